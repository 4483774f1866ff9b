//! Illumination by the sky of surfaces at rest in a moving frame.
//!
//! In the frame F the sky has the radiance L_F(d_F) = W⁻ᵖ L(d) along the aberrated direction d_F, and dω_F = W² dω, so an unoccluded
//! surface of normal n receives
//!
//! ```text
//! E_F(n) = ∫ L_F max(0, n·d_F) dω_F = ∫ W²⁻ᵖ L(d) max(0, n·d_F) dω.
//! ```
//!
//! The integral is a sum over the texels of a grid of the world's sphere ([`grid`](super::grid)), each with its mean L, the d_F and W of
//! its centre and its own solid angle. The texels are grouped into 96 × 48 blocks, 3.75° wide: for each, Σ dE and Σ d_F dE are stored, and
//! with d̄ their quotient a block contributes with the cosine max(0, n·d̄), which is exact unless the horizon of n crosses it. E_F is
//! stored at 6 × 33² normals on the faces of a cube and interpolated bilinearly: max(0, cos) to (4°)²/8 = 6·10⁻⁴, and to 4°/4 = 1.6·10⁻²
//! where a block sets. The few blocks that send more than a fiftieth of the total, such as one with a sun, are therefore excluded and
//! summed one by one; the error of E_F is 2·10⁻³ of its largest value over n. For a background that is the same in all directions the
//! integral of [`even`](super::even) is used instead, with an error of 2·10⁻⁴ of E_F for each n. Light with a spectrum of its own has its
//! colour at W instead of W⁻ᵖ L, per texel, and per star. Occlusion is tested with directions from [`BoostedSky::sample`]. For those, and
//! for light paths, the stars of a block shine uniformly from the whole block: this conserves the mean, and no sampled direction hits a
//! disc some thousand times brighter than its surroundings. Mirrors show the discs.
//!
//! Directions are sampled by the cosine; if some block sends 8 times the mean, half of them are sampled by the light of blocks and their
//! texels instead, weighted with the mean of the two densities (Veach and Guibas, "Optimally combining sampling techniques", SIGGRAPH
//! 1995). The light of a sampled direction is the mean of its texel: a sun of a few texels is sampled in proportion to its brightness.

use std::f64::consts::{FRAC_1_PI, PI};
use std::sync::Arc;

use glam::DVec3;
use rayon::prelude::*;

use super::even::EvenSky;
use super::faces::{axes, on_cube};
use super::grid::{BLOCKS, LightGrid};
use super::{Background, Sky, sum};
use crate::accel::vectors::{VectorLoop, dispatch};
use crate::colour::Wavelengths;
use crate::light::Received;
use crate::light::reflection::by_cosine;
use crate::spacetime::{Boost, Direction, Rest, World};

/// The fraction of the total above which a block is summed by itself: at most as many blocks as its inverse.
const BRIGHT: f64 = 0.02;
/// Steps along an edge of a face of the cube of normals.
const STEPS: usize = 32;
/// Normals whose irradiance is summed together: their sums and components fill the registers of AVX2.
const TOGETHER: usize = 8;

/// The sky as seen by surfaces at rest in one frame.
#[derive(Debug)]
pub struct BoostedSky {
    world_from_rest: Boost<World, Rest>,
    rest_from_world: Boost<Rest, World>,
    received: Received,
    grid: Arc<LightGrid>,
    /// E_F by normal, of everything neither even nor bright; empty if there is nothing else.
    irradiance: Vec<[f64; 3]>,
    /// Blocks that send much of the total.
    bright: Vec<Beam>,
    /// E_F of an even background.
    even: Option<EvenSky>,
    /// W²⁻ᵖ L dω of the stars of each block; empty if there are none.
    stars: Vec<[f64; 3]>,
    /// Cumulative distribution over blocks of the light sent; empty if cosine sampling is as good.
    cumulative: Vec<f64>,
}

/// A sampled direction.
#[derive(Debug, Clone, Copy)]
pub struct SkySample {
    /// The direction in the world.
    pub d: Direction<World>,
    /// The direction in the rest frame.
    pub in_rest: DVec3,
    /// ω_rest/ω_world of light from there.
    pub rho: f64,
    /// Density per solid angle of the rest frame.
    pub density: f64,
}

