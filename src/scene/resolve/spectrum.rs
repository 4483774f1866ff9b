//! Spectra of light sources.

use super::context::Context;
use crate::colour::{Continuation, Scale, Spectrum, SpectrumShape};
use crate::error::{Result, number};
use crate::scene::at::At;
use crate::scene::file;
use crate::scene::values::Number;
use crate::spacetime::Quantity;
use crate::spacetime::units::Wavelength;

/// The largest number of lines of a spectrum.
const MOST_LINES: usize = 256;

/// The narrowest Gaussian: σ over the wavelength of its peak. A narrower one is indistinguishable from a line.
const NARROWEST: f64 = 1e-6;

/// The spectrum of an object, a light or a sky in a scene whose radiance is RGB as a spectrum; `what` names it in messages.
pub(super) fn resolve(
    cx: &Context,
    at: &Option<At<file::Spectrum>>,
    what: &str,
    (quantity, continuation): (Quantity, Continuation),
) -> Result<Option<Spectrum>> {
    let Some(at) = at else {
        return Ok(None);
    };
    if quantity != Quantity::Rgb {
        let what = format!("{what} has a spectrum where radiances have none");
        let help = "set quantity = \"rgb\" in [radiance], or leave `spectrum` out";
        return Err(cx.refuse(at, what, help));
    }
    described(cx, at, continuation).map(Some)
}

/// The spectrum that `at` describes; `continuation` is the default for RGB.
fn described(
    cx: &Context,
    at: &At<file::Spectrum>,
    continuation: Continuation,
) -> Result<Spectrum> {
    let shape = shape(cx, at, continuation)?;
    let (scale, key) = scale(cx, at)?;
    let by_luminance = matches!(scale, Scale::Luminance(_));
    let ends = match &shape {
        SpectrumShape::Table(rows) => rows.first().zip(rows.last()),
        SpectrumShape::Lines(_)
        | SpectrumShape::Blackbody(_)
        | SpectrumShape::Gaussian { .. }
        | SpectrumShape::Rgb(..)
        | SpectrumShape::Filtered(..) => None,
    };
    let ends = ends.map(|(first, last)| [first[0], last[0]]);
    let unseen = || {
        let (file, ends) = at.value.table.as_ref().zip(ends)?;
        // Nanometres, to a thousandth if that distinguishes them.
        let [first, last] = ends.map(|metres| match metres < 1e-12 {
            true => format!("{:.3e}", metres * 1e9),
            false => number((metres * 1e12).round() / 1e3).to_string(),
        });
        let what = format!(
            "{:?} spans {first} to {last} nm, which is invisible at rest, so it has no luminance",
            file.value
        );
        let help = "wavelengths of a table are in nm, like 550; if these are right, give the amount of light by `total`, its sum over all wavelengths, or by `factor`";
        Some(cx.refuse(file, what, help))
    };
    Spectrum::new(shape, scale).ok_or_else(|| match by_luminance {
        true if let Some(unseen) = unseen() => unseen,
        true => {
            let what = "this spectrum is invisible at rest, so it has no luminance";
            let help = "give its amount by `total`, its sum over all wavelengths, or by `factor`";
            cx.report.refuse(key.unwrap_or(&at.span), what, help)
        }
        false => {
            let what = "this spectrum has no sum over all wavelengths";
            let help = "give `luminance` or `factor` in place of `total`";
            cx.report.refuse(key.unwrap_or(&at.span), what, help)
        }
    })
}

fn shape(
    cx: &Context,
    at: &At<file::Spectrum>,
    continuation: Continuation,
) -> Result<SpectrumShape> {
    let said = &at.value;
    cx.only_one(
        "the spectrum",
        [
            ("line", At::span_of(&said.line)),
            ("lines", At::span_of(&said.lines)),
            ("blackbody", At::span_of(&said.blackbody)),
            ("gaussian", At::span_of(&said.gaussian)),
            ("table", At::span_of(&said.table)),
            ("flat", At::span_of(&said.flat)),
            ("rgb", At::span_of(&said.rgb)),
        ],
        "keep one of them",
    )?;
    if let (Some(continuation), None) = (&said.continuation, &said.rgb) {
        let what = "only a spectrum by `rgb` is continued";
        return Err(cx.refuse(continuation, what, "leave `continuation` out"));
    }
    if let Some(at) = &said.continuation
        && at.value == Continuation::Companions
    {
        let what = "only the channels of cubes have companions";
        return Err(cx.refuse(at, what, "\"dark\", \"edge\" or \"blackbody\""));
    }
    if let Some(line) = &said.line {
        return Ok(SpectrumShape::Lines(vec![[wavelength(cx, line)?, 1.0]]));
    }
    if let Some(lines) = &said.lines {
        return self::lines(cx, lines);
    }
    if let Some(temperature) = &said.blackbody {
        let kelvin = temperature.value.kelvin();
        if (1e-6..=1e15).contains(&kelvin) {
            return Ok(SpectrumShape::Blackbody(kelvin));
        }
        let what = format!(
            "a temperature of {} is not between 1e-6 K and 1e15 K",
            temperature.value
        );
        return Err(cx.refuse(temperature, what, "like \"5800 K\""));
    }
    if let Some(gaussian) = &said.gaussian {
        return self::gaussian(cx, gaussian);
    }
    if let Some(table) = &said.table {
        let rows = cx.spectrum_table(table)?;
        if rows.iter().all(|[_, value]| *value == 0.0) {
            let what = format!("all values of {:?} are 0", table.value);
            return Err(cx.refuse(table, what, "give at least one wavelength a value above 0"));
        }
        return Ok(SpectrumShape::Table(rows));
    }
    // A flat spectrum is a table of two rows.
    if let Some(flat) = &said.flat {
        let [from, to] = &flat.value;
        let (first, last) = (wavelength(cx, from)?, wavelength(cx, to)?);
        if first < last {
            return Ok(SpectrumShape::Table(vec![[first, 1.0], [last, 1.0]]));
        }
        let what = format!("{} is not longer than {}", to.value, from.value);
        return Err(cx.refuse(
            to,
            what,
            "give the shorter wavelength first, like [\"300 nm\", \"2 um\"]",
        ));
    }
    if let Some(rgb) = &said.rgb {
        let own = said.continuation.as_ref().map(|at| at.value);
        return Ok(SpectrumShape::Rgb(
            cx.colour(rgb)?,
            own.unwrap_or(continuation),
        ));
    }
    let help = "say which: line = \"589 nm\", lines = […], blackbody = \"5800 K\", gaussian = { … }, \
                table = \"lamp.csv\", flat = [\"300 nm\", \"2 um\"] or rgb = [1, 1, 1]";
    Err(cx.refuse(at, "this spectrum does not give its wavelengths", help))
}

