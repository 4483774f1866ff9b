//! Coherent primary rays: this crate's certified closest hits against obvhs' own f32 traversal.
//!
//! Both are measured in turn, one thread, best of several rounds; one line per case is printed and
//! written as JSON to `target/bench/visibility.jsonl`. Meshes: every `*.tri` (little-endian f32, nine
//! per triangle) of the folder `NULLRAY_BENCH_MESHES`, else generated ones. `--smoke`,
//! `NULLRAY_BENCH_SMOKE=1` and `cargo test --benches` use tiny sizes.
//!
//! Camera, with c the centre of the mesh's bounding box and R half its diagonal: pixel-centre rays
//! along −z, "outside" from c + (0, 0, 2.2 R) with half-width 0.5 of the image plane at distance
//! 1, "inside" from c + (0, 0, 0.3 R) with half-width 0.7.

mod common;

use std::fs;
use std::io::Write;
use std::time::{Duration, Instant};

use glam::DVec3;
use nullray::accel::{Bvh, Facing, Hit, Ray};

use common::{Peer, grid, meshes};

/// Rays per batch: a tile of 8 × 8 pixels.
const TILE: usize = 8;

struct Size {
    image: usize,
    rounds: usize,
    detail: usize,
}

fn main() {
    let smoke = common::is_smoke();
    let size = if smoke {
        Size {
            image: 64,
            rounds: 1,
            detail: 16,
        }
    } else {
        Size {
            image: 1024,
            rounds: 7,
            detail: 256,
        }
    };
    let mut report = common::report_file("visibility");
    for (name, triangles) in meshes(smoke, size.detail) {
        measure_mesh(&name, triangles, &size, &mut report);
    }
}

fn measure_mesh(name: &str, triangles: Vec<[DVec3; 3]>, size: &Size, report: &mut fs::File) {
    let count = triangles.len();
    let (peer, peer_build) = Peer::build(&triangles);
    let begin = Instant::now();
    let bvh = Bvh::build(triangles, |_| Facing::TwoSided);
    let build = begin.elapsed();
    let bytes = bvh.bytes() as f64 / count as f64;
    println!(
        "{name}: {count} triangles, {bytes:.1} bytes each, built in {build:.2?} (obvhs alone {:.2?})",
        peer_build
    );
    for (place, distance, half_width) in [("outside", 2.2, 0.5), ("inside", 0.3, 0.7)] {
        let camera = Camera::new(&bvh, distance, half_width, size.image);
        let case = format!("{name}/{place}");
        let result = measure(&bvh, &peer, &camera, size.rounds);
        println!("  {case}: {result}");
        let line = serde_json::json!({
            "case": case, "precision": "certified", "kernel": "scalar", "threads": 1,
            "triangles": count, "rays": camera.rays(), "hits": result.hits,
            "mrays_per_s": result.batch, "single_mrays_per_s": result.single,
            "any_mrays_per_s": result.any,
            "obvhs_mrays_per_s": result.peer, "obvhs_hits": result.peer_hits,
            "bytes_per_triangle": bytes, "build_s": build.as_secs_f64(),
        });
        writeln!(report, "{line}").expect("report");
    }
}

struct Rates {
    batch: f64,
    single: f64,
    any: f64,
    peer: f64,
    hits: usize,
    peer_hits: usize,
}

impl std::fmt::Display for Rates {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "{:.2} Mrays/s (single {:.2}, any {:.2}), obvhs {:.2}, ratio {:.2}, hits {} (obvhs {})",
            self.batch,
            self.single,
            self.any,
            self.peer,
            self.batch / self.peer,
            self.hits,
            self.peer_hits
        )
    }
}

fn measure(bvh: &Bvh, peer: &Peer, camera: &Camera, rounds: usize) -> Rates {
    let mut best = [Duration::MAX; 4];
    let mut hits = [0; 4];
    for _ in 0..rounds {
        let kinds: [&dyn Fn() -> usize; 4] = [
            &|| trace_batches(bvh, camera),
            &|| trace_singles(bvh, camera),
            &|| trace_any(bvh, camera),
            &|| peer.trace(camera.origin, &camera.directions),
        ];
        for (i, kind) in kinds.iter().enumerate() {
            let begin = Instant::now();
            hits[i] = kind();
            best[i] = best[i].min(begin.elapsed());
        }
    }
    assert_eq!(hits[0], hits[1], "single rays and batches agree");
    assert_eq!(hits[0], hits[2], "closest and any hits agree");
    let [batch, single, any, peer] = best.map(|t| camera.rays() as f64 / t.as_secs_f64() / 1e6);
    Rates {
        batch,
        single,
        any,
        peer,
        hits: hits[0],
        peer_hits: hits[3],
    }
}

fn trace_batches(bvh: &Bvh, camera: &Camera) -> usize {
    let mut hits: [Option<Hit>; TILE * TILE];
    let mut count = 0;
    for tile in camera.directions.chunks(TILE * TILE) {
        hits = [None; TILE * TILE];
        bvh.closest_many(camera.origin, tile, &mut hits[..tile.len()]);
        count += hits.iter().flatten().count();
    }
    count
}

fn trace_singles(bvh: &Bvh, camera: &Camera) -> usize {
    let hit = |&d: &DVec3| bvh.closest(&camera.ray(d), f64::INFINITY).is_some();
    camera.directions.iter().filter(|d| hit(d)).count()
}

fn trace_any(bvh: &Bvh, camera: &Camera) -> usize {
    let hit = |&d: &DVec3| bvh.any(&camera.ray(d), f64::INFINITY, None);
    camera.directions.iter().filter(|d| hit(d)).count()
}

struct Camera {
    origin: DVec3,
    /// By tiles.
    directions: Vec<DVec3>,
}

impl Camera {
    fn new(bvh: &Bvh, distance: f64, half_width: f64, size: usize) -> Camera {
        let (lo, hi) = bvh.bounds().expect("a mesh");
        let origin = (lo + hi) / 2.0 + DVec3::Z * (distance * (hi - lo).length() / 2.0);
        let pixel = |i: usize| ((i as f64 + 0.5) / size as f64 * 2.0 - 1.0) * half_width;
        let mut directions = Vec::with_capacity(size * size);
        for (y0, x0) in grid(size / TILE).map(|(y, x)| (y * TILE, x * TILE)) {
            let direction = |(y, x)| DVec3::new(pixel(x0 + x), -pixel(y0 + y), -1.0).normalize();
            directions.extend(grid(TILE).map(direction));
        }
        Camera { origin, directions }
    }

    fn rays(&self) -> usize {
        self.directions.len()
    }

    fn ray(&self, direction: DVec3) -> Ray {
        Ray {
            origin: self.origin,
            direction,
            s_min: 0.0,
        }
    }
}
