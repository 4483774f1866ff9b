//! The farm: inputs generated from seeds, by changes that know the formats, in an order that depends on the seed number only.

use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::time::{Duration, Instant};

use crate::counting;
use crate::mutate::{Dictionary, Numbers, mutated};
use crate::schema::Maker;
use crate::targets::Target;
use crate::watch;

/// When it ends.
#[derive(Clone, Copy)]
pub enum Until {
    /// After so many inputs of each target, a tenth as many pictures.
    Inputs(u64),
    /// After so long, shared among the targets.
    Time(Duration),
}

/// What became of the inputs of a target.
pub struct Row {
    target: &'static str,
    seeds: usize,
    inputs: u64,
    seconds: f64,
    peak: usize,
}

/// What came of it all.
#[derive(Default)]
pub struct Report {
    rows: Vec<Row>,
    /// Inputs that are to be looked at, and why.
    pub findings: Vec<(PathBuf, String)>,
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "| target | seeds | inputs | inputs per second | most memory, MiB | findings |"
        )?;
        writeln!(f, "|---|---|---|---|---|---|")?;
        for row in &self.rows {
            let findings = self.findings.iter();
            let own = |(path, _): &&(PathBuf, String)| path.iter().any(|part| part == row.target);
            writeln!(
                f,
                "| {} | {} | {} | {:.0} | {:.1} | {} |",
                row.target,
                row.seeds,
                row.inputs,
                row.inputs as f64 / row.seconds,
                row.peak as f64 / f64::from(1 << 20),
                findings.filter(own).count()
            )?;
        }
        let all: u64 = self.rows.iter().map(|row| row.inputs).sum();
        writeln!(f, "| all | | {all} | | | {} |", self.findings.len())
    }
}

/// How many inputs that were accepted or refused in new ways are kept as seeds of a run.
const MOST_GROWN: usize = 2000;

/// Runs all targets, or those that `NULLRAY_FUZZ_TARGETS` names, in turn.
pub fn run(
    targets: &[Target],
    seeds: impl Fn(&Target) -> Vec<(PathBuf, Vec<u8>)>,
    until: Until,
    seed: u64,
) -> Report {
    let wanted = std::env::var("NULLRAY_FUZZ_TARGETS").unwrap_or_default();
    let is_wanted =
        |target: &&Target| wanted.is_empty() || wanted.split(',').any(|t| t == target.name);
    let chosen: Vec<&Target> = targets.iter().filter(is_wanted).collect();
    let mut report = Report::default();
    let quiet = matches!(until, Until::Time(_));
    if quiet {
        std::panic::set_hook(Box::new(|_| {}));
    }
    for target in &chosen {
        let mut pool: Vec<Vec<u8>> = seeds(target).into_iter().map(|(_, bytes)| bytes).collect();
        let dictionary = Dictionary::of(target.name, target.extension);
        let mut numbers = Numbers::new(
            seed ^ target.name.len() as u64 ^ (target.name.as_bytes()[0] as u64) << 32,
        );
        let mut maker = Maker::new(numbers.next());
        let (begin, mut inputs, mut peak) = (Instant::now(), 0, 0);
        let count = pool.len();
        loop {
            let done = match until {
                // A picture takes as long as thousands of files.
                Until::Inputs(most) if target.name == "picture" => 10 * inputs >= most,
                Until::Inputs(most) => inputs >= most,
                Until::Time(all) => begin.elapsed() >= all / chosen.len() as u32,
            };
            if done {
                break;
            }
            // Of pictures most are of whole scenes: changes of lines seldom leave one that can be rendered.
            let input = match target.name == "picture" && numbers.below(8) > 0 {
                true => maker.whole_scene().into_bytes(),
                false => mutated(&pool, target.extension, &dictionary, &mut numbers),
            };
            watch::begin(target.name, &input);
            let begin = Instant::now();
            let mut outcome = Ok(());
            let held = counting::peak_of(|| {
                outcome = catch_unwind(AssertUnwindSafe(|| (target.run)(&input)));
            });
            watch::end();
            inputs += 1;
            peak = peak.max(held);
            if let Err(panic) = outcome {
                let what = panic.downcast_ref::<String>().cloned();
                let what = what.or_else(|| Some(panic.downcast_ref::<&str>()?.to_string()));
                let path = watch::save(target.name, &input, "panic");
                report.findings.push((path, what.unwrap_or_default()));
            } else if held > watch::MOST_MEMORY {
                let path = watch::save(target.name, &input, "memory");
                report
                    .findings
                    .push((path, format!("{held} bytes of memory")));
            } else if begin.elapsed() > Duration::from_secs(5) {
                let path = watch::save(target.name, &input, "slow");
                report
                    .findings
                    .push((path, format!("{:?}", begin.elapsed())));
            }
            // Changes of changes, now and then.
            if numbers.below(40) == 0 && input.len() < 20_000 {
                match pool.len() < count + MOST_GROWN {
                    true => pool.push(input),
                    false => {
                        let at = count + numbers.below(MOST_GROWN);
                        pool[at] = input;
                    }
                }
            }
        }
        report.rows.push(Row {
            target: target.name,
            seeds: count,
            inputs,
            seconds: begin.elapsed().as_secs_f64(),
            peak,
        });
    }
    watch::finish();
    if quiet {
        let _ = std::panic::take_hook();
    }
    report
}
