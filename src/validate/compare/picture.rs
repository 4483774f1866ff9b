//! A picture to compare: its file, the meaning of its values, and its channels as rows of numbers.

use std::path::Path;

use serde::Serialize;

use crate::error::{Error, Result};
use crate::io::budget::Budget;
use crate::io::image::{Channel, Layers, Samples, exr, png};
use crate::io::npy::{self, Header, Numbers, Plain};
use crate::render::aov::{self, Aov};

/// The channels of light, in this order.
pub(super) const RADIANCE: [&str; 3] = ["radiance.R", "radiance.G", "radiance.B"];

/// Names of a channel of grey light.
const GREY: [&str; 5] = ["radiance", "value", "arr_0", "Y", "luminance"];

/// Whether this is a channel of light.
pub(super) fn is_light(name: &str) -> bool {
    name.starts_with("radiance.")
}

/// Whether the channel is auxiliary: NaN in it means no hit.
pub(super) fn is_auxiliary(name: &str) -> bool {
    Aov::named(name).is_some()
}

/// Whether the channel holds indices, whose differences are meaningless.
pub(super) fn is_identity(channel: &Channel) -> bool {
    Aov::named(&channel.name).is_some_and(Aov::is_identity)
}

/// The encoding of a picture's light.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Encoding {
    /// Linear light, of any range.
    Linear,
    /// sRGB codes in [0, 1], as a display shows them. Errors are errors of codes; ꟻLIP decodes them.
    Srgb,
}

/// A picture with facts about its file.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// The name of its file, for messages.
    pub name: String,
    /// The encoding of its light.
    pub encoding: Encoding,
    /// Channels and metadata.
    pub layers: Layers,
    /// Channels that the file stores in half precision, with a maximum of 65504.
    pub half: Vec<String>,
    /// Whether its light is multiplied by alpha.
    pub alpha: Alpha,
    /// Whether its values are limited to 1, like those of a `.png`.
    pub ends_at_one: bool,
    /// Arrays of its file that are not channels: a camera's matrix, a frame rate, motion vectors.
    pub unread: Vec<String>,
    /// The only array of its file, if it is taken for light whatever its name is.
    pub taken_for_light: Option<String>,
}

/// Whether light is multiplied by alpha.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Alpha {
    /// Yes, as OpenEXR requires.
    Premultiplied,
    /// No, as PNG requires.
    Straight,
    /// Not stated.
    Unknown,
}

/// The metadata key of the method that made a picture.
pub(super) const METHOD: &str = "method";
/// Values of [`METHOD`] of ray-traced pictures, which may omit it.
const RAY_TRACED: [&str; 2] = ["nullray", "trace"];

impl Picture {
    /// A picture of linear light.
    pub fn linear(name: impl Into<String>, layers: Layers) -> Self {
        Picture {
            name: name.into(),
            encoding: Encoding::Linear,
            layers,
            half: Vec::new(),
            alpha: Alpha::Unknown,
            ends_at_one: false,
            unread: Vec::new(),
            taken_for_light: None,
        }
    }

    /// Whether its values are light of any range rather than display values.
    pub(super) fn is_high_range(&self) -> bool {
        self.encoding == Encoding::Linear && !self.ends_at_one
    }

    /// The picture in colour, if it is grey and `other` has red, green and blue: grey stands for equal amounts of each, as in a cube with
    /// one channel. A channel is grey if it is named like light, or the only one.
    pub(super) fn in_colours(&self, other: &Picture) -> Option<Picture> {
        let channels = &self.layers.channels;
        let is_named = |channel: &&Channel| GREY.contains(&channel.name.as_str());
        let mut named = channels.iter().filter(is_named);
        let grey = match (named.next(), named.next(), channels.as_slice()) {
            (Some(grey), None, _) => grey,
            (None, _, [only]) if !is_auxiliary(&only.name) && only.name != "A" => only,
            _ => return None,
        };
        let has_colours = channels.iter().any(|channel| is_light(&channel.name));
        let mut colours = RADIANCE.iter();
        if has_colours || !colours.all(|name| other.layers.channel(name).is_some()) {
            return None;
        }
        let mut picture = self.clone();
        picture.layers.channels = RADIANCE
            .map(|name| Channel {
                name: name.into(),
                samples: grey.samples.clone(),
            })
            .into_iter()
            .chain(
                self.layers
                    .channels
                    .iter()
                    .filter(|c| c.name != grey.name)
                    .cloned(),
            )
            .collect();
        if picture.half.contains(&grey.name) {
            picture.half.extend(RADIANCE.map(String::from));
        }
        Some(picture)
    }

