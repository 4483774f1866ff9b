//! Values of options, from their texts.

use std::ops::Range;

use nullray::accel::Precision;
use nullray::render::aov::{self, Aov};
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
    let pixels = |t: &str| t.trim().parse::<u32>().ok().filter(|n| *n > 0);
    match (pixels(width), pixels(height)) {
        (Some(width), Some(height)) => Ok([width, height]),
        _ => Err("width and height are whole numbers above 0".into()),
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

/// Pixels of a point.
pub fn scale(text: &str) -> Result<f64, String> {
    let scale = text.trim().parse::<f64>().ok();
    let scale = scale.filter(|scale| (0.1..=100.0).contains(scale));
    scale.ok_or_else(|| "a scale is a number from 0.1 to 100".into())
}

/// An error on the film.
pub fn pixels(text: &str) -> Result<f64, String> {
    let pixels = text.trim().parse::<f64>().ok();
    let pixels = pixels.filter(|pixels| (1e-6..=1e6).contains(pixels));
    pixels.ok_or_else(|| "give a number of pixels from 1e-6 to 1e6, like 0.5".into())
}

pub fn assignment(text: &str) -> Result<(String, String), String> {
    let (key, value) = text
        .split_once('=')
        .filter(|(key, _)| !key.trim().is_empty())
        .ok_or("write KEY=VALUE, for instance --set \"camera.time=3 m\"")?;
    Ok((key.trim().into(), value.trim().into()))
}

pub fn bytes(text: &str) -> Result<u64, String> {
    let digits = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let unit = match text[digits.len()..].to_ascii_lowercase().as_str() {
        "" | "b" => 1,
        "k" | "kb" | "kib" => 1 << 10,
        "m" | "mb" | "mib" => 1 << 20,
        "g" | "gb" | "gib" => 1 << 30,
        "t" | "tb" | "tib" => 1 << 40,
        other => return Err(format!("\"{other}\" is no unit of memory; write 16GiB")),
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

/// A number of seconds, up to a month.
pub fn seconds(text: &str) -> Result<f64, String> {
    let seconds = text.trim().parse::<f64>().ok();
    let seconds = seconds.filter(|seconds| (0.0..=2.6e6).contains(seconds));
    seconds.ok_or_else(|| "a number of seconds, like 60".into())
}

pub fn aovs(text: &str) -> Result<AovList, String> {
    aov::parse(text).map(AovList)
}

/// What visibility is worth.
pub fn precision(text: &str) -> Result<Precision, String> {
    let known = Precision::ALL.into_iter().find(|p| p.name() == text);
    known.ok_or_else(|| "write certified, or fast".into())
}

/// A percentage; a bare number is one too.
pub fn percentage(text: &str) -> Result<String, String> {
    let text = match text.trim().parse::<f64>() {
        Ok(number) => format!("{number} %"),
        Err(_) => text.into(),
    };
    let parsed = text.parse::<Percentage>();
    parsed.map(|_| text).map_err(|error| error.to_string())
}

/// Frames A to B, B not included.
pub fn frames(text: &str) -> Result<Range<u64>, String> {
    let help = "write the first frame and the one after the last, for instance 0..50";
    let (first, end) = text.split_once("..").ok_or(help)?;
    let number = |t: &str| t.trim().parse::<u32>().map(u64::from);
    match (number(first), number(end)) {
        (Ok(first), Ok(end)) if first < end => Ok(first..end),
        (Ok(first), Ok(end)) => Err(format!(
            "{first}..{end} holds no frame: the second number is that of the first frame that is not rendered"
        )),
        _ => Err(format!(
            "frames have whole numbers from 0 to {}; {help}",
            u32::MAX
        )),
    }
}

/// Frames per second.
pub fn rate(text: &str) -> Result<f64, String> {
    let rate = text.trim().parse::<f64>();
    let rate = rate.ok().filter(|r| r.is_finite() && *r > 0.0);
    rate.ok_or_else(|| "give a number above 0, like 25 or 1e9".into())
}

/// Parsed `--transfer`.
#[derive(Debug, Clone, Copy)]
pub struct Transfer(pub Encoding);

/// Parsed `--nan`.
#[derive(Debug, Clone, Copy)]
pub struct Policy(pub NotFinite);

pub fn transfer(text: &str) -> Result<Transfer, String> {
    match text {
        "srgb" => Ok(Transfer(Encoding::Srgb)),
        "linear" => Ok(Transfer(Encoding::Linear)),
        _ => Err("write srgb or linear".into()),
    }
}

pub fn nan(text: &str) -> Result<Policy, String> {
    let help = "write refuse, ignore, or count-as=VALUE";
    let policy = match text.split_once('=') {
        None if text == "refuse" => NotFinite::Refuse,
        None if text == "ignore" => NotFinite::Ignore,
        Some(("count-as", value)) => {
            let value = value.trim().parse::<f64>().ok().filter(|v| v.is_finite());
            NotFinite::CountAs(value.ok_or(help)?)
        }
        _ => return Err(help.into()),
    };
    Ok(Policy(policy))
}

pub fn crop(text: &str) -> Result<[u32; 4], String> {
    let numbers: Option<Vec<u32>> = text.split(',').map(|n| n.trim().parse().ok()).collect();
    let numbers = numbers.and_then(|n| <[u32; 4]>::try_from(n).ok());
    numbers.ok_or_else(|| "write X,Y,WIDTH,HEIGHT in pixels, for instance 100,50,64,64".into())
}

pub fn ppd(text: &str) -> Result<f64, String> {
    let number = text.trim().parse::<f64>().ok();
    let number = number.filter(|n| (1.0..=1000.0).contains(n));
    number.ok_or_else(|| "a number from 1 to 1000".into())
}
