//! Errors, reported as one message and an exit code.
//!
//! | code | meaning |
//! |---|---|
//! | 0 | done |
//! | 1 | `compare` exceeded a tolerance or could not judge it, or a check of `selftest` failed |
//! | 2 | wrong command line, bad input, a file that cannot be read or written |
//! | 101 | a bug in nullray |
//! | 130 | stopped by Ctrl-C or a termination signal |

use std::panic::{self, AssertUnwindSafe};
use std::path::Path;
use std::process::ExitCode;
use std::sync::{Mutex, PoisonError};

use clap::error::{ContextKind, ContextValue};
use nullray::{Error, Result};

use super::console::{complain, complain_styled, harmless};
use super::flags;
use super::interrupt;

const OUT_OF_BOUNDS: u8 = 1;
const FAILED: u8 = 2;
const BUG: u8 = 101;

/// The message and location of the last panic.
static LAST_PANIC: Mutex<Option<String>> = Mutex::new(None);

/// The outcome of work without errors.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Done {
    /// Success.
    Well,
    /// A check failed.
    OutOfBounds,
}

/// Does `work`, and reports errors.
pub fn outcome(work: impl FnOnce() -> Result<Done>) -> ExitCode {
    match caught(work) {
        // Errors during a shutdown are consequences of it.
        Ok(Err(_)) | Err(_) if interrupt::is_stopping() => {
            complain(&interrupt::message());
            ExitCode::from(interrupt::CODE)
        }
        Ok(Ok(Done::Well)) => ExitCode::SUCCESS,
        Ok(Ok(Done::OutOfBounds)) => ExitCode::from(OUT_OF_BOUNDS),
        Ok(Err(error)) => {
            complain_styled(&flags::of_error(error).report(true));
            ExitCode::from(FAILED)
        }
        Err(what) => {
            complain(&bug(&what));
            ExitCode::from(BUG)
        }
    }
}

/// The result of `work`, or its panic message.
///
/// The hook only records panics: the library catches those of image decoders and reports them as broken files, so they must not be shown
/// here.
fn caught<T>(work: impl FnOnce() -> Result<T>) -> Result<Result<T>, String> {
    panic::set_hook(Box::new(|info| {
        let mut last = LAST_PANIC.lock().unwrap_or_else(PoisonError::into_inner);
        *last = Some(info.to_string());
    }));
    let result = panic::catch_unwind(AssertUnwindSafe(work));
    result.map_err(|_| {
        let mut last = LAST_PANIC.lock().unwrap_or_else(PoisonError::into_inner);
        last.take().unwrap_or_default()
    })
}

fn bug(what: &str) -> String {
    format!(
        "nullray: this is a bug in nullray {}: {what}\n\
         Please report it with this message, the command and the scene file. No unfinished file is left.\n",
        env!("CARGO_PKG_VERSION")
    )
}

/// The longest line quoted from a command line, characters.
const LONGEST_LINE: usize = 400;

/// Reports an error of the command line, with long lines cut.
pub fn of_command_line(mut said: clap::Error) -> ExitCode {
    add_command(&mut said);
    let styled = said.render().ansi().to_string();
    let lines = styled
        .lines()
        .map(|line| match line.char_indices().nth(LONGEST_LINE) {
            // Any open styles are closed at the end of the line.
            Some((end, _)) => format!("{}…\u{1b}[0m\n", &line[..end]),
            None => format!("{line}\n"),
        });
    complain_styled(&lines.collect::<String>());
    ExitCode::from(FAILED)
}

/// Adds the command to the error about a scene or a model without one.
fn add_command(said: &mut clap::Error) {
    let Some(ContextValue::String(file)) = said.get(ContextKind::InvalidSubcommand) else {
        return;
    };
    let extension = Path::new(file).extension();
    let is = |known: &str| extension.is_some_and(|extension| extension.eq_ignore_ascii_case(known));
    if ["toml", "glb", "gltf"].into_iter().any(is) {
        let file = harmless(file);
        let tip = match file.contains(char::is_whitespace) {
            true => format!("nullray render \"{file}\""),
            false => format!("nullray render {file}"),
        };
        let tip = ContextValue::StyledStrs(vec![tip.into()]);
        // Commands with a similar name are not meant.
        said.remove(ContextKind::SuggestedSubcommand);
        said.insert(ContextKind::Suggested, tip);
    }
}

/// A problem with an option of the command line.
pub fn refused(option: impl Into<String>, what: impl Into<String>, help: &str) -> Error {
    Error::invalid("command line", option, what, help)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_becomes_a_short_message_that_asks_for_a_report() {
        let what = caught::<()>(|| panic!("index {} of nothing", 7)).unwrap_err();
        assert!(
            what.contains("index 7 of nothing") && what.contains("failure.rs"),
            "{what}"
        );
        let message = bug(&what);
        assert!(message.contains("Please report"), "{message}");
        assert!(!message.contains("backtrace"), "{message}");
    }

    #[test]
    fn an_error_is_not_taken_for_a_panic() {
        assert!(matches!(
            caught::<()>(|| Err(Error::Cancelled)),
            Ok(Err(Error::Cancelled))
        ));
    }
}
