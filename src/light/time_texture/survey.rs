//! Checks of data for suspicious properties, before anything is rendered from them.
//!
//! All checks use a subset of the pixels and lines, evenly spread, so that they are cheap for any size. For cubes on disk that subset is
//! smaller, in groups of neighbours, which share reads.
//!
//! - Order of axes: `axis_order`.
//! - Order of bytes: the sizes of samples, as they are and after byte swapping ([`ByteOrder`]).
//! - Samples below 0: all of them in memory; for cubes on disk those of the subset.
//! - Ends: the light of the first and of the last bin, relative to that of the brightest. Noise about 0 cancels in their sums.
//! - Capture: light recorded at time t left its surface at t − η (r − n / cos θ). Lamps that flash at time 0 light nothing before; and
//!   pixels that see no object record nothing. The head of `first_light` explains what first light reveals.

mod axis_order;
mod first_light;
mod lines;

use std::collections::BTreeMap;

use first_light::FirstLight;
pub(crate) use lines::rounded;
use lines::{Lines, percent};

use super::capture::Capture;
use super::texture::TimeTexture;
use crate::io::cube::{ByteOrder, Counted, CubeStore, Negative, Sign};
use crate::scene::model::TimeBins;

/// Enough samples to judge their sizes, and for cubes on disk.
const MOST_SIZES: usize = 1 << 20;
const MOST_SIZES_ON_DISK: usize = 1 << 18;
/// Enough pixels to judge a picture.
const ENOUGH: usize = 256;
/// The longest run of dark bins that may be dead ones.
const DEAD: usize = 2;
/// An axis with fewer entries gives no evidence.
const FEWEST: usize = 8;
/// The fraction of all light that is tolerated where there should be none.
const TOLERATED: f64 = 0.05;

/// The origin of the order of axes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Order {
    /// It was stated.
    Stated,
    /// The default for an array, (H, W, T).
    Array,
    /// The default for a sequence of pictures, a frame per bin.
    Pictures,
}

/// Suspicious properties of a cube's samples by themselves, except negative ones. A cube whose bricks are only counted is not examined.
pub fn of_samples(cube: &CubeStore, order: Order) -> Vec<String> {
    of_samples_with(cube, order, None, false)
}

/// The same given the treatment of negative samples, and with light at the ends of the data accepted if it `is_held` there.
pub(crate) fn of_samples_with(
    cube: &CubeStore,
    order: Order,
    negative: Option<Negative>,
    is_held: bool,
) -> Vec<String> {
    if cube.on_disk().is_some_and(|bricks| bricks.counts_only()) {
        return Vec::new();
    }
    let mut lines = Lines::new(cube);
    let light = Light::of(&mut lines);
    let shape = cube.shape();
    let mut remarks = Vec::new();
    if light.total == 0.0 {
        // A small part of the picture may well be dark.
        let is_all = cube.on_disk().is_none();
        return Vec::from_iter(is_all.then(|| "every sample examined is 0".into()));
    }
    if let Some(remark) = byte_order(&light.samples, cube.sample_bytes(), shape[3]) {
        // If so, nothing else is meaningful.
        return vec![remark];
    }
    if negative.is_none() {
        remarks.extend(below_zero(cube, &light));
    }
    if !is_held {
        remarks.extend(ends(&light.per_bin));
    }
    remarks.extend(dead(&light.unsigned));
    if order != Order::Stated {
        remarks.extend(axis_order::doubt(&mut lines, order == Order::Pictures));
    }
    remarks
}

/// Whether every sample examined of a cube in memory is 0.
pub(crate) fn is_dark(cube: &CubeStore) -> bool {
    cube.on_disk().is_none() && Light::of(&mut Lines::new(cube)).total == 0.0
}

