//! What the benchmarks share.

#![allow(dead_code, unused_imports)] // each uses a part of it

mod camera;
mod meshes;
mod peer;
mod rounds;

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use nullray::render::film::Film;
use nullray::render::prepare::Prepared;
use nullray::render::progress::Progress;
use nullray::render::{render, render_over};

pub use camera::{Camera, TILE, trace_tile};
pub use meshes::{meshes, sphere};
pub use peer::Peer;
pub use rounds::{Ratio, Rounds, best, seconds_of};

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

/// The least of `rounds` times that `work` takes, seconds.
pub fn best_of(rounds: usize, work: impl FnMut()) -> f64 {
    Rounds::of(rounds, &mut [work]).best(0)
}

/// Writes a line of a report, and prints it.
pub fn report(file: &mut fs::File, line: &serde_json::Value) {
    println!("{line}");
    writeln!(file, "{line}").expect("report");
}

/// Renders `scene` in the memory of `film`, as frame after frame is rendered.
pub fn render_next(scene: &Prepared, film: &mut Option<Film>, progress: &dyn Progress) {
    let rendered = match film.take() {
        Some(film) => render_over(scene, film, progress),
        None => render(scene, progress),
    };
    *film = rendered.ok();
}

/// Runs `work` on so many threads.
pub fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    pool.build().expect("threads").install(work)
}

/// The cells of an `n` × `n` grid, row by row.
pub fn grid(n: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..n).flat_map(move |y| (0..n).map(move |x| (y, x)))
}
