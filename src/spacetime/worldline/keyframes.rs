//! Motion along a curve through events of the world.
//!
//! The curve is [`super::spline`] or [`super::polyline`], its clock [`super::clock`]. With v = dx/dct and w = dv/dct the four-velocity is
//! γ(1, v), and the proper acceleration in the comoving, boosted axes is
//!
//! ```text
//! a = γ² w + γ⁴/(1 + γ) (v·w) v,    γ² = 1/((1 − |v|)(1 + |v|)).
//! ```

use super::clock::Clock;
use super::cone::past_cone;
use super::elapsed::Elapsed;
use super::error::{WorldLineError, check_ascending, check_count};
use super::polyline;
use super::series::{Found, Series};
use super::spline;
use super::state::{Crossing, State};
use crate::spacetime::{Displacement, Event, Velocity, World};

/// A curve by world time, and its clock.
#[derive(Debug, Clone)]
pub(super) struct Keyframes {
    series: Series,
    clock: Clock,
}

impl Keyframes {
    pub fn smooth(events: &[Event<World>]) -> Result<Self, WorldLineError> {
        Keyframes::new(events, spline::natural)
    }

    pub fn straight(events: &[Event<World>]) -> Result<Self, WorldLineError> {
        Keyframes::new(events, polyline::polyline)
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
        Ok(Keyframes { series, clock })
    }

    pub fn span(&self) -> [f64; 2] {
        [0.0, self.clock.end()]
    }

    pub fn state(&self, proper_time: f64) -> Option<State> {
        let ct = self
            .clock
            .world_time(proper_time, |span, s| rate(&self.series, span, s));
        let (event, tangent) = self.series.at(ct);
        let (v, w) = (tangent.x, self.series.second(ct));
        let speed = v.length();
        // γ² and γ⁴/(1 + γ) (v·w), the factors of a.
        let gamma_squared = 1.0 / ((1.0 - speed) * (1.0 + speed));
        let along = gamma_squared * gamma_squared / (1.0 + gamma_squared.sqrt()) * v.dot(w);
        let velocity = Velocity::from_beta(v).ok()?;
        let acceleration = w * gamma_squared + v * along;
        Some(State::new(proper_time, event, velocity, acceleration))
    }

    pub fn past_cone(&self, near: &State, offset: Displacement<World>) -> Option<Crossing> {
        let guess = past_cone(near, offset).map_or(f64::NAN, |c| c.displacement.ct);
        let found = self
            .series
            .past_cone(near.event, near.event.ct, offset, guess)?;
        Some(self.crossing(near.event, found))
    }

    pub fn past_cone_of(&self, apex: Event<World>) -> Option<Crossing> {
        Some(self.crossing(apex, self.series.past_cone_of(apex)?))
    }

    fn crossing(&self, reference: Event<World>, found: Found) -> Crossing {
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
