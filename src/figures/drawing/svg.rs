//! SVG 1.1, for browsers and vector editors.
//!
//! Lengths are in points by `viewBox`, to 4 decimals. Text is outlines, in a group whose label is the text.

use super::image::{png_of, push_base64};
use super::marks::{Line, Mark, marks};
use super::{AnchorX, Cap, Colour, Drawing, Join, Path, Text};
use crate::error::Result;
use crate::io::image::RgbImage;
use crate::text::{Rect, Segment};

/// The drawing as an SVG file; `<metadata>` has a line for each key of its origin.
///
/// # Errors
/// Numbers that are not finite, paths that are not sound, pages of more than 200 inches; with the index
/// of the item.
pub fn write(drawing: &Drawing) -> Result<String> {
    written(drawing, false)
}

/// The same with text as text: it can be searched and edited, and is set in the viewer's fonts, Libertinus Serif if available.
///
/// # Errors
/// As [`write()`].
pub fn write_with_text(drawing: &Drawing) -> Result<String> {
    written(drawing, true)
}

fn written(drawing: &Drawing, as_text: bool) -> Result<String> {
    let marks = marks(drawing)?;
    let mut svg = Svg {
        as_text,
        ..Svg::default()
    };
    svg.head(drawing, holds_image(&marks));
    svg.origin(&drawing.origin);
    svg.marks(&marks)?;
    svg.text.push_str("</svg>\n");
    Ok(svg.text)
}

/// Without the characters that XML cannot hold.
fn printable(text: &str) -> String {
    let told = |c: char| match c {
        '\t' | '\n' | '\r' => c,
        c if c.is_control() || ['\u{fffe}', '\u{ffff}'].contains(&c) => '\u{fffd}',
        c => c,
    };
    text.chars().map(told).collect()
}

/// Whether any mark is, or contains, a picture.
fn holds_image(marks: &[Mark]) -> bool {
    marks.iter().any(|mark| match mark {
        Mark::Image { .. } => true,
        Mark::Clip { marks, .. } => holds_image(marks),
        Mark::Fill { .. } | Mark::Line { .. } | Mark::Text { .. } => false,
    })
}

#[derive(Default)]
struct Svg {
    text: String,
    /// Number of clips so far.
    clips: usize,
    /// Whether text is text, not outlines.
    as_text: bool,
}

impl Svg {
    fn head(&mut self, drawing: &Drawing, images: bool) {
        self.text
            .push_str("<svg xmlns=\"http://www.w3.org/2000/svg\"");
        if images {
            self.attribute("xmlns:xlink", "http://www.w3.org/1999/xlink");
        }
        let [width, height] = [number(drawing.width), number(drawing.height)];
        let size = format!(" width=\"{width}pt\" height=\"{height}pt\"");
        self.text.push_str(&size);
        let view = format!(" viewBox=\"0 0 {width} {height}\" role=\"img\">\n");
        self.text.push_str(&view);
        if !drawing.title.is_empty() {
            let title = format!("<title>{}</title>\n", escaped(&drawing.title));
            self.text.push_str(&title);
        }
    }

    fn origin(&mut self, origin: &[(String, String)]) {
        if origin.is_empty() {
            return;
        }
        self.text.push_str("<metadata>\n");
        for (key, value) in origin {
            let line = format!("{}: {}\n", escaped(key), escaped(&printable(value)));
            self.text.push_str(&line);
        }
        self.text.push_str("</metadata>\n");
    }

    fn marks(&mut self, marks: &[Mark]) -> Result<()> {
        for mark in marks {
            match mark {
                Mark::Fill { path, colour } => self.fill(path, *colour),
                Mark::Line { path, line } => self.line(path, line),
                Mark::Clip { path, marks } => self.clip(path, marks)?,
                Mark::Image { image, rect } => self.image(image, rect)?,
                Mark::Text { text, .. } if self.as_text => self.words(text)?,
                Mark::Text { says, marks, .. } => self.says(says, marks)?,
            }
        }
        Ok(())
    }

    fn fill(&mut self, path: &Path, colour: Colour) {
        self.text.push_str("<path");
        self.colour("fill", colour);
        self.data(path);
        self.text.push_str("/>\n");
    }

    fn line(&mut self, path: &Path, line: &Line) {
        self.text.push_str("<path fill=\"none\"");
        self.colour("stroke", line.colour);
        self.attribute("stroke-width", &number(line.width));
        if !line.dash.is_empty() {
            let dash: Vec<String> = line.dash.iter().map(|part| number(*part)).collect();
            self.attribute("stroke-dasharray", &dash.join(" "));
        }
        match line.cap {
            Cap::Butt => {}
            Cap::Round => self.attribute("stroke-linecap", "round"),
            Cap::Square => self.attribute("stroke-linecap", "square"),
        }
        match line.join {
            Join::Miter => {}
            Join::Round => self.attribute("stroke-linejoin", "round"),
            Join::Bevel => self.attribute("stroke-linejoin", "bevel"),
        }
        self.data(path);
        self.text.push_str("/>\n");
    }

    fn image(&mut self, image: &RgbImage, rect: &Rect) -> Result<()> {
        self.text
            .push_str("<image preserveAspectRatio=\"none\" image-rendering=\"optimizeSpeed\"");
        let [width, height] = rect.size();
        let places = [
            ("x", rect.min[0]),
            ("y", rect.min[1]),
            ("width", width),
            ("height", height),
        ];
        for (name, value) in places {
            self.attribute(name, &number(value));
        }
        self.text.push_str(" xlink:href=\"data:image/png;base64,");
        push_base64(&mut self.text, &png_of(image)?);
        self.text.push_str("\"/>\n");
        Ok(())
    }

