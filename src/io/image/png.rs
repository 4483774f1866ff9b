//! PNG files: pictures for displays.

use std::io::{BufReader, Read, Seek, SeekFrom, Write};
use std::path::Path;

use ::png::{
    BitDepth, ColorType, Compression, Decoder, DecodingError, Encoder, EncodingError, Limits,
    SrgbRenderingIntent, Transformations,
};

use super::decoder::guarded;
use super::file::{write_atomically, write_failed};
use super::layers::{
    Channel, Layers, Samples, check_count, check_metadata, keep_first, pixel_count,
};
use crate::error::{Error, Result};
use crate::io::budget::Budget;
use crate::io::files::Reader;
use crate::io::open::open_regular;

/// Writes 8-bit sRGB pixels (3 bytes each, row 0 at the top) to `path`, completely or not at all.
///
/// `text` entries become text chunks, in Latin-1 if they are ASCII and in UTF-8 otherwise.
///
/// # Errors
/// A size of 0, a `rgb` whose length is not 3·width·height; keys that a text chunk cannot have; I/O errors.
pub fn write(
    path: &Path,
    width: u32,
    height: u32,
    rgb: &[u8],
    text: &[(String, String)],
) -> Result<()> {
    write_codes(path, [width, height], BitDepth::Eight, rgb, text)
}

/// The same with 16 bits per sample.
///
/// # Errors
/// As for [`write()`].
pub fn write_16(
    path: &Path,
    width: u32,
    height: u32,
    rgb: &[u16],
    text: &[(String, String)],
) -> Result<()> {
    let bytes = big_endian(rgb);
    write_codes(path, [width, height], BitDepth::Sixteen, &bytes, text)
}

/// The bytes that [`write()`] would write to `path`, which is only the name in errors.
///
/// # Errors
/// As for [`write()`].
pub fn encode(
    path: &Path,
    width: u32,
    height: u32,
    rgb: &[u8],
    text: &[(String, String)],
) -> Result<Vec<u8>> {
    encode_codes(path, [width, height], BitDepth::Eight, rgb, text)
}

/// The same for [`write_16`].
///
/// # Errors
/// As for [`write()`].
pub fn encode_16(
    path: &Path,
    width: u32,
    height: u32,
    rgb: &[u16],
    text: &[(String, String)],
) -> Result<Vec<u8>> {
    let bytes = big_endian(rgb);
    encode_codes(path, [width, height], BitDepth::Sixteen, &bytes, text)
}

fn encode_codes(
    path: &Path,
    size: [u32; 2],
    depth: BitDepth,
    bytes: &[u8],
    text: &[(String, String)],
) -> Result<Vec<u8>> {
    check(path, size, depth, bytes, text)?;
    let mut encoded = Vec::new();
    encode_to(&mut encoded, size, depth, bytes, text).map_err(|e| failure(path, e))?;
    Ok(encoded)
}

/// Codes as PNG stores them: the most significant byte first.
fn big_endian(codes: &[u16]) -> Vec<u8> {
    codes.iter().flat_map(|code| code.to_be_bytes()).collect()
}

fn write_codes(
    path: &Path,
    size: [u32; 2],
    depth: BitDepth,
    bytes: &[u8],
    text: &[(String, String)],
) -> Result<()> {
    check(path, size, depth, bytes, text)?;
    write_atomically(path, |writer| {
        let encoded = encode_to(writer, size, depth, bytes, text);
        encoded.map_err(|e| failure(path, e))
    })
}

/// Refuses what the format cannot store.
fn check(
    path: &Path,
    [width, height]: [u32; 2],
    depth: BitDepth,
    bytes: &[u8],
    text: &[(String, String)],
) -> Result<()> {
    let of_pixel = 3 * (depth as usize / 8);
    if bytes.len() != of_pixel * pixel_count(width, height)? {
        let samples = 3 * bytes.len() / of_pixel;
        let what = format!("{samples} samples for {width} × {height} RGB pixels");
        return Err(Error::invalid(path, "", what, ""));
    }
    for (key, value) in text {
        check_metadata(key, value)?;
    }
    Ok(())
}

/// An encoder of 8-bit sRGB pictures of this size.
pub(crate) fn encoder<W: Write>(
    writer: W,
    [width, height]: [u32; 2],
    colour: ColorType,
) -> Encoder<'static, W> {
    let mut encoder = Encoder::new(writer, width, height);
    encoder.set_color(colour);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_compression(Compression::Balanced);
    encoder.set_source_srgb(SrgbRenderingIntent::RelativeColorimetric);
    encoder
}

