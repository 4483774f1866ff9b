//! One exposure for several pictures.
//!
//! For panels it is a percentile over small previews of all of them. For a film it is a percentile over previews of its middle third: a few
//! very bright pictures at its ends, for instance when a camera has become fast, would leave all others black. It is at least a hundredth
//! of the percentile over all pictures, so that none is too far above white if the middle is dark.

use glam::DVec3;
use nullray::Result;
use nullray::render;
use nullray::render::aov::Aov;
use nullray::render::film::Film;
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;
use nullray::render::progress::Silent;
use nullray::render::tonemap;
use nullray::scene::model::{Exposure, Scene};

use super::interrupt;

/// The most columns and rows of a preview.
const PREVIEW: u32 = 128;
/// The smallest `display.white` of scenes.
const DARKEST_WHITE: f64 = 1e-30;
/// How many times brighter than white the brightest picture may be so that those in the middle are well exposed.
const MOST_BEYOND: f64 = 100.0;

/// The white radiance of all panels; `None` if the scenes set it themselves.
///
/// The percentile is that of the first scene.
pub fn of_panels(scenes: &[Scene], request: &Request) -> Result<Option<f64>> {
    let Some(exposure) = percentile(scenes) else {
        return Ok(None);
    };
    let previews = previews(scenes, request)?;
    tonemap::white(&previews.concat(), exposure).map(Some)
}

/// The white radiance of all pictures of a film, from a selection of them in order, `scenes`; `None` if the scenes set it themselves.
///
/// The percentile is that of the first scene.
pub fn of_film(scenes: &[Scene], request: &Request) -> Result<Option<f64>> {
    let Some(exposure) = percentile(scenes) else {
        return Ok(None);
    };
    let mut previews = previews(scenes, request)?;
    let all = tonemap::white(&previews.concat(), exposure)?;
    let aside = previews.len() / 3;
    let middle = previews.drain(aside..previews.len() - aside);
    let middle: Vec<[f64; 3]> = middle.flatten().collect();
    let is_lit = |pixel: &[f64; 3]| pixel.iter().any(|c| *c > 0.0 && c.is_finite());
    Ok(Some(match middle.iter().any(is_lit) {
        true => tonemap::white(&middle, exposure)?.max(all / MOST_BEYOND),
        false => all,
    }))
}

/// The percentile of the first scene, if it has one.
fn percentile(scenes: &[Scene]) -> Option<Exposure> {
    let first = scenes.first().map(|scene| scene.exposure);
    first.filter(|exposure| matches!(exposure, Exposure::Percentile(_)))
}

/// The pixels of small pictures of all `scenes`.
fn previews(scenes: &[Scene], request: &Request) -> Result<Vec<Vec<[f64; 3]>>> {
    let pixels = |scene| {
        interrupt::check()?;
        Ok(preview(scene, request, Vec::new())?.radiance().to_vec())
    };
    scenes.iter().map(pixels).collect()
}

/// The white radiance that exposes for the surfaces of `scenes`, whatever the sky is like: the 99th percentile of their brightest channel
/// in small pictures, to three digits; `None` if no surface is visible.
///
/// Visibility is always certified, whatever `request` says, so that fast pictures have the same exposure.
pub fn of_surfaces(scenes: &[Scene], request: &Request) -> Result<Option<f64>> {
    let request = Request {
        memory_limit: request.memory_limit,
        ..Request::default()
    };
    let mut seen: Vec<[f64; 3]> = Vec::new();
    for scene in scenes {
        interrupt::check()?;
        let film = preview(scene, &request, vec![Aov::Alpha])?;
        let alpha = film.aov(Aov::Alpha).unwrap_or_default();
        let pixels = film.radiance().iter().zip(alpha);
        seen.extend(pixels.filter(|(_, a)| **a > 0.0).map(|(p, _)| *p));
    }
    if seen.iter().all(|pixel| *pixel == [0.0; 3]) {
        return Ok(None);
    }
    let white = tonemap::white(&seen, Exposure::Percentile(99.0))?;
    // Scene files do not allow such a white: the light is shifted out of the visible range.
    if white < DARKEST_WHITE {
        return Ok(None);
    }
    Ok(format!("{white:.2e}").parse().ok())
}

/// The median distance, metres, from the pinhole of `scene` to the surfaces in view, from world positions in a small picture; `None` if no
/// surface is in view.
pub fn median_distance(scene: &Scene, request: &Request) -> Result<Option<f64>> {
    let places = [Aov::EventX, Aov::EventY, Aov::EventZ];
    let film = preview(scene, request, places.to_vec())?;
    let [x, y, z] = places.map(|aov| film.aov(aov).unwrap_or_default());
    let eye = scene.camera.origin.x;
    let mut distances: Vec<f64> = (x.iter().zip(y).zip(z))
        .map(|((x, y), z)| eye.distance(DVec3::new(*x, *y, *z)))
        .filter(|distance| distance.is_finite())
        .collect();
    distances.sort_by(f64::total_cmp);
    Ok(distances.get(distances.len() / 2).copied())
}

/// A small picture with one ray through the centre of each pixel.
fn preview(scene: &Scene, request: &Request, aovs: Vec<Aov>) -> Result<Film> {
    let mut small = scene.clone();
    let [width, height] = scene.camera.size;
    let step = width.max(height).div_ceil(PREVIEW);
    small.camera.size = [width.div_ceil(step), height.div_ceil(step)];
    let request = Request {
        aovs,
        pixel_centers: true,
        ..request.clone()
    };
    let plan = Plan::new(&small, &request)?;
    render::render(&Prepared::new(&small, &plan, &Silent)?, &Silent)
}
