//! The light of lamps on surfaces.
//!
//! A lamp at rest in its frame G (its instantaneous frame, if it accelerates) emits the power I per solid angle. The camera's ray hits a
//! point of a surface at rest in F at the event X; the light incident there then left the lamp at the event P where the lamp's world line
//! crosses the past light cone of X. With the null vector k = P − X and the four-velocities u, the distance is r_G = k·u_G in G and r_F =
//! k·u_F in F, and frequencies are proportional to k·u, too, so that
//!
//! ```text
//! W = λ_F/λ_G = (k·u_G)/(k·u_F) = r_G/r_F.
//! ```
//!
//! In the time dτ the lamp emits N = I dτ dω_G/(hν_G) photons into dω_G. They cross an area perpendicular to the beam on which all
//! observers agree, because a solid angle about the emission is dω_F = W² dω_G and r_F = r_G/W: r_F² dω_F = r_G² dω_G. In F each has the
//! energy hν_G/W, and they arrive within dt_F = W dτ. Per area of the surface and time, therefore,
//!
//! ```text
//! E_F = N hν_G/W · cos θ_F / (r_G² dω_G · W dτ) = W⁻² I cos θ_F / r_G²,
//! E_λ^F(λ) = W⁻³ I_λ(λ/W) cos θ_F / r_G²      (per wavelength: dλ_F = W dλ_G),
//! ```
//!
//! with the angle of incidence θ_F in F. The same follows from radiance: a small ball of radiance L_G and of the solid angle ω_G, seen from
//! r_G, has W⁻⁴ L_G and W² ω_G in F, and I = L_G ω_G r_G². In general radiance scales with W⁻ᵖ (p by the declared quantity), and irradiance
//! with W²⁻ᵖ. Parallel light is the limit r → ∞ with E_G = I/r_G²: its irradiance is E_F = W²⁻ᵖ E_G cos θ_F. A diffuse surface of this
//! albedo then has the radiance albedo E_F/π in F.
//!
//! r_G is the distance of Liénard and Wiechert, γ (r − β·r) with r in the world; W and r_G depend on the velocity at P, but not on the
//! acceleration. In a medium of index η only lamps at rest in the world are computed: η r replaces r in the delay. A line of wavelength λ₀
//! arrives, and is reflected, with W λ₀ (weighted by irradiance if several lamps contribute).
//!
//! Linear RGB arrives as M(W) times that of the lamp, and a spectrum as its colour at W; either is multiplied by the albedo, component by
//! component: the light reflected is that of white light on the product of both colours. For a white lamp at rest relative to the surface
//! it is exact; for a coloured or shifted one products of spectra differ from products of colours. If light is sampled at wavelengths λ_F
//! of the surface (`render.spectra`), it arrives with W⁻³ I_λ(λ_F/W) at each of them.
//!
//! Sources: Weiskopf, Kraus, Ruder, ACM TOG 18(3), 1999 (radiance and solid angle); Jackson, Classical
//! Electrodynamics, ch. 14 (the retarded distance); KHR_lights_punctual (the cone of a spot light).

mod arrivals;
mod emission;
mod incidence;

use std::f64::consts::FRAC_1_PI;
use std::sync::Arc;

use glam::DVec3;

pub(crate) use arrivals::{Arrivals, EventColumns, PointsOnRays, Start};
use arrivals::{ArrivalsBlock, Ways};
pub(crate) use emission::Emission;
pub(crate) use incidence::{Incidence, Kept};

use super::Received;
use crate::accel::vectors::BLOCK;
use crate::colour::{ColourTable, Line, Spectrum, Wavelengths};
use crate::scene::model::{self, Beam, Pulse};
use crate::spacetime::worldline::{State, WorldLine, WorldLineError};
use crate::spacetime::{
    Boost, CameraFrame, Direction, Displacement, Event, InertialFrame, NullRay, Velocity, World,
};

/// A lamp, prepared for lighting computations.
#[derive(Debug, Clone)]
pub struct Lamp {
    path: Path,
    beam: Cone,
    emission: Emission,
    /// I or E_G, for each channel; all the same if it has a spectrum.
    intensity: [f64; 3],
    /// The quantity that surfaces receive.
    received: Received,
    /// Its colours as a function of W, if it has a spectrum.
    spectrum: Option<Arc<ColourTable>>,
    /// Whether surfaces cast shadows in its light.
    pub shadows: bool,
    /// If it is the pulse of a source: its centre and standard deviation.
    pulse: Option<(Event<World>, f64)>,
}

