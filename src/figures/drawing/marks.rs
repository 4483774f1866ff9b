//! Elements that mean the same in all formats: filled paths, plain lines, pictures, clips.

use super::arrow::with_heads;
use super::check::Checked;
use super::hatch;
use super::{Cap, Colour, Drawing, Fill, Item, Join, Path, Stroke, Text};
use crate::error::Result;
use crate::io::image::RgbImage;
use crate::text::Rect;

/// Something that every format can draw.
#[derive(Debug)]
pub(super) enum Mark<'a> {
    Fill {
        path: Path,
        colour: Colour,
    },
    Line {
        path: Path,
        line: Line,
    },
    Clip {
        path: Path,
        marks: Vec<Mark<'a>>,
    },
    Image {
        image: &'a RgbImage,
        rect: Rect,
    },
    /// Outlines of text, with the text itself.
    Text {
        text: &'a Text,
        says: String,
        marks: Vec<Mark<'a>>,
    },
}

/// A stroke without arrowheads.
#[derive(Debug)]
pub(super) struct Line {
    pub colour: Colour,
    pub width: f64,
    /// As many dashes as gaps.
    pub dash: Vec<f64>,
    pub cap: Cap,
    pub join: Join,
}

/// The marks of a drawing, from the lowest to the uppermost.
///
/// # Errors
/// The errors of [`Checked`], with the index of their item.
pub(super) fn marks(drawing: &Drawing) -> Result<Vec<Mark<'_>>> {
    let drawing = Checked::new(drawing)?.0;
    marks_of(
        &drawing.items,
        [drawing.width, drawing.height],
        drawing.background,
    )
}

/// The marks of items on a page of this size.
pub(super) fn marks_of(
    items: &[Item],
    size: [f64; 2],
    background: Colour,
) -> Result<Vec<Mark<'_>>> {
    let page = Rect {
        min: [0.0; 2],
        max: size,
    };
    let mut marks = Vec::with_capacity(items.len() + 1);
    push_fill(&mut marks, Path::rect(page), background);
    push_items(&mut marks, items, page)?;
    Ok(marks)
}

fn push_items<'a>(marks: &mut Vec<Mark<'a>>, items: &'a [Item], page: Rect) -> Result<()> {
    for item in items {
        match item {
            Item::Path { path, fill, stroke } => {
                if let Some(fill) = fill {
                    push_inside(marks, path, *fill, page);
                }
                if let Some(stroke) = stroke {
                    push_stroke(marks, path, stroke);
                }
            }
            Item::Text(text) => marks.push(text_mark(text)?),
            Item::Image { image, rect } => marks.push(Mark::Image { image, rect: *rect }),
            Item::Clip { path, items } => {
                let mut inner = Vec::with_capacity(items.len());
                push_items(&mut inner, items, page)?;
                marks.push(Mark::Clip {
                    path: path.clone(),
                    marks: inner,
                });
            }
        }
    }
    Ok(())
}

fn push_fill(marks: &mut Vec<Mark>, path: Path, colour: Colour) {
    if colour.alpha > 0 && !path.0.is_empty() {
        marks.push(Mark::Fill { path, colour });
    }
}

fn push_line(marks: &mut Vec<Mark>, path: Path, line: Line) {
    if line.colour.alpha > 0 && !path.0.is_empty() {
        marks.push(Mark::Line { path, line });
    }
}

fn push_inside(marks: &mut Vec<Mark>, path: &Path, fill: Fill, page: Rect) {
    let Some(hatch) = fill.hatch else {
        return push_fill(marks, path.clone(), fill.colour);
    };
    let Some(area) = path.bounds() else {
        return;
    };
    let mut lines = Vec::new();
    let line = Line {
        colour: fill.colour,
        width: hatch.width,
        dash: Vec::new(),
        cap: Cap::Butt,
        join: Join::Miter,
    };
    push_line(&mut lines, hatch::lines(&hatch, area, page), line);
    marks.push(Mark::Clip {
        path: path.clone(),
        marks: lines,
    });
}

fn push_stroke(marks: &mut Vec<Mark>, path: &Path, stroke: &Stroke) {
    let (shaft, heads) = with_heads(path, stroke);
    push_line(marks, shaft, Line::of(stroke));
    for head in heads {
        push_fill(marks, head, stroke.colour);
    }
}

fn text_mark(text: &Text) -> Result<Mark<'_>> {
    let outline = text.outline()?;
    let mut marks = Vec::with_capacity(2);
    if let Some((colour, width)) = text.halo.filter(|(_, width)| *width > 0.0) {
        let line = Line {
            colour,
            // Half of the line lies within the characters.
            width: 2.0 * width,
            dash: Vec::new(),
            cap: Cap::Round,
            join: Join::Round,
        };
        push_line(&mut marks, outline.clone(), line);
    }
    push_fill(&mut marks, outline, text.colour);
    Ok(Mark::Text {
        text,
        says: text.text.text(),
        marks,
    })
}

impl Line {
    fn of(stroke: &Stroke) -> Line {
        let mut dash = stroke.dash.clone();
        // An odd pattern takes turns: its dashes are gaps the second time.
        if dash.len() % 2 == 1 {
            dash.extend_from_within(..);
        }
        Line {
            colour: stroke.colour,
            width: stroke.width,
            dash,
            cap: stroke.cap,
            join: stroke.join,
        }
    }
}
