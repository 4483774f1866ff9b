//! What a format of cubes has to say for itself: a row of [`FORMATS`](super::FORMATS).

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
    /// How names of its files end, in lower case; the first is the one that copies get. None of what is told by its path.
    pub extensions: &'static [&'static str],
    /// Whether its arrays have names.
    pub named: bool,
    /// Whether it holds pictures, a frame of a cube each: codes of theirs stand for radiance by a transfer that is declared.
    pub pictures: bool,
    /// How it is told apart from the others.
    pub(super) told: Told,
    /// The files that it consists of, for which it is looked when a scene names it.
    pub(super) files: fn(&Path) -> Result<Vec<PathBuf>>,
    /// What would be loaded, by the same checks of headers and lengths; no samples are read.
    pub(super) inspect: fn(Input, Wanted) -> Result<CubeInfo>,
    /// The cube.
    pub(super) load: fn(Input, Wanted) -> Result<Cube>,
    /// The headers of all arrays, whether cubes or not.
    pub arrays: fn(&Path) -> Result<Vec<Header>>,
    /// What it says of the time axis of the array of this name, or of its only one.
    pub(super) times: fn(Input, Option<&str>) -> Result<Option<FileTimes>>,
    /// The points of a surface that the pixels of the cube are, where it says them.
    pub(super) wall: fn(Input, Wanted) -> Result<Option<Wall>>,
    /// How parts of a cube are read.
    pub(super) parts: Parts,
}

/// How a format is told apart from the others.
#[derive(Debug)]
pub(super) enum Told {
    /// By the first bytes of its files, which are one of these; where those say nothing, by the ends of their names.
    ByStart(&'static [&'static [u8]]),
    /// By a path, before anything is opened.
    ByPath(ByPath),
}

/// What is told by its path, as folders and patterns are.
#[derive(Debug)]
pub struct ByPath {
    /// Whether a path names such a thing.
    pub(super) is: fn(&Path) -> bool,
    /// What such things are called in a list of what can be read.
    pub(super) called: &'static str,
    /// What a folder of it is a folder of.
    pub folder_of: &'static str,
    /// How to name one.
    pub help: &'static str,
}

/// How parts of a cube are read without all of it in memory.
#[derive(Debug)]
pub(super) enum Parts {
    /// Each sample has its place in the file.
    InPlace(InPlace),
    /// Windows of an array in chunks are decoded; or all of it is written out.
    #[cfg(any(feature = "hdf5", feature = "zarr"))]
    Windows(OpenWindows, WriteOut),
    /// Nothing is found without reading all before it, so that all of it is written out first.
    WrittenOut(WriteOut),
}

/// Where the samples of a file lie.
pub(super) type InPlace = fn(&mut dyn ReadSeek, &Path, Wanted) -> Result<StoredLayout>;

/// Writes the samples that are wanted to a temporary file.
pub(super) type WriteOut = fn(Input, Wanted, &mut dyn Write) -> Result<StoredLayout>;

/// What is taken of an array, and how it is opened with so many bytes for decoded chunks.
#[cfg(any(feature = "hdf5", feature = "zarr"))]
pub(super) type OpenWindows = fn(&Path, Wanted, usize) -> Result<(Selection, Open)>;

/// What is read: a path, and the file there if it was opened to tell its format.
pub(super) struct Input<'a> {
    pub path: &'a Path,
    opened: Option<Reader>,
}

impl<'a> Input<'a> {
    /// What is told by its path.
    pub fn at(path: &'a Path) -> Self {
        Input { path, opened: None }
    }

    /// An open file, which `path` stands for in messages.
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

    /// The same for many small pieces.
    pub fn buffered(self) -> Result<Reader> {
        Ok(Box::new(BufReader::new(self.reader()?)))
    }
}

/// What consists of one file, or of a folder that is read as one.
pub(super) fn itself(path: &Path) -> Result<Vec<PathBuf>> {
    Ok(vec![path.to_path_buf()])
}

impl CubeFormat {
    /// How it is told by its path; none of files, which are told by what they hold.
    pub fn by_path(&self) -> Option<&ByPath> {
        match &self.told {
            Told::ByStart(_) => None,
            Told::ByPath(by_path) => Some(by_path),
        }
    }

    /// Whether it is told by a path, and by this one.
    pub(super) fn is_at(&self, path: &Path) -> bool {
        self.by_path().is_some_and(|told| (told.is)(path))
    }

    /// Whether files of it begin like this.
    pub(super) fn begins(&self, start: &[u8]) -> bool {
        match self.told {
            Told::ByStart(magic) => magic.iter().any(|magic| start.starts_with(magic)),
            Told::ByPath(_) => false,
        }
    }

    /// Whether the name of a file ends as those of this format do.
    pub(super) fn has_name_of(&self, path: &Path) -> bool {
        let extension = path.extension();
        let is = |known: &&str| extension.is_some_and(|e| e.eq_ignore_ascii_case(known));
        self.extensions.iter().any(is)
    }
}

/// The bytes by which formats are told apart; leaves the reader at the start.
pub(super) fn first_bytes(reader: &mut dyn ReadSeek, file: &Path) -> Result<Vec<u8>> {
    let mut start = Vec::new();
    (&mut *reader)
        .take(8)
        .read_to_end(&mut start)
        .and_then(|_| reader.rewind())
        .map_err(Error::io(file, "cannot read"))?;
    Ok(start)
}
