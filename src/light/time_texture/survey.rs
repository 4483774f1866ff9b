//! What looks wrong about data, before anything is rendered from them.
//!
//! All of it is judged by a part of the pixels and lines, evenly spread, so that it costs little for any size.
//!
//! - Order of axes: of the samples along a line, how large a part holds 90 % of the line's light? In time that is
//!   small (a pulse and its tail), across a picture it is large (most of what is seen is lit at some time). Of the
//!   corner's captures and its lightmap it is 0.11 to 0.17 along T, and 0.33 to 0.53 along H and W. What was assumed
//!   to be T is doubted where another axis has less than half of its part.
//! - Ends: the light of the first and of the last bin, against that of the brightest.
//! - Capture: what was recorded at time t left its surface at t − η (r − n / cos θ). Lamps that flash at time 0 light
//!   nothing before; and pixels that see no object record nothing.

use super::capture::Capture;
use super::texture::TimeTexture;
use crate::io::cube::Cube;

/// Pixels that are looked at.
const PIXELS: usize = 4096;
/// Lines along each axis that are looked at.
const LINES: usize = 512;
/// Fewer entries along an axis tell nothing about it.
const FEWEST: usize = 8;
/// The part of all light that may be where none should be.
const TOLERATED: f64 = 0.05;

/// How the order of axes came about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Order {
    /// It was stated.
    Stated,
    /// That of an array was assumed, (H, W, T).
    Array,
    /// That of a sequence of pictures was assumed, a frame per bin.
    Pictures,
}

/// What looks wrong about the samples of `cube` by themselves.
pub fn of_samples(cube: &Cube, order: Order) -> Vec<String> {
    let light = Light::of(cube);
    let mut remarks = Vec::new();
    if light.total == 0.0 {
        return vec!["every sample that was looked at is 0".into()];
    }
    if light.negative > TOLERATED * light.total {
        remarks.push(format!(
            "samples below 0 are {} of all light",
            percent(light.negative / light.total)
        ));
    }
    remarks.extend(ends(&light.per_bin));
    if order != Order::Stated {
        remarks.extend(self::order(cube, order == Order::Pictures));
    }
    remarks
}

/// What looks wrong about how data lie in the image of the camera that captured them, and in time. Of cubes that are
/// read from disk nothing is looked at.
pub fn of_capture(texture: &TimeTexture, capture: &Capture) -> Vec<String> {
    let Some(cube) = texture.cube().in_memory() else {
        return Vec::new();
    };
    let [h, w, bins, _] = cube.shape;
    let [start, end] = texture.span();
    let axis = texture.axis();
    let (mut total, mut unseen, mut early) = (0.0, 0.0, 0.0);
    let (mut nearest, mut farthest) = (f64::INFINITY, 0.0f64);
    for pixel in spread(h * w, PIXELS) {
        let seen = capture.distance(pixel);
        let delay = capture.delay_of(pixel);
        if let Some(distance) = seen {
            nearest = nearest.min(distance);
            farthest = farthest.max(distance);
        }
        for bin in 0..bins {
            let value = cube.total(pixel, bin).abs();
            let left = axis.end(bin + 1) - delay;
            total += value;
            unseen += if seen.is_none() { value } else { 0.0 };
            early += if seen.is_some() && left < 0.0 {
                value
            } else {
                0.0
            };
        }
    }
    let mut remarks = Vec::new();
    if unseen > TOLERATED * total {
        remarks.push(format!(
            "{} of the recorded light is in pixels through whose centres the capture camera sees no object: check \
             its pose, field of view and crop, and whether all objects are there",
            percent(unseen / total)
        ));
    }
    if !capture.is_warped() || farthest == 0.0 {
        return remarks;
    }
    if early > TOLERATED * total {
        remarks.push(format!(
            "{} of the recorded light would have left its surface before time 0: check start (now {start} m), \
             bin_width (now {} m) and their units, capture.near_clip, and whether the clock is the capture \
             camera's; objects are {nearest:.4} to {farthest:.4} m from it",
            percent(early / total),
            axis.bins.width()
        ));
    }
    let window = end - start;
    if !(1e-3 * farthest..=1e3 * farthest).contains(&window) {
        remarks.push(format!(
            "the data are {window:e} m of light path long, and objects up to {farthest:.4} m from the capture \
             camera: check the unit of bin_width"
        ));
    }
    remarks
}

/// The light of the pixels that are looked at.
struct Light {
    per_bin: Vec<f64>,
    /// Of all samples, without their signs.
    total: f64,
    /// Of samples below 0.
    negative: f64,
}

