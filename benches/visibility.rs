//! Coherent primary rays: closest hits by packets of each kernel, certified and fast, against single
//! rays and against obvhs' own f32 traversal.
//!
//! All are measured in turn, one thread, best of several rounds; one line per case, precision and kernel
//! is printed and written as JSON to `target/bench/visibility.jsonl`. Meshes: every `*.tri`
//! (little-endian f32, nine per triangle) of the folder `NULLRAY_BENCH_MESHES`, else generated ones.
//! `--smoke`, `NULLRAY_BENCH_SMOKE=1` and `cargo test --benches` use tiny sizes.
//!
//! Camera, with c the centre of the mesh's bounding box and R half its diagonal: pixel-centre rays
//! along −z, "outside" from c + (0, 0, 2.2 R) with half-width 0.5 of the image plane at distance
//! 1, "inside" from c + (0, 0, 0.3 R) with half-width 0.7.

mod common;

use std::fs;
use std::io::Write;
use std::time::{Duration, Instant};

use glam::DVec3;
use nullray::accel::{Bvh, Facing, Hit, Kernel, Method, NoTally, Origins, Precision, Ray};

use common::{Peer, grid, meshes};

/// Rays per batch: a tile of 16 × 16 pixels, as in images.
const TILE: usize = 16;

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

/// A way to trace the rays of a camera.
struct Case {
    precision: &'static str,
    kernel: &'static str,
    trace: Box<dyn Fn(&Camera) -> usize>,
}

fn measure_mesh(name: &str, triangles: Vec<[DVec3; 3]>, size: &Size, report: &mut fs::File) {
    let count = triangles.len();
    let (peer, peer_build) = Peer::build(&triangles);
    let begin = Instant::now();
    let bvh = Bvh::build(triangles, |_| Facing::TwoSided);
    let build = begin.elapsed();
    let bytes = bvh.bytes() as f64 / count as f64;
    println!(
        "{name}: {count} triangles, {bytes:.1} bytes each, built in {build:.2?} (obvhs alone {peer_build:.2?})"
    );
    let cameras = [("outside", 2.2, 0.5), ("inside", 0.3, 0.7)]
        .map(|(place, distance, width)| (place, Camera::new(&bvh, distance, width, size.image)));
    let cases = cases(bvh, peer);
    for (place, camera) in &cameras {
        for (case, best, hits) in measure(&cases, camera, size.rounds) {
            let rate = camera.rays() as f64 / best.as_secs_f64() / 1e6;
            let (precision, kernel) = (case.precision, case.kernel);
            println!("  {name}/{place} {precision} {kernel}: {rate:.2} Mrays/s, {hits} hits");
            let line = serde_json::json!({
                "case": format!("{name}/{place}"), "precision": precision, "kernel": kernel,
                "threads": 1, "mrays_per_s": rate, "hits": hits,
                "triangles": count, "rays": camera.rays(),
                "bytes_per_triangle": bytes, "build_s": build.as_secs_f64(),
            });
            writeln!(report, "{line}").expect("report");
        }
    }
}

/// Everything that can trace here.
fn cases(bvh: Bvh, peer: Peer) -> Vec<Case> {
    let bvh = std::rc::Rc::new(bvh);
    let mut cases = Vec::new();
    let mut add = |precision, kernel, trace: Box<dyn Fn(&Camera) -> usize>| {
        cases.push(Case {
            precision,
            kernel,
            trace,
        });
    };
    for kernel in Kernel::ALL.into_iter().filter(|k| k.is_supported()) {
        for (precision, called) in [
            (Precision::Fast, "fast"),
            (Precision::Certified, "certified"),
        ] {
            if (kernel, precision) != (Kernel::Scalar, Precision::Fast) {
                let (bvh, method) = (bvh.clone(), Method { kernel, precision });
                let trace = move |camera: &Camera| trace_batches(&bvh, method, camera);
                add(called, kernel_name(kernel), Box::new(trace));
            }
        }
    }
    add(
        "certified",
        "any",
        Box::new(move |camera| trace_any(&bvh, camera)),
    );
    let trace_peer = move |camera: &Camera| peer.trace(camera.origin, &camera.directions);
    add("fast", "obvhs", Box::new(trace_peer));
    cases
}

fn kernel_name(kernel: Kernel) -> &'static str {
    match kernel {
        Kernel::Avx512 => "avx512",
        Kernel::Avx2 => "avx2",
        Kernel::Portable => "portable",
        Kernel::Scalar => "scalar",
    }
}

/// The best time of each case, and how many rays hit.
fn measure<'a>(
    cases: &'a [Case],
    camera: &Camera,
    rounds: usize,
) -> Vec<(&'a Case, Duration, usize)> {
    let mut results: Vec<_> = cases.iter().map(|c| (c, Duration::MAX, 0)).collect();
    for _ in 0..rounds {
        for (case, best, hits) in &mut results {
            let begin = Instant::now();
            *hits = (case.trace)(camera);
            *best = begin.elapsed().min(*best);
        }
    }
    let certified = results.iter().filter(|r| r.0.precision == "certified");
    let mut counts: Vec<usize> = certified.map(|r| r.2).collect();
    counts.dedup();
    assert_eq!(counts.len(), 1, "certified hits agree: {counts:?}");
    results
}

fn trace_batches(bvh: &Bvh, method: Method, camera: &Camera) -> usize {
    let mut hits: [Option<Hit>; TILE * TILE];
    let mut count = 0;
    for tile in camera.directions.chunks(TILE * TILE) {
        hits = [None; TILE * TILE];
        let from = Origins::Shared(camera.origin);
        let entries = &mut hits[..tile.len()];
        bvh.closest_by(method, from, tile, entries, &mut NoTally, |_| count += 1);
        std::hint::black_box(&hits);
    }
    count
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
