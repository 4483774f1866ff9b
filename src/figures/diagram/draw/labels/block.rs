//! The words of a label, in one line or, if that is too long for its place, in several.

use super::geometry::moved;
use crate::error::Result;
use crate::figures::drawing::AnchorY;
use crate::text::{Rect, RichText};

/// The most lines of a label, and the most parts of one that is broken.
const MOST_LINES: usize = 6;
const MOST_PARTS: usize = 64;
/// From baseline to baseline, in the type's size.
pub(in crate::figures::diagram::draw) const LEADING: f64 = 1.25;

/// Type that is smaller than this cannot be read in any case, points.
const SMALLEST: f64 = 1.0;

/// Lines of text, one below the other.
pub(super) struct Block {
    lines: Vec<Line>,
    /// Of the type, points.
    pub size: f64,
    /// From baseline to baseline, points.
    step: f64,
}

struct Line {
    text: RichText,
    width: f64,
    /// Of its ink, from the left end of its baseline.
    ink: Rect,
}

impl Block {
    /// The possible layouts of `markup`: in one line, then in more and more lines of similar width.
    pub fn all(markup: &str, size: f64) -> Result<Vec<Block>> {
        let mut all = vec![Block::of(&[markup], size)?];
        let parts = parts(markup, &[',', ':']);
        let lengths: Vec<usize> = parts.iter().map(|part| part.chars().count()).collect();
        for count in 2..=MOST_LINES.min(parts.len()) {
            // The smallest width for which this number of lines holds the parts in order.
            let longest = lengths.iter().copied().max().unwrap_or(0);
            let whole: usize = lengths.iter().sum();
            let fits = |most: &usize| filled(&lengths, *most).len() <= count;
            let Some(most) = (longest..=whole).find(fits) else {
                continue;
            };
            let rows = filled(&lengths, most);
            if rows.len() == count {
                let lines: Vec<String> = rows.into_iter().map(|row| parts[row].concat()).collect();
                let lines: Vec<&str> = lines.iter().map(|line| line.trim()).collect();
                all.push(Block::of(&lines, size)?);
            }
        }
        Ok(all)
    }

    fn of(lines: &[&str], size: f64) -> Result<Block> {
        let lines = lines.iter().map(|markup| RichText::parse(markup));
        Block::set(lines.collect::<Result<_>>()?, size)
    }

    /// Broken between words so that it is at most `room` points wide and high; smaller if that needs too many lines.
    pub fn within(room: [f64; 2], markup: &str, size: f64) -> Result<Block> {
        let mut wanted = size;
        loop {
            let (lines, size) = wrapped(markup, wanted, room[0])?;
            let height = LEADING * size * lines.len() as f64;
            // At half the size there is half the number of lines, each of half the height.
            if height <= room[1] || size < SMALLEST {
                return Block::set(lines, size);
            }
            wanted = 0.85 * size;
        }
    }

    fn set(lines: Vec<RichText>, size: f64) -> Result<Block> {
        let line = |text: RichText| {
            Ok(Line {
                width: text.width(size)?,
                ink: text.bounds(size)?,
                text,
            })
        };
        Ok(Block {
            lines: lines.into_iter().map(line).collect::<Result<_>>()?,
            size,
            step: LEADING * size,
        })
    }

    /// The width of its longest line, points.
    pub fn width(&self) -> f64 {
        let widths = self.lines.iter().map(|line| line.width);
        widths.fold(0.0, f64::max)
    }

    /// Number of lines.
    pub fn count(&self) -> usize {
        self.lines.len()
    }

    /// Each line, its width and ink, and the distance of its anchor below that of the block.
    pub fn lines(&self, height: AnchorY) -> impl Iterator<Item = (&RichText, f64)> {
        let below = (self.lines.len() - 1) as f64 * self.step;
        let first = match height {
            AnchorY::Top => 0.0,
            AnchorY::Middle => -0.5 * below,
            // The last line is at the anchor.
            AnchorY::Baseline | AnchorY::Bottom => -below,
        };
        let lines = self.lines.iter().enumerate();
        lines.map(move |(k, line)| (&line.text, first + k as f64 * self.step))
    }

    /// The ink of all lines, where `offset` gives the left end of the baseline of a line of a width from its anchor.
    pub fn ink(&self, height: AnchorY, offset: impl Fn(f64) -> [f64; 2]) -> Rect {
        let rects = self
            .lines
            .iter()
            .zip(self.lines(height))
            .map(|(line, (_, down))| {
                let [x, y] = offset(line.width);
                moved(line.ink, [x, y + down])
            });
        let both = |a: Rect, b: Rect| Rect {
            min: [0, 1].map(|i| a.min[i].min(b.min[i])),
            max: [0, 1].map(|i| a.max[i].max(b.max[i])),
        };
        rects.reduce(both).unwrap_or(Rect {
            min: [0.0; 2],
            max: [0.0; 2],
        })
    }
}

