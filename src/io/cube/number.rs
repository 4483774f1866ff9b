//! Types of samples in files.

use half::f16;

use super::samples::CubeSamples;
use crate::io::npy::Dtype;

/// The types of samples that are read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Number {
    F16,
    F32,
    F64,
    U8,
    I8,
    U16,
    I16,
    U32,
    I32,
    U64,
    I64,
}

/// Integers up to here are exact in double precision.
const EXACT: u64 = 1 << 53;

/// As a floating-point number; NaN if that cannot represent it.
pub(super) fn exact_u64(n: u64) -> f64 {
    if n <= EXACT { n as f64 } else { f64::NAN }
}

/// As a floating-point number; NaN if that cannot represent it.
pub(super) fn exact_i64(n: i64) -> f64 {
    match n.unsigned_abs() <= EXACT {
        true => n as f64,
        false => f64::NAN,
    }
}

impl Number {
    /// The description of a sample of this type that was loaded as NaN or infinity, and the advice.
    pub fn refusal(self) -> [&'static str; 2] {
        match self {
            Number::U64 | Number::I64 => [
                "the integer is beyond 2^53, up to which double precision holds all integers",
                "array.astype(numpy.float64) rounds integers",
            ],
            _ => [
                "the sample is not a finite number",
                "radiance must be finite; numpy.nan_to_num replaces NaN and infinity",
            ],
        }
    }

    /// Bytes in the file.
    pub fn stored(self) -> u64 {
        match self {
            Number::U8 | Number::I8 => 1,
            Number::F16 | Number::U16 | Number::I16 => 2,
            Number::F32 | Number::U32 | Number::I32 => 4,
            Number::F64 | Number::U64 | Number::I64 => 8,
        }
    }

    /// The type in memory. Every integer is exact in it, or NaN.
    pub fn loaded(self) -> (Dtype, u64) {
        match self {
            Number::F16 => (Dtype::F16, 2),
            Number::F32 | Number::U8 | Number::I8 | Number::U16 | Number::I16 => (Dtype::F32, 4),
            Number::F64 | Number::U32 | Number::I32 | Number::U64 | Number::I64 => (Dtype::F64, 8),
        }
    }

    /// The samples encoded in `bytes`, in the type in memory.
    pub fn samples(self, bytes: &[u8], big_endian: bool) -> CubeSamples {
        fn each<const N: usize, T>(bytes: &[u8], number: impl Fn([u8; N]) -> T) -> Vec<T> {
            bytes
                .as_chunks::<N>()
                .0
                .iter()
                .map(|b| number(*b))
                .collect()
        }
        match (self, big_endian) {
            (Number::F16, false) => CubeSamples::F16(each(bytes, f16::from_le_bytes)),
            (Number::F32, false) => CubeSamples::F32(each(bytes, f32::from_le_bytes)),
            (Number::F64, false) => CubeSamples::F64(each(bytes, f64::from_le_bytes)),
            // Other layouts are converted via doubles.
            _ => {
                let mut numbers = Vec::with_capacity(bytes.len() / self.stored() as usize);
                self.decode(bytes, big_endian, &mut numbers);
                CubeSamples::of(&self.loaded().0, &numbers)
            }
        }
    }

    /// Appends the numbers encoded in `bytes` to `to`.
    pub fn decode(self, bytes: &[u8], big_endian: bool, to: &mut Vec<f64>) {
        fn each<const N: usize>(bytes: &[u8], to: &mut Vec<f64>, number: impl Fn([u8; N]) -> f64) {
            to.extend(bytes.as_chunks::<N>().0.iter().map(|b| number(*b)));
        }
        match (self, big_endian) {
            (Number::F16, true) => each(bytes, to, |b| f16::from_be_bytes(b).to_f64()),
            (Number::F16, false) => each(bytes, to, |b| f16::from_le_bytes(b).to_f64()),
            (Number::F32, true) => each(bytes, to, |b| f32::from_be_bytes(b).into()),
            (Number::F32, false) => each(bytes, to, |b| f32::from_le_bytes(b).into()),
            (Number::F64, true) => each(bytes, to, f64::from_be_bytes),
            (Number::F64, false) => each(bytes, to, f64::from_le_bytes),
            (Number::U8, _) => each(bytes, to, |[b]| b.into()),
            (Number::I8, _) => each(bytes, to, |b| i8::from_le_bytes(b).into()),
            (Number::U16, true) => each(bytes, to, |b| u16::from_be_bytes(b).into()),
            (Number::U16, false) => each(bytes, to, |b| u16::from_le_bytes(b).into()),
            (Number::I16, true) => each(bytes, to, |b| i16::from_be_bytes(b).into()),
            (Number::I16, false) => each(bytes, to, |b| i16::from_le_bytes(b).into()),
            (Number::U32, true) => each(bytes, to, |b| u32::from_be_bytes(b).into()),
            (Number::U32, false) => each(bytes, to, |b| u32::from_le_bytes(b).into()),
            (Number::I32, true) => each(bytes, to, |b| i32::from_be_bytes(b).into()),
            (Number::I32, false) => each(bytes, to, |b| i32::from_le_bytes(b).into()),
            (Number::U64, true) => each(bytes, to, |b| exact_u64(u64::from_be_bytes(b))),
            (Number::U64, false) => each(bytes, to, |b| exact_u64(u64::from_le_bytes(b))),
            (Number::I64, true) => each(bytes, to, |b| exact_i64(i64::from_be_bytes(b))),
            (Number::I64, false) => each(bytes, to, |b| exact_i64(i64::from_le_bytes(b))),
        }
    }
}
