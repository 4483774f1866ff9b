//! The panels of a scene.

use std::path::Path;

use nullray::Result;
use nullray::render::plan::Request;
use nullray::render::prepare::LoadedCubes;
use nullray::scene::model::{Panel, Scene, Show};
use nullray::scene::{Overrides, SceneFile};

use super::failure::refused;
use super::{builtin, exposure};

/// The named panels of `scene`, in the scene's order; all panels if no name is given.
///
/// # Errors
/// Names that no panel has.
pub fn chosen<'s>(scene: &'s Scene, names: &[String]) -> Result<Vec<&'s Panel>> {
    for name in names {
        if !scene.panels.iter().any(|panel| panel.name == *name) {
            return Err(unknown(scene, name));
        }
    }
    let is_chosen = |panel: &&Panel| names.is_empty() || names.contains(&panel.name);
    Ok(scene.panels.iter().filter(is_chosen).collect())
}

/// The scene of a command, or its named panel.
///
/// # Errors
/// Errors in the scene; a name without a panel.
pub fn scene(
    path: Option<&Path>,
    panel: Option<&String>,
    overrides: &Overrides,
    memory: u64,
) -> Result<Scene> {
    of_file(&builtin::open(path, overrides, memory)?, panel, overrides)
}

/// Like [`scene`], for a file that is already open.
///
/// # Errors
/// As [`scene`].
pub fn of_file(file: &SceneFile, panel: Option<&String>, overrides: &Overrides) -> Result<Scene> {
    let whole = file.scene(overrides)?;
    let Some(panel) = panel else {
        return Ok(whole);
    };
    match chosen(&whole, std::slice::from_ref(panel))?.as_slice() {
        [panel] => file.panel(&whole, panel, overrides),
        _ => Ok(whole),
    }
}

fn unknown(scene: &Scene, name: &str) -> nullray::Error {
    let known: Vec<_> = scene.panels.iter().map(|p| p.name.as_str()).collect();
    let help = match known.as_slice() {
        [] => format!("{} has no panels: leave the option out", scene.name),
        known => format!("there are: {}", known.join(", ")),
    };
    let what = "the scene has no panel of this name";
    refused(format!("--panel {}", name.escape_debug()), what, &help)
}

/// The scenes of all panels, in their order.
///
/// # Errors
/// Errors in any of them.
pub fn load_all(file: &SceneFile, whole: &Scene, overrides: &Overrides) -> Result<Vec<Scene>> {
    let panels = whole.panels.iter();
    panels
        .map(|panel| file.panel(whole, panel, overrides))
        .collect()
}

/// Gives the panels of `whole` that show brightness one exposure, except those that set their own, and all if the scene does.
pub fn same_exposure(
    whole: &Scene,
    scenes: &mut [Scene],
    request: &Request,
    cubes: &mut LoadedCubes,
) -> Result<()> {
    let Some(percentile) = exposure::percentile(whole) else {
        return Ok(());
    };
    let panels = whole.panels.iter().zip(scenes);
    let mut alike: Vec<&mut Scene> = panels
        .filter(|(panel, scene)| panel.show == Show::Picture && scene.exposure == percentile)
        .map(|(_, scene)| scene)
        .collect();
    // One picture is exposed by itself.
    if alike.len() < 2 {
        return Ok(());
    }
    let measured: Vec<&Scene> = alike.iter().map(|scene| &**scene).collect();
    let exposure = exposure::of_panels(&measured, percentile, request, cubes)?;
    alike.iter_mut().for_each(|scene| scene.exposure = exposure);
    Ok(())
}
