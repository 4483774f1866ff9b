//! Coherent rays by packets of each kernel, certified and fast, against single rays and against obvhs' own
//! f32 traversal: closest hits from one point ("shared"), from a pinhole a thousandth of R wide ("pinhole":
//! an origin for each ray), and whether anything stands between what the first hit and a lamp at
//! c + (0.5, 0.8, 0.6) R ("shadow").
//!
//! All are measured in turn, one thread, best of several rounds; one line per case, kind of rays, precision and kernel
//! is printed, with how many times the rate of certified single rays it is (the median of rounds and its quartiles), and written as
//! JSON to `target/bench/visibility.jsonl`. Meshes: every `*.tri`
//! (little-endian f32, nine per triangle) of the folder `NULLRAY_BENCH_MESHES`, else generated ones.
//! `--smoke`, `NULLRAY_BENCH_SMOKE=1` and `cargo test --benches` use tiny sizes.
//!
//! Camera, with c the centre of the mesh's bounding box and R half its diagonal: 1024 × 1024 pixel-centre rays
//! along −z from c + (0, 0, 2.2 R) with half-width 0.5 of the image plane at distance 1; in meshes called
//! kitchen or room from c + (0, 0, 0.3 R) with half-width 0.7. A case is called after its mesh.

mod common;

use std::cell::Cell;
use std::fs;
use std::io::Write;
use std::time::Instant;

use glam::DVec3;
use nullray::accel::{Bvh, Facing, Hit, Kernel, Origins, Precision, Ray, Segment, Traversal};

use common::{Camera, Peer, Rounds, TILE, meshes};

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
    rays: &'static str,
    precision: &'static str,
    kernel: &'static str,
    trace: Box<dyn Fn(&Shots) -> usize>,
}

fn measure_mesh(name: &str, triangles: Vec<[DVec3; 3]>, size: &Size, report: &mut fs::File) {
    let triangle_count = triangles.len();
    let (peer, peer_build) = Peer::build(&triangles);
    let begin = Instant::now();
    let bvh = Bvh::build(triangles, |_| Facing::TwoSided);
    let build = begin.elapsed();
    let bytes = bvh.bytes() as f64 / triangle_count as f64;
    println!(
        "{name}: {triangle_count} triangles, {bytes:.1} bytes each, built in {build:.2?} (obvhs alone {peer_build:.2?})"
    );
    let (place, distance, width) = match name {
        "kitchen" | "room" => ("inside", 0.3, 0.7),
        _ => ("outside", 2.2, 0.5),
    };
    let shots = Shots::new(&bvh, distance, width, size.image);
    let cases = cases(bvh, peer);
    let (times, hits) = measure(&cases, &shots, size.rounds);
    for (k, case) in cases.iter().enumerate() {
        let (rays, precision, kernel, hits) =
            (case.rays, case.precision, case.kernel, hits[k].get());
        let count = shots.count(rays);
        let rate = count as f64 / times.best(k) / 1e6;
        let singly = |other: &Case| (other.rays, other.kernel) == (rays, "scalar");
        let single = cases.iter().position(singly).expect("single rays");
        // How often the time of this case goes into that of single rays.
        let ratio = times.ratio(single, k);
        let called = match rays {
            "shared" => name.to_string(),
            other => format!("{name}, {other} rays"),
        };
        println!(
            "  {called}: {precision} {kernel}: {rate:.2} Mrays/s, {ratio} times single rays, {hits} hits"
        );
        let line = serde_json::json!({
            "case": called, "camera": place, "rays": rays, "precision": precision, "kernel": kernel,
            "threads": 1, "mrays_per_s": rate, "hits": hits, "times_single": ratio.middle, "quartiles": ratio.quartiles(),
            "triangles": triangle_count, "ray_count": count,
            "bytes_per_triangle": bytes, "build_s": build.as_secs_f64(),
        });
        writeln!(report, "{line}").expect("report");
    }
}

/// Everything that can trace here.
fn cases(bvh: Bvh, peer: Peer) -> Vec<Case> {
    let bvh = std::rc::Rc::new(bvh);
    let mut cases = Vec::new();
    let mut add = |rays, precision, kernel, trace: Box<dyn Fn(&Shots) -> usize>| {
        cases.push(Case {
            rays,
            precision,
            kernel,
            trace,
        });
    };
    for kernel in Kernel::ALL.into_iter().filter(|k| k.is_supported()) {
        let name = kernel.name();
        for (precision, called) in [
            (Precision::Fast, "fast"),
            (Precision::Certified, "certified"),
        ] {
            if (kernel, precision) != (Kernel::Scalar, Precision::Fast) {
                let method = Traversal { kernel, precision };
                let tree = bvh.clone();
                let trace = move |shots: &Shots| trace_shared(&tree, method, shots);
                add("shared", called, name, Box::new(trace));
                let tree = bvh.clone();
                let trace = move |shots: &Shots| trace_pinhole(&tree, method, shots);
                add("pinhole", called, name, Box::new(trace));
            }
        }
        let (tree, precision) = (bvh.clone(), Precision::Certified);
        let method = Traversal { kernel, precision };
        let trace = move |shots: &Shots| trace_shadows(&tree, method, shots);
        add("shadow", "certified", name, Box::new(trace));
    }
    let trace_peer = move |shots: &Shots| peer.trace(shots.camera.origin, &shots.camera.directions);
    add("shared", "fast", "obvhs", Box::new(trace_peer));
    cases
}

