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
//! (Horn, JOSA A 4(4), 1987, equivalent to Kabsch's rotation.) If its film has another size, too, the components of e across the axis are
//! those of the right film times kₓ and k_y: these are fitted in turn with the rotation. Both are linear in four unknowns, and the best fit to all pixels is the
//! eigenvector of the smallest eigenvalue of a 4 × 4 matrix. If a picture has no directions, those to its events on the past light cone of
//! the shot are used, if nearly all events are on it. Another film may look similar: it is preferred if its residual is smaller.

use glam::{DMat4, DQuat, DVec2, DVec3, DVec4};
use rayon::prelude::*;

use super::super::known::{KnownScene, unaberrated_without_gamma};
use super::super::picture::Plane;
use super::super::points::place;
use super::displacement::NOTABLE_DISPLACEMENT;
use super::motion::{camera_velocity, in_words, rounded};
use super::{Case, Diagnosis, FEWEST, Kind, MOST, Tally, channels, film, frames, median};
use crate::render::aov::Aov;
use crate::scene::model::ProjectionKind;
use crate::spacetime::{Boost, CameraFrame, Direction, Velocity, World};

/// Errors of directions from storage in single precision, radians.
const DIRECTION_ROUNDING: f64 = 1e-5;
/// Rotations and velocities that change directions by less, radians rms, are due to matrices in single precision: 0.006 degrees.
const NOTABLE: f64 = 1e-4;
/// The largest rotation of a camera, degrees: larger ones are exchanged axes or mirrored pictures.
pub(super) const FARTHEST_TURN: f64 = 30.0;

/// The largest rms difference, in pixels, that another camera may leave: samples anywhere in their pixels cause 0.58.
const LEFT_BY_CAMERA: f64 = 1.0;

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

/// Look directions that are wrong, and not those of any other camera.
pub(super) fn unexplained(case: &Case) -> Option<Diagnosis> {
    case.points
        .iter()
        .all(|p| p.direction.is_some())
        .then_some(())?;
    let known = case.known?;
    let velocity = known.velocity_of_looks();
    let looks = looks(case, velocity);
    let tally = tally(&looks, |look| Some(look.right));
    let error = tally.error();
    // Wrong directions of one object are another matter.
    let wrong = looks
        .iter()
        .filter(|look| (look.is - look.right).length() > NOTABLE);
    let is_wrong = looks.len() >= FEWEST && wrong.count() as f64 >= MOST * looks.len() as f64;
    let pixels = error / angle_of_pixel(case, &looks)?;
    (is_wrong && pixels > LEFT_BY_CAMERA).then(|| {
        Diagnosis {
            kind: Kind::ChannelWrong,
            what: format!(
                "look directions are wrong: by {:.4} degrees rms, {pixels:.1} pixels; they are those of no other velocity, \
                 orientation or film of the camera",
                error.to_degrees()
            )
            .into(),
            evidence: vec![("directions differ from the reference by (rad, rms)", error)],
        }
    })
}

/// Whether a camera may be the candidate's by its look directions: these are the reference's, or those of this camera.
pub(super) fn may_be_of(case: &Case, changed: &KnownScene) -> bool {
    let Some(known) = case.known else { return true };
    if case.points.iter().any(|points| points.direction.is_none()) {
        return true;
    }
    let [width, _] = case.points[0].size();
    let looks = looks(case, known.velocity_of_looks());
    let Some(angle) = angle_of_pixel(case, &looks) else {
        return true;
    };
    let left = LEFT_BY_CAMERA * angle;
    let of_camera = |look: &Look| {
        let [x, y] = [look.pixel % width, look.pixel / width].map(|n| n as f64 + 0.5);
        Some(changed.look_along(DVec2::new(x, y))?.unit())
    };
    let tally = tally(&looks, of_camera);
    tally.error() <= left || tally.rest() <= left || are_along_other_axes(case)
}

/// Whether directions are along other axes than the world's, which say nothing about the camera.
fn are_along_other_axes(case: &Case) -> bool {
    frames::direction(case).is_some() || channels::has_other_axes(case)
}

