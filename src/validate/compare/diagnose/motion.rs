//! Wrong velocities of objects and the camera, from wavelength ratios, and from where points of a known scene are shown. From look
//! directions: `looks`; from world events: `events`.
//!
//! # By wavelength ratios
//!
//! For an object with four-velocity γ(1, β) seen by a camera with γc(1, βc) along the world's look direction d,
//!
//! ```text
//! W = ω_emitted / ω_observed = γ(1 + β·d) / (γc(1 + βc·d))
//! ```
//!
//! so that W γc(1 + βc·d) is linear in d: a least squares fit over the object's pixels gives (γ, γβ). It is a four-velocity only if γ² −
//! |γβ|² = 1: a W that is wrong by a factor gives no velocity. An object that covers little of the view determines them poorly, so
//! hypotheses are compared by how well they reproduce W where the object is seen, not by the fitted numbers. In the frame of the camera the
//! same holds for its own look directions with γc = 1 and βc = 0.
//!
//! # By places
//!
//! In a known scene the map π from points of objects to the film is known for any velocity of the camera and of the objects, and for light
//! that takes no time. The candidate's points are seen where it shows them under the change that was made.

use std::collections::BTreeMap;

use glam::{DMat4, DVec2, DVec3, DVec4, Vec4Swizzles};
use rayon::prelude::*;

use super::super::known::{Change, KnownScene};
use super::super::picture::{Picture, Plane};
use super::super::points::{FEWEST_OF_OBJECT, place};
use super::displacement::{NOTABLE_DISPLACEMENT, displaced, displaced_if_promising};
use super::{Case, Diagnosis, Kind, NEAR, Tally, median};
use crate::error::{Message, Setting};
use crate::render::aov::Aov;
use crate::spacetime::{Boost, CameraFrame, Displacement, Velocity, World};

/// The velocity of a camera that moves without acceleration or rotation, from the picture's metadata.
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

/// The fewest pixels of an object.
pub(super) const FEWEST: usize = 24;
/// The largest rms relative error of W that a fit may leave.
const FITS: f64 = 1e-4;
/// The smallest notable relative error of W.
const NOTABLE_RATIO: f64 = 1e-3;

/// Four-velocities satisfy γ² − |γβ|² = 1, to this fraction of its terms: the first where pixels determine it poorly, the second where one
/// factor on W would do as well.
const OF_VELOCITY: f64 = 0.05;
const OF_VELOCITY_OR_FACTOR: f64 = 0.002;

/// Whether (γ, γβ) is a four-velocity.
fn is_velocity(u: DVec4, precision: f64) -> bool {
    let spatial = u.yzw().length_squared();
    u.x > 0.0 && (u.x * u.x - spatial - 1.0).abs() <= precision * (1.0 + spatial)
}

/// The text for a velocity.
pub(super) fn in_words(beta: DVec3) -> String {
    let [x, y, z] = beta.to_array().map(rounded);
    format!("({x:.4}, {y:.4}, {z:.4})")
}

/// A number rounded to four decimals, without −0.
pub(super) fn rounded(v: f64) -> f64 {
    (1e4 * v).round() / 1e4 + 0.0
}

/// An object's pixels in a picture.
#[derive(Debug, Clone, Default)]
struct ObjectRatios {
    /// (1, d), and W γc(1 + βc·d).
    rows: Vec<(DVec4, f64)>,
}

impl ObjectRatios {
    /// (γ, γβ); `None` if the pixels do not determine it.
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
        // Tikhonov regularization picks the shortest of the velocities that fit equally well.
        let damped = normal + DMat4::from_diagonal(DVec4::splat(1e-12));
        let u = damped.inverse() * right;
        u.is_finite().then_some(u)
    }

    /// The most common factor of W on the value that a four-velocity predicts.
    fn factor(&self, u: DVec4) -> Option<f64> {
        median(
            self.rows
                .iter()
                .map(|(row, value)| value / row.dot(u))
                .collect(),
        )
    }

    /// The rms relative error with which a four-velocity reproduces W.
    fn misfit(&self, u: DVec4) -> f64 {
        let square = |(row, value): &(DVec4, f64)| {
            let e = row.dot(u) / value - 1.0;
            e * e
        };
        let sum: f64 = self.rows.iter().map(square).sum();
        (sum / self.rows.len().max(1) as f64).sqrt()
    }
}

