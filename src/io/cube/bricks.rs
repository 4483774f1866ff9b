//! Cubes on disk that are read in bricks, as lookups need them: what is too large for memory.
//!
//! A brick is 4 KiB of the file, a page of most disks; samples keep the order that they have there. Neighbouring
//! samples in time (or, of frames, in a row) share one. Of arrays in chunks a brick is a chunk, decoded. A batch of lookups
//! first names all bricks that it needs; those that are missing are read in the order of the file, neighbours in one go,
//! by reads at a position, so that threads need not share one. Bricks stay as long as there is room; then one that was
//! not used for long makes way. One that comes back is counted as read again.
//!
//! What is read cannot depend on what was there before: samples are those of the whole cube, whatever the room, the
//! order and the number of threads. A file is not mapped, so that one which shrinks meanwhile is an error and no signal.
//! Lookups cannot fail: the first failure is kept, zeros stand in, and [`Bricks::check`] tells.

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

/// Pages that lie together and share a lock: as many as a word has bits.
const GROUP: u64 = 64;
/// Locks.
const SHARDS: usize = 64;
/// What there is to a brick beside its samples: its entries in tables, and what the allocator loses. Measured: 250 to 290.
const BESIDE: u64 = 400;
/// Bricks that a thread has at hand without a lock, at most.
const AT_HAND: usize = 1024;

/// The least room for bricks, bytes.
pub const LEAST_ROOM: u64 = 8 << 20;

/// A cube on disk.
#[derive(Debug)]
pub struct Bricks {
    /// Tells cubes apart.
    number: u64,
    form: Form,
    shape: [usize; 4],
    dtype: Dtype,
    /// Bytes of a sample in memory.
    sample_bytes: u64,
    /// By groups of bricks, a bit for each that has been read.
    seen: Box<[AtomicU64]>,
    cache: Cache<Arc<CubeSamples>>,
    /// Bricks that have made way, whose memory the next ones take: freed by one thread and asked for by another, it would not be used again,
    /// as allocators keep memory by thread.
    spare: Mutex<VecDeque<Arc<CubeSamples>>>,
    /// Bricks that a thread has at hand.
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

/// How samples lie in bricks.
#[derive(Debug)]
enum Form {
    /// As in the file.
    Pages(Pages),
    /// In chunks that are decoded.
    #[cfg(any(feature = "hdf5", feature = "zarr"))]
    Chunks(Chunks),
}

/// Does the same with either form.
macro_rules! with_form {
    ($form:expr, $of:ident => $do:expr) => {
        match $form {
            Form::Pages($of) => $do,
            #[cfg(any(feature = "hdf5", feature = "zarr"))]
            Form::Chunks($of) => $do,
        }
    };
}

/// Bytes that have been read of cubes on disk; of chunks, those of their samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct BytesRead {
    /// All.
    pub all: u64,
    /// The part of it that had been read before, and made way meanwhile.
    pub again: u64,
}

/// Bricks that a thread has at hand.
#[derive(Debug, Default)]
pub struct Held(Vec<Option<(u64, u64, Arc<CubeSamples>)>>);

/// Bricks that were looked at apart from those of lookups.
#[derive(Debug, Default)]
pub struct Peeked(HashMap<u64, CubeSamples>);

/// What becomes of the memory for bricks.
struct Room {
    /// Bricks that the cache keeps, and its locks.
    kept: usize,
    shards: usize,
    /// Bricks that a thread has at hand: those may have left the cache.
    at_hand: usize,
}

