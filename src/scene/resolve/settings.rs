//! Medium, effects, outside data, display.

use super::context::Context;
use crate::error::{Error, Result};
use crate::scene::at::At;
use crate::scene::file;
use crate::scene::limits;
use crate::scene::model::{
    CameraModel, Effects, Equations, Exposure, Fill, FlashClock, FlashTimes, Motion, Object,
    Outside,
};
use crate::scene::values::Numbers;
use crate::spacetime::Event;
use crate::spacetime::units::quoted;
use crate::text::RichText;

pub(super) fn medium_index(cx: &Context, medium: &file::Medium) -> Result<f64> {
    let index = medium.index.value.0;
    cx.checked(&medium.index, limits::medium_index(index))?;
    Ok(index)
}

pub(super) fn effects(effects: &file::Effects) -> Effects {
    Effects {
        aberration: effects.aberration,
        doppler: effects.doppler,
        searchlight: effects.searchlight,
        retardation: effects.retardation,
    }
}

pub(super) fn outside(outside: &file::Outside) -> Outside {
    let table = match outside {
        file::Outside::All(one) => return all(fill(*one)),
        file::Outside::ByCase(table) => table,
    };
    let otherwise = all(table.mark.map_or(Fill::Black, |mark| Fill::Mark(mark.0)));
    Outside {
        before: table.before.map_or(otherwise.before, fill),
        after: table.after.map_or(otherwise.after, fill),
        off_texture: table.off_texture.map_or(otherwise.off_texture, fill),
        occluded: table.occluded.map_or(otherwise.occluded, fill),
    }
}

fn all(fill: Fill) -> Outside {
    Outside {
        before: fill,
        after: fill,
        off_texture: fill,
        occluded: fill,
    }
}

fn fill(fill: file::Fill) -> Fill {
    match fill {
        file::Fill::Black => Fill::Black,
        file::Fill::Hold => Fill::Hold,
        file::Fill::Mark(colour) => Fill::Mark(colour.0),
    }
}

/// The radiance shown as white: one of three keys, or the default percentile.
pub(super) fn exposure(cx: &Context, at: &At<file::Display>) -> Result<Exposure> {
    let file::Display {
        exposure,
        white,
        logarithmic,
        ..
    } = &at.value;
    cx.exclusive((exposure, "exposure"), (white, "white"))?;
    cx.exclusive((exposure, "exposure"), (logarithmic, "logarithmic"))?;
    cx.exclusive((white, "white"), (logarithmic, "logarithmic"))?;
    if let Some(at) = logarithmic {
        return Ok(Exposure::Logarithmic(ascending(cx, at, "radiances")?));
    }
    if let Some(white) = white {
        return Ok(Exposure::White(cx.positive(white, "`white`")?));
    }
    let Some(percentile) = exposure else {
        return Ok(Exposure::default());
    };
    let percent = percentile.value.percent();
    if percent > 0.0 && percent <= 100.0 {
        return Ok(Exposure::Percentile(percent));
    }
    let what = format!(
        "a percentile of {} is not above 0 and at most 100 %",
        percentile.value
    );
    Err(cx.refuse(
        percentile,
        what,
        "give a percentile like \"99 %\", or white = 1.0",
    ))
}

/// Bits per sample of a PNG.
/// The words below pictures.
pub(super) fn caption(cx: &Context, at: &At<file::Display>) -> Result<Option<String>> {
    let Some(at) = &at.value.caption else {
        return Ok(None);
    };
    let set = RichText::plain(&at.value).and_then(|words| words.width(1.0));
    match set {
        Ok(_) => Ok(Some(at.value.clone())),
        Err(Error::Invalid(problem) | Error::Unsupported(problem)) => {
            Err(cx.refuse(at, problem.what.to_string(), problem.help.to_string()))
        }
        Err(error) => Err(error),
    }
}

pub(super) fn bits(cx: &Context, at: &At<file::Display>) -> Result<u8> {
    let bits = &at.value.bits;
    match bits.value {
        8 => Ok(8),
        16 => Ok(16),
        other => Err(cx.refuse(
            bits,
            format!("{other} bits"),
            "a PNG has 8 or 16 bits per sample",
        )),
    }
}

/// The observed wavelength that is shown as 555 nm, metres.
pub(super) fn false_colour(cx: &Context, at: &At<file::Display>) -> Result<Option<f64>> {
    let Some(at) = &at.value.false_colour else {
        return Ok(None);
    };
    let metres = at.value.metres();
    // The fourth power of its ratio to 555 nm is well within f64.
    if (1e-20..=1e10).contains(&metres) {
        return Ok(Some(metres));
    }
    let what = format!("a wavelength of {} cannot be shown", at.value);
    Err(cx.refuse(at, what, "like \"10 um\""))
}

