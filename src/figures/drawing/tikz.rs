//! TikZ: a picture for LaTeX whose text is set by LaTeX, in the fonts of the document around it.
//!
//! Lengths are in big points (bp, 1/72 inch), y downwards as on the page; a file is one `tikzpicture` to be read by
//! `\input`, in a document with `\usepackage{tikz}`. Some letters (ą, đ, þ, „) need `\usepackage[T1]{fontenc}` with pdfTeX.

use super::marks::{Line, Mark, marks};
use super::{AnchorX, Cap, Colour, Drawing, Join, Path, Text};
use crate::error::{Error, Result};
use crate::text::{Rect, Segment};

/// The drawing as a `tikzpicture`.
///
/// # Errors
/// As [`svg::write`](super::svg::write); pictures, which TikZ does not have.
pub fn write(drawing: &Drawing) -> Result<String> {
    let marks = marks(drawing)?;
    let mut text = String::new();
    for (key, value) in &drawing.origin {
        for line in format!("{key}: {value}").lines() {
            text.push_str(&format!("% {}\n", line.replace(char::is_control, " ")));
        }
    }
    text.push_str("% for \\input, after \\usepackage[T1]{fontenc} and \\usepackage{tikz}\n");
    text.push_str("\\begin{tikzpicture}[x=1bp, y=-1bp, inner sep=0pt, outer sep=0pt]\n");
    let page = Rect {
        min: [0.0; 2],
        max: [drawing.width, drawing.height],
    };
    text.push_str(&format!(
        "\\useasboundingbox {};\n",
        data(&Path::rect(page))
    ));
    push_marks(&mut text, &marks)?;
    text.push_str("\\end{tikzpicture}\n");
    Ok(text)
}

fn push_marks(text: &mut String, marks: &[Mark]) -> Result<()> {
    for mark in marks {
        match mark {
            Mark::Fill { path, colour } => {
                let line = format!("\\fill[{}] {};\n", options(*colour, "fill"), data(path));
                text.push_str(&line);
            }
            Mark::Line { path, line } => {
                text.push_str(&format!("\\draw[{}] {};\n", stroke(line), data(path)));
            }
            Mark::Clip { path, marks } => {
                text.push_str(&format!("\\begin{{scope}}\n\\clip {};\n", data(path)));
                push_marks(text, marks)?;
                text.push_str("\\end{scope}\n");
            }
            Mark::Text { text: said, .. } => text.push_str(&node(said)),
            Mark::Image { .. } => {
                let what = "TikZ has no pictures";
                let help = "write it as .pdf, .svg or .png";
                return Err(Error::unsupported("drawing", "", what, help));
            }
        }
    }
    Ok(())
}

/// Colour and opacity.
fn options(colour: Colour, what: &str) -> String {
    let [r, g, b] = colour.rgb;
    let colours = format!("{what}={{rgb,255:red,{r};green,{g};blue,{b}}}");
    match colour.alpha {
        255 => colours,
        alpha => format!("{colours}, opacity={}", number(f64::from(alpha) / 255.0)),
    }
}

fn stroke(line: &Line) -> String {
    let cap = match line.cap {
        Cap::Butt => "butt",
        Cap::Round => "round",
        Cap::Square => "rect",
    };
    let join = match line.join {
        Join::Miter => "miter",
        Join::Round => "round",
        Join::Bevel => "bevel",
    };
    let width = number(line.width);
    let colour = options(line.colour, "draw");
    let mut all = format!("{colour}, line width={width}bp, line cap={cap}, line join={join}");
    let parts = line.dash.iter().enumerate();
    let dash: Vec<String> = parts
        .map(|(i, part)| format!("{} {}bp", ["on", "off"][i % 2], number(*part)))
        .collect();
    if !dash.is_empty() {
        all.push_str(&format!(", dash pattern={}", dash.join(" ")));
    }
    all
}

/// A node at the anchor of the text.
fn node(text: &Text) -> String {
    let x = match text.anchor.x {
        AnchorX::Start => " west",
        AnchorX::Middle => "",
        AnchorX::End => " east",
    };
    // All lines of text have the same baselines as in the other formats.
    let [_, down] = text.anchor.offset(0.0, text.size);
    let (sin, cos) = libm::sincos(text.angle);
    let [px, py] = [text.at[0] + sin * down, text.at[1] + cos * down];
    let size = number(text.size);
    // \fontsize wants a distance of lines too: LaTeX's own sizes have 1.2 times theirs.
    let leading = number(1.2 * text.size);
    let turn = match text.angle {
        0.0 => String::new(),
        angle => format!(", rotate={}", number(angle.to_degrees())),
    };
    let colour = options(text.colour, "text");
    let (px, py) = (number(px), number(py));
    let words = text.text.tex();
    format!(
        "\\node[anchor=base{x}, {colour}{turn}, font=\\fontsize{{{size}bp}}{{{leading}bp}}\\selectfont] at ({px},{py}) {{{words}}};\n"
    )
}

fn data(path: &Path) -> String {
    let mut text = String::new();
    let mut here = [0.0; 2];
    for segment in &path.0 {
        match *segment {
            Segment::Move(p) => {
                text.push_str(&format!(" {}", point(p)));
                here = p;
            }
            Segment::Line(p) => {
                text.push_str(&format!(" -- {}", point(p)));
                here = p;
            }
            Segment::Quadratic(a, p) => {
                // The same curve as a cubic one.
                let control = |end: [f64; 2]| [0, 1].map(|i| end[i] + (a[i] - end[i]) * 2.0 / 3.0);
                push_cubic(&mut text, control(here), control(p), p);
                here = p;
            }
            Segment::Cubic(a, b, p) => {
                push_cubic(&mut text, a, b, p);
                here = p;
            }
            Segment::Close => text.push_str(" -- cycle"),
        }
    }
    text.trim_start().to_string()
}

fn push_cubic(text: &mut String, a: [f64; 2], b: [f64; 2], p: [f64; 2]) {
    let [a, b, p] = [a, b, p].map(point);
    text.push_str(&format!(" .. controls {a} and {b} .. {p}"));
}

fn point([x, y]: [f64; 2]) -> String {
    format!("({},{})", number(x), number(y))
}

/// To the nearest 1e-3 of a point: TeX's own unit is 1.5e-5.
fn number(value: f64) -> String {
    ((value * 1e3).round() / 1e3 + 0.0).to_string()
}