/// Objects whose wavelength ratios match another velocity.
pub(super) fn velocities(case: &Case) -> Vec<Diagnosis> {
    let [Some(r), Some(c)] = [0, 1].map(|which| object_ratios(case, which)) else {
        return camera_by_ratios_alone(case).into_iter().collect();
    };
    if let Some(found) = another_camera(case, &r, &c) {
        // Where points are seen is better evidence, if known.
        let by_places = changes(case);
        return match by_places.is_empty() {
            true => vec![found],
            false => by_places,
        };
    }
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
    // In a narrow view, another camera and other velocities of all objects may give the same W.
    let may_be_camera = moved.is_empty() || moved.len() > 1 && moved.len() == r.len();
    let by_camera = may_be_camera.then(|| fitted_camera(case, &r, &c)).flatten();
    match by_camera {
        Some(found) => vec![found],
        None => moved.iter().map(Moved::wrong).collect(),
    }
}

/// Wavelength ratios of all objects that match a camera at rest, or moving in the opposite direction.
fn another_camera(
    case: &Case,
    r: &BTreeMap<i64, ObjectRatios>,
    c: &BTreeMap<i64, ObjectRatios>,
) -> Option<Diagnosis> {
    let camera = camera_velocity(case.pair[0])?;
    let (gamma, beta) = (camera.gamma(), camera.beta());
    let mut objects = Vec::new();
    for (object, c) in c {
        let r = r.get(object).filter(|r| r.rows.len() >= FEWEST);
        if let Some(u) = r.and_then(ObjectRatios::velocity) {
            objects.push((u, &c.rows));
        }
    }
    // W γc(1 + βc·d), with the candidate's W, over γ(1 + β·d): 1 if it is right. With another camera, W times that camera's factor is.
    let tally = |other: fn(f64) -> f64, gamma_of_other: f64| {
        let pixels = objects
            .par_iter()
            .flat_map_iter(|(u, rows)| rows.iter().map(move |row| (u, row)));
        Tally::of(pixels.map(|(u, (row, value))| {
            let along = beta.dot(row.yzw());
            let is = libm::log(value / row.dot(*u));
            let factor = gamma_of_other * (1.0 + other(along)) / (gamma * (1.0 + along));
            [is.abs(), (is + libm::log(factor)).abs()]
        }))
    };
    let hypotheses = [
        ("at rest", tally(|_| 0.0, 1.0)),
        (
            "that moves in the opposite direction (−β for β)",
            tally(|along| -along, gamma),
        ),
    ];
    let explaining = hypotheses.into_iter();
    let explaining = explaining.filter(|(_, tally)| tally.explains(NOTABLE_RATIO));
    let (which, tally) = explaining.min_by(|a, b| a.1.rest().total_cmp(&b.1.rest()))?;
    Some(describe_camera(which, &tally, camera))
}

fn describe_camera(which: &str, tally: &Tally, camera: Velocity) -> Diagnosis {
    Diagnosis {
        kind: Kind::RatioOfCamera,
        what: format!("wavelength ratios are those of a camera {which}").into(),
        evidence: vec![
            ("ln W differs by (rms)", tally.error()),
            ("and from the hypothesis by", tally.rest()),
            ("beta of the camera", camera.beta().length()),
        ],
    }
}

