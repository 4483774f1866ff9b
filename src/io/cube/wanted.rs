//! Requests for cubes on disk, and the information that files contain about themselves.

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

impl FileTimes {
    /// The keys of the time axis of which these times say otherwise than `start` and `width`, with both values, metres.
    pub fn differing(
        &self,
        start: f64,
        width: f64,
    ) -> impl Iterator<Item = (&'static str, [f64; 2])> {
        /// Starts that differ by less of a bin, and widths by less of themselves, are the same but for rounding.
        const SAME_START: f64 = 1e-3;
        const SAME_WIDTH: f64 = 1e-6;
        let keys = [
            ("start", [self.start, start], SAME_START * self.width),
            ("bin_width", [self.width, width], SAME_WIDTH * self.width),
        ];
        let keys = keys.into_iter();
        keys.filter_map(|(key, [said, used], same)| {
            ((used - said).abs() > same).then_some((key, [said, used]))
        })
    }
}

/// The centres of bins of different widths, each with the width of energies, or 1 for densities; as bits, which can be compared and hashed.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct BinSizes(pub(super) Vec<[u64; 2]>);

impl FromIterator<[f64; 2]> for BinSizes {
    fn from_iter<I: IntoIterator<Item = [f64; 2]>>(sizes: I) -> BinSizes {
        BinSizes(
            sizes
                .into_iter()
                .map(|both| both.map(f64::to_bits))
                .collect(),
        )
    }
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
    /// The array; may be omitted if there is only one.
    pub array: Option<&'a str>,
    /// The order of its axes. Default: (H, W, T) or (H, W, T, C).
    pub axes: Option<&'a Axes>,
    /// The meaning of its channels. Default: one is grey, three are red, green, blue.
    pub channels: Option<&'a Channels>,
    /// How the codes of PNG pictures encode radiance.
    pub transfer: Option<Transfer>,
    /// Bins in which the sensor counted nothing; they are interpolated from their neighbours in time.
    pub dead_bins: &'a [usize],
    /// By what these are interpolated where bins differ in width.
    pub bin_sizes: Option<&'a BinSizes>,
    /// What to do with samples below 0. Default: keep them.
    pub negative: Option<Negative>,
    /// The memory limit for pictures and their decoded data, bytes. Default: 16 GiB.
    pub memory: Option<u64>,
}

impl<'a> Wanted<'a> {
    /// The same with this memory limit, bytes.
    #[must_use]
    pub fn within(self, memory: u64) -> Self {
        Wanted {
            memory: Some(memory),
            ..self
        }
    }

    /// The memory budget for pictures.
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
    /// The properties of a cube in memory.
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

/// The properties of a cube once it is loaded: its shape and its size in memory.
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
    /// Whether that order was assumed, because neither the file nor the caller gave it.
    pub assumed: bool,
    /// The name of the array, if its file has several and says which of them is a cube.
    pub array: Option<String>,
    /// Other information in the file, for display.
    pub notes: Vec<String>,
    /// Problems that are apparent without reading samples.
    pub remarks: Vec<String>,
}
