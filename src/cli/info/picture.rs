//! The contents of a picture.

use std::f64::consts::TAU;
use std::path::Path;

use nullray::Result;
use nullray::io::budget::Budget;
use nullray::io::cube;
use nullray::io::image::{self, Channel, Layers, Samples, panorama};
use nullray::render::aov::Aov;
use serde_json::{Value, json};

use super::Info;

pub fn exr(path: &Path, memory: u64) -> Result<Info> {
    let layers = image::exr::read(path, &Budget::new(memory))?;
    let half = image::exr::half_channels(path)?;
    let mut info = Info::new("exr", "OpenEXR picture");
    size(&mut info, layers.width, layers.height);
    info.row("channels", layers.channels.len().to_string());
    // As in the table of channels, after the radiance; a file has them by name.
    let mut channels: Vec<&Channel> = layers.channels.iter().collect();
    channels.sort_by_key(|channel| place(&channel.name));
    let channels = channels.into_iter().map(|channel| {
        let (name, range, kind) = (
            &channel.name,
            Range::of(channel),
            match half.contains(&channel.name) {
                true => "f16",
                false => precision(&channel.samples),
            },
        );
        info.row("", format!("{name:<24} {kind:<6} {range}"));
        json!({
            "name": name,
            "type": kind,
            "least": range.least,
            "greatest": range.greatest,
            "not_finite": range.not_finite,
        })
    });
    let channels: Vec<Value> = channels.collect();
    info.data("channels", channels);
    if is_sky(&layers) {
        info.row("usable", "as the image of a [sky]");
    }
    info.metadata(&layers.metadata);
    Ok(info)
}

/// The place of a channel among those that nullray knows; others come after them.
fn place(name: &str) -> usize {
    let radiance = ["radiance.R", "radiance.G", "radiance.B"].into_iter();
    let mut known = radiance.chain(Aov::ALL.iter().map(|aov| aov.name()));
    known.position(|known| known == name).unwrap_or(usize::MAX)
}

/// Whether this may be a panorama of the whole sky; of pictures of scenes the metadata say it.
fn is_sky(layers: &Layers) -> bool {
    let said = |key: &str| {
        let mut all = layers.metadata.iter();
        all.find(|(said, _)| said == key)
            .map(|(_, value)| value.as_str())
    };
    let angle = said("camera_horizontal_fov_rad").and_then(|angle| angle.parse::<f64>().ok());
    let is_whole = match (said("camera_projection"), angle) {
        (None, None) => true,
        // The angle is that of a text in degrees.
        (projection, angle) => projection == Some("equirectangular") && angle >= Some(0.999 * TAU),
    };
    let is_light = |x: &f64| (0.0..f64::INFINITY).contains(x);
    let radiance = layers.radiance();
    let has_light = radiance.is_some_and(|pixels| pixels.iter().flatten().all(is_light));
    is_whole && has_light && layers.width == 2 * layers.height
}

pub fn png(path: &Path) -> Result<Info> {
    let held = image::png::inspect(path)?;
    image::png::check_whole(path)?;
    let mut info = Info::new("png", "PNG picture");
    size(&mut info, held.width, held.height);
    let samples = format!("{}, {} bits each", held.colour, held.bits);
    info.fact("samples", samples, "colour", held.colour);
    info.data("bits", held.bits);
    info.metadata(&held.text);
    Ok(info)
}

/// A picture of another format that can be used as a frame.
pub fn frame(path: &Path, name: &str, memory: u64) -> Result<Info> {
    let [width, height, channels] = cube::frame_size(path, memory)?;
    let mut info = Info::new("frame", name);
    size(&mut info, width as u32, height as u32);
    let colours = if channels == 1 {
        "grey"
    } else {
        "red, green, blue"
    };
    info.fact(
        "channels",
        format!("{channels} ({colours})"),
        "channels",
        channels,
    );
    let count = cube::frame_count(path)?;
    // A panorama of the whole sky is twice as wide as high.
    let is_sky = panorama::is_hdr(path) && width == 2 * height;
    let usable = match count {
        1 if is_sky => {
            "as the image of a [sky], and as one of a folder of numbered pictures, which is the file of a [source.cube]"
        }
        1 => "as one of a folder of numbered pictures, which is the file of a [source.cube]",
        _ => "as the file of a [source.cube] with axes = \"T H W\"",
    };
    if count > 1 {
        info.fact(
            "pictures",
            format!("{count}, of one size"),
            "pictures",
            count,
        );
    }
    info.row("usable", usable);
    Ok(info)
}

fn size(info: &mut Info, width: u32, height: u32) {
    let text = format!("{width} × {height} pixels");
    info.fact("size", text, "width", width);
    info.data("height", height);
}

fn precision(samples: &Samples) -> &'static str {
    match samples {
        Samples::F32(_) => "f32",
        Samples::F64(_) => "f64",
        Samples::U32(_) => "u32",
        Samples::I32(_) => "i32",
    }
}

/// The range of finite values of a channel.
struct Range {
    /// `None` if no value is finite.
    least: Option<f64>,
    greatest: Option<f64>,
    /// The number of values that are NaN or infinite.
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
