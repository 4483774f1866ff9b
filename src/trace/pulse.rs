//! The light of pulses, as diffuse surfaces reflect it.
//!
//! A pulse from a point at rest in the world sends I(t) per solid angle. At a surface point met at
//! event E, the light left the source at E.ct − ηr, r the world distance. In the surface's rest
//! frame, with ρ = ω_rest/ω_world of that light and θ′ the angle of incidence there,
//!
//! ```text
//! E′ = I(E.ct − ηr) ρ^(p−2) cos θ′ / r²,      L′ = albedo E′ / π,
//! ```
//!
//! since radiance scales with ρᵖ and solid angle with ρ⁻² (p by the declared quantity). A line of
//! wavelength λ₀ arrives, and leaves again, with λ₀/ρ.

use super::emission::SurfacePoint;
use super::emitter::TimeResolved;
use super::surfaces::Surfaces;
use crate::scene::model::Pulse;
use crate::spacetime::{Direction, Event, Quantity, WavelengthRatio, World};

impl TimeResolved {
    /// Irradiance of `pulses` on `point` in its rest frame, and the wavelength at which it arrives
    /// over that of the source (weighted by irradiance where several pulses meet).
    pub(super) fn irradiance<S: Surfaces>(
        &self,
        surfaces: &S,
        pulses: &[usize],
        point: &SurfacePoint,
    ) -> ([f64; 3], f64) {
        let mut sum = [0.0; 3];
        let (mut weight, mut weighted) = (0.0, 0.0);
        for (pulse, quantity) in pulses.iter().filter_map(|k| self.pulses[*k].as_ref()) {
            let Some(light) = self.incident(surfaces, pulse, *quantity, point) else {
                continue;
            };
            for (sum, part) in sum.iter_mut().zip(light.irradiance) {
                *sum += part;
                weight += part;
                weighted += part * light.wavelength_scale;
            }
        }
        (sum, if weight > 0.0 { weighted / weight } else { 1.0 })
    }

    /// The light of one pulse on the side of the surface that faces the camera.
    fn incident<S: Surfaces>(
        &self,
        surfaces: &S,
        pulse: &Pulse,
        quantity: Quantity,
        point: &SurfacePoint,
    ) -> Option<Incident> {
        // By way of the camera's event, so that far from the world's origin no digits are lost.
        let camera = Event::ORIGIN + (point.ray.origin - pulse.origin);
        let way = camera + point.ray.tangent * point.hit.s;
        let (to_source, since) = (-way.x, way.ct);
        let r = to_source.length();
        let strength = gaussian((since - self.index * r) / pulse.sigma) / pulse.sigma;
        let d = Direction::<World>::new(to_source)?;
        let (d_rest, rho) = surfaces.turned(point.frame, d);
        let cosine = point.facing_normal().dot(d_rest.unit());
        if strength == 0.0 || cosine <= 0.0 {
            return None;
        }
        if pulse.shadows && surfaces.occluded(point, d, self.index, r) {
            return None;
        }
        let w = WavelengthRatio(1.0 / rho);
        let factor = strength * quantity.irradiance_factor(w) * cosine / (r * r);
        Some(Incident {
            irradiance: pulse.intensity.map(|i| i * factor),
            wavelength_scale: w.0,
        })
    }
}

/// Light that falls on a surface.
struct Incident {
    irradiance: [f64; 3],
    wavelength_scale: f64,
}

/// The unit Gaussian; 0 where it is below the smallest f64 that matters (|x| > 8: 5·10⁻¹⁵).
fn gaussian(x: f64) -> f64 {
    if x.abs() > 8.0 {
        return 0.0;
    }
    libm::exp(-0.5 * x * x) / (std::f64::consts::TAU).sqrt()
}
