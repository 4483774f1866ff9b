//! Access to one of a file's arrays: `.npy` contains one, `.npz` is a zip archive of many.

use std::io::{Read, SeekFrom};
use std::path::Path;

use zip::ZipArchive;
use zip::result::ZipError;

use super::METADATA;
use super::header::{self, Header};
use super::place::{MEMBERS, Place, WRITE_AGAIN};
use crate::io::files::ReadSeek;
use crate::{Error, Result};

/// Deflate expands a byte to at most 1032.
const LARGEST_EXPANSION: u64 = 1032;

/// The number of bytes read at a time; a multiple of every sample's size.
const PIECE: usize = 1 << 16;

/// One array; the reader is positioned at its magic string.
pub(in crate::io) struct Stored<'a> {
    pub reader: &'a mut dyn Read,
    pub place: Place,
    /// Bytes of the array, including its header, according to the file system or the archive's directory.
    length: u64,
    /// The maximum length that the compressed data in the archive allow.
    most: u64,
}

impl Stored<'_> {
    /// Reads the header, and returns how many bytes it took.
    pub fn header(&mut self) -> Result<(Header, u64)> {
        header::read(self.reader, &self.place)
    }

    /// The next `count` samples, the last of the array, each converted from its bytes by `sample`. `check` gets every piece as it arrives,
    /// with the index of its first sample.
    pub fn samples<const N: usize, T>(
        &mut self,
        count: usize,
        sample: impl Fn([u8; N]) -> T,
        check: impl Fn(&Place, usize, &[T]) -> Result<()>,
    ) -> Result<Vec<T>> {
        // This only reserves memory; it is used as samples arrive.
        let mut samples = self.room(count)?;
        self.pieces(count, |place, first, bytes| {
            samples.extend(bytes.iter().map(|b| sample(*b)));
            check(place, first, &samples[first..])
        })?;
        Ok(samples)
    }

    /// An empty vector with room for `count` samples.
    pub fn room<T>(&self, count: usize) -> Result<Vec<T>> {
        let mut samples = Vec::new();
        samples.try_reserve_exact(count).map_err(|_| {
            let what = format!("there is not enough memory for {count} samples");
            let help = "crop the array, or store it in half precision (numpy.float16)";
            self.place.unsupported("", what, help)
        })?;
        Ok(samples)
    }

    /// Passes the bytes of the next `count` samples, the last of the array, to `take`, piece by piece, with the index of each piece's first
    /// sample.
    pub fn pieces<const N: usize>(
        &mut self,
        count: usize,
        mut take: impl FnMut(&Place, usize, &[[u8; N]]) -> Result<()>,
    ) -> Result<()> {
        let mut piece = vec![0; PIECE];
        let mut first = 0;
        while first < count {
            let bytes = &mut piece[..PIECE.min((count - first).saturating_mul(N))];
            self.reader
                .read_exact(bytes)
                .map_err(|error| self.place.read_error("samples", error))?;
            let samples = bytes.as_chunks::<N>().0;
            take(&self.place, first, samples)?;
            first += samples.len();
        }
        self.expect_end()
    }

    /// Reads once more: an archive's checksum is compared at the end, and a member may be longer than its directory says.
    fn expect_end(&mut self) -> Result<()> {
        match self.reader.read(&mut [0]) {
            Ok(0) => Ok(()),
            Ok(_) => Err(self.place.invalid(
                "samples",
                "there are bytes after the last sample",
                WRITE_AGAIN,
            )),
            Err(error) => Err(self.place.read_error("samples", error)),
        }
    }

    /// Refuses an array whose length is not `expected` bytes, including its header.
    pub fn check_length(&self, expected: u64) -> Result<()> {
        let what = if self.length > self.most {
            format!(
                "the archive claims {} bytes, more than it can hold",
                self.length
            )
        } else if self.length > expected {
            format!(
                "it has {} bytes after the last sample",
                self.length - expected
            )
        } else {
            return self.check_whole(expected);
        };
        Err(self.place.invalid("samples", what, WRITE_AGAIN))
    }

    /// Refuses an array that ends before `expected` bytes, including its header.
    fn check_whole(&self, expected: u64) -> Result<()> {
        if self.length >= expected {
            return Ok(());
        }
        let what = format!(
            "it is {} bytes long and should be {expected}: it is truncated",
            self.length
        );
        Err(self.place.invalid("samples", what, WRITE_AGAIN))
    }
}

