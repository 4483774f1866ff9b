//! HDF5 files: `.h5`, `.hdf5`, and `.mat` of version 7.3, which is HDF5 behind a block of its own.
//!
//! The file format is read by the crate `hdf5-reader`, which has bounds on everything that a file can ask for. Arrays whose
//! samples lie together are not treated apart: what is read at random is first written out to a temporary file,
//! each chunk decoded once.

mod file;
mod layouts;
mod lzf;
mod write;

use std::io::Write;
use std::path::Path;

use self::file::File;
use self::layouts::known;
pub(super) use self::write::write;
use super::format::{CubeFormat, CubeInfo, FileTimes, Wanted};
use super::layout::StoredLayout;
use super::samples::Cube;
use super::wall::Wall;
use crate::error::Result;
use crate::io::files::Reader;
use crate::io::npy::Header;
use crate::io::open::open_regular;

/// HDF5.
pub(super) const FORMAT: CubeFormat = CubeFormat {
    name: "HDF5 file",
    extensions: &["h5", "hdf5", "mat"],
    magic: &[b"\x89HDF\r\n\x1a\n", b"MATLAB 7"],
    named: true,
    inspect,
    load,
    arrays,
    times,
};

fn inspect(reader: Reader, path: &Path, wanted: Wanted) -> Result<CubeInfo> {
    let known = known(&File::open(reader, path)?, wanted)?;
    let info = known.selection.info(path, known.assumed, known.notes)?;
    Ok(CubeInfo {
        array: Some(known.array.name().into()),
        ..info
    })
}

fn load(reader: Reader, path: &Path, wanted: Wanted) -> Result<Cube> {
    let mut known = known(&File::open(reader, path)?, wanted)?;
    known.selection.load(&mut known.array, path)
}

fn times(reader: Reader, path: &Path) -> Result<Option<FileTimes>> {
    let file = File::open(reader, path)?;
    // What cannot be known yet, like which of several arrays is meant, is refused when that is loaded.
    Ok(known(&file, Wanted::default())
        .ok()
        .and_then(|known| known.times))
}

fn arrays(path: &Path) -> Result<Vec<Header>> {
    File::open(open_regular(path)?.0, path)?.arrays()
}

/// Writes the samples that are `wanted` to `to`.
pub(super) fn write_out(
    reader: Reader,
    path: &Path,
    wanted: Wanted,
    to: &mut dyn Write,
) -> Result<StoredLayout> {
    let mut known = known(&File::open(reader, path)?, wanted)?;
    known.selection.write_out(&mut known.array, path, to)
}

/// The points of a surface that the pixels are.
pub(super) fn wall(reader: Reader, path: &Path, wanted: Wanted) -> Result<Option<Wall>> {
    Ok(known(&File::open(reader, path)?, wanted)?.wall)
}
