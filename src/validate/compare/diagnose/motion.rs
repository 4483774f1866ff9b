//! Wrong velocities: of the camera by look directions, of objects by wavelength ratios, of both by where points of a
//! known scene are shown.
//!
//! # By wavelength ratios
//!
//! For an object with four-velocity γ(1, β) seen by a camera with γc(1, βc) along the world's look direction d,
//!
//! ```text
//! W = ω_emitted / ω_observed = γ(1 + β·d) / (γc(1 + βc·d))
//! ```
//!
//! so that W γc(1 + βc·d) is linear in d: a least squares fit over the object's pixels gives (γ, γβ). It is a
//! four-velocity only where γ² − |γβ|² = 1: a W that is wrong by a factor gives no velocity. An
//! object that takes up little of the view determines them badly; so hypotheses are compared by how well they
//! reproduce W where the object is seen, not by the fitted numbers.
//!
//! # By events
//!
//! Events of the world do not say which point of a moving object emits there, but in the object's frame all of them lie on
//! its surface: p = Λ(β)(E − O). Where a candidate has taken another velocity, they do so in the frame of that one. The
//! surface is that of the reference's points; where these are hidden nothing is told of it, and as other sides of it may be seen, velocities are
//! told by the boxes around all points.
//!
//! # By places
//!
//! In a known scene the map π from points of objects to the film is known for any velocity of the camera and of the
//! objects, and for light that takes no time. The candidate's points are seen where it shows them under the
//! change that it has made.

use std::collections::{BTreeMap, HashMap};

use glam::{DMat4, DVec2, DVec3, DVec4, Vec4Swizzles};

use super::super::known::{Change, KnownScene};
use super::super::picture::{Picture, Plane};
use super::super::points::place;
use super::{Case, Diagnosis, Kind, NEAR, Tally, time};
use crate::render::aov::Aov;
use crate::spacetime::{Boost, Camera, Direction, Event, InertialFrame, Rest, Velocity, World};

/// Errors of directions that storage in single precision makes, radians.
const DIRECTION_ROUNDING: f64 = 1e-5;

/// Look directions with the camera's velocity reversed, or left out.
pub(super) fn aberration(case: &Case) -> Option<Diagnosis> {
    let [r, c] = case.points.map(|points| points.direction);
    let (r, c, velocity) = (r?, c?, camera_velocity(case.pair[0])?);
    let mut sums = [0.0; 3];
    let mut count = 0.0;
    for i in case.region.pixels(case.points[0].size()) {
        let [r, c] = [place(&r, i), place(&c, i)];
        let Some(d) = Direction::new(r) else {
            continue;
        };
        let [reversed, missing] = wrong_directions(d, velocity);
        for (sum, expected) in sums.iter_mut().zip([r, reversed, missing]) {
            *sum += (c - expected).length_squared();
        }
        count += 1.0;
    }
    let [error, reversed, missing] = sums.map(|sum: f64| (sum / f64::max(count, 1.0)).sqrt());
    let (kind, rest) = match reversed <= missing {
        true => (Kind::AberrationReversed, reversed),
        false => (Kind::AberrationMissing, missing),
    };
    let explains = error > DIRECTION_ROUNDING && rest <= NEAR * error;
    explains.then(|| describe_aberration(kind, error, rest, velocity))
}

fn describe_aberration(kind: Kind, error: f64, rest: f64, velocity: Velocity) -> Diagnosis {
    let how = match kind {
        Kind::AberrationReversed => {
            "aberration is reversed: look directions are those of a camera that moves the opposite way (−β for β)"
        }
        _ => "aberration is missing: look directions are those of the camera's own frame",
    };
    Diagnosis {
        kind,
        what: how.into(),
        evidence: vec![
            ("directions differ from the reference by (rad, rms)", error),
            ("and from the hypothesis by (rad, rms)", rest),
            ("beta of the camera", velocity.beta().length()),
        ],
    }
}

/// The world's look directions with the opposite boost, and without one, where the right one gives `d`.
fn wrong_directions(d: Direction<World>, velocity: Velocity) -> [DVec3; 2] {
    let camera_from_world = Boost::<Camera, World>::new(-velocity);
    let (own, _) = camera_from_world.direction(d);
    let (reversed, _) = Boost::<World, Camera>::new(-velocity).direction(own);
    [reversed.unit(), own.unit()]
}

