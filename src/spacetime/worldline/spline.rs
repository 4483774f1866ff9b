//! The natural cubic spline x(ct) through events, and a bound on its speed.
//!
//! The second derivatives M at the knots solve, with h the time from knot to knot,
//!
//! ```text
//! hᵢ₋₁ Mᵢ₋₁ + 2 (hᵢ₋₁ + hᵢ) Mᵢ + hᵢ Mᵢ₊₁ = 6 (Δxᵢ/hᵢ − Δxᵢ₋₁/hᵢ₋₁),    M = 0 at both ends.
//! ```
//!
//! On a span |v|² is a polynomial of degree 4. Its coefficients in Bernstein's basis bound it from above; bisecting the span tightens the
//! bound as far as needed to prove that the curve is slower than light.
//!
//! Source: e.g. Stoer and Bulirsch, Introduction to Numerical Analysis, 2.4; Farin, Curves and Surfaces for
//! CAGD, for Bernstein's basis.

use glam::{DVec3, DVec4};

use super::error::{MAX_KEYFRAME_SPEED, WorldLineError};
use super::series::{Piece, Series};
use crate::spacetime::{Event, World};

/// The maximum number of bisections of a span to prove that it is slower than light; if they are not enough, the proof fails.
const HALVINGS: u32 = 40;

/// The spline through `events`, which must ascend in time, with world time as parameter.
pub(super) fn natural(events: &[Event<World>]) -> Result<Series, WorldLineError> {
    let bends = second_derivatives(events);
    let mut series = Series {
        parameters: events.iter().map(|e| e.ct).collect(),
        events: events.to_vec(),
        ..Series::default()
    };
    let mut spans = Vec::new();
    for index in 0..events.len() - 1 {
        let way = events[index + 1] - events[index];
        let coefficients = span(way.ct, way.x, bends[index], bends[index + 1]);
        series.pieces.push(Piece {
            centre: index,
            scale: way.ct,
            first: series.coefficients.len(),
            count: coefficients.len(),
        });
        // World time is linear in u.
        let times = [way.ct, 0.0, 0.0];
        let with_time = coefficients.iter().zip(times).map(|(c, t)| c.extend(t));
        series
            .coefficients
            .extend::<Vec<DVec4>>(with_time.collect());
        spans.push(Span {
            index,
            start: events[index].ct,
            time: way.ct,
            coefficients,
        });
    }
    check_speed(&spans)?;
    Ok(series)
}

/// c₁, c₂, c₃ of x − x₀ in u = (ct − ct₀)/h.
fn span(h: f64, dx: DVec3, m0: DVec3, m1: DVec3) -> [DVec3; 3] {
    // In units of 6/h²: c₂ = M₀ h²/2 and c₃ = (M₁ − M₀) h²/6.
    let (m0, m1) = (m0 * (h * h / 6.0), m1 * (h * h / 6.0));
    [dx - m0 * 2.0 - m1, m0 * 3.0, m1 - m0]
}

/// d²x/dct² at each event: elimination in the tridiagonal system, which is stable as its diagonal dominates.
fn second_derivatives(events: &[Event<World>]) -> Vec<DVec3> {
    let mut bends = vec![DVec3::ZERO; events.len()];
    // Row i means Mᵢ = right − above · Mᵢ₊₁.
    let mut above = vec![0.0; events.len()];
    for i in 1..events.len() - 1 {
        let (before, after) = (events[i] - events[i - 1], events[i + 1] - events[i]);
        // Row i minus hᵢ₋₁ times the solved row i − 1.
        let pivot = 2.0 * (before.ct + after.ct) - before.ct * above[i - 1];
        let jump = (after.x / after.ct - before.x / before.ct) * 6.0;
        above[i] = after.ct / pivot;
        bends[i] = (jump - bends[i - 1] * before.ct) / pivot;
    }
    // Back substitution from the last: Mₙ = 0.
    for i in (1..events.len() - 1).rev() {
        let next = bends[i + 1];
        bends[i] -= next * above[i];
    }
    bends
}

