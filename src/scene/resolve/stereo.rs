//! Stereo pairs, and which cameras have a sensor plane behind the pinhole.

use super::context::Context;
use crate::error::Result;
use crate::scene::file;
use crate::scene::model::{ProjectionKind, Stereo};

/// The two pinholes of the file, if given.
pub(super) fn resolve(
    cx: &Context,
    camera: &file::Camera,
    [width, _]: [u32; 2],
) -> Result<Option<Stereo>> {
    let Some(at) = &camera.stereo else {
        return Ok(None);
    };
    let help = "leave one of the two out";
    if let Some(sensor) = &camera.sensor {
        let what = "the eyes of a stereo pair are points, but a sensor lies behind a pinhole";
        let other = (&at.span, "this stereo pair");
        return Err(cx.report.refuse_two(&sensor.span, other, what, help));
    }
    if let Some(rotation) = &camera.rotation {
        let what = "the eyes of a stereo pair do not turn";
        let other = (&at.span, "this stereo pair");
        return Err(cx.report.refuse_two(&rotation.span, other, what, help));
    }
    if let (Some(shutter), Some(motion)) = (&camera.shutter, &camera.motion) {
        let what = "two accelerating eyes share no common time: with a motion, a stereo pair can only take pictures of an instant";
        let help = "leave out [camera.shutter], [camera.motion] or [camera.stereo]";
        let other = (&motion.span, "this motion");
        return Err(cx.report.refuse_two(&shutter.span, other, what, help));
    }
    if width % 2 == 1 {
        let what = format!("{width} columns cannot be shared by two eyes");
        let help = "a stereo pair has an even number of columns, half of them for either eye";
        return Err(cx.refuse(&camera.size, what, help));
    }
    let distance = &at.value.interpupillary_distance;
    let metres = distance.value.metres();
    if !(metres >= 0.0 && metres.is_finite()) {
        let what = format!("the pupils are {} apart", distance.value);
        return Err(cx.refuse(
            distance,
            what,
            "their distance is at least 0, like \"64 mm\"",
        ));
    }
    Ok(Some(Stereo {
        interpupillary_distance: metres,
    }))
}

/// Refuses a sensor unless the projection is onto a plane.
pub(super) fn refuse_sensor_without_plane(cx: &Context, camera: &file::Camera) -> Result<()> {
    let projection = &camera.projection;
    match &camera.sensor {
        Some(sensor) if projection.value != ProjectionKind::Perspective => {
            let what = format!(
                "a sensor is a plane behind a pinhole, but projection = \"{}\" has none",
                projection.value.name()
            );
            let help = "leave out [camera.sensor], or give projection = \"perspective\"";
            let other = (&projection.span, "this projection");
            Err(cx.report.refuse_two(&sensor.span, other, what, help))
        }
        _ => Ok(()),
    }
}
