//! Diagrams of 2+1 dimensions: cones, planes, projection, floor.

use nullray::figures::diagram::{Nappe, Point, Projection};

use crate::diagrams::refused::check;
use crate::diagrams::{event, panel};

const CONE: &str = "dimensions = \"2+1\"\nevent = [{ name = \"A\", at = [1, 2, 3] }]\n\
                    light_cone = [{ of = \"A\", height = 1.5 }]\n";

#[track_caller]
fn equal(found: f64, expected: f64) {
    let error = (found - expected).abs();
    assert!(
        error <= 1e-12 * expected.abs().max(1.0),
        "{found} is not {expected}"
    );
}

/// Δx, Δy, Δct from the apex.
fn from_apex(nappe: &Nappe, p: &Point) -> [f64; 3] {
    [p.x - nappe.apex.x, p.y - nappe.apex.y, p.ct - nappe.apex.ct]
}

/// Cosine and sine of the turn, and the height of a circle: 24/25, −7/25 and 7/24; ct is stretched by √(1 + (7/24)²) = 25/24.
const TURN: [f64; 2] = [0.96, -0.28];
const HEIGHT: f64 = 7.0 / 24.0;

#[test]
fn an_event_is_drawn_where_the_projection_has_it() {
    // (0.96·2 − 0.28·3, 25/24·1 + 7/24 (0.96·3 + 0.28·2)).
    let panel = panel(CONE);
    let at = event(&panel, "A");
    assert_eq!([at.ct, at.x, at.y], [1.0, 2.0, 3.0]);
    assert_eq!(panel.projection(), Projection::Room);
    let [right, up] = at.page(Projection::Room);
    equal(right, 1.08);
    equal(up, 25.0 / 24.0 + 7.0 / 24.0 * 3.44);
    assert_eq!(at.page(Projection::Plane), [2.0, 1.0]);
}

#[test]
fn the_time_axis_and_cones_stand_upright_and_their_outlines_are_at_45_degrees() {
    let page = |p: Point| p.page(Projection::Room);
    assert_eq!(page(Point::deep(1.0, 0.0, 0.0))[0], 0.0);
    for nappe in &panel(CONE).cones[0].nappes {
        let [first, apex, last] = nappe.outline().map(page);
        for edge in [first, last] {
            equal(
                (edge[1] - apex[1]) / (edge[0] - apex[0]).abs(),
                nappe.height.signum(),
            );
        }
        equal(first[0] + last[0], 2.0 * apex[0]);
        // The rim is an upright ellipse: its highest and its lowest point are straight above the apex.
        let rim: Vec<_> = nappe
            .near
            .iter()
            .chain(&nappe.far)
            .map(|p| page(*p))
            .collect();
        let middle = apex[1] + 25.0 / 24.0 * nappe.height;
        for [right, up] in rim {
            let (u, v) = (right - apex[0], (up - middle) / HEIGHT);
            equal(u.hypot(v), nappe.height.abs());
        }
    }
}

#[test]
fn generators_of_a_cone_are_light() {
    let panel = panel(CONE);
    let nappes = &panel.cones[0].nappes;
    assert_eq!(
        nappes.iter().map(|n| n.height).collect::<Vec<_>>(),
        [1.5, -1.5]
    );
    for nappe in nappes {
        for p in nappe.near.iter().chain(&nappe.far) {
            let [x, y, ct] = from_apex(nappe, p);
            equal(x.hypot(y), ct.abs());
            equal(ct, nappe.height);
        }
    }
}

#[test]
fn the_outline_of_a_cone_touches_its_rim() {
    // With ψ the angle about the apex from the direction to the right, the outline is where sin ψ = ∓k/s.
    for nappe in &panel(CONE).cones[0].nappes {
        let [first, apex, last] = nappe.outline();
        assert_eq!(apex, nappe.apex);
        for edge in [first, last] {
            let [x, y, _] = from_apex(nappe, &edge);
            let away = (y * TURN[0] - x * TURN[1]) / nappe.height.abs();
            equal(away, -7.0 / 25.0 * nappe.height.signum());
        }
    }
}

