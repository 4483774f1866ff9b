//! Labels, and their outlines.

use ttf_parser::{Face, GlyphId, OutlineBuilder};

use super::kern::kerning;
use crate::error::{Error, Result};

const REGULAR: &[u8] = include_bytes!("fonts/LibertinusSerif-Regular.otf");
const ITALIC: &[u8] = include_bytes!("fonts/LibertinusSerif-Italic.otf");

/// How a run of text is set.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Style {
    /// Words, numbers and units.
    Upright,
    /// Quantities.
    Italic,
}

/// A line of text: runs of one style each.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Label {
    runs: Vec<(Style, String)>,
}

/// A path that is to be filled by the non-zero rule.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Outline {
    /// The path; every contour begins with a [`Segment::Move`] and ends with a [`Segment::Close`].
    pub segments: Vec<Segment>,
    /// How far the text advances.
    pub width: f64,
}

/// A piece of a path, with absolute points (x to the right, y down).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Segment {
    /// Begins a contour.
    Move([f64; 2]),
    /// A straight line to a point.
    Line([f64; 2]),
    /// A quadratic Bézier curve: control point, end.
    Quadratic([f64; 2], [f64; 2]),
    /// A cubic Bézier curve: two control points, end.
    Cubic([f64; 2], [f64; 2], [f64; 2]),
    /// Closes the contour.
    Close,
}

impl Label {
    /// An upright label.
    pub fn new(text: impl Into<String>) -> Label {
        Label::default().upright(text)
    }

    /// Goes on upright.
    pub fn upright(mut self, text: impl Into<String>) -> Label {
        self.runs.push((Style::Upright, text.into()));
        self
    }

    /// Goes on in italics.
    pub fn italic(mut self, text: impl Into<String>) -> Label {
        self.runs.push((Style::Italic, text.into()));
        self
    }

    /// The characters without their style.
    pub fn text(&self) -> String {
        self.runs.iter().map(|(_, text)| text.as_str()).collect()
    }
}

impl From<&str> for Label {
    fn from(text: &str) -> Label {
        Label::new(text)
    }
}

impl Segment {
    /// The segment with every point moved through `map`.
    pub fn map(self, map: impl Fn([f64; 2]) -> [f64; 2]) -> Segment {
        match self {
            Segment::Move(p) => Segment::Move(map(p)),
            Segment::Line(p) => Segment::Line(map(p)),
            Segment::Quadratic(a, p) => Segment::Quadratic(map(a), map(p)),
            Segment::Cubic(a, b, p) => Segment::Cubic(map(a), map(b), map(p)),
            Segment::Close => Segment::Close,
        }
    }
}

impl Outline {
    /// The outline moved by (x, y).
    pub fn translated(&self, x: f64, y: f64) -> Outline {
        let segments = self.segments.iter();
        Outline {
            segments: segments.map(|s| s.map(|[a, b]| [a + x, b + y])).collect(),
            width: self.width,
        }
    }
}

/// The outline of `label` with `size` units per em.
///
/// # Errors
/// A character that the font does not have, named.
pub fn outline(label: &Label, size: f64) -> Result<Outline> {
    let mut outline = Outline::default();
    for (style, text) in &label.runs {
        let face = face(*style)?;
        let scale = size / f64::from(face.units_per_em());
        let mut previous = None;
        for c in text.chars() {
            let glyph = glyph(&face, *style, c, text)?;
            if let Some(previous) = previous {
                outline.width += f64::from(kerning(&face, previous, glyph)) * scale;
            }
            let mut pen = Pen {
                origin: outline.width,
                scale,
                segments: &mut outline.segments,
            };
            face.outline_glyph(glyph, &mut pen);
            outline.width += f64::from(face.glyph_hor_advance(glyph).unwrap_or(0)) * scale;
            previous = Some(glyph);
        }
    }
    Ok(outline)
}

/// How far `label` advances with `size` units per em.
pub fn width(label: &Label, size: f64) -> Result<f64> {
    Ok(outline(label, size)?.width)
}

