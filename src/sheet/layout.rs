//! Where everything is on a page.

use super::{Options, Panel};
use crate::error::{Error, Result};
use crate::text::{self, Label};

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
/// From one baseline to the next, as a multiple of the size of the type.
const LEADING: f64 = 1.3;
/// From the top of a line of text to its baseline, as a multiple of its size.
const ASCENT: f64 = 0.95;

/// A page: everything has its place.
#[derive(Debug, Clone, PartialEq)]
pub struct Layout {
    /// Width and height of the page.
    pub size: [u32; 2],
    /// The title, line by line.
    pub title: Vec<Line>,
    /// One per panel, row by row.
    pub cells: Vec<Cell>,
    /// Pixels of the page per pixel of a picture.
    pub scale: u32,
}

/// The place of a panel.
#[derive(Debug, Clone, PartialEq)]
pub struct Cell {
    /// All of it; cells are of one size and do not overlap.
    pub frame: Rect,
    /// The picture, within the frame.
    pub picture: Rect,
    /// The label, line by line, within the frame and beneath the picture.
    pub label: Vec<Line>,
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

/// A line of text, centred.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// What it says.
    pub text: String,
    /// The middle of its baseline: x, y.
    pub middle: [f64; 2],
    /// Pixels per em.
    pub size: f64,
    /// How wide it is.
    pub width: f64,
}

impl Layout {
    /// Finds a place for everything.
    ///
    /// # Errors
    /// As [`compose`](super::compose) has them.
    pub fn new(panels: &[Panel], options: &Options) -> Result<Layout> {
        for panel in panels {
            check(panel)?;
        }
        let largest = |side: fn(&Panel) -> u32| panels.iter().map(side).max().unwrap_or(0);
        let (width, height) = (largest(|p| p.picture.width), largest(|p| p.picture.height));
        if width == 0 || height == 0 {
            return Err(refuse("a sheet without panels", "give at least one panel"));
        }
        let scale = (COMFORTABLE / width.max(height)).max(1);
        if width.max(height) > MAX_SIDE {
            return Err(too_large(width, height));
        }
        let draft = Draft::new(panels, [width * scale, height * scale], options)?;
        draft.place(panels, options, scale)
    }
}

/// Sizes, with nothing placed yet.
struct Draft {
    em: f64,
    columns: u32,
    rows: u32,
    margin: u32,
    gap: u32,
    /// The largest picture.
    picture: [u32; 2],
    cell: [u32; 2],
    labels: Vec<Vec<Measured>>,
}

/// A line and its width.
type Measured = (String, f64);

impl Draft {
    fn new(panels: &[Panel], picture: [u32; 2], options: &Options) -> Result<Draft> {
        let (part, least, most) = EM;
        let em = (part * f64::from(picture[0])).clamp(least, most);
        let count = panels.len() as u32;
        let columns = options
            .columns
            .unwrap_or_else(|| (1..).find(|n| n * n >= count).unwrap_or(count));
        let columns = columns.clamp(1, count);
        let texts: Vec<String> = (panels.iter().enumerate())
            .map(|(index, panel)| lettered(index, panels.len(), &panel.label))
            .collect();
        let mut width = f64::from(picture[0]);
        for text in &texts {
            width = width.max(widest_word(text, em)?);
        }
        let width = width.ceil();
        let labels: Result<Vec<_>> = texts.iter().map(|text| broken(text, em, width)).collect();
        let labels = labels?;
        let lines = labels.iter().map(Vec::len).max().unwrap_or(0);
        let beneath = if lines == 0 {
            0.0
        } else {
            (0.5 + LEADING * lines as f64) * em
        };
        Ok(Draft {
            em,
            columns,
            rows: count.div_ceil(columns),
            margin: (1.2 * em).round() as u32,
            gap: (1.2 * em).round() as u32,
            picture,
            cell: [width as u32, picture[1] + beneath.ceil() as u32],
            labels,
        })
    }

