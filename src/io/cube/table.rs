//! All formats of cubes, and reading a file of whichever it is. Sequences of pictures and Zarr folders are no files, and are told by their
//! names before the first bytes of anything are read.

use std::io::{BufReader, Cursor};
use std::path::Path;

use super::dead::DeadBins;
use super::format::{CubeFormat, CubeInfo, FileTimes, Transfer, Wanted, first_bytes};
use super::samples::Cube;
use super::wall::Wall;
use super::{hdf5, npy, sequence, transient_image, zarr};
use crate::error::{Error, Result};
use crate::io::files::{ReadSeek, Reader};
use crate::io::npy::Header;
use crate::io::open::open_regular;

/// The formats of files.
pub const FORMATS: &[CubeFormat] = &[
    npy::ARRAY,
    npy::ARCHIVE,
    transient_image::FORMAT,
    hdf5::FORMAT,
];

/// The format of a file that begins with `start`; by the end of its name where that says nothing.
pub fn format_of(start: &[u8], name: &Path) -> Option<&'static CubeFormat> {
    let by_start = |f: &&CubeFormat| f.magic.iter().any(|magic| start.starts_with(magic));
    let by_name = |f: &&CubeFormat| f.has_name_of(name);
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
    if sequence::is_zarr(path) {
        refuse_transfer(path, wanted)?;
        return zarr::inspect(path, wanted);
    }
    refuse_transfer(path, wanted)?;
    let (reader, format) = opened(path)?;
    (format.inspect)(reader, path, wanted)
}

/// The cube in a file, or in a sequence of pictures, that is `wanted` of it.
///
/// # Errors
/// The file cannot be read; it is truncated or longer than its header says; the array has not
/// the axes that are wanted, or other than 1 or 3 channels; it does not hold numbers; a sample is not finite; a dead bin
/// that there is not; samples below 0, where they are to be refused.
pub fn load(path: &Path, wanted: Wanted) -> Result<Cube> {
    mended(read(path, wanted)?, path, wanted)
}

fn mended(mut cube: Cube, path: &Path, wanted: Wanted) -> Result<Cube> {
    if let Some(negative) = wanted.negative {
        negative.apply_to_cube(&mut cube, path)?;
    }
    DeadBins::new(path, wanted.dead_bins, cube.shape[2])?.mend_cube(&mut cube);
    Ok(cube)
}

fn read(path: &Path, wanted: Wanted) -> Result<Cube> {
    if sequence::is_sequence(path) {
        return sequence::load(path, wanted);
    }
    refuse_transfer(path, wanted)?;
    if sequence::is_zarr(path) {
        return zarr::load(path, wanted);
    }
    let (reader, format) = opened(path)?;
    (format.load)(reader, path, wanted)
}

/// Refuses to decode what is no code of a picture.
fn refuse_transfer(path: &Path, wanted: Wanted) -> Result<()> {
    match wanted.transfer {
        Some(Transfer::Srgb) => {
            let what = "an array holds radiance as it is, and no codes of pictures";
            Err(Error::invalid(path, "", what, "leave out `transfer`"))
        }
        Some(Transfer::Linear) | None => Ok(()),
    }
}

/// What the file at `path` says of the time axis of its array of this name, or of its only one, if its format has a place for
/// that.
///
/// # Errors
/// The file cannot be read, or is broken.
pub fn times(path: &Path, array: Option<&str>) -> Result<Option<FileTimes>> {
    if sequence::is_sequence(path) {
        return Ok(None);
    }
    if sequence::is_zarr(path) {
        return zarr::times(path, array);
    }
    let (reader, format) = opened(path)?;
    (format.times)(reader, path, array)
}

/// The points of a surface that the pixels of the cube in a file are, where the file says them.
///
/// # Errors
/// The file cannot be read, or is broken.
pub fn wall(path: &Path, wanted: Wanted) -> Result<Option<Wall>> {
    if sequence::is_sequence(path) || sequence::is_zarr(path) {
        return Ok(None);
    }
    let (reader, format) = opened(path)?;
    (format.wall)(reader, path, wanted)
}

/// The headers of the arrays in a Zarr folder.
///
/// # Errors
/// As for [`inspect`].
pub fn arrays(path: &Path) -> Result<Vec<Header>> {
    zarr::arrays(path)
}

/// As [`load`], from bytes in memory; `name` stands for the file in messages.
///
/// # Errors
/// As for [`load`].
pub fn load_bytes(bytes: &[u8], name: &str, wanted: Wanted) -> Result<Cube> {
    let (mut reader, name) = (Cursor::new(bytes.to_vec()), Path::new(name));
    refuse_transfer(name, wanted)?;
    let format = told_apart(&mut reader, name)?;
    mended((format.load)(Box::new(reader), name, wanted)?, name, wanted)
}

/// The file, and its format.
fn opened(path: &Path) -> Result<(Reader, &'static CubeFormat)> {
    let mut reader = BufReader::new(open_regular(path)?.0);
    let format = told_apart(&mut reader, path)?;
    Ok((Box::new(reader), format))
}

/// The format by the first bytes; leaves the reader at the start.
fn told_apart(reader: &mut dyn ReadSeek, file: &Path) -> Result<&'static CubeFormat> {
    let start = first_bytes(reader, file)?;
    format_of(&start, file).ok_or_else(|| {
        let extensions = FORMATS.iter().flat_map(|format| format.extensions);
        let extensions: Vec<_> = extensions.map(|end| format!(".{end}")).collect();
        let help = format!(
            "cubes are read from {}, numbered pictures (a folder of them, or a pattern for their names) and Zarr folders",
            extensions.join(", ")
        );
        let what = "this file is of no format of cubes, by its first bytes and its name";
        Error::unsupported(file, "", what, help)
    })
}
