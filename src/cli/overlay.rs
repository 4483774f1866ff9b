//! `nullray render --overlay`.

use std::path::Path;

use nullray::Result;
use nullray::drawing::{self, Drawing, pdf, png, svg};
use nullray::film::Film;
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
    let instant = match outputs.parts.has(Part::Outlines) {
        true => Some(instantaneous(scene, prepared, quiet)?),
        false => None,
    };
    let traced = Overlay::trace(scene, &film, instant.as_ref(), outputs.parts, outputs.step)?;
    let image = picture(scene, &film, Show::Picture, None)?.image;
    let scale = overlay::png_scale(film.size());
    let page = traced.drawing(&scene.name, image)?;
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

/// The objects where they are at the world time of the shot.
fn instantaneous(scene: &Scene, prepared: Prepared, quiet: bool) -> Result<Film> {
    let [width, height] = scene.camera.size.map(u64::from);
    let bar = Bar::new(width * height, quiet).named("outlines".into());
    bar.start();
    let film = overlay::instantaneous(scene, prepared, &bar)?;
    drop(bar);
    interrupt::check()?;
    Ok(film)
}

fn bytes(path: &Path, page: &Drawing, scale: f64) -> Result<Vec<u8>> {
    match extension(path).as_str() {
        "svg" => Ok(svg::write(page)?.into_bytes()),
        "pdf" => pdf::write(page),
        _ => png::write(&png::render(page, scale)?),
    }
}
