//! The reference pictures of a bundle: one ray through each pixel's centre.

use super::Files;
use super::bundle::ReferenceEntry;
use crate::error::Result;
use crate::io::image::{Layers, exr, npz, png};
use crate::render::aov::{Aov, Combine};
use crate::render::metadata::metadata;
use crate::render::plan::Plan;
use crate::render::prepare::Prepared;
use crate::render::progress::Progress;
use crate::render::render;
use crate::render::tonemap::tonemap;
use crate::scene::model::Scene;

/// All channels of a picture with one ray per pixel: a single sample has no standard error.
pub fn channels() -> Vec<Aov> {
    let all = Aov::ALL.iter().copied();
    all.filter(|aov| match aov.combine() {
        Combine::StandardError | Combine::Samples => false,
        Combine::NearestIdentity
        | Combine::Nearest
        | Combine::MeanOfHits
        | Combine::MeanOfAll
        | Combine::MeanOfSeeing
        | Combine::Missing(_)
        | Combine::Coverage => true,
    })
    .collect()
}

/// Renders `plan` of `scene` and writes its pictures.
pub(super) fn write(
    scene: &Scene,
    plan: &Plan,
    files: &mut Files,
    progress: &dyn Progress,
) -> Result<ReferenceEntry> {
    let entry = ReferenceEntry {
        npz: "reference/reference.npz",
        exr: "reference/reference.exr",
        png: "reference/reference.png",
        sampling: "pixel_centres",
    };
    files.folder.subfolder("reference")?;
    let prepared = Prepared::new(scene, plan, progress)?;
    let film = render(&prepared, progress)?;
    drop(prepared);
    let [width, height] = film.size();
    let channels = film.channels(&plan.film.channels);
    let layers = Layers::new(width, height, channels, metadata(scene, &film)?)?;
    files.written(entry.npz, |path| npz::write(path, &layers))?;
    files.written(entry.exr, |path| exr::write(path, &layers))?;
    let display = tonemap(film.radiance(), scene.exposure)?;
    files.written(entry.png, |path| {
        png::write(path, width, height, &display.rgb, &layers.metadata)
    })?;
    Ok(entry)
}
