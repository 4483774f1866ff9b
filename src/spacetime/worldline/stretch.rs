//! A stretch of constant proper acceleration, for evaluation at very many proper times.
//!
//! In the frame comoving at one of its proper times, the anchor, the line is the hyperbola of [`super::thrust`]. After further proper time
//! σ it moves there with the rapidity φ = gσ along n. Anchors are so close that |φ| ≤ ¼. With q = φ²
//!
//! ```text
//! sinh φ       = φ (1 + q/6 (1 + q/20 (1 + q/42 (1 + q/72 (1 + q/110))))),
//! cosh φ − 1   = ½ q (1 + q/12 (1 + q/30 (1 + q/56 (1 + q/90 (1 + q/132))))):
//! ```
//!
//! the next terms, q⁶/13! and 2q⁶/14!, are below 10⁻¹⁷. Everything else needs only roots and quotients.
//!
//! A direction c in the comoving frame's axes, which are the world's boosted without rotation, is first converted to the axes that were
//! carried along from the anchor without rotation, by the inverse of [`super::hyperbola`]'s rotation: with t₀ = tanh(w₀/2) m of the anchor
//! and t₁ = tanh(φ/2) n, where tanh(φ/2) = sinh φ/(cosh φ + 1), its Gibbs vector is b = t₀ × t₁/(1 + t₀·t₁). Then it is boosted twice: from
//! the comoving frame to the anchor, and from there to the world.

use glam::DVec3;

use super::state::State;
use crate::spacetime::{Boost, CameraFrame, Direction, Displacement, Event, World};

/// The largest |φ| between an anchor and a proper time, for which the series above are exact to rounding.
const REACH: f64 = 0.25;

/// The maximum number of anchors of a stretch: more than needed for [`crate::spacetime::MAX_RAPIDITY`] and back.
const MOST_ANCHORS: f64 = 512.0;

/// A stretch of a world line along which its proper acceleration is constant.
#[derive(Debug, Clone)]
pub struct Stretch {
    /// Proper time at its beginning.
    begin: f64,
    /// Anchors per metre of proper time.
    density: f64,
    anchors: Vec<Anchor>,
}

/// A state of a stretch, for evaluation at proper times around it.
#[derive(Debug, Clone)]
pub struct Anchor {
    proper_time: f64,
    /// The event, relative to the stretch's reference.
    moved: Displacement<World>,
    world_from_comoving: Boost<World, CameraFrame>,
    /// Magnitude of the proper acceleration, 1/m, and its direction.
    g: f64,
    n: DVec3,
    /// The four-velocity, and (0, n) of the comoving frame in the world.
    ahead: Displacement<World>,
    aside: Displacement<World>,
    /// t₀ × n and t₀·n.
    turn: DVec3,
    lean: f64,
}

/// φ, φ², sinh φ/φ and 2 (cosh φ − 1)/φ².
struct Series {
    phi: f64,
    q: f64,
    odd: f64,
    even: f64,
}

impl Stretch {
    /// The stretch between two proper times, whose states are given by `state`; events are relative to `reference`. `g` is its proper
    /// acceleration. `None` if there is no state, or if it lasts too long.
    pub(super) fn new(
        [begin, end]: [f64; 2],
        g: f64,
        reference: Event<World>,
        state: impl Fn(f64) -> Option<State>,
    ) -> Option<Self> {
        let duration = end - begin;
        // An anchor covers a rapidity of `REACH` on either side.
        let count = (g * duration / (2.0 * REACH)).ceil().max(1.0);
        let usable = duration > 0.0 && count <= MOST_ANCHORS;
        if !usable {
            return None;
        }
        let middles = (0..count as usize).map(|k| begin + duration * (k as f64 + 0.5) / count);
        let anchors = middles.map(|middle| Some(Anchor::new(&state(middle)?, reference)));
        let mut anchors: Vec<Anchor> = anchors.collect::<Option<_>>()?;
        // At its beginning the stretch agrees with its state to the last digit.
        let first = &mut anchors[0];
        let back = first.way(begin - first.proper_time);
        first.moved = (state(begin)?.event - reference) + back * -1.0;
        Some(Stretch {
            begin,
            density: count / duration,
            anchors,
        })
    }

    /// The anchor nearest to a proper time of the stretch.
    #[inline(always)]
    pub fn nearest(&self, proper_time: f64) -> &Anchor {
        // A time slightly before the beginning, due to rounding, is negative, and the cast makes it 0.
        let nearest = ((proper_time - self.begin) * self.density) as usize;
        &self.anchors[nearest.min(self.anchors.len() - 1)]
    }

