//! Velocities of objects, by the wavelength ratios with which they are seen.
//!
//! For an object with four-velocity γ(1, β) seen by a camera with γc(1, βc) along the world's look direction d,
//!
//! ```text
//! W = ω_emitted / ω_observed = γ(1 + β·d) / (γc(1 + βc·d))
//! ```
//!
//! so that W γc(1 + βc·d) is linear in d: a least squares fit over the object's pixels gives γ and γβ. An
//! object that takes up little of the view determines them badly; so hypotheses are compared by how well they
//! reproduce W where the object is seen, not by the fitted numbers.

use std::collections::BTreeMap;

use glam::{DMat4, DVec3, DVec4};

use super::aberration::camera_velocity;
use super::{Case, Diagnosis, Kind};
use crate::validate::compare::plane::Plane;

/// An object has to have so many pixels.
const FEWEST: usize = 24;
/// The rms of W's relative error that a fit may leave.
const FITS: f64 = 1e-4;
/// W's relative errors below this are none.
const NOTABLE: f64 = 1e-3;
/// A hypothesis has to reproduce W to this part of its error.
const NEAR: f64 = 0.1;

/// An object's pixels in a picture.
#[derive(Debug, Clone, Default)]
struct Seen {
    /// (1, d), and W γc(1 + βc·d).
    rows: Vec<(DVec4, f64)>,
}

impl Seen {
    /// (γ, γβ); none where the pixels do not determine it.
    fn velocity(&self) -> Option<DVec4> {
        if self.rows.len() < FEWEST {
            return None;
        }
        let (mut normal, mut right) = (DMat4::ZERO, DVec4::ZERO);
        for (row, value) in &self.rows {
            let outer = DMat4::from_cols(*row * row.x, *row * row.y, *row * row.z, *row * row.w);
            normal += outer;
            right += *row * *value;
        }
        let scale = normal.col(0).x;
        let (normal, right) = (normal * (1.0 / scale), right / scale);
        // Tikhonov's term picks the shortest of the velocities that fit equally well.
        let damped = normal + DMat4::from_diagonal(DVec4::splat(1e-12));
        let u = damped.inverse() * right;
        u.is_finite().then_some(u)
    }

    /// The rms of the relative error with which a four-velocity reproduces W.
    fn misfit(&self, u: DVec4) -> f64 {
        let square = |(row, value): &(DVec4, f64)| {
            let e = row.dot(u) / value - 1.0;
            e * e
        };
        let sum: f64 = self.rows.iter().map(square).sum();
        (sum / self.rows.len().max(1) as f64).sqrt()
    }
}

pub(super) fn diagnose(case: &Case) -> Vec<Diagnosis> {
    let [Some(r), Some(c)] = [0, 1].map(|which| seen(case, which)) else {
        return Vec::new();
    };
    let moved: Vec<Moved> = (r.iter())
        .filter_map(|(object, r)| Moved::of(*object, r, c.get(object)?))
        .collect();
    let mut swapped = Vec::new();
    for (i, a) in moved.iter().enumerate() {
        for b in &moved[i + 1..] {
            swapped.extend(a.swapped_with(b));
        }
    }
    if !swapped.is_empty() {
        return swapped;
    }
    moved.iter().map(Moved::wrong).collect()
}

/// An object whose velocity differs between the pictures.
struct Moved {
    object: i64,
    candidate: Seen,
    /// Four-velocities in the reference and in the candidate.
    velocities: [DVec4; 2],
    /// How well the reference's reproduces W in the candidate.
    error: f64,
}

impl Moved {
    fn of(object: i64, r: &Seen, c: &Seen) -> Option<Moved> {
        let velocities = [r.velocity()?, c.velocity()?];
        let fits = r.misfit(velocities[0]) <= FITS && c.misfit(velocities[1]) <= FITS;
        let error = c.misfit(velocities[0]);
        (fits && error > NOTABLE).then(|| Moved {
            object,
            candidate: c.clone(),
            velocities,
            error,
        })
    }

    fn swapped_with(&self, other: &Moved) -> Option<Diagnosis> {
        let rest = [
            self.candidate.misfit(other.velocities[0]),
            other.candidate.misfit(self.velocities[0]),
        ];
        let explains = rest[0] <= NEAR * self.error && rest[1] <= NEAR * other.error;
        explains.then(|| Diagnosis {
            kind: Kind::VelocitiesSwapped,
            what: format!(
                "the velocities of objects {} and {} are swapped",
                self.object, other.object
            ),
            evidence: vec![
                ("W differs by (relative, rms)", self.error.max(other.error)),
                ("with swapped velocities by", rest[0].max(rest[1])),
            ],
        })
    }

    fn wrong(&self) -> Diagnosis {
        let beta = |u: DVec4| u.spatial() / u.x;
        let [r, c] = self.velocities.map(beta);
        let text = |b: DVec3| format!("({:.4}, {:.4}, {:.4})", b.x, b.y, b.z);
        Diagnosis {
            kind: Kind::VelocityWrong,
            what: format!(
                "object {} moves at another velocity: its wavelength ratios are those of β = {}, and should be those of {}",
                self.object,
                text(c),
                text(r)
            ),
            evidence: vec![
                ("W differs by (relative, rms)", self.error),
                (
                    "with the other velocity by",
                    self.candidate.misfit(self.velocities[1]),
                ),
            ],
        }
    }
}

trait Spatial {
    fn spatial(self) -> DVec3;
}

impl Spatial for DVec4 {
    /// The last three components.
    fn spatial(self) -> DVec3 {
        DVec3::new(self.y, self.z, self.w)
    }
}

/// The pixels of each object in a picture; none where it lacks channels or metadata.
fn seen(case: &Case, which: usize) -> Option<BTreeMap<i64, Seen>> {
    let layers = &case.pair[which].layers;
    let ratio = Plane::find(layers, "wavelength_ratio")?;
    let direction = Plane::group(layers, ["direction.x", "direction.y", "direction.z"])?;
    let velocity = camera_velocity(case.pair[which]).or_else(|| camera_velocity(case.pair[0]))?;
    let (gamma, beta) = (velocity.gamma(), velocity.beta());
    let mut objects: BTreeMap<i64, Seen> = BTreeMap::new();
    for i in case.pixels() {
        let d = DVec3::from_array(std::array::from_fn(|k| direction[k].at(i)));
        let value = ratio.at(i) * gamma * (1.0 + beta.dot(d));
        if value.is_finite() && value > 0.0 {
            let object = case.points[which].object_at(i).unwrap_or(0.0) as i64;
            let row = DVec4::new(1.0, d.x, d.y, d.z);
            objects.entry(object).or_default().rows.push((row, value));
        }
    }
    Some(objects)
}
