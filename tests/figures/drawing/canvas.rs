//! A canvas for the tests' readers.

use nullray::text::Segment;
use tiny_skia::{
    FillRule, LineCap, LineJoin, Mask, Paint, Path, PathBuilder, Pixmap, Stroke, StrokeDash,
    Transform,
};

pub struct Canvas {
    pixmap: Pixmap,
    scale: Transform,
    /// The clips that are in force, the innermost last.
    clips: Vec<Mask>,
}

/// How a line is drawn, in the numbers that PDF and tiny-skia share.
#[derive(Clone, Default)]
pub struct Pen {
    pub width: f64,
    pub dash: Vec<f32>,
    /// 0 butt, 1 round, 2 square.
    pub cap: u8,
    /// 0 miter, 1 round, 2 bevel.
    pub join: u8,
}

impl Canvas {
    pub fn new(width: u32, height: u32, scale: f64) -> Canvas {
        Canvas {
            pixmap: Pixmap::new(width, height).unwrap(),
            scale: Transform::from_scale(scale as f32, scale as f32),
            clips: Vec::new(),
        }
    }

    pub fn fill(&mut self, segments: &[Segment], rgba: [u8; 4]) {
        let Some(path) = path(segments) else { return };
        let clip = self.clips.last();
        self.pixmap
            .fill_path(&path, &paint(rgba), FillRule::Winding, self.scale, clip);
    }

    pub fn line(&mut self, segments: &[Segment], rgba: [u8; 4], pen: &Pen) {
        let Some(path) = path(segments) else { return };
        let stroke = Stroke {
            width: pen.width as f32,
            miter_limit: 4.0,
            line_cap: [LineCap::Butt, LineCap::Round, LineCap::Square][usize::from(pen.cap)],
            line_join: [LineJoin::Miter, LineJoin::Round, LineJoin::Bevel][usize::from(pen.join)],
            dash: StrokeDash::new(pen.dash.clone(), 0.0),
        };
        let clip = self.clips.last();
        self.pixmap
            .stroke_path(&path, &paint(rgba), &stroke, self.scale, clip);
    }

    pub fn clip(&mut self, segments: &[Segment]) {
        let path = path(segments).unwrap();
        let mut mask = Mask::new(self.pixmap.width(), self.pixmap.height()).unwrap();
        mask.fill_path(&path, FillRule::Winding, true, self.scale);
        if let Some(outer) = self.clips.last() {
            for (inner, outer) in mask.data_mut().iter_mut().zip(outer.data()) {
                *inner = (u16::from(*inner) * u16::from(*outer) / 255) as u8;
            }
        }
        self.clips.push(mask);
    }

    pub fn clips(&self) -> usize {
        self.clips.len()
    }

    pub fn unclip(&mut self, to: usize) {
        self.clips.truncate(to);
    }

    pub fn rgba(self) -> Vec<u8> {
        self.pixmap.take_demultiplied()
    }
}

fn paint([red, green, blue, alpha]: [u8; 4]) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color_rgba8(red, green, blue, alpha);
    paint
}

/// The segments as a tiny-skia path; `None` if there is nothing to draw.
fn path(segments: &[Segment]) -> Option<Path> {
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
