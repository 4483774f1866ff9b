//! Reflection of surfaces: diffuse, and the metallic-roughness model of glTF 2.0 (Appendix B).
//!
//! All directions are unit vectors of the surface's rest frame, away from it: n the normal on the side of the
//! observer, v to the observer, l to the light, h = (v + l)/|v + l|. With the base colour c, metalness m, perceptual
//! roughness r and α = r²,
//!
//! ```text
//! f = (1 − F) c (1 − m)/π + F D V,        F = f₀ + (1 − f₀)(1 − v·h)⁵,     f₀ = ((ν − 1)/(ν + 1))² (1 − m) + c m,
//! D = α²/(π ((n·h)² (α² − 1) + 1)²),      V = ½/(n·l √(α² + (1 − α²)(n·v)²) + n·v √(α² + (1 − α²)(n·l)²)).
//! ```
//!
//! ν is the refractive index of the dielectric, 1.5 unless a material says otherwise, for which its part is 0.04 (KHR_materials_ior); it
//! is also that of smooth glass. D V is GGX with Smith's height-correlated masking (Walter et al. 2007; Heitz, JCGT 3(2), 2014). Normals
//! visible from v are sampled as in Heitz, JCGT 7(4), 2018, for which f (n·l)/pdf = F G₂/G₁. A surface with m = 0 and r = 1 is treated as
//! purely diffuse: f = c/π.
//!
//! f does not conserve energy. D V is single scattering: light that meets a second microfacet is lost, and a white metal reflects less the
//! rougher it is. The diffuse part of a dielectric, weighted by 1 − F(v·h), reflects too much at grazing angles. The guide has the numbers.
//!
//! The files of this folder derive the rest: sampling of directions, smooth glass, and interpolated normals.

use std::f64::consts::{FRAC_1_PI, PI};

use glam::DVec3;

use crate::colour::reflectances;

mod cosine;
mod drawing;
mod glass;
mod gloss;
mod many;
mod smooth;

pub(super) use cosine::by_cosine;
pub(crate) use cosine::each_by_cosine;
pub use drawing::Scattered;
pub(crate) use gloss::{Coefficients, Glosses, reflectance_of_index};
pub(crate) use smooth::bent;

use glass::Through;
use gloss::{alpha, diffuse_and_specular, facing, schlick};

/// The reflection of a surface point towards the observer.
#[derive(Debug, Clone)]
pub struct Reflection {
    normal: DVec3,
    /// The normal of the surface itself, on the same side.
    geometric: DVec3,
    view: DVec3,
    /// n·v.
    facing: f64,
    /// c (1 − m).
    diffuse: [f64; 3],
    /// f₀; `None` for a diffuse surface.
    specular: Option<[f64; 3]>,
    alpha: f64,
    /// Whether the specular part is that of a mirror.
    is_mirror: bool,
    /// The transmission.
    through: Option<Box<Through>>,
    /// Refractive index on the side of the observer, over that of the medium of the scene.
    near: f64,
}

impl Reflection {
    /// A diffuse surface of albedo `colour`.
    pub fn diffuse(normal: DVec3, colour: [f64; 3]) -> Self {
        Reflection {
            normal,
            geometric: normal,
            view: normal,
            facing: 1.0,
            diffuse: colour,
            specular: None,
            alpha: 1.0,
            is_mirror: false,
            through: None,
            near: 1.0,
        }
    }

    /// A surface of base colour `colour`, and of a dielectric with the f₀ `dielectric`.
    #[inline(always)]
    pub fn metallic_roughness(
        normal: DVec3,
        view: DVec3,
        colour: [f64; 3],
        [metallic, roughness]: [f64; 2],
        dielectric: f64,
    ) -> Self {
        let [diffuse, specular] = diffuse_and_specular(colour, metallic, dielectric);
        Reflection {
            normal,
            geometric: normal,
            view,
            facing: facing(normal, view),
            diffuse,
            specular: Some(specular),
            alpha: alpha(roughness),
            is_mirror: false,
            through: None,
            near: 1.0,
        }
    }

    /// The same with the specular part of a mirror.
    pub fn as_mirror(self) -> Self {
        Reflection {
            is_mirror: true,
            ..self
        }
    }

    /// The same if the observer is in a medium of this index.
    pub fn within(self, near: f64) -> Self {
        Reflection { near, ..self }
    }

