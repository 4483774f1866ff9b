//! Which quarters of a block a triangle may affect: of 8 × 8 pixels, 4 × 4 each.
//!
//! If triangles are small, a leaf has several that some ray of the block may hit, and each affects few of the rays. So all triangles of
//! such a leaf are tested against the directions of each quarter at once.
//!
//! **(Q1)** Let the directions of a quarter be within hᵢ of their midpoint cᵢ along each axis. U of [`setup`](super::setup), for rays that share
//! their origin, is d·p ≤ c·p + h·|p|. If the sum of that and B is below zero, U + B is negative for all rays of the quarter, and none of them
//! hits; likewise V and W. As for a whole block, h is widened by 2⁻²⁰ of |d|∞ for the rounding errors of both sides.

use super::block::SPREAD;
use super::ray_set::RAYS;
use super::setup::{LeafTriangles, absolute, lane3};
use super::simd::{Eight, Simd, load_vectors};
use crate::accel::float::power_of_two;
use crate::accel::wide::WIDTH;

/// The number of quarters.
pub(super) const QUARTERS: usize = 4;
/// The rays in each: two vectors of eight.
pub(super) const PER_QUARTER: usize = RAYS / QUARTERS;
/// All quarters, as bits.
pub(super) const ALL: u8 = (1 << QUARTERS) - 1;

/// Directions of each quarter: their middle and half-width per axis.
#[derive(Clone, Copy)]
pub(super) struct Quarters {
    middle: [[f32; QUARTERS]; 3],
    half: [[f32; QUARTERS]; 3],
}

impl Quarters {
    /// The quarters of a block with these directions.
    #[inline(always)]
    pub fn of<K: Eight>(k: K, directions: &[[f32; RAYS]; 3]) -> Quarters {
        let mut quarters = Quarters {
            middle: [[0.0; QUARTERS]; 3],
            half: [[0.0; QUARTERS]; 3],
        };
        let zero = k.splat(0.0);
        let mut axis = 0;
        while axis < 3 {
            // The minimum of d and of −d.
            let (mut least, mut greatest) = ([zero; QUARTERS], [zero; QUARTERS]);
            let mut at = 0;
            while at < QUARTERS {
                let d = k.load(&directions[axis][at * PER_QUARTER..]);
                let e = k.load(&directions[axis][at * PER_QUARTER + K::LANES..]);
                least[at] = k.min(d, e);
                greatest[at] = k.sub(zero, k.max(d, e));
                at += 1;
            }
            let (least, greatest) = (k.smallest_of_each(least), k.smallest_of_each(greatest));
            at = 0;
            while at < QUARTERS {
                let (lo, hi) = (least[at] * 0.5, greatest[at] * -0.5);
                quarters.middle[axis][at] = lo + hi;
                // |d|∞ in a block is at most `SPREAD`: (Q1).
                quarters.half[axis][at] = (hi - lo) + power_of_two(-20) as f32 * SPREAD;
                at += 1;
            }
            axis += 1;
        }
        quarters
    }

    /// Stores, for each of `triangles`, the quarters in which rays may hit it; triangles that no ray may hit are dropped as candidates.
    #[inline(always)]
    pub fn narrow<K: Simd>(&self, k: K, triangles: &mut LeafTriangles) {
        // A bit per triangle, in a byte per quarter.
        let mut hit = [u32::MAX; QUARTERS];
        let zero = k.splat(0.0);
        let mut edge = 0;
        while edge < 3 {
            let p = load_vectors(k, &triangles.edge_normals[edge], 0);
            let size = absolute(k, &p);
            let slack = k.load(&triangles.slack[edge]);
            let mut at = 0;
            while at < QUARTERS {
                // The maximum of U + B over the quarter: c·p + h·|p| + B.
                let most = k.dot(&lane3(k, &self.middle, at), &p, slack);
                let most = k.dot(&lane3(k, &self.half, at), &size, most);
                hit[at] &= k.le(zero, most);
                at += 1;
            }
            edge += 1;
        }
        let (mut bytes, mut any, mut at) = (0, 0, 0);
        while at < QUARTERS {
            bytes |= u64::from(hit[at] as u8) << (WIDTH * at);
            any |= hit[at];
            at += 1;
        }
        triangles.quarters = transposed(bytes).to_le_bytes();
        // (Q1) assumes one σ: triangles whose σ is uncertain stay.
        triangles.candidates &= any | !triangles.certain;
    }
}

