//! What falls from the sky on surfaces at rest in a frame that moves.
//!
//! In the frame F the sky has the radiance L_F(d_F) = W⁻ᵖ L(d) along the aberrated direction d_F, and dω_F = W² dω, so
//! that a surface of the normal n is lit, with nothing in the way, by
//!
//! ```text
//! E_F(n) = ∫ L_F max(0, n·d_F) dω_F = ∫ W²⁻ᵖ L(d) max(0, n·d_F) dω.
//! ```
//!
//! The integral is a sum over 96 × 48 cells of the world's sphere, of equal solid angle, each with the mean of L in it
//! (4 × 4 lookups in the picture's smaller sizes) and d_F and W of its middle; E_F is kept at 6 × 33² normals on the faces of a cube, and
//! interpolated bilinearly. Cell and step are 4° wide: a light that is as small as a cell is off by up to a cell's half,
//! and max(0, cos) is interpolated to (4°)²/8 = 6·10⁻⁴ of it, so that E_F is right to 2·10⁻³ of its largest value over n.
//! A background that is the same all around lights by the integral of [`even`](super::even) in place of that, right to 2·10⁻⁴ of E_F for each n. What has a spectrum of its own has its colour at W in place of W⁻ᵖ L, at
//! each of the lookups, and a star at its own. What is in the way is taken from it by [`BoostedSky::sample`]. There and where light is followed, the stars of a
//! cell shine from all of it: the mean is theirs, and no direction that is drawn meets a disc that is some thousand times as bright as what is about it. Mirrors show
//! the discs.
//!
//! Directions are drawn with the cosine; where some cell sends 8 times the mean, half of the time by what the cells send
//! in place of that, and weighed by the mean of the two densities (Veach and Guibas, "Optimally combining sampling techniques", SIGGRAPH 1995).

use std::f64::consts::{FRAC_1_PI, PI, TAU};

use glam::DVec3;
use rayon::prelude::*;

use super::even::EvenSky;
use super::faces::{axes, on_cube};
use super::panorama::arctan;
use super::{Background, Sky, sum};
use crate::light::Received;
use crate::light::reflection::by_cosine;
use crate::spacetime::{Boost, Direction, Rest, World};

/// Cells around and from pole to pole, and lookups along the edge of a cell.
const AROUND: usize = 96;
const BANDS: usize = 48;
const LOOKUPS: usize = 4;
/// The solid angle of a cell.
const CELL: f64 = 4.0 * PI / (AROUND * BANDS) as f64;
/// Steps along an edge of a face of the cube of normals.
const STEPS: usize = 32;

/// The sky as surfaces at rest in one frame see it.
#[derive(Debug)]
pub struct BoostedSky {
    world_from_rest: Boost<World, Rest>,
    rest_from_world: Boost<Rest, World>,
    received: Received,
    /// E_F by normal, of what is not even; empty where there is nothing else.
    irradiance: Vec<[f64; 3]>,
    /// E_F of an even background.
    even: Option<EvenSky>,
    /// W²⁻ᵖ L dω of the stars of each cell; empty where there are none.
    stars: Vec<[f64; 3]>,
    /// What all cells up to each send, in parts of the whole; empty where drawing by the cosine is as good.
    cumulative: Vec<f64>,
}

/// A direction drawn.
#[derive(Debug, Clone, Copy)]
pub struct SkySample {
    /// In the world.
    pub d: Direction<World>,
    /// In the rest frame.
    pub in_rest: DVec3,
    /// ω_rest/ω_world of light from there.
    pub rho: f64,
    /// Density per solid angle of the rest frame.
    pub density: f64,
}

/// What a cell sends, W²⁻ᵖ L dω, and from where.
struct Beam {
    in_rest: DVec3,
    flux: [f64; 3],
}

