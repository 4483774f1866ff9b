//! The sun: a disc of uniform radiance, which never falls between the samples of a picture.
//!
//! Ahead of a fast camera it shrinks with W below a pixel. There it is widened as stars are, by the same derivation (at the head of
//! [`stars`](super::stars)): with the irradiance E = L π sin² ρ, and sin R of the width of pixels in the world, a direction sees
//! E · (L/E of the profile) · (W_d/W_s)ᵖ⁻² beyond its W_d⁻ᵖ, so the sum over pixels is that of the disc. Its colours are shifted with W_d.

use std::f64::consts::PI;

use glam::DVec3;

use super::cap::{Cap, Disc, reach};
use super::star::raised;
use super::{LookDirections, PixelAngles};
use crate::scene::model;

/// The sun: a disc around its direction.
#[derive(Debug)]
pub(super) struct Sun {
    direction: DVec3,
    disc: Disc,
    radiance: [f64; 3],
    /// sin ρ.
    sine: f64,
}

impl Sun {
    pub fn new(sun: &model::Sun) -> Sun {
        Sun {
            direction: sun.direction,
            disc: Disc::of(sun.radius),
            radiance: sun.radiance(),
            sine: libm::sin(sun.radius),
        }
    }

    /// Its radiance along the look direction `d`, if it is there.
    #[inline(always)]
    pub fn seen(&self, d: DVec3) -> Option<[f64; 3]> {
        let is_there = self.disc.around(self.direction, d);
        is_there.then_some(self.radiance)
    }

    /// Calls `each` with the index of each of `look` that sees it, and with its radiance, for pixels as wide as `angles` says.
    pub fn each_seen(
        &self,
        look: LookDirections,
        angles: PixelAngles,
        mut each: impl FnMut(usize, [f64; 3]),
    ) {
        let irradiance = self.radiance.map(|l| l * (PI * self.sine * self.sine));
        for (k, w) in angles.ratios.iter().enumerate() {
            let (d, reach) = (look.get(k), reach(self.sine, angles.pixel / w));
            // The disc itself, where pixels are narrow enough.
            if reach <= self.sine {
                if let Some(seen) = self.seen(d) {
                    each(k, seen);
                }
                continue;
            }
            let motion = angles.motions.get(k).unwrap_or(&angles.beaming.motion);
            let cap = Cap::of_discs(d, *w, [self.sine, reach], *motion);
            let [density, x] = cap.density(self.direction);
            if density > 0.0 {
                let density = density * raised(x, angles.power);
                each(k, irradiance.map(|e| e * density));
            }
        }
    }
}
