//! Tables with 1024 steps per factor of 2, equal ones between two powers of 2: the exponent and the first digits of an f64 number
//! them, without a logarithm.

use std::sync::OnceLock;

use rayon::prelude::*;

/// Bits of the mantissa that number the steps of a factor of 2.
const STEP_BITS: u32 = 10;

/// What an f64 is shifted right by to leave sign, exponent and these bits.
const SHIFT: u32 = 52 - STEP_BITS;

/// The most factors of 2 that a table spans: 1 to 32 times what lies between γ = 1 and 500.
pub(super) const MOST_OCTAVES: u32 = 20;

/// N numbers at equal steps between powers of 2.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Table<const N: usize> {
    /// The shifted bits of the argument of the first entry.
    pub(super) first: u64,
    /// One less than there are entries.
    steps: u64,
    pub(super) entries: Vec<[f32; N]>,
}

/// Of steps from that of the shifted bits `first` on, the number of the one at or below `x`, and how far `x` is on the way to the next; below the
/// first, for NaN and below 0 a number of no step, larger than all.
#[inline(always)]
pub(super) fn place(first: u64, x: f64) -> (u64, f64) {
    let bits = x.to_bits();
    // The last digits as those of a number from 1 to 2, exactly.
    let rest = (bits << STEP_BITS) & ((1 << 52) - 1) | 1.0f64.to_bits();
    (
        (bits >> SHIFT).wrapping_sub(first),
        f64::from_bits(rest) - 1.0,
    )
}

/// `count` values of `f`, from that of the argument with shifted bits `first` on; the loop over threads is compiled once for each N.
fn entries<const N: usize>(
    first: u64,
    count: usize,
    f: &(dyn Fn(f64) -> [f64; N] + Sync),
) -> Vec<[f32; N]> {
    let entry = |at| f(f64::from_bits((first + at as u64) << SHIFT)).map(|x| x as f32);
    (0..count).into_par_iter().map(entry).collect()
}

impl<const N: usize> Table<N> {
    /// `f` from the step at or below `from` to that above `to`.
    pub(super) fn new([from, to]: [f64; 2], f: impl Fn(f64) -> [f64; N] + Sync) -> Self {
        let last = (to.to_bits() >> SHIFT) + 1;
        let most = u64::from(MOST_OCTAVES) << STEP_BITS;
        let first = (from.to_bits() >> SHIFT).max(last.saturating_sub(most));
        Table {
            first,
            steps: last - first,
            entries: entries(first, (last - first + 1) as usize, &f),
        }
    }

    /// A table of nothing.
    pub(super) fn empty() -> Self {
        Table {
            first: 0,
            steps: 0,
            entries: Vec::new(),
        }
    }

    /// The number of the entry at or below `x`, and how far `x` is on the way to the next; none beyond the ends, for
    /// NaN and below 0.
    #[inline(always)]
    fn place(&self, x: f64) -> Option<(usize, f64)> {
        let (index, rest) = place(self.first, x);
        (index < self.steps).then_some((index as usize, rest))
    }

    /// Linear between entries.
    #[inline(always)]
    pub(super) fn at(&self, x: f64) -> Option<[f64; N]> {
        let (index, rest) = self.place(x)?;
        let (below, above) = (&self.entries[index], &self.entries[index + 1]);
        // Loops, no closures: they are compiled for the vectors of the loop that calls.
        let mut between = [0.0; N];
        for k in 0..N {
            let (a, b) = (f64::from(below[k]), f64::from(above[k]));
            between[k] = a + (b - a) * rest;
        }
        Some(between)
    }
}

/// What is made in parallel when it is first asked for. It is not made within a lock: a thread that waits for the others' parts of it may take
/// up another task in the meantime, which asks for the same. So some threads may make it, all alike, and one is kept.
pub(super) struct MadeOnce<T> {
    kept: OnceLock<T>,
    make: fn() -> T,
}

impl<T> MadeOnce<T> {
    pub(super) const fn new(make: fn() -> T) -> Self {
        MadeOnce {
            kept: OnceLock::new(),
            make,
        }
    }

    #[inline]
    pub(super) fn get(&self) -> &T {
        match self.kept.get() {
            Some(kept) => kept,
            None => self.make(),
        }
    }

    #[cold]
    fn make(&self) -> &T {
        let made = (self.make)();
        self.kept.get_or_init(|| made)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::sync::mpsc;
    use std::time::Duration;

    use super::*;

    #[test]
    fn what_is_made_in_parallel_may_be_asked_for_meanwhile() {
        // The thread that makes it waits for the second part, which another has taken, and takes up a task that asks for the same.
        static BEGUN: AtomicBool = AtomicBool::new(false);
        static MADE: MadeOnce<u32> = MadeOnce::new(|| {
            let first = || {
                while !BEGUN.load(Ordering::SeqCst) {
                    std::thread::yield_now();
                }
            };
            let second = || {
                if !BEGUN.swap(true, Ordering::SeqCst) {
                    rayon::spawn(|| assert_eq!(*MADE.get(), 7));
                    std::thread::sleep(Duration::from_millis(200));
                }
            };
            rayon::join(first, second);
            7
        });
        let (send, receive) = mpsc::channel();
        std::thread::spawn(move || {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build();
            send.send(pool.unwrap().install(|| *MADE.get()))
        });
        assert_eq!(receive.recv_timeout(Duration::from_secs(30)), Ok(7));
    }
}
