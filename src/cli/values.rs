//! Parsers for the values of options.

use std::ops::{Range, RangeBounds};

use glam::DVec3;
use nullray::accel::Precision;
use nullray::io::image::film::Delay;
use nullray::render::aov::{self, Aov};
use nullray::scene::Heading;
use nullray::spacetime::units::Percentage;
use nullray::validate::compare::{Encoding, NotFinite};
use nullray::validate::study::{self, Subject};

/// Parsed `--aovs`.
#[derive(Debug, Clone)]
pub struct AovList(pub Vec<Aov>);

/// Methods of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct MethodList(pub Vec<Subject>);

/// Numbers of samples of a study.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SampleList(pub Vec<u32>);

pub fn size(text: &str) -> Result<[u32; 2], String> {
    let (width, height) = text
        .split_once(['x', 'X', '×'])
        .ok_or("write WIDTHxHEIGHT, for instance 640x480")?;
    let is_large = |t: &str| {
        t.trim()
            .parse::<f64>()
            .is_ok_and(|n| n > f64::from(u32::MAX))
    };
    if is_large(width) || is_large(height) {
        return Err("too large: width and height are at most 65536".into());
    }
    let pixels = |t: &str| t.trim().parse::<u32>().ok().filter(|n| *n > 0);
    match (pixels(width), pixels(height)) {
        (Some(width), Some(height)) => Ok([width, height]),
        _ => Err("width and height are whole numbers above 0".into()),
    }
}

/// A range of indices.
pub fn range(text: &str) -> Result<Range<usize>, String> {
    let numbers = text
        .split_once(':')
        .map(|(from, to)| (from.trim().parse(), to.trim().parse()));
    match numbers {
        Some((Ok(from), Ok(to))) if from < to => Ok(from..to),
        _ => Err("write FROM:TO, like 0:64, FROM below TO".into()),
    }
}

/// A number above 0.
pub fn positive(text: &str) -> Result<f64, String> {
    let number = text.trim().parse::<f64>().ok();
    let fits = number.filter(|number| *number > 0.0 && number.is_finite());
    fits.ok_or_else(|| "write a number above 0".into())
}

/// A speed as v/c, with or without the unit c.
pub fn speed(text: &str) -> Result<f64, String> {
    let number = text.trim();
    let number = number.strip_suffix('c').unwrap_or(number).trim_end();
    number
        .parse()
        .map_err(|_| "write v/c as a number, like 0.9".into())
}

pub fn not_negative(text: &str) -> Result<f64, String> {
    let number = text.trim().parse::<f64>().ok();
    let fits = number.filter(|number| *number >= 0.0 && number.is_finite());
    fits.ok_or_else(|| "write a number, 0 or above".into())
}

/// The direction in which a camera moves.
pub fn heading(text: &str) -> Result<Heading, String> {
    let (sign, axis) = match text.strip_prefix('-') {
        Some(axis) => (-1.0, axis),
        None => (1.0, text),
    };
    match (axis, text) {
        ("x", _) => return Ok(Heading::Along(DVec3::X * sign)),
        ("y", _) => return Ok(Heading::Along(DVec3::Y * sign)),
        ("z", _) => return Ok(Heading::Along(DVec3::Z * sign)),
        (_, "towards") => return Ok(Heading::Towards),
        (_, "away") => return Ok(Heading::Away),
        _ => {}
    }
    // Parsed from the whole text: the minus sign taken off may belong to the first component.
    let numbers = text.split(',').map(|n| n.trim().parse::<f64>().ok());
    let numbers: Option<Vec<f64>> = numbers.collect();
    match numbers.as_deref() {
        Some(&[x, y, z]) if DVec3::new(x, y, z) != DVec3::ZERO && (x + y + z).is_finite() => {
            Ok(Heading::Along(DVec3::new(x, y, z)))
        }
        _ => Err("write x, y, z, -x, -y, -z, a vector like 1,0,-1, towards or away".into()),
    }
}

/// Three numbers.
pub fn vector(text: &str) -> Result<DVec3, String> {
    let numbers = text.split(',').map(|n| n.trim().parse::<f64>().ok());
    let numbers: Option<Vec<f64>> = numbers.collect();
    match numbers.as_deref() {
        Some(&[x, y, z]) if DVec3::new(x, y, z).is_finite() => Ok(DVec3::new(x, y, z)),
        _ => Err("write three numbers, like 0.5,1,-2".into()),
    }
}