/// The velocity of a camera that moves without acceleration and does not turn, by the picture's metadata.
pub(super) fn camera_velocity(picture: &Picture) -> Option<Velocity> {
    let turns = ["camera_motion", "rotation_axis", "sensor_focal_length"];
    if turns.iter().any(|key| picture.metadata(key).is_some()) {
        return None;
    }
    let numbers = picture.metadata("camera_rapidity")?.split_whitespace();
    let numbers: Vec<f64> = numbers
        .map(|word| word.parse().ok())
        .collect::<Option<_>>()?;
    let [x, y, z] = numbers.try_into().ok()?;
    Velocity::from_rapidity(DVec3::new(x, y, z)).ok()
}

/// An object has to have so many pixels.
const FEWEST: usize = 24;
/// The rms of W's relative error that a fit may leave.
const FITS: f64 = 1e-4;
/// W's relative errors below this are none.
const NOTABLE_RATIO: f64 = 1e-3;

/// Whether (γ, γβ) is a four-velocity: γ² − |γβ|² = 1, to a twentieth of its terms.
fn is_velocity(u: DVec4) -> bool {
    let spatial = u.yzw().length_squared();
    u.x > 0.0 && (u.x * u.x - spatial - 1.0).abs() <= 0.05 * (1.0 + spatial)
}

/// An object's pixels in a picture.
#[derive(Debug, Clone, Default)]
struct Seen {
    /// (1, d), and W γc(1 + βc·d).
    rows: Vec<(DVec4, f64)>,
}

impl Seen {
    /// (γ, γβ); none where the pixels do not determine it.
    fn velocity(&self) -> Option<DVec4> {
        if self.rows.len() < FEWEST {
            return None;
        }
        let (mut normal, mut right) = (DMat4::ZERO, DVec4::ZERO);
        for (row, value) in &self.rows {
            let outer = DMat4::from_cols(*row * row.x, *row * row.y, *row * row.z, *row * row.w);
            normal += outer;
            right += *row * *value;
        }
        let scale = normal.col(0).x;
        let (normal, right) = (normal * (1.0 / scale), right / scale);
        // Tikhonov's term picks the shortest of the velocities that fit equally well.
        let damped = normal + DMat4::from_diagonal(DVec4::splat(1e-12));
        let u = damped.inverse() * right;
        u.is_finite().then_some(u)
    }

    /// The rms of the relative error with which a four-velocity reproduces W.
    fn misfit(&self, u: DVec4) -> f64 {
        let square = |(row, value): &(DVec4, f64)| {
            let e = row.dot(u) / value - 1.0;
            e * e
        };
        let sum: f64 = self.rows.iter().map(square).sum();
        (sum / self.rows.len().max(1) as f64).sqrt()
    }
}

/// Objects whose wavelength ratios are those of another velocity.
pub(super) fn velocities(case: &Case) -> Vec<Diagnosis> {
    let [Some(r), Some(c)] = [0, 1].map(|which| seen(case, which)) else {
        return Vec::new();
    };
    let moved: Vec<Moved> = (r.iter())
        .filter_map(|(object, r)| Moved::of(*object, r, c.get(object)?))
        .collect();
    let mut swapped = Vec::new();
    for (i, a) in moved.iter().enumerate() {
        for b in &moved[i + 1..] {
            swapped.extend(a.swapped_with(b));
        }
    }
    if !swapped.is_empty() {
        return swapped;
    }
    moved.iter().map(Moved::wrong).collect()
}

/// An object whose velocity differs between the pictures.
struct Moved {
    object: i64,
    candidate: Seen,
    /// Four-velocities in the reference and in the candidate.
    velocities: [DVec4; 2],
    /// How well the reference's reproduces W in the candidate.
    error: f64,
}

impl Moved {
    fn of(object: i64, r: &Seen, c: &Seen) -> Option<Moved> {
        let velocities = [r.velocity()?, c.velocity()?];
        let fits = r.misfit(velocities[0]) <= FITS && c.misfit(velocities[1]) <= FITS;
        let error = c.misfit(velocities[0]);
        (fits && is_velocity(velocities[1]) && error > NOTABLE_RATIO).then(|| Moved {
            object,
            candidate: c.clone(),
            velocities,
            error,
        })
    }

