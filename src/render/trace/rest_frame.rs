//! Static meshes in the frame in which they rest.

use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};
use std::sync::{Arc, OnceLock};

use glam::{DVec2, DVec3};

use crate::accel::pages::Pages;
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
    /// Unit normals by slot of the tree, if many points need them; otherwise empty.
    pub(crate) normals: Pages<DVec3>,
    /// Runs of triangles with the same appearance, ascending by first triangle.
    pub patches: Vec<Patch>,
    /// By object of the frame: triangles, texture coordinates and vertex normals, if needed.
    pub meshes: Arc<[Mesh]>,
    /// The corners without repetitions, computed on first use.
    pub(crate) vertices: OnceLock<SharedVertices>,
}

/// The corners of all triangles of a tree, without repetitions.
#[derive(Debug)]
pub(crate) struct SharedVertices {
    /// In metres, in the rest frame, in order of first use by slots.
    pub positions: Vec<DVec3>,
    /// By slot, the indices of its corners.
    pub corners: Vec<[u32; 3]>,
    /// By position, the length of the longest edge that ends there.
    pub longest: Vec<f64>,
}

impl SharedVertices {
    /// The bytes of its lists.
    pub fn bytes(&self) -> u64 {
        let lists = size_of_val::<[_]>(&self.positions)
            + size_of_val::<[_]>(&self.corners)
            + size_of_val::<[_]>(&self.longest);
        lists as u64
    }
}

/// A run of triangles of one object with one emitter.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Patch {
    /// First triangle (index in the frame's BVH).
    pub first: u32,
    /// Index of the object in the scene.
    pub object: u32,
    /// Index into [`RestFrame::meshes`].
    pub mesh: u32,
    /// Triangle of the frame's BVH that is triangle 0 of the object.
    pub object_first: u32,
    /// The object's origin event in the frame: subtract it to get the object's own coordinates.
    pub object_origin: Event<Rest>,
    /// Index into the emitters.
    pub emitter: u32,
    /// Whether the back face is black.
    pub black_back: bool,
}

impl SharedVertices {
    fn of(bvh: &Bvh) -> Self {
        let mut known = HashMap::with_capacity_and_hasher(bvh.len(), BuildPlaceHasher::default());
        let mut positions = Vec::new();
        let mut index = |corner: DVec3| {
            // By bits: 0 and −0 count as two, which costs only a vertex.
            let bits = corner.to_array().map(f64::to_bits);
            *known.entry(bits).or_insert_with(|| {
                positions.push(corner);
                positions.len() as u32 - 1
            })
        };
        let slots = 0..bvh.len() as u32;
        let corners: Vec<[u32; 3]> = slots
            .map(|slot| bvh.corners(slot).map(&mut index))
            .collect();
        let mut longest = vec![0.0f64; positions.len()];
        for [a, b, c] in &corners {
            for (from, to) in [(*a, *b), (*b, *c), (*c, *a)].map(|(a, b)| (a as usize, b as usize))
            {
                let length = positions[from].distance(positions[to]);
                longest[from] = longest[from].max(length);
                longest[to] = longest[to].max(length);
            }
        }
        SharedVertices {
            positions,
            corners,
            longest,
        }
    }
}

/// Builds [`PlaceHasher`]s.
pub(crate) type BuildPlaceHasher = BuildHasherDefault<PlaceHasher>;

/// A fast hash of a few words, without protection against adversaries.
#[derive(Default)]
pub(crate) struct PlaceHasher(u64);

impl Hasher for PlaceHasher {
    fn write(&mut self, bytes: &[u8]) {
        for word in bytes.chunks(8) {
            let mut padded = [0; 8];
            padded[..word.len()].copy_from_slice(word);
            self.write_u64(u64::from_ne_bytes(padded));
        }
    }

    #[inline]
    fn write_u64(&mut self, word: u64) {
        // Coordinates often end in zeros: mix the upper half of the product into the lower.
        let mixed = (self.0.rotate_left(23) ^ word).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        self.0 = mixed ^ (mixed >> 32);
    }

    fn finish(&self) -> u64 {
        self.0
    }
}

impl RestFrame {
    /// The corners of its triangles, without repetitions.
    pub(crate) fn shared_vertices(&self) -> &SharedVertices {
        self.vertices.get_or_init(|| SharedVertices::of(&self.bvh))
    }

    /// Unit normals of triangles by slot in the tree, on the side from which their corners run counter-clockwise; empty if few points need
    /// them.
    pub fn normals(&self) -> &[DVec3] {
        &self.normals
    }

    /// The patch that triangle `triangle` belongs to.
    #[inline]
    pub fn patch(&self, triangle: u32) -> &Patch {
        self.patch_and_end(triangle).0
    }

    /// The same, and the first triangle after it.
    #[inline]
    pub(super) fn patch_and_end(&self, triangle: u32) -> (&Patch, u32) {
        let is_begun = |patch: &Patch| patch.first <= triangle;
        // A few patches are searched linearly, without a branch that could be mispredicted.
        let after = match self.patches.len() {
            0..=16 => self.patches.iter().map(|p| usize::from(is_begun(p))).sum(),
            _ => self.patches.partition_point(is_begun),
        };
        let after = after.max(1);
        let end = self.patches.get(after).map_or(u32::MAX, |next| next.first);
        (&self.patches[after - 1], end)
    }

    /// Texture coordinates of set `set` at a hit on `patch`, if the object has them.
    #[inline(always)]
    pub(crate) fn uv(&self, patch: &Patch, set: usize, hit: &Hit) -> Option<DVec2> {
        let mesh = self.meshes.get(patch.mesh as usize)?;
        mesh.uv(set, hit.triangle - patch.object_first, [hit.u, hit.v])
    }

    /// The interpolated vertex normal at a hit on `patch`, a unit vector that points outward, if the object has them.
    #[inline]
    pub(super) fn vertex_normal(&self, patch: &Patch, hit: &Hit) -> Option<DVec3> {
        let mesh = self.meshes.get(patch.mesh as usize)?;
        mesh.normal(hit.triangle - patch.object_first, [hit.u, hit.v])
    }

    /// The interpolated vertex colour at a hit on `patch`, linear RGBA, if the object has them.
    #[inline]
    pub(super) fn vertex_colour(&self, patch: &Patch, hit: &Hit) -> Option<[f64; 4]> {
        let mesh = self.meshes.get(patch.mesh as usize)?;
        mesh.colour(hit.triangle - patch.object_first, [hit.u, hit.v])
    }
}