/// Writes RGB pixels of this size, with text chunks.
fn encode_to(
    writer: impl Write,
    size: [u32; 2],
    depth: BitDepth,
    rgb: &[u8],
    text: &[(String, String)],
) -> Result<(), EncodingError> {
    let mut encoder = encoder(writer, size, ColorType::Rgb);
    encoder.set_depth(depth);
    for (key, value) in text {
        let (key, value) = (key.clone(), value.clone());
        if value.is_ascii() {
            encoder.add_text_chunk(key, value)?;
        } else {
            encoder.add_itxt_chunk(key, value)?;
        }
    }
    let mut writer = encoder.write_header()?;
    writer.write_image_data(rgb)?;
    writer.finish()
}

fn failure(path: &Path, error: EncodingError) -> Error {
    match error {
        EncodingError::IoError(error) => write_failed(path)(error),
        other => Error::unsupported(path, "", format!("cannot be written as PNG: {other}"), ""),
    }
}

/// The maximum memory for the header and the text of a file, bytes.
const HEADER_MEMORY: usize = 64 << 20;

/// The contents of a PNG file before its pixels.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct PngInfo {
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Bits per sample.
    pub bits: u8,
    /// Samples: "grey", "RGB", "palette", "grey and alpha" or "RGBA".
    pub colour: &'static str,
    /// Keys and texts, in the order of the file.
    pub text: Vec<(String, String)>,
}

/// Reads the header and the text of a PNG file; no pixel is decoded.
///
/// # Errors
/// I/O errors, and files that are not PNG or are broken, if this can be seen before the pixels.
pub fn inspect(path: &Path) -> Result<PngInfo> {
    let (file, _) = open_regular(path)?;
    let limits = Limits {
        bytes: HEADER_MEMORY,
    };
    let decoder = Decoder::new_with_limits(BufReader::new(file), limits);
    let decoded = guarded(|| {
        decoder
            .read_info()
            .map(|reader| describe(path, reader.info()))
    });
    match decoded {
        Some(Ok(info)) => info,
        Some(Err(DecodingError::IoError(e))) if e.kind() != std::io::ErrorKind::UnexpectedEof => {
            Err(Error::io(path, "cannot read")(e))
        }
        Some(Err(error)) => Err(broken(path, &error.to_string())),
        None => Err(broken(path, "its structure contradicts itself")),
    }
}

/// Refuses a file that ends before its last chunk, or has too few bytes for its pixels; no pixel is decoded.
///
/// # Errors
/// As for [`inspect`], and files that were cut short.
pub fn check_whole(path: &Path) -> Result<()> {
    let info = inspect(path)?;
    let cut = |what: &str| {
        let what = format!("truncated or damaged: {what}");
        Error::invalid(path, "", what, AGAIN)
    };
    let (file, length) = open_regular(path)?;
    let mut file = BufReader::new(file);
    let failed = || Error::io(path, "cannot read");
    // After the signature, chunks: length, name, data, checksum.
    let (mut at, mut data) = (8u64, 0u64);
    file.seek(SeekFrom::Start(at)).map_err(failed())?;
    loop {
        let mut head = [0; 8];
        if at + 12 > length {
            return Err(cut("the file ends before its last chunk"));
        }
        file.read_exact(&mut head).map_err(failed())?;
        let [a, b, c, d, name @ ..] = head;
        let size = u64::from(u32::from_be_bytes([a, b, c, d]));
        match &name {
            b"IEND" => break,
            b"IDAT" => data += size,
            _ => {}
        }
        at += 12 + size;
        file.seek_relative(size as i64 + 4).map_err(failed())?;
    }
    // At least a sample per pixel.
    let pixels = u64::from(info.width) * u64::from(info.height);
    let stored = pixels.saturating_mul(info.bits.into()) / 8;
    if stored > data.saturating_mul(LARGEST_EXPANSION) {
        let what = format!("{pixels} pixels are not in {data} bytes");
        return Err(cut(&what));
    }
    Ok(())
}

