//! Pictures that improve by passes, and their reported errors.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicI64, Ordering};

use nullray::Error;
use nullray::render::aov::Aov;
use nullray::render::film::Film;
use nullray::render::passes::Passes;
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;
use nullray::render::progress::{Progress, Silent};
use nullray::scene::model::Scene;

use crate::pipeline::stage;

/// A floor and a wall with a ball, on a film and in a light that `film` and `light` say; `light` begins with what else the ball does.
fn room_in(bounces: u32, film: &str, light: &str, samples: u32) -> Scene {
    let mut scene = stage::scene(&format!(
        "
render = {{ bounces = {bounces} }}
[camera]
eye = [0.2, 1.2, 3]
look_at = [0, 0.5, 0]
hfov = \"50 deg\"
{film}
[[object]]
shape = {{ plane = {{ size = [12, 12] }} }}
colour = [0.7, 0.5, 0.3]
[[object]]
shape = {{ plane = {{ size = [12, 12] }} }}
transform = {{ translate = [0, 0, -2], rotate = {{ axis = [1, 0, 0], angle = \"90 deg\" }} }}
colour = [0.5, 0.7, 0.6]
[[object]]
shape = {{ sphere = {{ radius = 0.4 }} }}
transform = {{ translate = [0.3, 0.4, -0.2] }}
{light}"
    ));
    scene.samples_per_pixel = samples;
    scene
}

/// The room with the ball flying by, in the light of a panel: noise of soft shadows and of a bounce.
fn room(samples: u32) -> Scene {
    let light = "velocity = { beta = [0.4, 0, 0] }
[[object]]
name = \"panel\"
shape = { plane = { size = [1, 1] } }
transform = { translate = [-0.6, 2.2, -0.4], rotate = { axis = [1, 0, 0], angle = \"180 deg\" } }
[[light]]
type = \"area\"
object = \"panel\"
radiance = 2";
    room_in(1, "size = [20, 16]", light, samples)
}

fn prepared(scene: &Scene, aovs: &[Aov]) -> Prepared {
    let request = Request {
        aovs: aovs.to_vec(),
        ..Request::default()
    };
    Prepared::new(scene, &Plan::new(scene, &request).unwrap(), &Silent).unwrap()
}

/// Films of `scene` with the seeds from 1 on.
fn films(scene: &Scene, seeds: u32) -> Vec<Film> {
    let mut prepared = prepared(scene, &[Aov::StandardError]);
    let of_seed = |seed| {
        prepared.sampler = prepared.sampler.with_seed(seed);
        nullray::render::render(&prepared, &Silent).unwrap()
    };
    (1..=seeds).map(of_seed).collect()
}

fn passes(prepared: &Prepared, error: Option<f64>, count: u32) -> Film {
    let mut passes = Passes::new(prepared, error).unwrap();
    while passes.done() < count && !passes.is_settled() {
        passes.advance(prepared, &Silent).unwrap();
    }
    passes.film().unwrap()
}

const OF_PASSES: [Aov; 2] = [Aov::StandardError, Aov::Samples];

/// The same by passes until this relative error is reached.
fn films_to(error: f64, count: u32, scene: &Scene, seeds: u32) -> Vec<Film> {
    let mut prepared = prepared(scene, &OF_PASSES);
    let of_seed = |seed| {
        prepared.sampler = prepared.sampler.with_seed(seed);
        passes(&prepared, Some(error), count)
    };
    (1..=seeds).map(of_seed).collect()
}

/// A film of 16 passes with seed 0.
fn truth(scene: &Scene) -> Film {
    passes(&prepared(scene, &OF_PASSES), None, 16)
}

/// The room with the noise of 8192 samples.
fn true_room() -> &'static Film {
    static FILM: OnceLock<Film> = OnceLock::new();
    FILM.get_or_init(|| truth(&room(512)))
}

fn grey(film: &Film, i: usize) -> f64 {
    film.radiance()[i].iter().sum::<f64>() / 3.0
}

/// What many independent pictures tell of each other.
struct Calibration {
    /// The squares of standard errors over the variance of pictures, as means over all pixels.
    variance: f64,
    /// How often an error is below one and two standard errors.
    within: [f64; 2],
    /// The mean over pixels of the squared difference of the mean picture from `truth`, in units of its variance.
    bias: f64,
}

/// Of `films` of one scene with different seeds; `truth` is a picture of far more samples, whose noise is `share` of the variance of theirs.
fn calibrate(films: &[Film], truth: &Film, share: f64) -> Calibration {
    let n = films.len() as f64;
    let (mut told, mut found, mut within, mut bias, mut pixels) = (0.0, 0.0, [0.0; 2], 0.0, 0.0);
    let of_pixel = |i: usize| {
        let mean = films.iter().map(|film| grey(film, i)).sum::<f64>() / n;
        let square = |film: &Film| (grey(film, i) - mean).powi(2);
        let variance = films.iter().map(square).sum::<f64>() / (n - 1.0);
        (mean, variance)
    };
    let all: Vec<_> = (0..stage::pixels(truth)).map(of_pixel).collect();
    let most = all.iter().fold(0.0, |most: f64, (_, v)| most.max(*v));
    for (i, (mean, variance)) in all.into_iter().enumerate() {
        // Tails of pulses below a thousandth of the noise of others are of no account.
        if variance <= 1e-6 * most {
            continue;
        }
        let said = |film: &Film| stage::value(film, Aov::StandardError, i);
        told += films.iter().map(|film| said(film).powi(2)).sum::<f64>() / n;
        found += variance;
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
        variance: told / found,
        within: within.map(|w| w / pixels),
        bias: bias / pixels,
    }
}

#[test]
fn over_200_seeds_the_error_is_within_the_standard_error_as_often_as_said() {
    let films = films(&room(32), 200);
    let truth = true_room();
    // Eight parts of four samples, and those of neighbours: Student's t with the 16 degrees of freedom that the film tells is below 1 in 66.8 % and below 2
    // in 93.7 % of all cases; where neighbours have more noise of their own it is so more often. 64,000 cases of 320 pixels put 0.19 % and
    // 0.1 % of chance on these. Of normal errors 68.3 % and 95.4 %: within 3 % and 2.5 %, which is more than 15 times the chance. By a pixel's own parts alone
    // it is 61 % and 87 %.
    let told = calibrate(&films, truth, 1.0 / 256.0);
    println!("{} {:?} {}", told.variance, told.within, told.bias);
    let [one, two] = told.within;
    assert!((one - 0.683).abs() < 0.03, "{one}");
    assert!((two - 0.954).abs() < 0.025, "{two}");
    let degrees = films[0].degrees_of_freedom().unwrap();
    assert!((degrees - 16.33).abs() < 0.01, "{degrees}");
    // The mean square of a tile is free of bias for any distribution. A pixel's variance of 200 pictures is known to 10 %; pixels share paths in some 20 groups,
    // of which all of them make 2 %: beyond 10 % by chance in less than 1 of 10⁶ cases.
    assert!((told.variance - 1.0).abs() < 0.1, "{}", told.variance);
    // χ² of 320 pixels per degree of freedom: 1 ± 0.08; more than 1.5 in less than 1 of 10⁶ cases.
    assert!(told.bias < 1.5, "{}", told.bias);
}

/// The room in the light of a flash, three bounces of which are in view: few paths are of that length.
fn flash(samples: u32) -> Scene {
    let light = "[[light]]
position = [1.2, 2.8, 1.0]
intensity = 30
emission = { gaussian = { sigma = \"12 cm\" } }";
    let film = "size = [32, 24]\ntime = \"6.6 m\"";
    room_in(3, film, light, samples)
}

#[test]
fn errors_of_light_that_few_samples_find_are_within_the_standard_error_as_often_as_said() {
    let films = films(&flash(16), 200);
    let truth = truth(&flash(256));
    let told = calibrate(&films, &truth, 1.0 / 256.0);
    println!("{} {:?} {}", told.variance, told.within, told.bias);
    // By its own parts alone the error of a pixel is within once what is said in 39 %, within twice in 51 %: most parts have missed the light. 200 pictures
    // of some 300 pixels that any light comes to put 0.2 % of chance on a share.
    let [one, two] = told.within;
    assert!((0.62..0.80).contains(&one), "{one}");
    assert!((0.86..0.97).contains(&two), "{two}");
    assert!((told.variance - 1.0).abs() < 0.2, "{}", told.variance);
}

#[test]
fn tiles_that_stop_by_their_error_are_unbiased_and_report_their_error() {
    // Passes of four samples: single parts of two are far from normal where few pixels of a tile see the edge of the panel.
    let films = films_to(0.05, 200, &room(4), 100);
    let truth = true_room();
    let told = calibrate(&films, truth, 1.0 / 80.0);
    println!("{} {:?} {}", told.variance, told.within, told.bias);
    // As above; the number of passes of a tile differs from seed to seed.
    let [one, two] = told.within;
    assert!((one - 0.683).abs() < 0.03, "{one}");
    assert!((two - 0.954).abs() < 0.025, "{two}");
    assert!((told.variance - 1.0).abs() < 0.1, "{}", told.variance);
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

/// A floor below a bright panel that moves one way, and a glossy ball that moves the other way: few samples find the panel in it.
fn glints(samples: u32) -> Scene {
    let light = "metallic = 1
roughness = 0.3
velocity = { beta = [0.5, 0, 0] }
[[object]]
name = \"panel\"
shape = { box = { size = [2, 0.1, 1] } }
transform = { translate = [-1, 2, 0] }
velocity = { beta = [-0.4, 0, 0] }
[[light]]
type = \"area\"
object = \"panel\"
radiance = [3, 2, 1]
[sky]
gradient = {}";
    room_in(2, "size = [32, 32]", light, samples)
}

#[test]
fn tiles_in_which_few_samples_find_a_light_reach_the_error_that_was_asked_for() {
    let films = films_to(0.1, 2000, &glints(4), 16);
    let count = films.len() as f64;
    let of_pixel = |i: usize| {
        let mean = films.iter().map(|film| grey(film, i)).sum::<f64>() / count;
        let square = |film: &Film| (grey(film, i) - mean).powi(2);
        let variance = films.iter().map(square).sum::<f64>() / (count - 1.0);
        [mean, variance]
    };
    let pixels: Vec<[f64; 2]> = (0..32 * 32).map(of_pixel).collect();
    let whole = pixels.iter().map(|[mean, _]| mean).sum::<f64>() / 1024.0;
    for tile in 0..4 {
        let of_tile = |i: usize| (i % 32) / 16 + 2 * (i / 512) == tile;
        let sums = (0..1024).filter(|i| of_tile(*i)).fold([0.0; 2], |sums, i| {
            [sums[0] + pixels[i][0], sums[1] + pixels[i][1]]
        });
        let [mean, variance] = sums.map(|sum| sum / 256.0);
        let error = variance.sqrt() / mean.max(whole);
        println!("{tile}: {error}");
        assert!(error < 0.1, "{tile}: {error}");
    }
}

#[test]
fn no_tile_is_settled_before_each_half_has_32_samples_and_4_passes() {
    // Without light there is no noise, so that the first decision is the last.
    for (samples, passes) in [(1, 64), (3, 22), (4, 16), (8, 8), (64, 8)] {
        let scene = room_in(0, "size = [4, 4]", "[sky]\nradiance = 0", samples);
        let prepared = prepared(&scene, &[]);
        let mut dark = Passes::new(&prepared, Some(0.9)).unwrap();
        while !dark.is_settled() {
            dark.advance(&prepared, &Silent).unwrap();
        }
        assert_eq!(dark.done(), passes, "{samples} samples");
        assert_eq!(dark.beyond().tiles, 0);
    }
}

const CHANNELS: [Aov; 4] = [Aov::StandardError, Aov::Samples, Aov::EventCt, Aov::Object];

/// The bits of the radiance and of these channels.
fn bits(film: &Film) -> Vec<u64> {
    let aovs = CHANNELS.map(|aov| film.aov(aov).unwrap().to_vec());
    let aovs = aovs.concat().into_iter().map(f64::to_bits);
    stage::bits(film).into_iter().chain(aovs).collect()
}

/// Stops work that has asked this many times.
struct Patience(AtomicI64);

impl Progress for Patience {
    fn is_cancelled(&self) -> bool {
        self.0.fetch_sub(1, Ordering::Relaxed) <= 0
    }
}

#[test]
fn passes_that_were_cancelled_are_finished_with_the_bits_of_those_that_were_not() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("sums");
    let prepared = prepared(&room(4), &CHANNELS);
    for error in [None, Some(0.05)] {
        let mut whole = Passes::new(&prepared, error).unwrap();
        (0..6).for_each(|_| whole.advance(&prepared, &Silent).unwrap());
        let mut stopped = Passes::new(&prepared, error).unwrap();
        let mut refused = 0;
        // From one question on, at least one tile gets on.
        let mut questions = (1..4).cycle();
        while stopped.done() < 12 {
            let patience = Patience(AtomicI64::new(questions.next().unwrap()));
            let done = stopped.done();
            match stopped.advance(&prepared, &patience) {
                Ok(()) => {
                    assert_eq!(stopped.done(), done + 2);
                    stopped.film().unwrap();
                }
                Err(error) => {
                    assert!(matches!(error, Error::Cancelled), "{error}");
                    assert_eq!(stopped.done(), done);
                    let film = stopped.film().unwrap_err().to_string();
                    assert!(film.contains("two passes were cancelled"), "{film}");
                    assert!(stopped.write(&path, &[7; 32]).is_err() && !path.exists());
                    refused += 1;
                }
            }
        }
        assert!(refused > 5, "{refused}");
        assert_eq!(bits(&whole.film().unwrap()), bits(&stopped.film().unwrap()));
    }
}

#[test]
fn passes_refuse_errors_that_cannot_be_reached_and_films_of_another_size() {
    let small = prepared(&room_in(0, "size = [4, 4]", "", 1), &[]);
    for error in [0.0, -0.1, f64::NAN, f64::INFINITY] {
        let said = Passes::new(&small, Some(error)).unwrap_err().to_string();
        assert!(said.contains("passes, error"), "{said}");
    }
    let mut passes = Passes::new(&small, None).unwrap();
    let large = prepared(&room_in(0, "size = [40, 40]", "", 1), &[]);
    let said = passes.advance(&large, &Silent).unwrap_err().to_string();
    assert!(said.contains("another film"), "{said}");
    passes.advance(&small, &Silent).unwrap();
}

#[test]
fn passes_that_are_taken_up_again_have_the_bits_of_those_that_were_not_stopped() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("sums");
    let scene = room(4);
    let prepared = prepared(&scene, &CHANNELS);
    for error in [None, Some(0.05)] {
        let mut whole = Passes::new(&prepared, error).unwrap();
        (0..12).for_each(|_| whole.advance(&prepared, &Silent).unwrap());
        let mut stopped = Passes::new(&prepared, error).unwrap();
        for _ in 0..12 {
            stopped.advance(&prepared, &Silent).unwrap();
            stopped.write(&path, &[7; 32]).unwrap();
            stopped = Passes::new(&prepared, error).unwrap();
            assert!(stopped.resume(&path, &[7; 32]).unwrap());
        }
        let (a, b) = (whole.film().unwrap(), stopped.film().unwrap());
        assert_eq!(bits(&a), bits(&b));
        assert_eq!((a.passes(), b.passes()), (24, 24));
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
    let mut prepared = prepared(&room(4), &[]);
    prepared.sampler = prepared.sampler.with_seed(3);
    let first = nullray::render::render(&prepared, &Silent).unwrap();
    let mut passes = Passes::new(&prepared, None).unwrap();
    passes.advance(&prepared, &Silent).unwrap();
    let both = passes.film().unwrap();
    let second: Vec<f64> = (0..stage::pixels(&both))
        .map(|i| 2.0 * grey(&both, i) - grey(&first, i))
        .collect();
    let differ = (0..second.len()).filter(|i| (second[*i] - grey(&first, *i)).abs() > 1e-9);
    assert!(differ.count() > 300);
    assert!(second.iter().all(|x| *x > -1e-12));
}

#[test]
fn tiles_stop_by_the_noise_of_each_colour() {
    // A red and a blue panel side by side, one of which each sample chooses: their noise is opposite, and cancels in the mean of R, G and B.
    let panel = |name: &str, x: f64, radiance: [f64; 3]| {
        format!(
            "
[[object]]
name = {name:?}
shape = {{ plane = {{ size = [0.3, 0.3] }} }}
transform = {{ translate = [{x}, 6, 0], rotate = {{ axis = [1, 0, 0], angle = \"180 deg\" }} }}
[[light]]
type = \"area\"
object = {name:?}
radiance = {radiance:?}"
        )
    };
    let mut scene = stage::scene(&format!(
        "
[camera]
eye = [0, 2, 0]
look_at = [0, 0, 0]
up = [0, 0, 1]
hfov = \"20 deg\"
size = [16, 16]
[[object]]
shape = {{ plane = {{ size = [9, 9] }} }}
colour = [1, 1, 1]
{}{}",
        panel("red", -0.2, [4.0, 0.0, 0.0]),
        panel("blue", 0.2, [0.0, 0.0, 4.0])
    ));
    scene.samples_per_pixel = 1;
    let films = films_to(0.05, 4000, &scene, 24);
    let count = films.len() as f64;
    // Variances over seeds, as means over the tile.
    let variance = |value: &dyn Fn(&Film, usize) -> f64| {
        let of_pixel = |i: usize| {
            let mean = films.iter().map(|film| value(film, i)).sum::<f64>() / count;
            let squares = films.iter().map(|film| (value(film, i) - mean).powi(2));
            squares.sum::<f64>() / (count - 1.0)
        };
        (0..256).map(of_pixel).sum::<f64>() / 256.0
    };
    let colour = |c: usize| variance(&|film, i| film.radiance()[i][c]);
    let of_colours = ((colour(0) + colour(1) + colour(2)) / 3.0).sqrt();
    let of_mean = variance(&grey).sqrt();
    let whole = (0..256).map(|i| grey(&films[0], i)).sum::<f64>() / 256.0;
    println!("{} {}", of_colours / whole, of_mean / whole);
    assert!(of_mean < 0.2 * of_colours);
    // Fewest passes, 32 samples of each half, would leave three times the noise that is asked for.
    assert!(of_colours < 0.055 * whole, "{}", of_colours / whole);
}

#[test]
fn rays_through_the_centres_of_pixels_choose_light_by_the_seed() {
    let picture = |seed: u32| {
        let mut scene = room(1);
        scene.seed = seed;
        let request = Request {
            pixel_centers: true,
            ..Request::default()
        };
        let plan = Plan::new(&scene, &request).unwrap();
        let prepared = Prepared::new(&scene, &plan, &Silent).unwrap();
        nullray::render::render(&prepared, &Silent).unwrap()
    };
    let [a, b, again] = [0, 1, 1].map(picture);
    assert!(a.radiance() != b.radiance());
    assert!(b.radiance() == again.radiance());
}
