//! Extreme scenes give correct pictures.

use glam::DVec3;
use nullray::render::aov::Aov;
use nullray::render::film::Film;
use nullray::scene::model::{BackFaces, Geometry, Scene, Shape};
use nullray::spacetime::{Event, Velocity};

use crate::pipeline::files::{self, Quad};
use crate::pipeline::stage::{self, assert_relative};

/// A box of edges 2, 1.6 and 1.2 at the origin, at rest.
fn crate_at_rest() -> Scene {
    stage::scene(
        "
[camera]
eye = [1.5, 2.0, 4.0]
look_at = [0.0, 0.0, 0.0]
hfov = \"50 deg\"
size = [21, 15]
[[object]]
shape = { box = { size = [2.0, 1.6, 1.2] } }
colour = [1, 1, 1]
",
    )
}

fn channel_bits(film: &Film, aov: Aov) -> Vec<u64> {
    film.aov(aov).unwrap().iter().map(|v| v.to_bits()).collect()
}

fn assert_finite(film: &Film) {
    assert!(film.radiance().iter().flatten().all(|v| v.is_finite()));
    for i in 0..stage::pixels(film) {
        assert!((stage::direction(film, i).length() - 1.0).abs() < 1e-12);
    }
    for i in stage::met(film) {
        let w = stage::value(film, Aov::WavelengthRatio, i);
        assert!(w > 0.0 && w.is_finite(), "{w}");
        assert!(stage::event(film, i).1.is_finite() && stage::object_event(film, i).1.is_finite());
    }
}

#[test]
fn a_camera_inside_a_closed_box_sees_its_walls_or_out_as_the_policy_says() {
    let mut scene = crate_at_rest();
    scene.camera.origin.x = DVec3::new(0.1, 0.2, -0.3);
    for (policy, walls) in [
        (BackFaces::TwoSided, true),
        (BackFaces::Black, true),
        (BackFaces::AsFile, false),
        (BackFaces::Culled, false),
    ] {
        scene.back_faces = policy;
        let film = stage::film(&scene);
        assert_finite(&film);
        let seen = stage::met(&film).len();
        assert_eq!(
            seen,
            if walls { stage::pixels(&film) } else { 0 },
            "{policy:?}"
        );
    }
}

#[test]
fn a_camera_on_a_wall_on_an_edge_or_at_a_corner_sees_what_lies_before_it() {
    for place in [
        DVec3::new(0.3, 0.8, 0.1),
        DVec3::new(1.0, 0.8, 0.1),
        DVec3::new(1.0, 0.8, 0.6),
    ] {
        let mut scene = crate_at_rest();
        scene.back_faces = BackFaces::TwoSided;
        scene.camera.origin.x = place;
        // Outward, away from the box: nothing is met, least of all the wall at distance 0.
        scene.camera.axes = [DVec3::X, DVec3::NEG_Z, DVec3::Y];
        let film = stage::film(&scene);
        assert_finite(&film);
        assert!(stage::met(&film).is_empty(), "{place}");
        // Inward: the far walls, at the distances of a convex box.
        let inward = (DVec3::new(-0.05, 0.02, 0.03) - place).normalize();
        let right = inward.cross(DVec3::Y).normalize();
        scene.camera.axes = [right, right.cross(inward), inward];
        scene.camera.horizontal_fov = 0.4;
        let film = stage::film(&scene);
        assert_finite(&film);
        assert_eq!(stage::met(&film).len(), stage::pixels(&film), "{place}");
        for i in stage::met(&film) {
            let far = stage::event(&film, i).1 / DVec3::new(1.0, 0.8, 0.6);
            assert!((far.abs().max_element() - 1.0).abs() < 1e-14);
            assert!(stage::value(&film, Aov::Distance, i) > 0.1);
        }
    }
}

#[test]
fn looking_exactly_along_the_motion_is_finite_at_any_speed() {
    for axis in [DVec3::NEG_Z, DVec3::X, DVec3::new(-1.5, -2.0, -4.0)] {
        for phi in [1e-9, 0.5, 5.0, 18.0, -1e-9, -0.5, -5.0, -18.0] {
            let mut scene = crate_at_rest();
            let forward = axis.normalize();
            let right = forward.cross(DVec3::Y).normalize();
            scene.camera.origin.x = -4.0 * forward;
            scene.camera.axes = [right, right.cross(forward), forward];
            scene.camera.velocity = Velocity::from_rapidity_along(phi, forward).unwrap();
            let film = stage::film(&scene);
            assert_finite(&film);
            // The pixel in the middle looks along the axis, at the box, and W = e^−φ.
            let middle = 7 * 21 + 10;
            assert_eq!(stage::value(&film, Aov::Object, middle), 0.0);
            let w = stage::value(&film, Aov::WavelengthRatio, middle);
            assert_relative(w, (-phi).exp(), 1e-12, phi);
            assert!(
                stage::direction(&film, middle).distance(forward) < 1e-9,
                "{phi}"
            );
        }
    }
}

