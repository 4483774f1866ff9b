//! Arrowheads, dashes, curves and text are where they should be.

use nullray::figures::drawing::{
    Anchor, AnchorX, AnchorY, Arrow, Colour, Drawing, Item, Node, Path, Stroke, Text, png, svg,
};
use nullray::text::{Rect, Segment};

use super::samples::{page, text};
use super::svg_reader::{Token, data, tokens};

/// The paths of a drawing as its SVG file has them, without that of the background.
fn paths(items: Vec<Item>) -> Vec<Vec<Segment>> {
    let file = svg::write(&page("", items)).unwrap();
    let paths = tokens(&file).into_iter().filter_map(|token| match token {
        Token::Start(name, attributes, _) if name == "path" => Some(data(&attributes["d"])),
        _ => None,
    });
    paths.skip(1).collect()
}

fn ends(path: &[Segment]) -> Vec<[f64; 2]> {
    path.iter().filter_map(|segment| segment.end()).collect()
}

const ARROW: Arrow = Arrow {
    length: 8.0,
    width: 6.0,
};

#[test]
fn the_tip_of_an_arrow_is_the_end_of_its_path() {
    let (from, to) = ([10.0625, 50.125], [70.1234, 12.5]);
    let stroke = Stroke::new(Colour::BLACK, 1.0)
        .starting(ARROW)
        .ending(ARROW);
    let paths = paths(vec![Item::stroked(Path::line(from, to), stroke)]);
    assert_eq!((ends(&paths[1])[0], ends(&paths[2])[0]), (to, from));
}

#[test]
fn a_head_is_as_long_and_as_wide_as_its_arrow_says() {
    let line = Path::line([10.0, 30.0], [100.0, 30.0]);
    let stroke = Stroke::new(Colour::BLACK, 1.0).ending(ARROW);
    let paths = paths(vec![Item::stroked(line, stroke)]);
    let head = [[100.0, 30.0], [92.0, 33.0], [94.0, 30.0], [92.0, 27.0]];
    assert_eq!(ends(&paths[1]), head);
}

#[test]
fn a_shaft_ends_within_its_head_where_the_head_is_wider() {
    for rounded in [false, true] {
        let line = Path::line([10.0, 30.0], [100.0, 30.0]);
        let stroke = Stroke::new(Colour::BLACK, 2.0).ending(ARROW);
        let stroke = if rounded { stroke.rounded() } else { stroke };
        let paths = paths(vec![Item::stroked(line, stroke)]);
        // A round end reaches half a width beyond the path.
        let end = ends(&paths[0])[1][0] + if rounded { 1.0 } else { 0.0 };
        // 2 wide is the head 8·2/6 from its tip.
        assert!(end > 94.0 && end < 100.0 - 16.0 / 6.0, "{end}");
    }
}

#[test]
fn the_notch_of_a_head_lies_on_its_curve() {
    let quarter = Path(Path::circle([60.0, 30.0], 25.0).0[..2].to_vec());
    let stroke = Stroke::new(Colour::BLACK, 1.0).ending(ARROW);
    let paths = paths(vec![Item::stroked(quarter, stroke)]);
    let head = ends(&paths[1]);
    assert_eq!(head[0], [60.0, 55.0]);
    let [x, y] = [head[2][0] - 60.0, head[2][1] - 30.0];
    // The arc meets its radius to 2.8e-4.
    assert!((x.hypot(y) / 25.0 - 1.0).abs() < 3e-4, "{head:?}");
}

#[test]
fn an_arrow_shorter_than_its_heads_keeps_both() {
    let stroke = Stroke::new(Colour::BLACK, 1.0)
        .starting(ARROW)
        .ending(ARROW);
    let line = Path::line([50.0, 30.0], [52.0, 30.0]);
    let paths = paths(vec![Item::stroked(line, stroke)]);
    assert_eq!(paths.len(), 2, "no shaft is left");
    assert_eq!(
        (ends(&paths[0])[0], ends(&paths[1])[0]),
        ([52.0, 30.0], [50.0, 30.0])
    );
}

