//! Objects that are elsewhere, or have another velocity, possibly exchanged, from the world events that pixels show.
//!
//! Such an event does not determine which point of a moving object it belongs to, but in the object's frame all of them lie on its surface:
//! p = Λ(β)(E − O). If a candidate used another velocity, they do so in the frame of that velocity. The surface is that of the reference's
//! points. Where other objects hide it, it is unknown; and because the two pictures may show different sides of an object, velocities are
//! distinguished by the bounding boxes of all points, and if these are inconclusive, such as for partly hidden objects, by renderings of
//! the object alone with each velocity: the point at each pixel.

use std::collections::{BTreeMap, HashMap};

use glam::DVec3;

use super::super::known::Change;
use super::super::picture::Plane;
use super::super::points::place;
use super::motion::{self, FEWEST, in_words};
use super::rendered;
use super::{Case, Diagnosis, Kind, time};
use crate::render::aov::Aov;
use crate::spacetime::{Event, InertialFrame, Rest, Velocity};

/// The largest fraction of an object's points that may be off its surface, by events: means over pixels that show several of its parts are.
/// For an object with another velocity the fraction is smaller, because its faces slide along themselves.
const OFF_SURFACE: f64 = 1.0 / 3.0;
const OFF_BY_VELOCITY: f64 = 0.1;
/// The largest distance between the bounding boxes of an object's points, relative to the diagonal: other sides of it are visible. Another
/// velocity must leave at most this fraction of the distance for the right one.
const SAME_BOX: f64 = 0.05;
const NEARER: f64 = 0.3;
/// The largest fraction of an object's points that may differ from a rendering of it, without rims: means over pixels at creases.
const UNLIKE: f64 = 0.02;
/// The most objects that are rendered.
const MOST_OBJECTS: usize = 8;

/// Objects whose events match another velocity, and objects whose events are off the surface that the reference shows; for candidates with
/// world events only. Wrong times displace everything that moves, and have their own diagnosis.
pub(super) fn elsewhere(case: &Case) -> Vec<Diagnosis> {
    let [r, c] = &case.points;
    let (Some(_), Some(_), Some(_), None) = (r.object, c.object, c.world, c.material) else {
        return Vec::new();
    };
    if time::instant(case)
        .or_else(|| time::shifted(case))
        .is_some()
    {
        return Vec::new();
    }
    let pixels = pixels_of_both(case);
    // Pairs before single objects: velocities that are opposite to each other also look reversed.
    let exchanged = exchanged(case, &pixels);
    if !exchanged.is_empty() {
        return exchanged.into_iter().map(|(_, found)| found).collect();
    }
    let mut left = MOST_OBJECTS;
    (pixels.iter())
        .filter_map(|(object, pixels)| off_surface(case, *object, pixels, &mut left))
        .collect()
}

/// The pixels of objects that both pictures show, for each picture.
fn pixels_of_both(case: &Case) -> BTreeMap<usize, [Vec<usize>; 2]> {
    let mut pixels: BTreeMap<usize, [Vec<usize>; 2]> = BTreeMap::new();
    let [r, c] = &case.points;
    for i in case.region.pixels(r.size()) {
        for (which, points) in [r, c].into_iter().enumerate() {
            if let Some(object) = points.object_at(i).filter(|object| *object >= 0.0) {
                pixels.entry(object as usize).or_default()[which].push(i);
            }
        }
    }
    let enough = |pixels: &[Vec<usize>; 2]| pixels.iter().all(|pixels| pixels.len() >= FEWEST);
    pixels.retain(|_, pixels| enough(pixels));
    pixels
}

/// Objects that are out of view because their velocity is exchanged with that of an object in view; for candidates with events only.
pub(super) fn gone_by_exchange(case: &Case) -> Vec<usize> {
    let [_, c] = &case.points;
    let (Some(_), None) = (c.world, c.material) else {
        return Vec::new();
    };
    let found = exchanged(case, &pixels_of_both(case));
    let objects = found.into_iter().flat_map(|(pair, _)| pair);
    objects.filter(|k| motion::is_gone(case, *k)).collect()
}

/// The most wrong objects for which pairs are tested.
const MOST_EXCHANGED: usize = 4;

