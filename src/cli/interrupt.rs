//! Ctrl-C and termination signals: work that checks the flag stops by itself. If it has not stopped after a while,
//! as in the construction of a BVH or the encoding of a large file, the process exits.
//!
//! Files appear whole or not at all, so that all there is to clear away is what is in the making; what work is resumed from is
//! kept, and said to be. Nothing new is begun once the flag is set ([`check`]).

use std::io::IsTerminal;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use nullray::io::temporary;
use nullray::{Error, Result};

use super::{complain, complain_styled};

/// The exit code, as shells have it: 128 + SIGINT.
pub const CODE: u8 = 130;
/// What is said of files where nothing is kept to resume from.
const NONE_LEFT: &str = "no unfinished file is left";

/// How long work may take to notice.
const PATIENCE: Duration = Duration::from_millis(600);

static STOPPING: AtomicBool = AtomicBool::new(false);
/// What becomes of the work when it is begun again, where there is something to say, and whether unfinished work is kept for that.
static AGAIN: Mutex<Option<(&'static str, bool)>> = Mutex::new(None);

/// Handles signals from now on.
pub fn install() {
    // Where a handler cannot be installed, Ctrl-C ends the process as it always does. The handler runs on
    // a thread of its own, and may do as it likes.
    let _ = ctrlc::set_handler(stop);
}

fn stop() {
    STOPPING.store(true, Ordering::Relaxed);
    std::thread::sleep(PATIENCE);
    temporary::remove_all();
    // The progress bar leaves its line to us.
    if std::io::stderr().is_terminal() {
        complain_styled("\r\x1b[K");
    }
    complain(&message());
    std::process::exit(CODE.into());
}

/// Notes how the work can be resumed after it was stopped, or that it cannot be, where it keeps no unfinished file; the last note counts.
pub fn can_resume(how: &'static str) {
    note(how, false);
}

/// Notes what unfinished work is kept, and how it can be resumed; the last note counts.
pub fn keeps(what: &'static str) {
    note(what, true);
}

fn note(text: &'static str, keeps: bool) {
    *AGAIN.lock().unwrap_or_else(PoisonError::into_inner) = Some((text, keeps));
}

/// The message when everything has stopped.
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

/// An error if it is time to stop.
pub fn check() -> Result<()> {
    if is_stopping() {
        Err(Error::Cancelled)
    } else {
        Ok(())
    }
}
