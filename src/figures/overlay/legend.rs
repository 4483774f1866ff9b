//! The legend: line samples with text, in rows below the picture.

use glam::DVec3;

use super::style::{APPARENT, HEAVY, INSTANTANEOUS, ISOCHRONE, POINTER, symbol};
use super::{Facts, Overlay, Pointer, Target};
use crate::camera::Projection;
use crate::error::Result;
use crate::figures::diagram::number;
use crate::figures::drawing::{Anchor, Colour, Item, Path, Text};
use crate::figures::ticks::Unit;
use crate::text::RichText;

/// Points per em.
const SIZE: f64 = 8.0;
/// From row to row.
const ROW: f64 = 14.0;
/// Around the legend.
const MARGIN: f64 = 9.0;
/// Of a line's sample.
const SAMPLE: f64 = 22.0;
/// Between a sample and its words.
const GAP: f64 = 5.0;
/// Between entries.
const SPACE: f64 = 16.0;
/// The greatest part of the picture's width that the angle to scale takes.
const BAR: f64 = 0.22;
/// Angles to scale, degrees.
const ANGLES: [f64; 14] = [
    90.0, 60.0, 45.0, 30.0, 20.0, 10.0, 5.0, 2.0, 1.0, 0.5, 0.2, 0.1, 0.05, 0.01,
];

/// The content below the picture.
pub(super) struct Legend {
    pub items: Vec<Item>,
    /// Points.
    pub height: f64,
}

/// A sample and its words.
struct Entry {
    sample: Sample,
    text: RichText,
}

/// The sample before the words.
enum Sample {
    Apparent,
    Instantaneous,
    Isochrones,
    Pointer(Target),
    /// An angle, points long.
    Bar(f64),
    Nothing,
}

/// Lays the legend out from `top` down on a page `width` points wide, of a picture of `scale` points per
/// pixel.
pub(super) fn lay_out(
    overlay: &Overlay,
    facts: &Facts,
    [width, top]: [f64; 2],
    scale: f64,
) -> Result<Legend> {
    let entries = entries(overlay, facts, scale)?;
    let mut items = Vec::new();
    let [mut x, mut y] = [MARGIN, top + MARGIN + 0.5 * SIZE];
    for entry in entries {
        let length = entry.length()?;
        if x > MARGIN && x + length > width - MARGIN {
            (x, y) = (MARGIN, y + ROW);
        }
        items.extend(entry.draw([x, y]));
        x += length + SPACE;
    }
    let height = y + 0.5 * SIZE + MARGIN - top;
    Ok(Legend { items, height })
}

/// The entries of the legend: only for what is drawn.
fn entries(overlay: &Overlay, facts: &Facts, scale: f64) -> Result<Vec<Entry>> {
    let mut entries = Vec::new();
    let mut push = |sample, text| entries.push(Entry { sample, text });
    if !overlay.apparent.is_empty() {
        push(Sample::Apparent, RichText::parse("where objects are seen")?);
    }
    if !overlay.instantaneous.is_empty() {
        let text = RichText::parse("where they are at the world time of the shot")?;
        push(Sample::Instantaneous, text);
    }
    if let Some(isochrones) = &overlay.isochrones {
        let step = span(isochrones.step, facts.speed_of_light);
        let text = RichText::parse(&format!("light left at *ct*: every {step}"))?;
        push(Sample::Isochrones, text);
    }
    if let Some(pointer) = &overlay.pointer {
        push(Sample::Pointer(pointer.target), speed_words(pointer)?);
    }
    let (degrees, length) = angle(overlay.size, facts);
    let text = RichText::parse(&format!("{degrees}° at the centre"))?;
    push(Sample::Bar(length * scale), text);
    let time = span(facts.camera_time, facts.speed_of_light);
    push(
        Sample::Nothing,
        RichText::parse(&format!("camera time *τ* = {time}"))?,
    );
    Ok(entries)
}