impl Light {
    fn of(cube: &Cube) -> Light {
        let [h, w, bins, _] = cube.shape;
        let mut light = Light {
            per_bin: vec![0.0; bins],
            total: 0.0,
            negative: 0.0,
        };
        for pixel in spread(h * w, PIXELS) {
            for (bin, sum) in light.per_bin.iter_mut().enumerate() {
                let value = cube.total(pixel, bin);
                *sum += value.abs();
                light.total += value.abs();
                light.negative += (-value).max(0.0);
            }
        }
        light
    }
}

/// Whether light is cut off at an end of the window.
fn ends(per_bin: &[f64]) -> Option<String> {
    let brightest = per_bin.iter().copied().fold(0.0, f64::max);
    let (&first, &last) = (per_bin.first()?, per_bin.last()?);
    if per_bin.len() < FEWEST || (first.min(last) > 0.5 * brightest) {
        return None;
    }
    let cut = |part: f64| part > TOLERATED * brightest;
    let end = match (cut(first), cut(last)) {
        (true, true) => "first and the last bin are",
        (true, false) => "first bin is",
        (false, true) => "last bin is",
        (false, false) => return None,
    };
    let bright = percent(first.max(last) / brightest);
    Some(format!(
        "the {end} still lit ({bright} of the brightest): light is cut off at the end of the data"
    ))
}

/// Whether another axis looks more like time than that which is taken for it.
fn order(cube: &Cube, pictures: bool) -> Option<String> {
    let [h, w, t, _] = cube.shape;
    if h.min(w).min(t) < FEWEST {
        return None;
    }
    let [rows, columns, time] = [0, 1, 2].map(|axis| lit_part(cube, axis));
    let (least, order) = match rows < columns {
        true => (rows, "T H W"),
        false => (columns, "H T W"),
    };
    if pictures {
        return (least < 0.5 * time).then(|| {
            format!(
                "the pictures are taken for frames, but 90 % of the light of a pixel fill {} of the frames and only {} of \
                 another axis: if they are streaks, each a row of the camera with time along x, say axes = \"H W T\", and \
                 if they are frames, say axes = \"T H W\"",
                percent(time),
                percent(least)
            )
        });
    }
    (least < 0.5 * time).then(|| {
        format!(
            "the axes are taken for (H, W, T), but 90 % of a line's light fill {} of the axis taken for T and only {} of \
             another: if the order is {order}, say axes = \"{order}\", and if it is H W T, say that",
            percent(time),
            percent(least)
        )
    })
}

/// The part of a line along `axis` that holds 90 % of its light: the mean over lines that are not dark.
fn lit_part(cube: &Cube, axis: usize) -> f64 {
    let [h, w, t, _] = cube.shape;
    // The sizes of the two other axes and of this one, and how to get from them to a pixel and a bin.
    let (others, length): (_, usize) = match axis {
        0 => ([w, t], h),
        1 => ([h, t], w),
        _ => ([h, w], t),
    };
    let value = |a: usize, b: usize, n: usize| match axis {
        0 => cube.total(n * w + a, b),
        1 => cube.total(a * w + n, b),
        _ => cube.total(a * w + b, n),
    };
    let mut lines = Vec::new();
    for line in spread(others[0] * others[1], LINES) {
        let (a, b) = (line / others[1], line % others[1]);
        let mut values: Vec<f64> = (0..length).map(|n| value(a, b, n).abs()).collect();
        values.sort_by(|a, b| b.total_cmp(a));
        let total: f64 = values.iter().sum();
        let mut left = 0.9 * total;
        let lit = values.iter().take_while(|&&value| {
            left -= value;
            left > 0.0
        });
        lines.push((total, (lit.count() + 1) as f64 / length as f64));
    }
    let mean = lines.iter().map(|line| line.0).sum::<f64>() / lines.len() as f64;
    let bright: Vec<f64> = (lines.iter().filter(|line| line.0 > 0.1 * mean))
        .map(|line| line.1)
        .collect();
    bright.iter().sum::<f64>() / bright.len().max(1) as f64
}

/// About `most` of `count` indices, evenly spread: every s-th of them, s odd, so that it is not the size of rows.
fn spread(count: usize, most: usize) -> impl Iterator<Item = usize> {
    (0..count).step_by((count / most).max(1) | 1)
}

fn percent(part: f64) -> String {
    format!("{:.1} %", 100.0 * part)
}