#[test]
fn the_near_side_of_a_cone_is_in_front_of_the_far_side() {
    for nappe in &panel(CONE).cones[0].nappes {
        let middle = |side: &[Point]| {
            let [x, y, _] = from_apex(nappe, &side[side.len() / 2]);
            y * TURN[0] - x * TURN[1]
        };
        assert!(middle(&nappe.near) < 0.0 && middle(&nappe.far) > 0.0);
    }
}

#[test]
fn a_cone_hides_what_is_behind_and_within_it_but_not_what_is_on_its_near_side() {
    let panel = panel(CONE);
    let past = &panel.cones[0].nappes[1];
    let at = |ct: f64, x: f64, y: f64| past.apex.plus(1.0, Point::deep(ct, x, y));
    assert!(past.hides(at(-1.0, 0.0, 0.0), 1e-6), "within");
    assert!(past.hides(at(-1.2, 0.0, 1.5), 1e-6), "behind");
    assert!(past.hides(at(-1.0, 0.0, 1.0), 1e-6), "on the far side");
    assert!(!past.hides(at(-1.0, 0.0, -1.0), 1e-6), "on the near side");
    assert!(!past.hides(at(-1.0, 0.0, -2.0), 1e-6), "in front");
    assert!(!past.hides(at(-1.0, 3.0, 0.0), 1e-6), "beside");
}

#[test]
fn what_is_simultaneous_in_a_moving_frame_is_a_plane_that_rises_by_beta() {
    let panel = panel(
        "dimensions = \"2+1\"\nx = [-2, 2]\ny = [-2, 2]\nct = [-3, 3]\n\
         frame = [{ name = \"S'\", velocity = { beta = [0.5, 0.25, 0] } }]\n\
         event = [{ name = \"A\", at = [0.5, 0, 0] }]\n\
         simultaneity = [{ event = \"A\", frame = \"S'\" }]\n",
    );
    let plane = &panel.planes[0];
    equal(plane.rise[0], 0.5);
    equal(plane.rise[1], 0.25);
    assert_eq!(plane.corners.len(), 4);
    for corner in &plane.corners {
        equal(corner.ct, 0.5 + 0.5 * corner.x + 0.25 * corner.y);
    }
    let below = Point::deep(0.3, 0.0, 0.0);
    assert!(plane.hides(below, 1e-6) && !plane.hides(Point::deep(1.0, 0.0, 0.0), 1e-6));
    assert!(panel.slices.is_empty());
}

#[test]
fn a_plane_is_cut_off_at_the_highest_ct() {
    let panel = panel(
        "dimensions = \"2+1\"\nx = [-2, 2]\ny = [-2, 2]\nct = [-3, 0.5]\n\
         frame = [{ name = \"S'\", velocity = 0.5 }]\n\
         simultaneity = [{ event = [0, 0, 0], frame = \"S'\" }]\nevent = [{ name = \"A\", at = [0, 0] }]\n",
    );
    let highest = panel.planes[0]
        .corners
        .iter()
        .map(|c| c.ct)
        .fold(f64::MIN, f64::max);
    equal(highest, 0.5);
    // x = 1, where the plane is at 0.5.
    let right = panel.planes[0]
        .corners
        .iter()
        .map(|c| c.x)
        .fold(f64::MIN, f64::max);
    equal(right, 1.0);
}

#[test]
fn shadows_and_drops_are_straight_below() {
    let panel = panel(
        "dimensions = \"2+1\"\nct = [-1, 2]\nx = [-2, 2]\ny = [-2, 2]\n\
         event = [{ name = \"A\", at = [1, 0.5, -0.5] }]\n\
         worldline = [{ name = \"w\", velocity = { beta = [0.25, 0.5, 0] } }]\n",
    );
    let solid = panel.solid.unwrap();
    let [from, to] = solid.drops[0];
    assert_eq!([from.ct, from.x, from.y], [1.0, 0.5, -0.5]);
    assert_eq!([to.ct, to.x, to.y], [-1.0, 0.5, -0.5]);
    let end = solid.shadows[0].points.last().unwrap();
    equal(end.x, 0.5);
    equal(end.y, 1.0);
    equal(end.ct, -1.0);
}

