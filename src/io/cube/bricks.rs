//! Cubes on disk that are read in bricks on demand, for cubes that are too large for memory.
//!
//! A brick is 4 KiB of the file, a page of most disks; samples keep their order in the file. Neighbouring samples in time (or, in frames,
//! in a row) share one. For chunked arrays a brick is a decoded chunk. A batch of lookups first names all bricks that it needs; those
//! that are missing are read in file order, neighbours together, by positioned reads, so that threads need not share a file position.
//! Bricks stay while there is room; then one that has not been used for a long time is evicted. One that is read a second time is counted
//! as read again.
//!
//! What is read cannot depend on what was there before: samples are those of the whole cube, whatever the room, the order and the number
//! of threads. A file is not memory-mapped, so that a shrinking file is an error, not a signal. Lookups cannot fail: the first failure is
//! kept, zeros are returned, and [`Bricks::check`] reports it.

use std::collections::{HashMap, VecDeque};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex};

use super::cache::{Cache, locked};
#[cfg(any(feature = "hdf5", feature = "zarr"))]
use super::chunks::Chunks;
use super::dead::DeadBins;
use super::negative::Negative;
use super::pages::{InOrder, Pages};
use super::samples::CubeSamples;
use super::store::Store;
use super::wanted::Wanted;
use crate::error::{Error, Result};
use crate::io::npy::Dtype;

/// Consecutive pages that share a lock: as many as a word has bits.
const GROUP: u64 = 64;
/// Locks.
const SHARDS: usize = 64;
/// The overhead of a brick beside its samples: its table entries and allocator overhead. Measured: 250 to 290.
const BESIDE: u64 = 400;
/// The largest number of bricks that a thread holds without a lock.
const AT_HAND: usize = 1024;

/// The minimal room for bricks, bytes.
pub const LEAST_ROOM: u64 = 8 << 20;

/// A cube on disk.
#[derive(Debug)]
pub struct Bricks {
    /// Identifies the cube.
    number: u64,
    form: Form,
    shape: [usize; 4],
    dtype: Dtype,
    /// Bytes of a sample in memory.
    sample_bytes: u64,
    /// By groups of bricks, a bit for each that has been read.
    seen: Box<[AtomicU64]>,
    cache: Cache<Arc<CubeSamples>>,
    /// Evicted bricks, whose memory the next ones reuse: memory freed by one thread and requested by another would not be reused, because
    /// allocators keep memory by thread.
    spare: Mutex<VecDeque<Arc<CubeSamples>>>,
    /// The number of bricks that a thread holds.
    at_hand: usize,
    /// Whether bricks are only counted, and nothing is read.
    counts_only: bool,
    zeros: Arc<CubeSamples>,
    dead: DeadBins,
    negative: Negative,
    path: PathBuf,
    read: AtomicU64,
    read_again: AtomicU64,
    failed: AtomicBool,
    failure: Mutex<Option<Error>>,
}

/// The layout of samples in bricks.
#[derive(Debug)]
enum Form {
    /// As in the file.
    Pages(Pages),
    /// In chunks that are decoded.
    #[cfg(any(feature = "hdf5", feature = "zarr"))]
    Chunks(Chunks),
}

/// Evaluates the same expression for either form.
macro_rules! with_form {
    ($form:expr, $of:ident => $do:expr) => {
        match $form {
            Form::Pages($of) => $do,
            #[cfg(any(feature = "hdf5", feature = "zarr"))]
            Form::Chunks($of) => $do,
        }
    };
}

/// Bytes read from cubes on disk; for chunks, those of their samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct BytesRead {
    /// All.
    pub all: u64,
    /// The part of it that had been read before and was evicted in the meantime.
    pub again: u64,
}

/// Bricks held by a thread.
#[derive(Debug, Default)]
pub struct Held(Vec<Option<(u64, u64, Arc<CubeSamples>)>>);

/// Bricks read outside of lookups.
#[derive(Debug, Default)]
pub struct Peeked(HashMap<u64, CubeSamples>);

