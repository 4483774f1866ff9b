//! The light of one lamp at many points: what [`Lamp::arrival`] says of each, in loops over arrays.

use glam::DVec3;

use super::{
    Accelerated, AtRest, Cone, Emitter, Inertial, Lamp, ParallelAtRest, ParallelInertial, Path,
    within_cone,
};
use crate::accel::vectors::{Columns, ColumnsMut, ColumnsRef, VectorLoop, dispatch};
use crate::spacetime::{Displacement, Event, Frame, World};

/// Events or displacements by component.
#[derive(Debug, Default)]
pub(crate) struct EventColumns {
    pub ct: Vec<f64>,
    pub x: Columns,
}

/// Points on world rays.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PointsOnRays<'a> {
    /// Where all rays leave.
    pub shot: Event<World>,
    /// Where each of them does; none if all leave the shot.
    pub origins: Option<&'a EventColumns>,
    /// From there to the points.
    pub offsets: &'a EventColumns,
}

/// What comes of a lamp, by point; see [`Arrival`](super::Arrival).
#[derive(Debug, Default)]
pub(crate) struct Arrivals {
    /// Towards the lamp in the world; NaN where no light comes.
    pub d: Columns,
    /// To the lamp in the world, metres; infinite for parallel light.
    pub distance: Vec<f64>,
    /// Intensity towards the point for one of 1.
    pub strength: Vec<f64>,
    ratio: Vec<f64>,
    reach: Vec<f64>,
    in_lamp: Columns,
}

impl EventColumns {
    /// Makes room for `count` events; what they are is to be written.
    pub fn resize(&mut self, count: usize) {
        self.ct.resize(count, 0.0);
        self.x.resize(count);
    }
}

impl Arrivals {
    fn resize(&mut self, count: usize) {
        for column in [
            &mut self.distance,
            &mut self.strength,
            &mut self.ratio,
            &mut self.reach,
        ] {
            column.resize(count, 0.0);
        }
        self.d.resize(count);
        self.in_lamp.resize(count);
    }
}

impl Lamp {
    /// What falls on each of `points`, in a medium of index `index`.
    pub(crate) fn arrivals(&self, points: &PointsOnRays, index: f64, to: &mut Arrivals) {
        to.resize(points.offsets.ct.len());
        match (&self.path, self.beam) {
            (Path::Rest(origin), Cone::Parallel(direction)) => {
                arrive(&ParallelAtRest { direction, index }, *origin, points, to);
            }
            (Path::Inertial(frame), Cone::Parallel(direction)) => {
                let path = ParallelInertial::new(frame, direction);
                arrive(&path, frame.origin(), points, to);
            }
            (Path::Line(_), Cone::Parallel(_)) => {
                to.strength.fill(0.0);
                return;
            }
            (Path::Rest(origin), _) => arrive(&AtRest { index }, *origin, points, to),
            (Path::Inertial(frame), _) => {
                arrive(&Inertial { frame }, frame.origin(), points, to);
            }
            (Path::Line(line), _) => {
                arrive(&Accelerated::new(line), line.1.event, points, to);
            }
        }
        // Its strength, which so far is the proper time.
        self.emission.at_each(&mut to.strength);
        if let Cone::Spot { axis, outer, inner } = self.beam {
            dispatch(Attenuate {
                axis,
                cone: [outer, inner],
                in_lamp: to.in_lamp.first(to.strength.len()),
                strength: &mut to.strength,
            });
        }
    }

    /// The factors on the lamp's intensity by which it falls on surfaces, and W, where ω_F/ω_world is `rho`: of arrivals `to`
    /// under angles of these cosines.
    pub(crate) fn incident_factors(
        &self,
        arrivals: &Arrivals,
        rho: &[f64],
        cosines: &[f64],
        ratios: &mut Vec<f64>,
        factors: &mut Vec<f64>,
    ) {
        ratios.clear();
        ratios.resize(rho.len(), 0.0);
        dispatch(Ratios {
            emitted: &arrivals.ratio,
            received: rho,
            ratios,
        });
        factors.clear();
        factors.extend_from_slice(ratios);
        self.received.irradiance_factors(factors);
        dispatch(Factors {
            strength: &arrivals.strength,
            reach: &arrivals.reach,
            cosines,
            factors,
        });
    }
}

