//! The coloured image and its lines, on a pixmap.

use tiny_skia::{
    Color, LineCap, LineJoin, Paint, PathBuilder, Pixmap, PremultipliedColorU8, Stroke, Transform,
};

use super::chain::{Points, polylines};
use super::contour::{Grid, pieces};
use super::range::Range;
use super::viridis::viridis;

/// Where nothing was seen: pale grey, sRGB.
const NOTHING: u8 = 232;
/// Every so many lines one is heavy.
const HEAVY: i64 = 5;
/// The least distance between lines, as a multiple of their width.
const CLOSEST: f64 = 4.0;

/// Where on the pixmap an image lies.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    pub left: f64,
    pub top: f64,
    /// Pixels of the pixmap per pixel of the image.
    pub scale: u32,
}

/// Draws the times as colours, with lines of width `stroke` pixels.
pub(super) fn draw(
    pixmap: &mut Pixmap,
    frame: Frame,
    grid: &Grid,
    range: Option<Range>,
    stroke: f64,
) {
    colours(pixmap, frame, grid, range);
    let Some(range) = range else {
        return;
    };
    let place = |[x, y]: [f64; 2]| {
        let scale = f64::from(frame.scale);
        [frame.left + scale * x, frame.top + scale * y]
    };
    // Lines per pixel of the image, at which they are as close as they may be.
    let crowded = f64::from(frame.scale) / (CLOSEST * stroke);
    for (pieces, number) in pieces(grid, &range).iter().zip(range.lines()) {
        let most = if number % HEAVY == 0 {
            HEAVY as f64
        } else {
            1.0
        } * crowded;
        let lines = polylines(pieces).into_iter();
        let lines = lines.filter(|line| line.density <= most);
        let lines: Vec<Points> = lines
            .map(|line| line.points.into_iter().map(place).collect())
            .collect();
        strokes(pixmap, &lines, &LineStyle::new(&range, number, stroke));
    }
}

fn colours(pixmap: &mut Pixmap, frame: Frame, grid: &Grid, range: Option<Range>) {
    let (left, top) = (frame.left as usize, frame.top as usize);
    let scale = frame.scale as usize;
    let row_length = pixmap.width() as usize;
    let pixels = pixmap.pixels_mut();
    for y in 0..grid.height * scale {
        let start = (top + y) * row_length + left;
        let times = grid.ct.iter().skip(y / scale * grid.width);
        let times = times.take(grid.width);
        let spread = times.flat_map(|ct| std::iter::repeat_n(ct, scale));
        for (pixel, &ct) in pixels.iter_mut().skip(start).zip(spread) {
            let [r, g, b] = shade(ct, range);
            *pixel = PremultipliedColorU8::from_rgba(r, g, b, 255).unwrap_or(*pixel);
        }
    }
}

/// The 8-bit sRGB colour of a time.
fn shade(ct: f64, range: Option<Range>) -> [u8; 3] {
    match range {
        Some(range) if ct.is_finite() => viridis(range.part(ct)).map(|c| (255.0 * c + 0.5) as u8),
        _ => [NOTHING; 3],
    }
}

/// How an isochrone is drawn, in the picture and on the legend.
pub(super) struct LineStyle {
    pub colour: Color,
    pub width: f64,
}

impl LineStyle {
    /// The look of line `number`: dark on bright colours and bright on dark ones.
    pub fn new(range: &Range, number: i64, stroke: f64) -> LineStyle {
        let heavy = number % HEAVY == 0;
        let part = range.part(number as f64 * range.step);
        let (r, g, b) = if part < 0.5 {
            (255, 255, 255)
        } else {
            (24, 16, 40)
        };
        let alpha = if heavy { 230 } else { 140 };
        LineStyle {
            colour: Color::from_rgba8(r, g, b, alpha),
            width: if heavy { 1.8 * stroke } else { stroke },
        }
    }
}

/// Strokes all lines as one path, so that a translucent line is not darker where its parts meet.
pub(super) fn strokes(pixmap: &mut Pixmap, lines: &[Points], look: &LineStyle) {
    let mut path = PathBuilder::new();
    for line in lines {
        let closed = line.len() > 2 && line.first() == line.last();
        for (i, &[x, y]) in line.iter().enumerate() {
            match i {
                0 => path.move_to(x as f32, y as f32),
                _ => path.line_to(x as f32, y as f32),
            }
        }
        if closed {
            path.close();
        }
    }
    let Some(path) = path.finish() else {
        return;
    };
    let mut paint = Paint::default();
    paint.set_color(look.colour);
    let stroke = Stroke {
        width: look.width as f32,
        line_cap: LineCap::Butt,
        line_join: LineJoin::Round,
        ..Stroke::default()
    };
    pixmap.stroke_path(&path, &paint, &stroke, Transform::identity(), None);
}
