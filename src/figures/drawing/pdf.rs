//! PDF 1.7, for journals and textbooks.
//!
//! One page of vector paths in DeviceRGB, with compressed content. It contains no date and no identifier, so that equal drawings are
//! equal files.
//!
//! Text is either outlines, or text: then the fonts in use are embedded completely, as CID-keyed fonts whose identifiers are glyph
//! numbers (a font program in the Compact Font Format without its own identifiers: ISO 32000-1, 9.7.4.2), with a table back to
//! characters. Glyphs are at the positions of the outlines, to a thousandth of their size.

use std::collections::{BTreeMap, BTreeSet};
use std::io::Read;

use flate2::Compression;
use flate2::bufread::ZlibEncoder;
use pdf_writer::types::{
    CidFontType, FontFlags, LineCapStyle, LineJoinStyle, SystemInfo, UnicodeCmap,
};
use pdf_writer::{Content, Filter, Finish, Name, Pdf, Rect, Ref, Str, TextStr};

use super::marks::{Line, Mark, marks};
use super::{Cap, Colour, Drawing, Join, Path, Text};
use crate::error::Result;
use crate::io::image::RgbImage;
use crate::text::{self, Glyph, Segment, font};

/// The drawing as a PDF file, whose document information holds the keys of its origin.
///
/// # Errors
/// As [`svg::write`](super::svg::write).
pub fn write(drawing: &Drawing) -> Result<Vec<u8>> {
    written(drawing, false)
}

/// The same with text as text in embedded fonts: it can be searched, copied and edited.
///
/// # Errors
/// As [`write()`].
pub fn write_with_text(drawing: &Drawing) -> Result<Vec<u8>> {
    written(drawing, true)
}

fn written(drawing: &Drawing, as_text: bool) -> Result<Vec<u8>> {
    let marks = marks(drawing)?;
    let mut page = Page::new(drawing.height, as_text);
    page.marks(&marks)?;
    document(drawing, page)
}

