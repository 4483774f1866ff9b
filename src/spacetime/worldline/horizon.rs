//! Where a rigid body behind an accelerating line ends, during a span of its time.
//!
//! A Born-rigid body that moves with the line has, in the comoving frame, the points p with 1 + a·p > 0, where a is the proper
//! acceleration: farther behind, nothing keeps its distance. In the axes that are boosted without rotation, in which p is constant, a
//! changes all the time.
//!
//! On circles, and where a is constant in a gyroscope's axes, a turns in one plane with a constant magnitude and in a constant sense. Along
//! an arc of less than half a turn, a·p is least where a is opposite to the part of p in that plane, if a comes by there, or else at one of the
//! ends. Constant acceleration turns by less than half a turn, however long it lasts: about a × v, at the rate of the Thomas precession
//! |a × U|/(1 + γ), where a × U is constant and γ = c cosh(|a|τ), with c² − 1 = (a × U)²/a², so that in all
//!
//! ```text
//! ∫ √(c² − 1)/(1 + c cosh φ) dφ = 4 atan √((c − 1)/(c + 1)) < π.
//! ```
//!
//! Elsewhere, where a differs by at most r from its value at the middle of a span, all of the span is safe if
//!
//! ```text
//! 1 + a·p > r |p|     in the middle;
//! ```
//!
//! otherwise both halves are examined. Each kind of line bounds r by the half length h of the span:
//!
//! ```text
//! linear in a gyroscope's axes:         r = (|s| + A min(A, |ω| + (|s| + 3/2 A²) h)) h
//! x(ct) with v = x′, w = x″, j = x‴:    below, from bounds on γ, |v|, |w|, |v·w| and the constant j
//! ```
//!
//! The first has the slope s, A = |a| + |s| h, and the Thomas precession ω = a × n tanh(φ/2) of the middle, for the velocity n tanh φ: with
//! |d(n tanh(φ/2))/dτ| ≤ |a|/2, |dω/dτ| ≤ (|s| + A²) + A²/2. Without it, motion along a straight line would need many more spans.
//!
//! The last is that of a = γ² w + g (v·w) v with g = γ⁴/(1 + γ), where dγ = γ³ (v·w) dct and dg/dγ = γ³ (4 + 3γ)/(1 + γ)².

use glam::DVec3;

/// The maximum numbers of halves that are examined, in all and for each span between nodes; where some are undecided then, the body is taken
/// to reach the horizon.
const MOST_HALVES: usize = 1 << 18;
const HALVES_OF_EACH: usize = 64;

/// The acceleration in the middle of a span, and by how much it differs from that within the span, at most.
#[derive(Debug, Clone, Copy)]
pub(super) struct Around {
    pub acceleration: DVec3,
    pub radius: f64,
}

/// Whether one of `points` lies at the horizon of an acceleration, or beyond it.
pub(super) fn is_reached(acceleration: DVec3, points: &[DVec3]) -> bool {
    points.iter().any(|p| 1.0 + acceleration.dot(*p) <= 0.0)
}

/// As [`super::WorldLine::beyond_horizon`], between the parameters `from` and `to` of a line. `around` is given the middle and half the
/// length of a span that contains none of `nodes`, which ascend; it returns `None` where the line has no state.
pub(super) fn beyond(
    [from, to]: [f64; 2],
    nodes: impl Iterator<Item = f64>,
    points: &[DVec3],
    around: impl Fn(f64, f64) -> Option<Around>,
) -> Option<DVec3> {
    let mut begin = from;
    let ends = nodes.filter(|node| from < *node && *node < to).chain([to]);
    let spans = ends.map(|end| [std::mem::replace(&mut begin, end), end]);
    let mut spans: Vec<_> = spans.collect();
    // All spans before their halves, so that what is plainly beyond is found first.
    let mut left = MOST_HALVES.max(HALVES_OF_EACH * spans.len());
    loop {
        let (mut halves, mut undecided) = (Vec::new(), None);
        for [from, to] in spans {
            let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
            let around = around(middle, half).filter(|around| around.acceleration.is_finite());
            let Some(Around {
                acceleration,
                radius,
            }) = around
            else {
                continue;
            };
            if is_reached(acceleration, points) {
                return Some(acceleration);
            }
            let is_safe = |p: &DVec3| 1.0 + acceleration.dot(*p) > radius * p.length();
            if !points.iter().all(is_safe) {
                undecided = undecided.or(Some(acceleration));
                halves.extend([[from, middle], [middle, to]]);
            }
        }
        if halves.len() > left || halves.is_empty() {
            return undecided;
        }
        left -= halves.len();
        spans = halves;
    }
}

/// The same while the acceleration turns from `first` to `last`, right-handed about `axis` (of any length, 0 if it does not turn) and by
/// less than half a turn.
pub(super) fn beyond_arc(
    [first, last]: [DVec3; 2],
    axis: DVec3,
    points: &[DVec3],
) -> Option<DVec3> {
    // Perpendicular to `first` whatever the rounding errors of a short axis.
    let along = first.normalize_or_zero();
    let n = (axis - along * along.dot(axis)).normalize_or_zero();
    let opposite = |p: &DVec3| {
        let q = (n * n.dot(*p) - *p).normalize_or_zero();
        let comes_by = n.dot(first.cross(q)) > 0.0 && n.dot(q.cross(last)) > 0.0;
        comes_by.then(|| q * first.length())
    };
    let all = points.iter().filter_map(opposite).chain([first, last]);
    all.filter(|a| a.is_finite())
        .find(|a| is_reached(*a, points))
}

/// The acceleration on a path x(ct) with these derivatives in the middle of a span of world time.
pub(super) fn on_path([v, w, jerk]: [DVec3; 3], half: f64) -> Around {
    let acceleration = proper(v, w);
    let jerk = jerk.length();
    // The largest |w|, |v| and |v·w| of the span.
    let bend = w.length() + jerk * half;
    let speed = v.length() + bend * half;
    let rate = bend * bend + speed * jerk;
    let along = v.dot(w).abs() + rate * half;
    let radius = match speed < 1.0 {
        true => {
            let square = 1.0 / ((1.0 - speed) * (1.0 + speed));
            let gamma = square.sqrt();
            let cube = square * gamma;
            let g = square * square / (1.0 + gamma);
            let slope = cube * (4.0 + 3.0 * gamma) / (1.0 + gamma).powi(2);
            let of_bend = 2.0 * square * square * along * bend + square * jerk;
            let of_motion =
                slope * cube * along * along * speed + g * (rate * speed + along * bend);
            (of_bend + of_motion) * half
        }
        false if half > 0.0 => f64::INFINITY,
        false => 0.0,
    };
    Around {
        acceleration,
        radius,
    }
}

/// The proper acceleration γ² w + γ⁴/(1 + γ) (v·w) v of what moves with v = dx/dct and w = dv/dct.
pub(super) fn proper(v: DVec3, w: DVec3) -> DVec3 {
    let speed = v.length();
    let square = 1.0 / ((1.0 - speed) * (1.0 + speed));
    // γ² and γ⁴/(1 + γ) (v·w), the factors in a.
    let along = square * square / (1.0 + square.sqrt()) * v.dot(w);
    w * square + v * along
}

#[cfg(test)]
mod tests;