impl BoostedSky {
    /// `sky` without its sun, of whose light `received` comes to surfaces in the frame that `rest_from_world` leads to.
    pub fn new(sky: &Sky, rest_from_world: &Boost<Rest, World>, received: Received) -> Self {
        let (beams, stars) = beams(sky, rest_from_world, received);
        let even = even(sky, rest_from_world, received);
        // Each sum in the order of the cells, whatever the threads.
        let of = |beams: &[Beam]| -> Vec<[f64; 3]> {
            let normals: Vec<DVec3> = normals().collect();
            normals.par_iter().map(|n| irradiance(beams, *n)).collect()
        };
        let irradiance = match &even {
            None => of(&beams),
            Some(_) if stars.is_empty() => Vec::new(),
            Some(_) => of(&of_stars(&beams, &stars)),
        };
        BoostedSky {
            world_from_rest: rest_from_world.inverse(),
            rest_from_world: *rest_from_world,
            received,
            irradiance,
            even,
            stars,
            cumulative: cumulative(&beams),
        }
    }

    /// E_F on a surface of the unit normal `n`, with nothing in the way.
    #[inline]
    pub fn irradiance(&self, n: DVec3) -> [f64; 3] {
        match &self.even {
            None => self.tabulated(n),
            Some(even) if self.irradiance.is_empty() => even.irradiance(n),
            Some(even) => sum(even.irradiance(n), self.tabulated(n)),
        }
    }

    #[inline]
    fn tabulated(&self, n: DVec3) -> [f64; 3] {
        let (face, [x, y]) = on_cube(n);
        let at = |x: f64| {
            let x = 0.5 * (x + 1.0) * STEPS as f64;
            let first = (x as usize).min(STEPS - 1);
            (first, x - first as f64)
        };
        let ((j, right), (i, down)) = (at(x), at(y));
        let node = |i: usize, j: usize| self.irradiance[(face * (STEPS + 1) + i) * (STEPS + 1) + j];
        let [a, b, c, d] = [
            node(i, j),
            node(i, j + 1),
            node(i + 1, j),
            node(i + 1, j + 1),
        ];
        std::array::from_fn(|k| {
            let (top, bottom) = (a[k] + (b[k] - a[k]) * right, c[k] + (d[k] - c[k]) * right);
            top + (bottom - top) * down
        })
    }

    /// L_F of light from `d`, ω_rest/ω_world of which is `rho`, without the sun; stars shine from all of their cell.
    #[inline]
    pub fn radiance(&self, sky: &Sky, d: Direction<World>, rho: f64) -> [f64; 3] {
        let w = 1.0 / rho;
        let channels = sky.background.radiance(d.unit(), 0.0);
        let mut seen = self.received.radiance(w, channels);
        if sky.has_spectra() {
            seen = sum(seen, sky.spectral_background(w));
        }
        // Through dω_F = W² dω.
        match self.stars.is_empty() {
            true => seen,
            false => {
                let stars = self.stars[cell_of(d.unit())];
                sum(seen, stars.map(|flux| flux * (rho * rho / CELL)))
            }
        }
    }

    /// The same with the sun, and with stars as the discs that they are.
    #[inline]
    pub fn radiance_with_sun(&self, sky: &Sky, d: Direction<World>, rho: f64) -> [f64; 3] {
        let w = 1.0 / rho;
        let seen = self.received.radiance(w, sky.radiance(d.unit()));
        match sky.has_spectra() {
            false => seen,
            true => sum(seen, sky.spectral(d.unit(), w)),
        }
    }

    /// The world's direction of a direction of the rest frame, and ω_rest/ω_world of light from there.
    #[inline]
    pub fn in_world(&self, in_rest: DVec3) -> (Direction<World>, f64) {
        let (d, ratio) = self
            .world_from_rest
            .direction(Direction::from_unit(in_rest));
        (d, 1.0 / ratio)
    }

    /// A direction drawn by two numbers in [0, 1) for a surface of the unit normal `n`; none where it goes into it.
    #[inline]
    pub fn sample(&self, n: DVec3, [x, y]: [f64; 2]) -> Option<SkySample> {
        // Half of the directions are drawn by what cells send, half by cosine; the density is the mean of both.
        let (d, in_rest, rho) = if x < 0.5 && !self.cumulative.is_empty() {
            let d = Direction::from_unit(self.in_a_cell(2.0 * x, y));
            let (in_rest, rho) = self.rest_from_world.direction(d);
            (d, in_rest.unit(), rho)
        } else {
            // What is left of x, uniform again.
            let x = if self.cumulative.is_empty() {
                x
            } else {
                2.0 * x - 1.0
            };
            let in_rest = by_cosine(n, [x, y]);
            let (d, rho) = self.in_world(in_rest);
            (d, in_rest, rho)
        };
        let cosine = n.dot(in_rest);
        if cosine <= 0.0 {
            return None;
        }
        Some(SkySample {
            d,
            in_rest,
            rho,
            density: self.density(cosine, d, rho),
        })
    }

