//! Series of pictures: boosts and sweeping lines of simultaneity.

use nullray::figures::diagram::model::Diagram;
use nullray::figures::diagram::{Panel, Series, layout};

use crate::diagrams::{event, near, parsed, slope};

/// β = 0.6: γ = 5/4.
const BOOST: &str = "\
[diagram]
frame = [{ name = \"S'\", velocity = 0.6 }]
event = [{ name = \"A\", at = [2, 1] }, { name = \"B\", at = [0, 1] }]
animation = { boost_to = \"S'\", frames = 5 }
";

const SWEEP: &str = "\
[diagram]
worldline = [
    { name = \"rest\", ticks = 1 },
    { name = \"moves\", velocity = 0.6, ticks = 1 },
    { name = \"plain\", at = [0, 2] },
]
ct = [-1, 6]
x = [-1, 6]
animation = { now = { from = 0, to = 5 }, frames = 11 }
";

fn model(text: &str) -> Diagram {
    parsed(text).unwrap_or_else(|error| panic!("{error}"))
}

fn picture(text: &str, k: u32) -> Panel {
    layout(&model(text).picture(k)).panels.remove(0)
}

#[test]
fn the_first_picture_is_in_the_view_and_the_last_in_the_frame() {
    let (first, last) = (picture(BOOST, 0), picture(BOOST, 4));
    near(event(&first, "A"), 2.0, 1.0);
    // γ (ct − βx), γ (x − βct)
    near(event(&last, "A"), 1.75, -0.25);
    near(event(&last, "B"), -0.75, 1.25);
}

#[test]
fn every_step_is_the_same_boost() {
    // e^φ = √((1 + β)/(1 − β)) = 2 in four steps: ct + x falls by 2^(−1/4), ct − x grows by as much.
    for k in 0..5 {
        let step = 2f64.powf(f64::from(k) / 4.0);
        let (u, v) = (3.0 / step, 1.0 * step);
        near(event(&picture(BOOST, k), "A"), (u + v) / 2.0, (u - v) / 2.0);
    }
}

#[test]
fn there_and_back_ends_a_step_before_its_beginning() {
    let there = BOOST.replace("frames = 5", "frames = 8, back = true");
    let at = |k| event(&picture(&there, k), "A");
    near(at(4), 1.75, -0.25);
    near(at(0), 2.0, 1.0);
    let (after, before) = (at(1), at(7));
    near(before, after.ct, after.x);
}

#[test]
fn the_axes_of_both_frames_move_and_none_is_the_views() {
    let panel = picture(BOOST, 2);
    // Half the rapidity: β = (√2 − 1)/(√2 + 1) · … = tanh(½ ln 2) = 1/3, opposite for the two.
    let slopes: Vec<f64> = panel.axes.iter().map(|a| slope(a.time.ends)).collect();
    assert_eq!(slopes.len(), 2);
    assert!(
        (slopes[0] + 3.0).abs() < 1e-12 && (slopes[1] - 3.0).abs() < 1e-12,
        "{slopes:?}"
    );
}

/// A camera at rest 4 m from what it sees, whose light is boosted away from it as it moves there.
const SEEN: &str = "\
camera = { eye = [0, 0, 4], look_at = [0, 0, 0], velocity = { beta = [0, 0, -0.6] }, clock_zero = \"7 m\" }
object = [{ shape = { box = { size = [1, 1, 1] } } }]
[diagram]
animation = { boost_to = \"camera\", frames = 5 }
";

#[test]
fn a_boost_about_the_picture_leaves_it_in_its_place_and_shows_where_its_light_left() {
    let mut diagram = model(SEEN);
    let shot = diagram.events[0].at;
    assert_eq!(diagram.events[0].name, "shot");
    diagram.boost_about(shot);
    let (x, ct) = (diagram.x.unwrap(), diagram.ct.unwrap());
    for k in 0..5 {
        let panel = layout(&diagram.picture(k)).panels.remove(0);
        near(event(&panel, "shot"), 0.0, 0.0);
        // What is 4 m ahead is seen 4 · 2^(k/4) m away: e^φ = 2 at 0.6 c.
        let away = 4.0 * 2f64.powf(f64::from(k) / 4.0);
        let [left, _] = panel.signals[0].ends;
        near(left, -away, away);
        assert!(x[0] < left.x && left.x < x[1], "{x:?}");
        assert!(ct[0] < left.ct && left.ct < ct[1], "{ct:?}");
    }
    // Not in the upper edge of the page: there is a fifth of it above the picture, and some beside it.
    assert!(
        ct[1] > 0.2 * (ct[1] - ct[0]) && x[0] < -0.1 * (x[1] - x[0]),
        "{ct:?}"
    );
    // Limits that are given stay.
    let mut given = model(&SEEN.replace("animation", "x = [-1, 9]\nanimation"));
    given.boost_about(shot);
    assert_eq!((given.x, given.ct), (Some([-1.0, 9.0]), None));
}

#[test]
fn all_pictures_of_a_boost_have_one_size_and_hold_its_events() {
    let sizes = Series::new(&model(BOOST)).unwrap().map(|drawing| {
        let drawing = drawing.unwrap();
        [drawing.width, drawing.height]
    });
    let sizes: Vec<_> = sizes.collect();
    assert_eq!(sizes.len(), 5);
    assert!(sizes.iter().all(|size| *size == sizes[0]), "{sizes:?}");
}

#[test]
fn clocks_on_a_line_of_simultaneity_show_their_own_times() {
    // At ct = 5: 5 at rest, 5/γ = 4 at β = 0.6, and nothing where there are no ticks.
    let now = picture(SWEEP, 10).now.unwrap();
    let labels: Vec<_> = now.beads.iter().map(|b| b.label.as_deref()).collect();
    assert_eq!(labels, [Some("5.00"), Some("4.00"), None]);
    near(now.beads[1].at, 5.0, 3.0);
    assert!((now.beads[1].proper_time - 4.0).abs() < 1e-12);
    assert_eq!(slope(now.ends), 0.0);
}

#[test]
fn a_sweep_goes_in_equal_steps() {
    for k in 0..11 {
        let now = picture(SWEEP, k).now.unwrap();
        assert!((now.ends[0].ct - 0.5 * f64::from(k)).abs() < 1e-12);
    }
}

#[test]
fn a_diagram_without_animation_has_no_series() {
    assert!(
        Series::new(&model(
            "[diagram]\nevent = [{ name = \"A\", at = [0, 0] }]\n"
        ))
        .is_none()
    );
}
