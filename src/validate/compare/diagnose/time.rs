//! Emission times: shifts, rounding, and no retardation.

use super::super::geometry::Field;
use super::super::picture::Plane;
use super::{Case, Diagnosis, FEWEST, Kind, MOST, Tally, median};

/// The largest shift, relative to the times themselves, that is due to rounding to single precision.
const TIME_ROUNDING: f64 = 1e-6;
/// The tolerance around the median shift.
const SHARED: f64 = 0.1;

/// A constant shift of emission times.
pub(super) fn shifted(case: &Case) -> Option<Diagnosis> {
    let [r, c] = [case.points[0].time?, case.points[1].time?];
    let pixels = case.pixels();
    let shifts: Vec<f64> = pixels
        .iter()
        .map(|i| c.at(*i) - r.at(*i))
        .filter(|d| d.is_finite())
        .collect();
    let scale = pixels
        .iter()
        .map(|i| r.at(*i).abs())
        .filter(|t| t.is_finite())
        .fold(0.0, f64::max);
    let count = shifts.len() as f64;
    let shift = median(shifts.clone())?;
    let share = shifts
        .iter()
        .filter(|d| (*d - shift).abs() <= SHARED * shift.abs())
        .count() as f64
        / count;
    // Nearly equal times in half precision are rounded to the same side, by up to half a step.
    let times = case.pixels().iter().copied().map(|i| c.at(i));
    let is_half = times.filter(|t| t.is_finite()).all(is_of_half_precision);
    let rounding = if is_half {
        HALF_PRECISION / 4.0
    } else {
        TIME_ROUNDING
    };
    let explains = shifts.len() >= FEWEST && shift.abs() > rounding * scale && share >= MOST;
    (explains && shift.abs() > by_samples(case, r)).then(|| describe_shift(case, shift, share))
}

/// Displacements below this number of pixels are rounding: the pictures have the same samples.
const SAME_SAMPLES: f64 = 0.02;

/// The shift of times that samples elsewhere in pixels may cause: the change of the reference's times from a pixel to the next, or nothing
/// where the pictures show the same points.
fn by_samples(case: &Case, times: Plane) -> f64 {
    let pixels = case.pixels();
    let off = |field: &Field| {
        let off = pixels.iter().filter_map(|i| field.displacement(*i));
        median(off.map(|d| d.length()).collect())
    };
    if case
        .field
        .and_then(off)
        .is_none_or(|off| off <= SAME_SAMPLES)
    {
        return 0.0;
    }
    let width = case.points[0].width;
    let step = |by: usize| {
        let here = pixels
            .iter()
            .filter(|i| **i + by < case.points[0].height * width);
        let steps =
            here.filter(|i| case.points[0].object_at(**i) == case.points[0].object_at(**i + by));
        let steps = steps.map(|i| (times.at(i + by) - times.at(*i)).abs());
        median(steps.filter(|step| step.is_finite()).collect()).unwrap_or(0.0)
    };
    f64::max(step(1), step(width))
}

fn describe_shift(case: &Case, shift: f64, share: f64) -> Diagnosis {
    let late = if shift > 0.0 { "late" } else { "early" };
    let bins = case.bin_width.map(|width| shift.abs() / width);
    let amount = match bins {
        Some(bins) => format!("by {}", words_for_bins(bins)),
        None => format!("by {:.6} m of light path", shift.abs()),
    };
    let mut evidence = vec![
        ("median shift (m)", shift),
        ("share of pixels with it", share),
    ];
    evidence.extend(case.bin_width.map(|width| ("shift (bins)", shift / width)));
    Diagnosis {
        kind: Kind::TimeShifted,
        what: format!("emission times are too {late} {amount}, uniformly").into(),
        evidence,
    }
}

/// The text for a number of bins.
pub(super) fn words_for_bins(bins: f64) -> String {
    match bins {
        _ if (bins - 1.0).abs() < SHARED => "one bin".into(),
        _ if (bins - 0.5).abs() < 0.5 * SHARED => "half a bin".into(),
        _ => format!("{bins:.3} bins"),
    }
}

