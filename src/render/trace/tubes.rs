//! Which rest frames light paths between surfaces can meet at all.
//!
//! What rests in a frame within a sphere of radius r about c is, at the world time t, within r of x(t) = x₀ + β (t − t₀), with
//! (t₀, x₀) the world event of c at the frame's time 0: motion shortens, and lengthens nothing. Between two world times it
//! therefore stays in a box: the interval of each coordinate of x(t), and r on either side. Light paths of a bundle stay, in
//! the same times, in the box about their ends. Where the two boxes are apart, none of the paths meets the frame.

use glam::DVec3;

use super::rest_frame::RestFrame;
use crate::spacetime::Event;

/// More than all rounding: of a few products and sums of coordinates, each 2⁻⁵³ of them.
const SLACK: f64 = 1e-9;

/// Where the surfaces of each rest frame are in the world, by coordinate: x(0), β, r.
#[derive(Debug, Default)]
pub(super) struct Tubes {
    at_zero: [Vec<f64>; 3],
    beta: [Vec<f64>; 3],
    radius: Vec<f64>,
}

/// A box about light paths of the world, and the times in which they pass it, metres.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bundle {
    lo: DVec3,
    hi: DVec3,
    times: [f64; 2],
}

impl Tubes {
    /// Those of `rests`.
    pub fn of<'a>(rests: impl Iterator<Item = &'a RestFrame>) -> Tubes {
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

    /// Whether a path of `bundle` may meet frame `k`.
    #[inline(always)]
    pub fn may_meet(&self, k: usize, bundle: &Bundle) -> bool {
        let [from, to] = bundle.times;
        let mut apart = false;
        for axis in 0..3 {
            let (at_zero, beta) = (self.at_zero[axis][k], self.beta[axis][k]);
            let (a, b) = (at_zero + beta * from, at_zero + beta * to);
            let margin = self.radius[k] + SLACK * (a.abs() + b.abs());
            // In this form not for NaN.
            apart |= a.max(b) + margin < bundle.lo[axis];
            apart |= a.min(b) - margin > bundle.hi[axis];
        }
        !apart
    }
}

impl Bundle {
    /// No path.
    pub const NONE: Bundle = Bundle {
        lo: DVec3::INFINITY,
        hi: DVec3::NEG_INFINITY,
        times: [f64::INFINITY, f64::NEG_INFINITY],
    };

    /// Adds the path from the event (`ct`, `x`) over the way `along`, on which light takes `delay`. Both may be infinite.
    #[inline(always)]
    pub fn add(&mut self, ct: f64, x: DVec3, along: DVec3, delay: f64) {
        // 0 · ∞, of a coordinate in which the path does not move.
        let end = x + DVec3::select(along.is_nan_mask(), DVec3::ZERO, along);
        self.lo = self.lo.min(x.min(end));
        self.hi = self.hi.max(x.max(end));
        self.times[0] = self.times[0].min(ct - delay);
        self.times[1] = self.times[1].max(ct);
    }

    /// With more room than all rounding of it takes.
    pub fn widened(self) -> Bundle {
        let margin = |a: f64, b: f64| match a.abs().max(b.abs()) {
            size if size.is_finite() => SLACK * size,
            _ => 0.0,
        };
        let size = self.lo.abs().max(self.hi.abs());
        let room = DVec3::from_array(size.to_array().map(|size| margin(size, 0.0)));
        let [from, to] = self.times;
        Bundle {
            lo: self.lo - room,
            hi: self.hi + room,
            times: [from - margin(from, to), to + margin(from, to)],
        }
    }
}
