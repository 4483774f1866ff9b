//! Pictures that improve by passes, and errors that are told with them.

use nullray::render::aov::Aov;
use nullray::render::film::Film;
use nullray::render::passes::Passes;
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;
use nullray::render::progress::Silent;
use nullray::scene::model::Scene;

use crate::pipeline::stage;

/// A floor and a wall with a ball that flies by, in the light of a panel: noise of soft shadows and of a bounce.
fn room(samples: u32, seed: u32) -> Scene {
    let mut scene = stage::scene(
        "
render = { bounces = 1 }
[camera]
eye = [0.2, 1.2, 3]
look_at = [0, 0.5, 0]
hfov = \"50 deg\"
size = [20, 16]
[[object]]
shape = { plane = { size = [12, 12] } }
colour = [0.7, 0.5, 0.3]
[[object]]
shape = { plane = { size = [12, 12] } }
transform = { translate = [0, 0, -2], rotate = { axis = [1, 0, 0], angle = \"90 deg\" } }
colour = [0.5, 0.7, 0.6]
[[object]]
shape = { sphere = { radius = 0.4 } }
transform = { translate = [0.3, 0.4, -0.2] }
velocity = { beta = [0.4, 0, 0] }
[[object]]
name = \"panel\"
shape = { plane = { size = [1, 1] } }
transform = { translate = [-0.6, 2.2, -0.4], rotate = { axis = [1, 0, 0], angle = \"180 deg\" } }
[[light]]
type = \"area\"
object = \"panel\"
radiance = 2",
    );
    (scene.samples_per_pixel, scene.seed) = (samples, seed);
    scene
}

fn prepared(scene: &Scene, aovs: &[Aov]) -> Prepared {
    let request = Request {
        aovs: aovs.to_vec(),
        ..Request::default()
    };
    Prepared::new(scene, &Plan::new(scene, &request).unwrap(), &Silent).unwrap()
}

fn grey(film: &Film, i: usize) -> f64 {
    film.radiance()[i].iter().sum::<f64>() / 3.0
}

#[test]
fn passes_that_are_taken_up_again_have_the_bits_of_those_that_were_not_stopped() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("sums");
    let scene = room(4, 0);
    let prepared = prepared(
        &scene,
        &[Aov::StandardError, Aov::Samples, Aov::EventCt, Aov::Object],
    );
    for error in [None, Some(0.05)] {
        let mut whole = Passes::new(&prepared, error);
        (0..8).for_each(|_| whole.advance(&prepared, &Silent).unwrap());
        let mut stopped = Passes::new(&prepared, error);
        for _ in 0..8 {
            stopped.advance(&prepared, &Silent).unwrap();
            stopped.write(&path, &[7; 32]).unwrap();
            stopped = Passes::new(&prepared, error);
            assert!(stopped.resume(&path, &[7; 32]).unwrap());
        }
        let (a, b) = (whole.film(), stopped.film());
        let bits = |film: &Film| -> Vec<u64> {
            let radiance = film.radiance().iter().flatten().map(|x| x.to_bits());
            let aovs = [Aov::StandardError, Aov::Samples, Aov::EventCt, Aov::Object];
            let aovs = aovs.map(|aov| film.aov(aov).unwrap().to_vec());
            radiance
                .chain(aovs.concat().into_iter().map(f64::to_bits))
                .collect()
        };
        assert_eq!(bits(&a), bits(&b));
        assert_eq!((a.passes(), b.passes()), (16, 16));
        // Of another picture, or damaged.
        assert!(!stopped.resume(&path, &[8; 32]).unwrap());
        let mut bytes = std::fs::read(&path).unwrap();
        for at in [100, bytes.len() / 2, bytes.len() - 1] {
            bytes[at] ^= 1;
            std::fs::write(&path, &bytes).unwrap();
            let error = stopped.resume(&path, &[7; 32]).unwrap_err().to_string();
            assert!(error.contains("damaged"), "{error}");
            bytes[at] ^= 1;
        }
        std::fs::write(&path, &bytes[..bytes.len() - 40]).unwrap();
        assert!(stopped.resume(&path, &[7; 32]).is_err());
    }
}

#[test]
fn two_passes_are_two_pictures_of_different_random_numbers() {
    let scene = room(4, 3);
    let prepared = prepared(&scene, &[]);
    let first = nullray::render::render(&prepared, &Silent).unwrap();
    let mut passes = Passes::new(&prepared, None);
    passes.advance(&prepared, &Silent).unwrap();
    let both = passes.film();
    let second: Vec<f64> = (0..stage::pixels(&both))
        .map(|i| 2.0 * grey(&both, i) - grey(&first, i))
        .collect();
    let differ = (0..second.len()).filter(|i| (second[*i] - grey(&first, *i)).abs() > 1e-9);
    assert!(differ.count() > 300);
    assert!(second.iter().all(|x| *x > -1e-12));
}
