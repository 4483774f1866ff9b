//! Depths along the camera's axis instead of distances.
//!
//! `distance` is the world's distance s from the pinhole to the emission event, whose displacement is (−ηs, s d). Rasterizers have the
//! depth z instead, the component along the camera's axis, in the camera's frame (after its boost) or in the world's coordinates; or the
//! value a + b/z of a depth buffer. Light delayed by the depth leaves at T − ηz instead of T − ηs. If the scene is unknown, the hypothesis
//! is the cosine between ray and axis of a pinhole camera, with one free parameter:
//!
//! ```text
//! s/z = √(1 + ρ²/f²),      ρ from the film's centre, f the focal length, both in pixels.
//! ```

use glam::DVec2;
use rayon::prelude::*;

use super::super::picture::Plane;
use super::{Case, Diagnosis, Kind, Tally, median};
use crate::render::aov::Aov;

/// The smallest notable relative error of distances.
const NOTABLE: f64 = 1e-3;

/// Quantities that a program may have written instead of the distance.
const MEANINGS: [&str; 4] = [
    "the depth along the camera's axis, in the camera's own frame",
    "the depth along the camera's axis, in the world's coordinates",
    "the distance in the camera's own frame",
    "the reference's over the cosine to the camera's axis: one of the two is a depth",
];

/// The values of [`MEANINGS`] at pixel `i` with the distance `s`.
pub(super) fn meanings(case: &Case, i: usize, s: f64) -> Option<[f64; 4]> {
    let known = case.known?;
    let d = known.look_along(centre(case, i))?.unit();
    let own = known.own_way(s, d);
    let [depth, own_depth] = [s * d, own].map(|way| -known.view(way).z);
    Some([own_depth, depth, own.length(), s * s / depth])
}

fn centre(case: &Case, i: usize) -> DVec2 {
    let [width, _] = case.points[0].size();
    DVec2::new((i % width) as f64 + 0.5, (i / width) as f64 + 0.5)
}

/// Distances and times computed from depths.
pub(super) fn depths(case: &Case) -> Vec<Diagnosis> {
    distance(case).into_iter().chain(time(case)).collect()
}

/// Distances that are another quantity.
fn distance(case: &Case) -> Option<Diagnosis> {
    let [r, c] = case
        .pair
        .map(|picture| Plane::aov(&picture.layers, Aov::Distance));
    let (r, c) = (r?, c?);
    let pixels = case.pixels();
    let usual = median(
        pixels
            .iter()
            .map(|i| r.at(*i).abs())
            .filter(|s| s.is_finite())
            .collect(),
    )?;
    let tally = |h: &(dyn Fn(usize) -> Option<f64> + Sync)| {
        Tally::of_pixels(pixels, |i| {
            let c = c.at(i);
            Some([(c - r.at(i)).abs(), (c - h(i)?).abs()])
        })
    };
    // Quantities without free parameters, and their negatives.
    let mut best: Option<(String, Tally)> = None;
    for (k, meaning) in MEANINGS.into_iter().enumerate() {
        for (sign, words) in [(1.0, ""), (-1.0, "minus ")] {
            let tally = tally(&|i| Some(sign * meanings(case, i, r.at(i))?[k]));
            let better = best
                .as_ref()
                .is_none_or(|(_, found)| tally.is_better_than(found));
            if tally.explains(NOTABLE * usual) && better {
                best = Some((format!("{words}{meaning}"), tally));
            }
        }
    }
    if let Some((meaning, tally)) = best {
        return Some(describe(
            format!("distance is {meaning}, and should be the world's distance"),
            &tally,
            Vec::new(),
        ));
    }
    buffer(case, pixels, [&r, &c], usual).or_else(|| by_cosine(case, pixels, [&r, &c], usual))
}

