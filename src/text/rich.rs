//! Text with italics, sub- and superscripts.
//!
//! ```text
//! *x*_A     *ct*'     *γ* = 5/3     10^{-9} s     \Delta*τ*     Alice's clock
//! ```
//!
//! | markup | meaning |
//! |---|---|
//! | `*…*` | italics, for quantities |
//! | `_a`, `_{…}`, `^a`, `^{…}` | a subscript or a superscript; if one directly follows the other, they are set above each other |
//! | `'` | a prime ′ (`''`: ″), but the apostrophe ’ between two upright letters |
//! | `-` | the minus −, but a hyphen directly after a letter or a digit |
//! | `\gamma`, `\times`, … | Greek letters and signs by name; `{}` after it separates it from letters |
//! | `\*`, `\_`, `\^`, `\'`, `\-`, `\{`, `\}`, `\\` | the character itself |
//!
//! Scripts are set at 0.7 of the size, 0.18 em down or 0.33 em up, and have no scripts of their own.

use super::markup::{Level, Run, parse};
use super::outline::{Outline, Rect, bounds};
use super::setter::{Setter, Style};
use super::tex;
use crate::error::{Error, Result};

/// The size of scripts, in that of their line.
const SCRIPT: f64 = 0.7;
/// Rise of a superscript's baseline, em of the line.
const RAISE: f64 = 0.33;
/// Drop of a subscript's baseline, em of the line.
const LOWER: f64 = 0.18;

/// The most characters of a line: more than any page has room for.
const LONGEST: usize = 2000;

/// A line of text whose characters the font has: runs of one style and one level each.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct RichText {
    runs: Vec<Run>,
}

/// `text` with all markup characters escaped.
pub(crate) fn escaped(text: &str) -> String {
    let own = |c| "*_^{}\\'".contains(c);
    let escape = |c| match own(c) {
        true => vec!['\\', c],
        false => vec![c],
    };
    text.chars().flat_map(escape).collect()
}

impl RichText {
    /// Reads the markup of the [module](self).
    ///
    /// # Errors
    /// Italics or braces that are not closed, a script of a script or of nothing, a name that is not
    /// known, and a character that the font does not have; each named, with the text.
    pub fn parse(markup: &str) -> Result<RichText> {
        RichText::of(parse(markup)?)
    }

    /// `text` literally, upright, without markup.
    ///
    /// # Errors
    /// A character that the font does not have.
    pub fn plain(text: &str) -> Result<RichText> {
        RichText::of(vec![Run {
            style: Style::Upright,
            level: Level::Line,
            text: text.to_owned(),
        }])
    }

    fn of(runs: Vec<Run>) -> Result<RichText> {
        let count: usize = runs.iter().map(|run| run.text.chars().count()).sum();
        if count > LONGEST {
            let start: String = runs
                .iter()
                .flat_map(|run| run.text.chars())
                .take(20)
                .collect();
            let what = format!("{count} characters in one line of text; the limit is {LONGEST}");
            return Err(Error::invalid(
                format!("text \"{start}…\""),
                "",
                what,
                "write less",
            ));
        }
        let text = RichText { runs };
        text.outline(1.0)?;
        Ok(text)
    }

    /// The characters without style; scripts as `_{…}` and `^{…}`, without braces if they are one character.
    pub fn text(&self) -> String {
        let mut text = String::new();
        let mut runs = self.runs.as_slice();
        while let Some(first) = runs.first() {
            let alike = runs.iter().take_while(|run| run.level == first.level);
            let (here, rest) = runs.split_at(alike.count());
            let characters: String = here.iter().map(|run| run.text.as_str()).collect();
            text += &first.level.marked(characters);
            runs = rest;
        }
        text
    }

    /// The text for LaTeX; mathematical symbols are set in math mode.
    pub(crate) fn tex(&self) -> String {
        let mut all = String::new();
        for run in &self.runs {
            let words: String = tex::words(&run.text);
            let styled = match run.style {
                Style::Upright => words,
                Style::Italic => format!("\\textit{{{words}}}"),
            };
            all += &match run.level {
                Level::Line => styled,
                Level::Subscript => format!("\\textsubscript{{{styled}}}"),
                Level::Superscript => format!("\\textsuperscript{{{styled}}}"),
            };
        }
        all
    }

    /// Characters, whether they lean, and their size and rise in those of the line, from left to right.
    pub(crate) fn runs(&self) -> impl Iterator<Item = (&str, bool, f64, f64)> {
        self.runs.iter().map(|run| {
            let (scale, rise) = run.level.scale_and_rise();
            (run.text.as_str(), run.style == Style::Italic, scale, rise)
        })
    }

