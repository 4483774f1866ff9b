//! Cameras with another velocity, time, orientation or position, found from positions of points.
//!
//! In a known scene the film position p(x) of a point is known for a camera with a changed parameter x: its time; its rapidity, which also
//! moves its position at the time of the shot; its orientation; or its position. The candidate shows the point at q, the centre of a pixel, or
//! the place in it at which the reference's own point is seen, if both have the same samples. x is found by
//! Gauss–Newton steps from the reference's value, and for velocities also from rest and from the opposite velocity: with J = ∂p/∂x,
//!
//! ```text
//! x ← x − (Σ JᵀJ)⁻¹ Σ Jᵀ(p − q),
//! ```
//!
//! over a sample of pixels; whether x explains the picture is tested on all. Look directions only give velocity and orientation (`looks`).
//! Another film may look similar: it is preferred if its residual is smaller.

use glam::{DMat3, DQuat, DVec2, DVec3};
use rayon::prelude::*;

use super::super::known::KnownScene;
use super::super::picture::Plane;
use super::displacement::{Aim, IN_PIXEL, NOTABLE_DISPLACEMENT, displaced, displaced_if_promising};
use super::looks::{self, FARTHEST_TURN, turned_in_words};
use super::motion;
use super::{Case, Diagnosis, FEWEST, Kind, MOST, NEAR, Tally, channels, film};
use crate::render::aov::Aov;
use crate::scene::model::{CameraModel, Motion};
use crate::spacetime::{Boost, CameraFrame, Displacement, Velocity, World};

/// The most pixels used to fit the parameters.
const ASKED: usize = 1024;
/// Maximum number of steps from one start, and of halvings of a step that does not improve the fit.
const STEPS: usize = 12;
const HALVINGS: usize = 6;
/// Differences for the derivatives, and step lengths that end the search: metres, rapidities, radians.
const DIFFERENCE: f64 = 1e-4;
const SMALLEST_STEP: f64 = 1e-9;

/// The largest rms displacement, in pixels, that another camera may leave: samples anywhere in their pixels cause 0.41, single-precision
/// vertices less. Other units and axes move points far out of view, where some camera may bring them nearer.
const LEFT_BY_CAMERA: f64 = 1.0;

/// The camera parameter that differs.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Number {
    /// The lead of its clock in metres: the first component.
    Time,
    /// Its rapidity.
    Velocity,
    /// Its rotation in radians, about the axes of its frame.
    Turn,
    /// Its displacement in the world, metres, at one time of the world.
    Place,
    /// Its displacement in its own frame, metres, at one time of its clock.
    Aside,
}

impl Number {
    /// Starts of the search, the reference's value first.
    fn starts(self, camera: &CameraModel) -> Vec<DVec3> {
        let rapidity = camera.velocity.rapidity();
        match self {
            Number::Velocity if rapidity != DVec3::ZERO => vec![rapidity, DVec3::ZERO, -rapidity],
            Number::Time | Number::Turn | Number::Velocity | Number::Place | Number::Aside => {
                vec![DVec3::ZERO]
            }
        }
    }

    /// The axes of its components.
    fn axes(self) -> &'static [DVec3] {
        match self {
            Number::Time => &[DVec3::X],
            Number::Velocity | Number::Turn | Number::Place | Number::Aside => &DVec3::AXES,
        }
    }

    fn apply(self, camera: &CameraModel, x: DVec3) -> Option<CameraModel> {
        let mut camera = camera.clone();
        match self {
            Number::Time => camera.time += x.x,
            Number::Velocity => camera.velocity = Velocity::from_rapidity(x).ok()?,
            Number::Turn => {
                let turn = DQuat::from_scaled_axis(x);
                camera.axes = camera.axes.map(|axis| turn * axis);
            }
            Number::Place => camera.origin.x += x,
            Number::Aside => {
                let world_from_camera = Boost::<World, CameraFrame>::new(camera.velocity);
                let offset = world_from_camera.displacement(Displacement::new(0.0, x));
                camera.origin.ct += offset.ct;
                camera.origin.x += offset.x;
            }
        }
        Some(camera)
    }
}

