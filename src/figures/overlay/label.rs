//! Labels along lines: where a line is nearly straight, and no other label is near.

use super::Polyline;
use super::style;
use crate::error::Result;
use crate::figures::drawing::{Colour, Text};
use crate::figures::text::RichText;

/// Points per em.
const SIZE: f64 = 6.5;
/// Where along a line a label may be, the best first.
const PLACES: [f64; 9] = [0.5, 0.35, 0.65, 0.42, 0.58, 0.25, 0.75, 0.15, 0.85];
/// How much of a line's length under a label its chord has at least.
const STRAIGHT: f64 = 0.975;
/// The least length of a line with a label, in lengths of the label.
const LEAST: f64 = 2.2;

/// The labels of a drawing so far.
#[derive(Debug)]
pub(super) struct Labels {
    /// Points; the label's middle and ends must lie within.
    size: [f64; 2],
    /// Discs that are taken: centre and radius.
    discs: Vec<([f64; 2], f64)>,
}

impl Labels {
    /// No labels yet on a picture of this size, points.
    pub fn new(size: [f64; 2]) -> Labels {
        Labels {
            size,
            discs: Vec::new(),
        }
    }

    /// Keeps labels off a disc, points.
    pub fn keep_off(&mut self, centre: [f64; 2], radius: f64) {
        self.discs.push((centre, radius));
    }

    /// A label with this text along `line`, points; none where there is no room for it.
    pub fn along(
        &mut self,
        line: &Polyline,
        text: RichText,
        colour: Colour,
    ) -> Result<Option<Text>> {
        let width = text.width(SIZE)?;
        let lengths = lengths(line);
        let whole = lengths.last().copied().unwrap_or(0.0);
        if whole < LEAST * width {
            return Ok(None);
        }
        for place in PLACES {
            let [a, m, b] = [-0.5, 0.0, 0.5].map(|k| at(line, &lengths, place * whole + k * width));
            let [x, y] = [b[0] - a[0], b[1] - a[1]];
            let is_straight = x.hypot(y) >= STRAIGHT * width;
            let discs = [a, m, b].map(|centre| (centre, 0.3 * width + 0.5 * SIZE));
            if !is_straight || !discs.iter().all(|disc| self.is_free(*disc)) {
                continue;
            }
            self.discs.extend(discs);
            // Read from the left, or from below.
            let (x, y) = if x < 0.0 { (-x, -y) } else { (x, y) };
            let label = style::label(text, m, colour, SIZE);
            return Ok(Some(Text {
                angle: libm::atan2(-y, x),
                ..label
            }));
        }
        Ok(None)
    }

    fn is_free(&self, (centre, radius): ([f64; 2], f64)) -> bool {
        let margin = 0.6 * SIZE;
        let inside = (0..2).all(|i| (margin..=self.size[i] - margin).contains(&centre[i]));
        let apart = |disc: &([f64; 2], f64)| {
            (disc.0[0] - centre[0]).hypot(disc.0[1] - centre[1]) >= disc.1 + radius
        };
        inside && self.discs.iter().all(apart)
    }
}

/// The length of the line up to each of its points.
fn lengths(line: &Polyline) -> Vec<f64> {
    let mut sum = 0.0;
    let mut lengths = Vec::with_capacity(line.len());
    for (i, p) in line.iter().enumerate() {
        let before = line[i.saturating_sub(1)];
        sum += (p[0] - before[0]).hypot(p[1] - before[1]);
        lengths.push(sum);
    }
    lengths
}

/// The point of the line after this length.
fn at(line: &Polyline, lengths: &[f64], length: f64) -> [f64; 2] {
    let last = line.len() - 1;
    let i = lengths.partition_point(|l| *l < length).clamp(1, last);
    let step = lengths[i] - lengths[i - 1];
    let t = if step > 0.0 {
        (length - lengths[i - 1]) / step
    } else {
        0.0
    };
    [0, 1].map(|k| line[i - 1][k] + t.clamp(0.0, 1.0) * (line[i][k] - line[i - 1][k]))
}
