//! Mistakes of unknown size, fitted by rendering the scene with them.
//!
//! A size x, such as a delay, is tried at a few values. From the best one, secant steps follow: with the light L of two sizes a and b, and
//! the candidate's light c,
//!
//! ```text
//! x = b + (b − a) (c − L(b))·(L(b) − L(a)) / |L(b) − L(a)|².
//! ```
//!
//! A displacement x has three components: with J = ∂L/∂x from differences along the axes, Gauss–Newton steps follow,
//!
//! ```text
//! x ← x + (JᵀJ)⁻¹ Jᵀ (c − L(x)).
//! ```
//!
//! In large pictures, some tiles are enough to find x; the whole picture is rendered only with that.

use std::borrow::Cow;

use glam::{DMat3, DVec3};

use super::Case;
use super::light::{Fit, Lit, middle};
use super::scene_light::{Asked, Light, is_promising, light_of};
use crate::scene::model::Scene;

/// Steps from the best of the sizes that are tried.
const STEPS: usize = 6;
/// The largest fraction of the squared error that a mistake of fitted size may leave.
const LEFT_BY_SIZE: f64 = 0.1;
/// The resolution of sizes, relative to the smallest that is tried.
const FINE: f64 = 1e-3;

/// The fraction of the previous residual that the first step must reach for others to be worthwhile.
const PROMISING: f64 = 0.9;

/// Adds a size with its light, and keeps the two whose light is closest to the candidate's.
fn keep_nearest<'a>(found: &mut Vec<(f64, Cow<'a, Light>, Fit)>, next: (f64, Cow<'a, Light>, Fit)) {
    found.push(next);
    found.sort_by(|a, b| a.2.left.total_cmp(&b.2.left));
    found.truncate(2);
}

/// The size of a mistake that explains the candidate, if one does: the search starts with 0, with the light `unchanged`, and the sizes `tried`.
pub(super) fn of_some_size(
    case: &Case,
    asked: &Asked,
    unchanged: &Light,
    tried: &[f64],
    scene: impl Fn(f64) -> Option<Scene>,
) -> Option<(f64, Fit)> {
    let whole = |x: f64| light_of(case, &scene(x)?, asked.lit);
    let (x, fit) = match asked.first() {
        Some(few) => {
            let light = |x: f64| few.light(case, &scene(x)?);
            let (x, of_few) = nearest_size(&few.lit, unchanged, tried, light)?;
            is_promising(&of_few).then_some(())?;
            (x, whole(x)?.fit(asked.lit))
        }
        None => nearest_size(asked.lit, unchanged, tried, whole)?,
    };
    (fit.explains() && fit.left <= LEFT_BY_SIZE).then_some((x, fit))
}

/// The size whose light is closest to the candidate's in these pixels.
fn nearest_size(
    lit: &[Lit],
    unchanged: &Light,
    tried: &[f64],
    light: impl Fn(f64) -> Option<Light>,
) -> Option<(f64, Fit)> {
    let smallest = tried.iter().map(|x| x.abs()).reduce(f64::min)?;
    let middle = middle(lit);
    let compressed = |light: [f64; 3]| DVec3::from(light.map(|v| v / (v.abs() + middle)));
    let light = |x: f64| -> Option<(f64, Cow<Light>, Fit)> {
        let light = light(x)?;
        let fit = light.fit(lit);
        Some((x, Cow::Owned(light), fit))
    };
    // The best two are enough.
    let mut found = vec![(0.0, Cow::Borrowed(unchanged), unchanged.fit(lit))];
    for x in tried {
        keep_nearest(&mut found, light(*x)?);
    }
    for step in 0..STEPS {
        let [(b, at_b, _), (a, at_a, _)] = &found[..] else {
            return None;
        };
        let (mut above, mut below) = (0.0, 0.0);
        for (i, [_, c]) in lit {
            let [c, at_a, at_b] = [*c, at_a.0[*i], at_b.0[*i]].map(compressed);
            above += (c - at_b).dot(at_b - at_a);
            below += (at_b - at_a).length_squared();
        }
        // The point closest to the candidate on the line through the two, in compressed light.
        let way = (b - a) * above / below;
        if !way.is_finite() || way.abs() < FINE * smallest {
            break;
        }
        // No farther than the distance between the two.
        let x = b + way.clamp(-(b - a).abs(), (b - a).abs());
        let next = light(x)?;
        keep_nearest(&mut found, next);
        if step == 0 && found[0].2.left > PROMISING {
            return None;
        }
    }
    let (x, _, fit) = found.into_iter().next()?;
    // Far beyond what was tried, light hardly changes any more, and chance decides.
    let farthest = tried.iter().map(|x| x.abs()).fold(0.0, f64::max);
    (x != 0.0 && x.abs() <= BEYOND * farthest).then_some((x, fit))
}

