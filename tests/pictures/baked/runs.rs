//! Bakes on any number of threads, stopped and resumed, and the errors that they give.

use std::sync::Arc;

use nullray::io::cube::CubeSamples;
use nullray::mesh::{Shape, shapes};
use nullray::render::bake::{self, Baked, Bins, Coordinates, CubePrecision, Surface};
use nullray::render::progress::Silent;
use nullray::scene::model::Geometry;

use super::{CORNER, camera_cube, prepared, surface_cube, value};
use crate::pipeline::stage;

#[test]
fn baked_light_is_the_same_on_any_number_of_threads() {
    let mut scene = stage::scene(CORNER);
    scene.camera.size = [24, 18];
    let bins = Bins {
        start: 7.0,
        width: 0.2,
        count: 50,
    };
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let bake = || {
            let camera = camera_cube(&scene, &bins).unwrap();
            let surface = surface_cube(&scene, 0, [33, 121], &bins).unwrap();
            (camera.cube.samples, camera.energy, surface.cube.samples)
        };
        pool.build().unwrap().install(bake)
    };
    let (one, three) = (on(1), on(3));
    assert_eq!(one.1, three.1);
    let values = |samples: CubeSamples| match samples {
        CubeSamples::F32(values) => values,
        _ => Vec::new(),
    };
    let all = |(a, _, b)| [values(a), values(b)].concat();
    let (one, three) = (all(one), all(three));
    assert!(!one.is_empty() && one == three);
}

#[test]
fn the_standard_error_of_a_bin_is_how_much_bakes_of_other_seeds_differ() {
    // 24 bakes of one scene: their variance, bin by bin as the mean over texels, is known to √(2/23)/√(some hundred texels), 3 %, and less in the
    // sum over bins. 15 % off by chance in less than 1 of 10⁶ cases.
    let bins = Bins {
        start: 7.0,
        width: 0.5,
        count: 12,
    };
    let mut scene = stage::scene(CORNER);
    scene.camera.size = [24, 18];
    let bake = |camera: bool| -> Vec<Baked> {
        let one = |seed: u32| {
            let mut scene = scene.clone();
            scene.seed = seed;
            match camera {
                true => camera_cube(&scene, &bins).unwrap(),
                false => surface_cube(
                    &scene,
                    0,
                    [33, 121],
                    &Bins {
                        start: 1.75,
                        ..bins
                    },
                )
                .unwrap(),
            }
        };
        (0..24).map(one).collect()
    };
    for camera in [true, false] {
        let baked = bake(camera);
        let [h, w, t, _] = baked[0].cube.shape;
        let n = baked.len() as f64;
        let (mut said, mut found) = (0.0, 0.0);
        for bin in 0..t {
            said += baked
                .iter()
                .map(|b| b.standard_error[bin].powi(2))
                .sum::<f64>()
                / n;
            let mut texels = 0.0;
            let mut sum = 0.0;
            for texel in 0..h * w {
                let values: Vec<f64> = baked.iter().map(|b| value(&b.cube, texel, bin)).collect();
                let mean = values.iter().sum::<f64>() / n;
                sum += values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
                texels += 1.0;
            }
            found += sum / texels;
        }
        // A camera's pixels are all of its texels; of a surface those off its charts, and in gutters, are not.
        match camera {
            true => stage::assert_relative(said, found, 0.15, "camera"),
            false => assert!(said > found && said < 2.0 * found, "{said} {found}"),
        }
    }
}

