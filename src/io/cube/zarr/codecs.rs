//! From the bytes of a chunk to its numbers.

use std::io::{Read, Seek, SeekFrom};

use half::f16;

use super::blosc;
use super::decompress::{Broken, gzip, lz4, zlib, zstd};
use super::number::Number;
use crate::io::cube::number::{exact_i64, exact_u64};
use crate::io::files::Reader;

/// A step of the encoding of chunks.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Codec {
    /// Axis i of the stored array is axis `order[i]` of the chunk.
    Transpose {
        order: Vec<usize>,
    },
    Bytes {
        is_big: bool,
    },
    /// Chunks within chunks, with an index of their offsets and lengths.
    Sharding {
        inner: Vec<usize>,
        codecs: Vec<Codec>,
        has_checksum: bool,
        at_start: bool,
    },
    Blosc,
    Gzip,
    /// A block of LZ4 after its decoded length, as numcodecs writes it.
    Lz4,
    Zlib,
    Zstd,
    Crc32c,
}

impl Codec {
    /// Whether it turns numbers into bytes.
    pub fn makes_bytes(&self) -> bool {
        matches!(self, Codec::Bytes { .. } | Codec::Sharding { .. })
    }
}

/// Bytes beside the samples that an encoding may add.
const BESIDE: u64 = 1 << 16;

/// The numbers of a chunk of this size, in C order.
pub(super) fn decode(
    bytes: Vec<u8>,
    codecs: &[Codec],
    chunk: &[usize],
    number: Number,
) -> Result<Vec<f64>, Broken> {
    let count: usize = chunk.iter().product();
    let expected = (count * number.bytes()) as u64;
    let most = expected + BESIDE;
    let mut bytes = bytes;
    // Codecs are listed in the order of encoding; decoding reverses it.
    for codec in codecs.iter().rev() {
        bytes = match codec {
            Codec::Gzip => gzip(&bytes, most)?,
            Codec::Zlib => zlib(&bytes, most)?,
            Codec::Zstd => zstd(&bytes, most)?,
            Codec::Blosc => blosc::decode(&bytes, most)?,
            Codec::Lz4 => {
                let (length, block) = bytes.split_first_chunk().ok_or("it is too short for LZ4")?;
                let length = u64::from(u32::from_le_bytes(*length));
                if length > most {
                    return Err(format!(
                        "it decodes to {length} bytes, more than a chunk has"
                    ));
                }
                lz4(block, length as usize)?
            }
            Codec::Crc32c => checked(bytes)?,
            Codec::Bytes { is_big } => {
                if bytes.len() as u64 != expected {
                    return Err(format!(
                        "it has {} bytes, and {expected} are expected",
                        bytes.len()
                    ));
                }
                let numbers = numbers(&bytes, number, *is_big)?;
                return Ok(transposed(numbers, codecs, chunk));
            }
            Codec::Transpose { .. } | Codec::Sharding { .. } => break,
        };
    }
    Err("its encoding is unknown".into())
}

/// The bytes without the checksum at their end, if that is correct.
fn checked(mut bytes: Vec<u8>) -> Result<Vec<u8>, Broken> {
    let end = bytes
        .len()
        .checked_sub(4)
        .ok_or("it is too short for a checksum")?;
    let said = bytes.split_off(end);
    match crc32c(&bytes).to_le_bytes() == *said {
        true => Ok(bytes),
        false => Err("its checksum is wrong: it is damaged".into()),
    }
}

/// CRC-32C (Castagnoli; RFC 3720, B.4), bit by bit; used only for indices and small chunks.
fn crc32c(bytes: &[u8]) -> u32 {
    let step = |crc: u32, _| match crc & 1 {
        0 => crc >> 1,
        _ => crc >> 1 ^ 0x82f6_3b78,
    };
    !bytes
        .iter()
        .fold(!0, |crc, byte| (0..8).fold(crc ^ u32::from(*byte), step))
}

fn numbers(bytes: &[u8], number: Number, is_big: bool) -> Result<Vec<f64>, Broken> {
    fn each<const N: usize>(
        bytes: &[u8],
        is_big: bool,
        number: impl Fn([u8; N]) -> f64,
    ) -> Vec<f64> {
        let little = |mut word: [u8; N]| {
            if is_big {
                word.reverse();
            }
            number(word)
        };
        bytes
            .as_chunks::<N>()
            .0
            .iter()
            .map(|word| little(*word))
            .collect()
    }
    let numbers = match number {
        Number::F16 => each(bytes, is_big, |b| f16::from_le_bytes(b).to_f64()),
        Number::F32 => each(bytes, is_big, |b| f32::from_le_bytes(b).into()),
        Number::F64 => each(bytes, is_big, f64::from_le_bytes),
        Number::I8 => each(bytes, is_big, |b| i8::from_le_bytes(b).into()),
        Number::I16 => each(bytes, is_big, |b| i16::from_le_bytes(b).into()),
        Number::I32 => each(bytes, is_big, |b| i32::from_le_bytes(b).into()),
        Number::I64 => each(bytes, is_big, |b| exact_i64(i64::from_le_bytes(b))),
        Number::U8 => each(bytes, is_big, |[b]| b.into()),
        Number::U16 => each(bytes, is_big, |b| u16::from_le_bytes(b).into()),
        Number::U32 => each(bytes, is_big, |b| u32::from_le_bytes(b).into()),
        Number::U64 => each(bytes, is_big, |b| exact_u64(u64::from_le_bytes(b))),
    };
    let is_whole = matches!(number, Number::I64 | Number::U64);
    match is_whole && numbers.iter().any(|x| x.is_nan()) {
        true => {
            Err("an integer is beyond 2^53, up to which double precision holds all integers".into())
        }
        false => Ok(numbers),
    }
}

