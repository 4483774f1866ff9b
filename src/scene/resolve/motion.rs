//! The motion of a camera's pinhole or a light: the state when its clock shows 0, and its evolution.

use glam::DVec3;

use super::context::Context;
use super::mover::{HELP, Mover};
use super::{path, velocity, worldline};
use crate::error::{Result, number};
use crate::scene::at::At;
use crate::scene::file;
use crate::scene::model::Motion;
use crate::spacetime::worldline::{Axes, Segment, WorldLine};
use crate::spacetime::{Event, Velocity, World};

/// A world line as the file gives it.
pub(super) struct Moving {
    /// Its position when its clock shows 0.
    pub origin: Event<World>,
    /// Its velocity then.
    pub velocity: Velocity,
    /// Its motion from there.
    pub motion: Motion,
    /// The resulting world line.
    pub line: WorldLine,
}

/// The motion of `mover`, given in one way; it is at `position` when its clock shows 0.
pub(super) fn resolve(cx: &Context, mover: &Mover, position: DVec3) -> Result<Moving> {
    let motion = motion(cx, mover, position)?;
    let velocity = velocity::resolve(cx, mover.velocity)?;
    // Keyframes are events of the world themselves; other motions begin where and when the clock shows 0.
    let origin = match &motion {
        Motion::Keyframes(events) | Motion::Animation { events, .. } => {
            events.first().copied().unwrap_or(Event::ORIGIN)
        }
        Motion::Inertial
        | Motion::Accelerated(_)
        | Motion::Segments(_)
        | Motion::Profile { .. }
        | Motion::Circular { .. } => Event::new(cx.time(mover.clock_zero)?, position),
    };
    let line = motion.world_line(velocity, origin);
    let line = line.map_err(|error| worldline::refusal(cx, mover, &error))?;
    if let Some(axes) = mover.motion.as_ref().and_then(|m| m.value.axes.as_ref()) {
        check_axes(cx, axes, &motion, &line)?;
    }
    Ok(Moving {
        origin,
        velocity: line.state(0.0).map_or(velocity, |state| state.velocity),
        motion,
        line,
    })
}

/// Refuses axes that have no effect on this motion, or in which it has no closed form.
fn check_axes(cx: &Context, axes: &At<Axes>, motion: &Motion, line: &WorldLine) -> Result<()> {
    // Each constant acceleration, with the time at which it begins.
    let starts: Vec<(f64, DVec3)> = match motion {
        Motion::Inertial | Motion::Profile { .. } => return Ok(()),
        Motion::Accelerated(a) => vec![(0.0, *a)],
        Motion::Segments(segments) => {
            let mut time = 0.0;
            let start = |segment: &Segment| {
                let begin = time;
                time += segment.duration;
                (begin, segment.acceleration)
            };
            segments.iter().map(start).collect()
        }
        Motion::Keyframes(_) | Motion::Animation { .. } | Motion::Circular { .. } => {
            let what = "`axes` applies to accelerations, but this motion has none";
            return Err(cx.refuse(axes, what, "leave out `axes`"));
        }
    };
    // Along the velocity both axes are the same; the bound is the rounding of directions in a file.
    let is_oblique = |(time, a): &(f64, DVec3)| {
        let u = line.state(*time).map_or(DVec3::ZERO, |s| s.velocity.beta());
        a.cross(u).length() > 1e-12 * a.length() * u.length()
    };
    if axes.value == Axes::World && starts.iter().any(is_oblique) {
        let what = "an acceleration oblique to the velocity and constant in the world's boosted axes does not \
                    give hyperbolic motion: `acceleration` and `segments` are constant in those of a gyroscope";
        let help = "give it as a `profile`, or take axes = \"gyroscope\"";
        return Err(cx.refuse(axes, what, help));
    }
    Ok(())
}

fn motion(cx: &Context, mover: &Mover, position: DVec3) -> Result<Motion> {
    let Some(at) = mover.motion else {
        return Ok(Motion::Inertial);
    };
    let motion = &at.value;
    if let Some(a) = &motion.acceleration {
        Ok(accelerated(acceleration(cx, a)?))
    } else if let Some(segments) = &motion.segments {
        self::segments(cx, segments)
    } else if let Some(profile) = &motion.profile {
        self::profile(cx, mover, profile)
    } else if let Some(keyframes) = &motion.keyframes {
        path::keyframes(cx, keyframes)
    } else if let Some(animation) = &motion.animation {
        path::animation(cx, animation)
    } else if let Some(circle) = &motion.circle {
        path::circle(cx, mover, circle, position)
    } else {
        Err(cx.refuse(at, "no motion is given", HELP))
    }
}

/// A constant proper acceleration, which may be 0.
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

fn profile(cx: &Context, mover: &Mover, at: &At<Vec<At<file::ProfileKnot>>>) -> Result<Motion> {
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
        let (noun, position) = (mover.noun, mover.position.1);
        let what = format!(
            "this profile, from {} m to {} m, does not contain {noun} time 0",
            number(first),
            number(last)
        );
        let help = format!(
            "`{position}` and `velocity` are those at {noun} time 0: let the profile begin there, or before"
        );
        return Err(cx.refuse(at, what, help));
    }
    let axes = mover.motion.as_ref().and_then(|m| m.value.axes.as_ref());
    Ok(Motion::Profile {
        knots,
        axes: axes.map_or(Axes::default(), |axes| axes.value),
    })
}