/// The times of the cases, and how many rays hit.
fn measure(cases: &[Case], shots: &Shots, rounds: usize) -> (Rounds, Vec<Cell<usize>>) {
    let hits = vec![Cell::new(0); cases.len()];
    let works = cases.iter().zip(&hits);
    let mut works: Vec<_> = works
        .map(|(case, hits)| || hits.set((case.trace)(shots)))
        .collect();
    let times = Rounds::of(rounds, &mut works);
    for rays in ["shared", "pinhole", "shadow"] {
        let certified = |case: &Case| (case.rays, case.precision) == (rays, "certified");
        let all = cases.iter().zip(&hits).filter(|(case, _)| certified(case));
        let mut counts: Vec<usize> = all.map(|(_, hits)| hits.get()).collect();
        counts.dedup();
        assert_eq!(counts.len(), 1, "certified hits agree: {rays} {counts:?}");
    }
    (times, hits)
}

fn trace_shared(bvh: &Bvh, method: Traversal, shots: &Shots) -> usize {
    let from = |_| Origins::Shared(shots.camera.origin);
    trace_batches(bvh, method, shots, from)
}

fn trace_pinhole(bvh: &Bvh, method: Traversal, shots: &Shots) -> usize {
    let from = |at| Origins::Each(&shots.pinhole[at..]);
    trace_batches(bvh, method, shots, from)
}

fn trace_batches<'a>(
    bvh: &Bvh,
    method: Traversal,
    shots: &Shots,
    from: impl Fn(usize) -> Origins<'a>,
) -> usize {
    let mut hits: [Option<Hit>; TILE * TILE];
    let mut count = 0;
    for (at, tile) in shots.camera.directions.chunks(TILE * TILE).enumerate() {
        hits = [None; TILE * TILE];
        let (from, entries) = (from(at * TILE * TILE), &mut hits[..tile.len()]);
        bvh.closest_by(method, from, tile, entries, None, None);
        std::hint::black_box(&hits);
        count += hits.iter().flatten().count();
    }
    count
}

fn trace_shadows(bvh: &Bvh, method: Traversal, shots: &Shots) -> usize {
    let mut count = 0;
    for segments in &shots.shadows {
        let mut blocked = [false; TILE * TILE];
        let blocked = &mut blocked[..segments.len()];
        bvh.any_by(method, segments, blocked, None);
        count += blocked.iter().filter(|b| **b).count();
    }
    count
}

/// Rays of each kind.
struct Shots {
    camera: Camera,
    /// For each direction where it leaves a pinhole.
    pinhole: Vec<DVec3>,
    /// From what is seen to a lamp, by tiles.
    shadows: Vec<Vec<Segment>>,
}

impl Shots {
    fn new(bvh: &Bvh, distance: f64, half_width: f64, size: usize) -> Shots {
        let camera = Camera::new(bvh, distance, half_width, size);
        let (lo, hi) = bvh.bounds().expect("a mesh");
        let (centre, radius) = ((lo + hi) / 2.0, (hi - lo).length() / 2.0);
        let place = |d: &DVec3| camera.origin + DVec3::new(d.x, d.y, 0.0) * (radius * 1e-3);
        let lamp = centre + DVec3::new(0.5, 0.8, 0.6) * radius;
        let tiles = camera.directions.chunks(TILE * TILE);
        let tiles = tiles.map(|tile| shadows(bvh, camera.origin, tile, lamp));
        Shots {
            pinhole: camera.directions.iter().map(place).collect(),
            shadows: tiles.collect(),
            camera,
        }
    }

    /// How many rays of this kind there are.
    fn count(&self, rays: &str) -> usize {
        match rays {
            "shadow" => self.shadows.iter().map(Vec::len).sum(),
            _ => self.camera.rays(),
        }
    }
}

/// From what is seen along `directions` to `lamp`.
fn shadows(bvh: &Bvh, eye: DVec3, directions: &[DVec3], lamp: DVec3) -> Vec<Segment> {
    let mut hits = vec![None; directions.len()];
    let (method, from) = (Traversal::default(), Origins::Shared(eye));
    bvh.closest_by(method, from, directions, &mut hits, None, None);
    let seen = directions
        .iter()
        .zip(hits)
        .filter_map(|(d, hit)| Some((d, hit?)));
    let shadow = |(d, hit): (&DVec3, Hit)| {
        let origin = eye + *d * hit.s;
        let direction = lamp - origin;
        let ray = Ray {
            origin,
            direction,
            s_min: 1e-12 * origin.length() / direction.length(),
        };
        Segment {
            ray,
            s_max: 1.0,
            skip: Some(hit.triangle),
            end: None,
        }
    };
    seen.map(shadow).collect()
}
