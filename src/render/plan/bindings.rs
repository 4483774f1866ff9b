//! Which source lights which surface, and what has to be loaded of an object for it.

use super::PlannedObject;
use crate::scene::model::{Binding, Mapping, Scene, Source, SourceKind};

/// What gives a material of an object its radiance; indices of sources.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Lit {
    /// Its base colour.
    Base,
    /// A stored cube.
    Cube(usize),
    /// Pulses that it reflects.
    Pulses(Vec<usize>),
}

/// What lights material `material` of object `object`: a cube, else pulses, else its base colour.
pub fn lit_by(scene: &Scene, object: usize, material: &str) -> Lit {
    let bound = |s: &Source| match &s.binding {
        Binding::All => true,
        Binding::Only { objects, materials } => {
            objects.contains(&object)
                && (materials.is_empty() || materials.iter().any(|m| m == material))
        }
    };
    let mut pulses = Vec::new();
    for (index, source) in scene.sources.iter().enumerate().filter(|(_, s)| bound(s)) {
        match source.kind {
            SourceKind::Cube(_) => return Lit::Cube(index),
            SourceKind::Pulse(_) => pulses.push(index),
        }
    }
    if pulses.is_empty() {
        Lit::Base
    } else {
        Lit::Pulses(pulses)
    }
}

/// Which sources light anything.
pub(super) fn used_sources(scene: &Scene, objects: &[PlannedObject]) -> Vec<bool> {
    let mut used = vec![false; scene.sources.len()];
    for (index, object) in objects.iter().enumerate() {
        for material in &object.materials {
            match lit_by(scene, index, material) {
                Lit::Base => {}
                Lit::Cube(source) => used[source] = true,
                Lit::Pulses(sources) => sources.iter().for_each(|s| used[*s] = true),
            }
        }
    }
    used
}

/// Sets what is loaded of `object`, and from what it has its radiance.
pub(super) fn resolve(scene: &Scene, index: usize, object: &mut PlannedObject, wants_uv: bool) {
    object.uvs = wants_uv;
    for material in object.materials.clone() {
        let lit = lit_by(scene, index, &material);
        let (uvs, textures, radiance) = needs(scene, &lit, object.images > 0);
        object.uvs |= uvs;
        object.textures |= textures;
        if !object.radiance.contains(&radiance) {
            object.radiance.push(radiance);
        }
    }
}

fn needs(scene: &Scene, lit: &Lit, has_images: bool) -> (bool, bool, String) {
    let name = |s: &usize| scene.sources[*s].name.as_str();
    match lit {
        Lit::Base => (has_images, has_images, "base colour".into()),
        Lit::Pulses(pulses) => {
            let names: Vec<_> = pulses.iter().map(name).collect();
            (
                has_images,
                has_images,
                format!("base colour lit by {}", names.join(", ")),
            )
        }
        Lit::Cube(source) => {
            let SourceKind::Cube(cube) = &scene.sources[*source].kind else {
                return (false, false, String::new());
            };
            match cube.mapping {
                Mapping::Uv { set } => (
                    true,
                    false,
                    format!("{} by texture coordinates {set}", name(source)),
                ),
                Mapping::Capture(_) => (false, false, format!("{} by projection", name(source))),
            }
        }
    }
}
