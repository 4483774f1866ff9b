//! The radiance that leaves a run of points, before the observer's factors.

use std::sync::Arc;

use glam::DVec3;

use super::area_draws::AreaDraws;
use super::blend::Blend;
use super::camera_rays::LeftTriangle;
use super::hits::HitBuffer;
use super::lamp_light::{Gathered, LampLight};
use super::occlusion::{OcclusionQueries, shadow_starts};
use super::point_columns::Points;
use super::sharing::{Groups, Receivers};
use super::spectral_points::SpectralPoints;
use crate::accel::vectors::Columns;
use crate::accel::{Converging, Segment};
use crate::camera::RayOrigin;
use crate::colour::{
    ColourTable, CompanionShift, Line, RgbShift, Spectrum, Wavelengths, colour_of_sampled,
};
use crate::light::lamp::{Incident, Irradiance};
use crate::light::reflection::{Glosses, Reflection, Scattered};
use crate::light::time_texture::{
    CaptureLookups, CapturePoints, CaptureView, Coverage, Located, Lookups, Near, Sampled,
};
use crate::spacetime::Quantity;

/// Radiance that leaves a surface, per channel, in its rest frame.
#[derive(Debug, Clone, Copy)]
pub struct Emission {
    /// Radiance to which the factors apply.
    pub radiance: [f64; 3],
    /// Radiance that replaces missing data and is shown unchanged.
    pub unscaled: [f64; 3],
    /// How much of the radiance is covered by data.
    pub coverage: Coverage,
    /// Emitted wavelength relative to the declared line.
    pub wavelength_scale: f64,
}

/// The observer's response to emitted radiance; determined beforehand from the quantity and the switches.
#[derive(Debug, Clone)]
pub struct Response {
    /// The factor on the radiance.
    pub scaled: Scaling,
    /// The colour.
    pub colour: Colouring,
}

/// The factor on a radiance, by W.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Scaling {
    /// 1: the searchlight effect is off, or included in the colouring.
    None,
    /// The factor of a quantity.
    Of(Quantity),
    /// W⁴: cancels the searchlight effect that the colouring includes, and keeps its hue.
    HueAlone,
}

/// How radiance becomes a colour.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub enum Colouring {
    /// The channels are the colours.
    Channels,
    /// The mean of the channels is the radiance of a line of this emitted wavelength, metres.
    ShiftedLine(f64),
    /// The same, shown in its emitted colour.
    UnshiftedLine(f64),
    /// The channels are linear RGB of a spectrum, whose shift includes the searchlight effect.
    Rgb(&'static RgbShift, Eye),
    /// The same, together with infrared and ultraviolet.
    Companions(&'static CompanionShift, Eye),
    /// The mean of the channels multiplies a spectrum, whose colours include the searchlight effect.
    Spectrum(Arc<ColourTable>, Eye),
    /// The channels are radiances at wavelengths that differ between points; colours include the searchlight effect.
    Sampled(Eye),
}

/// The wavelengths that an observer sees: those of the human eye, times a factor.
///
/// An eye with the sensitivity m(λ/s) turns a radiance into ∫ L′(λ) m(λ/s) dλ = s ∫ L′(sλ) m(λ) dλ, and with L′ at W that is s⁻⁴ times
/// the human eye's response at W/s. So a line keeps its energy in any false colour.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Eye {
    /// 1/s.
    inverse: f64,
    /// s⁻⁴.
    gain: f64,
}

impl Eye {
    /// The human eye.
    pub const HUMAN: Eye = Eye {
        inverse: 1.0,
        gain: 1.0,
    };

    /// An eye that sees `wavelength`, metres, as the human one sees 555 nm.
    pub fn seeing(wavelength: f64) -> Eye {
        // s = wavelength/555 nm: what the human eye sees at λ/s, this one sees at λ.
        let inverse = 555e-9 / wavelength;
        Eye {
            inverse,
            gain: inverse * inverse * inverse * inverse,
        }
    }

