//! Arrays in chunks, compressed or stored separately, as bricks of one chunk each.
//!
//! A sample (h, w, t, c) of the cube has an index along each axis of the array, which is one of h, w, t and c, or, if the axis is a list
//! of points, h · columns + w. Along an axis with chunks of n entries, index i is in chunk ⌊i/n⌋, at i mod n; so the brick and the
//! position in it are sums over the axes, with a term for each axis. Entries to sum over are added when a brick is read. At the ends of
//! the array chunks are padded with zeros.

use std::path::{Path, PathBuf};
use std::sync::Mutex;

use super::cache::locked;
use super::pages::changed;
use super::samples::CubeSamples;
use super::samples::place_of;
use super::selection::{Lies, Open, Selection, Windows};
use crate::error::Result;
use crate::io::files::Stamp;
use crate::io::npy::Dtype;

/// An array in chunks.
pub(super) struct Chunks {
    path: PathBuf,
    selection: Selection,
    /// The sizes of the part of the array that is read, and those of a chunk, along each of its axes.
    sizes: Vec<usize>,
    chunk: Vec<usize>,
    /// The number of chunks along each kept axis.
    counts: Vec<usize>,
    shape: [usize; 4],
    /// The channels that are read of those in the file; all if `None`.
    taken: Option<Box<[usize]>>,
    axes: Vec<KeptAxis>,
    per_brick: usize,
    open: Open,
    /// Open readers that are not in use.
    idle: Mutex<Vec<Box<dyn Windows + Send>>>,
    /// The state of the file, if chunks are in one.
    stamp: Option<Stamp>,
}

/// An axis of the array that is kept.
#[derive(Debug, Clone, Copy)]
struct KeptAxis {
    lies: Lies,
    /// The index of the axis in the array.
    axis: usize,
    /// Entries in a chunk.
    chunk: usize,
    /// The distance between chunks in brick numbers, and between entries in a brick.
    between: u64,
    stride: usize,
}

impl KeptAxis {
    #[inline(always)]
    fn place(&self, index: usize) -> (u64, usize) {
        let (chunk, entry) = (index / self.chunk, index % self.chunk);
        (chunk as u64 * self.between, entry * self.stride)
    }
}

impl std::fmt::Debug for Chunks {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.debug_struct("Chunks")
            .field("path", &self.path)
            .field("axes", &self.axes)
            .finish_non_exhaustive()
    }
}

impl Chunks {
    /// Whether the file, where chunks lie in one, holds what it held when it was opened.
    ///
    /// # Errors
    /// The file has been changed since.
    pub fn check_unchanged(&self) -> Result<()> {
        let now = || std::fs::metadata(&self.path);
        match &self.stamp {
            Some(stamp) if !now().is_ok_and(|now| stamp.holds(&now)) => Err(changed(&self.path)),
            _ => Ok(()),
        }
    }

    /// Opens the part of the array at `path` that `selection` reads; `None` if `room` bytes are too few for its chunks.
    pub fn open(
        path: &Path,
        selection: Selection,
        open: Open,
        room: u64,
    ) -> Result<Option<Chunks>> {
        let first = open()?;
        let chunks = Chunks::new(path, selection, first, open)?;
        let threads = rayon::current_num_threads().max(1) as u64;
        let each = chunks.per_brick() * chunks.dtype().1;
        // Every thread decodes one and holds two, and as many are cached.
        let least = threads * (chunks.decoding() + 5 * each);
        Ok((least <= room).then_some(chunks))
    }

    fn new(
        path: &Path,
        selection: Selection,
        first: Box<dyn Windows + Send>,
        open: Open,
    ) -> Result<Chunks> {
        let sizes = selection.kept_sizes();
        let chunk = first.together();
        let lies = selection.lies();
        let count = |axis: usize| sizes[axis].div_ceil(chunk[axis].max(1));
        // The last axis is the fastest, among bricks and inside them.
        let (mut between, mut stride) = (1, 1);
        let mut axes = Vec::new();
        for &(axis, lies) in lies.iter().rev() {
            axes.push(KeptAxis {
                lies,
                axis,
                chunk: chunk[axis].clamp(1, sizes[axis]),
                between,
                stride,
            });
            between *= count(axis) as u64;
            stride *= chunk[axis].clamp(1, sizes[axis]);
        }
        axes.reverse();
        let metadata = std::fs::metadata(path).ok();
        let file = metadata.filter(std::fs::Metadata::is_file);
        Ok(Chunks {
            stamp: file.as_ref().map(Stamp::of),
            path: path.to_path_buf(),
            counts: axes.iter().map(|kept| count(kept.axis)).collect(),
            shape: selection.arrangement(path)?.shape,
            taken: None,
            per_brick: stride,
            selection,
            sizes,
            chunk,
            axes,
            open,
            idle: Mutex::new(vec![first]),
        })
    }

    /// The same with only these of its channels.
    pub fn taking(self, channels: &[usize]) -> Chunks {
        let [h, w, t, _] = self.shape;
        Chunks {
            shape: [h, w, t, channels.len()],
            taken: Some(channels.into()),
            ..self
        }
    }

    pub fn shape(&self) -> [usize; 4] {
        self.shape
    }

    pub fn dtype(&self) -> (Dtype, u64) {
        let dtype = self.selection.dtype.clone();
        let bytes = self.selection.number().stored();
        (dtype, bytes)
    }

    pub fn per_brick(&self) -> u64 {
        self.per_brick as u64
    }

    pub fn bricks(&self) -> u64 {
        self.counts.iter().map(|n| *n as u64).product()
    }

