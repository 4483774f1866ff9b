//! The command line: arguments in, pictures out, one clear message where something is wrong.

#![forbid(unsafe_code)]

use std::process::ExitCode;

mod cli;

fn main() -> ExitCode {
    cli::run()
}
