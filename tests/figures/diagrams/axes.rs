//! Axes of moving frames, their ticks, lines of equal time and position, and limits.

use crate::diagrams::{event, laid_out, near, panel, slope};

const MOVING: &str =
    "frame = [{ name = \"S'\", velocity = 0.6, ticks = 1 }]\nx = [-1, 3]\nct = [-1, 3]\n";

#[test]
fn the_axes_of_a_frame_have_the_slopes_of_its_velocity() {
    let panel = panel(MOVING);
    let axes = &panel.axes[1];
    // x = β ct, and ct = β x.
    assert!((slope(axes.time.ends) - 1.0 / 0.6).abs() < 1e-12);
    assert!((slope(axes.space.ends) - 0.6).abs() < 1e-12);
}

#[test]
fn ticks_of_a_moving_frame_are_gamma_apart() {
    let panel = panel(MOVING);
    let one = |axis: &nullray::figures::diagram::Axis| {
        axis.ticks.iter().find(|t| t.value == 1.0).unwrap().at
    };
    // γ = 5/4: (γ, γβ) and (γβ, γ).
    near(one(&panel.axes[1].time), 1.25, 0.75);
    near(one(&panel.axes[1].space), 0.75, 1.25);
}

#[test]
fn axes_are_named_with_the_primes_of_their_frame() {
    let panel = panel(MOVING);
    assert_eq!(panel.axes[0].time.label, "*ct*");
    assert_eq!(panel.axes[1].space.label, "*x*'");
}

#[test]
fn a_unit_of_time_makes_t_of_ct() {
    let panel = panel("unit = \"yr\"\nevent = [{ name = \"A\", at = [3, 1] }]\n");
    assert_eq!(panel.axes[0].time.label, "*t* (yr)");
    assert_eq!(panel.axes[0].space.label, "*x* (ly)");
    near(event(&panel, "A"), 3.0, 1.0);
}

#[test]
fn lines_of_equal_time_have_the_slope_beta_and_those_of_equal_place_its_inverse() {
    let panel = panel(&format!(
        "{MOVING}simultaneity = [{{ frame = \"S'\", event = [1, 0] }}]\n\
         place = [{{ frame = \"S'\", event = [1, 0] }}]\n"
    ));
    assert!((slope(panel.slices[0].ends) - 0.6).abs() < 1e-12);
    assert!((slope(panel.slices[1].ends) - 1.0 / 0.6).abs() < 1e-12);
}

#[test]
fn in_the_view_of_a_moving_frame_the_world_moves_the_other_way() {
    let body = format!("{MOVING}view = \"S'\"\nevent = [{{ name = \"A\", at = [2, 1] }}]\n");
    let panel = panel(&body);
    assert_eq!(panel.axes[0].time.label, "*ct*'");
    assert!((slope(panel.axes[1].space.ends) + 0.6).abs() < 1e-12);
    // (γ(ct − βx), γ(x − β ct)).
    near(event(&panel, "A"), 1.25 * 1.4, 1.25 * -0.2);
}

#[test]
fn two_views_are_two_panels() {
    let layout = laid_out(&format!("{MOVING}view = [\"world\", \"S'\"]\n"));
    let frames: Vec<&str> = layout.panels.iter().map(|p| p.frame.as_str()).collect();
    assert_eq!(frames, ["world", "S'"]);
}

#[test]
fn the_lines_of_a_grid_are_those_of_the_frames_ticks() {
    let panel = panel(
        "frame = [{ name = \"S'\", velocity = 0.6, grid = true, ticks = 1 }]\nx = [-2, 2]\nct = [-2, 2]\n",
    );
    assert!(panel.grid.len() > 8);
    for line in &panel.grid {
        let [a, _] = line.ends;
        let (t, x) = (1.25 * (a.ct - 0.6 * a.x), 1.25 * (a.x - 0.6 * a.ct));
        let off = |v: f64| (v - v.round()).abs();
        assert!(off(t).min(off(x)) < 1e-12, "{line:?}");
    }
}

#[test]
fn automatic_limits_contain_every_event_and_end() {
    let panel = panel(
        "worldline = [{ name = \"w\", through = [[-3, 1], [0, 2], [7, -1]] }]\n\
         event = [{ name = \"A\", at = [4, 11] }]\n",
    );
    let line = &panel.world_lines[0].curve.points;
    assert!(line.iter().all(|p| panel.limits.contains(*p)));
    assert!(panel.limits.contains(event(&panel, "A")));
}

#[test]
fn limits_that_are_said_are_kept() {
    let panel = panel(MOVING);
    assert_eq!(
        (panel.limits.x, panel.limits.ct),
        ([-1.0, 3.0], [-1.0, 3.0])
    );
}
