//! World lines, hyperbolae, light cones and areas.
//!
//! A world line is sampled more finely where it is curved: between two points it deviates from the straight line by less than
//! [`FLATNESS`] of the diagram's size.

use glam::DVec3;

use super::solid;
use super::types::Limits;
use super::types::{Area, Cone, Curve, Hyperbola, Placed, Point, Tick, WorldLine, number};
use super::view::View;
use crate::figures::diagram::model::{self as model, DrawnCurve, NamedLine, Side, Track};
use crate::spacetime::Displacement;

/// The largest deviation from straight, in parts of the diagram's size: 0.02 mm on 200 mm.
const FLATNESS: f64 = 1e-4;
/// Pieces that are looked at in any case, and halvings of each.
const PIECES: u32 = 24;
const HALVINGS: u32 = 10;
/// The most ticks of a world line, and of all of a diagram.
const MOST_TICKS: f64 = 2000.0;
const MOST_TICKS_IN_ALL: f64 = 200_000.0;
/// The least distance of a hyperbola's vertex from its middle, in parts of the diagram's extent.
const NARROWEST: f64 = 1e-9;
/// Points of a hyperbola on each side of its vertex.
const HYPERBOLA: i32 = 64;

pub(super) fn world_lines(view: &View, limits: &Limits) -> Vec<WorldLine> {
    let lines = view.diagram.lines.iter();
    lines.map(|line| world_line(view, limits, line)).collect()
}

fn world_line(view: &View, limits: &Limits, line: &NamedLine) -> WorldLine {
    let times = times(view, limits, &line.track);
    WorldLine {
        name: line.name.clone(),
        curve: curve(view, limits, &line.track, times),
        ticks: ticks(view, limits, line, times),
        label: line.label.clone(),
        projected: is_projected(view, &line.track, times),
        colour: line.colour,
    }
}

/// Whether a world line moves across the directions that are drawn, in the view's coordinates.
fn is_projected(view: &View, track: &Track, [from, to]: [f64; 2]) -> bool {
    let steps = (0..=PIECES).filter(|_| from < to);
    let times = steps.map(|k| from + (to - from) * f64::from(k) / f64::from(PIECES));
    let events: Vec<_> = times
        .filter_map(|time| Some(track.at(time)?.event))
        .collect();
    events
        .windows(2)
        .any(|pair| view.is_beside(pair[0], pair[1]))
}

/// Proper times between which a world line is within the view's times.
fn times(view: &View, limits: &Limits, track: &Track) -> [f64; 2] {
    let unit = view.diagram.unit.metres;
    track.during(view.frame(), limits.ct.map(|ct| ct * unit))
}

fn curve(view: &View, limits: &Limits, track: &Track, [from, to]: [f64; 2]) -> Curve {
    let at = |time: f64| Some(view.point(track.at(time)?.event));
    // Straight lines need their vertices only. A curve is divided into at least this many pieces: one that bends to both sides may pass
    // through the middle of its chord.
    let mut knots = vec![from];
    let corners = track.corners();
    if track.bends() || (corners.is_empty() && !track.is_straight()) {
        knots.extend((1..PIECES).map(|k| from + (to - from) * f64::from(k) / f64::from(PIECES)));
    }
    knots.extend(corners);
    knots.sort_by(f64::total_cmp);
    knots.retain(|time| (from..to).contains(time));
    knots.push(to);
    // Between knots, as many points as it bends.
    let mut points: Vec<Point> = at(from).into_iter().collect();
    let allowed = FLATNESS * limits.size().into_iter().fold(0.0, f64::max);
    for pair in knots.windows(2) {
        if let (&[a, b], Some(pa), Some(pb)) = (pair, at(pair[0]), at(pair[1])) {
            bend(&at, [(a, pa), (b, pb)], allowed, HALVINGS, &mut points);
        }
    }
    match view.is_solid() {
        true => within(limits, &points),
        false => Curve { points },
    }
}