/// The motion of a lamp.
#[derive(Debug, Clone)]
enum Path {
    /// At rest in the world; the event at which its clock shows 0.
    Rest(Event<World>),
    /// Without acceleration, at the frame's origin.
    Inertial(InertialFrame<CameraFrame>),
    /// Any other; with a state close to those that are needed.
    Line(Box<(WorldLine, State)>),
}

/// The directions of its light, in its own frame.
#[derive(Debug, Clone, Copy)]
enum Cone {
    Everywhere,
    /// Within the cosines of its outer and inner angle about an axis.
    Spot {
        axis: DVec3,
        outer: f64,
        inner: f64,
    },
    /// In this direction only.
    Parallel(DVec3),
}

/// The light of a lamp at a surface point.
#[derive(Debug, Clone, Copy)]
pub struct Arrival {
    /// Direction to the lamp, in the world.
    pub d: Direction<World>,
    /// Distance to the lamp, in the world; infinite for parallel light.
    pub distance: f64,
    /// ω_G/ω_world of the light, and its inverse.
    ratio: f64,
    inverse: f64,
    /// 1/r_G²; 1 for parallel light.
    fade: f64,
    /// Direction to the lamp, in its frame.
    in_lamp: DVec3,
    /// Intensity towards the point for a lamp of intensity 1.
    strength: f64,
}

impl Arrival {
    /// Wavelength at a surface over that at the lamp, with `rho` as ω_F/ω_world of the light.
    #[inline]
    pub fn wavelength_ratio(&self, rho: f64) -> f64 {
        self.ratio * (1.0 / rho)
    }
}

impl Lamp {
    /// Prepares `lamp`, whose light surfaces receive as `received`, for points near those seen from `shot`.
    ///
    /// # Errors
    /// As [`model::Lamp::world_line`].
    pub fn new(
        lamp: &model::Lamp,
        received: Received,
        shadows: bool,
        shot: Event<World>,
    ) -> Result<Self, WorldLineError> {
        // Lamps in uniform motion have arrivals in closed form; on other world lines the crossing is searched near that of the shot.
        let line = lamp.world_line()?;
        let path = match line.frame() {
            Some(frame) if frame.velocity().is_rest() => Path::Rest(frame.origin()),
            Some(frame) => Path::Inertial(frame),
            None => Path::along(line, shot),
        };
        let beam = match lamp.beam {
            Beam::Point => Cone::Everywhere,
            Beam::Parallel(direction) => Cone::Parallel(direction),
            Beam::Spot { axis, inner, outer } => Cone::Spot {
                axis,
                outer: libm::cos(outer),
                inner: libm::cos(inner),
            },
        };
        // Colours on a spectrum are those of a filter that moves with the lamp.
        let filtered = |bare: &Spectrum| match lamp.intensity {
            [r, g, b] if r == g && g == b => (bare.clone(), lamp.intensity),
            rgb => (bare.filtered(rgb), [1.0; 3]),
        };
        let (spectrum, intensity) = match lamp.spectrum.as_ref().map(filtered) {
            Some((spectrum, grey)) => (Some(Arc::new(ColourTable::new(&spectrum))), grey),
            None => (None, lamp.intensity),
        };
        Ok(Lamp {
            path,
            beam,
            emission: Emission::from(&lamp.emission),
            intensity,
            received,
            spectrum,
            shadows,
            pulse: None,
        })
    }

    /// Prepares it for points near those seen from another `shot`.
    pub(crate) fn retake(&mut self, shot: Event<World>) {
        if let Path::Line(line) = &self.path {
            self.path = Path::along(line.0.clone(), shot);
        }
    }

    /// Prepares `pulse`, whose light surfaces receive as `received`: its intensity is an energy per solid angle.
    pub fn pulse(pulse: &Pulse, received: Received) -> Self {
        Lamp {
            path: Path::Rest(pulse.origin),
            beam: Cone::Everywhere,
            emission: Emission::Gaussian {
                centre: 0.0,
                sigma: pulse.sigma,
                scale: 1.0,
            },
            intensity: pulse.intensity,
            received,
            spectrum: None,
            shadows: pulse.shadows,
            pulse: Some((pulse.origin, pulse.sigma)),
        }
    }

