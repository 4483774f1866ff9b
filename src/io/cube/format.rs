//! What a format of cubes has to say for itself.

use std::io::Read;
use std::path::Path;

#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::axes::Axes;
use super::channels::Channels;
use super::negative::Negative;
use super::samples::{Cube, CubeSamples};
use super::wall::Wall;
use crate::io::budget::Budget;
use crate::io::files::{ReadSeek, Reader};
use crate::io::npy::{Dtype, Header};
use crate::{Error, Result};

/// A format of files that hold cubes. The readers get an open file, its name for messages, and what is
/// asked of it.
#[derive(Debug)]
pub struct CubeFormat {
    /// Its name, for people.
    pub name: &'static str,
    /// How names of its files end, in lower case; the first is the one that copies get.
    pub extensions: &'static [&'static str],
    /// First bytes, one of which its files begin with.
    pub magic: &'static [&'static [u8]],
    /// Whether its arrays have names.
    pub named: bool,
    /// What would be loaded, by the same checks of headers and lengths; no samples are read.
    pub(super) inspect: fn(Reader, &Path, Wanted) -> Result<CubeInfo>,
    /// The cube.
    pub(super) load: fn(Reader, &Path, Wanted) -> Result<Cube>,
    /// The headers of all arrays, whether cubes or not.
    pub arrays: fn(&Path) -> Result<Vec<Header>>,
    /// What a file says of the time axis of the array of this name, or of its only one.
    pub(super) times: fn(Reader, &Path, Option<&str>) -> Result<Option<FileTimes>>,
    /// The points of a surface that the pixels of the cube are, where a file says them.
    pub(super) wall: fn(Reader, &Path, Wanted) -> Result<Option<Wall>>,
}

/// The time axis of a file that says where its bins lie, metres of light path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FileTimes {
    /// Time at the start of bin 0.
    pub start: f64,
    /// Width of a bin, above 0.
    pub width: f64,
    /// Whether times are those of arrival at a sensor whose place only the file knows: they include the way from each
    /// point of a surface to it.
    pub at_sensor: bool,
}

/// How codes of PNG and TIFF pictures stand for radiance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Transfer {
    /// In proportion.
    Linear,
    /// By the transfer function of sRGB.
    Srgb,
}

/// What is asked of a file.
#[derive(Debug, Clone, Copy, Default)]
pub struct Wanted<'a> {
    /// The array, which may be left out where there is one only.
    pub array: Option<&'a str>,
    /// The order of its axes. Where none is given, (H, W, T) or (H, W, T, C).
    pub axes: Option<&'a Axes>,
    /// What its channels are. Where nothing is said, one is grey and three are red, green, blue.
    pub channels: Option<&'a Channels>,
    /// How codes of PNG pictures stand for radiance.
    pub transfer: Option<Transfer>,
    /// Bins in which the sensor counted nothing; they are mended from their neighbours in time.
    pub dead_bins: &'a [usize],
    /// What becomes of samples below 0. They stay where nothing is said.
    pub negative: Option<Negative>,
    /// The most memory that pictures and what is decoded of them may take, bytes. Default: 16 GiB.
    pub memory: Option<u64>,
}

impl<'a> Wanted<'a> {
    /// The same, within so many bytes of memory.
    #[must_use]
    pub fn within(self, memory: u64) -> Self {
        Wanted {
            memory: Some(memory),
            ..self
        }
    }

    /// The memory that pictures may take.
    pub(super) fn budget(&self) -> Budget {
        self.memory.map_or_else(Budget::default, Budget::new)
    }

    /// The array of this name.
    pub fn array(name: &'a str) -> Self {
        Wanted {
            array: Some(name),
            ..Wanted::default()
        }
    }
}

impl CubeFormat {
    /// Whether the name of a file ends as those of this format do.
    pub fn has_name_of(&self, path: &Path) -> bool {
        let extension = path.extension();
        let is = |known: &&str| extension.is_some_and(|e| e.eq_ignore_ascii_case(known));
        self.extensions.iter().any(is)
    }

    /// Whether the file begins as those of this format do, or is called so and begins as no array does; leaves the reader at the start.
    pub(super) fn is(&self, reader: &mut dyn ReadSeek, file: &Path) -> Result<bool> {
        let start = first_bytes(reader, file)?;
        // What stands before HDF5 in its file may be anything.
        let is_called = || self.named && self.has_name_of(file) && !start.starts_with(b"\x93NUMPY");
        Ok(self.magic.iter().any(|magic| start.starts_with(magic)) || is_called())
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

impl CubeInfo {
    /// That of a cube in memory.
    pub fn of(cube: &Cube) -> CubeInfo {
        let dtype = match &cube.samples {
            CubeSamples::F16(_) => Dtype::F16,
            CubeSamples::F32(_) => Dtype::F32,
            CubeSamples::F64(_) => Dtype::F64,
        };
        CubeInfo {
            shape: cube.shape,
            dtype,
            bytes: cube.samples.bytes(),
            axes: Axes::all(),
            assumed: false,
            array: None,
            notes: Vec::new(),
            remarks: Vec::new(),
        }
    }
}

/// What a cube will be once it is loaded: its shape and its size in memory.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct CubeInfo {
    /// H, W, T, C; each at least 1.
    pub shape: [usize; 4],
    /// The precision of the samples in memory.
    pub dtype: Dtype,
    /// Bytes of the samples in memory.
    pub bytes: u64,
    /// The order of the axes in the file.
    pub axes: Axes,
    /// Whether that order was assumed: neither the file nor the caller said it.
    pub assumed: bool,
    /// The name of the array, where its file has several and says which of them is a cube.
    pub array: Option<String>,
    /// What else the file says of itself, for people.
    pub notes: Vec<String>,
    /// What looks wrong, as far as it shows without reading samples.
    pub remarks: Vec<String>,
}