/// The division of the memory for bricks.
struct Room {
    /// The number of bricks that the cache keeps, and of its locks.
    kept: usize,
    shards: usize,
    /// The number of bricks that a thread holds, which may have left the cache.
    at_hand: usize,
}

impl Room {
    /// For `bytes` bytes of bricks that take `each`. Every thread may hold bricks for lookups of three kinds.
    fn new(bytes: u64, each: u64) -> Room {
        let bricks = bytes / each;
        // A sixteenth of the room for each kind of lookup, shared among threads; the cache has the rest.
        let at_hand = (bricks / 16 / threads()).clamp(1, AT_HAND as u64);
        let shards = (bricks / 16).clamp(1, SHARDS as u64);
        // In addition to the cache: bricks held by threads, which may have left it, for lookups of three kinds, and one more for each
        // lock.
        let kept = bricks.saturating_sub(3 * at_hand * threads() + shards);
        Room {
            kept: kept as usize,
            shards: shards as usize,
            at_hand: at_hand as usize,
        }
    }
}

fn threads() -> u64 {
    rayon::current_num_threads().max(1) as u64
}

impl Form {
    fn bricks(&self) -> u64 {
        with_form!(self, of => of.bricks())
    }

    fn per_brick(&self) -> u64 {
        with_form!(self, of => of.per_brick())
    }

    fn load(&self, first: u64, count: u64) -> Result<Vec<CubeSamples>> {
        with_form!(self, of => of.load(first, count))
    }

    /// Bricks with the same number share a lock.
    fn group(&self, brick: u64) -> u64 {
        match self {
            Form::Pages(_) => brick / GROUP,
            // Decoding takes long.
            #[cfg(any(feature = "hdf5", feature = "zarr"))]
            Form::Chunks(_) => brick,
        }
    }
}

impl Bricks {
    /// Opens the part `wanted` of the cube at `path`, with the checks of loading it; its bricks may take `room` bytes of memory, at least
    /// 8 MiB. Members of archives, pictures of sequences, and arrays with chunks that do not fit into the room are first written
    /// to a temporary file.
    ///
    /// # Errors
    /// As for [`load`](super::load), except for samples that are not finite.
    pub fn open(path: &Path, wanted: Wanted, room: u64) -> Result<Bricks> {
        #[cfg(any(feature = "hdf5", feature = "zarr"))]
        if let Some(chunks) = Bricks::chunks(path, wanted, room)? {
            return Bricks::of_chunks(chunks, room, false).mended(path, wanted);
        }
        let (located, layout) = Store::locate(path, wanted)?;
        let pages = Pages::new(path, located, layout)?;
        Bricks::of_pages(pages, room, false).mended(path, wanted)
    }

    /// The same for counting the bricks that would be read; nothing is read, and all samples are 0. `None` for cubes that are first
    /// written to a temporary file.
    ///
    /// # Errors
    /// As for [`Bricks::open`].
    pub fn counting(path: &Path, wanted: Wanted, room: u64) -> Result<Option<Bricks>> {
        #[cfg(any(feature = "hdf5", feature = "zarr"))]
        if let Some(chunks) = Bricks::chunks(path, wanted, room)? {
            return Bricks::of_chunks(chunks, 0, true)
                .mended(path, wanted)
                .map(Some);
        }
        // Counting needs no room except for chunks, which only these features have.
        let _ = room;
        let Some((located, layout)) = Store::locate_in_place(path, wanted)? else {
            return Ok(None);
        };
        let pages = Pages::new(path, located, layout)?;
        Bricks::of_pages(pages, 0, true)
            .mended(path, wanted)
            .map(Some)
    }

    /// The same with only these of its channels, in this order.
    #[must_use]
    pub fn taking(self, channels: &[usize]) -> Bricks {
        let form = match self.form {
            Form::Pages(pages) => Form::Pages(pages.taking(channels)),
            #[cfg(any(feature = "hdf5", feature = "zarr"))]
            Form::Chunks(chunks) => Form::Chunks(chunks.taking(channels)),
        };
        let shape = with_form!(&form, of => of.shape());
        Bricks {
            form,
            shape,
            ..self
        }
    }

