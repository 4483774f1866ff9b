//! Light from surface to surface, against closed forms.

use glam::DVec3;
use nullray::render::aov::Aov;
use nullray::render::film::Film;
use nullray::render::plan::Plan;
use nullray::render::prepare::Prepared;
use nullray::render::progress::Silent;
use nullray::scene::model::Scene;

use crate::pipeline::lorentz;
use crate::pipeline::stage::{self, assert_relative};

const PI: f64 = std::f64::consts::PI;

/// `scene` with so many bounces.
fn with(scene: &Scene, bounces: u32) -> Scene {
    let mut scene = scene.clone();
    scene.bounces = bounces;
    scene
}

/// The film of all samples of `scene`.
fn sampled(scene: &Scene) -> Film {
    stage::rendered(scene, &stage::sampled()).unwrap()
}

/// The mean of channel `c` over `pixels`.
fn mean(film: &Film, pixels: &[usize], c: usize) -> f64 {
    let sum: f64 = pixels.iter().map(|i| film.radiance()[*i][c]).sum();
    sum / pixels.len() as f64
}

/// A closed box whose walls have this red albedo and shine, in motion along x, seen from within by a camera in motion along x.
fn furnace(
    bounces: i32,
    albedo: f64,
    [beta, camera]: [f64; 2],
    radiance: f64,
    samples: u32,
) -> Scene {
    stage::scene(&format!(
        "
render = {{ bounces = {bounces} }}
[camera]
eye = [0.1, 0.2, 0.1]
look_at = [1, 0.3, 0.4]
hfov = \"80 deg\"
size = [120, 90]
velocity = {{ beta = [{camera}, 0, 0] }}
[[object]]
name = \"furnace\"
shape = {{ box = {{ size = [6, 3, 3] }} }}
colour = [{albedo}, 0.3, 0.1]
velocity = {{ beta = [{beta}, 0, 0] }}
[[light]]
type = \"area\"
object = \"furnace\"
radiance = {radiance}
[display]
back_faces = \"two_sided\"
samples_per_pixel = {samples}"
    ))
}

#[test]
fn a_closed_furnace_at_any_speed_has_the_radiance_of_its_walls_series() {
    // Walls of radiance e and albedo ρ are lit by π e, again by π ρ e, and so on: e (1 + ρ + … + ρᴺ⁺¹), W⁻⁴ of it seen.
    let (bounces, albedo) = (7, 0.6);
    let series: f64 = (0..=bounces + 1).map(|k| f64::powi(albedo, k)).sum();
    for (beta, camera) in [(0.0, 0.0), (0.95, 0.95), (0.6, -0.3)] {
        let scene = furnace(bounces, albedo, [beta, camera], 2.0, 1);
        let film = stage::film(&scene);
        let met = stage::met(&film);
        assert_eq!(met.len(), 120 * 90);
        let in_rest = |i: &usize| {
            let w = stage::value(&film, Aov::WavelengthRatio, *i);
            film.radiance()[*i][0] * w.powi(4)
        };
        let mean = met.iter().map(in_rest).sum::<f64>() / met.len() as f64;
        // 10800 samples, each within some 0.1 of the mean.
        assert_relative(mean, 2.0 * series, 3e-3, format!("{beta} {camera}"));
    }
}

#[test]
fn walls_that_emit_what_they_absorb_have_one_radiance_to_a_thousandth() {
    // Kirchhoff: walls of albedo ρ that emit (1 − ρ) L show L, but for ρᴺ⁺² of it after N bounces. Of 345,600 samples, which spread by 0.03 to 0.09
    // of the mean, the mean has an error of 1.5·10⁻⁴ at most: fewer than 10⁻⁶ of right means are off by 10⁻³.
    let (bounces, albedo, radiance) = (12, 0.5, 2.0);
    for (beta, camera) in [(0.0, 0.0), (0.9, 0.0), (0.0, 0.9)] {
        let emitted = (1.0 - albedo) * radiance;
        let scene = furnace(bounces, albedo, [beta, camera], emitted, 32);
        let film = sampled(&scene);
        let all = stage::met(&film);
        assert_eq!(all.len(), 120 * 90);
        // Each pixel's own W, whose fourth power varies over a pixel by 10⁻⁴ of it at most.
        let in_rest = |i: &usize| {
            let w = stage::value(&film, Aov::WavelengthRatio, *i);
            film.radiance()[*i][0] * w.powi(4)
        };
        let mean = all.iter().map(in_rest).sum::<f64>() / all.len() as f64;
        assert_relative(mean, radiance, 1e-3, format!("{beta} {camera}"));
    }
}

