//! The command line: arguments in, pictures out, one clear message where something is wrong.

use std::process::ExitCode;

mod cli;

fn main() -> ExitCode {
    cli::run()
}
