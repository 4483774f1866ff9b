//! The camera.

use super::context::Context;
use super::{pose, velocity};
use crate::error::Result;
use crate::scene::at::At;
use crate::scene::file::Camera;
use crate::scene::model::CameraModel;
use crate::spacetime::Event;

/// The largest width or height.
const LARGEST_SIDE: u32 = 65536;
/// The largest number of pixels.
const LARGEST_AREA: u64 = 1 << 28;

pub(super) fn resolve(cx: &Context, at: &At<Camera>) -> Result<CameraModel> {
    let camera = &at.value;
    let size = image_size(cx, &camera.size)?;
    let pose = pose::resolve(cx, at, &camera.into())?;
    Ok(CameraModel {
        origin: Event::new(cx.time(&camera.clock_zero)?, pose.eye),
        axes: pose.axes,
        horizontal_fov: horizontal_fov(cx, camera, &pose, size)?,
        size,
        velocity: velocity::resolve(cx, &camera.velocity)?,
        time: cx.time(&camera.time)?,
    })
}

/// The file's, or that of the glTF camera, or the default.
fn horizontal_fov(
    cx: &Context,
    camera: &Camera,
    pose: &pose::Pose,
    [width, height]: [u32; 2],
) -> Result<f64> {
    if let Some(hfov) = &camera.hfov {
        return pose::fov(cx, hfov);
    }
    let aspect = f64::from(width) / f64::from(height);
    Ok(match pose.gltf_fov {
        Some((Some(horizontal), _)) => horizontal,
        Some((None, vertical)) => 2.0 * libm::atan(aspect * libm::tan(0.5 * vertical)),
        None => Camera::HFOV.radians(),
    })
}

fn image_size(cx: &Context, at: &At<[u32; 2]>) -> Result<[u32; 2]> {
    let [width, height] = at.value;
    let side = |n: u32| (1..=LARGEST_SIDE).contains(&n);
    if !side(width) || !side(height) {
        let what = format!("an image of {width} by {height} pixels cannot be made");
        let help = format!("width and height are each 1 to {LARGEST_SIDE}, like [640, 480]");
        return Err(cx.refuse(at, what, help));
    }
    let area = u64::from(width) * u64::from(height);
    if area > LARGEST_AREA {
        let what = format!("{width} by {height} are {area} pixels");
        return Err(cx.refuse(
            at,
            what,
            format!("an image has at most {LARGEST_AREA} pixels"),
        ));
    }
    Ok(at.value)
}
