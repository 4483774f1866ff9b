//! The memory limit of a command.

use std::fs;

/// The default if the machine does not report its memory.
const USUAL: u64 = 16 << 30;

/// The memory of the program itself, bytes: its code and tables of colours, and for each thread its stack, rays and allocator overhead.
/// Measured: 34 MiB, and per thread 1/3 MiB, 1/2 MiB in lit scenes, and 2.2 MiB with bounces, which are traced for four samples of a tile
/// together.
pub fn program(threads: Option<u16>) -> u64 {
    let threads = threads.map_or_else(rayon::current_num_threads, usize::from);
    (36 << 20) + threads as u64 * (5 << 19)
}

/// The given limit, or three quarters of what the machine, the container, or the limit on this process leaves.
pub fn limit(said: Option<u64>) -> u64 {
    said.unwrap_or_else(|| available().unwrap_or(USUAL / 3 * 4) / 4 * 3)
}

/// The bytes available to this process.
fn available() -> Option<u64> {
    let containers = CONTAINERS.iter().filter_map(Container::left);
    containers.chain(machine()).chain(address_space()).min()
}

/// The files in which a version of control groups reports the memory limit and usage.
struct Container {
    limit: &'static str,
    taken: &'static str,
    /// Named numbers, of which `cache` is the part of the usage that can be reclaimed: cached copies of files.
    statistics: &'static str,
    cache: &'static str,
}

const CONTAINERS: [Container; 2] = [
    Container {
        limit: "/sys/fs/cgroup/memory.max",
        taken: "/sys/fs/cgroup/memory.current",
        statistics: "/sys/fs/cgroup/memory.stat",
        cache: "inactive_file",
    },
    Container {
        limit: "/sys/fs/cgroup/memory/memory.limit_in_bytes",
        taken: "/sys/fs/cgroup/memory/memory.usage_in_bytes",
        statistics: "/sys/fs/cgroup/memory/memory.stat",
        cache: "total_inactive_file",
    },
];

impl Container {
    /// The bytes left below the limit; `None` without a limit.
    fn left(&self) -> Option<u64> {
        let limit = number(self.limit)?;
        let cache = fs::read_to_string(self.statistics).ok();
        let cache = cache.and_then(|text| value(&text, self.cache));
        let taken = number(self.taken).unwrap_or(0);
        Some(limit.saturating_sub(taken.saturating_sub(cache.unwrap_or(0))))
    }
}

/// The bytes left below the limit on this process's address space (`ulimit -v`, as batch systems set it); `None` without one.
fn address_space() -> Option<u64> {
    let limits = fs::read_to_string("/proc/self/limits").ok()?;
    let status = fs::read_to_string("/proc/self/status").ok()?;
    below_limit(&limits, &status)
}

fn below_limit(limits: &str, status: &str) -> Option<u64> {
    let mut lines = limits.lines();
    let limit = lines.find_map(|line| line.strip_prefix("Max address space"))?;
    // The soft limit comes first.
    let limit: u64 = limit.split_whitespace().next()?.parse().ok()?;
    let taken = value(status, "VmSize:")?.checked_mul(1024)?;
    Some(limit.saturating_sub(taken))
}

/// The value of a line "name value".
fn value(text: &str, name: &str) -> Option<u64> {
    let mut lines = text.lines().map(str::split_whitespace);
    let mut words = lines.find_map(|mut words| (words.next()? == name).then_some(words))?;
    words.next()?.parse().ok()
}

fn number(path: &str) -> Option<u64> {
    fs::read_to_string(path).ok()?.trim().parse().ok()
}

/// The bytes that the machine can give to new programs without swapping.
fn machine() -> Option<u64> {
    in_meminfo(&fs::read_to_string("/proc/meminfo").ok()?)
}

/// `MemAvailable`, or `MemTotal` on kernels before 3.14.
fn in_meminfo(text: &str) -> Option<u64> {
    let kibibytes = value(text, "MemAvailable:").or_else(|| value(text, "MemTotal:"))?;
    kibibytes.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_machine_gives_what_is_available_or_else_all_that_it_has() {
        let old = "MemTotal:       24000000 kB\nMemFree:         1000000 kB\n";
        assert_eq!(in_meminfo(old), Some(24_000_000 * 1024));
        let new = format!("{old}MemAvailable:   20000000 kB\n");
        assert_eq!(in_meminfo(&new), Some(20_000_000 * 1024));
        assert_eq!(in_meminfo("nothing"), None);
        assert_eq!(
            value("active_file 1\ninactive_file 7\n", "inactive_file"),
            Some(7)
        );
    }

    #[test]
    fn a_limit_on_the_address_space_counts() {
        let limits = |soft: &str| {
            format!(
                "Limit  Soft Limit  Hard Limit  Units\nMax cpu time  unlimited  unlimited  seconds\n\
                 Max address space         {soft}            unlimited            bytes\n"
            )
        };
        let status = "VmPeak:   9000 kB\nVmSize:\t    1000 kB\n";
        assert_eq!(below_limit(&limits("4096000"), status), Some(3_072_000));
        assert_eq!(below_limit(&limits("4096"), status), Some(0));
        assert_eq!(below_limit(&limits("unlimited"), status), None);
    }

    #[test]
    fn what_was_said_is_the_limit() {
        assert_eq!(limit(Some(5)), 5);
        assert!(limit(None) > 0);
    }
}
