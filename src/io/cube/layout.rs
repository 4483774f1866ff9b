//! The layout of a cube's samples in a file.

use std::path::Path;

use super::axes::{Arrangement, Axes};
use super::number::Number;
use crate::error::{Error, Result};

/// The layout of samples in a file.
#[derive(Debug, Clone)]
pub(super) struct StoredLayout {
    /// Bytes before the first sample.
    pub start: u64,
    pub number: Number,
    pub big_endian: bool,
    /// Sizes, the slowest first.
    pub sizes: Vec<usize>,
    /// Axes, in the order of the sizes.
    pub axes: Axes,
}

impl StoredLayout {
    /// H, W, T, C of the cube in `path`.
    pub fn shape(&self, path: &Path) -> Result<[usize; 4]> {
        Arrangement::of(&self.sizes, &self.axes, false)
            .map(|arrangement| arrangement.shape)
            .map_err(|what| Error::invalid(path, "", what, "name the axes of the array"))
    }
}

/// The strides along each axis.
pub(super) fn strides(sizes: &[usize]) -> Vec<usize> {
    let mut strides = vec![1; sizes.len()];
    for axis in (1..sizes.len()).rev() {
        strides[axis - 1] = strides[axis] * sizes[axis];
    }
    strides
}
