//! The meaning of the auxiliary channels: identities of the sample nearest to the pixel's centre, means of the others over samples that hit
//! something.

use glam::DVec3;
use nullray::render::aov::Aov;
use nullray::render::film::Film;
use nullray::render::plan::Request;
use nullray::render::sampler::Sampler;
use nullray::scene::model::Scene;

use crate::pipeline::stage::{self, pinhole};

/// A square of side 2 and radiance 1 before black, seen from above, a little aslant.
fn square(samples: u32) -> Scene {
    let mut scene = stage::scene(
        "
[camera]
eye = [0.3, 4, 0.2]
look_at = [0, 0, 0]
up = [0.1, 0, -1]
hfov = \"40 deg\"
size = [20, 16]
[[object]]
shape = { plane = { size = [2, 2] } }
colour = [1, 1, 1]
",
    );
    scene.samples_per_pixel = samples;
    scene
}

/// One sample: squared distance from the pixel's centre; direction, distance and x where it meets.
struct Sample {
    off: f64,
    direction: DVec3,
    met: Option<(f64, DVec3)>,
}

/// The samples of pixel `i`, traced by hand.
fn samples(scene: &Scene, i: usize) -> Vec<Sample> {
    let count = scene.samples_per_pixel;
    samples_of(scene, &Sampler::stratified(count), count, i)
}

/// The first `count` samples of `sampler` in pixel `i`.
fn samples_of(scene: &Scene, sampler: &Sampler, count: u32, i: usize) -> Vec<Sample> {
    let (column, row) = (i as u32 % 20, i as u32 / 20);
    let eye = scene.camera.origin.x;
    let sample = |index| {
        let [x, y] = sampler.offset(column, row, index);
        let d = pinhole(&scene.camera, f64::from(column) + x, f64::from(row) + y);
        let s = -eye.y / d.y;
        let x_hit = eye + d * s;
        Sample {
            off: (x - 0.5).powi(2) + (y - 0.5).powi(2),
            direction: d,
            met: (x_hit.x.abs() < 1.0 && x_hit.z.abs() < 1.0).then_some((s, x_hit)),
        }
    };
    (0..count).map(sample).collect()
}

#[test]
fn means_are_over_the_samples_that_met_a_surface() {
    let scene = square(9);
    let film = stage::rendered(&scene, &stage::sampled()).unwrap();
    let (mut partly, mut empty) = (0, 0);
    for i in 0..stage::pixels(&film) {
        let samples = samples(&scene, i);
        let met: Vec<_> = samples.iter().filter_map(|s| s.met).collect();
        let n = met.len() as f64;
        partly += usize::from(!met.is_empty() && met.len() < 9);
        let radiance = film.radiance()[i][0];
        assert!((radiance - n / 9.0).abs() < 1e-15, "{radiance} {n}");
        let d: DVec3 = samples.iter().map(|s| s.direction).sum::<DVec3>() / 9.0;
        assert!(stage::direction(&film, i).distance(d) < 1e-14);
        if met.is_empty() {
            empty += 1;
            assert!(stage::value(&film, Aov::Distance, i).is_nan());
            assert!(stage::event(&film, i).1.is_nan());
            continue;
        }
        let s = met.iter().map(|m| m.0).sum::<f64>() / n;
        let x = met.iter().map(|m| m.1).sum::<DVec3>() / n;
        assert!((stage::value(&film, Aov::Distance, i) - s).abs() < 1e-13);
        assert!(stage::event(&film, i).1.distance(x) < 1e-13);
        assert_eq!(stage::value(&film, Aov::WavelengthRatio, i), 1.0);
        assert_eq!(stage::value(&film, Aov::NormalY, i), 1.0);
    }
    assert!(partly > 10 && empty > 10, "{partly} {empty}");
}