/// Wavelength ratios of all objects that match a camera with any other velocity: γc(1 + βc·d) = γ(1 + β·d)/W is linear in its
/// four-velocity.
fn fitted_camera(
    case: &Case,
    r: &BTreeMap<i64, ObjectRatios>,
    c: &BTreeMap<i64, ObjectRatios>,
) -> Option<Diagnosis> {
    let camera = camera_velocity(case.pair[0])?;
    let [mut right, mut is] = [ObjectRatios::default(), ObjectRatios::default()];
    for (object, c) in c {
        let Some(u) = r.get(object).and_then(ObjectRatios::velocity) else {
            continue;
        };
        for (row, value) in &c.rows {
            let along = camera.gamma() * (1.0 + camera.beta().dot(row.yzw()));
            right.rows.push((*row, along));
            is.rows.push((*row, row.dot(u) * along / value));
        }
    }
    let moved = Moved::of(0, &right, &is)?;
    let tally = Tally::of(is.rows.par_iter().map(|(row, value)| {
        let off = |u: DVec4| libm::log(value / row.dot(u)).abs();
        moved.velocities.map(off)
    }));
    let [was, is] = moved.velocities.map(|u| in_words(u.yzw() / u.x));
    let which = format!("with β = {is}, and should be those of one with {was}");
    (tally.explains(NOTABLE_RATIO)).then(|| describe_camera(&which, &tally, camera))
}

/// (γ, γβ).
fn four_velocity(velocity: Velocity) -> DVec4 {
    let gamma = velocity.gamma();
    (gamma * velocity.beta()).extend(gamma).wxyz()
}

/// A four-velocity of the world in the frame of a camera.
fn seen_by(camera: Velocity, u: DVec4) -> DVec4 {
    let camera_from_world = Boost::<CameraFrame, World>::new(-camera);
    let seen = camera_from_world.displacement(Displacement::new(u.x, u.yzw()));
    seen.x.extend(seen.ct).wxyz()
}

/// The velocity of the camera in whose frame the four-velocity `u` of the world is `seen`. The boost is P X P with the positive matrix
/// P ∝ cosh ½ζ − sinh ½ζ n·σ, X the matrix of a four-vector; P is the geometric mean of those of u⁻¹ and `seen`, which is proportional
/// to their sum, as both have the determinant 1. So n tanh ½ζ = (γβ − γ′β′)/(γ + γ′).
fn boost_between(u: DVec4, seen: DVec4) -> Option<Velocity> {
    let half = (u.yzw() - seen.yzw()) / (u.x + seen.x);
    let length = half.length();
    (length < 1.0).then_some(())?;
    match length == 0.0 {
        true => Some(Velocity::REST),
        false => Velocity::from_rapidity_along(2.0 * libm::atanh(length), half / length).ok(),
    }
}

/// The camera with another velocity whose wavelength ratios a candidate holds that says neither where its pixels look nor what they show.
/// An object's four-velocity γ′(1, β′) in the frame of that camera follows from W = γ′(1 + β′·d′) along the film's own look directions d′,
/// and the camera's velocity from this and the object's velocity in the world.
fn camera_by_ratios_alone(case: &Case) -> Option<Diagnosis> {
    let ratio = Plane::aov(&case.pair[1].layers, Aov::WavelengthRatio)?;
    let known = case.known.filter(|_| directions(case, 1).is_none())?;
    let velocities: Vec<Velocity> = known.velocities().collect();
    let is_common = velocities.windows(2).all(|pair| pair[0] == pair[1]);
    let object_at = |i: usize| match is_common {
        true => Some(0.0),
        false => case.points[1].object_at(i),
    };

    let width = case.points[1].width;
    let mut objects: BTreeMap<usize, ObjectRatios> = BTreeMap::new();
    for &i in case.pixels() {
        let centre = DVec2::new((i % width) as f64 + 0.5, (i / width) as f64 + 0.5);
        let object = object_at(i).filter(|id| *id >= 0.0).map(|id| id as usize);
        let seen = object.filter(|k| *k < velocities.len() && ratio.at(i) > 0.0);
        if let (Some(object), Some(d)) = (seen, known.own_look_along(centre)) {
            let rows = &mut objects.entry(object).or_default().rows;
            rows.push((DVec4::new(1.0, d.x, d.y, d.z), ratio.at(i)));
        }
    }
    let (most, pixels) = objects.iter().max_by_key(|(_, of)| of.rows.len())?;
    let seen = pixels.velocity()?;
    is_velocity(seen, OF_VELOCITY_OR_FACTOR).then_some(())?;
    let is = boost_between(four_velocity(velocities[*most]), seen)?;

    let tally = Tally::of(objects.par_iter().flat_map_iter(|(object, of)| {
        let world = four_velocity(velocities[*object]);
        let both = [known.camera_velocity(), is].map(|camera| seen_by(camera, world));
        let rows = of.rows.iter();
        rows.map(move |(row, ratio)| both.map(|u| libm::log(ratio / row.dot(u)).abs()))
    }));
    let right = known.camera_velocity().beta();
    let is = is.beta();
    // A camera that is turned sees the same W as one whose velocity is turned the other way.
    let or = match (is.length() - right.length()).abs() < 1e-3 {
        true => ", or of one that is turned",
        false => "",
    };
    let which = format!(
        "with β = {}, and should be those of one with {}{or}",
        in_words(is),
        in_words(right)
    );
    (tally.explains(NOTABLE_RATIO))
        .then(|| describe_camera(&which, &tally, known.camera_velocity()))
}

