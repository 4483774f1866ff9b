//! When the light of a flash is seen on a model.
//!
//! A film shows what a front lights of the surface that faces the camera. At distance r from a lamp of intensity I, a piece of surface has the
//! irradiance I cos θ / r². Pieces that would be black on the display in this light do not count, or the film would go on in the dark: so far
//! from the lamp, at so grazing angles, or beside its cone. Obstacles are ignored.

use glam::DVec3;

use super::motion::Motion;
use super::subject::{Piece, Subject};
use super::view::VIEWPOINT;
use crate::io::gltf::{GltfLight, GltfLightKind};

/// The front of a flash: a sphere about its lamp, or a plane that moves in this direction.
pub(super) enum Front {
    Sphere(DVec3),
    Plane(DVec3),
}

/// A lamp that flashes.
pub(super) struct Source {
    pub(super) front: Front,
    /// Power per solid angle; of parallel light, irradiance.
    pub(super) intensity: f64,
    /// The axis of its cone, and the cosine of the angle from it beyond which it is dark.
    pub(super) cone: Option<(DVec3, f64)>,
    /// When it flashes; of parallel light, when its front passes the origin.
    pub(super) time: f64,
}

impl Source {
    /// A lamp of a model that flashes at `time`.
    pub(super) fn of(light: &GltfLight, time: f64) -> Source {
        let intensity = light.intensity.iter().sum::<f64>() / 3.0;
        Source {
            front: match light.kind {
                GltfLightKind::Directional => Front::Plane(light.direction),
                _ => Front::Sphere(light.position),
            },
            intensity,
            cone: match light.kind {
                GltfLightKind::Spot { outer, .. } => Some((light.direction, libm::cos(outer))),
                _ => None,
            },
            time,
        }
    }

    /// A lamp that flashes at time 0 in all directions.
    pub(super) fn point(place: DVec3, intensity: f64) -> Source {
        Source {
            front: Front::Sphere(place),
            intensity,
            cone: None,
            time: 0.0,
        }
    }

    /// When its front reaches `point`.
    pub(super) fn arrival(&self, point: DVec3) -> f64 {
        self.time
            + match self.front {
                Front::Sphere(place) => point.distance(place),
                Front::Plane(direction) => point.dot(direction),
            }
    }

    /// The irradiance of a piece of surface.
    fn on(&self, piece: &Piece) -> f64 {
        let (towards, r2) = match self.front {
            Front::Sphere(place) => {
                let from = piece.point - place;
                (from.normalize_or_zero(), from.length_squared())
            }
            Front::Plane(direction) => (direction, 1.0),
        };
        let is_beside = |(axis, outer): (DVec3, f64)| axis.dot(towards) < outer;
        let cosine = -piece.normal.dot(towards);
        match self.cone.is_some_and(is_beside) || cosine <= 0.0 {
            true => 0.0,
            // A lamp on the surface itself.
            false => self.intensity * cosine / r2.max(f64::MIN_POSITIVE),
        }
    }
}

/// When the front of the first lamp and that of the last one reach a point of the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Lit {
    pub(super) point: DVec3,
    pub(super) first: f64,
    pub(super) last: f64,
}

/// The part of the surface, by area and of what is lit at all, that is brighter than white: the exposure of pictures.
const WHITE: f64 = 0.05;

impl Lit {
    /// What is lit of the surface that faces the camera, by no less than 1/`range` of white; without anything, the outline, and in front of it
    /// every lamp.
    pub(super) fn of(subject: &Subject, sources: &[Source], range: f64) -> Vec<Lit> {
        let received = |piece: &Piece| -> f64 { sources.iter().map(|s| s.on(piece)).sum() };
        let mut levels: Vec<(f64, f64)> = subject
            .seen
            .iter()
            .map(|piece| (received(piece), piece.area))
            .filter(|(level, _)| *level > 0.0)
            .collect();
        levels.sort_by(|a, b| b.0.total_cmp(&a.0));
        let whole: f64 = levels.iter().map(|(_, area)| area).sum();
        let mut brighter = 0.0;
        let white = levels.iter().find(|(_, area)| {
            brighter += area;
            brighter > WHITE * whole
        });
        let least = white.map_or(f64::INFINITY, |(level, _)| level / range);
        let lit = |piece: &Piece| {
            let counting = sources.iter().filter(|s| s.on(piece) >= least);
            Lit::by(piece.point, counting)
        };
        let lit: Vec<Lit> = subject.seen.iter().filter_map(lit).collect();
        if !lit.is_empty() {
            return lit;
        }
        // The far side is not seen.
        let centre = subject.ball.centre;
        let is_near = |point: &&DVec3| (**point - centre).dot(VIEWPOINT) >= 0.0;
        let near = subject.outline.iter().filter(is_near);
        near.filter_map(|point| Lit::by(*point, sources.iter()))
            .collect()
    }

    /// `None` without any source.
    fn by<'a>(point: DVec3, sources: impl Iterator<Item = &'a Source>) -> Option<Lit> {
        let times = sources.map(|source| source.arrival(point));
        let both = times
            .map(|t| [t, t])
            .reduce(|[a, b], [c, d]| [a.min(c), b.max(d)]);
        both.map(|[first, last]| Lit { point, first, last })
    }
}

/// The part of a flash that a film shows.
pub(super) struct Show<'a> {
    pub(super) lit: &'a [Lit],
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
        let mut span = self.span_about(eye, motion, seen);
        if motion.is_none() {
            return span;
        }
        // By secants: the later the camera is there, the earlier relative to that it sees the light.
        let middle = |span: &Span| 0.5 * (span.first + span.last);
        let mut slope = -1.0;
        for _ in 0..STEPS {
            let next = self.span_about(eye, motion, span.zero - middle(&span) / slope);
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
    fn span_about(&self, eye: DVec3, motion: Option<&Motion>, zero: f64) -> Span {
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
        for Lit { point, first, last } in self.lit {
            span[0] = span[0].min(seen(*point, first - self.dawn));
            span[1] = span[1].max(seen(*point, last + self.fades));
        }
        let [first, last] = span;
        Span { zero, first, last }
    }
}
