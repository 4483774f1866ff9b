//! Named channels of one size, in the precision in which they were computed.

use std::collections::HashSet;
use std::path::Path;

use crate::error::{Error, Result};

/// The longest name of a channel, bytes (the EXR format's limit).
const MAX_NAME: usize = 255;
/// The longest key of a metadata entry, bytes (the PNG format's limit).
const MAX_KEY: usize = 79;

/// The data of a frame per pixel, and its metadata.
///
/// Channel names have the dotted form `layer.component`: `radiance.R`, `event.ct`, or just `object` if a layer has one component. Row 0 is
/// the top row; samples are in row-major order.
#[derive(Debug, Clone, PartialEq)]
pub struct Layers {
    /// Pixels per row, at least 1.
    pub width: u32,
    /// Rows, at least 1.
    pub height: u32,
    /// The channels, with unique names.
    pub channels: Vec<Channel>,
    /// Keys and values for the file's header: keys unique, printable ASCII; values free of NUL.
    pub metadata: Vec<(String, String)>,
}

/// One number per pixel.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// `layer.component`.
    pub name: String,
    /// width · height samples.
    pub samples: Samples,
}

/// Samples in the precision in which they were computed.
#[derive(Debug, Clone, PartialEq)]
pub enum Samples {
    /// Single precision.
    F32(Vec<f32>),
    /// Double precision.
    F64(Vec<f64>),
    /// Counts.
    U32(Vec<u32>),
    /// Identifiers; −1 if there is none.
    I32(Vec<i32>),
}

impl Layers {
    /// Checked layers: a size above 0, one sample per pixel in every channel, unique names and keys.
    ///
    /// # Errors
    /// Layers that violate this.
    pub fn new(
        width: u32,
        height: u32,
        channels: Vec<Channel>,
        metadata: Vec<(String, String)>,
    ) -> Result<Self> {
        let layers = Layers {
            width,
            height,
            channels,
            metadata,
        };
        layers.check()?;
        Ok(layers)
    }

    /// Checks the guarantees of [`Layers::new`]; every writer calls it.
    ///
    /// # Errors
    /// As for [`Layers::new`].
    pub fn check(&self) -> Result<()> {
        let pixels = pixel_count(self.width, self.height)?;
        let mut names = HashSet::new();
        for channel in &self.channels {
            check_channel(channel, pixels)?;
            if !names.insert(channel.name.as_str()) {
                return Err(wrong(&channel.name, "two channels have this name"));
            }
        }
        let mut keys = HashSet::new();
        for (key, value) in &self.metadata {
            check_metadata(key, value)?;
            if !keys.insert(key.as_str()) {
                return Err(wrong(key, "two metadata entries have this key"));
            }
        }
        Ok(())
    }

    /// Refuses channels that do not have one sample per pixel.
    pub(crate) fn check_lengths(&self) -> Result<()> {
        let pixels = pixel_count(self.width, self.height)?;
        let mut channels = self.channels.iter();
        channels.try_for_each(|channel| check_length(channel, pixels))
    }

    /// The channel with this name.
    pub fn channel(&self, name: &str) -> Option<&Channel> {
        self.channels.iter().find(|channel| channel.name == name)
    }

    /// The only channel other than alpha and depth, of a picture without colours; `None` if there are none or several.
    pub fn grey(&self) -> Option<&Channel> {
        // These are stored beside a radiance, but measure something else.
        let others = ["A", "alpha", "Z", "distance"];
        let mut grey = (self.channels.iter()).filter(|c| !others.contains(&c.name.as_str()));
        grey.next().filter(|_| grey.next().is_none())
    }

