//! Whole frames through the public interface: scene text → plan → prepared scene → film.
//!
//! Every case is rendered several times in turn with two tracings of the same world rays alone: by this crate's
//! certified packets, and by obvhs' own f32 traversal. Rates are the best of each, ratios the medians of rounds with their
//! quartiles, and the time per stage is that of one more rendering, with statistics. One line per case is printed and
//! written as JSON to `target/bench/frame.jsonl`. Lit frames: `scenes/several-velocities.toml` at 1600 × 1000,
//! and `scenes/sodium.toml` with colours and with full spectra. Meshes: every `*.tri` of the folder `NULLRAY_BENCH_MESHES` (and
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
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use glam::DVec3;
use nullray::accel::{Bvh, Kernel};
use nullray::camera::{AnyView, View};
use nullray::render::prepare::Prepared;
use nullray::render::progress::{Progress, Silent};
use nullray::render::render_with_stats;
use nullray::render::trace::Stage;

use common::{Peer, Rounds, TILE, grid, meshes, render_next, trace_tile};
use scene::{Case, Files, Light, Place};

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
        let triangles = scene::split(&scene::split(&triangles));
        bench.mesh(&format!("{name}x16"), &triangles, place, scene::MAIN_CASES);
    }
    bench.several_velocities();
    bench.skies();
    bench.lit();
    bench.spectra();
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
            let eye = prepared.camera.shot.event.x;
            let peer = || peer.trace(eye, &rays);
            let bare = || trace(&prepared.frames[0].bvh, eye, &rays);
            let rivals = Some(Rivals {
                peer: &peer,
                bare: &bare,
            });
            let name = format!("{name}/{}", case.name);
            let one = Way::default();
            self.measure(&name, &prepared, one, rivals);
            if matches!(case.light, Light::Capture) {
                self.captures(
                    &name,
                    &files,
                    &scene::of_mesh(&files, case, place, self.size.image / 2),
                );
            }
            if case.name == scene::HEADLINE {
                let watched = Way {
                    progress: &Count::default(),
                    ..one
                };
                self.measure(&format!("{name}, watched"), &prepared, watched, rivals);
                let two = Way { threads: 2, ..one };
                self.measure(&format!("{name}, two threads"), &prepared, two, None);
                let resting = scene::of_mesh(&files, scene::RESTING, place, self.size.image);
                let resting = files.prepare(&resting);
                self.measure(&format!("{name}, at rest"), &resting, one, None);
                self.motion(&name, &resting, &prepared);
                self.cameras(&name, &prepared, &files, &text);
            }
        }
    }

    /// Frames of half the width from the cube in memory, and from one that is read in bricks.
    fn captures(&mut self, name: &str, files: &Files, text: &str) {
        let bricks = |lacking| files.prepare_in_bricks(text, lacking);
        for (place, scene) in [
            ("from memory", Some(files.prepare(text))),
            ("from bricks", bricks(0.0)),
            ("from bricks, half of which fit", bricks(0.5)),
        ] {
            let Some(scene) = scene else {
                continue;
            };
            let name = format!("{name} {place}, half the width");
            for threads in [1, 2] {
                let way = Way {
                    threads,
                    ..Way::default()
                };
                let name = match threads {
                    1 => name.clone(),
                    _ => format!("{name}, two threads"),
                };
                self.measure(&name, &scene, way, None);
            }
        }
    }

    /// What cameras cost whose rays leave each from its own event, relative to the point camera of
    /// `point`; its scene is `text`.
    fn cameras(&mut self, name: &str, point: &Prepared, files: &Files, text: &str) {
        for camera in scene::CAMERAS {
            let other = files.prepare(&camera.in_place(text));
            let times = self.in_turn([point, &other]);
            let case = format!("{name}, {}", camera.name);
            let (best, ratio) = (times.best(1), times.ratio(1, 0));
            let rate = point.layout.size[0].pow(2) as f64 / best / 1e6;
            println!("{case:<60} {rate:6.2} Mrays/s   {ratio} times the point camera's time");
            let line = serde_json::json!({
                "case": case, "seconds": best, "mrays_per_s": rate, "threads": 1, "times_point": ratio.middle,
                "quartiles": ratio.quartiles(),
            });
            writeln!(self.report, "{line}").expect("report");
        }
    }

    /// What motion costs: `moving` relative to `resting`, which sees the same.
    fn motion(&mut self, name: &str, resting: &Prepared, moving: &Prepared) {
        let times = self.in_turn([resting, moving]);
        let (case, ratio) = (format!("{name}, relative to rest"), times.ratio(1, 0));
        println!("{case:<60} {ratio} times the time at rest");
        let line = serde_json::json!({
            "case": case, "seconds": times.best(1), "seconds_at_rest": times.best(0), "threads": 1,
            "times_at_rest": ratio.middle, "quartiles": ratio.quartiles(),
        });
        writeln!(self.report, "{line}").expect("report");
    }

    /// The times of two scenes that one thread renders in turn.
    fn in_turn(&self, scenes: [&Prepared; 2]) -> Rounds {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1);
        let pool = pool.build().expect("a thread");
        let pool = &pool;
        let frame = |scene| {
            let mut film = None;
            move || pool.install(|| render_next(scene, &mut film, &Silent))
        };
        Rounds::of(2 * self.size.rounds, &mut scenes.map(frame))
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

    /// Views of a panorama or stars alone, and of nothing; in wide ones, most pixels are wider than the panorama's texels.
    fn skies(&mut self) {
        scene::write_panorama(self.folder.path());
        for view in scene::VIEWS {
            for (what, sky) in scene::SKIES {
                let name = format!("sky/0.9c, {}, {what}", view.0);
                if self.chooses(&name) {
                    let text = scene::of_sky(*view, sky, self.size.image);
                    let prepared = Files::none(self.folder.path()).prepare(&text);
                    self.measure(&name, &prepared, Way::default(), None);
                }
            }
        }
    }

    /// A scene whose surfaces reflect the light of lamps, with shadows: bodies at several velocities.
    fn lit(&mut self) {
        let name = "several velocities, lit by lamps";
        if !self.chooses(name) {
            return;
        }
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
        let path = folder.join("several-velocities.toml");
        let text = fs::read_to_string(path).expect("a scene");
        let size = [1600, 1000].map(|n: u32| n.div_ceil(1024 / self.size.image));
        let prepared = Files::none(&folder).prepare_at(&text, size, 4);
        for threads in [1, 2] {
            let way = Way {
                threads,
                ..Way::default()
            };
            let name = format!("{name}, threads: {threads}");
            self.measure(&name, &prepared, way, None);
        }
    }

    /// Balls under a sodium lamp, with colours and with full spectra.
    fn spectra(&mut self) {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
        let text = fs::read_to_string(folder.join("sodium.toml")).expect("a scene");
        for spectra in ["rgb", "sampled"] {
            let name = format!("balls under sodium light, spectra: {spectra}");
            if self.chooses(&name) {
                let text = text.replace("\"sampled\"", &format!("{spectra:?}"));
                let size = [self.size.image, self.size.image / 2];
                let prepared = Files::none(&folder).prepare_at(&text, size, 4);
                self.measure(&name, &prepared, Way::default(), None);
            }
        }
    }

    fn chooses(&self, name: &str) -> bool {
        self.only.as_ref().is_none_or(|only| name.contains(only))
    }

    /// Renders `scene` in a way, in turn with its `rivals`.
    fn measure(
        &mut self,
        case: &str,
        scene: &Prepared,
        Way { threads, progress }: Way,
        rivals: Option<Rivals>,
    ) {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let pool = pool.build().expect("threads");
        let mut film = None;
        let mut frame = || pool.install(|| render_next(scene, &mut film, progress));
        let times = match rivals {
            None => Rounds::of(self.size.rounds, &mut [&mut frame]),
            Some(Rivals { peer, bare }) => {
                let mut bare = || {
                    std::hint::black_box(bare());
                };
                let mut peer = || {
                    std::hint::black_box(peer());
                };
                let works: &mut [&mut dyn FnMut()] = &mut [&mut frame, &mut bare, &mut peer];
                Rounds::of(self.size.rounds, works)
            }
        };
        let best = times.best(0);
        let counted = pool.install(|| render_with_stats(scene, progress));
        let (_, stats) = counted.expect("a film");
        let [width, height] = scene.layout.size.map(u64::from);
        let rays = width * height * scene.layout.samples as u64;
        let rate = rays as f64 / best / 1e6;
        // Rays per time of the frame over those of the other.
        let rate_of = |other: usize| {
            rivals.map(|_| {
                let rate = (width * height) as f64 / times.best(other) / 1e6;
                (rate, times.ratio(other, 0))
            })
        };
        let (bare, peer) = (rate_of(1), rate_of(2));
        print!("{case:<46} {rate:6.2} Mrays/s");
        for (what, other) in [("bare visibility", bare), ("obvhs", peer)] {
            if let Some((rate, ratio)) = other {
                print!("   of {what} ({rate:6.2}) {ratio}");
            }
        }
        println!();
        let per_ray = |stage: &Stage| 1e9 * stats.seconds[*stage as usize] / rays as f64;
        let stages = Stage::ALL.map(|s| format!("{} {:.1}", s.name(), per_ray(&s)));
        println!("    ns per ray: {}", stages.join(", "));
        if stats.disk.all > 0 {
            let [all, again] = [stats.disk.all, stats.disk.again].map(|b| b as f64 / 1e6);
            println!("    {all:.0} MB read from the disk, {again:.0} MB of them again");
        }
        let stages: Vec<f64> = Stage::ALL.iter().map(per_ray).collect();
        let line = serde_json::json!({
            "case": case, "precision": "certified", "kernel": format!("{:?}", Kernel::best()).to_lowercase(),
            "threads": threads, "rays": rays, "hits": stats.hits, "seconds": best, "mrays_per_s": rate,
            "visibility_mrays_per_s": bare.map(|bare| bare.0), "of_visibility": bare.map(|bare| bare.1.middle),
            "of_visibility_quartiles": bare.map(|bare| bare.1.quartiles()),
            "obvhs_mrays_per_s": peer.map(|peer| peer.0), "ratio": peer.map(|peer| peer.1.middle),
            "quartiles": peer.map(|peer| peer.1.quartiles()),
            "stages": Stage::ALL.map(Stage::name), "stage_ns_per_ray": stages, "texture_bytes": stats.texture_bytes,
            "node_visits": stats.visibility.nodes, "triangle_tests": stats.visibility.triangles,
            "f64_fallbacks": stats.visibility.doubts, "exact_fallbacks": stats.visibility.exact,
            "occlusion_rays": stats.occlusion.rays,
        });
        writeln!(self.report, "{line}").expect("report");
    }
}

