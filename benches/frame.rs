//! Whole frames through the public interface: scene text → plan → prepared scene → film.
//!
//! Every case is rendered several times in turn with obvhs' own f32 traversal of the same mesh along the
//! same world rays; the best of each counts. One line per case is printed and written as JSON to
//! `target/bench/frame.jsonl`. Meshes: every `*.tri` of the folder `NULLRAY_BENCH_MESHES` (and
//! nefertiti, or else the last, at sixteen times its triangles), else generated ones. A first argument that is no flag
//! selects cases that contain it. `--smoke`, `NULLRAY_BENCH_SMOKE=1` and `cargo test --benches` use
//! tiny sizes.
//!
//! The camera stands as in `visibility` and looks along −z: from c + (0, 0, 2.2 R) with half-width 0.5, or
//! inside from c + (0, 0, 0.3 R) with 0.7. A moving one approaches at 0.9 c with a field of view
//! that aberration opens to the same half-angle in the world: both look at the same.

mod common;

#[path = "frame/scene.rs"]
mod scene;

use std::fs;
use std::io::Write;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Instant;

use glam::DVec3;
use nullray::camera::{AnyView, View};
use nullray::prepare::Prepared;
use nullray::progress::{Progress, Silent};
use nullray::render::render;

use common::{Peer, grid, meshes};
use scene::{Case, Files, Place};

struct Size {
    image: u32,
    rounds: usize,
    detail: usize,
    cube: [usize; 3],
}

fn main() {
    let smoke = common::is_smoke();
    let size = match smoke {
        true => Size {
            image: 32,
            rounds: 1,
            detail: 12,
            cube: [8, 8, 8],
        },
        false => Size {
            image: 1024,
            rounds: 5,
            detail: 256,
            cube: [256, 256, 64],
        },
    };
    let only = std::env::args().skip(1).find(|a| !a.starts_with('-'));
    let mut bench = Bench {
        report: common::report_file("frame"),
        folder: tempfile::tempdir().expect("a temporary folder"),
        only,
        size,
    };
    let mut to_split: Option<(String, Vec<[DVec3; 3]>, Place)> = None;
    for (name, triangles) in meshes(smoke, bench.size.detail) {
        let place = Place::of(&name);
        bench.mesh(&name, &triangles, place, scene::CASES);
        if to_split
            .as_ref()
            .is_none_or(|(name, ..)| name != "nefertiti")
        {
            to_split = Some((name, triangles, place));
        }
    }
    if let (Some((name, triangles, place)), false) = (to_split, smoke) {
        let triangles = split(&split(&triangles));
        bench.mesh(&format!("{name}x16"), &triangles, place, scene::MAIN_CASES);
    }
    bench.several_velocities();
}

