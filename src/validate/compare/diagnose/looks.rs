//! Camera mistakes from look directions: another aberration, velocity or orientation.
//!
//! A pixel looks along e in the frame of the right camera, which follows from the reference's direction and its camera's velocity. A camera
//! with another velocity looks along the direction d in the world that its boost maps e to. With the boost P = p₀ + p·σ of spinors,
//!
//! ```text
//! (1 − d·σ) (p₀ + p·σ) (1 + e·σ) = 0,      p/p₀ = −n tanh(φ/2)
//! ```
//!
//! A camera rotated by the unit quaternion q looks along q e q* in its frame, which is c, the candidate's direction boosted back:
//!
//! ```text
//! c q − q e = 0
//! ```
//!
//! (Horn, JOSA A 4(4), 1987, equivalent to Kabsch's rotation.) Both are linear in four unknowns, and the best fit to all pixels is the
//! eigenvector of the smallest eigenvalue of a 4 × 4 matrix. If a picture has no directions, those to its events on the past light cone of
//! the shot are used. Another film may look similar: it is preferred if its residual is smaller.

use glam::{DMat4, DQuat, DVec3, DVec4};
use rayon::prelude::*;

use super::super::known::{KnownScene, unaberrated_without_gamma};
use super::super::picture::Plane;
use super::super::points::place;
use super::displacement::NOTABLE_DISPLACEMENT;
use super::motion::{camera_velocity, in_words, rounded};
use super::{Case, Diagnosis, Kind, Tally, film, frames, median};
use crate::render::aov::Aov;
use crate::spacetime::{Boost, CameraFrame, Direction, Velocity, World};

/// Errors of directions from storage in single precision, radians.
const DIRECTION_ROUNDING: f64 = 1e-5;
/// Rotations and velocities that change directions by less, radians rms, are due to matrices in single precision: 0.006 degrees.
const NOTABLE: f64 = 1e-4;
/// The largest rotation of a camera, degrees: larger ones are exchanged axes or mirrored pictures.
pub(super) const FARTHEST_TURN: f64 = 30.0;

/// About the most pixels used.
const MOST_LOOKS: usize = 1 << 17;

/// A pixel's look directions.
#[derive(Debug, Clone, Copy)]
struct Look {
    pixel: usize,
    /// In the right camera's frame.
    own: Direction<CameraFrame>,
    /// In the world, in the reference and in the candidate.
    right: DVec3,
    is: DVec3,
}

/// Camera mistakes from the directions along which pixels look.
pub(super) fn camera(case: &Case) -> Option<Diagnosis> {
    let of_scene = case.known.map(KnownScene::velocity_of_looks);
    let velocity = of_scene.or_else(|| camera_velocity(case.pair[0]))?;
    let looks = looks(case, velocity);
    let error = tally(&looks, |look| Some(look.right)).error();
    (error > DIRECTION_ROUNDING).then_some(())?;
    aberration(&looks, velocity).or_else(|| fitted(case, &looks, velocity))
}

/// The look directions of pixels; empty if they are unknown.
fn looks(case: &Case, velocity: Velocity) -> Vec<Look> {
    let [width, _] = case.points[0].size();
    let camera_from_world = Boost::<CameraFrame, World>::new(-velocity);
    let by_event = |which: usize| {
        let time = Plane::aov(&case.pair[which].layers, Aov::EventCt)?;
        let (world, known) = (case.points[which].world?, case.known?);
        Some(move |i: usize| known.look_to(time.at(i), place(&world, i)))
    };
    let [of_reference, of_candidate] = [0, 1].map(by_event);
    let look = |which: usize, i: usize| match case.points[which].direction {
        Some(direction) => Direction::new(place(&direction, i)),
        None => match which {
            0 => of_reference.as_ref()?(i),
            _ => of_candidate.as_ref()?(i),
        },
    };
    // If the reference has neither, the centres of pixels are known.
    let centre = |i: usize| {
        let [x, y] = [i % width, i / width].map(|n| n as f64 + 0.5);
        case.known?.look_along(glam::DVec2::new(x, y))
    };
    // Pairs of adjacent pixels.
    let pixels = || case.region.pixels(case.points[0].size());
    let step = pixels().count() / MOST_LOOKS + 1;
    let chosen = pixels().enumerate().filter(|(n, _)| n / 2 % step == 0);
    let both = chosen.filter_map(|(_, i)| {
        let is = look(1, i)?.unit();
        let right = look(0, i).or_else(|| centre(i))?;
        let (own, _) = camera_from_world.direction(right);
        Some(Look {
            pixel: i,
            own,
            right: right.unit(),
            is,
        })
    });
    both.collect()
}

/// Angles between the candidate's and the right directions, and between the candidate's and a hypothesis', radians.
fn tally(looks: &[Look], of: impl Fn(&Look) -> Option<DVec3> + Sync) -> Tally {
    Tally::of(looks.par_iter().filter_map(|look| {
        Some([
            (look.is - look.right).length(),
            (look.is - of(look)?).length(),
        ])
    }))
}

