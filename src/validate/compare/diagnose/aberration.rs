//! Look directions that were boosted the wrong way, or not at all.

use glam::DVec3;

use super::{Case, Diagnosis, Kind};
use crate::spacetime::{Boost, Camera, Direction, Velocity, World};
use crate::validate::compare::Picture;
use crate::validate::compare::plane::Plane;

const NAMES: [&str; 3] = ["direction.x", "direction.y", "direction.z"];
/// A hypothesis has to bring the directions nearer than this part of their error.
const NEAR: f64 = 0.1;
/// Errors of directions that storage in single precision makes, radians.
const ROUNDING: f64 = 1e-5;

pub(super) fn diagnose(case: &Case) -> Option<Diagnosis> {
    let [r, c] = case
        .pair
        .map(|picture| Plane::group(&picture.layers, NAMES));
    let (r, c, velocity) = (r?, c?, camera_velocity(case.pair[0])?);
    let [width, height] = case.points[0].size();
    let mut sums = [0.0; 3];
    let mut count = 0.0;
    for y in 0..height {
        let chosen = case.region.row(y, width);
        for i in (0..width).filter(|x| chosen[*x]).map(|x| y * width + x) {
            let [r, c] =
                [&r, &c].map(|planes| DVec3::from_array(std::array::from_fn(|k| planes[k].at(i))));
            let Some(d) = Direction::new(r) else {
                continue;
            };
            let [reversed, missing] = wrong(d, velocity);
            for (sum, expected) in sums.iter_mut().zip([r, reversed, missing]) {
                *sum += (c - expected).length_squared();
            }
            count += 1.0;
        }
    }
    let [error, reversed, missing] = sums.map(|sum: f64| (sum / f64::max(count, 1.0)).sqrt());
    let (kind, rest) = match reversed <= missing {
        true => (Kind::AberrationReversed, reversed),
        false => (Kind::AberrationMissing, missing),
    };
    let explains = error > ROUNDING && rest <= NEAR * error;
    explains.then(|| described(kind, error, rest, velocity))
}

fn described(kind: Kind, error: f64, rest: f64, velocity: Velocity) -> Diagnosis {
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
fn wrong(d: Direction<World>, velocity: Velocity) -> [DVec3; 2] {
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
