//! Reads PNG pictures as 8-bit RGBA, without this program's own readers.

use std::io::Cursor;

use ::png::{ColorType, Decoder, DecodingError, Transformations};

/// A picture, row by row.
#[derive(Debug, PartialEq)]
pub struct Picture {
    pub width: u32,
    pub height: u32,
    pub rgba: Vec<u8>,
}

/// Decodes a PNG.
pub fn decode(bytes: &[u8]) -> Result<Picture, DecodingError> {
    let mut decoder = Decoder::new(Cursor::new(bytes));
    decoder.set_transformations(Transformations::normalize_to_color8() | Transformations::ALPHA);
    let mut reader = decoder.read_info()?;
    let mut samples = vec![0; reader.output_buffer_size().unwrap()];
    let frame = reader.next_frame(&mut samples)?;
    let rgba = match frame.color_type {
        ColorType::GrayscaleAlpha => {
            let pairs = samples.chunks_exact(2);
            pairs.flat_map(|p| [p[0], p[0], p[0], p[1]]).collect()
        }
        _ => samples,
    };
    let (width, height) = (frame.width, frame.height);
    assert_eq!(rgba.len(), 4 * width as usize * height as usize);
    Ok(Picture {
        width,
        height,
        rgba,
    })
}
