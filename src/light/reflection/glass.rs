//! What goes through smooth glass, and how often it is drawn as a mirror; [`reflection`](crate::light::reflection) derives both.

use glam::DVec3;

/// What goes through a surface.
#[derive(Debug, Clone, Copy)]
pub(super) struct Through {
    /// t c (1 − m).
    pub colour: [f64; 3],
    /// Index on the other side.
    pub far: f64,
    /// F.
    pub reflected: f64,
    /// Along which light comes that goes through; none where all is reflected.
    pub l: Option<DVec3>,
}

impl Through {
    /// Through a surface with this normal, seen from `view` at the cosine `facing`, with the index `near` here and `far` beyond; a film
    /// without thickness where `solid` is false. `colour` is t c (1 − m).
    pub fn new(
        (normal, view, facing): (DVec3, DVec3, f64),
        [near, far]: [f64; 2],
        solid: bool,
        colour: [f64; 3],
    ) -> Self {
        let ratio = if solid { near / far } else { 1.0 };
        let (mut reflected, cosine) = fresnel(facing.min(1.0), far / near);
        if !solid {
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

/// The chance with which glass of this F is drawn as a mirror: F, but a tenth of all draws for either part, or 2.5 times its own where that is less.
/// So nothing is drawn for a part that is not there, and bright light in a faint reflection, as the 4 % of an index of 1.5, is found by a tenth.
#[inline]
pub(super) fn chance_of_mirror(reflected: f64) -> f64 {
    let least = |part: f64| (2.5 * part).min(0.1);
    reflected.clamp(least(reflected), 1.0 - least(1.0 - reflected))
}

/// F of light that falls with `cosine` on a body whose index is `ratio` times as high, and the cosine within; none where all is reflected.
#[inline]
fn fresnel(cosine: f64, ratio: f64) -> (f64, Option<f64>) {
    let within = 1.0 - (1.0 - cosine * cosine) / (ratio * ratio);
    if within <= 0.0 {
        return (1.0, None);
    }
    let within = within.sqrt();
    let s = (cosine - ratio * within) / (cosine + ratio * within);
    let p = (ratio * cosine - within) / (ratio * cosine + within);
    (0.5 * (s * s + p * p), Some(within))
}