    /// The same with its dead bins interpolated, and with the treatment of negative samples in `wanted`.
    fn mended(self, path: &Path, wanted: Wanted) -> Result<Bricks> {
        if self.shape.contains(&0) {
            let what = format!("a cube of shape {:?} has no samples", self.shape);
            let help = "every axis must have a size of at least 1";
            return Err(Error::invalid(path, "", what, help));
        }
        let dead = DeadBins::new(path, wanted, self.shape[2])?;
        Ok(Bricks {
            dead,
            negative: wanted.negative.unwrap_or(Negative::Keep),
            path: path.to_path_buf(),
            ..self
        })
    }

    /// `count` bricks from the `first` on, with the requested treatment of negative samples.
    fn read(&self, first: u64, count: u64) -> Result<Vec<CubeSamples>> {
        let mut bricks = self.form.load(first, count)?;
        for samples in &mut bricks {
            self.negative.apply_to_samples(samples, &self.path)?;
        }
        Ok(bricks)
    }

    /// The chunked array at `path`; `None` if it is not one, or if `room` bytes are too few for its chunks.
    #[cfg(any(feature = "hdf5", feature = "zarr"))]
    fn chunks(path: &Path, wanted: Wanted, room: u64) -> Result<Option<Chunks>> {
        let Some((selection, open)) = Store::windows(path, wanted, 0)? else {
            return Ok(None);
        };
        Chunks::open(path, selection, open, room)
    }

    fn of_pages(pages: Pages, room: u64, counts_only: bool) -> Bricks {
        let loaded = pages.layout().number.loaded();
        let room = Room::new(room, pages.per_brick() * loaded.1 + BESIDE);
        let (shape, form) = (pages.shape(), Form::Pages(pages));
        Bricks::new(form, shape, loaded, room, counts_only)
    }

    #[cfg(any(feature = "hdf5", feature = "zarr"))]
    fn of_chunks(chunks: Chunks, room: u64, counts_only: bool) -> Bricks {
        let loaded = chunks.dtype();
        // The remainder while every thread decodes a chunk.
        let decoding = threads() * chunks.decoding();
        let room = Room::new(
            room.saturating_sub(decoding),
            chunks.per_brick() * loaded.1 + BESIDE,
        );
        let (shape, form) = (chunks.shape(), Form::Chunks(chunks));
        Bricks::new(form, shape, loaded, room, counts_only)
    }

    fn new(
        form: Form,
        shape: [usize; 4],
        (dtype, sample_bytes): (Dtype, u64),
        room: Room,
        counts_only: bool,
    ) -> Bricks {
        static NEXT: AtomicU64 = AtomicU64::new(0);
        let words = form.bricks().div_ceil(GROUP);
        Bricks {
            // Numbers only need to be distinct.
            number: NEXT.fetch_add(1, Ordering::Relaxed),
            shape,
            sample_bytes,
            seen: (0..words).map(|_| AtomicU64::new(0)).collect(),
            cache: Cache::new(room.kept, room.shards),
            spare: Mutex::default(),
            at_hand: room.at_hand,
            counts_only,
            zeros: Arc::new(CubeSamples::zeros(&dtype, form.per_brick() as usize)),
            dtype,
            form,
            dead: DeadBins::default(),
            negative: Negative::Keep,
            path: PathBuf::new(),
            read: AtomicU64::new(0),
            read_again: AtomicU64::new(0),
            failed: AtomicBool::new(false),
            failure: Mutex::new(None),
        }
    }

    /// Whether bricks are only counted.
    pub fn counts_only(&self) -> bool {
        self.counts_only
    }

    /// H, W, T, C.
    pub fn shape(&self) -> [usize; 4] {
        self.shape
    }

