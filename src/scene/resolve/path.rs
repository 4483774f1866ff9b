//! Motions given in world coordinates: keyframes and circles.
//!
//! A point at the distance r from an axis that circles it at the rate ω has the speed β = |ω| r (c = 1).

use glam::DVec3;

use super::context::{ABOVE, BELOW, Context};
use super::mover::{Mover, beta, slower};
use crate::error::{Error, Result, number};
use crate::scene::at::At;
use crate::scene::file::{Animation, Circle, Keyframe};
use crate::scene::model::Motion;
use crate::scene::values::{Numbers, Vector};
use crate::spacetime::{Event, World};

/// The smallest distance from the axis, relative to the distances whose difference it is.
const ON_AXIS: f64 = 1e-12;

/// The first event of `mover`, if its motion is given by events: then no other key may give its position or velocity.
pub(super) fn start(cx: &Context, mover: &Mover) -> Result<Option<At<Vector>>> {
    let Some(motion) = mover.motion.as_ref().map(|at| &at.value) else {
        return Ok(None);
    };
    if let Some(at) = &motion.keyframes {
        alone(cx, mover, (at, "keyframes"))?;
        cx.bounded(at, 2, "keyframes")?;
        let first = at.value.first();
        return Ok(first.map(|first| first.value.position.clone()));
    }
    let Some(at) = &motion.animation else {
        return Ok(None);
    };
    alone(cx, mover, (at, "animation"))?;
    let track = cx.gltf_track(&at.value.gltf)?;
    let first = track.points.first().map(|(_, position)| At {
        value: Numbers(position.to_array()),
        span: at.span.clone(),
    });
    Ok(first)
}

/// Refuses other keys for the position of `mover`.
fn alone<T>(cx: &Context, mover: &Mover, key: (&At<T>, &str)) -> Result<()> {
    if let (Some(position), name) = mover.position {
        return Err(cx.refuse_both(key, (position, name)));
    }
    if let Some(velocity) = mover.velocity {
        return Err(cx.refuse_both(key, (velocity, "velocity")));
    }
    if mover.clock_zero.is_given() {
        return Err(cx.refuse_both(key, (mover.clock_zero, "clock_zero")));
    }
    Ok(())
}

/// A motion by the animation of a node, ct = ct(seconds); at rest before its first and after its last time.
pub(super) fn animation(cx: &Context, at: &At<Animation>) -> Result<Motion> {
    let Animation { gltf, node, .. } = &at.value;
    let track = cx.gltf_track(gltf)?;
    let metres = |seconds: f64| seconds * cx.speed_of_light;
    for pair in track.points.windows(2) {
        // A curve between two events is longer than the chord: if that is too fast, every motion is.
        let ((from, a), (to, b)) = (pair[0], pair[1]);
        let beta = (b - a).length() / (metres(to) - metres(from));
        if beta < 1.0 {
            continue;
        }
        let what = format!(
            "node {:?} moves at |β| = {} between {} s and {} s of its animation",
            node.value,
            self::beta(beta),
            number(from),
            number(to)
        );
        return Err(cx.refuse(node, what, slower()));
    }
    if track.points.len() < 2 {
        let what = "the animation has a single key, and goes nowhere";
        return Err(cx.refuse(node, what, "give two keys or more"));
    }
    let event = |(seconds, x): &(f64, DVec3)| Event::new(metres(*seconds), *x);
    let events = track.points.iter().map(event).collect();
    Ok(Motion::Animation {
        events,
        velocities: (track.velocities.iter())
            .map(|both| both.map(|v| v / cx.speed_of_light))
            .collect(),
    })
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

/// Refuses keyframes that cannot be connected below the speed of light, even by a straight line.
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
        let beta = self::beta(distance / time);
        let what = format!(
            "this keyframe is {} m from the previous one, and {} m of time after it: |β| = {beta}",
            number(distance),
            number(time)
        );
        let other = (&first.value.position.span, "the one before");
        let span = &second.value.position.span;
        let help =
            "give more time or less distance between keyframes: nothing moves as fast as light";
        return Err(cx.report.refuse_two(span, other, what, help));
    }
    Ok(())
}

/// A circle through `position`.
pub(super) fn circle(
    cx: &Context,
    mover: &Mover,
    at: &At<Circle>,
    position: DVec3,
) -> Result<Motion> {
    if let Some(velocity) = mover.velocity {
        return Err(cx.refuse_both((at, "circle"), (velocity, "velocity")));
    }
    let circle = &at.value;
    let axis = cx.unit(
        &circle.axis,
        "the axis of the circle",
        "give an axis like [0, 1, 0]",
    )?;
    let centre = circle.centre.value.vec();
    let radius = radius(cx, mover, at, position, axis)?.length();
    let rate = rate(cx, at)?;
    match rate.abs() * radius {
        beta if beta >= 1.0 => Err(too_fast(cx, at, radius, beta)),
        _ => Ok(Motion::Circular { centre, axis, rate }),
    }
}

/// From the axis to the position, perpendicular to the axis.
fn radius(
    cx: &Context,
    mover: &Mover,
    at: &At<Circle>,
    position: DVec3,
    axis: DVec3,
) -> Result<DVec3> {
    let centre = &at.value.centre;
    let from_centre = position - centre.value.vec();
    let across = from_centre - axis * from_centre.dot(axis);
    let largest = position.length().max(centre.value.vec().length());
    if across.length() > ON_AXIS * largest {
        return Ok(across);
    }
    let (noun, key) = (mover.noun, mover.position.1);
    let what = format!("the axis of the circle passes through `{key}`: the {noun} would not move");
    let help = format!("move the centre or `{key}`, so that `{key}` is on the circle");
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

/// The error for a circle on which β = |ω| r is not below 1.
fn too_fast(cx: &Context, at: &At<Circle>, radius: f64, beta: f64) -> Error {
    let what = format!(
        "on this circle, {} m around the axis, |β| = {} is not below 1",
        number(radius),
        number(beta)
    );
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
