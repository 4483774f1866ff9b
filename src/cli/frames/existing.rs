//! Whether a file is there already: whole, and with the fingerprint that it would be given.

use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use nullray::io::budget::Budget;
use nullray::io::image::{exr, png};
use nullray::validate::compare::{Encoding, Picture};

use crate::cli::memory;
use crate::cli::output::{CHECKSUM_KEY, Identity, Kind, Outputs, content_checksum, extension};

/// Whether all files of a frame are there, as they would be written.
pub fn all(outputs: &Outputs) -> bool {
    let Some(identity) = &outputs.identity else {
        return false;
    };
    let overlay = identity.of_overlay(outputs.parts);
    let drawn = outputs.overlays.iter().all(|path| is_drawn(path, &overlay));
    drawn
        && outputs.files().all(|(path, kind)| {
            // A look at the first bytes would do for the fingerprint; that the rest is there takes all of it.
            let found = fingerprint(path, kind);
            found.is_some_and(|found| found == identity.fingerprint(kind))
        })
}

/// Whether a file with lines over a picture is whole and has this fingerprint.
fn is_drawn(path: &Path, fingerprint: &str) -> bool {
    let end: &[u8] = match extension(path).as_str() {
        "svg" => b"</svg>\n",
        "pdf" => b"%%EOF",
        _ => {
            let text = of_png(path).unwrap_or_default();
            return text.contains(&(Identity::KEY.into(), fingerprint.into()));
        }
    };
    let bytes = match path.is_file() {
        true => std::fs::read(path).unwrap_or_default(),
        false => return false,
    };
    let mut places = bytes.windows(fingerprint.len());
    bytes.ends_with(end) && places.any(|part| part == fingerprint.as_bytes())
}

/// The fingerprint in a file that is whole; none in any other.
fn fingerprint(path: &Path, kind: Kind) -> Option<String> {
    if !path.is_file() {
        return None;
    }
    let metadata = match kind {
        Kind::Display | Kind::Isochrones | Kind::Luminance => of_png(path)?,
        Kind::Exr => of_exr(path)?,
        Kind::Npz => of_npz(path)?,
    };
    let entry = metadata.into_iter().find(|(key, _)| key == Identity::KEY);
    entry.map(|(_, value)| value)
}

/// The text of a PNG of which all checksums are right.
fn of_png(path: &Path) -> Option<Vec<(String, String)>> {
    let bytes = std::fs::read(path).ok()?;
    if !png_is_whole(&bytes) {
        return None;
    }
    Some(png::inspect(path).ok()?.text)
}

/// Whether a PNG is chunks with their checksums (length, kind, data, CRC-32 of kind and data) up to its last one.
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

/// The metadata of an EXR file whose content has the checksum that it was given.
fn of_exr(path: &Path) -> Option<Vec<(String, String)>> {
    let mut layers = exr::read(path, &Budget::new(memory::limit(None))).ok()?;
    let given = layers
        .metadata
        .iter()
        .position(|(key, _)| key == CHECKSUM_KEY)?;
    let (_, given) = layers.metadata.swap_remove(given);
    let half = !exr::half_channels(path).ok()?.is_empty();
    (given == content_checksum(&layers, half)).then_some(layers.metadata)
}

/// The metadata of an archive of which every checksum is right, and whose arrays can be read: lengths and offsets in its
/// directory have no checksum, nor have names, which stand both there and before the arrays.
fn of_npz(path: &Path) -> Option<Vec<(String, String)>> {
    let file = BufReader::new(File::open(path).ok()?);
    let mut archive = zip::ZipArchive::new(file).ok()?;
    let mut text = None;
    let mut names = Vec::new();
    for index in 0..archive.len() {
        let mut member = archive.by_index(index).ok()?;
        names.push((member.header_start(), member.name_raw().to_vec()));
        if member.name().is_ok_and(|name| name == "metadata.npy") {
            text = Some(numpy_text(&mut member)?);
        }
        io::copy(&mut member, &mut io::sink()).ok()?;
    }
    let mut file = archive.into_inner();
    for (start, name) in names {
        if local_name(&mut file, start).ok()? != name {
            return None;
        }
    }
    let budget = Budget::new(memory::limit(None));
    Picture::read(path, Encoding::Linear, &budget).ok()?;
    let entries: serde_json::Map<String, serde_json::Value> = serde_json::from_str(&text?).ok()?;
    let entries = entries.into_iter();
    let texts = entries.filter_map(|(key, value)| Some((key, value.as_str()?.to_string())));
    Some(texts.collect())
}

/// The name in the local header of an archive's member that starts at `start`: its length is at byte 26, and the name at byte 30.
fn local_name(file: &mut (impl Read + Seek), start: u64) -> io::Result<Vec<u8>> {
    let mut length = [0; 2];
    file.seek(SeekFrom::Start(start + 26))?;
    file.read_exact(&mut length)?;
    let mut name = vec![0; usize::from(u16::from_le_bytes(length))];
    file.seek(SeekFrom::Start(start + 30))?;
    file.read_exact(&mut name)?;
    Ok(name)
}

/// The text of a numpy array of one `<U`: a header that ends with its line, then UTF-32.
fn numpy_text(reader: &mut impl Read) -> Option<String> {
    /// The longest metadata that are looked at, bytes.
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
    fn an_archive_with_a_changed_name_is_not_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.npz");
        let entries = [(Identity::KEY.to_string(), "is known".to_string())];
        let channel = |name: &str| Channel {
            name: name.into(),
            samples: Samples::F64(vec![0.5; 6]),
        };
        let channels = ["radiance.R", "radiance.G", "radiance.B"]
            .map(channel)
            .to_vec();
        npz::write(
            &path,
            &Layers::new(3, 2, channels, entries.to_vec()).unwrap(),
        )
        .unwrap();
        assert_eq!(of_npz(&path), Some(entries.to_vec()));
        let bytes = std::fs::read(&path).unwrap();
        let name = b"radiance.npy";
        let places = bytes.windows(name.len()).enumerate();
        let places: Vec<_> = places.filter(|(_, part)| part == name).collect();
        assert_eq!(places.len(), 2);
        for (at, _) in places {
            let mut changed = bytes.clone();
            changed[at] ^= 4;
            std::fs::write(&path, changed).unwrap();
            assert_eq!(of_npz(&path), None, "byte {at}");
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