/// Whether the bytes of samples, as many as these in the file, are in the wrong order.
fn byte_order(samples: &[f64], bytes: usize, channels: usize) -> Option<String> {
    let ByteOrder { sign, now, turned } = ByteOrder::of(samples, bytes, channels)?;
    let [now_part, turned_part] = [now, turned].map(percent);
    // No light has such magnitudes; of numbers with swapped bytes, a third (f32) or two thirds (f64) have them.
    let seen = match (sign, bytes) {
        (Sign::Sizes, 4) => {
            format!(
                "{now_part} of the samples are not of a size from 1e-25 to 1e25, and {turned_part}"
            )
        }
        (Sign::Sizes, _) => {
            format!(
                "{now_part} of the samples are not of a size from 1e-100 to 1e100, and {turned_part}"
            )
        }
        (Sign::Bytes, 2) => {
            format!("{now_part} of the samples are below 1.6e-5, and {turned_part}")
        }
        (Sign::Bytes, _) => {
            format!("{now_part} of the samples are multiples of 256, and {turned_part}")
        }
        (Sign::Spread, _) => format!(
            "the sizes of samples are spread by factors of 2^{now:.0}, and of 2^{turned:.0}"
        ),
        (Sign::Evenness, _) => "the lowest bytes of the samples take few values and the highest take all, and the reverse".into(),
        (Sign::Steps, _) => format!(
            "samples of neighbouring bins differ by {now_part} of their sum, as unrelated ones do, and by {turned_part}"
        ),
    };
    Some(format!(
        "{seen} with their bytes in the other order: the file says the wrong one; \
         in numpy, array.view(array.dtype.newbyteorder()) has the right one"
    ))
}

/// The warning about samples below 0.
fn below_zero(cube: &CubeStore, light: &Light) -> Option<String> {
    let found = match cube.in_memory() {
        Some(cube) => cube.below_zero(),
        None => light.counted.below_zero(cube.shape()),
    }?;
    let looked_at = match cube.in_memory() {
        Some(_) => "",
        None => " (of the part examined)",
    };
    Some(format!(
        "{found}{looked_at}; they are {} of all light, and are read as they are: negative = \"keep\" confirms this, \"zero\" replaces them by 0, \"refuse\" refuses the cube",
        percent(light.negative / light.total)
    ))
}