/// The longest part of a curve that is within the limits: in 2+1 dimensions the page has no edge to clip it.
fn within(limits: &Limits, points: &[Point]) -> Curve {
    let mut parts: Vec<Vec<Point>> = vec![Vec::new()];
    for pair in points.windows(2) {
        let Some([a, b]) = limits.segment(pair[0], pair[1]) else {
            parts.push(Vec::new());
            continue;
        };
        // A part begins where the curve enters, at the edge …
        if let Some(part) = parts.last_mut() {
            if part.is_empty() {
                part.push(a);
            }
            part.push(b);
        }
        // … and ends where it leaves.
        if b != pair[1] && !limits.contains(pair[1]) {
            parts.push(Vec::new());
        }
    }
    let extent = |part: &Vec<Point>| match (part.first(), part.last()) {
        (Some(a), Some(b)) => b.ct - a.ct,
        _ => 0.0,
    };
    let longest = parts
        .into_iter()
        .max_by(|a, b| extent(a).total_cmp(&extent(b)));
    Curve {
        points: longest.unwrap_or_default(),
    }
}

/// Adds the points after the first of two, as many as the curve between them bends.
fn bend(
    at: &impl Fn(f64) -> Option<Point>,
    [a, b]: [(f64, Point); 2],
    allowed: f64,
    halvings: u32,
    points: &mut Vec<Point>,
) {
    let middle = a.0 + 0.5 * (b.0 - a.0);
    let Some(m) = at(middle) else { return };
    let vector = |p: Point| DVec3::new(p.x, p.y, p.ct);
    // The distance of the middle from the chord: |chord × (m − a)| / |chord|.
    let chord = vector(b.1.from(a.1));
    let across = chord.cross(vector(m.from(a.1))).length() / chord.length();
    if halvings > 0 && across > allowed {
        bend(at, [a, (middle, m)], allowed, halvings - 1, points);
        bend(at, [(middle, m), b], allowed, halvings - 1, points);
        return;
    }
    points.push(b.1);
}

/// Ticks of a line's own clock, those in view.
fn ticks(view: &View, limits: &Limits, line: &NamedLine, [from, to]: [f64; 2]) -> Vec<Tick> {
    let unit = view.diagram.unit.metres;
    let Some(step) = line.ticks else {
        return Vec::new();
    };
    // Times are k·step; rounding must not remove one at an end.
    let first = libm::ceil(from / step - 1e-9);
    let last = libm::floor(to / step + 1e-9);
    let ticked = view
        .diagram
        .lines
        .iter()
        .filter(|line| line.ticks.is_some());
    // Too many ticks to distinguish are omitted.
    let most = MOST_TICKS.min(MOST_TICKS_IN_ALL / ticked.count() as f64);
    if last - first > most {
        return Vec::new();
    }
    let tick = |k: i64| {
        let time = (first + k as f64) * step;
        let moment = line.track.at(time.clamp(from, to))?;
        // The clock's own direction of time, across which its tick is drawn.
        let ahead = Displacement::new(unit, glam::DVec3::ZERO);
        let value = time / unit;
        Some(Tick {
            at: view.point(moment.event),
            value,
            along: view.vector(moment.frame().world_from_frame().displacement(ahead)),
            label: (line.numbers && value != 0.0).then(|| number(value)),
        })
    };
    let all = (0..=(last - first) as i64).filter_map(tick);
    all.filter(|tick| limits.contains(tick.at)).collect()
}

pub(super) fn cones(view: &View, limits: &Limits) -> Vec<Cone> {
    let cones = view.diagram.cones.iter().map(|cone| {
        let apex = view.point(cone.event);
        let far = limits.beyond(apex);
        let mut laid = Cone {
            apex,
            rays: Vec::new(),
            inside: Vec::new(),
            nappes: Vec::new(),
        };
        if view.is_solid() {
            laid.nappes = solid::nappes(view, limits, cone);
            return laid;
        }
        for (drawn, up) in [(cone.future, 1.0), (cone.past, -1.0)] {
            if !drawn {
                continue;
            }
            // |dx| = d(ct): light to both sides, as far as the edge; the shade extends beyond it and is clipped there.
            let rays = [Point::new(up, -1.0), Point::new(up, 1.0)];
            laid.rays
                .extend(rays.iter().filter_map(|ray| limits.ray(apex, *ray)));
            if cone.shade {
                let [left, right] = rays.map(|ray| apex.plus(far, ray));
                laid.inside.push(vec![apex, left, right]);
            }
        }
        laid
    });
    cones.collect()
}