/// A camera with another velocity, time, orientation or position, if no simpler mistake of the camera explains where points are seen.
pub(super) fn another(case: &Case) -> Option<Diagnosis> {
    let known = case.known?;
    (known.camera().motion == Motion::Inertial).then_some(())?;
    if displaced(case, known, known, None).error() <= NOTABLE_DISPLACEMENT {
        return None;
    }
    motion::of_all(case).is_none().then_some(())?;
    let explains =
        |tally: &Tally| tally.explains(NOTABLE_DISPLACEMENT) && tally.rest() <= LEFT_BY_CAMERA;
    let (number, x, tally) = nearest(case, known, displaced_if_promising, explains)?;
    let by_film = film::scaled_and_rest(case);
    (by_film.is_none_or(|(_, rest)| tally.rest() < rest))
        .then(|| describe(known, number, x, &tally))
}

/// A camera that explains, but for samples elsewhere in pixels, where points are seen: it sees nearly all of them in the pixels that show
/// them.
pub(super) fn of_samples(case: &Case) -> Option<Diagnosis> {
    let known = case.known?;
    (known.camera().motion == Motion::Inertial).then_some(())?;
    let in_pixels = |tally: &Tally| {
        let inside = tally.distances.iter().filter(|d| d[1] <= IN_PIXEL).count();
        inside as f64 >= MOST * tally.distances.len() as f64
    };
    let (number, x, tally) = nearest(case, known, displaced, in_pixels)?;
    Some(describe(known, number, x, &tally))
}

/// The change of the camera that leaves the smallest displacements, of those that explain them.
fn nearest(
    case: &Case,
    known: &KnownScene,
    tested: impl Fn(&Case, &KnownScene, &KnownScene, Option<usize>) -> Tally,
    explains: impl Fn(&Tally) -> bool,
) -> Option<(Number, DVec3, Tally)> {
    let numbers = [
        Number::Time,
        Number::Velocity,
        Number::Turn,
        Number::Place,
        Number::Aside,
    ];
    // Places in another unit are seen from an eye as far away where the scene is as much larger.
    let is_scaled = !channels::units_of_places(case).is_empty();
    let aims = Aim::all(case);
    let each = numbers
        .into_iter()
        .flat_map(|number| aims.iter().map(move |aim| (number, *aim)));
    let asked = asked(case, known);
    let found = each.filter_map(|(number, aim)| {
        let (x, changed) = fitted(case, known, &asked, number, aim)?;
        let is_possible = match number {
            Number::Time => !times_are_right(case, x.x),
            Number::Velocity => looks::may_be_of(case, &changed),
            Number::Turn => {
                x.length().to_degrees() <= FARTHEST_TURN && looks::may_be_of(case, &changed)
            }
            Number::Place | Number::Aside => !is_scaled,
        };
        is_possible.then_some(())?;
        let tally = tested(case, known, &changed, None);
        explains(&tally).then_some((number, x, tally))
    });
    // A camera at another time is elsewhere, too: of those that leave as little, the first is meant.
    let found: Vec<(Number, DVec3, Tally)> = found.collect();
    let least = found.iter().map(|found| found.2.rest()).reduce(f64::min)?;
    let is_as_near = |found: &(Number, DVec3, Tally)| found.2.rest() <= least + AS_NEAR;
    found.into_iter().find(is_as_near)
}

/// Whether the candidate shows most points that it shows in the right place at the right time, too, which a picture of a time later by
/// `lead` metres does not.
fn times_are_right(case: &Case, lead: f64) -> bool {
    let times = case
        .pair
        .map(|picture| Plane::aov(&picture.layers, Aov::EventCt));
    let ([Some(r), Some(c)], Some(field)) = (times, case.field) else {
        return false;
    };
    let pixels = case.pixels().par_iter();
    let in_place = pixels.filter(|i| {
        let off = field.displacement(**i);
        off.is_some_and(|off| off.length() <= NOTABLE_DISPLACEMENT)
    });
    let of_time = in_place.map(|i| (c.at(*i) - r.at(*i)).abs() <= NEAR * lead.abs());
    let [right, all] = of_time
        .map(|is_right| [usize::from(is_right), 1])
        .reduce(|| [0; 2], |[a, b], [c, d]| [a + c, b + d]);
    all >= FEWEST && right as f64 >= MOST * all as f64
}

