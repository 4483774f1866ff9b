//! Mistakes of the light: exchanged colours, gamma, exposure, the exponent of W.
//!
//! Pixels that the candidate clips at 1 say nothing. Of the hypotheses that explain the error the first is named:
//! exchanged colours and gamma have no free number; an exponent explains how the light's logarithm varies, an exposure
//! that it does not. The exponent is the slope k of
//!
//! ```text
//! ln(c/r) = a + k ln W,
//! ```
//!
//! by least squares over pixels, where the candidate's own W is right; a is the exposure beside it.

use super::super::picture::{Encoding, Plane, RADIANCE};
use super::{Case, Diagnosis, FEWEST, Kind, MOST, Tally, median};
use crate::colour::{srgb_decode, srgb_encode};
use crate::render::aov::Aov;

/// The light of a pixel in the reference and in the candidate.
pub(super) type Lit = (usize, [[f64; 3]; 2]);

/// What asks one question of the light.
type Hypothesis = fn(&Case, &[Lit]) -> Option<Diagnosis>;

/// What is wrong with the light.
pub(super) fn light(case: &Case) -> Option<Diagnosis> {
    let lit = lit(case)?;
    let named: [Hypothesis; 4] = [colours, gamma, exponent, exposure];
    named.iter().find_map(|hypothesis| hypothesis(case, &lit))
}

/// Values nearer to 1 than this are clipped: an encoded 1 is off by rounding.
const CLIPPED: f64 = 1e-6;

/// Pixels of surfaces with light, which the candidate does not clip.
pub(super) fn lit(case: &Case) -> Option<Vec<Lit>> {
    let [r, c] = case
        .pair
        .map(|picture| Plane::group(&picture.layers, RADIANCE));
    let (r, c) = (r?, c?);
    let pixels = case
        .pixels()
        .into_iter()
        .map(|i| (i, [&r, &c].map(|p| p.map(|p| p.at(i)))));
    let is_lit = |(_, [r, c]): &Lit| {
        let finite = r.iter().chain(c).all(|v| v.is_finite() && *v >= 0.0);
        let clipped = c.iter().any(|v| (v - 1.0).abs() < CLIPPED) && r != c;
        finite && r.iter().sum::<f64>() > 0.0 && !clipped
    };
    let lit: Vec<Lit> = pixels.filter(is_lit).collect();
    (lit.len() >= FEWEST).then_some(lit)
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    let square: f64 = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum();
    square.sqrt()
}

/// |c − r| and |c − h(r)| in parts of the reference's light, so that bright pixels do not decide alone.
pub(super) fn tally(lit: &[Lit], h: impl Fn(usize, [f64; 3]) -> [f64; 3]) -> Tally {
    Tally::of(lit.iter().map(|&(i, [r, c])| {
        let size = distance(r, [0.0; 3]);
        [distance(c, r) / size, distance(c, h(i, r)) / size]
    }))
}

/// Errors of light, in parts of it, that are notable.
pub(super) const NOTABLE: f64 = 0.03;

pub(super) fn evidence(tally: &Tally) -> Vec<(&'static str, f64)> {
    vec![
        ("light differs by (parts of it, rms)", tally.error()),
        ("and from the hypothesis by", tally.rest()),
    ]
}

fn colours(_: &Case, lit: &[Lit]) -> Option<Diagnosis> {
    let orders = [
        ([2, 1, 0], "BGR"),
        ([0, 2, 1], "RBG"),
        ([1, 0, 2], "GRB"),
        ([1, 2, 0], "GBR"),
        ([2, 0, 1], "BRG"),
    ];
    // Where most of the light is grey, or nearly, other orders explain it too, but not all of it.
    let mut best: Option<(&str, Tally)> = None;
    for (order, name) in orders {
        let tally = tally(lit, |_, r| order.map(|k: usize| r[k]));
        let better = best
            .as_ref()
            .is_none_or(|(_, found)| tally.is_better_than(found));
        if tally.explains(NOTABLE) && better {
            best = Some((name, tally));
        }
    }
    let (name, tally) = best?;
    Some(Diagnosis {
        kind: Kind::ColoursExchanged,
        what: format!("colours are exchanged: the channels R, G, B hold {name}"),
        evidence: evidence(&tally),
    })
}

