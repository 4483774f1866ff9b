//! Light through glass, against closed forms.

use nullray::render::aov::Aov;
use nullray::render::bake::{self, Bins, CubePrecision};
use nullray::render::enclosed;
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;
use nullray::render::progress::Silent;
use nullray::scene::model::Scene;

use crate::pipeline::stage::{self, assert_relative};

const PI: f64 = std::f64::consts::PI;

#[test]
fn a_ball_of_glass_in_a_furnace_has_the_radiance_of_the_furnace_at_any_speed() {
    // L/n² does not change along rays, and what is not let through is reflected: a ball of clear glass is not to be seen where all
    // around has one radiance. Beyond 10 surfaces there are at most F⁸ of it, nothing but at the rim.
    for (beta, camera) in [(0.0, 0.0), (0.9, 0.9), (0.9, 0.6)] {
        let scene = stage::scene(&format!(
            "
render = {{ bounces = 9 }}
[camera]
eye = [-1.2, 0.2, 0.1]
look_at = [0, 0, 0]
hfov = \"60 deg\"
size = [60, 45]
velocity = {{ beta = [{camera}, 0, 0] }}
[[object]]
name = \"furnace\"
shape = {{ box = {{ size = [6, 6, 6] }} }}
colour = [0, 0, 0]
velocity = {{ beta = [{beta}, 0, 0] }}
[[object]]
name = \"ball\"
shape = {{ sphere = {{ radius = 0.7, subdivisions = 4 }} }}
colour = [1, 1, 1]
transmission = 1
velocity = {{ beta = [{beta}, 0, 0] }}
[[light]]
type = \"area\"
object = \"furnace\"
radiance = 2
[display]
back_faces = \"two_sided\"
samples_per_pixel = 16"
        ));
        let film = stage::rendered(&scene, &stage::sampled()).unwrap();
        let ball: Vec<_> = (0..stage::pixels(&film))
            .filter(|i| stage::value(&film, Aov::Object, *i) == 1.0)
            .collect();
        assert!(ball.len() > 60, "{}", ball.len());
        let in_rest = |i: &usize| {
            let w = stage::value(&film, Aov::WavelengthRatio, *i);
            film.radiance()[*i][0] * w.powi(4)
        };
        let mean = ball.iter().map(in_rest).sum::<f64>() / ball.len() as f64;
        // Samples weigh 0.4 to 1.1 times the radiance: a chance of 0.3/√(16 · 60) at most.
        assert_relative(
            mean,
            2.0,
            2e-2,
            format!("{beta} {camera}: {} pixels", ball.len()),
        );
    }
}