/// An object whose velocity differs between the pictures.
struct Moved {
    object: i64,
    candidate: ObjectRatios,
    /// Four-velocities in the reference and in the candidate.
    velocities: [DVec4; 2],
    /// The error with which the reference's velocity reproduces W in the candidate.
    error: f64,
}

impl Moved {
    fn of(object: i64, r: &ObjectRatios, c: &ObjectRatios) -> Option<Moved> {
        let velocities = [r.velocity()?, c.velocity()?];
        let fits = r.misfit(velocities[0]) <= FITS && c.misfit(velocities[1]) <= FITS;
        let error = c.misfit(velocities[0]);
        let scaled = c.factor(velocities[0])? * velocities[0];
        let precision = match c.misfit(scaled) <= NEAR * error {
            true => OF_VELOCITY_OR_FACTOR,
            false => OF_VELOCITY,
        };
        let [was, is] = velocities.map(|u| in_words(u.yzw() / u.x));
        let is_velocity = is_velocity(velocities[1], precision) && was != is;
        (fits && is_velocity && error > NOTABLE_RATIO).then(|| Moved {
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
            )
            .into(),
            evidence: vec![
                ("W differs by (relative, rms)", self.error.max(other.error)),
                ("with swapped velocities by", rest[0].max(rest[1])),
            ],
        })
    }

    fn wrong(&self) -> Diagnosis {
        let beta = |u: DVec4| u.yzw() / u.x;
        let [r, c] = self.velocities.map(beta);
        let text = in_words;
        let at_rest = self.candidate.misfit(DVec4::X);
        // If rest explains the candidate, its program ignored the velocity.
        let is_at_rest = at_rest <= NEAR * self.error;
        let object = self.object;
        Diagnosis {
            kind: match is_at_rest {
                true => Kind::VelocityMissing,
                false => Kind::VelocityWrong,
            },
            what: match is_at_rest {
                true => format!(
                    "the velocity of object {object} is missing: its wavelength ratios are those of the object at rest, and should be those of β = {}",
                    text(r)
                ),
                false => format!(
                    "object {object} moves at another velocity: its wavelength ratios are those of β = {}, and should be those of {}",
                    text(c),
                    text(r)
                ),
            }
            .into(),
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

/// The look directions of a picture; if it has none, those from the reference's pinhole to its own events.
fn directions<'a>(case: &Case<'a>, which: usize) -> Option<Box<dyn Fn(usize) -> DVec3 + 'a>> {
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

/// The pixels of each object in a picture; `None` if channels or metadata are missing.
fn object_ratios(case: &Case, which: usize) -> Option<BTreeMap<i64, ObjectRatios>> {
    let layers = &case.pair[which].layers;
    let ratio = Plane::aov(layers, Aov::WavelengthRatio)?;
    let direction = directions(case, which)?;
    let velocity = camera_velocity(case.pair[which]).or_else(|| camera_velocity(case.pair[0]))?;
    let (gamma, beta) = (velocity.gamma(), velocity.beta());
    let mut objects: BTreeMap<i64, ObjectRatios> = BTreeMap::new();
    for &i in case.pixels() {
        let d = direction(i);
        // W γ (1 + β·d) of the camera is linear in the object's four-velocity (γ, γβ).
        let value = ratio.at(i) * gamma * (1.0 + beta.dot(d));
        if value.is_finite() && value > 0.0 {
            // A candidate without indices is told by the reference's.
            let shown = case.points[which]
                .object_at(i)
                .or_else(|| case.points[0].object_at(i));
            let object = shown.unwrap_or(0.0) as i64;
            let row = DVec4::new(1.0, d.x, d.y, d.z);
            objects.entry(object).or_default().rows.push((row, value));
        }
    }
    Some(objects)
}

/// Changes of a known scene that explain where the candidate shows points.
pub(super) fn changes(case: &Case) -> Vec<Diagnosis> {
    let Some(known) = case.known else {
        return Vec::new();
    };
    if let Some(found) = of_all(case) {
        return vec![found];
    }
    let moving: Vec<usize> = (known.velocities().enumerate())
        .filter(|(_, velocity)| !velocity.is_rest())
        .map(|(k, _)| k)
        .filter(|k| displaced(case, known, known, Some(*k)).error() > NOTABLE_DISPLACEMENT)
        .take(MOST_OBJECTS)
        .collect();
    // Pairs before single objects: two exchanged velocities also look like two wrong ones.
    let mut found = Vec::new();
    let (_, gone) = moving_and_gone(case, known);
    for (n, &j) in moving.iter().enumerate() {
        let others = moving[n + 1..].iter().chain(&gone);
        let pairs = others.map(|&k| Change::Swapped(j, k));
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
            &[Change::AtRest(k), Change::Reversed(k), Change::Standing(k)],
        )
    };
    moving.iter().filter_map(of_object).collect()
}