    /// The largest number of bricks that a thread holds.
    pub fn at_hand(&self) -> usize {
        self.at_hand
    }

    /// Bytes of its samples in memory.
    pub fn sample_bytes(&self) -> usize {
        self.sample_bytes as usize
    }

    /// The bytes read so far; if bricks are only counted, those that would have been read.
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

    /// Checks that everything requested could be read, and that no file has changed meanwhile.
    ///
    /// # Errors
    /// The first failure; later callers get the error that the work was abandoned.
    pub fn check(&self) -> Result<()> {
        if !self.has_failed() {
            return with_form!(&self.form, file => file.check_unchanged());
        }
        let first = locked(&self.failure).take();
        Err(first.unwrap_or(Error::Cancelled))
    }

    /// Fills `to` with the samples of a pixel from bin `bin` on, as many as it has room for, bin by bin.
    pub fn samples(&self, held: &mut Held, pixel: usize, bin: usize, to: &mut [f64]) {
        self.stored(held, pixel, bin, to);
        if !self.dead.is_empty() {
            let bins = bin..bin + to.len() / self.shape[3];
            let read = |bin: usize, to: &mut [f64]| self.stored(held, pixel, bin, to);
            self.dead.mend(bins, &self.dtype, to, read);
        }
    }

    /// The same as stored.
    #[inline]
    fn stored(&self, held: &mut Held, pixel: usize, bin: usize, to: &mut [f64]) {
        let mut at = 0;
        let bins = to.len() / self.shape[3];
        self.runs(pixel, bin, bins, |brick, from, count| {
            self.copy(held, brick, from, &mut to[at..at + count]);
            at += count;
        });
    }

    /// The same outside of lookups: bricks read for it are neither kept nor counted for lookups. They are kept in `near`, up to a limit.
    /// What cannot be read is 0 here: lookups that need it report the error.
    pub fn peek(&self, near: &mut Peeked, pixel: usize, bin: usize, to: &mut [f64]) {
        self.peek_stored(near, pixel, bin, to);
        let bins = bin..bin + to.len() / self.shape[3];
        let read = |bin: usize, to: &mut [f64]| self.peek_stored(near, pixel, bin, to);
        self.dead.mend(bins, &self.dtype, to, read);
    }

    fn peek_stored(&self, near: &mut Peeked, pixel: usize, bin: usize, to: &mut [f64]) {
        /// The most bytes of samples that are kept.
        const MOST: u64 = 4 << 20;
        let mut at = 0;
        let bins = to.len() / self.shape[3];
        self.runs(pixel, bin, bins, |brick, from, count| {
            // Clears everything at once: it is unknown which bricks will be needed again.
            if near.0.len() as u64 * self.form.per_brick() * self.sample_bytes > MOST {
                near.0.clear();
            }
            let samples = near.0.entry(brick).or_insert_with(|| {
                let read = self.read(brick, 1).unwrap_or_default();
                read.into_iter().next().unwrap_or_else(|| self.zeros(0))
            });
            samples.widen(from, &mut to[at..at + count]);
            at += count;
        });
    }

    /// Bytes that are read for the lines of bins of this many neighbouring pixels.
    pub fn bytes_of_lines(&self, pixels: usize) -> u64 {
        let mut bricks = Vec::new();
        let [h, w, bins, _] = self.shape;
        for pixel in 0..pixels.min(h * w) {
            self.runs(pixel, 0, bins, |brick, _, _| bricks.push(brick));
            bricks.dedup();
        }
        bricks.sort_unstable();
        bricks.dedup();
        bricks
            .iter()
            .map(|brick| with_form!(&self.form, of => of.bytes(*brick)))
            .sum()
    }

    /// One sample.
    pub fn sample(&self, pixel: usize, bin: usize, channel: usize) -> f64 {
        let mut values = [0.0; 3];
        let channels = self.shape[3].min(3);
        self.samples(&mut Held::default(), pixel, bin, &mut values[..channels]);
        values[channel.min(2)]
    }

