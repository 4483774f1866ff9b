//! OpenEXR files: linear, for every viewer and compositor.
//!
//! One part, scan lines, lossless compression. Samples and names in the file:
//!
//! | in memory | in the file |
//! |---|---|
//! | `radiance.R`, `radiance.G`, `radiance.B` | `R`, `G`, `B`, the image that viewers show |
//! | `distance` | `Z`, by the standard the distance from the viewer (no other channel may pass for depth) |
//! | `alpha` | `A`; radiance is premultiplied by it where the background is black |
//! | any other name | the same name: `event.ct` is component `ct` of layer `event` |
//! | f32, u32 | unchanged |
//! | radiance, alpha | half precision, if requested; numbers beyond its range become its largest value |
//! | f64 | rounded to f32 (EXR has no f64; `.npz` has); numbers beyond its range become its largest value |
//! | i32 | two's complement in u32, so that every identifier is exact: −1 is 4294967295 |
//!
//! RGB has the primaries and white of sRGB (Rec. 709, D65), stated in the file; files that state others are refused. The attribute
//! `nullray.signed` lists the channels that hold i32. Metadata entry `key` becomes the text attribute
//! `nullray.key`, UTF-8. The same layers give the same bytes.

use std::fs::File;
use std::io::{self, BufReader, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::Path;

use ::exr::block::UncompressedBlock;
use ::exr::block::writer::ChunksWriter;
use ::exr::image::write::layers::{LayersWriter, WritableLayers};
use ::exr::meta::Headers;
use ::exr::meta::MetaData;
use ::exr::meta::attribute::Chromaticities;
use ::exr::meta::header::Header;
use ::exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Blocks, Compression, Encoding, FlatImage, FlatSamples,
    Image, ImageAttributes, IntegerBounds, Layer, LayerAttributes, LineOrder, ReadChannels,
    ReadLayers, SampleType, Text, Vec2, WritableImage, f16,
};

use rayon::prelude::*;

use super::decoder::guarded;
use super::file::{Seekable, write_atomically, write_failed};
use super::layers::{Channel, Layers, Samples, check_count, check_metadata, keep_first};
use crate::error::{Error, Result};
use crate::io::budget::Budget;
use crate::io::open::open_regular;
use crate::io::sealed;

/// The beginning of the software name in files written by this program.
const OWN: &str = concat!(env!("CARGO_PKG_NAME"), " ");
/// The prefix of our attributes' keys, which keeps them apart from the standard's.
const PREFIX: &str = "nullray.";
/// The key of the attribute that lists the i32 channels.
const SIGNED: &str = "signed";
/// The layer whose R, G, B are the main image.
const MAIN: &str = "radiance.";

/// A channel's name in the file.
fn name_in_file(name: &str) -> &str {
    match name.strip_prefix(MAIN) {
        Some(component @ ("R" | "G" | "B")) => component,
        _ => match name {
            "distance" => "Z",
            "alpha" => "A",
            _ => name,
        },
    }
}

/// A channel's name in memory; `is_own` says that this program wrote the file.
fn name_in_memory(name: &str, is_own: bool) -> String {
    match name {
        "R" | "G" | "B" => format!("{MAIN}{name}"),
        // In other files it may be measured along the axis.
        "Z" if is_own => "distance".into(),
        "A" if is_own => "alpha".into(),
        _ => name.to_string(),
    }
}

/// Contents of a file beyond its layers, and its precision.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Options {
    /// Radiance (also grey, `Y`) and alpha in half precision.
    pub half: bool,
    /// Includes a checksum of the whole file: [`sealed`].
    pub sealed: bool,
    /// Row-major matrices for row vectors, of the standard attributes `worldToCamera` and `worldToNDC`.
    pub matrices: [Option<[f32; 16]>; 2],
    /// The width of the picture's window at the distance 1, the standard attribute `screenWindowWidth`; `None` for 1, of a picture that is
    /// not in perspective.
    pub window_width: Option<f32>,
}

/// What to do about a file that was cut short or changed.
const AGAIN: &str = "copy it again, or render it again";
/// What the decoder says of a file of another format.
const NO_IDENTIFIER: &str = "file identifier missing";

/// The maximum expansion by the lossless compressions (deflate: 1032; chunks have their own offsets in addition).
const LARGEST_EXPANSION: u64 = 1032;

