//! How far from their places the points of a film are drawn.

use super::Observer;
use crate::error::{Error, Result};
use crate::render::aov::Aov;
use crate::render::film::Film;
use crate::render::prepare::Prepared;

/// The channels that [`misplacements`] looks at.
pub const CHANNELS: [Aov; 4] = [
    Aov::Object,
    Aov::ObjectEventX,
    Aov::ObjectEventY,
    Aov::ObjectEventZ,
];

/// Per pixel of `film`, from where its point of a surface is drawn (the pixel's centre) to where it should
/// be, in pixels; NaN where nothing is met, and where the point is behind the camera.
///
/// The film has [`CHANNELS`] and one sample at the centre of each pixel.
///
/// # Errors
/// A film that is not like that; as [`Observer::of`] and [`Observer::sight`].
pub fn misplacements(scene: &Prepared, film: &Film) -> Result<Vec<[f64; 2]>> {
    let [Some(object), Some(x), Some(y), Some(z)] = CHANNELS.map(|aov| film.aov(aov)) else {
        return Err(unfit());
    };
    if !film.is_centred() {
        return Err(unfit());
    }
    let observer = Observer::new(scene)?;
    let places = observer.places(scene)?;
    let width = film.size()[0] as usize;
    let misplaced = |pixel: usize| {
        let (sight, origin) = places.get(object[pixel] as usize)?.as_ref()?;
        let point = glam::DVec3::new(x[pixel], y[pixel], z[pixel]);
        let [u, v] = sight.film_point(origin + point)?;
        let drawn = [(pixel % width) as f64 + 0.5, (pixel / width) as f64 + 0.5];
        Some([u - drawn[0], v - drawn[1]])
    };
    let met = |pixel: usize| object[pixel] >= 0.0;
    let all = 0..object.len();
    Ok(all
        .map(|pixel| met(pixel).then(|| misplaced(pixel)).flatten())
        .map(|found| found.unwrap_or([f64::NAN; 2]))
        .collect())
}

fn unfit() -> Error {
    Error::invalid(
        "film",
        "channels",
        "places on a film are compared at the centres of its pixels, by the channels object and object_event",
        "render with pixel centres and these channels",
    )
}