    /// The ratio at which to look up W in the human eye's tables.
    #[inline(always)]
    pub(super) fn ratio(self, w: f64) -> f64 {
        w * self.inverse
    }

    /// The human eye's equivalent of this wavelength.
    pub fn wavelength(self, wavelength: f64) -> f64 {
        wavelength * self.inverse
    }

    /// The wavelength that this eye sees as the human eye sees the given one.
    #[inline(always)]
    pub(super) fn seen_as(self, wavelength: f64) -> f64 {
        wavelength / self.inverse
    }

    /// Linear sRGB, in the mean over x, for radiances at the wavelengths of x.
    #[inline]
    pub(super) fn colour_of_sampled(self, x: f64, radiance: [f64; 3]) -> [f64; 3] {
        // ∫ L′(λ) m(λ/s) dλ = s ∫ L′(sλ) m(λ) dλ.
        colour_of_sampled(x, radiance).map(|c| c / self.inverse)
    }

    /// Linear sRGB of `spectrum`, seen without a shift.
    pub fn colour(self, spectrum: &Spectrum) -> [f64; 3] {
        // The human eye's response at W/s with W = 1, and s⁻⁴.
        spectrum.colour_at(self.inverse).map(|c| c * self.gain)
    }

    /// The factor on colours from the human eye's tables.
    #[inline(always)]
    pub(super) fn gain(self) -> f64 {
        self.gain
    }
}

/// The radiance that leaves the points of a run towards the camera, point by point.
#[derive(Debug)]
pub struct Emitted {
    /// The observer's response.
    pub(super) response: Response,
    /// Whether the run has been started.
    is_started: bool,
    /// Radiance to which the factors apply, per channel.
    pub(super) radiance: Vec<[f64; 3]>,
    /// Infrared and ultraviolet of each point, if the response includes them; empty otherwise.
    pub(super) companions: Vec<[f64; 2]>,
    /// Details of points that need more than a radiance, in the order of the points.
    pub(super) details: Vec<Detail>,
    /// Data for light that is sampled at wavelengths.
    pub(super) spectral: Box<SpectralPoints>,
    pub(super) lookups: Box<Lookups>,
    /// Occlusion queries.
    pub(super) queries: OcclusionQueries,
    pub(super) segments: Vec<Segment>,
    pub(super) blocked: Vec<bool>,
    /// The points in arrays, if light falls on them.
    pub(super) points: Points,
    /// Directions towards the observer, if needed.
    pub(super) views: Columns,
    /// Intermediate results for one lamp.
    pub(super) lamp_light: LampLight,
    /// Cosine-distributed directions about the points' normals.
    pub(super) by_cosine: Columns,
    /// Normals of the points from which paths continue.
    pub(super) normals: Columns,
    /// Keys of the points' pixels, sample indices if each point has its own, and two random numbers for each point.
    pub(super) keys: Vec<u64>,
    pub(super) indices: Vec<u32>,
    pub(super) numbers: [Vec<f64>; 2],
    /// Samples of area lights.
    pub(super) draws: Box<AreaDraws>,
    /// For one sampled light: the points it may reach, the incident light, and the direction to the light in the rest frame.
    pub(super) arriving: Vec<(usize, Incident, DVec3)>,
    /// Light of all lamps, by point.
    pub(super) incident: Gathered,
    /// How non-diffuse points reflect: in arrays for loops over lamps if all points are glossy, and one by one.
    pub(super) glosses: Glosses,
    pub(super) reflections: Vec<Reflection>,
    /// What non-diffuse points reflect.
    pub(super) added: Columns,
    /// Whether no light has reached the points of the run yet: then `added`, or the sum of `incident`, will be overwritten.
    pub(super) is_unlit: bool,
    /// Points as a capture camera sees them, the start of each ray to it, whether the rays are blocked, and a batch of lookups.
    pub(super) seen: CapturePoints,
    pub(super) leaving: Leaving,
    pub(super) starts: Vec<f64>,
    pub(super) answers: Vec<bool>,
    pub(super) captured: Box<CaptureLookups>,
    /// The other points, and bricks for their lookups.
    pub(super) rest: Vec<u32>,
    pub(super) near: Near,
    /// Positions of the points in the image of a capture camera, if there are several cameras.
    pub(super) located: Vec<Located>,
    /// How capture cameras see the points, if there are several cameras.
    pub(super) capture_views: Vec<Option<CaptureView>>,
    /// Time spans of the parts of an exposure, relative to the emission times.
    pub(super) spans: Vec<[f64; 2]>,
    /// Blended data of several captures, by point.
    pub(super) blends: Vec<Blend>,
    /// Times of emission.
    pub(super) times: Vec<f64>,
    /// Weights of the points' own emission, if followed rays and light samples can both find it; empty if they are all 1.
    pub(super) own_weights: Vec<f64>,
    /// Paths that continue from the points.
    pub(super) paths: Option<Box<Paths>>,
}

