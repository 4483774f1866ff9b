//! How far the radiance of a picture is from that of a reference.

use serde::Serialize;

use crate::error::Result;
use crate::io::image::Layers;
use crate::render::film::Film;
use crate::validate::compare::{CompareOptions, NotFinite, Picture, compare};

/// Errors of radiance, by the definitions of [`crate::validate::compare`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RadianceError {
    /// Root mean square error relative to the reference's root mean square; NaN against black.
    pub relrmse: f64,
    /// Mean relative square error.
    pub mrse: f64,
    /// Mean HDR-ꟻLIP.
    pub flip: f64,
}

/// The radiance of `film` as a picture that can be compared.
pub(super) fn picture(name: &str, film: &Film) -> Result<Picture> {
    let [width, height] = film.size();
    let layers = Layers::new(width, height, film.channels(&[]), Vec::new())?;
    Ok(Picture::linear(name, layers))
}

impl RadianceError {
    /// The error of `film` against `reference`.
    ///
    /// # Errors
    /// As [`compare`].
    pub(super) fn of(film: &Film, reference: &Picture) -> Result<Self> {
        let options = CompareOptions {
            not_finite: NotFinite::Ignore,
            ..CompareOptions::default()
        };
        let found = compare(reference, &picture("picture", film)?, &options)?;
        let errors = found.radiance.as_ref();
        Ok(RadianceError {
            relrmse: errors.and_then(|e| e.relrmse).unwrap_or(f64::NAN),
            mrse: errors.map_or(f64::NAN, |e| e.mrse),
            flip: found.flip.map_or(f64::NAN, |flip| flip.mean),
        })
    }
}
