//! A series of pictures of a diagram.
//!
//! The view of picture k of n is the frame whose velocity relative to the first view has the rapidity
//!
//! ```text
//! w(k) = s w(n − 1),    s = k/(n − 1),    or s = 1 − |1 − 2k/n| there and back,
//! ```
//!
//! where w is the rapidity of the target frame: rapidities along a line add, so each step is the same boost. The origin moves from that
//! of the first view to that of the target in equal steps.

use super::model::{Boost, Colour, Diagram, Now, Reference, Sweep};
use crate::spacetime::{Event, InertialFrame, Velocity, World};

impl Diagram {
    /// Picture `k` of the animation, counted from 0; the unchanged diagram if there is none.
    pub fn picture(&self, k: u32) -> Diagram {
        let mut picture = self.clone();
        let Some(animation) = self.animation else {
            return picture;
        };
        if let Some(sweep) = animation.sweep {
            picture.now = Some(sweep.at(k, animation.frames, self.unit.metres));
        }
        if let Some(boost) = animation.boost {
            picture.boost(boost, boost.part(k, animation.frames));
        }
        picture
    }

    /// Moves the view a part of the way to a frame. Its own axes are not drawn: those of the frames move.
    fn boost(&mut self, boost: Boost, part: f64) {
        let first = self.views.first().copied().unwrap_or(0);
        let (Some(from), Some(to)) = (self.frames.get(first), self.frames.get(boost.to)) else {
            return;
        };
        let passing = Reference::bare("", between(&from.frame, &to.frame, part));
        if let Some(world) = self.frames.get_mut(first) {
            world.colour = world.colour.or(Some(Colour::Black));
        }
        self.views = vec![self.frames.len()];
        self.frames.push(passing);
    }

    /// Makes a boost keep `event` in place: both frames have their origin there, and all pictures show where the light that arrives there
    /// left. Without a boost, or if limits are given, nothing changes.
    pub fn boost_about(&mut self, event: Event<World>) {
        let animation = self.animation.and_then(|a| Some((a.frames, a.boost?)));
        let (Some((frames, boost)), Some(&first)) = (animation, self.views.first()) else {
            return;
        };
        if self.x.is_some() || self.ct.is_some() {
            return;
        }
        for frame in [first, boost.to] {
            if let Some(Reference { frame, .. }) = self.frames.get_mut(frame) {
                *frame = InertialFrame::new(frame.velocity(), event);
            }
        }
        let arrives = self.signals.iter().filter(|light| light.ends[1] == event);
        let left: Vec<Event<World>> = arrives.map(|light| light.ends[0]).collect();
        let (mut x, mut ct) = ([0f64; 2], [0f64; 2]);
        for k in 0..frames {
            let part = boost.part(k, frames);
            let (Some(from), Some(to)) = (self.frames.get(first), self.frames.get(boost.to)) else {
                return;
            };
            let view = between(&from.frame, &to.frame, part);
            for event in &left {
                let own = view.event_from_world(*event);
                let along = self.direction.dot(own.x);
                x = [x[0].min(along), x[1].max(along)];
                ct = [ct[0].min(own.ct), ct[1].max(own.ct)];
            }
        }
        let room = (x[1] - x[0]).max(ct[1] - ct[0]);
        if room > 0.0 {
            // World lines continue above the event, and to the side from which no light comes.
            self.x = Some([x[0] - 0.2 * room, x[1] + 0.2 * room]);
            self.ct = Some([ct[0] - 0.1 * room, ct[1] + 0.4 * room]);
        }
    }

    /// Whether `frame` is one through which the view passes.
    pub fn is_passing(&self, frame: usize) -> bool {
        self.animation
            .is_some_and(|animation| animation.boost.is_some())
            && self.views.first() == Some(&frame)
            && self.frames.get(frame).is_some_and(|f| f.name.is_empty())
    }
}

/// The frame a part of the way from one to another.
fn between<F: crate::spacetime::Frame>(
    from: &InertialFrame<F>,
    to: &InertialFrame<F>,
    part: f64,
) -> InertialFrame<F> {
    let there = to.velocity().relative_to(from.velocity());
    let step = there.and_then(|velocity| Velocity::from_rapidity(velocity.rapidity() * part));
    let velocity = step.and_then(|velocity| velocity.relative_to(-from.velocity()));
    // Frames that are too fast to be compared are refused when they are resolved.
    let velocity = velocity.unwrap_or(from.velocity());
    let origin = from.origin() + (to.origin() - from.origin()) * part;
    InertialFrame::new(velocity, origin)
}

impl Boost {
    /// The part of the way in picture `k` of `count`.
    fn part(self, k: u32, count: u32) -> f64 {
        let (k, n) = (f64::from(k), f64::from(count));
        match self.back {
            true => 1.0 - (1.0 - 2.0 * k / n).abs(),
            false => k / (n - 1.0).max(1.0),
        }
    }
}

impl Sweep {
    fn at(self, k: u32, count: u32, unit: f64) -> Now {
        let part = f64::from(k) / f64::from(count.saturating_sub(1).max(1));
        let [from, to] = self.times;
        // Three digits of the whole way.
        let whole = ((to - from).abs() / unit).max(f64::MIN_POSITIVE);
        let decimals = (2.0 - libm::floor(libm::log10(whole))).clamp(0.0, 6.0);
        Now {
            frame: self.frame,
            ct: from + part * (to - from),
            decimals: decimals as usize,
            colour: self.colour,
        }
    }
}