/// Tracings of the rays of a picture, and nothing else.
#[derive(Clone, Copy)]
struct Rivals<'a> {
    peer: &'a dyn Fn() -> usize,
    bare: &'a dyn Fn() -> usize,
}

/// Certified visibility alone, tile by tile; how many rays hit.
fn trace(bvh: &Bvh, origin: DVec3, directions: &[DVec3]) -> usize {
    let tiles = directions.chunks(TILE * TILE);
    tiles.map(|tile| trace_tile(bvh, origin, tile)).sum()
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

/// The world look directions through all pixel centres, tile by tile.
fn world_directions(scene: &Prepared) -> Vec<DVec3> {
    let look = |(y, x): (usize, usize)| {
        let (x, y) = (x as f64 + 0.5, y as f64 + 0.5);
        match &scene.camera.view {
            AnyView::Still(view) => view.ray(x, y, 0.0).d.unit(),
            AnyView::Moving(view) => view.ray(x, y, 0.0).d.unit(),
            other => panic!("the peer has no {:?} camera", other.kind()),
        }
    };
    let tiles = grid(scene.layout.size[0] as usize / TILE);
    tiles
        .flat_map(|(v, u)| grid(TILE).map(move |(y, x)| (v * TILE + y, u * TILE + x)))
        .map(look)
        .collect()
}