/// Reads an EXR file.
///
/// Parts of equal size become one list of channels, named `part.channel` if there are several. Half precision becomes f32. The data window
/// is read, regardless of the display window. Text attributes become metadata; those that this program wrote get their original keys.
///
/// # Errors
/// I/O errors; files that are not EXR or are broken; deep data, subsampled channels, parts of different sizes; more pixels than a file of
/// this length can contain, or than `budget` has memory for.
pub fn read(path: &Path, budget: &Budget) -> Result<Layers> {
    let (file, length) = open_regular(path)?;
    let mut file = BufReader::new(file);
    let decoded = guarded(|| MetaData::read_from_buffered(&mut file, false));
    let headers = settle(path, decoded)?.headers;
    check(path, &headers, length, budget)?;
    file.rewind().map_err(Error::io(path, "cannot read"))?;
    // One thread: a panic in a thread of a pool could not be caught.
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

/// Like [`read`], for a complete picture: its data window must be its display window.
///
/// # Errors
/// As for [`read`], and other data windows.
pub fn read_whole(path: &Path, budget: &Budget) -> Result<Layers> {
    for header in headers(path)? {
        let shown = header.shared_attributes.display_window;
        let position = header.own_attributes.layer_position;
        if position != shown.position || header.layer_size != shown.size {
            let what = format!(
                "its pixels ({} x {} from {}, {}) are not those of its display window ({} x {} from {}, {})",
                header.layer_size.0,
                header.layer_size.1,
                position.0,
                position.1,
                shown.size.0,
                shown.size.1,
                shown.position.0,
                shown.position.1,
            );
            let help = "save the whole picture, without a crop or an overscan";
            return Err(Error::unsupported(path, "", what, help));
        }
    }
    read(path, budget)
}

/// The names that [`read`] gives to channels stored in half precision; no pixel is decoded.
///
/// # Errors
/// I/O errors; files that are not EXR or are broken.
pub fn half_channels(path: &Path) -> Result<Vec<String>> {
    let headers = headers(path)?;
    let several = headers.len() > 1;
    let names = headers.iter().flat_map(|header| {
        let attributes = &header.own_attributes;
        let prefix = attributes.layer_name.as_ref().filter(|_| several);
        let half = header.channels.list.iter();
        let half = half.filter(|channel| channel.sample_type == SampleType::F16);
        half.map(move |channel| name_in_part(&channel.name.to_string(), prefix, is_own(attributes)))
    });
    Ok(names.collect())
}

/// The metadata of the first part; no pixel is decoded.
///
/// # Errors
/// As for [`half_channels`].
pub fn metadata(path: &Path) -> Result<Vec<(String, String)>> {
    let headers = headers(path)?;
    let first = headers.first().map(|first| texts(&first.own_attributes).0);
    Ok(first.unwrap_or_default())
}

fn headers(path: &Path) -> Result<Headers> {
    let mut file = BufReader::new(open_regular(path)?.0);
    let decoded = guarded(|| MetaData::read_from_buffered(&mut file, false));
    Ok(settle(path, decoded)?.headers)
}

/// The result of a decoder; `None` if it panicked.
fn settle<T>(path: &Path, decoded: Option<::exr::error::Result<T>>) -> Result<T> {
    use ::exr::error::Error as Exr;
    match decoded {
        Some(Ok(decoded)) => Ok(decoded),
        Some(Err(Exr::Io(error))) if error.kind() == std::io::ErrorKind::UnexpectedEof => {
            let what = "the file ends before its last pixel";
            Err(Error::invalid(path, "", what, AGAIN))
        }
        Some(Err(Exr::Io(error))) => Err(Error::io(path, "cannot read")(error)),
        Some(Err(Exr::NotSupported(what))) => Err(Error::unsupported(path, "", what, "")),
        Some(Err(Exr::Invalid(what))) if what == NO_IDENTIFIER => {
            let what = "not an EXR file: it does not begin like one";
            Err(Error::invalid(path, "", what, "name an OpenEXR picture"))
        }
        Some(Err(Exr::Invalid(what))) => Err(broken(path, &what)),
        Some(Err(error)) => Err(broken(path, &error.to_string())),
        None => Err(broken(path, "its structure contradicts itself")),
    }
}

fn broken(path: &Path, what: &str) -> Error {
    let what = format!("truncated or damaged: {what}");
    Error::invalid(path, "", what, AGAIN)
}

/// Checks, before anything is allocated, that the contents of a file of `length` bytes fit.
fn check(path: &Path, headers: &[Header], length: u64, budget: &Budget) -> Result<()> {
    let Some(first) = headers.first() else {
        return Err(broken(path, "it has no part"));
    };
    let entries = headers
        .iter()
        .map(|header| header.own_attributes.other.len());
    check_count(path, entries.sum())?;
    let refuse = |what: String| Err(Error::unsupported(path, "", what, ""));
    let (mut stored, mut bytes) = (0u64, 0u64);
    for header in headers {
        refuse_other_primaries(path, header)?;
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
        let pixels = (header.layer_size.0 as u64).saturating_mul(header.layer_size.1 as u64);
        for channel in &header.channels.list {
            let size = channel.sample_type.bytes_per_sample() as u64;
            stored = stored.saturating_add(pixels.saturating_mul(size));
            // During conversion to single precision, a channel of half precision is in memory twice.
            let widened = if size == 2 { 6 } else { 4 };
            bytes = bytes.saturating_add(pixels.saturating_mul(widened));
        }
    }
    if stored > length.saturating_mul(LARGEST_EXPANSION) {
        let what = format!("it claims {stored} bytes of pixels, and has {length} bytes in all");
        return Err(broken(path, &what));
    }
    budget.take(bytes, path)
}

/// Refuses colours with other primaries than those of Rec. 709 and D65, which are the default.
fn refuse_other_primaries(path: &Path, header: &Header) -> Result<()> {
    /// Chromaticities are written with three or four digits.
    const SAME: f32 = 1e-3;
    let Some(said) = header.shared_attributes.chromaticities else {
        return Ok(());
    };
    let is_colour = |name: &Text| {
        let name = name.to_string();
        let last = name.rsplit('.').next();
        matches!(last, Some("R" | "G" | "B"))
    };
    let is_near = |a: Vec2<f32>, b: Vec2<f32>| (a.0 - b.0).abs() < SAME && (a.1 - b.1).abs() < SAME;
    let same = is_near(said.red, REC_709.red)
        && is_near(said.green, REC_709.green)
        && is_near(said.blue, REC_709.blue)
        && is_near(said.white, REC_709.white);
    if same || !header.channels.list.iter().any(|c| is_colour(&c.name)) {
        return Ok(());
    }
    let what = "its primaries (`chromaticities`) are not those of Rec. 709 with white D65";
    let help = "convert it to linear Rec. 709, the colour space of linear sRGB";
    Err(Error::unsupported(path, "", what, help))
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
        metadata.extend(entries);
        channels.extend(part_channels(part, prefix.as_ref(), &signed));
    }
    let side = |n: usize| u32::try_from(n).map_err(|_| broken(path, "its size is absurd"));
    keep_first(&mut metadata);
    metadata.sort();
    Layers::new(side(size.0)?, side(size.1)?, channels, metadata)
        .map_err(|e| broken(path, &e.to_string()))
}

