//! The light of lamps at surfaces.
//!
//! A lamp at rest in its frame G (of the moment, where it accelerates) sends the power I per solid angle. A point
//! of a surface at rest in F is hit by the camera's ray at the event X; the light that falls on it then left the lamp
//! at the event P at which the lamp's world line crosses the past light cone of X. With the null vector k = P − X and
//! the four-velocities u, the distance is r_G = k·u_G in G and r_F = k·u_F in F, and frequencies are as k·u too, so that
//!
//! ```text
//! W = λ_F/λ_G = (k·u_G)/(k·u_F) = r_G/r_F.
//! ```
//!
//! What the lamp sends within dτ into dω_G is N = I dτ dω_G/(hν_G) photons. They cross an area across the beam that
//! all observers agree on, for a solid angle about the emission is dω_F = W² dω_G and r_F = r_G/W: r_F² dω_F = r_G² dω_G.
//! In F each has the energy hν_G/W, and they come within dt_F = W dτ. Per area of the surface and time, therefore,
//!
//! ```text
//! E_F = N hν_G/W · cos θ_F / (r_G² dω_G · W dτ) = W⁻² I cos θ_F / r_G²,
//! E_λ^F(λ) = W⁻³ I_λ(λ/W) cos θ_F / r_G²      (per wavelength: dλ_F = W dλ_G),
//! ```
//!
//! θ_F the angle of incidence in F. The same follows from radiance: a small ball of radiance L_G and of the solid angle
//! ω_G, seen from r_G, is in F of W⁻⁴ L_G and of W² ω_G, and I = L_G ω_G r_G². In general radiance goes with W⁻ᵖ (p by
//! the declared quantity), and irradiance with W²⁻ᵖ. Parallel light is the limit r → ∞ with E_G = I/r_G²: it falls with
//! E_F = W²⁻ᵖ E_G cos θ_F. A diffuse surface of this albedo then has the radiance albedo E_F/π in F.
//!
//! r_G is the distance of Liénard and Wiechert, γ (r − β·r) with r in the world; W and r_G need no acceleration, only
//! the velocity at P. In a medium of index η only lamps at rest in the world are computed: η r takes the place of r
//! in the delay. A line of wavelength λ₀ arrives, and leaves again, with W λ₀ (weighted by irradiance where several
//! lamps meet).
//!
//! Linear RGB arrives as M(W) times what the lamp has, and a spectrum as its colour at W; either leaves as its product with the albedo, component by
//! component: the light reflected is that of white light on the product of both colours. For a white lamp
//! that rests with the surface it is exact; for a coloured or shifted one the products of spectra and of colours differ.
//!
//! Sources: Weiskopf, Kraus, Ruder, ACM TOG 18(3), 1999 (radiance and solid angle); Jackson, Classical
//! Electrodynamics, ch. 14 (the retarded distance); KHR_lights_punctual (the cone of a spot light).

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use glam::DVec3;

use super::Received;
use crate::colour::ColourTable;
use crate::scene::model::{self, Beam, EmissionProfile, Pulse};
use crate::spacetime::worldline::{State, WorldLine};
use crate::spacetime::{
    Boost, Camera, Direction, Displacement, Event, InertialFrame, NullRay, Velocity, World,
};

/// A lamp, ready to be asked for its light.
#[derive(Debug, Clone)]
pub struct Lamp {
    path: Path,
    beam: Cone,
    emission: Emission,
    /// I or E_G, by channel.
    intensity: [f64; 3],
    /// What surfaces receive of it.
    received: Received,
    /// Its colours by W, where it has a spectrum.
    spectrum: Option<Arc<ColourTable>>,
    /// Whether surfaces shadow it.
    pub shadows: bool,
    /// Where it is the pulse of a source: its centre and standard deviation.
    pulse: Option<(Event<World>, f64)>,
}

/// How a lamp moves.
#[derive(Debug, Clone)]
enum Path {
    /// At rest in the world; where its clock shows 0.
    Rest(Event<World>),
    /// Without acceleration; at the frame's origin.
    Inertial(InertialFrame<Camera>),
    /// Any; with a state near those that are asked for.
    Line(Box<(WorldLine, State)>),
}

/// Where it shines to, in its own frame.
#[derive(Debug, Clone, Copy)]
enum Cone {
    Everywhere,
    /// Within the cosines of its outer and inner angle about an axis.
    Spot {
        axis: DVec3,
        outer: f64,
        inner: f64,
    },
    /// Towards this direction alone.
    Parallel(DVec3),
}

