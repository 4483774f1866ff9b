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

fn passes(scene: &Scene, error: Option<f64>, count: u32) -> Passes {
    let prepared = prepared(scene, &[Aov::StandardError, Aov::Samples]);
    let mut passes = Passes::new(&prepared, error);
    while passes.done() < count && !passes.is_settled() {
        passes.advance(&prepared, &Silent).unwrap();
    }
    passes
}

fn grey(film: &Film, i: usize) -> f64 {
    film.radiance()[i].iter().sum::<f64>() / 3.0
}

/// What many independent pictures tell of each other.
struct Calibration {
    /// The mean of the squares of standard errors over the variance of pictures, pixel by pixel, as a mean.
    variance: f64,
    /// How often an error is below one and two standard errors.
    within: [f64; 2],
    /// The mean over pixels of the squared difference of the mean picture from `truth`, in units of its variance.
    bias: f64,
}

/// Of `films` of one scene with different seeds; `truth` is a picture of far more samples, whose noise is `share` of the variance of theirs.
fn calibrate(films: &[Film], truth: &Film, share: f64) -> Calibration {
    let n = films.len() as f64;
    let (mut ratio, mut within, mut bias, mut pixels) = (0.0, [0.0; 2], 0.0, 0.0);
    for i in 0..stage::pixels(truth) {
        let mean = films.iter().map(|film| grey(film, i)).sum::<f64>() / n;
        let square = |film: &Film| (grey(film, i) - mean).powi(2);
        let variance = films.iter().map(square).sum::<f64>() / (n - 1.0);
        if variance == 0.0 {
            continue;
        }
        let said = |film: &Film| stage::value(film, Aov::StandardError, i);
        ratio += films.iter().map(|film| said(film).powi(2)).sum::<f64>() / n / variance;
        for film in films {
            // The mean of all pictures is 1/n of this one, which makes its difference from it smaller by √(1 − 1/n).
            let error = (grey(film, i) - mean).abs() / (1.0 - 1.0 / n).sqrt();
            for (k, within) in (1..).zip(&mut within) {
                *within += f64::from(error < f64::from(k) * said(film)) / n;
            }
        }
        bias += (mean - grey(truth, i)).powi(2) / (variance * (1.0 / n + share));
        pixels += 1.0;
    }
    Calibration {
        variance: ratio / pixels,
        within: within.map(|w| w / pixels),
        bias: bias / pixels,
    }
}

#[test]
fn over_200_seeds_the_error_is_within_the_standard_error_as_often_as_said() {
    let films: Vec<_> = (1..=200)
        .map(|seed| {
            let scene = room(32, seed);
            let prepared = prepared(&scene, &[Aov::StandardError]);
            nullray::render::render(&prepared, &Silent).unwrap()
        })
        .collect();
    let truth = passes(&room(512, 0), None, 16).film();
    // Eight parts of four samples: Student's t with 7 degrees of freedom is below 1 in 64.9 % and below 2 in 91.4 % of all cases. 64,000
    // cases of 320 pixels put 0.19 % and 0.11 % of chance on these. Means of four samples are not quite normal, at the edges of shadows most:
    // within 4 % of it, which is more than 15 times the chance.
    let told = calibrate(&films, &truth, 1.0 / 256.0);
    println!("{} {:?} {}", told.variance, told.within, told.bias);
    let [one, two] = told.within;
    assert!((one - 0.649).abs() < 0.04, "{one}");
    assert!((two - 0.914).abs() < 0.04, "{two}");
    // The variance itself is free of bias for any distribution. A pixel's variance of 200 pictures is known to 10 %, the mean of 320 pixels
    // to 0.6 %; 1 + 2/199 is the mean of 1/χ² per degree. Beyond 5 % by chance in less than 1 of 10⁶ cases.
    assert!((told.variance - 1.01).abs() < 0.05, "{}", told.variance);
    // χ² of 320 pixels per degree of freedom: 1 ± 0.08; more than 1.5 in less than 1 of 10⁶ cases.
    assert!(told.bias < 1.5, "{}", told.bias);
}

#[test]
fn tiles_that_stop_by_their_error_have_no_bias_and_tell_their_error() {
    let films: Vec<_> = (1..=100)
        .map(|seed| passes(&room(2, seed), Some(0.06), 200).film())
        .collect();
    let truth = passes(&room(512, 0), None, 16).film();
    let told = calibrate(&films, &truth, 1.0 / 80.0);
    println!("{} {:?} {}", told.variance, told.within, told.bias);
    // As above; the number of passes of a tile differs from seed to seed. With 15 or more degrees of freedom 66 to 68 %, 94 to 95.4 %.
    let [one, two] = told.within;
    assert!((one - 0.67).abs() < 0.04, "{one}");
    assert!((two - 0.948).abs() < 0.04, "{two}");
    assert!((told.variance - 1.01).abs() < 0.08, "{}", told.variance);
    assert!(told.bias < 1.5, "{}", told.bias);
    // Tiles of more noise have taken more samples.
    let samples = films[0].aov(Aov::Samples).unwrap();
    let of = |most: bool| {
        samples
            .iter()
            .fold(f64::NAN, |a, b| if most { a.max(*b) } else { a.min(*b) })
    };
    assert!(of(true) > of(false), "{} {}", of(true), of(false));
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
        // Nor is anything else written over.
        for text in ["notes", &"notes that are long ".repeat(5)] {
            std::fs::write(&path, text).unwrap();
            let error = stopped.resume(&path, &[7; 32]).unwrap_err().to_string();
            assert!(error.contains("overwritten"), "{error}");
        }
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
