//! Interpolated normals of smooth surfaces, and their correction if they point too far away from the observer.
//!
//! If an interpolated normal replaces that of the triangle, n_g, it is n, flipped to the side of n_g that the observer is on. With χ = 1
//! if n·l and n_g·l have the same sign and otherwise 0, the surface has χ f in place of f: light from below it contributes nothing, and
//! it reflects no more than a surface with the normal n does. Such an f is not reciprocal (Veach, "Robust Monte Carlo Methods for Light
//! Transport Simulation", 1997, § 5.3); light is traced from the observer. Diffuse surfaces do not depend on v, and use n unchanged; for
//! others it is `bent`.

use glam::DVec3;

use super::Reflection;

/// The smallest cosine of a mirrored direction to the surface's normal, but at most [`PART`] of that of the view: with both, normals of
/// flat surfaces are unchanged.
const LEAST: f64 = 0.01;
const PART: f64 = 0.9;

impl Reflection {
    /// The normal on a surface with this geometric normal: on the side of the observer.
    pub fn on(self, geometric: DVec3) -> Self {
        Reflection { geometric, ..self }
    }

    /// The normal of the surface itself.
    pub fn geometric_normal(&self) -> DVec3 {
        self.geometric
    }

    /// Whether the shading normal differs from the geometric one.
    pub(crate) fn is_smooth(&self) -> bool {
        self.normal != self.geometric
    }

    /// Whether `l` is on the same side of the surface and of its normal: other light contributes nothing.
    #[inline]
    pub fn is_open(&self, l: DVec3) -> bool {
        (self.normal.dot(l) < 0.0) == (self.geometric.dot(l) < 0.0)
    }
}

/// A normal for view-dependent reflection: `normal`, unless that would mirror the view into the surface, whose own normal is `geometric`,
/// or point away from the view.
///
/// Then the mirrored direction r is lifted along n_g until n_g·r is the smallest allowed value, and the normal is halfway between this
/// and the view v, so that n·v > 0 and n·n_g > 0. The smallest value is that of Cycles' `ensure_valid_specular_reflection`; the rule is
/// that of Keller and others, "The Iray Light Transport Simulation and Rendering System", 2017 (arXiv 1705.01263), A.3, except for the
/// direction in which r is lifted, where n_g also works if n is nearly perpendicular to it.
pub(crate) fn bent(normal: DVec3, geometric: DVec3, view: DVec3) -> DVec3 {
    let mirrored = normal * (2.0 * normal.dot(view)) - view;
    let least = LEAST.min(PART * geometric.dot(view));
    let height = geometric.dot(mirrored);
    if height >= least {
        return normal;
    }
    // A direction mirrored straight down, or a view along the surface, leaves no direction to lift towards.
    let along = (mirrored - geometric * height).try_normalize();
    let lifted = along.map(|along| along * (1.0 - least * least).sqrt() + geometric * least);
    let between = lifted.and_then(|lifted| (lifted + view).try_normalize());
    between.filter(|n| n.dot(view) > 0.0).unwrap_or(geometric)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bent_normals_mirror_the_view_above_the_surface_and_are_continuous() {
        let unit = |height: f64, turn: f64| {
            let radius = (1.0 - height * height).sqrt();
            DVec3::new(radius * libm::cos(turn), radius * libm::sin(turn), height)
        };
        let (mut kept, mut lifted) = (0, 0);
        for k in 1..40_000u32 {
            let part = |n: u32| f64::from(k * n % 40_009) / 40_009.0;
            let (n, v) = (
                unit(part(7), 7.0 * part(11)),
                unit(part(13), 7.0 * part(17)),
            );
            let bent = bent(n, DVec3::Z, v);
            let mirrored = bent * (2.0 * bent.dot(v)) - v;
            let least = (0.9 * v.z).min(0.01);
            assert!(bent.is_normalized() && bent.dot(v) > 0.0 && bent.z > 0.0);
            assert!(mirrored.z >= least - 1e-12, "{n} {v}");
            let before = n * (2.0 * n.dot(v)) - v;
            if bent == n {
                kept += 1;
                assert!(before.z >= least);
                continue;
            }
            lifted += 1;
            assert!(before.z < least);
            // Lifted as far as necessary, in the plane of r and n_g.
            assert!((mirrored.z - least).abs() < 1e-12, "{n} {v}");
            assert!(before.cross(mirrored).z.abs() < 1e-9, "{n} {v}");
            // If nothing has to be lifted, the rule starts from n itself.
            if before.z > least - 1e-4 && n.dot(v) > 0.1 {
                assert!((bent - n).length() < 1e-3, "{n} {v}");
            }
        }
        assert!(kept > 10_000 && lifted > 10_000, "{kept} {lifted}");
    }

    #[test]
    fn normals_of_flat_surfaces_are_not_bent() {
        for k in 0..1000 {
            let v = DVec3::new(1.0, 0.0, f64::from(k) / 1000.0).normalize();
            assert_eq!(bent(DVec3::Z, DVec3::Z, v), DVec3::Z);
        }
        // A view along the surface and a direction mirrored straight down have normals, too.
        for (n, v) in [
            (DVec3::X, DVec3::X),
            (-DVec3::X, DVec3::X),
            (DVec3::X, DVec3::Z),
        ] {
            let bent = bent(n, DVec3::Z, v);
            assert!(bent.is_normalized() && bent.z >= 0.0, "{n} {v}: {bent}");
        }
    }
}
