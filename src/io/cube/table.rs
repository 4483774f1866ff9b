//! All formats of cubes, and reading a file of whichever it is.

use std::io::{BufReader, Cursor, Read};
use std::path::Path;

use super::format::{CubeFormat, CubeInfo, FileTimes, Wanted};
use super::samples::Cube;
use super::{npy, sequence, transient_image};
use crate::error::{Error, Result};
use crate::io::files::ReadSeek;
use crate::io::open::open_regular;

/// The formats. What is none of them is left to the first to refuse.
pub const FORMATS: &[CubeFormat] = &[npy::ARRAY, npy::ARCHIVE, transient_image::FORMAT];

/// The format of a file that begins with `start`; by the end of its name where that says nothing.
pub fn format_of(start: &[u8], name: &Path) -> Option<&'static CubeFormat> {
    let by_start = |f: &&CubeFormat| f.magic.iter().any(|magic| start.starts_with(magic));
    let by_name = |f: &&CubeFormat| {
        let extension = name.extension();
        extension.is_some_and(|e| e.eq_ignore_ascii_case(f.extension))
    };
    let formats = || FORMATS.iter();
    formats().find(by_start).or_else(|| formats().find(by_name))
}

/// What [`load`] would load, by the same checks of headers and lengths; no samples are read.
///
/// # Errors
/// As for [`load`], except for what is wrong with samples.
pub fn inspect(path: &Path, wanted: Wanted) -> Result<CubeInfo> {
    if sequence::is_sequence(path) {
        return sequence::inspect(path, wanted);
    }
    let mut reader = BufReader::new(open_regular(path)?.0);
    (told_apart(&mut reader, path)?.inspect)(&mut reader, path, wanted)
}

/// The cube in a file, or in a sequence of pictures, that is `wanted` of it.
///
/// # Errors
/// The file cannot be read; it is truncated or longer than its header says; the array has not
/// the axes that are wanted, or other than 1 or 3 channels; it does not hold numbers; a sample is not finite.
pub fn load(path: &Path, wanted: Wanted) -> Result<Cube> {
    if sequence::is_sequence(path) {
        return sequence::load(path, wanted);
    }
    let mut reader = BufReader::new(open_regular(path)?.0);
    (told_apart(&mut reader, path)?.load)(&mut reader, path, wanted)
}

/// What the file at `path` says of its time axis, if its format has a place for that.
///
/// # Errors
/// The file cannot be read, or is broken.
pub fn times(path: &Path) -> Result<Option<FileTimes>> {
    if sequence::is_sequence(path) {
        return Ok(None);
    }
    let mut reader = BufReader::new(open_regular(path)?.0);
    (told_apart(&mut reader, path)?.times)(&mut reader, path)
}

/// As [`load`], from bytes in memory; `name` stands for the file in messages.
///
/// # Errors
/// As for [`load`].
pub fn load_bytes(bytes: &[u8], name: &str, wanted: Wanted) -> Result<Cube> {
    let (mut reader, name) = (Cursor::new(bytes), Path::new(name));
    (told_apart(&mut reader, name)?.load)(&mut reader, name, wanted)
}

/// The format by the first bytes; leaves the reader at the start.
fn told_apart(reader: &mut dyn ReadSeek, file: &Path) -> Result<&'static CubeFormat> {
    let mut start = Vec::new();
    (&mut *reader)
        .take(8)
        .read_to_end(&mut start)
        .and_then(|_| reader.rewind())
        .map_err(Error::io(file, "cannot read"))?;
    Ok(format_of(&start, file).unwrap_or(&FORMATS[0]))
}
