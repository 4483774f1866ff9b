//! What is written where, by extension.

use std::path::{Path, PathBuf};

use nullray::aov::Aov;
use nullray::film::Film;
use nullray::image::{self, Layers};
use nullray::scene::model::Scene;
use nullray::{Error, Result, isochrones, tonemap};

use super::metadata::metadata;
use super::render::RETARDED_TIME;

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

impl Outputs {
    /// The channels that have to be rendered.
    pub fn needs(&self) -> Vec<Aov> {
        let mut needed = self.aovs.clone();
        if self.isochrones.is_some() && !needed.contains(&RETARDED_TIME) {
            needed.push(RETARDED_TIME);
        }
        needed
    }

    /// Refuses, before any work, what could not be written after it.
    pub fn check(&self) -> Result<()> {
        for path in &self.images {
            if !["png", "exr", "npz"].contains(&extension(path).as_str()) {
                return Err(refused(
                    path,
                    "is not a kind of picture that nullray writes",
                    "a name that ends in .png, .exr or .npz",
                ));
            }
            can_hold(path)?;
        }
        for path in self.isochrones.iter().map(|i| &i.path) {
            if extension(path) != "png" {
                return Err(refused(
                    path,
                    "isochrones are a display picture",
                    "a name that ends in .png",
                ));
            }
            can_hold(path)?;
        }
        let only_display = self.images.iter().all(|p| extension(p) == "png");
        if only_display && !self.aovs.is_empty() {
            return Err(Error::invalid(
                "command line",
                "--aovs",
                "a .png holds no auxiliary channels",
                "an output -o FILE.exr or -o FILE.npz",
            ));
        }
        Ok(())
    }

    /// Writes all files; says which.
    pub fn write(&self, scene: &Scene, film: &Film) -> Result<String> {
        let mut report = String::new();
        for path in &self.images {
            let note = match extension(path).as_str() {
                "png" => display(path, scene, film)?,
                "exr" => {
                    image::exr::write(path, &self.layers(scene, film)?).map(|()| String::new())?
                }
                _ => image::npz::write(path, &self.layers(scene, film)?).map(|()| String::new())?,
            };
            report += &format!("wrote {}{note}\n", path.display());
        }
        if let Some(isochrones) = &self.isochrones {
            isochrones.write(scene, film)?;
            report += &format!("wrote {} (retarded time)\n", isochrones.path.display());
        }
        Ok(report)
    }

    fn layers(&self, scene: &Scene, film: &Film) -> Result<Layers> {
        let [width, height] = film.size();
        Layers::new(width, height, film.channels(&self.aovs), metadata(scene))
    }
}

impl Isochrones {
    fn write(&self, scene: &Scene, film: &Film) -> Result<()> {
        let [width, height] = film.size();
        let options = isochrones::Options {
            step: self.step,
            speed_of_light: scene.speed_of_light,
            ..isochrones::Options::default()
        };
        let times = film.aov(RETARDED_TIME).unwrap_or_default();
        let picture = isochrones::draw(width, height, times, &options)?;
        image::png::write(
            &self.path,
            picture.width,
            picture.height,
            &picture.rgb,
            &metadata(scene),
        )
    }
}

/// Writes the tone-mapped picture; says how bright white is.
fn display(path: &Path, scene: &Scene, film: &Film) -> Result<String> {
    let [width, height] = film.size();
    let mapped = tonemap::tonemap(film.radiance(), scene.exposure)?;
    let mut metadata = metadata(scene);
    metadata.push(("white".into(), mapped.white.to_string()));
    image::png::write(path, width, height, &mapped.rgb, &metadata)?;
    Ok(format!(" (white is radiance {:.4})", mapped.white))
}

fn extension(path: &Path) -> String {
    path.extension()
        .map_or(String::new(), |e| e.to_string_lossy().to_ascii_lowercase())
}

fn can_hold(path: &Path) -> Result<()> {
    let directory = path
        .parent()
        .filter(|d| !d.as_os_str().is_empty())
        .unwrap_or(Path::new("."));
    if !directory.is_dir() {
        return Err(refused(
            path,
            "its directory does not exist",
            "a directory that exists",
        ));
    }
    if path.is_dir() {
        return Err(refused(path, "is a directory", "the name of a file"));
    }
    Ok(())
}

fn refused(path: &Path, what: &str, help: &str) -> Error {
    Error::invalid(path, "output", what, help)
}
