//! Which rest frames a batch of rays can hit at all.
//!
//! What lies within a sphere of radius r about c, seen from the origin of its rest frame, has look directions
//! d′ with d′·ĉ ≥ cos α, sin α = r/|c|. With past-directed null vectors k′ = ω (−1, d′) this is
//!
//! ```text
//! k′·N′ ≥ 0,   N′ = (−cos α, ĉ),   signature (−, +, +, +),
//! ```
//!
//! and holds in every frame (Penrose, "The apparent shape of a relativistically moving sphere", 1959). With
//! N boosted to the world, directions d within ρ of a middle m miss the sphere if
//!
//! ```text
//! N_ct + N_x·m + ρ |N_x| < 0,   since   k·N = N_ct + N_x·d.
//! ```
//!
//! Light in a medium is not null, and rays with origins of their own share no event: neither is culled.

use glam::DVec3;

use super::rest_frame::RestFrame;
use crate::spacetime::{Displacement, Event, Rest, World};

/// More than all rounding: of N at most γ (1 + φ) times some 2⁻⁵⁰, with φ < 710.
const SLACK: f64 = 1e-11;

/// The directions in which a rest frame is seen from one event: N, |N_x| and the slack.
#[derive(Debug, Clone, Copy)]
pub(super) struct VisibleCone {
    normal: Displacement<World>,
    length: f64,
    slack: f64,
}

impl VisibleCone {
    /// None where every direction may hit something, or nothing is known.
    pub fn of(rest: &RestFrame, camera: Event<Rest>, index: f64) -> Option<VisibleCone> {
        // The sphere about the bounding box: centre c from the camera, radius half the diagonal.
        let (lo, hi) = rest.bvh.bounds()?;
        let centre = (lo + hi) * 0.5 - camera.x;
        let distance = centre.length();
        // sin α, and more than the rounding of c and of the box.
        let sine = (hi - lo).length() * 0.5 / distance * (1.0 + 1e-9) + 1e-9;
        // Not for NaN either.
        if !(sine < 1.0 && index == 1.0) {
            return None;
        }
        // N′ = (−cos α, ĉ), boosted to the world.
        let cosine = ((1.0 - sine) * (1.0 + sine)).sqrt();
        let normal = Displacement::new(-cosine, centre / distance);
        let normal = rest.frame.world_from_frame().displacement(normal);
        Some(VisibleCone {
            normal,
            length: normal.x.length(),
            slack: SLACK * rest.frame.velocity().gamma(),
        })
    }

    /// Whether no ray of `bounds` can hit anything.
    #[inline]
    pub fn misses(&self, bounds: &DirectionBounds) -> bool {
        // N_ct + N_x·m + ρ |N_x|, which is below 0 by more than rounding.
        let most = self.normal.ct + self.normal.x.dot(bounds.middle) + bounds.radius * self.length;
        most < -self.slack
    }
}

/// Directions about a middle.
#[derive(Debug, Clone, Copy)]
pub(super) struct DirectionBounds {
    middle: DVec3,
    /// The largest distance of a unit vector from the middle.
    radius: f64,
}

impl DirectionBounds {
    /// Of unit vectors.
    pub fn of(directions: &[DVec3]) -> DirectionBounds {
        let sum = directions.iter().fold(DVec3::ZERO, |sum, d| sum + *d);
        let middle = sum / directions.len().max(1) as f64;
        let square = |d: &DVec3| (*d - middle).length_squared();
        let largest = directions.iter().map(square).fold(0.0, f64::max);
        DirectionBounds {
            middle,
            radius: largest.sqrt() * (1.0 + 1e-9),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::{Bvh, Facing, Ray};
    use crate::spacetime::{Direction, InertialFrame, Velocity};

    /// Numbers from −1 to 1.
    fn numbers(mut state: u64) -> impl FnMut() -> f64 {
        move || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1);
            (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        }
    }

    fn vector(next: &mut impl FnMut() -> f64) -> DVec3 {
        DVec3::new(next(), next(), next())
    }

    /// A triangle that moves with a rapidity of up to `rapidity` per axis.
    fn body(next: &mut impl FnMut() -> f64, rapidity: f64) -> RestFrame {
        let centre = vector(next) * 3.0;
        let corners = [(); 3].map(|()| centre + vector(next));
        let velocity = Velocity::from_rapidity(vector(next) * rapidity).unwrap();
        RestFrame {
            frame: InertialFrame::new(velocity, Event::new(next(), vector(next))),
            bvh: Bvh::build(vec![corners], |_| Facing::TwoSided),
            patches: Vec::new(),
            meshes: Vec::new(),
            vertices: Default::default(),
        }
    }

    /// How many bodies were met, and how many of those not met were known to be missed.
    fn count(rapidity: f64) -> [usize; 2] {
        let next = &mut numbers(7);
        let mut counts = [0; 2];
        for _ in 0..20_000 {
            let rest = body(next, rapidity);
            let camera = rest
                .frame
                .event_from_world(Event::new(next(), vector(next)));
            let towards = vector(next).normalize();
            let directions: Vec<_> = (0..16)
                .map(|_| (towards + vector(next) * 0.02).normalize())
                .collect();
            let met = directions.iter().any(|d| {
                let d = Direction::from_unit(*d);
                let ray = Ray {
                    origin: camera.x,
                    direction: rest.frame.frame_from_world().tangent(1.0, d).x,
                    s_min: 0.0,
                };
                rest.bvh.closest(&ray, f64::INFINITY).is_some()
            });
            let cone = VisibleCone::of(&rest, camera, 1.0);
            let missed = cone.is_some_and(|cone| cone.misses(&DirectionBounds::of(&directions)));
            assert!(!(met && missed), "{rest:?} is met along {towards}");
            counts[usize::from(!met)] += usize::from(met || missed);
        }
        counts
    }

    #[test]
    fn what_is_met_is_never_taken_for_missed() {
        for rapidity in [0.0, 1.0, 5.0, 20.0] {
            let [met, missed] = count(rapidity);
            assert!(met > 20, "{met} at {rapidity}");
            assert!(rapidity > 1.0 || missed > 10_000, "{missed} at {rapidity}");
        }
    }

    #[test]
    fn a_medium_lets_everything_pass() {
        let rest = body(&mut numbers(1), 0.3);
        let camera = Event::new(0.0, DVec3::splat(100.0));
        assert!(VisibleCone::of(&rest, camera, 1.0).is_some());
        assert!(VisibleCone::of(&rest, camera, 1.3).is_none());
    }
}
