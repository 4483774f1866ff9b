//! The bricks that a batch of lookups reads from a cube on disk.

use super::gather::{AnySource, Source};
use super::places::BATCH;
use crate::io::cube::{Bricks, CubeSamples, CubeStore, Held, Pieces};

/// The data that lookups need from a cube on disk; empty for one in memory.
#[derive(Debug)]
pub(super) struct FromDisk {
    held: Held,
    wanted: Vec<u64>,
    pieces: Pieces,
    /// Which piece each tap reads, by tap and lookup.
    which: [[u16; BATCH]; 4],
    /// Gathered samples of all taps, used if some bins have to be repaired.
    mended: CubeSamples,
}

impl Default for FromDisk {
    fn default() -> Self {
        FromDisk {
            held: Held::default(),
            wanted: Vec::new(),
            pieces: Pieces::default(),
            which: [[0; BATCH]; 4],
            mended: CubeSamples::F64(Vec::new()),
        }
    }
}

impl FromDisk {
    /// The samples of those of the first `count` lookups of N bins that are plain. For a cube on disk, their bricks are read, each once,
    /// and the origins of their taps then refer to the data read.
    #[inline(always)]
    pub fn source<'a, const N: usize>(
        &'a mut self,
        store: &'a CubeStore,
        (origins, plain): (&mut [[u64; BATCH]; 4], &[bool; BATCH]),
        count: usize,
    ) -> AnySource<'a> {
        match store {
            CubeStore::Memory(cube) => AnySource::whole(&cube.samples),
            CubeStore::Disk(bricks) => self.find(bricks, (origins, plain), count, N),
        }
    }

    #[inline(never)]
    fn find<'a>(
        &'a mut self,
        bricks: &'a Bricks,
        (origins, plain): (&mut [[u64; BATCH]; 4], &[bool; BATCH]),
        count: usize,
        bins: usize,
    ) -> AnySource<'a> {
        let each = bins * bricks.shape()[3];
        if bricks.is_mended() {
            return self.mend(bricks, (origins, plain), count, each);
        }
        // All bricks of the batch are collected first, so that each is read once.
        let FromDisk {
            held,
            wanted,
            pieces,
            which,
            ..
        } = self;
        pieces.start(bricks, each);
        for at in (0..count).filter(|at| plain[*at]) {
            for tap in 0..4 {
                let origin = &mut origins[tap][at];
                (which[tap][at], *origin) = pieces.find(bricks, held, tap / 2, *origin, wanted);
            }
        }
        if !wanted.is_empty() {
            bricks.bring(held, wanted);
        }
        pieces.fetch(bricks, held);
        match bricks.sample_type() {
            CubeSamples::F16(_) => {
                AnySource::F16(Source::Pieces(pieces.samples(bricks, held), which))
            }
            CubeSamples::F32(_) => {
                AnySource::F32(Source::Pieces(pieces.samples(bricks, held), which))
            }
            CubeSamples::F64(_) => {
                AnySource::F64(Source::Pieces(pieces.samples(bricks, held), which))
            }
        }
    }

    /// The samples if some bins have to be repaired.
    #[cold]
    fn mend(
        &mut self,
        bricks: &Bricks,
        (origins, plain): (&mut [[u64; BATCH]; 4], &[bool; BATCH]),
        count: usize,
        each: usize,
    ) -> AnySource<'_> {
        let (held, wanted) = (&mut self.held, &mut self.wanted);
        let plain = || (0..count).filter(|at| plain[*at]);
        for at in plain() {
            for tap in &*origins {
                bricks.want_from(held, tap[at], each, wanted);
            }
        }
        bricks.bring(held, wanted);
        let mut values = vec![0.0; count * 4 * each];
        for at in plain() {
            for (tap, origins) in origins.iter_mut().enumerate() {
                let first = (at * 4 + tap) * each;
                bricks.samples_from(held, origins[at], &mut values[first..][..each]);
                origins[at] = first as u64;
            }
        }
        self.mended = CubeSamples::F64(values);
        AnySource::whole(&self.mended)
    }
}
