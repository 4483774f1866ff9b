//! File → layers, for files of any origin.

use std::fs::File;
use std::io::{BufReader, Seek};
use std::path::Path;

use ::exr::meta::MetaData;
use ::exr::meta::header::Header;
use ::exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, FlatImage, FlatSamples, Layer, LayerAttributes,
    ReadChannels, ReadLayers, SampleType, Text,
};

use super::{PREFIX, SIGNED, name_in_memory};
use crate::error::{Error, Result};
use crate::io::image::layers::check_metadata;
use crate::io::image::{Channel, Layers, Samples, guarded};

/// The most pixel data that is read, bytes in memory.
const MAX_BYTES: u64 = 1 << 32;

/// Reads an EXR file.
///
/// Parts of one size become one list of channels, named `part.channel` where there are several. Half
/// precision becomes f32. The data window is read, whatever the display window. Text attributes become
/// metadata; those that this program wrote have their own keys again.
///
/// # Errors
/// I/O errors; files that are not EXR or are broken; deep data, subsampled channels, parts of different
/// sizes, and more than 4 GiB of pixels.
pub fn read(path: &Path) -> Result<Layers> {
    let io = || Error::io(path, "cannot read");
    let mut file = BufReader::new(File::open(path).map_err(io())?);
    let decoded = guarded(|| MetaData::read_from_buffered(&mut file, false));
    let headers = settle(path, decoded)?.headers;
    check(path, &headers)?;
    file.rewind().map_err(io())?;
    // One thread: a panic of a pool's thread could not be caught.
    let decoded = guarded(|| {
        ::exr::prelude::read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .all_layers()
            .all_attributes()
            .non_parallel()
            .from_buffered(file)
    });
    convert(path, settle(path, decoded)?)
}

/// The names of channels that the file holds in half precision; no pixel is decoded.
///
/// # Errors
/// I/O errors; files that are not EXR or are broken.
pub fn half_channels(path: &Path) -> Result<Vec<String>> {
    let mut file = BufReader::new(File::open(path).map_err(Error::io(path, "cannot read"))?);
    let decoded = guarded(|| MetaData::read_from_buffered(&mut file, false));
    let headers = settle(path, decoded)?.headers;
    let channels = headers.iter().flat_map(|header| &header.channels.list);
    let half = channels.filter(|channel| channel.sample_type == SampleType::F16);
    Ok(half
        .map(|channel| name_in_memory(&channel.name.to_string()))
        .collect())
}

/// The result of a decoder that may have panicked (none).
fn settle<T>(path: &Path, decoded: Option<::exr::error::Result<T>>) -> Result<T> {
    use ::exr::error::Error as Exr;
    match decoded {
        Some(Ok(decoded)) => Ok(decoded),
        Some(Err(Exr::Io(error))) => Err(Error::io(path, "cannot read")(error)),
        Some(Err(Exr::NotSupported(what))) => Err(Error::unsupported(path, "", what, "")),
        Some(Err(error)) => Err(broken(path, &error.to_string())),
        None => Err(broken(path, "its structure contradicts itself")),
    }
}

fn broken(path: &Path, what: &str) -> Error {
    let what = format!("not a readable EXR file: {what}");
    Error::invalid(path, "", what, "an OpenEXR image without deep data")
}

/// Refuses what would not fit, before anything is allocated for it.
fn check(path: &Path, headers: &[Header]) -> Result<()> {
    let Some(first) = headers.first() else {
        return Err(broken(path, "it has no part"));
    };
    let refuse = |what: String| Err(Error::unsupported(path, "", what, ""));
    let mut bytes = 0u64;
    for header in headers {
        if header.deep {
            return refuse("deep data are not supported".into());
        }
        if header.layer_size != first.layer_size {
            return refuse("its parts have different sizes".into());
        }
        if let Some(channel) = header
            .channels
            .list
            .iter()
            .find(|c| c.sampling.0 != 1 || c.sampling.1 != 1)
        {
            return refuse(format!("channel {} is subsampled", channel.name));
        }
        let channels = header.channels.list.len() as u64;
        let pixels = (header.layer_size.0 as u64).saturating_mul(header.layer_size.1 as u64);
        bytes = bytes.saturating_add(pixels.saturating_mul(4 * channels));
    }
    if bytes > MAX_BYTES {
        return refuse(format!(
            "it claims {bytes} bytes of pixels; at most {MAX_BYTES} are read"
        ));
    }
    Ok(())
}

fn convert(path: &Path, image: FlatImage) -> Result<Layers> {
    let Some(size) = image.layer_data.first().map(|part| part.size) else {
        return Err(broken(path, "it has no part"));
    };
    let several = image.layer_data.len() > 1;
    let mut channels = Vec::new();
    let mut metadata = Vec::new();
    for part in image.layer_data {
        let prefix = part.attributes.layer_name.clone().filter(|_| several);
        let (entries, signed) = texts(&part.attributes);
        for (key, value) in entries {
            if !metadata.iter().any(|(known, _)| *known == key) {
                metadata.push((key, value));
            }
        }
        channels.extend(part_channels(part, prefix.as_ref(), &signed));
    }
    let side = |n: usize| u32::try_from(n).map_err(|_| broken(path, "its size is absurd"));
    metadata.sort();
    Layers::new(side(size.0)?, side(size.1)?, channels, metadata)
        .map_err(|e| broken(path, &e.to_string()))
}

fn part_channels(
    part: Layer<AnyChannels<FlatSamples>>,
    prefix: Option<&Text>,
    signed: &[String],
) -> Vec<Channel> {
    let convert = |channel: AnyChannel<FlatSamples>| {
        let name = channel.name.to_string();
        let is_signed = signed.contains(&name);
        Channel {
            name: match prefix {
                Some(part) => format!("{part}.{name}"),
                None => name_in_memory(&name),
            },
            samples: samples(channel.sample_data, is_signed),
        }
    };
    part.channel_data.list.into_iter().map(convert).collect()
}

fn samples(samples: FlatSamples, signed: bool) -> Samples {
    match samples {
        FlatSamples::F16(v) => Samples::F32(v.into_iter().map(f32::from).collect()),
        FlatSamples::F32(v) => Samples::F32(v),
        FlatSamples::U32(v) if signed => {
            Samples::I32(v.into_iter().map(u32::cast_signed).collect())
        }
        FlatSamples::U32(v) => Samples::U32(v),
    }
}

/// The metadata of a part, and the names of its signed channels.
fn texts(attributes: &LayerAttributes) -> (Vec<(String, String)>, Vec<String>) {
    let mut entries = Vec::new();
    let mut signed = Vec::new();
    for (name, value) in &attributes.other {
        let (Ok(name), AttributeValue::Text(value)) = (std::str::from_utf8(name.as_slice()), value)
        else {
            continue;
        };
        let value = String::from_utf8_lossy(value.as_slice()).into_owned();
        match name.strip_prefix(PREFIX) {
            Some(SIGNED) => signed = value.split('\n').map(String::from).collect(),
            key => entries.push((key.unwrap_or(name).to_string(), value)),
        }
    }
    entries.retain(|(key, value)| check_metadata(key, value).is_ok());
    entries.sort();
    (entries, signed)
}
