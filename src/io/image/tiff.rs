//! TIFF pictures, as written by cameras and scientific programs: grey or RGB, integers or floating-point numbers, in strips or tiles,
//! uncompressed or with deflate, LZW or PackBits. The crate `tiff` reads them, within limits.

use std::io::{BufReader, ErrorKind, Read, Seek, SeekFrom};
use std::path::Path;

use tiff::ColorType;
use tiff::decoder::{Decoder, DecodingResult, Limits};

use crate::error::{Error, Result};
use crate::io::budget::Budget;
use crate::io::open::open_regular;

/// A picture as it is stored.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Tiff {
    /// Columns and rows.
    pub size: [usize; 2],
    /// 1 or 3.
    pub channels: usize,
    /// Row by row, colours fastest; integers are divided by the largest of their type.
    pub samples: Vec<f32>,
    /// Whether samples were integers: codes that represent light by some transfer function.
    pub is_coded: bool,
}

/// The maximum number of pictures in a file.
const MOST: usize = 1 << 16;

/// The number of pictures at the beginning of a file that have the size of the first: the frames of a stack, without previews.
///
/// # Errors
/// The file cannot be read or is broken.
pub fn count(path: &Path) -> Result<usize> {
    let broken = |error| broken(path, error);
    let (reader, length) = open_regular(path)?;
    let mut reader = BufReader::new(reader);
    check_directories(&mut reader, length, MOST, path)?;
    let mut decoder = Decoder::new(reader).map_err(broken)?;
    let size = decoder.dimensions().map_err(broken)?;
    let mut count = 1;
    while decoder.more_images() {
        decoder.next_image().map_err(broken)?;
        if decoder.dimensions().map_err(broken)? != size {
            break;
        }
        count += 1;
        if count > MOST {
            let what = format!("it holds more than {MOST} pictures");
            return Err(Error::unsupported(
                path,
                "",
                what,
                "save it as an array, in .npy",
            ));
        }
    }
    Ok(count)
}

/// Tags below this one are the format's own; the decoder reads no others.
const OWN_TAGS: u16 = 700;
/// Tags with text: names, descriptions, makers, dates, inks, printers.
const TEXTS: [u16; 11] = [269, 270, 271, 272, 285, 305, 306, 315, 316, 333, 337];
/// The type of text.
const TEXT: u16 = 2;

/// Refuses what the decoder would not refuse well, in the directories of the pictures up to `last`: text in place of numbers, for which it
/// prints a line, and overlapping directories, of which a small file can contain more than anyone can wait for.
///
/// Other errors are left to the decoder.
fn check_directories(
    reader: &mut (impl Read + Seek),
    length: u64,
    last: usize,
    path: &Path,
) -> Result<()> {
    let refuse = |what: String| {
        let help = "copy the file again, or save it again";
        Err(Error::invalid(path, "", what, help))
    };
    let read = (|| -> std::io::Result<Option<String>> {
        let header: [u8; 8] = bytes(reader)?;
        // BigTIFF has 43 in place of 42, and numbers of 8 bytes.
        let is_big = matches!(header[2..4], [43, 0] | [0, 43]);
        let numbers = Numbers {
            is_little: header.starts_with(b"II"),
        };
        let width = if is_big { 8 } else { 4 };
        let mut next = match is_big {
            true => numbers.of(&bytes::<8>(reader)?),
            false => numbers.of(&header[4..]),
        };
        let mut entries = 0u64;
        for picture in 0..=last {
            if next == 0 {
                break;
            }
            reader.seek(SeekFrom::Start(next))?;
            let count = match is_big {
                true => numbers.of(&bytes::<8>(reader)?),
                false => numbers.of(&bytes::<2>(reader)?),
            };
            entries = entries.saturating_add(count);
            if entries.saturating_mul(4 + 2 * width) > length {
                let what = format!(
                    "the directories up to that of picture {picture} are longer than the file: they overlap, or it is cut off"
                );
                return Ok(Some(what));
            }
            for _ in 0..count {
                let [tag, kind] =
                    [bytes::<2>(reader)?, bytes::<2>(reader)?].map(|two| numbers.of(&two) as u16);
                if kind == TEXT && tag < OWN_TAGS && !TEXTS.contains(&tag) {
                    let what =
                        format!("tag {tag} of picture {picture} holds text in place of numbers");
                    return Ok(Some(what));
                }
                // The count, and the value or its offset.
                reader.seek_relative(2 * width as i64)?;
            }
            next = match is_big {
                true => numbers.of(&bytes::<8>(reader)?),
                false => numbers.of(&bytes::<4>(reader)?),
            };
        }
        Ok(None)
    })();
    // The decoder starts at the reader's position.
    reader.rewind().map_err(Error::io(path, "cannot read"))?;
    match read {
        Ok(Some(what)) => refuse(what),
        Err(error) if error.kind() != ErrorKind::UnexpectedEof => {
            Err(Error::io(path, "cannot read")(error))
        }
        _ => Ok(()),
    }
}

