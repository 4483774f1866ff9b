//! `nullray selftest`.

use std::time::Instant;

use nullray::Result;
use nullray::accel::Kernel;
use nullray::render::plan;
use nullray::validate::selftest::{self, Check, Effort, Outcome};
use serde_json::{Value, json};

use super::args::SelftestArguments;
use super::console::print;
use super::failure::Done;
use super::progress::Bar;
use super::{failure, film};

/// Runs every check, reports its result, and returns whether all pass.
pub fn run(arguments: &SelftestArguments) -> Result<Done> {
    let checks = chosen(&arguments.check)?;
    let effort = match arguments.thorough {
        true => Effort::Thorough,
        false => Effort::Quick,
    };
    let limit = arguments.memory.bytes();
    if let Some(check) = checks.iter().find(|check| check.memory(effort) > limit) {
        let what = format!(
            "the check \"{}\" takes about {}, more than the limit of {}",
            check.name,
            plan::bytes(check.memory(effort)),
            plan::bytes(limit)
        );
        let help = "a higher limit, or other checks: --check NAME";
        return Err(failure::refused("--max-memory", what, help));
    }
    film::in_pool(arguments.threads.count, || {
        if !arguments.json.on {
            print(&heading())?;
        }
        let mut lines = Vec::new();
        for check in checks {
            // Each line is printed as soon as it is known: thorough checks take minutes.
            let line = Line::of(check, effort)?;
            if !arguments.json.on {
                print(&line.to_string())?;
            }
            lines.push(line);
        }
        let failed = lines.iter().filter(|line| !line.holds()).count();
        print(&match arguments.json.on {
            true => format!("{:#}\n", report(&lines, effort)),
            false => verdict(lines.len(), failed),
        })?;
        Ok(match failed {
            0 => Done::Well,
            _ => Done::OutOfBounds,
        })
    })
}

/// The checks with these names, or all.
fn chosen(names: &[String]) -> Result<Vec<Check>> {
    let checks = selftest::checks();
    let is_known = |name: &&String| checks.iter().any(|check| check.name == **name);
    if let Some(unknown) = names.iter().find(|name| !is_known(name)) {
        let known: Vec<&str> = checks.iter().map(|check| check.name).collect();
        let what = format!("there is no check \"{unknown}\"");
        let help = format!("there are: {}", known.join(", "));
        return Err(failure::refused("--check", what, &help));
    }
    let is_chosen = |check: &Check| names.is_empty() || names.iter().any(|n| n == check.name);
    Ok(checks.into_iter().filter(is_chosen).collect())
}

/// The result of a check, and its duration.
struct Line {
    check: Check,
    outcome: Outcome,
    seconds: f64,
}

impl Line {
    fn of(check: Check, effort: Effort) -> Result<Line> {
        let bar = Bar::new(check.cases(effort), false).named(check.name.into());
        let begin = Instant::now();
        let outcome = check.run(effort, &bar)?;
        Ok(Line {
            check,
            outcome,
            seconds: begin.elapsed().as_secs_f64(),
        })
    }

    fn holds(&self) -> bool {
        self.check.holds(&self.outcome)
    }

    fn json(&self) -> Value {
        json!({
            "name": self.check.name,
            "what": self.check.what,
            "unit": self.check.unit,
            "worst": self.outcome.worst,
            "bound": self.check.bound,
            "cases": self.outcome.cases,
            "holds": self.holds(),
            "seconds": self.seconds,
        })
    }
}

impl std::fmt::Display for Line {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let verdict = if self.holds() { "holds" } else { "FAILS" };
        let (worst, bound) = (figure(self.outcome.worst), figure(self.check.bound));
        let (name, unit) = (self.check.name, self.check.unit);
        let cases = plan::count(self.outcome.cases);
        writeln!(
            f,
            "{name:<13} {verdict}  {worst:>8} of {bound:>7}  {unit:<29} {cases:>11}"
        )?;
        match self.holds() {
            true => Ok(()),
            false => writeln!(f, "              {}", self.check.what),
        }
    }
}

/// Counts in full, other numbers to two digits.
fn figure(x: f64) -> String {
    match x {
        x if x == x.trunc() && x.abs() < 1e6 => format!("{x}"),
        x if (0.01..1e6).contains(&x) => format!("{x:.2}"),
        x => format!("{x:.1e}"),
    }
}

fn heading() -> String {
    let threads = rayon::current_num_threads();
    format!(
        "nullray {}, {:?} kernel, {threads} {}\n{:<13} {:>16} of {:>7}  {:<29} {:>11}\n",
        env!("CARGO_PKG_VERSION"),
        Kernel::best(),
        if threads == 1 { "thread" } else { "threads" },
        "check",
        "worst",
        "bound",
        "unit",
        "cases"
    )
}

fn verdict(checks: usize, failed: usize) -> String {
    match failed {
        0 if checks == 1 => "the check holds\n".into(),
        0 => format!("all {checks} checks hold\n"),
        n => format!(
            "{n} of {checks} checks FAIL: results of this machine or this build are not to be trusted\n"
        ),
    }
}

fn report(lines: &[Line], effort: Effort) -> Value {
    json!({
        "version": env!("CARGO_PKG_VERSION"),
        "thorough": effort == Effort::Thorough,
        "kernel": Kernel::best().name(),
        "threads": rayon::current_num_threads(),
        "holds": lines.iter().all(Line::holds),
        "checks": lines.iter().map(Line::json).collect::<Vec<_>>(),
    })
}
