//! A picture to compare: its file, what its values are, and its channels as rows of numbers.

use std::path::Path;

use serde::Serialize;

use crate::error::{Error, Result};
use crate::io::budget::Budget;
use crate::io::image::{Channel, Layers, Samples, exr, png};
use crate::io::npy::{self, Numbers, Plain};
use crate::render::aov::Aov;

/// The channels of light, in this order.
pub(super) const RADIANCE: [&str; 3] = ["radiance.R", "radiance.G", "radiance.B"];

/// Whether the channel is one of the light's.
pub(super) fn is_light(name: &str) -> bool {
    name.starts_with("radiance.")
}

/// Whether the channel is auxiliary: NaN in it says that no surface is met.
pub(super) fn is_auxiliary(name: &str) -> bool {
    Aov::named(name).is_some()
}

/// Whether the channel holds indices, whose differences mean nothing.
pub(super) fn is_identity(channel: &Channel) -> bool {
    Aov::named(&channel.name).is_some_and(Aov::is_identity)
}

/// What the values of a picture's light are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Encoding {
    /// Proportional to light, of any range.
    Linear,
    /// sRGB codes in [0, 1], as a display shows them. Errors are errors of codes; ꟻLIP decodes them.
    Srgb,
}

/// A picture and what is known of its file.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// For messages: the name of its file.
    pub name: String,
    /// What its light's values are.
    pub encoding: Encoding,
    /// Channels and metadata.
    pub layers: Layers,
    /// Channels that the file holds in half precision, which ends at 65504.
    pub half: Vec<String>,
}

/// Who made a picture, by its metadata.
pub(super) const METHOD: &str = "method";
/// Values of [`METHOD`] of ray-traced pictures, which need not say it.
const RAY_TRACED: [&str; 2] = ["nullray", "trace"];

impl Picture {
    /// A picture of linear light.
    pub fn linear(name: impl Into<String>, layers: Layers) -> Self {
        Picture {
            name: name.into(),
            encoding: Encoding::Linear,
            layers,
            half: Vec::new(),
        }
    }

    /// The value of a metadata entry.
    pub fn metadata(&self, key: &str) -> Option<&str> {
        let mut entries = self.layers.metadata.iter();
        entries
            .find(|(k, _)| k == key)
            .map(|(_, value)| value.as_str())
    }

    /// How the picture was made where that was an approximation (`method = "raster:uniform=0.05"`); none for one that
    /// was ray-traced, or says nothing of it.
    pub fn approximation(&self) -> Option<&str> {
        self.metadata(METHOD)
            .filter(|method| !RAY_TRACED.contains(method))
    }

    /// Whether the picture says that this program made it by tracing rays.
    pub(super) fn is_ray_traced(&self) -> bool {
        let ours = self
            .metadata("software")
            .is_some_and(|s| s.starts_with("nullray"));
        ours && self.approximation().is_none()
    }
}

/// One channel of a picture.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plane<'a> {
    samples: &'a Samples,
    width: usize,
}

impl<'a> Plane<'a> {
    pub fn new(layers: &'a Layers, channel: &'a Channel) -> Self {
        Plane {
            samples: &channel.samples,
            width: layers.width as usize,
        }
    }

    /// The channel of this name, where there is one.
    pub fn find(layers: &'a Layers, name: &str) -> Option<Self> {
        Some(Plane::new(layers, layers.channel(name)?))
    }

    /// Three channels of one group, in the order of `components`.
    pub fn group(layers: &'a Layers, names: [&str; 3]) -> Option<[Self; 3]> {
        let [a, b, c] = names.map(|name| Plane::find(layers, name));
        Some([a?, b?, c?])
    }

    /// A sample as f64.
    #[inline]
    pub fn at(&self, index: usize) -> f64 {
        match self.samples {
            Samples::F32(v) => v[index].into(),
            Samples::F64(v) => v[index],
            Samples::U32(v) => v[index].into(),
            Samples::I32(v) => v[index].into(),
        }
    }

