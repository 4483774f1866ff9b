//! What the benchmarks share.

mod meshes;
mod peer;

use std::fs;
use std::path::{Path, PathBuf};

pub use meshes::meshes;
pub use peer::Peer;

/// Whether to run tiny sizes only: `--smoke`, `NULLRAY_BENCH_SMOKE=1`, `cargo test --benches`.
pub fn is_smoke() -> bool {
    // `cargo bench` passes --bench, `cargo test --benches` doesn't.
    let arguments: Vec<String> = std::env::args().collect();
    let has = |flag: &str| arguments.iter().any(|a| a == flag);
    has("--smoke") || !has("--bench") || std::env::var_os("NULLRAY_BENCH_SMOKE").is_some()
}

/// `target/bench/NAME.jsonl`, empty.
pub fn report_file(name: &str) -> fs::File {
    let target = std::env::var_os("CARGO_TARGET_DIR").map(PathBuf::from);
    let target = target.unwrap_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("target"));
    let folder = target.join("bench");
    fs::create_dir_all(&folder).expect("target/bench");
    fs::File::create(folder.join(name).with_extension("jsonl")).expect("report")
}

/// The cells of an `n` × `n` grid, row by row.
pub fn grid(n: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..n).flat_map(move |y| (0..n).map(move |x| (y, x)))
}
