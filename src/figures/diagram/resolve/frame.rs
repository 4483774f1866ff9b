//! Frames of reference.

use super::names::Names;
use super::settings;
use crate::error::Result;
use crate::figures::diagram::file::DiagramFrame;
use crate::figures::diagram::model::{Moment, Reference};
use crate::scene::At;
use crate::spacetime::{InertialFrame, Rest};

/// A frame by its velocity, or the momentary rest frame of a world line.
pub(super) fn resolve(names: &mut Names, at: &At<DiagramFrame>) -> Result<Reference> {
    let frame = &at.value;
    let cx = names.cx;
    cx.exclusive((&frame.of, "of"), (&frame.velocity, "velocity"))?;
    cx.exclusive(
        (&frame.velocity, "velocity"),
        (&frame.proper_time, "proper_time"),
    )?;
    settings::settable(cx, &frame.name, &frame.name.value)?;
    let moment = moment(names, frame)?;
    let velocity = match &moment {
        Some(moment) => moment.velocity,
        None => names.velocity(&frame.velocity, &frame.relative_to)?,
    };
    let origin = match (&frame.origin, moment) {
        (Some(origin), _) => names.event(origin)?,
        (None, Some(moment)) => moment.event,
        (None, None) => crate::spacetime::Event::ORIGIN,
    };
    let ticks = settings::positive(cx, &frame.ticks, "`ticks`")?;
    Ok(Reference {
        name: frame.name.value.clone(),
        frame: InertialFrame::<Rest>::new(velocity, origin),
        axes: frame.axes.unwrap_or(true),
        grid: frame.grid.unwrap_or(false),
        ticks: ticks.map(|ticks| ticks * names.unit),
        colour: frame.colour,
    })
}

/// The moment of the world line along with which the frame moves.
fn moment(names: &mut Names, frame: &DiagramFrame) -> Result<Option<Moment>> {
    let Some(of) = &frame.of else {
        return Ok(None);
    };
    let track = names.track(of)?;
    let camera = names.scene.camera.as_ref();
    let shot = camera.filter(|_| ["camera", "pinhole", "sensor"].contains(&of.value.as_str()));
    let default = shot.map_or(0.0, |camera| camera.model.time);
    let time = frame.proper_time.as_ref();
    let time = time.map_or(default, |at| at.value.0 * names.unit);
    let moment = track.at(time).ok_or_else(|| {
        let [first, last] = track.span().map(|end| end / names.unit);
        let what = "the world line does not have this time";
        let help = format!("its own clock shows {first} to {last}");
        match &frame.proper_time {
            Some(at) => names.cx.refuse(at, what, help),
            None => names.cx.refuse(of, what, help),
        }
    })?;
    Ok(Some(moment))
}
