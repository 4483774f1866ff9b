//! What is written where, by extension; what cannot be written is refused before any work.

use std::fs;
use std::path::{Path, PathBuf};

use nullray::aov::Aov;
use nullray::film::Film;
use nullray::image::{self, Layers};
use nullray::scene::model::Scene;
use nullray::{Error, Result, isochrones, tonemap};

use super::failure::refused;
use super::metadata::metadata;
use super::{inputs, interrupt};

/// The retarded time, which isochrones need.
const RETARDED_TIME: Aov = Aov::EventCt;

/// The files of one rendering.
#[derive(Debug, Default)]
pub struct Outputs {
    /// By extension: png, exr, npz.
    pub images: Vec<PathBuf>,
    /// The picture of retarded times.
    pub isochrones: Option<Isochrones>,
    /// Auxiliary channels that were asked for.
    pub aovs: Vec<Aov>,
}

/// A picture of retarded times.
#[derive(Debug)]
pub struct Isochrones {
    /// A .png.
    pub path: PathBuf,
    /// Distance between isochrones, metres.
    pub step: Option<f64>,
}

/// What one file is to hold.
enum Kind {
    Display,
    Exr,
    Npz,
    Isochrones(Option<f64>),
}

impl Outputs {
    /// Auxiliary channels that have to be rendered.
    pub fn needs(&self) -> Vec<Aov> {
        let mut needed = self.aovs.clone();
        if self.isochrones.is_some() && !needed.contains(&RETARDED_TIME) {
            needed.push(RETARDED_TIME);
        }
        needed
    }

    /// Refuses, before any work, what could not be written after it, and what would be written over
    /// one of the files that are read.
    pub fn check(&self, read: &[PathBuf]) -> Result<()> {
        let read: Vec<_> = read.iter().map(|path| inputs::identity(path)).collect();
        let mut known = Vec::new();
        for (flag, path) in self.paths() {
            let option = format!("{flag} {}", path.display());
            check_kind(&option, flag, path)?;
            let identity = inputs::identity(path);
            if known.contains(&identity) {
                let help = "give each picture a name of its own";
                return Err(refused(option, "two outputs have this name", help));
            }
            if read.contains(&identity) {
                let what = "this is a file that the scene is made of: it would be overwritten";
                return Err(refused(option, what, "write to another name"));
            }
            known.push(identity);
            can_hold(&option, path)?;
        }
        self.check_options()
    }

    fn check_options(&self) -> Result<()> {
        let only_display = self.images.iter().all(|p| extension(p) == "png");
        if only_display && !self.aovs.is_empty() {
            let what = "a .png holds no auxiliary channels";
            return Err(refused(
                "--aovs",
                what,
                "add an output: -o FILE.exr or -o FILE.npz",
            ));
        }
        let step = self.isochrones.as_ref().and_then(|i| i.step);
        match step.filter(|step| *step <= 0.0) {
            Some(_) => Err(refused(
                "--isochrone-step",
                "the distance between isochrones is not above 0",
                "give a time like \"0.1 m\" or \"1 ns\"",
            )),
            None => Ok(()),
        }
    }

    /// All files, with the option that names them.
    fn paths(&self) -> impl Iterator<Item = (&'static str, &Path)> {
        let images = self.images.iter().map(|path| ("-o", path.as_path()));
        let isochrones = self.isochrones.iter();
        images.chain(isochrones.map(|i| ("--isochrones", i.path.as_path())))
    }

    /// Writes all files, one after the other; `say`s which.
    pub fn write(
        &self,
        scene: &Scene,
        film: &Film,
        say: &mut dyn FnMut(&str) -> Result<()>,
    ) -> Result<()> {
        for (_, path) in self.paths() {
            interrupt::will_write_into(inputs::directory(&inputs::identity(path)).into());
        }
        let images = self.images.iter().map(|path| {
            let kind = match extension(path).as_str() {
                "png" => Kind::Display,
                "exr" => Kind::Exr,
                _ => Kind::Npz,
            };
            (path, kind)
        });
        let isochrones = self.isochrones.iter();
        let isochrones = isochrones.map(|i| (&i.path, Kind::Isochrones(i.step)));
        for (path, kind) in images.chain(isochrones) {
            interrupt::check()?;
            let note = self.write_one(path, kind, scene, film)?;
            say(&format!("wrote {}{note}\n", path.display()))?;
        }
        Ok(())
    }

