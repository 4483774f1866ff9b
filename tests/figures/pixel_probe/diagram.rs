//! The diagram of a probe, laid out.

use nullray::figures::diagram::{Panel, Point, draw, layout};
use nullray::figures::pixel_probe::{Origin, diagram};

use crate::pixel_probe::{ALL, BELL, MOVING, SENSOR, STILL, base, equal, hit, seen, text, traced};

/// The panel of what a camera sees, in a frame.
fn panel(camera: &str, frame: Option<&str>, dimensions: &str) -> Panel {
    let (probe, _) = hit(camera);
    let text = text(camera) + &format!("\n[diagram]\ndimensions = \"{dimensions}\"\n");
    let model = diagram(&probe, base(&text), frame, None).unwrap();
    let laid = layout(&model);
    draw(&laid, &model.style).unwrap();
    laid.panels.into_iter().next().unwrap()
}

fn label(panel: &Panel, start: &str) -> Point {
    let labelled = |e: &&nullray::figures::diagram::model::Spot<Point>| {
        e.label.as_ref().is_some_and(|l| l.starts_with(start))
    };
    panel
        .events
        .iter()
        .find(labelled)
        .unwrap_or_else(|| panic!("no {start}"))
        .at
}

#[test]
fn the_ray_has_the_slope_of_light_in_the_world_and_in_the_camera() {
    for camera in ALL {
        for frame in ["world", "camera"] {
            let panel = panel(camera, Some(frame), "1+1");
            // The last signal but those of pulses: from the emission to the pinhole.
            let [from, to] = panel.signals.last().unwrap().ends;
            // To the left and upwards: the camera looks to the right.
            equal((to.ct - from.ct) / (to.x - from.x), -1.0);
        }
    }
}

#[test]
fn in_the_frame_of_the_camera_it_is_received_at_the_origin() {
    for camera in [MOVING, BELL] {
        let at = label(&panel(camera, Some("camera"), "1+1"), "seen");
        assert!(at.ct.abs() <= 1e-12 && at.x.abs() <= 1e-12, "{at:?}");
    }
}

#[test]
fn the_camera_has_the_slope_of_what_it_moves_along_the_ray() {
    let (probe, _) = hit(MOVING);
    let panel = panel(MOVING, None, "1+1");
    let points = &panel.world_lines[0].curve.points;
    let way = points[points.len() - 1].from(points[0]);
    let beta = probe.reception.frame.velocity().beta();
    equal(way.x / way.ct, beta.dot(probe.direction.unit()));
}

#[test]
fn clocks_have_ticks_and_the_axis_says_along_what_it_is() {
    let panel = panel(STILL, None, "1+1");
    assert!(panel.world_lines.iter().all(|line| line.ticks.len() >= 3));
    assert_eq!(panel.axes[0].space.label, "*x* (m), along the ray");
}

#[test]
fn a_camera_at_rest_has_one_now_and_a_moving_one_two() {
    let nows = |camera: &str| {
        let panel = panel(camera, None, "1+1");
        let labels = panel.events.iter().filter_map(|event| event.label.clone());
        labels
            .filter(|label| label.starts_with("now"))
            .collect::<Vec<_>>()
    };
    assert_eq!(nows(STILL), ["now"]);
    assert_eq!(nows(MOVING), ["now, for the camera", "now, in the world"]);
}

#[test]
fn with_a_sensor_its_element_has_a_world_line_and_the_light_goes_on_to_it() {
    let panel = panel(SENSOR, None, "1+1");
    let names: Vec<&str> = panel
        .world_lines
        .iter()
        .map(|line| line.name.as_str())
        .collect();
    assert_eq!(&names[..2], ["camera", "sensor"]);
    assert_eq!(panel.signals.len(), 2);
    assert_eq!(panel.signals[0].ends[0], panel.signals[1].ends[1]);
}