#[test]
fn a_body_that_recedes_near_the_speed_of_light_is_seen_where_it_was() {
    // Uniform motion has no beginning: every camera event has the body on its past light cone. Face at
    // z = −5 − βt + … seen at t = −s: s = 5 − βs …, so s = 5/(1 + β) for a face at −5 m at time 0.
    for beta in [0.9, 0.999, 0.999_999] {
        let mut scene = crate_at_rest();
        scene.camera.origin = Event::new(0.0, DVec3::ZERO);
        scene.camera.axes = [DVec3::X, DVec3::Y, DVec3::NEG_Z];
        let velocity = Velocity::from_beta(DVec3::NEG_Z * beta).unwrap();
        scene.objects[0].velocity = velocity;
        let gamma = velocity.gamma();
        scene.objects[0].origin.x = DVec3::new(0.0, 0.0, -5.0 - 0.6 / gamma);
        let film = stage::film(&scene);
        assert_finite(&film);
        let middle = 7 * 21 + 10;
        let s = stage::value(&film, Aov::Distance, middle);
        assert_relative(s, 5.0 / (1.0 + beta), 1e-9, beta);
        let w = stage::value(&film, Aov::WavelengthRatio, middle);
        assert_relative(w, gamma * (1.0 + beta), 1e-9, "W");
    }
}

#[test]
fn a_view_without_hits_shows_the_background_and_marks_it_in_channels() {
    let mut scene = crate_at_rest();
    scene.camera.axes = scene.camera.axes.map(|a| -a);
    scene.background = [0.1, 0.2, 0.3];
    let film = stage::film(&scene);
    assert!(film.radiance().iter().all(|c| *c == [0.1, 0.2, 0.3]));
    assert!(film.aov(Aov::Object).unwrap().iter().all(|o| *o == -1.0));
    assert!(film.aov(Aov::Distance).unwrap().iter().all(|d| d.is_nan()));
}

#[test]
fn degenerate_triangles_are_passed_over_and_keep_the_numbers_of_the_others() {
    let folder = tempfile::tempdir().unwrap();
    let quad = Quad {
        indices: &[0, 0, 0, 0, 1, 2, 1, 1, 3, 0, 2, 3],
        ..Quad::PLAIN
    };
    files::glb(&folder.path().join("quad.glb"), &quad);
    let scene = stage::scene_in(
        folder.path(),
        "
[camera]
eye = [0.1, 0.2, 3]
look_at = [0, 0, 0]
size = [16, 16]
[[object]]
gltf = \"quad.glb\"
",
    );
    let film = stage::film(&scene);
    for i in stage::met(&film) {
        let (_, x) = stage::event(&film, i);
        // Triangle 1 is below the diagonal, triangle 3 above it.
        let expected = if x.y < x.x { 1.0 } else { 3.0 };
        assert_eq!(stage::value(&film, Aov::Primitive, i), expected);
    }
    assert!(stage::met(&film).len() > 50);
}

/// The box and the camera's distance from it, all `scale` times as large.
fn scaled(scale: f64) -> Scene {
    let mut scene = crate_at_rest();
    if let Geometry::Shape {
        shape: Shape::Box { size },
        ..
    } = &mut scene.objects[0].geometry
    {
        *size = size.map(|s| s * scale);
    }
    scene.objects[0].velocity = Velocity::from_beta(DVec3::new(0.6, -0.3, 0.1)).unwrap();
    scene.objects[0].origin.ct = -4.0 * scale;
    scene.camera.origin.x *= scale;
    scene.camera.size = [85, 61];
    scene.camera.velocity = Velocity::from_beta(DVec3::new(0.0, 0.2, -0.5)).unwrap();
    scene
}

#[test]
fn the_picture_does_not_depend_on_the_scale_of_the_scene() {
    let film = stage::film(&scaled(1.0));
    assert!(stage::met(&film).len() > 20);
    for scale in [2f64.powi(30), 2f64.powi(-30)] {
        // Powers of two scale without rounding: the same bits.
        let other = stage::film(&scaled(scale));
        for aov in [
            Aov::Object,
            Aov::Primitive,
            Aov::BarycentricU,
            Aov::BarycentricV,
            Aov::WavelengthRatio,
        ] {
            let same = channel_bits(&film, aov) == channel_bits(&other, aov);
            assert!(same, "{scale:e}: {}", aov.name());
        }
        assert_eq!(film.radiance(), other.radiance());
    }
    for scale in [1e9, 1e-9] {
        let other = stage::film(&scaled(scale));
        assert_eq!(
            channel_bits(&film, Aov::Primitive),
            channel_bits(&other, Aov::Primitive)
        );
        for i in stage::met(&film) {
            let (a, b) = (
                stage::object_event(&film, i).1,
                stage::object_event(&other, i).1,
            );
            assert!(a.distance(b / scale) < 1e-12, "{scale:e}: {a} {b}");
        }
    }
}