    /// The density per solid angle of the rest frame with which [`BoostedSky::sample`] draws a direction that is `d` in
    /// the world, at this cosine to the normal; `rho` is ω_rest/ω_world of light from there.
    #[inline]
    pub fn density(&self, cosine: f64, d: Direction<World>, rho: f64) -> f64 {
        match self.cumulative.is_empty() {
            true => cosine * FRAC_1_PI,
            // Per solid angle of the world, times dω/dω_F = 1/W² = ρ².
            false => 0.5 * (cosine * FRAC_1_PI + self.share(cell_of(d.unit())) / CELL * rho * rho),
        }
    }

    /// Whether some cells send so much more than others that directions are drawn by it.
    #[inline]
    pub fn is_uneven(&self) -> bool {
        !self.cumulative.is_empty()
    }

    /// What surfaces receive of the sky's light.
    #[inline]
    pub fn received(&self) -> Received {
        self.received
    }

    /// The part of the whole that a cell sends.
    #[inline]
    fn share(&self, cell: usize) -> f64 {
        let before = cell.checked_sub(1).map_or(0.0, |k| self.cumulative[k]);
        self.cumulative[cell] - before
    }

    /// A direction of the world in a cell drawn by `x`, which also places it across, and `y` along.
    #[inline]
    fn in_a_cell(&self, x: f64, y: f64) -> DVec3 {
        let last = self.cumulative.len() - 1;
        let cell = self.cumulative.partition_point(|sum| *sum <= x).min(last);
        let share = self.share(cell);
        let rest = (x - (self.cumulative[cell] - share)) / share.max(f64::MIN_POSITIVE);
        place(cell, rest.clamp(0.0, 1.0), y)
    }
}

/// Direction at the fractions (x, y) of a cell: cells go around from −π on, in bands of equal height from +Y down.
#[inline]
fn place(cell: usize, x: f64, y: f64) -> DVec3 {
    let longitude = TAU * (((cell % AROUND) as f64 + x) / AROUND as f64 - 0.5);
    let height = 1.0 - 2.0 * ((cell / AROUND) as f64 + y) / BANDS as f64;
    let across = (1.0 - height * height).max(0.0).sqrt();
    let (sine, cosine) = libm::sincos(longitude);
    DVec3::new(sine * across, height, -cosine * across)
}

/// What a background that is the same all around sends; none of others.
fn even(sky: &Sky, boost: &Boost<Rest, World>, received: Received) -> Option<EvenSky> {
    // The frame moves against the world that moves in it.
    let (against, rapidity) = boost.motion();
    match &sky.background {
        Background::Uniform(radiance) => Some(EvenSky::new(-against, rapidity, |w| {
            received.radiance(w, *radiance)
        })),
        Background::Spectrum(table) => Some(EvenSky::new(-against, rapidity, |w| table.colour(w))),
        Background::Gradient(_) | Background::Image(_) => None,
    }
}

/// The part of the stars of what cells send.
fn of_stars(beams: &[Beam], stars: &[[f64; 3]]) -> Vec<Beam> {
    let beam = |(beam, flux): (&Beam, &[f64; 3])| Beam {
        in_rest: beam.in_rest,
        flux: *flux,
    };
    beams.iter().zip(stars).map(beam).collect()
}

/// The cell in which a direction lies.
#[inline]
fn cell_of(d: DVec3) -> usize {
    let around = (arctan(d.x, -d.z) / TAU + 0.5) * AROUND as f64;
    let band = 0.5 * (1.0 - d.y) * BANDS as f64;
    (band as usize).min(BANDS - 1) * AROUND + (around as usize).min(AROUND - 1)
}

