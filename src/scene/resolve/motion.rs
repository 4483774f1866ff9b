//! How the pinhole moves: the state when the camera's clock shows 0, and what becomes of it.

use glam::DVec3;

use super::context::Context;
use super::{path, velocity, worldline};
use crate::error::Result;
use crate::scene::at::At;
use crate::scene::file;
use crate::scene::model::Motion;
use crate::spacetime::worldline::{Segment, WorldLine};
use crate::spacetime::{Event, Velocity, World};

const HELP: &str =
    "give it in exactly one way: `acceleration`, `segments`, `profile`, `keyframes` or `circle`";

/// A world line as the file gives it.
pub(super) struct Moving {
    /// The pinhole when the camera's clock shows 0.
    pub origin: Event<World>,
    /// Its velocity then.
    pub velocity: Velocity,
    /// How it moves on.
    pub motion: Motion,
    /// The world line that these give.
    pub line: WorldLine,
}

/// The motion of `camera`, given in one way; its pose has the pinhole at `eye`.
pub(super) fn resolve(cx: &Context, camera: &file::Camera, eye: DVec3) -> Result<Moving> {
    let motion = motion(cx, camera, eye)?;
    let velocity = velocity::resolve(cx, &camera.velocity)?;
    let origin = match &motion {
        Motion::Keyframes(events) => events.first().copied().unwrap_or(Event::ORIGIN),
        _ => Event::new(cx.time(&camera.clock_zero)?, eye),
    };
    let line = motion.world_line(velocity, origin);
    let line = line.map_err(|error| worldline::refusal(cx, camera, &error))?;
    Ok(Moving {
        origin,
        velocity: line.state(0.0).map_or(velocity, |state| state.velocity),
        motion,
        line,
    })
}

fn motion(cx: &Context, camera: &file::Camera, eye: DVec3) -> Result<Motion> {
    let Some(at) = &camera.motion else {
        return Ok(Motion::Inertial);
    };
    let motion = &at.value;
    if let Some(a) = &motion.acceleration {
        Ok(accelerated(acceleration(cx, a)?))
    } else if let Some(segments) = &motion.segments {
        self::segments(cx, segments)
    } else if let Some(profile) = &motion.profile {
        self::profile(cx, profile)
    } else if let Some(keyframes) = &motion.keyframes {
        path::keyframes(cx, keyframes)
    } else if let Some(circle) = &motion.circle {
        path::circle(cx, camera, circle, eye)
    } else {
        Err(cx.refuse(at, "no motion is given", HELP))
    }
}

/// The keyframes of a camera that moves by them.
pub(super) fn keyframes(camera: &file::Camera) -> Option<&At<Vec<At<file::Keyframe>>>> {
    camera.motion.as_ref()?.value.keyframes.as_ref()
}

/// Refuses more than one way to give a motion.
pub(super) fn only_one_way(cx: &Context, camera: &file::Camera) -> Result<()> {
    let Some(motion) = camera.motion.as_ref().map(|at| &at.value) else {
        return Ok(());
    };
    let ways = [
        ("acceleration", At::span_of(&motion.acceleration)),
        ("segments", At::span_of(&motion.segments)),
        ("profile", At::span_of(&motion.profile)),
        ("keyframes", At::span_of(&motion.keyframes)),
        ("circle", At::span_of(&motion.circle)),
    ];
    cx.only_one("the motion", ways, HELP)
}

/// A constant proper acceleration, which may be none.
fn accelerated(acceleration: DVec3) -> Motion {
    match acceleration == DVec3::ZERO {
        true => Motion::Inertial,
        false => Motion::Accelerated(acceleration),
    }
}

/// A proper acceleration, 1/m.
fn acceleration(cx: &Context, at: &At<file::ProperAcceleration>) -> Result<DVec3> {
    let file::ProperAcceleration { proper, direction } = &at.value;
    let magnitude = cx.acceleration(proper)?;
    if magnitude == 0.0 {
        return Ok(DVec3::ZERO);
    }
    let Some(direction) = direction else {
        let help = "add direction = [0, 0, -1], or the like";
        return Err(cx.refuse(at, "this acceleration has no direction", help));
    };
    let name = "the direction of an acceleration that is not 0";
    let unit = cx.unit(direction, name, "any direction of length above 0 will do")?;
    Ok(unit * magnitude)
}

fn optional(cx: &Context, at: &Option<At<file::ProperAcceleration>>) -> Result<DVec3> {
    at.as_ref().map_or(Ok(DVec3::ZERO), |a| acceleration(cx, a))
}

fn segments(cx: &Context, at: &At<Vec<At<file::MotionSegment>>>) -> Result<Motion> {
    cx.bounded(at, 1, "segments")?;
    let last = at.value.len() - 1;
    let entries = at.value.iter().enumerate();
    let segments = entries.map(|(i, entry)| segment(cx, entry, i == last));
    let segments: Vec<Segment> = segments.collect::<Result<_>>()?;
    match segments.iter().all(|s| s.acceleration == DVec3::ZERO) {
        true => Ok(Motion::Inertial),
        false => Ok(Motion::Segments(segments)),
    }
}

fn segment(cx: &Context, at: &At<file::MotionSegment>, last: bool) -> Result<Segment> {
    let duration = match &at.value.duration {
        Some(duration) => cx.duration(duration, "`duration`")?,
        None if last => f64::INFINITY,
        None => {
            let what = "this segment has no `duration`, and is not the last";
            let help = "add a duration, like \"2 m\": only the last segment may go on for ever";
            return Err(cx.refuse(at, what, help));
        }
    };
    Ok(Segment {
        duration,
        acceleration: optional(cx, &at.value.acceleration)?,
    })
}

fn profile(cx: &Context, at: &At<Vec<At<file::ProfileKnot>>>) -> Result<Motion> {
    cx.bounded(at, 2, "times of a profile")?;
    let knot = |knot: &At<file::ProfileKnot>| {
        let time = cx.time(&knot.value.time)?;
        Ok((time, optional(cx, &knot.value.acceleration)?))
    };
    let knots: Vec<(f64, DVec3)> = at.value.iter().map(knot).collect::<Result<_>>()?;
    let times: Vec<f64> = knots.iter().map(|(time, _)| *time).collect();
    cx.ascending(&times, |i| Some(&at.value.get(i)?.value.time))?;
    if let (Some(&first), Some(&last)) = (times.first(), times.last())
        && (first > 0.0 || last < 0.0)
    {
        let what = format!("this profile, from {first} m to {last} m, leaves out camera time 0");
        let help = "`eye` and `velocity` are those at camera time 0: let the profile begin there, or before";
        return Err(cx.refuse(at, what, help));
    }
    Ok(Motion::Profile(knots))
}
