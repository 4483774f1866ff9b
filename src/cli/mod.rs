//! One thin file per command; [`run`] is the spine.

mod args;
mod builtin;
mod check;
mod compare;
mod demo;
mod diagram;
mod export;
mod exposure;
mod failure;
mod film;
mod frames;
mod help;
mod info;
mod inputs;
mod interrupt;
mod names;
mod output;
mod overlay;
mod panels;
mod plan;
mod progress;
mod reference;
mod remarks;
mod render;
mod selftest;
mod sheet;
mod stats;
mod study;
mod tessellation;
mod values;

use std::io::{self, ErrorKind, Write};
use std::process::ExitCode;

use clap::Parser;
use nullray::{Error, Result};
use serde::Serialize;

use args::{Arguments, Command};
use failure::Done;

/// Parses the command line, carries it out, reports what went wrong.
pub fn run() -> ExitCode {
    let arguments = Arguments::parse();
    interrupt::install();
    failure::outcome(|| carry_out(arguments.command))
}

fn carry_out(command: Option<Command>) -> Result<Done> {
    let done = match command {
        Some(Command::Compare(compare)) => return compare::run(&compare),
        None => demo::run(),
        Some(Command::Render(render)) => render::run(&render),
        Some(Command::Sheet(sheet)) => sheet::run(&sheet),
        Some(Command::Diagram(diagram)) => diagram::run(&diagram),
        Some(Command::Export(export)) => export::run(&export),
        Some(Command::Plan(plan)) => plan::run(&plan),
        Some(Command::Tessellation(forecast)) => tessellation::run(&forecast),
        Some(Command::Info(info)) => info::run(&info),
        Some(Command::Selftest(selftest)) => return selftest::run(&selftest),
        Some(Command::Study(study)) => study::run(&study),
        Some(Command::Schema) => reference::schema(),
        Some(Command::Completions { shell }) => reference::completions(shell),
        Some(Command::Man { directory }) => reference::man(directory.as_deref()),
    };
    done.map(|()| Done::Well)
}

/// Prints `text` on standard output. A closed pipe ("nullray info … | head") is not an
/// error: the work goes on.
fn print(text: &str) -> Result<()> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Error::io("standard output", "cannot write")(error))
        }
        _ => Ok(()),
    }
}

/// Prints `text` unless `quiet`.
fn say(quiet: bool, text: &str) -> Result<()> {
    if quiet { Ok(()) } else { print(text) }
}

/// Prints warnings unless `quiet`.
fn warn<'a>(quiet: bool, warnings: impl IntoIterator<Item = &'a String>) -> Result<()> {
    let mut warnings = warnings.into_iter();
    warnings.try_for_each(|text| say(quiet, &format!("warning: {}\n", info::escaped(text))))
}

/// Prints `value` as JSON.
fn print_json(value: &impl Serialize) -> Result<()> {
    let help = "leave --json out; numbers that JSON cannot hold are a bug";
    let text = serde_json::to_string_pretty(value);
    let text = text.map_err(|e| failure::refused("--json", e.to_string(), help))?;
    print(&(text + "\n"))
}

/// Writes `text` to standard error, if there is one; in colour where a terminal shows it.
fn complain(text: &str) {
    let _ = anstream::stderr().lock().write_all(text.as_bytes());
}