/// All emission times are equal, although the reference's differ.
pub(super) fn instant(case: &Case) -> Option<Diagnosis> {
    let [r, c] = case.points.map(|points| points.time);
    let (r, c): (Plane, Plane) = (r?, c?);
    let pixels = case.pixels();
    let time = median(
        pixels
            .iter()
            .map(|i| c.at(*i))
            .filter(|t| t.is_finite())
            .collect(),
    )?;
    let tally = Tally::of_all(pixels, |i| {
        Some([(c.at(i) - r.at(i)).abs(), (c.at(i) - time).abs()])
    });
    let scale = pixels.iter().map(|i| r.at(*i)).filter(|t| t.is_finite());
    let [low, high] = scale.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], t| {
        [low.min(t), high.max(t)]
    });
    // If the reference's times hardly differ, equal times are no evidence.
    let varied = high - low > 1e-3 * high.abs().max(low.abs());
    // The times are equal to one percent of the reference's range.
    let same = tally.rest() <= 0.01 * (high - low);
    (varied && same && tally.explains(0.1 * (high - low))).then(|| Diagnosis {
        kind: Kind::RetardationMissing,
        what: format!("retardation is missing: all emission times are {time:.6} m").into(),
        evidence: vec![
            ("times differ from the reference by (m, rms)", tally.error()),
            ("and from one another by (m, rms)", tally.rest()),
        ],
    })
}

/// For rounded times, the least number of pixels, and of different times in the reference, for each of the candidate's times.
const TIMES_FEWER: usize = 4;
/// Tolerance for gaps of times to be multiples of one step, relative to the step.
const WHOLE: f64 = 0.01;
/// Bins no wider than this fraction of the latest time are rounding to half precision.
const HALF_PRECISION: f64 = 1.0 / 512.0;

/// Emission times that are rounded to whole bins, or to steps of another width.
pub(super) fn rounded(case: &Case) -> Option<Diagnosis> {
    let [r, c] = [case.points[0].time?, case.points[1].time?];
    let pixels = case.pixels().iter().copied();
    let pairs: Vec<[f64; 2]> = pixels
        .map(|i| [r.at(i), c.at(i)])
        .filter(|pair| pair.iter().all(|t| t.is_finite()))
        .collect();
    let latest = pairs.iter().map(|[_, c]| c.abs()).fold(0.0, f64::max);
    let different = |which: usize| {
        let mut times: Vec<f64> = pairs.iter().map(|pair| pair[which]).collect();
        times.sort_unstable_by(f64::total_cmp);
        times.dedup_by(|b, a| *b - *a <= TIME_ROUNDING * latest);
        times
    };
    let (in_reference, times) = (different(0), different(1));
    let many = in_reference.len().min(pairs.len());
    (pairs.len() >= FEWEST && times.len() > 1 && many >= TIMES_FEWER * times.len()).then_some(())?;
    // All gaps are multiples of the smallest, which the span from the first to the last time determines best.
    let gaps = || times.windows(2).map(|pair| pair[1] - pair[0]);
    let least = gaps().fold(f64::INFINITY, f64::min);
    let all = times[times.len() - 1] - times[0];
    let step = all / (all / least).round();
    let is_whole = |gap: f64| (gap / step - (gap / step).round()).abs() <= WHOLE;
    let is_half = pairs.iter().all(|[_, c]| is_of_half_precision(*c));
    let is_rounding = is_half && step <= HALF_PRECISION * latest;
    (gaps().all(is_whole) && !is_rounding).then_some(())?;
    // Rounded times are off by at most one step.
    let offs = || pairs.iter().map(|[r, c]| c - r);
    let near = offs()
        .filter(|off| off.abs() <= (1.0 + WHOLE) * step)
        .count();
    (near as f64 >= MOST * pairs.len() as f64)
        .then(|| describe_rounding(case, step, offs(), times.len()))
}

/// Whether a number is representable in half precision: its significand has 11 bits.
fn is_of_half_precision(v: f64) -> bool {
    v.to_bits().trailing_zeros() >= f64::MANTISSA_DIGITS - 11
}

fn describe_rounding(
    case: &Case,
    step: f64,
    offs: impl Iterator<Item = f64>,
    times: usize,
) -> Diagnosis {
    let offs: Vec<f64> = offs.collect();
    let mean = offs.iter().sum::<f64>() / offs.len() as f64;
    let (how, shift) = match mean / step {
        part if part.abs() < 0.2 => ("to the nearest", 0.0),
        part if (part + 0.5).abs() < 0.2 => ("down", -0.5),
        part if (part - 0.5).abs() < 0.2 => ("up", 0.5),
        part => ("and shifted", part),
    };
    let is_bin = case
        .bin_width
        .is_some_and(|width| (step / width - 1.0).abs() <= WHOLE);
    let steps = if is_bin { "bins" } else { "steps" };
    let square: f64 = offs.iter().map(|off| off * off).sum();
    Diagnosis {
        kind: Kind::TimesRounded,
        what: format!(
            "emission times are rounded to whole {steps} of {step:.6} m, {how}: {times} different times at {} pixels",
            offs.len()
        )
        .into(),
        evidence: vec![
            ("width of a step (m)", step),
            ("times differ by (m, rms)", (square / offs.len() as f64).sqrt()),
            ("mean shift (steps)", shift),
        ],
    }
}
