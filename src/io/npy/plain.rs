//! Arrays of any shape as f64: pictures, masks, texts. NaN and infinity are values like others.

use half::f16;

use super::archive::Stored;
use super::{Dtype, Header, Place, header};
use crate::{Error, Result};

/// The most samples that are read.
const MOST: usize = 1 << 32;

/// An array of numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct Plain {
    /// Sizes, the slowest first.
    pub shape: Vec<usize>,
    /// All samples; single precision where they are stored in it, or in half.
    pub samples: Numbers,
}

/// Samples as they are stored, or wider.
#[derive(Debug, Clone, PartialEq)]
pub enum Numbers {
    /// `f2`, `f4`.
    F32(Vec<f32>),
    /// `f8`.
    F64(Vec<f64>),
    /// `i1`, `i2`, `i4`.
    I32(Vec<i32>),
    /// `b1`, `u1`, `u2`, `u4`.
    U32(Vec<u32>),
}

/// Reads an array of numbers.
pub(super) fn read(stored: &mut Stored) -> Result<Plain> {
    let (header, place, bytes) = raw(stored)?;
    let samples = numbers(&header, &bytes, &place)?;
    Ok(Plain {
        shape: header.shape,
        samples,
    })
}

/// Reads an array of one text (`<U…`, shape ()).
pub(super) fn text(stored: &mut Stored) -> Result<String> {
    let (header, place, bytes) = raw(stored)?;
    let is_text = matches!(&header.dtype, Dtype::Other(descr) if descr.starts_with("<U"));
    if !is_text || !header.shape.is_empty() {
        return Err(unsupported(&place, "is no single text"));
    }
    let characters = bytes
        .as_chunks::<4>()
        .0
        .iter()
        .map(|c| char::from_u32(u32::from_le_bytes(*c)));
    let text: Option<String> = characters.collect();
    Ok(text.unwrap_or_default().trim_end_matches('\0').to_string())
}

fn unsupported(place: &Place, what: &str) -> Error {
    place.unsupported(
        "header",
        format!("the array {what}"),
        "numpy.save(path, array.astype(numpy.float64))",
    )
}

/// Header and bytes of the samples; as many as the header says, or an error.
fn raw(stored: &mut Stored) -> Result<(Header, Place, Vec<u8>)> {
    let (header, header_bytes) = header::read(stored.reader, &stored.place)?;
    let place = stored.place.clone();
    if header.fortran_order && header.shape.len() > 1 {
        return Err(unsupported(&place, "is in Fortran order"));
    }
    let Some(size) = size(&header.dtype) else {
        return Err(unsupported(&place, "does not hold numbers"));
    };
    let count = header
        .shape
        .iter()
        .try_fold(1usize, |product, n| product.checked_mul(*n));
    let Some(length) = count
        .filter(|n| *n <= MOST)
        .and_then(|n| n.checked_mul(size))
    else {
        return Err(unsupported(&place, "has more samples than can be read"));
    };
    stored.check_length(header_bytes.saturating_add(length as u64))?;
    let mut bytes = vec![0; length];
    let read = stored.reader.read_exact(&mut bytes);
    read.map_err(|error| place.read_error("samples", error))?;
    Ok((header, place, bytes))
}

/// Bytes of a sample.
fn size(dtype: &Dtype) -> Option<usize> {
    match dtype {
        Dtype::F16 => Some(2),
        Dtype::F32 => Some(4),
        Dtype::F64 => Some(8),
        Dtype::Other(descr) => match descr.as_str() {
            "|b1" | "|u1" | "|i1" => Some(1),
            "<u2" | "<i2" => Some(2),
            "<u4" | "<i4" => Some(4),
            text => text
                .strip_prefix("<U")?
                .parse::<usize>()
                .ok()?
                .checked_mul(4),
        },
    }
}

fn numbers(header: &Header, bytes: &[u8], place: &Place) -> Result<Numbers> {
    let big = header.big_endian;
    Ok(match &header.dtype {
        Dtype::F16 if big => Numbers::F32(of(bytes, |b| f16::from_be_bytes(b).to_f32())),
        Dtype::F16 => Numbers::F32(of(bytes, |b| f16::from_le_bytes(b).to_f32())),
        Dtype::F32 if big => Numbers::F32(of(bytes, f32::from_be_bytes)),
        Dtype::F32 => Numbers::F32(of(bytes, f32::from_le_bytes)),
        Dtype::F64 if big => Numbers::F64(of(bytes, f64::from_be_bytes)),
        Dtype::F64 => Numbers::F64(of(bytes, f64::from_le_bytes)),
        Dtype::Other(descr) => match descr.as_str() {
            "|b1" | "|u1" => Numbers::U32(of(bytes, |[b]| b.into())),
            "|i1" => Numbers::I32(of(bytes, |b| i8::from_le_bytes(b).into())),
            "<u2" => Numbers::U32(of(bytes, |b| u16::from_le_bytes(b).into())),
            "<i2" => Numbers::I32(of(bytes, |b| i16::from_le_bytes(b).into())),
            "<u4" => Numbers::U32(of(bytes, u32::from_le_bytes)),
            "<i4" => Numbers::I32(of(bytes, i32::from_le_bytes)),
            _ => return Err(unsupported(place, "does not hold numbers")),
        },
    })
}

fn of<const N: usize, T>(bytes: &[u8], sample: impl Fn([u8; N]) -> T) -> Vec<T> {
    bytes
        .as_chunks::<N>()
        .0
        .iter()
        .map(|b| sample(*b))
        .collect()
}