    /// The outline with `size` units per em, from the left end of the baseline.
    ///
    /// # Errors
    /// Never fails for results of [`RichText::parse`] and [`RichText::plain`].
    pub fn outline(&self, size: f64) -> Result<Outline> {
        let text = self.text();
        Ok(self.set(&text, size)?.outline)
    }

    /// Its glyphs with `size` units per em, from left to right.
    ///
    /// # Errors
    /// As [`RichText::outline`].
    #[cfg(feature = "pdf")]
    pub(crate) fn glyphs(&self, size: f64) -> Result<Vec<super::Glyph>> {
        let text = self.text();
        Ok(self.set(&text, size)?.glyphs)
    }

    fn set<'a>(&self, text: &'a str, size: f64) -> Result<Setter<'a>> {
        let mut setter = Setter::new(text)?;
        let mut place = Place::default();
        for run in &self.runs {
            setter.outline.width = place.start(run, setter.outline.width);
            let (scale, rise) = run.level.scale_and_rise();
            setter.run(run.style, &run.text, scale * size, rise * size)?;
            place.end(run.level, &setter);
        }
        setter.outline.width = place.far;
        Ok(setter)
    }

    /// Advance width of the text with `size` units per em.
    ///
    /// # Errors
    /// As [`RichText::outline`].
    pub fn width(&self, size: f64) -> Result<f64> {
        Ok(self.outline(size)?.width)
    }

    /// The box of the ink with `size` units per em, x from the left end of the baseline and y down from the baseline; of size 0 if there is
    /// no ink.
    ///
    /// # Errors
    /// As [`RichText::outline`].
    pub fn bounds(&self, size: f64) -> Result<Rect> {
        let nothing = Rect {
            min: [0.0; 2],
            max: [0.0; 2],
        };
        Ok(bounds(&self.outline(size)?.segments).unwrap_or(nothing))
    }
}

impl Level {
    fn marked(self, text: String) -> String {
        let mark = match self {
            Level::Line => return text,
            Level::Subscript => '_',
            Level::Superscript => '^',
        };
        match text.chars().count() {
            1 => format!("{mark}{text}"),
            _ => format!("{mark}{{{text}}}"),
        }
    }

    /// The size and the height of the baseline, in those of the line.
    fn scale_and_rise(self) -> (f64, f64) {
        match self {
            Level::Line => (1.0, 0.0),
            Level::Subscript => (SCRIPT, -LOWER),
            Level::Superscript => (SCRIPT, RAISE),
        }
    }
}

/// Sets subscripts and superscripts that follow each other at the same position, and keeps italic letters clear of upright or raised text
/// after them.
#[derive(Default)]
struct Place {
    /// The start of a script: the end of the line so far.
    base: f64,
    /// The overhang of the line's last letter beyond that.
    overhang: f64,
    /// The scripts at that place, in order.
    scripts: Vec<Level>,
    /// The end of the longest script, or of the line if there are none.
    far: f64,
}

impl Place {
    /// Where `run` begins, if the last one ended at `x`.
    fn start(&mut self, run: &Run, x: f64) -> f64 {
        if run.level == Level::Line {
            let clear = !self.scripts.is_empty();
            self.scripts.clear();
            return self.far + if clear { 0.0 } else { self.correction(run) };
        }
        if self.scripts.last() == Some(&run.level) {
            // More of the same script.
            return x;
        }
        if self.scripts.contains(&run.level) {
            // A new pair after a pair.
            (self.base, self.overhang) = (self.far, 0.0);
            self.scripts.clear();
        }
        self.scripts.push(run.level);
        self.base + self.correction(run)
    }

    /// The italic correction: 0 if nothing in `run` would touch the italic letter.
    fn correction(&self, run: &Run) -> f64 {
        let upright = run.style == Style::Upright && !run.text.starts_with([' ', '.', ',']);
        match run.level {
            Level::Line if upright => self.overhang,
            Level::Superscript => self.overhang,
            Level::Line | Level::Subscript => 0.0,
        }
    }

    fn end(&mut self, level: Level, setter: &Setter) {
        let x = setter.outline.width;
        if level == Level::Line {
            (self.base, self.far, self.overhang) = (x, x, setter.overhang);
        } else {
            self.far = self.far.max(x);
        }
    }
}

#[cfg(test)]
mod tests;
