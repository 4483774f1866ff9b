//! Motion along a curve through events of the world.
//!
//! The curve is [`super::spline`] or [`super::cubics`], its clock [`super::clock`]. With v = dx/dct and w = dv/dct the four-velocity is
//! γ(1, v), and the proper acceleration in the comoving, boosted axes is
//!
//! ```text
//! a = γ² w + γ⁴/(1 + γ) (v·w) v,    γ² = 1/((1 − |v|)(1 + |v|)).
//! ```
//!
//! The line of an animation rests at its first event until then, and at its last one from then on: there it is an inertial line, x = x_k, ct
//! = ct_k + τ − τ_k, which crosses the past light cone of (T, X) at ct = T − |X − x_k|. Its velocity jumps at both ends, its position does
//! not, so every past light cone crosses it once. At the ends themselves it has the velocity of the part in between.

use glam::DVec3;

use super::clock::Clock;
use super::cone::past_cone;
use super::cubics;
use super::elapsed::Elapsed;
use super::error::{WorldLineError, check_ascending, check_count};
use super::horizon;
use super::series::{Series, SeriesCrossing};
use super::spline;
use super::state::{Crossing, State};
use crate::spacetime::{Displacement, Event, Velocity, World};

/// A curve as a function of world time, and its clock.
#[derive(Debug, Clone)]
pub(super) struct Keyframes {
    series: Series,
    clock: Clock,
    /// Whether the line rests before its first event and after its last one; otherwise it does not exist then.
    rests: bool,
}

impl Keyframes {
    pub fn smooth(events: &[Event<World>]) -> Result<Self, WorldLineError> {
        Keyframes::new(events, spline::natural)
    }

    pub fn straight(events: &[Event<World>]) -> Result<Self, WorldLineError> {
        Keyframes::new(events, cubics::polyline)
    }

    pub fn cubic(
        events: &[Event<World>],
        velocities: &[[DVec3; 2]],
    ) -> Result<Self, WorldLineError> {
        Keyframes::new(events, |events| cubics::cubics(events, velocities))
    }

    fn new(
        events: &[Event<World>],
        curve: impl Fn(&[Event<World>]) -> Result<Series, WorldLineError>,
    ) -> Result<Self, WorldLineError> {
        check_count(events.len())?;
        let finite = |e: &Event<World>| e.ct.is_finite() && e.x.is_finite();
        if let Some(index) = events.iter().position(|e| !finite(e)) {
            return Err(WorldLineError::EntryNotFinite { index });
        }
        check_ascending(events.iter().map(|e| e.ct))?;
        let series = curve(events)?;
        let clock = Clock::new(&series.parameters, |span, s| rate(&series, span, s));
        Ok(Keyframes {
            series,
            clock,
            rests: false,
        })
    }

    /// The same line, at rest for ever before and after its ends.
    pub fn resting(self) -> Self {
        Keyframes {
            rests: true,
            ..self
        }
    }

    pub fn span(&self) -> [f64; 2] {
        match self.rests {
            true => [f64::NEG_INFINITY, f64::INFINITY],
            false => self.keys(),
        }
    }

    /// The proper times before and after which the line rests.
    pub fn rests(&self) -> Option<[f64; 2]> {
        self.rests.then(|| self.keys())
    }

    /// The proper times of the first and the last event.
    fn keys(&self) -> [f64; 2] {
        [0.0, self.clock.end()]
    }

    /// The event at which the line rests at a proper time, and the proper time of that event; `None` if it does not rest then.
    fn rest_at(&self, proper_time: f64) -> Option<(Event<World>, f64)> {
        let [first, last] = self.rests()?;
        let events = &self.series.events;
        match proper_time {
            _ if proper_time < first => Some((*events.first()?, first)),
            _ if proper_time > last => Some((*events.last()?, last)),
            _ => None,
        }
    }

    /// The same for the crossing with a past light cone; `from` is the displacement from an event to the cone's apex.
    fn rest_seen(
        &self,
        from: impl Fn(Event<World>) -> Displacement<World>,
    ) -> Option<(Event<World>, f64)> {
        let [first, last] = self.rests()?;
        let (begin, end) = (*self.series.events.first()?, *self.series.events.last()?);
        let to_end = from(end);
        match () {
            // Its first event is not visible yet, or its last one already was.
            () if !from(begin).is_causal() => Some((begin, first)),
            () if to_end.ct > to_end.x.length() => Some((end, last)),
            () => None,
        }
    }