/// Some points of a run, from which rays go to one place.
#[derive(Debug, Default)]
pub(super) struct Leaving {
    /// Indices of the points.
    pub points: Vec<u32>,
    /// Their positions and triangles.
    pub from: Columns,
    pub triangles: Vec<u32>,
    /// The ray parameters from which obstacles count.
    pub s_min: Vec<f64>,
}

impl Leaving {
    /// Makes room for `count` points, or truncates to that number.
    pub fn resize(&mut self, count: usize) {
        self.points.resize(count, 0);
        self.from.resize(count);
        self.triangles.resize(count, 0);
        self.s_min.resize(count, 0.0);
    }

    /// Takes over the points of `points` with these indices, for rays to `end`; `starts` is a buffer.
    pub fn fill(&mut self, points: &Points, numbers: &[u32], end: DVec3, starts: &mut Vec<f64>) {
        // The starts of all points in one vector loop, from which those of the chosen points are picked.
        shadow_starts(points, end, starts);
        self.points.clear();
        self.points.extend_from_slice(numbers);
        self.from.gather(&points.positions, numbers);
        let numbers = || numbers.iter().map(|k| *k as usize);
        self.triangles.clear();
        self.triangles
            .extend(numbers().map(|k| points.triangles[k]));
        self.s_min.clear();
        self.s_min.extend(numbers().map(|k| starts[k]));
    }

    /// The segments from the points to `end`.
    pub fn towards(&self, end: DVec3) -> Converging<'_> {
        Converging {
            end,
            from: self.from.axes(),
            s_min: &self.s_min,
            skip: &self.triangles,
            at: None,
        }
    }
}

/// Paths from the points of a run: one level of rays for each further surface.
#[derive(Debug, Default)]
pub(super) struct Paths {
    pub levels: Vec<Level>,
    /// Rays sorted by the patch that they hit.
    pub order: Vec<MetPatch>,
    /// The rays of one patch.
    pub members: Vec<u32>,
    /// W of each of these rays.
    pub wavelength_ratios: Vec<f64>,
    /// Spectral lines that paths have found, by the point of the run at which the path starts.
    pub lines: Vec<(usize, Line)>,
    /// The radiance that leaves the points of one patch.
    pub emitted: Emitted,
    /// If paths are shared: the groups, the points from which paths continue, and the points of one group.
    pub groups: Groups,
    pub chosen: Vec<Chosen>,
    pub receivers: Receivers,
}

/// A point from which a path continues.
#[derive(Debug, Clone, Copy)]
pub(super) struct Chosen {
    /// The index of the point in the run.
    pub point: u32,
    /// Its index in its group.
    pub at: u32,
    /// The key of its random numbers, and the sample index.
    pub key: u64,
    pub index: u32,
}

/// The patch that a ray has hit.
#[derive(Debug, Clone, Copy)]
pub(super) struct MetPatch {
    /// The frame in the upper half, the patch's first triangle in the lower one.
    pub place: u64,
    pub ray: u32,
    pub emitter: u32,
}

