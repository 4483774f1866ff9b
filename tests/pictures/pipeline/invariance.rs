//! No velocity is special: a scene without anything at rest in "the world" (no pulse, no medium) gives the same picture if everything,
//! including the camera, is boosted together.
//!
//! A frame with rapidity w, boosted by Λ, is one with rapidity w′ whose contents are rotated: Λ B(w) = B(w′) R. Objects are rotated by R in
//! their own coordinates and so are the camera's axes. The test compares numbers that no boost changes: the triangle hit, the position on
//! it, the object's own time and position of the emission event, W, and the radiance.

use std::path::Path;
use std::sync::LazyLock;

use glam::DVec3;
use nullray::render::aov::Aov;
use nullray::render::film::Film;
use nullray::scene::model::Scene;
use nullray::spacetime::Quantity;
use proptest::prelude::*;

use crate::pipeline::{files, lorentz, stage};

/// Objects of four rest frames; the two boxes share one, with clocks of their own.
const TEXT: &str = "
outside = \"hold\"
[display]
back_faces = \"two_sided\"
background = [0.1, 0.2, 0.3]
[camera]
eye = [0.4, 1.5, 6.0]
look_at = [0.0, 0.4, 0.0]
hfov = \"48 deg\"
size = [24, 18]
velocity = { beta = [0.3, -0.2, -0.5] }
clock_zero = \"2 m\"
time = \"1.5 m\"
[[object]]
name = \"box\"
shape = { box = { size = [1.6, 1.4, 1.8] } }
transform = { rotate = { axis = [1, 2, 0], angle = \"25 deg\" }, translate = [0.2, 0.1, 0.0] }
velocity = { beta = [0.6, 0.1, -0.3] }
origin = { position = [0.5, 0.5, 0.3], time = \"-4 m\" }
[[object]]
name = \"second box\"
shape = { box = { size = [1.2, 2.0, 1.2] } }
velocity = { beta = [0.6, 0.1, -0.3] }
origin = { position = [-1.0, 0.5, 0.0], time = \"-5 m\" }
[[object]]
name = \"ball\"
shape = { sphere = { radius = 0.8, subdivisions = 3 } }
velocity = { beta = [-0.7, 0.2, 0.4] }
origin = { position = [-1.5, 0.7, -1.0], time = \"-3 m\" }
[[object]]
name = \"floor\"
shape = { plane = { size = [9, 9] } }
origin = { position = [0.0, -1.0, 0.0], time = \"1 m\" }
[[source]]
cube = { file = \"invariance.npy\", start = \"-40 m\", bin_width = \"4 m\", clock = \"object\", values = \"density\" }
";

static BASE: LazyLock<(Scene, Film)> = LazyLock::new(|| {
    // The file has to be there for the boosted scenes too.
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let values = (0..2 * 3 * 20).map(|k| 1.0 + f64::from(k * k % 37));
    files::npy(&folder.join("invariance.npy"), &[2, 3, 20], values);
    let scene = stage::scene_in(folder, TEXT);
    let film = stage::film(&scene);
    (scene, film)
});

/// Asserts that `moved`, the boosted scene, is the same picture; returns why not.
fn assert_same(moved: &Scene) -> Result<(), TestCaseError> {
    assert_same_as(&BASE.0, &BASE.1, moved)
}

fn assert_same_as(scene: &Scene, a: &Film, moved: &Scene) -> Result<(), TestCaseError> {
    let b = &stage::film(moved);
    // Places in an object turn with it.
    let turn = |k: f64| {
        let [from, to] = [scene, moved].map(|s| s.objects[k as usize].transform.matrix3);
        to * from.inverse()
    };
    for i in 0..stage::pixels(a) {
        for aov in [Aov::Object, Aov::Primitive] {
            let (x, y) = (stage::value(a, aov, i), stage::value(b, aov, i));
            prop_assert_eq!(x, y, "pixel {}, {}", i, aov.name());
        }
        let object = stage::value(a, Aov::Object, i);
        if object < 0.0 {
            prop_assert_eq!(a.radiance()[i], b.radiance()[i]);
            continue;
        }
        let near = |x: f64, y: f64, size: f64| (x - y).abs() <= 1e-9 * size;
        for aov in [Aov::BarycentricU, Aov::BarycentricV, Aov::WavelengthRatio] {
            let (x, y) = (stage::value(a, aov, i), stage::value(b, aov, i));
            prop_assert!(near(x, y, x.max(1.0)), "pixel {i}, {}: {x} {y}", aov.name());
        }
        let ((t, x), (u, y)) = (stage::object_event(a, i), stage::object_event(b, i));
        let x = turn(object) * x;
        prop_assert!(
            near(t, u, 10.0) && x.distance(y) < 1e-8,
            "pixel {i}: {x} {y}"
        );
        for (x, y) in a.radiance()[i].into_iter().zip(b.radiance()[i]) {
            prop_assert!(near(x, y, x.max(1.0)), "pixel {i}, radiance: {x} {y}");
        }
    }
    Ok(())
}

#[test]
fn the_scene_of_the_invariance_tests_shows_all_its_objects() {
    let object = BASE.1.aov(Aov::Object).unwrap();
    for k in -1..4 {
        let seen = object.iter().filter(|o| **o == f64::from(k)).count();
        assert!(seen > 5, "object {k}: {seen} pixels");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 32, failure_persistence: None, ..Default::default() })]

    #[test]
    fn a_scene_and_its_camera_boosted_together_give_the_same_picture(
        direction in prop::array::uniform3(-1.0..1.0),
        rapidity in 0.0..3.0,
    ) {
        let direction = DVec3::from(direction).try_normalize().unwrap_or(DVec3::X);
        assert_same(&lorentz::boosted(&BASE.0, direction * rapidity))?;
    }
}

#[test]
fn every_quantity_has_the_same_picture_in_every_frame() {
    for quantity in [
        Quantity::PerWavelength,
        Quantity::PerFrequency,
        Quantity::Photons,
        Quantity::Line { wavelength: 550e-9 },
    ] {
        let mut scene = BASE.0.clone();
        scene.sources[0].quantity = quantity;
        let moved = lorentz::boosted(&scene, DVec3::new(-0.8, 0.5, 1.1));
        // A hue follows λ by a table with a slope of some 0.03 per nanometre: 550 · 10⁻¹⁰ · 0.03.
        assert_same_as(&scene, &stage::film(&scene), &moved).unwrap();
    }
}

#[test]
fn without_the_wigner_rotation_the_picture_would_differ() {
    let scene = &BASE.0;
    let mut moved = lorentz::boosted(scene, DVec3::new(-0.8, 0.5, 1.1));
    moved.camera.axes = scene.camera.axes;
    assert!(assert_same(&moved).is_err());
}
