//! Arrays of any shape as numbers or text: pictures, masks. NaN and infinity are values like others.

use std::path::Path;

use half::f16;

use super::archive::Stored;
use super::header::{self, Dtype, Header};
use super::place::Place;
use crate::io::budget::Budget;
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
pub(super) fn read(stored: &mut Stored, file: &Path, budget: &Budget) -> Result<Plain> {
    let mut array = Array::open(stored, file, budget)?;
    let samples = array.numbers()?;
    Ok(Plain {
        shape: array.header.shape,
        samples,
    })
}

/// Reads an array of one text (`<U…`, shape ()).
pub(super) fn text(stored: &mut Stored, file: &Path, budget: &Budget) -> Result<String> {
    let mut array = Array::open(stored, file, budget)?;
    let Dtype::Other(descr) = &array.header.dtype else {
        return Err(unsupported(&array.stored.place, "is no single text"));
    };
    let length = descr.strip_prefix("<U").and_then(|n| n.parse().ok());
    let Some(length) = length.filter(|_| array.header.shape.is_empty()) else {
        return Err(unsupported(&array.stored.place, "is no single text"));
    };
    array.count = length;
    let characters = array.samples(|c| char::from_u32(u32::from_le_bytes(c)))?;
    let text: Option<String> = characters.into_iter().collect();
    Ok(text.unwrap_or_default().trim_end_matches('\0').to_string())
}

fn unsupported(place: &Place, what: &str) -> Error {
    place.unsupported(
        "header",
        format!("the array {what}"),
        "numpy.save(path, array.astype(numpy.float64))",
    )
}

/// An array after its header.
struct Array<'a, 'b> {
    stored: &'a mut Stored<'b>,
    header: Header,
    header_bytes: u64,
    /// How many samples it has.
    count: usize,
    file: &'a Path,
    budget: &'a Budget,
}

impl<'a, 'b> Array<'a, 'b> {
    fn open(stored: &'a mut Stored<'b>, file: &'a Path, budget: &'a Budget) -> Result<Self> {
        let (header, header_bytes) = header::read(stored.reader, &stored.place)?;
        if header.fortran_order && header.shape.len() > 1 {
            return Err(unsupported(&stored.place, "is in Fortran order"));
        }
        let mut sizes = header.shape.iter();
        let count = sizes.try_fold(1usize, |product, n| product.checked_mul(*n));
        Ok(Array {
            count: count.unwrap_or(usize::MAX),
            stored,
            header,
            header_bytes,
            file,
            budget,
        })
    }

    fn numbers(&mut self) -> Result<Numbers> {
        let big = self.header.big_endian;
        Ok(match self.header.dtype.clone() {
            Dtype::F16 if big => Numbers::F32(self.samples(|b| f16::from_be_bytes(b).to_f32())?),
            Dtype::F16 => Numbers::F32(self.samples(|b| f16::from_le_bytes(b).to_f32())?),
            Dtype::F32 if big => Numbers::F32(self.samples(f32::from_be_bytes)?),
            Dtype::F32 => Numbers::F32(self.samples(f32::from_le_bytes)?),
            Dtype::F64 if big => Numbers::F64(self.samples(f64::from_be_bytes)?),
            Dtype::F64 => Numbers::F64(self.samples(f64::from_le_bytes)?),
            Dtype::Other(descr) => match descr.as_str() {
                "|b1" | "|u1" => Numbers::U32(self.samples(|[b]| b.into())?),
                "|i1" => Numbers::I32(self.samples(|b| i8::from_le_bytes(b).into())?),
                "<u2" => Numbers::U32(self.samples(|b| u16::from_le_bytes(b).into())?),
                "<i2" => Numbers::I32(self.samples(|b| i16::from_le_bytes(b).into())?),
                "<u4" => Numbers::U32(self.samples(u32::from_le_bytes)?),
                "<i4" => Numbers::I32(self.samples(i32::from_le_bytes)?),
                _ => return Err(unsupported(&self.stored.place, "does not hold numbers")),
            },
        })
    }

    /// All samples, after a check that the file is as long as they take.
    fn samples<const N: usize, T>(&mut self, sample: impl Fn([u8; N]) -> T) -> Result<Vec<T>> {
        let bytes = self.count.checked_mul(N).filter(|_| self.count <= MOST);
        let Some(bytes) = bytes else {
            return Err(unsupported(
                &self.stored.place,
                "has more samples than can be read",
            ));
        };
        self.stored
            .check_length(self.header_bytes.saturating_add(bytes as u64))?;
        let memory = (self.count as u64).saturating_mul(size_of::<T>() as u64);
        self.budget.take(memory, self.file)?;
        self.stored.samples(self.count, sample, |_, _, _| Ok(()))
    }
}
