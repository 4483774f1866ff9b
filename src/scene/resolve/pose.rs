//! The pose of a pinhole camera: from eye, look_at and up, or from a glTF file.
//!
//! forward f = look_at − eye, or the key `forward`, normalised; right r = f × up normalised, up = r × f.

use glam::DVec3;

use super::context::Context;
use crate::error::{Error, Result};
use crate::scene::at::At;
use crate::scene::file::{Camera, Capture};
use crate::scene::inputs::Pose;
use crate::scene::model::ProjectionKind;
use crate::scene::values::Vector;
use crate::spacetime::units::Angle;
use crate::spacetime::{Direction, World};

/// sin of the angle between `up` and the forward axis, below which they count as parallel.
const PARALLEL: f64 = 1e-9;

/// The keys of a pose.
pub(super) struct Keys<'a> {
    pub eye: &'a Option<At<Vector>>,
    pub look_at: &'a Option<At<Vector>>,
    pub forward: &'a Option<At<Vector>>,
    pub up: &'a Option<At<Vector>>,
    pub gltf: &'a Option<At<String>>,
    pub node: &'a Option<At<String>>,
}

impl<'a> From<&'a Camera> for Keys<'a> {
    fn from(camera: &'a Camera) -> Self {
        Keys {
            eye: &camera.eye,
            look_at: &camera.look_at,
            forward: &camera.forward,
            up: &camera.up,
            gltf: &camera.gltf,
            node: &camera.node,
        }
    }
}

impl<'a> From<&'a Capture> for Keys<'a> {
    fn from(capture: &'a Capture) -> Self {
        Keys {
            eye: &capture.eye,
            look_at: &capture.look_at,
            forward: &None,
            up: &capture.up,
            gltf: &capture.gltf,
            node: &capture.node,
        }
    }
}

/// The pose given by `keys` of the table `at`.
pub(super) fn resolve<T>(cx: &Context, at: &At<T>, keys: &Keys) -> Result<Pose> {
    match keys.gltf {
        Some(gltf) => from_gltf(cx, gltf, keys),
        None => from_points(cx, at, keys),
    }
}

fn from_gltf(cx: &Context, gltf: &At<String>, keys: &Keys) -> Result<Pose> {
    for (key, name) in [
        (keys.eye, "eye"),
        (keys.look_at, "look_at"),
        (keys.forward, "forward"),
        (keys.up, "up"),
    ] {
        if let Some(key) = key {
            return Err(cx.refuse_both((gltf, "gltf"), (key, name)));
        }
    }
    cx.optional_text(keys.node, "the node's name")?;
    cx.gltf_pose(gltf)
}

fn from_points<T>(cx: &Context, at: &At<T>, keys: &Keys) -> Result<Pose> {
    if let Some(node) = keys.node {
        let help = "add gltf = \"file.glb\", or leave `node` out";
        return Err(cx.refuse(
            node,
            "`node` is a node of a glTF file, and there is none",
            help,
        ));
    }
    let needed = |key: &'static str| {
        let what = format!("the key `{key}` is missing");
        cx.refuse(
            at,
            what,
            "give eye and look_at (or forward), or gltf = \"file.glb\"",
        )
    };
    let eye = keys.eye.as_ref().ok_or_else(|| needed("eye"))?;
    cx.exclusive((keys.look_at, "look_at"), (keys.forward, "forward"))?;
    let (at, forward) = match (keys.forward, keys.look_at) {
        (Some(axis), _) => (axis, along(cx, axis)?),
        (None, Some(look_at)) => (look_at, towards(cx, eye, look_at)?),
        (None, None) => return Err(needed("look_at")),
    };
    Ok(Pose {
        eye: eye.value.vec(),
        axes: axes(cx, at, forward, keys.up)?,
        gltf_fov: None,
    })
}

/// The forward axis that is given.
fn along(cx: &Context, axis: &At<Vector>) -> Result<DVec3> {
    unit(axis.value.vec()).ok_or_else(|| {
        let what = "`forward` has no direction";
        cx.refuse(
            axis,
            what,
            "give a vector that is not zero, like [0, 0, -1]",
        )
    })
}

/// The forward axis from the eye to a point.
fn towards(cx: &Context, eye: &At<Vector>, look_at: &At<Vector>) -> Result<DVec3> {
    unit(look_at.value.vec() - eye.value.vec()).ok_or_else(|| {
        let (what, help) = (
            "`eye` and `look_at` are the same point",
            "look at another point, or give the axis itself: forward = [0, 0, -1]",
        );
        let other = (&eye.span, "the same point");
        cx.report.refuse_two(&look_at.span, other, what, help)
    })
}