    /// For the pulse of a source, the event of its centre and its standard deviation, metres.
    pub fn source_pulse(&self) -> Option<(Event<World>, f64)> {
        self.pulse
    }

    /// A sun at rest in the world, whose light surfaces receive as `received`: parallel light.
    pub fn sun(sun: &model::Sun, received: Received, shadows: bool) -> Self {
        Lamp {
            path: Path::Rest(Event::ORIGIN),
            beam: Cone::Parallel(-sun.direction),
            emission: Emission::Steady,
            intensity: sun.irradiance,
            received,
            spectrum: None,
            shadows,
            pulse: None,
        }
    }

    /// The light at the point that `ray` hits at `s`, in a medium of index `index`; `None` while it is dark there.
    #[inline]
    pub fn arrival(&self, ray: &NullRay<World>, s: f64, index: f64) -> Option<Arrival> {
        let (arrival, proper_time) = self.arrival_at_peak(ray, s, index)?;
        let strength = self.emission.at(proper_time) * arrival.strength;
        (strength != 0.0).then_some(Arrival {
            strength,
            ..arrival
        })
    }

    /// The same for a lamp with constant emission 1, with the lamp's proper time of emission.
    #[inline]
    pub fn arrival_at_peak(
        &self,
        ray: &NullRay<World>,
        s: f64,
        index: f64,
    ) -> Option<(Arrival, f64)> {
        let from = |event| (ray.origin - event) + ray.tangent * s;
        let (arrival, proper_time) = match (&self.path, self.beam) {
            (Path::Rest(origin), Cone::Parallel(direction)) => {
                ParallelAtRest { direction, index }.arrival(from(*origin))
            }
            (Path::Inertial(frame), Cone::Parallel(direction)) => {
                ParallelInertial::new(frame, direction).arrival(from(frame.origin()))
            }
            // Parallel light fills the frame of its lamp, which must be a single one.
            (Path::Line(_), Cone::Parallel(_)) => return None,
            (Path::Rest(origin), _) => AtRest { index }.arrival(from(*origin)),
            (Path::Inertial(frame), _) => Inertial { frame }.arrival(from(frame.origin())),
            (Path::Line(line), _) => Accelerated::new(line).arrival(from(line.1.event)),
        };
        let strength = self.attenuation(arrival.in_lamp);
        let arrival = Arrival {
            strength,
            ..arrival
        };
        // NaN if no light arrives.
        (!arrival.d.unit().x.is_nan()).then_some((arrival, proper_time))
    }

    /// The proper times between which it emits; `None` if it has always done so, or always will.
    pub fn emission_span(&self) -> Option<[f64; 2]> {
        self.emission.span()
    }

    /// Its brightness as a function of its proper time.
    pub(crate) fn emission(&self) -> &Emission {
        &self.emission
    }

    /// Its velocity in the world; `None` if that changes.
    pub fn velocity(&self) -> Option<Velocity> {
        match &self.path {
            Path::Rest(_) => Some(Velocity::REST),
            Path::Inertial(frame) => Some(frame.velocity()),
            Path::Line(_) => None,
        }
    }

    /// Whether its light on anything moving at `velocity` is constant.
    pub(crate) fn is_constant_for(&self, velocity: Velocity) -> bool {
        // The same velocity, up to rounding.
        let rests = |own: Velocity| (own.rapidity() - velocity.rapidity()).length() <= 1e-12;
        let is_uniform = matches!(self.beam, Cone::Parallel(_)) && self.velocity().is_some();
        self.emission.is_steady() && (is_uniform || self.velocity().is_some_and(rests))
    }

    /// The attenuation by the cone of a spot light along `d` of the lamp's frame.
    #[inline]
    fn attenuation(&self, d: DVec3) -> f64 {
        match self.beam {
            Cone::Spot { axis, outer, inner } => within_cone(axis, [outer, inner], d),
            Cone::Everywhere | Cone::Parallel(_) => 1.0,
        }
    }

    /// E_F of an arrival on a surface, with `rho` as ω_F/ω_world of the light, and the cosine of the angle of incidence.
    #[inline]
    pub fn incident(&self, arrival: &Arrival, rho: f64, cosine: f64) -> Incident {
        let w = arrival.wavelength_ratio(rho);
        // I cos θ_F/r_G² of a lamp with I = 1; the factor W²⁻ᵖ follows.
        let irradiance = arrival.strength * cosine * arrival.fade;
        let factor = (self.received).irradiance_at([w, arrival.inverse * rho], irradiance);
        self.incident_at(w, factor)
    }

