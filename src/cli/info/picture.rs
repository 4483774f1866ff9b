//! What a picture holds.

use std::path::Path;

use nullray::Result;
use nullray::io::image::{self, Channel, Samples};
use serde_json::{Map, Value, json};

use super::{Info, Sheet};

pub fn exr(path: &Path) -> Result<Info> {
    let layers = image::exr::read(path)?;
    let mut sheet = Sheet::new();
    sheet.row(
        "size",
        format!("{} × {} pixels", layers.width, layers.height),
    );
    sheet.row("channels", layers.channels.len().to_string());
    let ranges: Vec<Range> = layers.channels.iter().map(Range::of).collect();
    for (channel, range) in layers.channels.iter().zip(&ranges) {
        sheet.row(
            "",
            format!(
                "{:<24} {:<6} {range}",
                channel.name,
                precision(&channel.samples)
            ),
        );
    }
    sheet.metadata(&layers.metadata);
    let channels = layers.channels.iter().zip(&ranges).map(|(channel, range)| {
        json!({
            "name": channel.name,
            "type": precision(&channel.samples),
            "least": range.least,
            "greatest": range.greatest,
            "not_finite": range.not_finite,
        })
    });
    let data = json!({
        "kind": "exr",
        "width": layers.width,
        "height": layers.height,
        "channels": channels.collect::<Vec<_>>(),
        "metadata": map(&layers.metadata),
    });
    Info::new(path, "OpenEXR picture", sheet, &data)
}

pub fn png(path: &Path) -> Result<Info> {
    let held = image::png::inspect(path)?;
    let mut sheet = Sheet::new();
    sheet.row("size", format!("{} × {} pixels", held.width, held.height));
    sheet.row(
        "samples",
        format!("{}, {} bits each", held.colour, held.bits),
    );
    sheet.metadata(&held.text);
    let data = json!({
        "kind": "png",
        "width": held.width,
        "height": held.height,
        "colour": held.colour,
        "bits": held.bits,
        "metadata": map(&held.text),
    });
    Info::new(path, "PNG picture", sheet, &data)
}

fn map(entries: &[(String, String)]) -> Map<String, Value> {
    let entries = entries.iter();
    entries
        .map(|(k, v)| (k.clone(), v.clone().into()))
        .collect()
}

fn precision(samples: &Samples) -> &'static str {
    match samples {
        Samples::F32(_) => "f32",
        Samples::F64(_) => "f64",
        Samples::U32(_) => "u32",
        Samples::I32(_) => "i32",
    }
}

/// The finite values of a channel.
struct Range {
    /// None where no value is finite.
    least: Option<f64>,
    greatest: Option<f64>,
    /// How many values are NaN or infinite.
    not_finite: usize,
}

impl Range {
    fn of(channel: &Channel) -> Range {
        let values = channel.samples.to_f64();
        let finite = || values.iter().copied().filter(|v| v.is_finite());
        Range {
            least: finite().reduce(f64::min),
            greatest: finite().reduce(f64::max),
            not_finite: values.len() - finite().count(),
        }
    }
}

impl std::fmt::Display for Range {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match (self.least, self.greatest) {
            (Some(least), Some(greatest)) => {
                write!(f, "{} to {}", number(least), number(greatest))?
            }
            _ => write!(f, "no finite value")?,
        }
        match self.not_finite {
            0 => Ok(()),
            n => write!(f, " ({n} NaN or infinite)"),
        }
    }
}

/// A number in a few digits, whatever its magnitude.
fn number(x: f64) -> String {
    match x.abs() {
        0.0 => "0".into(),
        size if (1e-3..1e7).contains(&size) && x.fract() == 0.0 => format!("{x}"),
        size if (1e-3..1e7).contains(&size) => format!("{x:.6}"),
        _ => format!("{x:.6e}"),
    }
}
