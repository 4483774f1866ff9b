//! Checks that every format can represent a drawing.

use super::hatch::MOST_LINES;
use super::{Drawing, Fill, Hatch, Item, Path, Stroke, Text};
use crate::error::{Error, Result};
use crate::io::image::RgbImage;
use crate::text::{Rect, Segment};

/// The longest side of a page in points that PDF viewers open.
pub(in crate::figures) const LONGEST_SIDE: f64 = 14_400.0;
/// The greatest coordinate and length, points.
const FARTHEST: f64 = 1e5;
/// The most dashes along one path.
const MOST_DASHES: f64 = 1e5;

/// A drawing of finite numbers, sound paths, and a bounded number of dashes and hatch lines.
pub(super) struct Checked<'a>(pub &'a Drawing);

/// The error, and what would be right.
type Verdict = Result<(), (String, &'static str)>;

impl<'a> Checked<'a> {
    /// # Errors
    /// The first fault, with the index of its item (of clip and item, within a clip).
    pub fn new(drawing: &'a Drawing) -> Result<Checked<'a>> {
        for (side, length) in [("width", drawing.width), ("height", drawing.height)] {
            if !(length > 0.0 && length <= LONGEST_SIDE) {
                let what = format!("the page's {side} is {length} points");
                let help = format!("more than 0 and at most {LONGEST_SIDE} points (200 inches)");
                return Err(Error::invalid("drawing", "", what, help));
            }
        }
        items(&drawing.items, "")?;
        Ok(Checked(drawing))
    }
}

fn items(list: &[Item], above: &str) -> Result<()> {
    for (index, item) in list.iter().enumerate() {
        let verdict = match item {
            Item::Path { path, fill, stroke } => path_item(path, fill, stroke),
            Item::Text(text) => text_item(text),
            Item::Image { image, rect } => picture(image, rect),
            Item::Clip { path, .. } => contours(path),
        };
        verdict.map_err(|(what, help)| {
            Error::invalid("drawing", format!("{above}item {index}"), what, help)
        })?;
        if let Item::Clip { items: inner, .. } = item {
            items(inner, &format!("{above}item {index}, "))?;
        }
    }
    Ok(())
}

fn path_item(path: &Path, fill: &Option<Fill>, stroke: &Option<Stroke>) -> Verdict {
    contours(path)?;
    if let Some(Hatch {
        angle,
        spacing,
        width,
    }) = fill.and_then(|fill| fill.hatch)
    {
        number("the hatch's angle", angle)?;
        length("the hatch's spacing", spacing)?;
        length("the hatch's width", width)?;
        let size = path.bounds().map_or([0.0; 2], |area| area.size());
        // Only visible parts are hatched: less than twice the longest side.
        if size[0].hypot(size[1]).min(2.0 * LONGEST_SIDE) / spacing > MOST_LINES {
            let what =
                format!("a hatch of spacing {spacing} has more than {MOST_LINES} lines here");
            return Err((what, "a wider spacing, or a smaller area"));
        }
    }
    stroke.as_ref().map_or(Ok(()), |stroke| line(path, stroke))
}

fn line(path: &Path, stroke: &Stroke) -> Verdict {
    length("the stroke's width", stroke.width)?;
    dashes(path, &stroke.dash)?;
    for arrow in [stroke.start, stroke.end].into_iter().flatten() {
        length("the arrowhead's length", arrow.length)?;
        length("the arrowhead's width", arrow.width)?;
        pointable(path)?;
    }
    Ok(())
}

/// A path that can have arrowheads.
fn pointable(path: &Path) -> Verdict {
    let one = |s: &&Segment| matches!(s, Segment::Move(_) | Segment::Close);
    if path.0.iter().filter(one).count() != 1 {
        let what = "arrowheads on a path that is closed or not in one piece".to_owned();
        return Err((what, "one open contour"));
    }
    let mut points = points(path);
    let first = points.next();
    if points.all(|point| Some(point) == first) {
        let what = "an arrow from a point to itself has no direction".to_owned();
        return Err((what, "a path with some length, or no arrowhead"));
    }
    Ok(())
}

fn dashes(path: &Path, dash: &[f64]) -> Verdict {
    if dash.is_empty() {
        return Ok(());
    }
    for part in dash {
        number("a dash", *part)?;
    }
    let period: f64 = dash.iter().sum();
    if dash.iter().any(|part| *part < 0.0) || period <= 0.0 {
        let what = format!("the dashes and gaps {dash:?}");
        return Err((what, "lengths of 0 or more, one of them more than 0"));
    }
    if length_bound(path) / period > MOST_DASHES {
        let what = format!("dashes and gaps of {period} points are more than {MOST_DASHES} here");
        return Err((what, "longer dashes, or a shorter path"));
    }
    Ok(())
}

/// The length of the control polygon, at least that of the path.
fn length_bound(path: &Path) -> f64 {
    let points: Vec<[f64; 2]> = points(path).collect();
    let steps = points.windows(2);
    steps
        .map(|w| (w[1][0] - w[0][0]).hypot(w[1][1] - w[0][1]))
        .sum()
}

fn text_item(text: &Text) -> Verdict {
    coordinate(text.at)?;
    length("the text's size", text.size)?;
    number("the text's angle", text.angle)?;
    match text.halo {
        Some((_, width)) => number("the halo's width", width),
        None => Ok(()),
    }
}

/// A picture with as many bytes as pixels, on a rectangle with an inside.
fn picture(image: &RgbImage, rect: &Rect) -> Verdict {
    let pixels = u64::from(image.width) * u64::from(image.height);
    // Half of the largest PDF integer, in either direction.
    let fits = image.width.max(image.height) <= 1 << 30;
    if pixels == 0 || !fits || pixels.checked_mul(3) != Some(image.rgb.len() as u64) {
        let (width, height) = (image.width, image.height);
        let what = format!(
            "{} bytes for a picture of {width} × {height} pixels",
            image.rgb.len()
        );
        return Err((what, "at least one pixel, and 3 bytes for each"));
    }
    coordinate(rect.min)?;
    coordinate(rect.max)?;
    let [width, height] = rect.size();
    length("the picture's width", width)?;
    length("the picture's height", height)
}

/// Finite points, and every contour begun by a move.
fn contours(path: &Path) -> Verdict {
    let mut open = false;
    for segment in &path.0 {
        match segment {
            Segment::Move(_) => open = true,
            _ if !open => {
                let what = "a contour of the path does not begin with a move".to_owned();
                return Err((what, "a move first, and after every close"));
            }
            Segment::Close => open = false,
            Segment::Line(_) | Segment::Quadratic(..) | Segment::Cubic(..) => {}
        }
    }
    points(path).try_for_each(coordinate)
}

/// Every point of a path, those of control too.
fn points(path: &Path) -> impl Iterator<Item = [f64; 2]> {
    path.0.iter().flat_map(|segment| {
        let points = match *segment {
            Segment::Move(p) | Segment::Line(p) => [Some(p), None, None],
            Segment::Quadratic(a, p) => [Some(a), Some(p), None],
            Segment::Cubic(a, b, p) => [Some(a), Some(b), Some(p)],
            Segment::Close => [None; 3],
        };
        points.into_iter().flatten()
    })
}

fn coordinate([x, y]: [f64; 2]) -> Verdict {
    if x.abs() <= FARTHEST && y.abs() <= FARTHEST {
        return Ok(());
    }
    let what = format!("the point ({x}, {y}) is not on any page");
    Err((what, "finite coordinates of at most 100,000 points"))
}

fn number(name: &str, value: f64) -> Verdict {
    if value.abs() <= FARTHEST {
        return Ok(());
    }
    Err((
        format!("{name} is {value}"),
        "a finite number of at most 100,000",
    ))
}

fn length(name: &str, value: f64) -> Verdict {
    number(name, value)?;
    if value > 0.0 {
        return Ok(());
    }
    Err((format!("{name} is {value} points"), "more than 0 points"))
}
