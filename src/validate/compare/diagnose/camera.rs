//! Cameras at another velocity, or at another time.
//!
//! Of a known scene the place p(x) on the film is known at which a point is seen by a camera with a number x changed: its
//! time, or the factor on its rapidity, which moves its place at the time of the shot, too. The candidate shows the point at the
//! centre q of a pixel. x is found by the steps of Gauss and Newton from what the reference has, and from rest and from the opposite
//! velocity: with D = ∂p/∂x,
//!
//! ```text
//! x ← x − Σ D·(p − q) / Σ D²,
//! ```
//!
//! over a few pixels; whether it explains the picture is asked of all. Look directions say the velocity alone. Another film
//! may look much alike: it goes first where it leaves less.

use glam::{DVec2, DVec3};

use super::super::known::KnownScene;
use super::motion::{self, NOTABLE_DISPLACEMENT, displaced};
use super::{Case, Diagnosis, Kind, NEAR, Tally, film};
use crate::scene::model::{CameraModel, Motion};
use crate::spacetime::Velocity;

/// So many pixels are asked for the number.
const ASKED: usize = 1024;
/// Steps from one start, and halvings of a step that leads to nothing better.
const STEPS: usize = 12;
const HALVINGS: usize = 6;
/// Differences for the derivative, and steps that end the search, in parts of the size of the number.
const DIFFERENCE: f64 = 1e-4;
const SMALLEST_STEP: f64 = 1e-9;

/// What another camera may leave of displacements, pixels, rms: samples anywhere in their pixels make 0.41 of it, single-precision
/// vertices less. Other units and axes throw points far out of view, where a camera may be found that brings them nearer.
const LEFT_BY_CAMERA: f64 = 1.0;

/// What a camera has otherwise.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Number {
    /// Metres that its clock is ahead.
    Time,
    /// The factor on its rapidity.
    Speed,
}

impl Number {
    /// Where searches start: at what the reference has first.
    fn starts(self) -> &'static [f64] {
        match self {
            Number::Time => &[0.0],
            Number::Speed => &[1.0, 0.0, -1.0],
        }
    }

    fn apply(self, camera: &CameraModel, x: f64) -> Option<CameraModel> {
        let mut camera = camera.clone();
        match self {
            Number::Time => camera.time += x,
            Number::Speed => {
                let rapidity = camera.velocity.rapidity();
                camera.velocity = Velocity::from_rapidity(x * rapidity).ok()?;
            }
        }
        Some(camera)
    }
}

/// A camera of another velocity, or time, where no simpler mistake of the camera explains where points are seen.
pub(super) fn another(case: &Case) -> Option<Diagnosis> {
    let known = case.known?;
    (known.camera().motion == Motion::Inertial).then_some(())?;
    if displaced(case, known, known, None).error() <= NOTABLE_DISPLACEMENT {
        return None;
    }
    let simpler = motion::of_all(case).or_else(|| motion::aberration(case));
    simpler.is_none().then_some(())?;
    let moves = !known.camera().velocity.is_rest();
    let numbers = [Number::Time, Number::Speed].into_iter();
    let numbers = numbers.filter(|number| *number == Number::Time || moves);
    let found = numbers.filter_map(|number| {
        let (x, changed) = fitted(case, known, number)?;
        let tally = displaced(case, known, &changed, None);
        let explains = tally.explains(NOTABLE_DISPLACEMENT) && tally.rest() <= LEFT_BY_CAMERA;
        explains.then_some((number, x, tally))
    });
    let (number, x, tally) = found.min_by(|a, b| a.2.rest().total_cmp(&b.2.rest()))?;
    let by_film = film::scaled_and_rest(case);
    (by_film.is_none_or(|(_, rest)| tally.rest() < rest))
        .then(|| describe(known, number, x, &tally))
}

/// Numbers in metadata that differ by less than this part of them are the same.
const SAME: f64 = 1e-9;

/// What the metadata of both pictures say of cameras that move, or are, otherwise.
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

/// The number that explains best where the candidate shows points, and the scene with it.
fn fitted(case: &Case, known: &KnownScene, number: Number) -> Option<(f64, KnownScene)> {
    let points = &case.points[1];
    let [width, _] = points.size();
    let shown = case.region.pixels(points.size());
    let shown: Vec<usize> = shown
        .filter(|i| known.place(points, *i).is_some())
        .collect();
    let pixels: Vec<usize> = shown
        .iter()
        .copied()
        .step_by(shown.len() / ASKED + 1)
        .collect();
    let with = |x: f64| known.seen_by(number.apply(known.camera(), x)?);
    // Where the points are seen, from the pixels that show them.
    let off = |scene: &KnownScene| -> Vec<Option<DVec2>> {
        let off = |i: &usize| {
            let centre = DVec2::new((i % width) as f64 + 0.5, (i / width) as f64 + 0.5);
            Some(scene.place(points, *i)? - centre)
        };
        pixels.iter().map(off).collect()
    };
    // The mean length: a few points that are elsewhere do not decide, and those that are seen nowhere are as far as the picture is wide.
    let mean = |off: &[Option<DVec2>]| {
        let lengths = off.iter().map(|d| d.map_or(width as f64, |d| d.length()));
        lengths.sum::<f64>() / off.len().max(1) as f64
    };
    let search = |start: f64| -> Option<(f64, f64)> {
        let mut x = start;
        let mut now = off(&with(x)?);
        for _ in 0..STEPS {
            let next = off(&with(x + DIFFERENCE)?);
            let (mut above, mut below) = (0.0, 0.0);
            for (a, b) in now.iter().zip(&next) {
                if let (Some(a), Some(b)) = (a, b) {
                    let slope = (*b - *a) / DIFFERENCE;
                    // The weight of a mean of lengths.
                    let weight = 1.0 / a.length().max(NEAR);
                    above += weight * slope.dot(*a);
                    below += weight * slope.length_squared();
                }
            }
            let mut step = -above / below;
            let better = (0..HALVINGS).find_map(|_| {
                let found = with(x + step).map(|scene| off(&scene));
                let found = found.filter(|found| mean(found) < mean(&now));
                step *= if found.is_some() { 1.0 } else { 0.5 };
                found
            });
            let Some(better) = better else { break };
            (x, now) = (x + step, better);
            if step.abs() < SMALLEST_STEP {
                break;
            }
        }
        x.is_finite().then(|| (x, mean(&now)))
    };
    let found = number.starts().iter().filter_map(|start| search(*start));
    let (x, _) = found.min_by(|a, b| a.1.total_cmp(&b.1))?;
    Some((x, with(x)?))
}

fn describe(known: &KnownScene, number: Number, x: f64, tally: &Tally) -> Diagnosis {
    let camera = known.camera();
    let text = motion::in_words;
    let (kind, what, size) = match number {
        Number::Time => (
            Kind::CameraTime,
            format!(
                "the picture is that of another time: points are shown where the camera sees them at {:.4} m, and should be at {:.4} m",
                camera.time + x,
                camera.time
            ),
            ("the camera's time differs by (m)", x),
        ),
        Number::Speed => {
            let right = camera.velocity;
            let beta = Velocity::from_rapidity(x * right.rapidity());
            let beta = beta.map_or(DVec3::ZERO, Velocity::beta);
            (
                Kind::CameraVelocity,
                format!(
                    "the camera moves at another velocity: points are shown where they are seen with β = {}, and should be with {}",
                    text(beta),
                    text(right.beta())
                ),
                ("factor on the camera's rapidity", x),
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
