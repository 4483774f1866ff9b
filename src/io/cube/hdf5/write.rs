//! Writing a cube as HDF5: one array `data`, contiguous and little-endian, with the attributes `axes`, `start` and `bin_width`.
//!
//! The layout is that of "HDF5 File Format Specification Version 3.0": a superblock of version 2, the object headers
//! (version 2) of the root group and of the array, each with its checksum, and the samples. All of it but the samples
//! has a size that is known beforehand, so that it is written from front to back; HDF5 1.8 and later read it.

use std::io::Write;

use super::super::wanted::FileTimes;
use crate::io::npy::Dtype;

/// Bytes before the samples.
const START: usize = 2048;
const NOWHERE: u64 = u64::MAX;

/// Writes everything before the samples, which must follow in C order, little-endian.
pub(in super::super) fn write(
    to: &mut dyn Write,
    dtype: &Dtype,
    sizes: &[usize],
    axes: &str,
    times: Option<FileTimes>,
) -> std::io::Result<()> {
    let array = array(dtype, sizes, axes, times);
    let root = root(SUPERBLOCK as u64 + ROOT as u64);
    let mut head =
        superblock(START as u64 + bytes_of(dtype) * sizes.iter().product::<usize>() as u64);
    head.extend(root);
    head.resize(SUPERBLOCK + ROOT, 0);
    head.extend(array);
    debug_assert!(head.len() <= START);
    head.resize(START, 0);
    to.write_all(&head)
}

/// Bytes of the superblock, and the room for the root group.
const SUPERBLOCK: usize = 48;
const ROOT: usize = 208;

fn superblock(end: u64) -> Vec<u8> {
    let mut block = b"\x89HDF\r\n\x1a\n".to_vec();
    // Version 2, addresses and lengths of 8 bytes, no flags.
    block.extend([2, 8, 8, 0]);
    for address in [0, NOWHERE, end, SUPERBLOCK as u64] {
        block.extend(address.to_le_bytes());
    }
    with_checksum(block)
}

/// The root group, whose one link is to the array.
fn root(array: u64) -> Vec<u8> {
    let link_info = [&[0, 0][..], &NOWHERE.to_le_bytes(), &NOWHERE.to_le_bytes()].concat();
    // Version 1, the length of the name in one byte, a hard link.
    let link = [&[1, 0, 4][..], b"data", &array.to_le_bytes()].concat();
    object(&[(0x02, link_info), (0x0a, vec![0, 0]), (0x06, link)])
}

fn array(dtype: &Dtype, sizes: &[usize], axes: &str, times: Option<FileTimes>) -> Vec<u8> {
    let bytes = bytes_of(dtype) * sizes.iter().product::<usize>() as u64;
    // Contiguous: its address and its size.
    let layout = [
        &[3, 1][..],
        &(START as u64).to_le_bytes(),
        &bytes.to_le_bytes(),
    ]
    .concat();
    // By type: dataspace, datatype, fill value, layout, attributes.
    let mut messages = vec![
        (0x01, space(sizes)),
        (0x03, number(dtype)),
        // Space is allocated from the beginning, and no fill value is defined.
        (0x05, vec![3, 0x09]),
        (0x08, layout),
        (0x0c, attribute("axes", &text(axes.len()), axes.as_bytes())),
    ];
    if let Some(FileTimes { start, width, .. }) = times {
        for (name, value) in [("start", start), ("bin_width", width)] {
            messages.push((
                0x0c,
                attribute(name, &number(&Dtype::F64), &value.to_le_bytes()),
            ));
        }
    }
    object(&messages)
}

/// An object header of one chunk.
fn object(messages: &[(u8, Vec<u8>)]) -> Vec<u8> {
    let length: usize = messages.iter().map(|(_, data)| 4 + data.len()).sum();
    // Version 2; the length has four bytes.
    let mut header = b"OHDR\x02\x02".to_vec();
    header.extend((length as u32).to_le_bytes());
    for (kind, data) in messages {
        header.push(*kind);
        header.extend((data.len() as u16).to_le_bytes());
        header.push(0);
        header.extend(data);
    }
    with_checksum(header)
}

fn space(sizes: &[usize]) -> Vec<u8> {
    // Version 2, without maximum sizes, a plain array; a single value has no axes.
    let mut space = vec![2, sizes.len() as u8, 0, u8::from(!sizes.is_empty())];
    space.extend(sizes.iter().flat_map(|n| (*n as u64).to_le_bytes()));
    space
}