/// Look directions with the camera's velocity reversed, ignored, or without its γ.
fn aberration(looks: &[Look], velocity: Velocity) -> Option<Diagnosis> {
    let backwards = Boost::<World, CameraFrame>::new(-velocity);
    type Looks<'a> = Box<dyn Fn(&Look) -> Option<DVec3> + Sync + 'a>;
    let hypotheses: [(Kind, &str, Looks); 4] = [
        (
            Kind::AberrationReversed,
            "aberration is reversed: look directions are those of a camera that moves in the opposite direction (−β for β)",
            Box::new(|look| Some(backwards.direction(look.own).0.unit())),
        ),
        (
            Kind::AberrationMissing,
            "aberration is missing: look directions are those of the camera's own frame",
            Box::new(|look| Some(look.own.unit())),
        ),
        (
            Kind::AberrationWithoutGamma,
            "aberration lacks γ: the camera's own look directions are those along d + β, for d in the world, whose part along β should be γ times as long",
            Box::new(|look| Some(unaberrated_without_gamma(look.own.unit(), velocity))),
        ),
        (
            Kind::AberrationWithoutGamma,
            "aberration lacks γ: the world's look directions are those along d′ − β, for d′ in the camera's frame, whose part along β should be γ times as long",
            Box::new(|look| (look.own.unit() - velocity.beta()).try_normalize()),
        ),
    ];
    let tallies = hypotheses.map(|(kind, what, of)| (kind, what, tally(looks, of)));
    let explaining = tallies.into_iter();
    let explaining = explaining.filter(|(.., tally)| tally.explains(DIRECTION_ROUNDING));
    let (kind, what, tally) = explaining.min_by(|a, b| a.2.rest().total_cmp(&b.2.rest()))?;
    Some(Diagnosis {
        kind,
        what: what.into(),
        evidence: evidence(&tally, ("beta of the camera", velocity.beta().length())),
    })
}

