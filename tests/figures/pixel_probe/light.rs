//! Reception, pinhole, emission: light between world lines; and the current positions of objects.

use nullray::spacetime::{Event, World};

use crate::pixel_probe::{ALL, SENSOR, STILL, WITH_SENSOR, equal, hit, scene, seen, text, traced};

/// How far from null the step between two events is, in parts of its length.
fn off_light(from: Event<World>, to: Event<World>) -> f64 {
    let step = to - from;
    (step.ct - step.x.length()).abs() / step.ct
}

#[test]
fn the_emission_sends_light_to_the_pinhole() {
    for camera in ALL {
        let (probe, hit) = hit(camera);
        let off = off_light(hit.emission, probe.reception.pinhole);
        assert!(off <= 1e-12, "{off}: {camera}");
    }
}

#[test]
fn the_pinhole_sends_that_light_on_to_the_sensor_element() {
    for camera in WITH_SENSOR {
        let (probe, _) = hit(camera);
        let reception = probe.reception;
        let off = off_light(reception.pinhole, reception.event);
        assert!(off <= 1e-12, "{off}: {camera}");
        let way = (reception.pinhole.x - reception.event.x).normalize();
        let error = (way - probe.direction.unit()).length();
        assert!(error <= 1e-11, "{error}: {camera}");
    }
}

#[test]
fn the_pinhole_is_on_its_world_line_when_its_clock_says_so() {
    for camera in ALL {
        let (probe, _) = hit(camera);
        let moment = probe.camera.at(probe.reception.pinhole_time).unwrap();
        let error = moment.event - probe.reception.pinhole;
        assert!(
            error.ct.abs() + error.x.length() <= 1e-12,
            "{error:?}: {camera}"
        );
    }
}

#[test]
fn the_element_is_on_its_world_line_at_the_time_of_the_shot() {
    for camera in [SENSOR, crate::pixel_probe::BELL, crate::pixel_probe::RIGID] {
        let (probe, _) = hit(camera);
        let moment = probe.element.unwrap().at(probe.reception.time).unwrap();
        let error = moment.event - probe.reception.event;
        assert!(
            error.ct.abs() + error.x.length() <= 1e-12,
            "{error:?}: {camera}"
        );
    }
}

#[test]
fn a_point_camera_receives_at_the_pinhole() {
    let (probe, _) = hit(STILL);
    assert_eq!(probe.reception.event, probe.reception.pinhole);
    assert_eq!(probe.reception.time, probe.reception.pinhole_time);
    assert!(probe.element.is_none());
}

#[test]
fn the_emission_is_on_the_world_line_of_its_point() {
    for camera in ALL {
        let (_, hit) = hit(camera);
        let error = hit.track.at(hit.time).unwrap().event - hit.emission;
        assert!(
            error.ct.abs() + error.x.length() <= 1e-12,
            "{error:?}: {camera}"
        );
    }
}

#[test]
fn now_is_simultaneous_with_the_reception() {
    for camera in ALL {
        let (probe, hit) = hit(camera);
        let reception = probe.reception;
        let (now, in_world) = (hit.now.unwrap(), hit.now_in_world.unwrap());
        assert!(
            reception.frame.event_from_world(now).ct.abs() <= 1e-12,
            "{camera}"
        );
        equal(in_world.ct, reception.event.ct);
        let aside = hit.track.where_zero(|e| e.ct - now.ct).unwrap().event - now;
        assert!(aside.x.length() <= 1e-12);
    }
}

#[test]
fn a_crate_at_sixty_percent_has_gone_on_by_that_much_of_the_delay() {
    // The camera rests: now is later than the emission by the distance, and the crate has moved 0.6 of it.
    let scene = scene(&text(STILL));
    let pixels = (0..24).flat_map(|row| (0..32).map(move |column| [column, row]));
    let of_crate = pixels.filter_map(|pixel| traced(&scene, pixel).unwrap().hit);
    let hit = of_crate
        .into_iter()
        .find(|hit| hit.name == "crate")
        .unwrap();
    let moved = hit.now.unwrap() - hit.emission;
    equal(moved.ct, hit.distance);
    equal(moved.x.x, 0.6 * hit.distance);
    // Its clock runs slower by 1/γ = 0.8.
    let clock = hit
        .track
        .where_zero(|e| e.ct - hit.now.unwrap().ct)
        .unwrap();
    equal(clock.proper_time - hit.time, 0.8 * hit.distance);
}