impl MetPatch {
    pub fn frame(self) -> u32 {
        (self.place >> 32) as u32
    }

    pub fn triangle(self) -> u32 {
        self.place as u32
    }
}

/// Rays that continue from surfaces, and what they hit.
#[derive(Debug, Default)]
pub(super) struct Level {
    /// The number of surfaces before the ones that these rays hit.
    pub depth: u32,
    /// The origin of each ray.
    pub drawn: Vec<Drawn>,
    /// Look directions in the world, unit vectors.
    pub directions: Vec<DVec3>,
    /// The event at which each ray leaves.
    pub origins: Vec<RayOrigin>,
    /// The triangles that they leave.
    pub left: Vec<LeftTriangle>,
    /// ω_world/ω_F of their light, where F is the rest frame of the points that they leave.
    pub ratios: Vec<f64>,
    /// Keys of their pixels, and sample indices if each ray has its own.
    pub pixels: Vec<u64>,
    pub indices: Vec<u32>,
    /// Wavelengths in the frames of the points that they leave, if light is sampled at wavelengths.
    pub wavelengths: Vec<Wavelengths>,
    /// Weights for red, green and blue, if there are lines.
    pub rgb_weights: Vec<[f64; 3]>,
    /// The index of the first shared ray, if any are shared.
    pub shared_from: Option<usize>,
    /// Their nearest hits.
    pub hits: HitBuffer,
    /// What each ray has hit.
    pub met: Vec<Met>,
}

/// A sampled direction at a point.
#[derive(Debug, Clone, Copy)]
pub(super) struct Drawn {
    /// The point: its index in the run, or the ray of the previous level that hit it.
    pub from: u32,
    /// The point's rest frame.
    pub frame: u32,
    /// The normal of its triangle there, and n·l.
    pub normal: DVec3,
    pub cosine: f64,
    /// For a shared ray, the index of the point in its group.
    pub at: u32,
    pub scattered: Scattered,
}

/// What a ray has hit.
#[derive(Debug, Clone, Copy)]
pub(super) enum Met {
    /// Nothing that emits or reflects light.
    Nothing,
    /// Light that is fully known.
    Light(Incident),
    /// A surface that reflects incident light, some of which may not be known yet.
    Surface(MetSurface),
}

/// A point of a surface that reflects.
#[derive(Debug, Clone, Copy)]
pub(super) struct MetSurface {
    /// Index of its emitter.
    pub emitter: u32,
    /// W of its light at the origin of the ray.
    pub ratio: f64,
    /// The reflected part of the incident light known so far, and the surface's own emission.
    pub reflected: [f64; 3],
    pub own: [f64; 3],
    /// Whether the surface reflects equally in all directions.
    pub is_diffuse: bool,
    /// The incident light known so far.
    pub incident: Irradiance,
}

/// A point whose radiance is not fully known, or whose wavelength differs from the response's.
#[derive(Debug, Clone, Copy)]
pub(super) struct Detail {
    /// The point's index in the run.
    pub at: usize,
    /// As in [`Emission`].
    pub unscaled: [f64; 3],
    pub coverage: Coverage,
    pub wavelength_scale: f64,
}

impl Default for Emitted {
    fn default() -> Self {
        Emitted {
            response: Response {
                scaled: Scaling::None,
                colour: Colouring::Channels,
            },
            is_started: false,
            radiance: Vec::new(),
            companions: Vec::new(),
            details: Vec::new(),
            spectral: Box::default(),
            lookups: Box::default(),
            queries: OcclusionQueries::default(),
            segments: Vec::new(),
            blocked: Vec::new(),
            points: Points::default(),
            views: Columns::default(),
            lamp_light: LampLight::default(),
            by_cosine: Columns::default(),
            normals: Columns::default(),
            keys: Vec::new(),
            indices: Vec::new(),
            numbers: Default::default(),
            draws: Box::default(),
            arriving: Vec::new(),
            incident: Gathered::default(),
            glosses: Glosses::default(),
            reflections: Vec::new(),
            added: Columns::default(),
            is_unlit: false,
            captured: Box::default(),
            seen: CapturePoints::default(),
            leaving: Leaving::default(),
            starts: Vec::new(),
            answers: Vec::new(),
            rest: Vec::new(),
            near: Near::default(),
            located: Vec::new(),
            capture_views: Vec::new(),
            spans: Vec::new(),
            blends: Vec::new(),
            times: Vec::new(),
            own_weights: Vec::new(),
            paths: None,
        }
    }
}