    fn swapped_with(&self, other: &Moved) -> Option<Diagnosis> {
        let rest = [
            self.candidate.misfit(other.velocities[0]),
            other.candidate.misfit(self.velocities[0]),
        ];
        let explains = rest[0] <= NEAR * self.error && rest[1] <= NEAR * other.error;
        explains.then(|| Diagnosis {
            kind: Kind::VelocitiesSwapped,
            what: format!(
                "the velocities of objects {} and {} are swapped",
                self.object, other.object
            ),
            evidence: vec![
                ("W differs by (relative, rms)", self.error.max(other.error)),
                ("with swapped velocities by", rest[0].max(rest[1])),
            ],
        })
    }

    fn wrong(&self) -> Diagnosis {
        let beta = |u: DVec4| u.yzw() / u.x;
        let [r, c] = self.velocities.map(beta);
        let text = |b: DVec3| format!("({:.4}, {:.4}, {:.4})", b.x, b.y, b.z);
        let at_rest = self.candidate.misfit(DVec4::X);
        let is_at_rest = at_rest <= NEAR * self.error;
        let object = self.object;
        Diagnosis {
            kind: match is_at_rest {
                true => Kind::VelocityMissing,
                false => Kind::VelocityWrong,
            },
            what: match is_at_rest {
                true => format!(
                    "the velocity of object {object} is missing: its wavelength ratios are those of rest, and should be those of β = {}",
                    text(r)
                ),
                false => format!(
                    "object {object} moves at another velocity: its wavelength ratios are those of β = {}, and should be those of {}",
                    text(c),
                    text(r)
                ),
            },
            evidence: vec![
                ("W differs by (relative, rms)", self.error),
                (
                    "with the other velocity by",
                    self.candidate.misfit(self.velocities[1]).min(at_rest),
                ),
            ],
        }
    }
}

/// The look directions of a picture; where it has none, those from the reference's pinhole to its own events.
fn looks<'a>(case: &Case<'a>, which: usize) -> Option<Box<dyn Fn(usize) -> DVec3 + 'a>> {
    if let Some(direction) = case.points[which].direction {
        return Some(Box::new(move |i| place(&direction, i)));
    }
    let shown = case.points[which].world?;
    let (event, direction) = (case.points[0].world?, case.points[0].direction?);
    let distance = Plane::aov(&case.pair[0].layers, Aov::Distance)?;
    Some(Box::new(move |i| {
        let pinhole = place(&event, i) - place(&direction, i) * distance.at(i);
        (place(&shown, i) - pinhole).normalize()
    }))
}

/// The pixels of each object in a picture; none where it lacks channels or metadata.
fn seen(case: &Case, which: usize) -> Option<BTreeMap<i64, Seen>> {
    let layers = &case.pair[which].layers;
    let ratio = Plane::aov(layers, Aov::WavelengthRatio)?;
    let look = looks(case, which)?;
    let velocity = camera_velocity(case.pair[which]).or_else(|| camera_velocity(case.pair[0]))?;
    let (gamma, beta) = (velocity.gamma(), velocity.beta());
    let mut objects: BTreeMap<i64, Seen> = BTreeMap::new();
    for i in case.pixels() {
        let d = look(i);
        let value = ratio.at(i) * gamma * (1.0 + beta.dot(d));
        if value.is_finite() && value > 0.0 {
            let object = case.points[which].object_at(i).unwrap_or(0.0) as i64;
            let row = DVec4::new(1.0, d.x, d.y, d.z);
            objects.entry(object).or_default().rows.push((row, value));
        }
    }
    Some(objects)
}

/// The most of an object's points that may be off its surface, by events: means over pixels are, where these show several
/// parts of it. Of an object with another velocity fewer are, for its sides move along themselves.
const OFF_SURFACE: f64 = 1.0 / 3.0;
const OFF_BY_VELOCITY: f64 = 0.1;
/// How far the boxes around an object's points may be apart, in parts of the diagonal: other sides of it are seen. Another
/// velocity has to leave this part of what the right one does.
const SAME_BOX: f64 = 0.05;
const NEARER: f64 = 0.3;

/// Objects whose events are those of another velocity, and objects whose events are not on the surface that the reference
/// shows; for candidates that say of events of the world alone. Wrong times put all that moves elsewhere, and are said by themselves.
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
    let mut pixels: BTreeMap<usize, [Vec<usize>; 2]> = BTreeMap::new();
    for i in case.region.pixels(r.size()) {
        for (which, points) in [r, c].into_iter().enumerate() {
            if let Some(object) = points.object_at(i).filter(|object| *object >= 0.0) {
                pixels.entry(object as usize).or_default()[which].push(i);
            }
        }
    }
    let enough = |pixels: &[Vec<usize>; 2]| pixels.iter().all(|pixels| pixels.len() >= FEWEST);
    let found = pixels.iter().filter(|(_, pixels)| enough(pixels));
    found
        .filter_map(|(object, pixels)| off_surface(case, *object, pixels))
        .collect()
}