/// How much of a page is inked, square points.
fn inked(drawing: &Drawing) -> f64 {
    let picture = png::render(drawing, 10.0).unwrap();
    let ink = picture
        .rgba
        .chunks_exact(4)
        .map(|pixel| 255.0 - f64::from(pixel[0]));
    ink.sum::<f64>() / 255.0 / 100.0
}

fn inked_by_line(dash: &[f64]) -> f64 {
    let line = Path::line([10.0, 30.0], [110.0, 30.0]);
    let stroke = Stroke::new(Colour::BLACK, 2.0).dashed(dash);
    inked(&page("", vec![Item::stroked(line, stroke)]))
}

#[test]
fn dashes_begin_with_the_path_and_repeat() {
    // 100 = 16·6 + 4: 17 dashes of 4.
    let area = inked_by_line(&[4.0, 2.0]);
    assert!((area - 17.0 * 8.0).abs() < 0.3, "{area}");
}

#[test]
fn an_odd_pattern_takes_turns() {
    // 3 on, 1 off, 2 on, 3 off, 1 on, 2 off: 6 of 12. 100 = 8·12 + 4: 3 on and 1 off more.
    let area = inked_by_line(&[3.0, 1.0, 2.0]);
    assert!((area - 2.0 * 51.0).abs() < 0.3, "{area}");
}

#[test]
fn dashes_of_no_length_are_dots_where_ends_are_round() {
    let line = Path::line([10.0, 30.0], [108.0, 30.0]);
    let stroke = Stroke::new(Colour::BLACK, 4.0).rounded().dashed([0.0, 5.0]);
    let area = inked(&page("", vec![Item::stroked(line, stroke)]));
    // 20 dots, from 0 to 95, of 2 points radius.
    let expected = 20.0 * std::f64::consts::PI * 4.0;
    assert!((area / expected - 1.0).abs() < 0.01, "{area} {expected}");
}

#[test]
fn a_circle_covers_its_area() {
    let circle = Item::filled(Path::circle([60.0, 30.0], 20.0), Colour::BLACK);
    let area = inked(&page("", vec![circle]));
    let expected = std::f64::consts::PI * 400.0;
    // The mean of the arcs' excess is below the greatest, 2.8e-4, of which areas have twice.
    assert!((area / expected - 1.0).abs() < 8e-4, "{area} {expected}");
}

fn cubic(from: [f64; 2], segment: Segment, t: f64) -> [f64; 2] {
    let Segment::Cubic(a, b, p) = segment else {
        panic!("{segment:?}")
    };
    let s = 1.0 - t;
    let weigh = |i: usize| {
        s * s * s * from[i] + 3.0 * s * s * t * a[i] + 3.0 * s * t * t * b[i] + t * t * t * p[i]
    };
    [weigh(0), weigh(1)]
}

const POINTS: [[f64; 2]; 7] = [
    [0.0, 0.0],
    [1.0, 5.0],
    [1.5, 30.0],
    [8.0, 31.0],
    [9.0, 31.0],
    [30.0, 12.0],
    [29.0, 40.0],
];

#[test]
fn a_smooth_curve_goes_through_its_points() {
    let path = Path::smooth(&POINTS);
    assert_eq!(ends(&path.0), POINTS);
    for (pair, segment) in POINTS.windows(2).zip(&path.0[1..]) {
        for (t, point) in [(0.0, pair[0]), (1.0, pair[1])] {
            let at = cubic(pair[0], *segment, t);
            assert!((0..2).all(|i| (at[i] - point[i]).abs() < 1e-12));
        }
    }
}

#[test]
fn a_smooth_curve_does_not_overshoot() {
    let path = Path::smooth(&POINTS);
    for (pair, segment) in POINTS.windows(2).zip(&path.0[1..]) {
        for step in 0..=100 {
            let at = cubic(pair[0], *segment, f64::from(step) / 100.0);
            for i in 0..2 {
                let (low, high) = (pair[0][i].min(pair[1][i]), pair[0][i].max(pair[1][i]));
                assert!(
                    (low - 1e-12..=high + 1e-12).contains(&at[i]),
                    "{pair:?} {at:?}"
                );
            }
        }
    }
}

