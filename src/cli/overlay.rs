//! `nullray render --overlay`.

use nullray::Result;
use nullray::figures::drawing;
use nullray::figures::overlay::{self, Overlay, Part};
use nullray::io::sealed;
use nullray::render::film::Film;
use nullray::render::metadata::metadata;
use nullray::render::prepare::Prepared;
use nullray::scene::model::{Scene, Show};

use super::console::say;
use super::interrupt;
use super::output::{Identity, Outputs, encoded, extension, picture};
use super::progress::Bar;

/// Refuses overlays unless there is exactly one picture.
pub fn check(outputs: &Outputs, scene: &Scene) -> Result<()> {
    match outputs.overlays.is_empty() {
        true => Ok(()),
        false => Overlay::check(scene),
    }
}

/// Writes the pictures with lines drawn over them, if any, and prints their names unless `quiet`.
pub fn write(
    outputs: &Outputs,
    scene: &Scene,
    film: &Film,
    prepared: &mut Prepared,
    quiet: bool,
) -> Result<()> {
    if outputs.overlays.is_empty() {
        return Ok(());
    }
    let overlay = traced(outputs, scene, prepared, quiet)?;
    let image = picture(scene, film, Show::Picture, None)?.image;
    let mut page = overlay.drawing(&scene.name, image)?;
    let scale = overlay::png_scale(film.size());
    page.origin = metadata(scene, film)?;
    if let Some(identity) = &outputs.identity {
        page.origin
            .push((Identity::KEY.into(), identity.of_overlay(outputs.parts)));
        page.origin.push((sealed::KEY.into(), sealed::blank()));
    }
    for path in &outputs.overlays {
        interrupt::check()?;
        let kind = extension(path);
        let mut bytes = encoded(&page, &kind, scale)?;
        // PNG files have their own checksums.
        if outputs.identity.is_some() && kind != "png" {
            sealed::seal_bytes(&mut bytes);
        }
        drawing::save(path, bytes)?;
        say(quiet, &format!("wrote {} (overlay)\n", path.display()))?;
    }
    Ok(())
}

/// The requested lines. Only what they need is rendered.
fn traced(
    outputs: &Outputs,
    scene: &Scene,
    prepared: &mut Prepared,
    quiet: bool,
) -> Result<Overlay> {
    let parts = outputs.parts;
    let [width, height] = scene.camera.size.map(u64::from);
    let bar = || Bar::new(width * height, quiet).named("overlay".into());
    let apparent = match parts.needs().is_empty() {
        true => None,
        false => Some(overlay::apparent(prepared, parts, &bar())?),
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
