//! A moving body as the file gives it: the keys that cameras and lights share.

use std::ops::Range;

use super::context::Context;
use crate::error::{Result, number};
use crate::scene::at::At;
use crate::scene::file;
use crate::scene::values::Vector;
use crate::spacetime::units::Time;

/// The advice if no motion is given, or several.
pub(super) const HELP: &str = "give it in exactly one way: `acceleration`, `segments`, `profile`, `keyframes`, `animation` or `circle`";

/// The keys of a moving body.
pub(super) struct Mover<'a> {
    /// What it is, for messages.
    pub noun: &'static str,
    /// Its position when its clock shows 0, with its key.
    pub position: (&'a Option<At<Vector>>, &'static str),
    pub velocity: &'a Option<At<file::Velocity>>,
    pub clock_zero: &'a At<Time>,
    pub motion: &'a Option<At<file::Motion>>,
    /// The place for messages other than about the motion.
    pub span: &'a Range<usize>,
}

impl<'a> From<&'a file::Camera> for Mover<'a> {
    fn from(camera: &'a file::Camera) -> Self {
        Mover {
            noun: "camera",
            position: (&camera.eye, "eye"),
            velocity: &camera.velocity,
            clock_zero: &camera.clock_zero,
            motion: &camera.motion,
            span: &camera.time.span,
        }
    }
}

/// Refuses more than one way to give a motion.
pub(super) fn only_one_way(cx: &Context, mover: &Mover) -> Result<()> {
    let Some(motion) = mover.motion.as_ref().map(|at| &at.value) else {
        return Ok(());
    };
    let ways = [
        ("acceleration", At::span_of(&motion.acceleration)),
        ("segments", At::span_of(&motion.segments)),
        ("profile", At::span_of(&motion.profile)),
        ("keyframes", At::span_of(&motion.keyframes)),
        ("animation", At::span_of(&motion.animation)),
        ("circle", At::span_of(&motion.circle)),
    ];
    cx.only_one("the motion", ways, HELP)
}

/// The advice for an animation that is too fast.
pub(super) fn slower() -> &'static str {
    "nothing moves as fast as light: slow the animation down, or raise `speed_of_light`, which says how far light goes in \
     a second of it"
}

/// A speed over that of light with six digits, or as many as distinguish it from 1.
pub(super) fn beta(speed: f64) -> String {
    let rounded: f64 = format!("{speed:.5e}").parse().unwrap_or(speed);
    match rounded > 1.0 {
        true => number(rounded).to_string(),
        false => number(speed).to_string(),
    }
}
