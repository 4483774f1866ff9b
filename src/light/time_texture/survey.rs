//! What looks wrong about data, before anything is rendered from them.
//!
//! All of it is judged by a part of the pixels and lines, evenly spread, so that it costs little for any size. Of cubes on
//! disk that part is smaller, in groups of neighbours, which share what is read together.
//!
//! - Order of axes: of the samples along a line, how large a part holds 90 % of the line's light? In time that is
//!   small (a pulse and its tail), across a picture it is large (most of what is seen is lit at some time). Of the
//!   corner's captures and its lightmap it is 0.11 to 0.17 along T, and 0.33 to 0.53 along H and W. What was assumed
//!   to be T is doubted where another axis has less than half of its part.
//! - Order of bytes: the sizes of samples, as they are and with their bytes turned round ([`ByteOrder`]).
//! - Samples below 0: all of them in memory, of cubes on disk those of the part that is looked at.
//! - Ends: the light of the first and of the last bin, against that of the brightest. Noise about 0 cancels in their sums.
//! - Capture: what was recorded at time t left its surface at t − η (r − n / cos θ). Lamps that flash at time 0 light
//!   nothing before; and pixels that see no object record nothing.

use std::collections::BTreeMap;

use glam::DVec3;

use super::capture::Capture;
use super::texture::TimeTexture;
use crate::io::cube::{BelowZero, ByteOrder, CubeStore, Negative, Peeked, Sign};
use crate::scene::model::TimeBins;

/// Pixels that are looked at.
const PIXELS: usize = 4096;
/// Lines along each axis that are looked at.
const LINES: usize = 512;
/// Of cubes on disk: lines, and neighbours in a row that are looked at together.
const LINES_ON_DISK: usize = 12;
const TOGETHER: usize = 16;
/// The part of a cube on disk that is read, and bounds on it, bytes.
const PART_ON_DISK: u64 = 256;
const READ_ON_DISK: [u64; 2] = [8 << 20, 64 << 20];
/// Samples that are enough to judge their sizes by.
const MOST_SIZES: usize = 1 << 20;
/// Pixels that are enough to judge a picture by.
const ENOUGH: usize = 256;
/// Dark bins in a row, and no more, may be dead ones.
const DEAD: usize = 2;
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

/// Lines of samples along time, from memory or from disk.
struct Lines<'a> {
    store: &'a CubeStore,
    near: Peeked,
    samples: Vec<f64>,
}