    /// Adds the bricks of `bins` bins of a pixel that the thread does not hold.
    pub fn want(&self, held: &Held, pixel: usize, bin: usize, bins: usize, wanted: &mut Vec<u64>) {
        let reach = match self.dead.is_empty() {
            true => bin..bin + bins,
            false => self.dead.reach(bin..bin + bins),
        };
        self.runs(pixel, reach.start, reach.len(), |brick, _, _| {
            if held.get(self, brick).is_none() {
                wanted.push(brick);
            }
        });
    }

    /// Whether some bins are interpolated, so that samples differ from those in bricks.
    pub fn is_mended(&self) -> bool {
        !self.dead.is_empty()
    }

    /// A brick of zeros, with the type of the samples.
    pub(crate) fn sample_type(&self) -> &CubeSamples {
        &self.zeros
    }

    /// `count` zeros of the type of the samples.
    pub(super) fn zeros(&self, count: usize) -> CubeSamples {
        CubeSamples::zeros(&self.dtype, count)
    }

    /// The positions of samples, if bricks hold them in counting order.
    pub(super) fn in_order(&self) -> Option<InOrder> {
        match &self.form {
            Form::Pages(pages) => pages.in_order(),
            #[cfg(any(feature = "hdf5", feature = "zarr"))]
            Form::Chunks(_) => None,
        }
    }