/// Of the candidate's pixels of an object, those whose points the reference would show, were they on its surface: those at which
/// it shows the object, too, or what is farther away (light from there left earlier), or nothing. Where something nearer hides
/// the object, it says nothing; and pixels at the object's rim may be means of several surfaces.
fn told(case: &Case, object: usize, in_c: &[usize]) -> Vec<usize> {
    let [r, c] = &case.points;
    let [width, height] = r.size();
    let times = case.pair.map(|p| Plane::aov(&p.layers, Aov::EventCt));
    let is_nearer = |i: usize| match times {
        [Some(r), Some(c)] => c.at(i) > r.at(i),
        _ => false,
    };
    let is_inside = |i: usize| {
        let (x, y) = (i % width, i / width);
        let rows = y.saturating_sub(1)..=(y + 1).min(height - 1);
        rows.into_iter().all(|y| {
            let mut row = x.saturating_sub(1)..=(x + 1).min(width - 1);
            row.all(|x| c.object_at(y * width + x) == Some(object as f64))
        })
    };
    let is_told = |i: usize| match r.object_at(i) {
        Some(id) if id == object as f64 => true,
        Some(id) => id < 0.0 || is_nearer(i),
        None => false,
    };
    let inside = in_c.iter().copied().filter(|i| is_inside(*i));
    inside.filter(|i| is_told(*i)).collect()
}

fn off_surface(case: &Case, object: usize, [in_r, in_c]: &[Vec<usize>; 2]) -> Option<Diagnosis> {
    let frame = case.known.and_then(|known| known.frame(object));
    let velocity = frame.map_or(Velocity::REST, InertialFrame::velocity);
    let own = |which: usize, velocity: Velocity| {
        let world = case.points[which].world;
        let time = Plane::aov(&case.pair[which].layers, Aov::EventCt);
        move |i: usize| {
            let x = place(&world?, i);
            // Of what rests, and of scenes that are not known, places say all.
            let Some(frame) = frame.filter(|_| !velocity.is_rest()) else {
                return Some(x - frame.map_or(DVec3::ZERO, |frame| frame.origin().x));
            };
            let event = Event::new(time?.at(i), x);
            let frame = InertialFrame::<Rest>::new(velocity, frame.origin());
            Some(frame.event_from_world(event).x)
        }
    };
    let surface = Cloud::of(in_r, case.points[0].size(), own(0, velocity));
    let with_velocity = another_velocity(&surface, in_r, in_c, velocity, own);
    if let Some((part, reversed, [is, left])) = with_velocity {
        let (kind, what) = match reversed {
            false => (
                Kind::VelocityMissing,
                format!(
                    "the velocity of object {object} is missing: its events are those of its rest"
                ),
            ),
            true => (
                Kind::VelocityWrong,
                format!(
                    "the velocity of object {object} is reversed: its events are those of −β for β"
                ),
            ),
        };
        let evidence = vec![
            (PART_OFF, part),
            ("the box around its points is off by (m)", is),
            ("and with that velocity by (m)", left),
            ("beta", velocity.beta().length()),
        ];
        return Some(Diagnosis {
            kind,
            what,
            evidence,
        });
    }
    let part = surface.part_off(&told(case, object, in_c), own(1, velocity))?;
    (part > OFF_SURFACE).then(|| Diagnosis {
        kind: Kind::ObjectElsewhere,
        what: format!(
            "object {object} is elsewhere: by their events, {:.0} % of its points are not on the surface that the reference shows",
            100.0 * part
        ),
        evidence: vec![(PART_OFF, part)],
    })
}

const PART_OFF: &str = "part of its points that are off the surface";