#[test]
fn a_bake_that_is_taken_up_again_has_the_bits_of_one_that_was_not_stopped() {
    use std::sync::atomic::{AtomicU64, Ordering};

    use nullray::render::journal::Journal;
    use nullray::render::progress::Progress;

    /// Stops after so many rays.
    struct Until(AtomicU64, u64);
    impl Progress for Until {
        fn rays_done(&self, rays: u64) {
            self.0.fetch_add(rays, Ordering::Relaxed);
        }
        fn is_cancelled(&self) -> bool {
            self.0.load(Ordering::Relaxed) >= self.1
        }
    }

    let mut scene = stage::scene(CORNER);
    scene.camera.size = [40, 36];
    let bins = Bins {
        start: 7.0,
        width: 0.2,
        count: 50,
    };
    let prepared = prepared(&scene);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("parts");
    let surface = Surface {
        object: 0,
        coordinates: Coordinates::Set(0),
        size: [33, 121],
    };
    for camera in [true, false] {
        let bake = |journal: Option<&Journal>, progress: &dyn Progress| match camera {
            true => bake::camera_cube(
                &scene,
                &prepared,
                &bins,
                CubePrecision::Single,
                journal,
                progress,
            ),
            false => bake::surface_cube(
                &scene,
                &prepared,
                &surface,
                &bins,
                CubePrecision::Single,
                journal,
                progress,
            ),
        };
        let whole = bake(None, &Silent).unwrap();
        let mut found = Vec::new();
        for rays in [4000, 12_000, u64::MAX] {
            let journal = Journal::open(&path, &[3; 32]).unwrap();
            found.push(journal.found());
            let baked = bake(Some(&journal), &Until(AtomicU64::new(0), rays));
            if let Ok(baked) = baked {
                let values = |baked: &Baked| match &baked.cube.samples {
                    CubeSamples::F32(values) => values.clone(),
                    _ => Vec::new(),
                };
                assert!(values(&baked) == values(&whole));
                assert_eq!(baked.energy, whole.energy);
                assert_eq!(baked.standard_error, whole.standard_error);
                journal.remove().unwrap();
            }
        }
        assert!(
            found[0] == 0 && 0 < found[1] && found[1] <= found[2],
            "{found:?}"
        );
        assert!(!path.exists());
    }
}

#[test]
fn the_energy_is_that_of_the_cube_whatever_the_number_of_samples() {
    let mut scene = stage::scene(
        "camera = { eye = [0, 1, 5], look_at = [0, 0, 0], hfov = \"8 deg\", size = [8, 6] }\n\
         [[object]]\nname = \"floor\"\nshape = { plane = { size = [1, 1] } }\n\
         [[light]]\nposition = [0, 1, 0]\nemission = { gaussian = { sigma = \"5 cm\" } }\n",
    );
    // All of the light, and the bins of its middle: on the floor from 1 m to 1.2 m on, and at the camera some 5 m later.
    let bins = |[start, width]: [f64; 2], count| Bins {
        start,
        width,
        count,
    };
    let sum = |baked: &Baked| -> f64 {
        let [h, w, t, _] = baked.cube.shape;
        let all = (0..h * w).flat_map(|pixel| (0..t).map(move |bin| (pixel, bin)));
        all.map(|(pixel, bin)| value(&baked.cube, pixel, bin)).sum()
    };
    for samples in [1, 4, 16] {
        scene.samples_per_pixel = samples;
        for (camera, later) in [(true, 5.1), (false, 0.0)] {
            let bake = |bins: Bins| match camera {
                true => camera_cube(&scene, &bins).unwrap(),
                false => surface_cube(&scene, 0, [8, 8], &bins).unwrap(),
            };
            let some = bake(bins([1.04 + later, 0.01], 8));
            let all = sum(&bake(bins([-2.0, 10.0], 1)));
            let energy = some.energy;
            stage::assert_relative(energy.held, sum(&some), 1e-5, "in bins");
            assert!(energy.before > 0.01 * all && energy.after > 0.01 * all);
            let whole = energy.before + energy.held + energy.after;
            stage::assert_relative(whole, all, 1e-5, "all");
        }
    }
}

#[test]
fn the_relative_error_does_not_depend_on_how_much_of_the_texture_is_covered() {
    let mut scene = stage::scene(
        "camera = { eye = [0, 1, 5], look_at = [0, 0, 0], size = [4, 4] }\n\
         [[object]]\nname = \"floor\"\nshape = { plane = { size = [1, 1] } }\n\
         [[light]]\nposition = [0, 1, 0]\nemission = { gaussian = { sigma = \"5 cm\" } }\n",
    );
    let bins = Bins {
        start: 0.8,
        width: 0.1,
        count: 8,
    };
    let size = [1.0; 2];
    let mut mesh = shapes::mesh(Shape::Plane { size }, [0.5; 3]);
    scene.objects[0].geometry = Geometry::Mesh(Arc::new(mesh.clone()));
    let whole = surface_cube(&scene, 0, [16, 16], &bins).unwrap();
    // The same texels, with the same samples, as a quarter of a texture.
    for uv in &mut mesh.uvs[0] {
        *uv = uv.map(|x| 0.5 * x);
    }
    scene.objects[0].geometry = Geometry::Mesh(Arc::new(mesh));
    let quarter = surface_cube(&scene, 0, [32, 32], &bins).unwrap();
    assert_eq!(quarter.standard_error, whole.standard_error);
    let [quarter, whole] = [quarter, whole].map(|baked| baked.relative_error());
    assert!(whole > 0.0, "{whole}");
    stage::assert_relative(quarter, whole, 1e-9, "quarter");
}