/// What all cells send, and the part of it that their stars do.
fn beams(sky: &Sky, boost: &Boost<Rest, World>, received: Received) -> (Vec<Beam>, Vec<[f64; 3]>) {
    let angle = TAU / (AROUND * LOOKUPS) as f64;
    let mut radiance = vec![[0.0; 3]; AROUND * BANDS];
    for (cell, mean) in radiance.iter_mut().enumerate() {
        for k in 0..LOOKUPS * LOOKUPS {
            let at = |k: usize| (k as f64 + 0.5) / LOOKUPS as f64;
            let d = place(cell, at(k % LOOKUPS), at(k / LOOKUPS));
            let sample = sky.background.radiance(d, angle);
            for (mean, sample) in mean.iter_mut().zip(sample) {
                *mean += sample / (LOOKUPS * LOOKUPS) as f64;
            }
        }
    }
    let beam = |(cell, radiance): (usize, [f64; 3])| {
        let (in_rest, rho) = boost.direction(Direction::from_unit(place(cell, 0.5, 0.5)));
        Beam {
            in_rest: in_rest.unit(),
            flux: received.irradiance(1.0 / rho, radiance, CELL),
        }
    };
    let mut beams: Vec<Beam> = radiance.into_iter().enumerate().map(beam).collect();
    if let Background::Spectrum(_) = sky.background {
        add_spectrum(&mut beams, sky, boost);
    }
    let stars = stars(sky, boost, received);
    for (beam, star) in beams.iter_mut().zip(&stars) {
        beam.flux = sum(beam.flux, *star);
    }
    (beams, stars)
}

/// What the stars of each cell send; none where there are none.
fn stars(sky: &Sky, boost: &Boost<Rest, World>, received: Received) -> Vec<[f64; 3]> {
    let Some(map) = &sky.stars else {
        return Vec::new();
    };
    let ratio = |d: DVec3| 1.0 / boost.direction(Direction::from_unit(d)).1;
    let mut cells = vec![[0.0; 3]; AROUND * BANDS];
    for star in map.stars() {
        let at = cell_of(star.direction);
        let flux = match sky.thermal_stars {
            true => {
                let w = ratio(star.direction);
                star.colour(w).map(|c| c * w * w)
            }
            // As what the middle of their cell sends.
            false => {
                let radiance = star.channels().map(|e| e / CELL);
                received.irradiance(ratio(place(at, 0.5, 0.5)), radiance, CELL)
            }
        };
        cells[at] = sum(cells[at], flux);
    }
    cells
}

/// Adds W² dω times the colour at W of a background that has a spectrum of its own.
fn add_spectrum(beams: &mut [Beam], sky: &Sky, boost: &Boost<Rest, World>) {
    let ratio = |d: DVec3| 1.0 / boost.direction(Direction::from_unit(d)).1;
    beams.par_iter_mut().enumerate().for_each(|(cell, beam)| {
        for k in 0..LOOKUPS * LOOKUPS {
            let at = |k: usize| (k as f64 + 0.5) / LOOKUPS as f64;
            let w = ratio(place(cell, at(k % LOOKUPS), at(k / LOOKUPS)));
            let share = w * w * CELL / (LOOKUPS * LOOKUPS) as f64;
            let seen = sky.spectral_background(w).map(|c| c * share);
            beam.flux = sum(beam.flux, seen);
        }
    });
}

fn irradiance(beams: &[Beam], n: DVec3) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for beam in beams {
        let cosine = n.dot(beam.in_rest).max(0.0);
        for (sum, flux) in sum.iter_mut().zip(beam.flux) {
            *sum += flux * cosine;
        }
    }
    sum
}

/// The nodes of [`BoostedSky::irradiance`].
fn normals() -> impl Iterator<Item = DVec3> {
    let nodes = STEPS + 1;
    let at = |k: usize| 2.0 * k as f64 / STEPS as f64 - 1.0;
    (0..6 * nodes * nodes).map(move |k| {
        let (axis, u, v) = axes(k / (nodes * nodes));
        (axis + u * at(k % nodes) + v * at(k / nodes % nodes)).normalize()
    })
}

