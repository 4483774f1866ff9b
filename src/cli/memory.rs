//! How much memory a command may take.

use std::fs;

/// Where the machine does not say how much it has.
const USUAL: u64 = 16 << 30;

/// What was said, or three quarters of the machine's memory, or of what the container may have of it.
pub fn limit(said: Option<u64>) -> u64 {
    said.unwrap_or_else(|| available().unwrap_or(USUAL / 3 * 4) / 4 * 3)
}

/// The bytes that this process may have.
fn available() -> Option<u64> {
    let container = [
        "/sys/fs/cgroup/memory.max",
        "/sys/fs/cgroup/memory/memory.limit_in_bytes",
    ];
    let number = |path: &str| fs::read_to_string(path).ok()?.trim().parse().ok();
    let limits = container.into_iter().filter_map(number);
    limits.chain(machine()).min()
}

/// The bytes of the machine's memory.
fn machine() -> Option<u64> {
    let text = fs::read_to_string("/proc/meminfo").ok()?;
    let total = text
        .lines()
        .find_map(|line| line.strip_prefix("MemTotal:"))?;
    let kibibytes: u64 = total.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kibibytes.checked_mul(1024)
}
