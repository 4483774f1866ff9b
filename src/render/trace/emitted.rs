//! The radiance that leaves a run of points, before the observer's factors.

use std::sync::Arc;

use glam::DVec3;

use super::area_draws::AreaDraws;
use super::blend::Blend;
use super::camera_rays::LeftTriangle;
use super::falling::{Falling, Gathered};
use super::hits::HitBuffer;
use super::occlusion::{OcclusionQueries, shadow_starts};
use super::points::Points;
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
    /// Radiance that replaces missing data and is shown as it is.
    pub unscaled: [f64; 3],
    /// How much of it is covered by data.
    pub coverage: Coverage,
    /// Emitted wavelength over that of the declared line.
    pub wavelength_scale: f64,
}

/// The observer's response to emitted radiance; resolved from quantity and switches beforehand.
#[derive(Debug, Clone)]
pub struct Response {
    /// The factor on the radiance.
    pub scaled: Scaling,
    /// The colour.
    pub colour: Colouring,
}

/// The factor on a radiance, by W.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Scaling {
    /// 1: the searchlight effect is off, or included in the colouring.
    None,
    /// That of a quantity.
    Of(Quantity),
    /// W⁴: removes the searchlight effect from a colouring that includes it, and keeps its hue.
    HueAlone,
}

/// How radiance becomes a colour.
#[derive(Debug, Clone)]
pub enum Colouring {
    /// The channels are colours as they are.
    Channels,
    /// The mean of the channels is the radiance of a line of this emitted wavelength, metres.
    ShiftedLine(f64),
    /// The same, shown in its emitted colour.
    UnshiftedLine(f64),
    /// The channels are linear RGB of a spectrum, whose shift includes the searchlight effect.
    Rgb(&'static RgbShift, Eye),
    /// The same with infrared and ultraviolet beside them.
    Companions(&'static CompanionShift, Eye),
    /// The mean of the channels multiplies a spectrum, whose colours include the searchlight effect.
    Spectrum(Arc<ColourTable>, Eye),
    /// The channels are radiances at wavelengths that differ from point to point; colours include the searchlight effect.
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
    /// The human one.
    pub const HUMAN: Eye = Eye {
        inverse: 1.0,
        gain: 1.0,
    };

    /// An eye that sees `wavelength`, metres, as the human one sees 555 nm.
    pub fn seeing(wavelength: f64) -> Eye {
        let inverse = 555e-9 / wavelength;
        Eye {
            inverse,
            gain: inverse * inverse * inverse * inverse,
        }
    }

    /// W for the human eye's tables.
    #[inline(always)]
    pub(super) fn ratio(self, w: f64) -> f64 {
        w * self.inverse
    }

    /// The human eye's equivalent of this wavelength.
    pub fn wavelength(self, wavelength: f64) -> f64 {
        wavelength * self.inverse
    }

    /// The wavelength that it sees as the human eye sees this one.
    #[inline(always)]
    pub(super) fn seen_as(self, wavelength: f64) -> f64 {
        wavelength / self.inverse
    }

    /// Linear sRGB, in the mean over x, of the radiances at the wavelengths of x.
    #[inline]
    pub(super) fn colour_of_sampled(self, x: f64, radiance: [f64; 3]) -> [f64; 3] {
        // ∫ L′(λ) m(λ/s) dλ = s ∫ L′(sλ) m(λ) dλ.
        colour_of_sampled(x, radiance).map(|c| c / self.inverse)
    }

    /// Linear sRGB of `spectrum`, seen without a shift.
    pub fn colour(self, spectrum: &Spectrum) -> [f64; 3] {
        spectrum.colour_at(self.inverse).map(|c| c * self.gain)
    }

    /// The factor on colours from the human eye's tables.
    #[inline(always)]
    pub(super) fn gain(self) -> f64 {
        self.gain
    }
}

/// What leaves the points of a run towards the camera, point by point.
#[derive(Debug)]
pub struct Emitted {
    /// The observer's response to it.
    pub(super) response: Response,
    /// Radiance to which the factors apply, per channel.
    pub(super) radiance: Vec<[f64; 3]>,
    /// Infrared and ultraviolet of each point, where its response has them; empty otherwise.
    pub(super) companions: Vec<[f64; 2]>,
    /// Further details of some points, in order.
    pub(super) details: Vec<Detail>,
    /// Where light is sampled at wavelengths.
    pub(super) spectral: Box<SpectralPoints>,
    pub(super) lookups: Box<Lookups>,
    /// Occlusion queries.
    pub(super) queries: OcclusionQueries,
    pub(super) segments: Vec<Segment>,
    pub(super) blocked: Vec<bool>,
    /// The points in arrays, where light falls on them.
    pub(super) points: Points,
    /// Directions towards the observer, if needed.
    pub(super) views: Columns,
    /// Intermediate results for one lamp.
    pub(super) falling: Falling,
    /// Cosine-distributed directions about the points' normals.
    pub(super) by_cosine: Columns,
    /// Normals of the points from which paths go on.
    pub(super) normals: Columns,
    /// Keys of the points' pixels, their samples where each has its own, and two random numbers of each.
    pub(super) keys: Vec<u64>,
    pub(super) indices: Vec<u32>,
    pub(super) numbers: [Vec<f64>; 2],
    /// What is drawn of area lights.
    pub(super) draws: Box<AreaDraws>,
    /// Of one light that is drawn, by the point that it may fall on, and the direction towards it in the rest frame.
    pub(super) arriving: Vec<(usize, Incident, DVec3)>,
    /// Of all lamps, by point.
    pub(super) incident: Gathered,
    /// How points reflect, where they are not diffuse: for loops over lamps, where all are glossy, and one by one.
    pub(super) glosses: Glosses,
    pub(super) reflections: Vec<Reflection>,
    /// What points that are not diffuse reflect.
    pub(super) added: Columns,
    /// Whether no light has come yet to the points of the run: then `added`, or the sum of `incident`, is to be overwritten.
    pub(super) is_unlit: bool,
    /// Points as a capture camera sees them, from where on rays to it count, whether those are blocked, and a batch of lookups.
    pub(super) seen: CapturePoints,
    pub(super) leaving: Leaving,
    pub(super) starts: Vec<f64>,
    pub(super) answers: Vec<bool>,
    pub(super) captured: Box<CaptureLookups>,
    /// The other points, and bricks for their lookups.
    pub(super) rest: Vec<u32>,
    pub(super) near: Near,
    /// Where points lie in the image of a capture camera, where there are several.
    pub(super) located: Vec<Located>,
    /// How capture cameras look at points, where there are several.
    pub(super) capture_views: Vec<Option<CaptureView>>,
    /// What the parts of an exposure span, from these times, and W of the points.
    pub(super) spans: Vec<[f64; 2]>,
    /// What several captures say of points.
    pub(super) blends: Vec<Blend>,
    /// Times of emission.
    pub(super) times: Vec<f64>,
    /// Factors on what points shine of their own, where light is followed that was also drawn there; empty for 1.
    pub(super) own_weights: Vec<f64>,
    /// Paths that go on from the points.
    pub(super) paths: Option<Box<Paths>>,
}

/// Some points of a run, from which light goes to one place.
#[derive(Debug, Default)]
pub(super) struct Leaving {
    /// Which they are.
    pub points: Vec<u32>,
    /// Where, and their triangles.
    pub from: Columns,
    pub triangles: Vec<u32>,
    /// From where on what is in the way counts.
    pub s_min: Vec<f64>,
}

impl Leaving {
    /// Makes room for `count` points, or keeps so many.
    pub fn resize(&mut self, count: usize) {
        self.points.resize(count, 0);
        self.from.resize(count);
        self.triangles.resize(count, 0);
        self.s_min.resize(count, 0.0);
    }

    /// Makes them those of `points` with these numbers, for ways to `end`; `starts` is a buffer.
    pub fn fill(&mut self, points: &Points, numbers: &[u32], end: DVec3, starts: &mut Vec<f64>) {
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

    /// The ways to `end`.
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

/// Paths from the points of a run: for each surface that they meet after it, a level of all their rays.
#[derive(Debug, Default)]
pub(super) struct Paths {
    pub levels: Vec<Level>,
    /// Rays by what they hit.
    pub order: Vec<MetPatch>,
    /// The rays of one patch.
    pub members: Vec<u32>,
    /// W of each of them.
    pub wavelength_ratios: Vec<f64>,
    /// Lines that paths have found, by the point of the run that they leave.
    pub lines: Vec<(usize, Line)>,
    /// What leaves the points of one patch.
    pub emitted: Emitted,
    /// Where paths are shared, the groups that share them, the points from which they go on, and the points of one group.
    pub groups: Groups,
    pub chosen: Vec<Chosen>,
    pub receivers: Receivers,
}

/// A point from which a path goes on.
#[derive(Debug, Clone, Copy)]
pub(super) struct Chosen {
    /// The point of the run.
    pub point: u32,
    /// Its place in its group.
    pub at: u32,
    /// What random numbers come from, and which.
    pub key: u64,
    pub index: u32,
}

/// The patch that a ray has met.
#[derive(Debug, Clone, Copy)]
pub(super) struct MetPatch {
    /// Its frame in the upper half, and its first triangle.
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

/// Rays that go on from points of surfaces, and what they meet.
#[derive(Debug, Default)]
pub(super) struct Level {
    /// How many surfaces came before those that they meet.
    pub depth: u32,
    /// Where each comes from.
    pub drawn: Vec<Drawn>,
    /// Look directions in the world, unit vectors.
    pub directions: Vec<DVec3>,
    /// Where they leave.
    pub origins: Vec<RayOrigin>,
    /// The triangles that they leave.
    pub left: Vec<LeftTriangle>,
    /// ω_world/ω_F of their light, F the rest frame of the points that they leave.
    pub ratios: Vec<f64>,
    /// Keys of their pixels, and their samples where each has its own.
    pub pixels: Vec<u64>,
    pub indices: Vec<u32>,
    /// Wavelengths in the frames of the points that they leave, where light is sampled at some.
    pub wavelengths: Vec<Wavelengths>,
    /// Weights by red, green and blue, where there are lines.
    pub rgb_weights: Vec<[f64; 3]>,
    /// From which on they are shared, if any are.
    pub shared_from: Option<usize>,
    /// Their nearest hits.
    pub hits: HitBuffer,
    /// What each has met.
    pub met: Vec<Met>,
}

/// A direction drawn at a point.
#[derive(Debug, Clone, Copy)]
pub(super) struct Drawn {
    /// The point: its place in the run, or the ray of the level before that has met it.
    pub from: u32,
    /// Its rest frame.
    pub frame: u32,
    /// The normal of its triangle there, and n·l.
    pub normal: DVec3,
    pub cosine: f64,
    /// Of one that is shared, the place of the point in its group.
    pub at: u32,
    pub scattered: Scattered,
}

/// What a ray has met.
#[derive(Debug, Clone, Copy)]
pub(super) enum Met {
    /// Nothing that sends light.
    Nothing,
    /// Light that is known.
    Light(Incident),
    /// A surface that reflects what comes to it, some of which may not yet be known.
    Surface(MetSurface),
}

/// A point of a surface that reflects.
#[derive(Debug, Clone, Copy)]
pub(super) struct MetSurface {
    /// Index of its emitter.
    pub emitter: u32,
    /// W of its light where the ray comes from.
    pub ratio: f64,
    /// What it reflects of the light that is known so far, and what it shines of its own.
    pub reflected: [f64; 3],
    pub own: [f64; 3],
    /// Whether what it reflects is the same in all directions.
    pub is_diffuse: bool,
    /// Of the light that is known so far.
    pub incident: Irradiance,
}

/// A point whose radiance is not fully known, or has another wavelength than the response says.
#[derive(Debug, Clone, Copy)]
pub(super) struct Detail {
    /// The point's place in the run.
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
            falling: Falling::default(),
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
    /// Forgets the last run, and begins one of this response.
    pub fn start(&mut self, response: Response) {
        self.response = response;
        self.radiance.clear();
        self.companions.clear();
        self.details.clear();
    }

    /// Takes the radiance of all points of the run, which is grey, as that of a band, and begins the run again.
    pub(super) fn set_aside(&mut self, band: usize) {
        self.companions.resize(self.radiance.len(), [0.0; 2]);
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

    /// Notes the wavelengths of the light of lamps that points reflect, all of whose radiance is known.
    pub(super) fn note_wavelengths(&mut self) {
        // Nothing but the colour of a line depends on them.
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

    /// Adds what the next point emits.
    pub fn push(&mut self, emission: Emission) {
        self.radiance.push(emission.radiance);
        self.put(self.radiance.len() - 1, emission);
    }

    /// Sets what point `at` emits, of which nothing was known; the details are to be in the order of points at the end.
    #[inline]
    pub(super) fn put(&mut self, at: usize, emission: Emission) {
        self.radiance[at] = emission.radiance;
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
