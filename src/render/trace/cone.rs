//! Which rest frames a batch of rays can hit at all.
//!
//! An object within a sphere of radius r about c, seen from the origin of its rest frame, has look directions d′ with d′·ĉ ≥ cos α, sin α =
//! r/|c|. With past-directed null vectors k′ = ω (−1, d′) this is
//!
//! ```text
//! k′·N′ ≥ 0,   N′ = (−cos α, ĉ),   signature (−, +, +, +),
//! ```
//!
//! and holds in every frame (Penrose, "The apparent shape of a relativistically moving sphere", 1959). With N boosted to the world, the
//! directions d again form a cone, with axis N_x and half-angle a, where
//!
//! ```text
//! |N_x| cos a = −N_ct,   |N_x| sin a = sin α,   since   N_x² − N_ct² = N′² = sin² α.
//! ```
//!
//! Directions within an angle b of a central direction m miss the sphere if m is farther than a + b from the axis:
//!
//! ```text
//! N_x·m < |N_x| cos(a + b) = −N_ct cos b − sin α sin b,
//! ```
//!
//! as long as a + b < π, that is, sin α cos b − N_ct sin b > 0.
//!
//! Light in a medium is not null, and rays with their own origins share no event: neither is culled.

use glam::DVec3;

use super::rest_frame::RestFrame;
use crate::spacetime::{Displacement, Event, Rest, World};

/// A bound on all rounding errors: those of N are at most γ (1 + φ) times about 2⁻⁵⁰, with φ < 710.
const SLACK: f64 = 1e-11;

/// Added to sin α: the rounding errors of c and the box are about 2⁻⁵¹ of their coordinates, which are at most 10⁶ times their distance.
const ROUNDING: f64 = 1e-9;

/// The directions in which a rest frame is visible from one event: N, sin α and the slack.
#[derive(Debug, Clone, Copy)]
pub(super) struct VisibleCone {
    normal: Displacement<World>,
    sine: f64,
    slack: f64,
}

impl VisibleCone {
    /// `None` if any direction may hit something, or if nothing is known.
    pub fn of(rest: &RestFrame, camera: Event<Rest>, index: f64) -> Option<VisibleCone> {
        // The sphere about the bounding box: centre c relative to the camera, radius half the diagonal.
        let (lo, hi) = rest.bvh.bounds()?;
        let centre = (lo + hi) * 0.5 - camera.x;
        let distance = centre.length();
        let sine = (hi - lo).length() * 0.5 / distance * (1.0 + ROUNDING) + ROUNDING;
        // False for NaN, too.
        if !(sine < 1.0 && index == 1.0) {
            return None;
        }
        // N′ = (−cos α, ĉ), boosted to the world.
        let cosine = ((1.0 - sine) * (1.0 + sine)).sqrt();
        let normal = Displacement::new(-cosine, centre / distance);
        let normal = rest.frame.world_from_frame().displacement(normal);
        Some(VisibleCone {
            normal,
            sine,
            slack: SLACK * rest.frame.velocity().gamma(),
        })
    }

    /// Whether no ray of `bounds` can hit anything.
    #[inline]
    pub fn misses(&self, bounds: &DirectionBounds) -> bool {
        let DirectionBounds {
            middle,
            cosine,
            sine,
        } = bounds;
        // Both with a margin for rounding; false for NaN.
        let farthest = -self.normal.ct * cosine - self.sine * sine;
        let is_below_pi = self.sine * cosine - self.normal.ct * sine > self.slack;
        is_below_pi & (self.normal.x.dot(*middle) < farthest - self.slack)
    }
}

impl VisibleCone {
    /// Puts the indices of those `directions` that may hit something into `chosen`.
    pub fn choose(&self, directions: &[DVec3], chosen: &mut Vec<u32>) {
        chosen.clear();
        chosen.resize(directions.len(), 0);
        let least = -self.slack - self.normal.ct;
        let mut count = 0;
        for (ray, d) in directions.iter().enumerate() {
            // NaN counts as a possible hit, too.
            let misses = self.normal.x.dot(*d) < least;
            chosen[count] = ray as u32;
            count += usize::from(!misses);
        }
        chosen.truncate(count);
    }
}

/// A cone that contains a set of directions.
#[derive(Debug, Clone, Copy)]
pub(super) struct DirectionBounds {
    middle: DVec3,
    /// Cosine of the angle, which is below 90°; NaN if it is not.
    cosine: f64,
    sine: f64,
}

impl DirectionBounds {
    /// The bounds of a set of unit vectors.
    pub fn of(directions: &[DVec3]) -> DirectionBounds {
        let sum = directions.iter().fold(DVec3::ZERO, |sum, d| sum + *d);
        let middle = sum.normalize_or_zero();
        let square = |d: &DVec3| (*d - middle).length_squared();
        let largest = directions.iter().map(square).fold(0.0, f64::max);
        // The chord 2 sin(b/2), enlarged by more than its rounding error.
        let chord = largest.sqrt() * (1.0 + 1e-9);
        let cosine = 1.0 - 0.5 * chord * chord;
        let sine = chord * (1.0 - 0.25 * chord * chord).sqrt();
        let is_narrow = middle != DVec3::ZERO && cosine > 0.0;
        DirectionBounds {
            middle,
            cosine: if is_narrow { cosine } else { f64::NAN },
            sine,
        }
    }
}

#[cfg(test)]
mod tests;