impl<'a> Lines<'a> {
    fn new(store: &'a CubeStore) -> Lines<'a> {
        Lines {
            store,
            near: Peeked::default(),
            samples: Vec::new(),
        }
    }

    /// The sums over the channels of bins `bin` and on of a pixel, as many as `to` has room for.
    fn read(&mut self, pixel: usize, bin: usize, to: &mut [f64]) {
        match self.store {
            CubeStore::Memory(cube) => {
                for (bin, to) in (bin..).zip(to) {
                    *to = cube.total(pixel, bin);
                }
            }
            CubeStore::Disk(bricks) => {
                let channels = self.store.shape()[3];
                self.samples.clear();
                self.samples.resize(to.len() * channels, 0.0);
                bricks.peek(&mut self.near, pixel, bin, &mut self.samples);
                for (to, samples) in to.iter_mut().zip(self.samples.chunks(channels)) {
                    *to = samples.iter().sum();
                }
            }
        }
    }

    /// All samples of a pixel, bin by bin, channel by channel, in place of what is in `to`.
    fn all(&mut self, pixel: usize, to: &mut Vec<f64>) {
        let [_, _, bins, channels] = self.store.shape();
        let each = bins * channels;
        to.clear();
        match self.store {
            CubeStore::Memory(cube) => {
                let samples = pixel * each..(pixel + 1) * each;
                to.extend(samples.map(|at| cube.samples.get(at).unwrap_or(0.0)));
            }
            CubeStore::Disk(bricks) => {
                to.resize(each, 0.0);
                bricks.peek(&mut self.near, pixel, 0, to);
            }
        }
    }

    /// The pixels that are looked at.
    fn pixels(&self) -> Vec<usize> {
        let [h, w, ..] = self.store.shape();
        let Some(bricks) = self.store.on_disk() else {
            return spread(h * w, PIXELS).collect();
        };
        let samples: usize = self.store.shape().iter().product();
        let [least, most] = READ_ON_DISK;
        let all = samples as u64 * self.store.sample_bytes() as u64;
        let budget = (all / PART_ON_DISK).clamp(least, most);
        let groups = (budget / bricks.bytes_of_line().max(1)).clamp(1, (PIXELS / TOGETHER) as u64);
        // Each begins in the middle of its part of the picture.
        let begin = |group: u64| ((2 * group + 1) as usize * h * w) / (2 * groups as usize);
        let mut pixels: Vec<usize> = (0..groups)
            .flat_map(|group| begin(group)..(begin(group) + TOGETHER).min(h * w))
            .collect();
        pixels.dedup();
        pixels
    }

    /// How many lines along each axis are looked at.
    fn lines(&self) -> usize {
        match self.store.on_disk() {
            None => LINES,
            Some(_) => LINES_ON_DISK,
        }
    }
}

/// What looks wrong about the samples of a cube by themselves, of whose samples below 0 nothing is said. Of one whose bricks are
/// only counted nothing is looked at.
pub fn of_samples(cube: &CubeStore, order: Order) -> Vec<String> {
    of_samples_with(cube, order, None, false)
}

/// The same where it is said what becomes of samples below 0, and of light at the ends of the data if it `is_held` there.
pub fn of_samples_with(
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
    let mut remarks = Vec::new();
    if light.total == 0.0 {
        // A small part of the picture may well be dark.
        let is_all = cube.on_disk().is_none();
        return Vec::from_iter(is_all.then(|| "every sample that was looked at is 0".into()));
    }
    if let Some(remark) = byte_order(&mut lines) {
        // Nothing else means anything then.
        return vec![remark];
    }
    if negative.is_none() {
        remarks.extend(below_zero(&mut lines, &light));
    }
    if !is_held {
        remarks.extend(ends(&light.per_bin));
    }
    remarks.extend(dead(&light.unsigned));
    if order != Order::Stated {
        remarks.extend(self::order(&mut lines, order == Order::Pictures));
    }
    remarks
}

/// Whether the bytes of samples stand in the wrong order.
fn byte_order(lines: &mut Lines) -> Option<String> {
    let bytes = lines.store.sample_bytes();
    let (mut samples, mut line) = (Vec::new(), Vec::new());
    for pixel in lines.pixels() {
        lines.all(pixel, &mut line);
        samples.extend_from_slice(&line);
        if samples.len() > MOST_SIZES {
            break;
        }
    }
    let ByteOrder { sign, now, turned } = ByteOrder::of(&samples, bytes, lines.store.shape()[3])?;
    let [now_part, turned_part] = [now, turned].map(percent);
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

/// What to say of samples below 0.
fn below_zero(lines: &mut Lines, light: &Light) -> Option<String> {
    let shape = lines.store.shape();
    let found = match lines.store.in_memory() {
        Some(cube) => cube.below_zero(),
        None => {
            let (each, mut line) = (shape[2] * shape[3], Vec::new());
            let mut samples = Vec::new();
            for pixel in lines.pixels() {
                lines.all(pixel, &mut line);
                samples.extend((pixel * each..).zip(line.iter().copied()));
            }
            BelowZero::among(samples.into_iter(), shape)
        }
    }?;
    let looked_at = match lines.store.in_memory() {
        Some(_) => "",
        None => " (of the part that was looked at)",
    };
    Some(format!(
        "{found}{looked_at}; they are {} of all light, and are read as they are: negative = \"keep\" says that this is right, \"zero\" \
         takes them for 0, \"refuse\" refuses the cube",
        percent(light.negative / light.total)
    ))
}

/// What looks wrong about how data lie in the image of the camera that captured them, and in time.
/// `index` is η of the medium.
pub fn of_capture(texture: &TimeTexture, capture: &Capture, index: f64) -> Vec<String> {
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
    // By how many bins it is too early.
    let mut by_lack: BTreeMap<u64, f64> = BTreeMap::new();
    let mut onsets = Onsets::default();
    for &pixel in &pixels {
        lines.read(pixel, 0, &mut line);
        let seen = capture.distance(pixel);
        let delay = capture.delay_of(pixel);
        if let Some(distance) = seen {
            nearest = nearest.min(distance);
            farthest = farthest.max(distance);
        }
        if let Some(aim) = capture.aim_of(pixel) {
            onsets.note(&line, aim.position, index * seen.unwrap_or_default());
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
            "{} of the recorded light is in pixels through whose centres the capture camera sees no object: check \
             its pose, field of view and crop, and whether all objects are there",
            percent(unseen / total)
        ));
    }
    // Of steady data there is no time, and of short ones no order in time.
    if bins == 1 || farthest == 0.0 {
        return remarks;
    }
    let width = axis.bins.width();
    let lit = lit_bins(&per_bin).map(|[first, last]| [axis.end(first), axis.end(last + 1)]);
    let uneven = bins >= FEWEST && is_enough && matches!(axis.bins, TimeBins::Uniform { .. });
    if let Some(remark) = onsets
        .remark(width, index, capture.is_warped())
        .filter(|_| uneven)
    {
        remarks.push(remark);
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
        // Light that takes as long as the way across the scene needs no other unit, and no unit moves a start at 0.
        let is_long = lit.is_some_and(|[first, last]| last - first >= 0.5 * (farthest - nearest));
        let fit = fit
            .clone()
            .filter(|_| !is_long && start != 0.0)
            .unwrap_or_else(
                || match onsets.start_of_flash(width, index).filter(|_| uneven) {
                    Some(fitting) => format!(
                        "; start = \"{} m\" would fit a flash at time 0",
                        nearest_step(fitting, width)
                    ),
                    None => format!(
                        "; from start = \"{later} m\" on, {} would not be early",
                        percent(1.0 - TOLERATED)
                    ),
                },
            );
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

/// The times between which most bins are lit; none of dark data, and of data on disk, which are not read for it.
pub fn lit_span(texture: &TimeTexture) -> Option<[f64; 2]> {
    let store = texture.cube();
    if store.on_disk().is_some() {
        return None;
    }
    let light = Light::of(&mut Lines::new(store));
    let [first, last] = lit_bins(&light.per_bin)?;
    Some([texture.axis().end(first), texture.axis().end(last + 1)])
}

/// When light first came from points, by which the width of bins and the clock can be told from wrong ones: the time at which
/// light first reaches a point differs between two points by no more than the way of light from one to the other takes.
#[derive(Default)]
struct Onsets(Vec<Onset>);

struct Onset {
    /// Bins from the start of the data.
    bin: f64,
    /// The bin at which first light is brightest: the middle of a flash.
    peak: f64,
    /// The most light of a bin.
    brightest: f64,
    position: DVec3,
    /// From there to the camera, metres of light path.
    delay: f64,
}

impl Onsets {
    fn note(&mut self, line: &[f64], position: DVec3, delay: f64) {
        let brightest = line.iter().copied().fold(0.0, f64::max);
        let first = line.iter().position(|value| *value > 0.25 * brightest);
        let climb = |first: usize| {
            let pairs = line[first..]
                .windows(2)
                .take_while(|pair| pair[1] > pair[0]);
            first + pairs.count()
        };
        self.0.extend(first.map(|bin| Onset {
            bin: bin as f64,
            peak: climb(bin) as f64,
            brightest,
            position,
            delay,
        }));
    }

    /// The part of pairs of points between which first light would have been faster than light, by bins of `width`, where
    /// times are those of arrival at the camera (`warped`) or not.
    fn too_fast(&self, width: f64, index: f64, warped: bool) -> f64 {
        let some = self.bright();
        let left = |onset: &Onset| onset.bin * width - if warped { onset.delay } else { 0.0 };
        let (mut pairs, mut fast) = (0usize, 0usize);
        for (n, one) in some.iter().enumerate() {
            for other in &some[..n] {
                let way = index * (one.position - other.position).length();
                pairs += 1;
                fast += usize::from((left(one) - left(other)).abs() > way + ROUGH * width);
            }
        }
        fast as f64 / pairs.max(1) as f64
    }

    /// The start by which first light is that of one flash at time 0, metres; none where no point is its place.
    ///
    /// Of light that arrives t + o later than at 0, t in metres from the start of the data and o the start, d of which are the
    /// way from a point x to the camera: t + o − d = η|s − x| for a flash at s. With e = (t − d)/η and p = o/η its square is
    /// linear in p, s and p² − s²: 2 e p + 2 s·x + (p² − s²) = x² − e². Points in shadow do not obey; the half that fits best
    /// is taken again.
    fn start_of_flash(&self, width: f64, index: f64) -> Option<f64> {
        let rows: Vec<[f64; 6]> = (self.bright().into_iter())
            .map(|onset| {
                let (x, e) = (
                    onset.position,
                    ((onset.peak + 0.5) * width - onset.delay) / index,
                );
                let right = x.length_squared() - e * e;
                [2.0 * e, 2.0 * x.x, 2.0 * x.y, 2.0 * x.z, 1.0, right]
            })
            .collect();
        let mut kept: Vec<&[f64; 6]> = rows.iter().collect();
        let mut found = None;
        for _ in 0..8 {
            let solved = least_squares(&kept)?;
            let [p, x, y, z, _] = solved;
            // By how many metres a point is off: the row is the difference of two squares.
            let off = |row: &[f64; 6]| {
                let at = DVec3::new(row[1], row[2], row[3]) * 0.5;
                ((0.5 * row[0] + p) - at.distance(DVec3::new(x, y, z))).abs()
            };
            let mut by_error: Vec<_> = rows.iter().map(|row| (off(row), row)).collect();
            by_error.sort_by(|a, b| a.0.total_cmp(&b.0));
            by_error.truncate(rows.len() / 2);
            let worst = by_error.last()?.0;
            found = (worst * index < ROUGH * width).then_some(p * index);
            kept = by_error.into_iter().map(|(_, row)| row).collect();
        }
        found
    }

    /// Points whose light is well above nothing, spread evenly.
    fn bright(&self) -> Vec<&Onset> {
        let brightest = (self.0.iter()).fold(0.0, |most: f64, onset| most.max(onset.brightest));
        let bright: Vec<_> = (self.0.iter())
            .filter(|onset| onset.brightest > TOLERATED * brightest)
            .collect();
        spread(bright.len(), ENOUGH).map(|at| bright[at]).collect()
    }

    fn remark(&self, width: f64, index: f64, warped: bool) -> Option<String> {
        let now = self.too_fast(width, index, warped);
        if self.0.len() < FEWEST || now < FAST {
            return None;
        }
        let what = format!(
            "between {} of the points, light would have travelled faster than light, by the times of first light",
            percent(now)
        );
        let power = (1..=15)
            .find(|power| self.too_fast(width * 10f64.powi(-power), index, warped) < FAST / 4.0);
        let fit = power.map(|power| {
            let width = rounded(width * 10f64.powi(-power));
            format!("; in a unit 10^-{power} times as long it would fit: bin_width = \"{width} m\"")
        });
        Some(format!(
            "{what}: check bin_width (now {} m){}",
            rounded(width),
            fit.unwrap_or_default()
        ))
    }
}

/// The unknowns a of rows a·row = right, the last entry, by normal equations; none where they do not follow.
fn least_squares(rows: &[&[f64; 6]]) -> Option<[f64; 5]> {
    let mut m = [[0.0; 6]; 5];
    for row in rows {
        for (i, line) in m.iter_mut().enumerate() {
            for (k, sum) in line.iter_mut().enumerate() {
                *sum += row[i] * row[k];
            }
        }
    }
    let scale = m
        .iter()
        .flatten()
        .fold(0.0, |most: f64, entry| most.max(entry.abs()));
    // Gauss and Jordan, with pivots; below 1e-12 of the largest entry a pivot is rounding.
    for i in 0..5 {
        let pivot = (i..5).max_by(|a, b| m[*a][i].abs().total_cmp(&m[*b][i].abs()))?;
        m.swap(i, pivot);
        let line = m[i];
        if line[i].abs() <= 1e-12 * scale {
            return None;
        }
        for (_, other) in m.iter_mut().enumerate().filter(|(k, _)| *k != i) {
            let part = other[i] / line[i];
            other
                .iter_mut()
                .zip(line)
                .for_each(|(entry, by)| *entry -= part * by);
        }
    }
    Some(std::array::from_fn(|i| m[i][5] / m[i][i]))
}

/// Times of first light are known to so many bins.
const ROUGH: f64 = 4.0;
/// The part of pairs that may be too fast: first light in shadow comes from elsewhere, and is faint.
const FAST: f64 = 0.2;

/// The multiple of the width of a bin, to which times of first light are known, that is nearest.
fn nearest_step(time: f64, width: f64) -> f64 {
    rounded((time / width).round() * width)
}

/// A number of six digits, for people.
pub(crate) fn rounded(value: f64) -> f64 {
    // Adding 0 makes 0 of −0.
    format!("{value:.5e}").parse().unwrap_or(value) + 0.0
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
    /// Sums over pixels, in which noise about 0 cancels; no less than 0.
    per_bin: Vec<f64>,
    /// The same of samples without their signs.
    unsigned: Vec<f64>,
    /// Of all samples, without their signs.
    total: f64,
    /// Of samples below 0.
    negative: f64,
}

impl Light {
    fn of(lines: &mut Lines) -> Light {
        let bins = lines.store.shape()[2];
        let mut line = vec![0.0; bins];
        let mut light = Light {
            per_bin: vec![0.0; bins],
            unsigned: vec![0.0; bins],
            total: 0.0,
            negative: 0.0,
        };
        for pixel in lines.pixels() {
            lines.read(pixel, 0, &mut line);
            for (bin, &value) in line.iter().enumerate() {
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

/// Bins without any light among lit ones.
fn dead(per_bin: &[f64]) -> Option<String> {
    let brightest = per_bin.iter().copied().fold(0.0, f64::max);
    let is_lit = |bin: usize| {
        per_bin
            .get(bin)
            .is_some_and(|light| *light > TOLERATED * brightest)
    };
    let mut dead: Vec<String> = Vec::new();
    // A short run of empty bins between lit ones; at an end of the data, or long, it is plain darkness.
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
            "{} of {} bins are 0 in all pixels that were looked at, among lit ones: {shown}{}; if the sensor's bins are dead there, \
             say so: dead_bins = [{shown}]",
            dead.len(),
            per_bin.len(),
            if dead.len() > 8 { ", …" } else { "" }
        )
    })
}

/// Whether another axis looks more like time than that which is taken for it.
fn order(lines: &mut Lines, pictures: bool) -> Option<String> {
    let [h, w, t, _] = lines.store.shape();
    if h.min(w).min(t) < FEWEST {
        return None;
    }
    // Light at a place is brief: along time few bins hold most of a line, along the axes of the picture many pixels do.
    let [rows, columns, time] = [0, 1, 2].map(|axis| lit_part(lines, axis));
    let (rows, columns, time) = (rows?, columns?, time?);
    // Twice as brief, or the axes are taken to be right.
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

/// The part of a line along `axis` that holds 90 % of its light: the mean over lines that are not dark; none where all that are looked at
/// are.
fn lit_part(from: &mut Lines, axis: usize) -> Option<f64> {
    let [h, w, t, _] = from.store.shape();
    // The sizes of the two other axes and of this one, and how to get from them to a pixel and a bin.
    let (others, length): (_, usize) = match axis {
        0 => ([w, t], h),
        1 => ([h, t], w),
        _ => ([h, w], t),
    };
    let place = |a: usize, b: usize, n: usize| match axis {
        0 => (n * w + a, b),
        1 => (a * w + n, b),
        _ => (a * w + b, n),
    };
    let mut lines = Vec::new();
    for line in spread(others[0] * others[1], from.lines()) {
        let (a, b) = (line / others[1], line % others[1]);
        let mut values = vec![0.0; length];
        match axis {
            2 => from.read(a * w + b, 0, &mut values),
            _ => {
                for (n, value) in values.iter_mut().enumerate() {
                    let (pixel, bin) = place(a, b, n);
                    from.read(pixel, bin, std::slice::from_mut(value));
                }
            }
        }
        values.iter_mut().for_each(|value| *value = value.abs());
        values.sort_by(|a, b| b.total_cmp(a));
        let total: f64 = values.iter().sum();
        // Brightest first, until 90 % of the light is reached.
        let mut left = 0.9 * total;
        let lit = values.iter().take_while(|&&value| {
            left -= value;
            left > 0.0
        });
        lines.push((total, (lit.count() + 1) as f64 / length as f64));
    }
    let mean = lines.iter().map(|line| line.0).sum::<f64>() / lines.len() as f64;
    // Lines with little light are mostly noise.
    let bright: Vec<f64> = (lines.iter().filter(|line| line.0 > 0.1 * mean))
        .map(|line| line.1)
        .collect();
    (!bright.is_empty()).then(|| bright.iter().sum::<f64>() / bright.len() as f64)
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