    fn clip(&mut self, path: &Path, marks: &[Mark]) -> Result<()> {
        self.clips += 1;
        let name = format!("clip{}", self.clips);
        self.text
            .push_str(&format!("<clipPath id=\"{name}\"><path"));
        self.data(path);
        let group = format!("/></clipPath>\n<g clip-path=\"url(#{name})\">\n");
        self.text.push_str(&group);
        self.marks(marks)?;
        self.text.push_str("</g>\n");
        Ok(())
    }

    fn says(&mut self, says: &str, marks: &[Mark]) -> Result<()> {
        let says = escaped(says);
        let group = format!("<g role=\"img\" aria-label=\"{says}\"><title>{says}</title>\n");
        self.text.push_str(&group);
        self.marks(marks)?;
        self.text.push_str("</g>\n");
        Ok(())
    }

    fn words(&mut self, text: &Text) -> Result<()> {
        // SVG places text by its baseline.
        let [_, down] = text.anchor.offset(0.0, text.size);
        let anchor = match text.anchor.x {
            AnchorX::Start => "start",
            AnchorX::Middle => "middle",
            AnchorX::End => "end",
        };
        let [x, y] = text.at.map(number);
        self.text.push_str("<text xml:space=\"preserve\"");
        self.attribute("x", &x);
        self.attribute("y", &number(text.at[1] + down));
        self.attribute(
            "font-family",
            "'Libertinus Serif', 'Linux Libertine O', 'Times New Roman', 'Liberation Serif', 'DejaVu Serif Condensed', serif",
        );
        self.attribute("font-size", &number(text.size));
        // In other fonts, which may be wider, the text keeps its width.
        self.attribute("textLength", &number(text.text.width(text.size)?));
        self.attribute("lengthAdjust", "spacingAndGlyphs");
        self.attribute("text-anchor", anchor);
        if text.angle != 0.0 {
            // SVG turns clockwise.
            let turn = number(-text.angle.to_degrees());
            self.attribute("transform", &format!("rotate({turn} {x} {y})"));
        }
        // A stroke lies half inside its outline, hence twice the width.
        if let Some((colour, width)) = text.halo.filter(|(_, width)| *width > 0.0) {
            self.attribute("paint-order", "stroke");
            self.colour("stroke", colour);
            self.attribute("stroke-width", &number(2.0 * width));
            self.attribute("stroke-linejoin", "round");
        }
        self.colour("fill", text.colour);
        self.text.push('>');
        // `dy` also moves everything that follows: each run states its difference from the previous one.
        let mut raised = 0.0;
        for (words, leans, scale, rise) in text.text.runs() {
            self.text.push_str("<tspan");
            if leans {
                self.attribute("font-style", "italic");
            }
            if scale != 1.0 {
                self.attribute("font-size", &number(scale * text.size));
            }
            if rise != raised {
                self.attribute("dy", &number((raised - rise) * text.size));
                raised = rise;
            }
            self.text.push_str(&format!(">{}</tspan>", escaped(words)));
        }
        self.text.push_str("</text>\n");
        Ok(())
    }

    fn colour(&mut self, attribute: &str, colour: Colour) {
        let [red, green, blue] = colour.rgb;
        self.attribute(attribute, &format!("#{red:02x}{green:02x}{blue:02x}"));
        if colour.alpha < 255 {
            let opacity = number(f64::from(colour.alpha) / 255.0);
            self.attribute(&format!("{attribute}-opacity"), &opacity);
        }
    }

    fn attribute(&mut self, name: &str, value: &str) {
        self.text.push_str(&format!(" {name}=\"{value}\""));
    }

    fn data(&mut self, path: &Path) {
        self.text.push_str(" d=\"");
        for segment in &path.0 {
            match *segment {
                Segment::Move(p) => self.points('M', &[p]),
                Segment::Line(p) => self.points('L', &[p]),
                Segment::Quadratic(a, p) => self.points('Q', &[a, p]),
                Segment::Cubic(a, b, p) => self.points('C', &[a, b, p]),
                Segment::Close => self.text.push('Z'),
            }
        }
        self.text.push('"');
    }

    fn points(&mut self, command: char, points: &[[f64; 2]]) {
        self.text.push(command);
        for (i, value) in points.as_flattened().iter().enumerate() {
            if i > 0 {
                self.text.push(' ');
            }
            self.text.push_str(&number(*value));
        }
    }
}

/// `value` to the nearest 1e-4, without zeros at its end.
fn number(value: f64) -> String {
    // All values of a checked drawing are within 1e5: nine digits, at most as many as the shortest text that identifies a double has.
    // Adding 0 removes the sign of −0.
    ((value * 1e4).round() / 1e4 + 0.0).to_string()
}

/// Escapes text for XML; characters that XML does not allow become spaces.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '&' => escaped.push_str("&amp;"),
            '"' => escaped.push_str("&quot;"),
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => escaped.push(' '),
            c => escaped.push(c),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_at_most_four_decimals_and_no_idle_zeros() {
        let shown = [
            0.0,
            -0.00001,
            12.0,
            -0.5,
            7.123_49,
            0.00005,
            99_999.999_96,
            1.0203,
        ]
        .map(number);
        let expected = [
            "0", "0", "12", "-0.5", "7.1235", "0.0001", "100000", "1.0203",
        ];
        assert_eq!(shown, expected);
    }

    #[test]
    fn text_is_escaped() {
        assert_eq!(
            escaped("a<b & \"c\">\u{1}"),
            "a&lt;b &amp; &quot;c&quot;&gt; "
        );
    }
}
