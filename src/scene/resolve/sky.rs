//! The sky.

use super::context::Context;
use super::light::channels;
use super::spectrum;
use crate::colour::Continuation;
use crate::error::Result;
use crate::scene::at::At;
use crate::scene::file;
use crate::scene::limits::MOST_STARS;
use crate::scene::model::{Catalogue, Scene, Sky, SkyRadiance, Stars, Sun};
use crate::scene::values::Vector;
use crate::spacetime::Quantity;
use crate::spacetime::units::Angle;

/// `spectral`: what radiance measures, and how RGB continues if it is a spectrum.
pub(super) fn resolve(
    cx: &Context,
    at: &Option<At<file::Sky>>,
    spectral: (Quantity, Continuation),
) -> Result<Option<Sky>> {
    let Some(at) = at else {
        return Ok(None);
    };
    let sky = &at.value;
    let sun = sky.sun.as_ref().map(|sun| self::sun(cx, &sun.value));
    let stars = sky
        .stars
        .as_ref()
        .map(|stars| self::stars(cx, &stars.value));
    Ok(Some(Sky {
        background: background(cx, sky, spectral)?,
        sun: sun.transpose()?,
        stars: stars.transpose()?,
        lights: sky.lights,
        shadows: sky.shadows,
        span: at.span.clone(),
    }))
}

/// Refuses skies whose light cannot be used: a line has no single wavelength when it comes from all directions.
pub(super) fn check(cx: &Context, file: &file::Scene, scene: &Scene) -> Result<()> {
    let lights = file.sky.as_ref().filter(|at| at.value.lights);
    match (lights, scene.quantity) {
        (Some(sky), Quantity::Line { .. }) => {
            let what = "a sky's line emission has no single wavelength on moving surfaces";
            let help = "set lights = false, or another quantity in [radiance]";
            Err(cx.refuse(sky, what, help))
        }
        _ => Ok(()),
    }
}

/// The light of the sky apart from sun and stars, given in one way; black by default.
fn background(
    cx: &Context,
    sky: &file::Sky,
    spectral: (Quantity, Continuation),
) -> Result<SkyRadiance> {
    let ways = [
        ("radiance", At::span_of(&sky.radiance)),
        ("spectrum", At::span_of(&sky.spectrum)),
        ("gradient", At::span_of(&sky.gradient)),
        ("image", At::span_of(&sky.image)),
    ];
    let help = "give it in one way: `radiance`, `spectrum`, `gradient` or `image`; `sun` and `stars` add to it";
    cx.only_one("the sky", ways, help)?;
    if let Some(spectrum) = spectrum::resolve(cx, &sky.spectrum, "a sky", spectral)? {
        return Ok(SkyRadiance::Spectrum(spectrum));
    }
    if let Some(gradient) = &sky.gradient {
        let colour = |at: &Option<At<Vector>>, default| {
            at.as_ref().map_or(Ok(default), |colour| cx.colour(colour))
        };
        let gradient = &gradient.value;
        return Ok(SkyRadiance::Gradient {
            zenith: colour(&gradient.zenith, [0.13, 0.27, 0.62])?,
            horizon: colour(&gradient.horizon, [0.72, 0.83, 0.95])?,
            ground: colour(&gradient.ground, [0.16, 0.15, 0.13])?,
        });
    }
    if let Some(image) = &sky.image {
        let image = &image.value;
        return Ok(SkyRadiance::Image {
            path: cx.path(&image.file, &["exr", "hdr"])?,
            scale: channels(cx, &image.scale)?,
            rotation: image.rotation.as_ref().map_or(0.0, |at| at.value.radians()),
            negative: image.negative.value,
        });
    }
    Ok(SkyRadiance::Uniform(match &sky.radiance {
        Some(_) => channels(cx, &sky.radiance)?,
        None => [0.0; 3],
    }))
}

fn sun(cx: &Context, sun: &file::Sun) -> Result<Sun> {
    let help = "give the direction towards it, like [1, 2, 1]";
    Ok(Sun {
        direction: cx.unit(&sun.direction, "the direction of the sun", help)?,
        irradiance: match &sun.irradiance {
            Some(_) => channels(cx, &sun.irradiance)?,
            // A white surface facing it has a radiance of about 1, a little warm: an irradiance of π (1, 1, 1) would give exactly 1.
            None => [3.2, 3.0, 2.6],
        },
        // The sun's mean diameter as seen from the Earth.
        radius: radius(cx, &sun.diameter, 0.533, 90.0)?,
    })
}

fn stars(cx: &Context, stars: &file::Stars) -> Result<Stars> {
    cx.exclusive((&stars.file, "file"), (&stars.count, "count"))?;
    cx.exclusive((&stars.file, "file"), (&stars.seed, "seed"))?;
    cx.exclusive((&stars.file, "file"), (&stars.faintest, "faintest"))?;
    let scale = stars.scale.as_ref();
    let scale = scale.map_or(Ok(2e-5), |scale| cx.positive(scale, "`scale`"))?;
    Ok(Stars {
        catalogue: match &stars.file {
            Some(file) => Catalogue::File(cx.path(file, &["csv"])?),
            None => random(cx, stars)?,
        },
        scale,
        radius: radius(cx, &stars.diameter, 0.08, 10.0)?,
    })
}

fn random(cx: &Context, stars: &file::Stars) -> Result<Catalogue> {
    let count = stars.count.as_ref();
    if let Some(count) = count.filter(|count| count.value > MOST_STARS) {
        let what = format!("{} stars are too many", count.value);
        return Err(cx.refuse(count, what, format!("give at most {MOST_STARS}")));
    }
    let faintest = stars.faintest.as_ref();
    if let Some(faintest) = faintest.filter(|m| m.value.0.abs() > 30.0) {
        let help = "magnitudes are from -30 to 30, like 6.5";
        return Err(cx.refuse(faintest, "this is not the magnitude of a star", help));
    }
    Ok(Catalogue::Random {
        count: count.map_or(5000, |count| count.value),
        seed: stars.seed.as_ref().map_or(1, |seed| seed.value),
        faintest: faintest.map_or(6.5, |faintest| faintest.value.0),
    })
}

/// A disc whose angular diameter is not above this, in radians, has a solid angle below 1e-18: rounding of directions would decide about it.
const LEAST_DIAMETER: f64 = 1e-9;

/// Half of an angular diameter, radians; `default` and `largest` in degrees.
fn radius(cx: &Context, at: &Option<At<Angle>>, default: f64, largest: f64) -> Result<f64> {
    let Some(at) = at else {
        return Ok(0.5 * default.to_radians());
    };
    let diameter = at.value.radians();
    // The stated maximum may have been rounded up.
    if diameter > LEAST_DIAMETER && diameter <= largest.to_radians() * (1.0 + 1e-12) {
        return Ok(0.5 * diameter);
    }
    let what = format!("an angular diameter of {} is out of range", at.value);
    let help = format!(
        "it is above {LEAST_DIAMETER:e} rad and at most {largest} deg, like \"{default} deg\""
    );
    Err(cx.refuse(at, what, help))
}
