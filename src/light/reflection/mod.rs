//! How surfaces reflect: diffuse, and the metallic-roughness model of glTF 2.0 (Appendix B).
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
//! ν is the refractive index of the dielectric, 1.5 unless a material says otherwise, for which its part is 0.04 (KHR_materials_ior); it is
//! that of smooth glass, too. D V is GGX with Smith's height-correlated masking (Walter et al. 2007; Heitz, JCGT 3(2), 2014). Normals visible
//! from v are drawn as in Heitz, JCGT 7(4), 2018, for which f (n·l)/pdf = F G₂/G₁. A surface with m = 0 and r = 1 is
//! taken as diffuse altogether: f = c/π.
//!
//! Where light is followed from surface to surface, r = 0 is a mirror: F D V is F δ(l − v mirrored)/(n·l). A direction of all of f is drawn
//! for the specular part with the probability q = F₀/(F₀ + d), F₀ = F at n·v and d the diffuse albedo less F₀ (both as means of the
//! channels, and q from 0.1 to 0.9 where there are both), otherwise with the cosine, and its density is the sum of both,
//!
//! ```text
//! p(l) = (1 − q) n·l/π + q D/(2 (n·v + √(α² + (1 − α²)(n·v)²))),
//! ```
//!
//! the second term from p(h) = G₁ (v·h) D/(n·v), dω_h/dω_l = 1/(4 v·h) and G₁ = 2 n·v/(n·v + √(…)).
//!
//! Smooth glass, between the indices n₁ on the side of the observer and n₂, is a mirror with the F of Fresnel's equations for light of no
//! polarization (Born and Wolf, Principles of Optics, § 1.5.2). Of the rest the part t goes through: light that comes along
//!
//! ```text
//! l = −(n₁/n₂) v + ((n₁/n₂) cos θ₁ − cos θ₂) n,     n₁ sin θ₁ = n₂ sin θ₂,
//! ```
//!
//! has the radiance (n₁/n₂)² as large on the near side, as L/n² does not change along rays (dω cos θ n² is invariant: ibid., § 4.8), times c.
//! Where no θ₂ exists, all is reflected. A film without thickness lets light through unbent; with the reflections between its two faces its F
//! is 2F/(1 + F). A direction is drawn as of a mirror with a probability near F, in proportion to it where it is less than 4 %. Neglected: dispersion (one index for all wavelengths), absorption between surfaces, polarization, and interference.
//!
//! # Normals of vertices
//!
//! Where a normal between those of the corners of a triangle stands for that of the triangle, n_g, it is n, turned to the side of n_g that
//! the observer is on. With χ = 1 where n·l and n_g·l have one sign and otherwise 0, the surface has χ f in place of f: light from below it
//! gives nothing, and it reflects no more than a surface of the normal n does. Such an f is not reciprocal (Veach, "Robust Monte Carlo
//! Methods for Light Transport Simulation", 1997, § 5.3); light is followed from the observer. Diffuse surfaces do not depend on v, and n
//! is as it is; of others it is `bent`.

use std::f64::consts::{FRAC_1_PI, PI, TAU};

use glam::DVec3;

use crate::accel::vectors::{BLOCK, Columns, VectorLoop, Vectors, dispatch};
use crate::colour::reflectances;

mod bent;
mod cosine;
mod glass;
mod gloss;

pub(crate) use bent::bent;
pub(super) use cosine::by_cosine;
pub(crate) use cosine::each_by_cosine;
pub(crate) use gloss::{Coefficients, Glosses, reflectance_of_index};

use glass::{Through, chance_of_mirror};
use gloss::{alpha, diffuse_and_specular, facing, root, schlick};

/// The reflection of a point of a surface towards the observer.
#[derive(Debug, Clone)]
pub struct Reflection {
    normal: DVec3,
    /// That of the surface itself, on the same side.
    geometric: DVec3,
    view: DVec3,
    /// n·v.
    facing: f64,
    /// c (1 − m).
    diffuse: [f64; 3],
    /// f₀, or none of a diffuse surface.
    specular: Option<[f64; 3]>,
    alpha: f64,
    /// Whether the specular part is that of a mirror.
    is_mirror: bool,
    /// What goes through.
    through: Option<Box<Through>>,
    /// Refractive index on the side of the observer, over that of the medium of the scene.
    near: f64,
}

