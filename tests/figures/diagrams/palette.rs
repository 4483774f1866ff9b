//! The palette in numbers: contrast with the page, and between colours for every kind of colour vision.
//!
//! Contrast is (L₁ + 0.05)/(L₂ + 0.05) of relative luminances (WCAG 2.1), which requires 3 for graphics. Vision without long or middle
//! cones is simulated in linear sRGB (Viénot, Brettel, Mollon 1999); distances are ΔE of CIELAB (1976), where 2 or 3 are just noticeable.

use nullray::figures::drawing::{Drawing, Item};

use crate::diagrams::parsed;

type Rgb = [f64; 3];

/// The colours that a diagram's world lines have by themselves, as they are drawn.
fn line_colours(theme: &str) -> Vec<[u8; 3]> {
    let lines = (0..5).map(|i| format!("{{ name = \"w{i}\", at = [0, {i}] }}"));
    let lines: Vec<String> = lines.collect();
    let text = format!(
        "[diagram]\nct = [-1, 3]\nworldline = [{}]\nstyle = {{ theme = \"{theme}\" }}\n",
        lines.join(", ")
    );
    let model = parsed(&text).unwrap();
    let drawing =
        nullray::figures::diagram::draw(&nullray::figures::diagram::layout(&model), &model.style)
            .unwrap();
    label_colours(&drawing, "w")
}

fn label_colours(drawing: &Drawing, prefix: &str) -> Vec<[u8; 3]> {
    let texts = drawing.items.iter().filter_map(|item| match item {
        Item::Text(text) if text.text.text().starts_with(prefix) => Some(text.colour.rgb),
        _ => None,
    });
    texts.collect()
}

fn linear(rgb: [u8; 3]) -> Rgb {
    rgb.map(|v| {
        let v = f64::from(v) / 255.0;
        if v <= 0.04045 {
            v / 12.92
        } else {
            ((v + 0.055) / 1.055).powf(2.4)
        }
    })
}

fn luminance([r, g, b]: Rgb) -> f64 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

fn contrast(a: [u8; 3], b: [u8; 3]) -> f64 {
    let [a, b] = [a, b].map(|c| luminance(linear(c)) + 0.05);
    a.max(b) / a.min(b)
}

/// Colours as seen without the long cones and without the middle ones.
fn dichromatic(rgb: Rgb) -> [Rgb; 2] {
    let [r, g, b] = rgb;
    let protan = 0.11238 * r + 0.88762 * g;
    let deutan = 0.29275 * r + 0.70725 * g;
    let third = |k: f64| k * r - k * g + b;
    [
        [protan, protan, third(0.00401)],
        [deutan, deutan, third(-0.02234)],
    ]
}

fn lab([r, g, b]: Rgb) -> [f64; 3] {
    let x = (0.4124 * r + 0.3576 * g + 0.1805 * b) / 0.9505;
    let y = luminance([r, g, b]);
    let z = (0.0193 * r + 0.1192 * g + 0.9505 * b) / 1.089;
    let [x, y, z] = [x, y, z].map(|t: f64| {
        if t > 0.008856 {
            t.cbrt()
        } else {
            7.787 * t + 16.0 / 116.0
        }
    });
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

fn difference(a: Rgb, b: Rgb) -> f64 {
    let (a, b) = (lab(a), lab(b));
    (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt()
}

fn pairs(colours: &[[u8; 3]]) -> Vec<[[u8; 3]; 2]> {
    let mut pairs = Vec::new();
    for (i, a) in colours.iter().enumerate() {
        pairs.extend(colours[i + 1..].iter().map(|b| [*a, *b]));
    }
    pairs
}

#[test]
fn lines_stand_out_from_the_page_in_grey_too() {
    for (theme, page) in [("light", [255; 3]), ("dark", [16, 18, 22])] {
        let colours = line_colours(theme);
        assert_eq!(colours.len(), 5);
        for colour in colours {
            let found = contrast(colour, page);
            assert!(found >= 3.0, "{theme}: {colour:?} has {found}");
        }
    }
}

#[test]
fn lines_are_distinguishable_without_long_or_middle_cones() {
    for theme in ["light", "dark"] {
        for [a, b] in pairs(&line_colours(theme)) {
            let (p, q) = (dichromatic(linear(a)), dichromatic(linear(b)));
            for (vision, (p, q)) in p.into_iter().zip(q).enumerate() {
                let found = difference(p, q);
                assert!(
                    found >= 11.0,
                    "{theme}, {vision}: {a:?} and {b:?} are {found} apart"
                );
            }
        }
    }
}

#[test]
fn the_simulation_leaves_greys_as_they_are() {
    for seen in dichromatic([0.4; 3]) {
        assert!(difference(seen, [0.4; 3]) < 0.1);
    }
}
