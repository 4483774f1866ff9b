//! Sets runs of characters one after another.

use ttf_parser::gpos::{PairAdjustment, PositioningSubtable};
use ttf_parser::opentype_layout::Lookup;
use ttf_parser::{Face, GlyphId, OutlineBuilder};

use super::outline::{Outline, Segment};
use crate::error::{Error, Result};

const REGULAR: &[u8] = include_bytes!("fonts/LibertinusSerif-Regular.otf");
const ITALIC: &[u8] = include_bytes!("fonts/LibertinusSerif-Italic.otf");

/// The style of a run of text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Style {
    /// Words, numbers and units.
    Upright,
    /// Quantities.
    Italic,
}

/// A glyph of a line of text, and its position.
#[cfg_attr(not(feature = "pdf"), allow(dead_code))]
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Glyph {
    /// Whether its font is the leaning one.
    pub leans: bool,
    /// Its number in the font.
    pub id: u16,
    /// Its character.
    pub character: char,
    /// Its origin, from the left end of the baseline, y down.
    pub at: [f64; 2],
    /// Units per em.
    pub size: f64,
    /// Its advance, em.
    pub advance: f64,
}

/// A font as files embed it.
#[cfg(feature = "pdf")]
pub(crate) struct Font {
    /// Its PostScript name.
    pub name: &'static str,
    /// Its outlines, in the Compact Font Format.
    pub cff: &'static [u8],
    /// The box around all glyphs; heights of ascenders, descenders (below 0) and capitals: thousandths of an em.
    pub bounds: [i16; 4],
    pub heights: [i16; 3],
    /// Degrees to the left.
    pub angle: f32,
}

/// The upright or the leaning font.
///
/// # Errors
/// Never fails for the embedded fonts.
#[cfg(feature = "pdf")]
pub(crate) fn font(leans: bool) -> Result<Font> {
    let (data, name) = match leans {
        false => (REGULAR, "LibertinusSerif-Regular"),
        true => (ITALIC, "LibertinusSerif-Italic"),
    };
    let face = face(data)?;
    let tag = ttf_parser::Tag::from_bytes(b"CFF ");
    let cff = face.raw_face().table(tag);
    let bounds = face.global_bounding_box();
    Ok(Font {
        name,
        cff: cff.ok_or_else(|| Error::invalid("embedded font", "", "it has no outlines", ""))?,
        bounds: [bounds.x_min, bounds.y_min, bounds.x_max, bounds.y_max],
        heights: [
            face.ascender(),
            face.descender(),
            face.capital_height().unwrap_or(645),
        ],
        angle: face.italic_angle(),
    })
}

/// A line of text under construction: its outline so far, whose width is where the next run begins.
pub(super) struct Setter<'a> {
    /// The text's name in error messages.
    text: &'a str,
    upright: Face<'static>,
    italic: Face<'static>,
    pub outline: Outline,
    pub glyphs: Vec<Glyph>,
    /// The overhang of the last run's last glyph beyond what follows it.
    pub overhang: f64,
}

impl<'a> Setter<'a> {
    pub fn new(text: &'a str) -> Result<Setter<'a>> {
        Ok(Setter {
            text,
            upright: face(REGULAR)?,
            italic: face(ITALIC)?,
            outline: Outline::default(),
            glyphs: Vec::new(),
            overhang: 0.0,
        })
    }

    /// Adds `run` with `size` units per em, its baseline raised by `rise`.
    ///
    /// Characters that the italic font lacks are taken from the upright one.
    ///
    /// # Errors
    /// A character that neither font has.
    pub fn run(&mut self, style: Style, run: &str, size: f64, rise: f64) -> Result<()> {
        let mut previous = None;
        for c in run.chars() {
            let (style, glyph) = self.glyph(style, c)?;
            let face = match style {
                Style::Upright => &self.upright,
                Style::Italic => &self.italic,
            };
            let scale = size / f64::from(face.units_per_em());
            // Kerning is between glyphs of one font.
            if let Some((_, previous)) = previous.filter(|(font, _)| *font == style) {
                self.outline.width += f64::from(kerning(face, previous, glyph)) * scale;
            }
            let advance = f64::from(face.glyph_hor_advance(glyph).unwrap_or(0));
            let right = face.glyph_bounding_box(glyph).map_or(0, |ink| ink.x_max);
            // Italic letters lean out over their advance.
            self.overhang = (f64::from(right) - advance).max(0.0) * scale;
            // y runs down on pages, up in fonts.
            let mut pen = Pen {
                origin: [self.outline.width, -rise],
                scale,
                segments: &mut self.outline.segments,
            };
            face.outline_glyph(glyph, &mut pen);
            self.glyphs.push(Glyph {
                leans: style == Style::Italic,
                id: glyph.0,
                character: c,
                at: [self.outline.width, -rise],
                size,
                advance: advance / f64::from(face.units_per_em()),
            });
            self.outline.width += advance * scale;
            previous = Some((style, glyph));
        }
        Ok(())
    }

    /// The glyph of `c`, and the font that has it.
    fn glyph(&self, style: Style, c: char) -> Result<(Style, GlyphId)> {
        let italic = || Some((Style::Italic, self.italic.glyph_index(c)?));
        let upright = || Some((Style::Upright, self.upright.glyph_index(c)?));
        let found = match style {
            Style::Upright => upright(),
            Style::Italic => italic().or_else(upright),
        };
        found.ok_or_else(|| self.missing(c))
    }

    fn missing(&self, c: char) -> Error {
        let code = u32::from(c);
        let what = format!("the font has no character {c:?} (U+{code:04X})");
        let help = "Latin and Greek letters, digits, and the usual signs of physics";
        Error::unsupported(format!("label \"{}\"", self.text), "", what, help)
    }
}

fn face(data: &'static [u8]) -> Result<Face<'static>> {
    Face::parse(data, 0).map_err(|e| Error::invalid("embedded font", "", e.to_string(), ""))
}

/// Collects the curves of a glyph, scaled, moved to its place, y down.
struct Pen<'a> {
    origin: [f64; 2],
    scale: f64,
    segments: &'a mut Vec<Segment>,
}

impl Pen<'_> {
    fn at(&self, x: f32, y: f32) -> [f64; 2] {
        let (x, y) = (f64::from(x) * self.scale, f64::from(y) * self.scale);
        [self.origin[0] + x, self.origin[1] - y]
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

/// How much `second` moves towards or away from `first`, font units. The embedded fonts have no lookups other than those for kerning.
fn kerning(face: &Face, first: GlyphId, second: GlyphId) -> i32 {
    let Some(gpos) = face.tables().gpos else {
        return 0;
    };
    let of_lookup = |lookup: Lookup| {
        let subtables = lookup.subtables.into_iter::<PositioningSubtable>();
        // The first subtable that knows the pair decides.
        subtables
            .filter_map(|subtable| pair(subtable, first, second))
            .next()
            .unwrap_or(0)
    };
    gpos.lookups.into_iter().map(of_lookup).sum()
}

fn pair(subtable: PositioningSubtable, first: GlyphId, second: GlyphId) -> Option<i32> {
    let PositioningSubtable::Pair(pair) = subtable else {
        return None;
    };
    let index = pair.coverage().get(first)?;
    let (value, _) = match pair {
        PairAdjustment::Format1 { sets, .. } => sets.get(index)?.get(second)?,
        PairAdjustment::Format2 {
            classes, matrix, ..
        } => matrix.get((classes.0.get(first), classes.1.get(second)))?,
    };
    Some(i32::from(value.x_advance))
}
