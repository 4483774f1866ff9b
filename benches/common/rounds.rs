//! Works that are measured in turn, and what their times say: the best of each, and ratios of rounds with their spread.
//!
//! What else the machine does slows all works of a round alike, so that ratios within rounds say more than ratios of the best
//! times; half of all rounds lie between the quartiles.

use std::fmt::{Display, Formatter, Result};
use std::time::Instant;

/// Seconds of some works, by work and round.
pub struct Rounds(Vec<Vec<f64>>);

impl Rounds {
    /// Measures `works` in turn, each `rounds` times.
    pub fn of<F: FnMut()>(rounds: usize, works: &mut [F]) -> Rounds {
        let mut all = vec![Vec::with_capacity(rounds); works.len()];
        for _ in 0..rounds {
            for (seconds, work) in all.iter_mut().zip(&mut *works) {
                seconds.push(seconds_of(work));
            }
        }
        Rounds(all)
    }

    /// The best time of a work, seconds.
    pub fn best(&self, work: usize) -> f64 {
        best(&self.0[work])
    }

    /// The times of a work over those of another.
    pub fn ratio(&self, work: usize, other: usize) -> Ratio {
        Ratio::of(&self.0[work], &self.0[other])
    }

    /// The times of a work over its best.
    pub fn spread(&self, work: usize) -> Ratio {
        let best = vec![self.best(work); self.0[work].len()];
        Ratio::of(&self.0[work], &best)
    }
}

/// Seconds that `work` takes.
pub fn seconds_of<T>(work: impl FnOnce() -> T) -> f64 {
    let begin = Instant::now();
    std::hint::black_box(work());
    begin.elapsed().as_secs_f64()
}

/// The least of some times.
pub fn best(seconds: &[f64]) -> f64 {
    seconds.iter().copied().fold(f64::INFINITY, f64::min)
}

/// Ratios of rounds: their median and quartiles.
#[derive(Clone, Copy)]
pub struct Ratio {
    pub low: f64,
    pub middle: f64,
    pub high: f64,
}

impl Ratio {
    /// Of times to times of the same rounds.
    pub fn of(times: &[f64], to: &[f64]) -> Ratio {
        let mut ratios: Vec<f64> = times.iter().zip(to).map(|(a, b)| a / b).collect();
        ratios.sort_by(f64::total_cmp);
        let (count, quarter) = (ratios.len(), ratios.len() / 4);
        Ratio {
            low: ratios[quarter],
            middle: ratios[count / 2],
            high: ratios[count - 1 - quarter],
        }
    }

    /// The lower and the upper quartile, as reports have them.
    pub fn quartiles(self) -> [f64; 2] {
        [self.low, self.high]
    }
}

impl Display for Ratio {
    fn fmt(&self, f: &mut Formatter) -> Result {
        let Ratio { low, middle, high } = self;
        write!(f, "{middle:.2} ({low:.2} to {high:.2})")
    }
}
