//! The camera times at which light comes into view and leaves it, found by surveys of shots.
//!
//! An earlier or later shot sees light that was emitted earlier or later: the latest time h(t) at which light in view was emitted, and
//! the earliest, l(t), rise with the camera's time t. Data from c to d are in view from h(t) = c to l(t) = d. Both rise at a constant
//! rate if lamp, camera and surfaces rest, but not in general: 1 m of a lamp's time may take 1/(1 − β) m of the camera's while it
//! approaches, and a γth of that after it has passed. So both ends are found by secants, within a bracket as soon as there is one.

use super::{SeenTimes, seen_or_sampled};
use crate::render::prepare::Prepared;
use crate::scene::model::Scene;

/// The tolerance of an end, relative to the length of the data.
const TOLERANCE: f64 = 1e-3;

/// The largest number of shots for one end. Secants take 2 to 8.
const MOST_STEPS: usize = 16;

/// The largest number of shots for all sources together.
const MOST_SHOTS: usize = 64;

/// The largest growth of a step relative to the distance so far, while only one side of the end is known.
const GROWTH: f64 = 16.0;

/// The smallest fraction of a bracket that each step leaves on either side, so that it shrinks from both.
const MARGIN: f64 = 0.05;

/// Shots of a scene at other camera times, and what is seen in them.
pub struct Shots<'a> {
    scene: &'a Scene,
    prepared: &'a mut Prepared,
    /// One tile in this many is surveyed.
    every: u64,
    /// The camera's times of the shots, and the times of the sources seen in each.
    known: Vec<(f64, Vec<SeenTimes>)>,
}

impl<'a> Shots<'a> {
    /// For all tiles of the pictures.
    pub fn new(scene: &'a Scene, prepared: &'a mut Prepared) -> Self {
        Shots::among(scene, prepared, 1)
    }

    /// For one tile in `every`.
    pub(super) fn among(scene: &'a Scene, prepared: &'a mut Prepared, every: u64) -> Self {
        let seen = seen_or_sampled(prepared, every);
        Shots {
            known: vec![(scene.camera.time, seen)],
            scene,
            prepared,
            every,
        }
    }

    /// What is seen at the scene's camera time.
    pub fn seen(&self) -> Vec<SeenTimes> {
        self.known[0].1.clone()
    }

    /// The times of a source seen in a shot at a camera time; `None` if nothing that it lights is in view, the camera's world line has no
    /// such time, or the maximum number of shots has been taken.
    fn at(&mut self, time: f64, source: usize) -> Option<[f64; 2]> {
        let place = match self.known.iter().position(|(known, _)| *known == time) {
            Some(place) => place,
            None if self.known.len() == MOST_SHOTS => return None,
            None => {
                let mut other = self.scene.clone();
                other.camera = self.scene.camera.at(time);
                self.prepared.set_camera(&other).ok()?;
                let seen = seen_or_sampled(self.prepared, self.every);
                self.prepared.set_camera(self.scene).ok()?;
                self.known.push((time, seen));
                self.known.len() - 1
            }
        };
        let mut seen = self.known[place].1.iter();
        seen.find(|times| times.source == source)
            .map(|times| times.seen)
    }

    /// The range of camera times, in metres, at which some of the data of `wanted` are in view; `None` if no shot shows any, or one of the
    /// ends is not found.
    pub fn showing(&mut self, wanted: &SeenTimes) -> Option<[f64; 2]> {
        let [from, to] = wanted.data;
        if !(from.is_finite() && to.is_finite()) {
            return None;
        }
        let first = self.end(wanted, 1, from)?;
        let last = self.end(wanted, 0, to)?;
        (first < last).then_some([first, last])
    }

    /// The camera time at which an end of the visible range is `target`.
    fn end(&mut self, wanted: &SeenTimes, end: usize, target: f64) -> Option<f64> {
        let tolerance = TOLERANCE * (wanted.data[1] - wanted.data[0]);
        // Shots before and after the target, the nearest last, and one that shows nothing of the source.
        let mut sides: [Vec<[f64; 2]>; 2] = [Vec::new(), Vec::new()];
        let (mut hidden, mut last) = (None, None);
        let mut time = self.known[0].0;
        for _ in 0..MOST_STEPS {
            match self.at(time, wanted.source) {
                Some(seen) => {
                    let off = seen[end] - target;
                    // Indistinguishable from the target.
                    if off.abs() <= tolerance || (off.abs() <= 1e-12 * target.abs()) {
                        return Some(time);
                    }
                    let side = usize::from(off > 0.0);
                    // Twice on the same side: the other side is weighted by half (the Illinois rule), because its end of the bracket does
                    // not move.
                    if last == Some(side)
                        && let Some([_, off]) = sides[1 - side].last_mut()
                    {
                        *off *= 0.5;
                    }
                    last = Some(side);
                    sides[side].push([time, off]);
                }
                None => hidden = Some(time),
            }
            match next(&sides, hidden) {
                Some(other) => time = other,
                None => break,
            }
        }
        // If things come into view or leave it, there may be no such time, but a time at which light is in view right next to one at which
        // none is.
        let is_between = sides.iter().all(|side| !side.is_empty());
        let within = &sides[end];
        within.last().filter(|_| is_between).map(|[time, _]| *time)
    }
}

/// The next camera time to try; `None` if no time is left between shots, or the visible times do not rise.
fn next(sides: &[Vec<[f64; 2]>; 2], hidden: Option<f64>) -> Option<f64> {
    let time = match [sides[0].last(), sides[1].last()] {
        [Some(&[before, under]), Some(&[after, over])] => {
            let part = (under / (under - over)).clamp(MARGIN, 1.0 - MARGIN);
            let time = before + part * (after - before);
            (before < time && time < after).then_some(time)?
        }
        [Some(side), None] | [None, Some(side)] => {
            let &[near, off] = side;
            let other = sides.iter().find(|known| !known.is_empty())?;
            let before = other.len().checked_sub(2).map(|k| other[k]);
            // At rest, what is seen follows the camera's time.
            let rate = before.map_or(1.0, |[far, was]| (off - was) / (near - far));
            let step = -off / rate;
            // If they do not rise, no other shot shows the data.
            let rises = rate > 1e-9 && step.is_finite();
            let most = before.map_or(f64::INFINITY, |[far, _]| GROWTH * (near - far).abs());
            rises.then(|| near + step.clamp(-most, most))?
        }
        [None, None] => return None,
    };
    // Stop short of times at which nothing of it is in view.
    let nearest = sides.iter().filter_map(|side| side.last()).map(|[t, _]| *t);
    Some(match hidden {
        Some(end) => nearest.fold(time, |time, near| {
            let beyond = (end - near) * (time - end) >= 0.0;
            if beyond { 0.5 * (near + end) } else { time }
        }),
        None => time,
    })
}
