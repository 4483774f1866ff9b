//! Projections that bend straight lines: fisheyes and the panorama.
//!
//! A *fisheye* shows the look direction at the angle θ from the forward axis at the distance F g(θ) from the
//! middle of the film, in pixels, in its own azimuth (W. J. Smith, "Modern Optical Engineering", §4.9; ISO 20462):
//!
//! | kind | g(θ) | sees up to | keeps |
//! |---|---|---|---|
//! | equidistant | θ | 180° | angles from the axis |
//! | equisolid | 2 sin(θ/2) | 180° | solid angles: a pixel sees 1/F² everywhere |
//! | orthographic | sin θ | 90° | the view of the celestial sphere from far outside, and projected solid angles |
//!
//! With ρ = r/F and the direction's part across the axis a multiple s of the film vector p/F,
//!
//! ```text
//! equidistant:   cos θ = cos ρ,       s = sin(ρ)/ρ
//! equisolid:     cos θ = 1 − ρ²/2,    s = √(1 − ρ²/4)        since sin θ = 2 sin(θ/2) cos(θ/2)
//! orthographic:  cos θ = √(1 − ρ²),   s = 1.
//! ```
//!
//! F follows from the horizontal field of view: half of it is at half the width. Film points beyond θ = 180°
//! (or 90°) see nothing.
//!
//! The *equirectangular* panorama has longitude λ along x, 0 at the forward axis and growing to the right, and
//! latitude φ along y, both F pixels per radian:
//!
//! ```text
//! D = cos φ (sin λ right + cos λ forward) + sin φ up.
//! ```
//!
//! A pixel of it sees the solid angle ∫ cos φ dφ dλ = (sin φ₁ − sin φ₀)/F: with a width of 2π F and a height of
//! π F they add up to 4π. Rows beyond the poles see nothing, nor do columns beyond 180° from the middle.
//!
//! Here D is a unit vector: there is no plane of a sensor behind the pinhole.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::{DMat3, DVec3};

use super::projection::{Linear, Projection};
use crate::accel::sincos::sincos_each;
use crate::accel::vectors::{BLOCK, Block};

/// How a fisheye's distances from the middle follow from angles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Radial {
    /// r = F θ.
    Equidistant,
    /// r = 2 F sin(θ/2).
    Equisolid,
    /// r = F sin θ.
    Orthographic,
}

impl Radial {
    /// g(θ), the distance from the middle per F.
    fn distance(self, theta: f64) -> f64 {
        match self {
            Radial::Equidistant => theta,
            Radial::Equisolid => 2.0 * libm::sin(0.5 * theta),
            Radial::Orthographic => libm::sin(theta),
        }
    }

    /// The largest ρ² that sees anything, plus an allowance for rounding at the edge of the widest possible field of view.
    fn limit(self) -> f64 {
        let most = match self {
            Radial::Equidistant => PI * PI,
            Radial::Equisolid => 4.0,
            Radial::Orthographic => 1.0,
        };
        most * (1.0 + 4.0 * f64::EPSILON)
    }

    /// cos θ and s at ρ².
    #[inline(always)]
    fn along_and_across(self, square: f64) -> [f64; 2] {
        match self {
            Radial::Equidistant => {
                let rho = square.sqrt();
                let (sin, cos) = libm::sincos(rho);
                [cos, sine_part(sin, rho)]
            }
            // Just beyond the edge, which `limit` allows, the roots would be NaN.
            Radial::Equisolid => [1.0 - 0.5 * square, (1.0 - 0.25 * square).max(0.0).sqrt()],
            Radial::Orthographic => [(1.0 - square).max(0.0).sqrt(), 1.0],
        }
    }

    /// The same for a block, with the same bits.
    #[inline(always)]
    fn along_and_across_each(self, squares: &Block, along: &mut Block, across: &mut Block) {
        match self {
            Radial::Equidistant => {
                let mut rho = *squares;
                for rho in &mut rho {
                    *rho = rho.sqrt();
                }
                sincos_each(&rho, across, along);
                for k in 0..BLOCK {
                    across[k] = sine_part(across[k], rho[k]);
                }
            }
            Radial::Equisolid | Radial::Orthographic => {
                for k in 0..BLOCK {
                    [along[k], across[k]] = self.along_and_across(squares[k]);
                }
            }
        }
    }
}

/// sin(ρ)/ρ.
#[inline(always)]
fn sine_part(sine: f64, rho: f64) -> f64 {
    if rho > 0.0 { sine / rho } else { 1.0 }
}

/// A film whose points represent angles.
#[derive(Debug, Clone, PartialEq)]
struct AngularFilm {
    /// Right, up and forward.
    axes: [DVec3; 3],
    /// Columns and rows.
    size: [f64; 2],
    /// F.
    focal: f64,
}