/// The change of the camera, of time, or of all objects that explains where the candidate shows points.
pub(super) fn of_all(case: &Case) -> Option<Diagnosis> {
    let changes = [
        Change::Instant,
        Change::Advanced,
        Change::CameraReversed,
        Change::CameraAtRest,
        Change::CameraWithoutGamma,
        Change::Uncontracted,
    ];
    best(case, case.known?, None, &changes)
}

/// The most moving objects that are tested.
const MOST_OBJECTS: usize = 32;

/// The change that best explains where the candidate shows points (of one object), if one explains most of it.
fn best(
    case: &Case,
    known: &KnownScene,
    object: Option<usize>,
    changes: &[Change],
) -> Option<Diagnosis> {
    let tallies = changes.iter().filter_map(|change| {
        let tally = displaced_if_promising(case, known, &known.changed(*change)?, object);
        is_explained(&tally).then_some((*change, tally))
    });
    let (change, tally) = tallies.min_by(|a, b| a.1.rest().total_cmp(&b.1.rest()))?;
    // If two objects have exchanged their velocities, both are seen so, or one is out of view as a result.
    if let Change::Swapped(j, k) = change {
        let swapped = known.changed(change)?;
        let other = if object == Some(k) { j } else { k };
        let seen = displaced_if_promising(case, known, &swapped, Some(other));
        let is_seen = is_explained(&seen);
        (is_seen || is_gone(case, other) && is_out_of_view(case, &swapped, other)).then_some(())?;
    }
    Some(describe_change(known, change, &tally))
}

/// The largest rms displacement, in pixels, that a change may leave, whatever it was before: as much as rasterizers of a few large
/// triangles cause, and less than another velocity.
const LEFT_BY_CHANGE: f64 = 2.0;

fn is_explained(tally: &Tally) -> bool {
    tally.explains(NOTABLE_DISPLACEMENT) && tally.rest() <= LEFT_BY_CHANGE
}

/// Whether the reference shows an object that the candidate does not show.
pub(super) fn is_gone(case: &Case, object: usize) -> bool {
    let shows = |which: usize| {
        let points = &case.points[which];
        let pixels = case.region.pixels(points.size());
        let of_object = pixels.filter(|i| points.object_at(*i) == Some(object as f64));
        of_object.count() as u64
    };
    shows(0) >= FEWEST_OF_OBJECT && shows(1) == 0
}

