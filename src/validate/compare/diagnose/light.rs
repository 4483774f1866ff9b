//! Mistakes of the light: exchanged colours, gamma, exposure, the exponent of W.
//!
//! Pixels that the candidate clips at 1 are ignored, and so is a picture that is practically black. Of the hypotheses that explain the
//! error the first is reported: exchanged colours, other primaries and gamma have no free parameter; if a factor is added they must leave next to nothing;
//! an exponent explains variations of the light's logarithm, an exposure their absence. Practically black light counts as one percent of
//! its median, and errors at edges only are not mistakes of the light. The exponent is the slope k of
//!
//! ```text
//! ln(c/r) = a + k ln W,
//! ```
//!
//! by least squares over pixels where the candidate's own W is right; a is the additional exposure.

use std::borrow::Cow;
use std::sync::OnceLock;

use glam::{DMat3, DVec3};
use rayon::prelude::*;

use super::super::picture::{Encoding, Plane, RADIANCE};
use super::{
    ASKED, Case, Diagnosis, FEWEST, FEWEST_ASKED, Kind, MOST, NEAR, PROMISING, Tally, median,
    spread,
};
use crate::colour::{srgb_decode, srgb_encode};
use crate::render::aov::Aov;
use crate::scene::model::Fill;

/// The light of a pixel in the reference and in the candidate.
pub(super) type Lit = (usize, [[f64; 3]; 2]);

/// A test of one hypothesis on the light; returns the fraction of the squared error that it leaves, too.
type Hypothesis = fn(&Case, &LitPixels) -> Option<(Diagnosis, f64)>;

/// The mistake of the light, and the fraction of its squared error that this leaves.
pub(super) fn light(case: &Case) -> Option<(Diagnosis, f64)> {
    let lit = LitPixels::of(lit(case)?);
    let first: [Hypothesis; 3] = [black, codes, clipped];
    let named: [Hypothesis; 6] = [
        colours,
        primaries,
        gamma,
        encoded_and_scaled,
        exponent,
        exposure,
    ];
    let test = |named: &[Hypothesis]| named.iter().find_map(|hypothesis| hypothesis(case, &lit));
    // If one factor leaves nothing there is nothing else to explain.
    test(&first).or_else(|| match lit.left_by_one_factor(case) <= NOTHING {
        true => exposure(case, &lit),
        false => test(&named),
    })
}

/// The light of pixels, with what the tests of all hypotheses need.
pub(super) struct LitPixels {
    pub pixels: Vec<Lit>,
    scales: Scales,
    /// The rms error, relative to the light.
    usual: f64,
    /// Some of the pixels, from all over the picture.
    pub few: Vec<Lit>,
    /// What one factor leaves, once it has been asked for.
    by_one_factor: OnceLock<f64>,
}

impl LitPixels {
    pub fn of(pixels: Vec<Lit>) -> LitPixels {
        let scales = Scales::of(&pixels);
        let errors = pixels
            .par_iter()
            .map(|&(_, [r, c])| scales.distances(c, r, r)[0]);
        let errors: Vec<f64> = errors.collect();
        let (squares, count) = (errors.iter().filter(|error| error.is_finite()))
            .fold((0.0, 0usize), |(sum, n), e| (sum + e * e, n + 1));
        let few = spread(pixels.len(), ASKED).map(|at| pixels[at]).collect();
        LitPixels {
            scales,
            usual: (squares / count.max(1) as f64).sqrt(),
            few,
            pixels,
            by_one_factor: OnceLock::new(),
        }
    }

    /// The fraction of the squared error that one factor on linear light leaves.
    pub fn left_by_one_factor(&self, case: &Case) -> f64 {
        *self.by_one_factor.get_or_init(|| {
            let lit = decoded(case, &self.pixels);
            // Completely black light determines no factor.
            let factor = factor(&lit, |c| c).filter(|factor| *factor > 0.0);
            factor.map_or(1.0, |factor| fit(&lit, |_, r| r.map(|v| factor * v)).left)
        })
    }

    /// How well a hypothesis explains the light.
    pub fn fit(&self, h: impl Fn(usize, [f64; 3]) -> [f64; 3] + Sync) -> Fit {
        self.scales.fit(&self.pixels, h)
    }

