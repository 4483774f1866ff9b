//! Tree space: the coordinates of the tree's boxes.
//!
//! y = (x − c)·k with c the centre of the geometry and k a power of two for which |y| ≤ 1. Results computed in it depend neither on the
//! scale of the scene nor on its position.

use glam::DVec3;

use super::float::{exponent, power_of_two};

/// The map from the rest frame to tree space.
#[derive(Debug, Clone, Copy)]
pub(super) struct TreeSpace {
    /// c, metres.
    pub centre: DVec3,
    /// k, per metre.
    pub scale: f64,
    /// The box of everything in tree space, widened by 2⁻³⁰.
    pub lo: DVec3,
    pub hi: DVec3,
}

impl TreeSpace {
    /// The map for geometry within `lo` and `hi`, |coordinates| ≤ 2³⁰⁰.
    pub fn new(lo: DVec3, hi: DVec3) -> TreeSpace {
        let centre = lo * 0.5 + hi * 0.5;
        let half = (hi - centre).max(centre - lo).max_element();
        // half < 2^(e + 1), e its exponent. The clamp keeps k and 1/k normal if the geometry is a point.
        let scale = power_of_two(-(exponent(half).clamp(-400, 400) + 1));
        let margin = DVec3::splat(power_of_two(-30));
        TreeSpace {
            centre,
            scale,
            lo: (lo - centre) * scale - margin,
            hi: (hi - centre) * scale + margin,
        }
    }

    /// An upper bound on the distance of corners from the centre, metres.
    #[inline(always)]
    pub fn radius(&self) -> f64 {
        0.5 * (self.hi - self.lo).length() / self.scale
    }

    /// `point`, given in metres, in tree space.
    #[inline(always)]
    pub fn map(&self, point: DVec3) -> DVec3 {
        (point - self.centre) * self.scale
    }

    /// The f32 box around `corners`: each bound moves outward by at least half an f32 ulp more than conversion to nearest can move it
    /// inward, which covers the preceding rounding errors in f64.
    pub fn bounds(&self, [a, b, c]: &[DVec3; 3]) -> ([f32; 3], [f32; 3]) {
        let lo = self.map(a.min(*b).min(*c));
        let hi = self.map(a.max(*b).max(*c));
        (
            lo.to_array().map(|y| (y as f32).next_down()),
            hi.to_array().map(|y| (y as f32).next_up()),
        )
    }
}