#[test]
fn far_from_the_origin_and_from_time_zero_the_picture_is_the_same() {
    // The scene's own numbers are multiples of 2⁻²⁰, and so exact beside 2³⁰ m; lengths are taken from
    // the objects' origins, so that nothing else is rounded to that.
    let mut near = crate_at_rest();
    let exact = |v: DVec3| (v * 2f64.powi(20)).round() / 2f64.powi(20);
    near.objects[0].velocity = Velocity::from_beta(DVec3::new(0.6, -0.3, 0.1)).unwrap();
    near.objects[0].origin = Event::new(-4.0, exact(DVec3::new(0.3, -0.2, 0.1)));
    near.camera.origin.x = exact(near.camera.origin.x);
    near.camera.velocity = Velocity::from_beta(DVec3::new(0.0, 0.2, -0.5)).unwrap();
    let mut still = near.objects[0].clone();
    still.velocity = Velocity::REST;
    still.origin.x.x -= 2.0;
    near.objects.push(still);
    let mut far = near.clone();
    let shift = DVec3::new(1.0, -1.0, 1.0) * 2f64.powi(30);
    for origin in [&mut far.camera.origin]
        .into_iter()
        .chain(far.objects.iter_mut().map(|o| &mut o.origin))
    {
        origin.x += shift;
        origin.ct += 2f64.powi(30);
    }
    let (a, b) = (stage::film(&near), stage::film(&far));
    for aov in nullray::render::aov::Aov::ALL.iter().copied() {
        if !aov.name().starts_with("event") {
            assert!(
                channel_bits(&a, aov) == channel_bits(&b, aov),
                "{}",
                aov.name()
            );
        }
    }
    assert!((0..2).all(|k| a.aov(Aov::Object).unwrap().contains(&f64::from(k))));
    assert_eq!(a.radiance(), b.radiance());
}

/// A body of the camera's own velocity rests beside it for ever, however far both have gone in the world, and however fast.
#[test]
fn what_moves_with_the_camera_looks_the_same_at_all_camera_times() {
    let mut scene = crate_at_rest();
    let mut still = scene.objects[0].clone();
    still.origin.x.y -= 900.0;
    // Perpendicular to the line of sight, so that the body stays in view.
    let slow = Velocity::from_beta(DVec3::new(0.6, -0.3, -0.075)).unwrap();
    let fast = |gamma, n| Velocity::from_gamma(gamma, n).unwrap();
    let [level, rising] = [DVec3::new(4.0, 0.0, -1.5), DVec3::new(-2.0, 1.5, 0.0)];
    for velocity in [slow, fast(1e8, level), fast(1e6, rising)] {
        scene.camera.velocity = velocity;
        scene.objects[0].velocity = velocity;
        // Alone, and beside another one that is out of sight.
        for others in [vec![], vec![still.clone()]] {
            let mut scene = scene.clone();
            scene.objects.extend(others);
            let now = stage::film(&scene);
            assert!(stage::met(&now).len() > 20);
            for time in [10.0, 1e3, -3e8, 2f64.powi(48)] {
                scene.camera.time = time;
                let later = stage::film(&scene);
                for aov in [
                    Aov::Primitive,
                    Aov::BarycentricU,
                    Aov::ObjectEventX,
                    Aov::NormalX,
                ] {
                    let same = channel_bits(&now, aov) == channel_bits(&later, aov);
                    assert!(same, "{velocity:?} at {time}: {}", aov.name());
                }
            }
        }
    }
}

#[test]
fn in_a_medium_a_moving_body_is_hit_where_slow_light_left_it() {
    // Light at 1/η: world time T − η s; there the box must be, by the textbook's transformation.
    let mut scene = crate_at_rest();
    scene.medium_index = 1.5;
    let beta = DVec3::new(0.5, 0.1, -0.3);
    scene.objects[0].velocity = Velocity::from_beta(beta).unwrap();
    scene.objects[0].origin.ct = -6.0;
    let film = stage::film(&scene);
    let gamma = 1.0 / (1.0 - beta.length_squared()).sqrt();
    for i in stage::met(&film) {
        let (t, x) = stage::event(&film, i);
        assert!((t + 1.5 * stage::value(&film, Aov::Distance, i)).abs() < 1e-13);
        let along = beta * ((gamma - 1.0) * beta.dot(x) / beta.length_squared());
        let local = x + along - beta * (gamma * (t + 6.0));
        let on_box = local / DVec3::new(1.0, 0.8, 0.6);
        assert!((on_box.abs().max_element() - 1.0).abs() < 1e-12, "{on_box}");
    }
    assert!(stage::met(&film).len() > 20);
}

#[test]
fn the_narrowest_and_the_widest_lens_see_along_the_pinholes_directions() {
    for (degrees, all) in [(1e-6_f64, true), (179.9, false)] {
        let mut scene = crate_at_rest();
        scene.camera.horizontal_fov = degrees.to_radians();
        let film = stage::film(&scene);
        assert_finite(&film);
        for i in 0..stage::pixels(&film) {
            let d = stage::through(&scene.camera, i);
            assert!(stage::direction(&film, i).distance(d) < 1e-13);
        }
        let seen = stage::met(&film).len();
        assert_eq!(seen == stage::pixels(&film), all, "{degrees}: {seen}");
    }
}
