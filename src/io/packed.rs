//! The built-in lightmap, which is packed more tightly than an npz can be, so that the crate stays small.
//!
//! Samples of f16 from a Monte Carlo simulation hardly compress as they stand. What is stored is, per texel, the
//! difference of each sample's 16 bits from the sample before it in time; then all low bytes, then all high
//! bytes; then zlib. Unpacking it gives the bits of `scenes/corner/lightmap.npz`.

use std::io::{Cursor, Read, Write};

use flate2::read::ZlibDecoder;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

/// Rows, columns, time bins, channels.
const SHAPE: [usize; 4] = [242, 66, 153, 1];
const PACKED: &[u8] = include_bytes!("../../scenes/corner/lightmap.packed");

/// The lightmap as an npz file with the array `radiance`.
pub(super) fn lightmap() -> Vec<u8> {
    // These are our own bytes, and a test unpacks them: what fails here is a broken build.
    archive(&npy(&samples())).expect("the built-in lightmap is whole")
}

/// The samples, f16, little-endian, in C order.
fn samples() -> Vec<u8> {
    let count: usize = SHAPE.iter().product();
    let mut planes = Vec::with_capacity(2 * count);
    ZlibDecoder::new(PACKED)
        .read_to_end(&mut planes)
        .expect("the built-in lightmap is whole");
    let (low, high) = planes.split_at(count);
    let mut bytes = Vec::with_capacity(2 * count);
    // Undo the differences along time, texel by texel.
    for (low, high) in low.chunks(SHAPE[2]).zip(high.chunks(SHAPE[2])) {
        let mut sample = 0u16;
        for (low, high) in low.iter().zip(high) {
            sample = sample.wrapping_add(u16::from_le_bytes([*low, *high]));
            bytes.extend(sample.to_le_bytes());
        }
    }
    bytes
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
