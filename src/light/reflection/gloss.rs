//! Surfaces of the metallic-roughness model for loops over many, with the bits of single evaluations.

use std::f64::consts::{FRAC_1_PI, PI};

use glam::DVec3;

use crate::accel::vectors::{BLOCK, Columns};

/// The smallest α: a mirror keeps a highlight of some arc minutes.
const SMOOTHEST: f64 = 1e-3;

/// |v + l|² of directions that are opposite up to rounding, whose sum points anywhere, is above this, or 0: its square does not
/// underflow.
const LEAST_SQUARE: f64 = 1e-60;

/// The coefficients of the reflection in the metallic-roughness model.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Coefficients {
    pub(super) f0: DVec3,
    /// 1 − f₀.
    pub(super) rest: DVec3,
    /// c (1 − m)/π.
    pub(super) diffuse: DVec3,
    pub(super) alpha: f64,
}

impl Coefficients {
    /// For this base colour, metalness and roughness, and a dielectric with this f₀.
    #[inline(always)]
    pub fn new(colour: DVec3, [metallic, roughness]: [f64; 2], dielectric: f64) -> Self {
        let [diffuse, f0] = diffuse_and_specular(colour.to_array(), metallic, dielectric);
        let f0 = DVec3::from_array(f0);
        Coefficients {
            f0,
            rest: DVec3::ONE - f0,
            diffuse: DVec3::from_array(diffuse) * FRAC_1_PI,
            alpha: alpha(roughness),
        }
    }

    /// f for light from `l`, for the view and n·v; `ROUGHEST` says that α is 1, and `METAL` that there is no diffuse part.
    #[inline(always)]
    pub(super) fn value<const ROUGHEST: bool, const METAL: bool>(
        &self,
        normal: DVec3,
        (view, facing): (DVec3, f64),
        l: DVec3,
    ) -> DVec3 {
        let (gloss, along) = self.gloss_and_cosine::<ROUGHEST>(normal, (view, facing), l);
        let f = self.f0 + self.rest * schlick(along);
        match METAL {
            true => f * gloss,
            false => (DVec3::ONE - f) * self.diffuse + f * gloss,
        }
    }

    /// [`Self::value`] for the view alone, for loops over many.
    #[inline(always)]
    pub fn value_at<const ROUGHEST: bool, const METAL: bool>(
        &self,
        normal: DVec3,
        view: DVec3,
        l: DVec3,
    ) -> DVec3 {
        let facing = facing(normal, view);
        self.value::<ROUGHEST, METAL>(normal, (view, facing), l)
    }

    /// Whether α is 1, and whether there is no diffuse part.
    pub fn kind(&self) -> [bool; 2] {
        [self.alpha == 1.0, self.diffuse == DVec3::ZERO]
    }

    /// D V and v·h, with one division: with s = v + l, h = s/|s|, and v·h = |s|/2 as v and l are unit vectors,
    ///
    /// D = α² |s|⁴/(π ((n·s)² (α² − 1) + |s|²)²).
    ///
    /// With α = 1 the roots of V are 1, and D is 1/π.
    #[inline(always)]
    fn gloss_and_cosine<const ROUGHEST: bool>(
        &self,
        normal: DVec3,
        (view, facing): (DVec3, f64),
        l: DVec3,
    ) -> (f64, f64) {
        let sum = view + l;
        let square = sum.length_squared();
        // Light that grazes from behind may have no h: n replaces it.
        let has_half = square > LEAST_SQUARE;
        let along = 0.5 * square.sqrt();
        let along = if has_half { along } else { facing };
        let cosine = normal.dot(l);
        if ROUGHEST {
            return (0.5 / (PI * (cosine + facing)), along);
        }
        let (norm, height) = if has_half {
            (square, normal.dot(sum))
        } else {
            (1.0, 1.0)
        };
        let alpha = self.alpha * self.alpha;
        let masking = cosine * root(alpha, facing) + facing * root(alpha, cosine);
        // At the peak of a smooth surface its terms cancel down to α².
        let spread = height * height * (alpha - 1.0) + norm;
        // At the greatest roughness |v + l|² is a factor of both, and cancels.
        let is_roughest = alpha == 1.0;
        let norm = if is_roughest { 1.0 } else { norm * norm };
        let spread = if is_roughest { 1.0 } else { spread * spread };
        (0.5 * alpha * norm / (PI * spread * masking), along)
    }
}