    /// The picture with its alpha named as that of `other`, if only the names differ: `A` is the fourth channel of light that is
    /// multiplied by it, and `alpha` the auxiliary channel. Opaque alpha says nothing, and keeps its name.
    pub(super) fn with_alpha_named_as_in(&self, other: &Picture) -> Option<Picture> {
        let named = |picture: &Picture| ["A", "alpha"].map(|n| picture.layers.channel(n).is_some());
        let differs = named(self) == [true, false] && named(other) == [false, true];
        (differs && self.alpha != Alpha::Straight).then_some(())?;
        let alpha = Plane::find(&self.layers, "A")?;
        let pixels = self.layers.width as usize * self.layers.height as usize;
        (0..pixels).any(|i| alpha.at(i) != 1.0).then_some(())?;
        let mut picture = self.clone();
        for channel in &mut picture.layers.channels {
            if channel.name == "A" {
                channel.name = "alpha".into();
            }
        }
        Some(picture)
    }

    /// The value of a metadata entry.
    pub fn metadata(&self, key: &str) -> Option<&str> {
        let mut entries = self.layers.metadata.iter();
        entries
            .find(|(k, _)| k == key)
            .map(|(_, value)| value.as_str())
    }

    /// The approximation that made the picture (`method = "raster:uniform=0.05"`); `None` if it was ray-traced, or does not say.
    pub fn approximation(&self) -> Option<&str> {
        self.metadata(METHOD)
            .filter(|method| !RAY_TRACED.contains(method))
    }

    /// Whether the metadata say that this program ray-traced the picture.
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

    /// The auxiliary channel, if it exists.
    pub fn aov(layers: &'a Layers, aov: Aov) -> Option<Self> {
        Plane::find(layers, aov.name())
    }

    /// Several auxiliary channels, if all of them exist.
    pub fn aovs<const N: usize>(layers: &'a Layers, aovs: [Aov; N]) -> Option<[Self; N]> {
        let planes = aovs.into_iter().map(|aov| Plane::aov(layers, aov));
        planes.collect::<Option<Vec<_>>>()?.try_into().ok()
    }

    /// The channel of this name, if it exists.
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

    /// Whether samples are stored in single precision.
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
    /// Reads a picture. `png` states the encoding of a PNG file; other files hold linear light.
    ///
    /// Arrays have the shape (H, W), or (H, W, n). One with n = 3 or 4 that is named `radiance`, or is the only one in its file, becomes
    /// `radiance.R`, `.G`, `.B` and `A`; one named like a group of auxiliary channels becomes these, in their order (`event` of shape (H,
    /// W, 4) is `event.ct`, `.x`, `.y`, `.z`); one with n = 1 counts as (H, W), and is a channel of its own name, `value` in a `.npy` file.
    /// Anything else in an archive (a camera's matrix, a frame rate, texts, motion vectors) is not read, and its names are kept in
    /// [`Picture::unread`]. In channels of identities in unsigned integers, the largest number of the type means no hit (255 in uint8),
    /// like −1 in others.
    ///
    /// # Errors
    /// Errors of the readers of images and arrays; pictures beyond the memory of `budget`; names that do not end in .exr, .png, .npz or
    /// .npy; arrays of other shapes.
    pub fn read(path: &Path, png: Encoding, budget: &Budget) -> Result<Picture> {
        let extension = path
            .extension()
            .map(|e| e.to_string_lossy().to_ascii_lowercase());
        let name = path.display().to_string();
        Ok(match extension.as_deref() {
            Some("exr") => Picture {
                half: exr::half_channels(path)?,
                alpha: Alpha::Premultiplied,
                ..Picture::linear(name, exr::read(path, budget)?)
            },
            Some("png") => Picture {
                encoding: png,
                alpha: Alpha::Straight,
                ends_at_one: true,
                ..Picture::linear(name, png::read(path, budget)?)
            },
            Some("npz" | "npy") => {
                let (layers, unread, taken_for_light) = arrays(path, budget)?;
                Picture {
                    unread,
                    taken_for_light,
                    ..Picture::linear(name, layers)
                }
            }
            _ if path.is_dir() => {
                return Err(Error::unsupported(
                    path,
                    "",
                    "this is a folder, not a picture",
                    "name one of its pictures, like frames/000.exr; a cube is compared bin by bin",
                ));
            }
            _ => {
                return Err(Error::unsupported(
                    path,
                    "",
                    "the name does not say which kind of picture this is",
                    "a name that ends in .exr, .png, .npz or .npy",
                ));
            }
        })
    }