/// Residuals that differ by less, pixels, are equal: points in single precision are seen to 1e-4 pixels.
const AS_NEAR: f64 = 1e-3;

/// Relative tolerance for equal numbers in metadata.
const SAME: f64 = 1e-9;

/// Differences in camera motion or time between the metadata of both pictures.
pub(super) fn other_shot(case: &Case) -> Option<Diagnosis> {
    let numbers = |which: usize, key: &str| -> Option<Vec<f64>> {
        let words = case.pair[which].metadata(key)?.split_whitespace();
        words.map(|word| word.parse().ok()).collect()
    };
    let differs = |key: &str| -> Option<f64> {
        let [a, b] = [numbers(0, key)?, numbers(1, key)?];
        let largest = a.iter().chain(&b).fold(0.0f64, |most, v| most.max(v.abs()));
        let apart = a
            .iter()
            .zip(&b)
            .fold(0.0f64, |most, (a, b)| most.max((a - b).abs()));
        (a.len() == b.len() && apart > SAME * largest).then_some(apart)
    };
    let keys = ["camera_rapidity", "camera_time"];
    let found = keys
        .into_iter()
        .filter_map(|key| Some((key, differs(key)?)));
    let found: Vec<(&str, f64)> = found.collect();
    let words = found.iter().filter_map(|(key, _)| {
        let [r, c] = case.pair.map(|picture| picture.metadata(key));
        Some(format!("{key} is {}, and {} in the reference", c?, r?))
    });
    let words: Vec<String> = words.collect();
    (!found.is_empty()).then(|| Diagnosis {
        kind: Kind::ShotsDiffer,
        what: format!(
            "the pictures are of different shots, by their metadata: {}; its consequences are not diagnosed",
            words.join("; ")
        ).into(),
        evidence: found.iter().map(|(key, apart)| (*key, *apart)).collect(),
    })
}

/// A sample of the pixels at which the candidate shows points that the camera could see.
fn asked(case: &Case, known: &KnownScene) -> Vec<usize> {
    let points = &case.points[1];
    let all = case.everywhere().par_iter().copied();
    let shown: Vec<usize> = all
        .filter(|i| !case.is_mixed(*i) && known.place(points, *i).is_some())
        .collect();
    let step = shown.len() / ASKED + 1;
    shown.into_iter().step_by(step).collect()
}

/// The parameters that best explain where the candidate shows points at these `pixels`, and the scene with them.
fn fitted(
    case: &Case,
    known: &KnownScene,
    pixels: &[usize],
    number: Number,
    aim: Aim,
) -> Option<(DVec3, KnownScene)> {
    let points = &case.points[1];
    let [width, _] = points.size();
    let with = |x: DVec3| known.seen_by(number.apply(known.camera(), x)?);
    // Displacements of the points from the pixels that show them to where they are seen.
    let off = |scene: &KnownScene| -> Vec<Option<DVec2>> {
        let off = |i: &usize| Some(scene.place(points, *i)? - aim.place(case, known, *i));
        pixels.iter().map(off).collect()
    };
    // The mean length, so that a few displaced points do not decide; points that are not seen count as the width of the picture.
    let mean = |off: &[Option<DVec2>]| {
        let lengths = off.iter().map(|d| d.map_or(width as f64, |d| d.length()));
        lengths.sum::<f64>() / off.len().max(1) as f64
    };
    let search = |start: DVec3| -> Option<(DVec3, f64)> {
        let mut x = start;
        let mut now = off(&with(x)?);
        for _ in 0..STEPS {
            let ahead = |axis: &DVec3| Some(off(&with(x + DIFFERENCE * *axis)?));
            let ahead: Vec<_> = number.axes().iter().map(ahead).collect::<Option<_>>()?;
            let mut step = step(&now, &ahead)?;
            let better = (0..HALVINGS).find_map(|_| {
                let found = with(x + step).map(|scene| off(&scene));
                let found = found.filter(|found| mean(found) < mean(&now));
                step *= if found.is_some() { 1.0 } else { 0.5 };
                found
            });
            let Some(better) = better else { break };
            (x, now) = (x + step, better);
            if step.length() < SMALLEST_STEP {
                break;
            }
        }
        x.is_finite().then(|| (x, mean(&now)))
    };
    let starts = number.starts(known.camera()).into_iter();
    let found = starts.filter_map(search);
    let (x, _) = found.min_by(|a, b| a.1.total_cmp(&b.1))?;
    Some((x, with(x)?))
}

