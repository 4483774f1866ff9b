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
