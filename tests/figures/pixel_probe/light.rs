//! Reception, pinhole, emission: light between world lines; and where things are now.

use nullray::spacetime::{Event, World};

use crate::pixel_probe::{ALL, SENSOR, STILL, WITH_SENSOR, equal, met, scene, seen, text, traced};

/// How far from null the step between two events is, in parts of its length.
fn off_light(from: Event<World>, to: Event<World>) -> f64 {
    let step = to - from;
    (step.ct - step.x.length()).abs() / step.ct
}

#[test]
fn the_emission_sends_light_to_the_pinhole() {
    for camera in ALL {
        let (sighting, met) = met(camera);
        let off = off_light(met.emission, sighting.reception.pinhole);
        assert!(off <= 1e-12, "{off}: {camera}");
    }
}

#[test]
fn the_pinhole_sends_that_light_on_to_the_sensor_element() {
    for camera in WITH_SENSOR {
        let (sighting, _) = met(camera);
        let reception = sighting.reception;
        let off = off_light(reception.pinhole, reception.event);
        assert!(off <= 1e-12, "{off}: {camera}");
        let way = (reception.pinhole.x - reception.event.x).normalize();
        let error = (way - sighting.direction.unit()).length();
        assert!(error <= 1e-11, "{error}: {camera}");
    }
}

#[test]
fn the_pinhole_is_on_its_world_line_when_its_clock_says_so() {
    for camera in ALL {
        let (sighting, _) = met(camera);
        let moment = sighting.camera.at(sighting.reception.pinhole_time).unwrap();
        let error = moment.event - sighting.reception.pinhole;
        assert!(
            error.ct.abs() + error.x.length() <= 1e-12,
            "{error:?}: {camera}"
        );
    }
}

#[test]
fn the_element_is_on_its_world_line_at_the_time_of_the_shot() {
    for camera in [SENSOR, crate::pixel_probe::BELL, crate::pixel_probe::RIGID] {
        let (sighting, _) = met(camera);
        let moment = sighting
            .element
            .unwrap()
            .at(sighting.reception.time)
            .unwrap();
        let error = moment.event - sighting.reception.event;
        assert!(
            error.ct.abs() + error.x.length() <= 1e-12,
            "{error:?}: {camera}"
        );
    }
}

#[test]
fn a_point_camera_receives_at_the_pinhole() {
    let (sighting, _) = met(STILL);
    assert_eq!(sighting.reception.event, sighting.reception.pinhole);
    assert_eq!(sighting.reception.time, sighting.reception.pinhole_time);
    assert!(sighting.element.is_none());
}

#[test]
fn the_emission_is_on_the_world_line_of_its_point() {
    for camera in ALL {
        let (_, met) = met(camera);
        let error = met.track.at(met.time).unwrap().event - met.emission;
        assert!(
            error.ct.abs() + error.x.length() <= 1e-12,
            "{error:?}: {camera}"
        );
    }
}

#[test]
fn now_is_simultaneous_with_the_reception() {
    for camera in ALL {
        let (sighting, met) = met(camera);
        let reception = sighting.reception;
        let (now, in_world) = (met.now.unwrap(), met.now_in_world.unwrap());
        assert!(
            reception.frame.event_from_world(now).ct.abs() <= 1e-12,
            "{camera}"
        );
        equal(in_world.ct, reception.event.ct);
        let aside = met.track.where_zero(|e| e.ct - now.ct).unwrap().event - now;
        assert!(aside.x.length() <= 1e-12);
    }
}

#[test]
fn a_crate_at_sixty_percent_has_gone_on_by_that_much_of_the_delay() {
    // The camera rests: now is later than the emission by the distance, and the crate has moved 0.6 of it.
    let scene = scene(&text(STILL));
    let pixels = (0..24).flat_map(|row| (0..32).map(move |column| [column, row]));
    let of_crate = pixels.filter_map(|pixel| traced(&scene, pixel).unwrap().met);
    let met = of_crate
        .into_iter()
        .find(|met| met.name == "crate")
        .unwrap();
    let moved = met.now.unwrap() - met.emission;
    equal(moved.ct, met.distance);
    equal(moved.x.x, 0.6 * met.distance);
    // Its clock runs slower by 1/γ = 0.8.
    let clock = met
        .track
        .where_zero(|e| e.ct - met.now.unwrap().ct)
        .unwrap();
    equal(clock.proper_time - met.time, 0.8 * met.distance);
}

const LAMP: &str = "[[source]]\nname = \"lamp\"\n\
                    pulse = { position = [0.5, 3, 1], time = \"-8 m\", sigma = \"4 m\", intensity = 10 }\n";

#[test]
fn a_pulse_is_drawn_back_to_the_event_at_which_the_light_left_it() {
    let scene = scene(&(text(STILL) + LAMP));
    let sighting = traced(&scene, [16, 20]).unwrap();
    let met = sighting.met.unwrap();
    let lamp = &met.pulses[0];
    assert!(off_light(lamp.left, met.emission) <= 1e-12);
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
    let met = traced(&scene, [16, 20]).unwrap().met.unwrap();
    let names: Vec<&str> = met.pulses.iter().map(|lamp| lamp.name.as_str()).collect();
    assert_eq!(names, ["second", "lamp"]);
    equal(met.pulses[0].share, 0.75);
}

#[test]
fn a_pulse_that_is_over_lights_nothing() {
    let over = LAMP.replace("4 m", "1 cm");
    let met = traced(&scene(&(text(STILL) + &over)), [16, 20])
        .unwrap()
        .met
        .unwrap();
    assert!(met.pulses.is_empty());
}

#[test]
fn a_ray_that_meets_nothing_is_followed_as_far_as_there_are_objects() {
    let sighting = seen(STILL, [0, 0]);
    assert!(sighting.met.is_none());
    let end = sighting.far_end();
    equal(
        (end.x - sighting.reception.pinhole.x).length(),
        sighting.reach,
    );
    // The floor's origin is farther than the crate's.
    equal(sighting.reach, 17f64.sqrt());
}

#[test]
fn in_a_medium_light_takes_the_longer_for_its_way() {
    let medium = "[medium]\nindex = 1.5\n";
    let sighting = traced(&scene(&(medium.to_string() + &text(STILL))), [16, 20]).unwrap();
    let met = sighting.met.unwrap();
    equal(
        sighting.reception.pinhole.ct - met.emission.ct,
        1.5 * met.distance,
    );
    assert_eq!(sighting.index, 1.5);
}
