//! Closest and any hits of rays with triangles at rest.
//!
//! Triangles and rays are f64, in metres relative to the origin of the rest frame. A tree of f32 boxes
//! passes over what a ray certainly misses (`slab`: the derivation of "certainly"); what remains
//! is decided in f64, and exactly where f64 is in doubt (`triangle`). Hence
//!
//! - a ray hits a triangle iff exact arithmetic on the given numbers says so; edges and corners belong
//!   to all triangles that share them, so closed meshes have no gaps;
//! - of equal parameters the smaller id wins, and every parameter is a function of ray and triangle
//!   alone: a hit depends neither on the tree nor on the order in which it is walked;
//! - rays that go nearly the same way, from one point or from points near one another, go in packets of as
//!   many as the processor has lanes ([`Kernel`]), and meet what they would meet singly, bit for bit; so do
//!   segments, of which only whether something blocks them is asked;
//! - nothing depends on the scale or the place of the scene, or on the length of a direction.
//!
//! Limits: coordinates up to 2³⁰⁰ m; directions of length 2⁻⁵⁰⁰ to 2⁵⁰⁰; origins up to 2¹⁰⁰ scene
//! sizes away. What is outside, or NaN, hits nothing. This is the only module that knows obvhs, and the
//! only way of a ray from f64 to f32.

#[doc = include_str!("guide.md")]
pub mod guide {}

mod build;
mod exact;
mod pack;
mod packet;
mod query;
mod rays;
mod single;
mod slab;
mod tally;
mod traverse;
mod triangle;
pub(crate) mod vectors;
mod wide;

use glam::DVec3;

pub use build::Preset;
pub use packet::{Kernel, Method, Precision};
pub use rays::{Facing, Hit, Origins, Ray, Segment};
pub use tally::{Counts, NoTally, Tally, Work};

use pack::Pack;
use query::Tag;
use slab::{Lattice, Node, exponent, power_of_two};
use wide::{Wide, WideTree};

/// A tree over triangles at rest.
#[derive(Debug, Clone)]
pub struct Bvh {
    /// Corners by slot.
    corners: Vec<[DVec3; 3]>,
    /// Ids by slot.
    tags: Vec<Tag>,
    nodes: Vec<Node>,
    /// Levels of nodes.
    depth: usize,
    /// The same tree for packets.
    wide: WideTree,
    lattice: Lattice,
    bounds: (DVec3, DVec3),
}

impl Bvh {
    /// Triangles with a coordinate beyond this, 2³⁰⁰ m, are never hit.
    pub const MAX_COORDINATE: f64 = f64::from_bits((1023 + 300) << 52);

    /// A tree holds no more triangles than these.
    pub const MAX_TRIANGLES: usize = 1 << 30;

    fn empty() -> Bvh {
        Bvh {
            corners: Vec::new(),
            tags: Vec::new(),
            nodes: Vec::new(),
            depth: 0,
            wide: WideTree::default(),
            lattice: Lattice::new(DVec3::ZERO, DVec3::ZERO),
            bounds: (DVec3::ZERO, DVec3::ZERO),
        }
    }

    /// How many triangles can be hit: those that were given, without the degenerate ones.
    pub fn len(&self) -> usize {
        self.corners.len()
    }

    /// Whether there is nothing to hit.
    pub fn is_empty(&self) -> bool {
        self.corners.is_empty()
    }

    /// Bytes that the tree holds.
    pub fn bytes(&self) -> usize {
        size_of::<Bvh>()
            + self.corners.capacity() * size_of::<[DVec3; 3]>()
            + self.tags.capacity() * size_of::<Tag>()
            + self.nodes.capacity() * size_of::<Node>()
            + self.wide.nodes.capacity() * size_of::<Wide>()
            + self.wide.packs.capacity() * size_of::<Pack>()
    }

    /// An upper estimate of [`Bvh::bytes`] for so many triangles.
    ///
    /// Packs of meshes hold five triangles or so, and nodes seven packs; three and six are allowed for, and a node of
    /// pairs for every second triangle.
    pub fn estimate_bytes(triangles: usize) -> usize {
        let pairs = size_of::<[DVec3; 3]>() + size_of::<Tag>() + size_of::<Node>() / 2;
        let wide = size_of::<Pack>() / 3 + size_of::<Wide>() / 18;
        triangles.saturating_mul(pairs + wide).saturating_add(
            size_of::<Bvh>() + size_of::<Node>() + size_of::<Wide>() + size_of::<Pack>(),
        )
    }

    /// Least and greatest coordinates of the triangles that can be hit, metres.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        (!self.is_empty()).then_some(self.bounds)
    }

    /// The corners of the triangle in `slot`, metres.
    pub fn corners(&self, slot: u32) -> [DVec3; 3] {
        self.corners[slot as usize]
    }

    /// The id of the triangle in `slot`, and which of its sides are there.
    pub fn triangle(&self, slot: u32) -> (u32, Facing) {
        let tag = self.tags[slot as usize];
        let facing = match tag.shows(false) {
            true => Facing::TwoSided,
            false => Facing::FrontOnly,
        };
        (tag.id(), facing)
    }

    /// The unit normal of the triangle that was hit, on the side from which its corners run
    /// counter-clockwise.
    pub fn normal(&self, hit: &Hit) -> DVec3 {
        let [a, b, c] = self.corners(hit.slot);
        let (e1, e2) = (b - a, c - a);
        // Equal powers of two leave the direction as it is and the squares within range.
        let size = e1.abs().max(e2.abs()).max_element();
        let scale = power_of_two(-exponent(size).clamp(-900, 900));
        (e1 * scale).cross(e2 * scale).normalize_or_zero()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::traverse::USUAL_DEPTH;

    #[test]
    fn a_tree_deeper_than_the_usual_stack_is_walked_with_a_longer_one() {
        let strip = |i: u32| {
            let x = f64::from(i);
            [DVec3::X * x, DVec3::X * x + DVec3::Y, DVec3::X * (x + 1.0)]
        };
        let mut bvh = Bvh::build((0..100).map(strip).collect(), |_| Facing::TwoSided);
        let ray = |x: f64| Ray {
            origin: DVec3::new(x + 0.25, 0.25, 1.0),
            direction: -DVec3::Z,
            s_min: 0.0,
        };
        bvh.depth = 10 * USUAL_DEPTH;
        for i in 0..100 {
            let hit = bvh.closest(&ray(f64::from(i)), f64::INFINITY);
            assert_eq!(hit.map(|h| h.triangle), Some(i));
        }
    }
}