/// The lines of `markup` in type of this size, broken between words so that none is wider than `room`, and the size: smaller if
/// something that cannot be broken would be wider.
pub(in crate::figures::diagram::draw) fn wrapped(
    markup: &str,
    size: f64,
    room: f64,
) -> Result<(Vec<RichText>, f64)> {
    let whole = RichText::parse(markup)?;
    if whole.width(size)? <= room {
        return Ok((vec![whole], size));
    }
    let mut lines: Vec<(String, RichText)> = Vec::new();
    for part in parts(markup, &[]) {
        let longer = lines.last().map(|(line, _)| format!("{line}{part}"));
        if let Some(longer) = longer {
            let text = RichText::parse(longer.trim())?;
            if text.width(size)? <= room {
                lines.pop();
                lines.push((longer, text));
                continue;
            }
        }
        lines.push((part.to_string(), RichText::parse(part.trim())?));
    }
    let mut widest = 0.0;
    for (_, text) in &lines {
        widest = text.width(size)?.max(widest);
    }
    let fits = if widest > room { room / widest } else { 1.0 };
    Ok((
        lines.into_iter().map(|(_, text)| text).collect(),
        size * fits,
    ))
}

/// The parts between which a label may be broken where no markup spans: at spaces after one of `after`, or if that is empty at all.
fn parts<'m>(markup: &'m str, after: &[char]) -> Vec<&'m str> {
    let most = if after.is_empty() {
        usize::MAX
    } else {
        MOST_PARTS
    };
    let mut parts = Vec::new();
    let mut from = 0;
    for (space, _) in markup.match_indices(' ') {
        let is_there = after.is_empty() || markup[..space].ends_with(after);
        let end = space + 1;
        if !is_there {
            continue;
        }
        let Some((head, rest)) = markup.split_at_checked(end) else {
            continue;
        };
        let is_whole = |text: &str| RichText::parse(text.trim()).is_ok();
        let is_break = head.ends_with(' ') && !rest.trim().is_empty();
        if is_break && parts.len() + 1 < most && is_whole(&markup[from..end]) && is_whole(rest) {
            parts.push(&markup[from..end]);
            from = end;
        }
    }
    parts.push(&markup[from..]);
    parts
}

/// Lines of no more than `most` characters, each filled before the next begins.
fn filled(lengths: &[usize], most: usize) -> Vec<std::ops::Range<usize>> {
    let mut rows: Vec<std::ops::Range<usize>> = Vec::new();
    let mut width = 0;
    for (k, length) in lengths.iter().enumerate() {
        match rows.last_mut().filter(|_| width + length <= most) {
            Some(row) => row.end = k + 1,
            None => {
                rows.push(k..k + 1);
                width = 0;
            }
        }
        width += length;
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::drawing::AnchorX;

    fn set(markup: &str) -> Vec<Vec<String>> {
        let all = Block::all(markup, 10.0).unwrap();
        let lines = |block: &Block| {
            block
                .lines(AnchorY::Top)
                .map(|(text, _)| text.text())
                .collect()
        };
        all.iter().map(lines).collect()
    }

    #[test]
    fn labels_are_broken_after_commas_and_colons_into_even_lines() {
        assert_eq!(
            set("camera, floor, wall, gold"),
            [
                vec!["camera, floor, wall, gold"],
                vec!["camera, floor,", "wall, gold"],
                vec!["camera,", "floor,", "wall, gold"],
                vec!["camera,", "floor,", "wall,", "gold"],
            ]
        );
        assert_eq!(set("emitted: *τ*_{lamp} = 3 m").len(), 2);
    }

    #[test]
    fn labels_are_not_broken_within_markup_numbers_or_at_their_end() {
        for whole in ["*a, b*", "x_{a, b}", "3,5", "a,", "a, ", "one word"] {
            assert_eq!(set(whole).len(), 1, "{whole}");
        }
    }

    #[test]
    fn the_ink_of_a_block_holds_that_of_its_lines() {
        let [one, two] = &Block::all("long words, more", 10.0).unwrap()[..] else {
            panic!("two ways")
        };
        for height in [AnchorY::Top, AnchorY::Middle, AnchorY::Baseline] {
            let [a, b] = [one, two].map(|block| block.ink(height, |width| [-width, 0.0]));
            assert!(b.max[0] - b.min[0] < a.max[0] - a.min[0]);
            assert!(b.max[1] - b.min[1] > a.max[1] - a.min[1] + 9.0);
            // Below the anchor, around it, above it.
            let down = b.max[1] - a.max[1];
            let said = match height {
                AnchorY::Top => 12.5,
                AnchorY::Middle => 6.25,
                _ => 0.0,
            };
            // The last line has no descender that the whole has not.
            assert!((down - said).abs() < 3.0, "{down} {said}");
        }
    }

    #[test]
    fn lines_end_alike_at_the_right_of_an_anchor_at_their_end() {
        let offset = crate::figures::drawing::Anchor {
            x: AnchorX::End,
            y: AnchorY::Top,
        };
        let all = Block::all("long words, more", 10.0).unwrap();
        let rect = all[1].ink(AnchorY::Top, |width| offset.offset(width, 10.0));
        assert!(rect.max[0] <= 0.5 && rect.min[0] < -35.0, "{rect:?}");
    }
}