    /// Whether a hypothesis may explain the light, by some of the pixels.
    pub fn may_fit(&self, h: impl Fn(usize, [f64; 3]) -> [f64; 3]) -> bool {
        let (mut notable, mut explained) = (0, 0);
        for &(i, [r, c]) in &self.few {
            let [error, rest] = self.scales.distances(c, r, h(i, r));
            // As in `Tally`.
            if (error + rest).is_finite() && error.max(rest) > NEAR * self.usual {
                notable += 1;
                explained += usize::from(rest <= NEAR * error.max(self.usual));
            }
        }
        notable < FEWEST_ASKED || explained as f64 >= PROMISING * notable as f64
    }
}

/// The fraction of the squared error that is left if a hypothesis explains everything except rounding to single precision.
pub(super) const NOTHING: f64 = 1e-6;
/// Curves must leave less than this fraction of what one factor leaves: for light that is far darker, or hardly varies, they are alike.
pub(super) const FAR_LESS: f64 = 0.1;

/// Linear light; for pictures of codes, only pixels where neither has the largest code, which represents all light above.
pub(super) fn decoded<'a>(case: &Case, lit: &'a [Lit]) -> Cow<'a, [Lit]> {
    if case.pair[0].encoding == Encoding::Linear {
        return lit.into();
    }
    let inside = |(_, pair): &&Lit| pair.iter().flatten().all(|v| *v < 1.0 - CLIPPED);
    let decode = |(i, pair): &Lit| (*i, pair.map(|light| light.map(srgb_decode)));
    let decoded: Vec<Lit> = lit.par_iter().filter(inside).map(decode).collect();
    decoded.into()
}

/// Values closer to 1 than this are clipped: an encoded 1 has rounding errors.
const CLIPPED: f64 = 1e-6;

/// Pixels of surfaces with light that the candidate does not clip.
pub(super) fn lit(case: &Case) -> Option<Vec<Lit>> {
    lit_above(case, 0.0)
}

/// The same, whichever object the candidate shows there.
pub(super) fn lit_of_any_object(case: &Case) -> Option<Vec<Lit>> {
    lit_of(case, case.everywhere(), 0.0)
}

/// The same as [`lit`] with the candidate's light down to `least`.
pub(super) fn lit_above(case: &Case, least: f64) -> Option<Vec<Lit>> {
    lit_of(case, case.of_same_object(), least)
}

fn lit_of(case: &Case, pixels: &[usize], least: f64) -> Option<Vec<Lit>> {
    let lit = with_light(case, pixels, least, |[r, _]| r.iter().sum::<f64>() > 0.0)?;
    (lit.len() >= FEWEST).then_some(lit)
}

/// Pixels of surfaces, with light or without; `None` if the reference has it at too few.
pub(super) fn lit_and_dark(case: &Case) -> Option<Vec<Lit>> {
    lit(case)?;
    with_light(case, case.of_same_object(), 0.0, |_| true)
}

/// Those of `pixels` whose light satisfies `is_wanted` and is not clipped in the candidate.
fn with_light(
    case: &Case,
    pixels: &[usize],
    least: f64,
    is_wanted: impl Fn(&[[f64; 3]; 2]) -> bool + Sync,
) -> Option<Vec<Lit>> {
    let [r, c] = case
        .pair
        .map(|picture| Plane::group(&picture.layers, RADIANCE));
    let (r, c) = (r?, c?);
    let pixels = with_data(case, pixels, &r).into_par_iter();
    let pixels = pixels.map(|i| (i, [&r, &c].map(|p| p.each_ref().map(|p| p.at(i)))));
    let is_lit = |(_, pair): &Lit| {
        let [r, c] = pair;
        let is_light = |v: &f64, least: f64| v.is_finite() && *v >= least;
        let finite = r.iter().all(|v| is_light(v, 0.0)) && c.iter().all(|v| is_light(v, least));
        let clipped = c.iter().any(|v| (v - 1.0).abs() < CLIPPED) && r != c;
        finite && is_wanted(pair) && !clipped
    };
    Some(pixels.filter(is_lit).collect())
}

