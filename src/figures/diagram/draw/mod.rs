//! From a layout to a drawing: areas, grids, light, lines, world lines, axes, events, and labels last.

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
use crate::figures::text::RichText;
use labels::Ground;
pub(crate) use labels::Habits;
use page::Page;
use theme::Theme;

/// Draws a layout.
///
/// # Errors
/// Where a label holds what cannot be set; never for a layout of a resolved diagram.
pub fn draw(layout: &Layout, style: &Style) -> Result<Drawing> {
    draw_next(layout, style, &mut Habits::default())
}

/// Draws the next layout of a series, whose labels stay where `habits` have them as long as they can.
pub(crate) fn draw_next(layout: &Layout, style: &Style, habits: &mut Habits) -> Result<Drawing> {
    let theme = Theme::new(style);
    let page = page(layout, style, &theme);
    let mut items = title(layout, &theme, &page)?;
    let mut ground = Ground::new(page.width, page.height, theme.background);
    let mut requests = Vec::new();
    for (panel, map) in layout.panels.iter().zip(&page.frames) {
        items.extend(layers::of(panel, map, &theme, style));
        obstacles::add(&mut ground, panel, map, &theme);
        requests.extend(words::of(
            panel,
            map,
            &theme,
            style,
            layout.panels.len() > 1,
        ));
    }
    items.extend(labels::place(&ground, &requests, habits)?);
    if style.legend {
        items.extend(legend::items(layout, &theme, &page)?);
    }
    let title = layout.title.clone();
    Ok(Drawing {
        width: page.width,
        height: page.height,
        title: title.unwrap_or_else(|| "Space-time diagram".into()),
        origin: Vec::new(),
        background: theme.background,
        items,
    })
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
    Page::new(&layout.panels, style, head, foot)
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
