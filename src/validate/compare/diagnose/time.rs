//! Emission times that are shifted by a constant.

use super::{Case, Diagnosis, Kind, MOST, median};

/// Shifts below this part of the times themselves are rounding of single precision.
const ROUNDING: f64 = 1e-6;
/// Pixels within this part of the median shift share it.
const SHARED: f64 = 0.1;

pub(super) fn diagnose(case: &Case) -> Option<Diagnosis> {
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
    let explains = shift.abs() > ROUNDING * scale && share >= MOST;
    explains.then(|| described(case, shift, share))
}

fn described(case: &Case, shift: f64, share: f64) -> Diagnosis {
    let late = if shift > 0.0 { "late" } else { "early" };
    let bins = case.bin_width.map(|width| shift.abs() / width);
    let amount = match bins {
        Some(bins) if (bins - 1.0).abs() < SHARED => "by one bin".into(),
        Some(bins) => format!("by {bins:.3} bins"),
        None => format!("by {:.6} m of light path", shift.abs()),
    };
    let mut evidence = vec![
        ("median shift (m)", shift),
        ("share of pixels with it", share),
    ];
    evidence.extend(bins.map(|bins| ("shift (bins)", bins)));
    Diagnosis {
        kind: Kind::TimeShifted,
        what: format!("emission times are too {late} {amount}, everywhere alike"),
        evidence,
    }
}