/// Columns and rows of a grid.
pub fn grid(text: &str) -> Result<[u32; 2], String> {
    match size(text)? {
        // Each pixel adds a diagram to the page: with 400 its size is still one that a browser opens.
        [columns, rows] if columns.saturating_mul(rows) <= 400 => Ok([columns, rows]),
        _ => Err("more than 400 pixels; write columns and rows like 4x3".into()),
    }
}

/// Column and row of a pixel.
pub fn pixel(text: &str) -> Result<[u32; 2], String> {
    let help = "write COLUMN,ROW, whole numbers from 0, for instance 320,240";
    let (column, row) = text.split_once(',').ok_or(help)?;
    match (column.trim().parse(), row.trim().parse()) {
        (Ok(column), Ok(row)) => Ok([column, row]),
        _ => Err(help.into()),
    }
}

/// A number within `range`; `help` states what is allowed.
fn number(text: &str, range: impl RangeBounds<f64>, help: &str) -> Result<f64, String> {
    let number = text.trim().parse::<f64>().ok();
    number.filter(|n| range.contains(n)).ok_or(help.into())
}

/// Pixels per point.
pub fn scale(text: &str) -> Result<f64, String> {
    number(text, 0.1..=100.0, "a scale is a number from 0.1 to 100")
}

/// An error on the film.
pub fn pixels(text: &str) -> Result<f64, String> {
    let help = "give a number of pixels from 1e-6 to 1e6, like 0.5";
    number(text, 1e-6..=1e6, help)
}

pub fn assignment(text: &str) -> Result<(String, String), String> {
    let (key, value) = text
        .split_once('=')
        .filter(|(key, _)| !key.trim().is_empty())
        .ok_or("write KEY=VALUE, for instance --set \"camera.time=3 m\"")?;
    Ok((key.trim().into(), value.trim().into()))
}

/// An amount of memory.
pub fn bytes(text: &str) -> Result<u64, String> {
    if text.trim().starts_with('-') {
        return Err("memory is not negative; write 16GiB".into());
    }
    let digits = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    // Powers of 1024, however the unit is written.
    let unit = match text[digits.len()..].to_ascii_lowercase().as_str() {
        "" | "b" => 1,
        "k" | "kb" | "kib" => 1 << 10,
        "m" | "mb" | "mib" => 1 << 20,
        "g" | "gb" | "gib" => 1 << 30,
        "t" | "tb" | "tib" => 1 << 40,
        other => return Err(format!("\"{other}\" is not a unit of memory; write 16GiB")),
    };
    let number = digits
        .trim()
        .parse::<u64>()
        .map_err(|e| format!("{e}; write 16GiB"))?;
    number.checked_mul(unit).ok_or_else(|| "too large".into())
}

pub fn methods(text: &str) -> Result<MethodList, String> {
    study::parse_methods(text).map(MethodList)
}

pub fn samples(text: &str) -> Result<SampleList, String> {
    study::parse_samples(text).map(SampleList)
}

/// A relative error, as a part of 1: "1 %" or 0.01. A number from 1 on needs its unit, because elsewhere (`--exposure 95`) it is a percentage.
pub fn relative_error(text: &str) -> Result<f64, String> {
    let help = "write a percentage above 0 % and at most 100 %, like \"1 %\"";
    if let Ok(said) = number(text, 1.0..=100.0, help) {
        return Err(format!(
            "without a unit this is a part of 1, so it must be below 1: write \"{said} %\" or {}",
            said / 100.0
        ));
    }
    let (digits, unit) = match text.trim().strip_suffix('%') {
        Some(digits) => (digits, 0.01),
        None => (text, 1.0),
    };
    // The range applies to the number as written, so it is divided by the unit.
    number(digits, f64::MIN_POSITIVE..=1.0 / unit, help).map(|number| number * unit)
}

/// The longest time to work, seconds: a month.
const MONTH: f64 = 2.6e6;

/// A time to work, in seconds: "60 s", "5 min" or "1 h", up to a month; a bare number is one of seconds.
pub fn work_time(text: &str) -> Result<f64, String> {
    let help = "a time like \"60 s\", \"5 min\" or \"1 h\"";
    let text = text.trim();
    let digits = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let unit = match &text[digits.len()..] {
        "" | "s" => 1.0,
        "min" => 60.0,
        "h" => 3600.0,
        _ => return Err(help.into()),
    };
    number(digits, 0.0..=MONTH / unit, help).map(|number| number * unit)
}

/// The largest number of passes.
pub const MOST_PASSES: u32 = 65_536;