/// ∫ L dω of an equirectangular film of 64 × 32 pixels.
fn from_all_sides(film: &Film) -> f64 {
    let row = |i: usize| {
        // Rows are evenly spaced in latitude.
        let edge = |row: usize| (row as f64 * PI / 32.0).cos();
        let solid_angle = 2.0 * PI / 64.0 * (edge(i) - edge(i + 1));
        let pixels = &film.radiance()[64 * i..64 * (i + 1)];
        pixels.iter().map(|rgb| rgb[0]).sum::<f64>() * solid_angle
    };
    (0..32).map(row).sum()
}

/// [`from_all_sides`] of films with the seeds from 0 on, of one preparation.
fn of_seeds(scene: &Scene, seeds: u32) -> Vec<f64> {
    let plan = Plan::new(scene, &stage::sampled()).unwrap();
    let mut prepared = Prepared::new(scene, &plan, &Silent).unwrap();
    let of_seed = |seed| {
        prepared.sampler = prepared.sampler.with_seed(seed);
        from_all_sides(&nullray::render::render(&prepared, &Silent).unwrap())
    };
    (0..seeds).map(of_seed).collect()
}

/// The mean of eight numbers, and the square of its standard error.
fn of_eight(all: Vec<f64>) -> (f64, f64) {
    let mean = all.iter().sum::<f64>() / 8.0;
    let squares: f64 = all.iter().map(|x| (x - mean).powi(2)).sum();
    (mean, squares / (8.0 * 7.0))
}

