//! Why a candidate is wrong: hypotheses that explain most of an error, with their evidence.
//!
//! | diagnosis | hypothesis | explains when |
//! |---|---|---|
//! | aberration reversed, or left out | look directions d′ of the camera's frame are boosted with −β, or not at all | d differs from that by less than a tenth of what it differs from the reference |
//! | velocities swapped, or wrong | W and d of an object's pixels give its four-velocity, see below | the candidate's are those of the other object; or differ while both fit |
//! | emission time shifted | the time differs by a constant | nine tenths of the pixels are within a tenth of the median |
//! | exponent of W wrong | ln(c/r) = k ln W | nine tenths of Σ ln²(c/r), with W itself right |
//! | triangle, or object displaced | δ on one triangle, or one object, alone | nine tenths of Σ\|δ\|², on at most half of the pixels of surfaces |
//!
//! A hypothesis without the channels that it needs is not asked. Where directions or velocities are wrong, what follows
//! from that (time, brightness, places) is not diagnosed again.
//!
//! # Velocities
//!
//! Objects' velocities show in the wavelength ratios with which they are seen.
//!
//! For an object with four-velocity γ(1, β) seen by a camera with γc(1, βc) along the world's look direction d,
//!
//! ```text
//! W = ω_emitted / ω_observed = γ(1 + β·d) / (γc(1 + βc·d))
//! ```
//!
//! so that W γc(1 + βc·d) is linear in d: a least squares fit over the object's pixels gives γ and γβ. An
//! object that takes up little of the view determines them badly; so hypotheses are compared by how well they
//! reproduce W where the object is seen, not by the fitted numbers.

use std::collections::BTreeMap;

use glam::{DMat4, DVec2, DVec3, DVec4, Vec4Swizzles};
use serde::Serialize;

use super::geometry::{Field, Points, place};
use super::options::Region;
use super::picture::{Picture, Plane, RADIANCE};
use crate::spacetime::{Boost, Camera, Direction, Velocity, World};

/// The part of an error that a hypothesis has to explain.
const MOST: f64 = 0.9;

/// What is wrong with a candidate, and how one sees it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Diagnosis {
    /// Which hypothesis.
    pub kind: Kind,
    /// What is wrong, as a sentence.
    pub what: String,
    /// Names and values of the evidence.
    pub evidence: Vec<(&'static str, f64)>,
}

/// What can be diagnosed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// Look directions are boosted with the opposite velocity.
    AberrationReversed,
    /// Look directions are those of the camera's frame.
    AberrationMissing,
    /// Two objects have each other's velocity.
    VelocitiesSwapped,
    /// An object has another velocity.
    VelocityWrong,
    /// Emission times are shifted by a constant.
    TimeShifted,
    /// The radiance factor has another exponent.
    ExponentWrong,
    /// One triangle is displaced.
    TriangleDisplaced,
    /// One object is displaced.
    ObjectDisplaced,
}