/// Whether the candidate's events of an object that moves are those of its rest, or (true) of the opposite velocity: the part of
/// its points that are off the surface, and how far the boxes around all points are apart, with the right velocity and that one.
fn another_velocity<P: Fn(usize) -> Option<DVec3>>(
    surface: &Cloud,
    in_r: &[usize],
    in_c: &[usize],
    velocity: Velocity,
    own: impl Fn(usize, Velocity) -> P,
) -> Option<(f64, bool, [f64; 2])> {
    (!velocity.is_rest()).then_some(())?;
    let part = surface.part_off(in_c, own(1, velocity))?;
    let right = bounds(in_r.iter().copied().filter_map(own(0, velocity)));
    let apart = |velocity| {
        let [low, high] = bounds(in_c.iter().copied().filter_map(own(1, velocity)));
        let [low, high] = [low - right[0], high - right[1]];
        low.abs().max(high.abs()).max_element()
    };
    let [is, rest, reversed] = [velocity, Velocity::REST, -velocity].map(apart);
    let nearest = rest.min(reversed);
    let same = SAME_BOX * (right[1] - right[0]).length();
    let is_wrong = part > OFF_BY_VELOCITY || is > same;
    let explains = is_wrong && nearest <= same.min(NEARER * is);
    explains.then_some((part, reversed < rest, [is, nearest]))
}

/// The least box around points.
fn bounds(points: impl Iterator<Item = DVec3>) -> [DVec3; 2] {
    let none = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    let finite = points.filter(|p| p.is_finite());
    finite.fold(none, |[low, high], p| [low.min(p), high.max(p)])
}

/// How much farther than its neighbours a point of the surface reaches: samples lie anywhere in their pixels.
const REACH: f64 = 1.5;
fn longer(a: Option<f64>, b: Option<f64>) -> Option<f64> {
    [a, b].into_iter().flatten().reduce(f64::max)
}

/// Of two steps along an axis the shorter counts where the longer one is more than so many times as long, for that leads from
/// one part of the object to another.
const CONNECTED: f64 = 3.0;

/// The surface that points of neighbouring pixels make: balls around them that reach to the neighbours, across and down, so that
/// they are large where a surface is far away or grazed. They are found by grids whose cells are powers of two.
struct Cloud {
    /// The point of each pixel that shows the object, how far its ball reaches, and the farthest of its neighbours.
    balls: HashMap<usize, Ball>,
    /// Pixels by cell, for each power of two.
    grids: BTreeMap<i32, HashMap<[i64; 3], Vec<usize>>>,
}

/// Cells with more balls are full: what is in them, or beside them, is on the surface.
const FULL: usize = 256;

struct Ball {
    point: DVec3,
    reach: f64,
    farthest: f64,
}

impl Cloud {
    /// That of the points of these pixels of a picture of this size.
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

    /// The power of two that is not below a length.
    fn level(length: f64) -> i32 {
        libm::log2(length).ceil() as i32
    }

    fn cell(p: DVec3, level: i32) -> [i64; 3] {
        let size = libm::exp2(f64::from(level));
        (p / size).to_array().map(|x| x.floor() as i64)
    }

    /// Whether the point that pixel `i` shows is near that of the reference there, or in any ball.
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

