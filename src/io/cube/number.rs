//! Types of samples in files.

use half::f16;

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
}

impl Number {
    /// Bytes in the file.
    pub fn stored(self) -> u64 {
        match self {
            Number::U8 | Number::I8 => 1,
            Number::F16 | Number::U16 | Number::I16 => 2,
            Number::F32 | Number::U32 | Number::I32 => 4,
            Number::F64 => 8,
        }
    }

    /// The type in memory. Every integer is exact in it.
    pub fn loaded(self) -> (Dtype, u64) {
        match self {
            Number::F16 => (Dtype::F16, 2),
            Number::F32 | Number::U8 | Number::I8 | Number::U16 | Number::I16 => (Dtype::F32, 4),
            Number::F64 | Number::U32 | Number::I32 => (Dtype::F64, 8),
        }
    }

    /// The numbers that `bytes` are, behind what is in `to`.
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
        }
    }
}
