//! Smooth glass: reflection, transmission, and the probability of sampling the reflection; the symbols are those of
//! [`reflection`](super).
//!
//! Smooth glass, between the indices n₁ on the side of the observer and n₂, is a mirror with the F of Fresnel's equations for unpolarized
//! light (Born and Wolf, Principles of Optics, § 1.5.2). A fraction t of the rest is transmitted: light that comes along
//!
//! ```text
//! l = −(n₁/n₂) v + ((n₁/n₂) cos θ₁ − cos θ₂) n,     n₁ sin θ₁ = n₂ sin θ₂,
//! ```
//!
//! has (n₁/n₂)² times the radiance on the near side, as L/n² does not change along rays (dω cos θ n² is invariant: ibid., § 4.8), times
//! c. If no θ₂ exists, all is reflected. A thin-walled surface transmits light without refraction; with the reflections between its
//! two faces its F is 2F/(1 + F). The mirror direction is sampled with a probability near F, proportional to it below 4 %. Neglected:
//! dispersion (one index for all wavelengths), absorption between surfaces, polarization, and interference.

use glam::DVec3;

use super::Reflection;

/// The transmission through a surface.
#[derive(Debug, Clone, Copy)]
pub(super) struct Through {
    /// t c (1 − m).
    pub colour: [f64; 3],
    /// Index on the other side.
    pub far: f64,
    /// F.
    pub reflected: f64,
    /// The direction of the transmitted light; `None` for total reflection.
    pub l: Option<DVec3>,
}

impl Reflection {
    /// The reflection with the surface as smooth glass, which transmits the fraction `transmission` of what is not reflected, to the index
    /// `far`; thin-walled if `solid` is false.
    pub fn as_glass(self, transmission: f64, far: f64, solid: bool) -> Self {
        let through = Through::new(
            (self.normal, self.view, self.facing),
            [self.near, far],
            solid,
            self.diffuse.map(|c| c * transmission),
        );
        Reflection {
            diffuse: self.diffuse.map(|c| c * (1.0 - transmission)),
            is_mirror: true,
            through: Some(Box::new(through)),
            ..self
        }
    }
}

impl Through {
    /// Through a surface with this normal, seen from `view` at the cosine `facing`, with the index `near` here and `far` beyond;
    /// thin-walled if `solid` is false. `colour` is t c (1 − m).
    pub fn new(
        (normal, view, facing): (DVec3, DVec3, f64),
        [near, far]: [f64; 2],
        solid: bool,
        colour: [f64; 3],
    ) -> Self {
        let ratio = if solid { near / far } else { 1.0 };
        let (mut reflected, cosine) = fresnel(facing.min(1.0), far / near);
        if !solid {
            // Two faces, with all reflections between them.
            reflected = 2.0 * reflected / (1.0 + reflected);
        }
        let refracted = |cosine: f64| normal * (ratio * facing - cosine) - view * ratio;
        let l = match solid {
            true => cosine.map(|cosine| refracted(cosine).normalize_or(-normal)),
            false => Some(-view),
        };
        Through {
            colour: colour.map(|c| c * ratio * ratio),
            far: if solid { far } else { near },
            reflected,
            l,
        }
    }
}

/// The probability of sampling the reflection for glass of this F: F, but at least a tenth of all samples for either part, or 2.5 times
/// its own share if that is less. So nothing is sampled for a part that does not exist, and bright light in a faint reflection, like the
/// 4 % of an index of 1.5, gets a tenth of the samples.
#[inline]
pub(super) fn chance_of_mirror(reflected: f64) -> f64 {
    let least = |part: f64| (2.5 * part).min(0.1);
    reflected.clamp(least(reflected), 1.0 - least(1.0 - reflected))
}

/// F for light that arrives with `cosine` at a body whose index is `ratio` times as high, and the cosine inside; `None` for total
/// reflection.
#[inline]
fn fresnel(cosine: f64, ratio: f64) -> (f64, Option<f64>) {
    // cos² θ₂ by Snell's law: 0 at the critical angle, negative beyond it.
    let within = 1.0 - (1.0 - cosine * cosine) / (ratio * ratio);
    if within <= 0.0 {
        return (1.0, None);
    }
    let within = within.sqrt();
    // Amplitudes perpendicular and parallel to the plane of incidence; unpolarized light has half its power in each.
    let s = (cosine - ratio * within) / (cosine + ratio * within);
    let p = (ratio * cosine - within) / (ratio * cosine + within);
    (0.5 * (s * s + p * p), Some(within))
}

#[cfg(test)]
mod tests;
