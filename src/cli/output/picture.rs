//! Pictures for displays.

use nullray::Result;
use nullray::figures::isochrones;
use nullray::io::image::RgbImage;
use nullray::render::film::Film;
use nullray::render::tonemap;
use nullray::scene::model::{Scene, Show};

use super::RETARDED_TIME;

/// A picture, and the radiance that is white in it, where it shows radiance.
pub struct Picture {
    pub image: RgbImage,
    pub white: Option<f64>,
}

/// What `film` shows; isochrones `step` metres apart, or at round numbers.
pub fn picture(scene: &Scene, film: &Film, show: Show, step: Option<f64>) -> Result<Picture> {
    match show {
        Show::Picture => display(scene, film),
        Show::Isochrones => Ok(Picture {
            image: times(scene, film, step)?,
            white: None,
        }),
    }
}

fn display(scene: &Scene, film: &Film) -> Result<Picture> {
    let [width, height] = film.size();
    let mapped = tonemap::tonemap(film.radiance(), scene.exposure)?;
    Ok(Picture {
        image: RgbImage {
            width,
            height,
            rgb: mapped.rgb,
        },
        white: Some(mapped.white),
    })
}

fn times(scene: &Scene, film: &Film, step: Option<f64>) -> Result<RgbImage> {
    let [width, height] = film.size();
    let options = isochrones::Options {
        step,
        speed_of_light: scene.speed_of_light,
        ..isochrones::Options::default()
    };
    let times = film.aov(RETARDED_TIME).unwrap_or_default();
    isochrones::draw(width, height, times, &options)
}