#[test]
fn identities_and_places_are_those_of_the_sample_nearest_to_the_centre() {
    let scene = square(9);
    let film = stage::rendered(&scene, &stage::sampled()).unwrap();
    for i in 0..stage::pixels(&film) {
        let samples = samples(&scene, i);
        let nearest = samples
            .iter()
            .min_by(|a, b| a.off.total_cmp(&b.off))
            .unwrap();
        let (object, u) = (
            stage::value(&film, Aov::Object, i),
            stage::value(&film, Aov::UvU, i),
        );
        match nearest.met {
            // u runs along x over the square, v along z.
            Some((_, x)) => {
                assert_eq!(object, 0.0);
                assert!((u - 0.5 * (x.x + 1.0)).abs() < 1e-14, "{u} {x}");
                let v = stage::value(&film, Aov::UvV, i);
                assert!((v - 0.5 * (x.z + 1.0)).abs() < 1e-14, "{v} {x}");
            }
            None => {
                assert_eq!(
                    (object, stage::value(&film, Aov::Primitive, i)),
                    (-1.0, -1.0)
                );
                assert!(u.is_nan() && stage::value(&film, Aov::BarycentricU, i).is_nan());
            }
        }
    }
}

/// The standard error of all pixels of `scene`.
fn standard_errors(scene: &Scene) -> Film {
    let request = Request {
        aovs: vec![Aov::Object, Aov::StandardError, Aov::Samples],
        ..Request::default()
    };
    stage::rendered(scene, &request).unwrap()
}

#[test]
fn the_standard_error_is_that_of_eight_means_of_independent_parts_and_of_those_of_neighbours() {
    // The parts by hand: part k of n/8 samples is replicate k. Each mean is the share of its samples that meet the square.
    let n = 64;
    let scene = square(n);
    let film = standard_errors(&scene);
    let sampler = Sampler::stratified(n / 8);
    let mut variances = Vec::new();
    for i in 0..stage::pixels(&film) {
        let met: Vec<f64> = samples_of(&scene, &sampler, n, i)
            .iter()
            .map(|s| f64::from(s.met.is_some()))
            .collect();
        let means: Vec<f64> = met
            .chunks(8)
            .map(|part| part.iter().sum::<f64>() / 8.0)
            .collect();
        let mean = means.iter().sum::<f64>() / 8.0;
        let squares: f64 = means.iter().map(|m| (m - mean).powi(2)).sum();
        variances.push(squares / 7.0);
        assert!((film.radiance()[i][0] - mean).abs() < 1e-12);
        assert_eq!(stage::value(&film, Aov::Samples, i), f64::from(n));
    }
    // Seven degrees of freedom of its own and four of the mean of 5 × 5 pixels, in which it counts in place of those that are in no tile of its own.
    let [width, height] = film.size().map(|n| n as i64);
    let (mut uneven, mut sums) = (0, std::collections::BTreeMap::new());
    for i in 0..stage::pixels(&film) {
        let (x, y) = (i as i64 % width, i as i64 / width);
        let around = (-2..=2).flat_map(|dy| (-2..=2).map(move |dx| (x + dx, y + dy)));
        let of = |(u, v): (i64, i64)| {
            let tile = |x: i64, y: i64| (x.div_euclid(16), y.div_euclid(16));
            let there = u < width && v < height && tile(u, v) == tile(x, y);
            variances[if there { (v * width + u) as usize } else { i }]
        };
        let mean = around.map(of).sum::<f64>() / 25.0;
        let expected = ((7.0 * variances[i] + 4.0 * mean) / 11.0 / 8.0).sqrt();
        let got = stage::value(&film, Aov::StandardError, i);
        assert!((got - expected).abs() < 1e-12, "{got} {expected}");
        uneven += u32::from(expected > 0.0);
        let sums = sums.entry((x / 16, y / 16)).or_insert([0.0; 2]);
        *sums = [sums[0] + variances[i] / 8.0, sums[1] + got * got];
    }
    assert!(uneven > 20, "{uneven}");
    // The mean square over each tile is that of the variances themselves.
    for [own, told] in sums.values() {
        assert!((told - own).abs() <= 1e-12 * own, "{told} {own}");
    }
    // 7/(a² + (2 a b + b²)/25), a = 7/11.
    let metadata = nullray::render::metadata::metadata(&scene, &film).unwrap();
    let said = ("standard_error_degrees_of_freedom".into(), "16.3".into());
    assert!(metadata.contains(&said), "{metadata:?}");
    let degrees = film.degrees_of_freedom().unwrap();
    assert!(
        (degrees - 7.0 / (0.404_958_677_7 + 0.595_041_322_3 / 25.0)).abs() < 1e-6,
        "{degrees}"
    );
}

