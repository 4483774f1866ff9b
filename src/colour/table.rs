//! Tables with 1024 steps per factor of 2, of equal width between two powers of 2: they are indexed by the exponent and leading mantissa
//! bits of an f64, without a logarithm.

use std::sync::OnceLock;

use rayon::prelude::*;

/// Bits of the mantissa that index the steps of a factor of 2.
const STEP_BITS: u32 = 10;

/// The right shift of an f64 that leaves sign, exponent and these bits.
const SHIFT: u32 = 52 - STEP_BITS;

/// The most factors of 2 that a table spans: 1 to 32 times the range between γ = 1 and 500.
pub(super) const MOST_OCTAVES: u32 = 20;

/// N numbers at equal steps between powers of 2.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Table<const N: usize> {
    /// The shifted bits of the argument of the first entry.
    pub(super) first: u64,
    /// Number of entries minus one.
    steps: u64,
    pub(super) entries: Vec<[f32; N]>,
}

/// The index of the step at or below `x`, counted from that of the shifted bits `first`, and the fraction of the step to the next; below
/// the first, for NaN and below 0 an index larger than that of any step.
#[inline(always)]
pub(super) fn place(first: u64, x: f64) -> (u64, f64) {
    let bits = x.to_bits();
    // The trailing bits as a number from 1 to 2, exactly.
    let rest = (bits << STEP_BITS) & ((1 << 52) - 1) | 1.0f64.to_bits();
    (
        (bits >> SHIFT).wrapping_sub(first),
        f64::from_bits(rest) - 1.0,
    )
}

/// `count` values of `f`, from the argument with shifted bits `first` on; the loop over threads is compiled once for each N.
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

    /// An empty table.
    pub(super) fn empty() -> Self {
        Table {
            first: 0,
            steps: 0,
            entries: Vec::new(),
        }
    }

    /// The index of the entry at or below `x`, and the fraction of the step to the next; `None` beyond the ends, for NaN and below 0.
    #[inline(always)]
    fn place(&self, x: f64) -> Option<(usize, f64)> {
        let (index, rest) = place(self.first, x);
        (index < self.steps).then_some((index as usize, rest))
    }

    /// Linear interpolation between entries.
    #[inline(always)]
    pub(super) fn at(&self, x: f64) -> Option<[f64; N]> {
        let (index, rest) = self.place(x)?;
        let (below, above) = (&self.entries[index], &self.entries[index + 1]);
        // Loops instead of closures: they are vectorized as part of the calling loop.
        let mut between = [0.0; N];
        for k in 0..N {
            let (a, b) = (f64::from(below[k]), f64::from(above[k]));
            between[k] = a + (b - a) * rest;
        }
        Some(between)
    }
}

/// A value computed in parallel on first use. It is not computed inside a lock: a thread that waits for other threads' parts of it may
/// start another task in the meantime, which needs the same value. So several threads may compute it, with equal results, and one is kept.
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
        // The computing thread waits for the second part, which another thread has taken, and starts a task that needs the same value.
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