    /// The same at some wavelengths, given b_r, b_g and b_b of each: everything with channels is converted like reflectances, since f₀
    /// and c (1 − m) are linear in c, and the weights add up to 1.
    pub(crate) fn at(&self, basis: &[[f64; 3]; 3]) -> Self {
        let through = self.through.as_ref().map(|glass| Through {
            colour: reflectances(basis, glass.colour),
            ..**glass
        });
        Reflection {
            diffuse: reflectances(basis, self.diffuse),
            specular: self.specular.map(|f0| reflectances(basis, f0)),
            through: through.map(Box::new),
            ..*self
        }
    }

    /// The normal on the side of the observer.
    pub fn normal(&self) -> DVec3 {
        self.normal
    }

    /// For a diffuse surface, the reflected fraction of light.
    #[inline]
    pub(crate) fn albedo(&self) -> [f64; 3] {
        self.diffuse
    }

    /// Whether it is purely diffuse.
    #[inline]
    pub(crate) fn is_diffuse(&self) -> bool {
        self.specular.is_none() && self.through.is_none()
    }

    /// f for light from `l`, which is on the observer's side.
    #[inline]
    pub fn value(&self, l: DVec3) -> [f64; 3] {
        let Some(f0) = self.specular else {
            return self.diffuse.map(|c| c / PI);
        };
        if self.is_mirror {
            return self.diffuse_value(l);
        }
        DVec3::to_array(&self.glossy_value(DVec3::from_array(f0), l))
    }

    /// f of a surface of this f₀.
    #[inline(always)]
    fn glossy_value(&self, f0: DVec3, l: DVec3) -> DVec3 {
        let of = Coefficients {
            f0,
            rest: DVec3::ONE - f0,
            diffuse: DVec3::from_array(self.diffuse) * FRAC_1_PI,
            alpha: self.alpha,
        };
        of.value::<false, false>(self.normal, (self.view, self.facing), l)
    }

    /// The diffuse part of f for light from `l`.
    #[inline]
    pub fn diffuse_value(&self, l: DVec3) -> [f64; 3] {
        let Some(f0) = self.specular else {
            return self.diffuse.map(|c| c / PI);
        };
        // 1 − F = (1 − f₀)(1 − (1 − v·h)⁵).
        let h = (self.view + l).normalize_or(self.normal);
        let weight = schlick(self.view.dot(h));
        std::array::from_fn(|c| (1.0 - f0[c]) * (1.0 - weight) * self.diffuse[c] / PI)
    }

    /// A substitute for the diffuse part of f that is the same for all l: its value for l along v mirrored, with F at n·v.
    #[inline]
    pub fn mean_diffuse_value(&self) -> [f64; 3] {
        let Some(f0) = self.specular else {
            return self.diffuse.map(|c| c / PI);
        };
        let weight = schlick(self.facing);
        std::array::from_fn(|c| (1.0 - f0[c]) * (1.0 - weight) * self.diffuse[c] / PI)
    }

    /// The specular part of f for light from `l`; 0 for a diffuse surface.
    #[inline]
    pub fn specular_value(&self, l: DVec3) -> [f64; 3] {
        let (value, diffuse) = (self.value(l), self.diffuse_value(l));
        std::array::from_fn(|c| value[c] - diffuse[c])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A grid of n × n points in the unit square.
    pub(super) fn grid(n: usize) -> impl Iterator<Item = [f64; 2]> {
        let at = move |k: usize| (k as f64 + 0.5) / n as f64;
        (0..n * n).map(move |k| [at(k % n), at(k / n)])
    }

    pub(super) fn view(cosine: f64) -> DVec3 {
        DVec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine)
    }

    #[test]
    fn reflection_is_reciprocal() {
        let (a, b) = (view(0.8), DVec3::new(-0.3, 0.4, 0.75f64.sqrt()));
        let of = |v| Reflection::metallic_roughness(DVec3::Z, v, [0.9, 0.5, 0.1], [0.3, 0.4], 0.04);
        for (x, y) in of(a).value(b).into_iter().zip(of(b).value(a)) {
            assert!((x - y).abs() < 1e-13 * x, "{x} {y}");
        }
    }

    #[test]
    fn the_value_at_normal_incidence_is_that_of_the_formula() {
        // n = v = l = h: D = 1/(π α²), V = ¼, F = f₀; α = 0.25, c = 0.5, m = 0: f₀ = 0.04.
        let r = Reflection::metallic_roughness(DVec3::Z, DVec3::Z, [0.5; 3], [0.0, 0.5], 0.04);
        let expected = 0.96 * 0.5 / PI + 0.04 / (PI * 0.0625) / 4.0;
        assert!((r.value(DVec3::Z)[1] - expected).abs() < 1e-15);
    }
}
