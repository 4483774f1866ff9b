//! The intersection of constant proper acceleration with a light cone, in closed form.
//!
//! In the frame comoving at the start, with proper acceleration g along n and z = e^(gτ), y = (z − 1)/g, the hyperbola of [`super::thrust`]
//! is simply t + x∥ = y and t − x∥ = y/z in light-cone coordinates. It crosses the past light cone of the event (T, X∥ = X, X⊥), p = T + X
//! and q = T − X, where (p − y)(q − y/z) = X⊥² with p ≥ y. With P = 1 + gp, Q = 1 − gq and I = T² − X² − X⊥² = pq − X⊥², that is
//!
//! ```text
//! Q y² − 2by + I = 0,    b = A + q/2,    A = ½ (pQ + g X⊥²),
//! Q z² − 2mz + P = 0,    m = ½ (1 + PQ + g²X⊥²),
//! ```
//!
//! whose roots have S = √(X⊥² + (A − q/2)²) in common, as b² − QI = S² and m² − QP = g²S². The retarded ones are
//!
//! ```text
//! y = I/(b + S) or (b − S)/Q,     z = P/(m + gS) or (m − gS)/Q,
//! ```
//!
//! the first forms for b, m > 0, and otherwise the second ones, so that terms of equal sign are added. Since p ≥ y and 1 + gy > 0, there is
//! a crossing exactly if P > 0: the hyperbola has a horizon, p = −1/g, and none of its light ever reaches events beyond it. For g → 0 this
//! becomes y = T − R, the crossing with a straight line. No exponential and no logarithm is needed; the proper time is ln z/g.
//!
//! Near the start y keeps its digits, and z = 1 + gy follows; far from it z does, and y = (z − 1)/g. P and Q are small differences near a
//! horizon, and are computed without rounding. Each coordinate is accurate to a few eps of the largest coordinate involved; if n is not
//! along an axis, or the start is not at rest in the world, rounding errors of X and X⊥ are magnified by 1/P or 1/Q near a horizon.
//!
//! Source: light-cone coordinates of a uniformly accelerated observer, e.g. Misner, Thorne, Wheeler, Gravitation,
//! ch. 6; the arrangement is ours.

use super::elapsed::{Elapsed, is_near};
use super::rounding::one_plus;
use super::state::{Crossing, State};
use super::thrust::Thrust;
use crate::spacetime::{CameraFrame, Displacement, World};

/// The crossing of the line through `near`, with its acceleration for ever, and the past light cone of the event at `offset` from there.
#[inline]
pub(super) fn past_cone(near: &State, offset: Displacement<World>) -> Option<Crossing> {
    let apex = near.frame().frame_from_world().displacement(offset);
    let light = crossed(near, apex, offset.interval())?;
    // From the comoving frame to the world, with the two basis vectors that matter.
    let (ct, along) = light.place(near.thrust.g);
    let moved = near.ahead * ct + near.aside * along;
    let start = near.proper_time;
    let elapsed = Elapsed {
        start,
        y: light.y,
        z: light.z,
        g: near.thrust.g,
    };
    let largest = moved.x.abs().max_element() + moved.ct.abs();
    (largest < f64::INFINITY).then(|| Crossing::new(near.event, moved, elapsed))
}

/// T − R: the proper time of the crossing with a line at rest. The interval is invariant, and keeps the digits of the world's coordinates.
#[inline]
fn straight(apex: Displacement<CameraFrame>, interval: f64) -> f64 {
    let distance = apex.x.length();
    if apex.ct > 0.0 {
        interval / (apex.ct + distance)
    } else {
        apex.ct - distance
    }
}

/// A point of a hyperbola in light-cone coordinates.
struct Light {
    /// t + x∥.
    y: f64,
    /// e^(gτ).
    z: f64,
    /// t − x∥.
    minus: f64,
}

