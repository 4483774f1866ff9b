//! Look directions and light paths through boosts: nanoseconds per ray, one thread.
//!
//! `direction`: camera look directions to the world, with their wavelength ratios; `tangent`: world look
//! directions into a rest frame; `look`: whole look directions of a camera by pixel, as pictures take them. Each
//! at rest and moving, in turn, best of several rounds. JSON lines in `target/bench/boost.jsonl`: fields
//! `case`, `rays`, `ns_per_ray`, `mrays_per_s`, `times_rest` (the median of rounds) and its `quartiles`. `--smoke` and `NULLRAY_BENCH_SMOKE=1` use tiny sizes.

mod common;

use std::hint::black_box;

use glam::DVec3;
use nullray::camera::{AnyView, View};
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;
use nullray::render::progress::Silent;
use nullray::scene::{Overrides, parse};
use nullray::spacetime::{Boost, CameraFrame, Direction, Rest, Velocity, World};

use common::{Rounds, grid, report, report_file};

/// Names and velocities: at rest, slow, fast, and at the largest that pictures stand in any direction.
fn velocities() -> Vec<(&'static str, Velocity)> {
    let oblique = DVec3::new(0.6, -0.3, -0.8);
    let gamma = |gamma| Velocity::from_gamma(gamma, oblique).expect("a velocity");
    let beta = |beta| Velocity::from_beta(oblique.normalize() * beta).expect("a velocity");
    vec![
        ("rest", Velocity::REST),
        ("0.1 c", beta(0.1)),
        ("0.9 c", beta(0.9)),
        ("gamma 1e6", gamma(1e6)),
        ("gamma 1e12", gamma(1e12)),
    ]
}

/// What is measured at each velocity.
type Work = Box<dyn Fn()>;

fn main() {
    let smoke = common::is_smoke();
    let (image, rounds) = if smoke { (32, 1) } else { (1024, 9) };
    let mut file = report_file("boost");
    for (what, of) in [
        ("direction", direction as fn(usize, Velocity) -> Work),
        ("tangent", tangent),
        ("look", look),
    ] {
        let works = velocities()
            .into_iter()
            .map(|(name, v)| (name, of(image, v)));
        let works: Vec<_> = works.collect();
        let mut timed: Vec<_> = works.iter().map(|(_, work)| work).collect();
        let times = Rounds::of(rounds, &mut timed);
        let rays = image * image;
        for (k, (name, _)) in works.iter().enumerate() {
            let (seconds, ratio) = (times.best(k), times.ratio(k, 0));
            let line = serde_json::json!({
                "case": format!("{what}, {name}"), "threads": 1, "rays": rays,
                "ns_per_ray": seconds * 1e9 / rays as f64, "mrays_per_s": rays as f64 / seconds / 1e6,
                "times_rest": ratio.middle, "quartiles": ratio.quartiles(),
            });
            report(&mut file, &line);
        }
    }
}

/// Look directions of an image of 60°.
fn directions(image: usize) -> Vec<DVec3> {
    let at = |i: usize| ((i as f64 + 0.5) / image as f64 - 0.5) * 1.1547;
    let direction = |(y, x)| DVec3::new(at(x), -at(y), -1.0).normalize();
    grid(image).map(direction).collect()
}

/// Camera → world, into arrays, as pictures do.
fn direction(image: usize, velocity: Velocity) -> Work {
    let directions = directions(image);
    let directions = directions
        .into_iter()
        .filter_map(Direction::<CameraFrame>::new);
    let directions: Vec<_> = directions.collect();
    let boost = Boost::<World, CameraFrame>::new(velocity);
    Box::new(move || {
        let mut out = Vec::with_capacity(256);
        for tile in directions.chunks(256) {
            out.clear();
            out.extend(tile.iter().map(|&d| boost.direction(d)));
            black_box(&out);
        }
    })
}

/// World → rest frame.
fn tangent(image: usize, velocity: Velocity) -> Work {
    let directions = directions(image);
    let directions = directions.into_iter().filter_map(Direction::<World>::new);
    let directions: Vec<_> = directions.collect();
    let boost = Boost::<World, Rest>::new(velocity).inverse();
    Box::new(move || {
        let mut out = Vec::with_capacity(256);
        for tile in directions.chunks(256) {
            out.clear();
            out.extend(tile.iter().map(|&d| boost.tangent_and_ratio(1.0, d)));
            black_box(&out);
        }
    })
}

/// Pixels → world.
fn look(image: usize, velocity: Velocity) -> Work {
    let [x, y, z] = velocity.rapidity().to_array();
    let text = format!(
        "camera = {{ eye = [0, 0, 3], look_at = [0, 0, 0], size = [{image}, {image}], velocity = {{ rapidity = [{x:e}, {y:e}, {z:e}] }} }}\n\
         object = [{{ shape = {{ plane = {{ size = [1, 1] }} }} }}]\n"
    );
    let scene = parse(&text, "benchmark", ".".as_ref(), &Overrides::default()).expect("a scene");
    let plan = Plan::new(&scene, &Request::default()).expect("a plan");
    let view = Prepared::new(&scene, &plan, &Silent)
        .expect("a scene")
        .camera
        .view;
    Box::new(move || match &view {
        AnyView::Still(view) => look_all(view, image),
        AnyView::Moving(view) => look_all(view, image),
        other => panic!("not a {:?} camera", other.kind()),
    })
}

fn look_all(view: &impl View, image: usize) {
    let mut out = Vec::with_capacity(256);
    for row in 0..image {
        for columns in (0..image).step_by(256) {
            out.clear();
            let last = image.min(columns + 256);
            out.extend((columns..last).map(|x| view.ray(x as f64 + 0.5, row as f64 + 0.5, 0.0)));
            black_box(&out);
        }
    }
}
