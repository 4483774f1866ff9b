//! Checks of outputs before any work.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use nullray::{Error, Result};

use super::failure::refused;
use super::inputs;
use super::output::{Kind, Outputs, extension};

/// The files that are read and those that will be written, by identity.
pub struct Names {
    read: HashSet<PathBuf>,
    /// The message if an input would be overwritten.
    overwritten: &'static str,
    /// The content of an output, after a space.
    thing: &'static str,
    written: HashSet<PathBuf>,
    /// Directories that are known to be writable.
    directories: HashSet<PathBuf>,
}

/// Refuses, before any work, outputs that could not be written later, that would be written twice, or that would overwrite one of the
/// files `read`.
pub fn check_all(all: impl IntoIterator<Item = Outputs>, read: &[PathBuf]) -> Result<()> {
    let mut names = Names::of_scene(read);
    for outputs in all {
        for (flag, path) in outputs.paths() {
            let option = format!("{flag} {}", path.display());
            check_kind(&option, flag, path)?;
            names.check(&option, path)?;
        }
        check_options(&outputs)?;
    }
    Ok(())
}

/// Refuses to keep sums in `path` if that is impossible, or over a picture or one of the files `read`.
pub fn check_beside(path: &Path, outputs: &Outputs, read: &[PathBuf]) -> Result<()> {
    let mut names = Names::of_scene(read);
    for (flag, path) in outputs.paths() {
        names.check(&format!("{flag} {}", path.display()), path)?;
    }
    names.check(&format!("sums of passes in {}", path.display()), path)
}

/// Refuses to write statistics over one of the files `read`, or where that is impossible.
pub fn check_statistics(path: &Path, read: &[PathBuf]) -> Result<()> {
    let option = format!("--stats-json {}", path.display());
    Names::of_scene(read).check(&option, path)?;
    match extension(path).as_str() {
        "json" => Ok(()),
        _ => Err(refused(
            option,
            "statistics are written as JSON",
            "end its name in .json",
        )),
    }
}

/// Refuses an output name that does not work for the pages of `count` scenes.
pub fn check_page(output: &Path, count: usize) -> Result<()> {
    let option = format!("-o {}", output.display());
    if extension(output) != "png" {
        let what = "a sheet is a picture for displays";
        return Err(refused(option, what, "end its name in .png"));
    }
    if count != 1 {
        let what = format!("one output file for the pages of {count} scenes");
        return Err(refused(option, what, "give --directory DIR, or one scene"));
    }
    Ok(())
}

impl Names {
    /// For pictures of a scene with these files.
    fn of_scene(read: &[PathBuf]) -> Names {
        let overwritten = "the scene is made from this file, which would be overwritten";
        Names::new(read, overwritten, " picture")
    }

    pub fn new(
        read: impl IntoIterator<Item = impl AsRef<Path>>,
        overwritten: &'static str,
        thing: &'static str,
    ) -> Names {
        Names {
            read: read
                .into_iter()
                .map(|path| inputs::identity(path.as_ref()))
                .collect(),
            overwritten,
            thing,
            written: HashSet::new(),
            directories: HashSet::new(),
        }
    }

    /// Refuses to write `path`, which `option` names, over an input or another output.
    pub fn take(&mut self, option: &str, path: &Path) -> Result<()> {
        let identity = inputs::identity(path);
        if self.read.contains(&identity) {
            return Err(refused(option, self.overwritten, "write to another name"));
        }
        if !self.written.insert(identity) {
            let help = format!("give each{} a name of its own", self.thing);
            return Err(refused(option, "two outputs have this name", &help));
        }
        Ok(())
    }

    /// Like `take`, and also refuses a path that cannot be written.
    pub fn check(&mut self, option: &str, path: &Path) -> Result<()> {
        self.take(option, path)?;
        refuse_dangling(option, path)?;
        // `Path` ignores a slash at the end, and a dot after it; the system does not.
        let name = path.to_string_lossy();
        let name = name.strip_suffix('.').unwrap_or(&name);
        if name.ends_with(std::path::is_separator) {
            let what = "this is the name of a directory";
            return Err(refused(option, what, "remove the part after the file name"));
        }
        if path.exists() && !path.is_file() {
            let what = "something that is not a file has this name";
            let help = "name a new file, or one that may be replaced";
            return Err(refused(option, what, help));
        }
        let directory = inputs::directory(path);
        if self.directories.insert(directory.into()) {
            takes_files(option, path, directory)?;
        }
        Ok(())
    }
}

