//! File names for the pictures of one request, by frame number or panel name.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use nullray::Result;

use super::builtin;
use super::failure::refused;

/// The placeholder for a number in a pattern.
const PLACE: char = '#';
/// Digits of a number without a pattern.
const DIGITS: usize = 4;

/// The name of frame `number`. The number replaces the run of # in `path`'s name, padded to its length; without one it goes before the
/// extension: "name-0007.png".
pub fn numbered(path: &Path, number: u64) -> PathBuf {
    let Some((name, [start, end])) = run(path) else {
        return suffixed(path, &format!("{number:0DIGITS$}"));
    };
    let width = end - start;
    let number = format!("{number:0width$}");
    path.with_file_name(format!("{}{number}{}", &name[..start], &name[end..]))
}

/// The file's name and the position of its only run of #; `None` if there is no run, or several.
fn run(path: &Path) -> Option<(String, [usize; 2])> {
    let name = path.file_name()?.to_str()?;
    let start = name.find(PLACE)?;
    let length = name[start..].chars().take_while(|c| *c == PLACE).count();
    let end = start + length;
    (!name[end..].contains(PLACE)).then(|| (name.to_string(), [start, end]))
}

/// Refuses the name `path`, given by `option`, if it has several runs of #.
pub fn check_places(option: &str, path: &Path) -> Result<()> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    match name.contains(PLACE) && run(path).is_none() {
        true => Err(refused(
            format!("{option} {}", path.display()),
            "the name has several places for the number of a frame",
            "leave one run of #",
        )),
        false => Ok(()),
    }
}

/// "name-suffix.png" for "name.png".
pub fn suffixed(path: &Path, suffix: &str) -> PathBuf {
    let mut name = OsString::from(path.file_stem().unwrap_or_default());
    name.push("-");
    name.push(suffix);
    if let Some(extension) = path.extension() {
        name.push(".");
        name.push(extension);
    }
    path.with_file_name(name)
}

/// A name made safe for use in a file name: path separators and invisible characters become `_`.
pub fn in_file_name(name: &str) -> String {
    let is_apart = |c: char| std::path::is_separator(c) || c.is_control();
    name.replace(is_apart, "_")
}

/// The name of the scene's file without its extension.
pub fn stem(path: Option<&Path>) -> PathBuf {
    if path.is_some_and(builtin::is_standard_input) {
        return "stdin".into();
    }
    let stem = path.and_then(Path::file_stem);
    stem.unwrap_or("nullray".as_ref()).into()
}

/// A file in the current directory with the scene's name and `ending`.
pub fn named_after(path: Option<&Path>, ending: &str) -> PathBuf {
    // Not `with_extension`, which would take ".9" in "approaching-0.9" for an extension.
    let mut name = stem(path).into_os_string();
    name.push(ending);
    name.into()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(path: &str, number: u64) -> String {
        numbered(Path::new(path), number).display().to_string()
    }

    #[test]
    fn numbers_stand_before_the_extension_in_four_digits_or_more() {
        assert_eq!(frame("a/name.png", 7), "a/name-0007.png");
        assert_eq!(
            frame("approaching-0.9.exr", 12345),
            "approaching-0.9-12345.exr"
        );
    }

    #[test]
    fn a_run_of_places_takes_the_number() {
        assert_eq!(frame("a#/frame-####.exr", 7), "a#/frame-0007.exr");
        assert_eq!(frame("#.png", 12), "12.png");
        assert_eq!(frame("β###.final.png", 12), "β012.final.png");
    }

    #[test]
    fn the_name_of_a_panel_stands_before_the_extension() {
        let path = suffixed(Path::new("out/fig.png"), "beta-0.9");
        assert_eq!(path, Path::new("out/fig-beta-0.9.png"));
    }

    #[test]
    fn the_name_of_an_object_leads_into_no_other_directory() {
        let path = suffixed(Path::new("out/a.npz"), &in_file_name("../up\n/./x"));
        assert_eq!(path, Path::new("out/a-.._up__._x.npz"));
    }
}
