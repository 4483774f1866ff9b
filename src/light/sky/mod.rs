//! The sky: radiance from infinity in all directions of the world.
//!
//! A look direction d of the world sees the radiance L(d) of the background, of the sun and of the stars whose discs contain it. A moving
//! observer sees W⁻ᵖ L along the aberrated direction (W = ω_world/ω_observer, p by the declared quantity), and W is known for a camera ray
//! that hits nothing anyway; discs keep their radiance and change their solid angle with W², so their irradiance is that of
//! [`lamp`](super::lamp).
//!
//! If radiance has a spectrum (quantity RGB), stars are blackbodies, and the background may be one too, or have any other spectrum: an
//! observer sees L′(λ) = W⁻⁵ L(λ/W), which for a blackbody is exactly B(λ; T/W) (Peebles and Wilkinson, Phys. Rev. 174, 2168, 1968). For an
//! observer moving at β, W = γ (1 − β cos θ′) at the angle θ′ from the direction of motion, so a sky of T₀ has T′(θ′) = T₀/(γ (1 − β cos
//! θ′)) there: the dipole of the cosmic background. Colours are looked up by W in the tables of [`colour`](crate::colour), with an error of
//! 1·10⁻⁴.
//!
//! A pixel of the angle a sees a/W of the world's sky: ahead, where W is small, the sky is crowded, so pictures are looked up in a copy
//! with texels of that width (`panorama`), and stars and the sun are widened to at least about that (`stars`, `sun`).

mod boosted;
mod cap;
mod catalogue;
mod even;
mod faces;
mod grid;
mod levels;
mod panorama;
mod rays;
mod star;
mod star_map;
mod sun;
mod tally;

use glam::DVec3;

pub use boosted::{BoostedSky, FromSky, SkySample};
pub use catalogue::stars;
pub use grid::LightGrid;
pub use panorama::Panorama;
pub use star::{Beaming, Motion, Motions, Star};
pub use star_map::StarMap;
use sun::Sun;

use crate::accel::vectors::{BLOCK, Columns, VectorLoop, dispatch};
use crate::colour::{ColourTable, Line, Spectrum, Wavelengths};
use crate::scene::model;

/// A sky, ready for look-ups.
#[derive(Debug)]
pub struct Sky {
    background: Background,
    sun: Option<Sun>,
    stars: Option<StarMap>,
    /// Whether stars are seen as blackbodies; otherwise by the channels of their colour at rest.
    thermal_stars: bool,
}

#[derive(Debug)]
enum Background {
    Uniform([f64; 3]),
    Gradient(Gradient),
    Image(Panorama),
    /// The same in all directions.
    Spectrum(ColourTable),
}

/// A gradient from the horizon to the zenith, above a uniform ground.
#[derive(Debug, Clone, Copy)]
struct Gradient {
    zenith: [f64; 3],
    horizon: [f64; 3],
    ground: [f64; 3],
}

/// The width of pixels in the world: these angles for a camera at rest, and 1/W times these for a moving one.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PixelAngles<'a> {
    /// Angle of one sample's share of a pixel.
    pub angle: f64,
    /// Angle of a whole pixel where it is widest: the least width of stars and of the sun.
    pub pixel: f64,
    /// W by direction.
    pub ratios: &'a [f64],
    /// How stars are seen.
    pub beaming: Beaming,
    /// p − 2, where radiance by channel is scaled with W⁻ᵖ.
    pub power: i32,
    /// The observer's motion by direction, if it is not always that of `beaming`.
    pub motions: &'a [Motion],
}

/// Look directions of some rays in the world.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LookDirections<'a> {
    /// The directions of all rays.
    pub directions: &'a [DVec3],
    /// The indices of the rays in use.
    pub rays: &'a [u32],
}

impl LookDirections<'_> {
    /// The direction of ray `k` of those in use.
    #[inline(always)]
    fn get(&self, k: usize) -> DVec3 {
        self.directions[self.rays[k] as usize]
    }
}

