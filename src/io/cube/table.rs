//! All formats of cubes, and reading any of them. Formats recognised by path, such as sequences of pictures and Zarr folders, are checked
//! before the first bytes of anything are read.

use std::io::Cursor;
use std::path::{Path, PathBuf};

use super::dead::DeadBins;
use super::format::{CubeFormat, Input, first_bytes, itself};
use super::recorded::{Recorded, of_archive};
use super::samples::Cube;
use super::wall::Wall;
use super::wanted::{CubeInfo, FileTimes, Transfer, Wanted};
use super::{hdf5, npy, sequence, transient_image, zarr};
use crate::error::{Error, Result};
use crate::io::files::ReadSeek;
use crate::io::open::open_regular;

/// All formats. Of those recognised by path, the last is the fallback: any folder may contain pictures.
pub const FORMATS: &[CubeFormat] = &[
    npy::ARRAY,
    npy::ARCHIVE,
    transient_image::FORMAT,
    hdf5::FORMAT,
    sequence::FORMAT,
    zarr::FORMAT,
];

/// The format of a file that begins with `start`; by the end of its name if that is inconclusive.
pub fn format_of(start: &[u8], name: &Path) -> Option<&'static CubeFormat> {
    let by_start = FORMATS.iter().find(|format| format.begins(start));
    by_start.or_else(|| by_extension(name))
}

/// The format at `path`, as far as is known before it is opened: for a file by the end of its name.
pub fn format_called(path: &Path) -> Option<&'static CubeFormat> {
    by_path(path).or_else(|| by_extension(path))
}

fn by_path(path: &Path) -> Option<&'static CubeFormat> {
    FORMATS.iter().rev().find(|format| format.is_at(path))
}

fn by_extension(name: &Path) -> Option<&'static CubeFormat> {
    FORMATS.iter().find(|format| format.has_name_of(name))
}

/// Every extension of files that hold cubes.
pub fn extensions() -> impl Iterator<Item = &'static str> {
    FORMATS.iter().flat_map(|format| format.extensions).copied()
}

/// The files that `path` consists of: the pictures of a sequence, in the order of their numbers; otherwise the file itself.
///
/// # Errors
/// There is no such sequence, or several, or a picture of it is missing or repeated.
pub fn files(path: &Path) -> Result<Vec<PathBuf>> {
    format_called(path).map_or(itself as fn(&Path) -> _, |format| format.files)(path)
}

/// What [`load`] would load, with the same checks of headers and lengths; no samples are read.
///
/// # Errors
/// As for [`load`], except for errors in samples.
pub fn inspect(path: &Path, wanted: Wanted) -> Result<CubeInfo> {
    let (input, format) = open_wanted(path, wanted)?;
    (format.inspect)(input, wanted)
}

/// Loads the part `wanted` of the cube in a file or in a sequence of pictures.
///
/// # Errors
/// The file cannot be read; it is truncated or longer than its header says; the array does not have the requested axes, or has other than
/// 1 or 3 channels; it does not hold numbers; a sample is not finite; a dead bin does not exist; samples below 0, if they are to be
/// refused.
pub fn load(path: &Path, wanted: Wanted) -> Result<Cube> {
    mended(read(path, wanted)?, path, wanted)
}

fn mended(mut cube: Cube, path: &Path, wanted: Wanted) -> Result<Cube> {
    if let Some(negative) = wanted.negative {
        negative.apply_to_cube(&mut cube, path)?;
    }
    DeadBins::new(path, wanted, cube.shape[2])?.mend_cube(&mut cube);
    Ok(cube)
}

fn read(path: &Path, wanted: Wanted) -> Result<Cube> {
    let (input, format) = open_wanted(path, wanted)?;
    (format.load)(input, wanted)
}

/// Refuses a transfer for data that are not picture codes.
fn refuse_transfer(path: &Path, wanted: Wanted) -> Result<()> {
    match wanted.transfer {
        Some(Transfer::Srgb) => {
            let what = "an array already holds radiance; `transfer` applies only to pictures";
            Err(Error::invalid(path, "", what, "leave out `transfer`"))
        }
        Some(Transfer::Linear) | None => Ok(()),
    }
}

/// The time axis that the file at `path` gives for its array of this name, or for its only one, if its format can store one.
///
/// # Errors
/// The file cannot be read, or is broken.
pub fn times(path: &Path, array: Option<&str>) -> Result<Option<FileTimes>> {
    let (input, format) = open(path)?;
    (format.times)(input, array)
}

/// What the file at `path` says of its array of this name, or of its only one.
///
/// # Errors
/// The file cannot be read, or is broken.
pub fn recorded(path: &Path, array: Option<&str>) -> Result<Recorded> {
    let times = times(path, array)?;
    let of_archive = of_archive(path, array).unwrap_or_default();
    Ok(Recorded {
        times,
        ..of_archive
    })
}

/// The points on a surface that the pixels of the cube in a file see, if the file gives them.
///
/// # Errors
/// The file cannot be read, or is broken.
pub fn wall(path: &Path, wanted: Wanted) -> Result<Option<Wall>> {
    let (input, format) = open(path)?;
    (format.wall)(input, wanted)
}

/// As [`load`], from bytes in memory; `name` stands for the file in messages.
///
/// # Errors
/// As for [`load`].
pub fn load_bytes(bytes: &[u8], name: &str, wanted: Wanted) -> Result<Cube> {
    let (mut reader, name) = (Cursor::new(bytes.to_vec()), Path::new(name));
    refuse_transfer(name, wanted)?;
    let format = told_apart(&mut reader, name)?;
    let input = Input::opened(name, Box::new(reader));
    mended((format.load)(input, wanted)?, name, wanted)
}

/// The input at `path` and its format, which must have codes if a transfer is given.
fn open_wanted<'a>(path: &'a Path, wanted: Wanted) -> Result<(Input<'a>, &'static CubeFormat)> {
    if !by_path(path).is_some_and(|format| format.pictures) {
        refuse_transfer(path, wanted)?;
    }
    open(path)
}

/// The input at `path` and its format.
///
/// # Errors
/// There is no such file, or it is in no known format of cubes.
pub(super) fn open(path: &Path) -> Result<(Input<'_>, &'static CubeFormat)> {
    if let Some(format) = by_path(path) {
        return Ok((Input::at(path), format));
    }
    let (mut reader, _) = open_regular(path)?;
    let format = told_apart(&mut reader, path)?;
    Ok((Input::opened(path, reader), format))
}

/// The format by the first bytes; leaves the reader at the start.
fn told_apart(reader: &mut dyn ReadSeek, file: &Path) -> Result<&'static CubeFormat> {
    let start = first_bytes(reader, file)?;
    format_of(&start, file).ok_or_else(|| {
        let by_path = FORMATS.iter().filter_map(CubeFormat::by_path);
        let mut all: Vec<_> = extensions().map(|end| format!(".{end}")).collect();
        all.extend(by_path.map(|told| told.called.to_string()));
        let last = all.pop().unwrap_or_default();
        let help = format!("cubes are read from {} and {last}", all.join(", "));
        let what = "this file is not in a supported cube format, by its first bytes and its name";
        Error::unsupported(file, "", what, help)
    })
}