/// Pairs of objects whose events match each other's velocity; one of them may be out of view as a result.
fn exchanged(
    case: &Case,
    pixels: &BTreeMap<usize, [Vec<usize>; 2]>,
) -> Vec<([usize; 2], Diagnosis)> {
    let Some(known) = case.known else {
        return Vec::new();
    };
    let velocities: Vec<Velocity> = known.velocities().collect();
    let is_wrong = |(object, [in_r, in_c]): &(&usize, &[Vec<usize>; 2])| {
        !is_like_reference(case, **object, (in_r, &inside_of(case, **object, in_c)))
    };
    let wrong = pixels.iter().filter(is_wrong).map(|(object, _)| *object);
    let wrong: Vec<usize> = wrong.take(MOST_EXCHANGED).collect();
    let gone = (0..velocities.len()).filter(|k| motion::is_gone(case, *k));
    let gone: Vec<usize> = gone.take(MOST_EXCHANGED).collect();
    let has_velocity_of = |object: usize, other: usize| {
        let (Some(right), Some(velocity)) = (velocities.get(object), velocities.get(other)) else {
            return None;
        };
        (right != velocity).then_some(())?;
        let [in_r, in_c] = pixels.get(&object)?;
        let surface = Cloud::of(
            in_r,
            case.points[0].size(),
            own_point(case, object, 0, *right),
        );
        let own = |which, velocity| own_point(case, object, which, velocity);
        let by_boxes = by_boxes(&surface, in_r, in_c, *right, &[*velocity], own);
        let found = by_boxes.or_else(|| {
            let change = Change::Swapped(object, other);
            by_pictures(
                case,
                object,
                (in_r, &inside_of(case, object, in_c)),
                &[change],
            )
        });
        found.map(|(_, evidence)| evidence)
    };
    let is_out_of_view = |j: usize, k: usize| {
        let swapped = known.changed(Change::Swapped(j, k));
        swapped.is_some_and(|swapped| motion::is_out_of_view(case, &swapped, k))
    };
    let mut found = Vec::new();
    for (n, &j) in wrong.iter().enumerate() {
        for &k in wrong[n + 1..].iter().chain(&gone) {
            let Some(evidence) = has_velocity_of(j, k) else {
                continue;
            };
            let has_other = match gone.contains(&k) {
                true => is_out_of_view(j, k),
                false => has_velocity_of(k, j).is_some(),
            };
            if has_other {
                let pair = [j.min(k), j.max(k)];
                let what = format!(
                    "the velocities of objects {} and {} are swapped: their events are those of each other's velocity",
                    pair[0], pair[1]
                );
                let (kind, what) = (Kind::VelocitiesSwapped, what.into());
                found.push((
                    pair,
                    Diagnosis {
                        kind,
                        what,
                        evidence,
                    },
                ));
            }
        }
    }
    found
}

/// The time and position of the event that each of these pixels of the reference shows.
fn shown_by_reference(case: &Case, in_r: &[usize]) -> Option<Shown> {
    let world = case.points[0].world?;
    let time = Plane::aov(&case.pair[0].layers, Aov::EventCt)?;
    let shown = in_r.iter().map(|i| (*i, (time.at(*i), place(&world, *i))));
    Some(shown.collect())
}

/// The candidate's pixels of an object that are not on its rim.
fn inside_of(case: &Case, object: usize, in_c: &[usize]) -> Vec<usize> {
    let is_there = |i: usize| case.points[1].object_at(i) == Some(object as f64);
    inside(case.points[1].size(), in_c, is_there)
}

/// The point of an object that a pixel of a picture shows, in the object's frame, if it moved at `velocity`.
fn own_point<'a>(
    case: &Case<'a>,
    object: usize,
    which: usize,
    velocity: Velocity,
) -> impl Fn(usize) -> Option<DVec3> + 'a {
    let frame = case.known.and_then(|known| known.frame(object));
    let world = case.points[which].world;
    let time = Plane::aov(&case.pair[which].layers, Aov::EventCt);
    move |i: usize| {
        let x = place(&world?, i);
        // For objects at rest, and in unknown scenes, positions are sufficient.
        let Some(frame) = frame.filter(|_| !velocity.is_rest()) else {
            return Some(x - frame.map_or(DVec3::ZERO, |frame| frame.origin().x));
        };
        let event = Event::new(time?.at(i), x);
        let frame = InertialFrame::<Rest>::new(velocity, frame.origin());
        Some(frame.event_from_world(event).x)
    }
}

/// The pixels of an object without other surfaces around them: pixels on its rim may be means of several surfaces.
fn inside(
    [width, height]: [usize; 2],
    pixels: &[usize],
    is_there: impl Fn(usize) -> bool,
) -> Vec<usize> {
    let is_inside = |i: usize| {
        let (x, y) = (i % width, i / width);
        let rows = y.saturating_sub(1)..=(y + 1).min(height - 1);
        rows.into_iter().all(|y| {
            let mut row = x.saturating_sub(1)..=(x + 1).min(width - 1);
            row.all(|x| is_there(y * width + x))
        })
    };
    pixels.iter().copied().filter(|i| is_inside(*i)).collect()
}

