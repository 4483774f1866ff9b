//! One exposure for several pictures: a percentile over small previews of them all.

use nullray::Result;
use nullray::render;
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;
use nullray::render::progress::Silent;
use nullray::render::tonemap;
use nullray::scene::model::{Exposure, Scene};

use super::interrupt;

/// The most columns and rows of a preview.
const PREVIEW: u32 = 128;

/// The radiance that is white in all pictures of `scenes`; none where the scenes say it themselves.
///
/// The percentile is that of the first scene.
pub fn common(scenes: &[Scene], request: &Request) -> Result<Option<f64>> {
    let Some(Exposure::Percentile(percentile)) = scenes.first().map(|scene| scene.exposure) else {
        return Ok(None);
    };
    let mut pixels = Vec::new();
    for scene in scenes {
        interrupt::check()?;
        pixels.extend(preview(scene, request)?);
    }
    tonemap::white(&pixels, Exposure::Percentile(percentile)).map(Some)
}

/// The radiance of a small picture, a ray through the centre of each pixel.
fn preview(scene: &Scene, request: &Request) -> Result<Vec<[f64; 3]>> {
    let mut small = scene.clone();
    let [width, height] = scene.camera.size;
    let step = width.max(height).div_ceil(PREVIEW);
    small.camera.size = [width.div_ceil(step), height.div_ceil(step)];
    let request = Request {
        aovs: Vec::new(),
        pixel_centers: true,
        ..request.clone()
    };
    let plan = Plan::new(&small, &request)?;
    let film = render::render(&Prepared::new(&small, &plan, &Silent)?, &Silent)?;
    Ok(film.radiance().to_vec())
}
