//! Arrays of any shape as numbers or text: pictures, masks. NaN and infinity are allowed values.

use std::path::Path;

use half::f16;

use super::archive::Stored;
use super::header::{self, Dtype, Header};
use super::place::Place;
use crate::io::budget::Budget;
use crate::{Error, Result};

/// The maximum number of samples.
const MOST: usize = 1 << 32;

/// The limit up to which f64 represents all integers.
const LARGEST_EXACT: i128 = 1 << 53;

/// An array of numbers.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Plain {
    /// Sizes, the slowest first whatever the order in the file.
    pub shape: Vec<usize>,
    /// All samples; in single precision if they are stored in single or half precision.
    pub samples: Numbers,
}

/// Samples in their stored type, or a wider one.
#[derive(Debug, Clone, PartialEq)]
pub enum Numbers {
    /// `f2`, `f4`.
    F32(Vec<f32>),
    /// `f8`.
    F64(Vec<f64>),
    /// `i1`, `i2`, `i4`; `i8` if all values are in range.
    I32(Vec<i32>),
    /// `b1`, `u1`, `u2`, `u4`; `u8` if all values are in range, except its largest number, which becomes that of `u4`.
    U32(Vec<u32>),
}

impl Numbers {
    /// Bytes per number.
    pub fn size(&self) -> u64 {
        match self {
            Numbers::F64(_) => 8,
            Numbers::F32(_) | Numbers::I32(_) | Numbers::U32(_) => 4,
        }
    }

    /// All numbers as f64.
    pub fn into_f64(self) -> Vec<f64> {
        match self {
            Numbers::F32(v) => v.into_iter().map(f64::from).collect(),
            Numbers::F64(v) => v,
            Numbers::I32(v) => v.into_iter().map(f64::from).collect(),
            Numbers::U32(v) => v.into_iter().map(f64::from).collect(),
        }
    }
}

/// Reads an array of numbers.
pub(super) fn read(stored: &mut Stored, file: &Path, budget: &Budget) -> Result<Plain> {
    let mut array = Array::open(stored, file, budget)?;
    let samples = array.numbers()?;
    let samples = array.in_c_order(samples)?;
    Ok(Plain {
        shape: array.header.shape,
        samples,
    })
}

/// Reads an array of numbers with one axis.
pub(super) fn read_list(stored: &mut Stored, file: &Path, budget: &Budget) -> Result<Numbers> {
    let mut array = Array::open(stored, file, budget)?;
    let shape = &array.header.shape;
    if shape.len() != 1 {
        let what = format!("an array of shape {shape:?} is not one-dimensional");
        return Err(Error::invalid(
            file,
            "",
            what,
            "give an array of shape (n,)",
        ));
    }
    array.numbers()
}

/// Reads an array with a single text (`<U…` or `>U…`; shape (), or (1), which NumPy makes of it in Fortran order).
pub(super) fn text(stored: &mut Stored, file: &Path, budget: &Budget) -> Result<String> {
    let mut array = Array::open(stored, file, budget)?;
    let Dtype::Other(descr) = &array.header.dtype else {
        return Err(unsupported(&array.stored.place, "is not a single text"));
    };
    type Character = fn([u8; 4]) -> u32;
    let orders: [(&str, Character); 2] = [("<U", u32::from_le_bytes), (">U", u32::from_be_bytes)];
    let of_order = |(prefix, character): (&str, Character)| {
        let length: usize = descr.strip_prefix(prefix)?.parse().ok()?;
        Some((length, character))
    };
    let found = orders.into_iter().find_map(of_order);
    let is_single = array.header.shape.iter().all(|n| *n == 1);
    let Some((length, character)) = found.filter(|_| is_single) else {
        return Err(unsupported(&array.stored.place, "is not a single text"));
    };
    array.count = length;
    let characters = array.samples(|c| char::from_u32(character(c)))?;
    let text: Option<String> = characters.into_iter().collect();
    Ok(text.unwrap_or_default().trim_end_matches('\0').to_string())
}

/// Converts samples of an array of this shape from Fortran order to C order.
fn transposed<T: Copy>(samples: &[T], shape: &[usize]) -> Vec<T> {
    let mut index = vec![0; shape.len()];
    let mut ordered = Vec::with_capacity(samples.len());
    for _ in 0..samples.len() {
        let place = index
            .iter()
            .zip(shape)
            .rev()
            .fold(0, |place, (i, n)| place * n + i);
        ordered.push(samples[place]);
        // The next index, the last axis fastest.
        for (i, n) in index.iter_mut().zip(shape).rev() {
            *i += 1;
            if *i < *n {
                break;
            }
            *i = 0;
        }
    }
    ordered
}