    /// The samples of a brick that the thread holds.
    #[inline]
    pub(super) fn of<'a>(&self, held: &'a Held, brick: u64) -> Option<&'a CubeSamples> {
        held.get(self, brick)
    }

    /// Adds the bricks of `count` samples from the `origin`-th of the cube on, all of one pixel, counted by rows, columns, bins and
    /// channels.
    pub fn want_from(&self, held: &Held, origin: u64, count: usize, wanted: &mut Vec<u64>) {
        let (pixel, bin) = self.place(origin);
        self.want(held, pixel, bin, count / self.shape[3], wanted);
    }

    /// Fills `to` with samples from the `origin`-th of the cube on, which are all of one pixel.
    pub fn samples_from(&self, held: &mut Held, origin: u64, to: &mut [f64]) {
        let (pixel, bin) = self.place(origin);
        self.samples(held, pixel, bin, to);
    }

    /// The pixel and the bin of a sample.
    fn place(&self, origin: u64) -> (usize, usize) {
        let [_, _, bins, channels] = self.shape;
        let bin = origin as usize / channels;
        (bin / bins, bin % bins)
    }

    /// Calls `each` with the bricks that contain `count` samples from the `origin`-th on, the first position in each, and the number
    /// there; all are of one pixel.
    pub(super) fn runs_from(&self, origin: u64, count: usize, each: impl FnMut(u64, usize, usize)) {
        let (pixel, bin) = self.place(origin);
        self.runs(pixel, bin, count / self.shape[3], each);
    }

    #[inline(always)]
    fn runs(&self, pixel: usize, bin: usize, bins: usize, each: impl FnMut(u64, usize, usize)) {
        with_form!(&self.form, of => of.runs(pixel, bin, bins, each));
    }

    /// Fetches all `wanted` bricks, and empties the list.
    pub fn bring(&self, held: &mut Held, wanted: &mut Vec<u64>) {
        wanted.sort_unstable();
        wanted.dedup();
        for group in wanted.chunk_by(|a, b| self.form.group(*a) == self.form.group(*b)) {
            if self.counts_only {
                group.iter().for_each(|brick| self.note(*brick));
                continue;
            }
            let mut cache = self.cache.lock(self.form.group(group[0]));
            let mut missing: Vec<u64> = Vec::new();
            for brick in group {
                match cache.get(*brick) {
                    Some(samples) => held.put(self, *brick, samples),
                    None => missing.push(*brick),
                }
            }
            for run in missing.chunk_by(|a, b| a + 1 == *b) {
                for (brick, samples) in (run[0]..).zip(self.load(run[0], run.len() as u64)) {
                    held.put(self, brick, samples.clone());
                    self.keep_spare(cache.insert(brick, samples));
                }
            }
        }
        wanted.clear();
    }

    /// Samples of one brick, from its `from`-th on.
    #[inline]
    fn copy(&self, held: &mut Held, brick: u64, from: usize, to: &mut [f64]) {
        match held.get(self, brick) {
            Some(samples) => samples.widen(from, to),
            None => self.not_at_hand(brick).widen(from, to),
        }
    }

    /// The samples of a brick that the thread does not hold.
    #[cold]
    pub(super) fn not_at_hand(&self, brick: u64) -> Arc<CubeSamples> {
        if self.counts_only {
            self.note(brick);
            return self.zeros.clone();
        }
        let mut cache = self.cache.lock(self.form.group(brick));
        if let Some(samples) = cache.get(brick) {
            return samples;
        }
        let mut samples = self.zeros.clone();
        for loaded in self.load(brick, 1) {
            samples = loaded.clone();
            self.keep_spare(cache.insert(brick, loaded));
        }
        samples
    }

    /// Reads `count` bricks from the `first` on, none of which is cached; the lock of their shard is held, so that no other thread reads
    /// them.
    fn load(&self, first: u64, count: u64) -> Vec<Arc<CubeSamples>> {
        (first..first + count).for_each(|brick| self.note(brick));
        match self.read(first, count) {
            Ok(bricks) => bricks.into_iter().map(|brick| self.shared(brick)).collect(),
            Err(error) => {
                self.fail(error);
                vec![self.zeros.clone(); count as usize]
            }
        }
    }

    /// `samples` for sharing, in the memory of an evicted brick if there is one of their size.
    fn shared(&self, samples: CubeSamples) -> Arc<CubeSamples> {
        /// The number of spare bricks to try: threads may still hold some.
        const LOOKED_AT: usize = 8;
        let mut spare = locked(&self.spare);
        for _ in 0..spare.len().min(LOOKED_AT) {
            let Some(mut brick) = spare.pop_front() else {
                break;
            };
            match Arc::get_mut(&mut brick) {
                Some(memory) if memory.len() == samples.len() => {
                    memory.copy(0, &samples, 0..samples.len());
                    return brick;
                }
                // Of another size, like the last of a file.
                Some(_) => {}
                None => spare.push_back(brick),
            }
        }
        Arc::new(samples)
    }

    fn keep_spare(&self, brick: Option<Arc<CubeSamples>>) {
        locked(&self.spare).extend(brick);
    }

    /// Counts the bytes of a brick that is read.
    fn note(&self, brick: u64) {
        let bit = 1 << (brick % GROUP);
        // Bits are only for counting, so they need no memory ordering.
        let before = self.seen[(brick / GROUP) as usize].fetch_or(bit, Ordering::Relaxed);
        let again = before & bit != 0;
        if again && self.counts_only {
            return;
        }
        let bytes = with_form!(&self.form, of => of.bytes(brick));
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
    /// Releases all.
    pub fn clear(&mut self) {
        self.0.fill(None);
    }

    #[inline]
    fn slot(of: &Bricks, brick: u64) -> usize {
        // Adjacent bricks, and those with the same number in several cubes, go to distant positions.
        let mixed = (brick + (of.number << 40)).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32;
        // 32 bits as a fraction, times the count: without a division.
        ((mixed * of.at_hand as u64) >> 32) as usize
    }

    #[inline]
    fn get(&self, of: &Bricks, brick: u64) -> Option<&CubeSamples> {
        match self.0.get(Held::slot(of, brick)) {
            Some(Some((cube, number, samples))) if *cube == of.number && *number == brick => {
                Some(samples)
            }
            _ => None,
        }
    }

    fn put(&mut self, of: &Bricks, brick: u64, samples: Arc<CubeSamples>) {
        if self.0.is_empty() {
            self.0.resize(AT_HAND, None);
        }
        self.0[Held::slot(of, brick)] = Some((of.number, brick, samples));
    }
}
