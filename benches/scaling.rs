//! How cost grows: with triangles, threads, rest frames and resolution.
//!
//! `triangles`: closest hits of a fixed 1024² image of spheres of 10³ to 10⁷ triangles; `rest frames`: whole pictures of
//! a thousand balls at 1 to 1000 velocities; `resolution`: whole pictures of 16 balls. Each by one
//! and by two threads, in turn, best of several rounds. JSON lines in `target/bench/scaling.jsonl`: fields `case`,
//! `of`, `value`, `threads`, `seconds`, `mrays_per_s`, `times_one_thread`. A first argument that is no flag selects
//! cases that contain it. `--smoke` and `NULLRAY_BENCH_SMOKE=1` use tiny sizes.

mod common;

use glam::DVec3;
use nullray::accel::{Bvh, Facing};
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;
use nullray::render::progress::Silent;
use nullray::render::render;
use nullray::scene::{Overrides, parse};
use rayon::prelude::*;

use common::{Camera, TILE, on_threads, report, report_file, sphere, trace_tile};

fn main() {
    let smoke = common::is_smoke();
    let only = std::env::args().skip(1).find(|a| !a.starts_with('-'));
    let chosen = |what: &str| {
        only.as_ref()
            .is_none_or(|only| what.contains(only.as_str()))
    };
    let mut bench = Bench {
        file: report_file("scaling"),
        rounds: if smoke { 1 } else { 5 },
    };
    if chosen("triangles") {
        bench.triangles(
            if smoke {
                &[18, 60]
            } else {
                &[18, 58, 182, 578, 1826]
            },
            if smoke { 32 } else { 1024 },
        );
    }
    if chosen("rest frames") {
        let (frames, balls, image): (&[usize], _, _) = match smoke {
            true => (&[1, 3], 4, 32),
            false => (&[1, 3, 10, 30, 100, 300, 1000], 1000, 256),
        };
        for &frames in frames {
            bench.picture("rest frames", frames, &balls_scene(balls, frames, image));
        }
    }
    if chosen("resolution") {
        for image in if smoke {
            [16, 32, 64, 128]
        } else {
            [256, 512, 1024, 2048]
        } {
            bench.picture("resolution", image, &balls_scene(16, 4, image));
        }
    }
}

struct Bench {
    file: std::fs::File,
    rounds: usize,
}

impl Bench {
    /// Spheres of 3 n² triangles.
    fn triangles(&mut self, sizes: &[usize], image: usize) {
        for &n in sizes {
            let mesh = sphere(n);
            let count = mesh.len();
            let bvh = Bvh::build(mesh, |_| Facing::TwoSided);
            let camera = Camera::new(&bvh, 2.2, 0.5, image);
            self.measure("triangles", count, camera.rays(), || trace(&bvh, &camera));
        }
    }

    fn picture(&mut self, of: &str, value: usize, text: &str) {
        let scene = parse(text, "benchmark", ".".as_ref(), &Overrides::default()).expect("a scene");
        let plan = Plan::new(&scene, &Request::default()).expect("a plan");
        let prepared = Prepared::new(&scene, &plan, &Silent).expect("a scene");
        let [width, height] = prepared.layout.size;
        let rays = (width * height) as usize;
        self.measure(of, value, rays, || {
            assert!(render(&prepared, &Silent).is_ok())
        });
    }

    /// `work` by one and by two threads.
    fn measure(&mut self, of: &str, value: usize, rays: usize, work: impl Fn() + Sync) {
        let mut best = [f64::INFINITY; 2];
        for _ in 0..self.rounds {
            for threads in [1, 2] {
                let seconds = on_threads(threads, || common::best_of(1, &work));
                best[threads - 1] = best[threads - 1].min(seconds);
            }
        }
        for (threads, seconds) in (1..).zip(best) {
            let line = serde_json::json!({
                "case": format!("{value} {of}, {threads} threads"), "of": of, "value": value, "threads": threads,
                "rays": rays, "seconds": seconds, "mrays_per_s": rays as f64 / seconds / 1e6,
                "times_one_thread": best[0] / seconds,
            });
            report(&mut self.file, &line);
        }
    }
}

fn trace(bvh: &Bvh, camera: &Camera) {
    camera.directions.par_chunks(TILE * TILE).for_each(|tile| {
        trace_tile(bvh, camera.origin, tile);
    });
}

/// Balls of 320 triangles in a square before the camera, at as many velocities as `frames` says.
fn balls_scene(balls: usize, frames: usize, image: usize) -> String {
    let side = (balls as f64).sqrt().ceil();
    let mut text = format!(
        "display = {{ samples_per_pixel = 1 }}\n\
         camera = {{ eye = [0, 0, 8], look_at = [0, 0, 0], hfov = \"53 deg\", size = [{image}, {image}] }}\n"
    );
    for i in 0..balls {
        let at = |k: f64| (k + 0.5) / side * 7.0 - 3.5;
        let place = DVec3::new(at((i as f64) % side), at((i as f64 / side).floor()), 0.0);
        let beta = 0.8 * (i % frames + 1) as f64 / frames as f64;
        text += &format!(
            "[[object]]\nshape = {{ sphere = {{ radius = {}, subdivisions = 2 }} }}\n\
             velocity = {{ beta = [0, {beta}, 0] }}\norigin = {{ position = [{}, {}, 0], time = \"-8.5 m\" }}\n",
            2.8 / side,
            place.x,
            place.y
        );
    }
    text
}
