//! Pictures from files: EXR, PNG, npy, npz, told apart by their names.

use std::path::Path;

use super::{Encoding, Picture};
use crate::error::{Error, Result};
use crate::io::image::{Channel, Layers, Samples, exr, png};
use crate::io::npy::{self, Numbers, Plain};

impl Picture {
    /// Reads a picture. `png` says what the codes of a PNG file are; other files hold linear light.
    ///
    /// An array of shape (H, W, 3) named `radiance`, or alone in its file, is `radiance.R`, `.G`, `.B`; one of shape
    /// (H, W) is a channel of its own name, `value` in a `.npy` file.
    ///
    /// # Errors
    /// What the readers of images and arrays refuse; names that do not end in .exr, .png, .npz or .npy; arrays of other shapes.
    pub fn read(path: &Path, png: Encoding) -> Result<Picture> {
        let extension = path
            .extension()
            .map(|e| e.to_string_lossy().to_ascii_lowercase());
        let name = path.display().to_string();
        match extension.as_deref() {
            Some("exr") => Ok(Picture {
                half: exr::half_channels(path)?,
                ..Picture::linear(name, exr::read(path)?)
            }),
            Some("png") => Ok(Picture {
                encoding: png,
                ..Picture::linear(name, png::read(path)?)
            }),
            Some("npz" | "npy") => Ok(Picture::linear(name, arrays(path)?)),
            _ => Err(Error::unsupported(
                path,
                "",
                "the name does not say which kind of picture this is",
                "a name that ends in .exr, .png, .npz or .npy",
            )),
        }
    }
}

fn arrays(path: &Path) -> Result<Layers> {
    let headers = npy::inspect(path, None)?;
    let mut metadata = Vec::new();
    let mut parts: Vec<([usize; 2], Vec<Channel>)> = Vec::new();
    for header in &headers {
        let name = header.name.as_deref();
        match name {
            Some("metadata") => metadata = entries(&npy::load_text(path, "metadata")?),
            _ => parts.push(channels(path, name, npy::load_plain(path, name)?)?),
        }
    }
    let Some([height, width]) = parts.first().map(|part| part.0) else {
        return Err(Error::invalid(path, "", "it holds no array of numbers", ""));
    };
    if let Some((other, channels)) = parts.iter().find(|part| part.0 != [height, width]) {
        let what = format!(
            "it has {} × {} pixels, and another array has {width} × {height}",
            other[1], other[0]
        );
        return Err(Error::invalid(
            path,
            format!("array {}", channels[0].name),
            what,
            "arrays of one picture have one size",
        ));
    }
    let side = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
    let channels = parts.into_iter().flat_map(|part| part.1).collect();
    Layers::new(side(width), side(height), channels, metadata)
}

/// Keys and values of the metadata's JSON.
fn entries(json: &str) -> Vec<(String, String)> {
    let object: serde_json::Map<String, serde_json::Value> =
        serde_json::from_str(json).unwrap_or_default();
    let text = |value: serde_json::Value| value.as_str().map(String::from);
    object
        .into_iter()
        .filter_map(|(key, value)| Some((key, text(value)?)))
        .collect()
}

/// The channels that an array is, with its rows and columns.
fn channels(path: &Path, name: Option<&str>, array: Plain) -> Result<([usize; 2], Vec<Channel>)> {
    let samples = match array.samples {
        Numbers::F32(v) => Samples::F32(v),
        Numbers::F64(v) => Samples::F64(v),
        Numbers::I32(v) => Samples::I32(v),
        Numbers::U32(v) => Samples::U32(v),
    };
    match (array.shape.as_slice(), name) {
        (&[height, width], name) => Ok((
            [height, width],
            vec![Channel {
                name: name.unwrap_or("value").into(),
                samples,
            }],
        )),
        (&[height, width, 3], None | Some("radiance")) => {
            let channel = |k: usize| Channel {
                name: super::RADIANCE[k].into(),
                samples: every_third(&samples, k),
            };
            Ok(([height, width], (0..3).map(channel).collect()))
        }
        (shape, name) => {
            let place = name.map_or(String::new(), |name| format!("array {name:?}"));
            let what = format!("an array of shape {shape:?} is no picture");
            Err(Error::unsupported(
                path,
                place,
                what,
                "(H, W), or (H, W, 3) for the array \"radiance\"",
            ))
        }
    }
}

fn every_third(samples: &Samples, first: usize) -> Samples {
    fn part<T: Copy>(v: &[T], first: usize) -> Vec<T> {
        v.iter().skip(first).step_by(3).copied().collect()
    }
    match samples {
        Samples::F32(v) => Samples::F32(part(v, first)),
        Samples::F64(v) => Samples::F64(part(v, first)),
        Samples::U32(v) => Samples::U32(part(v, first)),
        Samples::I32(v) => Samples::I32(part(v, first)),
    }
}