/// Transposes from the stored order to that of the chunk.
fn transposed(numbers: Vec<f64>, codecs: &[Codec], chunk: &[usize]) -> Vec<f64> {
    // Axis i of the stored array is axis place[i] of the chunk.
    let mut place: Vec<usize> = (0..chunk.len()).collect();
    for codec in codecs {
        if let Codec::Transpose { order } = codec {
            place = order.iter().map(|axis| place[*axis]).collect();
        }
    }
    if place.iter().copied().eq(0..chunk.len()) {
        return numbers;
    }
    let mut strides = vec![1; chunk.len()];
    for axis in (1..chunk.len()).rev() {
        strides[axis - 1] = strides[axis] * chunk[axis];
    }
    let mut out = vec![0.0; numbers.len()];
    for (n, number) in numbers.into_iter().enumerate() {
        let (mut rest, mut at) = (n, 0);
        for axis in place.iter().rev() {
            at += rest % chunk[*axis] * strides[*axis];
            rest /= chunk[*axis];
        }
        out[at] = number;
    }
    out
}

/// The chunks of a shard: offset and length; `None` for missing ones.
pub(super) type Index = Vec<Option<(u64, u64)>>;

/// The index of a shard of `count` chunks.
pub(super) fn index(
    reader: &mut Reader,
    count: usize,
    has_checksum: bool,
    at_start: bool,
) -> Result<Index, Broken> {
    let failed = |error: std::io::Error| format!("the index of the shard cannot be read: {error}");
    // An offset and a length for each chunk, 8 bytes each, and optionally a CRC-32C of 4 bytes.
    let bytes = 16 * count + if has_checksum { 4 } else { 0 };
    let length = reader.seek(SeekFrom::End(0)).map_err(failed)?;
    let start = match at_start {
        true => 0,
        false => length
            .checked_sub(bytes as u64)
            .ok_or("it is too short for its index")?,
    };
    if start + bytes as u64 > length {
        return Err("it is too short for its index".into());
    }
    reader.seek(SeekFrom::Start(start)).map_err(failed)?;
    let mut index = vec![0; bytes];
    reader.read_exact(&mut index).map_err(failed)?;
    if has_checksum {
        index = checked(index)?;
    }
    let words: Vec<u64> = index
        .as_chunks()
        .0
        .iter()
        .map(|b| u64::from_le_bytes(*b))
        .collect();
    let entries = words
        .as_chunks::<2>()
        .0
        .iter()
        .map(|[offset, bytes]| match (*offset, *bytes) {
            // The specification's mark for a missing chunk.
            (u64::MAX, u64::MAX) => Ok(None),
            (offset, bytes) if offset.checked_add(bytes).is_some_and(|end| end <= length) => {
                Ok(Some((offset, bytes)))
            }
            _ => Err("its index names a place beyond its end".to_string()),
        });
    entries.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integers_that_double_precision_does_not_hold_are_refused() {
        let most = 1i64 << 53;
        let read = |n: i64, number| numbers(&n.to_le_bytes(), number, false).ok();
        for number in [Number::I64, Number::U64] {
            assert_eq!(read(most, number), Some(vec![9_007_199_254_740_992.0]));
            // As f64 it would round to 2⁵³.
            assert_eq!(read(most + 1, number), None);
            assert_eq!(read(i64::MAX, number), None);
        }
        assert_eq!(
            read(-most, Number::I64),
            Some(vec![-9_007_199_254_740_992.0])
        );
        assert_eq!(read(-most - 1, Number::I64), None);
    }

    /// RFC 3720, B.4: 32 bytes of 0, of 0xff, and ascending.
    #[test]
    fn the_checksum_is_that_of_the_standard() {
        assert_eq!(crc32c(&[0; 32]), 0x8a91_36aa);
        assert_eq!(crc32c(&[0xff; 32]), 0x62a8_ab43);
        let ascending: Vec<u8> = (0..32).collect();
        assert_eq!(crc32c(&ascending), 0x46dd_794e);
    }
}