/// Intensity by proper time.
#[derive(Debug, Clone)]
enum Emission {
    Steady,
    /// `scale` times the density of a normal distribution.
    Gaussian {
        centre: f64,
        sigma: f64,
        scale: f64,
    },
    Train {
        centre: f64,
        sigma: f64,
        period: f64,
        count: f64,
    },
    Table(Vec<[f64; 2]>),
}

/// The light of a lamp at a point of a surface.
#[derive(Debug, Clone, Copy)]
pub struct Arrival {
    /// Towards the lamp, in the world.
    pub d: Direction<World>,
    /// To the lamp, in the world; infinite for parallel light.
    pub distance: f64,
    /// ω_G/ω_world of the light.
    ratio: f64,
    /// r_G; 1 for parallel light.
    reach: f64,
    /// Towards the lamp, in its frame.
    in_lamp: DVec3,
    /// Intensity towards the point for one of 1.
    strength: f64,
}

impl Lamp {
    /// `lamp`, of whose light `received` comes to surfaces, for points near those seen from `shot`.
    pub fn new(lamp: &model::Lamp, received: Received, shadows: bool, shot: Event<World>) -> Self {
        let path = match lamp.line.frame() {
            Some(frame) if frame.velocity().is_rest() => Path::Rest(lamp.origin),
            Some(frame) => Path::Inertial(frame),
            None => Path::along(&lamp.line, shot),
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
        Lamp {
            path,
            beam,
            emission: Emission::from(&lamp.emission),
            intensity: lamp.intensity,
            received,
            spectrum: lamp
                .spectrum
                .as_ref()
                .map(|s| Arc::new(ColourTable::new(s))),
            shadows,
            pulse: None,
        }
    }

    /// `pulse`, of whose light `received` comes to surfaces: its intensity is an energy per solid angle.
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

    /// Of the pulse of a source, the event of its centre and its standard deviation, metres.
    pub fn source_pulse(&self) -> Option<(Event<World>, f64)> {
        self.pulse
    }

    /// A sun at rest in the world, of whose light `received` comes to surfaces: parallel light.
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

    /// What falls on the point that `ray` hits at `s`, in a medium of index `index`; none while it is dark there.
    #[inline]
    pub fn arrival(&self, ray: &NullRay<World>, s: f64, index: f64) -> Option<Arrival> {
        let (arrival, proper_time) = self.arrival_at_peak(ray, s, index)?;
        let strength = self.emission.at(proper_time) * arrival.strength;
        (strength != 0.0).then_some(Arrival {
            strength,
            ..arrival
        })
    }

    /// The same for a lamp whose emission is always 1, and the proper time of the lamp at which it left.
    #[inline]
    pub fn arrival_at_peak(
        &self,
        ray: &NullRay<World>,
        s: f64,
        index: f64,
    ) -> Option<(Arrival, f64)> {
        if let Cone::Parallel(direction) = self.beam {
            return self.parallel(direction, ray, s, index);
        }
        let (arrival, proper_time) = match &self.path {
            Path::Rest(origin) => at_rest(*origin, ray, s, index)?,
            Path::Inertial(frame) => inertial(frame, ray, s)?,
            Path::Line(line) => accelerated(&line.0, &line.1, ray, s)?,
        };
        let strength = self.attenuation(arrival.in_lamp);
        let arrival = Arrival {
            strength,
            ..arrival
        };
        Some((arrival, proper_time))
    }

    /// The proper times between which it emits; none where it has always done so, or always will.
    pub fn emission_span(&self) -> Option<[f64; 2]> {
        self.emission.span()
    }

    /// The integral of its emission up to a proper time.
    #[inline]
    pub fn emitted_until(&self, proper_time: f64) -> f64 {
        self.emission.until(proper_time)
    }

    /// Its velocity in the world; none where that changes.
    pub fn velocity(&self) -> Option<Velocity> {
        match &self.path {
            Path::Rest(_) => Some(Velocity::REST),
            Path::Inertial(frame) => Some(frame.velocity()),
            Path::Line(_) => None,
        }
    }

    /// What the cone of a spot light leaves of its intensity, seen along `d` of the lamp's frame.
    #[inline]
    fn attenuation(&self, d: DVec3) -> f64 {
        let Cone::Spot { axis, outer, inner } = self.beam else {
            return 1.0;
        };
        let part = ((-axis.dot(d) - outer) / (inner - outer)).clamp(0.0, 1.0);
        part * part
    }

    /// Parallel light: its phase is the proper time of the lamp's origin at which it left the plane across it there.
    #[inline]
    fn parallel(
        &self,
        direction: DVec3,
        ray: &NullRay<World>,
        s: f64,
        index: f64,
    ) -> Option<(Arrival, f64)> {
        let towards = Direction::<Camera>::from_unit(-direction);
        let (d, ratio, way, index) = match &self.path {
            Path::Rest(origin) => {
                let way = from(*origin, ray, s);
                let d = Direction::from_unit(-direction);
                (d, 1.0, Displacement::<Camera>::new(way.ct, way.x), index)
            }
            Path::Inertial(frame) => {
                let way = from(frame.origin(), ray, s);
                let way = frame.frame_from_world().displacement(way);
                let (d, world) = frame.world_from_frame().direction(towards);
                (d, 1.0 / world, way, 1.0)
            }
            Path::Line(_) => return None,
        };
        let arrival = Arrival {
            d,
            distance: f64::INFINITY,
            ratio,
            reach: 1.0,
            strength: 1.0,
            in_lamp: -direction,
        };
        Some((arrival, way.ct - index * way.x.dot(direction)))
    }

    /// E_F of an arrival on a surface, ω_F/ω_world of whose light is `rho`, under the angle of this cosine.
    #[inline]
    pub fn incident(&self, arrival: &Arrival, rho: f64, cosine: f64) -> Incident {
        let w = arrival.ratio / rho;
        let r = arrival.reach;
        let factor = arrival.strength * self.received.irradiance_factor(w) * cosine / (r * r);
        let light = match &self.spectrum {
            None => self.received.colour(w, self.intensity),
            Some(table) => {
                let colour = table.colour(w);
                std::array::from_fn(|c| self.intensity[c] * colour[c])
            }
        };
        Incident {
            irradiance: light.map(|e| e * factor),
            wavelength_scale: self.received.wavelength_scale(w),
        }
    }
}

impl Path {
    fn along(line: &WorldLine, shot: Event<World>) -> Path {
        let seen = line.on_past_light_cone_of(shot);
        let near = seen.and_then(|crossing| line.state(crossing.proper_time()));
        match near.or_else(|| line.state(0.0)) {
            Some(near) => Path::Line(Box::new((line.clone(), near))),
            // Every line has a state at its proper time 0.
            None => Path::Rest(shot),
        }
    }
}

/// By way of the camera's event, so that far from the world's origin no digits are lost.
#[inline]
fn from(event: Event<World>, ray: &NullRay<World>, s: f64) -> Displacement<World> {
    (ray.origin - event) + ray.tangent * s
}

/// What comes from a lamp at rest in the world; as strong as if it were steady, and when it left.
#[inline]
fn at_rest(
    origin: Event<World>,
    ray: &NullRay<World>,
    s: f64,
    index: f64,
) -> Option<(Arrival, f64)> {
    let way = from(origin, ray, s);
    let distance = way.x.length();
    let d = Direction::new(-way.x)?;
    let arrival = Arrival {
        d,
        distance,
        ratio: 1.0,
        reach: distance,
        in_lamp: d.unit(),
        strength: 1.0,
    };
    Some((arrival, way.ct - index * distance))
}

/// From a lamp without acceleration: all is as at rest in its frame, and the null vector k = r_G (−1, d) is boosted.
#[inline]
fn inertial(frame: &InertialFrame<Camera>, ray: &NullRay<World>, s: f64) -> Option<(Arrival, f64)> {
    let way = from(frame.origin(), ray, s);
    let way = frame.frame_from_world().displacement(way);
    let reach = way.x.length();
    let in_lamp = Direction::<Camera>::new(-way.x)?;
    let (d, world) = frame.world_from_frame().direction(in_lamp);
    let arrival = Arrival {
        d,
        distance: reach * world,
        ratio: 1.0 / world,
        reach,
        in_lamp: in_lamp.unit(),
        strength: 1.0,
    };
    Some((arrival, way.ct - reach))
}

/// From where the line crosses the past light cone, with the velocity that it has there.
fn accelerated(
    line: &WorldLine,
    near: &State,
    ray: &NullRay<World>,
    s: f64,
) -> Option<(Arrival, f64)> {
    let offset = from(near.event, ray, s);
    let crossing = line.on_past_light_cone(near, offset)?;
    let proper_time = crossing.proper_time();
    let (_, velocity) = line.place(proper_time)?;
    let k = (crossing.displacement - offset).x;
    let (d, distance) = (Direction::new(k)?, k.length());
    let boost = Boost::<World, Camera>::new(velocity).inverse();
    let (in_lamp, ratio) = boost.direction(d);
    let arrival = Arrival {
        d,
        distance,
        ratio,
        reach: distance * ratio,
        in_lamp: in_lamp.unit(),
        strength: 1.0,
    };
    Some((arrival, proper_time))
}

/// The light of one lamp that falls on a surface.
#[derive(Debug, Clone, Copy)]
pub struct Incident {
    /// E_F, by channel.
    pub irradiance: [f64; 3],
    wavelength_scale: f64,
}

impl Incident {
    /// E_F whose light has the wavelength of its source times `wavelength_scale`.
    #[inline]
    pub fn new(irradiance: [f64; 3], wavelength_scale: f64) -> Self {
        Incident {
            irradiance,
            wavelength_scale,
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

/// The light of all lamps that falls on a surface.
#[derive(Debug, Clone, Copy, Default)]
pub struct Irradiance {
    sum: [f64; 3],
    /// Of all channels.
    weight: f64,
    /// The same, times the wavelength at which it arrives over that of the lamp.
    weighted: f64,
}

impl Irradiance {
    /// Adds the light of one lamp.
    #[inline]
    pub fn add(&mut self, light: &Incident) {
        for (sum, part) in self.sum.iter_mut().zip(light.irradiance) {
            *sum += part;
            self.weight += part;
            self.weighted += part * light.wavelength_scale;
        }
    }

    /// Adds the light of one lamp to what its wavelength is found from, and to nothing else.
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
        std::array::from_fn(|c| albedo[c] * self.sum[c] / PI)
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

impl From<&EmissionProfile> for Emission {
    fn from(profile: &EmissionProfile) -> Self {
        match profile {
            EmissionProfile::Steady => Emission::Steady,
            EmissionProfile::Gaussian { centre, sigma } => Emission::Gaussian {
                centre: *centre,
                sigma: *sigma,
                // 1 at the peak.
                scale: sigma * TAU.sqrt(),
            },
            EmissionProfile::Train {
                centre,
                sigma,
                period,
                count,
            } => Emission::Train {
                centre: *centre,
                sigma: *sigma,
                period: *period,
                count: count.map_or(f64::INFINITY, f64::from),
            },
            EmissionProfile::Table(knots) => Emission::Table(knots.clone()),
        }
    }
}

impl Emission {
    /// The factor on the intensity at a proper time.
    #[inline]
    fn at(&self, proper_time: f64) -> f64 {
        match self {
            Emission::Steady => 1.0,
            Emission::Gaussian {
                centre,
                sigma,
                scale,
            } => gaussian((proper_time - centre) / sigma) / sigma * scale,
            Emission::Train {
                centre,
                sigma,
                period,
                count,
            } => train((proper_time - centre) / period, period / sigma, *count),
            Emission::Table(knots) => table(knots, proper_time),
        }
    }
}

impl Emission {
    /// The proper times between which it is not 0.
    fn span(&self) -> Option<[f64; 2]> {
        match self {
            Emission::Steady => None,
            Emission::Gaussian { centre, sigma, .. } => {
                Some([centre - CUT * sigma, centre + CUT * sigma])
            }
            Emission::Train {
                centre,
                sigma,
                period,
                count,
            } => {
                let last = centre + (count - 1.0) * period;
                last.is_finite()
                    .then(|| [centre - CUT * sigma, last + CUT * sigma])
            }
            Emission::Table(knots) => Some([knots.first()?[0], knots.last()?[0]]),
        }
    }

    /// The integral up to a proper time; infinite where it has always shone.
    fn until(&self, proper_time: f64) -> f64 {
        match self {
            Emission::Steady => f64::INFINITY,
            Emission::Gaussian {
                centre,
                sigma,
                scale,
            } => normal((proper_time - centre) / sigma) * scale,
            Emission::Train {
                centre,
                sigma,
                period,
                count,
            } => {
                let (phase, reach) = ((proper_time - centre) / period, CUT * sigma / period);
                // Those that are over, and those that are not.
                let over = (phase - reach).ceil().clamp(0.0, *count);
                let begun = (phase + reach).floor().min(count - 1.0);
                let rest = (0..=17)
                    .map(|n| over + f64::from(n))
                    .take_while(|k| *k <= begun);
                let rest: f64 = rest.map(|k| normal((phase - k) * period / sigma)).sum();
                (over + rest) * sigma * TAU.sqrt()
            }
            Emission::Table(knots) => {
                let parts = knots.windows(2).map(|pair| {
                    let [[from, first], [to, last]] = [pair[0], pair[1]];
                    let upto = proper_time.clamp(from, to);
                    let there = first + (last - first) * ((upto - from) / (to - from));
                    0.5 * (first + there) * (upto - from)
                });
                parts.sum()
            }
        }
    }
}

/// The integral of the normal distribution's density up to x.
fn normal(x: f64) -> f64 {
    0.5 * libm::erfc(-x * std::f64::consts::FRAC_1_SQRT_2)
}

/// Pulses of standard deviation 1/`spacing` at the integers that are `count` from 0 on; all for an infinite `count`.
fn train(phase: f64, spacing: f64, count: f64) -> f64 {
    let (first, last) = match count.is_finite() {
        true => (0.0, count - 1.0),
        false => (f64::NEG_INFINITY, f64::INFINITY),
    };
    // Those that are not below the Gaussian's smallest value: at most 17, for `spacing` is at least 1.
    let reach = CUT / spacing;
    let begin = (phase - reach).ceil().max(first);
    let end = (phase + reach).floor().min(last);
    let pulses = (0..=17).map(|n| begin + f64::from(n));
    let value = |k: f64| gaussian((phase - k) * spacing) * TAU.sqrt();
    pulses.take_while(|k| *k <= end).map(value).sum()
}

/// Linear between knots, 0 outside.
fn table(knots: &[[f64; 2]], time: f64) -> f64 {
    let after = knots.partition_point(|[at, _]| *at <= time);
    let Some(&[last, value]) = after.checked_sub(1).and_then(|before| knots.get(before)) else {
        return 0.0;
    };
    match knots.get(after) {
        Some(&[next, then]) => value + (then - value) * ((time - last) / (next - last)),
        None if time == last => value,
        None => 0.0,
    }
}

/// The unit Gaussian is taken for 0 beyond this: below the smallest value that matters, 5·10⁻¹⁵.
const CUT: f64 = 8.0;

#[inline]
fn gaussian(x: f64) -> f64 {
    if x.abs() > CUT {
        return 0.0;
    }
    libm::exp(-0.5 * x * x) / TAU.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_train_is_the_sum_of_its_pulses() {
        for count in [1.0, 3.0, f64::INFINITY] {
            for x in [-2.3, -0.5, 0.0, 0.4, 1.5, 2.0, 2.2, 7.0] {
                let pulses =
                    (-40..=40).filter(|k| count.is_infinite() || (0..count as i32).contains(k));
                let sum: f64 = pulses
                    .map(|k| libm::exp(-0.5 * (1.5 * (x - f64::from(k))).powi(2)))
                    .sum();
                assert!((train(x, 1.5, count) - sum).abs() < 1e-13, "{count} {x}");
            }
        }
        // No time is too late, and a train that has ended stays dark.
        assert_eq!(train(1e300, 1.5, 3.0), 0.0);
    }

    #[test]
    fn emission_adds_up_to_its_integral() {
        let all = [
            Emission::Gaussian {
                centre: 0.3,
                sigma: 0.2,
                scale: 1.7,
            },
            Emission::Train {
                centre: -1.0,
                sigma: 0.2,
                period: 0.35,
                count: 5.0,
            },
            Emission::Table(vec![[-1.0, 0.5], [0.2, 2.0], [0.5, 0.0], [1.5, 1.0]]),
        ];
        for emission in all {
            // By the midpoints of 4000 steps.
            let (mut sum, step) = (0.0, 2e-3);
            for k in 0..4000 {
                let t = -4.0 + (f64::from(k) + 0.5) * step;
                sum += emission.at(t) * step;
                let until = emission.until(t + 0.5 * step);
                assert!(
                    (until - sum).abs() < 2e-3,
                    "{emission:?} {t}: {until} {sum}"
                );
            }
            let [from, to] = emission.span().unwrap();
            assert!(emission.until(from) < 1e-12 && emission.at(from - 1e-9) == 0.0);
            assert!((emission.until(to) - emission.until(9.0)).abs() < 1e-12);
        }
    }

    #[test]
    fn a_table_is_linear_between_its_times_and_dark_outside() {
        let knots = [[0.0, 1.0], [2.0, 3.0], [3.0, 0.5]];
        let values = [-0.1, 0.0, 1.0, 2.0, 2.5, 3.0, 3.1].map(|t| table(&knots, t));
        assert_eq!(values, [0.0, 1.0, 2.0, 3.0, 1.75, 0.5, 0.0]);
    }
}