impl Room {
    /// So many bytes for bricks that take `each`. Every thread may have bricks at hand for lookups of three kinds.
    fn new(bytes: u64, each: u64) -> Room {
        let bricks = bytes / each;
        // A sixteenth of the room for each kind of lookup, shared among threads; the cache has the rest.
        let at_hand = (bricks / 16 / threads()).clamp(1, AT_HAND as u64);
        let shards = (bricks / 16).clamp(1, SHARDS as u64);
        // Beside the cache: bricks at hand, which may have left it, for lookups of three kinds, and one more for each lock.
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
    /// The cube at `path` that is `wanted` of it, by the checks of loading it; its bricks may take `room` bytes of
    /// memory, at least [`LEAST_ROOM`]. Members of archives, pictures of sequences, and arrays in chunks some of which
    /// would not fit into the room are written to a temporary file first.
    ///
    /// # Errors
    /// As for [`load`](super::load), but for samples that are not finite.
    pub fn open(path: &Path, wanted: Wanted, room: u64) -> Result<Bricks> {
        #[cfg(any(feature = "hdf5", feature = "zarr"))]
        if let Some(chunks) = Bricks::chunks(path, wanted, room)? {
            return Bricks::of_chunks(chunks, room, false).mended(path, wanted);
        }
        let (located, layout) = Store::locate(path, wanted)?;
        let pages = Pages::new(path, located, layout)?;
        Bricks::of_pages(pages, room, false).mended(path, wanted)
    }

    /// The same to count bricks that would be read; nothing is, and all samples are 0. None for what is written to a
    /// temporary file first.
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
        // Counting needs no room but for chunks, which only these features have.
        let _ = room;
        let Some((located, layout)) = Store::locate_in_place(path, wanted)? else {
            return Ok(None);
        };
        let pages = Pages::new(path, located, layout)?;
        Bricks::of_pages(pages, 0, true)
            .mended(path, wanted)
            .map(Some)
    }

    /// The same with these of its channels alone, in this order.
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

    /// The same without its dead bins, and with what is wanted of samples below 0.
    fn mended(self, path: &Path, wanted: Wanted) -> Result<Bricks> {
        if self.shape.contains(&0) {
            let what = format!("a cube of shape {:?} has no samples", self.shape);
            let help = "every axis must have a size of at least 1";
            return Err(Error::invalid(path, "", what, help));
        }
        let dead = DeadBins::new(path, wanted.dead_bins, self.shape[2])?;
        Ok(Bricks {
            dead,
            negative: wanted.negative.unwrap_or(Negative::Keep),
            path: path.to_path_buf(),
            ..self
        })
    }

    /// `count` bricks from the `first` on, with samples below 0 as they are wanted.
    fn read(&self, first: u64, count: u64) -> Result<Vec<CubeSamples>> {
        let mut bricks = self.form.load(first, count)?;
        for samples in &mut bricks {
            self.negative.apply_to_samples(samples, &self.path)?;
        }
        Ok(bricks)
    }

    /// The array in chunks at `path`; none where it is no such array, or where `room` bytes are too few for its chunks.
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
        // What is left while every thread decodes a chunk.
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
            // Numbers only have to differ.
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

    /// How many bricks a thread has at hand, at most.
    pub fn at_hand(&self) -> usize {
        self.at_hand
    }