    /// Whether all samples are finite.
    pub fn is_finite(&self) -> bool {
        match self.samples {
            Samples::F32(v) => v.iter().all(|x| x.is_finite()),
            Samples::F64(v) => v.iter().all(|x| x.is_finite()),
            Samples::U32(_) | Samples::I32(_) => true,
        }
    }

    /// Row `y` as f64, into `row`.
    pub fn row(&self, y: usize, row: &mut Vec<f64>) {
        let span = y * self.width..(y + 1) * self.width;
        row.clear();
        match self.samples {
            Samples::F32(v) => row.extend(v[span].iter().map(|&x| f64::from(x))),
            Samples::F64(v) => row.extend_from_slice(&v[span]),
            Samples::U32(v) => row.extend(v[span].iter().map(|&x| f64::from(x))),
            Samples::I32(v) => row.extend(v[span].iter().map(|&x| f64::from(x))),
        }
    }

    /// Columns `x` of row `y`, rounded to f32, into `row`.
    pub fn part(&self, y: usize, x: std::ops::Range<usize>, row: &mut [f32]) {
        let span = y * self.width + x.start..y * self.width + x.end;
        match self.samples {
            Samples::F32(v) => row.copy_from_slice(&v[span]),
            Samples::F64(v) => fill(row, &v[span], |x| x as f32),
            Samples::U32(v) => fill(row, &v[span], |x| x as f32),
            Samples::I32(v) => fill(row, &v[span], |x| x as f32),
        }
    }

    /// Whether samples were rounded to single precision.
    pub fn is_single(&self) -> bool {
        matches!(self.samples, Samples::F32(_))
    }
}

fn fill<T: Copy>(row: &mut [f32], samples: &[T], convert: impl Fn(T) -> f32) {
    for (to, from) in row.iter_mut().zip(samples) {
        *to = convert(*from);
    }
}

impl Picture {
    /// Reads a picture. `png` says what the codes of a PNG file are; other files hold linear light.
    ///
    /// An array of shape (H, W, 3) named `radiance`, or alone in its file, is `radiance.R`, `.G`, `.B`; one of shape
    /// (H, W) is a channel of its own name, `value` in a `.npy` file.
    ///
    /// # Errors
    /// What the readers of images and arrays refuse; more than `budget` has memory for; names that do not end in .exr, .png, .npz or .npy; arrays of other shapes.
    pub fn read(path: &Path, png: Encoding, budget: &Budget) -> Result<Picture> {
        let extension = path
            .extension()
            .map(|e| e.to_string_lossy().to_ascii_lowercase());
        let name = path.display().to_string();
        match extension.as_deref() {
            Some("exr") => Ok(Picture {
                half: exr::half_channels(path)?,
                ..Picture::linear(name, exr::read(path, budget)?)
            }),
            Some("png") => Ok(Picture {
                encoding: png,
                ..Picture::linear(name, png::read(path, budget)?)
            }),
            Some("npz" | "npy") => Ok(Picture::linear(name, arrays(path, budget)?)),
            _ => Err(Error::unsupported(
                path,
                "",
                "the name does not say which kind of picture this is",
                "a name that ends in .exr, .png, .npz or .npy",
            )),
        }
    }
}

fn arrays(path: &Path, budget: &Budget) -> Result<Layers> {
    let headers = npy::inspect(path, None)?;
    let mut metadata = Vec::new();
    let mut parts: Vec<([usize; 2], Vec<Channel>)> = Vec::new();
    for header in &headers {
        let name = header.name.as_deref();
        match name {
            Some("metadata") => metadata = entries(&npy::load_text(path, "metadata", budget)?),
            _ => parts.push(channels(path, name, npy::load_plain(path, name, budget)?)?),
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
                name: RADIANCE[k].into(),
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
