//! PDF 1.7: what journals and textbooks take.
//!
//! One page of vector paths in DeviceRGB, the content compressed. There is no date and no identifier in
//! it, so that equal drawings are equal files.

use std::collections::BTreeSet;

use pdf_writer::types::{LineCapStyle, LineJoinStyle};
use pdf_writer::{Content, Filter, Finish, Name, Pdf, Rect, Ref, TextStr};

use super::marks::{Line, Mark, marks};
use super::{Cap, Colour, Drawing, Join, Path};
use crate::error::Result;
use crate::text::Segment;

/// How hard the content is compressed, of 10.
const COMPRESSION: u8 = 6;

/// The drawing as a PDF file.
///
/// # Errors
/// As [`svg::write`](super::svg::write).
pub fn write(drawing: &Drawing) -> Result<Vec<u8>> {
    let marks = marks(drawing)?;
    let mut page = Page::new(drawing.height);
    page.marks(&marks);
    Ok(document(drawing, page))
}

fn document(drawing: &Drawing, page: Page) -> Vec<u8> {
    let [catalog, pages, leaf, content, info] = [1, 2, 3, 4, 5].map(Ref::new);
    let mut pdf = Pdf::new();
    pdf.catalog(catalog).pages(pages);
    pdf.pages(pages).kids([leaf]).count(1);
    let size = [drawing.width, drawing.height].map(float);
    let mut leaf = pdf.page(leaf);
    leaf.parent(pages).contents(content);
    leaf.media_box(Rect::new(0.0, 0.0, size[0], size[1]));
    // Translucent colours are mixed as displays have them.
    let mut group = leaf.group();
    group.transparency().isolated(true);
    group.color_space().device_rgb();
    group.finish();
    let mut resources = leaf.resources();
    let mut states = resources.ext_g_states();
    for alpha in &page.alphas {
        let value = fraction(*alpha);
        let mut state = states.insert(Name(alpha_name(*alpha).as_bytes())).dict();
        state.pair(Name(b"CA"), value).pair(Name(b"ca"), value);
    }
    states.finish();
    resources.finish();
    leaf.finish();
    let packed = miniz_oxide::deflate::compress_to_vec_zlib(&page.content.finish(), COMPRESSION);
    pdf.stream(content, &packed).filter(Filter::FlateDecode);
    let producer = concat!("nullray ", env!("CARGO_PKG_VERSION"));
    let mut about = pdf.document_info(info);
    about
        .title(TextStr(&drawing.title))
        .producer(TextStr(producer));
    about.finish();
    pdf.finish()
}

/// The content of a page as it grows.
struct Page {
    content: Content,
    /// All opacities but full.
    alphas: BTreeSet<u8>,
    /// The opacity that is set.
    alpha: u8,
}

impl Page {
    fn new(height: f64) -> Page {
        let mut content = Content::new();
        // y runs down from the top.
        content.transform([1.0, 0.0, 0.0, -1.0, 0.0, float(height)]);
        content.set_miter_limit(4.0);
        Page {
            content,
            alphas: BTreeSet::new(),
            alpha: 255,
        }
    }

    fn marks(&mut self, marks: &[Mark]) {
        for mark in marks {
            match mark {
                Mark::Fill { path, colour } => self.fill(path, *colour),
                Mark::Line { path, line } => self.line(path, line),
                Mark::Clip { path, marks } => self.clip(path, marks),
                Mark::Text { marks, .. } => self.marks(marks),
            }
        }
    }

    fn fill(&mut self, path: &Path, colour: Colour) {
        self.opacity(colour.alpha);
        let [red, green, blue] = colour.rgb.map(fraction);
        self.content.set_fill_rgb(red, green, blue);
        self.path(path);
        self.content.fill_nonzero();
    }

    fn line(&mut self, path: &Path, line: &Line) {
        self.opacity(line.colour.alpha);
        let [red, green, blue] = line.colour.rgb.map(fraction);
        self.content.set_stroke_rgb(red, green, blue);
        self.content.set_line_width(float(line.width));
        self.content.set_line_cap(match line.cap {
            Cap::Butt => LineCapStyle::ButtCap,
            Cap::Round => LineCapStyle::RoundCap,
            Cap::Square => LineCapStyle::ProjectingSquareCap,
        });
        self.content.set_line_join(match line.join {
            Join::Miter => LineJoinStyle::MiterJoin,
            Join::Round => LineJoinStyle::RoundJoin,
            Join::Bevel => LineJoinStyle::BevelJoin,
        });
        let dash = line.dash.iter().map(|part| float(*part));
        self.content.set_dash_pattern(dash, 0.0);
        self.path(path);
        self.content.stroke();
    }

    fn clip(&mut self, path: &Path, marks: &[Mark]) {
        let alpha = self.alpha;
        self.content.save_state();
        self.path(path);
        if path.0.is_empty() {
            // Nothing is inside of no path; a clip without one would not clip.
            self.content.rect(0.0, 0.0, 0.0, 0.0);
        }
        self.content.clip_nonzero().end_path();
        self.marks(marks);
        self.content.restore_state();
        self.alpha = alpha;
    }

    fn opacity(&mut self, alpha: u8) {
        if alpha != self.alpha {
            self.alpha = alpha;
            self.alphas.insert(alpha);
            let name = alpha_name(alpha);
            self.content.set_parameters(Name(name.as_bytes()));
        }
    }

    fn path(&mut self, path: &Path) {
        let content = &mut self.content;
        let mut from = [0.0; 2];
        for segment in &path.0 {
            match *segment {
                Segment::Move([x, y]) => content.move_to(float(x), float(y)),
                Segment::Line([x, y]) => content.line_to(float(x), float(y)),
                Segment::Quadratic(a, p) => {
                    // PDF has cubic curves only.
                    let third = |q: [f64; 2]| [0, 1].map(|i| q[i] + 2.0 / 3.0 * (a[i] - q[i]));
                    curve(content, third(from), third(p), p)
                }
                Segment::Cubic(a, b, p) => curve(content, a, b, p),
                Segment::Close => content.close_path(),
            };
            from = segment.end().unwrap_or(from);
        }
    }
}

fn curve(content: &mut Content, a: [f64; 2], b: [f64; 2], p: [f64; 2]) -> &mut Content {
    let [a, b, p] = [a, b, p].map(|point| point.map(float));
    content.cubic_to(a[0], a[1], b[0], b[1], p[0], p[1])
}

fn alpha_name(alpha: u8) -> String {
    format!("A{alpha}")
}

/// A share of 255, to 4 decimals.
fn fraction(value: u8) -> f32 {
    float(f64::from(value) / 255.0)
}

/// A number to 4 decimals, as precise as it is in SVG.
fn float(value: f64) -> f32 {
    ((value * 1e4).round() / 1e4) as f32
}
