//! One thin file per command; [`run`] is the spine.

mod args;
mod builtin;
mod info;
mod interrupt;
mod metadata;
mod output;
mod plan;
mod progress;
mod reference;
mod render;

use std::io::{self, Write};
use std::process::ExitCode;

use clap::Parser;
use nullray::{Error, Result};

use args::{Arguments, Command};

/// Exit code for bad input and failed work.
const FAILED: u8 = 2;
/// Exit code after Ctrl-C, as shells have it (128 + SIGINT).
const INTERRUPTED: u8 = 130;

/// Parses the command line, does what it says, reports what went wrong.
pub fn run() -> ExitCode {
    let arguments = Arguments::parse();
    let done = match arguments.command {
        None => builtin::render(),
        Some(Command::Render(render)) => render::run(&render),
        Some(Command::Plan(plan)) => plan::run(&plan),
        Some(Command::Info(info)) => info::run(&info),
        Some(Command::Schema) => reference::schema(),
        Some(Command::Completions { shell }) => reference::completions(shell),
        Some(Command::Man { directory }) => reference::man(directory.as_deref()),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => report(error),
    }
}

fn report(error: Error) -> ExitCode {
    match error {
        // The reader of a pipe has seen enough: "nullray info … | head".
        Error::Io { ref source, .. } if source.kind() == io::ErrorKind::BrokenPipe => {
            ExitCode::SUCCESS
        }
        Error::Cancelled => {
            eprintln!("nullray: stopped; nothing was written");
            ExitCode::from(INTERRUPTED)
        }
        error => {
            eprintln!("{:?}", miette::Report::new(error));
            ExitCode::from(FAILED)
        }
    }
}

/// Prints `text` on standard output; a closed pipe is no failure.
fn print(text: &str) -> Result<()> {
    let mut out = io::stdout().lock();
    out.write_all(text.as_bytes())
        .and_then(|()| out.flush())
        .map_err(Error::io("standard output", "cannot write"))
}
