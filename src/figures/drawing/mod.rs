//! Drawings that look the same in every format.
//!
//! A [`Drawing`] is a page of paths, text, pictures and clips in points (1/72 inch), x to the right and y down from the top left corner.
//! Everything in which formats differ is resolved once, before any writer sees it: arrowheads become filled paths with shortened shafts,
//! hatches become clipped lines, text becomes outlines. The rest (filled and stroked paths, pictures, clips) means the same to all of
//! them.
//!
//! ```text
//! Drawing → marks → svg::write, pdf::write, png::render → png::write, apng::write
//! ```
//!
//! Same drawing, same bytes, on every machine.
//!
//! ```
//! use nullray::figures::drawing::{Arrow, Colour, Drawing, Item, Path, Stroke, Text, pdf, png, svg};
//! use nullray::text::RichText;
//! # fn main() -> nullray::Result<()> {
//! let stroke = Stroke::new(Colour::BLACK, 0.8).ending(Arrow::of_line(0.8));
//! let drawing = Drawing {
//!     width: 200.0,
//!     height: 100.0,
//!     title: "The time axis of a moving frame".to_owned(),
//!     origin: Vec::new(),
//!     background: Colour::WHITE,
//!     items: vec![
//!         Item::stroked(Path::line([20.0, 90.0], [60.0, 10.0]), stroke),
//!         Item::Text(Text::new(RichText::parse("*ct*'")?, [66.0, 16.0], 10.0)),
//!     ],
//! };
//! let vectors = (svg::write(&drawing)?, pdf::write(&drawing)?);
//! let pixels = png::write(&png::render(&drawing, 300.0 / 72.0)?)?;
//! # Ok(())
//! # }
//! ```

pub mod apng;
mod arrow;
mod check;
mod file;
mod hatch;
mod image;
mod marks;
mod path;
#[cfg(feature = "pdf")]
pub mod pdf;
pub mod png;
mod style;
pub mod svg;
pub mod tikz;

pub(super) use check::LONGEST_SIDE;
pub use file::save;
pub(crate) use image::push_base64;
pub use path::{Node, Path};
pub use style::{Arrow, Cap, Colour, Fill, Hatch, Join, Stroke};

use crate::error::Result;
use crate::io::image::RgbImage;
use crate::text::{Rect, RichText};

/// A page.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawing {
    /// Points; up to 14,400 (200 inches).
    pub width: f64,
    /// Points; up to 14,400 (200 inches).
    pub height: f64,
    /// The title of the page for screen readers, and for programs that list documents.
    pub title: String,
    /// The origin of the drawing, for the metadata of files: keys (printable ASCII without spaces, 79 characters at most) and texts.
    pub origin: Vec<(String, String)>,
    /// Under everything.
    pub background: Colour,
    /// From the lowest to the uppermost.
    pub items: Vec<Item>,
}

/// Something on a page.
#[derive(Debug, Clone, PartialEq)]
pub enum Item {
    /// A path, filled and then stroked.
    Path {
        /// Where.
        path: Path,
        /// Its inside.
        fill: Option<Fill>,
        /// Its line.
        stroke: Option<Stroke>,
    },
    /// A line of text.
    Text(Text),
    /// A picture, stretched to a rectangle. Its pixels are seen as they are, not smoothed.
    Image {
        /// The picture.
        image: RgbImage,
        /// Where.
        rect: Rect,
    },
    /// Items clipped to the inside of a path (non-zero rule).
    Clip {
        /// The path.
        path: Path,
        /// The items.
        items: Vec<Item>,
    },
}

/// A line of text on a page.
#[derive(Debug, Clone, PartialEq)]
pub struct Text {
    /// The text.
    pub text: RichText,
    /// The position of its anchor.
    pub at: [f64; 2],
    /// The point of the text that is there.
    pub anchor: Anchor,
    /// Points per em.
    pub size: f64,
    /// Of its characters.
    pub colour: Colour,
    /// Its rotation about its anchor, radians, counter-clockwise on the page.
    pub angle: f64,
    /// A border around the characters, under them: colour and width in points.
    pub halo: Option<(Colour, f64)>,
}

