//! Arrays with random access in their file, in bricks of a page each.

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use super::cache::locked;
use super::layout::{StoredLayout, strides};
use super::samples::CubeSamples;
use super::store::{Located, Store};
use crate::error::{Error, Result};
use crate::io::files::{Reader, Stamp};

/// Bytes of the file in a brick, for random access.
pub const BRICK: u64 = 4096;

/// An array that is read by positioned reads.
#[derive(Debug)]
pub(super) struct Pages {
    path: PathBuf,
    file: Positioned,
    layout: StoredLayout,
    shape: [usize; 4],
    /// The channels that are read of those in the file; all if `None`.
    taken: Option<Box<[usize]>>,
    /// The strides along H, W, T and C in the file.
    strides: [u64; 4],
    /// Samples in the file.
    count: u64,
    /// Samples in a brick, as a power of 2; and how many of the first brick's are before the file's first sample, so that bricks are
    /// aligned to pages.
    per_brick: u32,
    skew: u64,
    /// Whether entries along H, W, T and C follow one another in this order.
    is_in_order: bool,
}

/// The positions of samples if bricks hold them in counting order.
#[derive(Debug, Clone, Copy)]
pub(super) struct InOrder {
    /// As in [`Pages`].
    per_brick: u32,
    skew: u64,
}

impl InOrder {
    /// The brick that contains all of `count` samples from the `first` on, and the first position in it; `None` if there are several.
    #[inline(always)]
    pub fn whole(self, first: u64, count: usize) -> Option<(u64, usize)> {
        let at = first + self.skew;
        let in_brick = 1 << self.per_brick;
        let from = (at & (in_brick - 1)) as usize;
        (from + count <= in_brick as usize).then_some((at >> self.per_brick, from))
    }
}

/// A file for positioned reads.
#[derive(Debug)]
enum Positioned {
    #[cfg(unix)]
    File(File, Stamp),
    Reader(Mutex<ReaderOf>),
}

struct ReaderOf(Reader);

impl std::fmt::Debug for ReaderOf {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.write_str("Reader")
    }
}

impl Positioned {
    fn new(located: Located, path: &Path) -> Result<Positioned> {
        #[cfg(unix)]
        match located {
            Located::Spooled(file) => return Positioned::of(file, path),
            Located::InPlace(_) if crate::io::files::is_on_disk(path) => {
                let file = File::open(path).map_err(Error::io(path, "cannot read"))?;
                return Positioned::of(file, path);
            }
            Located::InPlace(_) => {}
        }
        let _ = path;
        Ok(Positioned::Reader(Mutex::new(ReaderOf(
            located.into_reader(),
        ))))
    }

    #[cfg(unix)]
    fn of(file: File, path: &Path) -> Result<Positioned> {
        let metadata = file.metadata().map_err(Error::io(path, "cannot read"))?;
        Ok(Positioned::File(file, Stamp::of(&metadata)))
    }

    /// Whether the file's content is what it was when opened, as far as the operating system can tell.
    fn is_unchanged(&self) -> bool {
        match self {
            #[cfg(unix)]
            Positioned::File(file, stamp) => file.metadata().is_ok_and(|now| stamp.holds(&now)),
            Positioned::Reader(_) => true,
        }
    }

    fn read(&self, bytes: &mut [u8], position: u64) -> io::Result<()> {
        match self {
            #[cfg(unix)]
            Positioned::File(file, _) => {
                std::os::unix::fs::FileExt::read_exact_at(file, bytes, position)
            }
            Positioned::Reader(reader) => {
                let mut reader = locked(reader);
                reader.0.seek(io::SeekFrom::Start(position))?;
                reader.0.read_exact(bytes)
            }
        }
    }
}

/// The error for a file that changes while it is read.
pub(super) fn changed(path: &Path) -> Error {
    let what = "the file was changed while it was read";
    Error::invalid(path, "", what, "run the command again when it is complete")
}

impl Pages {
    pub fn new(path: &Path, located: Located, layout: StoredLayout) -> Result<Pages> {
        let size = layout.number.stored();
        // Samples take 1, 2, 4 or 8 bytes.
        let per_brick = (BRICK / size).ilog2();
        let mut along = [0; 4];
        for (slot, stride) in layout.axes.slots().into_iter().zip(strides(&layout.sizes)) {
            if let Some(slot) = slot {
                along[slot] = stride as u64;
            }
        }
        let shape = layout.shape(path)?;
        let [_, width, bins, channels] = shape.map(|n| n as u64);
        let in_order = [width * bins * channels, bins * channels, channels, 1];
        // An axis of one entry has no next entry.
        let follows = |k: usize| shape[k] == 1 || along[k] == in_order[k];
        Ok(Pages {
            path: path.to_path_buf(),
            file: Positioned::new(located, path)?,
            is_in_order: (0..4).all(follows),
            shape,
            taken: None,
            strides: along,
            count: layout.sizes.iter().product::<usize>() as u64,
            per_brick,
            // Bricks are pages of the file: the first one lacks the samples that would lie before the array.
            skew: match layout.start % size {
                0 => layout.start / size % (1 << per_brick),
                _ => 0,
            },
            layout,
        })
    }