/// Those of these pixels whose points the reference would show if they were on the object's surface: where it shows the object, too, or
/// something farther away (whose light left earlier), or nothing. Where something nearer hides the object, it is inconclusive.
fn told(case: &Case, object: usize, inside: &[usize]) -> Vec<usize> {
    let r = &case.points[0];
    let times = case.pair.map(|p| Plane::aov(&p.layers, Aov::EventCt));
    let is_nearer = |i: usize| match times {
        [Some(r), Some(c)] => c.at(i) > r.at(i),
        _ => false,
    };
    let is_told = |i: usize| match r.object_at(i) {
        Some(id) if id == object as f64 => true,
        Some(id) => id < 0.0 || is_nearer(i),
        None => false,
    };
    inside.iter().copied().filter(|i| is_told(*i)).collect()
}

/// The mistake of one object; up to `left` objects are rendered.
fn off_surface(
    case: &Case,
    object: usize,
    [in_r, in_c]: &[Vec<usize>; 2],
    left: &mut usize,
) -> Option<Diagnosis> {
    let frame = case.known.and_then(|known| known.frame(object));
    let velocity = frame.map_or(Velocity::REST, InertialFrame::velocity);
    let own = |which: usize, velocity: Velocity| own_point(case, object, which, velocity);
    let surface = Cloud::of(in_r, case.points[0].size(), own(0, velocity));
    let others = [Velocity::REST, -velocity];
    if !velocity.is_rest()
        && let Some((which, evidence)) = by_boxes(&surface, in_r, in_c, velocity, &others, own)
    {
        return Some(other_velocity(object, velocity, which == 1, evidence));
    }
    let inside = inside_of(case, object, in_c);
    let others = [Change::AtRest(object), Change::Reversed(object)];
    if !velocity.is_rest() && *left > 0 && !is_like_reference(case, object, (in_r, &inside)) {
        *left -= 1;
        if let Some((which, evidence)) = by_pictures(case, object, (in_r, &inside), &others) {
            return Some(other_velocity(object, velocity, which == 1, evidence));
        }
    }
    let part = surface.part_off(&told(case, object, &inside), own(1, velocity))?;
    (part > OFF_SURFACE).then(|| Diagnosis {
        kind: Kind::ObjectElsewhere,
        what: format!(
            "object {object} is elsewhere: by their events, {:.0} % of its points are not on the surface that the reference shows",
            100.0 * part
        ).into(),
        evidence: vec![(PART_OFF, part)],
    })
}