/// A direction in which light is followed on.
#[derive(Debug, Clone, Copy)]
pub struct Scattered {
    /// Towards where the light comes from.
    pub l: DVec3,
    /// f (n·l) over the density.
    pub weight: [f64; 3],
    /// Per solid angle; infinite for the direction of a mirror or through glass.
    pub density: f64,
    /// Refractive index along it, over that of the medium of the scene.
    pub index: f64,
}

impl Reflection {
    /// Of a diffuse surface of albedo `colour`.
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

    /// Of a surface of base colour `colour`, and of a dielectric of the f₀ `dielectric`.
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

    /// The same of a surface with this normal, where another stands for it: on the side of the observer.
    pub fn on(self, geometric: DVec3) -> Self {
        Reflection { geometric, ..self }
    }

    /// The same with the specular part of a mirror.
    pub fn as_mirror(self) -> Self {
        Reflection {
            is_mirror: true,
            ..self
        }
    }

    /// The same where the observer is in a medium of this index.
    pub fn within(self, near: f64) -> Self {
        Reflection { near, ..self }
    }

    /// The same as smooth glass, of which the part `transmission` of what is not reflected goes through to the index `far`; a film without
    /// thickness where `solid` is false.
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

    /// The same at some wavelengths, by b_r, b_g and b_b of each, of which all that has channels is made as of reflectances: f₀ and c (1 − m) are
    /// linear in c, and the weights add up to 1.
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

    /// That of the surface itself.
    pub fn geometric_normal(&self) -> DVec3 {
        self.geometric
    }

    /// Whether these are two.
    pub(crate) fn is_smooth(&self) -> bool {
        self.normal != self.geometric
    }