/// Those of `all` pixels whose light is known: a mark for missing data is the same in both pictures, whatever is wrong with light. All of
/// them if too few are left: where missing data are black, or are held, all light may be beside them.
fn with_data(case: &Case, all: &[usize], r: &[Plane; 3]) -> Vec<usize> {
    let coverage = case
        .pair
        .map(|picture| Plane::aov(&picture.layers, Aov::Coverage));
    let outside = case.scene.map(|scene| scene.outside);
    let fills = outside.map(|o| [o.before, o.after, o.off_texture, o.occluded]);
    let marks = fills.into_iter().flatten().filter_map(|fill| match fill {
        Fill::Mark(colour) => Some(colour),
        Fill::Black | Fill::Hold => None,
    });
    let marks: Vec<[f64; 3]> = marks.collect();
    let is_mark = |light: [f64; 3]| {
        let is = |mark: &[f64; 3]| (0..3).all(|k| (light[k] - mark[k]).abs() <= 1e-6 * mark[k]);
        marks.iter().any(is)
    };
    let is_known = |i: &usize| {
        let mut coverage = coverage.iter().flatten();
        let is_covered = coverage.all(|coverage| coverage.at(*i) >= 1.0 - COVERED);
        is_covered && !is_mark(r.each_ref().map(|p| p.at(*i)))
    };
    let known: Vec<usize> = all.par_iter().copied().filter(is_known).collect();
    match known.len() >= FEWEST {
        true => known,
        false => all.to_vec(),
    }
}

/// The rounding of a full coverage in half precision.
const COVERED: f64 = 1e-3;

pub(super) fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    let square: f64 = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum();
    square.sqrt()
}

/// Light below this fraction of its median is practically black: half a unit of an 8-bit picture's darkest codes.
const BLACK: f64 = 0.01;
/// The least fraction of lit pixels with errors: fewer are edges.
const FEWEST_WRONG: f64 = 0.1;
/// The fraction of the squared error that a hypothesis leaves if it explains everything except rounding: then a few pixels are enough
/// evidence if the rest is grey.
const EXACT: f64 = 1e-9;
/// The largest fraction of the squared error of compressed light at all lit pixels that a hypothesis may leave.
const LEFT: f64 = 0.5;

/// Light that is more than this many times the reference's is measured by its own median.
const FAR_BRIGHTER: f64 = 1e3;

/// The median of the reference's light.
pub(super) fn middle(lit: &[Lit]) -> f64 {
    let sizes = lit.par_iter().map(|(_, [r, _])| length(*r));
    median(sizes.collect()).unwrap_or(0.0)
}

fn length(light: [f64; 3]) -> f64 {
    distance(light, [0.0; 3])
}

/// How well a hypothesis explains the light.
pub(super) struct Fit {
    pub tally: Tally,
    /// Number of pixels with light.
    pixels: usize,
    /// The fraction of the squared error that it leaves, of light v compressed to v/(v + median): neither lamps nor nearly black pixels
    /// dominate.
    pub left: f64,
}

impl Fit {
    /// Whether it explains most of an error that is not at edges only.
    pub fn explains(&self) -> bool {
        self.explains_from(NOTABLE)
    }

    /// The same for an error of at least `notable`.
    pub fn explains_from(&self, notable: f64) -> bool {
        let enough = self.tally.distances.len() as f64 >= FEWEST_WRONG * self.pixels as f64;
        (enough || self.left <= EXACT) && self.left <= LEFT && self.tally.explains(notable)
    }
}

/// How well a hypothesis explains the light.
pub(super) fn fit(lit: &[Lit], h: impl Fn(usize, [f64; 3]) -> [f64; 3] + Sync) -> Fit {
    Scales::of(lit).fit(lit, h)
}

/// The light with which errors are compared.
struct Scales {
    /// The median of the reference's light.
    middle: f64,
    /// Light that is practically black in either picture.
    darkest: f64,
    /// The light that is compressed to a half.
    half: f64,
}

/// The number of pixels that are summed at a time: sums do not depend on the number of threads.
const SUMMED: usize = 1 << 14;

impl Scales {
    fn of(lit: &[Lit]) -> Scales {
        let middle = middle(lit);
        let bright = median(lit.par_iter().map(|(_, [_, c])| length(*c)).collect());
        // All far brighter light would compress to the same value: then its own median is the measure.
        let far = bright.filter(|bright| *bright > FAR_BRIGHTER * middle);
        Scales {
            middle,
            darkest: BLACK * bright.map_or(middle, |bright| bright.min(middle)),
            half: far.unwrap_or(middle),
        }
    }