#[test]
fn a_lamp_and_a_sensor_that_change_places_see_as_much_of_each_other() {
    // Surfaces reflect as much from l to v as from v to l, and the light of a small lamp that comes to a small sensor from all sides, over any
    // number of surfaces, is the same when the two change places: ∫ L dω of 8 seeds each way. They differ by more than 5 of their standard errors
    // in 2·10⁻⁴ of cases (Student's t of 14 degrees of freedom). At rest; among bodies in motion see below.
    let places = [[-0.5, 1.7, 0.9], [1.3, 0.6, 0.7]];
    let fluences = |eye: [f64; 3], lamp: [f64; 3]| -> Vec<f64> {
        let scene = stage::scene(&format!(
            "
render = {{ bounces = 3 }}
[camera]
eye = {eye:?}
look_at = [{}, {}, -9]
size = [64, 32]
projection = \"equirectangular\"
[[object]]
shape = {{ plane = {{ size = [4, 4] }} }}
colour = [0.8, 0.5, 0.3]
[[object]]
shape = {{ box = {{ size = [0.7, 1.4, 0.7] }} }}
transform = {{ translate = [0.4, 0.7, 0.8], rotate = {{ axis = [0, 1, 0], angle = \"30 deg\" }} }}
colour = [0.7, 0.8, 0.9]
[[object]]
shape = {{ box = {{ size = [4, 2, 0.1] }} }}
transform = {{ translate = [0, 1, -1] }}
colour = [0.9, 0.6, 0.5]
metallic = 1
roughness = 0.5
[[light]]
position = {lamp:?}
[display]
samples_per_pixel = 32",
            eye[0], eye[1]
        ));
        of_seeds(&scene, 8)
    };
    let [a, b] = places;
    let ((there, error), (back, other)) = (of_eight(fluences(a, b)), of_eight(fluences(b, a)));
    let error = (error + other).sqrt();
    assert!(
        (there - back).abs() < 5.0 * error,
        "{there} and {back} ± {error}"
    );
    assert!(error < 5e-3 * there, "{there} ± {error}");
}

#[test]
fn among_moving_bodies_lamp_and_sensor_change_places_where_time_runs_backwards() {
    // A lamp at rest in u sends photons evenly to all sides. With D(s) = δ(s²)/2π of the null separation s, and n the normal of a surface at rest in
    // v, as four-vectors, photons that come to a part of its world sheet are D (s·n)/(s·u)² of those that left; of them ρ 4 (s′·n)/(s′·v)³ D(s′)
    // (s′·w) come per area to a sensor at rest in w, of all directions. Backwards in time all separations and velocities are reversed, and
    // these products stay. So of one path, with κ s the photon's momentum, κ s·v = κ′ s′·v where it is reflected, and f = (κ′ s′·w)/(κ s·u) the
    // frequency at the sensor over that at the lamp,
    //
    //     photons there / photons back = (s′·w)³ (s·v)³/((s·u)³ (s′·v)³) = f³,
    //
    // and by induction over any number of surfaces, and of any material that reflects as much from l to v as from v to l: only the lamp's
    // and the sensor's ends of the path are left. What counts photons as frequency^(−3/2) is the same both ways, for each path. That does the spectrum
    // λ^(−7/2), which a shift multiplies at each wavelength: W⁻⁵ W^(7/2) = W^(−3/2), and f = 1/W. Times: the lamp emits for as long as the shutter is open on the
    // way back, and sums over both windows are of the same pairs of events.
    //
    // Eight seeds each way differ by more than 5 of their standard errors in 2·10⁻⁴ of cases (Student's t of 14 degrees of freedom).
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, power: f64| {
        // From 30 nm to 30 µm: shifts of the few reflections stay far within. Steps of 1.7 % leave the power true to 10⁻³.
        let row = |k: i32| {
            let x = 30.0 * 1000f64.powf(f64::from(k) / 400.0);
            format!("{x:e},{:e}\n", (x / 550.0).powf(power))
        };
        let rows: String = (0..=400).map(row).collect();
        std::fs::write(folder.path().join(name), format!("nm,W\n{rows}")).unwrap();
    };
    write("even.csv", -3.5);
    write("flat.csv", 0.0);
    // Where the lamp and the sensor are when their clocks show 0, and the lamp's velocity; the sensor rests.
    let (a, b, v) = ([-1.2, 1.1, 0.9], [1.3, 0.6, 0.7], [0.0, 0.3, 0.2]);
    // By their clocks the lamp shines from −1.2 m on and the sensor sees from 2.2 m on, for 1.5 m.
    let (shines, sees, long) = (-1.2, 2.2, 1.5);
    let scene = |spectrum: &str, is_back: bool| -> Scene {
        let s = if is_back { -1.0 } else { 1.0 };
        let reversed = |from: f64| -from - long;
        let (eye, lamp, time, from) = match is_back {
            false => (b, a, sees, shines),
            true => (a, b, reversed(shines), reversed(sees)),
        };
        let velocities = match is_back {
            false => ([0.0; 3], v),
            true => (v.map(|x| -x), [0.0; 3]),
        };
        let emission: String = [
            (0.0, -1e-3),
            (1.0, 1e-3),
            (1.0, long - 1e-3),
            (0.0, long + 1e-3),
        ]
        .iter()
        .map(|(factor, at)| format!("{{ time = \"{} m\", factor = {factor} }},", from + at))
        .collect();
        stage::scene_in(
            folder.path(),
            &format!(
                "
render = {{ bounces = 2, spectra = \"sampled\" }}
[camera]
eye = {eye:?}
look_at = [{}, {}, -9]
size = [64, 32]
projection = \"equirectangular\"
time = \"{time} m\"
shutter = {{ duration = \"{long} m\" }}
velocity = {{ beta = {:?} }}
[radiance]
quantity = \"rgb\"
[[object]]
shape = {{ plane = {{ size = [5, 5] }} }}
colour = [0.8, 0.8, 0.8]
[[object]]
shape = {{ box = {{ size = [1.6, 1.4, 0.7] }} }}
velocity = {{ beta = [{}, 0, 0] }}
origin = {{ position = [0.1, 0.7, -0.4], time = \"{} m\" }}
colour = [0.9, 0.9, 0.9]
[[object]]
shape = {{ box = {{ size = [0.8, 1.2, 0.8] }} }}
velocity = {{ beta = [{}, 0, {}] }}
origin = {{ position = [0.5, 0.8, 1.9], time = \"{} m\" }}
colour = [0.7, 0.7, 0.7]
[[light]]
position = {lamp:?}
velocity = {{ beta = {:?} }}
spectrum = {{ table = \"{spectrum}\" }}
intensity = 1
emission.table = [{emission}]
[display]
back_faces = \"two_sided\"
samples_per_pixel = 64",
                eye[0],
                eye[1],
                velocities.0,
                0.6 * s,
                0.9 * s,
                -0.4 * s,
                0.3 * s,
                0.9 * s,
                velocities.1,
            ),
        )
    };
    let [(there, error), (back, other)] =
        [false, true].map(|is_back| of_eight(of_seeds(&scene("even.csv", is_back), 8)));
    let error = (error + other).sqrt();
    assert!(
        (there - back).abs() < 5.0 * error,
        "{there} and {back} ± {error}"
    );
    assert!(error < 5e-3 * there, "{there} ± {error}");
    // Of energies by wavelength it is not so.
    let [there, back] = [false, true].map(|is_back| of_seeds(&scene("flat.csv", is_back), 1)[0]);
    assert!((there / back - 1.0).abs() > 0.1, "{there} and {back}");
}

#[test]
fn light_in_an_integrating_sphere_falls_by_its_series_and_comes_late_by_chords() {
    // All of a sphere sees all of it alike: what falls anywhere falls again, times ρ, everywhere. Chords that leave a point with
    // the cosine have the density s/(2R²) up to 2R, and the mean 4R/3. With a lamp at the centre whose intensity is its time,
    // L = ρ/(πR²) Σ ρᵏ (t − R − k 4R/3), t the time at the wall; in the sphere's frame, whatever its speed.
    let (albedo, bounces, radius) = (0.7, 5, 1.5);
    for beta in [0.0, 0.8] {
        let scene = stage::scene(&format!(
            "
render = {{ bounces = {bounces} }}
[camera]
eye = [0.3, 0.2, 0.1]
look_at = [1, 0.3, 0.4]
hfov = \"70 deg\"
size = [80, 60]
[[object]]
name = \"sphere\"
shape = {{ sphere = {{ radius = {radius}, subdivisions = 5 }} }}
colour = [{albedo}, 0.5, 0.1]
velocity = {{ beta = [{beta}, 0, 0] }}
[[light]]
position = [0, 0, 0]
velocity = {{ beta = [{beta}, 0, 0] }}
intensity = 1
emission.table = [{{ time = \"-100 m\", factor = 0 }}, {{ time = \"100 m\", factor = 200 }}]
[display]
back_faces = \"two_sided\""
        ));
        let film = stage::film(&scene);
        let (mut got, mut expected) = (0.0, 0.0);
        for i in stage::met(&film) {
            let w = stage::value(&film, Aov::WavelengthRatio, i);
            let t = stage::value(&film, Aov::ObjectEventCt, i) + 100.0;
            let series: f64 = (0..=bounces)
                .map(|k| {
                    let late = radius + f64::from(k) * 4.0 * radius / 3.0;
                    f64::powi(albedo, k) * (t - late)
                })
                .sum();
            got += film.radiance()[i][0] * w.powi(4);
            expected += albedo / (PI * radius * radius) * series;
        }
        assert_relative(got, expected, 2e-3, beta);
        // Without the delays it would be 4 % more.
        let delays: f64 = (0..=bounces)
            .map(|k| f64::powi(albedo, k) * f64::from(k) * 2.0)
            .sum();
        assert!(delays > 0.02 * expected / 4800.0);
    }
}

#[test]
fn plates_that_slide_past_each_other_light_each_other_with_gamma() {
    // A wide plate of radiance L sends T⁰ᶻ = π L up, and Tˣᶻ = 0. One that slides past above it at β receives, in its own frame,
    // γ (T⁰ᶻ − β Tˣᶻ) = γ π L, and shows ρ γ L; the lower plate receives that in the same way. So it shows e Σ (ρ γ)²ʲ.
    let (albedo, bounces) = (0.5, 4);
    for beta in [0.0, 0.4] {
        let scene = stage::scene(&format!(
            "
render = {{ bounces = {bounces} }}
[camera]
eye = [0, 0.5, 0]
look_at = [0, 0, 0]
up = [1, 0, 0]
hfov = \"60 deg\"
size = [200, 150]
[[object]]
name = \"below\"
shape = {{ plane = {{ size = [300, 300] }} }}
colour = [{albedo}, 0.3, 0.1]
[[object]]
name = \"above\"
shape = {{ box = {{ size = [300, 0.01, 300] }} }}
transform = {{ translate = [0, 1.005, 0] }}
colour = [{albedo}, 0.3, 0.1]
velocity = {{ beta = [{beta}, 0, 0] }}
[[light]]
type = \"area\"
object = \"below\"
radiance = 3"
        ));
        let film = stage::film(&scene);
        let gamma = 1.0 / f64::sqrt(1.0 - beta * beta);
        // Reflected 2, 4, … times, and N + 1 times at most.
        let series: f64 = (0..=(bounces + 1) / 2)
            .map(|j| (albedo * gamma).powi(2 * j))
            .sum();
        let all: Vec<usize> = (0..stage::pixels(&film)).collect();
        // 30000 samples, each within about the mean; 5.5 % less at rest.
        assert_relative(mean(&film, &all, 0), 3.0 * series, 6e-3, beta);
    }
}

#[test]
fn a_mirror_in_motion_reflects_by_einsteins_law() {
    // A mirror that moves with β along its normal n, towards the observer: light that leaves it at θᵣ to n with νᵣ came
    // with νᵢ = νᵣ γ² (1 − 2β cos θᵣ + β²) (Einstein 1905, § 8), and with the same momentum along the mirror:
    // νᵢ sin θᵢ = νᵣ sin θᵣ. L goes with ν⁴. Fresnel's factor is 1.
    for beta in [0.0, 0.4, -0.7] {
        let scene = stage::scene(&format!(
            "
render = {{ bounces = 1 }}
[camera]
eye = [0.5, 8, 3]
look_at = [0, 0, 0]
hfov = \"40 deg\"
size = [40, 30]
[[object]]
name = \"mirror\"
shape = {{ plane = {{ size = [300, 300] }} }}
colour = [1, 1, 1]
metallic = 1
roughness = 0
velocity = {{ beta = [0, {beta}, 0] }}
[sky]
gradient = {{ zenith = [4, 1, 1], horizon = [1, 1, 1] }}"
        ));
        let film = stage::film(&scene);
        let met = stage::met(&film);
        assert!(met.len() > 1000);
        for i in met {
            let seen = -stage::direction(&film, i);
            let ratio = (1.0 - 2.0 * beta * seen.y + beta * beta) / (1.0 - beta * beta);
            let sine = (1.0 - seen.y * seen.y).sqrt() / ratio;
            // Receding fast, what comes is what the mirror overtakes, from below.
            let up = (1.0 - sine * sine).sqrt();
            let square = (1.0 - up) * (1.0 - up);
            let sky = 1.0 + 3.0 * (1.0 - square * square);
            let expected = sky / ratio.powi(4);
            let in_mirror = (seen.y - beta) / (1.0 - beta * seen.y);
            let comes_from_above = in_mirror + beta > 0.0;
            if in_mirror > 0.0 && comes_from_above {
                let got = film.radiance()[i][0];
                assert_relative(got, expected, 1e-9, format!("{beta} {i}"));
            }
        }
    }
}

#[test]
fn light_that_is_drawn_both_ways_is_direct_light() {
    // What is lit reflects to nothing that does: one bounce more changes nothing, but that highlights, panel and sky are also
    // found by the rays that go on.
    let lit = |finish: &str, light: &str| {
        stage::scene(&format!(
            "
[camera]
eye = [0, 2.5, 4]
look_at = [0, 0, 0]
hfov = \"50 deg\"
size = [24, 18]
[[object]]
name = \"floor\"
shape = {{ plane = {{ size = [6, 6] }} }}
colour = [0.8, 0.5, 0.2]
{finish}
[[object]]
name = \"block\"
shape = {{ box = {{ size = [0.8, 0.6, 0.8] }} }}
colour = [0, 0, 0]
transform = {{ translate = [1, 0.3, 0.5] }}
velocity = {{ beta = [0.3, 0, 0] }}
{light}
[display]
samples_per_pixel = 1024"
        ))
    };
    let panel = "[[object]]\nname = \"panel\"\nshape = { box = { size = [1.5, 0.1, 1] } }\ncolour = [0, 0, 0]\n\
                 transform = { translate = [0, 1.5, -1.5] }\nvelocity = { beta = [0, 0, 0.5] }\n\
                 [[light]]\ntype = \"area\"\nobject = \"panel\"\nradiance = [3, 2, 1]\n";
    let sky =
        "[sky]\ngradient = { zenith = [0.3, 0.5, 1], horizon = [1, 1, 0.8], ground = [0, 0, 0] }\n";
    for finish in ["", "metallic = 0.5\nroughness = 0.35\n"] {
        for light in [panel, sky] {
            let scene = lit(finish, light);
            let (direct, both) = (sampled(&scene), sampled(&with(&scene, 1)));
            let floor: Vec<usize> = stage::met(&direct)
                .into_iter()
                .filter(|i| stage::value(&direct, Aov::Object, *i) == 0.0)
                .collect();
            assert!(floor.len() > 200);
            for c in 0..3 {
                let [a, b] = [&direct, &both].map(|film| mean(film, &floor, c));
                assert_relative(b, a, 5e-3, format!("{finish} {c}"));
            }
        }
    }
}

#[test]
fn lights_of_several_frames_add_up_to_all_of_them() {
    // Each shines alone in a scene with all bodies, and then all do: of those one is chosen for each draw.
    let bodies = [
        (
            "ball",
            "sphere = { radius = 0.4, subdivisions = 3 }",
            [-1.2, 1.0, 0.0],
            [0.6, 0.0, 0.0],
        ),
        (
            "panel",
            "box = { size = [1.5, 0.1, 1] }",
            [0.0, 1.5, -1.5],
            [0.0, 0.0, 0.5],
        ),
        (
            "tube",
            "box = { size = [0.05, 0.05, 0.5] }",
            [1.5, 0.3, 0.5],
            [0.0, 0.0, 0.0],
        ),
        (
            "saucer",
            "box = { size = [0.6, 0.1, 0.6] }",
            [0.5, 0.4, 1.0],
            [-0.5, 0.0, 0.2],
        ),
    ];
    let lit = |which: &[&str], bounces: u32| {
        let mut text = format!(
            "
render = {{ bounces = {bounces} }}
[camera]
eye = [0, 2.5, 4]
look_at = [0, 0, 0]
hfov = \"50 deg\"
size = [24, 18]
[[object]]
name = \"floor\"
shape = {{ plane = {{ size = [6, 6] }} }}
colour = [0.8, 0.5, 0.2]
velocity = {{ beta = [0, 0, -0.4] }}
[display]
samples_per_pixel = 1024
"
        );
        for (name, shape, at, beta) in bodies {
            text += &format!(
                "[[object]]\nname = \"{name}\"\nshape = {{ {shape} }}\ncolour = [0, 0, 0]\n\
                 transform = {{ translate = {at:?} }}\nvelocity = {{ beta = {beta:?} }}\n"
            );
            if which.contains(&name) {
                text += &format!(
                    "[[light]]\ntype = \"area\"\nobject = \"{name}\"\nradiance = [3, 2, 1]\n"
                );
            }
        }
        sampled(&stage::scene(&text))
    };
    for bounces in [0, 1] {
        let all = lit(&bodies.map(|(name, ..)| name), bounces);
        let floor: Vec<usize> = stage::met(&all)
            .into_iter()
            .filter(|i| stage::value(&all, Aov::Object, *i) == 0.0)
            .collect();
        assert!(floor.len() > 150);
        let alone = bodies.map(|(name, ..)| lit(&[name], bounces));
        let sum: f64 = alone.iter().map(|film| mean(film, &floor, 0)).sum();
        assert!(alone.iter().all(|film| mean(film, &floor, 0) > 0.1 * sum));
        assert_relative(mean(&all, &floor, 0), sum, 3e-3, bounces);
    }
}

#[test]
fn boosting_everything_changes_rounding_only() {
    let scene = stage::scene(
        "
render = { bounces = 3 }
[camera]
eye = [0, 1.4, 5]
look_at = [0, 0.7, 0]
hfov = \"50 deg\"
size = [48, 36]
velocity = { beta = [0.3, 0, 0] }
[[object]]
name = \"floor\"
shape = { plane = { size = [9, 9] } }
colour = [0.8, 0.5, 0.2]
[[object]]
name = \"ball\"
shape = { sphere = { radius = 0.7, subdivisions = 3 } }
metallic = 1
roughness = 0.3
transform = { translate = [0, 0.8, 0] }
velocity = { beta = [0.5, 0, 0] }
origin = { time = \"-4 m\" }
[[object]]
name = \"panel\"
shape = { box = { size = [2, 0.1, 1] } }
transform = { translate = [-1, 2, 0] }
velocity = { beta = [-0.4, 0, 0] }
[[light]]
type = \"area\"
object = \"panel\"
radiance = [3, 2, 1]
[[light]]
position = [2, 3, 2]
intensity = 9
[radiance]
quantity = \"rgb\"",
    );
    let boosted = lorentz::boosted(&scene, DVec3::X * f64::atanh(0.7));
    let (a, b) = (stage::film(&scene), stage::film(&boosted));
    let same = a
        .radiance()
        .iter()
        .zip(b.radiance())
        .filter(|(a, b)| (0..3).all(|c| (a[c] - b[c]).abs() <= 1e-9 * (a[c].abs() + 1e-3)));
    // A ray in a thousand may find an edge on its other side.
    let (same, all) = (same.count(), stage::pixels(&a));
    assert!(same * 500 >= all * 499, "{same} of {all}");
    assert!(mean(&a, &stage::met(&a), 1) > 0.02);
}

#[test]
fn pictures_with_bounces_are_the_same_on_any_number_of_threads() {
    let scene = stage::scene(
        "
render = { bounces = 2 }
[camera]
eye = [0, 1.4, 5]
look_at = [0, 0.7, 0]
hfov = \"50 deg\"
size = [40, 30]
[[object]]
name = \"floor\"
shape = { plane = { size = [9, 9] } }
[[object]]
name = \"ball\"
shape = { sphere = { radius = 0.7, subdivisions = 3 } }
velocity = { beta = [0.5, 0, 0] }
[sky]
gradient = {}",
    );
    let [one, three] = [1, 3].map(|threads| stage::on(threads, || sampled(&scene)));
    assert_eq!(one.radiance(), three.radiance());
}