    /// Whether `l` is on the same side of the surface as of its normal: other light gives nothing.
    #[inline]
    pub fn is_open(&self, l: DVec3) -> bool {
        (self.normal.dot(l) < 0.0) == (self.geometric.dot(l) < 0.0)
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

    /// [`Reflection::value`] of each of `reflections` that `chosen` names, for the light from its own of `l`.
    pub(crate) fn values(
        reflections: &[Reflection],
        chosen: &[u32],
        l: &Columns,
        values: &mut Columns,
    ) {
        values.resize(chosen.len());
        dispatch(Values {
            reflections,
            chosen,
            l,
            values,
        });
    }

    /// The diffuse part of f for light from `l`.
    #[inline]
    pub fn diffuse_value(&self, l: DVec3) -> [f64; 3] {
        let Some(f0) = self.specular else {
            return self.diffuse.map(|c| c / PI);
        };
        let h = (self.view + l).normalize_or(self.normal);
        let weight = schlick(self.view.dot(h));
        std::array::from_fn(|c| (1.0 - f0[c]) * (1.0 - weight) * self.diffuse[c] / PI)
    }

    /// What stands for the diffuse part of f alike for all l: that of l along v mirrored, with F by n·v.
    #[inline]
    pub fn mean_diffuse_value(&self) -> [f64; 3] {
        let Some(f0) = self.specular else {
            return self.diffuse.map(|c| c / PI);
        };
        let weight = schlick(self.facing);
        std::array::from_fn(|c| (1.0 - f0[c]) * (1.0 - weight) * self.diffuse[c] / PI)
    }

    /// A direction drawn for the specular part by two numbers in [0, 1), and that part of f (n·l)/pdf; none where it
    /// goes into the surface, or there is none.
    #[inline]
    pub fn sample_specular(&self, [x, y]: [f64; 2]) -> Option<(DVec3, [f64; 3])> {
        let f0 = self.specular?;
        let (tangent, bitangent) = self.normal.any_orthonormal_pair();
        let local = |v: DVec3| DVec3::new(v.dot(tangent), v.dot(bitangent), v.dot(self.normal));
        // The view, stretched to the hemisphere of α = 1.
        let v = local(self.view);
        let stretched = DVec3::new(self.alpha * v.x, self.alpha * v.y, v.z.max(1e-9)).normalize();
        // A point of the disc that it sees of the hemisphere.
        let across = DVec3::new(-stretched.y, stretched.x, 0.0).try_normalize();
        let t1 = across.unwrap_or(DVec3::X);
        let t2 = stretched.cross(t1);
        let (radius, angle) = (x.sqrt(), TAU * y);
        let p1 = radius * libm::cos(angle);
        let lift = 0.5 * (1.0 + stretched.z);
        let p2 = (1.0 - lift) * (1.0 - p1 * p1).max(0.0).sqrt() + lift * radius * libm::sin(angle);
        let rest = (1.0 - p1 * p1 - p2 * p2).max(0.0).sqrt();
        let n = t1 * p1 + t2 * p2 + stretched * rest;
        // Back to the roughness that it has.
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

    /// A direction drawn for all of f by two numbers in [0, 1); none where it goes into the surface, or all is black.
    #[inline]
    pub fn sample(&self, [x, y]: [f64; 2]) -> Option<Scattered> {
        // One number decides between mirror, glass and diffuse; what is left of it is uniform again.
        let share = self.specular_share();
        if x < share && self.is_mirror {
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

    /// Of a diffuse surface, the part of light that it reflects.
    #[inline]
    pub(crate) fn albedo(&self) -> [f64; 3] {
        self.diffuse
    }

    /// Whether it is diffuse, and nothing else.
    #[inline]
    pub(crate) fn is_diffuse(&self) -> bool {
        self.specular.is_none() && self.through.is_none()
    }

    /// The direction `l` as one that was drawn with [`Reflection::density`]; none where it goes into the surface.
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
        let (cosine, density) = (self.normal.dot(l), self.density(l));
        let is_drawn = cosine > 0.0 && density > 0.0 && self.is_open(l);
        is_drawn.then(|| Scattered {
            l,
            weight: self.value(l).map(|f| f * cosine / density),
            density,
            index: self.near,
        })
    }

    /// The weight of what was `drawn` of `other`, which is this surface with other channels.
    pub(crate) fn weight_of(&self, drawn: &Scattered, other: &Reflection) -> [f64; 3] {
        if self.is_diffuse() {
            return self.diffuse;
        }
        let (cosine, density) = (self.normal.dot(drawn.l), drawn.density);
        if density.is_finite() {
            return self.value(drawn.l).map(|f| f * cosine / density);
        }
        // One direction alone, by the chances of the other.
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

    /// The density with which [`Reflection::sample`] draws `l`, other than as a mirror's direction.
    #[inline]
    pub fn density(&self, l: DVec3) -> f64 {
        if self.is_diffuse() {
            return self.normal.dot(l).max(0.0) / PI;
        }
        self.density_of_parts(l)
    }

    /// The same of a surface that is not diffuse.
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

    /// The density with which [`Reflection::sample_specular`] draws `l`; 0 of a diffuse surface.
    #[inline]
    pub fn specular_density(&self, l: DVec3) -> f64 {
        if self.specular.is_none() {
            return 0.0;
        }
        let h = (self.view + l).normalize_or(self.normal);
        let visible = 2.0 * (self.facing + self.root(self.facing));
        self.distribution(self.normal.dot(h)) / visible
    }

    /// The specular part of f for light from `l`; 0 of a diffuse surface.
    #[inline]
    pub fn specular_value(&self, l: DVec3) -> [f64; 3] {
        let (value, diffuse) = (self.value(l), self.diffuse_value(l));
        std::array::from_fn(|c| value[c] - diffuse[c])
    }

    /// q.
    #[inline]
    fn specular_share(&self) -> f64 {
        let Some(f0) = self.specular else {
            return 0.0;
        };
        let weight = schlick(self.facing);
        if let Some(glass) = &self.through {
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

    /// Of what is not reflected as by a mirror, the part of directions that go through.
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
    fn distribution(&self, cosine: f64) -> f64 {
        let square = self.alpha * self.alpha;
        // (n·h)² (α² − 1) + 1, whose terms cancel at the peak of a smooth surface only as far as α² is small.
        let spread = cosine * cosine * (square - 1.0) + 1.0;
        square / (PI * spread * spread)
    }

    /// V for n·l.
    #[inline(always)]
    fn visibility(&self, cosine: f64) -> f64 {
        0.5 / (cosine * self.root(self.facing) + self.facing * self.root(cosine))
    }

    /// √(α² + (1 − α²) c²).
    #[inline(always)]
    fn root(&self, cosine: f64) -> f64 {
        root(self.alpha * self.alpha, cosine)
    }
}

/// The loop over points: their reflections are brought together by component first.
struct Values<'a> {
    reflections: &'a [Reflection],
    chosen: &'a [u32],
    l: &'a Columns,
    values: &'a mut Columns,
}

impl VectorLoop for Values<'_> {
    #[inline(always)]
    fn run(self) {
        let mut begin = 0;
        while begin < self.chosen.len() {
            let count = (self.chosen.len() - begin).min(BLOCK);
            let chosen = &self.chosen[begin..begin + count];
            let (mut normals, mut views, mut l) = (Vectors::ZERO, Vectors::ZERO, Vectors::ZERO);
            let (mut diffuse, mut specular) = (Vectors::ZERO, Vectors::ZERO);
            let (mut facing, mut alpha) = ([1.0; BLOCK], [1.0; BLOCK]);
            for (k, point) in chosen.iter().enumerate() {
                let of = &self.reflections[*point as usize];
                normals.set(k, of.normal);
                views.set(k, of.view);
                l.set(k, self.l.get(*point as usize));
                diffuse.set(k, DVec3::from_array(of.diffuse));
                specular.set(k, DVec3::from_array(of.specular.unwrap_or_default()));
                facing[k] = of.facing;
                alpha[k] = of.alpha;
            }
            let mut values = Vectors::ZERO;
            for k in 0..BLOCK {
                let of = Reflection {
                    normal: normals.get(k),
                    geometric: normals.get(k),
                    view: views.get(k),
                    facing: facing[k],
                    diffuse: diffuse.get(k).to_array(),
                    specular: None,
                    alpha: alpha[k],
                    is_mirror: false,
                    through: None,
                    near: 1.0,
                };
                values.set(k, of.glossy_value(specular.get(k), l.get(k)));
            }
            // The others one by one.
            for (k, point) in chosen.iter().enumerate() {
                let of = &self.reflections[*point as usize];
                if of.is_mirror || of.specular.is_none() {
                    let value = of.value(self.l.get(*point as usize));
                    values.set(k, DVec3::from_array(value));
                }
            }
            self.values.store(&values, begin);
            begin += BLOCK;
        }
    }
}

/// The least chance of either lobe of a metallic-roughness surface: what is found by one weighs at most ten times as much as by it alone.
const LEAST_CHANCE: f64 = 0.1;

#[inline]
fn mean([r, g, b]: [f64; 3]) -> f64 {
    (r + g + b) / 3.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn glossy_surfaces_in_loops_have_the_bits_of_single_ones() {
        for k in 0..500 {
            let part = |n: u32| f64::from(k * n % 101) / 100.0;
            let (n, v) = (
                DVec3::Z,
                DVec3::new(part(3), -part(5), 0.1 + part(7)).normalize(),
            );
            let l = DVec3::new(-part(11), part(13), 0.01 + part(17)).normalize();
            let (colour, look) = ([part(19), part(23), part(29)], [part(31), part(37)]);
            let one = Reflection::metallic_roughness(n, v, colour, look, 0.04).value(l);
            let many = |look| Coefficients::new(colour.into(), look, 0.04);
            let all = many(look).value_at::<false, false>(n, v, l).to_array();
            assert_eq!(one.map(f64::to_bits), all.map(f64::to_bits));
            // Surfaces as rough as can be, and metals, have loops of their own.
            let one = |m, r| Reflection::metallic_roughness(n, v, colour, [m, r], 0.04).value(l);
            let rough = many([look[0], 1.0]).value_at::<true, false>(n, v, l);
            assert_eq!(one(look[0], 1.0), rough.to_array());
            let metal = many([1.0, look[1]]).value_at::<false, true>(n, v, l);
            assert_eq!(one(1.0, look[1]), metal.to_array());
            let both = many([1.0, 1.0]).value_at::<true, true>(n, v, l);
            assert_eq!(one(1.0, 1.0), both.to_array());
        }
    }

    #[test]
    fn reflection_with_one_division_is_that_of_the_formulas() {
        // F D V by h, D and V each by itself; among them peaks of smooth surfaces, and grazing light.
        for k in 0..500 {
            let part = |n: u32| f64::from(k * n % 101) / 100.0;
            let v = DVec3::new(part(3), -part(5), 0.02 + part(7)).normalize();
            let l = match k % 4 {
                0 => DVec3::new(-v.x, -v.y, v.z),
                _ => DVec3::new(-part(11), part(13), 0.01 + part(17)).normalize(),
            };
            let colour = [part(19), part(23), part(29)];
            let r = Reflection::metallic_roughness(DVec3::Z, v, colour, [part(31), part(37)], 0.04);
            let h = (v + l).normalize();
            let gloss = r.distribution(h.z) * r.visibility(l.z);
            let weight = schlick(v.dot(h));
            for (c, value) in r.value(l).into_iter().enumerate() {
                let f0 = r.specular.unwrap()[c];
                let f = f0 + (1.0 - f0) * weight;
                let expected = (1.0 - f) * r.diffuse[c] / PI + f * gloss;
                // At peaks of α = 10⁻³ the 1 in D leaves α² = 10⁻⁶ of itself, with an error of some eps.
                let alpha = r.alpha * r.alpha;
                let bound = 1e-14 + 1e-15 / alpha;
                assert!(
                    (value - expected).abs() <= bound * expected,
                    "{k}: {value} {expected}"
                );
            }
        }
    }

    #[test]
    fn light_that_grazes_from_behind_has_the_normal_between() {
        // v + l = 0: h = n, so that n·h = 1 and v·h = n·v, which is kept above 0.
        let r = Reflection::metallic_roughness(DVec3::Z, DVec3::X, [0.5; 3], [1.0, 0.5], 0.04);
        let gloss = r.distribution(1.0) * r.visibility(0.0);
        let expected = gloss * (0.5 + 0.5 * schlick(r.facing));
        let value = r.value(DVec3::NEG_X)[0];
        assert!(
            (value - expected).abs() < 1e-14 * expected,
            "{value} {expected}"
        );
    }

    /// Of a grid of n × n points in the unit square.
    fn grid(n: usize) -> impl Iterator<Item = [f64; 2]> {
        let at = move |k: usize| (k as f64 + 0.5) / n as f64;
        (0..n * n).map(move |k| [at(k % n), at(k / n)])
    }

    fn view(cosine: f64) -> DVec3 {
        DVec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine)
    }

    #[test]
    fn drawn_directions_give_the_integral_of_the_specular_part() {
        // ∫ f (n·l) dω of white metal over the hemisphere: by z = n·l and azimuth, and by drawing.
        for (roughness, cosine) in [(0.5, 0.9), (0.7, 0.3), (1.0, 0.6)] {
            let r = Reflection::metallic_roughness(
                DVec3::Z,
                view(cosine),
                [1.0; 3],
                [1.0, roughness],
                0.04,
            );
            let n = 400;
            let uniform = grid(n).map(|[x, y]| {
                let (z, phi) = (x, TAU * y);
                let s = (1.0 - z * z).sqrt();
                r.value(DVec3::new(s * libm::cos(phi), s * libm::sin(phi), z))[0] * z * TAU
            });
            let uniform = uniform.sum::<f64>() / (n * n) as f64;
            let drawn = grid(n).filter_map(|u| Some(r.sample_specular(u)?.1[0]));
            let drawn = drawn.sum::<f64>() / (n * n) as f64;
            assert!(
                (uniform - drawn).abs() < 2e-3,
                "{roughness} {cosine}: {uniform} {drawn}"
            );
            assert!(drawn < 1.0 + 1e-9);
        }
    }

    #[test]
    fn directions_of_all_of_the_reflection_give_its_integral() {
        for (metallic, roughness, cosine) in [(0.0, 0.5, 0.8), (0.4, 0.7, 0.4), (1.0, 0.6, 0.9)] {
            let colour = [0.9, 0.6, 0.3];
            let r = Reflection::metallic_roughness(
                DVec3::Z,
                view(cosine),
                colour,
                [metallic, roughness],
                0.04,
            );
            let n = 600;
            let (mut uniform, mut drawn, mut all) = ([0.0; 3], [0.0; 3], 0.0);
            for [x, y] in grid(n) {
                let s = (1.0 - x * x).sqrt();
                let l = DVec3::new(s * libm::cos(TAU * y), s * libm::sin(TAU * y), x);
                let value = r.value(l);
                let scattered = r.sample([x, y]);
                for c in 0..3 {
                    uniform[c] += value[c] * x * TAU / (n * n) as f64;
                    drawn[c] += scattered.map_or(0.0, |s| s.weight[c]) / (n * n) as f64;
                }
                all += r.density(l) * TAU / (n * n) as f64;
            }
            for (a, b) in uniform.into_iter().zip(drawn) {
                assert!((a - b).abs() < 3e-3 * a, "{metallic} {roughness}: {a} {b}");
            }
            // The density is 1 in all, less what goes into the surface.
            let lost = grid(n).filter(|u| r.sample(*u).is_none()).count();
            let kept = 1.0 - lost as f64 / (n * n) as f64;
            assert!((all - kept).abs() < 5e-3, "{metallic}: {all} {kept}");
        }
    }

    #[test]
    fn a_mirror_sends_all_into_one_direction() {
        let v = view(0.6);
        let r = Reflection::metallic_roughness(DVec3::Z, v, [0.9, 0.8, 0.7], [1.0, 0.0], 0.04)
            .as_mirror();
        let s = r.sample([0.3, 0.8]).unwrap();
        assert!((s.l - DVec3::new(-v.x, -v.y, v.z)).length() < 1e-15);
        // Schlick: f₀ + (1 − f₀) 0.4⁵.
        assert!((s.weight[1] - (0.8 + 0.2 * 0.01024)).abs() < 1e-15);
        assert!(s.density.is_infinite());
        assert_eq!(r.value(s.l), [0.0; 3]);
    }

    #[test]
    fn many_values_have_the_bits_of_single_ones() {
        let of = |k: u32| {
            let cosine = 0.05 + 0.9 * f64::from(k % 17) / 17.0;
            let colour = [0.9, 0.5, 0.1 * f64::from(k % 9)];
            match k % 5 {
                0 => Reflection::diffuse(DVec3::Z, colour),
                1 => {
                    Reflection::metallic_roughness(DVec3::Z, view(cosine), colour, [1.0, 0.0], 0.04)
                        .as_mirror()
                }
                _ => {
                    let roughness = f64::from(k % 7) / 6.0;
                    Reflection::metallic_roughness(
                        DVec3::Z,
                        view(cosine),
                        colour,
                        [0.3, roughness],
                        0.04,
                    )
                }
            }
        };
        let reflections: Vec<_> = (0..150).map(of).collect();
        let mut l = Columns::default();
        for k in 0..150 {
            l.push(view(0.01 + 0.006 * f64::from(k)));
        }
        let chosen: Vec<u32> = (0..150).filter(|k| k % 11 != 3).collect();
        let mut values = Columns::default();
        Reflection::values(&reflections, &chosen, &l, &mut values);
        for (at, k) in chosen.iter().map(|k| *k as usize).enumerate() {
            assert_eq!(
                values.get(at).to_array(),
                reflections[k].value(l.get(k)),
                "{k}"
            );
        }
    }

    #[test]
    fn glass_reflects_by_fresnel_and_bends_by_snell() {
        // Of normal incidence ((n − 1)/(n + 1))², in glass of 1.5 as from air; nothing is polarized at Brewster's angle, whose tangent is n, and
        // (n² − 1)²/(n² + 1)²/2 is reflected there; beyond the critical angle, sin θ = 1/n, all of it.
        let n = 1.5;
        let glass = |v, near: f64, far: f64| {
            let r = Reflection::metallic_roughness(DVec3::Z, v, [1.0; 3], [0.0, 0.0], 0.04);
            r.within(near).as_glass(1.0, far, true)
        };
        let reflected = |r: Reflection| r.through.unwrap().reflected;
        assert!((reflected(glass(DVec3::Z, 1.0, n)) - 0.04).abs() < 1e-15);
        assert!((reflected(glass(DVec3::Z, n, 1.0)) - 0.04).abs() < 1e-15);
        let brewster = view(1.0 / (1.0 + n * n).sqrt());
        let expected = 0.5 * ((n * n - 1.0) / (n * n + 1.0)).powi(2);
        assert!((reflected(glass(brewster, 1.0, n)) - expected).abs() < 1e-15);
        let beyond = glass(view(0.74), n, 1.0);
        assert!(0.74f64 < (1.0 - 1.0 / (n * n)).sqrt() && reflected(beyond.clone()) == 1.0);
        assert!(beyond.sample([0.999, 0.5]).unwrap().l.z > 0.0);
        // A direction through: n₁ sin θ₁ = n₂ sin θ₂ on the other side, and radiance as n².
        let s = glass(view(0.6), 1.0, n).sample([0.95, 0.5]).unwrap();
        assert!((s.l - DVec3::new(-0.8 / n, 0.0, -(1.0 - 0.64 / (n * n)).sqrt())).length() < 1e-15);
        assert!((s.index, s.density) == (n, f64::INFINITY));
        let drawn = grid(200).map(|u| glass(view(0.6), 1.0, n).sample(u).unwrap());
        let (mut up, mut down) = (0.0, 0.0);
        for s in drawn {
            *if s.l.z > 0.0 { &mut up } else { &mut down } += s.weight[0] / 40_000.0;
        }
        let f = reflected(glass(view(0.6), 1.0, n));
        assert!(
            (up - f).abs() < 1e-3 && (down - (1.0 - f) / (n * n)).abs() < 1e-3,
            "{up} {down} {f}"
        );
    }

    #[test]
    fn glass_is_drawn_as_a_mirror_as_far_as_it_is_one() {
        let glass = |v, index: f64| {
            let r = Reflection::metallic_roughness(DVec3::Z, v, [1.0; 3], [0.0, 0.0], 0.04);
            r.within(1.0).as_glass(1.0, index, true)
        };
        // Of index 1 nothing is reflected, and each draw goes through with all of the light.
        for cosine in [1.0, 0.6, 0.05] {
            for u in grid(50) {
                let s = glass(view(cosine), 1.0).sample(u).unwrap();
                assert!(s.l.z < 0.0 && s.weight.iter().all(|w| (w - 1.0).abs() < 1e-12));
            }
        }
        // Of others each part is drawn with its chance and weighs what it has over that.
        for (cosine, index) in [
            (1.0, 1.05),
            (1.0, 1.3),
            (1.0, 1.5),
            (0.3, 1.5),
            (0.002, 1.5),
        ] {
            let r = glass(view(cosine), index);
            let f = r.through.as_ref().unwrap().reflected;
            let q = r.specular_share();
            let through = (1.0 - f) / (index * index);
            for (at, up, part) in [
                (1e-9, true, f / q),
                (1.0 - 1e-9, true, f / q),
                (1.0 + 1e-9, false, through / (1.0 - q)),
                (1.0 / q - 1e-9, false, through / (1.0 - q)),
            ] {
                let s = r.sample([at * q, 0.5]).unwrap();
                let weight = s.weight[0];
                assert!(
                    (s.l.z > 0.0) == up && (weight / part - 1.0).abs() < 1e-9,
                    "{index} {at}"
                );
            }
            assert!(
                q >= f.min(0.1) && q <= f.max(0.1) && q <= 2.5 * f,
                "{index}: {q} {f}"
            );
            assert!(1.0 - q <= 2.5 * (1.0 - f), "{index}: {q} {f}");
        }
        assert_eq!([0.0, 0.5, 1.0].map(chance_of_mirror), [0.0, 0.5, 1.0]);
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
