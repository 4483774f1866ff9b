//! The legend: a colour bar with ct on its left and time on its right.

use super::Values;
use super::picture::stroke;
use super::range::Range;
use super::viridis::viridis_srgb;
use crate::error::Result;
use crate::figures::drawing::{Anchor, AnchorX, AnchorY, Colour, Item, Path, Stroke, Text};
use crate::figures::ticks::{Unit, number, round_step};
use crate::io::image::RgbImage;
use crate::text::{Rect, RichText};

/// The colour of text and ticks.
pub(super) const INK: Colour = Colour::rgb(32, 32, 36);

/// The colour bar and its two scales.
pub(super) struct Legend {
    pub range: Range,
    left: f64,
    right: f64,
    /// The baseline of the heads.
    head: f64,
    /// Where `range.high` is.
    top: f64,
    /// Where `range.low` is.
    pub bottom: f64,
    distance: Scale,
    time: Scale,
}

/// Labelled values on one side of the bar.
struct Scale {
    head: RichText,
    /// ct in metres, and its label.
    ticks: Vec<(f64, RichText)>,
    /// The widest of the labels and half of the head, pixels.
    width: f64,
}

impl Legend {
    /// Finds a place for everything, with the upper left corner at `(x, y)`.
    pub fn lay_out(
        range: Range,
        [x, y]: [f64; 2],
        height: f64,
        em: f64,
        values: Values,
    ) -> Result<Legend> {
        let room = height / em;
        let (distance, time) = match values {
            Values::Times(c) => (
                Scale::distance(&range, room, em)?,
                Scale::time(&range, room, em, c)?,
            ),
            Values::Luminances => (
                Scale::luminance(&range, room, em)?,
                Scale::new(RichText::plain("")?, Vec::new(), em)?,
            ),
        };
        // Edges on whole pixels keep the bar sharp. An arrow needs 0.7 em beyond its end.
        let left = (x + distance.width + 0.5 * em).round();
        let room = |more: bool| if more { 0.7 * em } else { 0.2 * em };
        Ok(Legend {
            range,
            left,
            right: (left + 1.3 * em).round(),
            head: y - 0.65 * em,
            top: (y + room(range.more_above)).round(),
            bottom: (y + height - room(range.more_below)).round(),
            distance,
            time,
        })
    }

    /// The extent of the legend to the right.
    pub fn extent(&self) -> f64 {
        let em = (self.right - self.left) / 1.3;
        self.right + 0.5 * em + self.time.width
    }

    fn height_of(&self, ct: f64) -> f64 {
        self.bottom - self.range.part(ct) * (self.bottom - self.top)
    }

    /// Bar, lines and scales.
    pub fn items(&self, em: f64, width: f64) -> Vec<Item> {
        let mut items = vec![self.bar()];
        items.extend(self.arrows(em));
        items.extend(self.range.lines().map(|line| {
            let y = self.height_of(line as f64 * self.range.step);
            let across = Path::line([self.left, y], [self.right, y]);
            Item::stroked(across, stroke(&self.range, line, width))
        }));
        items.extend(self.scale(em, &self.distance, (self.left, -1.0), AnchorX::End));
        items.extend(self.scale(em, &self.time, (self.right, 1.0), AnchorX::Start));
        items
    }

    /// The colours, one row of pixels at a time.
    fn bar(&self) -> Item {
        let rows = (self.bottom - self.top).max(1.0) as u32;
        // The middle of a row; the latest is at the top.
        let part = |row: u32| 1.0 - (f64::from(row) + 0.5) / f64::from(rows);
        Item::Image {
            image: RgbImage {
                width: 1,
                height: rows,
                rgb: (0..rows).flat_map(|row| viridis_srgb(part(row))).collect(),
            },
            rect: Rect {
                min: [self.left, self.top],
                max: [self.right, self.top + f64::from(rows)],
            },
        }
    }

    /// Arrowheads at the ends beyond which there is more.
    fn arrows(&self, em: f64) -> impl Iterator<Item = Item> {
        let ends = [
            (self.range.more_above, self.top, -1.0, 1.0),
            (self.range.more_below, self.bottom, 1.0, 0.0),
        ];
        let ends = ends.into_iter().filter(|end| end.0);
        ends.map(move |(_, y, direction, part)| {
            let tip = [(self.left + self.right) / 2.0, y + direction * 0.6 * em];
            let [r, g, b] = viridis_srgb(part);
            let path = Path::polygon(&[[self.left, y], [self.right, y], tip]);
            Item::filled(path, Colour::rgb(r, g, b))
        })
    }

    /// Ticks, labels and head of one side of the bar.
    fn scale(&self, em: f64, scale: &Scale, (x, out): (f64, f64), anchor: AnchorX) -> Vec<Item> {
        let gap = x + 0.5 * em * out;
        let text = |label: &RichText, y: f64| {
            Item::Text(Text {
                colour: INK,
                anchor: Anchor {
                    x: anchor,
                    y: AnchorY::Baseline,
                },
                ..Text::new(label.clone(), [gap, y], em)
            })
        };
        let ticks = scale.ticks.iter().flat_map(|(ct, label)| {
            let y = self.height_of(*ct);
            let tick = Path::line([x, y], [x + 0.25 * em * out, y]);
            let stroke = Stroke::new(INK, (em / 16.0).max(1.0));
            // A third of an em down puts the middle of digits at the tick.
            [Item::stroked(tick, stroke), text(label, y + 0.32 * em)]
        });
        ticks.chain([text(&scale.head, self.head)]).collect()
    }
}

