use super::super::contour::{Grid, pieces};
use super::super::range::Range;
use super::*;

fn lines_of(width: usize, height: usize, f: impl Fn(f64, f64) -> f64, step: f64) -> Vec<Points> {
    let centre = |i: usize| (i % width, i / width);
    let ct: Vec<f64> = (0..width * height)
        .map(centre)
        .map(|(x, y)| f(x as f64 + 0.5, y as f64 + 0.5))
        .collect();
    let range = Range::of(&ct, Some(step)).unwrap();
    let grid = Grid {
        width,
        height,
        ct: &ct,
    };
    pieces(&grid, &range)
        .iter()
        .flat_map(|p| polylines(p))
        .map(|line| line.points)
        .collect()
}

#[test]
fn a_tilted_plane_has_straight_lines_in_the_exact_place() {
    // Bilinear interpolation is exact on a plane: every point of line k has 0.3 x + 0.1 y = k.
    let lines = lines_of(40, 30, |x, y| 0.3 * x + 0.1 * y, 1.0);
    assert_eq!(lines.len(), 14, "k = 1 to 14");
    for line in &lines {
        let value = |p: &[f64; 2]| 0.3 * p[0] + 0.1 * p[1];
        let k = value(&line[0]).round();
        assert!(line.iter().all(|p| (value(p) - k).abs() < 1e-12));
    }
}

#[test]
fn a_cone_has_closed_circles() {
    // Distance from a point: a chord of linear interpolation is at most h²/(8 r) off.
    let r = |x: f64, y: f64| libm::hypot(x - 32.2, y - 31.7);
    let lines = lines_of(64, 64, r, 10.0);
    let closed: Vec<_> = lines.iter().filter(|l| l.first() == l.last()).collect();
    assert_eq!(closed.len(), 3, "radii 10, 20, 30");
    for line in closed {
        let radius = (r(line[0][0], line[0][1]) / 10.0).round() * 10.0;
        let bound = 2.0 / (8.0 * radius) + 1e-12;
        assert!(line.iter().all(|p| (r(p[0], p[1]) - radius).abs() < bound));
    }
}

#[test]
fn no_line_runs_along_a_jump_or_a_hole() {
    // Two slanted surfaces; at x = 10 the time jumps by 100, and part of the first was not seen.
    let lines = lines_of(
        20,
        20,
        |x, y| match (x < 10.0, y < 5.0) {
            (true, true) => f64::NAN,
            (true, false) => 0.1 * y,
            (false, _) => 100.0 + 0.1 * y,
        },
        1.0,
    );
    assert!(!lines.is_empty());
    for p in lines.iter().flatten() {
        assert!((p[0] < 10.0 && p[1] > 5.0) || p[0] >= 10.0, "{p:?}");
        assert!((p[1] / 10.0 - (p[1] / 10.0).round()).abs() < 1e-9, "{p:?}");
    }
}

#[test]
fn a_line_knows_how_close_its_neighbours_are() {
    let ct: Vec<f64> = (0..10).map(f64::from).flat_map(|x| [x, x]).collect();
    let range = Range::of(&ct, Some(0.5)).unwrap();
    let (width, height) = (2, 10);
    let grid = Grid {
        width,
        height,
        ct: &ct,
    };
    let lines = pieces(&grid, &range);
    assert!(
        lines
            .iter()
            .flat_map(|p| polylines(p))
            .all(|line| line.density == 2.0)
    );
}

#[test]
fn saddles_have_lines_that_do_not_cross() {
    // x y around the saddle at (10, 10): every line is a branch of a hyperbola.
    let lines = lines_of(20, 20, |x, y| (x - 10.0) * (y - 10.0) + 1e-3, 8.0);
    for line in lines {
        let side = |p: &[f64; 2]| (p[0] > 10.0, p[1] > 10.0);
        let value = ((line[0][0] - 10.0) * (line[0][1] - 10.0) / 8.0).round();
        if value != 0.0 {
            assert!(line.iter().all(|p| side(p) == side(&line[0])));
        }
    }
}
