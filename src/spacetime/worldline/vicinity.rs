//! The stretch of constant proper acceleration around one state, for intersection with very many light cones.
//!
//! In the frame comoving at the state, let the apex of a past light cone be at time T, a along the
//! acceleration g and X⊥ across it, and spacelike from the state: r² = a² + X⊥² − T² > 0. With
//!
//! ```text
//! h = ½ g r²,   S² = X⊥² + (a + h)²,   w = S + T
//! ```
//!
//! the roots of [`super::cone`] (there I = −r² and b = T + h) are t + x∥ = −r²/(w + h) and
//! t − x∥ = −r²/(w − h), so that the cone crosses the line at
//!
//! ```text
//! t = −r² w/(w² − h²),   x∥ = r² h/(w² − h²),
//! ```
//!
//! as long as w > h: for T = 0, until 1 + ga = 0, the horizon. If T < 0, w is (r² + h(2a + h))/(S − T), so that nothing cancels unless a
//! horizon is near.

use glam::DVec3;

use super::state::State;
use crate::spacetime::{CameraFrame, Displacement, World};

/// The part of a world line around a state along which its proper acceleration is constant.
#[derive(Debug, Clone, Copy)]
pub struct Vicinity {
    near: State,
    g: f64,
    n: DVec3,
    /// t + x∥ at its beginning, in the comoving frame.
    begin: f64,
}

impl Vicinity {
    /// The vicinity of `near`, from proper time `elapsed` ≤ 0 relative to it.
    pub(super) fn new(near: State, elapsed: f64) -> Self {
        let g = near.thrust.g;
        Vicinity {
            near,
            g,
            n: near.thrust.n,
            // On the line t + x∥ = (e^(gτ) − 1)/g, which is τ without acceleration.
            begin: match g > 0.0 && elapsed > f64::NEG_INFINITY {
                true => libm::expm1(g * elapsed) / g,
                false => elapsed,
            },
        }
    }

    /// The crossing of the line and the past light cone of the event at `apex`, both relative to the state in the comoving frame; `None`
    /// beyond a horizon, or before the acceleration changed. `square` is r² = |x|² − t² > 0 of the apex, which may be more accurate from
    /// other frames.
    #[inline(always)]
    pub fn crossing(
        &self,
        apex: Displacement<CameraFrame>,
        square: f64,
    ) -> Option<Displacement<CameraFrame>> {
        let (crossing, crosses) = self.crossing_or_not(apex, square);
        crosses.then_some(crossing)
    }

    /// The same, and whether it exists, without a branch, for loops.
    #[inline(always)]
    pub fn crossing_or_not(
        &self,
        apex: Displacement<CameraFrame>,
        square: f64,
    ) -> (Displacement<CameraFrame>, bool) {
        // a, X⊥², h, S and w in the head of this file.
        let along = self.n.dot(apex.x);
        let across = (apex.x - self.n * along).length_squared();
        let h = 0.5 * self.g * square;
        let s = (across + (along + h) * (along + h)).sqrt();
        // Both of its forms, so that loops have no branch.
        let (sum, quotient) = (
            s + apex.ct,
            (square + h * (2.0 * along + h)) / (s - apex.ct),
        );
        let w = if apex.ct >= 0.0 { sum } else { quotient };
        // t = −r² w/(w² − h²) and x∥ = r² h/(w² − h²).
        let scale = square / ((w - h) * (w + h));
        let (ct, ahead) = (-w * scale, h * scale);
        // Not beyond the horizon, not infinitely far, and not before the acceleration began.
        let crosses = (w > h) & (scale < f64::INFINITY) & (ct + ahead >= self.begin);
        (Displacement::new(ct, self.n * ahead), crosses)
    }

    /// Transforms a displacement of the comoving frame by `ct` and `x` = n x∥, as returned by [`Vicinity::crossing`], to the world.
    #[inline(always)]
    pub fn in_world(&self, crossing: Displacement<CameraFrame>) -> Displacement<World> {
        let ahead = self.n.dot(crossing.x);
        self.near.ahead * crossing.ct + self.near.aside * ahead
    }
}