impl Light {
    /// t and x∥.
    #[inline]
    fn place(&self, g: f64) -> (f64, f64) {
        let Light { y, z, minus } = *self;
        let along = match is_near(z) {
            // Near the start the two nearly cancel: x∥ = ½ (y − y/z) = ½ g y (y/z), as z = 1 + gy.
            true => 0.5 * g * y * minus,
            false => 0.5 * (y - minus),
        };
        (0.5 * (y + minus), along)
    }
}

/// The apex of a light cone in light-cone coordinates.
struct Apex {
    t: f64,
    along: f64,
    /// X⊥².
    across: f64,
    /// I.
    interval: f64,
}

/// The crossing with a straight line or a hyperbola, `None` beyond its horizon, for an apex in the frame comoving at `near`, and its
/// interval, which may be more accurate in the world's coordinates.
#[inline]
fn crossed(near: &State, apex: Displacement<CameraFrame>, interval: f64) -> Option<Light> {
    let Thrust { g, n, .. } = near.thrust;
    if g == 0.0 {
        let y = straight(apex, interval);
        return Some(Light {
            y,
            z: 1.0,
            minus: y,
        });
    }
    // T, X∥ and X⊥² of the apex.
    let (t, along) = (apex.ct, n.dot(apex.x));
    let across = (apex.x - n * along).length_squared();
    let apex = Apex {
        t,
        along,
        across,
        interval,
    };
    if g * (t.abs() + along.abs()) < CLOSE {
        Some(apex.close(g))
    } else {
        apex.far(g)
    }
}

/// g (|T| + |X∥|) below which no horizon is near, and neither P nor Q is a small difference.
const CLOSE: f64 = 0.125;

impl Apex {
    #[inline]
    fn close(&self, g: f64) -> Light {
        let (p, q) = (self.t + self.along, self.t - self.along);
        let big_q = 1.0 - g * q;
        // A, A − q/2 and S; P and Q are not small differences here.
        let half = 0.5 * (p * big_q + g * self.across);
        let skew = half - 0.5 * q;
        let s = (self.across + skew * skew).sqrt();
        self.through(self.y(half + 0.5 * q, s, big_q), g)
    }

    /// The root y of b, S and Q, as a fraction.
    #[inline]
    fn y(&self, b: f64, s: f64, big_q: f64) -> (f64, f64) {
        if b > 0.0 {
            (self.interval, b + s)
        } else {
            (b - s, big_q)
        }
    }

    /// The point at y = `over`/`under`.
    #[inline]
    fn through(&self, (over, under): (f64, f64), g: f64) -> Light {
        let y = over / under;
        Light {
            y,
            z: 1.0 + g * y,
            // y/z, independent of both divisions.
            minus: over / (under + g * over),
        }
    }

    #[inline(never)]
    fn far(&self, g: f64) -> Option<Light> {
        let (p, q) = (self.t + self.along, self.t - self.along);
        let big_p = one_plus(g, self.t, self.along);
        let big_q = one_plus(-g, self.t, -self.along);
        if big_p.is_nan() || big_p <= 0.0 {
            return None;
        }
        let (product, lift) = (big_p * big_q, 0.5 * g * self.across);
        let half = 0.5 * p * big_q + lift;
        // A − q/2 = ½ (PQ − 1)/g + ½ g X⊥²: with a small P and a large Q this difference is more accurate.
        let skew = if (g * q).abs() > 1.0 {
            0.5 * (product - 1.0) / g + lift
        } else {
            half - 0.5 * q
        };
        let s = (self.across + skew * skew).sqrt();
        let light = self.through(self.y(half + 0.5 * q, s, big_q), g);
        // Near the start y has the digits; far from it z does.
        if is_near(light.z) {
            return Some(light);
        }
        let m = 0.5 * (1.0 + product) + g * lift;
        let (over, under) = if m > 0.0 {
            (big_p, m + g * s)
        } else {
            (m - g * s, big_q)
        };
        Some(Light {
            y: (over / under - 1.0) / g,
            z: over / under,
            minus: (1.0 - under / over) / g,
        })
    }
}
