//! The pose of a pinhole camera: from eye, look_at and up, or from a glTF file.
//!
//! forward f = look_at − eye, or the key `forward`, normalised; right r = f × up normalised, up = r × f.

use glam::{DMat3, DQuat, DVec3};

use super::context::Context;
use crate::error::{Error, Result, number};
use crate::scene::at::At;
use crate::scene::file::{Camera, Capture, GivenPose, PoseConvention};
use crate::scene::inputs::Pose;
use crate::scene::limits;
use crate::scene::model::ProjectionKind;
use crate::scene::values::Vector;
use crate::spacetime::units::{Angle, LARGEST};
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

/// The pose of a matrix, or of a quaternion and a translation: with R = [c₀ c₁ c₂] and t from camera to world (for one from world to
/// camera, its inverse (Rᵀ, −Rᵀ t)), the eye is t, and right, up and forward are ±cᵢ according to the convention.
pub(super) fn given(cx: &Context, at: &At<GivenPose>, keys: &Keys) -> Result<Pose> {
    for (other, name) in [
        (keys.eye.as_ref().map(|key| &key.span), "eye"),
        (keys.look_at.as_ref().map(|key| &key.span), "look_at"),
        (keys.up.as_ref().map(|key| &key.span), "up"),
        (keys.gltf.as_ref().map(|key| &key.span), "gltf"),
        (keys.node.as_ref().map(|key| &key.span), "node"),
    ] {
        if let Some(other) = other {
            let what = format!("`pose` and `{name}` exclude each other");
            let help = format!("keep one of `pose` and `{name}`");
            return Err(cx
                .report
                .refuse_two(&at.span, (other, "and here"), what, help));
        }
    }
    if let Some(colmap) = &at.value.colmap {
        return of_colmap(cx, at, colmap);
    }
    if let Some(scale) = &at.value.scale {
        let what = "`scale` is the unit of a COLMAP reconstruction, but there is none";
        let help = "leave it out, and give the translation in metres";
        return Err(cx.refuse(scale, what, help));
    }
    let (rotation, translation) = rotation_and_translation(cx, at)?;
    let Some(convention) = at.value.convention else {
        let help = "add convention = \"opengl\", \"opencv\", \"mitsuba\" or \"colmap\"";
        return Err(cx.refuse(at, "the convention of the pose is missing", help));
    };
    let (rotation, eye) = match convention {
        PoseConvention::Colmap => (rotation.transpose(), -(rotation.transpose() * translation)),
        PoseConvention::OpenGl | PoseConvention::OpenCv | PoseConvention::Mitsuba => {
            (rotation, translation)
        }
    };
    let (y, z) = (rotation.y_axis, rotation.z_axis);
    let (up, forward) = match convention {
        PoseConvention::OpenGl => (y, -z),
        PoseConvention::OpenCv | PoseConvention::Colmap => (-y, z),
        PoseConvention::Mitsuba => (y, z),
    };
    // Right follows from the other two, because the rotation is right-handed.
    let axes = unit(forward).and_then(|forward| frame(forward, up));
    let axes = axes.ok_or_else(|| cx.refuse(at, "the matrix has no directions", NO_ROTATION))?;
    Ok(Pose {
        eye,
        axes,
        gltf_fov: None,
        picture: None,
    })
}

/// The pose of an image of a COLMAP reconstruction.
fn of_colmap(cx: &Context, at: &At<GivenPose>, colmap: &At<String>) -> Result<Pose> {
    let GivenPose {
        matrix,
        quaternion,
        translation,
        convention,
        image,
        ..
    } = &at.value;
    let is_more = matrix.is_some() || quaternion.is_some() || translation.is_some();
    if is_more || convention.is_some() {
        let help = "keep `colmap` and `image`, or the other keys";
        return Err(cx.refuse(at, "the pose is given twice", help));
    }
    let Some(image) = image else {
        let help = "add image = \"…\", the name of one of its images";
        return Err(cx.refuse(colmap, "the name of the image is missing", help));
    };
    cx.optional_text(&Some(image.clone()), "the name of the image")?;
    let scale = at.value.scale.as_ref();
    if let Some(scale) = scale.filter(|scale| !(scale.value.0 > 0.0 && scale.value.0 <= LARGEST)) {
        let what = format!("a unit of {} m", number(scale.value.0));
        return Err(cx.refuse(scale, what, "a length above 0, like 0.25"));
    }
    let pose = cx.pose_of(colmap)?;
    Ok(Pose {
        eye: pose.eye * scale.map_or(1.0, |scale| scale.value.0),
        ..pose
    })
}

const NO_ROTATION: &str = "the upper left 3 × 3 of a pose is a rotation: columns of length 1, at right angles, right-handed; the last row is [0, 0, 0, 1]";

