//! Refuses motions without a possible world line, at their place in the file, and exposures outside the world line.

use std::ops::Range;

use super::context::Context;
use super::mover::{Mover, beta, slower};
use crate::error::{Error, Result, number};
use crate::scene::at::At;
use crate::scene::file;
use crate::scene::model::CameraModel;
use crate::spacetime::MAX_RAPIDITY;
use crate::spacetime::worldline::{WorldLine, WorldLineError};

const WEAKER: &str = "make it weaker or shorter";

/// The error for a motion without a possible world line.
pub(super) fn refusal(cx: &Context, mover: &Mover, error: &WorldLineError) -> Error {
    let noun = mover.noun;
    let span = |index| mover.motion.as_ref().and_then(|at| entry(at, index));
    // At the segment, knot or keyframe that is to blame.
    let here = span(error.index()).unwrap_or(mover.span);
    match *error {
        WorldLineError::TooFast { proper_time, .. } => {
            let what = format!(
                "this acceleration exceeds rapidity {MAX_RAPIDITY} near {} m of the {noun}'s time",
                number(proper_time)
            );
            cx.report.refuse(here, what, WEAKER)
        }
        WorldLineError::TooLong { proper_time, .. } => {
            let what = format!(
                "this acceleration is too strong to be followed beyond {} m of the {noun}'s time",
                number(proper_time)
            );
            cx.report.refuse(here, what, WEAKER)
        }
        WorldLineError::Superluminal { ct, speed, .. } if animated(mover).is_some() => {
            let node = animated(mover).map_or("", |animation| &animation.node.value);
            let seconds = ct / cx.speed_of_light;
            let what = format!(
                "the path of node {node:?} moves at |β| = {} at {} s of its animation",
                beta(speed),
                number(seconds)
            );
            cx.report.refuse(here, what, slower())
        }
        WorldLineError::Superluminal { index, ct, speed } => {
            let what = format!(
                "the curve from the previous keyframe to this one moves at |β| = {} at world time {} m",
                beta(speed),
                number(ct)
            );
            let help = "give more time or less distance between them, or gentler turns: nothing moves as fast as light";
            let there = span(Some(index + 1)).unwrap_or(here);
            cx.report
                .refuse_two(there, (here, "the one before"), what, help)
        }
        _ => cx.report.refuse(here, error.to_string(), ""),
    }
}

/// The animation that a motion follows.
fn animated<'a>(mover: &Mover<'a>) -> Option<&'a file::Animation> {
    let motion = mover.motion.as_ref()?;
    motion.value.animation.as_ref().map(|at| &at.value)
}

/// The span of an entry of the motion's list, or else of the motion itself.
fn entry(motion: &At<file::Motion>, index: Option<usize>) -> Option<&Range<usize>> {
    fn of<T>(list: &Option<At<Vec<At<T>>>>, index: Option<usize>) -> Option<&Range<usize>> {
        let entry = list.as_ref()?.value.get(index?)?;
        Some(&entry.span)
    }
    let m = &motion.value;
    of(&m.segments, index)
        .or_else(|| of(&m.profile, index))
        .or_else(|| of(&m.keyframes, index))
        .or(Some(&motion.span))
}

/// Refuses an exposure that is not within the world line, which always contains the default time 0.
pub(super) fn refuse_outside(
    cx: &Context,
    camera: &file::Camera,
    model: &CameraModel,
    line: &WorldLine,
) -> Result<()> {
    let duration = camera.shutter.as_ref().map(|at| &at.value.duration);
    // A shot is an exposure without duration.
    let end = model.time + model.shutter.map_or(0.0, |s| s.duration);
    let times = [
        (model.time, &camera.time, "begins"),
        (end, duration.unwrap_or(&camera.time), "ends"),
    ];
    for (time, at, verb) in times {
        if let Some((what, help)) = outside(line, time) {
            return Err(cx.refuse(at, format!("the exposure {verb} {what}"), help));
        }
    }
    Ok(())
}

/// What is wrong with a proper time at which the line has no state.
fn outside(line: &WorldLine, time: f64) -> Option<(&'static str, String)> {
    let [first, last] = line.span();
    if line.state(time).is_some() {
        return None;
    }
    let lifetime = format!(
        "the world line extends from {} m to {} m of the camera's time",
        number(first),
        number(last)
    );
    Some(match time {
        _ if time < first => ("before the camera's world line does", lifetime),
        _ if time > last => ("after the camera's world line has ended", lifetime),
        _ => {
            let help = format!("rapidities are at most {MAX_RAPIDITY}: give a time nearer to 0");
            ("where the camera is too fast", help)
        }
    })
}
