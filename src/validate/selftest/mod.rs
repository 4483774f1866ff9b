#![doc = include_str!("README.md")]

mod aimed;
mod measures;
mod meshes;
mod pictures;
mod rays;
mod regimes;
mod rows;

use crate::Result;
use crate::render::progress::Progress;

pub use regimes::{REGIMES, Regime};
pub use rows::{EPS, Fine, Row, embedded};

/// The amount of testing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Effort {
    /// Seconds.
    Quick,
    /// Minutes, and some 3 GB of memory: 10⁸ rays, and a mesh of 10⁷ triangles.
    Thorough,
}

/// A regime in which errors are measured or counted, and its promised bound.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub struct Check {
    /// A name of one word.
    pub name: &'static str,
    /// What is stressed, and what is compared with what.
    pub what: &'static str,
    /// The unit of the error.
    pub unit: &'static str,
    /// The largest allowed error, derived in the module that measures it.
    pub bound: f64,
    kind: Kind,
}

/// The source of errors.
#[derive(Debug, Clone, Copy)]
enum Kind {
    /// Rows of numbers in arbitrary precision.
    Reference(&'static Regime),
    /// Errors counted by a function.
    Counted(Counted),
}

/// Counts errors.
#[derive(Debug, Clone, Copy)]
struct Counted {
    cases: [u64; 2],
    /// The memory that it takes, bytes.
    memory: [u64; 2],
    count: fn(u64, &dyn Progress) -> Result<Outcome>,
}

/// The result of a check.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Outcome {
    /// The largest error, or the number of errors, in the check's unit.
    pub worst: f64,
    /// The number of cases.
    pub cases: u64,
}

impl Check {
    /// The number of cases, for [`Progress::rays_done`].
    pub fn cases(&self, effort: Effort) -> u64 {
        match &self.kind {
            Kind::Reference(regime) => regime.rows().count() as u64,
            Kind::Counted(counted) => counted.cases[usize::from(effort == Effort::Thorough)],
        }
    }

    /// The maximum memory that it takes, in addition to the program, bytes.
    pub fn memory(&self, effort: Effort) -> u64 {
        match &self.kind {
            Kind::Reference(_) => SMALL,
            Kind::Counted(counted) => counted.memory[usize::from(effort == Effort::Thorough)],
        }
    }

    /// The same check with the memory that it takes for each effort, bytes.
    const fn taking(self, memory: [u64; 2]) -> Check {
        match self.kind {
            Kind::Counted(counted) => Check {
                kind: Kind::Counted(Counted { memory, ..counted }),
                ..self
            },
            Kind::Reference(_) => self,
        }
    }

    /// Runs the check on all threads of the current rayon pool. The outcome does not depend on them.
    ///
    /// # Errors
    /// [`Error::Cancelled`](crate::Error::Cancelled) when `progress` says so.
    pub fn run(&self, effort: Effort, progress: &dyn Progress) -> Result<Outcome> {
        match &self.kind {
            Kind::Reference(regime) => Ok(regime.worst(regime.rows())),
            Kind::Counted(counted) => (counted.count)(self.cases(effort), progress),
        }
    }

    /// Whether the outcome is within the bound; NaN is not.
    pub fn holds(&self, outcome: &Outcome) -> bool {
        outcome.worst <= self.bound && outcome.cases > 0
    }
}

/// All checks, in the order in which they run.
pub fn checks() -> Vec<Check> {
    let mut checks: Vec<Check> = REGIMES.iter().map(Check::from).collect();
    checks.extend(aimed::CHECKS);
    checks.extend(rays::CHECKS);
    checks.extend(pictures::CHECKS);
    checks
}

/// More memory than most checks need, bytes.
const SMALL: u64 = 32 << 20;

/// A check that counts errors, none of which is allowed; its cases for each effort.
const fn counted(
    name: &'static str,
    what: &'static str,
    unit: &'static str,
    cases: [u64; 2],
    count: fn(u64, &dyn Progress) -> Result<Outcome>,
) -> Check {
    Check {
        name,
        what,
        unit,
        bound: 0.0,
        kind: Kind::Counted(Counted {
            cases,
            memory: [SMALL; 2],
            count,
        }),
    }
}

/// Runs `batches` of `size` cases each, which count their own errors, in parallel.
fn count_in_batches(
    cases: u64,
    size: u64,
    progress: &dyn Progress,
    errors: impl Fn(u64) -> u64 + Sync,
) -> Result<Outcome> {
    use rayon::prelude::*;
    // Whole batches, so there may be a few cases more.
    let batches = cases.div_ceil(size);
    let worst = (0..batches).into_par_iter().map(|batch| {
        if progress.is_cancelled() {
            return Err(crate::Error::Cancelled);
        }
        let errors = errors(batch);
        progress.rays_done(size);
        Ok(errors)
    });
    let worst: u64 = worst.try_reduce(|| 0, |a, b| Ok(a + b))?;
    Ok(Outcome {
        worst: worst as f64,
        cases: batches * size,
    })
}
