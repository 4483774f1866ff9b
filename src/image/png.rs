//! PNG files: what a display shows.

use std::path::Path;

use ::png::{BitDepth, ColorType, Compression, Encoder, EncodingError, SrgbRenderingIntent};

use super::file::write_failed;
use super::layers::{check_metadata, pixel_count};
use super::write_atomically;
use crate::error::{Error, Result};

/// Writes 8-bit sRGB pixels (3 bytes each, row 0 at the top) to `path`, whole or not at all.
///
/// `text` entries become text chunks, Latin-1 where they are ASCII and UTF-8 otherwise.
///
/// # Errors
/// A size of 0 or a `rgb` of another length than 3·width·height; keys that a text chunk cannot have;
/// I/O errors.
pub fn write(
    path: &Path,
    width: u32,
    height: u32,
    rgb: &[u8],
    text: &[(String, String)],
) -> Result<()> {
    if rgb.len() != 3 * pixel_count(width, height)? {
        let what = format!("{} bytes for {width} × {height} RGB pixels", rgb.len());
        return Err(Error::invalid(path, "", what, ""));
    }
    for (key, value) in text {
        check_metadata(key, value)?;
    }
    write_atomically(path, |writer| {
        let encoded = encode(writer, width, height, rgb, text);
        encoded.map_err(|e| failure(path, e))
    })
}

fn encode(
    writer: impl std::io::Write,
    width: u32,
    height: u32,
    rgb: &[u8],
    text: &[(String, String)],
) -> Result<(), EncodingError> {
    let mut encoder = Encoder::new(writer, width, height);
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_compression(Compression::Balanced);
    encoder.set_source_srgb(SrgbRenderingIntent::RelativeColorimetric);
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