/// Surfaces of the metallic-roughness model, by component.
#[derive(Debug, Default)]
pub(crate) struct Glosses {
    /// Whether all are equal: then only one block is stored.
    alike: bool,
    /// Base colours.
    pub colours: Columns,
    pub metallic: Vec<f64>,
    pub roughness: Vec<f64>,
    /// f₀ of the dielectric part, common to all.
    pub dielectric: f64,
}

impl Glosses {
    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.metallic.is_empty()
    }

    /// Removes all surfaces.
    pub fn clear(&mut self) {
        self.alike = false;
        self.colours.clear();
        self.metallic.clear();
        self.roughness.clear();
    }

    /// Gives all of them this base colour, metalness and roughness, and a dielectric with this f₀.
    pub fn fill_alike(
        &mut self,
        colour: [f64; 3],
        [metallic, roughness]: [f64; 2],
        dielectric: f64,
    ) {
        self.alike = true;
        self.dielectric = dielectric;
        self.colours.fill(BLOCK, DVec3::from_array(colour));
        self.metallic.resize(BLOCK, metallic);
        self.roughness.resize(BLOCK, roughness);
        // `resize` sets only elements that were missing.
        self.metallic.fill(metallic);
        self.roughness.fill(roughness);
    }

    /// The start index for the points from `begin` on.
    #[inline(always)]
    pub fn begin(&self, begin: usize) -> usize {
        if self.alike { 0 } else { begin }
    }

    /// The reflection shared by all, if they are equal.
    pub fn shared(&self) -> Option<Coefficients> {
        let look = || [self.metallic[0], self.roughness[0]];
        self.alike
            .then(|| Coefficients::new(self.colours.get(0), look(), self.dielectric))
    }
}

/// c (1 − m), and f₀ of a mixture of metal and a dielectric with this f₀.
#[inline(always)]
pub(super) fn diffuse_and_specular(
    colour: [f64; 3],
    metallic: f64,
    dielectric: f64,
) -> [[f64; 3]; 2] {
    [
        colour.map(|c| c * (1.0 - metallic)),
        colour.map(|c| dielectric * (1.0 - metallic) + c * metallic),
    ]
}

/// f₀ of a dielectric whose index is this many times that of the medium: 0.04 to the last bit for 1.5, as both squares are exact.
pub(crate) fn reflectance_of_index(relative: f64) -> f64 {
    (relative - 1.0) * (relative - 1.0) / ((relative + 1.0) * (relative + 1.0))
}

/// α of a perceptual roughness.
#[inline(always)]
pub(super) fn alpha(roughness: f64) -> f64 {
    (roughness * roughness).max(SMOOTHEST)
}

/// n·v. Grazing views may round to the other side.
#[inline(always)]
pub(super) fn facing(normal: DVec3, view: DVec3) -> f64 {
    normal.dot(view).max(1e-9)
}

/// √(α² + (1 − α²) c²), from α².
#[inline(always)]
pub(super) fn root(square: f64, cosine: f64) -> f64 {
    (square + (1.0 - square) * cosine * cosine).sqrt()
}

/// (1 − c)⁵.
#[inline(always)]
pub(super) fn schlick(cosine: f64) -> f64 {
    let x = (1.0 - cosine).clamp(0.0, 1.0);
    let square = x * x;
    square * square * x
}

#[cfg(test)]
mod tests;