fn rotation_and_translation(cx: &Context, at: &At<GivenPose>) -> Result<(DMat3, DVec3)> {
    /// The allowed deviation from a rotation, for single precision and printed digits.
    const TOLERANCE: f64 = 1e-3;
    let (rotation, translation, last) = match &at.value {
        GivenPose {
            matrix: Some(rows),
            quaternion: None,
            translation: None,
            ..
        } => {
            // The file gives rows.
            let row = |i: usize| DVec3::new(rows[i][0], rows[i][1], rows[i][2]);
            let rotation = DMat3::from_cols(row(0), row(1), row(2)).transpose();
            (
                rotation,
                DVec3::new(rows[0][3], rows[1][3], rows[2][3]),
                rows[3],
            )
        }
        GivenPose {
            matrix: None,
            quaternion: Some([w, x, y, z]),
            translation: Some(translation),
            ..
        } => {
            let rotation = DQuat::from_xyzw(*x, *y, *z, *w);
            let length = rotation.length();
            let is_unit = (length - 1.0).abs() < TOLERANCE;
            if !is_unit {
                let what = format!(
                    "a quaternion of length {} is not a rotation",
                    number(length)
                );
                return Err(cx.refuse(at, what, "give a unit quaternion [w, x, y, z]"));
            }
            let rotation = DMat3::from_quat(rotation.normalize());
            (
                rotation,
                DVec3::from_array(*translation),
                [0.0, 0.0, 0.0, 1.0],
            )
        }
        _ => {
            let what = "a pose is `matrix`, or `quaternion` and `translation`";
            return Err(cx.refuse(at, what, "give one of the two"));
        }
    };
    // R is a rotation where RᵀR is the identity and its determinant above 0.
    let square = rotation.transpose() * rotation;
    let apart = (square - DMat3::IDENTITY).to_cols_array();
    let is_rotation = apart.iter().all(|x| x.abs() < TOLERANCE) && rotation.determinant() > 0.0;
    let is_affine = last == [0.0, 0.0, 0.0, 1.0];
    let within = translation.to_array().iter().all(|x| x.abs() <= LARGEST);
    match is_rotation && is_affine && within {
        true => Ok((rotation, translation)),
        false => Err(cx.refuse(at, "this matrix is not a pose", NO_ROTATION)),
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

/// The pose by `eye` and `look_at` or `forward`, in the camera's own frame.
fn from_points<T>(cx: &Context, at: &At<T>, keys: &Keys) -> Result<Pose> {
    if let Some(node) = keys.node {
        let help = "add gltf = \"file.glb\", or leave `node` out";
        return Err(cx.refuse(
            node,
            "`node` is a node of a glTF file, but no file is given",
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
        picture: None,
    })
}

/// The given forward axis.
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
        let what = match unit(up_vector) {
            None => "`up` is a zero vector",
            Some(_) => "the forward axis is parallel to `up`",
        };
        let help =
            "give an `up` that is not zero and not along the line of sight, like up = [0, 0, 1]";
        let span = up.as_ref().map_or(&at.span, |up| &up.span);
        cx.report.refuse(span, what, help)
    })
}

/// Right, up, forward for the unit vector `forward`; `None` if `up` is parallel to it.
fn frame(forward: DVec3, up: DVec3) -> Option<[DVec3; 3]> {
    let across = forward.cross(unit(up)?);
    if across.length() < PARALLEL {
        return None;
    }
    // For nearly parallel vectors, rounding leaves a component along `forward` in the product; remove it.
    let right = unit(across)?;
    let right = unit(right - forward * right.dot(forward))?;
    Some([right, unit(right.cross(forward))?, forward])
}

fn unit(v: DVec3) -> Option<DVec3> {
    Direction::<World>::new(v).map(Direction::unit)
}

/// A field of view in radians, within the range of `projection`: in (0, π) for a perspective camera.
pub(super) fn fov(cx: &Context, hfov: &At<Angle>, projection: ProjectionKind) -> Result<f64> {
    let radians = hfov.value.radians();
    if projection != ProjectionKind::Perspective {
        return wide_fov(cx, hfov, projection);
    }
    if limits::is_field_of_view(radians, projection) {
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

/// The error for a field of view that is possible, but beyond the resolution of double precision.
fn extreme(cx: &Context, hfov: &At<Angle>) -> Error {
    let what = format!(
        "a field of view of {} is within a billionth of a radian of 0 or 180 degrees: double precision would keep at most four digits of the angle between neighbouring pixels",
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
    if limits::is_field_of_view(radians, projection) {
        return Ok(radians);
    }
    // The lower bound of `limits::is_field_of_view`.
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