/// Sums of what cells send over all channels, up to 1; empty for a dark or even sky.
fn cumulative(beams: &[Beam]) -> Vec<f64> {
    // Colours outside the gamut may have a sum below 0.
    let flux = |beam: &Beam| beam.flux.iter().sum::<f64>().max(0.0);
    let mut sum = 0.0;
    let sums = beams.iter().map(|beam| {
        sum += flux(beam);
        sum
    });
    let sums: Vec<f64> = sums.collect();
    let largest = beams.iter().map(flux).fold(0.0, f64::max);
    // Worth drawing by where a cell sends more than eight times the mean; otherwise cosines alone will do.
    match sum.is_finite() && largest * beams.len() as f64 > 8.0 * sum {
        true => sums.into_iter().map(|part| part / sum).collect(),
        false => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use super::super::{Star, StarMap};
    use super::*;
    use crate::colour::{ColourTable, Continuation, RgbShift, Scale, Spectrum, blackbody_colour};
    use crate::scene::model;
    use crate::spacetime::{Quantity, Velocity};

    fn uniform() -> Sky {
        Sky::new(
            &model::Sky {
                background: model::SkyRadiance::Uniform([1.0, 2.0, 0.5]),
                sun: None,
                stars: None,
                lights: true,
                shadows: true,
                span: 0..0,
            },
            None,
            Vec::new(),
            false,
        )
    }

    fn boost(beta: f64) -> Boost<Rest, World> {
        let rapidity = DVec3::new(2.0, -1.0, 0.5).normalize() * libm::atanh(beta);
        Boost::new(Velocity::from_rapidity(-rapidity).unwrap())
    }

    /// E_F of a uniform sky of radiance 1 as a plain sum over directions of the rest frame: L_F = (γ (1 + β c))⁴ with
    /// γ (1 + β c) = 1/(γ (1 − β c′)), in rings that are closer the nearer c′ is to 1.
    fn expected(beta: f64, tilt: f64) -> f64 {
        let gamma = 1.0 / (1.0 - beta * beta).sqrt();
        let (n, m) = (6000, 720);
        let mut sum = 0.0;
        let below_one = |k: f64| 2.0 * libm::expm1(-12.0 * k / f64::from(n)) / libm::expm1(-12.0);
        for k in 0..n {
            let (less, more) = (f64::from(k), f64::from(k + 1));
            let from_one = below_one(f64::from(n)) - below_one(more);
            let width = below_one(more) - below_one(less);
            let from_one = from_one + 0.5 * width;
            let c = 1.0 - from_one;
            let doppler = 1.0 / (gamma * (1.0 - beta) + gamma * beta * from_one);
            let s = (from_one * (2.0 - from_one)).sqrt();
            let around = (0..m).map(|i| {
                let phi = TAU * (f64::from(i) + 0.5) / f64::from(m);
                (c * libm::cos(tilt) + s * libm::sin(tilt) * libm::cos(phi)).max(0.0)
            });
            let mean = around.sum::<f64>() / f64::from(m);
            sum += doppler.powi(4) * mean * TAU * width;
        }
        sum
    }

    #[test]
    fn a_uniform_sky_lights_a_moving_surface_by_the_law() {
        for beta in [0.0, 0.5, 0.9, 0.99, 0.999] {
            let boost = boost(beta);
            let sky = BoostedSky::new(&uniform(), &boost, Received::Scaled(Quantity::Integrated));
            // The direction of motion of the frame, and one across.
            let along = DVec3::new(2.0, -1.0, 0.5).normalize();
            let across = along.any_orthonormal_vector();
            for tilt in [0.0, 0.4, 1.0, 1.4, FRAC_PI_2, 1.65, 2.0, 2.5, PI] {
                let n = along * libm::cos(tilt) + across * libm::sin(tilt);
                let [r, g, b] = sky.irradiance(n);
                let e = expected(beta, tilt);
                assert!((r - e).abs() < 2e-4 * e, "{beta} {tilt}: {r} {e}");
                assert!((g - 2.0 * r).abs() < 1e-12 * g && (b - 0.5 * r).abs() < 1e-12 * g);
            }
        }
    }

    /// A sky of Planck's law at T is one of T/W in each direction, for surfaces in motion too: by the same plain sum, seen from behind the motion, where it
    /// is cold.
    #[test]
    fn a_sky_of_a_blackbody_lights_the_far_side_of_what_moves() {
        let shape = crate::colour::SpectrumShape::Blackbody(5000.0);
        let spectrum = Spectrum::new(shape, Scale::Factor(1.0)).unwrap();
        let sky = Sky {
            background: Background::Spectrum(ColourTable::new(&spectrum)),
            ..uniform()
        };
        let (beta, motion) = (0.8, DVec3::new(2.0, -1.0, 0.5).normalize());
        let received = Received::Rgb(RgbShift::of(Continuation::Blackbody));
        let lit = BoostedSky::new(&sky, &boost(beta), received).irradiance(-motion);
        let (n, mut expected) = (20_000, [0.0; 3]);
        for k in 0..n {
            // c is the cosine to the normal, which looks back.
            let c = (f64::from(k) + 0.5) / f64::from(n);
            let w = (1.0 + beta * c) / (1.0 - beta * beta).sqrt();
            let seen = blackbody_colour(5000.0 / w).map(|l| l * TAU * c / f64::from(n));
            expected = sum(expected, seen);
        }
        for (lit, expected) in lit.into_iter().zip(expected) {
            assert!((lit - expected).abs() < 2e-4 * expected, "{lit} {expected}");
        }
    }

    #[test]
    fn drawn_directions_give_the_irradiance() {
        for beta in [0.0, 0.8] {
            let (sky, boost) = (uniform(), boost(beta));
            let boosted = BoostedSky::new(&sky, &boost, Received::Scaled(Quantity::Integrated));
            for n in [DVec3::Y, DVec3::new(0.6, 0.0, -0.8)] {
                let count = 300;
                let mut sum = 0.0;
                for k in 0..count * count {
                    let at = |k: usize| (k as f64 + 0.5) / count as f64;
                    if let Some(s) = boosted.sample(n, [at(k % count), at(k / count)]) {
                        let radiance = boosted.radiance(&sky, s.d, s.rho)[0];
                        sum += radiance * n.dot(s.in_rest) / s.density;
                    }
                }
                let (mean, e) = (sum / (count * count) as f64, boosted.irradiance(n)[0]);
                assert!((mean - e).abs() < 5e-3 * e, "{beta} {n}: {mean} {e}");
            }
        }
    }

    /// Discs of stars are met by a few of a million directions, and are as much brighter than what is about them: no sum of some draws would have
    /// their light.
    #[test]
    fn stars_light_surfaces_without_noise() {
        let direction = |k: u32| {
            let height = 1.0 - (2.0 * f64::from(k) + 1.0) / 400.0;
            let (sine, cosine) = libm::sincos(2.4 * f64::from(k));
            let across = (1.0 - height * height).sqrt();
            DVec3::new(sine * across, height, cosine * across)
        };
        let stars: Vec<_> = (0..400)
            .map(|k| Star::new(direction(k), 4000.0, 1e-3))
            .collect();
        for is_thermal in [false, true] {
            let sky = Sky {
                background: Background::Uniform([0.0; 3]),
                sun: None,
                stars: Some(StarMap::new(stars.clone(), 1e-3)),
                thermal_stars: is_thermal,
            };
            for beta in [0.0, 0.8] {
                let received = match is_thermal {
                    true => Received::Rgb(RgbShift::of(Continuation::Blackbody)),
                    false => Received::Scaled(Quantity::Integrated),
                };
                let boosted = BoostedSky::new(&sky, &boost(beta), received);
                let n = DVec3::new(0.6, 0.0, -0.8);
                // No multiple of the stars, whose cells would be met at their edges.
                let (count, mut sum, mut most) = (463, 0.0, 0.0f64);
                for k in 0..count * count {
                    let at = |k: usize| (k as f64 + 0.5) / count as f64;
                    if let Some(s) = boosted.sample(n, [at(k % count), at(k / count)]) {
                        let radiance = boosted.radiance(&sky, s.d, s.rho)[1];
                        let drawn = radiance * n.dot(s.in_rest) / s.density;
                        sum += drawn;
                        most = most.max(drawn);
                    }
                }
                let (mean, e) = (sum / (count * count) as f64, boosted.irradiance(n)[1]);
                assert!(
                    (mean - e).abs() < 0.03 * e,
                    "{is_thermal} {beta}: {mean} {e}"
                );
                assert!(most < 100.0 * e, "{is_thermal} {beta}: {most} {e}");
            }
        }
    }
}
