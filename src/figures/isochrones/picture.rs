//! The coloured image and its lines.

use super::contour::Grid;
use super::lines::{is_heavy, isochrones, path_of};
use super::range::Range;
use super::viridis::viridis_srgb;
use crate::figures::drawing::{Colour, Item, Join, Stroke};
use crate::io::image::RgbImage;
use crate::text::Rect;

/// The colour of pixels that show nothing: pale grey, sRGB.
const NOTHING: u8 = 232;
/// The least distance between lines, as a multiple of their width.
const CLOSEST: f64 = 4.0;

/// Where on the page an image lies.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    pub left: f64,
    pub top: f64,
    /// Pixels of the page per pixel of the image.
    pub scale: u32,
}

/// The times as colours, with lines of width `width` pixels.
pub(super) fn items(frame: Frame, grid: &Grid, range: Option<Range>, width: f64) -> Vec<Item> {
    let scale = f64::from(frame.scale);
    let place = |[x, y]: [f64; 2]| [frame.left + scale * x, frame.top + scale * y];
    let colours = Item::Image {
        image: RgbImage {
            width: grid.width as u32,
            height: grid.height as u32,
            rgb: grid.ct.iter().flat_map(|ct| shade(*ct, range)).collect(),
        },
        rect: Rect {
            min: place([0.0; 2]),
            max: place([grid.width as f64, grid.height as f64]),
        },
    };
    // The largest allowed number of lines per pixel of the image.
    let crowded = scale / (CLOSEST * width);
    let lines = range.into_iter().flat_map(|range| {
        let isochrones = isochrones(grid, &range, crowded).into_iter();
        isochrones.map(move |isochrone| {
            let stroke = stroke(&range, isochrone.number, width);
            Item::stroked(path_of(&isochrone.lines, place), stroke)
        })
    });
    std::iter::once(colours).chain(lines).collect()
}

/// The 8-bit sRGB colour of a time.
fn shade(ct: f64, range: Option<Range>) -> [u8; 3] {
    match range {
        Some(range) if ct.is_finite() => viridis_srgb(range.part(ct)),
        _ => [NOTHING; 3],
    }
}

/// The stroke of line `number`, in the picture and on the legend: dark on bright colours and bright on dark ones.
pub(super) fn stroke(range: &Range, number: i64, width: f64) -> Stroke {
    let heavy = is_heavy(number);
    // Viridis is dark below its middle.
    let colour = match range.part(number as f64 * range.step) < 0.5 {
        true => Colour::WHITE,
        false => Colour::rgb(24, 16, 40),
    };
    let colour = colour.with_alpha(if heavy { 230 } else { 140 });
    Stroke {
        join: Join::Round,
        ..Stroke::new(colour, if heavy { 1.8 * width } else { width })
    }
}
