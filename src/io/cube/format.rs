//! What a format of cubes has to say for itself.

use std::path::Path;

use super::samples::Cube;
use crate::Result;
use crate::io::files::ReadSeek;
use crate::io::npy::{Dtype, Header};

/// A format of files that hold cubes. The readers get an open file, its name for messages, and the name of an
/// array in it, which may be left out where there is one only.
#[derive(Debug)]
pub struct CubeFormat {
    /// Its name, for people.
    pub name: &'static str,
    /// How names of its files end, in lower case.
    pub extension: &'static str,
    /// First bytes, one of which its files begin with.
    pub magic: &'static [&'static [u8]],
    /// Whether its arrays have names.
    pub named: bool,
    /// What would be loaded, by the same checks of headers and lengths; no samples are read.
    pub(super) inspect: fn(&mut dyn ReadSeek, &Path, Option<&str>) -> Result<CubeInfo>,
    /// The cube.
    pub(super) load: fn(&mut dyn ReadSeek, &Path, Option<&str>) -> Result<Cube>,
    /// The headers of all arrays, whether cubes or not.
    pub arrays: fn(&Path) -> Result<Vec<Header>>,
}

/// What a cube will be once it is loaded: its shape and its size in memory.
#[derive(Debug, Clone, PartialEq)]
pub struct CubeInfo {
    /// H, W, T, C; each at least 1.
    pub shape: [usize; 4],
    /// The precision of the samples.
    pub dtype: Dtype,
    /// Bytes of the samples in memory.
    pub bytes: u64,
}
