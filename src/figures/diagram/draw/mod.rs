//! From a layout to a drawing: areas, grids, light, lines, world lines, axes, events, and labels last.

mod gaps;
mod labels;
mod layers;
mod legend;
mod obstacles;
mod page;
mod solid;
mod theme;
mod words;

use super::layout::Layout;
use crate::error::Result;
use crate::figures::diagram::model::Style;
use crate::figures::drawing::{Anchor, AnchorX, AnchorY, Drawing, Item, Text};
use crate::figures::text::{Rect, RichText};
use labels::Ground;
pub(crate) use labels::Habits;
use labels::widened;
use page::Page;
use theme::Theme;

/// Around labels, where a line that moves is interrupted, points.
const GAP: f64 = 1.5;
/// Between titles and labels beside them, points.
const BESIDE: f64 = 16.0;

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
    let page = page(layout, style, &theme);
    let mut items = title(layout, &theme, &page)?;
    items.extend(note(layout, &theme, &page)?);
    let mut ground = Ground::new(page.width, page.height, theme.background);
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
    // Moving lines are interrupted at labels, which stay in place.
    let labels = labels::place(&ground, &requests, habits)?;
    let boxes = boxes(&labels)?;
    let gaps: Vec<Rect> = boxes.iter().map(|rect| widened(*rect, GAP)).collect();
    let mut lines = Vec::new();
    for (panel, map) in layout.panels.iter().zip(&page.frames) {
        lines.extend(layers::of(panel, map, &theme, style, &gaps));
    }
    items.extend(gaps::interrupted(lines, &boxes));
    items.extend(labels);
    if style.legend {
        items.extend(legend::items(layout, &theme, &page)?);
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

/// The note below a diagram with light outside of its plane.
fn note(layout: &Layout, theme: &Theme, page: &Page) -> Result<Option<Item>> {
    if !has_projected_light(layout) {
        return Ok(None);
    }
    let words = RichText::plain("dashed light leaves the plane of the diagram: its projection")?;
    let at = [0.5 * page.width, page.height - 0.6 * theme.size];
    // Smaller if the page is too narrow for it.
    let room = (page.width - theme.size) / words.width(1.0)?;
    let size = room.min(0.8 * theme.size);
    Ok(Some(Item::Text(Text {
        anchor: Anchor {
            x: AnchorX::Middle,
            y: AnchorY::Baseline,
        },
        colour: theme.light,
        ..Text::new(words, at, size)
    })))
}

fn has_projected_light(layout: &Layout) -> bool {
    let panels = layout.panels.iter();
    panels.flat_map(|panel| &panel.projected).any(|is| *is)
}

fn page(layout: &Layout, style: &Style, theme: &Theme) -> Page {
    let head = match &layout.title {
        Some(_) => 1.9 * theme.size,
        None => 0.0,
    };
    let foot = match style.legend {
        true => legend::height(layout, theme),
        false => 0.0,
    };
    let note = match has_projected_light(layout) {
        true => 1.6 * theme.size,
        false => 0.0,
    };
    Page::new(&layout.panels, style, head, foot + note)
}

fn title(layout: &Layout, theme: &Theme, page: &Page) -> Result<Vec<Item>> {
    let Some(title) = &layout.title else {
        return Ok(Vec::new());
    };
    let at = [0.5 * page.width, 0.7 * theme.size];
    let text = Text {
        anchor: Anchor {
            x: AnchorX::Middle,
            y: AnchorY::Top,
        },
        colour: theme.ink,
        ..Text::new(RichText::parse(title)?, at, 1.2 * theme.size)
    };
    Ok(vec![Item::Text(text)])
}
