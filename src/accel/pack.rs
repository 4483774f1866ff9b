//! Up to eight triangles that lie together, in f32: what packets look at before the f64 corners.
//!
//! Corners are held relative to a centre of the pack, in the frame of the boxes, so that they are as exact
//! as the pack is small. How far they are off is known: the conversion's own error is measured, and
//! f64 adds less than 2⁻⁵⁰ before (differences and products with |y| ≤ 1).

use glam::DVec3;

use super::slab::{Lattice, power_of_two};
use super::wide::WIDTH;

/// Triangles, one per lane.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
pub(super) struct Pack {
    /// Per corner and axis; 0 where there is no triangle.
    pub corners: [[[f32; WIDTH]; 3]; 3],
    /// What corners are relative to.
    pub centre: [f32; 3],
    /// No coordinate is farther off than this.
    pub error: f32,
    /// The slot of the first triangle.
    pub first: u32,
    /// Triangles that there are, as bits.
    pub present: u32,
    /// Those that show their front only.
    pub front_only: u32,
}

impl Pack {
    /// The triangles with `corners`, which are at most eight, in slots from `first` on.
    pub fn new(lattice: &Lattice, corners: &[[DVec3; 3]], first: u32) -> Pack {
        let all = || {
            corners
                .as_flattened()
                .iter()
                .map(|&corner| lattice.place(corner))
        };
        let lo = all().fold(DVec3::INFINITY, DVec3::min);
        let hi = all().fold(DVec3::NEG_INFINITY, DVec3::max);
        let centre = ((lo + hi) * 0.5).as_vec3();
        let mut pack = Pack {
            corners: [[[0.0; WIDTH]; 3]; 3],
            centre: centre.to_array(),
            error: 0.0,
            first,
            present: (1 << corners.len()) - 1,
            front_only: 0,
        };
        let mut error = 0.0f64;
        for (at, corner) in all().enumerate() {
            let exact = corner - centre.as_dvec3();
            let kept = exact.as_vec3();
            error = error.max((kept.as_dvec3() - exact).abs().max_element());
            for axis in 0..3 {
                pack.corners[at % 3][axis][at / 3] = kept[axis];
            }
        }
        pack.error = (error + power_of_two(-50)) as f32 * (1.0 + f32::EPSILON);
        pack
    }
}