    /// |c − r| and |c − h(r)| relative to the reference's light, so that bright pixels do not dominate. If both c and h are far darker
    /// than r, |c − h| is measured relative to them, as |c − r| is relative to r: otherwise any hypothesis of nearly black light would fit.
    fn distances(&self, c: [f64; 3], r: [f64; 3], h: [f64; 3]) -> [f64; 2] {
        let size = length(r).max(BLACK * self.middle);
        let (error, rest) = (distance(c, r), distance(c, h));
        let larger = length(c).max(length(h)).max(self.darkest);
        let darker = if rest > 0.0 { error / larger } else { 1.0 };
        [error / size, rest / size * darker.max(1.0)]
    }

    fn fit(&self, lit: &[Lit], h: impl Fn(usize, [f64; 3]) -> [f64; 3] + Sync) -> Fit {
        let compressed = |light: [f64; 3]| light.map(|v| v / (v.abs() + self.half));
        let square = |a, b| {
            let d = distance(compressed(a), compressed(b));
            d * d
        };
        let (mut distances, mut sums) = (Vec::new(), Vec::new());
        let part = |pixels: &[Lit]| {
            let (mut of, mut is, mut was) = (Vec::with_capacity(pixels.len()), 0.0, 0.0);
            for &(i, [r, c]) in pixels {
                let h = h(i, r);
                of.push(self.distances(c, r, h));
                was += square(c, r);
                is += square(c, h);
            }
            (of, [is, was])
        };
        lit.par_chunks(SUMMED)
            .map(part)
            .unzip_into_vecs(&mut distances, &mut sums);
        let [is, was] = sums
            .into_iter()
            .fold([0.0; 2], |[a, b], [is, was]| [a + is, b + was]);
        Fit {
            tally: Tally::of(distances.into_par_iter().flatten_iter()),
            pixels: lit.len(),
            left: is / was,
        }
    }
}

/// The largest residual of a hypothesis with a free factor: one percent noise, but not chance correlation of light and W.
pub(super) const LEFT_BESIDE_A_FACTOR: f64 = 0.003;

/// The most common factor on the sum of the channels.
fn factor(lit: &[Lit], of: impl Fn([f64; 3]) -> [f64; 3] + Sync) -> Option<f64> {
    let sum = |light: [f64; 3]| light.iter().sum::<f64>();
    let factors = lit.par_iter().map(|(_, [r, c])| sum(of(*c)) / sum(*r));
    median(factors.collect())
}

/// Describes a factor in addition to a mistake.
pub(super) fn beside(factor: f64) -> String {
    let factor = in_words(factor);
    format!(", and light is {factor} times what it should be beside that")
}

/// A factor with enough digits to distinguish it.
fn in_words(factor: f64) -> String {
    match (0.01..1e5).contains(&factor) {
        true => format!("{factor:.4}"),
        false => format!("{factor:.3e}"),
    }
}

/// A picture with less than this fraction of the reference's light is practically black.
const DARK: f64 = 1e-3;

/// A picture with next to no light: what little there is does not show why, unless it is one factor on all of it.
fn black(case: &Case, lit: &LitPixels) -> Option<(Diagnosis, f64)> {
    let [r, c] = case.pair.map(|p| Plane::group(&p.layers, RADIANCE));
    let (r, c) = (r?, c?);
    // All light, wherever it is: misplaced light is another mistake.
    let sum = |of: &[Plane; 3]| {
        let pixels = case.of_same_object().iter().copied();
        let pixels = pixels.flat_map(|i| of.each_ref().map(|p| p.at(i)));
        pixels.filter(|v| v.is_finite()).map(f64::abs).sum::<f64>()
    };
    let part = sum(&c) / sum(&r);
    (part < DARK).then_some(())?;
    let scaled = exposure(case, lit).filter(|(_, left)| *left <= LEFT_BESIDE_A_FACTOR);
    scaled.or_else(|| {
        let light = match part > 0.0 {
            true => format!("{part:.1e}"),
            false => "none".into(),
        };
        let what = format!(
            "the picture is black, or nearly: it has {light} of the reference's light, which shows some at {} pixels",
            lit.pixels.len()
        );
        let evidence = vec![("part of the reference's light", part)];
        let kind = Kind::Exposure;
        let what = what.into();
        // The little light may be that of a changed scene. Completely black light fits many changes and shows nothing.
        let left = if part > 0.0 { LEFT_BY_BLACK } else { 0.0 };
        Some((Diagnosis { kind, what, evidence }, left))
    })
}

