//! Trials of a share of what is baked.

use nullray::render::bake::{Bins, Coordinates, Surface, Trial, Trials};
use nullray::render::progress::Silent;
use nullray::scene::model::Scene;

use super::{CORNER, camera_cube, prepared, surface_cube};
use crate::pipeline::stage;

/// A trial of the corner's surface of this size, or of its camera, with so many samples.
fn trial(scene: &Scene, size: Option<[u32; 2]>, bins: &Bins, samples: u32) -> Trial {
    let prepared = prepared(scene);
    let trials = match size {
        None => Trials::of_camera(scene, &prepared, bins),
        Some(size) => {
            let surface = Surface {
                object: 0,
                coordinates: Coordinates::Set(0),
                size,
            };
            Trials::of_surface(scene, &prepared, &surface, bins)
        }
    };
    let trials = trials.unwrap();
    let trial = trials.run(samples, &Silent).unwrap();
    let [columns, rows] = size.unwrap_or(scene.camera.size);
    let all = f64::from(columns) * f64::from(rows);
    assert_eq!(trials.texels() as f64, trial.share * all);
    trial
}

#[test]
fn a_trial_has_the_error_of_the_whole() {
    let mut scene = stage::scene(CORNER);
    let bins = Bins {
        start: 1.75,
        width: 0.5,
        count: 12,
    };
    let arriving = Bins { start: 7.0, ..bins };
    for samples in [16, 64] {
        scene.samples_per_pixel = samples;
        // A texel's error is known to 1/√2 of itself from two parts. Of 1,000 texels with light in a few bins each, whose errors differ, it is known
        // to a few per cent, and of 8 of 16 tiles to the difference between them.
        let baked = surface_cube(&scene, 0, [64, 128], &bins).unwrap();
        let tried = trial(&scene, Some([64, 128]), &bins, samples);
        assert_eq!(tried.share, 1.0 / 8.0);
        let ratio = tried.relative_error / baked.relative_error();
        assert!((ratio - 1.0).abs() < 0.15, "{samples}: {ratio}");
        let baked = camera_cube(&scene, &arriving).unwrap();
        let tried = trial(&scene, None, &arriving, samples);
        assert_eq!(tried.share, 0.5);
        let ratio = tried.relative_error / baked.relative_error();
        assert!((ratio - 1.0).abs() < 0.3, "camera, {samples}: {ratio}");
    }
}

#[test]
fn a_trial_of_all_texels_has_numbers_of_its_own_on_any_number_of_threads() {
    let mut scene = stage::scene(CORNER);
    scene.samples_per_pixel = 16;
    let bins = Bins {
        start: 1.75,
        width: 0.5,
        count: 12,
    };
    let size = [24, 40];
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let work = || trial(&scene, Some(size), &bins, 16);
        pool.build().unwrap().install(work)
    };
    let (one, three) = (on(1), on(3));
    assert_eq!(one, three);
    assert_eq!(one.share, 1.0);
    // The bake's error is estimated from other random numbers: close, and not the same.
    let baked = surface_cube(&scene, 0, size, &bins).unwrap();
    let ratio = one.relative_error / baked.relative_error();
    assert!((ratio - 1.0).abs() < 0.15 && ratio != 1.0, "{ratio}");
}
