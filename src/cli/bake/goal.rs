//! Choosing the number of samples of a bake: for an error, or for a time.

use std::fmt;
use std::path::Path;
use std::time::Instant;

use nullray::Result;
use nullray::render::bake::{Baked, Trials};

use crate::cli::args::GoalArguments;
use crate::cli::progress::Bar;
use crate::cli::remarks::short;

/// The numbers of samples that can be chosen: powers of two, whose points are spread best.
pub const POSSIBLE: [u32; 16] = {
    let mut powers = [2; 16];
    let mut k = 1;
    while k < powers.len() {
        powers[k] = 2 * powers[k - 1];
        k += 1;
    }
    powers
};
/// The samples of the first trial: with fewer, rare light is overlooked.
const FIRST: u32 = 32;
/// A trial's error must be less than the one asked for by this factor, because it is itself right to a few per cent only.
const MARGIN: f64 = 0.9;
/// As many samples are tried before texels without any light count as dark.
const DARK: u32 = 1024;

/// What the number of samples is chosen for.
#[derive(Debug, Clone, Copy)]
pub struct Goal {
    /// The standard error of a bin, relative to the root mean square of all.
    error: Option<f64>,
    /// Seconds for all that is baked.
    budget: Option<f64>,
}

/// A number of samples, and why it was chosen.
pub struct Chosen {
    pub samples: u32,
    tried: Option<Tried>,
}

/// The last trial.
struct Tried {
    samples: u32,
    error: f64,
    /// Seconds that the bake is expected to take with the number that was chosen.
    seconds: f64,
}

impl Goal {
    /// `None` if the number of samples is not to be chosen.
    pub fn of(arguments: GoalArguments) -> Option<Goal> {
        let GoalArguments { error, budget } = arguments;
        (error.is_some() || budget.is_some()).then_some(Goal { error, budget })
    }

    /// The number of samples for what `trials` are of: the work `began` then, and this is a `share` of what is left.
    pub fn samples(
        self,
        trials: &Trials,
        (began, share): (Instant, f64),
        quiet: bool,
    ) -> Result<Chosen> {
        let start = Instant::now();
        let left = self
            .budget
            .map(|budget| (budget - began.elapsed().as_secs_f64()) * share);
        let is_late =
            |seconds: f64| left.is_some_and(|left| start.elapsed().as_secs_f64() + seconds > left);
        let mut samples = FIRST;
        loop {
            let rays = trials.texels().saturating_mul(samples.into());
            let bar = Bar::new(rays, quiet).named(format!("trial of {samples} samples"));
            let trial_start = Instant::now();
            let trial = trials.run(samples, &bar)?;
            let took = trial_start.elapsed().as_secs_f64();
            let mut whole = took / trial.share;
            let error = trial.relative_error;
            let is_good = match self.error {
                Some(_) if error.is_nan() => samples >= DARK,
                Some(wanted) => error <= MARGIN * wanted,
                None => false,
            };
            // The next trial, and the bake after it, take twice as long.
            let is_last = POSSIBLE.last() == Some(&samples);
            if !is_good && !is_last && !is_late(2.0 * (took + whole)) {
                samples *= 2;
                continue;
            }
            let tried = samples;
            // Fewer, if the time does not suffice even for these.
            while is_late(whole) && samples > POSSIBLE[0] {
                samples /= 2;
                whole /= 2.0;
            }
            return Ok(Chosen {
                samples,
                tried: Some(Tried {
                    samples: tried,
                    error,
                    seconds: whole,
                }),
            });
        }
    }

    /// The warning that the bake did not reach the error asked for.
    pub fn missed_by(self, path: &Path, baked: &Baked, chosen: &Chosen) -> Option<String> {
        let (wanted, error) = (100.0 * self.error?, 100.0 * baked.relative_error());
        (error > wanted).then(|| {
            let (next, wanted) = (2 * chosen.samples, short(wanted));
            let path = path.display();
            format!(
                "{path}: its error is {error:.2} %, more than the {wanted} % asked for: --spp {next} takes twice as long"
            )
        })
    }
}

impl fmt::Display for Goal {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, " for error {:?} in {:?} s", self.error, self.budget)
    }
}

impl Chosen {
    /// A number of samples that was given.
    pub fn of(samples: u32) -> Chosen {
        Chosen {
            samples,
            tried: None,
        }
    }

    /// What was chosen for the file of this name, whose samples are those of a `unit`, texel or pixel.
    pub fn text(&self, path: &Path, unit: &str) -> String {
        let mut text = format!("{}: {} samples per {unit}", path.display(), self.samples);
        if let Some(Tried {
            samples,
            error,
            seconds,
        }) = self.tried
        {
            text += &match error.is_nan() {
                true => format!(": a trial of {samples} found no light"),
                false => format!(
                    ": a trial of {samples} had an error of {:.2} %",
                    100.0 * error
                ),
            };
            text += &format!("; takes about {} s", number_of(seconds));
        }
        text + "\n"
    }
}

/// Seconds with one decimal place, or none from ten on.
fn number_of(seconds: f64) -> String {
    match seconds < 10.0 {
        true => format!("{:.1}", seconds.max(0.1)),
        false => format!("{seconds:.0}"),
    }
}
