//! Memory and time of one input.

use std::fs::File;
use std::io::{Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// The most bytes that an input of some kilobytes may take: the largest budget of a target and the texture decoders' own limits.
pub const MOST_MEMORY: usize = 1200 << 20;
/// The longest that an input may take. Builds for tests are several times slower than others.
const LONGEST: Duration = Duration::from_secs(20);

/// Where findings are kept.
const FINDINGS: &str = "target/fuzz-findings";

/// What is run now, and since when, in milliseconds after the first look.
static CURRENT: Mutex<(String, Vec<u8>)> = Mutex::new((String::new(), Vec::new()));
static SINCE: AtomicU64 = AtomicU64::new(u64::MAX);
static WATCHED: AtomicBool = AtomicBool::new(false);

/// Notes that this input is run from now on; one that takes too long is saved, and ends the process.
pub fn begin(target: &str, bytes: &[u8]) {
    static START: std::sync::LazyLock<Instant> = std::sync::LazyLock::new(Instant::now);
    let now = || START.elapsed().as_millis() as u64;
    {
        let mut current = CURRENT.lock().unwrap_or_else(PoisonError::into_inner);
        current.0.clear();
        current.0.push_str(target);
        current.1.clear();
        current.1.extend_from_slice(bytes);
    }
    note(target, bytes);
    SINCE.store(now(), Ordering::Relaxed);
    if !WATCHED.swap(true, Ordering::Relaxed) {
        std::thread::spawn(move || {
            loop {
                std::thread::sleep(Duration::from_millis(500));
                let since = SINCE.load(Ordering::Relaxed);
                if now().saturating_sub(since) > LONGEST.as_millis() as u64 {
                    let current = CURRENT.lock().unwrap_or_else(PoisonError::into_inner);
                    let path = save(&current.0, &current.1, "slow");
                    eprintln!("{}: takes more than {LONGEST:?}", path.display());
                    std::process::abort();
                }
            }
        });
    }
}

/// Notes that nothing is run.
pub fn end() {
    SINCE.store(u64::MAX, Ordering::Relaxed);
}

/// What is run now, for those who find the process dead of a stack overflow or a signal: a line that names the target, then
/// the input.
fn note(target: &str, bytes: &[u8]) {
    static FILE: Mutex<Option<File>> = Mutex::new(None);
    let mut file = FILE.lock().unwrap_or_else(PoisonError::into_inner);
    let file = file.get_or_insert_with(|| {
        std::fs::create_dir_all(FINDINGS).expect("a folder can be made");
        File::create(current()).expect("a file can be made")
    });
    let content = [target.as_bytes(), b"\n", bytes].concat();
    let written = file
        .seek(SeekFrom::Start(0))
        .and_then(|_| file.write_all(&content));
    written
        .and_then(|()| file.set_len(content.len() as u64))
        .expect("a file can be written");
}

/// Removes that note, at the end of a run.
pub fn finish() {
    let _ = std::fs::remove_file(current());
}

fn current() -> PathBuf {
    Path::new(FINDINGS).join(format!("died-{}", std::process::id()))
}

/// Keeps an input that was found.
pub fn save(target: &str, bytes: &[u8], what: &str) -> PathBuf {
    let folder = Path::new(FINDINGS).join(target);
    std::fs::create_dir_all(&folder).expect("a folder can be made");
    let hash = bytes.iter().fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
        (hash ^ u64::from(*byte)).wrapping_mul(0x100_0000_01b3)
    });
    let path = folder.join(format!("{what}-{hash:016x}"));
    std::fs::write(&path, bytes).expect("a file can be written");
    path
}