fn gamma(case: &Case, lit: &[Lit]) -> Option<Diagnosis> {
    let is_linear = case.pair[0].encoding == Encoding::Linear;
    let [once_more, once_less] = match is_linear {
        true => [
            "light is encoded for a display (gamma) and should be linear",
            "light is decoded twice: it is darker than linear light",
        ],
        false => [
            "gamma is applied twice: codes of codes",
            "gamma is not applied: the values of the file are linear light",
        ],
    };
    type Curve = fn(f64) -> f64;
    let curves: [(&str, Curve); 4] = [
        (once_more, srgb_encode),
        (once_more, |v| libm::pow(v, 1.0 / 2.2)),
        (once_less, srgb_decode),
        (once_less, |v| libm::pow(v, 2.2)),
    ];
    let tallies = curves.map(|(words, curve)| (words, tally(lit, |_, r| r.map(curve))));
    let explaining = tallies
        .into_iter()
        .filter(|(_, tally)| tally.explains(NOTABLE));
    let (words, tally) = explaining.min_by(|a, b| a.1.rest().total_cmp(&b.1.rest()))?;
    Some(Diagnosis {
        kind: Kind::Gamma,
        what: words.into(),
        evidence: evidence(&tally),
    })
}

fn exposure(_: &Case, lit: &[Lit]) -> Option<Diagnosis> {
    let sum = |light: &[f64; 3]| light.iter().sum::<f64>();
    let factor = median(lit.iter().map(|(_, [r, c])| sum(c) / sum(r)).collect())?;
    let tally = tally(lit, |_, r| r.map(|v| factor * v));
    let is_notable = factor > 0.0 && libm::log(factor).abs() > NOTABLE;
    (is_notable && tally.explains(NOTABLE)).then(|| Diagnosis {
        kind: Kind::Exposure,
        what: format!(
            "light is {factor:.4} times what it should be, everywhere alike ({:+.2} stops)",
            libm::log2(factor)
        ),
        evidence: [("factor", factor)]
            .into_iter()
            .chain(evidence(&tally))
            .collect(),
    })
}

/// An exponent that is notable.
const NOTABLE_EXPONENT: f64 = 0.2;
/// The standard deviation of ln W that is needed to tell, and the relative error up to which W itself is right.
const SPREAD: f64 = 0.01;
const W_IS_RIGHT: f64 = 1e-3;

fn exponent(case: &Case, lit: &[Lit]) -> Option<Diagnosis> {
    let [w_r, w_c] = case
        .pair
        .map(|p| Plane::aov(&p.layers, Aov::WavelengthRatio));
    let w_r = w_r?;
    let sum = |light: &[f64; 3]| light.iter().sum::<f64>();
    let (mut points, mut wrong) = (Vec::new(), 0usize);
    for (i, [r, c]) in lit {
        let (ratio, w) = (sum(c) / sum(r), w_r.at(*i));
        if ratio > 0.0 && w > 0.0 && (ratio + w).is_finite() {
            points.push([libm::log(w), libm::log(ratio)]);
            wrong += usize::from(w_c.is_some_and(|w_c| (w_c.at(*i) / w - 1.0).abs() > W_IS_RIGHT));
        }
    }
    let n = points.len();
    if n < FEWEST || wrong * 10 > n {
        return None;
    }
    let mean = |k: usize| points.iter().map(|p| p[k]).sum::<f64>() / n as f64;
    let (x0, y0) = (mean(0), mean(1));
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for [x, y] in &points {
        let (x, y) = (x - x0, y - y0);
        (xx, xy, yy) = (xx + x * x, xy + x * y, yy + y * y);
    }
    let slope = xy / xx;
    let explained = xy * xy / (xx * yy);
    let spread = (xx / n as f64).sqrt();
    let explains = slope.abs() >= NOTABLE_EXPONENT && explained >= MOST;
    (spread >= SPREAD && explains)
        .then(|| describe_exponent(slope, libm::exp(y0 - slope * x0), explained, n))
}

fn describe_exponent(slope: f64, factor: f64, explained: f64, count: usize) -> Diagnosis {
    let whole = slope.round();
    let amount = match (slope - whole).abs() < 0.1 && whole != 0.0 {
        true => format!("{whole:+}"),
        false => format!("{slope:+.2}"),
    };
    let beside = match (factor - 1.0).abs() > NOTABLE {
        true => format!(", and light is {factor:.4} times what it should be beside that"),
        false => String::new(),
    };
    Diagnosis {
        kind: Kind::ExponentWrong,
        what: format!(
            "the exponent of W in the radiance factor is off by {amount}: candidate / reference = W^({amount}){beside}"
        ),
        evidence: vec![
            ("slope of ln(candidate / reference) over ln W", slope),
            ("factor at W = 1", factor),
            ("share of the error explained", explained),
            ("pixels with light", count as f64),
        ],
    }
}