/// A time as ct and in seconds: "0.5 m (1.668 ns)".
fn span(metres: f64, c: f64) -> String {
    let seconds = metres / c;
    let (length, time) = (
        Unit::metres(metres.abs()),
        Unit::prefixed("s", seconds.abs()),
    );
    let (ct, t) = (number(length.count(metres)), number(time.count(seconds)));
    format!("{ct} {} ({t} {})", length.name, time.name)
}

/// A round angle, degrees, and its length in pixels about the middle of the picture: 2 tan(θ/2) · w/(2t), or that of a projection that
/// bends straight lines.
fn angle([width, _]: [u32; 2], facts: &Facts) -> (f64, f64) {
    let width = f64::from(width);
    let length = |degrees: &f64| match &facts.curved {
        None => libm::tan(0.5 * degrees.to_radians()) * width / facts.half_width,
        Some(film) => {
            let (sin, cos) = libm::sincos(0.5 * degrees.to_radians());
            let edge = film.film_point(DVec3::new(sin, 0.0, cos));
            edge.map_or(0.0, |[x, _]| 2.0 * x - width)
        }
    };
    let fits = |degrees: &f64| length(degrees) <= BAR * width;
    let degrees = ANGLES
        .into_iter()
        .find(fits)
        .unwrap_or(ANGLES[ANGLES.len() - 1]);
    (degrees, length(&degrees))
}

impl Entry {
    fn length(&self) -> Result<f64> {
        Ok(self.sample.length() + self.text.width(SIZE)?)
    }

    fn draw(&self, [x, y]: [f64; 2]) -> Vec<Item> {
        let mut items = self.sample.draw([x, y]);
        items.push(Item::Text(Text {
            colour: Colour::rgb(32, 32, 36),
            anchor: Anchor::START,
            ..Text::new(self.text.clone(), [x + self.sample.length(), y], SIZE)
        }));
        items
    }
}

impl Sample {
    /// With the gap after it.
    fn length(&self) -> f64 {
        match self {
            Sample::Bar(length) => length + GAP,
            Sample::Pointer(Target::Ahead(_) | Target::Behind(_)) => 12.0 + GAP,
            Sample::Pointer(Target::Outside(_)) => 26.0 + GAP,
            Sample::Nothing => 0.0,
            Sample::Apparent | Sample::Instantaneous | Sample::Isochrones => SAMPLE + GAP,
        }
    }

    fn draw(&self, [x, y]: [f64; 2]) -> Vec<Item> {
        let line = |dy: f64| Path::line([x, y + dy], [x + SAMPLE, y + dy]);
        match *self {
            Sample::Apparent => APPARENT.draw(line(0.0)).into(),
            Sample::Instantaneous => INSTANTANEOUS.draw(line(0.0)).into(),
            Sample::Isochrones => {
                let light = line(-2.6).and(line(2.6));
                let mut items: Vec<Item> = ISOCHRONE.draw(light).into();
                items.extend(HEAVY.draw(line(0.0)));
                items
            }
            Sample::Pointer(Target::Outside(_)) => {
                // The shaft of 24 points, and its border.
                symbol(Target::Outside([1.0, 0.0]), [x + 25.0, y])
            }
            // RADIUS, and the border of the ring.
            Sample::Pointer(target) => symbol(target, [x + 6.0, y]),
            Sample::Bar(length) => {
                let tick = |at: f64| Path::line([at, y - 2.5], [at, y + 2.5]);
                let bar = Path::line([x, y], [x + length, y]);
                let bar = bar.and(tick(x)).and(tick(x + length));
                POINTER.draw(bar).into()
            }
            Sample::Nothing => Vec::new(),
        }
    }
}

/// The speed in words of the legend.
fn speed_words(pointer: &Pointer) -> Result<RichText> {
    let way = match pointer.target {
        Target::Ahead(_) => "towards what is there",
        Target::Behind(_) => "away from what is there",
        Target::Outside(_) => "that way",
    };
    RichText::parse(&format!("the camera moves {way}"))
}
