//! Cubes on disk that are read in bricks, as lookups need them: what is too large for memory.
//!
//! A brick is 4 KiB of the file, a page of most disks; samples keep the order that they have there. Neighbouring
//! samples in time (or, of frames, in a row) share one. A batch of lookups first names all bricks that it needs; those
//! that are missing are read in the order of the file, neighbours in one go, by reads at a position, so that threads
//! need not share one. Bricks stay as long as there is room; then one that was not used for long makes way. One that comes back is counted as read again.
//!
//! What is read cannot depend on what was there before: samples are those of the whole cube, whatever the room, the
//! order and the number of threads. A file is not mapped, so that one which shrinks meanwhile is an error and no signal.
//! Lookups cannot fail: the first failure is kept, zeros stand in, and [`Bricks::check`] tells.

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use half::f16;

use super::cache::Cache;
use super::format::Wanted;
use super::layout::{StoredLayout, strides};
use super::samples::Samples;
use super::store::{Located, Store};
use crate::error::{Error, Result};
use crate::io::files::Reader;
use crate::io::npy::Dtype;

/// Bytes of the file in a brick.
pub const BRICK: u64 = 4096;
/// Bricks that lie together and share a lock: as many as a word has bits.
const GROUP: u64 = 64;
/// Locks.
const SHARDS: usize = 64;
/// What there is to a brick beside its samples: its entries in tables, and what the allocator loses. Measured: 290 where
/// neighbours are read together, 850 where each is read alone.
const BESIDE: u64 = 850;
/// Bricks that a thread has at hand without a lock.
const AT_HAND: usize = 1024;

/// The least room for bricks, bytes.
pub const LEAST_ROOM: u64 = 8 << 20;

/// A cube on disk.
#[derive(Debug)]
pub struct Bricks {
    /// Tells cubes apart.
    number: u64,
    path: PathBuf,
    file: Positioned,
    layout: StoredLayout,
    shape: [usize; 4],
    /// How far apart in the file entries along H, W, T and C are.
    strides: [u64; 4],
    /// Samples in the file.
    count: u64,
    /// Samples in a brick, and how many of the first brick's lie before the file's first sample: so that bricks begin
    /// where pages do.
    per_brick: u64,
    skew: u64,
    /// By groups of bricks, a bit for each that has been read.
    seen: Box<[AtomicU64]>,
    cache: Cache<Arc<Samples>>,
    /// Whether bricks are only counted, and nothing is read.
    counts_only: bool,
    zeros: Arc<Samples>,
    read: AtomicU64,
    read_again: AtomicU64,
    failed: AtomicBool,
    failure: Mutex<Option<Error>>,
}

/// Bytes that have been read of cubes on disk.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct BytesRead {
    /// All.
    pub all: u64,
    /// The part of it that had been read before, and made way meanwhile.
    pub again: u64,
}

/// Bricks that a thread has at hand.
#[derive(Debug, Default)]
pub struct Held(Vec<Option<(u64, u64, Arc<Samples>)>>);