    /// Makes `no_hit` mean no hit in channels of identities.
    pub fn set_no_hit(&mut self, no_hit: i64) {
        let channels = self.layers.channels.iter_mut();
        for channel in channels.filter(|channel| is_identity(channel)) {
            channel.samples = with_no_hit(&channel.samples, no_hit as f64);
        }
    }
}

/// Identities with `no_hit` replaced by −1.
fn with_no_hit(samples: &Samples, no_hit: f64) -> Samples {
    let id = |id: f64| if id == no_hit { -1.0 } else { id };
    Samples::F64(samples.to_f64().into_iter().map(id).collect())
}

/// The channels in the arrays of a file, the names of the other arrays, and that of an only array of another name that is light.
fn arrays(path: &Path, budget: &Budget) -> Result<(Layers, Vec<String>, Option<String>)> {
    let mut headers = npy::inspect(path, None)?;
    let is_metadata = |header: &Header| header.name.as_deref() == Some("metadata");
    let metadata = match headers.iter().any(is_metadata) {
        true => entries(&npy::load_text(path, "metadata", budget)?),
        false => Vec::new(),
    };
    headers.retain(|header| !is_metadata(header));
    // Our arrays must be right; of the others, those that are not channels of a picture of this size are skipped.
    let is_alone = headers.len() == 1;
    let ours = |header: &Header| is_alone || is_ours(header.name.as_deref());
    let size = headers.iter().find(|header| ours(header));
    let size = size.and_then(|header| pixels(&header.shape));
    let is_channel = |header: &Header| {
        let is_plane = matches!(*header.shape.as_slice(), [_, _] | [_, _, 1]);
        is_plane && header.dtype.is_number() && pixels(&header.shape) == size
    };
    let any = headers.iter().any(&ours);
    let (read, unread): (Vec<Header>, Vec<Header>) =
        (headers.into_iter()).partition(|header| !any || ours(header) || is_channel(header));
    let mut parts: Vec<([usize; 2], Vec<Channel>)> = Vec::new();
    for header in &read {
        let array = npy::load_plain(path, header.name.as_deref(), budget)?;
        // While the channels of an array are extracted, it is in memory twice.
        if header.shape.len() == 3 && header.shape[2] > 1 {
            let copied: u64 = array.shape.iter().map(|n| *n as u64).product();
            budget.take(copied.saturating_mul(array.samples.size()), path)?;
        }
        parts.push(channels(path, header, is_alone, array)?);
    }
    let Some([height, width]) = parts.first().map(|part| part.0) else {
        return Err(Error::invalid(
            path,
            "",
            "it holds no array of numbers",
            "arrays of shape (H, W), and (H, W, 3) for the array \"radiance\"",
        ));
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
    let layers = Layers::new(side(width), side(height), channels, metadata)?;
    let unread = unread.into_iter().filter_map(|header| header.name);
    let other = read.into_iter().filter_map(|header| header.name);
    let mut other =
        other.filter(|name| !is_ours(Some(name)) && layers.channel(RADIANCE[0]).is_some());
    let taken_for_light = other.next().filter(|_| is_alone);
    Ok((layers, unread.collect(), taken_for_light))
}

/// Whether an array of this name is light, an auxiliary channel, or a group of them.
fn is_ours(name: Option<&str>) -> bool {
    let Some(name) = name else {
        return true;
    };
    let is_light_or_alpha = is_light(name) || GREY.contains(&name) || name == "A";
    is_light_or_alpha || is_auxiliary(name) || !aov::group_of(name).is_empty()
}

/// Rows and columns of an array with one or more numbers per pixel.
fn pixels(shape: &[usize]) -> Option<[usize; 2]> {
    match *shape {
        [height, width] | [height, width, _] => Some([height, width]),
        _ => None,
    }
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

/// The channels of an array, which may be the only one of its file, with its rows and columns.
fn channels(
    path: &Path,
    header: &Header,
    is_alone: bool,
    array: Plain,
) -> Result<([usize; 2], Vec<Channel>)> {
    let name = header.name.as_deref();
    let samples = match array.samples {
        Numbers::F32(v) => Samples::F32(v),
        Numbers::F64(v) => Samples::F64(v),
        Numbers::I32(v) => Samples::I32(v),
        Numbers::U32(v) => Samples::U32(v),
    };
    let (size, depth) = match *array.shape.as_slice() {
        [height, width] => ([height, width], 1),
        [height, width, depth] => ([height, width], depth),
        _ => return Err(no_picture(path, name, &array.shape)),
    };
    let names = names(name, depth, is_alone).ok_or_else(|| no_picture(path, name, &array.shape))?;
    let channel = |(k, name): (usize, String)| {
        let mut channel = Channel {
            name,
            samples: every(&samples, depth, k),
        };
        // In unsigned integers −1 is the largest number of the type.
        if let (true, Some(largest)) = (is_identity(&channel), header.dtype.largest_unsigned()) {
            channel.samples = with_no_hit(&channel.samples, largest);
        }
        channel
    };
    Ok((size, names.into_iter().enumerate().map(channel).collect()))
}

/// The names of the channels in the array `name` with `depth` numbers per pixel.
fn names(name: Option<&str>, depth: usize, is_alone: bool) -> Option<Vec<String>> {
    let group = aov::group_of(name.unwrap_or(""));
    let light = matches!(name, None | Some("radiance" | "arr_0")) || (is_alone && group.is_empty());
    match depth {
        1 => Some(vec![name.unwrap_or("value").to_string()]),
        3 | 4 if light => {
            let names = RADIANCE.into_iter().chain(["A"]).take(depth);
            Some(names.map(String::from).collect())
        }
        _ if depth > 0 && group.len() == depth => {
            Some(group.iter().map(|aov| aov.name().into()).collect())
        }
        _ => None,
    }
}

fn no_picture(path: &Path, name: Option<&str>, shape: &[usize]) -> Error {
    let place = name.map_or(String::new(), |name| format!("array {name:?}"));
    let group: Vec<&str> = (aov::group_of(name.unwrap_or("")).iter())
        .map(|aov| aov.name())
        .collect();
    // A group whose array has fewer numbers than the group has channels, such as positions without times.
    if let ([first, others @ ..], [height, width, depth]) = (&group[..], shape)
        && !others.is_empty()
    {
        let all = group.join(", ");
        let missing = match others.len() == *depth {
            true => format!("; {first} is missing, if these are {}", others.join(", ")),
            false => String::new(),
        };
        let what = format!(
            "it has {depth} numbers per pixel, and stands for {} channels: {all}{missing}",
            group.len()
        );
        let help = format!(
            "shape ({height}, {width}, {}) with all of them in this order, or an array of shape ({height}, {width}) for each that there is, by its own name, like {:?}",
            group.len(),
            others[0]
        );
        return Error::unsupported(path, place, what, help);
    }
    let what = format!("an array of shape {shape:?} is not a picture");
    if shape.len() == 4 {
        let file = path.display();
        let help = format!(
            "of a cube, (H, W, T, C), compare the pictures of its bins: nullray convert {file} -o frames writes frames/000.exr and so on"
        );
        return Error::unsupported(path, place, what, help);
    }
    let help = "(H, W) or (H, W, 1) for one channel; (H, W, 3) or (H, W, 4) for the array \"radiance\"; (H, W, n) for an \
                array that is named like a group of n channels, like (H, W, 4) for \"event\"";
    Error::unsupported(path, place, what, help)
}

fn every(samples: &Samples, depth: usize, first: usize) -> Samples {
    fn part<T: Copy>(v: &[T], depth: usize, first: usize) -> Vec<T> {
        v.iter().skip(first).step_by(depth).copied().collect()
    }
    match samples {
        Samples::F32(v) => Samples::F32(part(v, depth, first)),
        Samples::F64(v) => Samples::F64(part(v, depth, first)),
        Samples::U32(v) => Samples::U32(part(v, depth, first)),
        Samples::I32(v) => Samples::I32(part(v, depth, first)),
    }
}