    /// Bytes of its samples as they are held.
    pub fn sample_bytes(&self) -> usize {
        self.sample_bytes as usize
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

    /// Whether all that was asked for could be read, and of files that nobody changed meanwhile.
    ///
    /// # Errors
    /// The first failure; whoever asks again is told that the work was given up.
    pub fn check(&self) -> Result<()> {
        if !self.has_failed() {
            return with_form!(&self.form, file => file.check_unchanged());
        }
        let first = locked(&self.failure).take();
        Err(first.unwrap_or(Error::Cancelled))
    }

    /// Fills `to` with the samples of bins `bin` and on of a pixel, as many as it has room for, bin by bin.
    pub fn samples(&self, held: &mut Held, pixel: usize, bin: usize, to: &mut [f64]) {
        self.stored(held, pixel, bin, to);
        if !self.dead.is_empty() {
            let bins = bin..bin + to.len() / self.shape[3];
            let read = |bin: usize, to: &mut [f64]| self.stored(held, pixel, bin, to);
            self.dead.mend(bins, &self.dtype, to, read);
        }
    }

    /// The same as they are stored.
    #[inline]
    fn stored(&self, held: &mut Held, pixel: usize, bin: usize, to: &mut [f64]) {
        let mut at = 0;
        let bins = to.len() / self.shape[3];
        self.runs(pixel, bin, bins, |brick, from, count| {
            self.copy(held, brick, from, &mut to[at..at + count]);
            at += count;
        });
    }

    /// The same, apart from lookups: what is read for it is neither kept for them nor counted as theirs. It is kept in `near`, as
    /// far as that is little. What cannot be read is 0 here: lookups that meet it tell.
    pub fn peek(&self, near: &mut Peeked, pixel: usize, bin: usize, to: &mut [f64]) {
        self.peek_stored(near, pixel, bin, to);
        let bins = bin..bin + to.len() / self.shape[3];
        let read = |bin: usize, to: &mut [f64]| self.peek_stored(near, pixel, bin, to);
        self.dead.mend(bins, &self.dtype, to, read);
    }

    fn peek_stored(&self, near: &mut Peeked, pixel: usize, bin: usize, to: &mut [f64]) {
        /// The most numbers that are kept.
        const MOST: u64 = 1 << 21;
        let mut at = 0;
        let bins = to.len() / self.shape[3];
        self.runs(pixel, bin, bins, |brick, from, count| {
            // All at once: nothing tells which of them will be needed again.
            if near.0.len() as u64 * self.form.per_brick() > MOST {
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

    /// Bytes that are read for a pixel's line of bins.
    pub fn bytes_of_line(&self) -> u64 {
        let mut bricks = Vec::new();
        self.runs(0, 0, self.shape[2], |brick, _, _| bricks.push(brick));
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

    /// Notes the bricks of `bins` bins of a pixel that are not at hand.
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

    /// Whether samples are not as bricks hold them, as some bins are mended.
    pub fn is_mended(&self) -> bool {
        !self.dead.is_empty()
    }

    /// A brick of zeros: what type samples have.
    pub(crate) fn sample_type(&self) -> &CubeSamples {
        &self.zeros
    }

    /// So many zeros, as samples are held.
    pub(super) fn zeros(&self, count: usize) -> CubeSamples {
        CubeSamples::zeros(&self.dtype, count)
    }

    /// Where samples lie, if they are in bricks in the order in which they are counted.
    pub(super) fn in_order(&self) -> Option<InOrder> {
        match &self.form {
            Form::Pages(pages) => pages.in_order(),
            #[cfg(any(feature = "hdf5", feature = "zarr"))]
            Form::Chunks(_) => None,
        }
    }

    /// The samples of a brick that is at hand.
    #[inline]
    pub(super) fn of<'a>(&self, held: &'a Held, brick: u64) -> Option<&'a CubeSamples> {
        held.get(self, brick)
    }

    /// Notes the bricks of `count` samples from the `origin`-th of the cube on, all of one pixel, as they are counted by rows, columns,
    /// bins and channels.
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

    /// Gives to `each` in which bricks `count` samples from the `origin`-th on lie, from where on, and how many; all are of one pixel.
    pub(super) fn runs_from(&self, origin: u64, count: usize, each: impl FnMut(u64, usize, usize)) {
        let (pixel, bin) = self.place(origin);
        self.runs(pixel, bin, count / self.shape[3], each);
    }

    #[inline(always)]
    fn runs(&self, pixel: usize, bin: usize, bins: usize, each: impl FnMut(u64, usize, usize)) {
        with_form!(&self.form, of => of.runs(pixel, bin, bins, each));
    }

    /// Gets all `wanted` bricks at hand, and empties the list.
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

    /// The samples of a brick that is not at hand.
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

    /// Reads `count` bricks from the `first` on, none of which is there; the lock of their shard is held, so that nobody
    /// else reads them.
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

    /// `samples` to be shared, in the memory of a brick that has made way if there is one of their size.
    fn shared(&self, samples: CubeSamples) -> Arc<CubeSamples> {
        /// Spare bricks to look at: some threads may still have at hand.
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
                // Of another size, as the last of a file is.
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
        // Bits are for counting alone, so that nothing has to be ordered by them.
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
    /// Lets go of all.
    pub fn clear(&mut self) {
        self.0.fill(None);
    }

    #[inline]
    fn slot(of: &Bricks, brick: u64) -> usize {
        // Bricks side by side, and those of one number in several cubes, go to places far apart.
        let mixed = (brick + (of.number << 40)).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32;
        // 32 bits of a number below 1, times how many there are: without a division.
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