#[test]
fn in_three_dimensions_the_ray_lies_on_the_past_cone_of_the_reception() {
    for camera in ALL {
        for frame in ["world", "camera"] {
            let panel = panel(camera, Some(frame), "2+1");
            let nappe = &panel.cones[0].nappes[0];
            for end in panel.signals.iter().flat_map(|signal| signal.ends) {
                let way = end.from(nappe.apex);
                assert!(
                    (way.x.hypot(way.y) + way.ct).abs() <= 1e-12 * way.ct.abs().max(1.0),
                    "{way:?}"
                );
                assert!(way.ct >= nappe.height, "the cone ends before {way:?}");
            }
        }
    }
}

#[test]
fn in_three_dimensions_now_is_on_the_plane() {
    let panel = panel(STILL, None, "2+1");
    let plane = &panel.planes[0];
    assert_eq!(plane.rise, [0.0, 0.0]);
    equal(label(&panel, "now").ct, plane.event.ct);
}

#[test]
fn a_ray_that_hits_nothing_is_reported() {
    let probe = seen(STILL, [0, 0]);
    let model = diagram(&probe, base(&text(STILL)), None, None).unwrap();
    let panel = &layout(&model).panels[0];
    assert_eq!(panel.signals[0].label.as_deref(), Some("meets nothing"));
    assert_eq!(panel.world_lines.len(), 1);
}

#[test]
fn the_object_has_a_frame_to_draw_in() {
    let scene = crate::pixel_probe::scene(&text(STILL));
    let pixels = (0..24).flat_map(|row| (0..32).map(move |column| [column, row]));
    let crates = |pixel| traced(&scene, pixel).unwrap();
    let probe = pixels
        .map(crates)
        .find(|s| s.hit.as_ref().is_some_and(|m| m.name == "crate"));
    let model = diagram(&probe.unwrap(), base(&text(STILL)), Some("crate"), None).unwrap();
    let panel = &layout(&model).panels[0];
    let points = &panel.world_lines[1].curve.points;
    equal(points[0].x, points[1].x);
}

#[test]
fn an_unknown_frame_has_no_diagram() {
    let (probe, _) = hit(STILL);
    assert!(diagram(&probe, base(&text(STILL)), Some("moon"), None).is_none());
}

#[test]
fn pulses_from_one_event_share_a_mark() {
    let lamp = |name: &str| {
        format!(
            "[[source]]\nname = \"{name}\"\npulse = {{ position = [0.5, 3, 1], time = \"-8 m\", sigma = \"4 m\", \
             intensity = 10 }}\n"
        )
    };
    let text = text(STILL) + &lamp("a") + &lamp("b");
    let probe = traced(&crate::pixel_probe::scene(&text), [16, 20]).unwrap();
    let panel = layout(&diagram(&probe, base(&text), None, None).unwrap())
        .panels
        .remove(0);
    let marked = panel
        .events
        .iter()
        .filter(|event| event.label.as_deref() == Some("a, b"));
    assert_eq!(marked.count(), 1);
    assert_eq!(panel.signals.len(), 2);
}

#[test]
fn the_origin_is_at_the_end_of_the_light_that_is_asked_for() {
    let (probe, _) = hit(MOVING);
    let object = probe.hit.as_ref().unwrap().name.clone();
    for frame in ["world", "camera", object.as_str()] {
        for (origin, at) in [
            (Origin::Reception, "reception"),
            (Origin::Emission, "emission"),
        ] {
            let model = diagram(&probe, base(&text(MOVING)), Some(frame), Some(origin)).unwrap();
            let panel = layout(&model).panels.remove(0);
            let found = panel.events.iter().find(|event| event.name == at).unwrap();
            assert!(
                found.at.ct.abs() < 1e-12 && found.at.x.abs() < 1e-12,
                "{frame} {at}"
            );
        }
    }
}

#[test]
fn the_ray_says_by_how_much_wavelengths_change() {
    let (probe, _) = hit(MOVING);
    let ratio = probe.hit.as_ref().unwrap().ratio;
    let model = diagram(&probe, base(&text(MOVING)), None, None).unwrap();
    let mut labels = model
        .signals
        .iter()
        .filter_map(|signal| signal.label.clone());
    let said = labels
        .find_map(|label| label.strip_prefix("*W* = ")?.parse::<f64>().ok())
        .unwrap();
    assert!((said / ratio - 1.0).abs() < 1e-3, "{said} {ratio}");
}
