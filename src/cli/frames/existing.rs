//! Whether a file already exists, complete and with the expected fingerprint.

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

use nullray::io::image::{exr, png};
use nullray::io::sealed;

use crate::cli::output::{Identity, Kind, Outputs, extension};

/// Whether all files of a frame exist as they would be written.
pub fn all(outputs: &Outputs) -> bool {
    let Some(identity) = &outputs.identity else {
        return false;
    };
    let overlay = identity.of_overlay(outputs.parts);
    let drawn = outputs.overlays.iter().all(|path| is_drawn(path, &overlay));
    drawn
        && outputs.files().all(|(path, kind)| {
            // The first bytes would be enough for the fingerprint, but completeness needs all of it.
            let found = fingerprint(path, kind);
            found.is_some_and(|found| found == identity.fingerprint(kind))
        })
}

/// Whether a picture with lines over it is complete and has this fingerprint.
fn is_drawn(path: &Path, fingerprint: &str) -> bool {
    if extension(path) == "png" {
        let text = of_png(path).unwrap_or_default();
        return text.contains(&(Identity::KEY.into(), fingerprint.into()));
    }
    if !is_sealed(path) {
        return false;
    }
    let bytes = std::fs::read(path).unwrap_or_default();
    let mut places = bytes.windows(fingerprint.len());
    places.any(|part| part == fingerprint.as_bytes())
}

/// Whether a file exists and matches its checksum byte for byte.
fn is_sealed(path: &Path) -> bool {
    path.is_file() && sealed::is_whole(path).unwrap_or(false)
}

/// The fingerprint of a complete file; `None` for any other.
fn fingerprint(path: &Path, kind: Kind) -> Option<String> {
    let metadata = match kind {
        Kind::Display | Kind::Isochrones | Kind::Luminance => of_png(path)?,
        Kind::Exr | Kind::Npz if !is_sealed(path) => return None,
        Kind::Exr => exr::metadata(path).ok()?,
        Kind::Npz => of_npz(path)?,
    };
    let entry = metadata.into_iter().find(|(key, _)| key == Identity::KEY);
    entry.map(|(_, value)| value)
}

/// The texts of a PNG whose checksums are all correct.
fn of_png(path: &Path) -> Option<Vec<(String, String)>> {
    if !path.is_file() {
        return None;
    }
    let bytes = std::fs::read(path).ok()?;
    if !png_is_whole(&bytes) {
        return None;
    }
    Some(png::inspect(path).ok()?.text)
}

/// Whether a PNG consists of chunks with correct checksums (length, kind, data, CRC-32 of kind and data) up to its last one.
fn png_is_whole(bytes: &[u8]) -> bool {
    let Some(mut rest) = bytes.strip_prefix(b"\x89PNG\r\n\x1a\n") else {
        return false;
    };
    while let Some((length, after)) = rest.split_first_chunk::<4>() {
        let covered = u32::from_be_bytes(*length) as usize + 4;
        let Some((covered, after)) = after.split_at_checked(covered) else {
            return false;
        };
        let Some((sum, after)) = after.split_first_chunk::<4>() else {
            return false;
        };
        let mut crc = flate2::Crc::new();
        crc.update(covered);
        if crc.sum() != u32::from_be_bytes(*sum) {
            return false;
        }
        if covered.starts_with(b"IEND") {
            return after.is_empty();
        }
        rest = after;
    }
    false
}

/// The metadata of a complete archive.
fn of_npz(path: &Path) -> Option<Vec<(String, String)>> {
    let file = BufReader::new(File::open(path).ok()?);
    let mut archive = zip::ZipArchive::new(file).ok()?;
    let text = numpy_text(&mut archive.by_name("metadata.npy").ok()?)?;
    let entries: serde_json::Map<String, serde_json::Value> = serde_json::from_str(&text).ok()?;
    let entries = entries.into_iter();
    let texts = entries.filter_map(|(key, value)| Some((key, value.as_str()?.to_string())));
    Some(texts.collect())
}

/// The text of a numpy array with one `<U` element: a header that ends with its line, then UTF-32.
fn numpy_text(reader: &mut impl Read) -> Option<String> {
    /// The longest metadata that are read, bytes.
    const LONGEST: u64 = 256 << 20;
    let mut bytes = Vec::new();
    reader.take(LONGEST).read_to_end(&mut bytes).ok()?;
    let header = bytes.iter().position(|byte| *byte == b'\n')?;
    let (units, rest) = bytes.get(header + 1..)?.as_chunks::<4>();
    let text = units
        .iter()
        .map(|unit| char::from_u32(u32::from_le_bytes(*unit)));
    text.collect::<Option<String>>().filter(|_| rest.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;
    use nullray::io::image::{Channel, Layers, Samples, npz};

    #[test]
    fn a_file_with_any_byte_changed_is_not_whole() {
        let folder = tempfile::tempdir().unwrap();
        let entries = [(Identity::KEY.to_string(), "is known".to_string())];
        let channel = |name: &str| Channel {
            name: name.into(),
            samples: Samples::F64(vec![0.5; 6]),
        };
        let channels = ["radiance.R", "radiance.G", "radiance.B"].map(channel);
        let layers = Layers::new(3, 2, channels.to_vec(), entries.to_vec()).unwrap();
        let [exr, npz] = ["a.exr", "a.npz"].map(|name| folder.path().join(name));
        let options = exr::Options {
            sealed: true,
            ..exr::Options::default()
        };
        exr::write_with(&exr, &layers, &options).unwrap();
        npz::write_sealed(&npz, &layers).unwrap();
        for (path, kind) in [(exr, Kind::Exr), (npz, Kind::Npz)] {
            let is_known = || fingerprint(&path, kind).as_deref() == Some("is known");
            assert!(is_known(), "{kind:?}");
            let mut bytes = std::fs::read(&path).unwrap();
            for at in 0..bytes.len() {
                bytes[at] ^= 4;
                std::fs::write(&path, &bytes).unwrap();
                assert!(!is_known(), "{kind:?}, byte {at}");
                bytes[at] ^= 4;
                std::fs::write(&path, &bytes[..at]).unwrap();
                assert!(!is_known(), "{kind:?}, cut to {at}");
            }
            std::fs::write(&path, [&bytes[..], b"0"].concat()).unwrap();
            assert!(!is_known(), "{kind:?} with a byte more");
            std::fs::write(&path, &bytes).unwrap();
            assert!(is_known(), "{kind:?}");
        }
    }

    #[test]
    fn a_png_with_any_byte_changed_is_not_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let text = [(Identity::KEY.to_string(), "é and more".to_string())];
        png::write(&path, 5, 4, &[77; 60], &text).unwrap();
        let mut bytes = std::fs::read(&path).unwrap();
        assert!(png_is_whole(&bytes));
        for at in 0..bytes.len() {
            bytes[at] ^= 0x10;
            assert!(!png_is_whole(&bytes), "byte {at}");
            bytes[at] ^= 0x10;
            assert!(!png_is_whole(&bytes[..at]), "cut to {at}");
        }
        bytes.push(0);
        assert!(!png_is_whole(&bytes));
    }
}
