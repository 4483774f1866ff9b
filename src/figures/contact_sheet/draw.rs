//! The page in pixels.

use super::Panel;
use super::layout::{Layout, Rect};
use super::lines::TextLine;
use crate::error::Result;
use crate::figures::drawing::{Anchor, AnchorX, AnchorY, Item, Text, png};
use crate::io::image::RgbImage;
use crate::text::RichText;

/// Draws all panels and their labels.
pub(super) fn page(panels: &[Panel], layout: &Layout) -> Result<RgbImage> {
    let labels = layout.cells.iter().flat_map(|cell| &cell.label);
    let texts: Result<Vec<Item>> = layout.title.iter().chain(labels).map(text).collect();
    let mut page = png::picture(layout.size, &texts?)?;
    for (panel, cell) in panels.iter().zip(&layout.cells) {
        place(&mut page, &panel.picture, cell.picture, layout.scale);
    }
    Ok(page)
}

fn text(line: &TextLine) -> Result<Item> {
    Ok(Item::Text(Text {
        anchor: Anchor {
            x: AnchorX::Middle,
            y: AnchorY::Baseline,
        },
        ..Text::new(RichText::plain(&line.text)?, line.middle, line.size)
    }))
}

/// Copies the picture, each pixel `scale` times in both directions.
fn place(page: &mut RgbImage, picture: &RgbImage, at: Rect, scale: u32) {
    let rows = page.rgb.chunks_exact_mut(3 * page.width as usize);
    let rows = rows.skip(at.top as usize).take(at.height as usize);
    let lines = picture.rgb.chunks_exact(3 * picture.width as usize);
    let lines = lines.flat_map(|line| std::iter::repeat_n(line, scale as usize));
    for (row, line) in rows.zip(lines) {
        let (pixels, _) = line.as_chunks::<3>();
        let spread = pixels.iter();
        let spread = spread.flat_map(|rgb| std::iter::repeat_n(*rgb, scale as usize));
        let (places, _) = row.as_chunks_mut::<3>();
        for (place, rgb) in places.iter_mut().skip(at.left as usize).zip(spread) {
            *place = rgb;
        }
    }
}