/// Bit j of byte i becomes bit i of byte j (Warren, Hacker's Delight, 7-3).
#[inline(always)]
fn transposed(x: u64) -> u64 {
    // Swaps single bits, pairs and fours across the diagonal.
    let moved = (x ^ (x >> 7)) & 0x00aa_00aa_00aa_00aa;
    let x = x ^ moved ^ (moved << 7);
    let moved = (x ^ (x >> 14)) & 0x0000_cccc_0000_cccc;
    let x = x ^ moved ^ (moved << 14);
    let moved = (x ^ (x >> 28)) & 0x0000_0000_f0f0_f0f0;
    x ^ moved ^ (moved << 28)
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::accel::packet::method::{Kernel, Precision, Traversal};
    use crate::accel::{Bvh, Facing, Origins, numbers};

    #[test]
    fn triangles_as_small_as_pixels_are_hit_in_every_quarter() {
        // Triangles in a curved sheet, about as wide as two of the 16 × 16 pixels.
        const SIDE: usize = 24;
        let corner = |i: usize, j: usize| {
            let [x, y] = [i, j].map(|k| k as f64 / SIDE as f64 * 2.4 - 1.2);
            DVec3::new(x, y, -3.0 + 0.3 * (2.0 * x + y).sin())
        };
        let mut triangles = Vec::new();
        for (i, j) in (0..SIDE).flat_map(|i| (0..SIDE).map(move |j| (i, j))) {
            let (a, b) = (corner(i, j), corner(i + 1, j));
            let (c, d) = (corner(i, j + 1), corner(i + 1, j + 1));
            triangles.extend([[a, b, c], [d, c, b]]);
        }
        let bvh = Bvh::build(triangles, |_| Facing::TwoSided);
        let mut next = numbers(17);
        for shot in 0..40 {
            let origin = DVec3::new(next(), next(), next()) * 0.3;
            let directions: Vec<DVec3> = (0..256)
                .map(|pixel| {
                    let [x, y] = [pixel % 16, pixel / 16].map(|k| (k as f64 - 7.5) / 8.0 * 0.3);
                    DVec3::new(x + next() * 0.02, y + next() * 0.02, -1.0)
                })
                .collect();
            let trace = |kernel| {
                let method = Traversal {
                    kernel,
                    precision: Precision::Certified,
                };
                let mut hits = vec![None; directions.len()];
                let from = Origins::Shared(origin);
                bvh.closest_by(method, from, &directions, &mut hits, None, None);
                hits
            };
            let expected = trace(Kernel::Scalar);
            assert!(expected.iter().filter(|hit| hit.is_some()).count() > 200);
            for kernel in Kernel::ALL.into_iter().filter(|k| k.is_supported()) {
                assert!(trace(kernel) == expected, "{kernel:?}, shot {shot}");
            }
        }
    }

    #[test]
    fn bits_and_bytes_change_places() {
        for (byte, bit) in (0..8).flat_map(|byte| (0..8).map(move |bit| (byte, bit))) {
            let others = 0x8000_0000_0100_2000 & !(1 << (8 * byte + bit));
            let x = transposed(1 << (8 * byte + bit) | others);
            assert_eq!(
                x,
                1 << (8 * bit + byte) | transposed(others),
                "{byte}, {bit}"
            );
        }
        assert_eq!(transposed(0xff), 0x0101_0101_0101_0101);
    }
}
