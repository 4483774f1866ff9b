//! Why a candidate is wrong: hypotheses that explain most of an error, with their evidence.
//!
//! | diagnosis | hypothesis | explains when |
//! |---|---|---|
//! | aberration reversed, or left out | look directions d′ of the camera's frame are boosted with −β, or not at all | d differs from that by less than a tenth of what it differs from the reference |
//! | velocities swapped, or wrong | W and d of an object's pixels give its four-velocity, see [`motion`] | the candidate's are those of the other object; or differ while both fit |
//! | emission time shifted | the time differs by a constant | nine tenths of the pixels are within a tenth of the median |
//! | exponent of W wrong | ln(c/r) = k ln W | nine tenths of Σ ln²(c/r), with W itself right |
//! | triangle, or object displaced | δ on one triangle, or one object, alone | nine tenths of Σ\|δ\|², on at most half of the pixels of surfaces |
//!
//! A hypothesis without the channels that it needs is not asked. Where directions or velocities are wrong, what follows
//! from that (time, brightness, places) is not diagnosed again.

mod aberration;
mod displaced;
mod exponent;
pub mod motion;
mod time;

use serde::Serialize;

use super::Picture;
use super::region::Region;
use super::surface::points::Points;

/// The part of an error that a hypothesis has to explain.
const MOST: f64 = 0.9;

/// What is wrong with a candidate, and how one sees it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Diagnosis {
    /// Which hypothesis.
    pub kind: Kind,
    /// What is wrong, as a sentence.
    pub what: String,
    /// Names and values of the evidence.
    pub evidence: Vec<(&'static str, f64)>,
}

/// What can be diagnosed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// Look directions are boosted with the opposite velocity.
    AberrationReversed,
    /// Look directions are those of the camera's frame.
    AberrationMissing,
    /// Two objects have each other's velocity.
    VelocitiesSwapped,
    /// An object has another velocity.
    VelocityWrong,
    /// Emission times are shifted by a constant.
    TimeShifted,
    /// The radiance factor has another exponent.
    ExponentWrong,
    /// One triangle is displaced.
    TriangleDisplaced,
    /// One object is displaced.
    ObjectDisplaced,
}

/// What the hypotheses are asked of.
#[derive(Debug, Clone, Copy)]
struct Case<'a> {
    pair: [&'a Picture; 2],
    points: [Points<'a>; 2],
    region: &'a Region,
    /// Width of a time bin, metres of light path.
    bin_width: Option<f64>,
}

/// All diagnoses of a candidate.
pub(super) fn diagnose(
    pair: [&Picture; 2],
    region: &Region,
    bin_width: Option<f64>,
) -> Vec<Diagnosis> {
    let case = Case {
        pair,
        points: pair.map(|picture| Points::new(&picture.layers)),
        region,
        bin_width,
    };
    let causes: Vec<Diagnosis> = aberration::diagnose(&case).into_iter().collect();
    if !causes.is_empty() {
        return causes;
    }
    let causes = motion::diagnose(&case);
    if !causes.is_empty() {
        return causes;
    }
    let effects = [
        time::diagnose(&case),
        exponent::diagnose(&case),
        displaced::diagnose(&case),
    ];
    effects.into_iter().flatten().collect()
}

impl Case<'_> {
    /// Pixels of the region at which both pictures show the same object.
    fn pixels(&self) -> Vec<usize> {
        let [width, height] = self.points[0].size();
        let mut pixels = Vec::new();
        for y in 0..height {
            let chosen = self.region.row(y, width);
            let row = (0..width).filter(|x| chosen[*x]).map(|x| y * width + x);
            pixels.extend(row.filter(|i| self.points[0].same_object(&self.points[1], *i)));
        }
        pixels
    }
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    let middle = values.len() / 2;
    let inside = middle < values.len();
    inside.then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}