/// A point of a line of text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Anchor {
    /// Along the line.
    pub x: AnchorX,
    /// Across the line.
    pub y: AnchorY,
}

/// A place along a line of text, by its advance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AnchorX {
    /// Its beginning.
    Start,
    /// Half way.
    Middle,
    /// Its end.
    End,
}

/// A height of a line of text: the same for all texts of one size, so that adjacent texts are aligned.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AnchorY {
    /// The foot of letters without descenders.
    Baseline,
    /// Half the height of capitals and digits.
    Middle,
    /// The height of capitals and digits.
    Top,
    /// The depth of descenders.
    Bottom,
}

/// The height of capitals in em, of Libertinus Serif.
const CAPITALS: f64 = 0.645;
/// The depth of its descenders in em.
const DESCENDERS: f64 = 0.238;

impl Item {
    /// A path with a line along it.
    pub fn stroked(path: Path, stroke: Stroke) -> Item {
        Item::Path {
            path,
            fill: None,
            stroke: Some(stroke),
        }
    }

    /// A path with its inside in one colour.
    pub fn filled(path: Path, colour: Colour) -> Item {
        Item::Path {
            path,
            fill: Some(Fill::solid(colour)),
            stroke: None,
        }
    }
}

impl Anchor {
    /// The middle of a line.
    pub const MIDDLE: Anchor = Anchor {
        x: AnchorX::Middle,
        y: AnchorY::Middle,
    };
    /// The beginning of a line, at half the height of capitals.
    pub const START: Anchor = Anchor {
        x: AnchorX::Start,
        y: AnchorY::Middle,
    };

    /// Where, from the anchor, a line of this advance and size has the left end of its baseline.
    pub(crate) fn offset(self, width: f64, size: f64) -> [f64; 2] {
        let left = match self.x {
            AnchorX::Start => 0.0,
            AnchorX::Middle => -width / 2.0,
            AnchorX::End => -width,
        };
        let baseline = match self.y {
            AnchorY::Baseline => 0.0,
            AnchorY::Middle => CAPITALS / 2.0 * size,
            AnchorY::Top => CAPITALS * size,
            AnchorY::Bottom => -DESCENDERS * size,
        };
        [left, baseline]
    }
}

impl Text {
    /// Black text, not turned, whose baseline begins at `at`.
    pub fn new(text: RichText, at: [f64; 2], size: f64) -> Text {
        Text {
            text,
            at,
            anchor: Anchor {
                x: AnchorX::Start,
                y: AnchorY::Baseline,
            },
            size,
            colour: Colour::BLACK,
            angle: 0.0,
            halo: None,
        }
    }

    /// The outlines on the page.
    ///
    /// # Errors
    /// As [`RichText::outline`].
    pub fn outline(&self) -> Result<Path> {
        let outline = self.text.outline(self.size)?;
        let [left, baseline] = self.anchor.offset(outline.width, self.size);
        let (sin, cos) = libm::sincos(self.angle);
        let place = |[x, y]: [f64; 2]| {
            let (x, y) = (left + x, baseline + y);
            // y runs down: counter-clockwise on the page turns (1, 0) to (cos, −sin).
            [
                self.at[0] + cos * x + sin * y,
                self.at[1] - sin * x + cos * y,
            ]
        };
        Ok(Path(outline.segments).map(place))
    }

    /// The box of its ink on the page, without its halo; of size 0 at its anchor if there is no ink.
    ///
    /// # Errors
    /// As [`RichText::outline`].
    pub fn bounds(&self) -> Result<Rect> {
        let nothing = Rect {
            min: self.at,
            max: self.at,
        };
        Ok(self.outline()?.bounds().unwrap_or(nothing))
    }
}
