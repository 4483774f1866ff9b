//! Whether a baked file is complete.

use std::fs::File;
use std::io::{self, BufReader, Read};
use std::path::Path;

use nullray::render::bake::CubePrecision;
use zip::ZipArchive;

/// Bytes that hold the type of an array in the header of its .npy.
const HEADER: u64 = 128;

/// Whether an .npz is complete, byte for byte by the checksums of its arrays, and holds light in this precision, which its fingerprint
/// leaves out.
pub fn is_whole(path: &Path, precision: CubePrecision) -> bool {
    let descr = match precision {
        CubePrecision::Single => "<f4",
        CubePrecision::Half => "<f2",
    };
    let checked = || -> io::Result<bool> {
        let mut archive = ZipArchive::new(BufReader::new(File::open(path)?))?;
        let mut header = Vec::new();
        let light = archive.by_name("radiance.npy")?;
        light.take(HEADER).read_to_end(&mut header)?;
        // Reading an entry to its end checks its CRC-32.
        for index in 0..archive.len() {
            io::copy(&mut archive.by_index(index)?, &mut io::sink())?;
        }
        Ok(String::from_utf8_lossy(&header).contains(descr))
    };
    checked().unwrap_or(false)
}
