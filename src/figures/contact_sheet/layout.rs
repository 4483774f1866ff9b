//! The layout of a page.

use super::lines::{LEADING, Measured, TextLine, broken, lettered, lines, widest_word};
use super::{Panel, SheetOptions};
use crate::error::{Error, Result};

/// Small pictures are enlarged to about this size, pixels.
const COMFORTABLE: u32 = 240;
/// The longest side of a page, pixels.
const MAX_SIDE: u32 = 32_000;
/// The most pixels of a page.
const MAX_AREA: u64 = 1 << 28;
/// The em as a part of the widest picture, and its bounds in pixels.
const EM: (f64, f64, f64) = (0.045, 13.0, 60.0);
/// The title's size, em.
const TITLE: f64 = 1.35;
/// Between cells, and around them, em.
const SPACE: f64 = 1.2;

/// The layout of a page.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Layout {
    /// Width and height of the page.
    pub size: [u32; 2],
    /// The title, line by line.
    pub title: Vec<TextLine>,
    /// One per panel, row by row.
    pub cells: Vec<Cell>,
    /// Pixels of the page per pixel of a picture.
    pub scale: u32,
}

/// The layout of a panel.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Cell {
    /// The whole cell; cells of a row have the same size, and none overlap.
    pub frame: Rect,
    /// The picture, within the frame.
    pub picture: Rect,
    /// The label, line by line, within the frame and beneath the picture.
    pub label: Vec<TextLine>,
}

/// A panel, given the size of its picture.
#[derive(Debug, Clone, Copy)]
pub struct Size<'a> {
    /// Columns of pixels.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Its label.
    pub label: &'a str,
    /// Whether it starts a new row.
    pub new_row: bool,
}

impl<'a> Size<'a> {
    /// That of a panel.
    fn of(panel: &'a Panel) -> Self {
        Size {
            width: panel.picture.width,
            height: panel.picture.height,
            label: &panel.label,
            new_row: panel.new_row,
        }
    }
}

/// A rectangle of whole pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rect {
    /// First column.
    pub left: u32,
    /// First row.
    pub top: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl Layout {
    /// Computes the layout.
    ///
    /// # Errors
    /// Those of [`compose`](super::compose).
    pub fn new(panels: &[Panel], options: &SheetOptions) -> Result<Layout> {
        panels.iter().try_for_each(check)?;
        let sizes: Vec<Size> = panels.iter().map(Size::of).collect();
        Layout::of_sizes(&sizes, options)
    }

    /// The same for pictures that do not exist yet: whether they fit on a page is known before they are rendered.
    ///
    /// # Errors
    /// Those of [`compose`](super::compose).
    pub fn of_sizes(panels: &[Size], options: &SheetOptions) -> Result<Layout> {
        let largest = |side: fn(&Size) -> u32| panels.iter().map(side).max().unwrap_or(0);
        let (width, height) = (largest(|p| p.width), largest(|p| p.height));
        if width == 0 || height == 0 {
            return Err(refuse("a sheet without panels", "give at least one panel"));
        }
        let scale = (COMFORTABLE / width.max(height)).max(1);
        if width.max(height) > MAX_SIDE {
            return Err(too_large(width, height));
        }
        let draft = Draft::new(panels, width * scale, scale, options)?;
        draft.place(panels, options)
    }
}

/// Sizes, with nothing placed yet.
struct Draft {
    em: f64,
    /// Pixels of the page per pixel of a picture.
    scale: u32,
    columns: u32,
    /// Row and column of each panel.
    slots: Vec<[u32; 2]>,
    rows: Vec<Row>,
    /// Between cells, and around them.
    space: u32,
    /// The width of all cells.
    width: u32,
    labels: Vec<Vec<Measured>>,
}

/// A row of cells, as high as its own pictures and labels need.
#[derive(Clone, Copy, Default)]
struct Row {
    /// Its first row of pixels, from that of the first row on.
    top: u64,
    /// The height of its highest picture.
    picture: u32,
    /// The height of its longest label.
    label: u32,
}

impl Row {
    fn height(self) -> u32 {
        self.picture + self.label
    }
}

impl Draft {
    /// For pictures the widest of which takes `widest` pixels of the page.
    fn new(panels: &[Size], widest: u32, scale: u32, options: &SheetOptions) -> Result<Draft> {
        let (part, least, most) = EM;
        let em = (part * f64::from(widest)).clamp(least, most);
        let count = panels.len() as u32;
        // The smallest number of columns for which as many rows hold all panels.
        let nearly_square = || (1..count).find(|n| n * n >= count).unwrap_or(count);
        let columns = options.columns.unwrap_or_else(nearly_square);
        let columns = columns.clamp(1, count);
        let (labels, width) = labels(panels, widest, em)?;
        let slots = slots(panels, columns);
        let space = (SPACE * em).round() as u32;
        // Each row is as high as its own highest picture and longest label.
        let heights = panels.iter().zip(&labels).zip(&slots);
        let heights = heights.map(|((panel, label), [row, _])| {
            let label = height_of(label.len(), em);
            (*row as usize, [panel.height * scale, label])
        });
        Ok(Draft {
            em,
            scale,
            columns,
            rows: rows(heights, space),
            slots,
            space,
            width,
            labels,
        })
    }

    /// Columns and rows of pixels that all cells take.
    fn extent(&self) -> [u64; 2] {
        let [columns, width, space] = [self.columns, self.width, self.space].map(u64::from);
        let last = self.rows.last().copied().unwrap_or_default();
        [
            columns * width + (columns - 1) * space,
            last.top + u64::from(last.height()),
        ]
    }