/// A camera that is turned, with another field of view or aspect ratio.
fn turned_with_another_film(
    known: &KnownScene,
    looks: &[Look],
    velocity: Velocity,
) -> Option<(Diagnosis, Tally)> {
    (known.camera().projection == ProjectionKind::Perspective).then_some(())?;
    let camera_from_world = Boost::<CameraFrame, World>::new(-velocity);
    let pair = |look: &Look| {
        let is = camera_from_world.direction(Direction::new(look.is)?).0;
        Some([known.view(look.own.unit()), known.view(is.unit())])
    };
    let pairs: Vec<[DVec3; 2]> = looks
        .iter()
        .step_by(looks.len() / FEW_LOOKS + 1)
        .filter_map(pair)
        .collect();
    // The rotation that fits best with a film of this size, and then the size that fits best with this rotation.
    let mut film = DVec2::ONE;
    let mut turn = DQuat::IDENTITY;
    for _ in 0..TURNS_AND_FILMS {
        let scaled = |e: DVec3| (e * film.extend(1.0)).normalize();
        turn = rotation(pairs.iter().map(|[e, c]| [scaled(*e), *c]))?;
        let (mut above, mut below) = (DVec2::ZERO, DVec2::ZERO);
        for [e, c] in &pairs {
            let c = turn.inverse() * *c;
            let [right, is] = [*e, c].map(|d| d.truncate() / d.z);
            (above, below) = (above + right * is, below + right * right);
        }
        let next = above / below;
        let is_done = (next - film).abs().max_element() <= DIRECTION_ROUNDING;
        film = next;
        if is_done {
            break;
        }
    }
    let tally = Tally::of(pairs.par_iter().map(|[e, c]| {
        let hypothesis = turn * (*e * film.extend(1.0)).normalize();
        [(*c - *e).length(), (*c - hypothesis).length()]
    }));
    let degrees = angle(turn).to_degrees();
    (tally.explains(NOTABLE) && film.min_element() > 0.0 && degrees <= FARTHEST_TURN)
        .then_some(())?;
    let [right, up, forward] = known.camera().axes;
    let axis = turn.xyz().normalize_or_zero();
    let axis = right * axis.x + up * axis.y - forward * axis.z;
    let mut evidence = evidence(&tally, ("degrees", degrees));
    evidence.extend([
        ("tan(fov/2) across over the reference's", film.x),
        ("tan(fov/2) down over the reference's", film.y),
    ]);
    let found = Diagnosis {
        kind: Kind::CameraTurned,
        what: format!(
            "{}; and its tan(fov/2) is {:.4} times the reference's across and {:.4} times down",
            turned_in_words(Some(known), axis, degrees),
            film.x,
            film.y
        )
        .into(),
        evidence,
    };
    Some((found, tally))
}

/// The most pixels for a rotation with another film, and the most steps of the fit.
const FEW_LOOKS: usize = 4096;
const TURNS_AND_FILMS: usize = 200;

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
    // Events elsewhere are not seen from this shot, and those of them that happen to be on its cone do not say where the camera looks.
    let is_on_cone = |of_candidate: &dyn Fn(usize) -> Option<Direction<World>>| {
        let [mut all, mut on_cone] = [0usize; 2];
        let shown = case.everywhere().iter();
        let shown = shown.filter(|i| {
            let place = case.points[1].world_point(**i);
            !case.is_mixed(**i) && place.is_some_and(DVec3::is_finite)
        });
        for i in shown {
            all += 1;
            on_cone += usize::from(of_candidate(*i).is_some());
        }
        on_cone as f64 >= MOST * all as f64
    };
    if case.points[1].direction.is_none()
        && !of_candidate.as_ref().is_some_and(|look| is_on_cone(look))
    {
        return Vec::new();
    }
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
        case.known?.look_along(DVec2::new(x, y))
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
    let angle = angle_of_pixel(case, looks)?;
    let explaining = both
        .filter(|(_, tally)| tally.explains(NOTABLE))
        .map(|(found, tally)| (found, tally.rest() / angle))
        .filter(|(_, rest)| *rest <= LEFT_BY_CAMERA);
    let of_camera = explaining.min_by(|a, b| a.1.total_cmp(&b.1));
    // Directions that only another film explains are explained after other mistakes of channels, unless it is also turned.
    let by_film = || film::scaled_and_rest(case).or_else(|| film::of_directions(case));
    let found = match (of_camera, by_film()) {
        (Some((_, rest)), Some((by_film, of_film))) if of_film <= rest => Some((by_film, of_film)),
        (None, Some((_, of_film))) if of_film <= LEFT_BY_CAMERA => return None,
        (of_camera, _) => of_camera,
    };
    let rest = found.as_ref().map_or(LEFT_BY_CAMERA, |(_, rest)| *rest);
    if rest > EXACT
        && let Some(known) = case.known
        && let Some((both, tally)) = turned_with_another_film(known, looks, velocity)
        && tally.rest() / angle <= 0.5 * rest
        && !are_along_other_axes(case)
    {
        return Some(both);
    }
    found.map(|(found, _)| found)
}

/// The residual, in pixels, of directions in single precision: then nothing is left to explain.
const EXACT: f64 = 0.05;

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
    let pairs = looks.iter().filter_map(|look| {
        let c = camera_from_world.direction(Direction::new(look.is)?).0;
        Some([look.own.unit(), c.unit()])
    });
    rotation(pairs).filter(|q| angle(*q).to_degrees() <= FARTHEST_TURN)
}

/// The rotation that best turns the first of each pair of unit vectors to the second.
fn rotation(pairs: impl Iterator<Item = [DVec3; 2]>) -> Option<DQuat> {
    let equations = pairs.map(|[e, c]| {
        let along = |a: DVec3| [(c + e).cross(a).extend(a.dot(e - c)), DVec4::ZERO];
        let first = [(c - e).extend(0.0), DVec4::ZERO];
        [first, along(DVec3::X), along(DVec3::Y), along(DVec3::Z)]
    });
    let q = solution(equations)?;
    let q = DQuat::from_xyzw(q.y, q.z, q.w, q.x).normalize();
    let q = if q.w < 0.0 { -q } else { q };
    q.is_finite().then_some(q)
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