/// Reads a PNG file as codes in [0, 1].
///
/// Channels are `radiance.R`, `radiance.G`, `radiance.B`, three times the same for a grey picture, and `A` if there is alpha or a
/// transparent colour. 8 and 16 bits are read, fewer are widened, palettes resolved. Texts become metadata if their keys and values are
/// allowed.
///
/// # Errors
/// I/O errors; files that are not PNG or are broken; more pixels than `budget` has memory for.
pub fn read(path: &Path, budget: &Budget) -> Result<Layers> {
    let info = inspect(path)?;
    let pixels = u64::from(info.width).saturating_mul(info.height.into());
    budget.take(pixels.saturating_mul(PIXEL_BYTES), path)?;
    let (file, _) = open_regular(path)?;
    let decoded = guarded(|| decode(BufReader::new(file)));
    layers(path, info, &settle(path, decoded)?)
}

/// The format of a frame's pixels: columns and rows, samples per pixel (1 for grey, 3 for colours), and the memory needed to read it,
/// bytes.
pub(crate) struct FrameForm {
    pub size: [usize; 2],
    pub channels: usize,
    pub memory: u64,
}

/// The format of a file, from its header.
///
/// # Errors
/// As for [`inspect`].
pub(crate) fn frame_form(path: &Path) -> Result<FrameForm> {
    let info = inspect(path)?;
    let channels = if info.colour.starts_with("grey") {
        1
    } else {
        3
    };
    let size = [info.width as usize, info.height as usize];
    let pixels = u64::from(info.width).saturating_mul(info.height.into());
    // The decoded samples, with alpha, and f32.
    let pixel = (channels + 1) * if info.bits > 8 { 2 } else { 1 } + 4 * channels;
    Ok(FrameForm {
        size,
        channels,
        memory: pixels.saturating_mul(pixel as u64),
    })
}

/// Reads a PNG file as samples in row order, colours fastest: the results of `linear` for codes in [0, 1].
///
/// # Errors
/// As for [`read`].
pub(crate) fn read_frame(path: &Path, budget: &Budget, linear: fn(f64) -> f32) -> Result<Vec<f32>> {
    let form = frame_form(path)?;
    budget.take(form.memory, path)?;
    let (file, _) = open_regular(path)?;
    let decoded = settle(path, guarded(|| decode(BufReader::new(file))))?;
    let [width, height] = form.size;
    decoded.check(path, width * height)?;
    // A picture may have alpha after its colours, which is skipped.
    let places = (0..width * height).flat_map(|pixel| {
        let first = pixel * decoded.samples;
        first..first + form.channels
    });
    let mut samples = Vec::with_capacity(width * height * form.channels);
    samples.extend(places.map(|at| linear(decoded.code(at).into())));
    Ok(samples)
}

/// The result of a decoder; `None` if it panicked.
fn settle(path: &Path, decoded: Option<Result<Decoded, DecodingError>>) -> Result<Decoded> {
    match decoded {
        Some(Ok(decoded)) => Ok(decoded),
        Some(Err(error)) => Err(broken(path, &error.to_string())),
        None => Err(broken(path, "its structure contradicts itself")),
    }
}

/// The maximum expansion by deflate.
const LARGEST_EXPANSION: u64 = 1032;
/// The maximum memory per pixel: four samples of 16 bits as decoded, and as f32.
const PIXEL_BYTES: u64 = 4 * (2 + 4);

/// Decoded pixels.
struct Decoded {
    /// Samples per pixel.
    samples: usize,
    /// Samples of all pixels, most significant byte first.
    bytes: Vec<u8>,
    /// Whether each sample has two bytes.
    wide: bool,
}

impl Decoded {
    /// Refuses any other number of pixels.
    fn check(&self, path: &Path, pixels: usize) -> Result<()> {
        let size = if self.wide { 2 } else { 1 };
        match self.bytes.len() == pixels * self.samples * size {
            true => Ok(()),
            false => Err(broken(path, "it has fewer pixels than it declares")),
        }
    }

    /// The code of a sample, from 0 to 1.
    fn code(&self, at: usize) -> f32 {
        let bytes = &self.bytes;
        match self.wide {
            true => f32::from(u16::from_be_bytes([bytes[2 * at], bytes[2 * at + 1]])) / 65535.0,
            false => f32::from(bytes[at]) / 255.0,
        }
    }
}

fn decode(file: BufReader<Reader>) -> Result<Decoded, DecodingError> {
    let limits = Limits {
        bytes: HEADER_MEMORY,
    };
    let mut decoder = Decoder::new_with_limits(file, limits);
    decoder.set_transformations(Transformations::EXPAND);
    let mut reader = decoder.read_info()?;
    let length = reader.output_buffer_size();
    let length = length.ok_or(DecodingError::LimitsExceeded)?;
    let mut bytes = vec![0; length];
    let frame = reader.next_frame(&mut bytes)?;
    bytes.truncate(frame.buffer_size());
    Ok(Decoded {
        samples: frame.color_type.samples(),
        bytes,
        wide: frame.bit_depth == BitDepth::Sixteen,
    })
}

