//! The page: title, picture, and the legend to its right.
//!
//! ```text
//! title
//! ┌──────────────┐   ct / m      t / ns
//! │              │      2 ┌─┐ 6
//! │   picture    │      1 │ │ 4
//! │              │      0 └─┘ 2
//! └──────────────┘
//! ```

use super::contour::Grid;
use super::legend::{INK, Legend};
use super::picture::{self, Frame};
use super::range::Range;
use super::{IsochroneOptions, Values};
use crate::error::{Error, Result};
use crate::figures::drawing::{Item, Text, png};
use crate::io::image::RgbImage;
use crate::text::RichText;

/// Small pictures are enlarged to about this size, pixels.
const COMFORTABLE: u32 = 360;
/// The longest side of a page, pixels.
const MAX_SIDE: f64 = 32_000.0;

/// Where everything lies, pixels.
pub(super) struct Page {
    size: [u32; 2],
    image: [u32; 2],
    frame: Frame,
    /// Pixels per em.
    em: f64,
    title: [f64; 2],
    legend: Option<Legend>,
}

impl Page {
    /// Finds a place for everything.
    pub fn lay_out(
        width: u32,
        height: u32,
        range: Option<Range>,
        title: &str,
        values: Values,
    ) -> Result<Page> {
        // Small pictures are enlarged by whole factors, so that pixels stay squares.
        let scale = (COMFORTABLE / width.max(height)).max(1);
        let [w, h] = [width, height].map(|n| f64::from(n) * f64::from(scale));
        // Proportional to the height of the picture, but always legible.
        let em = (0.035 * h).clamp(15.0, 40.0);
        let margin = (1.2 * em).round();
        let top = (margin + 2.0 * em).round();
        // Low pictures have a legend higher than themselves.
        let bar_height = (h - 1.6 * em).max(12.0 * em);
        let legend = match range {
            Some(range) => Some(Legend::lay_out(
                range,
                [margin + w + 1.4 * em, top + 1.6 * em],
                bar_height,
                em,
                values,
            )?),
            None => None,
        };
        // The page is as large as the picture, the title or the legend needs.
        let title_width = RichText::plain(title)?.width(1.25 * em)?;
        let right = legend.as_ref().map_or(margin + w, Legend::extent);
        let bottom = legend.as_ref().map_or(0.0, |l| l.bottom + 0.5 * em);
        let right = right.max(margin + title_width) + margin;
        let bottom = bottom.max(top + h) + margin;
        if right.max(bottom) > MAX_SIDE {
            let what =
                format!("{width} × {height} pixels are too many for a picture of isochrones");
            let help = "at most 30000 pixels per side";
            return Err(Error::unsupported("isochrones", "", what, help));
        }
        Ok(Page {
            size: [right.ceil() as u32, bottom.ceil() as u32],
            image: [width, height],
            frame: Frame {
                left: margin,
                top,
                scale,
            },
            em,
            title: [margin, margin + 0.95 * em],
            legend,
        })
    }

    /// Draws the page.
    pub fn draw(&self, ct: &[f64], options: &IsochroneOptions) -> Result<RgbImage> {
        let title = RichText::plain(&options.title)?;
        let mut items = vec![Item::Text(Text {
            colour: INK,
            ..Text::new(title, self.title, 1.25 * self.em)
        })];
        let grid = Grid {
            width: self.image[0] as usize,
            height: self.image[1] as usize,
            ct,
        };
        let range = self.legend.as_ref().map(|legend| legend.range);
        let stroke = (self.em / 18.0).max(0.9);
        items.extend(picture::items(self.frame, &grid, range, stroke));
        if let Some(legend) = &self.legend {
            items.extend(legend.items(self.em, stroke));
        }
        png::picture(self.size, &items)
    }
}