/// Calls `then` with the only array of the file, or with the one named `array`.
pub(in crate::io) fn with_array<T>(
    reader: &mut dyn ReadSeek,
    file: &Path,
    array: Option<&str>,
    then: impl FnOnce(&mut Stored) -> Result<T>,
) -> Result<T> {
    if is_zip(reader, file)? {
        let length = length(reader, file)?;
        let mut archive = open(reader, file)?;
        let (index, name) = choose(members(&archive, file)?, file, array)?;
        let place = Place::new(file, Some(&name));
        return with_member(&mut archive, index, length, place, then);
    }
    let length = length(reader, file)?;
    let mut stored = Stored {
        reader,
        place: Place::new(file, None),
        length,
        most: length,
    };
    match array {
        Some(name) if has_magic(&mut stored)? => Err(stored.place.invalid(
            &format!("array {name:?}"),
            "a .npy file holds one array, which has no name",
            "leave out the name of the array",
        )),
        _ => then(&mut stored),
    }
}

/// The length of the file in bytes; leaves the reader at the start.
fn length(reader: &mut dyn ReadSeek, file: &Path) -> Result<u64> {
    reader
        .seek(SeekFrom::End(0))
        .and_then(|length| reader.rewind().map(|()| length))
        .map_err(Error::io(file, "cannot read"))
}

/// Whether the header is valid; otherwise its error is the better message.
fn has_magic(stored: &mut Stored) -> Result<bool> {
    header::read(stored.reader, &stored.place).map(|_| true)
}

/// The headers of all arrays, or of the one named `array`.
pub(super) fn headers(
    reader: &mut dyn ReadSeek,
    file: &Path,
    array: Option<&str>,
) -> Result<Vec<Header>> {
    let one = |stored: &mut Stored| {
        let (header, start) = stored.header()?;
        let samples = header.bytes().unwrap_or(0);
        stored.check_whole(start.saturating_add(samples))?;
        Ok(header)
    };
    if array.is_some() || !is_zip(reader, file)? {
        return Ok(vec![with_array(reader, file, array, one)?]);
    }
    let length = length(reader, file)?;
    let mut archive = open(reader, file)?;
    members(&archive, file)?
        .into_iter()
        .map(|(index, name)| {
            let place = Place::new(file, Some(&name));
            with_member(&mut archive, index, length, place, one)
        })
        .collect()
}

/// Whether the file starts like a zip archive; leaves the reader at the start.
fn is_zip(reader: &mut dyn ReadSeek, file: &Path) -> Result<bool> {
    let mut start = Vec::with_capacity(4);
    (Read::take(&mut *reader, 4).read_to_end(&mut start))
        .and_then(|_| reader.rewind())
        .map_err(Error::io(file, "cannot read"))?;
    // A local file header, or the end record of an archive without members.
    Ok(start == *b"PK\x03\x04" || start == *b"PK\x05\x06")
}

fn open<'a>(reader: &'a mut dyn ReadSeek, file: &Path) -> Result<ZipArchive<&'a mut dyn ReadSeek>> {
    let place = Place::new(file, None);
    let mut archive = ZipArchive::new(reader).map_err(|error| end_error(&place, error))?;
    if archive.has_duplicate_names() {
        return Err(place.invalid("archive", "two members have the same name", WRITE_AGAIN));
    }
    // A small file can have any number of members that share their bytes. If the check itself fails, reading the member gives a better
    // error.
    if archive.has_overlapping_files().is_ok_and(|overlap| overlap) {
        let what = "two members overlap, or one extends beyond the archive's end";
        return Err(place.invalid("archive", what, WRITE_AGAIN));
    }
    Ok(archive)
}