impl SkySample {
    /// The light of `sky` from this direction: by channel, or at some wavelengths of the rest frame.
    #[inline]
    pub fn of<'a>(&self, sky: &'a Sky, wavelengths: Option<&'a Wavelengths>) -> FromSky<'a> {
        FromSky {
            sky,
            d: self.d,
            rho: self.rho,
            wavelengths,
        }
    }
}

/// Light of a sky from one direction.
#[derive(Debug, Clone, Copy)]
pub struct FromSky<'a> {
    /// The sky that was passed to [`BoostedSky::new`].
    pub sky: &'a Sky,
    /// The direction in the world.
    pub d: Direction<World>,
    /// ω_rest/ω_world.
    pub rho: f64,
    /// The wavelengths of the rest frame to evaluate; `None` for channels.
    pub wavelengths: Option<&'a Wavelengths>,
}

impl FromSky<'_> {
    /// The radiance of the background in the world.
    #[inline]
    fn background(&self) -> [f64; 3] {
        self.sky.background.radiance(self.d.unit(), 0.0)
    }
}

/// The light sent by a block, W²⁻ᵖ L dω, and its direction.
#[derive(Debug, Clone, Copy)]
struct Beam {
    /// The mean direction weighted by flux, in the rest frame: not a unit vector unless the light of the block comes from one point.
    in_rest: DVec3,
    flux: [f64; 3],
}

impl Beam {
    /// Its flux summed over channels; colours outside the gamut may have a sum below 0.
    fn size(&self) -> f64 {
        self.flux.iter().sum::<f64>().max(0.0)
    }

    /// Whether it sends much of the total `whole`.
    fn is_bright(&self, whole: f64) -> bool {
        self.size() > BRIGHT * whole
    }

    /// Adds its contribution to a surface with normal `n`.
    #[inline(always)]
    fn add_to(&self, sum: &mut [f64; 3], n: DVec3) {
        let cosine = n.dot(self.in_rest).max(0.0);
        for (sum, flux) in sum.iter_mut().zip(self.flux) {
            *sum += flux * cosine;
        }
    }
}

/// Sums over light: dE, and d_F |dE| with |dE| summed over channels.
#[derive(Debug, Clone, Copy, Default)]
struct Moment {
    flux: [f64; 3],
    directions: DVec3,
    size: f64,
}

impl Moment {
    fn add(&mut self, flux: [f64; 3], in_rest: DVec3) {
        // Colours outside the gamut may have a sum below 0.
        let size = flux.iter().sum::<f64>().max(0.0);
        self.flux = sum(self.flux, flux);
        self.directions += in_rest * size;
        self.size += size;
    }

    fn beam(&self) -> Beam {
        let is_any = self.size > 0.0;
        Beam {
            in_rest: if is_any {
                self.directions / self.size
            } else {
                DVec3::ZERO
            },
            flux: self.flux,
        }
    }
}

impl BoostedSky {
    /// `sky` without its sun, for surfaces at rest in the frame of `rest_from_world`, which receive the quantity `received`; `grid` has the
    /// radiance of the sky.
    pub fn new(
        sky: &Sky,
        grid: &Arc<LightGrid>,
        rest_from_world: &Boost<Rest, World>,
        received: Received,
    ) -> Self {
        let stars = stars(sky, grid, rest_from_world, received);
        let beams = beams(sky, grid, rest_from_world, received, &stars);
        let even = even(sky, rest_from_world, received);
        let lighting = match &even {
            None => beams.clone(),
            Some(_) => stars.iter().map(Moment::beam).collect(),
        };
        let whole: f64 = lighting.iter().map(Beam::size).sum();
        let (bright, others): (Vec<Beam>, Vec<Beam>) = lighting
            .into_iter()
            .filter(|beam| beam.flux != [0.0; 3])
            .partition(|beam| beam.is_bright(whole));
        // Each sum is taken in the order of the blocks, independent of the number of threads.
        let irradiance = match others.is_empty() {
            true => Vec::new(),
            false => {
                let normals: Vec<DVec3> = normals().collect();
                let mut table = vec![[0.0; 3]; normals.len()];
                let lit = table.par_chunks_mut(TOGETHER);
                lit.zip(normals.par_chunks(TOGETHER))
                    .for_each(|(sums, normals)| {
                        dispatch(Illumination {
                            beams: &others,
                            normals,
                            sums,
                        });
                    });
                table
            }
        };
        BoostedSky {
            world_from_rest: rest_from_world.inverse(),
            rest_from_world: *rest_from_world,
            received,
            grid: grid.clone(),
            irradiance,
            bright,
            even,
            stars: stars.iter().map(|of_block| of_block.flux).collect(),
            cumulative: cumulative(&beams, grid),
        }
    }

