//! The positions of many lookups' samples in the bricks of a cube on disk.
//!
//! A lookup reads short runs of samples, each of one pixel. Almost every run is in one brick, usually that of the previous run: such runs
//! share a piece, and are read in place. The others are copied into separate pieces.

use std::mem::discriminant;
use std::sync::Arc;

use half::f16;

use super::bricks::{Bricks, Held};
use super::pages::InOrder;
use super::samples::CubeSamples;

/// Runs of samples in bricks.
#[derive(Debug)]
pub(crate) struct Pieces {
    pieces: Vec<Piece>,
    /// Samples in a run.
    count: usize,
    /// The positions of samples, if in order.
    places: Option<InOrder>,
    /// By row of taps, the brick of the last run and its piece.
    last: [Option<(u64, u16)>; 2],
    /// Bricks that the thread does not hold, in the order of their pieces.
    far: Vec<Arc<CubeSamples>>,
    /// Samples of the runs that are copied.
    copied: CubeSamples,
}

#[derive(Debug, Clone, Copy)]
enum Piece {
    /// All of a brick.
    Brick(u64),
    /// A run that spans several bricks, or is not contiguous in one: the number of its first sample.
    Copied(u64),
}

/// A number as bricks hold it.
pub(crate) trait Stored: Copy {
    /// The samples, if they are of this type; empty otherwise.
    fn of(samples: &CubeSamples) -> &[Self];
}

macro_rules! stored {
    ($number:ty, $variant:ident) => {
        impl Stored for $number {
            #[inline(always)]
            fn of(samples: &CubeSamples) -> &[$number] {
                match samples {
                    CubeSamples::$variant(samples) => samples,
                    _ => &[],
                }
            }
        }
    };
}

stored!(f16, F16);
stored!(f32, F32);
stored!(f64, F64);

impl Default for Pieces {
    fn default() -> Self {
        Pieces {
            pieces: Vec::new(),
            count: 0,
            places: None,
            last: [None; 2],
            far: Vec::new(),
            copied: CubeSamples::F64(Vec::new()),
        }
    }
}

impl Pieces {
    /// Clears everything; the next runs are of `count` samples of `bricks`, none of whose bins is interpolated.
    pub fn start(&mut self, bricks: &Bricks, count: usize) {
        self.pieces.clear();
        self.far.clear();
        self.count = count;
        self.places = bricks.in_order();
        self.last = [None; 2];
    }

    /// The piece of the run from the `origin`-th sample of the cube on, at most 2¹⁶ of them, and the first position in it. Records which
    /// bricks the thread does not hold. Runs of the same `row` (of two) are looked up together.
    #[inline(always)]
    pub fn find(
        &mut self,
        bricks: &Bricks,
        held: &Held,
        row: usize,
        origin: u64,
        wanted: &mut Vec<u64>,
    ) -> (u16, u64) {
        let whole = self.places.and_then(|all| all.whole(origin, self.count));
        let Some((brick, from)) = whole else {
            return (self.copy(bricks, held, origin, wanted), 0);
        };
        let piece = match self.last[row] {
            Some((last, piece)) if last == brick => piece,
            _ => self.look_for(bricks, held, (row, brick), wanted),
        };
        (piece, from as u64)
    }

    #[inline(never)]
    // Once per brick, not per run: not inlined, so that the loop around `find` stays short.
    fn look_for(
        &mut self,
        bricks: &Bricks,
        held: &Held,
        (row, brick): (usize, u64),
        wanted: &mut Vec<u64>,
    ) -> u16 {
        if bricks.of(held, brick).is_none() {
            wanted.push(brick);
        }
        let piece = self.add(Piece::Brick(brick));
        self.last[row] = Some((brick, piece));
        piece
    }

    #[inline(never)]
    fn copy(&mut self, bricks: &Bricks, held: &Held, origin: u64, wanted: &mut Vec<u64>) -> u16 {
        bricks.runs_from(origin, self.count, |brick, _, _| {
            if bricks.of(held, brick).is_none() {
                wanted.push(brick);
            }
        });
        self.add(Piece::Copied(origin))
    }

    fn add(&mut self, piece: Piece) -> u16 {
        self.pieces.push(piece);
        (self.pieces.len() - 1) as u16
    }

    /// Fetches missing bricks (bricks of one batch can evict each other), and copies the runs that are not contiguous.
    pub fn fetch(&mut self, bricks: &Bricks, held: &Held) {
        let copies = self.pieces.iter().filter(|p| matches!(p, Piece::Copied(_)));
        let room = copies.count() * self.count;
        // The buffer keeps its room from batch to batch while cubes hold numbers of the same type.
        let same =
            |samples: &CubeSamples| discriminant(samples) == discriminant(bricks.sample_type());
        if !same(&self.copied) {
            self.copied = bricks.zeros(0);
        }
        self.copied.resize(room);
        let mut at = 0;
        for piece in &self.pieces {
            match *piece {
                Piece::Brick(brick) => {
                    if bricks.of(held, brick).is_none() {
                        self.far.push(bricks.not_at_hand(brick));
                    }
                }
                Piece::Copied(origin) => {
                    bricks.runs_from(origin, self.count, |brick, from, count| {
                        // Holds a brick until its run is copied, because the cache may drop it meanwhile.
                        let far;
                        let samples = match bricks.of(held, brick) {
                            Some(samples) => samples,
                            None => {
                                far = bricks.not_at_hand(brick);
                                &*far
                            }
                        };
                        self.copied.copy(at, samples, from..from + count);
                        at += count;
                    });
                }
            }
        }
    }

    /// The samples of each piece, which were fetched.
    pub fn samples<'a, T: Stored>(&'a self, bricks: &Bricks, held: &'a Held) -> Vec<&'a [T]> {
        let copied = T::of(&self.copied).chunks_exact(self.count.max(1));
        let (mut far, mut copied) = (self.far.iter(), copied);
        let samples = self.pieces.iter().map(|piece| match *piece {
            Piece::Brick(brick) => {
                let samples = bricks.of(held, brick);
                let samples = samples.or_else(|| far.next().map(|far| &**far));
                samples.map(T::of).unwrap_or_default()
            }
            Piece::Copied(_) => copied.next().unwrap_or_default(),
        });
        samples.collect()
    }
}
