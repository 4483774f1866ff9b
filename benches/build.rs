//! Building trees: by mesh, preset and number of threads.
//!
//! Measured in turn with obvhs alone (its medium preset: f32 boxes, no corners), best of several rounds, and
//! what the tree is worth: the time of one 1024² picture by one thread, for the sum that a still takes. JSON lines in
//! `target/bench/build.jsonl`: fields `case`, `preset`, `threads`, `triangles`, `build_s`, `mtriangles_per_s`,
//! `bytes_per_triangle`, `trace_s`. Meshes: every `*.tri` of the folder `NULLRAY_BENCH_MESHES`, else generated ones and a
//! sphere of 1.6 million triangles. `--smoke` and `NULLRAY_BENCH_SMOKE=1` use tiny sizes.

mod common;

use std::time::Instant;

use glam::DVec3;
use nullray::accel::{Bvh, Facing, Preset};

use common::{
    Camera, Peer, TILE, best_of, meshes, on_threads, report, report_file, sphere, trace_tile,
};

fn main() {
    let smoke = common::is_smoke();
    let (image, rounds) = if smoke { (32, 1) } else { (1024, 5) };
    let mut file = report_file("build");
    let mut all = meshes(smoke, if smoke { 12 } else { 256 });
    if !smoke && std::env::var_os("NULLRAY_BENCH_MESHES").is_none() {
        all.push(("large sphere".into(), sphere(730)));
    }
    for (name, triangles) in all {
        let rounds = if triangles.len() > 1_000_000 {
            rounds.min(3)
        } else {
            rounds
        };
        let mut best = vec![f64::INFINITY; 8];
        for _ in 0..rounds {
            for (best, (preset, threads)) in best.iter_mut().zip(cases()) {
                *best = best.min(build_time(&triangles, preset, threads));
            }
        }
        for ((preset, threads), seconds) in cases().zip(best) {
            let worth = preset.map(|preset| worth(&triangles, preset, image));
            let line = serde_json::json!({
                "case": name, "preset": preset.map_or("obvhs medium".into(), |p| format!("{p:?}").to_lowercase()),
                "threads": threads, "triangles": triangles.len(), "build_s": seconds,
                "mtriangles_per_s": triangles.len() as f64 / seconds / 1e6,
                "bytes_per_triangle": worth.map(|w| w.0), "trace_s": worth.map(|w| w.1),
            });
            report(&mut file, &line);
        }
    }
}

/// Presets, and none for obvhs alone, by one and by two threads.
fn cases() -> impl Iterator<Item = (Option<Preset>, usize)> {
    let presets = Preset::ALL.map(Some).into_iter().chain([None]);
    presets.flat_map(|preset| [(preset, 1), (preset, 2)])
}

fn build_time(triangles: &[[DVec3; 3]], preset: Option<Preset>, threads: usize) -> f64 {
    on_threads(threads, || {
        let Some(preset) = preset else {
            return Peer::build(triangles).1.as_secs_f64();
        };
        let copy = triangles.to_vec();
        let begin = Instant::now();
        std::hint::black_box(Bvh::build_with(copy, |_| Facing::TwoSided, preset));
        begin.elapsed().as_secs_f64()
    })
}

/// Bytes per triangle, and the time of a picture from outside.
fn worth(triangles: &[[DVec3; 3]], preset: Preset, image: usize) -> (f64, f64) {
    let bvh = Bvh::build_with(triangles.to_vec(), |_| Facing::TwoSided, preset);
    let camera = Camera::new(&bvh, 2.2, 0.5, image);
    let seconds = best_of(2, || {
        for tile in camera.directions.chunks(TILE * TILE) {
            trace_tile(&bvh, camera.origin, tile);
        }
    });
    (bvh.bytes() as f64 / triangles.len() as f64, seconds)
}