/// The residual reported for a black picture: large enough that the scene is tested, and small enough that other films are not.
const LEFT_BY_BLACK: f64 = 0.1;

/// The largest codes of 8 and of 16 bits.
const LARGEST_CODES: [f64; 2] = [255.0, 65535.0];

/// Light stored as integer codes.
fn codes(_: &Case, lit: &LitPixels) -> Option<(Diagnosis, f64)> {
    let pixels = &lit.pixels;
    let are_whole = |which: usize| {
        let mut values = pixels.iter().flat_map(|(_, pair)| pair[which]);
        values.all(|v| v.fract() == 0.0)
    };
    let largest = pixels.iter().flat_map(|(_, [_, c])| *c).fold(0.0, f64::max);
    let bound = LARGEST_CODES.into_iter().find(|bound| largest <= *bound)?;
    (largest > 1.0 && are_whole(1) && !are_whole(0)).then_some(())?;
    let found = lit.fit(|_, r| r);
    (found.tally.error() > NOTABLE).then(|| {
        let what = format!(
            "light is in whole numbers up to {largest}: {}-bit codes, not linear light. Divide by {bound}, and decode what is encoded for a display",
            if bound > 255.0 { 16 } else { 8 }
        );
        let evidence = vec![("largest code", largest)];
        let kind = Kind::Gamma;
        let what = what.into();
        (Diagnosis { kind, what, evidence }, 0.0)
    })
}

/// Light that is clipped elsewhere than at 1, where displays clip.
fn clipped(_: &Case, lit: &LitPixels) -> Option<(Diagnosis, f64)> {
    let pixels = &lit.pixels;
    let most = |which: usize| {
        let values = pixels.iter().flat_map(|(_, pair)| pair[which]);
        values.fold(0.0, f64::max)
    };
    let [right, bound] = [0, 1].map(most);
    (bound > 0.0 && right > bound * (1.0 + NOTABLE)).then_some(())?;
    let at_bound = |(_, [r, c]): &&Lit| (0..3).any(|k| c[k] == bound && r[k] > bound);
    let count = pixels.iter().filter(at_bound).count();
    (count >= FEWEST).then_some(())?;
    let fit = lit.fit(|_, r| r.map(|v| v.min(bound)));
    let is_exact = fit.tally.share() >= MOST && fit.left <= LEFT_BESIDE_A_FACTOR;
    let is_clip = is_exact || is_level(pixels, bound);
    is_clip.then(|| {
        let what = format!("light is clipped at {bound:.4}: the reference's is up to {right:.4}");
        let evidence = [("pixels at the bound", count as f64)];
        let evidence = evidence.into_iter().chain(self::evidence(&fit.tally));
        let diagnosis = Diagnosis {
            kind: Kind::Clipped,
            what: what.into(),
            evidence: evidence.collect(),
        };
        (diagnosis, fit.left)
    })
}

/// The fraction of the values above a bound that must be at it, and the least range of their tenths in the reference.
const MOST_AT_BOUND: f64 = 0.8;
const RANGE_AT_BOUND: f64 = 0.1;

/// Whether the candidate's light is at `bound` where the reference's varies above it, and is the reference's below: with other samples this
/// is so except at edges.
fn is_level(lit: &[Lit], bound: f64) -> bool {
    let values = || {
        lit.iter()
            .flat_map(|(_, [r, c])| (0..3).map(|k| [r[k], c[k]]))
    };
    let above = values().filter(|[r, _]| *r > (1.0 + NOTABLE) * bound);
    let (all, at_bound) = above.fold((0usize, 0usize), |(all, at), [_, c]| {
        (all + 1, at + usize::from(c == bound))
    });
    let mut in_reference: Vec<f64> = values()
        .filter(|[_, c]| *c == bound)
        .map(|[r, _]| r / bound)
        .collect();
    in_reference.sort_by(f64::total_cmp);
    let tenth = |k: usize| in_reference.get(k * in_reference.len() / 10).copied();
    let varies = tenth(9)
        .zip(tenth(1))
        .is_some_and(|(high, low)| high - low > RANGE_AT_BOUND);
    let below = values().filter(|[r, _]| *r > 0.0 && *r < (1.0 - NOTABLE) * bound);
    let off = median(below.map(|[r, c]| (c / r - 1.0).abs()).collect());
    let is_same_below = off.is_none_or(|off| off <= NOTABLE);
    all >= FEWEST && at_bound as f64 >= MOST_AT_BOUND * all as f64 && varies && is_same_below
}