impl AngularFilm {
    fn stretched(&self, stretch: f64) -> Self {
        AngularFilm {
            focal: self.focal * stretch,
            ..self.clone()
        }
    }

    fn turned(&self, turn: DMat3) -> Self {
        AngularFilm {
            axes: self.axes.map(|axis| turn * axis),
            ..self.clone()
        }
    }

    /// p/F: right and up of the middle.
    #[inline(always)]
    fn place(&self, x: f64, y: f64) -> [f64; 2] {
        let [width, height] = self.size;
        [
            (x - 0.5 * width) / self.focal,
            (0.5 * height - y) / self.focal,
        ]
    }

    /// Turns the components of vectors along the axes into look directions, and records the original lengths.
    #[inline(always)]
    fn directions_and_lengths(&self, to: &mut [Block; 3], lengths: &mut Block) {
        let [right, up, forward] = self.axes;
        let [x, y, z] = to;
        for k in 0..BLOCK {
            let d = right * x[k] + up * y[k] + forward * z[k];
            lengths[k] = d.length();
            let d = d * (1.0 / lengths[k]);
            (x[k], y[k], z[k]) = (d.x, d.y, d.z);
        }
    }

    /// The film point that is `right` and `up` pixels from the middle.
    fn point(&self, right: f64, up: f64) -> [f64; 2] {
        let [width, height] = self.size;
        [0.5 * width + right, 0.5 * height - up]
    }
}

/// A fisheye; see the module.
#[derive(Debug, Clone, PartialEq)]
pub struct Fisheye {
    radial: Radial,
    film: AngularFilm,
}

impl Fisheye {
    /// A fisheye with unit axes right, up and forward, a horizontal field of view in radians (up to 2π; π where
    /// it is orthographic), and `size` in columns and rows.
    pub fn new(radial: Radial, axes: [DVec3; 3], horizontal_fov: f64, size: [f64; 2]) -> Self {
        // Half of the field of view is at half of the width.
        let focal = 0.5 * size[0] / radial.distance(0.5 * horizontal_fov);
        let film = AngularFilm { axes, size, focal };
        Fisheye { radial, film }
    }

    /// The position of a film point; for one that sees nothing, that of the middle, which looks forward.
    #[inline(always)]
    fn seen_place(&self, x: f64, y: f64) -> [f64; 2] {
        let [a, b] = self.film.place(x, y);
        // Selected without a branch: loops over film points vectorize.
        let is_beyond = a * a + b * b > self.radial.limit();
        [
            if is_beyond { 0.0 } else { a },
            if is_beyond { 0.0 } else { b },
        ]
    }

    pub(super) fn stretched(&self, stretch: f64) -> Self {
        Fisheye {
            film: self.film.stretched(stretch),
            ..*self
        }
    }

    pub(super) fn turned(&self, turn: DMat3) -> Self {
        Fisheye {
            film: self.film.turned(turn),
            ..*self
        }
    }
}

impl Projection for Fisheye {
    fn size(&self) -> [f64; 2] {
        self.film.size
    }

    fn axes(&self) -> [DVec3; 3] {
        self.film.axes
    }

    #[inline(always)]
    fn sees(&self, x: f64, y: f64) -> bool {
        let [a, b] = self.film.place(x, y);
        a * a + b * b <= self.radial.limit()
    }

    #[inline]
    fn components(&self, x: f64, y: f64) -> DVec3 {
        let [a, b] = self.seen_place(x, y);
        let [along, across] = self.radial.along_and_across(a * a + b * b);
        DVec3::new(a * across, b * across, along)
    }

    #[inline(always)]
    fn directions_and_lengths(
        &self,
        [x, y]: [&Block; 2],
        to: &mut [Block; 3],
        lengths: &mut Block,
    ) {
        // Right and up in units of F, then by s to the components of a unit vector.
        let [a, b, along] = &mut *to;
        let (mut squares, mut across) = ([0.0; BLOCK], [0.0; BLOCK]);
        for k in 0..BLOCK {
            [a[k], b[k]] = self.seen_place(x[k], y[k]);
            squares[k] = a[k] * a[k] + b[k] * b[k];
        }
        self.radial
            .along_and_across_each(&squares, along, &mut across);
        for k in 0..BLOCK {
            (a[k], b[k]) = (a[k] * across[k], b[k] * across[k]);
        }
        self.film.directions_and_lengths(to, lengths);
    }

    fn film_point(&self, v: DVec3) -> Option<[f64; 2]> {
        let across = libm::hypot(v.x, v.y);
        let theta = libm::atan2(across, v.z);
        // An orthographic lens sees the half space in front of it.
        let beyond = self.radial == Radial::Orthographic && v.z < 0.0;
        // A point straight behind is seen all around the edge.
        if beyond || !(across > 0.0 || v.z > 0.0) {
            return None;
        }
        let radius = self.film.focal * self.radial.distance(theta);
        let scale = if across > 0.0 { radius / across } else { 0.0 };
        Some(self.film.point(scale * v.x, scale * v.y))
    }

