//! Drawings that no format can hold are refused, with the index of the item.

use nullray::figures::drawing::{
    Arrow, Colour, Drawing, Fill, Hatch, Item, Path, Stroke, Text, pdf, png, svg,
};
use nullray::text::{RichText, Segment};

use super::samples::{page, text};

/// The error that all formats give alike.
fn refusal(drawing: &Drawing) -> String {
    let error = svg::write(drawing).unwrap_err().to_string();
    assert_eq!(pdf::write(drawing).unwrap_err().to_string(), error);
    assert_eq!(png::render(drawing, 1.0).unwrap_err().to_string(), error);
    error
}

/// The error of `item` as the second of a page.
fn of_item(item: Item) -> String {
    let sound = Item::filled(Path::circle([9.0; 2], 3.0), Colour::BLACK);
    let error = refusal(&page("", vec![sound, item]));
    assert!(error.contains("item 1"), "{error}");
    error
}

fn line() -> Path {
    Path::line([0.0; 2], [50.0; 2])
}

fn of_stroke(stroke: Stroke) -> String {
    of_item(Item::stroked(line(), stroke))
}

fn black() -> Stroke {
    Stroke::new(Colour::BLACK, 1.0)
}

#[test]
fn points_that_are_not_finite_are_refused() {
    for bad in [f64::NAN, f64::INFINITY, 1e6] {
        let path = Path::line([0.0; 2], [1.0, bad]);
        assert!(of_item(Item::stroked(path, black())).contains("the point"));
        assert!(of_item(Item::Text(text("a", [bad, 0.0], 9.0))).contains("the point"));
    }
}

#[test]
fn control_points_that_are_not_finite_are_refused() {
    let curve = Segment::Cubic([0.0; 2], [f64::NAN; 2], [1.0; 2]);
    let path = Path(vec![Segment::Move([0.0; 2]), curve]);
    assert!(of_item(Item::filled(path, Colour::BLACK)).contains("the point"));
}

#[test]
fn items_within_clips_are_named_by_both_indices() {
    let bad = Item::stroked(Path::line([0.0; 2], [f64::NAN; 2]), black());
    let clip = Item::Clip {
        path: Path::circle([9.0; 2], 3.0),
        items: vec![bad],
    };
    assert!(of_item(clip).contains("item 1, item 0"));
}

#[test]
fn contours_begin_with_a_move() {
    let path = Path(vec![Segment::Line([1.0; 2])]);
    assert!(of_item(Item::filled(path, Colour::BLACK)).contains("begin with a move"));
    let mut path = line().closed();
    path.0.push(Segment::Line([1.0; 2]));
    assert!(of_item(Item::filled(path, Colour::BLACK)).contains("begin with a move"));
}

#[test]
fn strokes_have_a_width() {
    for width in [0.0, -1.0, f64::NAN] {
        assert!(of_stroke(Stroke::new(Colour::BLACK, width)).contains("width"));
    }
}

#[test]
fn dashes_have_lengths() {
    for dash in [[0.0, 0.0], [2.0, -1.0], [f64::NAN, 1.0]] {
        assert!(of_stroke(black().dashed(dash)).contains("dash"));
    }
}

#[test]
fn dashes_without_number_are_refused() {
    assert!(of_stroke(black().dashed([1e-4, 1e-4])).contains("more than"));
}

#[test]
fn arrowheads_have_a_length_and_a_width() {
    for (length, width) in [(0.0, 1.0), (1.0, f64::NAN)] {
        assert!(of_stroke(black().ending(Arrow { length, width })).contains("arrowhead"));
    }
}

#[test]
fn arrowheads_need_one_open_contour_that_goes_somewhere() {
    let arrow = Arrow::of_line(1.0);
    for path in [line().closed(), line().and(line()), Path::default()] {
        assert!(of_item(Item::stroked(path, black().ending(arrow))).contains("one piece"));
    }
    let point = Path::line([3.0; 2], [3.0; 2]);
    assert!(of_item(Item::stroked(point, black().starting(arrow))).contains("no direction"));
}

#[test]
fn hatches_have_a_spacing_and_a_bounded_number_of_lines() {
    for (spacing, what) in [(0.0, "spacing"), (f64::NAN, "spacing"), (1e-4, "more than")] {
        let fill = Fill {
            colour: Colour::BLACK,
            hatch: Some(Hatch {
                angle: 0.0,
                spacing,
                width: 1.0,
            }),
        };
        let path = Path::circle([50.0; 2], 20.0);
        let error = of_item(Item::Path {
            path,
            fill: Some(fill),
            stroke: None,
        });
        assert!(error.contains(what), "{error}");
    }
}

#[test]
fn text_has_a_size_and_an_angle() {
    assert!(of_item(Item::Text(text("a", [0.0; 2], 0.0))).contains("size"));
    let turned = Text {
        angle: f64::NAN,
        ..text("a", [0.0; 2], 9.0)
    };
    assert!(of_item(Item::Text(turned)).contains("angle"));
    let halo = Some((Colour::WHITE, f64::NAN));
    let bordered = Text {
        halo,
        ..text("a", [0.0; 2], 9.0)
    };
    assert!(of_item(Item::Text(bordered)).contains("halo"));
}

#[test]
fn a_character_that_the_font_lacks_is_named_with_its_text() {
    let error = RichText::parse("*v* of 電子").unwrap_err().to_string();
    assert!(
        error.contains("'電' (U+96FB)") && error.contains("v of 電子"),
        "{error}"
    );
}

#[test]
fn pages_have_a_size_that_viewers_open() {
    for (width, height) in [(0.0, 9.0), (9.0, f64::NAN), (14_401.0, 9.0), (9.0, -1.0)] {
        let drawing = Drawing {
            width,
            height,
            ..page("", Vec::new())
        };
        assert!(refusal(&drawing).contains("the page's"));
    }
}

#[test]
fn pictures_too_large_for_memory_are_refused_before_they_are_drawn() {
    let drawing = Drawing {
        width: 14_400.0,
        height: 14_400.0,
        ..page("", Vec::new())
    };
    let error = png::render(&drawing, 2.0).unwrap_err().to_string();
    assert!(error.contains("28800 × 28800"), "{error}");
    assert!(png::render(&page("", Vec::new()), 1e300).is_err());
}

#[test]
fn a_scale_is_positive() {
    for scale in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(png::render(&page("", Vec::new()), scale).is_err());
    }
}
