//! Which rest frames light paths between surfaces can hit.
//!
//! Objects that rest in a frame within a sphere of radius r about c are, at the world time t, within r of x(t) = x₀ + β (t − t₀), with (t₀,
//! x₀) the world event of c at the frame's time 0: motion contracts lengths and never stretches them. Between two world times they
//! therefore stay in a box: the interval of each coordinate of x(t), extended by r on either side. The light paths of a bundle stay, during
//! the same times, in the box about their ends. If the two boxes are disjoint, none of the paths hits the frame.

use glam::DVec3;

use super::rest_frame::RestFrame;
use crate::spacetime::Event;

/// Relative enlargement of boxes: 10⁷ times the rounding error, 2⁻⁵³ each, of the few products and sums that compute them.
const SLACK: f64 = 1e-9;

/// The regions of the world where the surfaces of each rest frame are, by coordinate: x(0), β, r.
#[derive(Debug, Default)]
pub(super) struct Tubes {
    at_zero: [Vec<f64>; 3],
    beta: [Vec<f64>; 3],
    radius: Vec<f64>,
}

/// A box around light paths in the world, and the range of times of these paths, metres.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bundle {
    lo: DVec3,
    hi: DVec3,
    times: [f64; 2],
}

impl Tubes {
    /// The tubes of `rests`.
    pub fn of(rests: &[RestFrame]) -> Tubes {
        let mut tubes = Tubes::default();
        for rest in rests {
            // An empty frame is nowhere.
            let (lo, hi) = rest.bvh.bounds().unwrap_or((DVec3::NAN, DVec3::NAN));
            let event = rest.frame.event_to_world(Event::new(0.0, (lo + hi) * 0.5));
            let beta = rest.frame.velocity().beta();
            let at_zero = event.x - beta * event.ct;
            let size = lo.abs().max(hi.abs()).max_element();
            let rounding = SLACK * (size + event.x.length() + 2.0 * event.ct.abs());
            tubes.radius.push((hi - lo).length() * 0.5 + rounding);
            for axis in 0..3 {
                tubes.at_zero[axis].push(at_zero[axis]);
                tubes.beta[axis].push(beta[axis]);
            }
        }
        tubes
    }

    /// Whether a path of `bundle` may hit frame `k`.
    #[inline(always)]
    pub fn may_meet(&self, k: usize, bundle: &Bundle) -> bool {
        let [from, to] = bundle.times;
        let mut apart = false;
        for axis in 0..3 {
            let (at_zero, beta) = (self.at_zero[axis][k], self.beta[axis][k]);
            let (a, b) = (at_zero + beta * from, at_zero + beta * to);
            let margin = self.radius[k] + SLACK * (a.abs() + b.abs());
            // False for NaN.
            apart |= a.max(b) + margin < bundle.lo[axis];
            apart |= a.min(b) - margin > bundle.hi[axis];
        }
        !apart
    }
}

impl Bundle {
    /// A bundle without paths.
    pub const NONE: Bundle = Bundle {
        lo: DVec3::INFINITY,
        hi: DVec3::NEG_INFINITY,
        times: [f64::INFINITY, f64::NEG_INFINITY],
    };

    /// Adds the path from the event (`ct`, `x`) along the displacement `along`, for which light takes `delay`. Both may be infinite.
    #[inline(always)]
    pub fn add(&mut self, ct: f64, x: DVec3, along: DVec3, delay: f64) {
        // 0 · ∞, for a coordinate along which the path does not move.
        let end = x + DVec3::select(along.is_nan_mask(), DVec3::ZERO, along);
        self.lo = self.lo.min(x.min(end));
        self.hi = self.hi.max(x.max(end));
        self.times[0] = self.times[0].min(ct - delay);
        self.times[1] = self.times[1].max(ct);
    }

    /// The same, with a margin for the rounding of its coordinates.
    pub fn widened(self) -> Bundle {
        let room = |a: f64| if a.is_finite() { SLACK * a.abs() } else { 0.0 };
        let [lo, hi] = [self.lo, self.hi].map(|corner| corner.to_array());
        let [from, to] = self.times;
        Bundle {
            lo: DVec3::from_array(lo.map(|a| a - room(a))),
            hi: DVec3::from_array(hi.map(|a| a + room(a))),
            times: [from - room(from), to + room(to)],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::{Bvh, Facing, Ray, numbers};
    use crate::spacetime::{Direction, InertialFrame, NullRay, Velocity};

    #[test]
    fn what_light_meets_is_never_taken_for_apart() {
        let mut next = numbers(11);
        let mut vector = || DVec3::new(next(), next(), next());
        let (mut met, mut apart) = (0, 0);
        for round in 0..20_000 {
            let rapidity = [0.0, 0.5, 2.0, 8.0][round % 4];
            let centre = vector() * 2.0;
            let corners = [(); 3].map(|()| centre + vector());
            let velocity = Velocity::from_rapidity(vector() * rapidity).unwrap();
            let rest = RestFrame {
                frame: InertialFrame::new(velocity, Event::new(vector().x, vector())),
                bvh: Bvh::build(vec![corners], |_| Facing::TwoSided),
                normals: Default::default(),
                patches: Vec::new(),
                meshes: Default::default(),
                vertices: Default::default(),
            };
            let d = vector().normalize();
            // Every other ray leads to a point of the body, the others anywhere.
            let at = rest
                .frame
                .event_to_world(Event::new(vector().x, centre + vector() * 0.3));
            let (ct, x) = match round % 2 {
                0 => (vector().x * 3.0, vector() * 3.0),
                _ => (at.ct + 2.0, at.x - d * 2.0),
            };
            let distance = [1.0, 5.0, f64::INFINITY][round % 3];
            let ray = NullRay::new(Event::new(ct, x), Direction::from_unit(d), 1.0);
            let local = rest
                .frame
                .ray_from_world(ray.origin, Direction::from_unit(d), 1.0);
            let ray = Ray {
                origin: local.origin.x,
                direction: local.tangent.x,
                s_min: 0.0,
            };
            let is_met = rest.bvh.closest(&ray, distance).is_some();
            let mut bundle = Bundle::NONE;
            bundle.add(ct, x, d * distance, distance);
            let may = Tubes::of(std::slice::from_ref(&rest)).may_meet(0, &bundle.widened());
            assert!(
                may || !is_met,
                "round {round}: {rest:?} is met from {x} along {d}"
            );
            met += usize::from(is_met);
            apart += usize::from(!may);
        }
        assert!(met > 200 && apart > 2000, "{met} met, {apart} apart");
    }
}
