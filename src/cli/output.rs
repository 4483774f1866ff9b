//! What is written where, by extension.

mod check;
mod names;
mod picture;

use std::path::{Path, PathBuf};

use nullray::Result;
use nullray::approximate::raster::Method;
use nullray::figures::overlay::Parts;
use nullray::io::image::{self, Layers};
use nullray::render::aov::Aov;
use nullray::render::film::Film;
use nullray::render::metadata::metadata;
use nullray::scene::model::{Scene, Show};

use super::frames::Identity;
use super::{inputs, interrupt};

pub use check::{check_all, check_page, check_statistics};
pub use names::{numbered, suffixed};
pub use picture::{Picture, picture};

/// The retarded time, which isochrones need.
const RETARDED_TIME: Aov = Aov::EventCt;

/// The files of one rendering.
#[derive(Debug, Clone, Default)]
pub struct Outputs {
    /// By extension: png, exr, npz.
    pub images: Vec<PathBuf>,
    /// What a png of them shows.
    pub show: Show,
    /// The picture of retarded times, a png.
    pub isochrones: Option<PathBuf>,
    /// Pictures with lines drawn over them, by extension: png, svg, pdf.
    pub overlays: Vec<PathBuf>,
    /// What is drawn over those.
    pub parts: Parts,
    /// Distance between isochrones, metres.
    pub step: Option<f64>,
    /// Auxiliary channels that were asked for.
    pub aovs: Vec<Aov>,
    /// How they are made.
    pub method: Method,
    /// Tells the files of a frame of a sequence from all others.
    pub identity: Option<Identity>,
}

/// What one file holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// The tone-mapped picture.
    Display,
    /// The picture of retarded times.
    Isochrones,
    /// All channels, single precision.
    Exr,
    /// All channels, double precision.
    Npz,
}

impl Kind {
    /// The kind of a file of this name, of which it is known that it can be written.
    fn of(path: &Path, show: Show) -> Kind {
        match (extension(path).as_str(), show) {
            ("exr", _) => Kind::Exr,
            ("npz", _) => Kind::Npz,
            (_, Show::Picture) => Kind::Display,
            (_, Show::Isochrones) => Kind::Isochrones,
        }
    }

    /// A word for it.
    pub fn word(self) -> &'static str {
        match self {
            Kind::Display => "display",
            Kind::Isochrones => "isochrones",
            Kind::Exr => "exr",
            Kind::Npz => "npz",
        }
    }
}

impl Outputs {
    /// Auxiliary channels that have to be rendered.
    pub fn needs(&self) -> Vec<Aov> {
        let mut needed = self.aovs.clone();
        let times = self.files().any(|(_, kind)| kind == Kind::Isochrones);
        if times && !needed.contains(&RETARDED_TIME) {
            needed.push(RETARDED_TIME);
        }
        needed
    }

    /// All files of the film's own, and what they hold; not those with lines drawn over them.
    pub fn files(&self) -> impl Iterator<Item = (&Path, Kind)> {
        let images = self.images.iter();
        let images = images.map(|path| (path.as_path(), Kind::of(path, self.show)));
        let isochrones = self.isochrones.iter();
        images.chain(isochrones.map(|path| (path.as_path(), Kind::Isochrones)))
    }

    /// All files, with the option that names them.
    fn paths(&self) -> impl Iterator<Item = (&'static str, &Path)> {
        let images = self.images.iter().map(|path| ("-o", path.as_path()));
        let isochrones = self.isochrones.iter();
        let overlays = self.overlays.iter();
        images
            .chain(isochrones.map(|path| ("--isochrones", path.as_path())))
            .chain(overlays.map(|path| ("--overlay", path.as_path())))
    }

    /// The same with every file's name changed.
    pub fn renamed(&self, name: impl Fn(&Path) -> PathBuf) -> Outputs {
        Outputs {
            images: self.images.iter().map(|path| name(path)).collect(),
            isochrones: self.isochrones.as_deref().map(&name),
            overlays: self.overlays.iter().map(|path| name(path)).collect(),
            ..self.clone()
        }
    }

    /// Writes all files, one after the other; `say`s which.
    pub fn write(
        &self,
        scene: &Scene,
        film: &Film,
        say: &mut dyn FnMut(&str) -> Result<()>,
    ) -> Result<()> {
        for (_, path) in self.paths() {
            will_write(path);
        }
        for (path, kind) in self.files() {
            interrupt::check()?;
            let note = self.write_one(path, kind, scene, film)?;
            say(&format!("wrote {}{note}\n", path.display()))?;
        }
        Ok(())
    }

    fn write_one(&self, path: &Path, kind: Kind, scene: &Scene, film: &Film) -> Result<String> {
        let mut metadata = metadata(scene, film);
        metadata.push(("method".into(), self.method.to_string()));
        if let Some(identity) = &self.identity {
            metadata.push((Identity::KEY.into(), identity.fingerprint(kind)));
        }
        match kind {
            Kind::Display => self.write_picture(path, Show::Picture, scene, film, metadata),
            Kind::Isochrones => self.write_picture(path, Show::Isochrones, scene, film, metadata),
            Kind::Exr | Kind::Npz => self.write_layers(path, kind, film, metadata),
        }
    }

    fn write_picture(
        &self,
        path: &Path,
        show: Show,
        scene: &Scene,
        film: &Film,
        mut metadata: Vec<(String, String)>,
    ) -> Result<String> {
        let Picture { image, white } = picture(scene, film, show, self.step)?;
        metadata.extend(white.map(|white| ("white".into(), white.to_string())));
        image::png::write(path, image.width, image.height, &image.rgb, &metadata)?;
        Ok(match white {
            Some(white) => format!(" (white is radiance {})", five_digits(white)),
            None => " (retarded time)".into(),
        })
    }

    fn write_layers(
        &self,
        path: &Path,
        kind: Kind,
        film: &Film,
        metadata: Vec<(String, String)>,
    ) -> Result<String> {
        let [width, height] = film.size();
        let layers = Layers::new(width, height, film.channels(&self.aovs), metadata)?;
        match kind {
            Kind::Exr => image::exr::write(path, &layers)?,
            _ => image::npz::write(path, &layers)?,
        }
        Ok(format!(" ({} channels)", layers.channels.len()))
    }
}

/// Says that a file of this name is about to be written, so that its temporary one can be cleared away.
pub fn will_write(path: &Path) {
    interrupt::will_write_into(inputs::directory(&inputs::identity(path)).into());
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

pub fn extension(path: &Path) -> String {
    path.extension()
        .map_or(String::new(), |e| e.to_string_lossy().to_ascii_lowercase())
}
