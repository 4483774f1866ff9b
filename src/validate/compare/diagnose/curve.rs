//! Light with a number added, or with a curve applied: tone mapping.
//!
//! A curve T maps the reference's light r to the candidate's light c, channel by channel, c = T(r), or by luminance Y only, c = r S(Y). The
//! usual ones have one free parameter, the exposure before them; any other is fitted as a polyline over ln r. The fit must leave next to
//! nothing, and the light must have enough different values.

use std::borrow::Cow;

use rayon::prelude::*;

use super::light::{
    FAR_LESS, Fit, LEFT_BESIDE_A_FACTOR, Lit, LitPixels, NOTABLE, NOTHING, decoded, distance,
    evidence, lit, lit_above, middle,
};
use super::{Case, Diagnosis, Kind, median};
use crate::colour::srgb_encode;

/// A diagnosis of the light, and the fraction of the squared error that it leaves.
type Explanation = (Diagnosis, f64);

/// Returns `found`, the mistake of the light found so far, or a curve that explains it far better (`FAR_LESS`).
pub(super) fn instead_of(case: &Case, found: Option<Explanation>) -> Option<Explanation> {
    if found.as_ref().is_some_and(|(_, left)| *left <= NOTHING) {
        return found;
    }
    let by_curve = offset(case).or_else(|| toned(case));
    match (by_curve, found) {
        (Some(curve), Some(found)) if curve.1 > FAR_LESS * found.1 => Some(found),
        (Some(curve), _) => Some(curve),
        (None, found) => found,
    }
}

/// Light values that differ by this factor count as different, and the number of pixels that each must have.
const LEVEL: f64 = 1.1;
const FEWEST_AT_LEVEL: usize = 3;
/// The number of values needed for an added number, for a curve with one free parameter, and for any curve.
const LEVELS_FOR_OFFSET: usize = 5;
const LEVELS_FOR_EXPOSURE: usize = 8;
const LEVELS_FOR_CURVE: usize = 16;

/// The smallest notable added number relative to the light: rounding to half precision causes a tenth of it.
const NOTABLE_OFFSET: f64 = 0.003;

/// The largest fraction of the squared error that an added number may leave: one percent noise, if it is a tenth of the light.
const LEFT_BY_OFFSET: f64 = 0.02;

/// Whether the reference's light has at least `wanted` different values; those of some pixels are counted first.
fn has_levels(lit: &LitPixels, wanted: usize) -> bool {
    levels(&lit.few) >= wanted || levels(&lit.pixels) >= wanted
}

/// The number of different values of the reference's light.
fn levels(lit: &[Lit]) -> usize {
    let mut counts = std::collections::BTreeMap::<i64, usize>::new();
    let per_level = libm::log(LEVEL);
    for v in lit.iter().flat_map(|(_, [r, _])| *r).filter(|v| *v > 0.0) {
        let level = (libm::log(v) / per_level).floor() as i64;
        *counts.entry(level).or_default() += 1;
    }
    counts
        .values()
        .filter(|count| **count >= FEWEST_AT_LEVEL)
        .count()
}

/// Light to which one number is added.
fn offset(case: &Case) -> Option<Explanation> {
    // After subtraction light may be negative.
    let lit = lit_above(case, f64::NEG_INFINITY)?;
    let cut = |c: &[f64; 3]| c.contains(&0.0);
    let lit: Vec<Lit> = lit.into_iter().filter(|(_, [_, c])| !cut(c)).collect();
    let lit = LitPixels::of(lit);
    has_levels(&lit, LEVELS_FOR_OFFSET).then_some(())?;
    let added = |lit: &[Lit]| {
        let added = lit.iter();
        let added = added.flat_map(|(_, [r, c])| [0, 1, 2].map(|k| c[k] - r[k]));
        median(added.collect())
    };
    let about = added(&lit.few)?;
    lit.may_fit(|_, r| r.map(|v| v + about)).then_some(())?;
    let added = added(&lit.pixels)?;
    let fit = lit.fit(|_, r| r.map(|v| v + added));
    (fit.explains_from(NOTABLE_OFFSET) && fit.left <= LEFT_BY_OFFSET).then(|| {
        let usual = middle(&lit.pixels) / 3f64.sqrt();
        let what = format!(
            "light has {added:+.6} added to it, uniformly: {:+.2} % of the reference's median",
            100.0 * added / usual
        );
        let evidence = [("added", added)].into_iter().chain(evidence(&fit.tally));
        let diagnosis = Diagnosis {
            kind: Kind::Offset,
            what: what.into(),
            evidence: evidence.collect(),
        };
        (diagnosis, fit.left)
    })
}