    /// The maximum memory that a thread needs to decode a brick: the samples as stored, compressed and decompressed, and as numbers of the
    /// array and of the brick.
    pub fn decoding(&self) -> u64 {
        let whole: usize = self.chunk.iter().product();
        32 * whole as u64 + 16 * self.per_brick()
    }

    /// The window of a brick, a range per kept axis.
    fn window(&self, brick: u64) -> Vec<std::ops::Range<usize>> {
        let along = |(kept, count): (&KeptAxis, &usize)| {
            let number = (brick / kept.between) as usize % count;
            let begin = number * kept.chunk;
            begin..(begin + kept.chunk).min(self.sizes[kept.axis])
        };
        self.axes.iter().zip(&self.counts).map(along).collect()
    }

    /// Bytes of the samples of a brick.
    pub fn bytes(&self, brick: u64) -> u64 {
        let samples: usize = self
            .window(brick)
            .iter()
            .map(ExactSizeIterator::len)
            .product();
        samples as u64 * self.dtype().1
    }

    /// Calls `each` with the positions of a pixel's samples, from `bin` on, bin by bin: the brick, the first position in it, and the
    /// number.
    #[inline]
    pub fn runs(
        &self,
        pixel: usize,
        bin: usize,
        bins: usize,
        mut each: impl FnMut(u64, usize, usize),
    ) {
        let [_, width, _, channels] = self.shape;
        let (row, column) = (pixel / width, pixel % width);
        let (mut brick, mut from) = (0, 0);
        let (mut time, mut colour) = (None, None);
        for kept in &self.axes {
            let index = match kept.lies {
                Lies::Row => row,
                Lies::Column => column,
                Lies::Listed { columns } => row * columns + column,
                Lies::Nothing => 0,
                Lies::Time => {
                    time = Some(kept);
                    continue;
                }
                Lies::Channel => {
                    colour = Some(kept);
                    continue;
                }
            };
            let (chunk, entry) = kept.place(index);
            brick += chunk;
            from += entry;
        }
        let place = |axis: Option<&KeptAxis>, index| axis.map_or((0, 0), |axis| axis.place(index));
        // Consecutive samples in a brick are passed together.
        let mut run: Option<(u64, usize, usize)> = None;
        for bin in bin..bin + bins {
            let (chunk, entry) = place(time, bin);
            for channel in 0..channels {
                let channel = self.taken.as_ref().map_or(channel, |taken| taken[channel]);
                let (other, further) = place(colour, channel);
                let at = (brick + chunk + other, from + entry + further);
                match &mut run {
                    Some((brick, from, count)) if (*brick, *from + *count) == at => *count += 1,
                    _ => {
                        if let Some((brick, from, count)) = run.replace((at.0, at.1, 1)) {
                            each(brick, from, count);
                        }
                    }
                }
            }
        }
        if let Some((brick, from, count)) = run {
            each(brick, from, count);
        }
    }

    /// `count` bricks from the `first` on.
    pub fn load(&self, first: u64, count: u64) -> Result<Vec<CubeSamples>> {
        let idle = locked(&self.idle).pop();
        let mut array = match idle {
            Some(array) => array,
            None => (self.open)()?,
        };
        let mut bricks = Vec::with_capacity(count as usize);
        let (mut window, mut filled) = (Vec::new(), Vec::new());
        for brick in first..first + count {
            let ranges = self.window(brick);
            self.selection.window(&mut *array, &ranges, &mut window)?;
            self.check(&ranges, &window)?;
            let numbers = self.fill_up(&ranges, &window, &mut filled);
            bricks.push(CubeSamples::of(&self.selection.dtype, numbers));
        }
        locked(&self.idle).push(array);
        Ok(bricks)
    }

    /// Refuses samples that are not finite.
    fn check(&self, ranges: &[std::ops::Range<usize>], window: &[f64]) -> Result<()> {
        let Some(bad) = window.iter().position(|number| !number.is_finite()) else {
            return Ok(());
        };
        let (mut rest, mut place) = (bad, 0);
        let mut strides = vec![1; ranges.len()];
        for axis in (1..ranges.len()).rev() {
            strides[axis - 1] = strides[axis] * self.sizes[self.axes[axis].axis];
        }
        for ((range, kept), stride) in ranges.iter().zip(&self.axes).zip(&strides).rev() {
            let index = range.start + rest % range.len();
            rest /= range.len();
            debug_assert!(index < self.sizes[kept.axis]);
            place += index * stride;
        }
        let arrangement = self.selection.arrangement(&self.path)?;
        let place = place_of(arrangement.place(place), arrangement.shape);
        Err(Selection::not_finite(&self.path, place))
    }

    /// Pads a window to a whole chunk, if necessary in `brick`.
    fn fill_up<'a>(
        &self,
        ranges: &[std::ops::Range<usize>],
        window: &'a [f64],
        brick: &'a mut Vec<f64>,
    ) -> &'a [f64] {
        if window.len() == self.per_brick {
            return window;
        }
        brick.clear();
        brick.resize(self.per_brick, 0.0);
        let run = ranges.last().map_or(1, ExactSizeIterator::len);
        for (number, samples) in window.chunks(run).enumerate() {
            let (mut rest, mut at) = (number, 0);
            for (range, kept) in ranges.iter().zip(&self.axes).rev().skip(1) {
                at += rest % range.len() * kept.stride;
                rest /= range.len();
            }
            brick[at..at + run].copy_from_slice(samples);
        }
        brick
    }
}
