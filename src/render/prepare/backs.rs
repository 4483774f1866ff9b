//! The backs of surfaces.

use crate::mesh::Material;
use crate::render::plan::{Lit, lit_by};
use crate::scene::model::{BackFaces, CubeBacks, Mapping, Scene, SourceKind};

/// The backs of surfaces.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Backs {
    /// The same as their fronts.
    Same,
    /// Absent.
    Culled,
    Black,
}

/// The backs of `material` in `scene`.
pub(super) fn backs(scene: &Scene, material: &Material) -> Backs {
    // Glass is visible from inside.
    if scene.bounces > 0 && material.transmission > 0.0 {
        return Backs::Same;
    }
    match scene.back_faces {
        BackFaces::AsFile if material.double_sided => Backs::Same,
        BackFaces::AsFile | BackFaces::Culled => Backs::Culled,
        BackFaces::TwoSided => Backs::Same,
        BackFaces::Black => Backs::Black,
    }
}

/// The backs of `material` of object `object`: for a cube that contains only fronts, visible backs are black.
pub(super) fn backs_of(scene: &Scene, object: usize, material: &Material) -> Backs {
    let holds_fronts = || {
        let Lit::Cube(source) = lit_by(scene, object, &material.name) else {
            return false;
        };
        let SourceKind::Cube(cube) = &scene.sources[source].kind else {
            return false;
        };
        let black = CubeBacks::Black;
        matches!(cube.mapping, Mapping::Uv { backs, .. } if backs == black)
    };
    match backs(scene, material) {
        Backs::Same if holds_fronts() => Backs::Black,
        backs => backs,
    }
}
