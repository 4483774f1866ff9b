//! One exposure for several pictures.
//!
//! For panels, and for one place at many speeds, it is a percentile over small previews of all of them; if that of one is over 30 times
//! that of another, the pictures share a logarithmic scale. For another film it is a percentile over previews of its middle third: a few
//! very bright pictures at its ends, for instance when a camera has become fast, would leave all others black. It is at least a hundredth
//! of the percentile over all pictures, so that none is too far above white if the middle is dark.

use glam::DVec3;
use nullray::Result;
use nullray::render::aov::Aov;
use nullray::render::film::Film;
use nullray::render::plan::Request;
use nullray::render::prepare::{LoadedCubes, Prepared};
use nullray::render::tonemap;
use nullray::scene::model::{Exposure, Scene};

use super::preview::Preview;

/// The most columns and rows of a preview.
const MOST: u32 = 128;
/// The smallest `display.white` of scenes.
const DARKEST_WHITE: f64 = 1e-30;
/// How many times brighter than white the brightest picture may be so that those in the middle are well exposed.
const MOST_BEYOND: f64 = 100.0;

/// The exposure of all of `scenes`, with this `percentile`.
pub fn of_panels(
    scenes: &[&Scene],
    percentile: Exposure,
    request: &Request,
    cubes: &mut LoadedCubes,
) -> Result<Exposure> {
    let mut previews = Vec::new();
    for scene in scenes {
        let preview = Preview::new(scene, request, Vec::new(), MOST)?;
        previews.push(preview.alone(cubes)?.radiance().to_vec());
    }
    for_all(&previews, percentile)
}

/// The exposure of one place at many speeds, from a selection of its pictures, `scenes`, which differ as for [`of_film`].
pub fn of_speeds(
    scenes: &[Scene],
    percentile: Exposure,
    request: &Request,
    prepared: &mut Prepared,
) -> Result<Exposure> {
    for_all(&previews(scenes, request, prepared)?, percentile)
}

/// The exposure that shows all `pictures`: white is the percentile over all, or on a logarithmic scale that of the brightest.
fn for_all(pictures: &[Vec<[f64; 3]>], percentile: Exposure) -> Result<Exposure> {
    let lit = pictures.iter().filter(|picture| picture.iter().any(is_lit));
    let whites = lit.map(|picture| tonemap::white(picture, percentile));
    let whites = whites.collect::<Result<Vec<f64>>>()?;
    let brightest = whites.iter().copied().fold(0.0, f64::max);
    let darkest = whites.iter().copied().fold(f64::INFINITY, f64::min);
    let black = Exposure::white_over_black(brightest / darkest).map(|ratio| brightest / ratio);
    Ok(match black {
        Some(black) if black > 0.0 => Exposure::Logarithmic([black, brightest]),
        _ => Exposure::White(tonemap::white(&pictures.concat(), percentile)?),
    })
}

/// The exposure of all pictures of a film, from a selection of them in order, `scenes`, with the `percentile` of the first. They are
/// taken of `prepared`, from which they differ only in what [`Prepared::retake`] allows.
pub fn of_film(
    scenes: &[Scene],
    percentile: Exposure,
    request: &Request,
    prepared: &mut Prepared,
) -> Result<Exposure> {
    let mut previews = previews(scenes, request, prepared)?;
    let all = tonemap::white(&previews.concat(), percentile)?;
    let aside = previews.len() / 3;
    let middle = previews.drain(aside..previews.len() - aside);
    let middle: Vec<[f64; 3]> = middle.flatten().collect();
    Ok(Exposure::White(match middle.iter().any(is_lit) {
        true => tonemap::white(&middle, percentile)?.max(all / MOST_BEYOND),
        false => all,
    }))
}

/// The pixels of small pictures of `scenes`, taken of `prepared`.
fn previews(
    scenes: &[Scene],
    request: &Request,
    prepared: &mut Prepared,
) -> Result<Vec<Vec<[f64; 3]>>> {
    let pixels = |scene| {
        let preview = Preview::new(scene, request, Vec::new(), MOST)?;
        Ok(preview.of(prepared)?.radiance().to_vec())
    };
    scenes.iter().map(pixels).collect()
}

fn is_lit(pixel: &[f64; 3]) -> bool {
    pixel.iter().any(|c| *c > 0.0 && c.is_finite())
}

/// The percentile by which `scene` is exposed; `None` if it sets its radiances itself.
pub fn percentile(scene: &Scene) -> Option<Exposure> {
    Some(scene.exposure).filter(|exposure| matches!(exposure, Exposure::Percentile(_)))
}

