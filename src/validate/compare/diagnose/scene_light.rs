//! The light of a scene in the candidate's pixels, rendered as the reference was.

use glam::DVec3;

use super::super::known::is_all_in_its_text;
use super::Case;
use super::light::{Fit, Lit, fit};
use crate::render::plan::{Plan, Request};
use crate::render::prepare::Prepared;
use crate::render::progress::Silent;
use crate::render::render;
use crate::scene::model::Scene;

/// The most samples per pixel, and the most rays of a picture: edges alone need more.
const MOST_SAMPLES: u32 = 16;
const MOST_RAYS: usize = 4_000_000;
/// The most memory for a scene without files, which may come from any picture's metadata.
pub(super) const MEMORY: u64 = 1 << 30;

/// The light of a scene, for each pixel.
pub(super) struct Light(pub Vec<[f64; 3]>);

impl Light {
    pub fn fit(&self, lit: &[Lit]) -> Fit {
        fit(lit, |i, _| self.0[i])
    }
}

/// The light of a scene in the candidate's pixels.
pub(super) fn light_of(case: &Case, scene: &Scene, lit: &[Lit]) -> Option<Light> {
    light_and_size_of(case, scene, lit).map(|(light, _)| light)
}

/// The same, with the largest distance in metres of surfaces from the origins of their rest frames.
pub(super) fn light_and_size_of(case: &Case, scene: &Scene, lit: &[Lit]) -> Option<(Light, f64)> {
    let mut scene = scene.clone();
    let [width, height] = case.points[0].size();
    let most = (MOST_RAYS / (width * height).max(1)).clamp(1, MOST_SAMPLES as usize);
    // The reference may have been rendered with another number of samples than its file requests.
    let of_reference = case.pair[0].metadata("samples_per_pixel");
    let of_reference = of_reference.and_then(|samples| samples.parse().ok());
    let samples: u32 = of_reference.unwrap_or(scene.samples_per_pixel);
    scene.samples_per_pixel = samples.clamp(1, most as u32);
    let mut request = Request {
        pixel_centers: case.pair[0].metadata("pixel_centers") == Some("true"),
        ..Request::default()
    };
    if is_all_in_its_text(&scene) {
        request.memory_limit = MEMORY;
    }
    let plan = Plan::new(&scene, &request).ok()?;
    let prepared = Prepared::new(&scene, &plan, &Silent).ok()?;
    let reach = |(lo, hi): (DVec3, DVec3)| lo.abs().max(hi.abs()).max_element();
    let bounds = prepared
        .frames
        .iter()
        .filter_map(|frame| frame.bvh.bounds());
    let size = bounds.map(reach).fold(0.0, f64::max);
    let film = render(&prepared, &Silent).ok()?;
    let light = film.radiance().to_vec();
    let last = lit.iter().map(|(i, _)| *i).max()?;
    (light.len() == width * height && last < light.len()).then_some((Light(light), size))
}