    /// The light incident on a surface, `factor` times the lamp's intensity as seen at `w`.
    #[inline]
    pub(crate) fn incident_at(&self, w: f64, factor: f64) -> Incident {
        Incident {
            irradiance: self.colour(w).map(|e| e * factor),
            wavelength_scale: self.received.wavelength_scale(w),
        }
    }

    /// Its intensity as seen at `w`.
    #[inline]
    pub(crate) fn colour(&self, w: f64) -> [f64; 3] {
        match &self.spectrum {
            None => self.received.colour(w, self.intensity),
            Some(table) => table.colour(w).map(|c| c * self.intensity[0]),
        }
    }

    /// The same at each of these wavelengths of the surface; 0 for lines.
    #[inline]
    pub(crate) fn at(&self, w: f64, wavelengths: Wavelengths) -> [f64; 3] {
        match &self.spectrum {
            None => self.received.at(w, self.intensity, wavelengths),
            Some(table) => {
                let seen = table.spectrum().at(w, wavelengths);
                seen.map(|l| l * self.intensity[0])
            }
        }
    }

    /// Its lines, as seen at `w`.
    pub(crate) fn lines(&self, w: f64) -> impl Iterator<Item = Line> {
        let spectrum = self.spectrum.as_ref().map(|table| table.spectrum());
        let lines = spectrum.into_iter().flat_map(|spectrum| spectrum.lines());
        lines.map(move |line| line.scaled(self.intensity[0]).received(w))
    }

    /// Whether all its light is in lines.
    pub(crate) fn is_of_lines(&self) -> bool {
        let spectrum = self.spectrum.as_ref();
        spectrum.is_some_and(|table| table.spectrum().is_of_lines())
    }

    /// The same if it does not depend on W.
    pub(crate) fn constant_colour(&self) -> Option<[f64; 3]> {
        let is_constant = self.spectrum.is_none() && matches!(self.received, Received::Scaled(_));
        is_constant.then_some(self.intensity)
    }

    /// The point of the world where all its light comes from, if there is one.
    pub(crate) fn place(&self) -> Option<DVec3> {
        match (&self.path, self.beam) {
            (_, Cone::Parallel(_)) | (Path::Inertial(_) | Path::Line(_), _) => None,
            (Path::Rest(origin), _) => Some(origin.x),
        }
    }

    /// Whether wavelengths are scaled by W separately; otherwise its colours include that.
    pub(crate) fn shifts_wavelengths(&self) -> bool {
        matches!(self.received, Received::Scaled(_))
    }
}

impl Path {
    fn along(line: WorldLine, shot: Event<World>) -> Path {
        // Searches for crossings start from this state: points of the picture are near, and so are their crossings. Arrivals have its
        // rounding, so it must be that of the shot in use.
        let seen = line.on_past_light_cone_of(shot);
        let near = seen.and_then(|crossing| line.state(crossing.proper_time()));
        match near.or_else(|| line.state(0.0)) {
            Some(near) => Path::Line(Box::new((line, near))),
            // Every world line has a state at its proper time 0.
            None => Path::Rest(shot),
        }
    }
}

/// The attenuation by the cone of a spot light along `d` of the lamp's frame.
#[inline(always)]
fn within_cone(axis: DVec3, [outer, inner]: [f64; 2], d: DVec3) -> f64 {
    // d points to the lamp, so its light goes along −d. The square of a ramp in the cosine (KHR_lights_punctual).
    let part = ((-axis.dot(d) - outer) / (inner - outer)).clamp(0.0, 1.0);
    part * part
}

/// The propagation of light from a kind of lamp to a point.
trait Emitter {
    /// The arrival as if the lamp were steady and isotropic, and the lamp's proper time of emission, at a point displaced by `way` from the
    /// lamp's own event in the world. NaN if no light arrives.
    ///
    /// Callers compute `way` relative to the camera's event, so that no digits are lost far from the world's origin.
    fn arrival(&self, way: Displacement<World>) -> (Arrival, f64);

