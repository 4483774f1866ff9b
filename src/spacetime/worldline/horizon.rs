//! Where a rigid body behind an accelerating line ends, during a span of its time.
//!
//! A Born-rigid body that moves with the line has, in the comoving frame, the points p with 1 + a·p > 0, where a is the proper
//! acceleration: farther behind, nothing keeps its distance. In the axes that are boosted without rotation, in which p is constant, a
//! changes all the time. Where it differs by at most r from its value at the middle of a span, all of the span is safe if
//!
//! ```text
//! 1 + a·p > r |p|     in the middle;
//! ```
//!
//! otherwise both halves are examined. Each kind of line bounds r by the half length h of the span:
//!
//! ```text
//! constant in a gyroscope's axes:       r = |a|² h              (Thomas precession is slower than |a|)
//! linear there, with the slope s:       r = (|s| + (|a| + |s| h)²) h
//! a circle at Ω in world time:          r = |a| |Ω| γ h
//! x(ct) with v = x′, w = x″, j = x‴:    below, from bounds on γ, |v|, |w|, |v·w| and the constant j
//! ```
//!
//! The last is that of a = γ² w + g (v·w) v with g = γ⁴/(1 + γ), where dγ = γ³ (v·w) dct and dg/dγ = γ³ (4 + 3γ)/(1 + γ)².

use glam::DVec3;

/// The maximum number of bisections of a span; what is still undecided then is as good as at the horizon.
const HALVINGS: u32 = 30;

/// The acceleration in the middle of a span, and by how much it differs from that within the span, at most.
#[derive(Debug, Clone, Copy)]
pub(super) struct Around {
    pub acceleration: DVec3,
    pub radius: f64,
}

/// An acceleration between the parameters `from` and `to` of a line beyond whose horizon one of `points` lies; `None` if there is none.
/// `around` is given the middle and half the length of a span that contains none of `nodes`, which ascend; it returns `None` where the
/// line has no state.
pub(super) fn beyond(
    [from, to]: [f64; 2],
    nodes: impl Iterator<Item = f64>,
    points: &[DVec3],
    around: impl Fn(f64, f64) -> Option<Around>,
) -> Option<DVec3> {
    let inner = nodes.filter(|node| from < *node && *node < to);
    let mut begin = from;
    inner.chain([to]).find_map(|end| {
        let span = [begin, end];
        begin = end;
        within(span, points, &around, HALVINGS)
    })
}

fn within(
    [from, to]: [f64; 2],
    points: &[DVec3],
    around: &impl Fn(f64, f64) -> Option<Around>,
    halvings: u32,
) -> Option<DVec3> {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let Around {
        acceleration,
        radius,
    } = around(middle, half).filter(|around| around.acceleration.is_finite())?;
    let left = |p: &DVec3| 1.0 + acceleration.dot(*p);
    if points.iter().any(|p| left(p) <= 0.0) {
        return Some(acceleration);
    }
    if points.iter().all(|p| left(p) > radius * p.length()) {
        return None;
    }
    match halvings {
        0 => Some(acceleration),
        _ => within([from, middle], points, around, halvings - 1)
            .or_else(|| within([middle, to], points, around, halvings - 1)),
    }
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
mod tests {
    use super::*;
    use crate::spacetime::worldline::{Axes, Segment, WorldLine};
    use crate::spacetime::{Event, Velocity};

    fn lines() -> Vec<(WorldLine, f64)> {
        let event = |ct: f64, x: f64, y: f64, z: f64| Event::new(ct, DVec3::new(x, y, z));
        let events = [
            event(0.0, 0.0, 0.0, 0.0),
            event(1.0, 0.3, -0.4, 0.5),
            event(1.7, 0.1, 0.0, 0.7),
            event(3.0, -0.4, 0.6, 0.2),
        ];
        let velocity = Velocity::from_beta(DVec3::new(0.4, -0.3, 0.6)).unwrap();
        let zero = event(0.5, 1.0, 0.0, 0.0);
        let (a, b) = (DVec3::new(0.9, 0.2, -0.5), DVec3::new(-0.3, 1.4, 0.8));
        let segment = |duration, acceleration| Segment {
            duration,
            acceleration,
        };
        let segments = [segment(1.0, a), segment(1.5, b)];
        let knots = [(0.0, a), (1.0, b), (3.0, a)];
        let profile = |axes| WorldLine::profile(velocity, zero, &knots, axes).unwrap();
        let circle = WorldLine::circular(zero, DVec3::new(0.2, 0.1, 0.0), DVec3::Z, -0.9);
        vec![
            (WorldLine::keyframes(&events).unwrap(), 1.5),
            (WorldLine::animation(&events, true).unwrap(), 4.0),
            (WorldLine::segments(velocity, zero, &segments).unwrap(), 3.0),
            (profile(Axes::Gyroscope), 2.9),
            (profile(Axes::World), 2.9),
            (circle.unwrap(), 5.0),
        ]
    }

    /// At the reciprocal of the strongest pull in a direction, found among many states, the horizon is just not reached or just reached.
    #[test]
    fn the_horizon_is_found_at_the_strongest_pull_of_a_dense_sample() {
        let directions = [
            DVec3::X,
            DVec3::new(-0.6, 0.0, 0.8),
            DVec3::new(0.48, -0.6, -0.64),
            DVec3::NEG_Y,
        ];
        for (which, (line, end)) in lines().into_iter().enumerate() {
            // Fine enough for the ends of an animation's corners, which take a fiftieth of a metre.
            let count = 400_000;
            let state = |i: i32| line.state(end * f64::from(i) / f64::from(count)).unwrap();
            let accelerations: Vec<DVec3> = (0..=count).map(|i| state(i).acceleration).collect();
            for n in directions {
                let pulls = accelerations.iter().map(|a| a.dot(-n));
                let strongest = pulls.fold(0.0, f64::max);
                if strongest == 0.0 {
                    continue;
                }
                let found = |reach: f64| {
                    let points = [n * (reach / strongest), n * (0.5 * reach / strongest)];
                    line.beyond_horizon([0.0, end], &points)
                };
                assert_eq!(found(0.999), None, "line {which}, {n}");
                let a = found(1.001).unwrap();
                assert!(a.dot(-n) >= 0.998 * strongest, "line {which}, {n}");
            }
        }
    }
}
