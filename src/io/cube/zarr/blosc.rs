//! Decodes the container of Blosc 1, which zarr-python and numcodecs write.
//!
//! A header of 16 bytes (version, version of the codec, flags, bytes per number; then as u32 the bytes decoded, those of a block, and all
//! of the container's), the offset of each block, and the blocks. A block is one stream, or one for each byte of a number; a
//! stream is its length and its bytes, which are compressed unless that is the decoded length. Decoded blocks are shuffled: first the
//! first bytes of all numbers, then their second ones; or so by bits. Source: README_CHUNK_FORMAT.rst of c-blosc 1.21, and for BloscLZ
//! the format of FastLZ at level 2 (`blosclz.c`).

use super::decompress::{Broken, lz4, zlib, zstd};

const HEADER: usize = 16;

/// Bits of the flags.
const BY_BYTES: u8 = 1;
const IS_COPY: u8 = 2;
const BY_BITS: u8 = 4;
const IS_ONE_STREAM: u8 = 16;

/// Decodes the container, to at most `most` bytes.
pub(super) fn decode(bytes: &[u8], most: u64) -> Result<Vec<u8>, Broken> {
    let short = || "it is too short for Blosc".to_string();
    let header: &[u8; HEADER] = bytes.first_chunk().ok_or_else(short)?;
    let (version, flags, width) = (header[0], header[2], usize::from(header[3]).max(1));
    // Blosc 1 writes versions 1 and 2 of its format.
    if version > 2 {
        return Err("it is encoded by Blosc 2".into());
    }
    let word = |at: usize| number(bytes, at).ok_or_else(short);
    let (decoded, block) = (word(4)?, word(8)?);
    if decoded as u64 > most {
        return Err(format!(
            "it decodes to {decoded} bytes, more than a chunk has"
        ));
    }
    if flags & IS_COPY != 0 {
        let copy = bytes.get(HEADER..HEADER + decoded).ok_or_else(short)?;
        return Ok(copy.to_vec());
    }
    if decoded > 0 && block == 0 {
        return Err("its blocks are empty".into());
    }
    let mut out = Vec::with_capacity(decoded);
    for k in 0..decoded.div_ceil(block.max(1)) {
        let length = block.min(decoded - k * block);
        let is_last = length < block;
        let is_one = flags & IS_ONE_STREAM != 0 || is_last;
        let streams = if is_one { 1 } else { width };
        let mut at = word(HEADER + 4 * k)?;
        let mut own = Vec::with_capacity(length);
        for _ in 0..streams {
            // The remainder that does not divide evenly is in a last block with a single stream.
            let part = length / streams;
            let size = word(at)?;
            at += 4;
            let end = at.checked_add(size).ok_or_else(short)?;
            let stream = bytes.get(at..end).ok_or_else(short)?;
            at = end;
            // A stream as long as its decoded data is stored uncompressed; the codec of others is in the upper three bits of the flags.
            match size == part {
                true => own.extend_from_slice(stream),
                false => own.extend(decompressed(stream, flags >> 5, part)?),
            }
        }
        if own.len() != length {
            return Err("a block has another length than it declares".into());
        }
        match () {
            () if flags & BY_BYTES != 0 && width > 1 => unshuffle(&own, width, &mut out),
            () if flags & BY_BITS != 0 && length >= width => unshuffle_bits(&own, width, &mut out),
            () => out.extend_from_slice(&own),
        }
    }
    Ok(out)
}

/// The u32 at `at`.
fn number(bytes: &[u8], at: usize) -> Option<usize> {
    let word = bytes.get(at..)?.first_chunk::<4>()?;
    usize::try_from(u32::from_le_bytes(*word)).ok()
}

/// Decodes a stream of `length` bytes with the codec of this number.
fn decompressed(stream: &[u8], codec: u8, length: usize) -> Result<Vec<u8>, Broken> {
    let bytes = match codec {
        0 => blosclz(stream, length).ok_or("BloscLZ: it is damaged")?,
        1 => lz4(stream, length)?,
        2 => {
            return Err(
                "it is compressed by Snappy, which is not supported: write it with LZ4 or zstd"
                    .into(),
            );
        }
        3 => zlib(stream, length as u64)?,
        4 => zstd(stream, length as u64)?,
        _ => return Err(format!("codec {codec} of Blosc is unknown")),
    };
    match bytes.len() == length {
        true => Ok(bytes),
        false => Err("a stream has another length than it declares".into()),
    }
}

/// BloscLZ: literals, and matches of earlier output; `None` for damaged data.
fn blosclz(from: &[u8], length: usize) -> Option<Vec<u8>> {
    /// Matches at larger distances have 16 more bits.
    const NEAR: usize = 8191;
    let mut to = Vec::with_capacity(length);
    let mut bytes = from.iter().copied();
    // The first control byte always means literals.
    let mut control = bytes.next()? & 31;
    loop {
        if control < 32 {
            for _ in 0..=control {
                to.push(bytes.next()?);
            }
        } else {
            // The upper three bits, 1 to 7, mean matches of three bytes or more.
            let mut count = usize::from(control >> 5) + 2;
            if control >> 5 == 7 {
                loop {
                    let more = bytes.next()?;
                    count += usize::from(more);
                    if more != 255 {
                        break;
                    }
                }
            }
            let far = usize::from(control & 31) << 8;
            let near = usize::from(bytes.next()?);
            let distance = match (far, near) {
                (0x1f00, 255) => {
                    let [high, low] = [bytes.next()?, bytes.next()?];
                    NEAR + (usize::from(high) << 8 | usize::from(low))
                }
                _ => far + near,
            };
            // Distance 0 means the previous byte.
            let start = to.len().checked_sub(distance + 1)?;
            if to.len() + count > length {
                return None;
            }
            // A match may overlap its own output.
            for k in start..start + count {
                to.push(to[k]);
            }
        }
        if to.len() > length {
            return None;
        }
        match bytes.next() {
            Some(next) => control = next,
            None => return Some(to),
        }
    }
}

/// Reorders bytes: the input has the k-th bytes of all numbers for one k after the other, and the remainder at the end.
fn unshuffle(from: &[u8], width: usize, to: &mut Vec<u8>) {
    let count = from.len() / width;
    for n in 0..count {
        to.extend((0..width).map(|k| from[k * count + n]));
    }
    to.extend_from_slice(&from[count * width..]);
}

/// The same for bits, the lowest first, eight numbers to a byte; if their count is not a multiple of eight, nothing was reordered.
fn unshuffle_bits(from: &[u8], width: usize, to: &mut Vec<u8>) {
    let count = from.len() / width;
    if !count.is_multiple_of(8) {
        to.extend_from_slice(from);
        return;
    }
    let row = count / 8;
    for n in 0..count {
        for k in 0..width {
            let bit = |b: usize| (from[(8 * k + b) * row + n / 8] >> (n % 8) & 1) << b;
            to.push((0..8).map(bit).sum());
        }
    }
    to.extend_from_slice(&from[count * width..]);
}