/// The diagnosis of an object whose events match rest or the opposite velocity.
fn other_velocity(
    object: usize,
    velocity: Velocity,
    reversed: bool,
    mut evidence: Vec<(&'static str, f64)>,
) -> Diagnosis {
    let beta = in_words(velocity.beta());
    let (kind, what) = match reversed {
        false => (
            Kind::VelocityMissing,
            format!(
                "the velocity of object {object} is missing: its events are those of the object at rest, and should be those of β = {beta}"
            ),
        ),
        true => (
            Kind::VelocityWrong,
            format!(
                "the velocity of object {object} is reversed: its events are those of −β for β = {beta}"
            ),
        ),
    };
    evidence.push(("beta", velocity.beta().length()));
    Diagnosis {
        kind,
        what: what.into(),
        evidence,
    }
}

const PART_OFF: &str = "part of its points that are off the surface";

/// The other velocity that matches the candidate's events of an object, with the evidence: the fraction of its points off the surface, and
/// the distance between the bounding boxes, with the right velocity and with that one.
fn by_boxes<P: Fn(usize) -> Option<DVec3>>(
    surface: &Cloud,
    in_r: &[usize],
    in_c: &[usize],
    velocity: Velocity,
    others: &[Velocity],
    own: impl Fn(usize, Velocity) -> P,
) -> Option<(usize, Vec<(&'static str, f64)>)> {
    let part = surface.part_off(in_c, own(1, velocity))?;
    let right = bounds(in_r.iter().copied().filter_map(own(0, velocity)));
    let apart = |velocity| {
        let [low, high] = bounds(in_c.iter().copied().filter_map(own(1, velocity)));
        let [low, high] = [low - right[0], high - right[1]];
        low.abs().max(high.abs()).max_element()
    };
    let is = apart(velocity);
    let apart_by: Vec<f64> = others.iter().map(|velocity| apart(*velocity)).collect();
    let (which, nearest) = least(apart_by.iter().copied().map(Some))?;
    // Other sides of a body are visible at each velocity: one of them must be far nearer than the others, too.
    let is_nearest = |(k, other): (usize, &f64)| k == which || nearest <= NEARER * other;
    let is_only = apart_by.iter().enumerate().all(is_nearest);
    let same = SAME_BOX * (right[1] - right[0]).length();
    let is_wrong = part > OFF_BY_VELOCITY || is > same;
    let explains = is_wrong && is_only && nearest <= same.min(NEARER * is);
    let evidence = vec![
        (PART_OFF, part),
        ("the box around its points is off by (m)", is),
        ("and with that velocity by (m)", nearest),
    ];
    explains.then_some((which, evidence))
}

/// The smallest number and its index; `None` if one is missing.
fn least(numbers: impl Iterator<Item = Option<f64>>) -> Option<(usize, f64)> {
    let numbers: Vec<f64> = numbers.collect::<Option<_>>()?;
    let numbers = numbers.into_iter().enumerate();
    numbers.min_by(|a, b| a.1.total_cmp(&b.1))
}

/// Whether an object's pixels in the reference and its pixels off the rim in the candidate show the same points.
fn is_like_reference(case: &Case, object: usize, (in_r, in_c): (&[usize], &[usize])) -> bool {
    let shown = shown_by_reference(case, in_r);
    let unlike = shown.and_then(|shown| part_unlike(case, object, &shown, in_c));
    unlike.is_none_or(|part| part <= OFF_BY_VELOCITY)
}

/// The same as `by_boxes` from renderings of the object alone, unchanged and with other changes. Because its faces slide along themselves,
/// the test is whether each point is where it is seen, not whether it is on them.
fn by_pictures(
    case: &Case,
    object: usize,
    (in_r, in_c): (&[usize], &[usize]),
    others: &[Change],
) -> Option<(usize, Vec<(&'static str, f64)>)> {
    if is_like_reference(case, object, (in_r, in_c)) {
        return None;
    }
    let unlike = |change| {
        let shown = rendered::events_of(case, object, change)?;
        part_unlike(case, object, &shown, in_c)
    };
    let is = unlike(None).filter(|part| *part > OFF_BY_VELOCITY)?;
    let (which, nearest) = least(others.iter().map(|change| unlike(Some(*change))))?;
    let evidence = vec![
        ("part of its points that are not where they are seen", is),
        ("and with that velocity", nearest),
    ];
    (nearest <= UNLIKE.min(NEARER * is)).then_some((which, evidence))
}

/// For each pixel, the time and position of the event that it shows of an object.
type Shown = BTreeMap<usize, (f64, DVec3)>;

/// The fraction of the candidate's points of an object that differ from `shown` by more than a pixel, including points that it lacks
/// although nothing nearer hides them.
fn part_unlike(case: &Case, object: usize, shown: &Shown, in_c: &[usize]) -> Option<f64> {
    let c = &case.points[1];
    let (world, time) = (c.world?, Plane::aov(&case.pair[1].layers, Aov::EventCt)?);
    let pixels: Vec<usize> = shown.keys().copied().collect();
    let surface = Cloud::of(&pixels, c.size(), |i| Some(shown.get(&i)?.1));
    let is_like = |i: &usize| {
        let ball = surface.balls.get(i);
        ball.is_some_and(|ball| (place(&world, *i) - ball.point).length() <= ball.reach / REACH)
    };
    let unlike = in_c.iter().filter(|i| !is_like(i)).count();
    let is_lacking = |i: &usize| match c.object_at(*i) {
        Some(id) if id == object as f64 => false,
        Some(id) => id < 0.0 || time.at(*i) < shown[i].0,
        None => false,
    };
    let inside = inside(c.size(), &pixels, |i| shown.contains_key(&i));
    let lacking = inside.iter().filter(|i| is_lacking(i)).count();
    let all = in_c.len() + lacking;
    (all >= FEWEST).then(|| (unlike + lacking) as f64 / all as f64)
}

/// The bounding box of points.
fn bounds(points: impl Iterator<Item = DVec3>) -> [DVec3; 2] {
    let none = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    let finite = points.filter(|p| p.is_finite());
    finite.fold(none, |[low, high], p| [low.min(p), high.max(p)])
}

/// The reach of a surface point relative to the distance of its neighbours: samples lie anywhere in their pixels.
const REACH: f64 = 1.5;
fn longer(a: Option<f64>, b: Option<f64>) -> Option<f64> {
    [a, b].into_iter().flatten().reduce(f64::max)
}

/// Of two steps along an axis the shorter one is used if the longer one is more than this many times as long, because that one leads from
/// one part of the object to another.
const CONNECTED: f64 = 3.0;

/// The surface from points of neighbouring pixels: balls around them that reach the neighbours, across and down, so that they are large
/// where a surface is far away or grazed. They are looked up in grids whose cell sizes are powers of two.
struct Cloud {
    /// The point of each pixel that shows the object, the radius of its ball, and its farthest neighbour.
    balls: HashMap<usize, Ball>,
    /// Pixels by cell, for each power of two.
    grids: BTreeMap<i32, HashMap<[i64; 3], Vec<usize>>>,
}

/// The number of balls above which a cell is full: anything in it, or beside it, is on the surface.
const FULL: usize = 256;

struct Ball {
    point: DVec3,
    reach: f64,
    farthest: f64,
}

impl Cloud {
    /// The surface from the points of these pixels of a picture of this size.
    fn of(
        pixels: &[usize],
        [width, _]: [usize; 2],
        point: impl Fn(usize) -> Option<DVec3>,
    ) -> Cloud {
        let points: HashMap<usize, DVec3> = pixels
            .iter()
            .filter_map(|i| Some((*i, point(*i).filter(|p| p.is_finite())?)))
            .collect();
        let mut cloud = Cloud {
            balls: HashMap::new(),
            grids: BTreeMap::new(),
        };
        for i in pixels {
            let Some(&point) = points.get(i) else {
                continue;
            };
            let step = |dx: isize, dy: isize| {
                let x = (i % width).checked_add_signed(dx).filter(|x| *x < width)?;
                let y = (i / width).checked_add_signed(dy)?;
                Some((*points.get(&(y * width + x))? - point).length())
            };
            // If one of two steps is far longer, it crosses a silhouette.
            let along = |dx, dy| match [step(dx, dy), step(-dx, -dy)] {
                [Some(a), Some(b)] if a.max(b) > CONNECTED * a.min(b) => Some(a.min(b)),
                [a, b] => longer(a, b),
            };
            let reach = REACH * longer(along(1, 0), along(0, 1)).unwrap_or(0.0);
            let around = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| [dx, dy]));
            let farthest = around
                .filter_map(|[dx, dy]| step(dx, dy))
                .fold(0.0, f64::max);
            if reach > 0.0 {
                let level = Cloud::level(reach);
                let cell = Cloud::cell(point, level);
                let cells = cloud.grids.entry(level).or_default();
                cells.entry(cell).or_default().push(*i);
            }
            let ball = Ball {
                point,
                reach,
                farthest,
            };
            cloud.balls.insert(*i, ball);
        }
        cloud
    }

    /// The exponent of the smallest power of two that is at least a length.
    fn level(length: f64) -> i32 {
        libm::log2(length).ceil() as i32
    }

    fn cell(p: DVec3, level: i32) -> [i64; 3] {
        let size = libm::exp2(f64::from(level));
        (p / size).to_array().map(|x| x.floor() as i64)
    }

    /// Whether the point that pixel `i` shows is close to that of the reference there, or in any ball.
    fn has(&self, i: usize, p: DVec3) -> bool {
        let is_near = |ball: &Ball| (p - ball.point).length() <= ball.farthest.max(ball.reach);
        if self.balls.get(&i).is_some_and(is_near) {
            return true;
        }
        let is_in = |i: &usize| {
            let ball = &self.balls[i];
            (p - ball.point).length() <= ball.reach
        };
        self.grids.iter().any(|(level, cells)| {
            let [x, y, z] = Cloud::cell(p, *level);
            let around =
                (-1..=1).flat_map(|i| (-1..=1).flat_map(move |j| (-1..=1).map(move |k| [i, j, k])));
            let mut around = around.map(|[i, j, k]| {
                [
                    x.saturating_add(i),
                    y.saturating_add(j),
                    z.saturating_add(k),
                ]
            });
            around.any(|cell| {
                let found = cells.get(&cell);
                found.is_some_and(|found| found.len() > FULL || found.iter().any(is_in))
            })
        })
    }

    /// The fraction of these pixels' points that are off the surface; `None` if there are too few.
    fn part_off(&self, pixels: &[usize], point: impl Fn(usize) -> Option<DVec3>) -> Option<f64> {
        let (mut all, mut off) = (0usize, 0usize);
        for i in pixels {
            if let Some(p) = point(*i).filter(|p| p.is_finite()) {
                all += 1;
                off += usize::from(!self.has(*i, p));
            }
        }
        (all >= FEWEST && !self.balls.is_empty()).then(|| off as f64 / all as f64)
    }
}
