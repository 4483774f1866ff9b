//! From a layout to a drawing: areas, grids, light, lines, world lines, axes, events, and labels last.

mod gaps;
mod labels;
mod layers;
mod legend;
mod obstacles;
mod page;
mod parts;
mod reach;
mod solid;
mod theme;
mod words;

use super::layout::Layout;
use crate::error::{Error, Result};
use crate::figures::diagram::model::Style;
use crate::figures::drawing::{Anchor, AnchorX, AnchorY, Drawing, Item, LONGEST_SIDE, Text};
use crate::text::{Rect, RichText};
use labels::Ground;
pub(crate) use labels::Habits;
use labels::{LEADING, widened, wrapped};
use page::Page;
pub(super) use page::WIDTH;
use reach::Reach;
use theme::Theme;

/// Around labels, where a line that moves is interrupted, points.
const GAP: f64 = 1.5;
/// Between titles and labels beside them, points.
const BESIDE: f64 = 16.0;
/// Size of titles, and distance of the lines of notes, in the type's size.
const TITLE: f64 = 1.2;
const NOTE: f64 = 1.1;

/// Draws a layout.
///
/// # Errors
/// If a label contains characters that cannot be set; never for a layout of a resolved diagram.
pub fn draw(layout: &Layout, style: &Style) -> Result<Drawing> {
    draw_next(layout, style, &mut Habits::default())
}

/// Draws the next layout of a series, whose labels stay where `habits` have them as long as they can.
pub(crate) fn draw_next(layout: &Layout, style: &Style, habits: &mut Habits) -> Result<Drawing> {
    let theme = Theme::new(style);
    let page = page(layout, style, &theme)?;
    let mut items = title(layout, &theme, &page)?;
    items.extend(notes(layout, &theme, &page)?);
    let mut ground = Ground::new(page.width, page.height, &theme);
    for item in &items {
        if let Item::Text(text) = item {
            ground.words(beside(text.bounds()?));
        }
    }
    let mut requests = Vec::new();
    for (i, (panel, map)) in layout.panels.iter().zip(&page.frames).enumerate() {
        obstacles::add(&mut ground, panel, map, &theme);
        let number = (layout.panels.len() > 1).then_some(i);
        let words = words::Words::new(panel, map, &theme, number);
        requests.extend(words.all(style, &ground, habits)?);
    }
    let reach = Reach::of(&page);
    for request in &mut requests {
        request.anchors.retain(|at| reach.holds(*at));
    }
    // Moving lines are interrupted at labels, which stay in place.
    let labels = labels::place(&ground, &requests, habits)?;
    let boxes = boxes(&labels)?;
    let gaps: Vec<Rect> = boxes.iter().map(|rect| widened(*rect, GAP)).collect();
    let mut lines = Vec::new();
    for (panel, map) in layout.panels.iter().zip(&page.frames) {
        lines.extend(reach.cut(layers::of(panel, map, &theme, style, &gaps)));
    }
    items.extend(gaps::interrupted(lines, &boxes));
    items.extend(labels);
    if style.legend {
        let above_notes = page.height - notes_height(layout, &theme);
        items.extend(legend::items(layout, &theme, above_notes, page.width)?);
    }
    let title = layout.title.as_deref().map(RichText::parse).transpose()?;
    Ok(Drawing {
        width: page.width,
        height: page.height,
        title: title.map_or("Space-time diagram".into(), |title| title.text()),
        origin: Vec::new(),
        background: theme.background,
        items,
    })
}

/// With room left and right, so that no label reads as the next word of a title.
fn beside(rect: Rect) -> Rect {
    Rect {
        min: [rect.min[0] - BESIDE, rect.min[1]],
        max: [rect.max[0] + BESIDE, rect.max[1]],
    }
}

/// The boxes of labels.
fn boxes(labels: &[Item]) -> Result<Vec<Rect>> {
    let texts = labels.iter().filter_map(|item| match item {
        Item::Text(text) => Some(text.bounds()),
        Item::Path { .. } | Item::Image { .. } | Item::Clip { .. } => None,
    });
    texts.collect()
}

/// The lines below a diagram.
fn notes(layout: &Layout, theme: &Theme, page: &Page) -> Result<Vec<Item>> {
    let room = page.width - theme.size.min(0.2 * page.width);
    let count = layout.notes.len();
    let notes = layout.notes.iter().enumerate().map(|(i, note)| {
        let words = RichText::parse(&note.text)?;
        let above = (count - 1 - i) as f64 * NOTE * theme.size;
        let at = [0.5 * page.width, page.height - 0.6 * theme.size - above];
        // Smaller if the page is too narrow for it.
        let size = (room / words.width(1.0)?).min(0.8 * theme.size);
        Ok(Item::Text(Text {
            anchor: Anchor {
                x: AnchorX::Middle,
                y: AnchorY::Baseline,
            },
            colour: note.colour.map_or(theme.ink, |name| theme.colour(name)),
            ..Text::new(words, at, size)
        }))
    });
    notes.collect()
}

/// Height of the notes, points: that of one, and a line for each more.
fn notes_height(layout: &Layout, theme: &Theme) -> f64 {
    match layout.notes.len() {
        0 => 0.0,
        count => (1.6 + NOTE * (count - 1) as f64) * theme.size,
    }
}

fn page(layout: &Layout, style: &Style, theme: &Theme) -> Result<Page> {
    let head = match &layout.title {
        Some(title) => {
            let width = page::width(layout.panels.len(), style);
            let lines = title_lines(title, width, theme)?.0.len();
            (1.9 + TITLE * LEADING * (lines - 1) as f64) * theme.size
        }
        None => 0.0,
    };
    let foot = match style.legend {
        true => legend::height(layout, theme),
        false => 0.0,
    };
    let foot = foot + notes_height(layout, theme);
    let page = Page::new(&layout.panels, style, head, foot);
    for (side, length) in [("wide", page.width), ("high", page.height)] {
        if !(length > 0.0 && length <= LONGEST_SIDE) {
            let what = format!("the page of the diagram would be {length:.0} points {side}");
            let help = format!(
                "at most {LONGEST_SIDE} points (200 inches): a smaller width or type, or fewer views, lines and notes"
            );
            return Err(Error::invalid("diagram", "style", what, help));
        }
    }
    Ok(page)
}

/// The lines of a title on a page of this width, and the size of their type.
fn title_lines(title: &str, width: f64, theme: &Theme) -> Result<(Vec<RichText>, f64)> {
    wrapped(
        title,
        TITLE * theme.size,
        width - theme.size.min(0.2 * width),
    )
}

fn title(layout: &Layout, theme: &Theme, page: &Page) -> Result<Vec<Item>> {
    let Some(title) = &layout.title else {
        return Ok(Vec::new());
    };
    let (lines, size) = title_lines(title, page.width, theme)?;
    let lines = lines.into_iter().enumerate().map(|(i, line)| {
        let down = TITLE * LEADING * theme.size * i as f64;
        let at = [0.5 * page.width, 0.7 * theme.size + down];
        Item::Text(Text {
            anchor: Anchor {
                x: AnchorX::Middle,
                y: AnchorY::Top,
            },
            colour: theme.ink,
            ..Text::new(line, at, size)
        })
    });
    Ok(lines.collect())
}