    /// The same at a block of points with these displacements.
    #[inline(always)]
    fn arrivals<W: Ways>(&self, ways: &W::Block<'_>, to: &mut ArrivalsBlock) {
        arrivals_singly::<W>(self, ways, to);
    }
}

/// [`Emitter::arrival`] at each point of a block.
#[inline(always)]
fn arrivals_singly<W: Ways>(
    emitter: &(impl Emitter + ?Sized),
    ways: &W::Block<'_>,
    to: &mut ArrivalsBlock,
) {
    for k in 0..BLOCK {
        let (arrival, time) = emitter.arrival(W::at(ways, k));
        to.set(k, &arrival);
        to.times[k] = time;
    }
}

/// A lamp at rest in the world, in a medium.
struct AtRest {
    index: f64,
}

impl Emitter for AtRest {
    #[inline(always)]
    fn arrival(&self, way: Displacement<World>) -> (Arrival, f64) {
        // k = P − X in space, |k| = r: one division gives 1/r² and, times r, the unit direction.
        let k = -way.x;
        let square = k.length_squared();
        let distance = square.sqrt();
        let fade = inverse_within(square);
        let d = k * (distance * fade);
        let arrival = Arrival {
            d: Direction::from_unit(d),
            distance,
            ratio: 1.0,
            inverse: 1.0,
            fade,
            in_lamp: d,
            strength: 1.0,
        };
        // The lamp's clock shows world time since its own event; the light left η r before it arrived.
        (arrival, way.ct - self.index * distance)
    }
}

/// 1/x, NaN if x or its inverse is outside f64's normal range, including 0, ∞ and NaN.
#[inline(always)]
fn inverse_within(x: f64) -> f64 {
    /// 2⁻¹⁰²⁰ and 2¹⁰²⁰.
    const RANGE: [f64; 2] = [
        f64::from_bits((1023 - 1020) << 52),
        f64::from_bits((1023 + 1020) << 52),
    ];
    let is_within = (x > RANGE[0]) & (x < RANGE[1]);
    1.0 / if is_within { x } else { f64::NAN }
}

/// A lamp without acceleration: computed as at rest in its frame, and the null vector k = (−r_G, r_G d_G) is boosted to (−r, r d).
///
/// One division serves all quotients: with q = 1/(r r_G²) they are d = (r d) q r_G², ω_G/ω_world = r_G/r = q r_G³, its inverse q r² r_G and
/// 1/r_G² = q r. Each is accurate to a few eps of what r_G is; where lamp and surface both move at γ in the world, r_G itself has lost γ² of
/// these digits, as the world rounds events γ r_G away ([`plan`](crate::render::plan) says so before it shows). Lamps farther than 10¹⁰² m, or nearer than its inverse, send no
/// light.
struct Inertial<'a> {
    frame: &'a InertialFrame<CameraFrame>,
}

/// Boosts to a lamp's frame and back; `SLOW` is the result of [`Boost::is_slow`].
struct ThereAndBack<const SLOW: bool> {
    there: Boost<CameraFrame, World>,
    back: Boost<World, CameraFrame>,
}

impl<const SLOW: bool> ThereAndBack<SLOW> {
    fn new(frame: &InertialFrame<CameraFrame>) -> Self {
        ThereAndBack {
            there: *frame.frame_from_world(),
            back: *frame.world_from_frame(),
        }
    }

    /// In the lamp's frame: k = r_G d_G, r_G and the proper time of emission.
    #[inline(always)]
    fn leave(&self, way: Displacement<World>) -> (DVec3, [f64; 2]) {
        let way = match SLOW {
            true => self.there.displacement_of_slow(way),
            false => self.there.displacement_of_fast(way),
        };
        // In its own frame the lamp rests: light that arrives at way.ct left r_G earlier.
        let k = -way.x;
        let reach = k.length();
        (k, [reach, way.ct - reach])
    }

    /// The rest, from there on.
    #[inline(always)]
    fn arrive(&self, k: DVec3, reach: f64) -> Arrival {
        let (in_world, distance) = match SLOW {
            true => self.back.null_of_slow(k, reach),
            false => self.back.null_of_fast(k, reach),
        };
        // q, and the quotients that follow from it.
        let square = reach * reach;
        let quotient = inverse_within(distance * square);
        let (per_distance, fade) = (square * quotient, distance * quotient);
        let per_reach = reach * fade;
        Arrival {
            d: Direction::from_unit(in_world * per_distance),
            distance,
            ratio: reach * per_distance,
            inverse: distance * per_reach,
            fade,
            in_lamp: k * per_reach,
            strength: 1.0,
        }
    }