/// The smallest notable relative error of light.
pub(super) const NOTABLE: f64 = 0.03;

pub(super) fn evidence(tally: &Tally) -> Vec<(&'static str, f64)> {
    vec![
        ("light differs by (parts of it, rms)", tally.error()),
        ("and from the hypothesis by", tally.rest()),
    ]
}

/// Another order of channels, beside a factor, may leave at most this fraction of what the factor alone leaves.
const LEFT_BY_ORDER: f64 = 0.1;

fn colours(case: &Case, lit: &LitPixels) -> Option<(Diagnosis, f64)> {
    let orders = [
        ([2, 1, 0], "BGR"),
        ([0, 2, 1], "RBG"),
        ([1, 0, 2], "GRB"),
        ([1, 2, 0], "GBR"),
        ([2, 0, 1], "BRG"),
    ];
    best_order(case, lit, &orders, 1.0, &|| LEFT).or_else(|| {
        let factor = factor(&lit.pixels, |c| c)?;
        (factor > DARK).then_some(())?;
        let left = || {
            let left = lit.fit(|_, r| r.map(|v| factor * v)).left;
            (LEFT_BY_ORDER * left).min(LEFT_BESIDE_A_FACTOR)
        };
        best_order(case, lit, &orders, factor, &left)
    })
}

