//! A study as a drawing: time against error of geometry, and of radiance, both logarithmic.

use super::entry::{Entry, Family, Study};
use crate::error::Result;
use crate::figures::drawing::{
    Anchor, AnchorX, AnchorY, Colour, Drawing, Fill, Item, Path, Stroke, Text,
};
use crate::text::{Rect, RichText};

const WIDTH: f64 = 560.0;
const HEIGHT: f64 = 300.0;
const TYPE: f64 = 8.5;
/// Errors below this count as none, pixels.
const NO_ERROR: f64 = 1e-6;

/// The anchor of labels.
const LINE: Anchor = anchor(AnchorX::Start, AnchorY::Baseline);
const ABOVE: Anchor = anchor(AnchorX::Middle, AnchorY::Baseline);
const BELOW: Anchor = anchor(AnchorX::Middle, AnchorY::Top);
const LEFT: Anchor = anchor(AnchorX::End, AnchorY::Middle);
const RIGHT: Anchor = anchor(AnchorX::Start, AnchorY::Middle);

const fn anchor(x: AnchorX, y: AnchorY) -> Anchor {
    Anchor { x, y }
}

/// The drawing of `study`.
///
/// # Errors
/// None in practice: all its text can be set.
pub fn draw(study: &Study) -> Result<Drawing> {
    let fewest = study.entries.iter().map(|e| e.samples).min().unwrap_or(1);
    let geometry = Panel {
        rect: panel(0),
        title: format!("geometry, {fewest} per pixel"),
        error: "largest error of a point, pixels",
        points: points(study, |e| {
            (e.samples == fewest).then(|| (e.geometry.pixels.max.max(NO_ERROR), e.front.geometry))
        }),
    };
    let radiance = Panel {
        rect: panel(1),
        title: format!("radiance, against {} per pixel", study.reference.samples),
        error: "relRMSE",
        points: points(study, |e| Some((e.radiance?.relrmse, e.front.radiance))),
    };
    let mut items = Vec::new();
    // A name may contain characters that the font does not have.
    let name = match RichText::plain(&study.scene) {
        Ok(_) => study.scene.as_str(),
        Err(_) => "a scene",
    };
    let heading = format!(
        "{name}, {} × {} pixels, {} triangles, threads: {}",
        study.size[0], study.size[1], study.triangles, study.threads
    );
    items.push(text(&heading, [14.0, 16.0], LINE)?);
    for panel in [geometry, radiance] {
        panel.draw(&mut items)?;
    }
    legend(study, &mut items)?;
    Ok(Drawing {
        width: WIDTH,
        height: HEIGHT,
        title: format!("Run time against error: {}", study.scene),
        origin: Vec::new(),
        background: Colour::WHITE,
        items,
    })
}

/// The position of the left (0) or the right (1) panel.
fn panel(index: usize) -> Rect {
    let left = 46.0 + 274.0 * index as f64;
    Rect {
        min: [left, 40.0],
        max: [left + 226.0, 222.0],
    }
}

/// A measured picture.
struct Point {
    time: f64,
    error: f64,
    family: Family,
    on_front: bool,
}

/// The entries of `study` that have an error, in order of each method's levels and samples.
fn points(study: &Study, error: impl Fn(&Entry) -> Option<(f64, bool)>) -> Vec<Point> {
    let point = |entry: &Entry| {
        let (error, on_front) = error(entry)?;
        let time = entry.timing.as_ref()?.median;
        let point = Point {
            time,
            error,
            family: entry.family,
            on_front,
        };
        (time.is_finite() && error.is_finite() && error > 0.0).then_some(point)
    };
    study.entries.iter().filter_map(point).collect()
}

/// Axes, and their contents.
struct Panel {
    rect: Rect,
    title: String,
    error: &'static str,
    points: Vec<Point>,
}

impl Panel {
    fn draw(&self, items: &mut Vec<Item>) -> Result<()> {
        let Rect { min, max } = self.rect;
        let middle = 0.5 * (min[0] + max[0]);
        items.push(text(&self.title, [middle, min[1] - 6.0], ABOVE)?);
        let x = Axis::around(self.points.iter().map(|p| p.time), [min[0], max[0]]);
        let y = Axis::around(self.points.iter().map(|p| p.error), [max[1], min[1]]);
        self.grid(&x, &y, items)?;
        let place = |p: &Point| [x.place(p.time), y.place(p.error)];
        for family in Family::ALL {
            let of = self.points.iter().filter(|p| p.family == family);
            // A line joins points that differ only in the level, with equal samples.
            let line: Vec<_> = of.clone().map(place).collect();
            if line.len() > 1 && (family.is_trace() || self.joins()) {
                let stroke = Stroke::new(colour(family), 0.8);
                items.push(Item::stroked(Path::polyline(&line), stroke));
            }
            of.for_each(|p| items.push(mark(p.family, place(p), p.on_front)));
        }
        items.push(Item::stroked(
            Path::rect(self.rect),
            Stroke::new(Colour::BLACK, 0.7),
        ));
        Ok(())
    }

    /// Whether the levels of one method follow each other.
    fn joins(&self) -> bool {
        self.error.ends_with("pixels")
    }

