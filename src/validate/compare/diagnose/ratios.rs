//! Mistakes of wavelength ratios: another measure of the Doppler shift, or a factor.
//!
//! | the channel holds | hypothesis |
//! |---|---|
//! | W − 1, 1/W − 1, ln W, −ln W | that number, which the candidate matches to a tenth of its variation |
//! | a power | ln c = k ln W; k, by least squares, is an integer or half-integer other than 1 |
//! | W times a factor | ln c = ln W + a, with one a for each object |

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::super::picture::Plane;
use super::motion::camera_velocity;
use super::{Case, Diagnosis, Kind, NEAR, Tally, median};
use crate::render::aov::Aov;

/// The smallest notable relative error of W.
const NOTABLE_RATIO: f64 = 0.005;

fn ratios<'a>(case: &Case<'a>) -> Option<[Plane<'a>; 2]> {
    let [r, c] = case
        .pair
        .map(|p| Plane::aov(&p.layers, Aov::WavelengthRatio));
    Some([r?, c?])
}

/// The logarithms of W in the reference and in the candidate, for each pixel.
fn logarithms(case: &Case) -> Option<Vec<(usize, [f64; 2])>> {
    let [r, c] = ratios(case)?;
    let logs = case.pixels().par_iter();
    let logs = logs.map(|&i| (i, [libm::log(r.at(i)), libm::log(c.at(i))]));
    let finite = logs.filter(|(_, logs)| logs.iter().all(|l| l.is_finite()));
    Some(finite.collect())
}

/// The largest residual of a hypothesis if W hardly varies.
const HARDLY: f64 = 1e-4;
/// Tolerance for a power to count as a multiple of a half, and the largest power reported.
const SAME_POWER: f64 = 0.02;
const LARGEST_POWER: f64 = 6.0;

/// Wavelength ratios that are another measure of the Doppler shift: its logarithm, a difference, a power of it.
pub(super) fn forms(case: &Case) -> Option<Diagnosis> {
    let power = power(case);
    let inverted = power.as_ref().is_some_and(|(p, _)| *p == -1.0);
    if let Some((_, tally)) = power.as_ref().filter(|_| inverted) {
        return Some(describe_inverted("", tally));
    }
    let form = form(case);
    form.or_else(|| power.map(|(p, tally)| describe_power(p, &tally)))
}

/// A power of W, other than the first, that the candidate holds.
fn power(case: &Case) -> Option<(f64, Tally)> {
    let logs = logarithms(case)?;
    let of = |p: f64| {
        let pairs = logs
            .par_iter()
            .map(|(_, [r, c])| [(c - r).abs(), (c - p * r).abs()]);
        Tally::of(pairs)
    };
    let inverse = of(-1.0);
    if inverse.explains(NOTABLE_RATIO) {
        return Some((-1.0, inverse));
    }
    let sum = |of: fn(f64, f64) -> f64| logs.iter().map(|(_, [r, c])| of(*r, *c)).sum::<f64>();
    let slope = sum(|r, c| r * c) / sum(|r, _| r * r);
    let p = 0.5 * (2.0 * slope).round();
    let is_named = p != 1.0 && p != 0.0 && p.abs() <= LARGEST_POWER;
    (is_named && (slope - p).abs() <= SAME_POWER).then_some(())?;
    let tally = of(p);
    let varies = spread(logs.iter().map(|(_, [_, c])| *c));
    let is_near = tally.rest() <= (NEAR * varies).max(HARDLY);
    (is_near && tally.explains(NOTABLE_RATIO)).then_some((p, tally))
}

/// A logarithm of W, or its difference from 1.
fn form(case: &Case) -> Option<Diagnosis> {
    let [r, c] = ratios(case)?;
    let pixels = case.pixels();
    let pairs: Vec<[f64; 2]> = pixels.iter().map(|i| [r.at(*i), c.at(*i)]).collect();
    let are_numbers = |pair: &&[f64; 2]| pair[0] > 0.0 && pair[1].is_finite();
    let varies = spread(pairs.iter().filter(are_numbers).map(|[_, c]| *c));
    type Form = fn(f64) -> f64;
    let forms: [(&str, Form); 4] = [
        ("W − 1", |w| w - 1.0),
        ("1/W − 1", |w| 1.0 / w - 1.0),
        ("ln W", libm::log),
        ("−ln W", |w| -libm::log(w)),
    ];
    let tallies = forms.map(|(name, of)| {
        let pairs = pairs.par_iter().filter(are_numbers);
        (
            name,
            Tally::of(pairs.map(|[r, c]| [(c - r).abs(), (c - of(*r)).abs()])),
        )
    });
    let explaining = tallies.into_iter().filter(|(_, tally)| {
        tally.explains(NOTABLE_RATIO) && tally.rest() <= (NEAR * varies).max(HARDLY)
    });
    let (name, tally) = explaining.min_by(|a, b| a.1.rest().total_cmp(&b.1.rest()))?;
    Some(Diagnosis {
        kind: Kind::RatioForm,
        what: format!(
            "wavelength_ratio holds {name}, and should hold W, observed over emitted wavelength"
        )
        .into(),
        evidence: vec![
            ("differs from the reference by (rms)", tally.error()),
            ("and from the hypothesis by (rms)", tally.rest()),
        ],
    })
}

/// The rms distance of values from their median.
fn spread(values: impl Iterator<Item = f64>) -> f64 {
    let values: Vec<f64> = values.collect();
    let middle = median(values.clone()).unwrap_or(0.0);
    let sum: f64 = values.iter().map(|v| (v - middle) * (v - middle)).sum();
    (sum / values.len().max(1) as f64).sqrt()
}

