//! The description of a format of cubes: a row of [`FORMATS`](super::FORMATS).

use std::io::{BufReader, Read, Write};
use std::path::{Path, PathBuf};

use super::layout::StoredLayout;
use super::samples::Cube;
#[cfg(any(feature = "hdf5", feature = "zarr"))]
use super::selection::{Open, Selection};
use super::wall::Wall;
use super::wanted::{CubeInfo, FileTimes, Wanted};
use crate::io::files::{ReadSeek, Reader};
use crate::io::npy::Header;
use crate::io::open::open_regular;
use crate::{Error, Result};

/// A format of files, or of folders of them, that hold cubes.
#[derive(Debug)]
pub struct CubeFormat {
    /// Its name, for people.
    pub name: &'static str,
    /// Its name, for programs.
    pub key: &'static str,
    /// The ends of its files' names, in lower case; the first is used for copies. Empty for formats recognised by path.
    pub extensions: &'static [&'static str],
    /// Whether its arrays have names.
    pub named: bool,
    /// Whether it consists of pictures, each a frame of a cube: their codes encode radiance by a declared transfer.
    pub pictures: bool,
    /// How it is distinguished from the others.
    pub(super) recognition: Recognition,
    /// The files that it consists of, which are checked for when a scene names it.
    pub(super) files: fn(&Path) -> Result<Vec<PathBuf>>,
    /// What would be loaded, with the same checks of headers and lengths; no samples are read.
    pub(super) inspect: fn(Input, Wanted) -> Result<CubeInfo>,
    /// Loads the cube.
    pub(super) load: fn(Input, Wanted) -> Result<Cube>,
    /// The headers of all arrays, whether cubes or not.
    pub arrays: fn(&Path) -> Result<Vec<Header>>,
    /// The time axis that it gives for the array of this name, or for its only one.
    pub(super) times: fn(Input, Option<&str>) -> Result<Option<FileTimes>>,
    /// The points on a surface that the pixels of the cube see, if it gives them.
    pub(super) wall: fn(Input, Wanted) -> Result<Option<Wall>>,
    /// How parts of a cube are read.
    pub(super) parts: Parts,
}

/// How a format is distinguished from the others.
#[derive(Debug)]
pub(super) enum Recognition {
    /// By the first bytes of its files, which are one of these; if those are inconclusive, by the ends of their names.
    ByStart(&'static [&'static [u8]]),
    /// By a path, before anything is opened.
    ByPath(ByPath),
}

/// Formats recognised by path, such as folders and patterns.
#[derive(Debug)]
pub struct ByPath {
    /// Whether a path names one.
    pub(super) is: fn(&Path) -> bool,
    /// Its name in a list of readable formats.
    pub(super) called: &'static str,
    /// What its folders contain.
    pub folder_of: &'static str,
    /// How to name one.
    pub help: &'static str,
}

/// How parts of a cube are read without loading all of it.
#[derive(Debug)]
pub(super) enum Parts {
    /// Each sample has its position in the file.
    InPlace(InPlace),
    /// Windows of a chunked array are decoded; or all of it is written out.
    #[cfg(any(feature = "hdf5", feature = "zarr"))]
    Windows(OpenWindows, WriteOut),
    /// Random access is impossible, so all of it is written out first.
    WrittenOut(WriteOut),
}

/// The positions of a file's samples.
pub(super) type InPlace = fn(&mut dyn ReadSeek, &Path, Wanted) -> Result<StoredLayout>;

/// Writes the requested samples to a temporary file.
pub(super) type WriteOut = fn(Input, Wanted, &mut dyn Write) -> Result<StoredLayout>;

/// What is read of an array, and how it is opened with this many bytes for decoded chunks.
#[cfg(any(feature = "hdf5", feature = "zarr"))]
pub(super) type OpenWindows = fn(&Path, Wanted, usize) -> Result<(Selection, Open)>;

/// The input: a path, and the file if it was opened to recognise its format.
pub(super) struct Input<'a> {
    pub path: &'a Path,
    opened: Option<Reader>,
}

impl<'a> Input<'a> {
    /// An input recognised by its path.
    pub fn at(path: &'a Path) -> Self {
        Input { path, opened: None }
    }

    /// An open file, named `path` in messages.
    pub fn opened(path: &'a Path, reader: Reader) -> Self {
        let opened = Some(reader);
        Input { path, opened }
    }

    /// The file, as it was opened.
    pub fn reader(self) -> Result<Reader> {
        match self.opened {
            Some(reader) => Ok(reader),
            None => Ok(open_regular(self.path)?.0),
        }
    }

    /// The same, buffered for many small reads.
    pub fn buffered(self) -> Result<Reader> {
        Ok(Box::new(BufReader::new(self.reader()?)))
    }
}

/// For formats that consist of one file, or of a folder that is read as a whole.
pub(super) fn itself(path: &Path) -> Result<Vec<PathBuf>> {
    Ok(vec![path.to_path_buf()])
}

impl CubeFormat {
    /// How it is recognised by its path; `None` for files, which are recognised by content.
    pub fn by_path(&self) -> Option<&ByPath> {
        match &self.recognition {
            Recognition::ByStart(_) => None,
            Recognition::ByPath(by_path) => Some(by_path),
        }
    }

    /// Whether it is recognised by path, and by this one.
    pub(super) fn is_at(&self, path: &Path) -> bool {
        self.by_path().is_some_and(|by_path| (by_path.is)(path))
    }

    /// Whether its files begin like this.
    pub(super) fn begins(&self, start: &[u8]) -> bool {
        match self.recognition {
            Recognition::ByStart(magic) => magic.iter().any(|magic| start.starts_with(magic)),
            Recognition::ByPath(_) => false,
        }
    }

    /// Whether a file name ends like those of this format.
    pub(super) fn has_name_of(&self, path: &Path) -> bool {
        let extension = path.extension();
        let is = |known: &&str| extension.is_some_and(|e| e.eq_ignore_ascii_case(known));
        self.extensions.iter().any(is)
    }
}

/// The bytes that distinguish formats; leaves the reader at the start.
pub(super) fn first_bytes(reader: &mut dyn ReadSeek, file: &Path) -> Result<Vec<u8>> {
    let mut start = Vec::new();
    (&mut *reader)
        .take(8)
        .read_to_end(&mut start)
        .and_then(|_| reader.rewind())
        .map_err(Error::io(file, "cannot read"))?;
    Ok(start)
}