/// The largest size that is reported, relative to the largest that is tried.
const BEYOND: f64 = 2.0;

/// The displacement for the first differences, the longest step, and the resolution, relative to the size of the scene.
const NEARBY: f64 = 0.01;
const LONGEST_STEP: f64 = 0.1;
const FINE_PLACE: f64 = 1e-4;
/// The smallest displacement that is reported, relative to the size of the scene.
const LEAST_PLACE: f64 = 1e-3;
/// The largest fraction of the squared error that another place may leave: other films leave more, as do edges of single samples.
const LEFT_BY_PLACE: f64 = 0.02;

/// The displacement of something in the scene that explains the candidate, if one does: by Gauss–Newton steps from its place, where it
/// gives the light `unchanged`, with differences along the axes.
pub(super) fn of_some_place(
    case: &Case,
    asked: &Asked,
    unchanged: &Light,
    size: f64,
    scene: &dyn Fn(DVec3) -> Option<Scene>,
) -> Option<(DVec3, Fit)> {
    let whole = |x: DVec3| light_of(case, &scene(x)?, asked.lit);
    let (x, fit) = match asked.first() {
        Some(few) => {
            let light = |x: DVec3| few.light(case, &scene(x)?);
            let (x, of_few) = nearest_place(&few.lit, unchanged, size, light)?;
            is_promising(&of_few).then_some(())?;
            (x, whole(x)?.fit(asked.lit))
        }
        None => nearest_place(asked.lit, unchanged, size, whole)?,
    };
    (fit.explains() && fit.left <= LEFT_BY_PLACE).then_some((x, fit))
}

/// The displacement whose light is closest to the candidate's in these pixels.
fn nearest_place(
    lit: &[Lit],
    unchanged: &Light,
    size: f64,
    light: impl Fn(DVec3) -> Option<Light>,
) -> Option<(DVec3, Fit)> {
    let middle = middle(lit);
    let compressed = |light: [f64; 3]| DVec3::from(light.map(|v| v / (v.abs() + middle)));
    let near = NEARBY * size;
    let beside: Vec<Light> = (DVec3::AXES.into_iter())
        .map(|axis| light(near * axis))
        .collect::<Option<_>>()?;
    // The columns of ∂L/∂x at each pixel.
    let slopes = |i: usize| {
        let here = compressed(unchanged.0[i]);
        [0, 1, 2].map(|k| (compressed(beside[k].0[i]) - here) / near)
    };
    let (mut x, mut now) = (DVec3::ZERO, unchanged.0.clone());
    let mut fit = unchanged.fit(lit);
    for step_number in 0..STEPS {
        let (mut normal, mut right) = (DMat3::ZERO, DVec3::ZERO);
        for (i, [_, c]) in lit {
            let slopes = slopes(*i);
            let off = compressed(*c) - compressed(now[*i]);
            right += DVec3::from(slopes.map(|slope| slope.dot(off)));
            let column = |k: usize| DVec3::from(slopes.map(|slope| slope.dot(slopes[k])));
            normal += DMat3::from_cols(column(0), column(1), column(2));
        }
        let step = normal.inverse() * right;
        step.is_finite().then_some(())?;
        let step = step.clamp_length_max(LONGEST_STEP * size);
        let next = light(x + step)?;
        let next_fit = next.fit(lit);
        if next_fit.left >= fit.left {
            break;
        }
        (x, now, fit) = (x + step, next.0, next_fit);
        if step_number == 0 && fit.left > PROMISING {
            return None;
        }
        if step.length() < FINE_PLACE * size {
            break;
        }
    }
    (x.length() >= LEAST_PLACE * size).then_some((x, fit))
}