/// A curve for displays.
#[derive(Clone, Copy)]
enum Curve {
    /// Of each channel separately.
    Channel(fn(f64) -> f64),
    /// A factor by luminance.
    Luminance(fn(f64) -> f64),
}

/// The usual curves.
const CURVES: [(&str, Curve); 5] = [
    ("Reinhard's, v/(1 + v)", Curve::Channel(|v| v / (1.0 + v))),
    (
        "Reinhard's by luminance, v/(1 + Y)",
        Curve::Luminance(|y| 1.0 / (1.0 + y)),
    ),
    ("1 − exp(−v)", Curve::Channel(|v| -libm::expm1(-v))),
    ("the ACES fit of Narkowicz", Curve::Channel(aces)),
    ("Hable's, with white at 11.2", Curve::Channel(hable)),
];

/// K. Narkowicz, "ACES filmic tone mapping curve", 2016.
fn aces(v: f64) -> f64 {
    (v * (2.51 * v + 0.03) / (v * (2.43 * v + 0.59) + 0.14)).clamp(0.0, 1.0)
}

/// J. Hable, "Filmic tonemapping operators", 2010.
fn hable(v: f64) -> f64 {
    let curve =
        |v: f64| (v * (0.15 * v + 0.05) + 0.004) / (v * (0.15 * v + 0.5) + 0.06) - 0.02 / 0.3;
    // 11.2 maps to white.
    curve(v) / curve(11.2)
}

impl Curve {
    /// Its result for light that is `exposure` times as bright, encoded for a display if `encoded`.
    fn of(self, light: [f64; 3], exposure: f64, encoded: bool) -> [f64; 3] {
        let light = light.map(|v| exposure * v);
        let shown = match self {
            Curve::Channel(curve) => light.map(curve),
            Curve::Luminance(factor) => {
                let factor = factor(luminance(light));
                light.map(|v| factor * v)
            }
        };
        match encoded {
            true => shown.map(srgb_encode),
            false => shown,
        }
    }
}

/// The luminance of linear light with sRGB primaries.
fn luminance([r, g, b]: [f64; 3]) -> f64 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