/// IEEE floating-point, little-endian.
fn number(dtype: &Dtype) -> Vec<u8> {
    // Bytes; the sign bit; position and length of the exponent; bits of the mantissa; the bias.
    let (bytes, sign, exponent, exponent_bits, mantissa, bias) = match dtype {
        Dtype::F16 => (2u32, 15, 10, 5, 10, 15u32),
        Dtype::F64 => (8, 63, 52, 11, 52, 1023),
        Dtype::F32 | Dtype::Other(_) => (4, 31, 23, 8, 23, 127),
    };
    // Version 1, class 1 (floating-point); little-endian, with the first 1 of the mantissa implied.
    let mut number = vec![0x11, 0x20, sign, 0];
    number.extend(bytes.to_le_bytes());
    // The position of its bits, and their number.
    number.extend([0, 0]);
    number.extend((8 * bytes as u16).to_le_bytes());
    number.extend([exponent, exponent_bits, 0, mantissa]);
    number.extend(bias.to_le_bytes());
    number
}

/// A text of the given number of bytes, padded with zeros, ASCII.
fn text(bytes: usize) -> Vec<u8> {
    let mut text = vec![0x13, 0x01, 0, 0];
    text.extend((bytes as u32).to_le_bytes());
    text
}

fn attribute(name: &str, kind: &[u8], value: &[u8]) -> Vec<u8> {
    let space = space(&[]);
    let mut message = vec![3, 0];
    for length in [name.len() + 1, kind.len(), space.len()] {
        message.extend((length as u16).to_le_bytes());
    }
    // Names in ASCII.
    message.push(0);
    message.extend(name.as_bytes());
    message.push(0);
    message.extend(kind);
    message.extend(space);
    message.extend(value);
    message
}

fn bytes_of(dtype: &Dtype) -> u64 {
    match dtype {
        Dtype::F16 => 2,
        Dtype::F64 => 8,
        Dtype::F32 | Dtype::Other(_) => 4,
    }
}

fn with_checksum(mut block: Vec<u8>) -> Vec<u8> {
    let sum = lookup3(&block);
    block.extend(sum.to_le_bytes());
    block
}

/// Bob Jenkins' hash `lookup3`, 2006 (public domain), of bytes, from 0: HDF5's checksum of metadata.
fn lookup3(bytes: &[u8]) -> u32 {
    let start = 0xdead_beef_u32.wrapping_add(bytes.len() as u32);
    let [mut a, mut b, mut c] = [start; 3];
    let mut rest = bytes;
    loop {
        let (block, after) = rest.split_at(rest.len().min(12));
        let mut words = [0; 12];
        words[..block.len()].copy_from_slice(block);
        let word =
            |n: usize| u32::from_le_bytes([words[n], words[n + 1], words[n + 2], words[n + 3]]);
        if block.is_empty() {
            return c;
        }
        a = a.wrapping_add(word(0));
        b = b.wrapping_add(word(4));
        c = c.wrapping_add(word(8));
        if after.is_empty() {
            break;
        }
        // The function's mixing step.
        a = a.wrapping_sub(c) ^ c.rotate_left(4);
        c = c.wrapping_add(b);
        b = b.wrapping_sub(a) ^ a.rotate_left(6);
        a = a.wrapping_add(c);
        c = c.wrapping_sub(b) ^ b.rotate_left(8);
        b = b.wrapping_add(a);
        a = a.wrapping_sub(c) ^ c.rotate_left(16);
        c = c.wrapping_add(b);
        b = b.wrapping_sub(a) ^ a.rotate_left(19);
        a = a.wrapping_add(c);
        c = c.wrapping_sub(b) ^ b.rotate_left(4);
        b = b.wrapping_add(a);
        rest = after;
    }
    // The function's final steps.
    c = (c ^ b).wrapping_sub(b.rotate_left(14));
    a = (a ^ c).wrapping_sub(c.rotate_left(11));
    b = (b ^ a).wrapping_sub(a.rotate_left(25));
    c = (c ^ b).wrapping_sub(b.rotate_left(16));
    a = (a ^ c).wrapping_sub(c.rotate_left(4));
    b = (b ^ a).wrapping_sub(a.rotate_left(14));
    (c ^ b).wrapping_sub(b.rotate_left(24))
}

#[cfg(test)]
mod tests {
    /// Values of the author's own test (`driver5` of lookup3.c, initial value 0).
    #[test]
    fn the_checksum_is_that_of_its_author() {
        assert_eq!(super::lookup3(b""), 0xdead_beef);
        assert_eq!(
            super::lookup3(b"Four score and seven years ago"),
            0x1777_0551
        );
    }
}