/// Refuses a dangling link, named by `option`: its target may be on a disk that is not mounted.
pub fn refuse_dangling(option: &str, path: &Path) -> Result<()> {
    match std::fs::read_link(path) {
        Ok(link) if !path.exists() => {
            let what = format!("this is a link to {}, which does not exist", link.display());
            let help = "remove the link, or create its target";
            Err(refused(option, what, help))
        }
        _ => Ok(()),
    }
}

fn check_options(outputs: &Outputs) -> Result<()> {
    let holds_channels = |(_, kind): (&Path, Kind)| matches!(kind, Kind::Exr | Kind::Npz);
    if !outputs.aovs.is_empty() && !outputs.files().any(holds_channels) {
        let what = "a .png holds no auxiliary channels";
        return Err(refused(
            "--aovs",
            what,
            "add an output: -o FILE.exr or -o FILE.npz",
        ));
    }
    match outputs.step.filter(|step| *step <= 0.0) {
        Some(_) => Err(refused(
            "--isochrone-step",
            "the distance between isochrones is not above 0",
            "give a time like \"0.1 m\" or \"1 ns\"",
        )),
        None => Ok(()),
    }
}

/// The error for a name, given by `option`, whose extension is no format of a `thing`; `help` says which are.
pub fn unknown_format(option: String, path: &Path, thing: &str, help: &str) -> Error {
    let what = match extension(path).as_str() {
        "" => format!("the name does not say which kind of {thing} to write"),
        other => format!("nullray does not write {thing}s as .{other}"),
    };
    refused(option, what, help)
}

/// Advice for a video of a format that is not written, by its extension; empty for all others.
pub fn by_ffmpeg(extension: &str) -> String {
    let pixels = match extension {
        "gif" => "",
        "avi" | "m4v" | "mkv" | "mov" | "mp4" | "webm" => " -pix_fmt yuv420p",
        _ => return String::new(),
    };
    format!(
        "; for .{extension} pipe raw video to ffmpeg: -o - | ffmpeg -i -{pixels} FILE.{extension}"
    )
}

/// Refuses a file whose extension the option does not support.
fn check_kind(option: &str, flag: &str, path: &Path) -> Result<()> {
    let extension = extension(path);
    match (flag, extension.as_str()) {
        (_, "png") | ("-o", "exr" | "npz") | ("--overlay", "svg" | "pdf") => Ok(()),
        ("--overlay", _) => {
            let help = "end it in .png (pixels), .svg or .pdf (vectors over the picture)";
            Err(unknown_format(option.into(), path, "overlay", help))
        }
        ("-o", other) => {
            let known = "end it in .png (display), .exr (linear, all channels) or .npz (for numpy)";
            let help = known.to_string() + &by_ffmpeg(other);
            Err(unknown_format(option.into(), path, "picture", &help))
        }
        ("--luminance", _) => Err(refused(
            option,
            "luminance is a picture for displays",
            "end its name in .png",
        )),
        _ => Err(refused(
            option,
            "isochrones are a picture for displays",
            "end its name in .png",
        )),
    }
}

/// Checks that files can be created in `directory`, so that no rendering starts that cannot be saved.
fn takes_files(option: &str, path: &Path, directory: &Path) -> Result<()> {
    if !directory.is_dir() {
        let what = format!("there is no directory {}", directory.display());
        return Err(refused(
            option,
            what,
            "make the directory first, or write elsewhere",
        ));
    }
    // Permissions are not enough: the disk may be read-only or full, or the network down.
    let made = tempfile::tempfile_in(directory);
    let made = made.map(drop);
    made.map_err(Error::io(path, "no file can be written into its directory"))
}
