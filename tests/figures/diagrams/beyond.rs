//! Contents far beyond the page, and sizes that fill it: drawn without what cannot be seen.

use nullray::figures::diagram::draw;
use nullray::figures::drawing::{Drawing, svg};

use crate::diagrams::{laid_out, parsed};

/// The drawing, which can be written.
fn drawn(body: &str) -> Drawing {
    let style = parsed(&format!("[diagram]\n{body}")).unwrap().style;
    let drawing = draw(&laid_out(body), &style).unwrap_or_else(|error| panic!("{body}: {error}"));
    svg::write(&drawing).unwrap_or_else(|error| panic!("{body}: {error}"));
    drawing
}

const LIMITS: &str = "x = [-1, 6]\nct = [-1, 11]\nevent = [{ name = \"A\", at = [1, 1] }]\n";

#[test]
fn what_is_far_beyond_the_limits_is_cut_off() {
    for element in [
        "worldline = [{ name = \"far ship\", at = [0, 1e4], velocity = -0.2 }]",
        "worldline = [{ name = \"ship\", velocity = 0.9999999999999999 }]",
        "frame = [{ name = \"S'\", velocity = 0.9999999999999999, grid = true }]",
        "text = [{ text = \"far words\", at = [1e4, 1e9] }]",
        "hyperbola = [{ proper_time = 1e4, label = \"far\" }, { proper_length = 1e30 }]",
        "hyperbola = [{ proper_time = 1e-30, label = \"near\" }, { proper_length = 1e-9 }]",
        "region = [{ corners = [[0, 0], [1e9, 1e9], [1e30, 0]], label = \"large\" }]",
        "curve = [{ through = [\"A\", [1e9, 2], [3, 1e20]], dashed = true, label = \"long\" }]",
        "arrow = [{ from = \"A\", to = [1e9, 1e8], label = \"up\" }]",
        "wedge = [{ of = [0, 1e9], side = \"right\" }, { of = [1e25, 0], side = \"past\" }]",
        "interval = [{ from = [-1e20, 0], to = [1e20, 1e3] }]",
        "light_cone = [{ of = [0, 1e12], shade = true, past = true }]",
    ] {
        drawn(&format!("{LIMITS}{element}\n"));
    }
}

#[test]
fn a_region_that_covers_the_page_is_still_shaded() {
    let region = "region = [{ corners = [[-1e9, -1e9], [-1e9, 1e9], [1e9, 1e9], [1e9, -1e9]], colour = \"#123456\" }]\n";
    let svg = svg::write(&drawn(&format!("{LIMITS}{region}"))).unwrap();
    assert!(svg.contains("#123456"), "{svg}");
}

#[test]
fn a_hyperbola_whose_vertex_cannot_be_told_from_its_middle_is_its_light_rays() {
    for unit in ["yr", "ps"] {
        for size in ["1e-308", "5e-324", "1e-12"] {
            let body =
                format!("unit = \"{unit}\"\n{LIMITS}hyperbola = [{{ proper_time = {size} }}]\n");
            // Numbers below the smallest of a scene are refused.
            if parsed(&format!("[diagram]\n{body}")).is_err() {
                continue;
            }
            drawn(&body);
            let points = &laid_out(&body).panels[0].hyperbolae[0].curve.points;
            assert!(
                points.iter().all(|p| (p.ct - p.x.abs()).abs() < 1e-6),
                "{body}"
            );
        }
    }
}

#[test]
fn the_largest_type_and_lines_are_drawn() {
    let content =
        "worldline = [{ name = \"a ship\", velocity = 0.3, ticks = 1, numbers = true }]\n";
    for style in [
        "font_size = 340",
        "line_width = 340",
        "font_size = 340\nline_width = 340",
    ] {
        drawn(&format!("{LIMITS}{content}[diagram.style]\n{style}\n"));
    }
}

#[test]
fn a_page_that_no_viewer_opens_is_refused_by_its_cause() {
    let body = "x = [0, 9]\nct = [0, 99]\nevent = [{ name = \"A\", at = [1, 1] }]\n[diagram.style]\nwidth = \"5 m\"\n";
    let style = parsed(&format!("[diagram]\n{body}")).unwrap().style;
    let error = draw(&laid_out(body), &style).unwrap_err().to_string();
    assert!(error.contains("points high"), "{error}");
}
