//! What a batch of rays has met, onto the film: runs of points of one patch, their radiance, the observer's
//! factor W⁻ᵖ and colours.

use super::emission::{Colouring, Radiance, Response};
use super::light::{Detail, Light};
use super::run::{Run, Traced};
use super::stats::{Counter, Meter, Stage};
use super::surfaces::Surfaces;
use crate::accel::vectors::{VectorLoop, dispatch};
use crate::camera::Departure;
use crate::colour;
use crate::light::time_texture::Coverage;
use crate::render::film::TileFilm;
use crate::spacetime::Quantity;

/// Takes what the rays of a batch bring.
pub trait Exposed {
    /// Adds the radiance of ray `ray`.
    fn add(&mut self, ray: usize, radiance: [f64; 3]);
    /// Adds how much of the radiance of ray `ray` is known.
    fn add_coverage(&mut self, ray: usize, coverage: Coverage);
    /// Notes rays whose radiance is fully known.
    fn add_held(&mut self, rays: &[u32]);
    /// Notes rays that met nothing.
    fn add_unmet(&mut self, rays: u64);
}

/// One ray per pixel.
impl Exposed for TileFilm {
    #[inline(always)]
    fn add(&mut self, ray: usize, radiance: [f64; 3]) {
        TileFilm::add(self, ray, radiance);
    }

    #[inline(always)]
    fn add_coverage(&mut self, ray: usize, coverage: Coverage) {
        TileFilm::add_coverage(self, ray, coverage);
    }

    fn add_held(&mut self, rays: &[u32]) {
        TileFilm::add_held(self, rays);
    }

    fn add_unmet(&mut self, rays: u64) {
        TileFilm::add_unmet(self, rays);
    }
}

/// Buffers for developing one tile.
#[derive(Debug, Default)]
pub struct Developer {
    /// Rays that met a surface that shines.
    met: Vec<u32>,
    /// Rays whose radiance is fully known without asking the surface: of the background, and black backs.
    plain: Vec<u32>,
    runs: Vec<Stretch>,
    light: Light,
    /// W of each point of a run, and the factor on its radiance.
    ratios: Vec<f64>,
    factors: Vec<f64>,
}

/// Consecutive rays in `met` that meet one patch of one frame.
#[derive(Debug, Clone, Copy)]
struct Stretch {
    begin: usize,
    end: usize,
    frame: u32,
    /// A triangle of the patch.
    triangle: u32,
}

impl Developer {
    /// Adds what `traced` rays have met to `film`; `ratios` are their W for sources at rest in the world.
    pub(crate) fn develop<D: Departure, S: Surfaces, R: Radiance, M: Meter>(
        &mut self,
        radiance: &R,
        traced: &Traced<D, S>,
        background: [f64; 3],
        ratios: &[f64],
        film: &mut impl Exposed,
        meter: &mut M,
    ) {
        let has_gaps = R::HAS_GAPS || !D::TOGETHER;
        self.sort(traced, background, film);
        if has_gaps {
            film.add_held(&self.plain);
        }
        meter.count(Counter::Hits, self.met.len() as u64);
        meter.lap(Stage::Film);
        for at in 0..self.runs.len() {
            let stretch = self.runs[at];
            let rest = traced.surfaces.rest(stretch.frame);
            let run = Run {
                traced,
                members: &self.met[stretch.begin..stretch.end],
                patch: rest.patch(stretch.triangle),
                rest,
                frame: stretch.frame,
            };
            radiance.emit(&run, &mut self.light, meter);
            meter.lap(Stage::Radiance);
            self.ratios.clear();
            let ratio = |k: usize| ratios[run.members[k] as usize] * run.local(k).1;
            self.ratios.extend((0..run.members.len()).map(ratio));
            weigh(&self.light.response, &self.ratios, &mut self.factors);
            if !D::TOGETHER {
                for (factor, ray) in self.factors.iter_mut().zip(run.members) {
                    *factor *= traced.rays.from[*ray as usize].into().weight;
                }
            }
            colour_in(&self.light, &self.ratios, &self.factors, run.members, film);
            if has_gaps {
                cover(&self.light.details, run.members, film);
            }
            meter.lap(Stage::Film);
        }
    }