#[test]
fn a_smooth_curve_has_no_corners() {
    let path = Path::smooth(&POINTS);
    for pair in path.0[1..].windows(2) {
        let (Segment::Cubic(_, before, p), Segment::Cubic(after, _, _)) = (pair[0], pair[1]) else {
            panic!("{pair:?}")
        };
        let [u, v] = [
            [p[0] - before[0], p[1] - before[1]],
            [after[0] - p[0], after[1] - p[1]],
        ];
        let cross = u[0] * v[1] - u[1] * v[0];
        assert!(
            cross.abs() <= 1e-9 && u[0] * v[0] + u[1] * v[1] >= 0.0,
            "{u:?} {v:?}"
        );
    }
}

#[test]
fn a_curve_of_points_and_derivatives_is_the_cubic_that_has_them() {
    // x = t, y = t³ − 2t.
    let node = |t: f64| Node {
        parameter: t,
        at: [t, t * t * t - 2.0 * t],
        derivative: [1.0, 3.0 * t * t - 2.0],
    };
    let path = Path::hermite(&[node(-1.0), node(0.5), node(3.0)]);
    let at = cubic(node(0.5).at, path.0[2], 0.4);
    let expected = node(0.5 + 0.4 * 2.5).at;
    assert!(
        (0..2).all(|i| (at[i] - expected[i]).abs() < 1e-12),
        "{at:?} {expected:?}"
    );
}

/// The first and the last column and row with ink, as a box in points.
fn ink(text: &Text) -> Rect {
    let picture = png::render(&page("", vec![Item::Text(text.clone())]), 4.0).unwrap();
    let width = picture.width as usize;
    let dark = picture
        .rgba
        .chunks_exact(4)
        .enumerate()
        .filter(|(_, pixel)| pixel[0] < 255);
    let corners = dark.flat_map(|(i, _)| {
        let (x, y) = ((i % width) as f64, (i / width) as f64);
        [[x / 4.0, y / 4.0], [(x + 1.0) / 4.0, (y + 1.0) / 4.0]]
    });
    Rect::around(corners).unwrap()
}

#[test]
fn the_bounds_of_text_are_those_of_its_ink_to_a_pixel() {
    for markup in ["*ct*'", "Agj^2", "*f*_A^{-9}", "—"] {
        for (x, y) in [
            (AnchorX::Start, AnchorY::Top),
            (AnchorX::End, AnchorY::Middle),
        ] {
            for angle in [0.0, 0.5, -2.0] {
                let text = text(markup, [60.0, 30.0], 12.0);
                let text = Text {
                    anchor: Anchor { x, y },
                    angle,
                    ..text
                };
                let (bounds, found) = (text.bounds().unwrap(), ink(&text));
                for i in 0..2 {
                    let off = [bounds.min[i] - found.min[i], found.max[i] - bounds.max[i]];
                    assert!(
                        off.iter().all(|o| (-0.1..=0.26).contains(o)),
                        "{markup} {off:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn anchors_hold_the_heights_of_capitals_and_descenders() {
    let capital = |y| {
        let x = AnchorX::Start;
        let text = text("E", [10.0, 30.0], 10.0);
        let rect = Text {
            anchor: Anchor { x, y },
            ..text
        }
        .bounds()
        .unwrap();
        (rect.min[1] - 30.0, rect.max[1] - 30.0)
    };
    // Within what a letter rises above or sinks below its line, 0.02 em.
    let near = |(top, foot): (f64, f64), expected: [f64; 2]| {
        assert!(
            (top - expected[0]).abs() < 0.2 && (foot - expected[1]).abs() < 0.2,
            "{top} {foot}"
        );
    };
    near(capital(AnchorY::Baseline), [-6.45, 0.0]);
    near(capital(AnchorY::Middle), [-3.22, 3.22]);
    near(capital(AnchorY::Top), [0.0, 6.45]);
    near(capital(AnchorY::Bottom), [-8.83, -2.38]);
}

#[test]
fn text_turns_counter_clockwise_on_the_page() {
    let text = text("—", [60.0, 30.0], 12.0);
    let turned = Text {
        angle: std::f64::consts::FRAC_PI_2,
        ..text
    };
    let rect = turned.bounds().unwrap();
    assert!(
        rect.max[1] < 30.1 && rect.min[1] < 22.0,
        "upwards: {rect:?}"
    );
}