/// Suspicious properties of the data in the image of their capture camera, and in time. `index` is η of the medium.
pub(crate) fn of_capture(texture: &TimeTexture, capture: &Capture, index: f64) -> Vec<String> {
    let store = texture.cube();
    if store.on_disk().is_some_and(|bricks| bricks.counts_only()) {
        return Vec::new();
    }
    let mut lines = Lines::new(store);
    let (bins, pixels) = (store.shape()[2], lines.pixels());
    let mut line = vec![0.0; bins];
    let [start, end] = texture.span();
    let axis = texture.axis();
    let (mut total, mut unseen, mut early) = (0.0, 0.0, 0.0);
    let (mut nearest, mut farthest) = (f64::INFINITY, 0.0f64);
    let mut per_bin = vec![0.0; bins];
    // How many bins too early it is.
    let mut by_lack: BTreeMap<u64, f64> = BTreeMap::new();
    let mut first_light = FirstLight::new(axis.bins.width(), index);
    for &pixel in &pixels {
        lines.line(pixel, &mut line);
        let seen = capture.distance(pixel);
        let delay = capture.delay_of(pixel);
        if let Some(distance) = seen {
            nearest = nearest.min(distance);
            farthest = farthest.max(distance);
        }
        if let Some(aim) = capture.aim_of(pixel) {
            first_light.note(&line, aim.position, delay);
        }
        for (bin, sum) in per_bin.iter_mut().enumerate() {
            let value = line[bin];
            let left = axis.end(bin + 1) - delay;
            total += value;
            unseen += if seen.is_none() { value } else { 0.0 };
            *sum += value;
            if seen.is_some() && left < 0.0 && value != 0.0 {
                early += value;
                let lack = (-left / axis.bins.width()).ceil() as u64;
                *by_lack.entry(lack).or_default() += value;
            }
        }
    }
    let mut remarks = Vec::new();
    if total <= 0.0 {
        return remarks;
    }
    let is_enough = store.on_disk().is_none() || pixels.len() >= ENOUGH;
    if is_enough && unseen > TOLERATED * total {
        remarks.push(format!(
            "{} of the recorded light is in pixels whose centres show no object to the capture camera: check its pose, field of view and crop, and whether any objects are missing",
            percent(unseen / total)
        ));
    }
    // Steady data have no time, and short data no order in time.
    if bins == 1 || farthest == 0.0 {
        return remarks;
    }
    let width = axis.bins.width();
    let lit = lit_bins(&per_bin).map(|[first, last]| [axis.end(first), axis.end(last + 1)]);
    let uneven = bins >= FEWEST && is_enough && matches!(axis.bins, TimeBins::Uniform { .. });
    if uneven {
        remarks.extend(first_light.too_wide());
    }
    if !capture.is_warped() {
        return remarks;
    }
    let fit = lit.and_then(|lit| other_unit(lit, [nearest, farthest]));
    let fit = fit.map(|power| {
        let [start, width] = [start, width].map(|time| rounded(time * 10f64.powi(power)));
        format!(
            "; in a unit 10^{power} times as long they would fit: start = \"{start} m\", bin_width = \"{width} m\""
        )
    });
    let [now_start, now_width] = [start, width].map(rounded);
    if early > TOLERATED * total {
        let lack = lack(&by_lack, TOLERATED * total) as f64 * width;
        let later = rounded(start + lack);
        // If light takes about as long as the way across the scene, the unit is right, and no unit moves a start at 0.
        let is_long = lit.is_some_and(|[first, last]| last - first >= 0.5 * (farthest - nearest));
        let fit = fit
            .clone()
            .filter(|_| !is_long && start != 0.0)
            .unwrap_or_else(|| match first_light.explained(start).filter(|_| uneven) {
                Some(fitting) => format!("; {fitting} would fit a flash at time 0"),
                None => format!(
                    "; from start = \"{later} m\" on, {} would not be early",
                    percent(1.0 - TOLERATED)
                ),
            });
        remarks.push(format!(
            "{} of the recorded light would have left its surface before time 0: check start (now {now_start} m), \
             bin_width (now {now_width} m) and their units, capture.near_clip, and whether the clock is the capture \
             camera's; objects are {nearest:.4} to {farthest:.4} m from it{fit}",
            percent(early / total)
        ));
    } else if let Some([first, _]) = lit.filter(|[first, _]| *first > LATE * farthest) {
        remarks.push(format!(
            "the first light arrives after {} m, and objects are {nearest:.4} to {farthest:.4} m from the capture \
             camera: check start (now {now_start} m), bin_width (now {now_width} m) and their units{}",
            rounded(first),
            fit.clone().unwrap_or_default()
        ));
    } else if uneven {
        remarks.extend(first_light.early_flash(start));
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

/// The times between which most bins are lit; `None` for dark data, and for data on disk, which are not read for it.
pub(crate) fn lit_span(texture: &TimeTexture) -> Option<[f64; 2]> {
    let store = texture.cube();
    if store.on_disk().is_some() {
        return None;
    }
    let light = Light::of(&mut Lines::new(store));
    let [first, last] = lit_bins(&light.per_bin)?;
    Some([texture.axis().end(first), texture.axis().end(last + 1)])
}

/// Light that first arrives after more than this many times the way to the farthest object cannot come from the scene.
const LATE: f64 = 100.0;
/// The same if another unit would fit better than the stated one.
const FITTING: f64 = 30.0;

/// The first and the last lit bin.
fn lit_bins(per_bin: &[f64]) -> Option<[usize; 2]> {
    let brightest = per_bin.iter().copied().fold(0.0, f64::max);
    let is_lit = |light: &f64| *light > TOLERATED * brightest;
    Some([
        per_bin.iter().position(is_lit)?,
        per_bin.iter().rposition(is_lit)?,
    ])
}

/// The power of ten by which times from `first` to `last` must be scaled so that the light can come from objects between `nearest` and
/// `farthest`: the smallest; `None` if they already fit, or if none fits.
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

/// How many bins later at most `tolerated` of the light is too early.
fn lack(by_lack: &BTreeMap<u64, f64>, tolerated: f64) -> u64 {
    let mut left = tolerated;
    let mut later = by_lack.iter().rev().skip_while(|(_, light)| {
        left -= *light;
        left >= 0.0
    });
    later.next().map_or(0, |(lack, _)| *lack)
}

/// The light of the examined pixels.
struct Light {
    /// Sums over pixels, in which noise about 0 cancels; at least 0.
    per_bin: Vec<f64>,
    /// The same with the absolute values of samples.
    unsigned: Vec<f64>,
    /// The sum of the absolute values of all samples.
    total: f64,
    /// The sum of the absolute values of samples below 0.
    negative: f64,
    /// The samples of the first pixels, in order.
    samples: Vec<f64>,
    /// All of them.
    counted: Counted,
}

impl Light {
    fn of(lines: &mut Lines) -> Light {
        let [_, _, bins, channels] = lines.store.shape();
        let most = match lines.store.on_disk() {
            None => MOST_SIZES,
            Some(_) => MOST_SIZES_ON_DISK,
        };
        let (each, mut line) = (bins * channels, Vec::new());
        let mut light = Light {
            per_bin: vec![0.0; bins],
            unsigned: vec![0.0; bins],
            total: 0.0,
            negative: 0.0,
            samples: Vec::new(),
            counted: Counted::default(),
        };
        let pixels = lines.pixels();
        (light.samples).reserve_exact((pixels.len() * each).min(most + each));
        for pixel in pixels {
            lines.all(pixel, &mut line);
            if light.samples.len() <= most {
                light.samples.extend_from_slice(&line);
            }
            for (at, sample) in (pixel * each..).zip(&line) {
                light.counted.add(at, *sample);
            }
            for (bin, samples) in line.chunks(channels).enumerate() {
                let value: f64 = samples.iter().sum();
                light.per_bin[bin] += value;
                light.unsigned[bin] += value.abs();
                light.total += value.abs();
                light.negative += (-value).max(0.0);
            }
        }
        light.per_bin.iter_mut().for_each(|sum| *sum = sum.max(0.0));
        light
    }
}

/// Whether light is cut off at one end of the window.
fn ends(per_bin: &[f64]) -> Option<String> {
    let brightest = per_bin.iter().copied().fold(0.0, f64::max);
    let (&first, &last) = (per_bin.first()?, per_bin.last()?);
    if per_bin.len() < FEWEST || (first.min(last) > 0.5 * brightest) {
        return None;
    }
    let cut = |part: f64| part > TOLERATED * brightest;
    let (bins, end) = match (cut(first), cut(last)) {
        (true, true) => ("first and the last bin are", "both ends"),
        (true, false) => ("first bin is already", "the start"),
        (false, true) => ("last bin is still", "the end"),
        (false, false) => return None,
    };
    let bright = percent(first.max(last) / brightest);
    Some(format!(
        "the {bins} lit ({bright} of the brightest): light is cut off at {end} of the data"
    ))
}

/// Bins without any light between lit ones.
fn dead(per_bin: &[f64]) -> Option<String> {
    let brightest = per_bin.iter().copied().fold(0.0, f64::max);
    let is_lit = |bin: usize| {
        per_bin
            .get(bin)
            .is_some_and(|light| *light > TOLERATED * brightest)
    };
    let mut dead: Vec<String> = Vec::new();
    // A short run of empty bins between lit ones; at an end of the data, or if long, it is ordinary darkness.
    let mut begin = 1;
    for run in per_bin[1..].chunk_by(|a, b| (*a == 0.0) == (*b == 0.0)) {
        let end = begin + run.len();
        if run[0] == 0.0 && run.len() <= DEAD && is_lit(begin - 1) && is_lit(end) {
            dead.extend((begin..end).map(|bin| bin.to_string()));
        }
        begin = end;
    }
    let shown = dead[..dead.len().min(8)].join(", ");
    (!dead.is_empty()).then(|| {
        format!(
            "{} of {} bins are 0 in all pixels examined, among lit ones: {shown}{}; if the sensor's bins are dead there, \
             say so: dead_bins = [{shown}]",
            dead.len(),
            per_bin.len(),
            if dead.len() > 8 { ", …" } else { "" }
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Objects 3 to 5 m away, whose light arrives from 4 to 20 m.
    #[test]
    fn units_that_are_off_by_powers_of_ten_are_named() {
        let seen = |scale: f64| other_unit([4.0 * scale, 20.0 * scale], [3.0, 5.0]);
        assert_eq!(seen(1.0), None);
        // Millimetres taken for metres, and metres for millimetres; picoseconds for seconds of path.
        assert_eq!(seen(1e3), Some(-2));
        assert_eq!(seen(1e6), Some(-5));
        assert_eq!(seen(1e-3), Some(3));
        assert_eq!(seen(1e-12), Some(12));
        // No unit brings a start at 0 to where the objects are.
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