/// Fills `to` with what comes from `emitter`, whose own event is `from`; the strength is the proper time of emission.
fn arrive(emitter: &impl Emitter, from: Event<World>, points: &PointsOnRays, to: &mut Arrivals) {
    let count = points.offsets.ct.len();
    let offsets = EventsRef::of(points.offsets, count);
    let to = ArrivalsMut {
        d: to.d.first_mut(count),
        distance: &mut to.distance[..count],
        times: &mut to.strength[..count],
        ratio: &mut to.ratio[..count],
        reach: &mut to.reach[..count],
        in_lamp: to.in_lamp.first_mut(count),
    };
    match points.origins {
        None => dispatch(Arrive {
            emitter,
            starts: Shared(points.shot - from),
            offsets,
            to,
        }),
        Some(origins) => dispatch(Arrive {
            emitter,
            starts: Each(EventsRef::of(origins, count), from),
            offsets,
            to,
        }),
    }
}

/// From a lamp's own event to where rays leave.
trait Starts {
    fn at(&self, k: usize) -> Displacement<World>;
}

struct Shared(Displacement<World>);

impl Starts for Shared {
    #[inline(always)]
    fn at(&self, _: usize) -> Displacement<World> {
        self.0
    }
}

struct Each<'a>(EventsRef<'a>, Event<World>);

impl Starts for Each<'_> {
    #[inline(always)]
    fn at(&self, k: usize) -> Displacement<World> {
        self.0.event::<World>(k) - self.1
    }
}

#[derive(Clone, Copy)]
struct EventsRef<'a> {
    ct: &'a [f64],
    x: ColumnsRef<'a>,
}

impl<'a> EventsRef<'a> {
    fn of(events: &'a EventColumns, count: usize) -> Self {
        EventsRef {
            ct: &events.ct[..count],
            x: events.x.first(count),
        }
    }

    #[inline(always)]
    fn event<F: Frame>(&self, k: usize) -> Event<F> {
        Event::new(self.ct[k], self.x.get(k))
    }
}

struct ArrivalsMut<'a> {
    d: ColumnsMut<'a>,
    distance: &'a mut [f64],
    times: &'a mut [f64],
    ratio: &'a mut [f64],
    reach: &'a mut [f64],
    in_lamp: ColumnsMut<'a>,
}

/// The loop over points.
struct Arrive<'a, E, S> {
    emitter: &'a E,
    starts: S,
    offsets: EventsRef<'a>,
    to: ArrivalsMut<'a>,
}

impl<E: Emitter, S: Starts> VectorLoop for Arrive<'_, E, S> {
    #[inline(always)]
    fn run(self) {
        let Arrive {
            emitter,
            starts,
            offsets,
            mut to,
        } = self;
        for k in 0..offsets.ct.len() {
            let offset = Displacement::new(offsets.ct[k], offsets.x.get(k));
            let (arrival, time) = emitter.arrival(starts.at(k) + offset);
            to.d.set(k, arrival.d.unit());
            to.distance[k] = arrival.distance;
            to.times[k] = time;
            to.ratio[k] = arrival.ratio;
            to.reach[k] = arrival.reach;
            to.in_lamp.set(k, arrival.in_lamp);
        }
    }
}

/// What the cone of a spot light leaves of its strength.
struct Attenuate<'a> {
    axis: DVec3,
    cone: [f64; 2],
    in_lamp: ColumnsRef<'a>,
    strength: &'a mut [f64],
}

impl VectorLoop for Attenuate<'_> {
    #[inline(always)]
    fn run(self) {
        for (k, strength) in self.strength.iter_mut().enumerate() {
            *strength *= within_cone(self.axis, self.cone, self.in_lamp.get(k));
        }
    }
}

/// W = (ω_G/ω_world)/(ω_F/ω_world).
struct Ratios<'a> {
    emitted: &'a [f64],
    received: &'a [f64],
    ratios: &'a mut [f64],
}

impl VectorLoop for Ratios<'_> {
    #[inline(always)]
    fn run(self) {
        for ((ratio, emitted), received) in
            self.ratios.iter_mut().zip(self.emitted).zip(self.received)
        {
            *ratio = emitted / received;
        }
    }
}

/// From the factor of W to that on the intensity: strength · W²⁻ᵖ cos θ/r².
struct Factors<'a> {
    strength: &'a [f64],
    reach: &'a [f64],
    cosines: &'a [f64],
    factors: &'a mut [f64],
}

impl VectorLoop for Factors<'_> {
    #[inline(always)]
    fn run(self) {
        let count = self.factors.len();
        let (strength, reach, cosines) = (
            &self.strength[..count],
            &self.reach[..count],
            &self.cosines[..count],
        );
        for (k, factor) in self.factors.iter_mut().enumerate() {
            let r = reach[k];
            *factor = strength[k] * *factor * cosines[k] / (r * r);
        }
    }
}