    /// E_F on an unoccluded surface with the unit normal `n`.
    #[inline]
    pub fn irradiance(&self, n: DVec3) -> [f64; 3] {
        let mut all = match &self.even {
            None => [0.0; 3],
            Some(even) => even.irradiance(n),
        };
        if !self.irradiance.is_empty() {
            all = sum(all, self.tabulated(n));
        }
        for beam in &self.bright {
            beam.add_to(&mut all, n);
        }
        all
    }

    #[inline]
    fn tabulated(&self, n: DVec3) -> [f64; 3] {
        let (face, [x, y]) = on_cube(n);
        // −1 to 1 is 0 to STEPS: the node before x and the rest. x = 1 belongs to the last step, so that the next node exists.
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

    /// L_F without the sun; stars shine uniformly from their whole block. By channel, or at some wavelengths of the frame if there are
    /// neither stars nor lines. For directions of [`BoostedSky::sample`]: if these are sampled by light, it is the mean of the texel.
    #[inline]
    pub fn mean_radiance(&self, from: &FromSky) -> [f64; 3] {
        let channels = match self.is_uneven() {
            false => from.background(),
            true => self.grid.radiance_about(self.grid.texel(from.d.unit())),
        };
        self.seen(channels, from)
    }

    /// L_F for a direction that a surface samples with this `density`. Light found by reflected rays and light found by
    /// [`BoostedSky::sample`] must be consistent, so this is also the mean of the texel, except for lobes narrower than a texel, which show
    /// the picture.
    #[inline]
    pub fn reflected_radiance(&self, from: &FromSky, density: f64) -> [f64; 3] {
        match self.shows_picture(from.d, from.rho, density) {
            true => self.seen(from.background(), from),
            false => self.mean_radiance(from),
        }
    }

    /// Whether a surface that samples a direction with this `density` has a lobe narrower than a texel there.
    #[inline]
    pub fn shows_picture(&self, d: Direction<World>, rho: f64, density: f64) -> bool {
        // dω_F = dω/ρ².
        density * self.grid.solid_angle_about(d.unit()) / (rho * rho) > 1.0
    }

    /// L_F if the background has the radiance `channels`.
    #[inline]
    fn seen(&self, channels: [f64; 3], from: &FromSky) -> [f64; 3] {
        let FromSky { sky, d, rho, .. } = *from;
        let w = 1.0 / rho;
        if let Some(wavelengths) = from.wavelengths {
            return self.seen_at(sky, channels, w, *wavelengths);
        }
        let mut seen = self.received.radiance(w, channels);
        if sky.has_spectra() {
            seen = sum(seen, sky.spectral_background(w));
        }
        // By dω_F = W² dω.
        match self.stars.is_empty() {
            true => seen,
            false => {
                let block = self.grid.texel(d.unit()).block;
                let solid_angle = self.grid.solid_angle_of_block(block);
                let stars = self.stars[block];
                sum(seen, stars.map(|flux| flux * (rho * rho / solid_angle)))
            }
        }
    }

    /// The radiance at some wavelengths of the frame if the background has the radiance `channels`, seen at `w`.
    #[inline]
    fn seen_at(&self, sky: &Sky, channels: [f64; 3], w: f64, wavelengths: Wavelengths) -> [f64; 3] {
        let seen = self.received.at(w, channels, wavelengths);
        sum(seen, sky.spectral_at(w, wavelengths))
    }

    /// L_F with the sun, and with stars as discs.
    #[inline]
    pub fn radiance_with_sun(&self, from: &FromSky) -> [f64; 3] {
        let (sky, d, w) = (from.sky, from.d.unit(), 1.0 / from.rho);
        if let Some(wavelengths) = from.wavelengths {
            return self.seen_at(sky, sky.radiance(d), w, *wavelengths);
        }
        let seen = self.received.radiance(w, sky.radiance(d));
        match sky.has_spectra() {
            false => seen,
            true => sum(seen, sky.spectral(d, w)),
        }
    }

    /// The direction in the world of a direction of the rest frame, and ω_rest/ω_world of light from there.
    #[inline]
    pub fn in_world(&self, in_rest: DVec3) -> (Direction<World>, f64) {
        let (d, ratio) = self
            .world_from_rest
            .direction(Direction::from_unit(in_rest));
        (d, 1.0 / ratio)
    }

    /// A direction sampled by two numbers in [0, 1) for a surface with the unit normal `n`; `None` if it points below the surface.
    #[inline]
    pub fn sample(&self, n: DVec3, [x, y]: [f64; 2]) -> Option<SkySample> {
        // Half of the directions are sampled by the light of blocks, half by cosine; the density is the mean of both.
        let (d, in_rest, rho) = if x < 0.5 && !self.cumulative.is_empty() {
            let d = Direction::from_unit(self.in_a_block(2.0 * x, y));
            let (in_rest, rho) = self.rest_from_world.direction(d);
            (d, in_rest.unit(), rho)
        } else {
            // The remainder of x, again uniform.
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

    /// The direction `in_rest` as a sampled direction for a surface with the unit normal `n`.
    #[inline]
    pub fn sample_at(&self, n: DVec3, in_rest: DVec3) -> SkySample {
        let (d, rho) = self.in_world(in_rest);
        SkySample {
            d,
            in_rest,
            rho,
            density: self.density(n.dot(in_rest), d, rho),
        }
    }

    /// The density per solid angle of the rest frame with which [`BoostedSky::sample`] samples the direction with `d` in the world, at this
    /// cosine to the normal; `rho` is ω_rest/ω_world of light from there.
    #[inline]
    pub fn density(&self, cosine: f64, d: Direction<World>, rho: f64) -> f64 {
        match self.cumulative.is_empty() {
            true => cosine * FRAC_1_PI,
            // Per solid angle of the world, times dω/dω_F = 1/W² = ρ².
            false => {
                let texel = self.grid.texel(d.unit());
                let by_light = self.share(texel.block) * self.grid.density(texel) * rho * rho;
                0.5 * (cosine * FRAC_1_PI + by_light)
            }
        }
    }

    /// Whether directions are sampled by light because some blocks send much more than others.
    #[inline]
    pub fn is_uneven(&self) -> bool {
        !self.cumulative.is_empty()
    }

    /// The quantity that surfaces receive of the sky's light.
    #[inline]
    pub fn received(&self) -> Received {
        self.received
    }

    /// The fraction of the total sent by a block.
    #[inline]
    fn share(&self, block: usize) -> f64 {
        let before = block.checked_sub(1).map_or(0.0, |k| self.cumulative[k]);
        self.cumulative[block] - before
    }

    /// A direction of the world: `x` selects the block, the texel and the position across, `y` the position along.
    #[inline]
    fn in_a_block(&self, x: f64, y: f64) -> DVec3 {
        let last = self.cumulative.len() - 1;
        // The block whose part of the distribution contains x; within that part x is uniform again.
        let block = self.cumulative.partition_point(|sum| *sum <= x).min(last);
        let share = self.share(block);
        let rest = (x - (self.cumulative[block] - share)) / share.max(f64::MIN_POSITIVE);
        self.grid
            .sample(block, rest.clamp(0.0, 1.0 - f64::EPSILON), y)
    }
}

/// The light of a background that is the same in all directions; `None` for other backgrounds.
fn even(sky: &Sky, boost: &Boost<Rest, World>, received: Received) -> Option<EvenSky> {
    // The frame moves opposite to the world's motion in it.
    let (against, rapidity) = boost.motion();
    match &sky.background {
        Background::Uniform(radiance) => Some(EvenSky::new(-against, rapidity, |w| {
            received.radiance(w, *radiance)
        })),
        Background::Spectrum(table) => Some(EvenSky::new(-against, rapidity, |w| table.colour(w))),
        Background::Gradient(_) | Background::Image(_) => None,
    }
}

/// The light sent by each block, including `stars`.
fn beams(
    sky: &Sky,
    grid: &LightGrid,
    boost: &Boost<Rest, World>,
    received: Received,
    stars: &[Moment],
) -> Vec<Beam> {
    let table = match &sky.background {
        Background::Spectrum(table) => Some(table),
        _ => None,
    };
    let of_block = |block: usize| {
        let mut sent = stars.get(block).copied().unwrap_or_default();
        for texel in grid.texels(block) {
            let (in_rest, rho) = boost.direction(Direction::from_unit(grid.middle(texel)));
            let (w, solid_angle) = (1.0 / rho, grid.solid_angle(texel));
            // dE = W²⁻ᵖ L dω; light with a spectrum has its colour at W times W² dω.
            let flux = received.irradiance(w, grid.radiance(texel), solid_angle);
            sent.add(flux, in_rest.unit());
            if let Some(table) = table {
                let share = w * w * solid_angle;
                sent.add(table.colour(w).map(|c| c * share), in_rest.unit());
            }
        }
        sent.beam()
    };
    (0..BLOCKS).into_par_iter().map(of_block).collect()
}

/// The light of the stars of each block, and Σ of their directions weighted by it; empty if there are none.
fn stars(
    sky: &Sky,
    grid: &LightGrid,
    boost: &Boost<Rest, World>,
    received: Received,
) -> Vec<Moment> {
    let Some(map) = &sky.stars else {
        return Vec::new();
    };
    let mut blocks = vec![Moment::default(); BLOCKS];
    for star in map.stars() {
        // E = W²⁻ᵖ times that at rest, or W² Ω B(λ; T/W) for blackbodies.
        let (in_rest, rho) = boost.direction(Direction::from_unit(star.direction));
        let w = 1.0 / rho;
        let flux = match sky.thermal_stars {
            true => star.colour(w).map(|c| c * w * w),
            false => received.irradiance(w, star.channels(), 1.0),
        };
        blocks[grid.texel(star.direction).block].add(flux, in_rest.unit());
    }
    blocks
}

/// The sums of [`Beam::add_to`] for up to [`TOGETHER`] normals, with the same bits.
struct Illumination<'a> {
    beams: &'a [Beam],
    normals: &'a [DVec3],
    sums: &'a mut [[f64; 3]],
}

impl VectorLoop for Illumination<'_> {
    #[inline(always)]
    fn run(self) {
        // By component. Lanes beyond the last normal have a cosine of 0.
        let mut normals = [[0.0; TOGETHER]; 3];
        for (k, n) in self.normals.iter().enumerate() {
            [normals[0][k], normals[1][k], normals[2][k]] = n.to_array();
        }
        let mut sums = [[0.0; TOGETHER]; 3];
        // Beam by beam in the given order, so that each sum has the bits of `Beam::add_to`.
        for beam in self.beams {
            let [x, y, z] = beam.in_rest.to_array();
            let mut cosines = [0.0; TOGETHER];
            for k in 0..TOGETHER {
                let cosine = normals[0][k] * x + normals[1][k] * y + normals[2][k] * z;
                cosines[k] = if cosine > 0.0 { cosine } else { 0.0 };
            }
            for (sums, flux) in sums.iter_mut().zip(beam.flux) {
                for (sum, cosine) in sums.iter_mut().zip(&cosines) {
                    *sum += flux * cosine;
                }
            }
        }
        for (k, sum) in self.sums.iter_mut().enumerate() {
            *sum = sums.map(|of_channel| of_channel[k]);
        }
    }
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

/// The cumulative light of blocks over all channels, normalized to 1; empty for a dark or even sky.
fn cumulative(beams: &[Beam], grid: &LightGrid) -> Vec<f64> {
    let mut sum = 0.0;
    let sums = beams.iter().map(|beam| {
        sum += beam.size();
        sum
    });
    let sums: Vec<f64> = sums.collect();
    // Sampling by light pays where a block sends more than eight times the mean per solid angle; otherwise cosine sampling is enough.
    let per_solid_angle =
        |(block, beam): (usize, &Beam)| beam.size() / grid.solid_angle_of_block(block);
    let largest = beams
        .iter()
        .enumerate()
        .map(per_solid_angle)
        .fold(0.0, f64::max);
    match sum.is_finite() && largest * 4.0 * PI > 8.0 * sum {
        true => sums.into_iter().map(|part| part / sum).collect(),
        false => Vec::new(),
    }
}

#[cfg(test)]
mod tests;
