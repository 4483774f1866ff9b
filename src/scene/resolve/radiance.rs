//! What a radiance measures.

use super::context::Context;
use crate::colour::Continuation;
use crate::error::Result;
use crate::io::cube::CubeChannel;
use crate::scene::at::At;
use crate::scene::file::{Radiance, Source};
use crate::spacetime::{Quantity, QuantityKind};

pub(super) fn resolve(cx: &Context, radiance: &At<Radiance>) -> Result<Quantity> {
    let Radiance {
        quantity,
        wavelength,
        continuation: _,
    } = &radiance.value;
    if quantity.value == QuantityKind::Line {
        return line(cx, radiance);
    }
    if let Some(wavelength) = wavelength {
        let what = "only the radiance of a spectral line has one wavelength";
        let help = "leave `wavelength` out, or set quantity = \"line\"";
        return Err(cx.refuse(wavelength, what, help));
    }
    Ok(quantity.value.at(f64::NAN))
}

/// How RGB continues outside the range visible at rest; only the scene's `radiance` sets it.
pub(super) fn continuation(radiance: &At<Radiance>, sources: &[At<Source>]) -> Continuation {
    let is_companion = |name: &String| CubeChannel::COMPANIONS.iter().any(|c| c.name() == name);
    let has_companions = |source: &At<Source>| {
        let cube = source.value.cube.as_ref();
        let channels = cube.and_then(|cube| cube.value.channels.as_ref());
        channels.is_some_and(|channels| channels.value.iter().any(is_companion))
    };
    match &radiance.value.continuation {
        Some(said) => said.value,
        None if sources.iter().any(has_companions) => Continuation::Companions,
        None => Continuation::default(),
    }
}

/// Refuses keys that only the scene's `radiance` may have.
pub(super) fn of_source(cx: &Context, radiance: &At<Radiance>) -> Result<Quantity> {
    match &radiance.value.continuation {
        None => resolve(cx, radiance),
        Some(continuation) => {
            let what = "`continuation` is one for the whole scene";
            Err(cx.refuse(continuation, what, "move it to [radiance]"))
        }
    }
}

fn line(cx: &Context, radiance: &At<Radiance>) -> Result<Quantity> {
    let quantity = &radiance.value.quantity;
    let Some(at) = &radiance.value.wavelength else {
        let help = "add its wavelength in the emitter's rest frame, like wavelength = \"532 nm\"";
        return Err(cx.refuse(quantity, "a spectral line needs its wavelength", help));
    };
    let wavelength = at.value.metres();
    if wavelength <= 0.0 {
        let what = format!("a wavelength of {} is not above 0", at.value);
        return Err(cx.refuse(at, what, "a wavelength is above 0, like \"532 nm\""));
    }
    Ok(Quantity::Line { wavelength })
}