fn part_channels(
    part: Layer<AnyChannels<FlatSamples>>,
    prefix: Option<&Text>,
    signed: &[String],
) -> Vec<Channel> {
    let is_own = is_own(&part.attributes);
    let convert = |channel: AnyChannel<FlatSamples>| {
        let name = channel.name.to_string();
        let is_signed = signed.contains(&name);
        Channel {
            name: name_in_part(&name, prefix, is_own),
            samples: samples(channel.sample_data, is_signed),
        }
    };
    part.channel_data.list.into_iter().map(convert).collect()
}

/// Whether this crate wrote a part.
fn is_own(attributes: &LayerAttributes) -> bool {
    let software = attributes.software_name.as_ref();
    software.is_some_and(|name| name.to_string().starts_with(OWN))
}

/// The name in memory of a part's channel; parts of files with several have a `prefix`.
fn name_in_part(name: &str, prefix: Option<&Text>, is_own: bool) -> String {
    match prefix {
        Some(part) => format!("{part}.{name}"),
        None => name_in_memory(name, is_own),
    }
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

/// Lossless, in blocks of 16 lines. Of ZIP1, ZIP16 and PIZ it gives the smallest files for a frame with 25 channels and is by far the
/// fastest to read; PIZ takes three quarters of its time to write.
const COMPRESSION: Compression = Compression::ZIP16;

/// Writes `layers` to `path`, completely or not at all.
///
/// # Errors
/// Layers that fail [`Layers::check`] or have no channels; I/O errors.
pub fn write(path: &Path, layers: &Layers) -> Result<()> {
    write_with(path, layers, &Options::default())
}

/// Like [`write()`], with `options`.
///
/// # Errors
/// As for [`write()`].
pub fn write_with(path: &Path, layers: &Layers, options: &Options) -> Result<()> {
    let image = checked_image(path, layers, options)?;
    write_atomically(path, |writer| {
        let written = write_blocks(&image, writer);
        written.map_err(|e| failure(path, e))?;
        sort(writer).map_err(write_failed(path))?;
        match options.sealed {
            true => sealed::seal(writer.get_mut()).map_err(write_failed(path)),
            false => Ok(()),
        }
    })
}

/// The bytes that [`write_with`] would write to `path`, which is only the name in errors.
///
/// # Errors
/// As for [`write()`].
pub fn encode(path: &Path, layers: &Layers, options: &Options) -> Result<Vec<u8>> {
    let image = checked_image(path, layers, options)?;
    let mut bytes = io::Cursor::new(Vec::new());
    write_blocks(&image, &mut bytes).map_err(|e| failure(path, e))?;
    sort_attributes(&mut bytes).map_err(write_failed(path))?;
    let mut bytes = bytes.into_inner();
    if options.sealed {
        sealed::seal_bytes(&mut bytes);
    }
    Ok(bytes)
}

/// The image of `layers`, which the format can store.
fn checked_image(
    path: &Path,
    layers: &Layers,
    options: &Options,
) -> Result<Image<Layer<AnyChannels<FlatSamples>>>> {
    layers.check()?;
    check_limits(path, layers)?;
    Ok(image(layers, options))
}

/// Compresses the blocks of `image` on the threads of the pool, several at a time, and writes them in order.
fn write_blocks(
    image: &Image<Layer<AnyChannels<FlatSamples>>>,
    to: &mut dyn Seekable,
) -> ::exr::error::UnitResult {
    let headers = image.write().infer_meta_data();
    let layers = image.layer_data.create_writer(&headers);
    // With this number of blocks, threads do not wait long for the slowest one, and few blocks are in memory.
    let together = 4 * rayon::current_num_threads();
    ::exr::block::write(to, headers, true, |meta, file| {
        let blocks: Vec<_> = meta.enumerate_ordered_header_block_indices().collect();
        for group in blocks.chunks(together) {
            let compressed = group.par_iter().map(|(at, index)| {
                let data = layers.extract_uncompressed_block(&meta.headers, *index);
                let block = UncompressedBlock {
                    index: *index,
                    data,
                };
                Ok((*at, block.compress_to_chunk(&meta.headers)?))
            });
            for (at, chunk) in compressed.collect::<::exr::error::Result<Vec<_>>>()? {
                file.write_chunk(at, chunk)?;
            }
        }
        Ok(())
    })
}

fn sort(writer: &mut BufWriter<File>) -> std::io::Result<()> {
    writer.flush()?;
    sort_attributes(writer.get_mut())
}

/// Refuses layers that the format cannot store.
fn check_limits(path: &Path, layers: &Layers) -> Result<()> {
    let refuse = |what: &str| Err(Error::unsupported(path, "", what, ""));
    if layers.channels.is_empty() {
        return refuse("an EXR file needs at least one channel");
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

fn image(layers: &Layers, options: &Options) -> Image<Layer<AnyChannels<FlatSamples>>> {
    let encoding = Encoding {
        compression: COMPRESSION,
        blocks: Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    let channel = |c: &Channel| channel(c, options.half);
    let channels = AnyChannels::sort(layers.channels.iter().map(channel).collect());
    let size = Vec2(layers.width as usize, layers.height as usize);
    Image {
        attributes: image_attributes(size),
        layer_data: Layer::new(size, layer_attributes(layers, options), encoding, channels),
    }
}

fn channel(channel: &Channel, half: bool) -> AnyChannel<FlatSamples> {
    if half && matches!(name_in_file(&channel.name), "R" | "G" | "B" | "A" | "Y") {
        let samples = match &channel.samples {
            Samples::F32(v) => v.iter().map(|&x| half_of(x.into())).collect(),
            Samples::F64(v) => v.iter().map(|&x| half_of(x)).collect(),
            Samples::U32(v) => v.iter().map(|&x| half_of(x.into())).collect(),
            Samples::I32(v) => v.iter().map(|&x| half_of(x.into())).collect(),
        };
        return AnyChannel::new(text(name_in_file(&channel.name)), FlatSamples::F16(samples));
    }
    let samples = match &channel.samples {
        Samples::F32(v) => FlatSamples::F32(v.clone()),
        Samples::F64(v) => FlatSamples::F32(v.iter().map(|&x| single_of(x)).collect()),
        Samples::U32(v) => FlatSamples::U32(v.clone()),
        Samples::I32(v) => FlatSamples::U32(v.iter().map(|&x| x.cast_unsigned()).collect()),
    };
    AnyChannel::new(text(name_in_file(&channel.name)), samples)
}

/// The nearest half-precision number; finite numbers beyond the largest become the largest rather than infinite.
fn half_of(value: f64) -> f16 {
    let largest = f64::from(f16::MAX);
    match value.is_infinite() {
        true => f16::from_f64(value),
        // NaN stays NaN.
        false => f16::from_f64(value.clamp(-largest, largest)),
    }
}

/// The nearest single-precision number; finite numbers beyond the largest become the largest rather than infinite.
fn single_of(value: f64) -> f32 {
    let largest = f64::from(f32::MAX);
    match value.is_infinite() {
        true => value as f32,
        false => value.clamp(-largest, largest) as f32,
    }
}

/// Rec. 709 primaries and D65, the space of linear sRGB.
const REC_709: Chromaticities = Chromaticities {
    red: Vec2(0.64, 0.33),
    green: Vec2(0.30, 0.60),
    blue: Vec2(0.15, 0.06),
    white: Vec2(0.3127, 0.3290),
};

fn image_attributes(size: Vec2<usize>) -> ImageAttributes {
    ImageAttributes {
        chromaticities: Some(REC_709),
        ..ImageAttributes::new(IntegerBounds::from_dimensions(size))
    }
}

fn layer_attributes(layers: &Layers, options: &Options) -> LayerAttributes {
    let software = concat!(env!("CARGO_PKG_NAME"), " ", env!("CARGO_PKG_VERSION"));
    let signed = layers.channels.iter();
    let signed = signed.filter(|c| matches!(c.samples, Samples::I32(_)));
    let signed: Vec<_> = signed.map(|c| name_in_file(&c.name)).collect();
    let mut attributes = LayerAttributes {
        software_name: Some(text(software)),
        world_to_camera: options.matrices[0],
        world_to_normalized_device: options.matrices[1],
        screen_window_width: options.window_width.unwrap_or(1.0),
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
    if options.sealed {
        put(sealed::KEY, &sealed::blank());
    }
    if !signed.is_empty() {
        put(SIGNED, &signed.join("\n"));
    }
    attributes
}

/// UTF-8, unchanged: newer versions of the standard's own library specify it for strings.
fn text(text: &str) -> Text {
    Text::from_slice_unchecked(text.as_bytes())
}

fn failure(path: &Path, error: ::exr::error::Error) -> Error {
    match error {
        ::exr::error::Error::Io(error) => write_failed(path)(error),
        other => Error::unsupported(path, "", format!("cannot be written as EXR: {other}"), ""),
    }
}

/// Sorts the attributes of a single-part file, in place.
fn sort_attributes(file: &mut (impl Read + Write + Seek)) -> io::Result<()> {
    file.seek(SeekFrom::Start(8))?;
    let mut attributes = Vec::new();
    {
        let mut reader = io::BufReader::new(&mut *file);
        while let Some(attribute) = read_attribute(&mut reader)? {
            attributes.push(attribute);
        }
    }
    attributes.sort();
    file.seek(SeekFrom::Start(8))?;
    file.write_all(&attributes.concat())?;
    file.seek(SeekFrom::End(0))?;
    Ok(())
}

/// The bytes of the next attribute; `None` at the end of the header.
fn read_attribute(reader: &mut impl io::BufRead) -> io::Result<Option<Vec<u8>>> {
    let mut attribute = Vec::new();
    reader.read_until(0, &mut attribute)?;
    if attribute.len() <= 1 {
        return Ok(None);
    }
    reader.read_until(0, &mut attribute)?;
    let mut size = [0; 4];
    reader.read_exact(&mut size)?;
    attribute.extend(size);
    let size = u64::from(u32::from_le_bytes(size));
    reader.take(size).read_to_end(&mut attribute)?;
    Ok(Some(attribute))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn attribute(name: &str, value: &[u8]) -> Vec<u8> {
        let size = (value.len() as i32).to_le_bytes();
        [name.as_bytes(), b"\0string\0", &size, value].concat()
    }

    #[test]
    fn attributes_are_sorted_and_nothing_else_moves() {
        let [a, b, c] = [
            attribute("a", b"1"),
            attribute("b", b"\0\0"),
            attribute("c", b""),
        ];
        let file = |order: [&Vec<u8>; 3]| {
            let header = order.map(Vec::as_slice).concat();
            [b"headmore".as_slice(), &header, b"\0pixels"].concat()
        };
        let mut cursor = io::Cursor::new(file([&b, &c, &a]));
        sort_attributes(&mut cursor).unwrap();
        assert_eq!(cursor.into_inner(), file([&a, &b, &c]));
    }
}
