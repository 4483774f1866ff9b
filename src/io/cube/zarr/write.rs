//! Writing a Zarr array: chunks compressed by gzip, one layer of them at a time, so that memory is bounded.

use std::fs;
use std::io::Write;
use std::path::Path;

use flate2::Compression;
use flate2::write::GzEncoder;
use serde_json::json;

use super::super::axes::{Axes, Axis};
use super::super::wanted::FileTimes;
use crate::io::npy::Dtype;

/// Entries of a chunk along rows and columns, along time, and along the axis of the layers.
const ACROSS: usize = 32;
const IN_TIME: usize = 64;
const LAYER: usize = 8;

/// An array under construction.
pub(in super::super) struct Writer {
    sizes: Vec<usize>,
    chunk: Vec<usize>,
    bytes: usize,
    /// The next layer.
    layer: usize,
}

impl Writer {
    /// Begins an array in the empty `folder`.
    pub fn new(
        folder: &Path,
        dtype: &Dtype,
        sizes: &[usize],
        axes: &Axes,
        times: Option<FileTimes>,
    ) -> std::io::Result<Writer> {
        let (name, bytes) = match dtype {
            Dtype::F16 => ("float16", 2),
            Dtype::F64 => ("float64", 8),
            Dtype::F32 | Dtype::Other(_) => ("float32", 4),
        };
        let across = |(at, (axis, size)): (usize, (&Axis, &usize))| match axis {
            _ if at == 0 => LAYER.min(*size),
            Axis::Time => IN_TIME.min(*size),
            Axis::Channel => *size,
            Axis::Row | Axis::Column | Axis::Single | Axis::Sum | Axis::Choice => ACROSS.min(*size),
        };
        let chunk: Vec<usize> = axes
            .list()
            .iter()
            .zip(sizes)
            .enumerate()
            .map(across)
            .collect();
        let names: Vec<String> = axes
            .list()
            .iter()
            .map(|axis| Axes::of(vec![*axis]).to_string())
            .collect();
        let mut attributes = json!({});
        if let Some(FileTimes { start, width, .. }) = times {
            attributes = json!({ "start": start, "bin_width": width });
        }
        let document = json!({
            "zarr_format": 3,
            "node_type": "array",
            "shape": sizes,
            "data_type": name,
            "chunk_grid": { "name": "regular", "configuration": { "chunk_shape": chunk } },
            "chunk_key_encoding": { "name": "default", "configuration": { "separator": "/" } },
            "fill_value": 0.0,
            "codecs": [
                { "name": "bytes", "configuration": { "endian": "little" } },
                { "name": "gzip", "configuration": { "level": 5 } },
            ],
            "attributes": attributes,
            "dimension_names": names,
        });
        fs::write(folder.join("zarr.json"), format!("{document:#}\n"))?;
        Ok(Writer {
            sizes: sizes.to_vec(),
            chunk,
            bytes,
            layer: 0,
        })
    }

    /// Entries of the first axis in a layer.
    pub fn layer(&self) -> usize {
        self.chunk[0]
    }

    /// Writes the next layers to `folder`: bytes of their samples in C order, whole layers except at the end.
    pub fn write(&mut self, folder: &Path, bytes: &[u8]) -> std::io::Result<()> {
        let each = self.sizes[1..].iter().product::<usize>() * self.bytes;
        for layer in bytes.chunks(each * self.layer()) {
            self.write_layer(folder, layer, each)?;
            self.layer += 1;
        }
        Ok(())
    }

    /// Writes all chunks of a layer of the first axis; files are named c/i/j/k by the chunk's position.
    fn write_layer(&self, folder: &Path, layer: &[u8], each: usize) -> std::io::Result<()> {
        let counts: Vec<usize> = self
            .sizes
            .iter()
            .zip(&self.chunk)
            .skip(1)
            .map(|(n, k)| n.div_ceil(*k))
            .collect();
        let thick = layer.len() / each;
        for number in 0..counts.iter().product() {
            // The position of chunk `number`, the last axis fastest.
            let mut rest = number;
            let mut place = vec![0; counts.len()];
            for (at, count) in place.iter_mut().zip(&counts).rev() {
                *at = rest % count;
                rest /= count;
            }
            let mut file = folder.join("c").join(self.layer.to_string());
            file.extend(place.iter().map(usize::to_string));
            if let Some(folder) = file.parent() {
                fs::create_dir_all(folder)?;
            }
            let mut encoder = GzEncoder::new(Vec::new(), Compression::new(5));
            encoder.write_all(&self.chunk_of(layer, thick, &place))?;
            fs::write(&file, encoder.finish()?)?;
        }
        Ok(())
    }

    /// The bytes of one chunk; samples beyond the array are 0.
    fn chunk_of(&self, layer: &[u8], thick: usize, place: &[usize]) -> Vec<u8> {
        let size = self.bytes;
        let mut chunk = vec![0; self.chunk.iter().product::<usize>() * size];
        let axes = self.sizes.len();
        // The start and the length of its part within the array, along each axis; the layer begins at 0 along the first.
        let start = |axis: usize| {
            if axis == 0 {
                0
            } else {
                place[axis - 1] * self.chunk[axis]
            }
        };
        let total = |axis: usize| if axis == 0 { thick } else { self.sizes[axis] };
        let length = |axis: usize| self.chunk[axis].min(total(axis) - start(axis));
        let last = axes - 1;
        let run = length(last) * size;
        let rows: usize = (0..last).map(length).product();
        for n in 0..rows {
            let (mut rest, mut from, mut to) = (n, 0, 0);
            let (mut from_stride, mut to_stride) = (total(last), self.chunk[last]);
            for axis in (0..last).rev() {
                let index = rest % length(axis);
                rest /= length(axis);
                from += (start(axis) + index) * from_stride;
                to += index * to_stride;
                from_stride *= total(axis);
                to_stride *= self.chunk[axis];
            }
            from = (from + start(last)) * size;
            chunk[to * size..to * size + run].copy_from_slice(&layer[from..from + run]);
        }
        chunk
    }
}