/// Whether all points of an object that the reference shows are out of view in the changed scene.
pub(super) fn is_out_of_view(case: &Case, changed: &KnownScene, object: usize) -> bool {
    let points = &case.points[0];
    let size = points.size().map(|n| n as f64);
    let pixels = case.region.pixels(points.size());
    let mut seen = pixels.filter_map(|i| {
        let (k, p) = case.known?.point(points, i)?;
        (k == object).then_some(())?;
        let seen = changed.film_point(k, p);
        let inside = |p: DVec2| (0.0..size[0]).contains(&p.x) && (0.0..size[1]).contains(&p.y);
        Some(seen.is_some_and(inside))
    });
    let first = seen.next();
    first == Some(false) && !seen.any(|is_inside| is_inside)
}

/// The changes of an object, of the camera, or of the whole scene, that move it out of view.
pub(super) fn out_of_view(case: &Case, object: usize) -> Vec<&'static str> {
    let changes = [
        (Change::Instant, "light that takes no time"),
        (Change::Advanced, "retardation of the opposite sign"),
        (Change::CameraReversed, "aberration that is reversed"),
        (Change::CameraAtRest, "aberration that is missing"),
        (Change::AtRest(object), "a velocity that is missing"),
        (
            Change::Reversed(object),
            "a velocity that is reversed (−β for β)",
        ),
    ];
    let puts_out = |change: Change| {
        let changed = case.known.and_then(|known| known.changed(change));
        changed.is_some_and(|changed| is_out_of_view(case, &changed, object))
    };
    let changes = changes.into_iter();
    changes
        .filter(|(change, _)| puts_out(*change))
        .map(|(_, words)| words)
        .collect()
}

/// Light that arrives from the future, where it puts all objects out of view that show by their places that it does: of those that rest,
/// only the times have the opposite sign, if the shot is at ct = 0.
pub(super) fn advanced_out_of_view(
    case: &Case,
    found: &[Diagnosis],
    gone: &[usize],
) -> Option<Diagnosis> {
    let sign = found.first()?;
    let are_signs = found.iter().all(|found| found.kind == Kind::SignOpposite);
    (are_signs && !gone.is_empty()).then_some(())?;
    let advanced = case.known?.changed(Change::Advanced)?;
    let is_out = |object: &usize| is_out_of_view(case, &advanced, *object);
    gone.iter().all(is_out).then(|| {
        let objects: Vec<String> = gone.iter().map(usize::to_string).collect();
        let [objects, are] = match gone.len() {
            1 => [format!("object {}", objects[0]), "is".into()],
            _ => [format!("objects {}", objects.join(", ")), "are".into()],
        };
        Diagnosis {
            kind: Kind::RetardationReversed,
            what: format!(
                "{ADVANCED}: times are after the shot, and {objects} {are} out of view as a result"
            )
            .into(),
            evidence: sign.evidence.clone(),
        }
    })
}

/// Objects that are out of view because their velocity is exchanged with that of an object in view.
pub(super) fn gone_by_exchange(case: &Case) -> Vec<usize> {
    let Some(known) = case.known else {
        return Vec::new();
    };
    let (moving, gone) = moving_and_gone(case, known);
    let is_exchanged = |k: &usize| {
        let exchanged = |j: &usize| best(case, known, Some(*j), &[Change::Swapped(*j, *k)]);
        moving.iter().any(|j| exchanged(j).is_some())
    };
    gone.into_iter().filter(is_exchanged).collect()
}

/// Objects whose points are not where they should be seen, and missing objects.
fn moving_and_gone(case: &Case, known: &KnownScene) -> (Vec<usize>, Vec<usize>) {
    let is_off = |k: usize| displaced(case, known, known, Some(k)).error() > NOTABLE_DISPLACEMENT;
    let all = 0..known.velocities().count();
    let moving = all
        .clone()
        .filter(|k| is_off(*k))
        .take(MOST_OBJECTS)
        .collect();
    let gone = all
        .filter(|k| is_gone(case, *k))
        .take(MOST_OBJECTS)
        .collect();
    (moving, gone)
}

