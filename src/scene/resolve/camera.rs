//! The camera.

use super::context::Context;
use super::motion::{self, Moving};
use super::mover::{Mover, only_one_way};
use super::{path, pose, sensor, stereo, worldline};
use crate::error::Result;
use crate::scene::at::At;
use crate::scene::file::Camera;
use crate::scene::inputs::Pose;
use crate::scene::limits;
use crate::scene::model::{CameraModel, ProjectionKind};

/// The camera: its parts are resolved separately and then checked against each other.
pub(super) fn resolve(cx: &Context, at: &At<Camera>) -> Result<CameraModel> {
    let camera = &at.value;
    let size = camera.size.value;
    cx.checked(&camera.size, limits::image_size(size))?;
    let mover = Mover::from(camera);
    only_one_way(cx, &mover)?;
    let pose = pose(cx, at)?;
    let Moving {
        origin,
        velocity,
        motion,
        line,
    } = motion::resolve(cx, &mover, pose.eye)?;
    let interval = camera.frame_interval.as_ref();
    let interval = interval.map(|interval| cx.duration(interval, "`frame_interval`"));
    let model = CameraModel {
        origin,
        axes: pose.axes,
        projection: camera.projection.value,
        horizontal_fov: horizontal_fov(cx, camera, &pose, size)?,
        size,
        velocity,
        motion,
        sensor: sensor::resolve(cx, camera)?,
        rotation: sensor::rotation(cx, camera)?,
        stereo: stereo::resolve(cx, camera, size)?,
        time: cx.time(&camera.time)?,
        shutter: sensor::shutter(cx, camera)?,
        frame_interval: interval.transpose()?,
    };
    stereo::refuse_sensor_without_plane(cx, camera)?;
    sensor::refuse_faster_than_light(cx, camera, &model)?;
    worldline::refuse_outside(cx, camera, &model, &line)?;
    Ok(model)
}

/// The pose when the camera's clock shows 0.
fn pose(cx: &Context, at: &At<Camera>) -> Result<Pose> {
    let camera = &at.value;
    let mut keys = pose::Keys::from(camera);
    let mover = Mover::from(camera);
    let start = path::start(cx, &mover)?;
    if camera.gltf.is_none() && start.is_some() {
        keys.eye = &start;
    }
    pose::resolve(cx, at, &keys)
}

/// From the sensor's width, or the file, or the glTF camera, or the default.
fn horizontal_fov(
    cx: &Context,
    camera: &Camera,
    pose: &Pose,
    [width, height]: [u32; 2],
) -> Result<f64> {
    if let Some(horizontal) = sensor::horizontal_fov(cx, camera)? {
        return Ok(horizontal);
    }
    let projection = camera.projection.value;
    if let Some(hfov) = &camera.hfov {
        return pose::fov(cx, hfov, projection);
    }
    if projection != ProjectionKind::Perspective {
        return Ok(Camera::hfov(projection).radians());
    }
    // Each eye has half of the columns.
    let eyes = if camera.stereo.is_some() { 2.0 } else { 1.0 };
    let aspect = f64::from(width) / (eyes * f64::from(height));
    Ok(match pose.gltf_fov {
        Some((Some(horizontal), _)) => horizontal,
        // tan(h/2) = aspect · tan(v/2): the film is a plane.
        Some((None, vertical)) => 2.0 * libm::atan(aspect * libm::tan(0.5 * vertical)),
        None => Camera::hfov(projection).radians(),
    })
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::scene::inputs::Inputs;
    use crate::scene::report::Report;
    use crate::spacetime::Event;

    /// A camera of the file with a vertical field of view of 90 degrees and no aspect ratio.
    fn resolved(keys: &str) -> CameraModel {
        let report = Report {
            name: "test".into(),
            text: format!("[camera]\ngltf = 'a.glb'\nnode = 'cam'\n{keys}").into(),
            edits: Vec::new(),
        };
        let file: crate::scene::file::Scene = report.read().unwrap();
        let camera = file.camera.as_ref().unwrap();
        let mut inputs = Inputs::default();
        let pose = Pose {
            eye: DVec3::new(1.0, 2.0, 3.0),
            axes: [DVec3::X, DVec3::Y, DVec3::NEG_Z],
            gltf_fov: Some((None, std::f64::consts::FRAC_PI_2)),
        };
        inputs.add_pose(camera.value.gltf.as_ref().unwrap(), Ok(pose));
        let cx = Context::new(report, inputs, &file.speed_of_light).unwrap();
        resolve(&cx, camera).unwrap()
    }

    #[test]
    fn a_gltf_camera_gives_pose_and_field_of_view() {
        let camera = resolved("size = [200, 100]");
        assert_eq!(camera.origin.x, DVec3::new(1.0, 2.0, 3.0));
        assert_eq!(camera.axes[2], DVec3::NEG_Z);
        // tan 45° = 1 vertically, 2 horizontally.
        assert!((libm::tan(camera.horizontal_fov / 2.0) - 2.0).abs() < 1e-15);
    }

    #[test]
    fn a_fisheye_at_a_gltf_camera_has_its_own_field_of_view() {
        let camera = resolved("projection = 'fisheye_equisolid'");
        assert_eq!(camera.horizontal_fov, std::f64::consts::PI);
        assert_eq!(camera.axes[2], DVec3::NEG_Z);
    }

    #[test]
    fn a_field_of_view_in_the_scene_goes_before_that_of_the_gltf_camera() {
        let camera = resolved("hfov = \"1 rad\"");
        assert_eq!(camera.horizontal_fov, 1.0);
    }

    #[test]
    fn keyframes_take_the_place_of_where_a_gltf_camera_is() {
        let camera = resolved(
            "motion.keyframes = [{ time = '1 m', position = [0, 0, 7] }, \
             { time = '3 m', position = [1, 0, 7] }]",
        );
        assert_eq!(camera.origin, Event::new(1.0, DVec3::Z * 7.0));
        assert_eq!(camera.axes[2], DVec3::NEG_Z);
    }
}
