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
//! wavelength λ₀ arrives, and leaves again, with λ₀/ρ (weighted by irradiance where several pulses meet).
//! Shadows are asked for last, for all points of a run together.

use super::emission::{Emission, SurfacePoint};
use super::emitter::TimeResolved;
use super::light::Light;
use super::occlusion::Question;
use super::run::Run;
use super::stats::Meter;
use super::surfaces::Surfaces;
use crate::camera::Departure;
use crate::scene::model::Pulse;
use crate::spacetime::{Direction, Event, Quantity, WavelengthRatio, World};

impl TimeResolved {
    /// Reflects `pulses` at the points of `run`: into `light`.
    pub(super) fn reflect<D: Departure, S: Surfaces, M: Meter>(
        &self,
        run: &Run<D, S>,
        albedo: usize,
        pulses: &[usize],
        light: &mut Light,
        meter: &mut M,
    ) {
        light.incident.clear();
        light
            .incident
            .resize(run.members.len(), Irradiance::default());
        for (pulse, quantity) in pulses.iter().filter_map(|k| self.pulses[*k].as_ref()) {
            self.shine(run, pulse, *quantity, light, meter);
        }
        for (k, point) in run.points().enumerate() {
            let albedo = self.base.radiance(albedo, &point);
            let Irradiance {
                sum,
                weight,
                weighted,
            } = light.incident[k];
            let radiance = std::array::from_fn(|c| albedo[c] * sum[c] / std::f64::consts::PI);
            light.push(Emission {
                wavelength_scale: if weight > 0.0 { weighted / weight } else { 1.0 },
                ..Emission::full(radiance, light.response)
            });
        }
    }

    /// Adds the light of one pulse to what falls on the points of `run`.
    fn shine<D: Departure, S: Surfaces, M: Meter>(
        &self,
        run: &Run<D, S>,
        pulse: &Pulse,
        quantity: Quantity,
        light: &mut Light,
        meter: &mut M,
    ) {
        let (surfaces, rays) = (run.traced.surfaces, &run.traced.rays);
        light.arriving.clear();
        light.questions.clear();
        for (k, point) in run.points().enumerate() {
            if let Some((incident, d, distance)) = self.incident(surfaces, pulse, quantity, &point)
            {
                light.arriving.push((k, incident));
                if pulse.shadows {
                    let question = Question::new(&point, d, distance);
                    light.questions.asked.push(question);
                }
            }
        }
        if pulse.shadows {
            surfaces.occlude(
                &mut light.questions,
                self.index,
                rays.method,
                meter.occlusion(),
            );
        }
        for (at, (k, incident)) in light.arriving.iter().enumerate() {
            if light.questions.blocked.get(at) != Some(&true) {
                light.incident[*k].add(incident);
            }
        }
    }

    /// The light of one pulse on the side of the surface that faces the camera, if nothing is in its way; and
    /// where it comes from: direction and distance in the world.
    fn incident<S: Surfaces>(
        &self,
        surfaces: &S,
        pulse: &Pulse,
        quantity: Quantity,
        point: &SurfacePoint,
    ) -> Option<(Incident, Direction<World>, f64)> {
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
        let w = WavelengthRatio(1.0 / rho);
        let factor = strength * quantity.irradiance_factor(w) * cosine / (r * r);
        let incident = Incident {
            irradiance: pulse.intensity.map(|i| i * factor),
            wavelength_scale: w.0,
        };
        Some((incident, d, r))
    }
}

/// The light of all pulses that falls on a surface.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Irradiance {
    sum: [f64; 3],
    /// Of all channels.
    weight: f64,
    /// The same, times the wavelength at which it arrives over that of the source.
    weighted: f64,
}

impl Irradiance {
    fn add(&mut self, light: &Incident) {
        for (sum, part) in self.sum.iter_mut().zip(light.irradiance) {
            *sum += part;
            self.weight += part;
            self.weighted += part * light.wavelength_scale;
        }
    }
}

/// The light of one pulse that falls on a surface.
#[derive(Debug, Clone, Copy)]
pub(super) struct Incident {
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