/// The range of the colours of isochrones, metres.
pub(super) fn times(cx: &Context, at: &At<file::Display>) -> Result<Option<[f64; 2]>> {
    let Some(at) = &at.value.times else {
        return Ok(None);
    };
    let [first, last] = &at.value;
    let span = [cx.time(first)?, cx.time(last)?];
    if span[0] < span[1] {
        return Ok(Some(span));
    }
    let what = "these times span nothing";
    Err(cx.refuse(
        at,
        what,
        "give the earlier time first, like [\"0 m\", \"12 m\"]",
    ))
}

/// The range of the colours of luminance.
pub(super) fn luminances(cx: &Context, at: &At<file::Display>) -> Result<Option<[f64; 2]>> {
    let Some(at) = &at.value.luminances else {
        return Ok(None);
    };
    ascending(cx, at, "luminances").map(Some)
}

/// Two values above 0, the lower first.
fn ascending(cx: &Context, at: &At<Numbers<2>>, what: &str) -> Result<[f64; 2]> {
    let [low, high] = at.value.0;
    if 0.0 < low && low < high {
        return Ok([low, high]);
    }
    let what = format!("the range of these {what} is empty, or not above 0");
    Err(cx.refuse(at, what, "give the lower one first, like [1e-4, 1e2]"))
}

/// The light whose isochrones are drawn, as seen by this camera, for these objects.
pub(super) fn isochrones(
    cx: &Context,
    at: &At<file::Display>,
    camera: &CameraModel,
    objects: &[Object],
) -> Result<Option<FlashTimes>> {
    let Some(at) = &at.value.isochrones else {
        return Ok(None);
    };
    let file::Isochrones { flash, time, clock } = &at.value;
    if let Some(object) = objects.iter().find(|object| !object.velocity.is_rest()) {
        let what = format!(
            "isochrones of a flash need bodies at rest, but {} moves",
            quoted(&object.name)
        );
        return Err(cx.refuse(
            at,
            what,
            "leave `isochrones` out: isochrones of the picture's own light work for any bodies",
        ));
    }
    // Times of arrival refer to one place: the pinhole must be at rest.
    let rests =
        camera.velocity.is_rest() && camera.motion == Motion::Inertial && camera.stereo.is_none();
    let clock = match clock.as_ref().map(|at| at.value) {
        None | Some(file::Receiver::Named(file::NamedReceiver::World)) => FlashClock::World,
        Some(file::Receiver::At(place)) => FlashClock::Capture(place.vec()),
        Some(file::Receiver::Named(file::NamedReceiver::Camera)) if rests => {
            FlashClock::Camera(camera.origin)
        }
        Some(file::Receiver::Named(file::NamedReceiver::Camera)) => {
            let what =
                "these isochrones need a camera with one pinhole at rest, but this one is not";
            let help = "give clock = \"world\", or a camera at rest";
            return Err(cx.refuse(at, what, help));
        }
    };
    let ct = time.as_ref().map_or(Ok(0.0), |time| cx.time(time))?;
    Ok(Some(FlashTimes {
        flash: Event::new(ct, flash.value.vec()),
        clock,
    }))
}

pub(super) fn samples_per_pixel(cx: &Context, at: &At<file::Display>) -> Result<u32> {
    let samples = &at.value.samples_per_pixel;
    cx.checked(samples, limits::samples_per_pixel(samples.value))?;
    Ok(samples.value)
}

/// The number of reflections after direct light.
pub(super) fn bounces(cx: &Context, file: &file::Scene) -> Result<u32> {
    let bounces = &file.render.bounces;
    cx.checked(bounces, limits::bounces(bounces.value))?;
    if bounces.value > 0 && !file.effects.retardation {
        let what = "without retardation, light cannot be traced from surface to surface";
        let help = "leave `bounces` out, or turn `effects.retardation` on";
        return Err(cx.refuse(bounces, what, help));
    }
    if bounces.value > 0 && file.model.value == Equations::Paper2015 {
        let other = (&file.model.span, "this model");
        let what = "the paper's equations have no light from surface to surface";
        let help = "leave `bounces` out, or give model = \"exact\"";
        return Err(cx.report.refuse_two(&bounces.span, other, what, help));
    }
    Ok(bounces.value)
}
