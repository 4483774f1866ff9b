//! What one ray sees of discs that are widened to about a pixel: the derivation at the head of [`stars`](super::stars), ray by ray.

use glam::DVec3;

use super::star::{Motion, raised};

/// sin R of a point divided by the width of a pixel: the zero of the fundamental.
pub(super) const REACH: f64 = 1.4;
/// The decrease of sin² R per sin² ρ, such that R = ρ at 1.4/√1.36 = 1.2 pixels.
pub(super) const LESS: f64 = 0.36;
/// The largest sin R of a level of stars, 2 to the power of −1, and of a disc in the camera's frame.
pub(super) const WIDEST: f64 = 0.5;

/// sin R of discs with sin ρ = `sine` for pixels of this width; `sine` or less if they are not widened.
#[inline(always)]
pub(super) fn reach(sine: f64, pixel: f64) -> f64 {
    let point = REACH * pixel;
    let square = point * point - LESS * sine * sine;
    square.max(0.0).sqrt()
}

/// A disc of directions d within the angular radius ρ of s, d·s > cos ρ: from the chord, |d − s|² < (2 sin(ρ/2))², which keeps the digits
/// of ρ. Those of cos ρ are lost below 10⁻⁸, where it rounds to 1. The components of d and s are rounded by 10⁻¹⁶.
#[derive(Debug, Clone, Copy)]
pub(super) struct Disc {
    chord_squared: f64,
}

impl Disc {
    pub fn of(radius: f64) -> Disc {
        let chord = 2.0 * libm::sin(0.5 * radius);
        Disc {
            chord_squared: chord * chord,
        }
    }

    /// Whether `d` is in the disc around `s`.
    #[inline(always)]
    pub fn around(self, s: DVec3, d: DVec3) -> bool {
        (d - s).length_squared() < self.chord_squared
    }
}

/// What one ray sees in the camera's frame: within sin R of the direction `d`.
pub(super) struct Cap {
    d: DVec3,
    /// W_d.
    ratio: f64,
    /// sin R.
    pub sine: f64,
    /// q² of discs.
    even: f64,
    pub motion: Motion,
}

impl Cap {
    /// For the direction `d`, seen at the ratio `w`, and points that are widened to this `sine` in the world.
    pub fn of_points(d: DVec3, w: f64, sine: f64, motion: Motion) -> Cap {
        Cap::of_discs(d, w, [0.0, sine], motion)
    }

    /// The same for discs with sin ρ = `own`, widened to `sine`.
    #[inline(always)]
    pub fn of_discs(d: DVec3, w: f64, [own, sine]: [f64; 2], motion: Motion) -> Cap {
        let ratio = 1.0 / motion.inverse_ratio(d);
        // As for many rays together, in `tally`.
        let (motion, ratio) = match w > 0.5 * ratio && w < 2.0 * ratio {
            true => (motion, ratio),
            false => (Motion::REST, 1.0),
        };
        // q = sin² ρ/sin² R, by the widths in the world.
        let q = (own / sine) * (own / sine);
        Cap {
            d,
            ratio,
            sine: (sine * ratio).min(WIDEST),
            even: q * q,
            motion,
        }
    }

    /// The axis and the bound of the cap of the world that the head of `stars` derives, s·axis > bound.
    pub fn in_world(&self) -> (DVec3, f64) {
        let square = self.sine * self.sine;
        // C² = 2 (1 − cos R), without a difference of nearly equal numbers.
        let chord = 2.0 * square / (1.0 + (1.0 - square).sqrt());
        let motion = &self.motion;
        let axis = 2.0 * self.ratio * self.d + motion.n * (motion.sinh * chord);
        (axis, 2.0 * self.ratio - chord * motion.gamma)
    }

    /// L/E of a disc around the direction `middle`, and W_d/W_s.
    #[inline(always)]
    pub fn density(&self, middle: DVec3) -> [f64; 2] {
        // W_d/W_s; with c the chord in the world C² = c² W_d W_s, and sin² θ = C² (1 − C²/4).
        let x = self.ratio * self.motion.inverse_ratio(middle);
        let chord = (middle - self.d).length_squared() * (self.ratio * self.ratio / x);
        let square = self.sine * self.sine;
        let part = 1.0 - chord * (1.0 - 0.25 * chord) / square;
        let world = self.ratio * self.ratio / (std::f64::consts::PI * square);
        let is_seen = chord < 2.0 && part > 0.0;
        let profile = 5.0 * world * (1.0 - self.even) * raised(part, 4) + world * self.even;
        [if is_seen { profile } else { 0.0 }, x]
    }
}