/// A wall behind half a metre of glass of index 1.5, lit by a lamp half a metre before it; all of it at the speed `beta`.
fn behind_glass(beta: f64, emission: &str, samples: u32) -> Scene {
    let velocity = format!("velocity = {{ beta = [{beta}, 0, 0] }}");
    let mut scene = stage::scene(&format!(
        "
render = {{ bounces = 2 }}
[camera]
eye = [0, 0, 3]
look_at = [0, 0, 0]
hfov = \"1 deg\"
size = [32, 32]
{velocity}
[[object]]
name = \"wall\"
shape = {{ plane = {{ size = [4, 4] }} }}
transform = {{ rotate = {{ axis = [1, 0, 0], angle = \"90 deg\" }} }}
colour = [0.5, 0.5, 0.5]
{velocity}
[[object]]
name = \"glass\"
shape = {{ box = {{ size = [4, 4, 0.5] }} }}
transform = {{ translate = [0, 0, 1.25] }}
colour = [1, 1, 1]
transmission = 1
ior = 1.5
{velocity}
[[light]]
position = [0, 0, 0.5]
intensity = 1
{velocity}
emission.{emission}"
    ));
    scene.samples_per_pixel = samples;
    scene
}

#[test]
fn light_comes_late_through_glass_by_its_index_at_any_speed() {
    // 3 m of way and half a metre of glass, n − 1 = 1/2 of that more, and half a metre from the lamp: emission at −3.75 m, where a lamp whose
    // intensity is its time + 10 m has 6.25. Of it 0.96² get through, at 4 % each; (1 m/0.5 m)² ρ/π of that is seen.
    for beta in [0.0, 0.6] {
        let ramp = "table = [{ time = \"-10 m\", factor = 0 }, { time = \"10 m\", factor = 20 }]";
        let film = stage::rendered(&behind_glass(beta, ramp, 64), &stage::sampled()).unwrap();
        let n = stage::pixels(&film);
        let mean = film.radiance().iter().map(|l| l[1]).sum::<f64>() / n as f64;
        let expected = 0.96 * 0.96 * 4.0 * 0.5 / PI * 6.25;
        // One of 0.81 samples is let through twice: 0.48/√65,536 = 0.2 % of chance, and 4 % without the delay of the glass.
        assert_relative(mean, expected, 1e-2, beta);
    }
}

#[test]
fn baked_light_comes_late_through_glass_by_its_index() {
    let scene = behind_glass(0.0, "gaussian = { sigma = \"1 mm\" }", 64);
    let plan = Plan::new(&scene, &Request::default()).unwrap();
    let prepared = Prepared::new(&scene, &plan, &Silent).unwrap();
    let bins = Bins {
        start: 3.5,
        width: 0.01,
        count: 50,
    };
    let baked = bake::camera_cube(
        &scene,
        &prepared,
        &bins,
        CubePrecision::Single,
        None,
        &Silent,
    )
    .unwrap();
    let energy = |bin: usize| (0..32 * 32).map(|p| baked.cube.total(p, bin)).sum::<f64>();
    let all: f64 = (0..50).map(energy).sum();
    // Bins 24 and 25 meet at 3.75 m.
    assert!(
        (energy(24) + energy(25)) / all > 0.99,
        "{}",
        (energy(24) + energy(25)) / all
    );
}

#[test]
fn a_film_of_glass_is_seen_through_unbent_and_twice_reflecting() {
    // A plane has no inside: what is behind it stays where it is, and 1 − 2F/(1 + F) of it comes through, F = 0.04.
    let scene = stage::scene(
        "
render = { bounces = 1 }
[camera]
eye = [0, 0, 3]
look_at = [0, 0, 0]
hfov = \"1 deg\"
size = [32, 32]
[[object]]
name = \"panel\"
shape = { plane = { size = [4, 4] } }
transform = { rotate = { axis = [1, 0, 0], angle = \"90 deg\" } }
colour = [0, 0, 0]
[[object]]
shape = { plane = { size = [4, 4] } }
transform = { translate = [0, 0, 1], rotate = { axis = [1, 0, 0], angle = \"90 deg\" } }
colour = [0.5, 1, 1]
transmission = 1
[[light]]
type = \"area\"
object = \"panel\"
radiance = 1
[display]
samples_per_pixel = 64",
    );
    let film = stage::rendered(&scene, &stage::sampled()).unwrap();
    let n = stage::pixels(&film) as f64;
    let mean = |c: usize| film.radiance().iter().map(|l| l[c]).sum::<f64>() / n;
    let through = 1.0 - 0.08 / 1.04;
    assert_relative(mean(1), through, 5e-3, "green");
    assert_relative(mean(0), 0.5 * through, 5e-3, "red");
}

#[test]
fn a_camera_inside_a_body_of_glass_is_found_there_and_only_there() {
    let around = |eye: [f64; 3], keys: &str, bounces: u32| {
        let scene = stage::scene(&format!(
            "
render.bounces = {bounces}
[camera]
eye = {eye:?}
look_at = [0, 0, -9]
size = [4, 4]
[[object]]
name = \"floor\"
shape = {{ plane = {{ size = [9, 9] }} }}
transform = {{ translate = [0, -3, 0] }}
[[object]]
name = \"glass\"
{keys}
[sky]
radiance = 1"
        ));
        let plan = Plan::new(&scene, &Request::default()).unwrap();
        enclosed::glass_around_camera(&Prepared::new(&scene, &plan, &Silent).unwrap())
    };
    let block = "shape = { box = { size = [2, 2, 2] } }\ntransmission = 1\n";
    for (eye, expected) in [
        ([0.0, 0.0, 0.999], Some(1)),
        ([0.9, -0.9, 0.0], Some(1)),
        ([0.0, 0.0, 1.001], None),
        ([0.0, 1.5, 0.0], None),
    ] {
        assert_eq!(around(eye, block, 2), expected, "{eye:?}");
    }
    // Opaque without bounces; a plane has no inside; and others are no glass.
    let plane = "shape = { plane = { size = [2, 2] } }\ntransmission = 1\n";
    assert_eq!(around([0.0; 3], block, 0), None);
    assert_eq!(around([0.0, 1e-3, 0.0], plane, 2), None);
    assert_eq!(
        around([0.0; 3], &block.replace("transmission", "metallic"), 2),
        None
    );
    // Contracted to 0.8 m on each side of its centre, where it is when the camera's clock shows 0.
    let moving = format!("{block}velocity = {{ beta = [0.6, 0, 0] }}\n");
    assert_eq!(around([0.79, 0.0, 0.0], &moving, 2), Some(1));
    assert_eq!(around([0.81, 0.0, 0.0], &moving, 2), None);
}