/// The error for samples whose type is not a number of at most 64 bits.
fn no_numbers(place: &Place, descr: &str) -> Error {
    let kind = match descr
        .trim_start_matches(['<', '>', '|', '='])
        .chars()
        .next()
    {
        Some('c') => "complex numbers",
        Some('f') => "numbers of more than 64 bits",
        Some('O') => "Python objects",
        Some('S' | 'U' | 'a') => "texts",
        Some('M' | 'm') => "dates",
        Some('[' | 'V') => "records of several fields",
        _ => "samples of a type that is not known",
    };
    unsupported(place, &format!("holds {kind} ({descr})"))
}

fn unsupported(place: &Place, what: &str) -> Error {
    place.unsupported(
        "header",
        format!("the array {what}"),
        "numpy.save(path, array.astype(numpy.float64))",
    )
}

/// An array whose header has been read.
struct Array<'a, 'b> {
    stored: &'a mut Stored<'b>,
    header: Header,
    header_bytes: u64,
    /// The number of samples.
    count: usize,
    file: &'a Path,
    budget: &'a Budget,
}

impl<'a, 'b> Array<'a, 'b> {
    fn open(stored: &'a mut Stored<'b>, file: &'a Path, budget: &'a Budget) -> Result<Self> {
        let (header, header_bytes) = header::read(stored.reader, &stored.place)?;
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
            Dtype::Other(descr) => self.integers(&descr)?,
        })
    }

    fn integers(&mut self, descr: &str) -> Result<Numbers> {
        let big = self.header.big_endian;
        Ok(match descr.trim_start_matches(['<', '>', '|', '=']) {
            "b1" | "u1" => Numbers::U32(self.samples(|[b]| b.into())?),
            "i1" => Numbers::I32(self.samples(|b| i8::from_le_bytes(b).into())?),
            "u2" if big => Numbers::U32(self.samples(|b| u16::from_be_bytes(b).into())?),
            "u2" => Numbers::U32(self.samples(|b| u16::from_le_bytes(b).into())?),
            "i2" if big => Numbers::I32(self.samples(|b| i16::from_be_bytes(b).into())?),
            "i2" => Numbers::I32(self.samples(|b| i16::from_le_bytes(b).into())?),
            "u4" if big => Numbers::U32(self.samples(u32::from_be_bytes)?),
            "u4" => Numbers::U32(self.samples(u32::from_le_bytes)?),
            "i4" if big => Numbers::I32(self.samples(i32::from_be_bytes)?),
            "i4" => Numbers::I32(self.samples(i32::from_le_bytes)?),
            "u8" if big => self.narrow(u64::from_be_bytes)?,
            "u8" => self.narrow(u64::from_le_bytes)?,
            "i8" if big => self.narrow(i64::from_be_bytes)?,
            "i8" => self.narrow(i64::from_le_bytes)?,
            _ => return Err(no_numbers(&self.stored.place, descr)),
        })
    }

    /// Converts 64-bit integers to 32-bit ones if possible, or else to f64, which represents them up to 2⁵³.
    fn narrow<T: Copy + Into<i128>>(&mut self, sample: impl Fn([u8; 8]) -> T) -> Result<Numbers> {
        let samples = self.samples(|bytes| match sample(bytes).into() {
            // −1 as numpy converts it to an unsigned integer.
            n if n == i128::from(u64::MAX) => i128::from(u32::MAX),
            n => n,
        })?;
        self.take_copy()?;
        let within = |low: i128, high: i128| samples.iter().all(|n| (low..=high).contains(n));
        if within(0, u32::MAX.into()) {
            return Ok(Numbers::U32(samples.iter().map(|n| *n as u32).collect()));
        }
        if within(i32::MIN.into(), i32::MAX.into()) {
            return Ok(Numbers::I32(samples.iter().map(|n| *n as i32).collect()));
        }
        if within(-LARGEST_EXACT, LARGEST_EXACT) {
            return Ok(Numbers::F64(samples.iter().map(|n| *n as f64).collect()));
        }
        Err(unsupported(
            &self.stored.place,
            "holds integers beyond 2^53, which double precision cannot represent exactly",
        ))
    }

    /// The samples in C order.
    fn in_c_order(&self, samples: Numbers) -> Result<Numbers> {
        let shape = &self.header.shape;
        if !self.header.fortran_order || shape.len() < 2 {
            return Ok(samples);
        }
        self.take_copy()?;
        Ok(match samples {
            Numbers::F32(v) => Numbers::F32(transposed(&v, shape)),
            Numbers::F64(v) => Numbers::F64(transposed(&v, shape)),
            Numbers::I32(v) => Numbers::I32(transposed(&v, shape)),
            Numbers::U32(v) => Numbers::U32(transposed(&v, shape)),
        })
    }

    /// Reserves memory for a second copy of all samples.
    fn take_copy(&self) -> Result<()> {
        let bytes = (self.count as u64).saturating_mul(size_of::<f64>() as u64);
        self.budget.take(bytes, self.file)
    }

    /// All samples, after a check that the file has the expected length.
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