const LAMP: &str = "[[source]]\nname = \"lamp\"\n\
                    pulse = { position = [0.5, 3, 1], time = \"-8 m\", sigma = \"4 m\", intensity = 10 }\n";

#[test]
fn a_pulse_is_drawn_back_to_the_event_at_which_the_light_left_it() {
    let scene = scene(&(text(STILL) + LAMP));
    let probe = traced(&scene, [16, 20]).unwrap();
    let hit = probe.hit.unwrap();
    let lamp = &hit.pulses[0];
    assert!(off_light(lamp.left, hit.emission) <= 1e-12);
    assert_eq!(lamp.left.x.to_array(), [0.5, 3.0, 1.0]);
    equal(lamp.deviations, (lamp.left.ct + 8.0) / 4.0);
    equal(lamp.share, 1.0);
}

#[test]
fn pulses_share_what_they_light_by_their_strengths() {
    let second = LAMP
        .replace("\"lamp\"", "\"second\"")
        .replace("10 }", "30 }");
    let scene = scene(&(text(STILL) + LAMP + &second));
    let hit = traced(&scene, [16, 20]).unwrap().hit.unwrap();
    let names: Vec<&str> = hit.pulses.iter().map(|lamp| lamp.name.as_str()).collect();
    assert_eq!(names, ["second", "lamp"]);
    equal(hit.pulses[0].share, 0.75);
}

#[test]
fn a_pulse_that_is_over_lights_nothing() {
    let over = LAMP.replace("4 m", "1 cm");
    let hit = traced(&scene(&(text(STILL) + &over)), [16, 20])
        .unwrap()
        .hit
        .unwrap();
    assert!(hit.pulses.is_empty());
}

#[test]
fn a_ray_that_meets_nothing_is_followed_as_far_as_there_are_objects() {
    let probe = seen(STILL, [0, 0]);
    assert!(probe.hit.is_none());
    let end = probe.far_end();
    equal((end.x - probe.reception.pinhole.x).length(), probe.reach);
    // The floor's origin is farther than the crate's.
    equal(probe.reach, 17f64.sqrt());
}

#[test]
fn in_a_medium_light_takes_the_longer_for_its_way() {
    let medium = "[medium]\nindex = 1.5\n";
    let probe = traced(&scene(&(medium.to_string() + &text(STILL))), [16, 20]).unwrap();
    let hit = probe.hit.unwrap();
    equal(
        probe.reception.pinhole.ct - hit.emission.ct,
        1.5 * hit.distance,
    );
    assert_eq!(probe.index, 1.5);
}

#[test]
fn the_numbers_of_a_pixel_have_seven_digits_at_any_scale_and_speed() {
    // A cube of a micrometre, seen from 2.5 µm ahead of its face by a camera that flies to it.
    let text = "camera = { eye = [0, 0, 3e-6], forward = [0, 0, -1], size = [9, 7], \
                velocity = { gamma = 1e8, direction = [0, 0, -1] } }\n\
                object = [{ name = \"cube\", shape = { box = { size = [1e-6, 1e-6, 1e-6] } } }]\n";
    let probe = traced(&scene(text), [4, 3]).unwrap();
    let said = probe.to_string();
    // W = 1/(γ (1 + β)).
    for part in [
        "emission      (-2.500000, ",
        ", 0.500000) × 1e-6, object's clock -2.500000e-6\n",
        "distance      2.500000e-6\n",
        "W = λ′/λ      5.000000e-9\n",
        ", -1.000000), γ = 1.000000e8\n",
    ] {
        assert!(said.contains(part), "no {part} in\n{said}");
    }
    let json = serde_json::to_value(&probe).unwrap();
    let rapidity = json["camera_rapidity"][2].as_f64().unwrap();
    assert!((rapidity + 1e8f64.acosh()).abs() < 1e-12, "{rapidity}");
    assert_eq!(json["camera_beta"][2], -1.0);
    assert_eq!(
        json["surface"]["rapidity"],
        serde_json::json!([0.0, 0.0, 0.0])
    );
    assert_eq!(json["surface"]["beta"], json["surface"]["rapidity"]);
}
