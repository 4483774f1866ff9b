//! The limits of a view: from the file, or fitted to its contents.

use super::types::{Limits, Point};
use super::view::View;
use crate::figures::diagram::model::{self as model, Track};

/// The part of an automatic diagram that is empty on each side.
const MARGIN: f64 = 0.13;
const ROOM: f64 = 0.07;
/// The smallest width and height of an automatic diagram, relative to the other side.
const NARROWEST: f64 = 0.62;
const LOWEST: f64 = 0.55;
/// The change in rapidity of an endless accelerated line within an automatic diagram.
const TURN: f64 = 1.2;

/// The limits of a view.
pub(super) fn of(view: &View) -> Limits {
    let unit = view.diagram.unit.metres;
    let said = [view.diagram.x, view.diagram.ct].map(|l| l.map(|l| l.map(|end| end / unit)));
    let y = view.diagram.y.map(|y| y.map(|end| end / unit));
    let points = contents(view);
    let found = match view.is_solid() {
        true => roomy(&points),
        false => automatic(&points),
    };
    Limits {
        x: said[0].unwrap_or(found.x),
        ct: said[1].unwrap_or(found.ct),
        y: y.unwrap_or(found.y),
    }
}

/// Limits around points, with margins, neither too narrow nor too low.
fn automatic(points: &[Point]) -> Limits {
    let mut x = range(points.iter().map(|p| p.x));
    let mut ct = range(points.iter().map(|p| p.ct));
    // The origin, if it is not far.
    let largest = (x[1] - x[0]).max(ct[1] - ct[0]).max(f64::MIN_POSITIVE);
    for range in [&mut x, &mut ct] {
        // The distance of the range from 0; negative if it contains 0.
        let far = range[0].max(-range[1]);
        if far <= largest {
            *range = [range[0].min(0.0), range[1].max(0.0)];
        }
    }
    let extent = |range: [f64; 2]| range[1] - range[0];
    let largest = extent(x).max(extent(ct));
    // A single point gets the margins of eight units.
    let margin = MARGIN * if largest > 0.0 { largest } else { 8.0 };
    let widened = |range: [f64; 2]| [range[0] - margin, range[1] + margin];
    let (x, ct) = (widened(x), widened(ct));
    Limits {
        x: at_least(x, NARROWEST * extent(ct)),
        ct: at_least(ct, LOWEST * extent(x)),
        y: [0.0; 2],
    }
}

/// Limits of 2+1 dimensions around points. The origin does not count: the axes are along the edges.
fn roomy(points: &[Point]) -> Limits {
    let [x, y, ct] = [
        range(points.iter().map(|p| p.x)),
        range(points.iter().map(|p| p.y)),
        range(points.iter().map(|p| p.ct)),
    ];
    let extent = |range: [f64; 2]| range[1] - range[0];
    let largest = extent(x).max(extent(y)).max(extent(ct));
    let margin = ROOM * if largest > 0.0 { largest } else { 8.0 };
    let widened = |range: [f64; 2]| [range[0] - margin, range[1] + margin];
    let (x, y, ct) = (widened(x), widened(y), widened(ct));
    let least = NARROWEST * extent(ct).max(extent(x)).max(extent(y));
    Limits {
        x: at_least(x, least),
        y: at_least(y, least),
        ct: at_least(ct, LOWEST * extent(x)),
    }
}

fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let wider = |[low, high]: [f64; 2], v: f64| [low.min(v), high.max(v)];
    let [low, high] = values.fold([f64::INFINITY, f64::NEG_INFINITY], wider);
    if low <= high { [low, high] } else { [0.0, 0.0] }
}

/// A range about the same middle, of an extent at least.
fn at_least(range: [f64; 2], extent: f64) -> [f64; 2] {
    let lack = (extent - (range[1] - range[0])).max(0.0);
    [range[0] - 0.5 * lack, range[1] + 0.5 * lack]
}

/// The points that a view is to show.
pub(super) fn contents(view: &View) -> Vec<Point> {
    let d = view.diagram;
    let mut events: Vec<_> = d.events.iter().map(|mark| mark.at).collect();
    let segments = d.signals.iter().chain(&d.arrows);
    events.extend(segments.flat_map(|segment| segment.ends));
    events.extend(d.intervals.iter().flat_map(|interval| interval.ends));
    events.extend(
        d.slices
            .iter()
            .flat_map(|s| [Some(s.event), s.to])
            .flatten(),
    );
    events.extend(d.regions.iter().flat_map(|r| r.corners.iter().copied()));
    events.extend(d.curves.iter().flat_map(|c| c.points.iter().copied()));
    events.extend(d.texts.iter().map(|words| words.at));
    events.extend(d.cones.iter().map(|cone| cone.event));
    events.extend(d.hyperbolae.iter().flat_map(|h| [h.about, h.vertex]));
    events.extend(d.wedges.iter().map(|wedge| wedge.event));
    for line in &d.lines {
        let moments = shown(&line.track).into_iter();
        events.extend(moments.filter_map(|time| Some(line.track.at(time)?.event)));
    }
    let mut points: Vec<Point> = events.into_iter().map(|event| view.point(event)).collect();
    if view.is_solid() {
        let rims = rims(view, &points);
        points.extend(rims);
    }
    points
}

/// Points of the rims of cones whose heights are as the contents go, or as they are given.
fn rims(view: &View, points: &[Point]) -> Vec<Point> {
    let cones = view.diagram.cones.iter();
    let rim = |cone: &model::Cone| {
        let apex = view.point(cone.event);
        // Future upwards, past down.
        let sides = [(cone.future, 1.0), (cone.past, -1.0)]
            .into_iter()
            .filter(|(drawn, _)| *drawn);
        let heights = sides.map(move |(_, up)| up * height(view, cone, points, up));
        // Four points of the rim, on the axes: limits need no more.
        let quarter =
            |h: f64| [[h, 0.0], [-h, 0.0], [0.0, h], [0.0, -h]].map(|[x, y]| Point::deep(h, x, y));
        heights
            .flat_map(quarter)
            .map(move |p| apex.plus(1.0, p))
            .collect::<Vec<_>>()
    };
    cones.flat_map(rim).collect()
}

/// The extent of a cone towards `up`: beyond everything on that side of its apex.
fn height(view: &View, cone: &model::Cone, points: &[Point], up: f64) -> f64 {
    if let Some(height) = cone.height {
        return height / view.diagram.unit.metres;
    }
    let apex = view.point(cone.event);
    let ways = points.iter().map(|p| up * (p.ct - apex.ct));
    let far = ways.fold(0.0, f64::max);
    let all = range(points.iter().map(|p| p.ct));
    match (far > 0.0, all[1] > all[0]) {
        (true, _) => far,
        (false, true) => 0.5 * (all[1] - all[0]),
        (false, false) => 1.0,
    }
}

/// Proper times of a world line that should be visible: its ends, its corners, its turning point, a revolution.
fn shown(track: &Track) -> Vec<f64> {
    let mut times = track.corners();
    let start = 0f64.clamp(track.span()[0], track.span()[1]);
    times.push(start);
    for (end, towards) in track.span().into_iter().zip([-1.0, 1.0]) {
        match end.is_finite() {
            true => times.push(end),
            false => times.extend(track.turned(start, towards, TURN)),
        }
    }
    if let Some(period) = track.period() {
        // Eighths of a revolution reach its extremes to 8 %.
        times.extend((0..=8).map(|k| start + period * f64::from(k) / 8.0));
    }
    times
}
