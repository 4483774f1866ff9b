//! A pulse of light on surfaces at rest, against its closed form.
//!
//! Irradiance at distance r from the source: I g((t − t₀ − r)/σ)/σ · cos θ / r² with g the unit Gaussian,
//! cut off at 8 σ (where g is 5·10⁻¹⁵); reflected as albedo/π of it. Seen at time T from distance s,
//! t = T − s: the exponent is constant where |x − S| + |x − C| is, on ellipsoids with the source S and
//! the camera C as their foci.

use glam::DVec3;
use nullray::render::aov::Aov;
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;
use nullray::render::progress::Silent;
use nullray::scene::model::{Pulse, Scene, SourceKind};

use crate::pipeline::stage::{self, assert_relative};

const TAU: f64 = std::f64::consts::TAU;

/// A floor under a pulse.
fn floor() -> Scene {
    stage::scene(
        "
[camera]
eye = [1, 3, 4]
look_at = [0, 0, 0]
hfov = \"60 deg\"
size = [48, 36]
clock_zero = \"7 m\"
[[object]]
name = \"floor\"
shape = { plane = { size = [8, 8] } }
colour = [0.5, 0.25, 0.75]
[[source]]
pulse = { position = [0.7, 1.9, -0.4], time = \"0.3 m\", sigma = \"0.4 m\", intensity = [2, 1, 0.5] }
",
    )
}

fn pulse(scene: &mut Scene) -> &mut Pulse {
    match &mut scene.sources[0].kind {
        SourceKind::Pulse(pulse) => pulse,
        SourceKind::Cube(_) => unreachable!(),
    }
}

/// g(x), without the cut.
fn gauss(x: f64) -> f64 {
    (-0.5 * x * x).exp() / TAU.sqrt()
}

/// Where the ray through pixel `i` meets the floor, worked out from the camera alone.
fn on_floor(scene: &Scene, i: usize) -> (DVec3, f64) {
    let eye = scene.camera.origin.x;
    let d = stage::through(&scene.camera, i);
    let s = -eye.y / d.y;
    (eye + d * s, s)
}

#[test]
fn a_floor_in_a_pulse_has_the_radiance_of_the_closed_form() {
    let mut scene = floor();
    let film = stage::film(&scene);
    let pulse = pulse(&mut scene).clone();
    let mut lit = 0;
    for i in stage::met(&film) {
        let (x, s) = on_floor(&scene, i);
        let r = x.distance(pulse.origin.x);
        let late = (7.0 - s - r - 0.3) / 0.4;
        let got = film.radiance()[i];
        if late.abs() > 8.0 {
            assert_eq!(got, [0.0; 3]);
            continue;
        }
        let irradiance = gauss(late) / 0.4 * (1.9 / r) / (r * r);
        for ((got, albedo), intensity) in
            got.into_iter().zip([0.5, 0.25, 0.75]).zip([2.0, 1.0, 0.5])
        {
            let expected = albedo / (TAU / 2.0) * intensity * irradiance;
            // The exponent late²/2 ≤ 32 magnifies rounding.
            assert_relative(got, expected, 1e-12, format!("pixel {i} at {late:.2} σ"));
        }
        lit += 1;
    }
    assert!(lit > 500, "{lit}");
}

#[test]
fn the_brightest_curve_is_on_the_ellipsoid_between_source_and_camera() {
    let mut scene = floor();
    let film = stage::film(&scene);
    let source = pulse(&mut scene).origin.x;
    let mut nearest = f64::INFINITY;
    for i in stage::met(&film) {
        let (x, s) = on_floor(&scene, i);
        let r = x.distance(source);
        // How bright it is for a lamp at its distance and angle: g(δ/σ)/σ, so |δ| = σ √(−2 ln(g/g(0))).
        let g = film.radiance()[i][0] * (TAU / 2.0) / 0.5 / 2.0 * r.powi(3) / 1.9 * 0.4;
        if g > 1e-6 {
            let off = (s + r - (7.0 - 0.3)).abs();
            let told = 0.4 * (-2.0 * (g / gauss(0.0)).ln()).max(0.0).sqrt();
            // Near the maximum the root of a rounding error is left: √10⁻¹⁵.
            assert!((told - off).abs() < 1e-7, "pixel {i}: {told} {off}");
            nearest = nearest.min(told);
        }
    }
    assert!(nearest < 0.02, "no pixel near the ellipsoid: {nearest}");
}

#[test]
fn a_box_casts_the_shadow_of_geometry() {
    let mut scene = stage::scene(
        "
[camera]
eye = [1, 5, 4]
look_at = [0, 0, 0]
hfov = \"60 deg\"
size = [80, 60]
clock_zero = \"7 m\"
[[object]]
name = \"floor\"
shape = { plane = { size = [12, 12] } }
[[object]]
name = \"box\"
shape = { box = { size = [1.0, 0.4, 0.6] } }
origin = { position = [0.2, 1.0, -0.1] }
[[source]]
pulse = { position = [0.9, 2.4, -0.7], sigma = \"100 m\" }
",
    );
    let source = pulse(&mut scene).origin.x;
    let film = stage::film(&scene);
    let (lo, hi) = (DVec3::new(-0.3, 0.8, -0.4), DVec3::new(0.7, 1.2, 0.2));
    let (mut dark, mut light) = (0, 0);
    for i in stage::met(&film) {
        if stage::value(&film, Aov::Object, i) != 0.0 {
            continue;
        }
        // The box shadows x iff the slabs' intervals on the way to the source overlap.
        let (x, _) = on_floor(&scene, i);
        let way = source - x;
        let (a, b) = ((lo - x) / way, (hi - x) / way);
        let (enter, leave) = (a.min(b).max_element(), a.max(b).min_element());
        let is_dark = film.radiance()[i] == [0.0; 3];
        assert_eq!(is_dark, enter < leave, "pixel {i}, {x}");
        if is_dark { dark += 1 } else { light += 1 }
    }
    assert!(dark > 100 && light > 1000, "{dark} {light}");
    // Without shadows none is dark.
    pulse(&mut scene).shadows = false;
    let film = stage::film(&scene);
    let dark = |i: &&usize| {
        stage::value(&film, Aov::Object, **i) == 0.0 && film.radiance()[**i] == [0.0; 3]
    };
    assert_eq!(stage::met(&film).iter().filter(dark).count(), 0);
}

#[test]
fn where_nothing_is_in_the_way_light_is_the_same_without_shadows() {
    // Then where points are is not worked out for shadow rays: nothing else may ask for it.
    let mut scene = floor();
    let [with, without] = [true, false].map(|shadows| {
        pulse(&mut scene).shadows = shadows;
        stage::film(&scene)
    });
    assert_eq!(with.radiance(), without.radiance());
}

#[test]
fn a_surface_does_not_shadow_itself_along_the_edges_of_its_triangles() {
    // A square is two triangles; a camera straight above it has pixel centres on their common edge. The
    // point of emission is rounded, on either side of the plane.
    for step in 0..24 {
        let angle = 7.3 * f64::from(step);
        let mut scene = stage::scene(&format!(
            "
[camera]
eye = [0, 3, 0]
look_at = [0, 0, 0]
up = [0, 0, 1]
hfov = \"60 deg\"
size = [33, 33]
[[object]]
shape = {{ plane = {{ size = [2, 2] }} }}
transform = {{ rotate = {{ axis = [1, 0.3, 0.7], angle = \"{angle} deg\" }}, translate = [0.1, 0.3, 0.7] }}
[[source]]
pulse = {{ position = [0.1, 9, 0.3], sigma = \"1000 m\" }}
"
        ));
        // The camera above the plane's centre, looking down on it, upright along an edge.
        let plane = scene.objects[0].transform;
        let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z].map(|e| plane.transform_vector3(e));
        scene.camera.origin.x = plane.translation + y * 3.0;
        scene.camera.axes = [x, -z, -y];
        pulse(&mut scene).origin.x = plane.translation + y * 2.0 + x * 0.4 + z * 0.2;
        let film = stage::film(&scene);
        let met = stage::met(&film);
        assert!(met.len() > 300);
        for i in met {
            assert!(film.radiance()[i][0] > 0.0, "{angle}°, pixel {i} is dark");
        }
    }
}

#[test]
fn a_pulse_long_after_time_zero_looks_the_same() {
    // 2⁴⁸ m is some 11 days of light; event times there are multiples of 1/16 m, but their differences
    // from the camera's own time are not rounded.
    let scene = floor();
    let mut later = scene.clone();
    let shift = 2f64.powi(48);
    later.camera.origin.ct += shift;
    // 0.25 m is a multiple of that spacing; 0.3 m is not.
    pulse(&mut later).origin.ct = 0.25 + shift;
    let mut now = scene.clone();
    pulse(&mut now).origin.ct = 0.25;
    let (a, b) = (stage::film(&now), stage::film(&later));
    for (a, b) in a.radiance().iter().zip(b.radiance()) {
        assert!((a[0] - b[0]).abs() <= 1e-12 * a[0].max(1e-3), "{a:?} {b:?}");
    }
}

#[test]
fn gloss_that_pulses_alone_do_not_show_is_named_with_what_shows_it() {
    let scene = |metallic: f64, sky: &str| {
        stage::scene(&format!(
            "
[camera]
eye = [1, 2, 3]
look_at = [0, 0, 0]
size = [12, 8]
clock_zero = \"5 m\"
{sky}
[[object]]
name = \"left\"
shape = {{ box = {{ size = [1, 1, 1] }} }}
metallic = {metallic}
[[object]]
name = \"right\"
shape = {{ box = {{ size = [1, 1, 1] }} }}
transform = {{ translate = [1.5, 0, 0] }}
[[source]]
pulse = {{ position = [0.5, 2, 2], sigma = \"1 m\" }}
"
        ))
    };
    let look = |metallic: f64, sky: &str| {
        let scene = scene(metallic, sky);
        let plan = Plan::new(&scene, &Request::default()).unwrap();
        let is_named = |notes: &[String]| {
            let named = notes
                .iter()
                .filter(|note| note.contains("lit only by pulses"));
            let named: Vec<_> = named.collect();
            assert!(
                named.iter().all(|note| note.starts_with("\"left\" is lit")),
                "{named:?}"
            );
            assert!(named.len() < 2, "{named:?}");
            !named.is_empty()
        };
        let prepared = Prepared::new(&scene, &plan, &Silent).unwrap();
        let said = is_named(&plan.notes);
        assert_eq!(said, is_named(&prepared.warnings));
        (said, stage::film(&scene).radiance().to_vec())
    };
    let ([matte, metal], dark) = ([0.0, 1.0].map(|m| look(m, "")), "[sky]\nradiance = 0");
    assert!(!matte.0 && metal.0);
    assert_eq!(matte.1, metal.1);
    assert!(matte.1.iter().any(|rgb| rgb[0] > 0.0));
    let [matte, metal] = [0.0, 1.0].map(|m| look(m, dark));
    assert!(!matte.0 && !metal.0);
    assert_ne!(matte.1, metal.1);
}