    /// The same with only these of its channels.
    pub fn taking(self, channels: &[usize]) -> Pages {
        let [h, w, t, _] = self.shape;
        Pages {
            shape: [h, w, t, channels.len()],
            taken: Some(channels.into()),
            is_in_order: false,
            ..self
        }
    }

    pub fn shape(&self) -> [usize; 4] {
        self.shape
    }

    /// Checks that everything read from the file was its content when it was opened.
    ///
    /// # Errors
    /// The file has been changed since.
    pub fn check_unchanged(&self) -> Result<()> {
        match self.file.is_unchanged() {
            true => Ok(()),
            false => Err(changed(&self.path)),
        }
    }

    pub fn layout(&self) -> &StoredLayout {
        &self.layout
    }

    pub fn per_brick(&self) -> u64 {
        1 << self.per_brick
    }

    /// Calls `each` with the positions of `count` samples from the `first` of the file on: the brick, the first position in it, and the
    /// number.
    #[inline(always)]
    pub fn run(&self, first: u64, mut count: usize, mut each: impl FnMut(u64, usize, usize)) {
        let mut at = first + self.skew;
        while count > 0 {
            let from = (at & (self.per_brick() - 1)) as usize;
            let now = count.min(self.per_brick() as usize - from);
            each(at >> self.per_brick, from, now);
            at += now as u64;
            count -= now;
        }
    }

    /// The positions of samples if the file stores them by rows, columns, bins and channels; `None` otherwise.
    pub fn in_order(&self) -> Option<InOrder> {
        self.is_in_order.then_some(InOrder {
            per_brick: self.per_brick,
            skew: self.skew,
        })
    }

    pub fn bricks(&self) -> u64 {
        (self.count + self.skew).div_ceil(self.per_brick())
    }

    /// Bytes of a brick in the file.
    pub fn bytes(&self, brick: u64) -> u64 {
        let [begin, end] = self.range(brick, brick + 1);
        (end - begin) * self.layout.number.stored()
    }

    /// The samples of bricks `first` to `end`.
    fn range(&self, first: u64, end: u64) -> [u64; 2] {
        [first, end].map(|brick| {
            let sample = (brick << self.per_brick).saturating_sub(self.skew);
            sample.min(self.count)
        })
    }

    /// Calls `each` with the positions of a pixel's samples, from `bin` on, bin by bin: the brick, the first position in it, and the
    /// number.
    #[inline(always)]
    pub fn runs(
        &self,
        pixel: usize,
        bin: usize,
        bins: usize,
        mut each: impl FnMut(u64, usize, usize),
    ) {
        let [row, column, between, channel] = self.strides;
        let [_, width, _, channels] = self.shape;
        let first =
            (pixel / width) as u64 * row + (pixel % width) as u64 * column + bin as u64 * between;
        // Contiguous samples, brick by brick.
        let mut run = |first: u64, count: usize| self.run(first, count, &mut each);
        if let Some(taken) = &self.taken {
            for bin in 0..bins as u64 {
                for c in taken {
                    run(first + bin * between + *c as u64 * channel, 1);
                }
            }
            return;
        }
        let is_together = channels == 1 || channel == 1;
        if is_together && between == channels as u64 {
            return run(first, bins * channels);
        }
        for bin in 0..bins as u64 {
            match is_together {
                true => run(first + bin * between, channels),
                false => {
                    for c in 0..channels as u64 {
                        run(first + bin * between + c * channel, 1);
                    }
                }
            }
        }
    }

    /// `count` bricks from the `first` on, in one read; the last of the file may be shorter.
    pub fn load(&self, first: u64, count: u64) -> Result<Vec<CubeSamples>> {
        let size = self.layout.number.stored();
        let [begin, end] = self.range(first, first + count);
        let mut bytes = vec![0; ((end - begin) * size) as usize];
        let position = self.layout.start + begin * size;
        (self.file.read(&mut bytes, position))
            .map_err(|error| Store::unreadable(&self.path, error))?;
        let mut bricks = Vec::with_capacity(count as usize);
        for brick in first..first + count {
            let [from, to] = self.range(brick, brick + 1);
            let bytes = &bytes[((from - begin) * size) as usize..((to - begin) * size) as usize];
            let mut samples = self.layout.number.samples(bytes, self.layout.big_endian);
            if let Some(bad) = samples.first_not_finite(0..samples.len()) {
                let number = self.layout.number;
                return Err(Store::not_finite(&self.path, number, from + bad as u64));
            }
            // The file has no samples before its first one.
            if brick == 0 {
                samples.pad(self.skew as usize);
            }
            bricks.push(samples);
        }
        Ok(bricks)
    }
}
