//! Rasterizers and warps refuse scenes that they cannot draw with a message, before and after loading.

use nullray::Error;
use nullray::approximate::projection::displacements;
use nullray::approximate::raster::{self, Map, Method, Raster, Tessellation, Warp};
use nullray::render::plan::{Plan, Request};
use nullray::render::progress::Silent;

use super::stage::{BODIES, camera, centred, film, prepared, scene};

fn message(result: Result<impl std::fmt::Debug, Error>) -> String {
    result.unwrap_err().to_string()
}

/// Asserts that `method` is refused for the scene by its plan and by rendering, with `part` in the message.
#[track_caller]
fn assert_refused(text: &str, method: &str, part: &str, by_plan: bool) {
    let scene = scene(text);
    let method: Method = method.parse().unwrap();
    let plan = Plan::new(&scene, &Request::default()).unwrap();
    if by_plan {
        let said = message(method.check(&plan));
        assert!(said.contains(part), "{said}");
    }
    let said = message(raster::render(
        &prepared(&scene, &Request::default()),
        &method,
        &Silent,
    ));
    assert!(said.contains(part), "{said}");
}

#[test]
fn cameras_whose_rays_leave_events_of_their_own_are_refused() {
    let sensor = camera("") + "[camera.sensor]\nfocal_length = \"0.2 m\"\n" + BODIES;
    let shutter = camera("") + "[camera.shutter]\nduration = \"0.2 m\"\n" + BODIES;
    let paper = "model = \"paper2015\"\n".to_string()
        + &camera("velocity = { beta = [0, 0, -0.5] }")
        + BODIES;
    for text in [sensor, shutter, paper] {
        for method in ["raster:none", "warp:cube=8"] {
            assert_refused(&text, method, "rays all leave one event", true);
        }
    }
}

#[test]
fn an_accelerated_point_camera_is_rasterized() {
    let motion =
        "[camera.motion]\nacceleration = { proper = \"0.5 /m\", direction = [0, 0, -1] }\n";
    let text = camera("time = \"1 m\"") + motion + BODIES;
    let stage = centred(&scene(&text));
    assert!(super::stage::worst(&stage, "raster:adaptive=0.2") <= 0.2);
}

#[test]
fn objects_that_outrun_light_in_the_medium_are_refused() {
    let fast = "velocity = { beta = [0.8, 0, 0] }\n[medium]\nindex = 1.5\n";
    assert_refused(
        &(camera("") + BODIES + fast),
        "raster:none",
        "as fast as light",
        false,
    );
}

#[test]
fn warps_of_moving_objects_are_refused_by_name() {
    let moving = "velocity = { beta = [0.1, 0, 0] }\n";
    let text = camera("") + BODIES + moving;
    assert_refused(&text, "warp:cube=8", "moves", true);
    let plan = Plan::new(&scene(&text), &Request::default()).unwrap();
    let method: Method = "warp:cube=8".parse().unwrap();
    let said = message(method.check(&plan));
    assert!(said.contains("object \"crate\" moves"), "{said}");
}

#[test]
fn more_points_than_can_be_kept_are_refused() {
    assert_refused(
        &(camera("") + BODIES),
        "raster:uniform=0.00003",
        "16777216 points",
        false,
    );
}

#[test]
fn places_on_films_without_their_channels_are_refused() {
    let stage = prepared(&scene(&(camera("") + BODIES)), &Request::default());
    let said = message(displacements(&stage, &film(&stage, "trace")));
    assert!(said.contains("object_event"), "{said}");
}

#[test]
fn a_camera_within_a_surface_does_not_fail() {
    for eye in ["[0, 0, 1]", "[0, 0.5, 0]", "[3, 0, 3]"] {
        let text = format!(
            "[camera]\neye = {eye}\nlook_at = [0, 0.2, -4]\nsize = [20, 16]\nvelocity = {{ beta = [0, 0, -0.9] }}\n{BODIES}"
        );
        let stage = centred(&scene(&text));
        for method in [
            "raster:none",
            "raster:uniform=0.5",
            "raster:adaptive=5",
            "warp:panorama=16x8",
        ] {
            assert_eq!(film(&stage, method).size(), [20, 16]);
        }
    }
}

#[test]
fn numbers_that_no_method_string_can_have_are_refused() {
    let scene = scene(&(camera("") + BODIES));
    let plan = Plan::new(&scene, &Request::default()).unwrap();
    let stage = prepared(&scene, &Request::default());
    let divided = |by: fn(f64) -> Tessellation, x| Method::Raster(Raster::new(by(x)));
    let mut methods = Vec::new();
    for x in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        methods.push(divided(Tessellation::Uniform, x));
        methods.push(divided(Tessellation::Adaptive, x));
    }
    for map in [
        Map::Cube(0),
        Map::Cube(u32::MAX),
        Map::Panorama([0, 0]),
        Map::Panorama([8, 0]),
    ] {
        methods.push(Method::Warp(Warp {
            map,
            lookup: Default::default(),
        }));
    }
    for method in methods {
        for said in [
            message(method.check(&plan)),
            message(raster::render(&stage, &method, &Silent)),
        ] {
            assert!(said.contains("cannot be"), "{method:?}: {said}");
        }
    }
}