fn axes(
    cx: &Context,
    at: &At<Vector>,
    forward: DVec3,
    up: &Option<At<Vector>>,
) -> Result<[DVec3; 3]> {
    let up_vector = up.as_ref().map_or(Camera::UP, |up| up.value).vec();
    frame(forward, up_vector).ok_or_else(|| {
        let what = "the forward axis has no direction across `up`: they are parallel";
        let help =
            "give an `up` that is not zero and not along the line of sight, like up = [0, 0, 1]";
        let span = up.as_ref().map_or(&at.span, |up| &up.span);
        cx.report.refuse(span, what, help)
    })
}

/// Right, up, forward for the unit vector `forward`, or none where `up` is parallel to it.
fn frame(forward: DVec3, up: DVec3) -> Option<[DVec3; 3]> {
    let across = forward.cross(unit(up)?);
    if across.length() < PARALLEL {
        return None;
    }
    // Nearly parallel vectors leave rounding along `forward` in the product; it is taken out again.
    let right = unit(across)?;
    let right = unit(right - forward * right.dot(forward))?;
    Some([right, unit(right.cross(forward))?, forward])
}

fn unit(v: DVec3) -> Option<DVec3> {
    Direction::<World>::new(v).map(Direction::unit)
}

/// Whether this is in (0, π), and tan(fov/2) has digits left: to within a billionth at either end.
pub(super) fn is_fov(radians: f64) -> bool {
    radians > 1e-9 && radians < std::f64::consts::PI - 1e-9
}

/// A field of view in radians, as wide as `projection` can show: in (0, π) for a perspective camera.
pub(super) fn fov(cx: &Context, hfov: &At<Angle>, projection: ProjectionKind) -> Result<f64> {
    let radians = hfov.value.radians();
    if projection != ProjectionKind::Perspective {
        return wide_fov(cx, hfov, projection);
    }
    if is_fov(radians) {
        return Ok(radians);
    }
    if radians > 0.0 && radians < std::f64::consts::PI {
        return Err(extreme(cx, hfov));
    }
    let what = format!(
        "a field of view of {} is not between 0 and 180 degrees",
        hfov.value
    );
    Err(cx.refuse(
        hfov,
        what,
        "a field of view is above 0 and below 180 deg, like \"60 deg\"",
    ))
}

/// The refusal of a field of view that is possible, and beyond what double precision tells apart.
fn extreme(cx: &Context, hfov: &At<Angle>) -> Error {
    let what = format!(
        "a field of view of {} is within a billionth of a radian of 0 or 180 degrees: of the angle between \
         neighbouring ones of a thousand pixels, double precision keeps four digits at most there",
        hfov.value
    );
    cx.refuse(
        hfov,
        what,
        "give more than 1e-9 rad, and less than pi − 1e-9",
    )
}

/// A field of view in radians, in (0, π] or (0, 2π].
fn wide_fov(cx: &Context, hfov: &At<Angle>, projection: ProjectionKind) -> Result<f64> {
    let (radians, widest) = (hfov.value.radians(), projection.widest());
    if radians > 1e-9 && radians <= widest.to_radians() {
        return Ok(radians);
    }
    if radians > 0.0 && radians <= 1e-9 {
        return Err(extreme(cx, hfov));
    }
    let what = format!(
        "a field of view of {} is not between 0 and {widest} degrees",
        hfov.value
    );
    let help = format!(
        "with projection = \"{}\" a field of view is above 0 and at most {widest} deg",
        projection.name()
    );
    Err(cx.refuse(hfov, what, help))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_are_orthonormal_and_right_handed_in_any_direction() {
        let mut state = 1u64;
        let mut random = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        };
        for i in 0..2000 {
            let forward = unit(DVec3::new(random(), random(), random())).unwrap();
            let near = forward + DVec3::new(random(), random(), random()) * 0.1f64.powi(i % 8);
            let Some([r, u, f]) = frame(forward, near) else {
                continue;
            };
            for (a, b) in [(r, u), (u, f), (f, r)] {
                assert!(a.dot(b).abs() < 1e-15, "{a} {b}");
            }
            for a in [r, u, f] {
                assert!((a.length() - 1.0).abs() < 1e-15);
            }
            assert!(
                (r.cross(u) + f).length() < 1e-15,
                "looks along −z, up y, right x"
            );
        }
    }

    #[test]
    fn looking_along_minus_z_gives_the_axes_of_the_world() {
        let axes = frame(DVec3::NEG_Z, DVec3::Y);
        assert_eq!(axes, Some([DVec3::X, DVec3::Y, DVec3::NEG_Z]));
        assert_eq!(frame(DVec3::Y, DVec3::Y * 3.0), None);
        assert_eq!(frame(DVec3::Y, DVec3::ZERO), None);
    }
}