fn document(drawing: &Drawing, page: Page) -> Result<Vec<u8>> {
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
    for (leans, glyphs) in &page.fonts {
        write_font(
            &mut pdf,
            font_ref(*leans, page.images.len()),
            *leans,
            glyphs,
        )?;
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
    Ok(pdf.finish())
}

/// The five objects of a font, from number `first` on.
fn write_font(pdf: &mut Pdf, first: Ref, leans: bool, glyphs: &Glyphs) -> Result<()> {
    let font = font(leans)?;
    let [whole, cid, descriptor, program, unicode] =
        [0, 1, 2, 3, 4].map(|k| Ref::new(first.get() + k));
    let name = Name(font.name.as_bytes());
    let system = SystemInfo {
        registry: Str(b"Adobe"),
        ordering: Str(b"Identity"),
        supplement: 0,
    };
    let mut type0 = pdf.type0_font(whole);
    type0
        .base_font(name)
        .encoding_predefined(Name(b"Identity-H"));
    type0.descendant_font(cid).to_unicode(unicode);
    type0.finish();
    let mut described = pdf.cid_font(cid);
    described.subtype(CidFontType::Type0).base_font(name);
    described.system_info(system).font_descriptor(descriptor);
    let mut widths = described.widths();
    for (glyph, (_, advance)) in glyphs {
        // PDF counts widths in thousandths of the size.
        widths.same(*glyph, *glyph, float(1000.0 * advance));
    }
    widths.finish();
    described.finish();
    let [left, bottom, right, top] = font.bounds.map(f32::from);
    let [ascent, descent, capitals] = font.heights.map(f32::from);
    let slope = match leans {
        true => FontFlags::ITALIC,
        false => FontFlags::empty(),
    };
    let mut details = pdf.font_descriptor(descriptor);
    // Its encoding is its own (Identity-H), not one of Latin text.
    details
        .name(name)
        .flags(FontFlags::SERIF | FontFlags::SYMBOLIC | slope);
    details.bbox(Rect::new(left, bottom, right, top));
    details.italic_angle(font.angle).ascent(ascent);
    details.descent(descent).cap_height(capitals);
    // Of its upright stems.
    details.stem_v(80.0).font_file3(program);
    details.finish();
    let packed_program = packed(font.cff);
    let mut file = pdf.stream(program, &packed_program);
    file.filter(Filter::FlateDecode);
    file.pair(Name(b"Subtype"), Name(b"CIDFontType0C"));
    file.finish();
    let mut map = UnicodeCmap::<u16>::new(Name(b"characters"), system);
    for (glyph, (character, _)) in glyphs {
        map.pair(*glyph, *character);
    }
    pdf.cmap(unicode, &map.finish());
    Ok(())
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

/// Writes the size of the page, its colour mixing, and the opacities of its content.
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
        objects.finish();
    }
    if !page.fonts.is_empty() {
        let mut fonts = resources.fonts();
        for leans in page.fonts.keys() {
            let object = font_ref(*leans, page.images.len());
            fonts.pair(font_name(*leans), object);
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
    /// Whether text is text, not outlines.
    as_text: bool,
    /// The glyphs of the upright font that are used, and those of the leaning one.
    fonts: BTreeMap<bool, Glyphs>,
    state: State,
}

/// For each glyph number, its character and advance in em.
type Glyphs = BTreeMap<u16, (char, f64)>;

/// The current state of the content, so that it is not set again.
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
    fn new(height: f64, as_text: bool) -> Page<'a> {
        let mut content = Content::new();
        // y runs down from the top.
        content.transform([1.0, 0.0, 0.0, -1.0, 0.0, float(height)]);
        // The default of SVG.
        content.set_miter_limit(4.0);
        Page {
            content,
            alphas: BTreeSet::new(),
            images: Vec::new(),
            as_text,
            fonts: BTreeMap::new(),
            state: State::default(),
        }
    }

    fn marks(&mut self, marks: &[Mark<'a>]) -> Result<()> {
        for mark in marks {
            match mark {
                Mark::Fill { path, colour } => self.fill(path, *colour),
                Mark::Line { path, line } => self.line(path, line),
                Mark::Clip { path, marks } => self.clip(path, marks)?,
                Mark::Image { image, rect } => self.image(image, rect),
                Mark::Text { text, marks, .. } if self.as_text => {
                    // Its halo, which is drawn around outlines.
                    let halo = |mark: &&Mark| matches!(mark, Mark::Line { .. });
                    for mark in marks.iter().filter(halo) {
                        self.marks(std::slice::from_ref(mark))?;
                    }
                    self.words(text)?;
                }
                Mark::Text { marks, .. } => self.marks(marks)?,
            }
        }
        Ok(())
    }

    /// Text as text: runs of glyphs of one font and size on one baseline.
    fn words(&mut self, text: &Text) -> Result<()> {
        let glyphs = text.text.glyphs(text.size)?;
        let [left, baseline] = text.anchor.offset(text.text.width(text.size)?, text.size);
        let (sin, cos) = libm::sincos(text.angle);
        self.colour(text.colour);
        self.content.begin_text();
        let alike = |a: &Glyph, b: &Glyph| (a.leans, a.size, a.at[1]) == (b.leans, b.size, b.at[1]);
        for run in glyphs.chunk_by(alike) {
            let (first, used) = (&run[0], self.fonts.entry(run[0].leans).or_default());
            used.extend(run.iter().map(|g| (g.id, (g.character, g.advance))));
            let (x, y) = (left + first.at[0], baseline + first.at[1]);
            let at = [
                text.at[0] + cos * x + sin * y,
                text.at[1] - sin * x + cos * y,
            ];
            self.content
                .set_font(font_name(first.leans), float(first.size));
            // Glyphs are y up, the page y down.
            let turn = [cos, -sin, -sin, -cos, at[0], at[1]].map(float);
            self.content.set_text_matrix(turn);
            let mut shown = self.content.show_positioned();
            let mut items = shown.items();
            let mut end = first.at[0];
            for glyph in run {
                // Thousandths of the size, to the left.
                let back = 1000.0 * (end - glyph.at[0]) / glyph.size;
                // Less is rounding.
                if back.abs() > 0.01 {
                    items.adjust(float(back));
                }
                items.show(Str(&glyph.id.to_be_bytes()));
                end = glyph.at[0] + glyph.advance * glyph.size;
            }
        }
        self.content.end_text();
        Ok(())
    }

    /// Sets the fill colour.
    fn colour(&mut self, colour: Colour) {
        self.opacity(colour.alpha);
        if self.state.fill.replace(colour.rgb) != Some(colour.rgb) {
            let [red, green, blue] = colour.rgb.map(fraction);
            self.content.set_fill_rgb(red, green, blue);
        }
    }

    fn fill(&mut self, path: &Path, colour: Colour) {
        self.colour(colour);
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

    /// Sets the properties of a line except for its colour.
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

    fn clip(&mut self, path: &Path, marks: &[Mark<'a>]) -> Result<()> {
        let outer = self.state.clone();
        self.content.save_state();
        self.path(path);
        if path.0.is_empty() {
            // Nothing is inside of no path; a clip without one would not clip.
            self.content.rect(0.0, 0.0, 0.0, 0.0);
        }
        self.content.clip_nonzero().end_path();
        self.marks(marks)?;
        self.content.restore_state();
        self.state = outer;
        Ok(())
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

fn font_name(leans: bool) -> Name<'static> {
    match leans {
        false => Name(b"Upright"),
        true => Name(b"Italic"),
    }
}

/// The number of the first object of a font, after those of the pictures.
fn font_ref(leans: bool, images: usize) -> Ref {
    Ref::new(6 + images as i32 + 5 * i32::from(leans))
}

fn alpha_name(alpha: u8) -> String {
    format!("A{alpha}")
}

/// A share of 255, to 4 decimals.
fn fraction(value: u8) -> f32 {
    float(f64::from(value) / 255.0)
}

/// A number with 4 decimals, the precision of SVG.
fn float(value: f64) -> f32 {
    ((value * 1e4).round() / 1e4) as f32
}
