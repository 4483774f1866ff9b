//! Emission times: shifts, and no retardation.

use super::super::picture::Plane;
use super::{Case, Diagnosis, Kind, MOST, Tally, median};

/// Shifts below this part of the times themselves are rounding of single precision.
const TIME_ROUNDING: f64 = 1e-6;
/// Pixels within this part of the median shift share it.
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
    let explains = shift.abs() > TIME_ROUNDING * scale && share >= MOST;
    explains.then(|| describe_shift(case, shift, share))
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
        what: format!("emission times are too {late} {amount}, everywhere alike").into(),
        evidence,
    }
}

/// So many bins.
pub(super) fn words_for_bins(bins: f64) -> String {
    match bins {
        _ if (bins - 1.0).abs() < SHARED => "one bin".into(),
        _ if (bins - 0.5).abs() < 0.5 * SHARED => "half a bin".into(),
        _ => format!("{bins:.3} bins"),
    }
}

/// All emission times are the same, where the reference's differ.
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
    let errors = pixels
        .iter()
        .map(|&i| [(c.at(i) - r.at(i)).abs(), (c.at(i) - time).abs()]);
    let tally = Tally::of(errors);
    let scale = pixels.iter().map(|i| r.at(*i)).filter(|t| t.is_finite());
    let [low, high] = scale.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], t| {
        [low.min(t), high.max(t)]
    });
    // Where the reference's times hardly differ, one time for all says nothing.
    let varied = high - low > 1e-3 * high.abs().max(low.abs());
    // The times themselves are the same to a hundredth of the reference's range.
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