impl Emission {
    /// Radiance that is fully known.
    pub fn full(radiance: [f64; 3]) -> Self {
        Emission {
            radiance,
            unscaled: [0.0; 3],
            coverage: Coverage::HELD,
            wavelength_scale: 1.0,
        }
    }

    /// Radiance from a cube.
    pub(super) fn stored(sampled: Sampled) -> Self {
        Emission {
            unscaled: sampled.unscaled,
            coverage: sampled.coverage,
            ..Emission::full(sampled.radiance)
        }
    }
}

impl Emitted {
    /// Clears the last run and starts one with this response.
    pub fn start(&mut self, response: Response) {
        self.response = response;
        self.is_started = true;
        self.clear();
    }

    /// Clears the last run without a start of the next.
    pub(super) fn forget(&mut self) {
        self.is_started = false;
        self.clear();
    }

    /// The number of points with an emission; `None` if the run was not started.
    pub(super) fn pushed(&self) -> Option<usize> {
        self.is_started.then_some(self.radiance.len())
    }

    fn clear(&mut self) {
        self.radiance.clear();
        self.companions.clear();
        self.details.clear();
    }

    /// Stores the radiance of all points of the run, which is grey, as that of a band, and restarts the run.
    pub(super) fn set_aside(&mut self, band: usize) {
        self.companions.resize(self.radiance.len(), [0.0; 2]);
        // A band has one value, which is in all three channels.
        for (companions, [grey, ..]) in self.companions.iter_mut().zip(&self.radiance) {
            companions[band] = *grey;
        }
        self.radiance.clear();
        self.details.clear();
    }

    /// Infrared and ultraviolet of a point.
    #[inline]
    pub(super) fn companions(&self, at: usize) -> [f64; 2] {
        self.companions.get(at).copied().unwrap_or_default()
    }

    /// Records the wavelengths of the lamp light that the points reflect. The radiance of these points must be fully known.
    pub(super) fn note_wavelengths(&mut self) {
        // Only the colour of a line depends on them.
        if !matches!(self.response.colour, Colouring::ShiftedLine(_)) {
            return;
        }
        for at in 0..self.radiance.len() {
            let wavelength_scale = self.incident.get(at).wavelength_scale();
            if wavelength_scale != 1.0 {
                self.details.push(Detail {
                    at,
                    unscaled: [0.0; 3],
                    coverage: Coverage::HELD,
                    wavelength_scale,
                });
            }
        }
    }

    /// Adds what the next point emits. After [`start`](Emitted::start), once for each point of the run.
    pub fn push(&mut self, emission: Emission) {
        self.radiance.push(emission.radiance);
        self.put(self.radiance.len() - 1, emission);
    }

    /// Sets the emission of point `at`, which must not have been set before; in the end, the details must be in the order of the points.
    #[inline]
    pub(super) fn put(&mut self, at: usize, emission: Emission) {
        self.radiance[at] = emission.radiance;
        // Only exceptions get a detail: the loops that add colours are faster without any.
        let plain = emission.coverage == Coverage::HELD
            && emission.wavelength_scale == 1.0
            && emission.unscaled == [0.0; 3];
        if !plain {
            self.details.push(Detail {
                at,
                unscaled: emission.unscaled,
                coverage: emission.coverage,
                wavelength_scale: emission.wavelength_scale,
            });
        }
    }
}