/// The name of a curve, its parameters, and how well it explains the light.
type Explained = (String, Vec<(&'static str, f64)>, Fit);

/// Exposures to try: their number, and the range of the logarithm of the factor on the median of light.
const EXPOSURES: usize = 33;
const RANGE: f64 = 7.0;

/// Light with a curve applied.
fn toned(case: &Case) -> Option<Explanation> {
    // The light of objects that are elsewhere differs by what moved them, which some curve may resemble.
    (!case.shows_objects_elsewhere()).then_some(())?;
    let lit = lit(case)?;
    // Values that a display clips say nothing about the curve.
    let cut = |c: &[f64; 3]| c.contains(&0.0) || c.iter().any(|v| *v >= 1.0 - 1e-6);
    let range = lit.iter().flat_map(|(_, [_, c])| *c).fold(0.0, f64::max);
    let lit: Vec<Lit> = match range <= 1.0 {
        true => lit.into_iter().filter(|(_, [_, c])| !cut(c)).collect(),
        false => lit,
    };
    let lit = LitPixels::of(lit);
    let most = FAR_LESS * lit.left_by_one_factor(case);
    let of_codes = match decoded(case, &lit.pixels) {
        Cow::Owned(decoded) => Some(LitPixels::of(decoded)),
        Cow::Borrowed(_) => None,
    };
    let lit = of_codes.unwrap_or(lit);
    if !has_levels(&lit, LEVELS_FOR_EXPOSURE) || lit.fit(|_, r| r).tally.error() <= NOTABLE {
        return None;
    }
    let usual = middle(&lit.pixels) / 3f64.sqrt();
    let curves = CURVES.into_iter();
    let curves =
        curves.flat_map(|(name, curve)| [false, true].map(|encoded| (name, curve, encoded)));
    let fitted = curves
        .collect::<Vec<_>>()
        .into_par_iter()
        .map(|(name, curve, encoded)| {
            let exposure = exposure(&lit.few, curve, encoded) / usual;
            (name, curve, encoded, exposure)
        });
    let mut best: Option<Explained> = None;
    for (name, curve, encoded, exposure) in fitted.collect::<Vec<_>>() {
        let of = |_, r: [f64; 3]| curve.of(r, exposure, encoded);
        if !lit.may_fit(of) {
            continue;
        }
        let fit = lit.fit(of);
        if best
            .as_ref()
            .is_none_or(|(.., found)| fit.left < found.left)
        {
            let encoded = if encoded {
                ", encoded for a display"
            } else {
                ""
            };
            let words = format!(
                "light is tone-mapped by {name}{encoded}, of {exposure:.4} times the reference's light"
            );
            best = Some((words, vec![("exposure", exposure)], fit));
        }
    }
    let is_one = |fit: &Fit| fit.explains() && fit.left <= LEFT_BESIDE_A_FACTOR.min(most);
    let best = best.filter(|(.., fit)| is_one(fit));
    // An arbitrary curve has more freedom: try it last.
    let found = best.or_else(|| {
        has_levels(&lit, LEVELS_FOR_CURVE).then_some(())?;
        any(&lit).filter(|(.., fit)| is_one(fit))
    });
    let (what, sizes, fit) = found?;
    let diagnosis = Diagnosis {
        kind: Kind::ToneMapped,
        what: what.into(),
        evidence: sizes.into_iter().chain(evidence(&fit.tally)).collect(),
    };
    Some((diagnosis, fit.left))
}

/// The exposure, relative to the light's median, at which a curve fits best: by a grid, then by step halving.
fn exposure(lit: &[Lit], curve: Curve, encoded: bool) -> f64 {
    let usual = middle(lit) / 3f64.sqrt();
    let left = |log: f64| {
        let factor = libm::exp(log) / usual;
        let squares = lit.iter().map(|(_, [r, c])| {
            let d = distance(curve.of(*r, factor, encoded), *c);
            d * d
        });
        squares.sum::<f64>()
    };
    let mut step = 2.0 * RANGE / (EXPOSURES - 1) as f64;
    let tried = (0..EXPOSURES).map(|k| -RANGE + k as f64 * step);
    let least = tried.min_by(|a, b| left(*a).total_cmp(&left(*b)));
    let mut log = least.unwrap_or(0.0);
    for _ in 0..24 {
        step *= 0.5;
        let around = [log - step, log, log + step];
        let least = around
            .into_iter()
            .min_by(|a, b| left(*a).total_cmp(&left(*b)));
        log = least.unwrap_or(log);
    }
    libm::exp(log)
}

/// Vertices of a polyline over ln r, per factor of e.
const CORNERS: f64 = 8.0;

/// A polyline over the logarithm of light, through medians.
struct Polygon {
    corners: Vec<[f64; 2]>,
}

impl Polygon {
    fn of(pairs: &[[f64; 2]]) -> Option<Polygon> {
        let mut parts = std::collections::BTreeMap::<i64, Vec<[f64; 2]>>::new();
        for [x, y] in pairs.iter().filter(|[x, _]| *x > 0.0) {
            // Intervals of equal light ratios.
            let x = libm::log(*x);
            parts
                .entry((CORNERS * x).floor() as i64)
                .or_default()
                .push([x, *y]);
        }
        let parts = parts
            .into_values()
            .filter(|part| part.len() >= FEWEST_AT_LEVEL);
        let corners = parts.filter_map(|part| {
            let middle = |k: usize| median(part.iter().map(|p| p[k]).collect());
            Some([middle(0)?, middle(1)?])
        });
        let corners: Vec<[f64; 2]> = corners.collect();
        (corners.len() >= 2).then_some(Polygon { corners })
    }

    /// Interpolates along its edges, and extrapolates beyond the last ones.
    fn at(&self, v: f64) -> f64 {
        let x = libm::log(v.max(f64::MIN_POSITIVE));
        let next = self.corners.partition_point(|corner| corner[0] < x);
        let next = next.clamp(1, self.corners.len() - 1);
        let [[x0, y0], [x1, y1]] = [self.corners[next - 1], self.corners[next]];
        y0 + (y1 - y0) * (x - x0) / (x1 - x0)
    }

    /// Whether it never decreases.
    fn rises(&self) -> bool {
        self.corners
            .windows(2)
            .all(|pair| pair[1][1] >= pair[0][1] - NOTABLE * pair[0][1].abs())
    }
}

/// The curve of each channel through the medians of these pixels.
fn of_channels(lit: &[Lit]) -> Option<Polygon> {
    let pairs = lit.iter();
    let pairs = pairs.flat_map(|(_, [r, c])| [0, 1, 2].map(|k| [r[k], c[k]]));
    Polygon::of(&pairs.collect::<Vec<_>>()).filter(Polygon::rises)
}

/// The same of luminance.
fn of_luminance(lit: &[Lit]) -> Option<Polygon> {
    let pairs = lit.iter();
    let pairs = pairs.map(|(_, [r, c])| [luminance(*r), luminance(*c)]);
    Polygon::of(&pairs.collect::<Vec<_>>()).filter(Polygon::rises)
}

/// Any curve, of channels or of luminance.
fn any(lit: &LitPixels) -> Option<Explained> {
    let by_channels = |curve: &Polygon, r: [f64; 3]| r.map(|v| curve.at(v));
    let by_luminance = |curve: &Polygon, r: [f64; 3]| {
        let y = luminance(r);
        r.map(|v| v * curve.at(y) / y)
    };
    // The curve through some of the pixels tells whether one through all of them may explain the light.
    let fitted = |of: fn(&[Lit]) -> Option<Polygon>,
                  by: &(dyn Fn(&Polygon, [f64; 3]) -> [f64; 3] + Sync)| {
        if let Some(about) = of(&lit.few) {
            lit.may_fit(|_, r| by(&about, r)).then_some(())?;
        }
        let curve = of(&lit.pixels)?;
        let fit = lit.fit(|_, r| by(&curve, r));
        Some((curve, fit))
    };
    let by_channels = fitted(of_channels, &by_channels);
    let by_channels = by_channels.map(|(curve, fit)| ("each channel", curve, fit));
    let by_luminance = fitted(of_luminance, &by_luminance);
    let by_luminance = by_luminance.map(|(curve, fit)| ("luminance", curve, fit));
    let both = by_channels.into_iter().chain(by_luminance);
    let (of, curve, fit) = both.min_by(|a, b| a.2.left.total_cmp(&b.2.left))?;
    // At the median light, and at the brightest tenth.
    let pixels = lit.pixels.iter();
    let mut values: Vec<f64> = pixels.map(|(_, [r, _])| luminance(*r)).collect();
    values.sort_by(f64::total_cmp);
    let [usual, bright] =
        [0.5, 0.9].map(|part| values[(part * (values.len() - 1) as f64) as usize]);
    let [at_usual, at_bright] = [usual, bright].map(|v| curve.at(v));
    let words = format!(
        "light was transformed by one curve, of {of}, such as tone mapping or another gamma: {usual:.4} became {at_usual:.4}, {bright:.4} became {at_bright:.4}"
    );
    let sizes = vec![
        ("factor at the median of light", at_usual / usual),
        ("factor at the brightest tenth", at_bright / bright),
    ];
    Some((words, sizes, fit))
}
