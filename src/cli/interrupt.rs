//! Ctrl-C: a flag that the work looks at, and a limit on how long it may take to notice.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use super::INTERRUPTED;

/// How long work that does not look at the flag (a BVH under construction) may go on.
const PATIENCE: Duration = Duration::from_millis(800);

/// What the signal handler and the work share.
#[derive(Debug, Default)]
pub struct Interrupt {
    /// Set by Ctrl-C.
    stop: AtomicBool,
    /// Whether files are being written, which is finished first.
    writing: AtomicBool,
}

impl Interrupt {
    /// The one of this process, its handler installed.
    pub fn install() -> &'static Interrupt {
        static INTERRUPT: OnceLock<Interrupt> = OnceLock::new();
        INTERRUPT.get_or_init(|| {
            // Where a handler cannot be installed, Ctrl-C ends the process as it always does.
            let _ = ctrlc::set_handler(|| Interrupt::install_handled());
            Interrupt::default()
        })
    }

    fn install_handled() {
        let interrupt = Interrupt::install();
        interrupt.stop.store(true, Ordering::Relaxed);
        std::thread::sleep(PATIENCE);
        if !interrupt.writing.load(Ordering::Relaxed) {
            eprintln!("nullray: stopped; nothing was written");
            std::process::exit(INTERRUPTED.into());
        }
    }

    /// Whether Ctrl-C was pressed.
    pub fn is_pressed(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Says that files are being written from now on.
    pub fn begin_writing(&self) {
        self.writing.store(true, Ordering::Relaxed);
    }
}