impl Sky {
    /// `sky`, with its picture, if any, and its stars, which are seen as blackbodies if `thermal_stars` is set.
    pub fn new(
        sky: &model::Sky,
        panorama: Option<Panorama>,
        stars: Vec<Star>,
        thermal_stars: bool,
    ) -> Sky {
        let background = match (&sky.background, panorama) {
            (_, Some(panorama)) => Background::Image(panorama),
            (model::SkyRadiance::Uniform(radiance), _) => Background::Uniform(*radiance),
            (
                model::SkyRadiance::Gradient {
                    zenith,
                    horizon,
                    ground,
                },
                _,
            ) => Background::Gradient(Gradient {
                zenith: *zenith,
                horizon: *horizon,
                ground: *ground,
            }),
            (model::SkyRadiance::Spectrum(spectrum), _) => {
                Background::Spectrum(ColourTable::new(spectrum))
            }
            (model::SkyRadiance::Image { .. }, None) => Background::Uniform([0.0; 3]),
        };
        let radius = sky.stars.as_ref().map_or(0.0, |stars| stars.radius);
        Sky {
            background,
            sun: sky.sun.as_ref().map(Sun::new),
            stars: (!stars.is_empty()).then(|| StarMap::new(stars, radius)),
            thermal_stars,
        }
    }

    /// Whether [`Sky::radiance`] can be nonzero.
    pub(crate) fn has_channels(&self) -> bool {
        let is_dark = self.is_black() || matches!(self.background, Background::Spectrum(_));
        let stars = !self.thermal_stars && self.stars.is_some();
        !is_dark || stars || self.sun.is_some()
    }

    /// Whether its background is a picture without any light.
    pub fn has_black_picture(&self) -> bool {
        matches!(&self.background, Background::Image(picture) if picture.is_black())
    }

    fn is_black(&self) -> bool {
        matches!(self.background, Background::Uniform(radiance) if radiance == [0.0; 3])
    }

    /// The stars, if they have no spectra and there is nothing else.
    pub(crate) fn only_stars(&self) -> Option<&StarMap> {
        let stars = self.stars.as_ref();
        stars.filter(|_| !self.thermal_stars && self.is_black() && self.sun.is_none())
    }

    /// Whether loops over directions need them by component; pictures and uniform skies use them in place.
    pub(crate) fn takes_columns(&self) -> bool {
        let is_plain = matches!(
            self.background,
            Background::Uniform(_) | Background::Image(_)
        );
        !is_plain || self.stars.is_some()
    }

    /// Whether it has discs that are widened to about a pixel, by the motion of the observer.
    pub(crate) fn has_discs(&self) -> bool {
        self.stars.is_some() || self.sun.is_some()
    }

    /// Whether [`Sky::spectral`] adds to the radiance.
    #[inline]
    pub fn has_spectra(&self) -> bool {
        let stars = self.thermal_stars && self.stars.is_some();
        stars || matches!(self.background, Background::Spectrum(_))
    }

    /// Linear sRGB, seen at W, of light with a spectrum of its own along the look direction `d` of the world, with stars as discs.
    #[inline]
    pub fn spectral(&self, d: DVec3, w: f64) -> [f64; 3] {
        let background = self.spectral_background(w);
        match self.stars.as_ref().filter(|_| self.thermal_stars) {
            None => background,
            Some(stars) => sum(background, stars.radiance(d, |star| star.colour(w))),
        }
    }

    /// Calls `each` with the index of each direction along which there is such light, and with its colour as seen at the W of `ratio`, in
    /// pixels as wide as `angles` says; once for the background and once for stars.
    pub(crate) fn each_spectral(
        &self,
        directions: &Columns,
        angles: PixelAngles,
        ratio: impl Fn(f64) -> f64,
        mut each: impl FnMut(usize, [f64; 3]),
    ) {
        if let Background::Spectrum(table) = &self.background {
            for (k, w) in angles.ratios.iter().enumerate() {
                each(k, table.colour(ratio(*w)));
            }
        }
        if let Some(stars) = self.stars.as_ref().filter(|_| self.thermal_stars) {
            let colour = |k: usize, star: &Star| star.colour(ratio(angles.ratios[k]));
            stars.each_seen(directions, angles, colour, each);
        }
    }

    /// [`Sky::spectral`] without stars.
    #[inline]
    fn spectral_background(&self, w: f64) -> [f64; 3] {
        match &self.background {
            Background::Spectrum(table) => table.colour(w),
            _ => [0.0; 3],
        }
    }

    /// The spectrum of the background, if it has one of its own.
    #[inline]
    fn spectrum(&self) -> Option<&Spectrum> {
        match &self.background {
            Background::Spectrum(table) => Some(table.spectrum()),
            Background::Uniform(_) | Background::Gradient(_) | Background::Image(_) => None,
        }
    }

