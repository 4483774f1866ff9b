//! PNG, for slides and web pages.

use ::png::{ColorType, Encoder, EncodingError, Filter, PixelDimensions, Unit};
use tiny_skia::{
    ColorU8, FillRule, FilterQuality, LineCap, LineJoin, Mask, Paint, PathBuilder, Pattern, Pixmap,
    SpreadMode, Stroke, StrokeDash, Transform,
};

use super::marks::{Line, Mark, marks, marks_of};
use super::{Cap, Colour, Drawing, Item, Join, Path};
use crate::error::{Error, Result};
use crate::io::image::{RgbImage, png};
use crate::text::{Rect, Segment};

/// The most pixels of a picture: 1 GiB of memory.
const MOST_PIXELS: f64 = (1u64 << 28) as f64;

/// A picture of a drawing.
#[derive(Debug, Clone, PartialEq)]
pub struct RgbaImage {
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Red, green, blue, alpha (sRGB, not multiplied by alpha), row 0 at the top.
    pub rgba: Vec<u8>,
    /// Pixels per point of the page.
    pub scale: f64,
    /// Where a file is from, as in [`Drawing::origin`].
    pub origin: Vec<(String, String)>,
}

/// Draws with `scale` pixels per point: 2 for screens; dots per inch over 72 for print, so 300/72.
///
/// # Errors
/// The errors of [`svg::write`](super::svg::write), a scale that is not positive, and pictures of more than 2²⁸ pixels.
pub fn render(drawing: &Drawing, scale: f64) -> Result<RgbaImage> {
    let marks = marks(drawing)?;
    let (width, height) = pixels(drawing, scale)?;
    let canvas = Canvas::with(&marks, [width, height], scale)?;
    Ok(RgbaImage {
        width,
        height,
        rgba: canvas.pixmap.take_demultiplied(),
        scale,
        origin: drawing.origin.clone(),
    })
}

/// The picture as a PNG file, without alpha if it is opaque; it states the number of pixels per metre, and its origin in text chunks.
///
/// # Errors
/// A [`RgbaImage`] whose length is not that of its pixels, and keys that PNG does not hold.
pub fn write(raster: &RgbaImage) -> Result<Vec<u8>> {
    let opaque = raster.rgba.chunks_exact(4).all(|pixel| pixel[3] == 255);
    let mut bytes = Vec::new();
    let encoded = if opaque {
        let rgb = raster.rgba.chunks_exact(4).flat_map(|pixel| &pixel[..3]);
        let rgb: Vec<u8> = rgb.copied().collect();
        encode(encoder(&mut bytes, raster, ColorType::Rgb), &rgb)
    } else {
        encode(encoder(&mut bytes, raster, ColorType::Rgba), &raster.rgba)
    };
    encoded
        .map_err(|e| Error::invalid("drawing", "", format!("cannot be written as PNG: {e}"), ""))?;
    Ok(bytes)
}

/// Draws items on a white page whose pixels are points.
pub(crate) fn picture(size: [u32; 2], items: &[Item]) -> Result<RgbImage> {
    let marks = marks_of(items, size.map(f64::from), Colour::WHITE)?;
    let pixels = Canvas::with(&marks, size, 1.0)?.pixmap;
    let rgb = pixels.pixels().iter();
    Ok(RgbImage {
        width: size[0],
        height: size[1],
        rgb: rgb.flat_map(|p| [p.red(), p.green(), p.blue()]).collect(),
    })
}

type Encoded<'a> = Result<Encoder<'static, &'a mut Vec<u8>>, EncodingError>;

fn encode(encoder: Encoded, data: &[u8]) -> Result<(), EncodingError> {
    let mut writer = encoder?.write_header()?;
    writer.write_image_data(data)?;
    writer.finish()
}

/// An encoder of pictures like `raster`.
pub(super) fn encoder<'a>(
    bytes: &'a mut Vec<u8>,
    raster: &RgbaImage,
    colour: ColorType,
) -> Encoded<'a> {
    let mut encoder = png::encoder(bytes, [raster.width, raster.height], colour);
    // Flat areas repeat without a filter.
    encoder.set_filter(Filter::NoFilter);
    // 72 points are 0.0254 m.
    let per_metre = (raster.scale * 72.0 / 0.0254).round() as u32;
    encoder.set_pixel_dims(Some(PixelDimensions {
        xppu: per_metre,
        yppu: per_metre,
        unit: Unit::Meter,
    }));
    for (key, value) in &raster.origin {
        encoder.add_itxt_chunk(key.clone(), value.clone())?;
    }
    Ok(encoder)
}

fn pixels(drawing: &Drawing, scale: f64) -> Result<(u32, u32)> {
    if !(scale > 0.0 && scale.is_finite()) {
        let what = format!("{scale} pixels per point");
        let help = "a finite number of more than 0; 2 for screens, 300/72 for 300 dots per inch";
        return Err(Error::invalid("drawing", "", what, help));
    }
    let [width, height] =
        [drawing.width, drawing.height].map(|side| (side * scale).round().max(1.0));
    // Either side too, for a product that rounds or a page like a thread.
    if width * height > MOST_PIXELS || width.max(height) > MOST_PIXELS {
        return Err(too_large(width, height));
    }
    Ok((width as u32, height as u32))
}