/// The order of channels that best explains the light, times `factor`, if it leaves at most `most()`.
fn best_order(
    case: &Case,
    lit: &LitPixels,
    orders: &[([usize; 3], &'static str)],
    factor: f64,
    most: &dyn Fn() -> f64,
) -> Option<(Diagnosis, f64)> {
    // If most of the light is grey, or nearly grey, other orders explain it too, but not all of it.
    let mut best: Option<(&str, Fit)> = None;
    for (order, name) in orders {
        let of = |_, r: [f64; 3]| order.map(|k: usize| factor * r[k]);
        if !lit.may_fit(of) {
            continue;
        }
        let fit = lit.fit(of);
        let better = best
            .as_ref()
            .is_none_or(|(_, found)| fit.tally.is_better_than(&found.tally));
        if fit.explains() && fit.left <= most() && better {
            best = Some((name, fit));
        }
    }
    let (name, fit) = best?;
    let diagnosis = Diagnosis {
        kind: Kind::ColoursExchanged,
        what: match factor == 1.0 {
            true => format!("colours are exchanged: the channels R, G, B hold {name}"),
            false => format!(
                "colours are exchanged: the channels R, G, B hold {name}{}",
                beside(self::factor(&decoded(case, &lit.pixels), |c| c).unwrap_or(factor))
            ),
        }
        .into(),
        evidence: evidence(&fit.tally),
    };
    Some((diagnosis, fit.left))
}

/// The chromaticities of red, green and blue, and of white, which all of these have (D65).
const REC_709: [[f64; 2]; 3] = [[0.64, 0.33], [0.3, 0.6], [0.15, 0.06]];
const OTHER_PRIMARIES: [(&str, [[f64; 2]; 3]); 2] = [
    ("Rec. 2020", [[0.708, 0.292], [0.17, 0.797], [0.131, 0.046]]),
    ("Display P3", [[0.68, 0.32], [0.265, 0.69], [0.15, 0.06]]),
];
const WHITE: [f64; 2] = [0.3127, 0.329];

/// XYZ of linear RGB with these primaries: their XYZ times the amounts that add up to white.
fn xyz_of(primaries: [[f64; 2]; 3]) -> DMat3 {
    let xyz = |[x, y]: [f64; 2]| DVec3::new(x, y, 1.0 - x - y) / y;
    let [r, g, b] = primaries.map(xyz);
    let columns = DMat3::from_cols(r, g, b);
    columns * DMat3::from_diagonal(columns.inverse() * xyz(WHITE))
}

/// Linear light in other primaries, or converted from them though it was in the right ones.
fn primaries(case: &Case, lit: &LitPixels) -> Option<(Diagnosis, f64)> {
    (case.pair[0].encoding == Encoding::Linear).then_some(())?;
    let right = xyz_of(REC_709);
    let both = OTHER_PRIMARIES.into_iter().flat_map(|(name, other)| {
        let other = xyz_of(other);
        [
            (other.inverse() * right, format!("light is in the primaries of {name} and should be in those of sRGB (Rec. 709)")),
            (right.inverse() * other, format!("light is converted from the primaries of {name} to those of sRGB (Rec. 709), in which it was before")),
        ]
    });
    let found = both.filter_map(|(matrix, what)| {
        let of = |_, r: [f64; 3]| (matrix * DVec3::from(r)).to_array();
        let fit = lit.may_fit(of).then(|| lit.fit(of))?;
        let explains = fit.explains() && fit.left <= LEFT_BESIDE_A_FACTOR;
        (explains && fit.left <= FAR_LESS * lit.left_by_one_factor(case)).then_some((what, fit))
    });
    let (what, fit) = found.min_by(|a, b| a.1.left.total_cmp(&b.1.left))?;
    let diagnosis = Diagnosis {
        kind: Kind::Primaries,
        what: what.into(),
        evidence: evidence(&fit.tally),
    };
    Some((diagnosis, fit.left))
}

/// Light that is encoded or decoded once too often, by the curve of sRGB or the power 2.2, whichever fits better.
fn gamma(case: &Case, lit: &LitPixels) -> Option<(Diagnosis, f64)> {
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
    let promising = curves
        .into_iter()
        .filter(|(_, curve)| lit.may_fit(|_, r| r.map(*curve)));
    let found = promising.map(|(words, curve)| (words, lit.fit(|_, r| r.map(curve))));
    let most = FAR_LESS * lit.left_by_one_factor(case);
    let explaining = found.filter(|(_, fit)| fit.explains() && fit.left <= most);
    let rest = |fit: &Fit| fit.tally.rest();
    let (words, fit) = explaining.min_by(|a, b| rest(&a.1).total_cmp(&rest(&b.1)))?;
    let diagnosis = Diagnosis {
        kind: Kind::Gamma,
        what: words.into(),
        evidence: evidence(&fit.tally),
    };
    Some((diagnosis, fit.left))
}

/// Light that was scaled to the range of a display, and encoded for it.
fn encoded_and_scaled(case: &Case, lit: &LitPixels) -> Option<(Diagnosis, f64)> {
    (case.pair[0].encoding == Encoding::Linear).then_some(())?;
    type Curve = fn(f64) -> f64;
    let curves: [[Curve; 2]; 2] = [
        [srgb_encode, srgb_decode],
        [|v| libm::pow(v, 1.0 / 2.2), |v| libm::pow(v, 2.2)],
    ];
    let found = curves.into_iter().filter_map(|[encode, decode]| {
        let factor_of = |lit: &[Lit]| factor(lit, |c| c.map(decode)).filter(|f| *f > DARK);
        let about = factor_of(&lit.few)?;
        lit.may_fit(|_, r| r.map(|v| encode(about * v)))
            .then_some(())?;
        let factor = factor_of(&lit.pixels)?;
        let fit = lit.fit(|_, r| r.map(|v| encode(factor * v)));
        let explains = fit.explains() && fit.left <= LEFT_BESIDE_A_FACTOR;
        // If light has few different values one factor explains much, too.
        let is_curve = fit.left <= FAR_LESS * lit.left_by_one_factor(case);
        (explains && is_curve).then_some((factor, fit))
    });
    let (factor, fit) = found.min_by(|a, b| a.1.left.total_cmp(&b.1.left))?;
    let diagnosis = Diagnosis {
        kind: Kind::Gamma,
        what: format!(
            "light is encoded for a display (gamma) and should be linear{}",
            beside(factor)
        )
        .into(),
        evidence: evidence(&fit.tally),
    };
    Some((diagnosis, fit.left))
}

/// The distance of codes of 8 bits, with a margin for f32.
const CODE: f64 = 1.0001 / 255.0;

fn exposure(case: &Case, lit: &LitPixels) -> Option<(Diagnosis, f64)> {
    let mut lit = decoded(case, &lit.pixels);
    let factor = factor(&lit, |c| c)?;
    if case.pair[0].encoding == Encoding::Srgb {
        // Both were rounded to codes: half a code each.
        lit.to_mut().par_iter_mut().for_each(|(_, [r, c])| {
            let scaled = r.map(|v| factor * v);
            let is_code = |k: usize| (srgb_encode(scaled[k]) - srgb_encode(c[k])).abs() <= CODE;
            if (0..3).all(is_code) {
                *c = scaled;
            }
        });
    }
    let fit = fit(&lit, |_, r| r.map(|v| factor * v));
    (factor > 0.0 && fit.explains()).then(|| {
        let diagnosis = Diagnosis {
            kind: Kind::Exposure,
            what: format!(
                "light is {} times what it should be, uniformly ({:+.2} stops)",
                in_words(factor),
                libm::log2(factor)
            )
            .into(),
            evidence: [("factor", factor)]
                .into_iter()
                .chain(evidence(&fit.tally))
                .collect(),
        };
        (diagnosis, fit.left)
    })
}

/// The smallest notable exponent.
const NOTABLE_EXPONENT: f64 = 0.2;
/// The standard deviation of ln W that is needed, and the relative error up to which W itself is right.
const SPREAD: f64 = 0.01;
const W_IS_RIGHT: f64 = 1e-3;
/// The largest fraction of the pixels at which W itself may be wrong.
const MOST_WRONG: f64 = 0.1;

fn exponent(case: &Case, lit: &LitPixels) -> Option<(Diagnosis, f64)> {
    let [w_r, w_c] = case
        .pair
        .map(|p| Plane::aov(&p.layers, Aov::WavelengthRatio));
    let w_r = w_r?;
    let sum = |light: &[f64; 3]| light.iter().sum::<f64>();
    let (mut points, mut wrong) = (Vec::new(), 0usize);
    for (i, [r, c]) in &lit.pixels {
        let (ratio, w) = (sum(c) / sum(r), w_r.at(*i));
        if ratio > 0.0 && w > 0.0 && (ratio + w).is_finite() {
            points.push([libm::log(w), libm::log(ratio)]);
            wrong += usize::from(w_c.is_some_and(|w_c| (w_c.at(*i) / w - 1.0).abs() > W_IS_RIGHT));
        }
    }
    let n = points.len();
    if n < FEWEST || wrong as f64 > MOST_WRONG * n as f64 {
        return None;
    }
    // Least squares of the logarithm of light over that of W.
    let mean = |k: usize| points.iter().map(|p| p[k]).sum::<f64>() / n as f64;
    let (x0, y0) = (mean(0), mean(1));
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for [x, y] in &points {
        let (x, y) = (x - x0, y - y0);
        (xx, xy, yy) = (xx + x * x, xy + x * y, yy + y * y);
    }
    let slope = xy / xx;
    // r²: the fraction of the variance that the line explains.
    let explained = xy * xy / (xx * yy);
    let spread = (xx / n as f64).sqrt();
    let explains = slope.abs() >= NOTABLE_EXPONENT && explained >= MOST;
    let factor = libm::exp(y0 - slope * x0);
    // With two free parameters, a line fits many data that are not linear.
    let is_plain = is_whole(slope) || (factor - 1.0).abs() <= NOTABLE;
    let is_linear = || {
        let off = |[x, y]: &[f64; 2]| [y.abs(), (y - y0 - slope * (x - x0)).abs()];
        Tally::of(points.par_iter().map(off)).explains(0.0)
    };
    (spread >= SPREAD && explains && is_plain && is_linear()).then(|| {
        let diagnosis = describe_exponent(slope, factor, explained, n);
        (diagnosis, 1.0 - explained)
    })
}

/// Tolerance for an exponent to count as an integer.
const WHOLE: f64 = 0.1;

fn is_whole(slope: f64) -> bool {
    (slope - slope.round()).abs() < WHOLE && slope.round() != 0.0
}

fn describe_exponent(slope: f64, factor: f64, explained: f64, count: usize) -> Diagnosis {
    let whole = slope.round();
    let amount = match is_whole(slope) {
        true => format!("{whole:+}"),
        false => format!("{slope:+.2}"),
    };
    let beside = match (factor - 1.0).abs() > NOTABLE {
        true => beside(factor),
        false => String::new(),
    };
    Diagnosis {
        kind: Kind::ExponentWrong,
        what: format!(
            "the exponent of W in the radiance factor is off by {amount}: candidate / reference = W^({amount}){beside}"
        ).into(),
        evidence: vec![
            ("slope of ln(candidate / reference) over ln W", slope),
            ("factor at W = 1", factor),
            ("share of the error explained", explained),
            ("pixels with light", count as f64),
        ],
    }
}
