//! The light of a pulse at a diffuse surface.
//!
//! A pulse from a point at rest in the world sends I(t) per solid angle, a Gaussian of time with the integral
//! `intensity`. At a surface point hit at event E, the light left the source at E.ct − ηr, r the world
//! distance. In the surface's rest frame, with ρ = ω_rest/ω_world of that light and θ′ the angle of
//! incidence there,
//!
//! ```text
//! E′ = I(E.ct − ηr) ρ^(p−2) cos θ′ / r²,      L′ = albedo E′ / π,
//! ```
//!
//! since radiance scales with ρᵖ and solid angle with ρ⁻² (p by the declared quantity). A line of
//! wavelength λ₀ arrives, and leaves again, with λ₀/ρ (weighted by irradiance where several pulses meet).
//!
//! Linear RGB arrives as M(1/ρ) times what the source has, and leaves as its product with the albedo, component by
//! component: the light reflected is that of white light on the product of both colours. For a white source
//! that rests with the surface it is exact; for a coloured or shifted one the products of spectra and of colours differ.

use crate::colour::RgbShift;
use crate::scene::model::Pulse;
use crate::spacetime::{Direction, Event, NullRay, Quantity, WavelengthRatio, World};

/// The light of a pulse at a point of a surface.
#[derive(Debug, Clone, Copy)]
pub struct Arrival {
    /// Towards the source, in the world.
    pub d: Direction<World>,
    /// To the source: r.
    pub distance: f64,
    /// I(E.ct − ηr) for an intensity of 1.
    strength: f64,
}

impl Arrival {
    /// Of `pulse` at the point that `ray` hits at `s`, in a medium of index `index`; none while it is dark there.
    #[inline]
    pub fn at(pulse: &Pulse, ray: &NullRay<World>, s: f64, index: f64) -> Option<Self> {
        // By way of the camera's event, so that far from the world's origin no digits are lost.
        let camera = Event::ORIGIN + (ray.origin - pulse.origin);
        let way = camera + ray.tangent * s;
        let (to_source, since) = (-way.x, way.ct);
        let distance = to_source.length();
        let strength = gaussian((since - index * distance) / pulse.sigma) / pulse.sigma;
        let d = Direction::new(to_source)?;
        (strength != 0.0).then_some(Arrival {
            d,
            distance,
            strength,
        })
    }

    /// What falls on the surface, in its rest frame: E′.
    #[inline]
    ///
    /// `shift` is that of [`Quantity::Rgb`]: E′ = M(1/ρ) ρ⁻² I cos θ′ / r², since M has the power of a radiance.
    pub fn incident(
        &self,
        pulse: &Pulse,
        quantity: Quantity,
        shift: Option<&RgbShift>,
        rho: f64,
        cosine: f64,
    ) -> Incident {
        let w = WavelengthRatio(1.0 / rho);
        let r = self.distance;
        if let Some(shift) = shift {
            let factor = self.strength * (w.0 * w.0) * cosine / (r * r);
            return Incident {
                irradiance: shift.apply(w.0, pulse.intensity).map(|i| i * factor),
                wavelength_scale: 1.0,
            };
        }
        let factor = self.strength * quantity.irradiance_factor(w) * cosine / (r * r);
        Incident {
            irradiance: pulse.intensity.map(|i| i * factor),
            wavelength_scale: w.0,
        }
    }
}

/// The light of one pulse that falls on a surface.
#[derive(Debug, Clone, Copy)]
pub struct Incident {
    irradiance: [f64; 3],
    wavelength_scale: f64,
}

/// The light of all pulses that falls on a surface.
#[derive(Debug, Clone, Copy, Default)]
pub struct Irradiance {
    sum: [f64; 3],
    /// Of all channels.
    weight: f64,
    /// The same, times the wavelength at which it arrives over that of the source.
    weighted: f64,
}

impl Irradiance {
    /// Adds the light of one pulse.
    #[inline]
    pub fn add(&mut self, light: &Incident) {
        for (sum, part) in self.sum.iter_mut().zip(light.irradiance) {
            *sum += part;
            self.weight += part;
            self.weighted += part * light.wavelength_scale;
        }
    }

    /// The radiance that a surface of this albedo reflects: L′.
    #[inline]
    pub fn reflected(&self, albedo: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|c| albedo[c] * self.sum[c] / std::f64::consts::PI)
    }

    /// Wavelength of the light over that of the source.
    #[inline]
    pub fn wavelength_scale(&self) -> f64 {
        match self.weight > 0.0 {
            true => self.weighted / self.weight,
            false => 1.0,
        }
    }
}

/// The unit Gaussian; 0 where it is below the smallest f64 that matters (|x| > 8: 5·10⁻¹⁵).
#[inline]
fn gaussian(x: f64) -> f64 {
    if x.abs() > 8.0 {
        return 0.0;
    }
    libm::exp(-0.5 * x * x) / (std::f64::consts::TAU).sqrt()
}