    fn footprint(&self, v: DVec3) -> f64 {
        // The larger of two magnifications: dθ/dr along the radius, sin θ/r around the axis.
        let theta = libm::atan2(libm::hypot(v.x, v.y), v.z);
        let along = match self.radial {
            Radial::Equidistant => 1.0,
            Radial::Equisolid => libm::cos(0.5 * theta),
            Radial::Orthographic => libm::cos(theta).max(0.0),
        };
        v.length() / (self.film.focal * along)
    }

    // Around the axis r/sin θ, which diverges behind the camera.
    fn density(&self) -> f64 {
        f64::INFINITY
    }

    fn linear(&self) -> Option<Linear> {
        None
    }
}

/// Whether a longitude and a latitude belong to a direction; branch-free, for vectorized loops.
#[inline(always)]
fn is_seen(longitude: f64, latitude: f64) -> bool {
    // Allows for rounding at an edge that is at 180 or 90 degrees.
    const EDGE: f64 = 1.0 + 4.0 * f64::EPSILON;
    (longitude.abs() <= PI * EDGE) & (latitude.abs() <= FRAC_PI_2 * EDGE)
}

/// The panorama; see the module.
#[derive(Debug, Clone, PartialEq)]
pub struct Equirectangular {
    film: AngularFilm,
}

impl Equirectangular {
    /// A panorama with unit axes right, up and forward, a horizontal field of view in radians, up to 2π, and
    /// `size` in columns and rows.
    pub fn new(axes: [DVec3; 3], horizontal_fov: f64, size: [f64; 2]) -> Self {
        let focal = size[0] / horizontal_fov;
        let film = AngularFilm { axes, size, focal };
        Equirectangular { film }
    }

    /// The longitude and latitude of a film point; for one that sees nothing, those of the middle, which looks forward.
    #[inline(always)]
    fn seen_place(&self, x: f64, y: f64) -> [f64; 2] {
        let [longitude, latitude] = self.film.place(x, y);
        let is_seen = is_seen(longitude, latitude);
        [
            if is_seen { longitude } else { 0.0 },
            if is_seen { latitude } else { 0.0 },
        ]
    }

    pub(super) fn stretched(&self, stretch: f64) -> Self {
        Equirectangular {
            film: self.film.stretched(stretch),
        }
    }

    pub(super) fn turned(&self, turn: DMat3) -> Self {
        Equirectangular {
            film: self.film.turned(turn),
        }
    }
}

impl Projection for Equirectangular {
    fn size(&self) -> [f64; 2] {
        self.film.size
    }

    fn axes(&self) -> [DVec3; 3] {
        self.film.axes
    }

    #[inline(always)]
    fn sees(&self, x: f64, y: f64) -> bool {
        let [longitude, latitude] = self.film.place(x, y);
        is_seen(longitude, latitude)
    }

    #[inline]
    fn components(&self, x: f64, y: f64) -> DVec3 {
        let [longitude, latitude] = self.seen_place(x, y);
        let (sin, cos) = libm::sincos(longitude);
        // sin φ up, and cos φ in the horizontal plane.
        let (up, level) = libm::sincos(latitude);
        DVec3::new(level * sin, up, level * cos)
    }

    #[inline(always)]
    fn directions_and_lengths(
        &self,
        [x, y]: [&Block; 2],
        to: &mut [Block; 3],
        lengths: &mut Block,
    ) {
        let (mut longitudes, mut latitudes) = ([0.0; BLOCK], [0.0; BLOCK]);
        for k in 0..BLOCK {
            [longitudes[k], latitudes[k]] = self.seen_place(x[k], y[k]);
        }
        let mut level = [0.0; BLOCK];
        let [right, up, forward] = &mut *to;
        sincos_each(&longitudes, right, forward);
        sincos_each(&latitudes, up, &mut level);
        for k in 0..BLOCK {
            (right[k], forward[k]) = (level[k] * right[k], level[k] * forward[k]);
        }
        self.film.directions_and_lengths(to, lengths);
    }

    fn film_point(&self, v: DVec3) -> Option<[f64; 2]> {
        let level = libm::hypot(v.x, v.z);
        // The poles are seen along a whole row.
        (level > 0.0).then(|| {
            let longitude = libm::atan2(v.x, v.z);
            let latitude = libm::atan2(v.y, level);
            let focal = self.film.focal;
            self.film.point(focal * longitude, focal * latitude)
        })
    }

    fn footprint(&self, v: DVec3) -> f64 {
        v.length() / self.film.focal
    }

    // Along circles of latitude 1/cos φ, which diverges at the poles.
    fn density(&self) -> f64 {
        f64::INFINITY
    }

    fn linear(&self) -> Option<Linear> {
        None
    }
}

#[cfg(test)]
mod tests;
