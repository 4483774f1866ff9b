//! What the backs of surfaces are like.

use crate::mesh::Material;
use crate::scene::model::{BackFaces, Scene};

/// What the backs of surfaces are like.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Backs {
    /// As their fronts.
    Same,
    /// Not there.
    Culled,
    Black,
}

/// The backs of `material` in `scene`.
pub(super) fn backs(scene: &Scene, material: &Material) -> Backs {
    // Glass is seen from within.
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