fn face(style: Style) -> Result<Face<'static>> {
    let data = match style {
        Style::Upright => REGULAR,
        Style::Italic => ITALIC,
    };
    Face::parse(data, 0).map_err(|e| Error::invalid("embedded font", "", e.to_string(), ""))
}

fn glyph(face: &Face, style: Style, c: char, text: &str) -> Result<GlyphId> {
    face.glyph_index(c).ok_or_else(|| {
        let style = match style {
            Style::Upright => "upright",
            Style::Italic => "italic",
        };
        let code = u32::from(c);
        let what = format!("the {style} font has no character {c:?} (U+{code:04X})");
        let help = "Latin and Greek letters, digits, and the usual signs of physics";
        Error::unsupported(format!("label \"{text}\""), "", what, help)
    })
}

/// Collects the curves of a glyph, scaled, moved to its place, y down.
struct Pen<'a> {
    origin: f64,
    scale: f64,
    segments: &'a mut Vec<Segment>,
}

impl Pen<'_> {
    fn at(&self, x: f32, y: f32) -> [f64; 2] {
        let (x, y) = (f64::from(x) * self.scale, f64::from(y) * self.scale);
        [self.origin + x, -y]
    }
}

impl OutlineBuilder for Pen<'_> {
    fn move_to(&mut self, x: f32, y: f32) {
        self.segments.push(Segment::Move(self.at(x, y)));
    }
    fn line_to(&mut self, x: f32, y: f32) {
        self.segments.push(Segment::Line(self.at(x, y)));
    }
    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let control = self.at(x1, y1);
        let end = self.at(x, y);
        self.segments.push(Segment::Quadratic(control, end));
    }
    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let controls = (self.at(x1, y1), self.at(x2, y2));
        let end = self.at(x, y);
        let cubic = Segment::Cubic(controls.0, controls.1, end);
        self.segments.push(cubic);
    }
    fn close(&mut self) {
        self.segments.push(Segment::Close);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fonts_have_what_physics_needs() {
        let text = "aZ09 γβτλΔΩµ′″−·×±°…²³¹⁰⁴⁻⁺₀₁₂₉→≈≤≥∞½√∥";
        outline(&Label::new(text), 10.0).unwrap();
        outline(&Label::default().italic(text), 10.0).unwrap();
        outline(&Label::new("⊥"), 10.0).unwrap();
    }

    #[test]
    fn a_missing_character_is_named() {
        let error = outline(&Label::new("光 slow"), 10.0).unwrap_err();
        assert!(error.to_string().contains("'光' (U+5149)"), "{error}");
        assert!(error.to_string().contains("光 slow"), "{error}");
    }

    #[test]
    fn widths_are_the_sum_of_advances_and_kerning() {
        // From the font's tables: figures are 465 units wide, and not kerned among themselves.
        let eleven = width(&Label::new("11"), 1000.0).unwrap();
        assert_eq!(eleven, 2.0 * width(&Label::new("1"), 1000.0).unwrap());
        let pair = |text| width(&Label::new(text), 1000.0).unwrap();
        assert!(
            pair("AV") < pair("A") + pair("V") - 50.0,
            "A and V move together"
        );
        assert_eq!(pair("AV") * 2.0, width(&Label::new("AV"), 2000.0).unwrap());
    }

    #[test]
    fn an_upright_i_stands_on_the_baseline() {
        let outline = outline(&Label::new("I"), 1000.0).unwrap();
        let ends = outline.segments.iter().filter_map(|s| match s {
            Segment::Move(p) | Segment::Line(p) => Some(p[1]),
            Segment::Quadratic(_, p) | Segment::Cubic(_, _, p) => Some(p[1]),
            Segment::Close => None,
        });
        let (low, high) = ends.fold((0.0, 0.0), |(l, h): (f64, f64), y| (l.min(y), h.max(y)));
        // Capital height of the font: 0.645 em; y runs down.
        assert!(
            (-660.0..=-635.0).contains(&low) && high <= 3.0,
            "{low} {high}"
        );
    }
}