/// A file that is read at positions.
#[derive(Debug)]
enum Positioned {
    #[cfg(unix)]
    File(File),
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
            Located::Spooled(file) => return Ok(Positioned::File(file)),
            Located::InPlace(_) if crate::io::files::is_on_disk(path) => {
                let file = File::open(path).map_err(Error::io(path, "cannot read"))?;
                return Ok(Positioned::File(file));
            }
            Located::InPlace(_) => {}
        }
        let _ = path;
        Ok(Positioned::Reader(Mutex::new(ReaderOf(
            located.into_reader(),
        ))))
    }

    fn read(&self, bytes: &mut [u8], position: u64) -> io::Result<()> {
        match self {
            #[cfg(unix)]
            Positioned::File(file) => {
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

impl Bricks {
    /// The cube at `path` that is `wanted` of it, by the checks of loading it; its bricks may take `room` bytes of
    /// memory, at least [`LEAST_ROOM`]. Members of archives and pictures of sequences are written to a temporary file.
    ///
    /// # Errors
    /// As for [`load`](super::load), but for samples that are not finite.
    pub fn open(path: &Path, wanted: Wanted, room: u64) -> Result<Bricks> {
        let (located, layout) = Store::locate(path, wanted)?;
        let file = Positioned::new(located, path)?;
        Bricks::new(path, file, layout, room, false)
    }

    /// The same to count bricks that would be read; nothing is, and all samples are 0. None for pictures and archives,
    /// in which samples have no place.
    ///
    /// # Errors
    /// As for [`Bricks::open`].
    pub fn counting(path: &Path, wanted: Wanted) -> Result<Option<Bricks>> {
        let Some((located, layout)) = Store::locate_in_place(path, wanted)? else {
            return Ok(None);
        };
        let file = Positioned::new(located, path)?;
        Bricks::new(path, file, layout, 0, true).map(Some)
    }

    fn new(
        path: &Path,
        file: Positioned,
        layout: StoredLayout,
        room: u64,
        counts_only: bool,
    ) -> Result<Bricks> {
        static NEXT: AtomicU64 = AtomicU64::new(0);
        let size = layout.number.stored();
        let per_brick = BRICK / size;
        let skew = match layout.start % size {
            0 => layout.start / size % per_brick,
            _ => 0,
        };
        let count = layout.sizes.iter().product::<usize>() as u64;
        let bricks = (count + skew).div_ceil(per_brick);
        let mut along = [0; 4];
        for (slot, stride) in layout.axes.slots().into_iter().zip(strides(&layout.sizes)) {
            if let Some(slot) = slot {
                along[slot] = stride as u64;
            }
        }
        let (dtype, loaded) = layout.number.loaded();
        let each = per_brick * loaded + BESIDE;
        Ok(Bricks {
            number: NEXT.fetch_add(1, Ordering::Relaxed),
            path: path.to_path_buf(),
            file,
            shape: layout.shape(path)?,
            strides: along,
            count,
            per_brick,
            skew,
            seen: (0..bricks.div_ceil(GROUP))
                .map(|_| AtomicU64::new(0))
                .collect(),
            cache: Cache::new((room / each) as usize, SHARDS),
            counts_only,
            zeros: Arc::new(zeros(&dtype, per_brick as usize)),
            layout,
            read: AtomicU64::new(0),
            read_again: AtomicU64::new(0),
            failed: AtomicBool::new(false),
            failure: Mutex::new(None),
        })
    }

    /// Whether bricks are only counted.
    pub fn counts_only(&self) -> bool {
        self.counts_only
    }

    /// H, W, T, C.
    pub fn shape(&self) -> [usize; 4] {
        self.shape
    }

    /// Bytes of its samples as they are held.
    pub fn sample_bytes(&self) -> usize {
        self.layout.number.loaded().1 as usize
    }

    /// What has been read so far; or, where bricks are counted, what would have been.
    pub fn bytes_read(&self) -> BytesRead {
        BytesRead {
            all: self.read.load(Ordering::Relaxed),
            again: self.read_again.load(Ordering::Relaxed),
        }
    }

    /// Whether something could not be read.
    pub fn has_failed(&self) -> bool {
        self.failed.load(Ordering::Relaxed)
    }

    /// Whether all that was asked for could be read.
    ///
    /// # Errors
    /// The first failure; whoever asks again is told that the work was given up.
    pub fn check(&self) -> Result<()> {
        if !self.has_failed() {
            return Ok(());
        }
        let first = locked(&self.failure).take();
        Err(first.unwrap_or(Error::Cancelled))
    }

    /// Fills `to` with the samples of bins `bin` and on of a pixel, as many as it has room for, bin by bin.
    pub fn samples(&self, held: &mut Held, pixel: usize, bin: usize, to: &mut [f64]) {
        let first = self.place(pixel, bin);
        let [_, _, between, channel] = self.strides;
        let channels = self.shape[3];
        let is_together = channels == 1 || channel == 1;
        if is_together && between == channels as u64 {
            return self.run(held, first, to);
        }
        for (bin, to) in (0..).zip(to.chunks_mut(channels)) {
            let first = first + bin * between;
            match is_together {
                true => self.run(held, first, to),
                false => {
                    for (c, to) in (0..).zip(to) {
                        self.run(held, first + c * channel, std::slice::from_mut(to));
                    }
                }
            }
        }
    }

    /// One sample.
    pub fn sample(&self, pixel: usize, bin: usize, channel: usize) -> f64 {
        let at = self.place(pixel, bin) + channel as u64 * self.strides[3];
        let mut sample = 0.0;
        self.run(&mut Held::default(), at, std::slice::from_mut(&mut sample));
        sample
    }

    /// Notes the bricks of `bins` bins of a pixel that are not at hand.
    pub fn want(&self, held: &Held, pixel: usize, bin: usize, bins: usize, wanted: &mut Vec<u64>) {
        let first = self.place(pixel, bin) + self.skew;
        let [_, _, between, channel] = self.strides;
        let channels = self.shape[3] as u64;
        let mut note = |first: u64, last: u64| {
            let bricks = first / self.per_brick..=last / self.per_brick;
            wanted.extend(bricks.filter(|brick| held.get(self.number, *brick).is_none()));
        };
        if (channels == 1 || channel == 1) && between == channels {
            return note(first, first + bins as u64 * channels - 1);
        }
        for bin in 0..bins as u64 {
            for c in 0..channels {
                let at = first + bin * between + c * channel;
                note(at, at);
            }
        }
    }

    /// Gets all `wanted` bricks at hand, and empties the list.
    pub fn bring(&self, held: &mut Held, wanted: &mut Vec<u64>) {
        wanted.sort_unstable();
        wanted.dedup();
        for group in wanted.chunk_by(|a, b| a / GROUP == b / GROUP) {
            if self.counts_only {
                group.iter().for_each(|brick| self.note(*brick));
                continue;
            }
            let mut cache = self.cache.lock(group[0] / GROUP);
            let mut missing: Vec<u64> = Vec::new();
            for brick in group {
                match cache.get(*brick) {
                    Some(samples) => held.put(self.number, *brick, samples),
                    None => missing.push(*brick),
                }
            }
            for run in missing.chunk_by(|a, b| a + 1 == *b) {
                for (brick, samples) in (run[0]..).zip(self.load(run[0], run.len() as u64)) {
                    held.put(self.number, brick, samples.clone());
                    cache.insert(brick, samples);
                }
            }
        }
        wanted.clear();
    }

    /// Index in the file of the first sample of a bin of a pixel.
    #[inline]
    fn place(&self, pixel: usize, bin: usize) -> u64 {
        let [_, width, ..] = self.shape;
        let [row, column, between, _] = self.strides;
        (pixel / width) as u64 * row + (pixel % width) as u64 * column + bin as u64 * between
    }

    /// Samples that lie together in the file.
    #[inline]
    fn run(&self, held: &mut Held, first: u64, mut to: &mut [f64]) {
        let mut at = first + self.skew;
        while !to.is_empty() {
            let (brick, from) = (at / self.per_brick, (at % self.per_brick) as usize);
            let count = to.len().min(self.per_brick as usize - from);
            let (now, later) = to.split_at_mut(count);
            self.copy(held, brick, from, now);
            at += count as u64;
            to = later;
        }
    }

    /// Samples of one brick, from its `from`-th on.
    #[inline]
    fn copy(&self, held: &mut Held, brick: u64, from: usize, to: &mut [f64]) {
        if let Some(samples) = held.get(self.number, brick) {
            return widen(samples, from, to);
        }
        if self.counts_only {
            self.note(brick);
            return to.fill(0.0);
        }
        let mut cache = self.cache.lock(brick / GROUP);
        if let Some(samples) = cache.get(brick) {
            return widen(&samples, from, to);
        }
        for samples in self.load(brick, 1) {
            widen(&samples, from, to);
            cache.insert(brick, samples);
        }
    }

    /// Reads `count` bricks from the `first` on, none of which is there; the lock of their shard is held, so that nobody
    /// else reads them.
    fn load(&self, first: u64, count: u64) -> Vec<Arc<Samples>> {
        (first..first + count).for_each(|brick| self.note(brick));
        let size = self.layout.number.stored();
        let [begin, end] = [first, first + count].map(|brick| {
            (brick * self.per_brick)
                .saturating_sub(self.skew)
                .min(self.count)
        });
        let mut bytes = vec![0; ((end - begin) * size) as usize];
        let position = self.layout.start + begin * size;
        if let Err(error) = self.file.read(&mut bytes, position) {
            self.fail(Store::unreadable(&self.path, error));
            return vec![self.zeros.clone(); count as usize];
        }
        let mut numbers = Vec::with_capacity((end - begin + self.skew) as usize);
        if first == 0 {
            numbers.resize(self.skew as usize, 0.0);
        }
        self.layout
            .number
            .decode(&bytes, self.layout.big_endian, &mut numbers);
        if let Some(bad) = numbers.iter().position(|number| !number.is_finite()) {
            let before = if first == 0 { self.skew } else { 0 };
            self.fail(Store::not_finite(&self.path, begin + bad as u64 - before));
            return vec![self.zeros.clone(); count as usize];
        }
        let (dtype, _) = self.layout.number.loaded();
        let each = numbers.chunks(self.per_brick as usize);
        each.map(|numbers| Arc::new(narrow(&dtype, numbers)))
            .collect()
    }

    /// Counts the bytes of a brick that is read.
    fn note(&self, brick: u64) {
        let bit = 1 << (brick % GROUP);
        let before = self.seen[(brick / GROUP) as usize].fetch_or(bit, Ordering::Relaxed);
        let again = before & bit != 0;
        if again && self.counts_only {
            return;
        }
        let [begin, end] = [brick, brick + 1].map(|brick| {
            (brick * self.per_brick)
                .saturating_sub(self.skew)
                .min(self.count)
        });
        let bytes = (end - begin) * self.layout.number.stored();
        self.read.fetch_add(bytes, Ordering::Relaxed);
        if again {
            self.read_again.fetch_add(bytes, Ordering::Relaxed);
        }
    }

    fn fail(&self, error: Error) {
        let mut failure = locked(&self.failure);
        if !self.failed.swap(true, Ordering::Relaxed) {
            *failure = Some(error);
        }
    }
}

impl Held {
    #[inline]
    fn slot(cube: u64, brick: u64) -> usize {
        let mixed = (brick + (cube << 40)).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32;
        mixed as usize % AT_HAND
    }

    #[inline]
    fn get(&self, cube: u64, brick: u64) -> Option<&Samples> {
        match self.0.get(Held::slot(cube, brick)) {
            Some(Some((of, number, samples))) if *of == cube && *number == brick => Some(samples),
            _ => None,
        }
    }

    fn put(&mut self, cube: u64, brick: u64, samples: Arc<Samples>) {
        if self.0.is_empty() {
            self.0.resize(AT_HAND, None);
        }
        self.0[Held::slot(cube, brick)] = Some((cube, brick, samples));
    }
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Samples as numbers; zeros beyond the last.
#[inline]
fn widen(samples: &Samples, from: usize, to: &mut [f64]) {
    #[inline(always)]
    fn each<T: Copy>(samples: &[T], from: usize, to: &mut [f64], number: impl Fn(T) -> f64) {
        let samples = samples.get(from..).unwrap_or_default();
        to.iter_mut()
            .zip(samples)
            .for_each(|(to, sample)| *to = number(*sample));
    }
    match samples {
        Samples::F16(samples) => each(samples, from, to, f16::to_f64),
        Samples::F32(samples) => each(samples, from, to, f64::from),
        Samples::F64(samples) => each(samples, from, to, |number| number),
    }
}

/// Numbers that are of this type, in it.
fn narrow(dtype: &Dtype, numbers: &[f64]) -> Samples {
    match dtype {
        Dtype::F16 => Samples::F16(numbers.iter().map(|x| f16::from_f64(*x)).collect()),
        Dtype::F32 => Samples::F32(numbers.iter().map(|x| *x as f32).collect()),
        Dtype::F64 | Dtype::Other(_) => Samples::F64(numbers.to_vec()),
    }
}

fn zeros(dtype: &Dtype, count: usize) -> Samples {
    narrow(dtype, &vec![0.0; count])
}