fn bytes<const N: usize>(reader: &mut impl Read) -> std::io::Result<[u8; N]> {
    let mut bytes = [0; N];
    reader.read_exact(&mut bytes)?;
    Ok(bytes)
}

/// Numbers in the file's byte order.
struct Numbers {
    is_little: bool,
}

impl Numbers {
    fn of(&self, bytes: &[u8]) -> u64 {
        let push = |number: u64, byte: &u8| number << 8 | u64::from(*byte);
        match self.is_little {
            true => bytes.iter().rev().fold(0, push),
            false => bytes.iter().fold(0, push),
        }
    }
}

/// The error for a broken file.
fn broken(path: &Path, error: tiff::TiffError) -> Error {
    match error {
        tiff::TiffError::IoError(error) if error.kind() != std::io::ErrorKind::UnexpectedEof => {
            Error::io(path, "cannot read")(error)
        }
        tiff::TiffError::UnsupportedError(what) => Error::unsupported(
            path,
            "",
            format!("{what}"),
            "save it without compression, or as EXR",
        ),
        error => Error::invalid(
            path,
            "",
            format!("{error}"),
            "copy the file again, or save it again",
        ),
    }
}

/// Reads picture `number` of a file, counted from 0.
///
/// # Errors
/// The file cannot be read or is broken; it needs more memory than `budget` has; it is neither grey nor RGB.
pub fn read(path: &Path, number: usize, budget: &Budget) -> Result<Tiff> {
    let broken = |error| broken(path, error);
    let (reader, length) = open_regular(path)?;
    let mut reader = BufReader::new(reader);
    check_directories(&mut reader, length, number, path)?;
    let mut decoder = Decoder::new(reader).map_err(broken)?;
    if number > 0 {
        decoder.seek_to_image(number).map_err(broken)?;
    }
    let (width, height) = decoder.dimensions().map_err(broken)?;
    let colour = decoder.colortype().map_err(broken)?;
    let (channels, stored) = match colour {
        ColorType::Gray(_) => (1, 1),
        ColorType::GrayA(_) => (1, 2),
        ColorType::RGB(_) => (3, 3),
        ColorType::RGBA(_) => (3, 4),
        other => {
            let what = format!("its colours are {other:?}, neither grey nor red, green and blue");
            return Err(Error::unsupported(path, "", what, "save it as grey or RGB"));
        }
    };
    // No compression expands a byte to more than a few thousand.
    let count = u64::from(width) * u64::from(height) * stored;
    if count > length.saturating_mul(5000) {
        let what = format!("{width} × {height} pixels do not fit in a file of {length} bytes");
        return Err(Error::invalid(
            path,
            "",
            what,
            "copy the file again, or save it again",
        ));
    }
    // The widest sample has eight bytes.
    budget.take(count.saturating_mul(12), path)?;
    let mut limits = Limits::default();
    limits.decoding_buffer_size = usize::try_from(count.saturating_mul(8)).unwrap_or(usize::MAX);
    decoder = decoder.with_limits(limits);
    let (samples, is_coded): (Vec<f32>, bool) = match decoder.read_image().map_err(broken)? {
        DecodingResult::U8(codes) => (codes.iter().map(|n| f32::from(*n) / 255.0).collect(), true),
        DecodingResult::U16(codes) => (
            codes.iter().map(|n| f32::from(*n) / 65535.0).collect(),
            true,
        ),
        DecodingResult::U32(codes) => {
            let part = |n: &u32| (f64::from(*n) / f64::from(u32::MAX)) as f32;
            (codes.iter().map(part).collect(), true)
        }
        DecodingResult::F16(samples) => (samples.iter().map(|x| x.to_f32()).collect(), false),
        DecodingResult::F32(samples) => (samples, false),
        DecodingResult::F64(samples) => (samples.iter().map(|x| *x as f32).collect(), false),
        _ => {
            let what = "its samples are signed integers or of 64 bits";
            return Err(Error::unsupported(
                path,
                "",
                what,
                "save it as u8, u16, u32, f16, f32 or f64",
            ));
        }
    };
    let (stored, pixels) = (stored as usize, width as usize * height as usize);
    if pixels == 0 || samples.len() != pixels * stored {
        let what = "it does not have the samples that it declares";
        return Err(Error::invalid(
            path,
            "",
            what,
            "save it again, one plane for all colours",
        ));
    }
    let samples = samples.chunks(stored).flat_map(|pixel| &pixel[..channels]);
    Ok(Tiff {
        size: [width as usize, height as usize],
        channels,
        samples: samples.copied().collect(),
        is_coded,
    })
}
