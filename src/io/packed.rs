//! The built-in lightmap, which is packed more tightly than an npz can be, so that the crate stays small.
//!
//! Samples of f16 from a Monte Carlo simulation hardly compress as they stand. The 16 bits of each are foretold from the
//! sample before it in time (a), the same bin of the texel to its left (b) and the bin before that one (c), by the median
//! of a, b and a + b − c. What is stored is the difference from that, with its sign as the lowest bit. Differences are
//! grouped by how much a, b and c differ, |a − c| + |b − c|, to the next power of two, because noise is larger where
//! light is: the sizes of the groups (u32), then all low bytes, group by group, then all high bytes; then zlib (by
//! zopfli). Unpacking it gives the bits of `scenes/corner/lightmap.npz`.
//!
//! Source of the prediction and the groups: Weinberger, Seroussi, Sapiro, "The LOCO-I lossless image compression
//! algorithm", IEEE Trans. Image Processing 9 (2000).

use std::io::{Cursor, Read, Write};

use flate2::read::ZlibDecoder;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

/// Rows, columns, time bins, channels.
const SHAPE: [usize; 4] = [242, 66, 153, 1];
/// Groups of differences: nothing differs, or by less than 2, 4, … 2¹⁵.
const GROUPS: usize = 16;
const PACKED: &[u8] = include_bytes!("../../scenes/corner/lightmap.packed");

/// The lightmap as an npz file with the array `radiance`.
pub(super) fn lightmap() -> Vec<u8> {
    // These are our own bytes, and a test unpacks them: what fails here is a broken build.
    archive(&npy(&samples())).expect("the built-in lightmap is whole")
}

/// The samples, f16, little-endian, in C order.
fn samples() -> Vec<u8> {
    let count: usize = SHAPE.iter().product();
    let [_, columns, bins, _] = SHAPE;
    let mut unpacked = Vec::with_capacity(4 * GROUPS + 2 * count);
    ZlibDecoder::new(PACKED)
        .read_to_end(&mut unpacked)
        .expect("the built-in lightmap is whole");
    let (sizes, planes) = unpacked.split_at(4 * GROUPS);
    let (low, high) = planes.split_at(count);

    // Where the next difference of each group is.
    let mut next = [0; GROUPS];
    let sizes = sizes.chunks_exact(4);
    let mut start = 0;
    for (next, size) in next.iter_mut().zip(sizes) {
        *next = start;
        start += u32::from_le_bytes([size[0], size[1], size[2], size[3]]) as usize;
    }

    let mut samples: Vec<i32> = Vec::with_capacity(count);
    for texel in 0..count / bins {
        let is_first = texel % columns == 0;
        let mut before = [0i32; 2];
        for bin in 0..bins {
            let left = match is_first {
                true => 0,
                false => samples[(texel - 1) * bins + bin],
            };
            let [a, c] = before;
            let group = ((a - c).abs() + (left - c).abs()).checked_ilog2();
            let place = &mut next[group.map_or(0, |log| log as usize + 1)];
            let coded = i32::from(u16::from_le_bytes([low[*place], high[*place]]));
            *place += 1;
            let foretold = (a + left - c).clamp(a.min(left), a.max(left));
            let sample = foretold + ((coded >> 1) ^ -(coded & 1));
            samples.push(sample);
            before = [sample, left];
        }
    }
    samples
        .iter()
        .flat_map(|sample| (*sample as u16).to_le_bytes())
        .collect()
}

/// `samples` with the header of an npy file, version 1.0.
fn npy(samples: &[u8]) -> Vec<u8> {
    let shape = SHAPE.map(|n| n.to_string()).join(", ");
    let header = format!("{{'descr': '<f2', 'fortran_order': False, 'shape': ({shape}), }}");
    // Magic, version, length of the header, and the header itself fill a multiple of 64 bytes.
    let length = (10 + header.len() + 1).next_multiple_of(64) - 10;
    let mut file = b"\x93NUMPY\x01\x00".to_vec();
    file.extend((length as u16).to_le_bytes());
    file.extend(format!("{header:<width$}\n", width = length - 1).bytes());
    file.extend(samples);
    file
}

fn archive(npy: &[u8]) -> zip::result::ZipResult<Vec<u8>> {
    let mut archive = ZipWriter::new(Cursor::new(Vec::with_capacity(npy.len() + 512)));
    let stored = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
    archive.start_file("radiance.npy", stored)?;
    archive.write_all(npy)?;
    Ok(archive.finish()?.into_inner())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_packed_lightmap_has_the_bits_of_the_npz() {
        let file = std::fs::File::open("scenes/corner/lightmap.npz").unwrap();
        let mut archive = zip::ZipArchive::new(file).unwrap();
        let mut expected = Vec::new();
        let mut member = archive.by_name("radiance.npy").unwrap();
        member.read_to_end(&mut expected).unwrap();
        assert!(npy(&samples()) == expected);
    }
}
