//! The resident memory of this process, as Linux counts it.

use std::fs;

/// Memory in use before something is done.
pub(super) struct Before(Option<u64>);

impl Before {
    /// Takes note, and has the system count the peak from here.
    pub fn now() -> Self {
        // Where that is not possible the peak of before is not known to be over.
        let reset = fs::write("/proc/self/clear_refs", "5");
        Before(reset.ok().and_then(|()| line("VmRSS:")))
    }

    /// By how much the memory in use has grown at most since, bytes; none where nobody counts.
    pub fn growth(&self) -> Option<u64> {
        Some(line("VmHWM:")?.saturating_sub(self.0?))
    }
}

/// A line of the process's status, which counts in KiB.
fn line(name: &str) -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix(name))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes * 1024)
}