    /// The anchor, if there is only one.
    pub fn only(&self) -> Option<&Anchor> {
        match self.anchors.as_slice() {
            [anchor] => Some(anchor),
            _ => None,
        }
    }
}

impl Anchor {
    fn new(state: &State, reference: Event<World>) -> Self {
        let (m, w) = state.velocity.split();
        let first = m * libm::tanh(0.5 * w);
        let (g, n) = (state.thrust.g, state.thrust.n);
        Anchor {
            proper_time: state.proper_time,
            moved: state.event - reference,
            world_from_comoving: *state.frame().world_from_frame(),
            g,
            n,
            ahead: state.ahead,
            aside: state.aside,
            turn: first.cross(n),
            lean: first.dot(n),
        }
    }

    /// The view along `seen` in the comoving frame at a proper time near this one: the displacement from the reference to the line's event
    /// then, the look direction in the world, and ω_world/ω_comoving of light from there.
    #[inline(always)]
    pub fn look(
        &self,
        proper_time: f64,
        seen: Direction<CameraFrame>,
    ) -> (Displacement<World>, Direction<World>, f64) {
        let (d, ratio) = self.turned(proper_time, seen);
        let (d, onward) = self.world_from_comoving.direction(d);
        (self.event(proper_time), d, ratio * onward)
    }

    /// The first part of [`Anchor::look`]: the look direction in the anchor's frame, and ω_anchor/ω_comoving.
    #[inline(always)]
    pub(crate) fn turned(
        &self,
        proper_time: f64,
        seen: Direction<CameraFrame>,
    ) -> (Direction<CameraFrame>, f64) {
        let since = proper_time - self.proper_time;
        let Series { phi, q, odd, even } = self.series(since);
        // Convert to the axes that were carried along.
        let (sinh, rise) = (phi * odd, 0.5 * q * even);
        let tanh_of_half = sinh / (2.0 + rise);
        let c = seen.unit();
        let gibbs = self.turn * (tanh_of_half / (1.0 + self.lean * tanh_of_half));
        let across = gibbs.cross(c);
        let c = c + (across + gibbs.cross(across)) * (2.0 / (1.0 + gibbs.length_squared()));

        // To the anchor's frame, by increments, as the rapidity is small.
        let along = self.n.dot(c);
        let ratio = (1.0 + rise) - sinh * along;
        let d = (c + self.n * (rise * along - sinh)) * (1.0 / ratio);
        (Direction::from_unit(d), ratio)
    }

    /// The boost of the second part: from the anchor's frame to the world.
    #[inline(always)]
    pub(crate) fn world_from_comoving(&self) -> &Boost<World, CameraFrame> {
        &self.world_from_comoving
    }

    /// The displacement from the stretch's reference to the line's event at a proper time near this one.
    #[inline(always)]
    pub(crate) fn event(&self, proper_time: f64) -> Displacement<World> {
        self.moved + self.way(proper_time - self.proper_time)
    }

    /// The displacement from the anchor's event to the one `since` later.
    #[inline(always)]
    fn way(&self, since: f64) -> Displacement<World> {
        let Series { phi, odd, even, .. } = self.series(since);
        self.ahead * (since * odd) + self.aside * (0.5 * since * phi * even)
    }

    /// The series in the head of this file.
    #[inline(always)]
    fn series(&self, since: f64) -> Series {
        let phi = self.g * since;
        let q = phi * phi;
        // Ratios of successive terms: for sinh φ/φ 1/(2·3), 1/(4·5), …, for (cosh φ − 1)/(φ²/2) 1/(3·4), 1/(5·6), …
        Series {
            phi,
            q,
            odd: nested(
                q,
                [1.0 / 6.0, 1.0 / 20.0, 1.0 / 42.0, 1.0 / 72.0, 1.0 / 110.0],
            ),
            even: nested(
                q,
                [1.0 / 12.0, 1.0 / 30.0, 1.0 / 56.0, 1.0 / 90.0, 1.0 / 132.0],
            ),
        }
    }
}

/// 1 + a₀ q (1 + a₁ q (1 + …)).
#[inline(always)]
fn nested(q: f64, factors: [f64; 5]) -> f64 {
    let mut sum = 1.0;
    for factor in factors.into_iter().rev() {
        sum = 1.0 + factor * q * sum;
    }
    sum
}

#[cfg(test)]
mod tests;