    fn write_one(&self, path: &Path, kind: Kind, scene: &Scene, film: &Film) -> Result<String> {
        match kind {
            Kind::Display => return display(path, scene, film),
            Kind::Exr => image::exr::write(path, &self.layers(scene, film)?)?,
            Kind::Npz => image::npz::write(path, &self.layers(scene, film)?)?,
            Kind::Isochrones(step) => {
                times(path, step, scene, film)?;
                return Ok(" (retarded time)".into());
            }
        }
        let channels = 3 + self.aovs.len();
        Ok(format!(" ({channels} channels)"))
    }

    fn layers(&self, scene: &Scene, film: &Film) -> Result<Layers> {
        let [width, height] = film.size();
        Layers::new(
            width,
            height,
            film.channels(&self.aovs),
            metadata(scene, film),
        )
    }
}

/// Writes the picture of retarded times.
fn times(path: &Path, step: Option<f64>, scene: &Scene, film: &Film) -> Result<()> {
    let [width, height] = film.size();
    let options = isochrones::Options {
        step,
        speed_of_light: scene.speed_of_light,
        ..isochrones::Options::default()
    };
    let times = film.aov(RETARDED_TIME).unwrap_or_default();
    let picture = isochrones::draw(width, height, times, &options)?;
    let (width, height) = (picture.width, picture.height);
    image::png::write(path, width, height, &picture.rgb, &metadata(scene, film))
}

/// Writes the tone-mapped picture; says how bright white is.
fn display(path: &Path, scene: &Scene, film: &Film) -> Result<String> {
    let [width, height] = film.size();
    let mapped = tonemap::tonemap(film.radiance(), scene.exposure)?;
    let mut metadata = metadata(scene, film);
    metadata.push(("white".into(), mapped.white.to_string()));
    image::png::write(path, width, height, &mapped.rgb, &metadata)?;
    Ok(format!(
        " (white is radiance {})",
        five_digits(mapped.white)
    ))
}

/// A number in five significant digits, which `--white` takes again.
fn five_digits(value: f64) -> String {
    let exponent = value.abs().log10().floor();
    if !(-4.0..7.0).contains(&exponent) {
        return format!("{value:.4e}");
    }
    let decimals = (4.0 - exponent).max(0.0) as usize;
    format!("{value:.decimals$}")
}

fn extension(path: &Path) -> String {
    path.extension()
        .map_or(String::new(), |e| e.to_string_lossy().to_ascii_lowercase())
}

fn check_kind(option: &str, flag: &str, path: &Path) -> Result<()> {
    let extension = extension(path);
    match (flag, extension.as_str()) {
        (_, "png") | ("-o", "exr" | "npz") => Ok(()),
        ("-o", _) => Err(refused(
            option,
            "the name does not say which kind of picture to write",
            "end it in .png (display), .exr (linear, all channels) or .npz (for numpy)",
        )),
        _ => Err(refused(
            option,
            "isochrones are a picture for displays",
            "end its name in .png",
        )),
    }
}

/// Whether a file can be made there. A rendering that cannot be saved is not begun.
fn can_hold(option: &str, path: &Path) -> Result<()> {
    let directory = inputs::directory(path);
    if !directory.is_dir() {
        let what = format!("there is no directory {}", directory.display());
        return Err(refused(
            option,
            what,
            "make the directory first, or write elsewhere",
        ));
    }
    if path.exists() && !path.is_file() {
        let what = "there is something of this name that is not a file";
        return Err(refused(
            option,
            what,
            "name a file that is new, or that may be replaced",
        ));
    }
    let probe = directory.join(format!(".nullray-{}-probe.part", std::process::id()));
    let made = fs::File::create_new(&probe).and_then(|_| fs::remove_file(&probe));
    made.map_err(Error::io(path, "no file can be written into its directory"))
}