fn describe(what: String, tally: &Tally, sizes: Vec<(&'static str, f64)>) -> Diagnosis {
    let mut evidence = sizes;
    evidence.extend([
        ("differs from the reference by (rms)", tally.error()),
        ("and from the hypothesis by (rms)", tally.rest()),
    ]);
    Diagnosis {
        kind: Kind::DepthForDistance,
        what: what.into(),
        evidence,
    }
}

/// a + b/z, as in a depth buffer, by least squares over the depths in the camera's frame.
fn buffer(case: &Case, pixels: &[usize], [r, c]: [&Plane; 2], usual: f64) -> Option<Diagnosis> {
    let inverse = |i: usize| Some(1.0 / meanings(case, i, r.at(i))?[0]);
    let pairs: Vec<[f64; 2]> = pixels
        .iter()
        .filter_map(|&i| Some([inverse(i)?, c.at(i)]))
        .filter(|pair| pair.iter().all(|v| v.is_finite()))
        .collect();
    let n = pairs.len().max(1) as f64;
    let mean = |k: usize| pairs.iter().map(|p| p[k]).sum::<f64>() / n;
    let (x0, y0) = (mean(0), mean(1));
    let sums = pairs.iter().fold([0.0; 3], |[xx, xy, yy], [x, y]| {
        let (x, y) = (x - x0, y - y0);
        [xx + x * x, xy + x * y, yy + y * y]
    });
    let [xx, xy, yy] = sums;
    let b = xy / xx;
    let a = y0 - b * x0;
    let tally = Tally::of(pixels.par_iter().filter_map(|&i| {
        let h = a + b * inverse(i)?;
        Some([(c.at(i) - r.at(i)).abs(), (c.at(i) - h).abs()])
    }));
    // With two free parameters, the residual is compared with the spread of the values, too.
    let varies = (yy / n).sqrt();
    let explains = varies > 0.0 && tally.explains(NOTABLE * usual) && tally.rest() <= 0.02 * varies;
    explains.then(|| {
        let mut sizes = vec![("a", a), ("b", b)];
        // a = f/(f − n) and b = −fn/(f − n), for near and far planes at n and f.
        sizes.extend((a > 1.0 && b < 0.0).then_some(("near plane", -b / a)));
        sizes.extend((a > 1.0 && b < 0.0).then_some(("far plane", -b / (a - 1.0))));
        let what = format!(
            "distance is the value of a depth buffer, {a:.6} {b:+.6}/depth, and should be the world's distance"
        );
        describe(what, &tally, sizes)
    })
}

/// The distance multiplied, or divided, by the cosine between ray and axis, if the scene is unknown.
fn by_cosine(case: &Case, pixels: &[usize], [r, c]: [&Plane; 2], usual: f64) -> Option<Diagnosis> {
    if case.known.is_some() {
        return None;
    }
    let [width, height] = case.points[0].size();
    let middle = 0.5 * DVec2::new(width as f64, height as f64);
    let square = |i: usize| (centre(case, i) - middle).length_squared();
    let ways = [
        ("the depth along the camera's axis", 1.0),
        (MEANINGS[3], -1.0),
    ];
    ways.into_iter().find_map(|(meaning, sign)| {
        // (s/z)² − 1 = ρ²/f², by least squares.
        let (mut above, mut below) = (0.0, 0.0);
        for &i in pixels {
            let ratio = (r.at(i) / c.at(i)).powi(2).powf(sign);
            if ratio.is_finite() {
                above += square(i) * (ratio - 1.0);
                below += square(i) * square(i);
            }
        }
        let inverse = above / below;
        (inverse > 0.0).then_some(())?;
        let tally = Tally::of(pixels.par_iter().map(|&i| {
            let cosine = (1.0 + square(i) * inverse).sqrt().recip();
            let h = r.at(i) * cosine.powf(sign);
            [(c.at(i) - r.at(i)).abs(), (c.at(i) - h).abs()]
        }));
        tally.explains(NOTABLE * usual).then(|| {
            let f = inverse.sqrt().recip();
            let fov = 2.0 * libm::atan(middle.x / f).to_degrees();
            let what = format!("distance is {meaning}, for a field of view of {fov:.2} degrees across, and should be the world's distance");
            describe(what, &tally, vec![("focal length (pixels)", f)])
        })
    })
}

/// Emission times of light delayed by the depth.
fn time(case: &Case) -> Option<Diagnosis> {
    let [r, c] = case
        .pair
        .map(|picture| Plane::aov(&picture.layers, Aov::EventCt));
    let (r, c, known) = (r?, c?, case.known?);
    let (shot, index) = (known.shot_time(), known.index());
    (index > 0.0).then_some(())?;
    let pixels = case.pixels();
    let usual = pixels.iter().map(|i| (r.at(*i) - shot).abs());
    let usual = median(usual.filter(|t| t.is_finite()).collect())?;
    let tallies = MEANINGS
        .into_iter()
        .take(3)
        .enumerate()
        .filter_map(|(k, meaning)| {
            let tally = Tally::of_pixels(pixels, |i| {
                let way = meanings(case, i, (shot - r.at(i)) / index)?[k];
                Some([
                    (c.at(i) - r.at(i)).abs(),
                    (c.at(i) - (shot - index * way)).abs(),
                ])
            });
            tally.explains(NOTABLE * usual).then_some((meaning, tally))
        });
    let (meaning, tally) = tallies.reduce(|a, b| match b.1.is_better_than(&a.1) {
        true => b,
        false => a,
    })?;
    let what =
        format!("emission times are early by {meaning}, and should be by the world's distance");
    Some(describe(what, &tally, Vec::new()))
}