    fn place(self, panels: &[Size], options: &SheetOptions) -> Result<Layout> {
        // No word of the title is broken: one that is wider than all cells makes the page wider, and the cells stay in its middle.
        let [across, down] = self.extent();
        let size = TITLE * self.em;
        let title = options.title.as_deref().unwrap_or("");
        let content = (across as f64).max(widest_word(title, size)?).ceil();
        let title = broken(title, size, content)?;
        let above = u64::from(height_of(title.len(), size));
        let margin = u64::from(self.space);
        // Checked before cells get places: these count pixels in u32.
        let (width, height) = (content as u64 + 2 * margin, above + down + 2 * margin);
        if width.max(height) > u64::from(MAX_SIDE) || width * height > MAX_AREA {
            return Err(too_large(width, height));
        }
        let corner = [((width - across) / 2) as u32, (margin + above) as u32];
        let placed = panels.iter().zip(&self.labels).zip(&self.slots);
        let cells = placed
            .map(|((panel, label), slot)| self.cell(panel, label, *slot, corner))
            .collect();
        Ok(Layout {
            size: [width as u32, height as u32],
            title: lines(title, [width as f64 / 2.0, margin as f64], size),
            cells,
            scale: self.scale,
        })
    }

    /// The positions of a panel's picture and label: pictures of a row are aligned.
    fn cell(
        &self,
        panel: &Size,
        label: &[Measured],
        [row, column]: [u32; 2],
        [left, top]: [u32; 2],
    ) -> Cell {
        let row = self.rows[row as usize];
        let frame = Rect {
            left: left + column * (self.width + self.space),
            top: top + row.top as u32,
            width: self.width,
            height: row.height(),
        };
        // Centred in its cell; lower pictures are aligned with the bottom of the row's highest one, above the labels.
        let [width, height] = [panel.width, panel.height].map(|n| n * self.scale);
        let picture = Rect {
            left: frame.left + (self.width - width) / 2,
            top: frame.top + row.picture - height,
            width,
            height,
        };
        let middle = f64::from(frame.left) + f64::from(self.width) / 2.0;
        let beneath = f64::from(frame.top + row.picture) + 0.4 * self.em;
        Cell {
            frame,
            picture,
            label: lines(label.to_vec(), [middle, beneath], self.em),
        }
    }
}

/// The rows of a page, by the row of each panel and the heights of its picture and its label.
fn rows(panels: impl Iterator<Item = (usize, [u32; 2])>, space: u32) -> Vec<Row> {
    let mut rows: Vec<Row> = Vec::new();
    for (index, [picture, label]) in panels {
        rows.resize(rows.len().max(index + 1), Row::default());
        rows[index].picture = rows[index].picture.max(picture);
        rows[index].label = rows[index].label.max(label);
    }
    let mut top = 0;
    for row in &mut rows {
        row.top = top;
        top += u64::from(row.height()) + u64::from(space);
    }
    rows
}

/// Row and column of each panel: rows of `columns`, or shorter where a panel begins one.
fn slots(panels: &[Size], columns: u32) -> Vec<[u32; 2]> {
    let mut next = [0, 0];
    let slot = |panel: &Size| {
        let [row, column] = next;
        let slot = match column == columns || panel.new_row && column > 0 {
            true => [row + 1, 0],
            false => [row, column],
        };
        next = [slot[0], slot[1] + 1];
        slot
    };
    panels.iter().map(slot).collect()
}

/// All labels in lines, and the width in which each word of them has room.
fn labels(panels: &[Size], picture: u32, em: f64) -> Result<(Vec<Vec<Measured>>, u32)> {
    let numbered = panels.iter().enumerate();
    let texts = numbered.map(|(index, panel)| lettered(index, panels.len(), panel.label));
    let texts: Vec<String> = texts.collect();
    let mut width = f64::from(picture);
    for text in &texts {
        width = width.max(widest_word(text, em)?);
    }
    let width = width.ceil();
    let labels: Result<_> = texts.iter().map(|text| broken(text, em, width)).collect();
    Ok((labels?, width as u32))
}

/// The height of `lines` lines with the space before them; 0 for no lines.
fn height_of(lines: usize, size: f64) -> u32 {
    match lines {
        0 => 0,
        lines => ((0.5 + LEADING * lines as f64) * size).ceil() as u32,
    }
}

fn check(panel: &Panel) -> Result<()> {
    let picture = &panel.picture;
    let bytes = 3 * u64::from(picture.width) * u64::from(picture.height);
    if bytes > 0 && bytes == picture.rgb.len() as u64 {
        return Ok(());
    }
    let (w, h, n) = (picture.width, picture.height, picture.rgb.len());
    let what = format!("{n} bytes for {w} × {h} RGB pixels");
    Err(refuse(&what, "three bytes per pixel, at least one pixel"))
}

fn refuse(what: &str, help: &str) -> Error {
    Error::invalid("sheet", "", what, help)
}

fn too_large(width: impl std::fmt::Display, height: impl std::fmt::Display) -> Error {
    let what = format!("a page of {width} × {height} pixels cannot be drawn");
    let help =
        format!("smaller or fewer pictures: at most {MAX_SIDE} pixels per side, {MAX_AREA} in all");
    Error::unsupported("sheet", "", what, help)
}
