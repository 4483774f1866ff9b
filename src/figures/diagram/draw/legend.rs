//! A line sample and a name for each world line, below the panels.

use super::layers::line_colour;
use super::theme::Theme;
use crate::error::Result;
use crate::figures::diagram::layout::Layout;
use crate::figures::drawing::{Anchor, Item, Path, Text};
use crate::text::RichText;

/// Lines that a legend has: those with labels, of the first panel.
fn entries(layout: &Layout) -> impl Iterator<Item = (usize, &str)> {
    let panels = layout.panels.first().into_iter();
    let lines = panels.flat_map(|panel| &panel.world_lines);
    let labelled = lines
        .enumerate()
        .map(|(i, line)| (i, line.label.as_deref()));
    labelled.filter_map(|(i, label)| Some((i, label?)))
}

/// Points.
pub(super) fn height(layout: &Layout, theme: &Theme) -> f64 {
    1.5 * theme.size * (entries(layout).count() as f64 + 0.5)
}

/// Its lines, above `bottom` on a page of this width.
pub(super) fn items(layout: &Layout, theme: &Theme, bottom: f64, width: f64) -> Result<Vec<Item>> {
    let mut items = Vec::new();
    let Some(panel) = layout.panels.first() else {
        return Ok(items);
    };
    let top = bottom - height(layout, theme);
    for (row, (i, label)) in entries(layout).enumerate() {
        let colour = line_colour(panel, theme, i);
        let y = top + 1.5 * theme.size * (row as f64 + 0.5);
        let x = 2.0 * theme.size;
        let path = Path::line([x, y], [x + 28.0, y]);
        items.push(Item::stroked(path, theme.world_line(i, colour)));
        let words = RichText::parse(label)?;
        let left = x + 34.0;
        // Smaller if the page is too narrow for it.
        let room = (width - left - 0.5 * theme.size).max(0.1 * width);
        let size = theme.size.min(room / words.width(1.0)?);
        items.push(Item::Text(Text {
            anchor: Anchor::START,
            colour: theme.ink,
            ..Text::new(words, [left, y], size)
        }));
    }
    Ok(items)
}