/// The white radiance that exposes for the surfaces of `scenes`, whatever the sky is like: the 99th percentile of their brightest channel
/// in small pictures, to three digits.
///
/// Surfaces that shine may be far brighter than those that they light. Pixels with more emitted than reflected light are brighter than white,
/// if need be, so that the others are well exposed; unless these are fewer, or dark.
///
/// The scenes differ only in what [`Prepared::retake`] allows from each other and from the one that is `prepared`, if it is. Visibility is
/// always certified, whatever `request` says, so that fast pictures have the same exposure.
pub fn of_surfaces(
    scenes: &[Scene],
    request: &Request,
    mut prepared: Option<&mut Prepared>,
) -> Result<Measured> {
    let request = Request {
        memory_limit: request.memory_limit,
        ..Request::default()
    };
    let mut own: Option<Prepared> = None;
    let [mut seen, mut lit]: [Vec<[f64; 3]>; 2] = Default::default();
    for scene in scenes {
        let preview = Preview::new(scene, &request, vec![Aov::Alpha], MOST)?;
        let prepared = match (&mut prepared, &mut own) {
            (Some(prepared), _) => &mut **prepared,
            (None, Some(own)) => own,
            (None, none) => none.insert(preview.prepared(&mut LoadedCubes::default())?),
        };
        let pixels = on_surfaces(&preview.of(prepared)?);
        if prepared.show_emission(false) {
            let reflected = on_surfaces(&preview.of(prepared)?);
            let both = pixels.iter().zip(&reflected);
            lit.extend(
                both.filter(|(all, part)| is_reflecting(all, part))
                    .map(|(all, _)| *all),
            );
        }
        prepared.show_emission(true);
        seen.extend(pixels);
    }
    if seen.iter().all(is_dark) {
        return Ok(match seen.is_empty() {
            true => Measured::Unknown,
            false => Measured::Dark,
        });
    }
    let mut white = tonemap::white(&seen, Exposure::Percentile(99.0))?;
    if 2 * lit.len() >= seen.len() && !lit.iter().all(is_dark) {
        white = white.min(tonemap::white(&lit, Exposure::Percentile(99.0))?);
    }
    // Scene files do not allow such a white: the light is shifted out of the visible range.
    if white < DARKEST_WHITE {
        return Ok(Measured::Unknown);
    }
    let short = format!("{white:.2e}").parse();
    Ok(short.map_or(Measured::Unknown, Measured::White))
}

/// An exposure for surfaces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Measured {
    /// The white radiance.
    White(f64),
    /// All surfaces in view are black.
    Dark,
    /// No surface is in view, or its light is out of sight.
    Unknown,
}

impl Measured {
    /// The white radiance, if there is one; says, unless `quiet`, if a model is black.
    pub fn of_model(self, quiet: bool) -> Result<Option<f64>> {
        match self {
            Measured::White(white) => Ok(Some(white)),
            Measured::Unknown => Ok(None),
            Measured::Dark => {
                let text = "nothing of the model in view is lit, so that it is black: no light reaches it, or it reflects none \
                            (--print-scene writes a scene to which you can add lights)\n";
                super::console::say(quiet, text).map(|()| None)
            }
        }
    }
}

/// The pixels of `film` that show a surface.
fn on_surfaces(film: &Film) -> Vec<[f64; 3]> {
    let alpha = film.aov(Aov::Alpha).unwrap_or_default();
    let pixels = film.radiance().iter().zip(alpha);
    pixels.filter(|(_, a)| **a > 0.0).map(|(p, _)| *p).collect()
}

/// Whether at least half of the light of a pixel, `all`, is `reflected`.
fn is_reflecting(all: &[f64; 3], reflected: &[f64; 3]) -> bool {
    let sum = |pixel: &[f64; 3]| pixel.iter().sum::<f64>();
    2.0 * sum(reflected) >= sum(all)
}

fn is_dark(pixel: &[f64; 3]) -> bool {
    *pixel == [0.0; 3]
}

/// The median distance, metres, from the pinhole of `scene` to the surfaces in view, from world positions in a small picture; `None` if no
/// surface is in view.
pub fn median_distance(scene: &Scene, request: &Request) -> Result<Option<f64>> {
    let places = [Aov::EventX, Aov::EventY, Aov::EventZ];
    let preview = Preview::new(scene, request, places.to_vec(), MOST)?;
    let film = preview.alone(&mut LoadedCubes::default())?;
    let [x, y, z] = places.map(|aov| film.aov(aov).unwrap_or_default());
    let eye = scene.camera.origin.x;
    let mut distances: Vec<f64> = (x.iter().zip(y).zip(z))
        .map(|((x, y), z)| eye.distance(DVec3::new(*x, *y, *z)))
        .filter(|distance| distance.is_finite())
        .collect();
    distances.sort_by(f64::total_cmp);
    Ok(distances.get(distances.len() / 2).copied())
}