fn lines(cx: &Context, lines: &At<Vec<At<file::SpectralLine>>>) -> Result<SpectrumShape> {
    let count = lines.value.len();
    if !(1..=MOST_LINES).contains(&count) {
        let what = format!("{count} lines");
        return Err(cx.refuse(lines, what, format!("give 1 to {MOST_LINES} lines")));
    }
    let mut sum = 0.0;
    let mut resolved = Vec::with_capacity(count);
    for line in &lines.value {
        let energy = not_below_zero(cx, &line.value.energy, "the energy of a line")?;
        sum += energy;
        resolved.push([wavelength(cx, &line.value.wavelength)?, energy]);
    }
    if sum <= 0.0 {
        let what = "none of these lines has any energy";
        return Err(cx.refuse(lines, what, "give at least one an `energy` above 0"));
    }
    Ok(SpectrumShape::Lines(resolved))
}

fn gaussian(cx: &Context, gaussian: &At<file::Gaussian>) -> Result<SpectrumShape> {
    let centre = wavelength(cx, &gaussian.value.centre)?;
    let sigma = wavelength(cx, &gaussian.value.sigma)?;
    if sigma >= NARROWEST * centre && sigma <= centre {
        return Ok(SpectrumShape::Gaussian { centre, sigma });
    }
    let what = format!(
        "a standard deviation of {} is not between {NARROWEST:e} of the centre and the centre itself",
        gaussian.value.sigma.value
    );
    let help = "like \"20 nm\"; a narrower one is a `line`, a wider one a `table`";
    Err(cx.refuse(&gaussian.value.sigma, what, help))
}

fn wavelength(cx: &Context, at: &At<Wavelength>) -> Result<f64> {
    let metres = at.value.metres();
    // The fifth power of the smallest still fits f64.
    if metres >= 1e-20 {
        return Ok(metres);
    }
    let what = format!("a wavelength of {} is not above 1e-11 nm", at.value);
    Err(cx.refuse(at, what, "like \"550 nm\""))
}

/// Its amount, and the place that gives it.
fn scale<'a>(
    cx: &Context,
    at: &'a At<file::Spectrum>,
) -> Result<(Scale, Option<&'a std::ops::Range<usize>>)> {
    let said = &at.value;
    let (luminance, total, factor) = (&said.luminance, &said.total, &said.factor);
    cx.only_one(
        "the amount of light",
        [
            ("luminance", At::span_of(luminance)),
            ("total", At::span_of(total)),
            ("factor", At::span_of(factor)),
        ],
        "keep one of them",
    )?;
    let has_values = said.table.is_some() || said.rgb.is_some() || said.blackbody.is_some();
    if let (Some(factor), false) = (factor, has_values) {
        let what = "`factor` multiplies the values of a table, of rgb or of Planck's law, but this spectrum has none";
        let help =
            "give the amount of light by `total`, its sum over all wavelengths, or by `luminance`";
        return Err(cx.refuse(factor, what, help));
    }
    let amount = |at: &Option<At<Number>>| {
        let check = |at| not_below_zero(cx, at, "the amount of light");
        at.as_ref().map(check).transpose()
    };
    let scale = match (amount(luminance)?, amount(total)?, amount(factor)?) {
        (Some(wanted), ..) => Scale::Luminance(wanted),
        (_, Some(wanted), _) => Scale::Total(wanted),
        (.., Some(factor)) => Scale::Factor(factor),
        _ if said.rgb.is_some() => Scale::Factor(1.0),
        _ => Scale::Luminance(1.0),
    };
    let spans = [luminance, total, factor].into_iter().find_map(At::span_of);
    Ok((scale, spans))
}

fn not_below_zero(cx: &Context, at: &At<Number>, name: &str) -> Result<f64> {
    let value = at.value.0;
    if value >= 0.0 {
        return Ok(value);
    }
    let what = format!("{name} is {value}, which is below 0");
    Err(cx.refuse(at, what, format!("{name} is at least 0")))
}