    fn place(self, panels: &[Panel], options: &Options, scale: u32) -> Result<Layout> {
        let [cell_width, cell_height] = self.cell.map(u64::from);
        let (columns, rows) = (u64::from(self.columns), u64::from(self.rows));
        let (margin, gap) = (u64::from(self.margin), u64::from(self.gap));
        let across = columns * cell_width + (columns - 1) * gap;
        let size = TITLE * self.em;
        let title = options.title.as_deref().unwrap_or("");
        let content = (across as f64).max(widest_word(title, size)?).ceil();
        let title = broken(title, size, content)?;
        let above = match title.len() {
            0 => 0.0,
            lines => (LEADING * lines as f64 + 0.5) * size,
        };
        let width = content as u64 + 2 * margin;
        let top = margin + above.ceil() as u64;
        let height = top + rows * cell_height + (rows - 1) * gap + margin;
        if width.max(height) > u64::from(MAX_SIDE) || width * height > MAX_AREA {
            return Err(too_large(width, height));
        }
        let size_of_page = [width as u32, height as u32];
        let left = ((width - across) / 2) as u32;
        let middle = f64::from(size_of_page[0]) / 2.0;
        let title = lines(title, [middle, margin as f64], size);
        let cells = (panels.iter().zip(&self.labels).zip(0..))
            .map(|((panel, label), index)| {
                self.cell(panel, label, index, [left, top as u32], scale)
            })
            .collect();
        Ok(Layout {
            size: size_of_page,
            title,
            cells,
            scale,
        })
    }

    fn cell(
        &self,
        panel: &Panel,
        label: &[Measured],
        index: u32,
        [left, top]: [u32; 2],
        scale: u32,
    ) -> Cell {
        let (column, row) = (index % self.columns, index / self.columns);
        let [cell_width, cell_height] = self.cell;
        let frame = Rect {
            left: left + column * (cell_width + self.gap),
            top: top + row * (cell_height + self.gap),
            width: cell_width,
            height: cell_height,
        };
        let [width, height] = [panel.picture.width, panel.picture.height].map(|n| n * scale);
        let picture = Rect {
            left: frame.left + (cell_width - width) / 2,
            top: frame.top + self.picture[1] - height,
            width,
            height,
        };
        let middle = f64::from(frame.left) + f64::from(cell_width) / 2.0;
        let beneath = f64::from(frame.top + self.picture[1]) + 0.4 * self.em;
        Cell {
            frame,
            picture,
            label: lines(label.to_vec(), [middle, beneath], self.em),
        }
    }
}

/// Lines one beneath the other, centred, from the top at `y` on.
fn lines(measured: Vec<Measured>, [x, y]: [f64; 2], size: f64) -> Vec<Line> {
    let place = |(number, (text, width)): (usize, Measured)| Line {
        text,
        middle: [x, y + (ASCENT + LEADING * number as f64) * size],
        size,
        width,
    };
    measured.into_iter().enumerate().map(place).collect()
}

/// The label of panel `index`, with its letter where there are several panels.
fn lettered(index: usize, count: usize, label: &str) -> String {
    if count == 1 {
        return label.to_string();
    }
    format!("({}) {label}", letters(index))
}

/// a, b, …, z, aa, ab, …
fn letters(index: usize) -> String {
    let last = char::from(b'a' + (index % 26) as u8);
    match index / 26 {
        0 => last.to_string(),
        before => letters(before - 1) + &last.to_string(),
    }
}

fn width(text: &str, size: f64) -> Result<f64> {
    text::width(&Label::new(text), size)
}

fn widest_word(text: &str, size: f64) -> Result<f64> {
    let mut widest: f64 = 0.0;
    for word in text.split_whitespace() {
        widest = widest.max(width(word, size)?);
    }
    Ok(widest)
}

/// The text in lines of at most `room` pixels, broken at spaces.
fn broken(text: &str, size: f64, room: f64) -> Result<Vec<Measured>> {
    let mut lines: Vec<Measured> = Vec::new();
    for word in text.split_whitespace() {
        if let Some((line, line_width)) = lines.last_mut() {
            let longer = format!("{line} {word}");
            let longer_width = width(&longer, size)?;
            if longer_width <= room {
                (*line, *line_width) = (longer, longer_width);
                continue;
            }
        }
        lines.push((word.to_string(), width(word, size)?));
    }
    Ok(lines)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_go_on_after_z() {
        assert_eq!(
            [0, 25, 26, 27, 51, 52].map(letters),
            ["a", "z", "aa", "ab", "az", "ba"]
        );
    }

    #[test]
    fn lines_are_broken_at_spaces_and_fit() {
        let lines = broken("one two  three four", 10.0, 45.0).unwrap();
        assert!(lines.len() > 1);
        assert!(lines.iter().all(|(_, width)| *width <= 45.0), "{lines:?}");
        let words: Vec<_> = lines.iter().map(|(text, _)| text.as_str()).collect();
        assert_eq!(words.join(" "), "one two three four");
        assert!(broken("", 10.0, 45.0).unwrap().is_empty());
    }
}
