//! PDF 1.7: what journals and textbooks take.
//!
//! One page of vector paths in DeviceRGB, the content compressed. There is no date and no identifier in
//! it, so that equal drawings are equal files.

use std::collections::BTreeSet;
use std::io::Read;

use flate2::Compression;
use flate2::bufread::ZlibEncoder;
use pdf_writer::types::{LineCapStyle, LineJoinStyle};
use pdf_writer::{Content, Filter, Finish, Name, Pdf, Rect, Ref, TextStr};

use super::marks::{Line, Mark, marks};
use super::{Cap, Colour, Drawing, Join, Path};
use crate::error::Result;
use crate::figures::text::{self, Segment};
use crate::io::image::RgbImage;

/// The drawing as a PDF file, whose document information holds the keys of its origin.
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
    let mut leaf = pdf.page(leaf);
    leaf.parent(pages).contents(content);
    describe(&mut leaf, drawing, &page);
    leaf.finish();
    for (index, image) in page.images.iter().enumerate() {
        write_image(&mut pdf, image_ref(index), image);
    }
    let packed = packed(&page.content.finish());
    pdf.stream(content, &packed).filter(Filter::FlateDecode);
    let producer = concat!("nullray ", env!("CARGO_PKG_VERSION"));
    let mut about = pdf.document_info(info);
    about.title(TextStr(&drawing.title));
    about.producer(TextStr(producer));
    for (key, value) in &drawing.origin {
        about.pair(Name(key.as_bytes()), TextStr(value));
    }
    about.finish();
    pdf.finish()
}

fn write_image(pdf: &mut Pdf, id: Ref, image: &RgbImage) {
    let rgb = packed(&image.rgb);
    let mut object = pdf.image_xobject(id, &rgb);
    object.filter(Filter::FlateDecode);
    object
        .width(image.width as i32)
        .height(image.height as i32)
        .bits_per_component(8);
    object.color_space().device_rgb();
}

/// The size of the page, how its colours mix, and the opacities that its content uses.
fn describe(leaf: &mut pdf_writer::writers::Page, drawing: &Drawing, page: &Page) {
    let [width, height] = [drawing.width, drawing.height].map(float);
    leaf.media_box(Rect::new(0.0, 0.0, width, height));
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
    if !page.images.is_empty() {
        let mut objects = resources.x_objects();
        for index in 0..page.images.len() {
            objects.pair(Name(image_name(index).as_bytes()), image_ref(index));
        }
    }
}

fn packed(content: &[u8]) -> Vec<u8> {
    let mut packed = Vec::with_capacity(content.len() / 2);
    // Of the levels with a good yield the quickest.
    let mut encoder = ZlibEncoder::new(content, Compression::new(3));
    // A slice reads into memory without errors.
    let _ = encoder.read_to_end(&mut packed);
    packed
}

/// The content of a page as it grows.
struct Page<'a> {
    content: Content,
    /// All opacities that are used.
    alphas: BTreeSet<u8>,
    /// All pictures, in order.
    images: Vec<&'a RgbImage>,
    state: State,
}

/// What the content has set, so that it is not set again.
#[derive(Clone, Default)]
struct State {
    alpha: Option<u8>,
    fill: Option<[u8; 3]>,
    stroke: Option<[u8; 3]>,
    width: Option<f64>,
    cap: Option<Cap>,
    join: Option<Join>,
    dash: Vec<f64>,
}

impl<'a> Page<'a> {
    fn new(height: f64) -> Page<'a> {
        let mut content = Content::new();
        // y runs down from the top.
        content.transform([1.0, 0.0, 0.0, -1.0, 0.0, float(height)]);
        content.set_miter_limit(4.0);
        Page {
            content,
            alphas: BTreeSet::new(),
            images: Vec::new(),
            state: State::default(),
        }
    }

    fn marks(&mut self, marks: &[Mark<'a>]) {
        for mark in marks {
            match mark {
                Mark::Fill { path, colour } => self.fill(path, *colour),
                Mark::Line { path, line } => self.line(path, line),
                Mark::Clip { path, marks } => self.clip(path, marks),
                Mark::Image { image, rect } => self.image(image, rect),
                Mark::Text { marks, .. } => self.marks(marks),
            }
        }
    }

    fn fill(&mut self, path: &Path, colour: Colour) {
        self.opacity(colour.alpha);
        if self.state.fill.replace(colour.rgb) != Some(colour.rgb) {
            let [red, green, blue] = colour.rgb.map(fraction);
            self.content.set_fill_rgb(red, green, blue);
        }
        self.path(path);
        self.content.fill_nonzero();
    }

    fn line(&mut self, path: &Path, line: &Line) {
        self.opacity(line.colour.alpha);
        if self.state.stroke.replace(line.colour.rgb) != Some(line.colour.rgb) {
            let [red, green, blue] = line.colour.rgb.map(fraction);
            self.content.set_stroke_rgb(red, green, blue);
        }
        self.pen(line);
        self.path(path);
        self.content.stroke();
    }

    /// Sets what a line has but its colour.
    fn pen(&mut self, line: &Line) {
        if self.state.width.replace(line.width) != Some(line.width) {
            self.content.set_line_width(float(line.width));
        }
        if self.state.cap.replace(line.cap) != Some(line.cap) {
            self.content.set_line_cap(match line.cap {
                Cap::Butt => LineCapStyle::ButtCap,
                Cap::Round => LineCapStyle::RoundCap,
                Cap::Square => LineCapStyle::ProjectingSquareCap,
            });
        }
        if self.state.join.replace(line.join) != Some(line.join) {
            self.content.set_line_join(match line.join {
                Join::Miter => LineJoinStyle::MiterJoin,
                Join::Round => LineJoinStyle::RoundJoin,
                Join::Bevel => LineJoinStyle::BevelJoin,
            });
        }
        if self.state.dash != line.dash {
            self.state.dash.clone_from(&line.dash);
            let dash = line.dash.iter().map(|part| float(*part));
            self.content.set_dash_pattern(dash, 0.0);
        }
    }

    fn image(&mut self, image: &'a RgbImage, rect: &text::Rect) {
        self.opacity(255);
        let name = image_name(self.images.len());
        self.images.push(image);
        let ([x, y], [width, height]) = (rect.min.map(float), rect.size().map(float));
        self.content.save_state();
        // The unit square of a picture has its first row at the top, y = 1.
        self.content
            .transform([width, 0.0, 0.0, -height, x, y + height]);
        self.content.x_object(Name(name.as_bytes()));
        self.content.restore_state();
    }

    fn clip(&mut self, path: &Path, marks: &[Mark<'a>]) {
        let outer = self.state.clone();
        self.content.save_state();
        self.path(path);
        if path.0.is_empty() {
            // Nothing is inside of no path; a clip without one would not clip.
            self.content.rect(0.0, 0.0, 0.0, 0.0);
        }
        self.content.clip_nonzero().end_path();
        self.marks(marks);
        self.content.restore_state();
        self.state = outer;
    }

    fn opacity(&mut self, alpha: u8) {
        if self.state.alpha.replace(alpha) != Some(alpha) {
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

fn image_name(index: usize) -> String {
    format!("I{index}")
}

/// The number of the object that holds a picture.
fn image_ref(index: usize) -> Ref {
    Ref::new(6 + index as i32)
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