/// The channels of a decoded picture as codes from 0 to 1; grey is used for red, green and blue.
fn layers(path: &Path, info: PngInfo, decoded: &Decoded) -> Result<Layers> {
    let pixels = pixel_count(info.width, info.height)?;
    decoded.check(path, pixels)?;
    let samples = decoded.samples;
    let names: &[(&str, usize)] = match samples {
        1 | 2 => &[
            ("radiance.R", 0),
            ("radiance.G", 0),
            ("radiance.B", 0),
            ("A", 1),
        ],
        _ => &[
            ("radiance.R", 0),
            ("radiance.G", 1),
            ("radiance.B", 2),
            ("A", 3),
        ],
    };
    let channels = names.iter().filter(|(_, sample)| *sample < samples);
    let channels = channels.map(|(name, sample)| Channel {
        name: name.to_string(),
        samples: Samples::F32(
            (0..pixels)
                .map(|i| decoded.code(i * samples + sample))
                .collect(),
        ),
    });
    let mut metadata = info.text;
    metadata.retain(|(key, value)| check_metadata(key, value).is_ok());
    keep_first(&mut metadata);
    Layers::new(info.width, info.height, channels.collect(), metadata)
}

/// What to do about a file that was cut short or changed.
const AGAIN: &str = "copy or write the picture again";

fn broken(path: &Path, what: &str) -> Error {
    let what = format!("not a readable PNG file: {what}");
    Error::invalid(path, "", what, AGAIN)
}

/// The maximum memory for the decompressed texts of a file, bytes.
const TEXT_MEMORY: usize = 16 << 20;

fn describe(path: &Path, info: &::png::Info) -> Result<PngInfo> {
    Ok(PngInfo {
        width: info.width,
        height: info.height,
        bits: info.bit_depth as u8,
        colour: match info.color_type {
            ColorType::Grayscale => "grey",
            ColorType::Rgb => "RGB",
            ColorType::Indexed => "palette",
            ColorType::GrayscaleAlpha => "grey and alpha",
            ColorType::Rgba => "RGBA",
        },
        text: texts(path, info)?,
    })
}

/// Keys and texts; damaged ones are skipped.
fn texts(path: &Path, info: &::png::Info) -> Result<Vec<(String, String)>> {
    let (latin, packed) = (&info.uncompressed_latin1_text, &info.compressed_latin1_text);
    check_count(path, latin.len() + packed.len() + info.utf8_text.len())?;
    let latin = latin.iter();
    let mut texts: Vec<_> = latin
        .map(|chunk| (chunk.keyword.clone(), chunk.text.clone()))
        .collect();
    // zlib can expand a few bytes a thousandfold: all compressed texts share the memory.
    let mut left = TEXT_MEMORY;
    for chunk in packed {
        let mut chunk = chunk.clone();
        let text = (chunk.decompress_text_with_limit(left)).and_then(|()| chunk.get_text());
        texts.extend(unpacked(path, text, &mut left)?.map(|text| (chunk.keyword, text)));
    }
    for chunk in &info.utf8_text {
        let mut chunk = chunk.clone();
        let text = (chunk.decompress_text_with_limit(left)).and_then(|()| chunk.get_text());
        match chunk.compressed {
            true => {
                texts.extend(unpacked(path, text, &mut left)?.map(|text| (chunk.keyword, text)))
            }
            false => texts.extend(text.ok().map(|text| (chunk.keyword, text))),
        }
    }
    Ok(texts)
}

/// A text, decompressed within the memory that is `left`; `None` if it is damaged.
fn unpacked(
    path: &Path,
    text: Result<String, DecodingError>,
    left: &mut usize,
) -> Result<Option<String>> {
    let is_too_long = match &text {
        Ok(text) => text.len() > *left,
        // The decoder identifies this error only by its text.
        Err(error) => error.to_string().contains("decompression space"),
    };
    if is_too_long {
        let what = format!("its compressed texts have more than {TEXT_MEMORY} bytes");
        let help = "write the picture again without them";
        return Err(Error::unsupported(path, "", what, help));
    }
    Ok(text.ok().inspect(|text| *left -= text.len()))
}
