//! The camera times at which objects are in view, found by shots about the closest approach.
//!
//! In the rest frame of an object its place is fixed, so that the closest approach is where the camera's distance from it is least.
//! With the place p of the camera relative to the object and its velocity u per camera time there, the nearest point of the tangent is
//! at −p·u/u²: for inertial cameras that is exact, for others it is repeated. What is in view changes over times of about |p|/|u|.

use glam::DVec3;
use rayon::prelude::*;

use super::{PixelSamples, each_point, one_in};
use crate::camera::Shot;
use crate::error::{Message, Setting};
use crate::render::film::Tile;
use crate::render::prepare::Prepared;
use crate::render::trace::RestFrame;
use crate::scene::model::Scene;

/// The ratio of neighbouring offsets from the closest approach, the smallest offset in units of |p|/|u|, and the number of offsets on
/// each side: up to some 40 of these units.
const RATIO: f64 = 1.6;
const SMALLEST: f64 = 1.0 / 16.0;
const OFFSETS: i32 = 14;

/// The maximum number of rest frames whose approach is searched.
const MOST_FRAMES: usize = 8;

/// Steps towards the closest approach of a camera that accelerates, and halvings of the interval that holds an end.
const STEPS: usize = 16;
const HALVINGS: usize = 7;

/// For a picture in which no ray hits an object although some camera time shows one: such times, as advice.
pub fn other_times(scene: &Scene, prepared: &mut Prepared) -> Option<Message> {
    let [from, to] = rounded_inwards(showing(scene, prepared)?);
    let text = Message::from("objects are in view at other times: try ");
    Some(text + Setting::Time + format!(" \"{from} m\" to \"{to} m\""))
}

/// These times with the digits that their difference needs, so that they stay between the given ones.
fn rounded_inwards([from, to]: [f64; 2]) -> [f64; 2] {
    let power = libm::floor(libm::log10(to - from)) as i32 - 5;
    // Dividing by a power of ten leaves the number nearest to a short decimal; multiplying would not.
    let [up, down] = [power.max(0), (-power).max(0)].map(|power| 10f64.powi(power));
    [
        (from * down / up).ceil() * up / down,
        (to * down / up).floor() * up / down,
    ]
}

/// The camera times, metres, between which objects are in view, about the shot that shows most of them.
fn showing(scene: &Scene, prepared: &mut Prepared) -> Option<[f64; 2]> {
    let frames = prepared.frames.iter().take(MOST_FRAMES);
    let approaches: Vec<_> = frames.filter_map(|frame| approach(scene, frame)).collect();
    let mut times: Vec<f64> = approaches
        .iter()
        .flat_map(|&[closest, unit]| {
            let offset = move |k: i32| unit * SMALLEST * RATIO.powi(k);
            let later = (0..OFFSETS).map(move |k| closest + offset(k));
            let earlier = (0..OFFSETS).map(move |k| closest - offset(k));
            later.chain(earlier).chain([closest])
        })
        .collect();
    times.sort_by(f64::total_cmp);
    let hits: Vec<usize> = times.iter().map(|t| hits(scene, prepared, *t)).collect();
    // The shot that shows most, the first among equals.
    let (best, _) = hits
        .iter()
        .enumerate()
        .filter(|(_, hits)| **hits > 0)
        .max_by_key(|(at, hits)| (**hits, std::cmp::Reverse(*at)))?;
    // On either side, the last time in view before one that is not; without such a time, the outermost.
    let mut end = |mut seen: f64, outwards: &mut dyn Iterator<Item = usize>| {
        let mut unseen = None;
        for at in outwards {
            match hits[at] {
                0 => {
                    unseen = Some(times[at]);
                    break;
                }
                _ => seen = times[at],
            }
        }
        for _ in 0..unseen.map_or(0, |_| HALVINGS) {
            let middle = seen.midpoint(unseen.unwrap_or(seen));
            match self::hits(scene, prepared, middle) {
                0 => unseen = Some(middle),
                _ => seen = middle,
            }
        }
        seen
    };
    let first = end(times[best], &mut (0..best).rev());
    let last = end(times[best], &mut (best + 1..times.len()));
    prepared.set_camera(scene).ok()?;
    (first < last).then_some([first, last])
}

/// The camera time at which the camera is closest to the objects of a frame, and the time in which it passes their distance, metres;
/// `None` if they do not move relative to each other, or there is no such time.
fn approach(scene: &Scene, frame: &RestFrame) -> Option<[f64; 2]> {
    let (lo, hi) = frame.bvh.bounds()?;
    let (middle, radius) = (lo.midpoint(hi), 0.5 * lo.distance(hi));
    let place = |time: f64| -> Option<DVec3> {
        let shot = Shot::new(&scene.camera.at(time)).ok()?;
        Some(shot.event_in(&frame.frame).x - middle)
    };
    let mut time = scene.camera.time;
    let mut unit = None;
    for _ in 0..STEPS {
        // Differences over a hundredth of what is near, or of the time's own digits.
        let p = place(time)?;
        let step = 1e-2 * p.length().max(radius) + 1e-9 * time.abs();
        let u = (place(time + step)? - p) / step;
        if u.length_squared() < 1e-18 {
            return unit;
        }
        time -= p.dot(u) / u.length_squared();
        let found = [time, place(time)?.length().max(radius) / u.length()];
        let is_settled = unit
            .is_some_and(|[before, _]: [f64; 2]| (found[0] - before).abs() < SMALLEST * found[1]);
        unit = Some(found).filter(|found| found.iter().all(|x| x.is_finite()));
        if is_settled || unit.is_none() {
            break;
        }
    }
    unit
}

/// Of rays through pixel centres of some tiles, those that hit an object at a camera time; 0 if the camera's world line does not reach it.
fn hits(scene: &Scene, prepared: &mut Prepared, time: f64) -> usize {
    let mut other = scene.clone();
    other.camera = scene.camera.at(time);
    if prepared.set_camera(&other).is_err() {
        return 0;
    }
    let (prepared, surfaces) = (&*prepared, prepared.surfaces());
    let every = one_in(prepared.layout.size);
    let of_tile = |index: u64| {
        let tile = Tile::of_image(prepared.layout.size, index * every);
        let mut count = 0;
        let samples = (tile, PixelSamples::centred(&prepared.camera));
        each_point(prepared, &surfaces, samples, |_| count += 1, |_| {});
        count
    };
    let tiles = 0..Tile::count(prepared.layout.size).div_ceil(every);
    tiles.into_par_iter().map(of_tile).sum()
}