    /// The spectral lines of its light, as seen at `w`.
    pub(crate) fn lines(&self, w: f64) -> impl Iterator<Item = Line> {
        let lines = self.spectrum().into_iter().flat_map(Spectrum::lines);
        lines.map(move |line| line.received(w))
    }

    /// Whether it has spectral lines.
    pub(crate) fn has_lines(&self) -> bool {
        self.spectrum().is_some_and(Spectrum::is_of_lines)
    }

    /// The radiance of light with a spectrum of its own, without stars and lines, as seen at `w` at each of `wavelengths`.
    #[inline]
    fn spectral_at(&self, w: f64, wavelengths: Wavelengths) -> [f64; 3] {
        let spectrum = self.spectrum();
        spectrum.map_or([0.0; 3], |spectrum| spectrum.at(w, wavelengths))
    }

    /// Radiance by channel, without light that has a spectrum of its own, along the look direction `d` of the world: of pictures and stars
    /// at full resolution.
    #[inline]
    pub fn radiance(&self, d: DVec3) -> [f64; 3] {
        let mut radiance = self.background.radiance(d, 0.0);
        if let Some(stars) = self.stars.as_ref().filter(|_| !self.thermal_stars) {
            radiance = sum(radiance, stars.radiance(d, Star::channels));
        }
        if let Some(of_sun) = self.sun.as_ref().and_then(|sun| sun.seen(d)) {
            radiance = sum(radiance, of_sun);
        }
        radiance
    }

    /// Sets the radiance of [`Sky::radiance`] for each of `look`, with pixels as wide as `angles` says, in vector loops. `directions` are
    /// the same by component if [`Sky::takes_columns`] is true.
    pub(crate) fn radiance_each(
        &self,
        look: LookDirections,
        directions: &Columns,
        angles: PixelAngles,
        radiance: &mut Vec<[f64; 3]>,
    ) {
        radiance.resize(look.rays.len(), [0.0; 3]);
        // The background comes first: it overwrites the output, and stars and sun are added to it.
        match &self.background {
            Background::Uniform(everywhere) => radiance.fill(*everywhere),
            Background::Gradient(gradient) => dispatch(Gradients {
                gradient: *gradient,
                directions,
                radiance,
            }),
            Background::Image(panorama) => panorama.radiance_each(look, angles, radiance),
            Background::Spectrum(_) => radiance.fill([0.0; 3]),
        }
        if let Some(stars) = self.stars.as_ref().filter(|_| !self.thermal_stars) {
            let channels = |_: usize, star: &Star| star.channels();
            stars.each_seen(directions, angles, channels, |k, of_stars| {
                radiance[k] = sum(radiance[k], of_stars);
            });
        }
        if let Some(sun) = &self.sun {
            sun.each_seen(look, angles, |k, of_sun| {
                radiance[k] = sum(radiance[k], of_sun);
            });
        }
    }
}

impl Background {
    #[inline]
    fn radiance(&self, d: DVec3, angle: f64) -> [f64; 3] {
        match self {
            Background::Uniform(radiance) => *radiance,
            Background::Gradient(gradient) => gradient.radiance(d.y),
            Background::Image(panorama) => panorama.radiance(d, angle),
            Background::Spectrum(_) => [0.0; 3],
        }
    }
}

impl Gradient {
    /// The radiance along directions of this height.
    #[inline(always)]
    fn radiance(&self, y: f64) -> [f64; 3] {
        // The weight of the zenith is 1 − (1 − y)⁴: most of the change is near the horizon. The ground is selected without a branch.
        let square = (1.0 - y) * (1.0 - y);
        let weight = 1.0 - square * square;
        let mut radiance = self.ground;
        for (c, radiance) in radiance.iter_mut().enumerate() {
            let above = self.horizon[c] + (self.zenith[c] - self.horizon[c]) * weight;
            *radiance = if y < 0.0 { *radiance } else { above };
        }
        radiance
    }
}

/// Sets radiances from directions in a gradient.
struct Gradients<'a> {
    gradient: Gradient,
    directions: &'a Columns,
    radiance: &'a mut [[f64; 3]],
}

impl VectorLoop for Gradients<'_> {
    #[inline(always)]
    fn run(self) {
        let mut begin = 0;
        for radiance in self.radiance.chunks_mut(BLOCK) {
            let d = self.directions.load(begin);
            for (k, radiance) in radiance.iter_mut().enumerate() {
                *radiance = self.gradient.radiance(d.get(k).y);
            }
            begin += BLOCK;
        }
    }
}

#[inline]
fn sum(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|c| a[c] + b[c])
}