    /// Finds the runs, and develops rays that met nothing or the black back of something.
    fn sort<D: Departure, S: Surfaces>(
        &mut self,
        traced: &Traced<D, S>,
        background: [f64; 3],
        film: &mut impl Exposed,
    ) {
        self.met.clear();
        self.plain.clear();
        self.runs.clear();
        let mut unmet = 0;
        // The triangles of the patch that was met last.
        let (mut frame, mut first, mut end, mut black_back) = (u32::MAX, 0, 0, false);
        for (ray, hit) in traced.scratch.hits().iter().enumerate() {
            let weight = weight(traced.rays.from[ray]);
            if !D::TOGETHER && weight == 0.0 {
                film.add_coverage(ray, Coverage::OCCLUDED);
                film.add(ray, [0.0; 3]);
                unmet += 1;
                continue;
            }
            let Some(hit) = hit else {
                film.add(ray, background.map(|c| c * weight));
                self.plain.push(ray as u32);
                unmet += 1;
                continue;
            };
            let in_frame = traced.scratch.frame(ray);
            if in_frame != frame || !(first..end).contains(&hit.triangle) {
                let (patch, after) = traced.surfaces.rest(in_frame).patch_and_end(hit.triangle);
                (frame, first, end) = (in_frame, patch.first, after);
                black_back = patch.black_back;
                self.begin(frame, hit.triangle);
            }
            if black_back && !hit.front {
                film.add(ray, [0.0; 3]);
                self.plain.push(ray as u32);
                continue;
            }
            self.met.push(ray as u32);
        }
        self.begin(u32::MAX, 0);
        self.runs.pop();
        film.add_unmet(unmet);
    }

    /// Ends a run where the next begins.
    fn begin(&mut self, frame: u32, triangle: u32) {
        let begin = self.met.len();
        match self.runs.last_mut() {
            Some(last) if last.begin == begin => {
                self.runs.pop();
            }
            Some(last) => last.end = begin,
            None => {}
        }
        self.runs.push(Stretch {
            begin,
            end: begin,
            frame,
            triangle,
        });
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

/// The observer's factors for wavelength ratios `ratios`.
fn weigh(response: &Response, ratios: &[f64], factors: &mut Vec<f64>) {
    factors.clear();
    match response.scaled {
        None => factors.resize(ratios.len(), 1.0),
        Some(quantity) => {
            factors.extend_from_slice(ratios);
            dispatch(Powers { quantity, factors });
        }
    }
}

/// Ratios to factors.
struct Powers<'a> {
    quantity: Quantity,
    factors: &'a mut [f64],
}

impl VectorLoop for Powers<'_> {
    #[inline(always)]
    fn run(self) {
        self.quantity.radiance_factors(self.factors);
    }
}

/// Adds the light of a run, times `factors`, to the pixels of its members.
fn colour_in(
    light: &Light,
    ratios: &[f64],
    factors: &[f64],
    members: &[u32],
    film: &mut impl Exposed,
) {
    if let (Colouring::Channels, []) = (light.response.colour, light.details.as_slice()) {
        return expose(&light.radiance, factors, members, film);
    }
    let mut details = light.details.iter().peekable();
    for (k, ray) in members.iter().enumerate() {
        let mut unscaled = [0.0; 3];
        let mut wavelength_scale = 1.0;
        if let Some(detail) = details.next_if(|detail| detail.at == k) {
            (unscaled, wavelength_scale) = (detail.unscaled, detail.wavelength_scale);
        }
        let colour = match light.response.colour {
            Colouring::Channels => light.radiance[k],
            Colouring::ShiftedLine(wavelength) => {
                line(light.radiance[k], wavelength * wavelength_scale * ratios[k])
            }
            Colouring::UnshiftedLine(wavelength) => line(light.radiance[k], wavelength),
        };
        let factor = factors[k];
        let [r, g, b] = colour;
        let [r0, g0, b0] = unscaled;
        film.add(
            *ray as usize,
            [r0 + factor * r, g0 + factor * g, b0 + factor * b],
        );
    }
}

/// Adds radiance times `factors`, and nothing else.
fn expose(radiance: &[[f64; 3]], factors: &[f64], members: &[u32], film: &mut impl Exposed) {
    for ((ray, [r, g, b]), factor) in members.iter().zip(radiance).zip(factors) {
        film.add(*ray as usize, [factor * r, factor * g, factor * b]);
    }
}

/// The colour of a line whose radiance is the mean of three channels.
fn line([r, g, b]: [f64; 3], wavelength: f64) -> [f64; 3] {
    colour::line_colour(wavelength).map(|c| c * ((r + g + b) / 3.0))
}

/// Adds how much of the radiance of a run is known.
fn cover(details: &[Detail], members: &[u32], film: &mut impl Exposed) {
    let mut begin = 0;
    for detail in details {
        film.add_held(&members[begin..detail.at]);
        film.add_coverage(members[detail.at] as usize, detail.coverage);
        begin = detail.at + 1;
    }
    film.add_held(&members[begin..]);
}
