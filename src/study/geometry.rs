//! Where the points that a picture shows should have been.

use glam::DVec3;
use serde::Serialize;

use super::statistics::quantile;
use crate::aov::Aov;
use crate::apparent::{Observer, Sight};
use crate::error::Result;
use crate::film::Film;
use crate::prepare::Prepared;

/// Errors of geometry and of time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct GeometricError {
    /// How far points are from where they should be, pixels.
    pub pixels: Spread,
    /// |Δct| of the emission where the right object is seen, metres.
    pub emission_time: Spread,
    /// Pixels in whose middle another object is seen than should be, or none, or one where none should be.
    pub wrong_object: u64,
    /// Pixels in whose middle something is seen.
    pub seen: u64,
}

/// How large errors are.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Spread {
    /// That of the middle one.
    pub median: f64,
    /// Exceeded by one in a hundred.
    pub p99: f64,
    /// The largest.
    pub max: f64,
}

/// The channels that [`Geometry::error`] reads.
pub(super) const CHANNELS: [Aov; 5] = [
    Aov::Object,
    Aov::EventCt,
    Aov::ObjectEventX,
    Aov::ObjectEventY,
    Aov::ObjectEventZ,
];

/// What a camera sees of points of a scene's objects.
pub(super) struct Geometry<'a> {
    /// Per object: what is seen of its rest frame, and where its origin is in that.
    sights: Vec<Option<(usize, DVec3)>>,
    frames: Vec<Sight<'a>>,
}

impl Spread {
    fn of(errors: &[f64]) -> Self {
        Spread {
            median: quantile(errors, 0.5),
            p99: quantile(errors, 0.99),
            max: quantile(errors, 1.0),
        }
    }
}

impl<'a> Geometry<'a> {
    /// What `observer` sees of `scene`.
    pub fn new(scene: &Prepared, observer: &'a Observer) -> Result<Self> {
        let frames = scene.frames.iter().map(|rest| observer.sight(&rest.frame));
        let mut sights = Vec::new();
        for (index, rest) in scene.frames.iter().enumerate() {
            for patch in &rest.patches {
                let object = patch.object as usize;
                if sights.len() <= object {
                    sights.resize(object + 1, None);
                }
                sights[object] = Some((index, patch.object_origin.x));
            }
        }
        Ok(Geometry {
            sights,
            frames: frames.collect::<Result<_>>()?,
        })
    }

    /// The error of `film`, rendered at the centres of pixels, against the truth of `exact`.
    pub fn error(&self, film: &Film, exact: &Film) -> GeometricError {
        let [object, ct, x, y, z] = CHANNELS.map(|aov| film.aov(aov).unwrap_or_default());
        let [true_object, true_ct, ..] = CHANNELS.map(|aov| exact.aov(aov).unwrap_or_default());
        let columns = film.size()[0] as usize;
        let (mut pixels, mut times, mut wrong) = (Vec::new(), Vec::new(), 0);
        for i in 0..object.len() {
            if object[i] != true_object[i] {
                wrong += 1;
            } else if object[i] >= 0.0 {
                times.push((ct[i] - true_ct[i]).abs());
            }
            if object[i] >= 0.0 {
                let middle = [(i % columns) as f64 + 0.5, (i / columns) as f64 + 0.5];
                let place = DVec3::new(x[i], y[i], z[i]);
                pixels.push(self.distance(object[i] as usize, place, middle));
            }
        }
        GeometricError {
            pixels: Spread::of(&pixels),
            emission_time: Spread::of(&times),
            wrong_object: wrong,
            seen: pixels.len() as u64,
        }
    }

    /// How far from `middle`, in pixels, the point `place` of an object is truly seen.
    fn distance(&self, object: usize, place: DVec3, [x, y]: [f64; 2]) -> f64 {
        let known = self.sights.get(object).copied().flatten();
        let seen = known.and_then(|(frame, origin)| self.frames[frame].film_point(place + origin));
        seen.map_or(f64::INFINITY, |[u, v]| libm::hypot(u - x, v - y))
    }
}