    #[inline(always)]
    fn arrival(&self, way: Displacement<World>) -> (Arrival, f64) {
        let (k, [reach, time]) = self.leave(way);
        (self.arrive(k, reach), time)
    }

    /// The same at a block of points, in two loops: dependency chains are half as long, and more of them are in flight at once.
    #[inline(always)]
    fn arrivals<W: Ways>(&self, ways: &W::Block<'_>, to: &mut ArrivalsBlock) {
        for at in 0..BLOCK {
            let (k, [reach, time]) = self.leave(W::at(ways, at));
            to.in_lamp.set(at, k);
            (to.distance[at], to.times[at]) = (reach, time);
        }
        for at in 0..BLOCK {
            let arrival = self.arrive(to.in_lamp.get(at), to.distance[at]);
            to.set(at, &arrival);
        }
    }
}

impl Emitter for Inertial<'_> {
    #[inline(always)]
    fn arrival(&self, way: Displacement<World>) -> (Arrival, f64) {
        match self.frame.frame_from_world().is_slow() {
            true => ThereAndBack::<true>::new(self.frame).arrival(way),
            false => ThereAndBack::<false>::new(self.frame).arrival(way),
        }
    }

    #[inline(always)]
    fn arrivals<W: Ways>(&self, ways: &W::Block<'_>, to: &mut ArrivalsBlock) {
        match self.frame.frame_from_world().is_slow() {
            true => ThereAndBack::<true>::new(self.frame).arrivals::<W>(ways, to),
            false => ThereAndBack::<false>::new(self.frame).arrivals::<W>(ways, to),
        }
    }
}

/// A lamp that accelerates: its light comes from where its world line crosses the past light cone, with the velocity there.
struct Accelerated<'a> {
    line: &'a WorldLine,
    near: &'a State,
}

impl<'a> Accelerated<'a> {
    fn new((line, near): &'a (WorldLine, State)) -> Self {
        Accelerated { line, near }
    }

    fn seen(&self, way: Displacement<World>) -> Option<(Arrival, f64)> {
        let crossing = self.line.on_past_light_cone(self.near, way)?;
        let proper_time = crossing.proper_time();
        let (_, velocity) = self.line.place(proper_time)?;
        // P − X: `crossing` and `way` both start at the lamp's own event.
        let k = (crossing.displacement - way).x;
        let (d, distance) = (Direction::new(k)?, k.length());
        let boost = Boost::<World, CameraFrame>::new(velocity).inverse();
        let (in_lamp, ratio) = boost.direction(d);
        // r_G: distances transform like frequencies.
        let reach = distance * ratio;
        let arrival = Arrival {
            d,
            distance,
            ratio,
            inverse: 1.0 / ratio,
            fade: 1.0 / (reach * reach),
            in_lamp: in_lamp.unit(),
            strength: 1.0,
        };
        Some((arrival, proper_time))
    }
}

impl Emitter for Accelerated<'_> {
    fn arrival(&self, way: Displacement<World>) -> (Arrival, f64) {
        self.seen(way).unwrap_or((Arrival::NONE, f64::NAN))
    }
}

/// Parallel light at rest in the world. Its phase is the proper time of the lamp's origin when it left the plane perpendicular to it there.
struct ParallelAtRest {
    direction: DVec3,
    index: f64,
}

impl Emitter for ParallelAtRest {
    #[inline(always)]
    fn arrival(&self, way: Displacement<World>) -> (Arrival, f64) {
        let arrival = Arrival {
            d: Direction::from_unit(-self.direction),
            distance: f64::INFINITY,
            ratio: 1.0,
            inverse: 1.0,
            fade: 1.0,
            in_lamp: -self.direction,
            strength: 1.0,
        };
        // The front that passes the lamp's origin reaches x a time η n·x later.
        (arrival, way.ct - self.index * way.x.dot(self.direction))
    }
}

/// Parallel light of a moving lamp.
struct ParallelInertial<'a> {
    frame: &'a InertialFrame<CameraFrame>,
    direction: DVec3,
    /// Direction to it in the world, and ω_world/ω_G.
    in_world: (Direction<World>, f64),
}

