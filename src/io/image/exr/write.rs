//! Layers → file.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use ::exr::meta::attribute::Chromaticities;
use ::exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Blocks, Compression, Encoding, FlatSamples, Image,
    ImageAttributes, IntegerBounds, Layer, LayerAttributes, LineOrder, Text, Vec2, WritableImage,
};

use super::{PREFIX, SIGNED, header, name_in_file};
use crate::error::{Error, Result};
use crate::io::image::file::write_failed;
use crate::io::image::{Channel, Layers, Samples, write_atomically};

/// Lossless, by blocks of 16 lines. Of ZIP1, ZIP16 and PIZ it makes the smallest files of a frame with 25
/// channels and is by far the fastest to read; PIZ takes three quarters of its time to write.
const COMPRESSION: Compression = Compression::ZIP16;

/// Writes `layers` to `path`, whole or not at all.
///
/// # Errors
/// Layers that fail [`Layers::check`] or have no channel; I/O errors.
pub fn write(path: &Path, layers: &Layers) -> Result<()> {
    write_as(path, layers, COMPRESSION)
}

fn write_as(path: &Path, layers: &Layers, compression: Compression) -> Result<()> {
    layers.check()?;
    check_limits(path, layers)?;
    let image = image(layers, compression);
    write_atomically(path, |writer| {
        let written = image.write().to_buffered(&mut *writer);
        written.map_err(|e| failure(path, e))?;
        sort(writer).map_err(write_failed(path))
    })
}

fn sort(writer: &mut BufWriter<File>) -> std::io::Result<()> {
    writer.flush()?;
    header::sort_attributes(writer.get_mut())
}

/// What the format cannot hold.
fn check_limits(path: &Path, layers: &Layers) -> Result<()> {
    let refuse = |what: &str| Err(Error::unsupported(path, "", what, ""));
    if layers.channels.is_empty() {
        return refuse("an EXR file needs a channel at least");
    }
    if layers.width > i32::MAX as u32 / 2 || layers.height > i32::MAX as u32 / 2 {
        return refuse("an EXR image has less than 2³⁰ pixels per row and per column");
    }
    let mut names: Vec<_> = layers
        .channels
        .iter()
        .map(|c| name_in_file(&c.name))
        .collect();
    names.sort_unstable();
    if names.windows(2).any(|pair| pair[0] == pair[1]) {
        return refuse("radiance.R, .G, .B are stored as R, G, B: there is another of that name");
    }
    Ok(())
}

fn image(layers: &Layers, compression: Compression) -> Image<Layer<AnyChannels<FlatSamples>>> {
    let encoding = Encoding {
        compression,
        blocks: Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    let channels = AnyChannels::sort(layers.channels.iter().map(channel).collect());
    let size = Vec2(layers.width as usize, layers.height as usize);
    Image {
        attributes: image_attributes(size),
        layer_data: Layer::new(size, layer_attributes(layers), encoding, channels),
    }
}

fn channel(channel: &Channel) -> AnyChannel<FlatSamples> {
    let samples = match &channel.samples {
        Samples::F32(v) => FlatSamples::F32(v.clone()),
        Samples::F64(v) => FlatSamples::F32(v.iter().map(|&x| x as f32).collect()),
        Samples::U32(v) => FlatSamples::U32(v.clone()),
        Samples::I32(v) => FlatSamples::U32(v.iter().map(|&x| x.cast_unsigned()).collect()),
    };
    AnyChannel::new(text(name_in_file(&channel.name)), samples)
}

/// Rec. 709 primaries and D65, the space of linear sRGB.
fn image_attributes(size: Vec2<usize>) -> ImageAttributes {
    ImageAttributes {
        chromaticities: Some(Chromaticities {
            red: Vec2(0.64, 0.33),
            green: Vec2(0.30, 0.60),
            blue: Vec2(0.15, 0.06),
            white: Vec2(0.3127, 0.3290),
        }),
        ..ImageAttributes::new(IntegerBounds::from_dimensions(size))
    }
}

fn layer_attributes(layers: &Layers) -> LayerAttributes {
    let software = concat!(env!("CARGO_PKG_NAME"), " ", env!("CARGO_PKG_VERSION"));
    let signed = layers.channels.iter();
    let signed = signed.filter(|c| matches!(c.samples, Samples::I32(_)));
    let signed: Vec<_> = signed.map(|c| name_in_file(&c.name)).collect();
    let mut attributes = LayerAttributes {
        software_name: Some(text(software)),
        ..LayerAttributes::default()
    };
    let mut put = |key: &str, value: &str| {
        let value = AttributeValue::Text(text(value));
        attributes
            .other
            .insert(text(&format!("{PREFIX}{key}")), value)
    };
    for (key, value) in &layers.metadata {
        put(key, value);
    }
    if !signed.is_empty() {
        put(SIGNED, &signed.join("\n"));
    }
    attributes
}

/// UTF-8 as it stands: newer versions of the standard's own library say the same of strings.
fn text(text: &str) -> Text {
    Text::from_slice_unchecked(text.as_bytes())
}

fn failure(path: &Path, error: ::exr::error::Error) -> Error {
    match error {
        ::exr::error::Error::Io(error) => write_failed(path)(error),
        other => Error::unsupported(path, "", format!("cannot be written as EXR: {other}"), ""),
    }
}
