//! World lines, light, hyperbolae and intervals.

use nullray::figures::diagram::Kind;

use crate::diagrams::{event, laid_out, near, panel, parsed, slope};

const TWINS: &str = "\
worldline = [
  { name = \"Alice\", through = [[0, 0], [10, 0]] },
  { name = \"Bob\", through = [[0, 0], [5, 4], [10, 0]], ticks = 1 },
]
";

#[test]
fn a_crossing_of_inertial_lines_is_where_their_equations_say() {
    // x = 0.6 ct and x = 2 − 0.2 ct: ct = 2.5.
    let panel = panel(
        "worldline = [{ name = \"a\", velocity = 0.6 }, { name = \"b\", at = [0, 2], velocity = -0.2 }]\n\
         event = [{ name = \"X\", cross = [\"a\", \"b\"] }]\n",
    );
    near(event(&panel, "X"), 2.5, 1.5);
}

#[test]
fn lines_that_part_cross_where_they_meet_again() {
    let panel = panel(&format!(
        "{TWINS}event = [{{ name = \"X\", cross = [\"Alice\", \"Bob\"] }}]\n"
    ));
    near(event(&panel, "X"), 10.0, 0.0);
}

#[test]
fn the_ticks_of_a_broken_line_are_its_own_time() {
    let panel = panel(TWINS);
    // 1/γ = 0.6: six years in ten.
    let ticks = &panel.world_lines[1].ticks;
    assert_eq!(ticks.len(), 7);
    near(ticks[1].at, 5.0 / 3.0, 4.0 / 3.0);
    near(ticks[3].at, 5.0, 4.0);
}

#[test]
fn ticks_of_constant_acceleration_are_on_the_hyperbola() {
    let panel = panel(
        "worldline = [{ name = \"w\", at = [0, 1], acceleration = 1, ticks = 0.5 }]\nx = [0, 4]\nct = [-3, 3]\n",
    );
    for tick in &panel.world_lines[0].ticks {
        near(tick.at, libm::sinh(tick.value), libm::cosh(tick.value));
    }
    let curve = &panel.world_lines[0].curve.points;
    assert!(curve.len() > 20);
    assert!(
        curve
            .iter()
            .all(|p| (p.x * p.x - p.ct * p.ct - 1.0).abs() < 1e-12 * p.x * p.x)
    );
}

#[test]
fn light_goes_at_45_degrees_to_its_reception_and_back() {
    let panel = panel(
        "worldline = [{ name = \"a\" }, { name = \"b\", velocity = 0.6 }]\n\
         signal = [{ from = \"a\", proper_time = 1, to = [\"b\", \"a\"] }]\n",
    );
    let [out, back] = [panel.signals[0].ends, panel.signals[1].ends];
    // k = 2: received at (2.5, 1.5), back at k² = 4.
    near(out[1], 2.5, 1.5);
    near(back[1], 4.0, 0.0);
    assert!((slope(out) - 1.0).abs() < 1e-12);
    assert!((slope(back) + 1.0).abs() < 1e-12);
}

#[test]
fn signals_at_regular_times_arrive_at_those_of_the_doppler_factor() {
    let panel = panel(&format!(
        "{TWINS}signal = [{{ from = \"Bob\", every = 1, to = \"Alice\" }}]\n"
    ));
    // k = 3 on the way out, 1/3 on the way back; the last is sent where they meet.
    let arrivals = [3.0, 6.0, 9.0, 9.0 + 1.0 / 3.0, 9.0 + 2.0 / 3.0];
    assert_eq!(panel.signals.len(), arrivals.len());
    for (signal, ct) in panel.signals.iter().zip(arrivals) {
        near(signal.ends[1], ct, 0.0);
    }
}

#[test]
fn an_event_is_where_light_reaches_or_leaves_a_line() {
    let panel = panel(
        "worldline = [{ name = \"w\", at = [0, 3] }]\n\
         event = [{ name = \"A\", at = [0, 0] }, { name = \"L\", on = \"w\", light_from = \"A\" }, \
         { name = \"E\", on = \"w\", light_to = \"A\" }]\n",
    );
    near(event(&panel, "L"), 3.0, 3.0);
    near(event(&panel, "E"), -3.0, 3.0);
}

#[test]
fn the_rays_of_a_light_cone_have_slopes_one_and_minus_one() {
    let panel = panel("light_cone = [{ of = [1, 2] }]\n");
    let rays = &panel.cones[0].rays;
    assert_eq!(rays.len(), 4);
    assert!(
        rays.iter()
            .all(|ray| (slope(*ray).abs() - 1.0).abs() < 1e-12)
    );
}

#[test]
fn a_hyperbola_holds_its_event_in_every_frame() {
    for view in ["world", "S'"] {
        let panel = panel(&format!(
            "frame = [{{ name = \"S'\", velocity = 0.6 }}]\nview = \"{view}\"\n\
             hyperbola = [{{ through = [1.25, 0.75] }}]\n"
        ));
        let curve = &panel.hyperbolae[0].curve.points;
        // Interval 1 from the origin, whatever the frame.
        for p in curve {
            let allowed = 1e-12 * p.ct * p.ct;
            assert!(((p.ct - p.x) * (p.ct + p.x) - 1.0).abs() < allowed, "{p:?}");
        }
    }
}

#[test]
fn intervals_have_their_value_and_kind() {
    let panel = panel(
        "interval = [{ from = [0, 0], to = [5, 3] }, { from = [0, 0], to = [3, 5] }, { from = [0, 0], to = [2, -2] }]\n",
    );
    let found: Vec<_> = panel
        .intervals
        .iter()
        .map(|i| (i.squared, i.kind))
        .collect();
    assert_eq!(
        found,
        [
            (16.0, Kind::Timelike),
            (-16.0, Kind::Spacelike),
            (0.0, Kind::Null)
        ]
    );
    assert_eq!(panel.intervals[0].label, "Δ*τ* = 4");
}

#[test]
fn intervals_keep_their_digits_at_any_speed() {
    for gamma in ["1.25", "1e4", "5e6", "1e9", "1e15"] {
        let panel = panel(&format!(
            "frame = [{{ name = \"S'\", velocity = {{ gamma = {gamma} }} }}]\n\
             worldline = [{{ name = \"f\", velocity = {{ gamma = {gamma} }} }}]\n\
             event = [\n\
             {{ name = \"O\", at = [0, 0] }}, {{ name = \"E\", at = [0, 1] }},\n\
             {{ name = \"A\", at = [1, 2], frame = \"S'\" }}, {{ name = \"B\", at = [3, 2.5], frame = \"S'\" }},\n\
             {{ name = \"C\", at = [2, 3], frame = \"S'\" }}, {{ name = \"P\", on = \"f\", proper_time = 1 }},\n\
             {{ name = \"Q\", on = \"f\", proper_time = 4.5 }}, {{ name = \"R\", on = \"f\", light_from = \"E\" }},\n]\n\
             interval = [\n\
             {{ from = \"A\", to = \"B\" }}, {{ from = \"O\", to = \"P\" }}, {{ from = \"P\", to = \"Q\" }},\n\
             {{ from = \"B\", to = \"Q\" }}, {{ from = \"A\", to = \"C\" }}, {{ from = \"E\", to = \"R\" }},\n]\n"
        ));
        // In S', in which f rests at the origin: (Δct)² − (Δx)².
        let expected = [
            (2.0 * 2.0 - 0.5 * 0.5, Kind::Timelike),
            (1.0, Kind::Timelike),
            (3.5 * 3.5, Kind::Timelike),
            (1.5 * 1.5 - 2.5 * 2.5, Kind::Spacelike),
            (0.0, Kind::Null),
            (0.0, Kind::Null),
        ];
        for (interval, (squared, kind)) in panel.intervals.iter().zip(expected) {
            assert_eq!(interval.kind, kind, "{gamma}: {interval:?}");
            let is_right = (interval.squared - squared).abs() <= 1e-12;
            assert!(is_right || kind == Kind::Null, "{gamma}: {interval:?}");
        }
        assert_eq!(panel.intervals[0].label, "Δ*τ* = 1.936");
    }
}

#[test]
fn an_interval_that_rounding_hides_is_not_said_to_be_that_of_light() {
    let of = |gammas: [f64; 2]| {
        let [a, b] = gammas;
        laid_out(&format!(
            "frame = [{{ name = \"S'\", velocity = {{ gamma = {a:e} }} }}, {{ name = \"S''\", velocity = {{ gamma = {b:e} }} }}]\n\
             event = [{{ name = \"A\", at = [1, 0], frame = \"S'\" }}, {{ name = \"B\", at = [1, 0], frame = \"S''\" }}]\n\
             interval = [{{ from = \"A\", to = \"B\" }}]\n"
        ))
    };
    // Of two clocks that part at 0, when they show 1: s² = 2 − 2γ, with γ = γ_a γ_b (1 − β_a β_b) between them.
    let slow = of([1.25, 5.0 / 3.0]);
    let interval = &slow.panels[0].intervals[0];
    let squared = 2.0 - 2.0 * (1.25 * 5.0 / 3.0) * (1.0 - 0.6 * 0.8);
    assert_eq!(interval.kind, Kind::Spacelike);
    assert!((interval.squared - squared).abs() < 1e-12, "{interval:?}");
    assert!(slow.notes.is_empty());
    // γ = (2 + ½)/2 at twice the e^w.
    let fast = of([1e9, 2e9]);
    let interval = &fast.panels[0].intervals[0];
    assert_eq!(interval.kind, Kind::Unresolved);
    assert!(interval.squared > 0.5, "{interval:?}");
    assert!(interval.label.starts_with("|Δ*s*| < "), "{interval:?}");
    assert!(fast.notes[0].text.contains("one frame"), "{:?}", fast.notes);
}

#[test]
fn times_and_accelerations_have_the_speed_of_light_of_the_scene() {
    let of = |unit: &str| {
        let text = format!(
            "speed_of_light = \"10 m/s\"\n\
             [camera]\nforward = [0, 0, -1]\n\
             motion = {{ keyframes = [{{ time = \"0 s\", position = [0, 0, 0] }}, {{ time = \"3 s\", position = [6, 0, 0] }}] }}\n\
             [diagram]\nunit = \"{unit}\"\ndirection = [1, 0, 0]\n\
             worldline = [{{ name = \"film\", of = \"camera\" }}, {{ name = \"ship\", acceleration = \"9.80665 m/s2\", from = [0, 0], to = [4, 0] }},\n\
             {{ name = \"q\", segments = [{{ acceleration = \"0.5 c/s\" }}], from = [0, 0], to = [3, 0] }}]\n\
             event = [{{ name = \"O\", at = [0, 0] }}, {{ name = \"P\", on = \"ship\", proper_time = 2 }}, {{ name = \"Q\", on = \"q\", proper_time = 1 }}]\n\
             interval = [{{ from = \"O\", to = \"P\" }}, {{ from = \"O\", to = \"Q\" }}]\n"
        );
        let model = parsed(&text).unwrap_or_else(|error| panic!("{error}"));
        nullray::figures::diagram::layout(&model).panels.remove(0)
    };
    // A clock with the acceleration a shows τ, one that coasts between the same events (2c/a) sinh(aτ/2c).
    let coasting = |a: f64, time: f64| 2.0 / a * (0.5 * a * time).sinh();
    for (unit, seconds) in [("s", 1.0), ("m", 0.1)] {
        let panel = of(unit);
        let points = &panel.world_lines[0].curve.points;
        // 3 s, in which the camera goes as far as light in 0.6 s.
        near(points[points.len() - 1], 3.0 / seconds, 0.6 / seconds);
        for (interval, expected) in panel.intervals.iter().zip([
            coasting(0.980_665 * seconds, 2.0),
            coasting(0.5 * seconds, 1.0),
        ]) {
            let value = interval.squared.sqrt();
            assert!(
                (value - expected).abs() < 1e-9,
                "{unit}: {value} is not {expected}"
            );
        }
    }
}

const LAMPS: &str = "\
[[light]]\nname = \"still\"\nposition = [2, 0, 0]\n\
[[light]]\nname = \"moving\"\nposition = [1, 0, 0]\nclock_zero = \"2 m\"\nvelocity = { beta = [0.6, 0, 0] }\n\
[[light]]\ntype = \"spot\"\nposition = [0, 0, 0]\ndirection = [0, -1, 0]\n\
motion = { acceleration = { proper = \"1 /m\", direction = [1, 0, 0] } }\n\
[[light]]\nposition = [1, 0, 0]\nmotion = { circle = { centre = [0, 0, 0], axis = [0, 0, 1], period = \"8 m\" } }\n\
[[light]]\nname = \"path\"\n\
motion = { keyframes = [{ time = \"0 m\", position = [0, 0, 0] }, { time = \"4 m\", position = [2, 0, 0] }] }\n\
[[source]]\nname = \"flash\"\npulse = { position = [3, 0, 0], time = \"1 m\", sigma = \"5 cm\" }\n";

#[test]
fn lamps_and_pulses_of_a_scene_have_their_world_lines() {
    let names = ["still", "moving", "spot", "point", "path", "flash"];
    let lines = names.map(|name| format!("{{ name = \"of {name}\", of = \"{name}\" }}"));
    let events = names.map(|name| match name {
        "path" => "{ name = \"path\", on = \"of path\", simultaneous_with = [2, 0] }".to_string(),
        name => format!("{{ name = \"{name}\", on = \"{name}\", proper_time = 1 }}"),
    });
    let panel = panel(&format!(
        "direction = [1, 0, 0]\nworldline = [{}]\nevent = [{}]\nframe = [{{ name = \"of lamp\", of = \"moving\" }}]\n{LAMPS}",
        lines.join(", "),
        events.join(", ")
    ));
    near(event(&panel, "still"), 1.0, 2.0);
    near(event(&panel, "moving"), 2.0 + 1.25, 1.0 + 0.75);
    near(event(&panel, "spot"), 1f64.sinh(), 1f64.cosh() - 1.0);
    let rate = std::f64::consts::FRAC_PI_4;
    let ct = 1.0 / (1.0 - rate * rate).sqrt();
    near(event(&panel, "point"), ct, (rate * ct).cos());
    near(event(&panel, "path"), 2.0, 1.0);
    near(event(&panel, "flash"), 2.0, 3.0);
}

#[test]
fn velocities_relative_to_a_moving_frame_add_as_rapidities() {
    let panel = panel(
        "frame = [{ name = \"S'\", velocity = 0.5 }, { name = \"S''\", velocity = 0.5, relative_to = \"S'\" }]\n\
         event = [{ name = \"C\", at = [3, 0], frame = \"S''\" }]\n",
    );
    // β = 0.8, γ = 5/3.
    near(event(&panel, "C"), 5.0, 4.0);
}

#[test]
fn a_four_velocity_has_components_gamma_and_gamma_beta() {
    let panel = panel(
        "worldline = [{ name = \"w\", velocity = 0.6 }]\narrow = [{ of = \"w\", proper_time = 4 }]\n",
    );
    near(panel.arrows[0].ends[0], 5.0, 3.0);
    near(panel.arrows[0].ends[1], 6.25, 3.75);
}

#[test]
fn the_camera_of_a_scene_has_its_world_line_and_its_light() {
    let text = "camera = { eye = [0, 0, 0], look_at = [0, 0, -1], velocity = { beta = [0, 0, -0.6] }, time = \"4 m\" }\n\
                object = [{ name = \"ball\", shape = { sphere = { radius = 1 } }, origin = { position = [0, 0, -9] } }]\n";
    let layout = nullray::figures::diagram::layout(&crate::diagrams::parsed(text).unwrap());
    let panel = &layout.panels[0];
    near(event(panel, "shot"), 5.0, 3.0);
    // From 6 m away.
    near(panel.signals[0].ends[0], -1.0, 9.0);
    assert_eq!(panel.world_lines.len(), 2);
}

#[test]
fn a_circle_from_the_side_is_a_cosine() {
    // R = 1, T = 8, farthest at [0, 2]: x = 1 + cos(π ct/4); γ² = 1/(1 − (π/4)²).
    let panel = panel(
        "ct = [0, 8]\nworldline = [{ name = \"w\", at = [0, 2], circle = { radius = 1, period = 8 } }]\n",
    );
    let points = &panel.world_lines[0].curve.points;
    assert!(points.len() > 20);
    for p in points {
        let x = 1.0 + (std::f64::consts::FRAC_PI_4 * p.ct).cos();
        near(*p, p.ct, x);
    }
}

#[test]
fn automatic_limits_hold_a_revolution() {
    let panel =
        panel("worldline = [{ name = \"w\", at = [0, 2], circle = { radius = 1, period = 8 } }]\n");
    let limits = panel.limits;
    assert!(
        limits.x[0] < 0.0 && limits.x[1] > 2.0 && limits.ct[1] > 8.0,
        "{limits:?}"
    );
}

#[test]
fn a_constant_profile_is_a_hyperbola_until_its_end() {
    // x = cosh τ − 1 for a proper acceleration of 1, from rest.
    let panel = panel("ct = [-1, 9]\nworldline = [{ name = \"w\", profile = [[0, 1], [2, 1]] }]\n");
    let points = &panel.world_lines[0].curve.points;
    let (first, last) = (points[0], points[points.len() - 1]);
    near(first, 0.0, 0.0);
    near(last, 2f64.sinh(), 2f64.cosh() - 1.0);
}

#[test]
fn a_line_of_equal_place_ends_where_it_meets_its_world_line() {
    // In S' (β = 0.6) at rest from the origin: x = 0.6 ct meets x = 1 + 0.1 ct at ct = 2.
    let panel = panel(
        "ct = [-1, 4]\nx = [-1, 4]\nframe = [{ name = \"S'\", velocity = 0.6 }]\n\
         worldline = [{ name = \"w\", at = [0, 1], velocity = 0.1 }]\n\
         place = [{ frame = \"S'\", event = [0, 0], to = \"w\" }]\n",
    );
    near(panel.slices[0].ends[1], 2.0, 1.2);
}
