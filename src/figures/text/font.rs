//! Labels, and their outlines.

use super::outline::Outline;
use super::setter::Setter;
use crate::error::Result;

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

/// The outline of `label` with `size` units per em.
///
/// # Errors
/// A character that the font does not have, named. What its italics lack is set upright.
pub fn outline(label: &Label, size: f64) -> Result<Outline> {
    let text = label.text();
    let mut setter = Setter::new(&text)?;
    for (style, text) in &label.runs {
        setter.run(*style, text, size, 0.0)?;
    }
    Ok(setter.outline)
}

/// How far `label` advances with `size` units per em.
pub fn width(label: &Label, size: f64) -> Result<f64> {
    Ok(outline(label, size)?.width)
}

#[cfg(test)]
mod tests {
    use super::super::Segment;
    use super::*;

    #[test]
    fn the_fonts_have_what_physics_needs() {
        let text = "aZ09 γβτλΔΩµ′″−·×±°…²³¹⁰⁴⁻⁺₀₁₂₉→≈≤≥∞½√∥";
        outline(&Label::new(text), 10.0).unwrap();
        outline(&Label::default().italic(text), 10.0).unwrap();
        outline(&Label::new("⊥"), 10.0).unwrap();
    }

    #[test]
    fn what_italics_lack_is_set_upright() {
        let italic = outline(&Label::default().italic("⊥"), 10.0).unwrap();
        assert_eq!(italic, outline(&Label::new("⊥"), 10.0).unwrap());
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
