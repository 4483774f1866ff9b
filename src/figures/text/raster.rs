//! Labels on pixmaps.

use tiny_skia::{Color, FillRule, Paint, Path, PathBuilder, Pixmap, Transform};

use super::outline::Segment;
use super::rich::RichText;
use crate::error::Result;

/// A place along a line of text, by its advance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AnchorX {
    /// Where it begins.
    Start,
    /// Half way.
    Middle,
    /// Where it ends.
    End,
}

impl AnchorX {
    /// How far from the anchor a line of this advance begins.
    pub(crate) fn left(self, width: f64) -> f64 {
        match self {
            AnchorX::Start => 0.0,
            AnchorX::Middle => -width / 2.0,
            AnchorX::End => -width,
        }
    }
}

/// Fills `label` with its baseline's `anchor` at `(x, y)` pixels, `size` pixels per em.
///
/// # Errors
/// A character that the font does not have.
pub fn draw(
    pixmap: &mut Pixmap,
    [x, y]: [f64; 2],
    anchor: AnchorX,
    size: f64,
    colour: Color,
    label: &RichText,
) -> Result<()> {
    let outline = label.outline(size)?;
    let left = x + anchor.left(outline.width);
    let mut paint = Paint::default();
    paint.set_color(colour);
    // A label of spaces has no path.
    if let Some(path) = path(&outline.translated(left, y).segments) {
        let transform = Transform::identity();
        pixmap.fill_path(&path, &paint, FillRule::Winding, transform, None);
    }
    Ok(())
}

/// The segments as a tiny-skia path; none where there is nothing to draw.
pub fn path(segments: &[Segment]) -> Option<Path> {
    let mut path = PathBuilder::new();
    for segment in segments {
        match *segment {
            Segment::Move([x, y]) => path.move_to(x as f32, y as f32),
            Segment::Line([x, y]) => path.line_to(x as f32, y as f32),
            Segment::Quadratic([a, b], [x, y]) => {
                path.quad_to(a as f32, b as f32, x as f32, y as f32);
            }
            Segment::Cubic([a, b], [c, d], [x, y]) => {
                path.cubic_to(a as f32, b as f32, c as f32, d as f32, x as f32, y as f32);
            }
            Segment::Close => path.close(),
        }
    }
    path.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first and the last column with ink.
    fn ink(anchor: AnchorX) -> (u32, u32) {
        let mut pixmap = Pixmap::new(100, 40).unwrap();
        draw(
            &mut pixmap,
            [50.0, 30.0],
            anchor,
            20.0,
            Color::BLACK,
            &RichText::plain("HH").unwrap(),
        )
        .unwrap();
        let inked = |x: &u32| (0..40).any(|y| pixmap.pixel(*x, y).unwrap().alpha() > 0);
        let columns: Vec<u32> = (0..100).filter(inked).collect();
        (columns[0], columns[columns.len() - 1])
    }

    #[test]
    fn a_label_lies_where_its_anchor_says() {
        let (first, _) = ink(AnchorX::Start);
        assert!((50..53).contains(&first));
        let (_, last) = ink(AnchorX::End);
        assert!((47..50).contains(&last));
        let (first, last) = ink(AnchorX::Middle);
        assert!((first + last).abs_diff(99) <= 2, "{first} {last}");
    }

    #[test]
    fn a_label_beyond_the_pixmap_is_no_error() {
        let mut pixmap = Pixmap::new(10, 10).unwrap();
        for at in [-1e9, 1e9, f64::NAN] {
            let label = RichText::plain("far").unwrap();
            draw(
                &mut pixmap,
                [at, at],
                AnchorX::Start,
                12.0,
                Color::BLACK,
                &label,
            )
            .unwrap();
        }
        assert!(pixmap.data().iter().all(|&b| b == 0));
    }
}