/// The diagnosis of a camera whose light has the aberration of another velocity. If objects move, light that takes no time may look
/// similar: both are reported if no scene distinguishes them.
pub(super) fn describe_aberration_by_light(
    case: &Case,
    change: Change,
    evidence: Vec<(&'static str, f64)>,
) -> Diagnosis {
    let (kind, wrong, place) = match change {
        Change::CameraReversed => (
            Kind::AberrationReversed,
            "aberration is reversed",
            "where a camera moving in the opposite direction sees it (−β for β)",
        ),
        Change::CameraAtRest
        | Change::CameraWithoutGamma
        | Change::Instant
        | Change::Advanced
        | Change::AtRest(_)
        | Change::Standing(_)
        | Change::Reversed(_)
        | Change::Swapped(..)
        | Change::Uncontracted => (
            Kind::AberrationMissing,
            "aberration is missing",
            "where a camera at rest sees it",
        ),
    };
    let moves = |known: &KnownScene| known.velocities().any(|v| !v.is_rest());
    let may_be_instant = case.scene.is_none() && case.known.is_some_and(moves);
    let or = match may_be_instant {
        true => ", or retardation is missing",
        false => "",
    };
    let mut what = Message::from(format!("{wrong}{or}: the light is {place}"));
    if may_be_instant {
        what += Message::from("; ") + Setting::Scene + " tells which";
    }
    Diagnosis {
        kind,
        what,
        evidence,
    }
}

/// What is said of light that arrives from the future.
pub(super) const ADVANCED: &str = "retardation has the opposite sign (t + r for t − r)";

/// The diagnosis for a change that explains the candidate.
fn describe_change(known: &KnownScene, change: Change, tally: &Tally) -> Diagnosis {
    let beta = |k: usize| known.velocities().nth(k).map_or(0.0, |v| v.beta().length());
    let (kind, what, beta) = match change {
        Change::Instant => (
            Kind::RetardationMissing,
            "retardation is missing: points are shown where they are at the time of the shot, and not where their light left them".into(),
            known.velocities().map(|v| v.beta().length()).fold(0.0, f64::max),
        ),
        Change::Advanced => (
            Kind::RetardationReversed,
            format!("{ADVANCED}: points are shown where they will be as long after the shot"),
            known.velocities().map(|v| v.beta().length()).fold(0.0, f64::max),
        ),
        Change::CameraReversed => (
            Kind::AberrationReversed,
            "aberration is reversed: points are shown where a camera moving in the opposite direction sees them (−β for β)".into(),
            known.camera_velocity().beta().length(),
        ),
        Change::CameraAtRest => (
            Kind::AberrationMissing,
            "aberration is missing: points are shown where a camera at rest sees them".into(),
            known.camera_velocity().beta().length(),
        ),
        Change::CameraWithoutGamma => (
            Kind::AberrationWithoutGamma,
            "aberration lacks γ: points are shown along d + β, and should be along the direction whose part along β is γ times as long".into(),
            known.camera_velocity().beta().length(),
        ),
        Change::AtRest(k) => (
            Kind::VelocityMissing,
            format!("the velocity of object {k} is missing: its points are shown where they would be seen at rest"),
            beta(k),
        ),
        Change::Standing(k) => (
            Kind::RetardationMissing,
            format!("object {k} is drawn at rest, at its position at the time of the shot"),
            beta(k),
        ),
        Change::Reversed(k) => (
            Kind::VelocityWrong,
            format!("the velocity of object {k} is reversed: its points are shown where they would be seen with −β for β"),
            beta(k),
        ),
        Change::Swapped(j, k) => (
            Kind::VelocitiesSwapped,
            format!("the velocities of objects {j} and {k} are swapped: their points are shown as they would be with velocities exchanged"),
            beta(j).max(beta(k)),
        ),
        Change::Uncontracted => (
            Kind::ContractionMissing,
            "objects are not contracted: points are shown where they would be seen in bodies as long as at rest, by matrices without γ (Galilean)".into(),
            known.velocities().map(|v| v.beta().length()).fold(0.0, f64::max),
        ),
    };
    Diagnosis {
        kind,
        what: what.into(),
        evidence: vec![
            ("points are displaced by (pixels, rms)", tally.error()),
            ("and from the hypothesis by (pixels, rms)", tally.rest()),
            ("beta", beta),
        ],
    }
}
