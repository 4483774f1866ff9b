//! One sample: event → null ray → nearest hit over all rest frames → retarded event → radiance × factor.
//!
//! A [`Pipeline`] is put together from the plan: which [`View`], which [`Surfaces`], which
//! [`Radiance`] and which recorder of auxiliary channels. Each combination is compiled for itself, so
//! that a scene pays nothing for what it does not need. Rays go in batches: one sample of every pixel
//! of a tile, which share the camera's event and are coherent.

mod emission;
mod emitter;
mod pulse;
mod record;
mod scratch;
mod surfaces;

pub use emission::{Colouring, Emission, Radiance, Response, SurfacePoint};
pub use emitter::{BaseColour, BaseColours, EmissionClock, Emitter, TimeResolved};
pub use record::{AovRecorder, NoAovs, Recorder, Seen};
pub use scratch::Scratch;
pub use surfaces::{Found, Frames, Moving, Patch, Rays, RestFrame, Still, Surfaces};

use crate::camera::{Apart, Departure, View};
use crate::colour;
use crate::film::{Tile, TileFilm};
use crate::sampler::Sampler;
use crate::spacetime::{Direction, Event, NullRay, WavelengthRatio, World};
use crate::time_texture::Coverage;

/// Everything that turns film points into radiance.
#[derive(Debug)]
pub struct Pipeline<'a, V, S, R> {
    /// Film point → world direction and W.
    pub view: &'a V,
    /// Ray → nearest hit.
    pub surfaces: S,
    /// Hit → emitted radiance.
    pub radiance: &'a R,
    /// The event from which all rays leave.
    pub event: Event<World>,
    /// Refractive index that delays the rays; 0 where retardation is turned off.
    pub index: f64,
    /// Observed radiance of rays that meet nothing.
    pub background: [f64; 3],
    /// Where samples lie in a pixel.
    pub sampler: Sampler,
}

/// Observed radiance of one sample.
#[derive(Debug, Clone, Copy)]
pub struct Observed {
    /// Linear RGB.
    pub radiance: [f64; 3],
    /// How much of it is known.
    pub coverage: Coverage,
}

/// Buffers of one thread's tile.
#[derive(Debug)]
pub struct Buffers<D> {
    pub(crate) offsets: Vec<[f64; 2]>,
    pub(crate) directions: Vec<Direction<World>>,
    pub(crate) ratios: Vec<f64>,
    from: Vec<D>,
    pub(crate) scratch: Scratch,
}

impl<D> Default for Buffers<D> {
    fn default() -> Self {
        Buffers {
            offsets: Vec::new(),
            directions: Vec::new(),
            ratios: Vec::new(),
            from: Vec::new(),
            scratch: Scratch::default(),
        }
    }
}