/// The Gauss–Newton step from displacements `now`, with those `ahead` along each axis.
fn step(now: &[Option<DVec2>], ahead: &[Vec<Option<DVec2>>]) -> Option<DVec3> {
    let (mut normal, mut right) = (DMat3::ZERO, DVec3::ZERO);
    for (i, a) in now.iter().enumerate() {
        let Some(a) = a else { continue };
        let mut slopes = [DVec3::ZERO; 2];
        for (k, ahead) in ahead.iter().enumerate() {
            let Some(b) = ahead[i] else { continue };
            for (slopes, slope) in slopes.iter_mut().zip(((b - a) / DIFFERENCE).to_array()) {
                slopes[k] = slope;
            }
        }
        // Weights that minimise the mean length.
        let weight = 1.0 / a.length().max(NEAR);
        for (slopes, a) in slopes.into_iter().zip(a.to_array()) {
            let [x, y, z] = slopes.to_array();
            normal += weight * DMat3::from_cols(slopes * x, slopes * y, slopes * z);
            right += weight * a * slopes;
        }
    }
    // Missing components stay unchanged.
    for k in ahead.len()..3 {
        normal.col_mut(k)[k] = 1.0;
    }
    let step = -(normal.inverse() * right);
    step.is_finite().then_some(step)
}

fn describe(known: &KnownScene, number: Number, x: DVec3, tally: &Tally) -> Diagnosis {
    let camera = known.camera();
    let text = motion::in_words;
    let (kind, what, size) = match number {
        Number::Time => (
            Kind::CameraTime,
            format!(
                "the picture is that of another time: points are shown where the camera sees them at {:.4} m, and should be at {:.4} m",
                camera.time + x.x,
                camera.time
            ),
            ("the camera's time differs by (m)", x.x),
        ),
        Number::Velocity => {
            let right = camera.velocity.beta();
            let is = Velocity::from_rapidity(x).map_or(DVec3::ZERO, Velocity::beta);
            (
                Kind::CameraVelocity,
                format!(
                    "the camera moves at another velocity: points are shown where they are seen with β = {}, and should be with {}",
                    text(is),
                    text(right)
                ),
                ("beta differs by", (is - right).length()),
            )
        }
        Number::Place => {
            let right = camera.origin.x;
            (
                Kind::CameraElsewhere,
                elsewhere_in_words(right + x, right),
                ("the camera is displaced by (m)", x.length()),
            )
        }
        Number::Aside => {
            let [right, up, back] = known.view(x).to_array().map(motion::rounded);
            (
                Kind::CameraElsewhere,
                format!(
                    "the camera is displaced in its own frame: by {right:+.4} m to the right, {up:+.4} m up and {:+.4} m ahead",
                    0.0 - back
                ),
                ("the camera is displaced by (m)", x.length()),
            )
        }
        Number::Turn => {
            let degrees = x.length().to_degrees();
            (
                Kind::CameraTurned,
                turned_in_words(Some(known), x.normalize_or_zero(), degrees),
                ("degrees", degrees),
            )
        }
    };
    Diagnosis {
        kind,
        what: what.into(),
        evidence: vec![
            size,
            ("points are displaced by (pixels, rms)", tally.error()),
            ("and from the hypothesis by (pixels, rms)", tally.rest()),
        ],
    }
}

/// The description of a camera whose position is `is`, and should be `right`.
pub(super) fn elsewhere_in_words(is: DVec3, right: DVec3) -> String {
    let text = motion::in_words;
    format!(
        "the camera is elsewhere: its eye is at {} m, and should be at {} m",
        text(is),
        text(right)
    )
}