/// The interval of labelled lines, in `room` em.
fn every(range: &Range, room: f64) -> i64 {
    let steps = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000];
    // Labels whose baselines are 1.7 em apart have air between them.
    let fits = |every: &i64| range.line_count() / *every as f64 <= room / 1.7;
    steps.into_iter().find(fits).unwrap_or(1000)
}

/// Labels of the powers of ten of `logarithms`, which are `step` apart: in three significant digits, or as many as keep the error of a label
/// below a twentieth of the way to the next lower one, 1 − 10⁻ˢᵗᵉᵖ of its value.
fn labels(logarithms: impl Iterator<Item = f64>, step: f64) -> impl Iterator<Item = String> {
    let apart = -libm::expm1(-step * std::f64::consts::LN_10);
    let digits = (2.0 - libm::log10(apart)).ceil().clamp(3.0, 17.0) as usize;
    logarithms.map(move |logarithm| rounded(libm::pow(10.0, logarithm), digits))
}

/// A positive number rounded to `digits` significant digits.
fn rounded(value: f64, digits: usize) -> String {
    let rounded: f64 = format!("{value:.*e}", digits - 1).parse().unwrap_or(value);
    match (1e-3..1e5).contains(&rounded) {
        true => rounded.to_string(),
        false => format!("{rounded:e}").replace('-', "\u{2212}"),
    }
}

impl Scale {
    /// ct at the lines themselves, as many as there is room for; `room` in em.
    fn distance(range: &Range, room: f64, em: f64) -> Result<Scale> {
        let unit = Unit::metres(range.low.abs().max(range.high.abs()));
        let every = every(range, room);
        // The interval at which labels do not touch.
        let chosen = range.lines().filter(|line| line % every == 0);
        let step = unit.count(range.step * every as f64);
        let ticks = chosen.map(|line| {
            let ct = line as f64 * range.step;
            Ok((ct, RichText::plain(&number(unit.count(ct), step))?))
        });
        let head = RichText::parse(&format!("*ct* ({})", unit.name))?;
        Scale::new(head, ticks.collect::<Result<_>>()?, em)
    }

    /// Luminances at the lines, whose values are their logarithms.
    fn luminance(range: &Range, room: f64, em: f64) -> Result<Scale> {
        let every = every(range, room);
        let chosen = range.lines().filter(|line| line % every == 0);
        let logarithms: Vec<f64> = chosen.map(|line| line as f64 * range.step).collect();
        let labels = labels(logarithms.iter().copied(), every as f64 * range.step);
        let ticks = logarithms.iter().zip(labels);
        let ticks = ticks.map(|(logarithm, label)| Ok((*logarithm, RichText::plain(&label)?)));
        let head = RichText::plain("luminance")?;
        Scale::new(head, ticks.collect::<Result<_>>()?, em)
    }

    /// Round times.
    fn time(range: &Range, room: f64, em: f64, c: f64) -> Result<Scale> {
        let (low, high) = (range.low / c, range.high / c);
        let unit = Unit::prefixed("s", low.abs().max(high.abs()));
        let (low, high) = (unit.count(low), unit.count(high));
        // Times are farther apart than the labels of the lines, with at most nine steps.
        let step = round_step((high - low) / (room / 2.5).min(9.0));
        let base = unit.count(1.0 / c);
        let (first, last) = ((low / step).ceil() as i64, (high / step).floor() as i64);
        // Ten at most; the bound is for ranges that rounding spoils.
        let ticks = (first..=last).take(50).map(|i| {
            let t = i as f64 * step;
            Ok((t / base, RichText::plain(&number(t, step))?))
        });
        let head = RichText::parse(&format!("*t* ({})", unit.name))?;
        Scale::new(head, ticks.collect::<Result<_>>()?, em)
    }

    fn new(head: RichText, ticks: Vec<(f64, RichText)>, em: f64) -> Result<Scale> {
        let mut width = head.width(em)?;
        for (_, label) in &ticks {
            width = width.max(label.width(em)?);
        }
        Ok(Scale { head, ticks, width })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_of_luminances_differ_however_close_they_are() {
        let of = |lines: [i32; 4], step: f64| {
            let logarithms = lines.into_iter().map(|line| f64::from(line) * step);
            labels(logarithms, step).collect::<Vec<_>>()
        };
        assert_eq!(of([-1, 0, 1, 2], 1.0), ["0.1", "1", "10", "100"]);
        assert_eq!(of([0, 1, 2, 3], 0.1), ["1", "1.26", "1.58", "2"]);
        // 10^±0.0002 = 1 ± 4.6·10⁻⁴.
        let close = of([-2, -1, 0, 1], 2e-4);
        assert_eq!(close, ["0.999079", "0.99954", "1", "1.00046"]);
        assert_eq!(of([0, 1, 2, 3], 1e-9)[1], "1.0000000023");
    }
}