impl<V: View, S: Surfaces, R: Radiance> Pipeline<'_, V, S, R> {
    /// Renders sample `index` of every pixel of `tile`.
    pub fn sample<A: Recorder>(
        &self,
        tile: Tile,
        index: u32,
        recorder: &A,
        buffers: &mut Buffers<V::From>,
        film: &mut TileFilm,
    ) {
        self.shoot(tile, index, buffers);
        let rays = Rays {
            directions: &buffers.directions,
            from: &buffers.from,
        };
        self.surfaces.nearest(rays, &mut buffers.scratch);
        for pixel in 0..tile.pixels() {
            self.develop(pixel, recorder, buffers, film);
        }
    }

    /// Look directions and wavelength ratios of sample `index` of every pixel.
    pub(crate) fn shoot(&self, tile: Tile, index: u32, buffers: &mut Buffers<V::From>) {
        buffers.offsets.clear();
        buffers.directions.clear();
        buffers.ratios.clear();
        buffers.from.clear();
        // Two loops: of hashing integers, and of divisions.
        let offset = |(column, row)| self.sampler.offset(column, row, index);
        buffers.offsets.extend(tile.coordinates().map(offset));
        for ((column, row), offset) in tile.coordinates().zip(&buffers.offsets) {
            let (x, y) = (column as f64 + offset[0], row as f64 + offset[1]);
            let look = self.view.look(x, y, self.moment(column, row, index));
            buffers.directions.push(look.d);
            buffers.ratios.push(look.ratio);
            buffers.from.push(look.from);
        }
    }

    /// The moment of the exposure, 0 to 1, of a sample.
    #[inline(always)]
    fn moment(&self, column: u32, row: u32, index: u32) -> f64 {
        match V::EXPOSED {
            true => self.sampler.moment(column, row, index),
            false => 0.0,
        }
    }

    /// Adds what one ray has met to its pixel.
    #[inline]
    fn develop<A: Recorder>(
        &self,
        pixel: usize,
        recorder: &A,
        buffers: &Buffers<V::From>,
        film: &mut TileFilm,
    ) {
        let d = buffers.directions[pixel];
        let from = buffers.from[pixel];
        let offset = buffers.offsets[pixel];
        let weight = weight(from);
        if !V::From::TOGETHER && weight == 0.0 {
            film.add_coverage(pixel, Coverage::OCCLUDED);
            film.add(pixel, [0.0; 3]);
            film.add_unmet();
            recorder.record(pixel, offset, d, None, film);
            return;
        }
        let Some(found) = buffers.scratch.found(pixel) else {
            self.expose(pixel, self.unmet(weight), film);
            film.add_unmet();
            recorder.record(pixel, offset, d, None, film);
            return;
        };
        let (point, rho) = self.point(found, d, from);
        let w = WavelengthRatio(buffers.ratios[pixel] * rho);
        self.expose(pixel, self.observe(&point, w, weight), film);
        recorder.record(pixel, offset, d, Some(&Seen { point, w }), film);
    }

    /// The surface point, and ω_rest/ω_world of the light that comes from it.
    #[inline]
    pub(crate) fn point(
        &self,
        found: Found,
        d: Direction<World>,
        from: V::From,
    ) -> (SurfacePoint<'_>, f64) {
        let rest = self.surfaces.rest(found.frame);
        let (local, rho) = self.surfaces.local(found.frame, d, from);
        let point = SurfacePoint {
            rest,
            frame: found.frame,
            patch: rest.patch(found.hit.triangle),
            hit: found.hit,
            ray: self.ray(d, from),
            from: from.into(),
            local,
        };
        (point, rho)
    }

    /// The world ray from `from` along `d`.
    #[inline]
    fn ray(&self, d: Direction<World>, from: V::From) -> NullRay<World> {
        if V::From::TOGETHER {
            return NullRay::new(self.event, d, self.index);
        }
        let Apart {
            displacement,
            delay,
            ..
        } = from.into();
        NullRay::new(self.event + displacement, d, self.index * delay)
    }

    /// Adds a sample to its pixel; coverage only where it can be other than full.
    #[inline]
    pub(crate) fn expose(&self, pixel: usize, observed: Observed, film: &mut TileFilm) {
        film.add(pixel, observed.radiance);
        if R::HAS_GAPS || !V::From::TOGETHER {
            film.add_coverage(pixel, observed.coverage);
        }
    }

    pub(crate) fn unmet(&self, weight: f64) -> Observed {
        Observed {
            radiance: self.background.map(|c| c * weight),
            coverage: Coverage::HELD,
        }
    }

    /// What is recorded of a surface point seen with wavelength ratio `w`.
    #[inline]
    pub(crate) fn observe(
        &self,
        point: &SurfacePoint,
        w: WavelengthRatio,
        weight: f64,
    ) -> Observed {
        if point.patch.black_back && !point.hit.front {
            return Observed {
                radiance: [0.0; 3],
                coverage: Coverage::HELD,
            };
        }
        let emission = self.radiance.emission(&self.surfaces, point);
        let factor = emission
            .response
            .scaled
            .map_or(1.0, |q| q.radiance_factor(w))
            * weight;
        let colour = emission.colour(w);
        Observed {
            radiance: std::array::from_fn(|c| emission.unscaled[c] + factor * colour[c]),
            coverage: emission.coverage,
        }
    }
}

/// What a ray's radiance counts for.
#[inline(always)]
fn weight<D: Departure>(from: D) -> f64 {
    match D::TOGETHER {
        true => 1.0,
        false => from.into().weight,
    }
}

impl Emission {
    /// Linear RGB before the radiance factor, seen with wavelength ratio `w`.
    #[inline]
    fn colour(&self, w: WavelengthRatio) -> [f64; 3] {
        match self.response.colour {
            Colouring::Channels => self.radiance,
            Colouring::ShiftedLine(wavelength) => {
                self.line(wavelength * self.wavelength_scale * w.0)
            }
            Colouring::UnshiftedLine(wavelength) => self.line(wavelength),
        }
    }

    fn line(&self, wavelength: f64) -> [f64; 3] {
        let [r, g, b] = self.radiance;
        colour::line_colour(wavelength).map(|c| c * ((r + g + b) / 3.0))
    }
}
