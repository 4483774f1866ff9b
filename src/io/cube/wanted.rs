//! Requests for cubes on disk, and what the files say of themselves.

#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::axes::Axes;
use super::channels::Channels;
use super::negative::Negative;
use super::samples::{Cube, CubeSamples};
use crate::io::budget::Budget;
use crate::io::npy::Dtype;

/// The time axis of a file that gives its bins, metres of light path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FileTimes {
    /// Time at the start of bin 0.
    pub start: f64,
    /// Width of a bin, above 0.
    pub width: f64,
    /// Whether times are those of arrival at a sensor whose position only the file knows: they include the path from each point of a
    /// surface to it.
    pub at_sensor: bool,
}

/// How the codes of PNG and TIFF pictures encode radiance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Transfer {
    /// In proportion.
    Linear,
    /// By the transfer function of sRGB.
    Srgb,
}

/// A request for the content of a file.
#[derive(Debug, Clone, Copy, Default)]
pub struct Wanted<'a> {
    /// The array, which may be left out if there is only one.
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