/// What the hypotheses are asked of.
#[derive(Debug, Clone, Copy)]
struct Case<'a> {
    pair: [&'a Picture; 2],
    points: [Points<'a>; 2],
    region: &'a Region,
    /// Width of a time bin, metres of light path.
    bin_width: Option<f64>,
}

/// All diagnoses of a candidate.
pub(super) fn diagnose(
    pair: [&Picture; 2],
    region: &Region,
    bin_width: Option<f64>,
) -> Vec<Diagnosis> {
    let case = Case {
        pair,
        points: pair.map(|picture| Points::new(&picture.layers)),
        region,
        bin_width,
    };
    let causes: Vec<Diagnosis> = aberration(&case).into_iter().collect();
    if !causes.is_empty() {
        return causes;
    }
    let causes = motion(&case);
    if !causes.is_empty() {
        return causes;
    }
    let effects = [time(&case), exponent(&case), displaced(&case)];
    effects.into_iter().flatten().collect()
}

impl Case<'_> {
    /// Pixels of the region at which both pictures show the same object.
    fn pixels(&self) -> Vec<usize> {
        let [r, c] = &self.points;
        let pixels = self.region.pixels(r.size());
        pixels.filter(|i| r.same_object(c, *i)).collect()
    }
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    let middle = values.len() / 2;
    let inside = middle < values.len();
    inside.then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

const DIRECTION: [&str; 3] = ["direction.x", "direction.y", "direction.z"];
/// A hypothesis has to bring directions, or W, nearer than this part of their error.
const NEAR: f64 = 0.1;
/// Errors of directions that storage in single precision makes, radians.
const DIRECTION_ROUNDING: f64 = 1e-5;

fn aberration(case: &Case) -> Option<Diagnosis> {
    let [r, c] = case
        .pair
        .map(|picture| Plane::group(&picture.layers, DIRECTION));
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
fn camera_velocity(picture: &Picture) -> Option<Velocity> {
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

fn motion(case: &Case) -> Vec<Diagnosis> {
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
        (fits && error > NOTABLE_RATIO).then(|| Moved {
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
        Diagnosis {
            kind: Kind::VelocityWrong,
            what: format!(
                "object {} moves at another velocity: its wavelength ratios are those of β = {}, and should be those of {}",
                self.object,
                text(c),
                text(r)
            ),
            evidence: vec![
                ("W differs by (relative, rms)", self.error),
                (
                    "with the other velocity by",
                    self.candidate.misfit(self.velocities[1]),
                ),
            ],
        }
    }
}

/// The pixels of each object in a picture; none where it lacks channels or metadata.
fn seen(case: &Case, which: usize) -> Option<BTreeMap<i64, Seen>> {
    let layers = &case.pair[which].layers;
    let ratio = Plane::find(layers, "wavelength_ratio")?;
    let direction = Plane::group(layers, DIRECTION)?;
    let velocity = camera_velocity(case.pair[which]).or_else(|| camera_velocity(case.pair[0]))?;
    let (gamma, beta) = (velocity.gamma(), velocity.beta());
    let mut objects: BTreeMap<i64, Seen> = BTreeMap::new();
    for i in case.pixels() {
        let d = place(&direction, i);
        let value = ratio.at(i) * gamma * (1.0 + beta.dot(d));
        if value.is_finite() && value > 0.0 {
            let object = case.points[which].object_at(i).unwrap_or(0.0) as i64;
            let row = DVec4::new(1.0, d.x, d.y, d.z);
            objects.entry(object).or_default().rows.push((row, value));
        }
    }
    Some(objects)
}

/// Shifts below this part of the times themselves are rounding of single precision.
const TIME_ROUNDING: f64 = 1e-6;
/// Pixels within this part of the median shift share it.
const SHARED: f64 = 0.1;

fn time(case: &Case) -> Option<Diagnosis> {
    let [r, c] = [case.points[0].time?, case.points[1].time?];
    let pixels = case.pixels();
    let shifts: Vec<f64> = pixels
        .iter()
        .map(|i| c.at(*i) - r.at(*i))
        .filter(|d| d.is_finite())
        .collect();
    let scale = pixels
        .iter()
        .map(|i| r.at(*i).abs())
        .filter(|t| t.is_finite())
        .fold(0.0, f64::max);
    let count = shifts.len() as f64;
    let shift = median(shifts.clone())?;
    let share = shifts
        .iter()
        .filter(|d| (*d - shift).abs() <= SHARED * shift.abs())
        .count() as f64
        / count;
    let explains = shift.abs() > TIME_ROUNDING * scale && share >= MOST;
    explains.then(|| describe_shift(case, shift, share))
}

fn describe_shift(case: &Case, shift: f64, share: f64) -> Diagnosis {
    let late = if shift > 0.0 { "late" } else { "early" };
    let bins = case.bin_width.map(|width| shift.abs() / width);
    let amount = match bins {
        Some(bins) if (bins - 1.0).abs() < SHARED => "by one bin".into(),
        Some(bins) => format!("by {bins:.3} bins"),
        None => format!("by {:.6} m of light path", shift.abs()),
    };
    let mut evidence = vec![
        ("median shift (m)", shift),
        ("share of pixels with it", share),
    ];
    evidence.extend(bins.map(|bins| ("shift (bins)", bins)));
    Diagnosis {
        kind: Kind::TimeShifted,
        what: format!("emission times are too {late} {amount}, everywhere alike"),
        evidence,
    }
}

/// Pixels that have to have light, and an exponent that is notable.
const FEWEST_LIT: usize = 24;
const NOTABLE_EXPONENT: f64 = 0.2;
/// The rms of ln W that is needed to tell, and the relative error up to which W itself is right.
const SPREAD: f64 = 0.01;
const W_IS_RIGHT: f64 = 1e-3;

fn exponent(case: &Case) -> Option<Diagnosis> {
    let [light_r, light_c] = case.pair.map(|p| Plane::group(&p.layers, RADIANCE));
    let (light_r, light_c) = (light_r?, light_c?);
    let [w_r, w_c] = case
        .pair
        .map(|p| Plane::find(&p.layers, "wavelength_ratio"));
    let w_r = w_r?;
    let sum = |planes: &[Plane; 3], i: usize| planes.iter().map(|p| p.at(i)).sum::<f64>();
    let (mut xx, mut xy, mut yy, mut count, mut wrong) = (0.0, 0.0, 0.0, 0usize, 0usize);
    for i in case.pixels() {
        let (r, c, w) = (sum(&light_r, i), sum(&light_c, i), w_r.at(i));
        if !(r > 0.0 && c > 0.0 && w > 0.0 && (r + c + w).is_finite()) {
            continue;
        }
        let (x, y) = (libm::log(w), libm::log(c / r));
        (xx, xy, yy) = (xx + x * x, xy + x * y, yy + y * y);
        count += 1;
        wrong += usize::from(w_c.is_some_and(|w_c| (w_c.at(i) / w - 1.0).abs() > W_IS_RIGHT));
    }
    let spread = (xx / count.max(1) as f64).sqrt();
    if count < FEWEST_LIT || spread < SPREAD || wrong * 10 > count {
        return None;
    }
    let exponent = xy / xx;
    let explained = xy * xy / (xx * yy);
    (exponent.abs() >= NOTABLE_EXPONENT && explained >= MOST)
        .then(|| describe_exponent(exponent, explained, count))
}

fn describe_exponent(exponent: f64, explained: f64, count: usize) -> Diagnosis {
    let whole = exponent.round();
    let amount = match (exponent - whole).abs() < 0.1 && whole != 0.0 {
        true => format!("{whole:+}"),
        false => format!("{exponent:+.2}"),
    };
    Diagnosis {
        kind: Kind::ExponentWrong,
        what: format!(
            "the exponent of W in the radiance factor is off by {amount}: candidate / reference = W^({amount})"
        ),
        evidence: vec![
            ("fitted exponent of the ratio", exponent),
            ("share of the error explained", explained),
            ("pixels with light", count as f64),
        ],
    }
}

/// Displacements that are notable, pixels.
const NOTABLE_DISPLACEMENT: f64 = 0.01;
/// The most of the pixels with surfaces that a part may take.
const LARGEST_PART: f64 = 0.5;

/// Displacements on one part of the picture.
#[derive(Debug, Default)]
struct Part {
    square: f64,
    found: Vec<DVec2>,
}

fn displaced(case: &Case) -> Option<Diagnosis> {
    let fields = [Field::new(&case.points), Field::on_triangles(&case.points)];
    fields
        .into_iter()
        .flatten()
        .find_map(|field| localised(case, &field))
}

fn localised(case: &Case, field: &Field) -> Option<Diagnosis> {
    let pixels = case.pixels();
    let [mut triangles, mut objects] = [BTreeMap::<_, Part>::new(), BTreeMap::new()];
    let points = &case.points[0];
    let mut total = 0.0;
    for &i in &pixels {
        let Some(d) = field.displacement(i) else {
            continue;
        };
        let object = points.object_at(i).unwrap_or(-1.0) as i64;
        let triangle = points.primitive.map_or(-1, |p| p.at(i) as i64);
        total += d.length_squared();
        for part in [
            triangles.entry((object, triangle)).or_default(),
            objects.entry((object, -1)).or_default(),
        ] {
            part.square += d.length_squared();
            part.found.push(d);
        }
    }
    let has_triangles = points.primitive.is_some();
    let triangle = worst(&triangles, total, pixels.len()).filter(|_| has_triangles);
    let object = worst(&objects, total, pixels.len());
    let (kind, ((object, triangle), part)) = match triangle {
        Some(found) => (Kind::TriangleDisplaced, found),
        None => (Kind::ObjectDisplaced, object?),
    };
    describe_part(kind, [object, triangle], part, total)
}

type Name = (i64, i64);

/// The part that has most of the displacement and little of the picture.
fn worst(parts: &BTreeMap<Name, Part>, total: f64, pixels: usize) -> Option<(Name, &Part)> {
    let (name, part) = parts
        .iter()
        .max_by(|a, b| a.1.square.total_cmp(&b.1.square))?;
    let small = part.found.len() as f64 <= LARGEST_PART * pixels as f64;
    (small && part.square >= MOST * total).then_some((*name, part))
}

fn describe_part(
    kind: Kind,
    [object, triangle]: [i64; 2],
    part: &Part,
    total: f64,
) -> Option<Diagnosis> {
    let middle = |of: fn(&DVec2) -> f64| median(part.found.iter().map(of).collect());
    // A point that belongs to the right is seen displaced to the left.
    let [x, y, length] = [
        middle(|d| -d.x)?,
        middle(|d| -d.y)?,
        middle(|d| d.length())?,
    ];
    let place = match kind {
        Kind::TriangleDisplaced => format!("triangle {triangle} of object {object}"),
        _ => format!("object {object}"),
    };
    (length > NOTABLE_DISPLACEMENT).then(|| Diagnosis {
        kind,
        what: format!("{place} is displaced by {length:.2} pixels, ({x:+.2}, {y:+.2}) to the right and down; the rest is where it should be"),
        evidence: vec![
            ("median displacement (pixels)", length),
            ("share of the displacement", part.square / total),
            ("pixels", part.found.len() as f64),
        ],
    })
}