/// A number of passes; they come in pairs, one for each half of the samples.
pub fn passes(text: &str) -> Result<u32, String> {
    let number = text.trim().parse::<u32>().ok();
    let even = number.filter(|n| (2..=MOST_PASSES).contains(n) && n % 2 == 0);
    even.ok_or_else(|| format!("passes come in pairs: an even number from 2 to {MOST_PASSES}"))
}

pub fn aovs(text: &str) -> Result<AovList, String> {
    let list = aov::parse(text).map_err(|error| error.to_string())?;
    Ok(AovList(list))
}

/// The precision of visibility.
pub fn precision(text: &str) -> Result<Precision, String> {
    let known = Precision::ALL.into_iter().find(|p| p.name() == text);
    known.ok_or_else(|| "write certified, or fast".into())
}

/// A percentage; a bare number is one too. One up to 1 needs its unit, because elsewhere (`--error 0.05`) it is a part of 1.
pub fn percentage(text: &str) -> Result<String, String> {
    if let Ok(said) = number(text, f64::MIN_POSITIVE..=1.0, "") {
        // Without what rounding leaves of the product.
        let percent = (1e11 * said).round() / 1e9;
        return Err(format!(
            "without a unit this is a percentage, and a very low one: write \"{percent} %\" or \"{said} %\""
        ));
    }
    // A text with a unit is kept: the scene file has the same key, and reads it in the same way.
    let text = match text.trim().parse::<f64>() {
        Ok(number) => format!("{number} %"),
        Err(_) => text.into(),
    };
    let parsed = text.parse::<Percentage>();
    parsed.map(|_| text).map_err(|error| error.to_string())
}

/// The largest number of frames in one run.
pub const MOST_FRAMES: u64 = 1_000_000;

/// Frames A to B, B not included.
pub fn frames(text: &str) -> Result<Range<u64>, String> {
    let help = "write the first frame and the one after the last, for instance 0..50";
    let (first, end) = text.split_once("..").ok_or(help)?;
    let number = |t: &str| t.trim().parse::<u32>().map(u64::from);
    match (number(first), number(end)) {
        // Numbers are u32, so this sum cannot overflow.
        (Ok(first), Ok(end)) if end > first + MOST_FRAMES => Err(format!(
            "{} frames are more than {MOST_FRAMES}: render a part of them",
            end - first
        )),
        (Ok(first), Ok(end)) if first < end => Ok(first..end),
        (Ok(first), Ok(end)) => Err(format!(
            "{first}..{end} contains no frame: the end is exclusive"
        )),
        _ => Err(format!(
            "frames have whole numbers from 0 to {}; {help}",
            u32::MAX
        )),
    }
}

/// Frames per second.
pub fn rate(text: &str) -> Result<f64, String> {
    let help = "give a number above 0, like 25 or 1e9";
    number(text, f64::MIN_POSITIVE..f64::INFINITY, help)
}

/// A rate at which films are played, which files store as a fraction.
pub fn film_rate(text: &str) -> Result<f64, String> {
    let fps = rate(text)?;
    let help =
        "cannot be expressed as a fraction of numbers up to 65535: give a rate like 25 or 29.97";
    Delay::of_rate(fps).map(|_| fps).map_err(|_| help.into())
}

pub fn transfer(text: &str) -> Result<Encoding, String> {
    match text {
        "srgb" => Ok(Encoding::Srgb),
        "linear" => Ok(Encoding::Linear),
        _ => Err("write srgb or linear".into()),
    }
}

pub fn nan(text: &str) -> Result<NotFinite, String> {
    let help = "write refuse, ignore, or count-as=VALUE";
    match text.split_once('=') {
        None if text == "refuse" => Ok(NotFinite::Refuse),
        None if text == "ignore" => Ok(NotFinite::Ignore),
        Some(("count-as", value)) => {
            number(value, f64::MIN..=f64::MAX, help).map(NotFinite::CountAs)
        }
        _ => Err(help.into()),
    }
}

pub fn crop(text: &str) -> Result<[u32; 4], String> {
    let numbers: Option<Vec<u32>> = text.split(',').map(|n| n.trim().parse().ok()).collect();
    let numbers = numbers.and_then(|n| <[u32; 4]>::try_from(n).ok());
    numbers.ok_or_else(|| "write X,Y,WIDTH,HEIGHT in pixels, for instance 100,50,64,64".into())
}

pub fn ppd(text: &str) -> Result<f64, String> {
    number(text, 1.0..=1000.0, "a number from 1 to 1000")
}
