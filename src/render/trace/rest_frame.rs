//! Static meshes in the frame in which they rest.

use glam::DVec2;

use crate::accel::{Bvh, Hit};
use crate::mesh::Mesh;
use crate::spacetime::{Event, InertialFrame, Rest};

/// Everything at rest in one inertial frame.
#[derive(Debug)]
pub struct RestFrame {
    /// The frame; its origin is that of its first object.
    pub frame: InertialFrame<Rest>,
    /// All triangles, in rest-frame coordinates relative to the frame's origin.
    pub bvh: Bvh,
    /// Runs of triangles that look alike, ascending by first triangle.
    pub patches: Vec<Patch>,
    /// Per object of the frame: triangles and texture coordinates, where something needs them.
    pub meshes: Vec<Mesh>,
}

/// A run of triangles of one object with one emitter.
#[derive(Debug, Clone, PartialEq)]
pub struct Patch {
    /// First triangle (index in the frame's BVH).
    pub first: u32,
    /// Index of the object in the scene.
    pub object: u32,
    /// Index into [`RestFrame::meshes`].
    pub mesh: u32,
    /// Triangle of the frame's BVH that is triangle 0 of the object.
    pub object_first: u32,
    /// The object's origin event in the frame: subtract it for the object's own coordinates.
    pub object_origin: Event<Rest>,
    /// Index into the emitters.
    pub emitter: u32,
    /// Whether the back face is black.
    pub black_back: bool,
}

impl RestFrame {
    /// The patch that triangle `triangle` belongs to.
    #[inline]
    pub fn patch(&self, triangle: u32) -> &Patch {
        self.patch_and_end(triangle).0
    }

    /// The same, and the first triangle after it.
    #[inline]
    pub(super) fn patch_and_end(&self, triangle: u32) -> (&Patch, u32) {
        let after = self.patches.partition_point(|p| p.first <= triangle);
        let after = after.max(1);
        let end = self.patches.get(after).map_or(u32::MAX, |next| next.first);
        (&self.patches[after - 1], end)
    }

    /// Texture coordinates of set `set` at a hit on `patch`, where the object has them.
    #[inline(always)]
    pub(super) fn uv(&self, patch: &Patch, set: usize, hit: &Hit) -> Option<DVec2> {
        let mesh = self.meshes.get(patch.mesh as usize)?;
        mesh.uv(set, hit.triangle - patch.object_first, [hit.u, hit.v])
    }
}
