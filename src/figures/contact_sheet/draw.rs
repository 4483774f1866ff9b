//! The page in pixels.

use tiny_skia::{Color, Pixmap, PremultipliedColorU8};

use super::Panel;
use super::layout::{Layout, Rect, TextLine};
use crate::error::{Error, Result};
use crate::figures::text::{self, AnchorX, RichText};
use crate::io::image::RgbImage;

/// Draws all panels and their labels.
pub(super) fn page(panels: &[Panel], layout: &Layout) -> Result<RgbImage> {
    let [width, height] = layout.size;
    let mut page = Pixmap::new(width, height).ok_or_else(|| {
        let what = format!("a page of {width} × {height} pixels cannot be held");
        Error::unsupported("sheet", "", what, "")
    })?;
    page.fill(Color::WHITE);
    for line in &layout.title {
        write(&mut page, line)?;
    }
    for (panel, cell) in panels.iter().zip(&layout.cells) {
        place(&mut page, &panel.picture, cell.picture, layout.scale);
        for line in &cell.label {
            write(&mut page, line)?;
        }
    }
    let rgb = page.pixels().iter();
    let rgb = rgb.flat_map(|p| [p.red(), p.green(), p.blue()]).collect();
    Ok(RgbImage { width, height, rgb })
}

fn write(page: &mut Pixmap, line: &TextLine) -> Result<()> {
    let label = RichText::plain(&line.text)?;
    text::draw(
        page,
        line.middle,
        AnchorX::Middle,
        line.size,
        Color::BLACK,
        &label,
    )
}

/// Copies the picture, each pixel `scale` times in both directions.
fn place(page: &mut Pixmap, picture: &RgbImage, at: Rect, scale: u32) {
    let row_length = page.width() as usize;
    let rows = page.pixels_mut().chunks_exact_mut(row_length);
    let rows = rows.skip(at.top as usize).take(at.height as usize);
    let lines = picture.rgb.chunks_exact(3 * picture.width as usize);
    let lines = lines.flat_map(|line| std::iter::repeat_n(line, scale as usize));
    for (row, line) in rows.zip(lines) {
        let (pixels, _) = line.as_chunks::<3>();
        let spread = pixels.iter();
        let spread = spread.flat_map(|rgb| std::iter::repeat_n(*rgb, scale as usize));
        for (pixel, [r, g, b]) in row.iter_mut().skip(at.left as usize).zip(spread) {
            *pixel = PremultipliedColorU8::from_rgba(r, g, b, 255).unwrap_or(*pixel);
        }
    }
}
