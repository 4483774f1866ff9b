//! HDF5 files: `.h5`, `.hdf5`, and `.mat` of version 7.3, which is HDF5 after a user block.
//!
//! The file format is read by the crate `hdf5-reader`, which bounds everything that a file can request. Contiguous arrays are read as if
//! they had small chunks.

mod file;
mod layouts;
mod lzf;
mod write;

use std::io::Write;
use std::path::Path;

use self::file::File;
use self::layouts::known;
pub(super) use self::write::write;
use super::format::{CubeFormat, Input, Parts, Recognition, itself};
use super::layout::StoredLayout;
use super::samples::Cube;
use super::selection::{Open, Selection, Windows};
use super::wall::Wall;
use super::wanted::{CubeInfo, FileTimes, Wanted};
use crate::error::Result;
use crate::io::npy::Header;
use crate::io::open::open_regular;

/// Bytes of decoded chunks that are kept while all of an array is read.
const CACHE: usize = 256 << 20;

/// HDF5.
pub(super) const FORMAT: CubeFormat = CubeFormat {
    name: "HDF5 file",
    key: "hdf5",
    extensions: &["h5", "hdf5", "mat"],
    named: true,
    pictures: false,
    // The block before HDF5 in its file may also be something else.
    recognition: Recognition::ByStart(&[b"\x89HDF\r\n\x1a\n", b"MATLAB 7"]),
    files: itself,
    inspect,
    load,
    arrays,
    times,
    wall,
    parts: Parts::Windows(windows, write_out),
};

/// The file, for reading all of an array.
fn opened(input: Input) -> Result<File> {
    let path = input.path;
    File::open(input.buffered()?, path, CACHE)
}

fn inspect(input: Input, wanted: Wanted) -> Result<CubeInfo> {
    let path = input.path;
    let known = known(&opened(input)?, wanted)?;
    let info = known.selection.info(path, known.assumed, known.notes)?;
    Ok(CubeInfo {
        array: Some(known.array.name().into()),
        ..info
    })
}

fn load(input: Input, wanted: Wanted) -> Result<Cube> {
    let path = input.path;
    let mut known = known(&opened(input)?, wanted)?;
    known.selection.load(&mut known.array, path)
}

fn times(input: Input, array: Option<&str>) -> Result<Option<FileTimes>> {
    let file = opened(input)?;
    // What cannot be known yet, such as which of several arrays is meant, is reported when it is loaded.
    Ok(layouts::times_of(&file, array).ok().flatten())
}

fn arrays(path: &Path) -> Result<Vec<Header>> {
    File::open(open_regular(path)?.0, path, 0)?.arrays()
}

/// Writes the requested samples to `to`.
fn write_out(input: Input, wanted: Wanted, to: &mut dyn Write) -> Result<StoredLayout> {
    let path = input.path;
    let mut known = known(&opened(input)?, wanted)?;
    known.selection.write_out(&mut known.array, path, to)
}

/// What is read of the array, and how it is opened with `room` bytes for decoded chunks.
fn windows(path: &Path, wanted: Wanted, room: usize) -> Result<(Selection, Open)> {
    let opened = move |wanted: Wanted, path: &Path| {
        let file = File::open(open_regular(path)?.0, path, room)?;
        known(&file, wanted)
    };
    let selection = opened(wanted, path)?.selection;
    let (path, array) = (path.to_path_buf(), wanted.array.map(String::from));
    let (axes, channels) = (wanted.axes.cloned(), wanted.channels.cloned());
    let open = move || {
        let wanted = Wanted {
            array: array.as_deref(),
            axes: axes.as_ref(),
            channels: channels.as_ref(),
            ..Wanted::default()
        };
        Ok(Box::new(opened(wanted, &path)?.array) as Box<dyn Windows + Send>)
    };
    Ok((selection, Box::new(open)))
}

/// The points on a surface that the pixels see.
fn wall(input: Input, wanted: Wanted) -> Result<Option<Wall>> {
    Ok(known(&opened(input)?, wanted)?.wall)
}