/// The cubic from one event to the next.
pub(super) struct Span {
    /// The index of the event at its beginning.
    pub index: usize,
    /// Its world time at the beginning, and the time that it takes.
    pub start: f64,
    pub time: f64,
    /// c₁, c₂, c₃ of x − x₀ in u.
    pub coefficients: [DVec3; 3],
}

/// Refuses a curve that is not slower than light, reporting the fastest of its spans.
pub(super) fn check_speed(spans: &[Span]) -> Result<(), WorldLineError> {
    let too_fast = spans
        .iter()
        .filter(|span| !is_slow(span.velocity(), HALVINGS));
    let fastest = too_fast
        .map(|span| (span, fastest(span.velocity())))
        .reduce(|a, b| if b.1.1 > a.1.1 { b } else { a });
    let Some((span, (u, speed))) = fastest else {
        return Ok(());
    };
    Err(WorldLineError::Superluminal {
        index: span.index,
        ct: span.start + span.time * u,
        speed,
    })
}

impl Span {
    /// Whether its velocity is constant.
    pub fn is_straight(&self) -> bool {
        self.coefficients[1..] == [DVec3::ZERO; 2]
    }

    /// The Bernstein coefficients of the velocity c₁ + 2c₂u + 3c₃u², over h.
    fn velocity(&self) -> [DVec3; 3] {
        let [c1, c2, c3] = self.coefficients.map(|c| c / self.time);
        [c1, c1 + c2, c1 + c2 * 2.0 + c3 * 3.0]
    }
}

/// Whether the velocity with Bernstein coefficients `v` (degree 2) is below the limit everywhere.
fn is_slow(v: [DVec3; 3], halvings: u32) -> bool {
    // |v|² is bounded by its largest Bernstein coefficient of degree 4.
    let limit = MAX_KEYFRAME_SPEED * MAX_KEYFRAME_SPEED;
    let [a, b, c] = v;
    let middle = (a.dot(c) + 2.0 * b.dot(b)) / 3.0;
    let bounds = [a.dot(a), a.dot(b), middle, b.dot(c), c.dot(c)];
    if bounds.iter().all(|bound| *bound <= limit) {
        return true;
    }
    if halvings == 0 {
        return false;
    }
    // De Casteljau.
    let (ab, bc) = ((a + b) * 0.5, (b + c) * 0.5);
    let half = (ab + bc) * 0.5;
    is_slow([a, ab, half], halvings - 1) && is_slow([half, bc, c], halvings - 1)
}

/// The position in [0, 1] of the highest speed, and that speed, for the message: by sampling, then by ternary search around the best
/// sample.
fn fastest([a, b, c]: [DVec3; 3]) -> (f64, f64) {
    if a == b && b == c {
        return (0.0, a.length());
    }
    let speed = |u: f64| (a.lerp(b, u)).lerp(b.lerp(c, u), u).length();
    let sample = |i: u32| f64::from(i) / 64.0;
    let best = (0..=64)
        .map(sample)
        .fold(0.0, |best, u| if speed(u) > speed(best) { u } else { best });
    let (mut low, mut high) = ((best - sample(1)).max(0.0), (best + sample(1)).min(1.0));
    // (2/3)⁶⁰ of a thirty-second is below 10⁻¹²; so near its maximum the speed itself does not change any more.
    for _ in 0..60 {
        let third = (high - low) / 3.0;
        if speed(low + third) < speed(high - third) {
            low += third;
        } else {
            high -= third;
        }
    }
    // At an end it may have a slope.
    let ends = [0.0, 1.0].into_iter();
    let found = ends.fold(0.5 * (low + high), |best, u| {
        match speed(u) >= speed(best) {
            true => u,
            false => best,
        }
    });
    (found, speed(found))
}
