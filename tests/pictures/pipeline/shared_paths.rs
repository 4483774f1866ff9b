//! Paths shared between points, against the same light without sharing.
//!
//! Paths are shared only if nothing changes with time. A lamp with a table of emission does change, if only in principle: a table that is 1
//! for longer than light travels is as bright, and makes every point follow its own path.

use nullray::render::aov::Aov;
use nullray::render::bake::{self, Bins, CubePrecision};
use nullray::render::film::Film;
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;
use nullray::render::progress::Silent;
use nullray::scene::model::{LightKind, Scene};

use crate::pipeline::stage;

/// A room that is open above and in front, with a block of this finish, a panel of which the one side shines, and a lamp of this emission; all moves with
/// `beta`.
fn room(beta: f64, finish: &str, (lamp, panel): (&str, &str), sky: &str) -> Scene {
    let moves = format!("velocity = {{ beta = [{beta}, 0, 0] }}");
    let mut text = format!(
        "
render = {{ bounces = 3 }}
display = {{ back_faces = \"two_sided\", samples_per_pixel = 16 }}
{sky}
[camera]
eye = [0.2, 1.1, 3.2]
look_at = [0, 0.7, 0]
hfov = \"55 deg\"
size = [32, 24]
{moves}
[[light]]
position = [0.5, 1.5, 0.3]
intensity = 2
{moves}
{lamp}
[[object]]
name = \"panel\"
shape = {{ plane = {{ size = [0.7, 0.5] }} }}
colour = [0.3, 0.3, 0.3]
transform = {{ translate = [-0.3, 1.7, 0], rotate = {{ axis = [1, 0, 0], angle = \"180 deg\" }} }}
{moves}
[[light]]
type = \"area\"
object = \"panel\"
radiance = [4, 3, 2]
{panel}
[[object]]
name = \"block\"
shape = {{ box = {{ size = [0.6, 0.7, 0.6] }} }}
transform = {{ translate = [0.2, 0.35, 0.1], rotate = {{ axis = [0, 1, 0], angle = \"30 deg\" }} }}
{moves}
{finish}
"
    );
    for (name, size, place, colour) in [
        (
            "floor",
            [2.4, 0.02, 2.4],
            [0.0, -0.01, 0.0],
            [0.8, 0.8, 0.7],
        ),
        ("back", [2.4, 2.0, 0.02], [0.0, 1.0, -1.2], [0.7, 0.7, 0.8]),
        ("left", [0.02, 2.0, 2.4], [-1.2, 1.0, 0.0], [0.8, 0.2, 0.1]),
        ("right", [0.02, 2.0, 2.4], [1.2, 1.0, 0.0], [0.2, 0.7, 0.2]),
    ] {
        text += &format!(
            "[[object]]\nname = \"{name}\"\nshape = {{ box = {{ size = {size:?} }} }}\ncolour = {colour:?}\n\
             transform = {{ translate = {place:?} }}\n{moves}\n"
        );
    }
    stage::scene(&text)
}

/// As bright as steady, and not known to be.
const ALONE: &str = "emission = { table = [{ time = \"-1000 m\", factor = 1 }, { time = \"1000 m\", factor = 1 }] }";
const SKY: &str = "[sky]\ngradient = { zenith = [0.3, 0.5, 1], horizon = [1, 1, 0.8], ground = [0.1, 0.1, 0.1] }\n";

fn prepared(scene: &Scene) -> Prepared {
    let request = Request {
        aovs: vec![Aov::StandardError],
        ..Request::default()
    };
    Prepared::new(scene, &Plan::new(scene, &request).unwrap(), &Silent).unwrap()
}

fn films(scene: &Scene, seeds: u32) -> Vec<Film> {
    let mut prepared = prepared(scene);
    let one = |seed| {
        prepared.sampler = prepared.sampler.with_seed(seed);
        nullray::render::render(&prepared, &Silent).unwrap()
    };
    (0..seeds).map(one).collect()
}

fn mean_and_variance(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>();
    (mean, squares / (n - 1.0))
}

fn grey(film: &Film, i: usize) -> f64 {
    film.radiance()[i].iter().sum::<f64>() / 3.0
}

/// The means over pixels, film by film, and the variance between films as a mean over pixels.
fn spread(films: &[Film]) -> (Vec<f64>, f64) {
    let count = stage::pixels(&films[0]);
    let means = films
        .iter()
        .map(|film| (0..count).map(|i| grey(film, i)).sum::<f64>() / count as f64);
    let variances = (0..count).map(|i| {
        let values: Vec<f64> = films.iter().map(|film| grey(film, i)).collect();
        mean_and_variance(&values).1
    });
    (means.collect(), variances.sum::<f64>() / count as f64)
}

/// The difference of two means in units of what their spread lets expect.
fn apart(a: &[f64], b: &[f64]) -> f64 {
    let ((a, va), (b, vb), n) = (mean_and_variance(a), mean_and_variance(b), a.len() as f64);
    (a - b) / ((va + vb) / n).sqrt()
}

#[test]
fn paths_that_are_shared_show_the_same_light() {
    // Means of 24 pictures each, of which a difference of 5.5 standard errors, known to 15 %, is chance in less than 1 of 10⁵ cases. What is
    // shared is within 0.5 % at that.
    let diffuse = "colour = [0.7, 0.6, 0.2]";
    let mirror = "colour = [0.9, 0.9, 0.9]\nmetallic = 1\nroughness = 0";
    let rough = "colour = [0.9, 0.6, 0.4]\nmetallic = 1\nroughness = 0.4";
    for (beta, finish, sky) in [
        (0.0, diffuse, SKY),
        (0.6, diffuse, SKY),
        (0.0, rough, ""),
        (0.0, mirror, SKY),
    ] {
        let [shared, alone] =
            ["", ALONE].map(|lamp| spread(&films(&room(beta, finish, (lamp, ""), sky), 24)));
        let z = apart(&shared.0, &alone.0);
        assert!(z.abs() < 5.5, "{beta} {finish}: {z}");
        let (a, b) = (
            mean_and_variance(&shared.0).0,
            mean_and_variance(&alone.0).0,
        );
        stage::assert_relative(a, b, 5e-3, finish);
        assert!(shared.1 < alone.1, "{} {}", shared.1, alone.1);
    }
}

#[test]
fn sharing_paths_takes_half_of_the_noise_of_a_lit_room() {
    // With a lamp alone, direct light has no noise but at edges and shadows: of diffuse surfaces less than half of all noise is left, 1 where nothing
    // is shared. Ratios of variances of 12 films, over 768 pixels, are within some 10 % at edges.
    for (finish, falls) in [
        ("colour = [0.7, 0.6, 0.2]", 1.8),
        (
            "colour = [0.9, 0.6, 0.4]\nmetallic = 1\nroughness = 0.4",
            1.2,
        ),
    ] {
        let [shared, alone] = ["", ALONE].map(|lamp| {
            let mut scene = room(0.0, finish, (lamp, ""), "");
            // The panel is dark.
            scene
                .lights
                .retain(|light| matches!(light.kind, LightKind::Lamp(_)));
            spread(&films(&scene, 12)).1
        });
        let ratio = alone / shared;
        println!("{finish}: {ratio}");
        assert!(ratio > falls, "{finish}: {ratio}");
    }
}

#[test]
fn standard_errors_of_shared_paths_are_as_large_as_said() {
    let diffuse = "colour = [0.7, 0.6, 0.2]";
    let films = films(&room(0.0, diffuse, ("", ""), SKY), 32);
    let (count, n) = (stage::pixels(&films[0]), films.len() as f64);
    let said = |i: usize| {
        let squares = films
            .iter()
            .map(|film| stage::value(film, Aov::StandardError, i).powi(2));
        squares.sum::<f64>() / n
    };
    let said = (0..count).map(said).sum::<f64>() / count as f64;
    // Variances of 768 pixels from 32 films: some 64 of them independent, each within √(2/31), make 3 %.
    stage::assert_relative(said, spread(&films).1, 0.15, "variance");
}

#[test]
fn flashes_that_are_baked_from_shared_paths_add_up_to_steady_light() {
    // A flash of the energy E leaves, in all bins together, what a lamp of the intensity E shows. Lamp and panel flash at once.
    let sigma = 0.1;
    let energy = sigma * (2.0 * std::f64::consts::PI).sqrt();
    let flash = format!("emission = {{ gaussian = {{ time = \"0 m\", sigma = \"{sigma} m\" }} }}");
    let steady = format!(
        "emission = {{ table = [{{ time = \"-1000 m\", factor = {energy} }}, {{ time = \"1000 m\", factor = {energy} }}] }}"
    );
    let bins = Bins {
        start: -2.0,
        width: 2.0,
        count: 40,
    };
    for finish in [
        "colour = [0.7, 0.6, 0.2]",
        "colour = [0.9, 0.6, 0.4]\nmetallic = 1\nroughness = 0.4",
    ] {
        let baked: Vec<f64> = (0..24)
            .map(|seed| {
                let mut scene = room(0.0, finish, (&flash, &flash), "");
                scene.seed = seed;
                let baked = bake::camera_cube(
                    &scene,
                    &prepared(&scene),
                    &bins,
                    CubePrecision::Single,
                    None,
                    &Silent,
                );
                let cube = baked.unwrap().cube;
                let pixels = cube.shape[0] * cube.shape[1];
                let all =
                    (0..pixels).flat_map(|pixel| (0..bins.count).map(move |bin| (pixel, bin)));
                let sum: f64 = all.map(|(pixel, bin)| cube.total(pixel, bin) / 3.0).sum();
                sum / pixels as f64
            })
            .collect();
        let films = films(&room(0.0, finish, (&steady, &steady), ""), 24);
        let pictures = spread(&films).0;
        let z = apart(&baked, &pictures);
        let [a, b] = [&baked, &pictures].map(|means| mean_and_variance(means).0);
        println!("{finish}: z {z}, {a} {b}");
        assert!(z.abs() < 5.5, "{finish}: {z}");
        stage::assert_relative(a, b, 5e-3, finish);
    }
}