pub(super) fn hyperbolae(view: &View, limits: &Limits) -> Vec<Hyperbola> {
    let all = view.diagram.hyperbolae.iter().map(|hyperbola| Hyperbola {
        curve: hyperbola_curve(view, limits, hyperbola),
        label: hyperbola.label.clone(),
        colour: hyperbola.colour,
    });
    all.collect()
}

pub(super) fn drawn(view: &View) -> Vec<DrawnCurve<Point>> {
    let all = view.diagram.curves.iter().map(|curve| DrawnCurve {
        points: curve
            .points
            .iter()
            .map(|event| view.point(*event))
            .collect(),
        dashed: curve.dashed,
        label: curve.label.clone(),
        colour: curve.colour,
    });
    all.collect()
}

/// about + s (cosh φ, sinh φ), or about + s (sinh φ, cosh φ), for as many φ as are in view.
fn hyperbola_curve(view: &View, limits: &Limits, hyperbola: &model::Hyperbola) -> Curve {
    let unit = view.diagram.unit.metres;
    let step = hyperbola.vertex - hyperbola.about;
    let (time, length) = (step.ct / unit, view.diagram.direction.dot(step.x) / unit);
    let about = view.point(hyperbola.about);
    // A vertex that cannot be told from the middle on paper is moved out until it almost can: its hyperbola is the light rays.
    let beyond = limits.beyond(about);
    let said = time.abs().max(length.abs());
    let size = said.max(NARROWEST * beyond);
    let [time, length] = match size > said {
        true => [time, length].map(|part| part / said * size),
        false => [time, length],
    };
    if !(time + length).is_finite() {
        return Curve::default();
    }
    // sinh φ = (extent in view) / (distance of the vertex) at both ends.
    let largest = libm::asinh(beyond / size);
    let points = (-HYPERBOLA..=HYPERBOLA).map(|k| {
        let phi = largest * f64::from(k) / f64::from(HYPERBOLA);
        let (sinh, cosh) = (libm::sinh(phi), libm::cosh(phi));
        let ct = time * cosh + length * sinh;
        let x = time * sinh + length * cosh;
        Point::new(about.ct + ct, about.x + x)
    });
    Curve {
        points: points.collect(),
    }
}

/// Sheets, regions and wedges.
pub(super) fn areas(view: &View, limits: &Limits) -> Vec<Area> {
    let d = view.diagram;
    let wedges = d
        .wedges
        .iter()
        .map(|wedge| self::wedge(view, limits, wedge));
    let regions = d.regions.iter().map(|region| {
        let edge: Vec<Point> = region.corners.iter().map(|e| view.point(*e)).collect();
        area(edge, &region.label, region.colour, None)
    });
    let sheets = d.sheets.iter().map(|sheet| {
        let [a, b] = sheet_curves(view, limits, sheet.between);
        let middles = sheet_middles(limits, &a, &b);
        // Up along one line and down along the other.
        let edge = a.into_iter().chain(b.into_iter().rev()).collect();
        let mut area = area(edge, &sheet.label, sheet.colour, Some(sheet.between[0]));
        if let Some(label) = area.label.as_mut().filter(|_| !middles.is_empty()) {
            label.places = middles;
        }
        area
    });
    wedges.chain(regions).chain(sheets).collect()
}