#[test]
fn a_world_line_ends_at_the_walls() {
    let panel = panel(
        "dimensions = \"2+1\"\nct = [-4, 4]\nx = [-1, 1]\ny = [-1, 1]\n\
         worldline = [{ name = \"w\", velocity = 0.5 }]\n",
    );
    let points = &panel.world_lines[0].curve.points;
    equal(points[0].x, -1.0);
    equal(points[0].ct, -2.0);
    equal(points[points.len() - 1].ct, 2.0);
}

#[test]
fn automatic_limits_hold_the_rims_of_cones() {
    let panel = panel(
        "dimensions = \"2+1\"\nevent = [{ name = \"A\", at = [0, 0, 0] }, { name = \"B\", at = [-2, 0.5, 0] }]\n\
         light_cone = [{ of = \"A\", past = true }]\n",
    );
    let nappe = &panel.cones[0].nappes[0];
    // As deep as B, which is the lowest.
    assert!(nappe.height <= -2.0, "{}", nappe.height);
    assert!(
        nappe
            .near
            .iter()
            .chain(&nappe.far)
            .all(|p| panel.limits.contains(*p))
    );
}

#[test]
fn a_signal_in_three_dimensions_is_light() {
    let panel = panel(
        "dimensions = \"2+1\"\nworldline = [{ name = \"w\", at = [0, 1, 1], velocity = { beta = [0.3, 0, 0.1] } }]\n\
         across = [0, 0, 1]\nsignal = [{ from = [0, 0, -1], to = \"w\" }]\n",
    );
    let [from, to] = panel.signals[0].ends;
    equal((to.x - from.x).hypot(to.y - from.y), to.ct - from.ct);
}

#[test]
fn lines_that_pass_each_other_do_not_cross() {
    check(
        "dimensions = \"2+1\"\nworldline = [{ name = \"a\", velocity = 0.5 }, { name = \"b\", at = [0, 1, 1] }]\n\
         event = [{ name = \"X\", cross = [\"a\", \"b\"] }]\n",
        "diagram.event[0].cross",
        "do not cross",
        "that meet",
    );
}

#[test]
fn lines_of_one_plane_are_refused() {
    let solid = "dimensions = \"2+1\"\nevent = [{ name = \"A\", at = [0, 0] }]\n";
    check(
        &format!("{solid}frame = [{{ name = \"S'\", velocity = 0.5, grid = true }}]\n"),
        "diagram.frame[0]",
        "needs a diagram of 1+1 dimensions",
        "`simultaneity`",
    );
    check(
        &format!("{solid}hyperbola = [{{ proper_time = 1 }}]\n"),
        "diagram.hyperbola[0]",
        "a hyperbola of constant interval",
        "a surface",
    );
    check(
        &format!("{solid}wedge = [{{ of = \"A\", side = \"right\" }}]\n"),
        "diagram.wedge[0]",
        "needs a diagram of 1+1 dimensions",
        "light cone",
    );
}

#[test]
fn a_third_coordinate_needs_a_third_dimension() {
    check(
        "event = [{ name = \"A\", at = [0, 0, 1] }]\n",
        "diagram.event[0].at",
        "this diagram has 1+1",
        "2+1",
    );
    check(
        "y = [0, 1]\n",
        "diagram.y",
        "needs a diagram of 2+1 dimensions",
        "leave it out",
    );
    check(
        "across = [0, 1, 0]\n",
        "diagram.across",
        "needs a diagram of 2+1",
        "2+1",
    );
    check(
        "light_cone = [{ of = [0, 0], height = 1 }]\n",
        "diagram.light_cone[0].height",
        "go to the edges",
        "2+1",
    );
}

#[test]
fn directions_along_one_line_are_refused() {
    check(
        "dimensions = \"2+1\"\ndirection = [0, 2, 0]\nacross = [0, -1, 0]\n",
        "diagram.across",
        "along the same line",
        "not along x",
    );
}
