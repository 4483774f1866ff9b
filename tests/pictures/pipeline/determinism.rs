//! The film's bits do not depend on the number of threads.

use std::path::Path;

use nullray::render::aov::Aov;
use nullray::render::film::Film;
use nullray::render::plan::Request;
use nullray::scene::{self, Overrides};

use crate::pipeline::stage;

/// Those of all channels, too.
fn bits(film: &Film) -> Vec<u64> {
    let aovs = Aov::ALL.iter().flat_map(|aov| film.aov(*aov).unwrap());
    let radiance = film.radiance().iter().flatten();
    radiance.chain(aovs).map(|v| v.to_bits()).collect()
}

fn film_on(threads: usize, scene: &scene::model::Scene) -> Vec<u64> {
    // With the standard error, and so in parts.
    let request = Request {
        pixel_centers: false,
        ..stage::centred()
    };
    stage::on(threads, || bits(&stage::rendered(scene, &request).unwrap()))
}

fn same_on_any_number_of_threads(file: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("scenes")
        .join(file);
    let mut scene = scene::load(&path, &Overrides::default()).unwrap();
    // Not a multiple of the tiles' size.
    scene.camera.size = [50, 35];
    for samples in [1, 5, 16] {
        scene.samples_per_pixel = samples;
        let alone = film_on(1, &scene);
        for threads in [2, 3, 7] {
            let film = film_on(threads, &scene);
            assert!(
                film == alone,
                "{file}: {samples} samples, {threads} threads"
            );
        }
    }
}

#[test]
fn a_pulse_and_a_moving_camera_are_the_same_on_any_number_of_threads() {
    same_on_any_number_of_threads("cube/approaching-0.9.toml");
}

#[test]
fn a_projected_capture_is_the_same_on_any_number_of_threads() {
    same_on_any_number_of_threads("capture.toml");
}

#[test]
fn several_rest_frames_are_the_same_on_any_number_of_threads() {
    same_on_any_number_of_threads("several-velocities.toml");
}

#[test]
fn a_cube_on_texture_coordinates_is_the_same_on_any_number_of_threads() {
    same_on_any_number_of_threads("corner.toml");
}