/// Index and name of every array; members not named `name.npy` are not arrays.
fn members(archive: &ZipArchive<&mut dyn ReadSeek>, file: &Path) -> Result<Vec<(usize, String)>> {
    let mut members = Vec::new();
    for (index, name) in archive.file_names().enumerate() {
        let name = name.map_err(|error| zip_error(&Place::new(file, None), error))?;
        if let Some(name) = name.strip_suffix(".npy") {
            members.push((index, name.to_owned()));
        }
    }
    Ok(members)
}

/// The requested array, or the only one.
fn choose(
    mut members: Vec<(usize, String)>,
    file: &Path,
    array: Option<&str>,
) -> Result<(usize, String)> {
    // Metadata only describe the other arrays.
    if array.is_none() && members.len() > 1 {
        members.retain(|(_, name)| name != METADATA);
    }
    let names = names(&members);
    let (place, what, help) = match array {
        Some(wanted) => match members.into_iter().find(|(_, name)| name == wanted) {
            Some(member) => return Ok(member),
            None => (
                format!("array {wanted:?}"),
                "there is no such array in the archive".to_owned(),
                format!("it holds {names}"),
            ),
        },
        None => match <[_; 1]>::try_from(members) {
            Ok([member]) => return Ok(member),
            Err(members) if members.is_empty() => (
                "archive".to_owned(),
                "it holds no arrays".to_owned(),
                "an archive as numpy.savez writes it has members that end in .npy".to_owned(),
            ),
            Err(members) => (
                "archive".to_owned(),
                format!("it holds {} arrays, and none is named", members.len()),
                format!("name one of them: {names}"),
            ),
        },
    };
    Err(Error::invalid(file, place, what, help))
}

fn names(members: &[(usize, String)]) -> String {
    const MOST: usize = 20;
    let mut names: Vec<String> = (members.iter().take(MOST))
        .map(|(_, name)| format!("{name:?}"))
        .collect();
    match members.len() {
        0 => names.push("no arrays".into()),
        n if n > MOST => names.push("…".into()),
        _ => {}
    }
    names.join(", ")
}

fn with_member<T>(
    archive: &mut ZipArchive<&mut dyn ReadSeek>,
    index: usize,
    file_length: u64,
    place: Place,
    then: impl FnOnce(&mut Stored) -> Result<T>,
) -> Result<T> {
    let mut member = (archive.by_index(index)).map_err(|error| zip_error(&place, error))?;
    // Both are only declared; there cannot be more compressed bytes than the file has.
    let (length, compressed) = (member.size(), member.compressed_size().min(file_length));
    then(&mut Stored {
        reader: &mut member,
        place,
        length,
        most: compressed.saturating_mul(LARGEST_EXPANSION),
    })
}

/// Why the end of an archive cannot be read, where the list of its members is.
fn end_error(place: &Place, error: ZipError) -> Error {
    // The reader calls the record at the end EOCD.
    match error {
        ZipError::InvalidArchive(said) if said.contains("EOCD") => {
            let what = "it is cut short: the list of its arrays, which an archive has at its end, is missing";
            place.invalid("archive", what, WRITE_AGAIN)
        }
        error => zip_error(place, error),
    }
}

fn zip_error(place: &Place, error: ZipError) -> Error {
    let what = match error {
        ZipError::Io(error) => return place.read_error("archive", error),
        ZipError::UnsupportedArchive(_)
        | ZipError::CompressionMethodNotSupported(_)
        | ZipError::InvalidPassword => {
            return place.unsupported("archive", error.to_string(), MEMBERS);
        }
        _ => error.to_string(),
    };
    place.invalid("archive", what, WRITE_AGAIN)
}
