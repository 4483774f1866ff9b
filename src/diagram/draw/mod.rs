//! From a layout to a drawing: areas, grids, light, lines, world lines, axes, events, and labels last.

mod labels;
mod layers;
mod page;
mod solid;
mod theme;
mod words;

use super::layout::Layout;
use crate::drawing::{Anchor, AnchorX, AnchorY, Drawing, Item, Text};
use crate::error::Result;
use crate::scene::model::diagram::Style;
use crate::text::RichText;
use labels::Placement;
use page::Page;
use theme::Theme;

/// Draws a layout.
///
/// # Errors
/// Where a label holds what cannot be set; never for a layout of a resolved diagram.
pub fn draw(layout: &Layout, style: &Style) -> Result<Drawing> {
    let theme = Theme::new(style);
    let head = match &layout.title {
        Some(_) => 1.9 * theme.size,
        None => 0.0,
    };
    let foot = match style.legend {
        true => words::legend_height(layout, &theme),
        false => 0.0,
    };
    let page = Page::new(&layout.panels, style, head, foot);
    let mut items = title(layout, &theme, &page)?;
    let mut placement = Placement::new(page.width, page.height, theme.background);
    for (panel, map) in layout.panels.iter().zip(&page.frames) {
        items.extend(layers::of(panel, map, &theme, style));
        words::obstacles(&mut placement, panel, map, &theme);
    }
    for (panel, map) in layout.panels.iter().zip(&page.frames) {
        for request in words::of(panel, map, &theme, style, layout.panels.len() > 1) {
            placement.place(&request)?;
        }
    }
    items.append(&mut placement.items);
    if style.legend {
        items.extend(words::legend(layout, &theme, &page)?);
    }
    Ok(Drawing {
        width: page.width,
        height: page.height,
        title: layout
            .title
            .clone()
            .unwrap_or_else(|| "Space-time diagram".into()),
        background: theme.background,
        items,
    })
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