    /// The pixels of `radiance.R`, `radiance.G`, `radiance.B`; `None` if one of them is missing.
    pub fn radiance(&self) -> Option<Vec<[f64; 3]>> {
        let r = self.channel("radiance.R")?.samples.to_f64();
        let g = self.channel("radiance.G")?.samples.to_f64();
        let b = self.channel("radiance.B")?.samples.to_f64();
        let rgb = r.into_iter().zip(g).zip(b);
        Some(rgb.map(|((r, g), b)| [r, g, b]).collect())
    }
}

impl Samples {
    /// The number of samples.
    pub fn len(&self) -> usize {
        match self {
            Samples::F32(v) => v.len(),
            Samples::F64(v) => v.len(),
            Samples::U32(v) => v.len(),
            Samples::I32(v) => v.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// All samples as f64, exact for every kind.
    pub fn to_f64(&self) -> Vec<f64> {
        match self {
            Samples::F32(v) => v.iter().map(|&x| x.into()).collect(),
            Samples::F64(v) => v.clone(),
            Samples::U32(v) => v.iter().map(|&x| x.into()).collect(),
            Samples::I32(v) => v.iter().map(|&x| x.into()).collect(),
        }
    }
}

/// width · height, if both are above 0 and the product is addressable.
pub(super) fn pixel_count(width: u32, height: u32) -> Result<usize> {
    let pixels = (width as usize).checked_mul(height as usize);
    // 16 bytes per pixel must be addressable too: the most that a writer needs.
    match pixels.filter(|&n| n > 0 && n <= isize::MAX as usize / 16) {
        Some(pixels) => Ok(pixels),
        None => Err(wrong(
            "",
            format!("a size of {width} × {height} pixels cannot be held"),
        )),
    }
}

fn check_channel(channel: &Channel, pixels: usize) -> Result<()> {
    let name = &channel.name;
    if name.is_empty() || name.len() > MAX_NAME || name.contains(char::is_control) {
        let what = "a channel's name has 1 to 255 bytes and no control characters";
        return Err(wrong(&format!("{name:?}"), what));
    }
    check_length(channel, pixels)
}

fn check_length(channel: &Channel, pixels: usize) -> Result<()> {
    match channel.samples.len() {
        count if count == pixels => Ok(()),
        count => {
            let what = format!("{count} samples for {pixels} pixels");
            Err(wrong(&channel.name, what))
        }
    }
}

/// Whether every format can hold this entry.
pub(super) fn check_metadata(key: &str, value: &str) -> Result<()> {
    let graphic = key.bytes().all(|b| b.is_ascii_graphic());
    if key.is_empty() || key.len() > MAX_KEY || !graphic {
        let what = "a metadata key has 1 to 79 characters, printable ASCII without spaces";
        return Err(wrong(&format!("{key:?}"), what));
    }
    if value.contains('\0') {
        return Err(wrong(key, "a metadata value cannot hold a NUL character"));
    }
    Ok(())
}

/// The maximum number of metadata entries of a file.
const MOST_ENTRIES: usize = 10_000;

/// Refuses a file with too many metadata entries.
pub(super) fn check_count(path: &Path, entries: usize) -> Result<()> {
    if entries <= MOST_ENTRIES {
        return Ok(());
    }
    let what = format!("it has {entries} texts of metadata");
    let help = format!("a picture with at most {MOST_ENTRIES}");
    Err(Error::unsupported(path, "", what, help))
}

/// Keeps only the first entry of each key.
pub(super) fn keep_first(metadata: &mut Vec<(String, String)>) {
    let mut known = HashSet::new();
    let is_new: Vec<bool> = (metadata.iter())
        .map(|(key, _)| known.insert(key.as_str()))
        .collect();
    let mut is_new = is_new.into_iter();
    metadata.retain(|_| is_new.next() == Some(true));
}

fn wrong(place: &str, what: impl Into<String>) -> Error {
    Error::invalid("image", place, what, "")
}

/// An 8-bit sRGB image, row 0 at the top.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RgbImage {
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// 3·width·height bytes.
    pub rgb: Vec<u8>,
}

#[cfg(test)]
mod tests;
