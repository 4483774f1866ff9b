//! How cost grows: with triangles, threads, rest frames and resolution.
//!
//! `triangles`: closest hits of a fixed 1024² image of spheres of 10³ to 10⁷ triangles; `rest frames`: whole pictures of
//! a thousand balls at 1 to 1000 velocities; `resolution`: whole pictures of 16 balls, 0.1 to 67 megapixels; `whole process`: the
//! program's `render` of models of 10⁴ to 10⁷ triangles, from start to end: it reads the file, builds, traces a picture of 1024² at 0.9 c and writes
//! it. Each by one and by two threads, in turn, best of several rounds. JSON lines in `target/bench/scaling.jsonl`: fields `case`,
//! `of`, `value`, `threads`, `seconds`, `mrays_per_s`, `times_one_thread` (the speed-up, the median of rounds) and its `quartiles`. A first
//! argument that is no flag selects cases that contain it. `--smoke` and `NULLRAY_BENCH_SMOKE=1` use tiny sizes.

mod common;

#[path = "frame/scene.rs"]
#[allow(dead_code)]
mod scene;

use std::process::Command;

use glam::DVec3;
use nullray::accel::{Bvh, Facing};
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;
use nullray::render::progress::Silent;
use nullray::render::render;
use nullray::scene::{Overrides, parse};
use rayon::prelude::*;

use common::{Camera, Rounds, TILE, report, report_file, sphere, trace_tile};
use scene::{Case, Files, Light, Place};

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
        let images: &[usize] = match smoke {
            true => &[16, 32, 64, 128],
            false => &[316, 512, 1024, 2048, 4096, 8192],
        };
        for &image in images {
            bench.picture("resolution", image, &balls_scene(16, 4, image));
        }
    }
    if chosen("whole process") {
        let (sizes, image): (&[usize], _) = match smoke {
            true => (&[18], 32),
            false => (&[58, 182, 578, 1826], 1024),
        };
        bench.whole_process(sizes, image);
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

    /// The program renders spheres of 3 n² triangles.
    fn whole_process(&mut self, sizes: &[usize], image: usize) {
        let folder = tempfile::tempdir().expect("a temporary folder");
        for &n in sizes {
            let mesh = sphere(n);
            let files = Files::write(folder.path(), &mesh, [1; 3]);
            let case = Case {
                name: "",
                moving: true,
                light: Light::Base,
            };
            let text = scene::of_mesh(&files, &case, Place::of(""), image as u32);
            std::fs::write(folder.path().join("scene.toml"), text).expect("a scene");
            let render = |threads: usize| {
                let mut program = Command::new(env!("CARGO_BIN_EXE_nullray"));
                program.current_dir(&folder).args(["render", "scene.toml"]);
                program.args(["-o", "picture.png", "--threads", &threads.to_string()]);
                let done = program.output().expect("the program");
                assert!(done.status.success(), "{done:?}");
            };
            let count = mesh.len();
            self.measure_by("whole process", count, image * image, render);
        }
    }

    /// `work` by one and by two threads.
    fn measure(&mut self, of: &str, value: usize, rays: usize, work: impl Fn() + Sync) {
        let pools = [1, 2].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            pool.build().expect("threads")
        });
        self.measure_by(of, value, rays, |threads| pools[threads - 1].install(&work));
    }

    /// The same of work that is told how many threads it has.
    fn measure_by(&mut self, of: &str, value: usize, rays: usize, work: impl Fn(usize)) {
        let work = &work;
        let times = Rounds::of(
            self.rounds,
            &mut [1, 2].map(|threads| move || work(threads)),
        );
        for threads in [1, 2] {
            let (seconds, ratio) = (times.best(threads - 1), times.ratio(0, threads - 1));
            let line = serde_json::json!({
                "case": format!("{value} {of}, {threads} threads"), "of": of, "value": value, "threads": threads,
                "rays": rays, "seconds": seconds, "mrays_per_s": rays as f64 / seconds / 1e6,
                "times_one_thread": ratio.middle, "quartiles": ratio.quartiles(),
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
