//! Sampling of directions in proportion to a surface's reflection; the symbols are those of [`reflection`](super).
//!
//! When light is traced from surface to surface, r = 0 is a mirror: F D V is F δ(l − v mirrored)/(n·l). A direction is sampled for the
//! specular part with the probability q = F₀/(F₀ + d), F₀ = F at n·v and d the diffuse albedo less F₀ (both as means of the channels, and
//! q from 0.1 to 0.9 if both parts exist), otherwise with the cosine, and its density is the sum of both,
//!
//! ```text
//! p(l) = (1 − q) n·l/π + q D/(2 (n·v + √(α² + (1 − α²)(n·v)²))),
//! ```
//!
//! the second term from p(h) = G₁ (v·h) D/(n·v), dω_h/dω_l = 1/(4 v·h) and G₁ = 2 n·v/(n·v + √(…)).

use std::f64::consts::{FRAC_1_PI, PI, TAU};

use glam::DVec3;

use super::Reflection;
use super::cosine::by_cosine;
use super::glass::chance_of_mirror;
use super::gloss::{root, schlick};

/// A sampled direction in which light is traced on.
#[derive(Debug, Clone, Copy)]
pub struct Scattered {
    /// The direction towards the light.
    pub l: DVec3,
    /// f (n·l) over the density.
    pub weight: [f64; 3],
    /// Per solid angle; infinite for the direction of a mirror or through glass.
    pub density: f64,
    /// Refractive index along it, over that of the medium of the scene.
    pub index: f64,
}

/// The smallest probability of either lobe of a metallic-roughness surface: samples of one weigh at most ten times as much as by it
/// alone.
const LEAST_CHANCE: f64 = 0.1;

impl Reflection {
    /// A direction sampled for the specular part from two numbers in [0, 1), and that part of f (n·l)/pdf; `None` if it points into the
    /// surface, or there is no such part.
    #[inline]
    pub fn sample_specular(&self, [x, y]: [f64; 2]) -> Option<(DVec3, [f64; 3])> {
        let f0 = self.specular?;
        let (tangent, bitangent) = self.normal.any_orthonormal_pair();
        let local = |v: DVec3| DVec3::new(v.dot(tangent), v.dot(bitangent), v.dot(self.normal));
        // The view, stretched to the hemisphere of α = 1; not below the surface, to which shading normals and rounding may tilt it.
        let v = local(self.view);
        let stretched = DVec3::new(self.alpha * v.x, self.alpha * v.y, v.z.max(1e-9)).normalize();
        // A point of the disc in which the hemisphere appears in that view.
        let across = DVec3::new(-stretched.y, stretched.x, 0.0).try_normalize();
        let t1 = across.unwrap_or(DVec3::X);
        let t2 = stretched.cross(t1);
        let (radius, angle) = (x.sqrt(), TAU * y);
        let p1 = radius * libm::cos(angle);
        // In that view the hemisphere covers half of the disc and, foreshortened, part of the other half: p₂ is squeezed into it.
        let lift = 0.5 * (1.0 + stretched.z);
        let p2 = (1.0 - lift) * (1.0 - p1 * p1).max(0.0).sqrt() + lift * radius * libm::sin(angle);
        let rest = (1.0 - p1 * p1 - p2 * p2).max(0.0).sqrt();
        let n = t1 * p1 + t2 * p2 + stretched * rest;
        // Unstretched to the actual roughness.
        let h = DVec3::new(self.alpha * n.x, self.alpha * n.y, n.z.max(0.0)).normalize_or(DVec3::Z);
        let h = tangent * h.x + bitangent * h.y + self.normal * h.z;
        let along = self.view.dot(h);
        let l = h * (2.0 * along) - self.view;
        let cosine = self.normal.dot(l);
        if cosine <= 0.0 || !self.is_open(l) {
            return None;
        }
        // G₂/G₁ = 4 (n·l)(n·v) V / G₁(v), G₁ = 2 n·v/(n·v + √(α² + (1 − α²)(n·v)²)).
        let root = self.root(self.facing);
        let ratio = 2.0 * cosine * self.visibility(cosine) * (self.facing + root);
        let weight = schlick(along);
        Some((l, f0.map(|f| (f + (1.0 - f) * weight) * ratio)))
    }

    /// A direction sampled for all of f from two numbers in [0, 1); `None` if it points into the surface, or everything is black.
    #[inline]
    pub fn sample(&self, [x, y]: [f64; 2]) -> Option<Scattered> {
        // One number decides between mirror, glass and diffuse; its remainder is uniform again.
        let share = self.specular_share();
        if x < share && self.is_mirror {
            // A mirror: Schlick's F, or for glass Fresnel's, over its probability.
            let f0 = self.specular?;
            let weight = schlick(self.facing);
            let reflected = match &self.through {
                None => f0.map(|f| f + (1.0 - f) * weight),
                Some(glass) => [glass.reflected; 3],
            };
            let l = self.normal * (2.0 * self.normal.dot(self.view)) - self.view;
            return self.is_open(l).then(|| Scattered {
                l,
                weight: reflected.map(|f| f / share),
                density: f64::INFINITY,
                index: self.near,
            });
        }
        let l = match x < share {
            true => self.sample_specular([x / share, y])?.0,
            false => {
                let x = (x - share) / (1.0 - share);
                // The rest is transmitted or diffuse.
                let part = self.share_through();
                if let Some(glass) = self.through.as_ref().filter(|_| x < part) {
                    let weight = (1.0 - glass.reflected) / ((1.0 - share) * part);
                    let l = glass.l.filter(|l| self.is_open(*l))?;
                    return Some(Scattered {
                        l,
                        weight: glass.colour.map(|c| c * weight),
                        density: f64::INFINITY,
                        index: glass.far,
                    });
                }
                let x = match part > 0.0 {
                    true => (x - part) / (1.0 - part),
                    false => x,
                };
                by_cosine(self.normal, [x, y])
            }
        };
        self.scattered(l)
    }

