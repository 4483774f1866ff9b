//! `nullray render --overlay`.

use std::path::Path;

use nullray::Result;
use nullray::drawing::{self, Drawing, pdf, png, svg};
use nullray::overlay::{self, Overlay, Part};
use nullray::prepare::Prepared;
use nullray::scene::model::{Scene, Show};

use super::output::{Outputs, extension, picture, will_write};
use super::progress::Bar;
use super::render::Rendered;
use super::{interrupt, print};

/// Writes the pictures with lines drawn over them, if any; says which unless `quiet`.
pub fn write(outputs: &Outputs, scene: &Scene, rendered: Rendered, quiet: bool) -> Result<()> {
    if outputs.overlays.is_empty() {
        return Ok(());
    }
    let Rendered { film, prepared, .. } = rendered;
    let overlay = traced(outputs, scene, prepared, quiet)?;
    let image = picture(scene, &film, Show::Picture, None)?.image;
    let page = overlay.drawing(&scene.name, image)?;
    let scale = overlay::png_scale(film.size());
    for path in &outputs.overlays {
        interrupt::check()?;
        will_write(path);
        drawing::save(path, bytes(path, &page, scale)?)?;
        if !quiet {
            print(&format!("wrote {} (overlay)\n", path.display()))?;
        }
    }
    Ok(())
}

/// The lines that are asked for. Only what they need is rendered.
fn traced(
    outputs: &Outputs,
    scene: &Scene,
    mut prepared: Prepared,
    quiet: bool,
) -> Result<Overlay> {
    let parts = outputs.parts;
    let [width, height] = scene.camera.size.map(u64::from);
    let bar = || Bar::new(width * height, quiet).named("overlay".into());
    let apparent = match parts.needs().is_empty() {
        true => None,
        false => Some(overlay::apparent(&mut prepared, parts, &bar())?),
    };
    let instant = match parts.has(Part::Outlines) {
        true => Some(overlay::instantaneous(scene, prepared, &bar())?),
        false => None,
    };
    interrupt::check()?;
    Overlay::trace(
        scene,
        apparent.as_ref(),
        instant.as_ref(),
        parts,
        outputs.step,
    )
}

fn bytes(path: &Path, page: &Drawing, scale: f64) -> Result<Vec<u8>> {
    match extension(path).as_str() {
        "svg" => Ok(svg::write(page)?.into_bytes()),
        "pdf" => pdf::write(page),
        _ => png::write(&png::render(page, scale)?),
    }
}
