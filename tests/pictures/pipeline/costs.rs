//! The statistics of a picture, and how a preview may differ.

use nullray::accel::Precision;
use nullray::render::film::Film;
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;
use nullray::render::progress::Silent;
use nullray::render::trace::Stats;
use nullray::render::{render, render_with_stats};
use nullray::scene::{self, Overrides};

use crate::pipeline::stage::{self, bits, on};

fn prepared(file: &str, precision: Precision) -> Prepared {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let mut scene = scene::load(&folder.join(file), &Overrides::default()).unwrap();
    // Not a multiple of the tiles' size.
    scene.camera.size = [50, 35];
    scene.samples_per_pixel = 3;
    let request = Request {
        precision,
        ..stage::sampled()
    };
    let plan = Plan::new(&scene, &request).unwrap();
    Prepared::new(&scene, &plan, &Silent).unwrap()
}

/// The counts without the times.
fn counts(mut stats: Stats) -> Stats {
    stats.seconds = Default::default();
    stats
}

#[test]
fn pictures_and_counts_are_the_same_on_any_number_of_threads() {
    for file in ["capture.toml", "corner.toml", "cube/approaching-0.9.toml"] {
        let scene = prepared(file, Precision::Certified);
        let expected = bits(&render(&scene, &Silent).unwrap());
        let (_, alone) = on(1, || render_with_stats(&scene, &Silent).unwrap());
        let alone = counts(alone);
        for threads in [1, 2, 3] {
            let plain = on(threads, || render(&scene, &Silent).unwrap());
            let (counted, stats) = on(threads, || render_with_stats(&scene, &Silent).unwrap());
            assert_eq!(bits(&plain), expected, "{file}, {threads} threads");
            assert_eq!(
                bits(&counted),
                expected,
                "{file}, {threads} threads, counted"
            );
            assert_eq!(counts(stats), alone, "{file}, {threads} threads");
        }
    }
}

#[test]
fn every_camera_ray_is_counted_once_and_those_that_meet_something() {
    let scene = prepared("corner.toml", Precision::Certified);
    let (film, stats) = render_with_stats(&scene, &Silent).unwrap();
    assert_eq!(stats.rays, 50 * 35 * 3);
    let met = stats.hits as f64 / stats.rays as f64;
    assert!((film.met() - met).abs() < 1e-12, "{} {met}", film.met());
}

#[test]
fn time_data_that_nobody_looks_up_are_not_read() {
    let bytes = |file| {
        let scene = prepared(file, Precision::Certified);
        render_with_stats(&scene, &Silent).unwrap().1.texture_bytes
    };
    assert!(bytes("corner.toml") > 0);
    assert_eq!(bytes("cube/approaching-0.9.toml"), 0);
}

#[test]
fn a_preview_shows_nearly_the_same() {
    let certified = render(&prepared("corner.toml", Precision::Certified), &Silent).unwrap();
    let fast = render(&prepared("corner.toml", Precision::Fast), &Silent).unwrap();
    assert_eq!(fast.precision(), Precision::Fast);
    let sum = |film: &Film| film.radiance().iter().flatten().sum::<f64>();
    let (certified, fast) = (sum(&certified), sum(&fast));
    assert!(
        (certified - fast).abs() < 1e-3 * certified,
        "{certified} {fast}"
    );
    assert_ne!(certified, fast);
}