    /// The part of the points of these pixels that are not on the surface; none of too few.
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

/// Displacements that are notable, pixels, rms.
const NOTABLE_DISPLACEMENT: f64 = 0.1;

/// Changes of a known scene that explain where the candidate shows points.
pub(super) fn changes(case: &Case) -> Vec<Diagnosis> {
    let Some(known) = case.known else {
        return Vec::new();
    };
    let global = [
        Change::Instant,
        Change::CameraReversed,
        Change::CameraAtRest,
    ];
    if let Some(found) = best(case, known, None, &global) {
        return vec![found];
    }
    let moving: Vec<usize> = (known.velocities().enumerate())
        .filter(|(_, velocity)| !velocity.is_rest())
        .map(|(k, _)| k)
        .filter(|k| displaced(case, known, known, Some(*k)).error() > NOTABLE_DISPLACEMENT)
        .take(MOST_OBJECTS)
        .collect();
    let mut found = Vec::new();
    for (n, &j) in moving.iter().enumerate() {
        let pairs = moving[n + 1..].iter().map(|&k| Change::Swapped(j, k));
        found.extend(pairs.filter_map(|change| best(case, known, Some(j), &[change])));
    }
    if !found.is_empty() {
        return found;
    }
    let of_object = |&k: &usize| {
        best(
            case,
            known,
            Some(k),
            &[Change::AtRest(k), Change::Reversed(k)],
        )
    };
    moving.iter().filter_map(of_object).collect()
}

/// No more moving objects are asked about.
const MOST_OBJECTS: usize = 32;

/// The change that explains best where the candidate shows points (of one object), if one explains most of it.
fn best(
    case: &Case,
    known: &KnownScene,
    object: Option<usize>,
    changes: &[Change],
) -> Option<Diagnosis> {
    let tallies = changes.iter().filter_map(|change| {
        let tally = displaced(case, known, &known.changed(*change)?, object);
        tally
            .explains(NOTABLE_DISPLACEMENT)
            .then_some((*change, tally))
    });
    let (change, tally) = tallies.min_by(|a, b| a.1.rest().total_cmp(&b.1.rest()))?;
    // Of a velocity that two objects have exchanged, both are seen so.
    if let Change::Swapped(_, k) = change {
        let other = displaced(case, known, &known.changed(change)?, Some(k));
        other.explains(NOTABLE_DISPLACEMENT).then_some(())?;
    }
    Some(describe_change(known, change, &tally))
}

/// Distances of the candidate's points from where they are seen, in the scene and in the changed one.
fn displaced(
    case: &Case,
    known: &KnownScene,
    changed: &KnownScene,
    object: Option<usize>,
) -> Tally {
    let points = &case.points[1];
    let [width, _] = points.size();
    let pixels = case.region.pixels(points.size());
    let off = pixels.filter_map(|i| {
        if let Some(object) = object
            && points.object_at(i).is_some_and(|id| id != object as f64)
        {
            return None;
        }
        let centre = DVec2::new((i % width) as f64 + 0.5, (i / width) as f64 + 0.5);
        let shown = changed.place(points, i)?;
        let (k, p) = known.point(points, i)?;
        let right = known.film_point(k, p);
        // A point that is seen nowhere is as far away as the picture is wide.
        let off = right.map_or(width as f64, |right| (right - centre).length());
        Some([off, (shown - centre).length()])
    });
    Tally::of(off)
}

/// What is said of a camera whose light has the aberration of another velocity. Where objects move, light that takes no time may
/// look much like it: both are said where no scene tells them apart.
pub(super) fn describe_aberration_by_light(
    case: &Case,
    change: Change,
    evidence: Vec<(&'static str, f64)>,
) -> Diagnosis {
    let (kind, wrong, place) = match change {
        Change::CameraReversed => (
            Kind::AberrationReversed,
            "aberration is reversed",
            "where a camera sees it that moves the opposite way (−β for β)",
        ),
        _ => (
            Kind::AberrationMissing,
            "aberration is missing",
            "where a camera at rest sees it",
        ),
    };
    let moves = |known: &KnownScene| known.velocities().any(|v| !v.is_rest());
    let may_be_instant = case.scene.is_none() && case.known.is_some_and(moves);
    let (or, tells) = match may_be_instant {
        true => (", or retardation is missing", "; --scene tells which"),
        false => ("", ""),
    };
    Diagnosis {
        kind,
        what: format!("{wrong}{or}: the light is {place}{tells}"),
        evidence,
    }
}

fn describe_change(known: &KnownScene, change: Change, tally: &Tally) -> Diagnosis {
    let beta = |k: usize| known.velocities().nth(k).map_or(0.0, |v| v.beta().length());
    let (kind, what, beta) = match change {
        Change::Instant => (
            Kind::RetardationMissing,
            "retardation is missing: points are shown where they are at the time of the shot, and not where their light left them".into(),
            known.velocities().map(|v| v.beta().length()).fold(0.0, f64::max),
        ),
        Change::CameraReversed => (
            Kind::AberrationReversed,
            "aberration is reversed: points are shown where a camera sees them that moves the opposite way (−β for β)".into(),
            known.camera_velocity().beta().length(),
        ),
        Change::CameraAtRest => (
            Kind::AberrationMissing,
            "aberration is missing: points are shown where a camera at rest sees them".into(),
            known.camera_velocity().beta().length(),
        ),
        Change::AtRest(k) => (
            Kind::VelocityMissing,
            format!("the velocity of object {k} is missing: its points are shown where they are seen at rest"),
            beta(k),
        ),
        Change::Reversed(k) => (
            Kind::VelocityWrong,
            format!("the velocity of object {k} is reversed: its points are shown where they are seen with −β for β"),
            beta(k),
        ),
        Change::Swapped(j, k) => (
            Kind::VelocitiesSwapped,
            format!("the velocities of objects {j} and {k} are swapped: their points are shown where they are seen so"),
            beta(j).max(beta(k)),
        ),
    };
    Diagnosis {
        kind,
        what,
        evidence: vec![
            ("points are displaced by (pixels, rms)", tally.error()),
            ("and from the hypothesis by (pixels, rms)", tally.rest()),
            ("beta", beta),
        ],
    }
}
