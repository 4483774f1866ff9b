//! The container of a file: JSON text, or the binary container (GLB) with JSON and one chunk of data.
//!
//! GLB (glTF 2.0 §4.4): twelve bytes with `glTF`, version and total length; then chunks of length, type and data. The first chunk is JSON,
//! the second may be the binary buffer, others are ignored.

use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

use crate::{Error, Result};

/// The maximum length of JSON: longer text cannot be a scene description.
const MOST_JSON: u64 = 1 << 29;

const JSON: [u8; 4] = *b"JSON";
const BIN: [u8; 4] = *b"BIN\0";
const COPY_AGAIN: &str = "copy the file again, or export it again";

/// Anything from which a document can be read.
pub(super) trait Storage: Read + Seek {}
impl<T: Read + Seek> Storage for T {}

/// The contents of a file before its JSON is parsed.
pub(super) struct Container {
    pub json: Vec<u8>,
    /// Offset and length of the binary chunk in the file.
    pub bin: Option<(u64, u64)>,
}

/// Reads the JSON of a file of `length` bytes, and finds the binary chunk without reading it.
pub(super) fn read(storage: &mut dyn Storage, length: u64, file: &Path) -> Result<Container> {
    let mut reader = Reader {
        storage,
        file,
        length,
    };
    let mut start = [0; 4];
    let magic = reader.take(0, 4.min(length), "")?;
    start[..magic.len()].copy_from_slice(&magic);
    if &start == b"glTF" {
        return reader.glb();
    }
    let first = start.iter().find(|c| !c.is_ascii_whitespace());
    if length > 0 && first.is_none_or(|&c| c == b'{') {
        let json = reader.take(0, length, "JSON")?;
        return Ok(Container { json, bin: None });
    }
    Err(Error::invalid(
        file,
        "",
        "this is neither a GLB file (which starts with \"glTF\") nor JSON of glTF (which starts with \"{\")",
        "export the model as glTF 2.0, .glb or .gltf",
    ))
}

struct Reader<'a> {
    storage: &'a mut dyn Storage,
    file: &'a Path,
    length: u64,
}

impl Reader<'_> {
    /// `bytes` bytes at `offset`, which must lie within the file.
    fn take(&mut self, offset: u64, bytes: u64, place: &str) -> Result<Vec<u8>> {
        if bytes > MOST_JSON {
            return Err(self.invalid(
                place,
                format!("{bytes} bytes of JSON are more than this program reads"),
                "keep vertex data in a .bin or .glb file, not in data URIs",
            ));
        }
        // Grows with the data read: a length that a broken file declares allocates nothing.
        let mut data = Vec::new();
        (self.storage.seek(SeekFrom::Start(offset)))
            .and_then(|_| (&mut *self.storage).take(bytes).read_to_end(&mut data))
            .map_err(Error::io(self.file, "cannot read"))?;
        match data.len() as u64 == bytes {
            true => Ok(data),
            false => Err(self.invalid(place, "the file ends too early", COPY_AGAIN)),
        }
    }

    fn word(&mut self, offset: u64, place: &str) -> Result<[u8; 4]> {
        let bytes = self.take(offset, 4, place)?;
        Ok(<[u8; 4]>::try_from(bytes).unwrap_or_default())
    }

    fn glb(&mut self) -> Result<Container> {
        let place = "GLB header";
        let version = u32::from_le_bytes(self.word(4, place)?);
        if version != 2 {
            let what = format!("version {version} of the GLB format is unknown");
            let help = "export the model as glTF 2.0";
            return Err(Error::unsupported(self.file, place, what, help));
        }
        let claimed = u64::from(u32::from_le_bytes(self.word(8, place)?));
        if claimed != self.length {
            let what = format!(
                "it says that the file has {claimed} bytes, and the file has {}",
                self.length
            );
            return Err(self.invalid(place, what, COPY_AGAIN));
        }
        let (json, next) = self.json_chunk()?;
        let bin = self.bin_chunk(next)?;
        Ok(Container { json, bin })
    }

    fn json_chunk(&mut self) -> Result<(Vec<u8>, u64)> {
        let (kind, offset, length) = self.chunk(12, "GLB chunk 0")?;
        if kind != JSON {
            return Err(self.invalid(
                "GLB chunk 0",
                "the first chunk of a GLB file must be JSON",
                COPY_AGAIN,
            ));
        }
        let json = self.take(offset, length, "GLB chunk 0")?;
        Ok((json, offset + length))
    }

    fn bin_chunk(&mut self, offset: u64) -> Result<Option<(u64, u64)>> {
        if offset == self.length {
            return Ok(None);
        }
        let (kind, offset, length) = self.chunk(offset, "GLB chunk 1")?;
        Ok((kind == BIN).then_some((offset, length)))
    }

    /// Type, offset and length of the data in the chunk at `offset`, checked against the file.
    fn chunk(&mut self, offset: u64, place: &str) -> Result<([u8; 4], u64, u64)> {
        let length = u64::from(u32::from_le_bytes(self.word(offset, place)?));
        let kind = self.word(offset + 4, place)?;
        let data = offset + 8;
        match length <= self.length.saturating_sub(data) {
            true => Ok((kind, data, length)),
            false => Err(self.invalid(
                place,
                format!("the chunk claims {length} bytes and goes beyond the end of the file"),
                COPY_AGAIN,
            )),
        }
    }

    fn invalid(&self, place: &str, what: impl Into<String>, help: &str) -> Error {
        Error::invalid(self.file, place, what, help)
    }
}
