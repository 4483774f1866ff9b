//! Contact sheets: panels side by side on a white page, each with its label beneath.
//!
//! ```text
//! ┌──────────────────────────┐
//! │          title           │    n panels in rows of equal cells; n ≤ columns · rows
//! │ ┌────────┐    ┌────────┐ │
//! │ │picture │    │picture │ │    a picture stands at the bottom of its cell, in the middle,
//! │ └────────┘    └────────┘ │    at its own size or a whole multiple of it: no pixel is resampled
//! │  (a) label    (b) label  │
//! └──────────────────────────┘
//! ```
//!
//! All lengths are pixels and grow with the cells. [`Layout`] computes the positions, [`compose`] draws them. Lines that are too long are
//! broken at spaces; a word that is wider than a picture widens the cells.

mod draw;
mod layout;
mod lines;

use crate::error::Result;
use crate::io::image::RgbImage;

pub use layout::{Cell, Layout, Rect, Size};
pub use lines::TextLine;

/// A picture and its label.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Panel {
    /// The picture.
    pub picture: RgbImage,
    /// In Latin or Greek letters, digits and the signs of physics; may be empty.
    pub label: String,
    /// Whether it starts a new row, however many panels are in the row before.
    pub new_row: bool,
}

/// The arrangement of panels on a page.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct SheetOptions {
    /// Above the panels.
    pub title: Option<String>,
    /// Panels per row; `None` for as many as there are rows, or one more.
    pub columns: Option<u32>,
}

/// Draws the page. Several panels are lettered, (a), (b), …, in their order.
///
/// # Errors
/// No panel; a picture whose bytes are not those of its size; a page of more than 32000 pixels per side
/// or 2²⁸ in all; characters in a label that the font does not have.
pub fn compose(panels: &[Panel], options: &SheetOptions) -> Result<RgbImage> {
    let layout = Layout::new(panels, options)?;
    draw::page(panels, &layout)
}
