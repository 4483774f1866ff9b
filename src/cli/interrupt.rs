//! Ctrl-C and termination signals: work that checks the flag stops by itself. If it has not stopped after a while, for instance during
//! the construction of a BVH or the encoding of a large file, the process exits.
//!
//! Files appear completely or not at all, so only unfinished ones have to be removed; files to resume from are kept, and reported. Nothing
//! new is started once the flag is set ([`check`]).

use std::io::IsTerminal;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

#[cfg(unix)]
use nix::sys::signal::{SigSet, Signal};
use nullray::io::temporary;
use nullray::{Error, Result};

use super::console::{complain, complain_styled};

/// The exit code, as shells have it: 128 + SIGINT.
pub const CODE: u8 = 130;
/// The message about files if nothing is kept to resume from.
const NONE_LEFT: &str = "no unfinished file is left";

/// How long work may take to stop.
const PATIENCE: Duration = Duration::from_millis(600);

static STOPPING: AtomicBool = AtomicBool::new(false);
/// The message about a restart, if there is one, and whether unfinished work is kept for it.
static AGAIN: Mutex<Option<(&'static str, bool)>> = Mutex::new(None);

/// Handles signals from now on.
pub fn install() {
    // If a handler cannot be installed, Ctrl-C ends the process as usual. The handler runs on its own thread, so it may do anything.
    let _ = ctrlc::set_handler(stop);
    // Files that become too large are errors where they are written. All threads to come inherit the mask.
    #[cfg(unix)]
    let _ = SigSet::from(Signal::SIGXFSZ).thread_block();
}

fn stop() {
    STOPPING.store(true, Ordering::Relaxed);
    std::thread::sleep(PATIENCE);
    temporary::remove_all();
    // Clears the line of the progress bar.
    if std::io::stderr().is_terminal() {
        complain_styled("\r\x1b[K");
    }
    complain(&message());
    std::process::exit(CODE.into());
}

/// Records how stopped work can be resumed, or that it cannot, if no unfinished file is kept; the last call wins.
pub fn can_resume(how: &'static str) {
    note(how, false);
}

/// Records what unfinished work is kept, and how it can be resumed; the last call wins.
pub fn keeps(what: &'static str) {
    note(what, true);
}

/// Records that nothing is kept any more.
pub fn keeps_nothing() {
    *AGAIN.lock().unwrap_or_else(PoisonError::into_inner) = None;
}

fn note(text: &'static str, keeps: bool) {
    *AGAIN.lock().unwrap_or_else(PoisonError::into_inner) = Some((text, keeps));
}

/// The message after everything has stopped.
pub fn message() -> String {
    match *AGAIN.lock().unwrap_or_else(PoisonError::into_inner) {
        Some((what, true)) => format!("nullray: stopped; {what}\n"),
        Some((how, false)) => format!("nullray: stopped; {NONE_LEFT}\n{how}\n"),
        None => format!("nullray: stopped; {NONE_LEFT}\n"),
    }
}

/// Whether to stop.
pub fn is_stopping() -> bool {
    STOPPING.load(Ordering::Relaxed)
}

/// An error if the work has to stop.
pub fn check() -> Result<()> {
    if is_stopping() {
        Err(Error::Cancelled)
    } else {
        Ok(())
    }
}
