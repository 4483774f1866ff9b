//! Motions given in world coordinates: keyframes and circles.
//!
//! A point at the distance r from an axis about which it goes at the rate ω has the speed β = |ω| r (c = 1).

use glam::DVec3;

use super::context::{ABOVE, BELOW, Context};
use crate::error::{Error, Result};
use crate::scene::at::At;
use crate::scene::file::{Camera, Circle, Keyframe};
use crate::scene::model::Motion;
use crate::scene::values::Vector;
use crate::spacetime::{Event, World};

/// The smallest distance from the axis, in parts of the distances that it is the difference of.
const ON_AXIS: f64 = 1e-12;

const SLOWER: &str = "give more time or less way between keyframes: a camera is slower than light";

/// The position of the first keyframe, in place of `eye`: beside keyframes nothing else gives where the
/// camera is or how fast.
pub(super) fn start(
    cx: &Context,
    camera: &Camera,
    at: &At<Vec<At<Keyframe>>>,
) -> Result<Option<At<Vector>>> {
    let key = (at, "keyframes");
    if let Some(eye) = &camera.eye {
        return Err(cx.refuse_both(key, (eye, "eye")));
    }
    if let Some(velocity) = &camera.velocity {
        return Err(cx.refuse_both(key, (velocity, "velocity")));
    }
    if camera.clock_zero.is_given() {
        return Err(cx.refuse_both(key, (&camera.clock_zero, "clock_zero")));
    }
    cx.bounded(at, 2, "keyframes")?;
    let first = at.value.first();
    Ok(first.map(|first| first.value.position.clone()))
}

/// A motion by keyframes.
pub(super) fn keyframes(cx: &Context, at: &At<Vec<At<Keyframe>>>) -> Result<Motion> {
    let event = |key: &At<Keyframe>| {
        let Keyframe { time, position } = &key.value;
        Ok(Event::new(cx.time(time)?, position.value.vec()))
    };
    let events: Vec<Event<World>> = at.value.iter().map(event).collect::<Result<_>>()?;
    let times: Vec<f64> = events.iter().map(|event| event.ct).collect();
    cx.ascending(&times, |i| Some(&at.value.get(i)?.value.time))?;
    slower_than_light(cx, at, &events)?;
    Ok(Motion::Keyframes(events))
}

/// Refuses keyframes that nothing slower than light connects, not even on a straight line.
fn slower_than_light(
    cx: &Context,
    at: &At<Vec<At<Keyframe>>>,
    events: &[Event<World>],
) -> Result<()> {
    let pairs = events.iter().zip(events.iter().skip(1));
    let keys = at.value.iter().zip(at.value.iter().skip(1));
    for ((a, b), (first, second)) in pairs.zip(keys) {
        let (distance, time) = ((b.x - a.x).length(), b.ct - a.ct);
        if distance < time {
            continue;
        }
        let beta = distance / time;
        let what = format!(
            "this keyframe is {distance} m from the one before, and {time} m of time after it: |β| = {beta}"
        );
        let other = (&first.value.position.span, "the one before");
        let span = &second.value.position.span;
        return Err(cx.report.refuse_two(span, other, what, SLOWER));
    }
    Ok(())
}

/// A circle through `eye`.
pub(super) fn circle(cx: &Context, camera: &Camera, at: &At<Circle>, eye: DVec3) -> Result<Motion> {
    if let Some(velocity) = &camera.velocity {
        return Err(cx.refuse_both((at, "circle"), (velocity, "velocity")));
    }
    let circle = &at.value;
    let axis = cx.unit(
        &circle.axis,
        "the axis of the circle",
        "give an axis like [0, 1, 0]",
    )?;
    let centre = circle.centre.value.vec();
    let radius = radius(cx, at, eye, axis)?.length();
    let rate = rate(cx, at)?;
    match rate.abs() * radius {
        beta if beta >= 1.0 => Err(too_fast(cx, at, radius, beta)),
        _ => Ok(Motion::Circular { centre, axis, rate }),
    }
}

/// From the axis to the eye, across the axis.
fn radius(cx: &Context, at: &At<Circle>, eye: DVec3, axis: DVec3) -> Result<DVec3> {
    let centre = &at.value.centre;
    let from_centre = eye - centre.value.vec();
    let across = from_centre - axis * from_centre.dot(axis);
    let largest = eye.length().max(centre.value.vec().length());
    if across.length() > ON_AXIS * largest {
        return Ok(across);
    }
    let what = "the axis of the circle goes through `eye`: the camera would stay where it is";
    let help = "move the centre or `eye`, so that `eye` is on the circle";
    Err(cx.refuse(centre, what, help))
}

/// Radians per metre of world time, from whichever of `period` and `rate` is given.
fn rate(cx: &Context, at: &At<Circle>) -> Result<f64> {
    let Circle { period, rate, .. } = &at.value;
    cx.exclusive((period, "period"), (rate, "rate"))?;
    if let Some(period) = period {
        return Ok(std::f64::consts::TAU / cx.duration(period, "`period`")?);
    }
    let Some(rate) = rate else {
        let help = "add period = \"60 m\" or rate = \"0.1 rad/m\"";
        return Err(cx.refuse(at, "this circle has no speed", help));
    };
    cx.angular_rate(rate)
}

/// The refusal of a circle on which β = |ω| r is not below 1.
fn too_fast(cx: &Context, at: &At<Circle>, radius: f64, beta: f64) -> Error {
    let what = format!("on this circle, {radius} m around the axis, |β| = {beta} is not below 1");
    let Circle { period, rate, .. } = &at.value;
    match (period, rate) {
        (Some(period), _) => {
            let shortest = period.value.scaled(beta * ABOVE);
            cx.refuse(period, what, format!("the shortest period is {shortest}"))
        }
        (None, Some(rate)) => {
            let largest = rate.value.scaled(BELOW / beta);
            cx.refuse(rate, what, format!("the largest rate is {largest}"))
        }
        (None, None) => cx.refuse(at, what, "give a slower one"),
    }
}