fn area(
    edge: Vec<Point>,
    label: &Option<String>,
    colour: Option<model::Colour>,
    owner: Option<usize>,
) -> Area {
    let count = edge.len().max(1) as f64;
    let sum = edge
        .iter()
        .fold(Point::default(), |sum, p| sum.plus(1.0, *p));
    let middle = Point::new(sum.ct / count, sum.x / count);
    Area {
        label: label.clone().map(|text| Placed {
            text,
            places: vec![middle],
        }),
        edge,
        horizons: Vec::new(),
        owner,
        colour,
    }
}

/// The two world lines of a sheet.
fn sheet_curves(view: &View, limits: &Limits, between: [usize; 2]) -> [Vec<Point>; 2] {
    between.map(|i| {
        let line = view.diagram.lines.get(i);
        let points = line.map(|line| {
            let times = times(view, limits, &line.track);
            curve(view, limits, &line.track, times).points
        });
        points.unwrap_or_default()
    })
}

/// Points half way between two world lines, in view.
fn sheet_middles(limits: &Limits, a: &[Point], b: &[Point]) -> Vec<Point> {
    const HEIGHTS: [f64; 11] = [
        0.83, 0.76, 0.69, 0.62, 0.55, 0.48, 0.4, 0.31, 0.24, 0.17, 0.1,
    ];
    // So near to the sides labels would leave the panel.
    let air = 0.06 * limits.size()[0];
    let within = |p: &Point| p.x > limits.x[0] + air && p.x < limits.x[1] - air;
    let heights = HEIGHTS.map(|part| limits.ct[0] + part * limits.size()[1]);
    let middle = |ct: f64| Some(Point::new(ct, 0.5 * (x_at(a, ct)? + x_at(b, ct)?)));
    heights
        .into_iter()
        .filter_map(middle)
        .filter(within)
        .collect()
}

/// The x of an upward curve at height `ct`.
fn x_at(points: &[Point], ct: f64) -> Option<f64> {
    let pair = points
        .windows(2)
        .find(|pair| pair[0].ct <= ct && ct <= pair[1].ct)?;
    let d = pair[1].from(pair[0]);
    Some(pair[0].x + d.x * (ct - pair[0].ct) / d.ct.max(f64::MIN_POSITIVE))
}

/// The region between two light rays from an event: light is at 45 degrees in every frame, so no boost is needed.
fn wedge(view: &View, limits: &Limits, wedge: &model::Wedge) -> Area {
    let apex = view.point(wedge.event);
    let rays = match wedge.side {
        Side::Right => [[-1.0, 1.0], [1.0, 1.0]],
        Side::Left => [[-1.0, -1.0], [1.0, -1.0]],
        Side::Future => [[1.0, -1.0], [1.0, 1.0]],
        Side::Past => [[-1.0, -1.0], [-1.0, 1.0]],
    };
    let rays = rays.map(|[ct, x]| Point::new(ct, x));
    let far = limits.beyond(apex);
    let [a, b] = rays.map(|ray| apex.plus(far, ray));
    // The axis of the wedge is the sum of its rays.
    let along = rays[0].plus(1.0, rays[1]);
    let places = limits.ray(apex, along).map(|ends| within_wedge(ends, rays));
    Area {
        edge: vec![apex, a, b],
        horizons: rays
            .iter()
            .filter_map(|ray| limits.ray(apex, *ray))
            .collect(),
        owner: None,
        label: wedge
            .label
            .clone()
            .zip(places)
            .map(|(text, places)| Placed { text, places }),
        colour: wedge.colour,
    }
}

/// Points within a wedge, on both sides of its axis between `ends`.
fn within_wedge([from, to]: [Point; 2], rays: [Point; 2]) -> Vec<Point> {
    const PLACES: [(f64, f64); 6] = [
        (0.55, 0.2),
        (0.75, 0.25),
        (0.4, 0.15),
        (0.75, 0.12),
        (0.6, 0.3),
        (0.85, 0.4),
    ];
    let way = to.from(from);
    let length = way.ct.hypot(way.x);
    let beside =
        |ray: Point| PLACES.map(|(along, aside)| from.plus(along, way).plus(aside * length, ray));
    rays.into_iter().flat_map(beside).collect()
}
