//! Apparent positions: the ray tracer draws every point exactly there.

use super::stage::{BODIES, camera, centred, errors, film, greatest, scene, scene_file};

/// Asserts that the traced film has its points within `tolerance` pixels of their apparent positions.
#[track_caller]
fn assert_in_place(text: &str, tolerance: f64) {
    let stage = centred(&scene(text));
    let errors = errors(&stage, &film(&stage, "trace"));
    assert!(errors.len() > 1000, "{}", errors.len());
    assert!(greatest(&errors) < tolerance, "{:e}", greatest(&errors));
}

#[test]
fn a_moving_camera_sees_points_where_their_light_comes_from() {
    let text = camera("velocity = { beta = [0.3, -0.2, -0.8] }\ntime = \"0.4 m\"") + BODIES;
    assert_in_place(&text, 1e-8);
}

#[test]
fn points_of_bodies_at_different_velocities_have_different_boosts() {
    let stage = centred(&scene_file("several-velocities.toml", [120, 75]));
    let errors = errors(&stage, &film(&stage, "trace"));
    assert!(greatest(&errors) < 1e-8, "{:e}", greatest(&errors));
}

#[test]
fn a_camera_at_a_gamma_of_a_thousand_keeps_its_digits() {
    let text = camera("velocity = { gamma = 1000, direction = [0.3, 0.9, 3.4] }") + BODIES;
    let stage = centred(&scene(&text));
    let errors = errors(&stage, &film(&stage, "trace"));
    assert!(
        !errors.is_empty() && greatest(&errors) < 1e-6,
        "{:e}",
        greatest(&errors)
    );
}

#[test]
fn bodies_in_a_medium_are_seen_by_its_slower_light() {
    let moving = "velocity = { beta = [0.5, 0.1, 0] }\norigin = { position = [-0.3, 0, 0], time = \"-4 m\" }\n";
    for effects in ["", "[effects]\naberration = false\n"] {
        let text = camera("velocity = { beta = [0.2, 0, -0.3] }")
            + BODIES
            + moving
            + "[medium]\nindex = 1.5\n";
        assert_in_place(&(text + effects), 1e-8);
    }
}

#[test]
fn without_delay_bodies_are_seen_where_they_are() {
    let moving = "velocity = { beta = [0.8, 0.1, 0] }\norigin = { position = [0.1, 0, 0], time = \"0 m\" }\n";
    for camera_motion in ["", "velocity = { beta = [0.2, 0, -0.6] }"] {
        let text = camera(camera_motion) + BODIES + moving + "[effects]\nretardation = false\n";
        assert_in_place(&text, 1e-8);
    }
}