fn too_large(width: f64, height: f64) -> Error {
    let what = format!("a picture of {width} × {height} pixels");
    let help = format!("at most {MOST_PIXELS} pixels: fewer pixels per point, or a smaller page");
    Error::unsupported("drawing", "", what, help)
}

struct Canvas {
    pixmap: Pixmap,
    transform: Transform,
}

impl Canvas {
    /// The marks on this number of pixels, with `scale` pixels per point.
    fn with(marks: &[Mark], [width, height]: [u32; 2], scale: f64) -> Result<Canvas> {
        let pixmap = Pixmap::new(width, height);
        let mut canvas = Canvas {
            pixmap: pixmap.ok_or_else(|| too_large(width.into(), height.into()))?,
            transform: Transform::from_scale(scale as f32, scale as f32),
        };
        canvas.marks(marks, None);
        Ok(canvas)
    }

    fn marks(&mut self, marks: &[Mark], mask: Option<&Mask>) {
        for mark in marks {
            match mark {
                Mark::Fill { path, colour } => self.fill(path, *colour, mask),
                Mark::Line { path, line } => self.line(path, line, mask),
                Mark::Clip { path, marks } => self.clip(path, marks, mask),
                Mark::Image { image, rect } => self.image(image, *rect, mask),
                Mark::Text { marks, .. } => self.marks(marks, mask),
            }
        }
    }

    fn fill(&mut self, path: &Path, colour: Colour, mask: Option<&Mask>) {
        // Paths without extent have no inside.
        if let Some(path) = path_of(&path.0) {
            let rule = FillRule::Winding;
            self.pixmap
                .fill_path(&path, &paint(colour), rule, self.transform, mask);
        }
    }

    fn line(&mut self, path: &Path, line: &Line, mask: Option<&Mask>) {
        if let Some(path) = path_of(&path.0) {
            let paint = paint(line.colour);
            self.pixmap
                .stroke_path(&path, &paint, &stroke(line), self.transform, mask);
        }
    }

    fn image(&mut self, image: &RgbImage, rect: Rect, mask: Option<&Mask>) {
        let path = path_of(&Path::rect(rect).0);
        let (Some(path), Some(pixels)) = (path, pixmap_of(image)) else {
            return;
        };
        let [width, height] = rect.size();
        let rect_from_image = Transform::from_row(
            (width / f64::from(image.width)) as f32,
            0.0,
            0.0,
            (height / f64::from(image.height)) as f32,
            rect.min[0] as f32,
            rect.min[1] as f32,
        );
        let (spread, quality) = (SpreadMode::Pad, FilterQuality::Nearest);
        let paint = Paint {
            shader: Pattern::new(pixels.as_ref(), spread, quality, 1.0, rect_from_image),
            ..Paint::default()
        };
        self.pixmap
            .fill_path(&path, &paint, FillRule::Winding, self.transform, mask);
    }

    fn clip(&mut self, path: &Path, marks: &[Mark], mask: Option<&Mask>) {
        let Some(path) = path_of(&path.0) else {
            return;
        };
        let inner = match mask {
            Some(outer) => {
                let mut inner = outer.clone();
                inner.intersect_path(&path, FillRule::Winding, true, self.transform);
                Some(inner)
            }
            None => Mask::new(self.pixmap.width(), self.pixmap.height()).map(|mut inner| {
                inner.fill_path(&path, FillRule::Winding, true, self.transform);
                inner
            }),
        };
        self.marks(marks, inner.as_ref());
    }
}

/// The segments as a tiny-skia path; `None` if there is nothing to draw.
fn path_of(segments: &[Segment]) -> Option<tiny_skia::Path> {
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

/// The picture as tiny-skia holds it.
fn pixmap_of(image: &RgbImage) -> Option<Pixmap> {
    let mut pixmap = Pixmap::new(image.width, image.height)?;
    let pixels = pixmap.pixels_mut().iter_mut();
    for (pixel, rgb) in pixels.zip(image.rgb.chunks_exact(3)) {
        *pixel = ColorU8::from_rgba(rgb[0], rgb[1], rgb[2], 255).premultiply();
    }
    Some(pixmap)
}

fn paint(colour: Colour) -> Paint<'static> {
    let mut paint = Paint::default();
    let [red, green, blue] = colour.rgb;
    paint.set_color_rgba8(red, green, blue, colour.alpha);
    paint
}

fn stroke(line: &Line) -> Stroke {
    let dash = line.dash.iter().map(|part| *part as f32).collect();
    Stroke {
        width: line.width as f32,
        miter_limit: 4.0,
        line_cap: match line.cap {
            Cap::Butt => LineCap::Butt,
            Cap::Round => LineCap::Round,
            Cap::Square => LineCap::Square,
        },
        line_join: match line.join {
            Join::Miter => LineJoin::Miter,
            Join::Round => LineJoin::Round,
            Join::Bevel => LineJoin::Bevel,
        },
        // `None` for an empty pattern.
        dash: StrokeDash::new(dash, 0.0),
    }
}