    /// Lines and numbers at powers of ten, and the axis labels.
    fn grid(&self, x: &Axis, y: &Axis, items: &mut Vec<Item>) -> Result<()> {
        let Rect { min, max } = self.rect;
        let grey = Stroke::new(Colour::rgb(225, 225, 225), 0.5);
        for decade in x.decades() {
            let at = x.place(power(decade));
            items.push(Item::stroked(
                Path::line([at, min[1]], [at, max[1]]),
                grey.clone(),
            ));
            items.push(text(&seconds(decade), [at, max[1] + 5.0], BELOW)?);
        }
        for decade in y.decades() {
            let at = y.place(power(decade));
            items.push(Item::stroked(
                Path::line([min[0], at], [max[0], at]),
                grey.clone(),
            ));
            let label = format!("10^{{{decade}}}");
            items.push(set(RichText::parse(&label)?, [min[0] - 4.0, at], LEFT, 0.0));
        }
        let middle = [0.5 * (min[0] + max[0]), 0.5 * (min[1] + max[1])];
        let under = [middle[0], max[1] + 16.0];
        items.push(text("time of one picture", under, BELOW)?);
        let beside = [min[0] - 30.0, middle[1]];
        let quarter = std::f64::consts::FRAC_PI_2;
        items.push(set(RichText::plain(self.error)?, beside, ABOVE, quarter));
        Ok(())
    }
}

/// A logarithmic axis of whole decades.
struct Axis {
    /// Exponents of its ends.
    decades: [i32; 2],
    ends: [f64; 2],
}

impl Axis {
    fn around(values: impl Iterator<Item = f64>, ends: [f64; 2]) -> Self {
        // f64 reaches 10^±308.
        let exponents = values.map(|v| libm::log10(v).clamp(-300.0, 300.0));
        let span = exponents.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], e| {
            [a.min(e), b.max(e)]
        });
        let [first, last] = match span[0] <= span[1] {
            true => [
                (span[0] - 0.05).floor() as i32,
                (span[1] + 0.05).ceil() as i32,
            ],
            false => [-1, 0],
        };
        Axis {
            decades: [first, last.max(first + 1)],
            ends,
        }
    }

    fn place(&self, value: f64) -> f64 {
        let [first, last] = self.decades.map(f64::from);
        let part = (libm::log10(value) - first) / (last - first);
        self.ends[0] + (self.ends[1] - self.ends[0]) * part
    }

    /// The exponents with a line: all, or every second, third …
    fn decades(&self) -> impl Iterator<Item = i32> {
        let [first, last] = self.decades;
        let step = ((last - first) as usize).div_ceil(7).max(1);
        (first..=last).step_by(step)
    }
}

fn power(exponent: i32) -> f64 {
    libm::pow(10.0, f64::from(exponent))
}

/// 10ⁿ seconds in words.
fn seconds(exponent: i32) -> String {
    let (group, rest) = (exponent.div_euclid(3), exponent.rem_euclid(3));
    let number = ["1", "10", "100"][rest as usize];
    match group {
        0 => format!("{number} s"),
        -1 => format!("{number} ms"),
        -2 => format!("{number} µs"),
        _ => format!("1e{exponent} s"),
    }
}

fn legend(study: &Study, items: &mut Vec<Item>) -> Result<()> {
    let has = |family: &&Family| study.entries.iter().any(|e| e.family == **family);
    for (k, family) in Family::ALL.iter().filter(has).enumerate() {
        let at = [54.0 + 178.0 * (k % 3) as f64, 259.0 + 13.0 * (k / 3) as f64];
        items.push(mark(*family, at, true));
        items.push(text(family.name(), [at[0] + 8.0, at[1]], RIGHT)?);
    }
    let note = format!(
        "filled: no other method is both faster and more accurate; errors below {NO_ERROR:e} pixels are drawn there"
    );
    items.push(text(&note, [54.0, 286.0], RIGHT)?);
    Ok(())
}

fn colour(family: Family) -> Colour {
    let [r, g, b] = match family {
        Family::Trace => [0, 90, 170],
        Family::FastTrace => [90, 180, 230],
        Family::NoTessellation => [110, 110, 110],
        Family::Uniform => [213, 94, 0],
        Family::Adaptive => [0, 140, 100],
        Family::Cube => [170, 70, 150],
        Family::Panorama => [190, 150, 0],
    };
    Colour::rgb(r, g, b)
}

/// A mark in the family's shape: filled on the front.
fn mark(family: Family, [x, y]: [f64; 2], filled: bool) -> Item {
    let regular = |corners: usize, turn: f64| {
        let corner = |k| {
            let (sin, cos) = libm::sincos(turn + std::f64::consts::TAU * k as f64 / corners as f64);
            [x + 3.4 * sin, y - 3.4 * cos]
        };
        Path::polygon(&(0..corners).map(corner).collect::<Vec<_>>())
    };
    let path = match family {
        Family::Trace => Path::circle([x, y], 2.8),
        Family::FastTrace => regular(6, 0.0),
        Family::NoTessellation => regular(3, std::f64::consts::PI),
        Family::Uniform => regular(4, std::f64::consts::FRAC_PI_4),
        Family::Adaptive => regular(3, 0.0),
        Family::Cube => regular(4, 0.0),
        Family::Panorama => regular(5, 0.0),
    };
    let inside = if filled {
        colour(family)
    } else {
        Colour::WHITE
    };
    Item::Path {
        path,
        fill: Some(Fill::solid(inside)),
        stroke: Some(Stroke::new(colour(family), 0.9)),
    }
}

fn text(words: &str, at: [f64; 2], anchor: Anchor) -> Result<Item> {
    Ok(set(RichText::plain(words)?, at, anchor, 0.0))
}

fn set(words: RichText, at: [f64; 2], anchor: Anchor, angle: f64) -> Item {
    Item::Text(Text {
        anchor,
        angle,
        ..Text::new(words, at, TYPE)
    })
}