    pub fn state(&self, proper_time: f64) -> Option<State> {
        if let Some((event, time)) = self.rest_at(proper_time) {
            let since = Displacement::new(proper_time - time, DVec3::ZERO);
            return Some(State::new(
                proper_time,
                event + since,
                Velocity::REST,
                DVec3::ZERO,
            ));
        }
        let ct = self
            .clock
            .world_time(proper_time, |span, s| rate(&self.series, span, s));
        let (event, tangent) = self.series.at(ct);
        let (v, w) = (tangent.x, self.series.second(ct));
        let velocity = Velocity::from_beta(v).ok()?;
        let acceleration = horizon::proper(v, w);
        Some(State::new(proper_time, event, velocity, acceleration))
    }

    /// As [`super::WorldLine::beyond_horizon`].
    pub fn beyond_horizon(&self, [from, to]: [f64; 2], points: &[DVec3]) -> Option<DVec3> {
        let [first, last] = self.keys();
        // At rest, before and after, there is no horizon.
        if to < first || from > last {
            return None;
        }
        let times = [from, to].map(|time| {
            let time = time.clamp(first, last);
            self.clock
                .world_time(time, |span, s| rate(&self.series, span, s))
        });
        let nodes = self.series.parameters.iter().copied();
        horizon::beyond(times, nodes, points, |middle, half| {
            let (_, tangent) = self.series.at(middle);
            let [second, third] = [self.series.second(middle), self.series.third(middle)];
            Some(horizon::on_path([tangent.x, second, third], half))
        })
    }

    pub fn past_cone(&self, near: &State, offset: Displacement<World>) -> Option<Crossing> {
        let own = self.rest_at(near.proper_time);
        if let Some((event, time)) = self.rest_seen(|node| (near.event - node) + offset) {
            // From a state at the same rest, without the displacement to its end, which may be long.
            if own.is_some_and(|(_, own)| own == time) {
                return past_cone(near, offset);
            }
            let apex = (near.event - event) + offset;
            let since = apex.ct - apex.x.length();
            let moved = (event - near.event) + Displacement::new(since, DVec3::ZERO);
            return Some(Crossing::new(
                near.event,
                moved,
                Elapsed::known(time, since),
            ));
        }
        if let Some((event, _)) = own {
            // From rest into the curve: via the nearest end of the curve.
            let to_end = event - near.event;
            let found = self
                .series
                .past_cone(event, event.ct, offset - to_end, f64::NAN)?;
            let moved = to_end + found.displacement;
            return Some(self.crossing(
                near.event,
                SeriesCrossing {
                    displacement: moved,
                    ..found
                },
            ));
        }
        let guess = past_cone(near, offset).map_or(f64::NAN, |c| c.displacement.ct);
        let found = self
            .series
            .past_cone(near.event, near.event.ct, offset, guess)?;
        Some(self.crossing(near.event, found))
    }

    pub fn past_cone_of(&self, apex: Event<World>) -> Option<Crossing> {
        if let Some((event, time)) = self.rest_seen(|node| apex - node) {
            let from = apex - event;
            let distance = from.x.length();
            let back = Displacement::new(-distance, -from.x);
            let elapsed = Elapsed::known(time, from.ct - distance);
            return Some(Crossing::new(apex, back, elapsed));
        }
        Some(self.crossing(apex, self.series.past_cone_of(apex)?))
    }

    fn crossing(&self, reference: Event<World>, found: SeriesCrossing) -> Crossing {
        let proper_time = self
            .clock
            .proper_time(found.parameter, |span, s| rate(&self.series, span, s));
        let elapsed = Elapsed::known(proper_time, 0.0);
        Crossing::new(reference, found.displacement, elapsed)
    }
}

/// dτ/dct = √(1 − |v|²) at the world time `s` after the beginning of a span.
fn rate(series: &Series, span: usize, s: f64) -> f64 {
    let speed = series.tangent(span, s).x.length();
    ((1.0 - speed) * (1.0 + speed)).sqrt()
}