fn describe_power(p: f64, tally: &Tally) -> Diagnosis {
    Diagnosis {
        kind: Kind::RatioForm,
        what: format!(
            "wavelength_ratio holds W^({p:+}), and should hold W, observed over emitted wavelength"
        )
        .into(),
        evidence: vec![
            ("slope of ln c over ln W", p),
            ("ln W differs by (rms)", tally.error()),
            ("and from the hypothesis by", tally.rest()),
        ],
    }
}

/// The diagnosis of inverted ratios in the named objects.
fn describe_inverted(objects: &str, tally: &Tally) -> Diagnosis {
    Diagnosis {
        kind: Kind::RatioInverted,
        what: format!(
            "wavelength ratios are inverted{objects}: W is observed / emitted wavelength, below 1 for a blueshift"
        ).into(),
        evidence: vec![
            ("ln W differs by (rms)", tally.error()),
            ("and ln 1/W by", tally.rest()),
        ],
    }
}

/// Wavelength ratios that are wrong by a factor.
pub(super) fn ratio(case: &Case) -> Option<Diagnosis> {
    let logs = logarithms(case)?;
    // One factor for each object.
    let mut by_object: BTreeMap<i64, Vec<f64>> = BTreeMap::new();
    for &(i, [r, c]) in &logs {
        let object = case.points[0].object_at(i).unwrap_or(0.0) as i64;
        by_object.entry(object).or_default().push(c - r);
    }
    let factors: BTreeMap<i64, f64> = (by_object.into_iter())
        .filter_map(|(object, logs)| Some((object, median(logs)?)))
        .collect();
    let object_at = |i: usize| case.points[0].object_at(i).unwrap_or(0.0) as i64;
    let factor = |i: usize| factors.get(&object_at(i)).copied().unwrap_or(0.0);
    let by_factor = Tally::of(
        logs.par_iter()
            .map(|&(i, [r, c])| [(c - r).abs(), (c - r - factor(i)).abs()]),
    );
    let wrong = factors.iter().filter(|(_, log)| log.abs() > NOTABLE_RATIO);
    let wrong: Vec<i64> = wrong.map(|(object, _)| *object).collect();
    if wrong.is_empty() {
        return None;
    }
    // If W varies little over an object, a factor resembles 1/W.
    let of_wrong = logs.par_iter();
    let of_wrong = of_wrong.filter(|(i, _)| wrong.contains(&object_at(*i)));
    let inverse =
        Tally::of(of_wrong.map(|&(i, [r, c])| [(c - r - factor(i)).abs(), (c + r).abs()]));
    if inverse.explains(NOTABLE_RATIO) {
        let words: Vec<String> = wrong.iter().take(6).map(i64::to_string).collect();
        return Some(describe_inverted(
            &format!(" in object {}", words.join(", ")),
            &inverse,
        ));
    }
    by_factor
        .explains(NOTABLE_RATIO)
        .then(|| describe_factors(case, &factors, &by_factor))
}

/// Diagnoses the mistake in the formula of W that causes these factors, ln W of the candidate minus that of the reference for each object.
fn describe_factors(case: &Case, factors: &BTreeMap<i64, f64>, tally: &Tally) -> Diagnosis {
    // Logarithms of γ to a tenth; to a thousandth if γ is close to 1.
    let near = |factor: f64, gamma: f64| {
        (factor - libm::log(gamma)).abs() < 0.1 * libm::log(gamma).abs().max(0.01)
    };
    let camera = case
        .known
        .map(|known| known.camera_velocity())
        .or_else(|| camera_velocity(case.pair[0]));
    let camera = camera.map_or(1.0, |velocity| velocity.gamma());
    let gammas: Vec<f64> = case.known.map_or(Vec::new(), |known| {
        known.velocities().map(|v| v.gamma()).collect()
    });
    let gamma = |k: i64| gammas.get(k as usize).copied().unwrap_or(1.0);
    let all = |of: &dyn Fn(i64) -> f64| factors.iter().all(|(k, factor)| near(*factor, of(*k)));
    // One formula must explain all objects: the camera's γ first, then each object's own.
    let what = if all(&|_| camera) {
        format!(
            "wavelength ratios are γ times what they should be, γ = {camera:.4} the camera's: 1/(γ (1 + β·d)) lacks its γ, or γ (1 − β·d′) has it twice"
        )
    } else if all(&|_| 1.0 / camera) {
        format!(
            "wavelength ratios are 1/γ of what they should be, γ = {camera:.4} the camera's: γ (1 − β·d′) lacks its γ, or 1/(γ (1 + β·d)) has it twice"
        )
    } else if all(&|k| 1.0 / gamma(k)) {
        "wavelength ratios lack the objects' γ: they are 1/γ of what they should be".into()
    } else if all(&gamma) {
        "wavelength ratios contain the objects' γ once too often".into()
    } else {
        // Only wrong objects are reported.
        let wrong = factors.iter().filter(|(_, log)| log.abs() > NOTABLE_RATIO);
        let words = wrong
            .take(6)
            .map(|(k, factor)| format!("{:.4} (object {k})", libm::exp(*factor)));
        format!(
            "wavelength ratios are wrong by a factor: {}",
            words.collect::<Vec<_>>().join(", ")
        )
    };
    let largest = factors
        .values()
        .copied()
        .fold(0.0f64, |a, b| if b.abs() > a.abs() { b } else { a });
    Diagnosis {
        kind: Kind::RatioFactor,
        what: what.into(),
        evidence: vec![
            ("factor on W", libm::exp(largest)),
            ("ln W differs by (rms)", tally.error()),
            ("and from the hypothesis by", tally.rest()),
            ("part of the pixels with it", tally.share()),
        ],
    }
}
