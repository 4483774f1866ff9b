//! Errors of a method: the displacement of the points that a picture shows, and the difference of its radiance from a reference.

use serde::Serialize;

use super::statistics::quantile;
use crate::approximate::projection::{CHANNELS as PLACES, displacements};
use crate::error::Result;
use crate::io::image::Layers;
use crate::render::aov::Aov;
use crate::render::film::Film;
use crate::render::prepare::Prepared;
use crate::validate::compare::{CompareOptions, NotFinite, Picture, compare};

/// Errors of geometry and of time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[non_exhaustive]
pub struct GeometricError {
    /// The displacement of points, pixels.
    pub pixels: Spread,
    /// |Δct| of the emission where the right object is visible, metres.
    pub emission_time: Spread,
    /// Pixels whose centre shows a wrong object, misses one, or shows one where there should be none.
    pub wrong_object: u64,
    /// Pixels whose centre shows an object.
    pub seen: u64,
}

/// The distribution of errors.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Spread {
    /// The median.
    pub median: f64,
    /// The 99th percentile.
    pub p99: f64,
    /// The largest.
    pub max: f64,
}

/// The channels that [`GeometricError::of`] reads.
pub(super) fn geometry_channels() -> Vec<Aov> {
    PLACES.into_iter().chain([Aov::EventCt]).collect()
}

impl Spread {
    fn of(errors: &[f64]) -> Self {
        Spread {
            median: quantile(errors, 0.5),
            p99: quantile(errors, 0.99),
            max: quantile(errors, 1.0),
        }
    }
}

impl GeometricError {
    /// The error of `film` of `scene`, rendered at pixel centres, against the truth of `exact`.
    ///
    /// # Errors
    /// As [`displacements`].
    pub(super) fn of(scene: &Prepared, film: &Film, exact: &Film) -> Result<Self> {
        let object = film.aov(Aov::Object).unwrap_or_default();
        let true_object = exact.aov(Aov::Object).unwrap_or_default();
        let is_seen = |i: &usize| object[*i] >= 0.0;
        let is_right = |i: &usize| object[*i] == true_object[*i];
        let all = 0..object.len();
        let displaced = displacements(scene, film)?;
        let pixels: Vec<_> = all
            .clone()
            .filter(is_seen)
            .map(|i| libm::hypot(displaced[i][0], displaced[i][1]))
            .collect();
        Ok(GeometricError {
            pixels: Spread::of(&pixels),
            emission_time: Spread::of(&late(
                film,
                exact,
                all.clone().filter(is_seen).filter(is_right),
            )),
            wrong_object: all.filter(|i| !is_right(i)).count() as u64,
            seen: pixels.len() as u64,
        })
    }
}

/// The errors of the emission times of these pixels.
fn late(film: &Film, exact: &Film, pixels: impl Iterator<Item = usize>) -> Vec<f64> {
    let [time, truth] = [film, exact].map(|f| f.aov(Aov::EventCt).unwrap_or_default());
    pixels.map(|i| (time[i] - truth[i]).abs()).collect()
}

/// Errors of radiance, by the definitions of [`crate::validate::compare`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[non_exhaustive]
pub struct RadianceError {
    /// Root mean square error relative to the reference's root mean square; NaN against black.
    pub relrmse: f64,
    /// Mean relative square error.
    pub mrse: f64,
    /// Mean HDR-ꟻLIP.
    pub flip: f64,
}

/// The radiance of `film` as a picture for comparison.
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
        let value = |name: &str| found.metric(name).unwrap_or(f64::NAN);
        Ok(RadianceError {
            relrmse: value("relrmse"),
            mrse: value("mrse"),
            flip: value("flip"),
        })
    }
}