    /// The direction `l` as if sampled with [`Reflection::density`]; `None` if it points into the surface.
    #[inline]
    pub(crate) fn scattered(&self, l: DVec3) -> Option<Scattered> {
        if self.is_diffuse() {
            // (c/π) (n·l)/p with p = (n·l)/π.
            let cosine = self.normal.dot(l);
            return (cosine > 0.0 && self.is_open(l)).then_some(Scattered {
                l,
                weight: self.diffuse,
                density: cosine * FRAC_1_PI,
                index: self.near,
            });
        }
        // Weighted with the density of all lobes together, whichever of them sampled l.
        let (cosine, density) = (self.normal.dot(l), self.density(l));
        let is_drawn = cosine > 0.0 && density > 0.0 && self.is_open(l);
        is_drawn.then(|| Scattered {
            l,
            weight: self.value(l).map(|f| f * cosine / density),
            density,
            index: self.near,
        })
    }

    /// The weight of a sample `drawn` from `other`, which is this surface with other channels.
    pub(crate) fn weight_of(&self, drawn: &Scattered, other: &Reflection) -> [f64; 3] {
        if self.is_diffuse() {
            return self.diffuse;
        }
        let (cosine, density) = (self.normal.dot(drawn.l), drawn.density);
        if density.is_finite() {
            return self.value(drawn.l).map(|f| f * cosine / density);
        }
        // A mirror has a single direction: weighted with the probabilities of the other surface.
        let share = other.specular_share();
        match (&self.through, cosine > 0.0) {
            (Some(glass), false) => {
                let part = (1.0 - share) * other.share_through();
                glass.colour.map(|c| c * (1.0 - glass.reflected) / part)
            }
            (Some(glass), true) => [glass.reflected / share; 3],
            (None, _) => {
                let weight = schlick(self.facing);
                let f0 = self.specular.unwrap_or_default();
                f0.map(|f| (f + (1.0 - f) * weight) / share)
            }
        }
    }

    /// The density with which [`Reflection::sample`] samples `l`, except as a mirror's direction.
    #[inline]
    pub fn density(&self, l: DVec3) -> f64 {
        if self.is_diffuse() {
            return self.normal.dot(l).max(0.0) / PI;
        }
        self.density_of_parts(l)
    }

    /// The same for a surface that is not diffuse.
    fn density_of_parts(&self, l: DVec3) -> f64 {
        let share = self.specular_share();
        let mut diffuse = (1.0 - share) * self.normal.dot(l).max(0.0) / PI;
        if self.through.is_some() {
            diffuse *= 1.0 - self.share_through();
        }
        if share == 0.0 || self.is_mirror {
            return diffuse;
        }
        diffuse + share * self.specular_density(l)
    }

    /// The density with which [`Reflection::sample_specular`] samples `l`; 0 for a diffuse surface.
    #[inline]
    pub fn specular_density(&self, l: DVec3) -> f64 {
        if self.specular.is_none() {
            return 0.0;
        }
        let h = (self.view + l).normalize_or(self.normal);
        let visible = 2.0 * (self.facing + self.root(self.facing));
        self.distribution(self.normal.dot(h)) / visible
    }

    /// q.
    #[inline]
    pub(super) fn specular_share(&self) -> f64 {
        let Some(f0) = self.specular else {
            return 0.0;
        };
        let weight = schlick(self.facing);
        if let Some(glass) = &self.through {
            // Glass is a mirror for all samples if it reflects totally, or if nothing is transmitted or diffuse.
            let rest = mean(self.diffuse) + mean(glass.colour);
            return match glass.l.is_some() && rest > 0.0 {
                true => chance_of_mirror(glass.reflected),
                false => 1.0,
            };
        }
        let specular = mean(f0.map(|f| f + (1.0 - f) * weight));
        let diffuse = (1.0 - specular).max(0.0) * mean(self.diffuse);
        match diffuse > 0.0 {
            true => (specular / (specular + diffuse)).clamp(LEAST_CHANCE, 1.0 - LEAST_CHANCE),
            false => 1.0,
        }
    }

    /// The fraction transmitted among directions other than a mirror's.
    #[inline]
    fn share_through(&self) -> f64 {
        let Some(glass) = &self.through else {
            return 0.0;
        };
        let through = mean(glass.colour);
        match through > 0.0 {
            true => through / (through + mean(self.diffuse)),
            false => 0.0,
        }
    }

    /// D.
    #[inline(always)]
    pub(super) fn distribution(&self, cosine: f64) -> f64 {
        let square = self.alpha * self.alpha;
        // (n·h)² (α² − 1) + 1, whose terms cancel at the peak of a smooth surface down to α².
        let spread = cosine * cosine * (square - 1.0) + 1.0;
        square / (PI * spread * spread)
    }

    /// V for n·l.
    #[inline(always)]
    pub(super) fn visibility(&self, cosine: f64) -> f64 {
        0.5 / (cosine * self.root(self.facing) + self.facing * self.root(cosine))
    }

    /// √(α² + (1 − α²) c²).
    #[inline(always)]
    fn root(&self, cosine: f64) -> f64 {
        root(self.alpha * self.alpha, cosine)
    }
}

#[inline]
fn mean([r, g, b]: [f64; 3]) -> f64 {
    (r + g + b) / 3.0
}

#[cfg(test)]
mod tests;
