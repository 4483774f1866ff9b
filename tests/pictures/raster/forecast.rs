//! The forecast of tessellation against measurements.

use nullray::approximate::tessellation::{Forecast, forecast};
use nullray::render::aov::Aov;
use nullray::render::progress::Silent;
use nullray::scene::model::Scene;

use super::stage::{BODIES, camera, centred, errors, film, greatest, scene, scene_file, values};

/// The least part of the error that is allowed which has to be found: the forecast counts with the worst direction
/// and shape of a triangle, and with the worst place being met.
const LEAST: f64 = 0.28;

fn scenes() -> [Scene; 3] {
    [
        scene(&(camera("velocity = { beta = [0.1, -0.3, -0.85] }") + BODIES)),
        scene(&(camera("velocity = { beta = [0.7, 0.1, 0.3] }") + BODIES)),
        scene_file("several-velocities.toml", [160, 100]),
    ]
}

fn forecast_of(scene: &Scene, pixels: f64) -> Forecast {
    forecast(scene, &centred(scene), pixels, &Silent).unwrap()
}

#[test]
fn errors_with_the_forecast_edge_lengths_are_as_allowed_and_not_much_smaller() {
    for (index, scene) in scenes().iter().enumerate() {
        let stage = centred(scene);
        for pixels in [0.5, 0.1, 0.02] {
            for object in forecast_of(scene, pixels).objects {
                let Some(length) = object.edge_length.filter(|_| object.parts > 1) else {
                    continue;
                };
                let drawn = film(&stage, &format!("raster:uniform={length}"));
                let all = errors(&stage, &drawn);
                let of = values(&drawn, Aov::Object).iter().filter(|o| **o >= 0.0);
                let own = all
                    .into_iter()
                    .zip(of)
                    .filter(|(_, o)| **o == f64::from(object.object));
                let worst = greatest(&own.map(|(error, _)| error).collect::<Vec<_>>());
                let part = worst / pixels;
                // Few parts are much shorter than they might be.
                let least = if object.parts < 5 { 0.0 } else { LEAST };
                assert!(
                    part <= 1.0 && part > least,
                    "scene {index}, {}: {part} of {pixels}",
                    object.name
                );
            }
        }
    }
}

#[test]
fn adaptive_tessellation_keeps_what_it_is_told_and_not_much_more() {
    for (index, scene) in scenes().iter().enumerate() {
        let stage = centred(scene);
        for pixels in [1.0, 0.3, 0.1] {
            let worst = greatest(&errors(
                &stage,
                &film(&stage, &format!("raster:adaptive={pixels}")),
            ));
            let part = worst / pixels;
            assert!(
                part <= 1.0 && part > LEAST,
                "scene {index}: {part} of {pixels}"
            );
        }
    }
}

#[test]
fn a_quarter_of_the_error_takes_half_the_length() {
    let scene = &scenes()[0];
    let [coarse, fine] = [0.4, 0.1].map(|pixels| forecast_of(scene, pixels).objects.remove(0));
    let (coarse, fine) = (coarse.edge_length.unwrap(), fine.edge_length.unwrap());
    assert!((coarse / fine - 2.0).abs() < 1e-12);
}

#[test]
fn objects_at_rest_relative_to_the_camera_need_no_tessellation() {
    let found = forecast_of(&scene(&(camera("") + BODIES)), 0.5);
    assert_eq!(found.objects.len(), 2);
    for object in &found.objects {
        assert_eq!(
            (object.edge_length, object.parts, object.halvings),
            (None, 1, 0)
        );
    }
    assert!(found.report().contains("raster:none"));
}

#[test]
fn the_worst_place_is_where_the_picture_shows_it() {
    let scene = &scenes()[0];
    let film = film(&centred(scene), "trace");
    for object in forecast_of(scene, 0.5).objects {
        let [column, row] = object.worst.pixel.map(|p| p as usize);
        let pixel = row * 120 + column;
        assert_eq!(values(&film, Aov::Object)[pixel] as u32, object.object);
        assert_eq!(
            values(&film, Aov::Primitive)[pixel] as u32,
            object.worst.triangle
        );
        let place = [Aov::ObjectEventX, Aov::ObjectEventY, Aov::ObjectEventZ]
            .map(|a| values(&film, a)[pixel]);
        for (a, b) in place.iter().zip(object.worst.place) {
            assert!((a - b).abs() < 1e-9);
        }
    }
}
