//! A radiance factor with another exponent of W.

use super::{Case, Diagnosis, Kind, MOST};
use crate::validate::compare::RADIANCE;
use crate::validate::compare::plane::Plane;

/// Pixels that have to have light, and an exponent that is notable.
const FEWEST: usize = 24;
const NOTABLE: f64 = 0.2;
/// The rms of ln W that is needed to tell, and the relative error up to which W itself is right.
const SPREAD: f64 = 0.01;
const RIGHT: f64 = 1e-3;

pub(super) fn diagnose(case: &Case) -> Option<Diagnosis> {
    let [light_r, light_c] = case.pair.map(|p| Plane::group(&p.layers, RADIANCE));
    let (light_r, light_c) = (light_r?, light_c?);
    let [w_r, w_c] = case
        .pair
        .map(|p| Plane::find(&p.layers, "wavelength_ratio"));
    let w_r = w_r?;
    let sum = |planes: &[Plane; 3], i: usize| planes.iter().map(|p| p.at(i)).sum::<f64>();
    let (mut xx, mut xy, mut yy, mut count, mut wrong) = (0.0, 0.0, 0.0, 0usize, 0usize);
    for i in case.pixels() {
        let (r, c, w) = (sum(&light_r, i), sum(&light_c, i), w_r.at(i));
        if !(r > 0.0 && c > 0.0 && w > 0.0 && (r + c + w).is_finite()) {
            continue;
        }
        let (x, y) = (libm::log(w), libm::log(c / r));
        (xx, xy, yy) = (xx + x * x, xy + x * y, yy + y * y);
        count += 1;
        wrong += usize::from(w_c.is_some_and(|w_c| (w_c.at(i) / w - 1.0).abs() > RIGHT));
    }
    let spread = (xx / count.max(1) as f64).sqrt();
    if count < FEWEST || spread < SPREAD || wrong * 10 > count {
        return None;
    }
    let exponent = xy / xx;
    let explained = xy * xy / (xx * yy);
    (exponent.abs() >= NOTABLE && explained >= MOST).then(|| described(exponent, explained, count))
}

fn described(exponent: f64, explained: f64, count: usize) -> Diagnosis {
    let whole = exponent.round();
    let amount = match (exponent - whole).abs() < 0.1 && whole != 0.0 {
        true => format!("{whole:+}"),
        false => format!("{exponent:+.2}"),
    };
    Diagnosis {
        kind: Kind::ExponentWrong,
        what: format!(
            "the exponent of W in the radiance factor is off by {amount}: candidate / reference = W^({amount})"
        ),
        evidence: vec![
            ("fitted exponent of the ratio", exponent),
            ("share of the error explained", explained),
            ("pixels with light", count as f64),
        ],
    }
}
