//! The legend: a colour bar with ct on its left and time on its right.

use tiny_skia::{Color, FillRule, Paint, PathBuilder, Pixmap, Rect, Transform};

use super::Values;
use super::picture::{LineStyle, strokes};
use super::range::Range;
use super::viridis::viridis;
use crate::error::Result;
use crate::figures::text::{self, AnchorX, RichText};
use crate::figures::ticks::{Unit, number, round_step};

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

/// The colour of text and ticks.
pub(super) fn ink() -> Color {
    Color::from_rgba8(32, 32, 36, 255)
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

    /// How far the legend reaches to the right.
    pub fn extent(&self) -> f64 {
        let em = (self.right - self.left) / 1.3;
        self.right + 0.5 * em + self.time.width
    }

    fn height_of(&self, ct: f64) -> f64 {
        self.bottom - self.range.part(ct) * (self.bottom - self.top)
    }

    /// Draws bar, lines and scales.
    pub fn draw(&self, pixmap: &mut Pixmap, em: f64, stroke: f64) -> Result<()> {
        self.bar(pixmap);
        self.arrows(pixmap, em);
        for line in self.range.lines() {
            let y = self.height_of(line as f64 * self.range.step);
            let look = LineStyle::new(&self.range, line, stroke);
            strokes(pixmap, &[vec![[self.left, y], [self.right, y]]], &look);
        }
        self.scale(pixmap, em, &self.distance, (self.left, -1.0), AnchorX::End)?;
        self.scale(pixmap, em, &self.time, (self.right, 1.0), AnchorX::Start)?;
        let gap = 0.5 * em;
        let heads = [
            (self.left - gap, AnchorX::End, &self.distance.head),
            (self.right + gap, AnchorX::Start, &self.time.head),
        ];
        for (x, anchor, label) in heads {
            text::draw(pixmap, [x, self.head], anchor, em, ink(), label)?;
        }
        Ok(())
    }

    /// The colours, one row of pixels at a time.
    fn bar(&self, pixmap: &mut Pixmap) {
        let rows = (self.bottom - self.top).max(1.0) as u32;
        for row in 0..rows {
            let part = 1.0 - (f64::from(row) + 0.5) / f64::from(rows);
            let y = self.top as f32 + row as f32;
            let (x, width) = (self.left as f32, (self.right - self.left) as f32);
            if let Some(rect) = Rect::from_xywh(x, y, width, 1.0) {
                pixmap.fill_rect(rect, &paint(viridis(part)), Transform::identity(), None);
            }
        }
    }

    /// Points at the ends beyond which there is more.
    fn arrows(&self, pixmap: &mut Pixmap, em: f64) {
        let ends = [
            (self.range.more_above, self.top, -1.0, 1.0),
            (self.range.more_below, self.bottom, 1.0, 0.0),
        ];
        for (_, y, direction, part) in ends.into_iter().filter(|end| end.0) {
            let mut path = PathBuilder::new();
            path.move_to(self.left as f32, y as f32);
            path.line_to(self.right as f32, y as f32);
            let tip = y + direction * 0.6 * em;
            path.line_to(((self.left + self.right) / 2.0) as f32, tip as f32);
            path.close();
            if let Some(path) = path.finish() {
                let identity = Transform::identity();
                pixmap.fill_path(
                    &path,
                    &paint(viridis(part)),
                    FillRule::Winding,
                    identity,
                    None,
                );
            }
        }
    }

    /// The ticks and labels of one side of the bar.
    fn scale(
        &self,
        pixmap: &mut Pixmap,
        em: f64,
        scale: &Scale,
        (x, outwards): (f64, f64),
        anchor: AnchorX,
    ) -> Result<()> {
        let look = LineStyle {
            colour: ink(),
            width: (em / 16.0).max(1.0),
        };
        for (ct, label) in &scale.ticks {
            let y = self.height_of(*ct);
            strokes(
                pixmap,
                &[vec![[x, y], [x + 0.25 * em * outwards, y]]],
                &look,
            );
            let at = [x + 0.5 * em * outwards, y + 0.32 * em];
            text::draw(pixmap, at, anchor, em, ink(), label)?;
        }
        Ok(())
    }
}

/// A positive number in three significant digits.
fn three_digits(value: f64) -> String {
    let rounded: f64 = format!("{value:.2e}").parse().unwrap_or(value);
    match (1e-3..1e5).contains(&rounded) {
        true => rounded.to_string(),
        false => format!("{rounded:e}").replace('-', "\u{2212}"),
    }
}

fn paint(rgb: [f64; 3]) -> Paint<'static> {
    let mut paint = Paint::default();
    let [r, g, b] = rgb.map(|c| (255.0 * c + 0.5) as u8);
    paint.set_color_rgba8(r, g, b, 255);
    paint
}

impl Scale {
    /// ct at the lines themselves, as many as there is room for; `room` in em.
    fn distance(range: &Range, room: f64, em: f64) -> Result<Scale> {
        let unit = Unit::metres(range.low.abs().max(range.high.abs()));
        let every = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000].into_iter();
        let fits = |every: &i64| range.line_count() / *every as f64 <= room / 1.7;
        let every = every.clone().find(fits).unwrap_or(1000);
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
        let every = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000].into_iter();
        let fits = |every: &i64| range.line_count() / *every as f64 <= room / 1.7;
        let every = every.clone().find(fits).unwrap_or(1000);
        let chosen = range.lines().filter(|line| line % every == 0);
        let ticks = chosen.map(|line| {
            let logarithm = line as f64 * range.step;
            Ok((
                logarithm,
                RichText::plain(&three_digits(libm::pow(10.0, logarithm)))?,
            ))
        });
        let head = RichText::plain("luminance")?;
        Scale::new(head, ticks.collect::<Result<_>>()?, em)
    }

    /// Round times.
    fn time(range: &Range, room: f64, em: f64, c: f64) -> Result<Scale> {
        let (low, high) = (range.low / c, range.high / c);
        let unit = Unit::prefixed("s", low.abs().max(high.abs()));
        let (low, high) = (unit.count(low), unit.count(high));
        let step = round_step((high - low) / (room / 2.5).min(9.0));
        let base = unit.count(1.0 / c);
        let (first, last) = ((low / step).ceil() as i64, (high / step).floor() as i64);
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