/// Each triangle in four, by the midpoints of its edges.
fn split(triangles: &[[DVec3; 3]]) -> Vec<[DVec3; 3]> {
    let four = |&[a, b, c]: &[DVec3; 3]| {
        let [ab, bc, ca] = [a.midpoint(b), b.midpoint(c), c.midpoint(a)];
        [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
    };
    triangles.iter().flat_map(four).collect()
}

struct Bench {
    report: fs::File,
    folder: tempfile::TempDir,
    only: Option<String>,
    size: Size,
}

impl Bench {
    fn mesh(&mut self, name: &str, triangles: &[[DVec3; 3]], place: Place, cases: &[Case]) {
        let chosen = |case: &&Case| self.chooses(&format!("{name}/{}", case.name));
        let cases: Vec<_> = cases.iter().filter(chosen).collect();
        if cases.is_empty() {
            return;
        }
        let files = Files::write(self.folder.path(), triangles, self.size.cube);
        let (peer, _) = Peer::build(triangles);
        for case in cases {
            let text = scene::of_mesh(&files, case, place, self.size.image);
            let prepared = files.prepare(&text);
            let rays = world_directions(&prepared);
            let peer = || peer.trace(prepared.camera.shot.event.x, &rays);
            let name = format!("{name}/{}", case.name);
            let one = Way::default();
            self.measure(&name, &prepared, one, Some(&peer));
            if case.name == scene::HEADLINE {
                let watched = Way {
                    progress: &Count::default(),
                    ..one
                };
                self.measure(&format!("{name}, watched"), &prepared, watched, Some(&peer));
                let two = Way { threads: 2, ..one };
                self.measure(&format!("{name}, two threads"), &prepared, two, None);
            }
        }
    }

    fn several_velocities(&mut self) {
        for frames in [1, 4, 16] {
            let name = format!("spheres/{frames} rest frames");
            if self.chooses(&name) {
                let text = scene::spheres(frames, self.size.image);
                let prepared = Files::none(self.folder.path()).prepare(&text);
                self.measure(&name, &prepared, Way::default(), None);
            }
        }
    }

    fn chooses(&self, name: &str) -> bool {
        self.only.as_ref().is_none_or(|only| name.contains(only))
    }

    /// Renders `scene` in a way and lets `peer` trace its rays in turn.
    fn measure(
        &mut self,
        case: &str,
        scene: &Prepared,
        Way { threads, progress }: Way,
        peer: Option<&dyn Fn() -> usize>,
    ) {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let pool = pool.build().expect("threads");
        let (mut best, mut best_peer) = (f64::INFINITY, f64::INFINITY);
        for _ in 0..self.size.rounds {
            best = best.min(seconds(|| pool.install(|| render(scene, progress).is_ok())));
            if let Some(peer) = peer {
                best_peer = best_peer.min(seconds(peer));
            }
        }
        let [width, height] = scene.layout.size.map(u64::from);
        let rays = width * height * scene.layout.samples as u64;
        let rate = rays as f64 / best / 1e6;
        let peer_rate = peer.map(|_| (width * height) as f64 / best_peer / 1e6);
        let ratio = peer_rate.map(|peer| rate / peer);
        print!("{case:<46} {rate:6.2} Mrays/s");
        if let (Some(peer), Some(ratio)) = (peer_rate, ratio) {
            print!("   obvhs {peer:6.2}   ratio {ratio:.2}");
        }
        println!();
        let line = serde_json::json!({
            "case": case, "rays": rays, "seconds": best, "mrays_per_s": rate, "threads": threads,
            "obvhs_mrays_per_s": peer_rate, "ratio": ratio,
        });
        writeln!(self.report, "{line}").expect("report");
    }
}

/// How a scene is rendered.
#[derive(Clone, Copy)]
struct Way<'a> {
    threads: usize,
    progress: &'a dyn Progress,
}

impl Default for Way<'_> {
    fn default() -> Self {
        Way {
            threads: 1,
            progress: &Silent,
        }
    }
}

/// Watches as a caller would: counts rays, and can be told to stop.
#[derive(Default)]
struct Count {
    rays: AtomicU64,
    stop: AtomicBool,
}

impl Progress for Count {
    fn rays_done(&self, rays: u64) {
        self.rays.fetch_add(rays, Ordering::Relaxed);
    }

    fn is_cancelled(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

fn seconds<T>(work: impl FnOnce() -> T) -> f64 {
    let begin = Instant::now();
    std::hint::black_box(work());
    begin.elapsed().as_secs_f64()
}

/// The world look directions through all pixel centres, in tiles of 8 × 8.
fn world_directions(scene: &Prepared) -> Vec<DVec3> {
    const TILE: usize = 8;
    let look = |(y, x): (usize, usize)| {
        let (x, y) = (x as f64 + 0.5, y as f64 + 0.5);
        match &scene.camera.view {
            AnyView::Still(view) => view.look(x, y, 0.0).d.unit(),
            AnyView::Moving(view) => view.look(x, y, 0.0).d.unit(),
            other => panic!("the peer has no {:?} camera", other.kind()),
        }
    };
    let tiles = grid(scene.layout.size[0] as usize / TILE);
    tiles
        .flat_map(|(v, u)| grid(TILE).map(move |(y, x)| (v * TILE + y, u * TILE + x)))
        .map(look)
        .collect()
}