impl<'a> ParallelInertial<'a> {
    fn new(frame: &'a InertialFrame<CameraFrame>, direction: DVec3) -> Self {
        let towards = Direction::from_unit(-direction);
        let in_world = frame.world_from_frame().direction(towards);
        ParallelInertial {
            frame,
            direction,
            in_world,
        }
    }
}

impl Emitter for ParallelInertial<'_> {
    #[inline(always)]
    fn arrival(&self, way: Displacement<World>) -> (Arrival, f64) {
        // The phase is that of the lamp's own frame; direction and frequencies are the same everywhere.
        let way = self.frame.frame_from_world().displacement(way);
        let (d, world) = self.in_world;
        let arrival = Arrival {
            d,
            distance: f64::INFINITY,
            ratio: 1.0 / world,
            inverse: world,
            fade: 1.0,
            in_lamp: -self.direction,
            strength: 1.0,
        };
        // In the lamp's frame the medium does not matter: media are supported for lamps at rest only.
        (arrival, way.ct - way.x.dot(self.direction))
    }
}

impl Arrival {
    /// No light.
    const NONE: Arrival = Arrival {
        d: Direction::from_unit(DVec3::NAN),
        distance: f64::NAN,
        ratio: f64::NAN,
        inverse: f64::NAN,
        fade: f64::NAN,
        in_lamp: DVec3::NAN,
        strength: 0.0,
    };
}

/// The light of one lamp incident on a surface.
#[derive(Debug, Clone, Copy)]
pub struct Incident {
    /// E_F, for each channel.
    pub irradiance: [f64; 3],
    pub(crate) wavelength_scale: f64,
}

impl Incident {
    /// E_F of light with the wavelength of its source times `wavelength_scale`.
    #[inline]
    pub fn new(irradiance: [f64; 3], wavelength_scale: f64) -> Self {
        Incident {
            irradiance,
            wavelength_scale,
        }
    }

    /// Light of the same wavelength and this irradiance.
    #[inline]
    pub(crate) fn with(&self, irradiance: [f64; 3]) -> Self {
        Incident {
            irradiance,
            ..*self
        }
    }

    /// The same, `factor` times as bright.
    #[inline]
    pub fn scaled(&self, factor: f64) -> Self {
        Incident {
            irradiance: self.irradiance.map(|e| e * factor),
            ..*self
        }
    }
}

/// The light of all lamps incident on a surface.
#[derive(Debug, Clone, Copy, Default)]
pub struct Irradiance {
    sum: [f64; 3],
    /// Sum over all channels.
    weight: f64,
    /// The same, times the ratio of the wavelength at arrival to that at the lamp.
    weighted: f64,
}

impl Irradiance {
    /// From this sum, and the sums over all channels without and with the wavelength.
    #[inline(always)]
    pub(crate) fn from_parts(sum: [f64; 3], [weight, weighted]: [f64; 2]) -> Self {
        Irradiance {
            sum,
            weight,
            weighted,
        }
    }

    /// Its components.
    #[inline(always)]
    pub(crate) fn parts(&self) -> ([f64; 3], [f64; 2]) {
        (self.sum, [self.weight, self.weighted])
    }

    /// Adds the light of one lamp.
    #[inline]
    pub fn add(&mut self, light: &Incident) {
        for (sum, part) in self.sum.iter_mut().zip(light.irradiance) {
            *sum += part;
            self.weight += part;
            self.weighted += part * light.wavelength_scale;
        }
    }

    /// Adds the weights of the wavelength of `other` light.
    pub(crate) fn merge(&mut self, other: &Irradiance) {
        self.weight += other.weight;
        self.weighted += other.weighted;
    }

    /// Adds the light of one lamp to the weights of the wavelength only.
    #[inline]
    pub fn weigh(&mut self, light: &Incident) {
        for part in light.irradiance {
            self.weight += part;
            self.weighted += part * light.wavelength_scale;
        }
    }

    /// The radiance that a diffuse surface of this albedo reflects: albedo E_F/π.
    #[inline]
    pub fn reflected(&self, albedo: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|c| albedo[c] * self.sum[c] * FRAC_1_PI)
    }

    /// Wavelength of the light over that of the lamps.
    #[inline]
    pub fn wavelength_scale(&self) -> f64 {
        match self.weight > 0.0 {
            true => self.weighted / self.weight,
            false => 1.0,
        }
    }
}