#[test]
fn a_pixel_of_one_radiance_has_no_standard_error() {
    for n in [3, 5, 16, 17, 22] {
        let mut scene = square(n);
        scene.background = [0.1, 0.7, 0.123];
        scene.camera.size = [80, 64];
        let film = standard_errors(&scene);
        let is_dark = |i: &usize| film.aov(Aov::Object).unwrap()[*i] < 0.0;
        // Far from the square: its outline is four pixels away, and two count.
        let corner = [0, 79, 63 * 80, 63 * 80 + 79];
        for i in corner.iter().filter(|i| is_dark(i)) {
            assert_eq!(
                stage::value(&film, Aov::StandardError, *i),
                0.0,
                "{n} samples"
            );
        }
        assert!(corner.iter().any(is_dark));
    }
}

#[test]
fn one_sample_has_no_standard_error() {
    let film = standard_errors(&square(1));
    assert!(
        film.aov(Aov::StandardError)
            .unwrap()
            .iter()
            .all(|e| e.is_nan())
    );
}

#[test]
fn metadata_of_any_motion_give_the_wavelength_ratios_of_the_picture() {
    let motions = [
        "velocity = { beta = [0.3, -0.4, 0.5] }\neye = [0.3, 0.2, 5]\n[camera.motion]\n\
         acceleration = { proper = \"0.4 /m\", direction = [1, 2, 3] }",
        "velocity = { beta = [0.3, -0.4, 0.5] }\neye = [0.3, 0.2, 5]\n[camera.motion]\n\
         segments = [{ duration = \"0.5 m\", acceleration = { proper = \"0.4 /m\", direction = [1, 0, 0] } }]",
        "velocity = { beta = [0.3, -0.4, 0.5] }\neye = [0.3, 0.2, 5]\n[camera.motion]\n\
         profile = [{ time = \"0 m\" }, { time = \"2 m\", acceleration = { proper = \"0.9 /m\", direction = [0, 1, 0] } }]",
        "[camera.motion]\nkeyframes = [{ time = \"0 m\", position = [0, 0, 3] }, \
         { time = \"1 m\", position = [0.5, 0, 3] }, { time = \"2 m\", position = [0.5, 0, 3.5] }]",
        "eye = [0, 0, 5]\n[camera.motion]\ncircle = { centre = [0, 0, 4.5], axis = [0, 1, 0], rate = \"1.4 rad/m\" }",
    ];
    for motion in motions {
        let scene = stage::scene(&format!(
            "[camera]\nforward = [0, 0, -1]\nhfov = \"60 deg\"\nsize = [8, 6]\ntime = \"0.7 m\"\n{motion}\n\
             [[object]]\nshape = {{ box = {{ size = [90, 90, 1] }} }}\n"
        ));
        let film = stage::film(&scene);
        let said = nullray::render::metadata::metadata(&scene, &film).unwrap();
        let numbers = |key: &str| -> Vec<f64> {
            let (_, value) = said.iter().find(|(k, _)| k == key).unwrap();
            value.split(' ').map(|word| word.parse().unwrap()).collect()
        };
        let [shot, rapidity] = ["camera_shot_event", "camera_shot_rapidity"].map(numbers);
        let (eye, rapidity) = (DVec3::from_slice(&shot[1..]), DVec3::from_slice(&rapidity));
        let (gamma, beta) = (
            rapidity.length().cosh(),
            rapidity.normalize() * rapidity.length().tanh(),
        );
        let met = stage::met(&film);
        assert!(met.len() > 10, "{motion}");
        for i in met {
            let (ct, x) = stage::event(&film, i);
            assert!(
                ((x - eye).length() + ct - shot[0]).abs() < 1e-11,
                "{motion}"
            );
            let w = 1.0 / (gamma * (1.0 + (x - eye).normalize().dot(beta)));
            let got = stage::value(&film, Aov::WavelengthRatio, i);
            assert!((got / w - 1.0).abs() < 1e-11, "{motion}: {got} {w}");
        }
    }
}
