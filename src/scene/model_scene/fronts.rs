//! When the light of a flash is seen on a model.

use glam::DVec3;

use super::motion::Motion;
use super::subject::Subject;

/// The front of a flash that leaves its lamp at time 0; for parallel light, the front through the origin at time 0.
pub(super) enum Front {
    Sphere(DVec3),
    Plane(DVec3),
}

impl Front {
    /// The time when it reaches `point`.
    pub(super) fn arrival(&self, point: DVec3) -> f64 {
        match self {
            Front::Sphere(place) => point.distance(*place),
            Front::Plane(direction) => point.dot(*direction),
        }
    }
}

/// The part of a flash that a film shows.
pub(super) struct Show<'a> {
    pub(super) sources: &'a [Front],
    /// How long before the front the film begins, and how long after it the film ends.
    pub(super) dawn: f64,
    pub(super) fades: f64,
    /// The time when the front reaches the middle of the model.
    pub(super) middle: f64,
}

/// When a camera is at a place, and the world times, relative to that moment, at which it sees the first and the last light of the side of a model towards it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Span {
    pub(super) zero: f64,
    pub(super) first: f64,
    pub(super) last: f64,
}

/// Steps of the search for the middle of a film, each of which leaves a tenth of the distance or less.
const STEPS: usize = 6;

impl Show<'_> {
    /// The film of a camera that is at `eye` in the middle of it; a camera at rest is always there, and sees at `zero` the light that left
    /// the middle of the model with the front.
    pub(super) fn span(&self, subject: &Subject, eye: DVec3, motion: Option<&Motion>) -> Span {
        let seen = self.middle + eye.distance(subject.ball.centre);
        let mut span = self.span_about(subject, eye, motion, seen);
        if motion.is_none() {
            return span;
        }
        // By secants: the later the camera is there, the earlier relative to that it sees the light.
        let middle = |span: &Span| 0.5 * (span.first + span.last);
        let mut slope = -1.0;
        for _ in 0..STEPS {
            let next = self.span_about(subject, eye, motion, span.zero - middle(&span) / slope);
            let secant = (middle(&next) - middle(&span)) / (next.zero - span.zero);
            slope = if secant < 0.0 { secant } else { slope };
            span = next;
        }
        span
    }

    /// The film of a camera that is at `eye` at the world's time `zero`.
    ///
    /// Let E be the camera's position relative to the point at that moment, a the time of emission after that moment, and q the delay. The
    /// camera sees the light at E + βn(q + a). With F = E + βna, the solution of q² = |F + βnq|² is q = γ²(βF·n + √(β²(F·n)² + F²/γ²)).
    fn span_about(
        &self,
        subject: &Subject,
        eye: DVec3,
        motion: Option<&Motion>,
        zero: f64,
    ) -> Span {
        let seen = |point: DVec3, time: f64| {
            let after = time - zero;
            let (beta, gamma, n) = motion.map_or((0.0, 1.0, DVec3::X), |m| (m.beta, m.gamma, m.n));
            let from = eye - point + n * (beta * after);
            let along = beta * from.dot(n);
            let root = (along * along + from.length_squared() / (gamma * gamma)).sqrt();
            // Avoids cancellation for either sign.
            let delay = match along < 0.0 {
                true => from.length_squared() / (root - along),
                false => gamma * gamma * (along + root),
            };
            after + delay
        };
        let mut span = [f64::INFINITY, f64::NEG_INFINITY];
        // The far side is not seen.
        let centre = subject.ball.centre;
        let is_near = |point: &&DVec3| (**point - centre).dot(eye - centre) >= 0.0;
        for point in subject.outline.iter().filter(is_near) {
            for source in self.sources {
                let front = source.arrival(*point);
                span[0] = span[0].min(seen(*point, front - self.dawn));
                span[1] = span[1].max(seen(*point, front + self.fades));
            }
        }
        let [first, last] = span;
        Span { zero, first, last }
    }
}