fn evidence(tally: &Tally, size: (&'static str, f64)) -> Vec<(&'static str, f64)> {
    vec![
        size,
        (
            "directions differ from the reference by (rad, rms)",
            tally.error(),
        ),
        ("and from the hypothesis by (rad, rms)", tally.rest()),
    ]
}

/// A camera with another velocity, or rotated, if no other film explains directions better.
fn fitted(case: &Case, looks: &[Look], velocity: Velocity) -> Option<Diagnosis> {
    let moving = another_velocity(looks).map(|found| {
        let boost = Boost::<World, CameraFrame>::new(found);
        let tally = tally(looks, |look| Some(boost.direction(look.own).0.unit()));
        (describe_velocity(velocity, found, &tally), tally)
    });
    let turned = turn(looks, velocity).map(|found| {
        let boost = Boost::<World, CameraFrame>::new(velocity);
        let tally = tally(looks, |look| {
            let own = Direction::new(found * look.own.unit())?;
            Some(boost.direction(own).0.unit())
        });
        (describe_turn(case, found, &tally), tally)
    });
    // If channels are along the camera's own axes, positions show that it is not rotated.
    let turned = turned.filter(|_| !places_are_right(case) && frames::direction(case).is_none());
    let both = [moving, turned].into_iter().flatten();
    let explaining = both.filter(|(_, tally)| tally.explains(NOTABLE));
    let (found, tally) = explaining.min_by(|a, b| a.1.rest().total_cmp(&b.1.rest()))?;
    let rest = tally.rest() / angle_of_pixel(case, looks)?;
    let by_film = film::scaled_and_rest(case).or_else(|| film::of_directions(case));
    match by_film {
        Some((by_film, rest_of_film)) if rest_of_film <= rest => Some(by_film),
        _ => Some(found),
    }
}

/// Whether the candidate shows points where they should be seen.
fn places_are_right(case: &Case) -> bool {
    let Some(field) = case.field else {
        return false;
    };
    let off = case.pixels().par_iter().copied();
    let off = off.filter_map(|i| Some(field.displacement(i)?.length()));
    let off = Tally::of(off.map(|off| [off, 0.0]));
    off.distances.len() >= super::FEWEST && off.error() <= NOTABLE_DISPLACEMENT
}

/// The angle between directions of adjacent pixels, radians.
fn angle_of_pixel(case: &Case, looks: &[Look]) -> Option<f64> {
    let [width, _] = case.points[0].size();
    let pairs = looks.windows(2).filter_map(|pair| {
        let [a, b] = pair else { return None };
        let are_beside = a.pixel + 1 == b.pixel && b.pixel % width > 0;
        are_beside.then(|| (b.own.unit() - a.own.unit()).length())
    });
    median(pairs.collect()).filter(|angle| *angle > 0.0)
}

/// The velocity of the best-fitting boost.
fn another_velocity(looks: &[Look]) -> Option<Velocity> {
    // The real and imaginary parts of the equation's scalar and vector, for p₀ = 1 and for p along each axis.
    let equations = looks.iter().map(|look| {
        let (d, e) = (look.is, look.own.unit());
        let along = |a: DVec3| {
            let real = a - a.dot(e) * d + a * d.dot(e) - e * d.dot(a);
            let imaginary = a.cross(e + d);
            [
                real.extend(a.dot(e - d)),
                imaginary.extend(-a.dot(e.cross(d))),
            ]
        };
        let first = [(e - d).extend(1.0 - d.dot(e)), (-d.cross(e)).extend(0.0)];
        [first, along(DVec3::X), along(DVec3::Y), along(DVec3::Z)]
    });
    let p = solution(equations)?;
    let half = DVec3::new(p.y, p.z, p.w) / p.x;
    let length = half.length();
    (length < 1.0).then_some(())?;
    match length == 0.0 {
        true => Some(Velocity::REST),
        false => Velocity::from_rapidity_along(-2.0 * libm::atanh(length), half).ok(),
    }
}

/// The best-fitting rotation of the camera, in its frame.
fn turn(looks: &[Look], velocity: Velocity) -> Option<DQuat> {
    let camera_from_world = Boost::<CameraFrame, World>::new(-velocity);
    let equations = looks.iter().filter_map(|look| {
        let e = look.own.unit();
        let c = camera_from_world
            .direction(Direction::new(look.is)?)
            .0
            .unit();
        let along = |a: DVec3| [(c + e).cross(a).extend(a.dot(e - c)), DVec4::ZERO];
        let first = [(c - e).extend(0.0), DVec4::ZERO];
        Some([first, along(DVec3::X), along(DVec3::Y), along(DVec3::Z)])
    });
    let q = solution(equations)?;
    let q = DQuat::from_xyzw(q.y, q.z, q.w, q.x).normalize();
    let q = if q.w < 0.0 { -q } else { q };
    (q.is_finite() && angle(q).to_degrees() <= FARTHEST_TURN).then_some(q)
}

/// The angle of a rotation, from 0 to π, without the cancellation of arccos.
fn angle(q: DQuat) -> f64 {
    2.0 * libm::atan2(q.xyz().length(), q.w)
}

/// Number of steps of the inverse power method: the other eigenvalues are far larger if anything fits.
const STEPS: usize = 32;
/// Relative damping added to the matrix to make it invertible.
const DAMPING: f64 = 1e-15;

/// The unit vector that best solves linear equations, given each pixel's coefficients for the four unknowns.
fn solution(equations: impl Iterator<Item = [[DVec4; 2]; 4]>) -> Option<DVec4> {
    let mut normal = [[0.0; 4]; 4];
    for columns in equations {
        for (row, a) in normal.iter_mut().zip(columns) {
            for (sum, b) in row.iter_mut().zip(columns) {
                *sum += a[0].dot(b[0]) + a[1].dot(b[1]);
            }
        }
    }
    let trace: f64 = (0..4).map(|k| normal[k][k]).sum();
    let normal = DMat4::from_cols_array_2d(&normal) * (1.0 / trace);
    let inverse = (normal + DMat4::from_diagonal(DVec4::splat(DAMPING))).inverse();
    let mut v = DVec4::new(1.0, 0.1, 0.2, 0.3);
    for _ in 0..STEPS {
        v = (inverse * v).try_normalize()?;
    }
    v.is_finite().then_some(v)
}

fn describe_velocity(right: Velocity, is: Velocity, tally: &Tally) -> Diagnosis {
    Diagnosis {
        kind: Kind::CameraVelocity,
        what: format!(
            "the camera moves at another velocity: look directions are those of β = {}, and should be those of {}",
            in_words(is.beta()),
            in_words(right.beta())
        )
        .into(),
        evidence: evidence(
            tally,
            ("beta differs by", (is.beta() - right.beta()).length()),
        ),
    }
}

fn describe_turn(case: &Case, turn: DQuat, tally: &Tally) -> Diagnosis {
    let degrees = angle(turn).to_degrees();
    Diagnosis {
        kind: Kind::CameraTurned,
        what: turned_in_words(case.known, turn.xyz().normalize_or_zero(), degrees).into(),
        evidence: evidence(tally, ("degrees", degrees)),
    }
}

/// The description of a camera that is rotated about an axis of its frame.
pub(super) fn turned_in_words(known: Option<&KnownScene>, axis: DVec3, degrees: f64) -> String {
    let parts = known.map(|known| {
        let [up, left, over] = (degrees * known.view(axis)).to_array().map(rounded);
        format!(": yaw {left:+.4} (left), pitch {up:+.4} (up), roll {over:+.4} (over to the left)")
    });
    format!(
        "the camera is turned by {degrees:.4} degrees about {} (look_at or up){}",
        in_words(axis),
        parts.unwrap_or_default()
    )
}
