//! Refusals of bindings that headers alone can tell, each with its place in the scene file.

use super::PlannedObject;
use super::bindings::{Lit, lit_by};
use crate::error::{Error, Problem, Result};
use crate::scene::model::{Binding, Mapping, Scene, Source, SourceKind};

/// Refuses sources that cannot light what they are bound to.
pub(super) fn check(scene: &Scene, objects: &[PlannedObject]) -> Result<()> {
    for source in &scene.sources {
        check_materials(scene, source, objects)?;
    }
    for (index, object) in objects.iter().enumerate() {
        for material in &object.materials {
            match lit_by(scene, index, material) {
                Lit::Base => {}
                Lit::Cube(source) => check_uv_set(scene, &scene.sources[source], object)?,
                Lit::Pulses(pulses) => check_pulses(scene, &pulses, object)?,
            }
        }
    }
    Ok(())
}

/// A source must not name materials that none of its objects has.
fn check_materials(scene: &Scene, source: &Source, objects: &[PlannedObject]) -> Result<()> {
    let Binding::Only {
        objects: bound,
        materials,
    } = &source.binding
    else {
        return Ok(());
    };
    let there = bound.iter().flat_map(|o| &objects[*o].materials);
    let there: Vec<&str> = there.map(String::as_str).collect();
    match materials.iter().find(|m| !there.contains(&m.as_str())) {
        None => Ok(()),
        Some(missing) => {
            let what = format!("no material \"{missing}\" in its objects");
            Err(refuse(
                scene,
                source,
                "materials",
                what,
                format!("there are: {}", there.join(", ")),
            ))
        }
    }
}

/// A cube by texture coordinates needs them.
fn check_uv_set(scene: &Scene, source: &Source, object: &PlannedObject) -> Result<()> {
    let SourceKind::Cube(cube) = &source.kind else {
        return Ok(());
    };
    match cube.mapping {
        Mapping::Uv { set } if set >= object.uv_sets => {
            let what = format!(
                "object \"{}\" has no TEXCOORD_{set} (sets of texture coordinates that it has: {})",
                object.name, object.uv_sets
            );
            let help = "another `uv`, a mesh that is exported with texture coordinates, or a `capture` \
                        camera to project the cube from";
            Err(refuse(scene, source, "cube.uv", what, help))
        }
        _ => Ok(()),
    }
}

/// Pulses of different quantities cannot light one surface: their sum would measure neither.
fn check_pulses(scene: &Scene, pulses: &[usize], object: &PlannedObject) -> Result<()> {
    let mut sources = pulses.iter().map(|p| &scene.sources[*p]);
    let Some(first) = sources.next() else {
        return Ok(());
    };
    match sources.find(|s| s.quantity != first.quantity) {
        None => Ok(()),
        Some(other) => {
            let what = format!(
                "lights object \"{}\" with another quantity than source \"{}\"",
                object.name, first.name
            );
            let help = "pulses on one surface must declare the same quantity and wavelength";
            Err(refuse(scene, other, "radiance", what, help))
        }
    }
}

fn refuse(
    scene: &Scene,
    source: &Source,
    key: &str,
    what: String,
    help: impl Into<String>,
) -> Error {
    let place = format!("source \"{}\", {key}", source.name);
    Problem::new(&scene.name, place, what, help)
        .labelled(
            scene.text.as_str().into(),
            source.span.clone(),
            "this source",
        )
        .invalid()
}
