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

use std::collections::BTreeMap;

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
    let mut per_bin = vec![0.0; bins];
    // By how many bins it is too early.
    let mut by_lack: BTreeMap<u64, f64> = BTreeMap::new();
    for pixel in spread(h * w, PIXELS) {
        let seen = capture.distance(pixel);
        let delay = capture.delay_of(pixel);
        if let Some(distance) = seen {
            nearest = nearest.min(distance);
            farthest = farthest.max(distance);
        }
        for (bin, sum) in per_bin.iter_mut().enumerate() {
            let value = cube.total(pixel, bin).abs();
            let left = axis.end(bin + 1) - delay;
            total += value;
            unseen += if seen.is_none() { value } else { 0.0 };
            *sum += value;
            if seen.is_some() && left < 0.0 && value > 0.0 {
                early += value;
                let lack = (-left / axis.bins.width()).ceil() as u64;
                *by_lack.entry(lack).or_default() += value;
            }
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
    let width = axis.bins.width();
    let lit = lit_bins(&per_bin).map(|[first, last]| [axis.end(first), axis.end(last + 1)]);
    let fit = lit.and_then(|lit| other_unit(lit, [nearest, farthest]));
    let fit = fit.map(|power| {
        let times = [start, width].map(|time| time * 10f64.powi(power));
        format!(
            "; in a unit 10^{power} times as long they would fit: start = \"{} m\", bin_width = \"{} m\"",
            times[0], times[1]
        )
    });
    if early > TOLERATED * total {
        let later = start + lack(&by_lack, TOLERATED * total) as f64 * width;
        let fit = fit.clone().unwrap_or_else(|| {
            format!(
                "; from start = \"{later:.6} m\" on, {} would not be early",
                percent(1.0 - TOLERATED)
            )
        });
        remarks.push(format!(
            "{} of the recorded light would have left its surface before time 0: check start (now {start} m), \
             bin_width (now {width} m) and their units, capture.near_clip, and whether the clock is the capture \
             camera's; objects are {nearest:.4} to {farthest:.4} m from it{fit}",
            percent(early / total)
        ));
    } else if let Some([first, _]) = lit.filter(|[first, _]| *first > LATE * farthest) {
        remarks.push(format!(
            "the first light arrives after {first} m, and objects are {nearest:.4} to {farthest:.4} m from the capture \
             camera: check start (now {start} m), bin_width (now {width} m) and their units{}",
            fit.clone().unwrap_or_default()
        ));
    }
    let window = end - start;
    if !(1e-3 * farthest..=1e3 * farthest).contains(&window) {
        remarks.push(format!(
            "the data are {window:e} m of light path long, and objects up to {farthest:.4} m from the capture \
             camera: check the unit of bin_width{}",
            fit.unwrap_or_default()
        ));
    }
    remarks
}

/// Light that first arrives after so many times the way to the farthest object comes from nothing in the scene.
const LATE: f64 = 100.0;
/// The same of light in a unit that would fit better than the one that is said.
const FITTING: f64 = 30.0;

/// The first and the last bin that are lit.
fn lit_bins(per_bin: &[f64]) -> Option<[usize; 2]> {
    let brightest = per_bin.iter().copied().fold(0.0, f64::max);
    let is_lit = |light: &f64| *light > TOLERATED * brightest;
    Some([
        per_bin.iter().position(is_lit)?,
        per_bin.iter().rposition(is_lit)?,
    ])
}

/// By which power of ten times from `first` to `last` would be in a unit in which light comes from objects between `nearest`
/// and `farthest`: the smallest; none where they are so already, or in no such unit.
fn other_unit([first, last]: [f64; 2], [nearest, farthest]: [f64; 2]) -> Option<i32> {
    let fits = |power: i32| {
        let [first, last] = [first, last].map(|time| time * 10f64.powi(power));
        last >= nearest
            && first <= FITTING * farthest
            && first >= 0.5 * nearest
            && last <= LATE * farthest
    };
    let powers = (1..=15).flat_map(|power| [power, -power]);
    match fits(0) {
        true => None,
        false => powers.into_iter().find(|power| fits(*power)),
    }
}

/// So many bins later, no more than `tolerated` of the light is too early.
fn lack(by_lack: &BTreeMap<u64, f64>, tolerated: f64) -> u64 {
    let mut left = tolerated;
    let mut later = by_lack.iter().rev().skip_while(|(_, light)| {
        left -= *light;
        left >= 0.0
    });
    later.next().map_or(0, |(lack, _)| *lack)
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Objects 3 to 5 m away, whose light arrives from 4 to 20 m.
    #[test]
    fn units_that_are_off_by_powers_of_ten_are_named() {
        let seen = |scale: f64| other_unit([4.0 * scale, 20.0 * scale], [3.0, 5.0]);
        assert_eq!(seen(1.0), None);
        // Millimetres that are taken for metres, and metres for millimetres; picoseconds for seconds of path.
        assert_eq!(seen(1e3), Some(-2));
        assert_eq!(seen(1e6), Some(-5));
        assert_eq!(seen(1e-3), Some(3));
        assert_eq!(seen(1e-12), Some(12));
        // No unit brings what begins at 0 to where objects are.
        assert_eq!(other_unit([0.0, 1e-3], [3.0, 5.0]), None);
    }

    #[test]
    fn a_later_start_leaves_no_more_than_what_is_tolerated() {
        let by_lack = BTreeMap::from([(1, 10.0), (4, 3.0), (9, 2.0)]);
        assert_eq!(lack(&by_lack, 0.0), 9);
        assert_eq!(lack(&by_lack, 2.0), 4);
        assert_eq!(lack(&by_lack, 5.0), 1);
        assert_eq!(lack(&by_lack, 15.0), 0);
        assert_eq!(lit_bins(&[0.0, 0.01, 1.0, 0.2, 0.0]), Some([2, 3]));
        assert_eq!(lit_bins(&[]), None);
    }
}
