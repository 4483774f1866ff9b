//! Surfaces that a candidate does not show because a plane clips them, or for another reason.
//!
//! A near plane takes away what is nearer than a bound, a far plane what is farther: the depth along the camera's axis in its own frame, or
//! a distance. Of the pixels that lack the reference's surface and those that show it, the bound is the number that tells most of them
//! apart. Where the candidate has no indices of objects, it lacks what is lit in the reference and black in the candidate. Rims are left out:
//! samples elsewhere show other objects there.

use super::super::picture::{Plane, RADIANCE};
use super::super::points::around;
use super::{Case, Diagnosis, FEWEST, Kind, NEAR, depth, median};
use crate::render::aov::Aov;

/// The quantities that may be bounded.
const BOUNDED: [&str; 3] = [
    "along the camera's axis",
    "from the camera in its own frame",
    "from the camera",
];

/// The largest median displacement, in pixels, of surfaces that a plane or a hole leaves where they are: samples elsewhere cause less.
const DISPLACED: f64 = 1.0;

/// The smallest fraction of the picture that is missing without a bound.
const NOTABLE: f64 = 0.01;

/// Where an object of the reference is not shown.
pub(super) fn found(case: &Case) -> Option<Diagnosis> {
    let size = case.points[0].size();
    let object = |i: usize| case.points[0].object_at(i).filter(|id| *id >= 0.0);
    let [r, c] = case
        .pair
        .map(|picture| Plane::group(&picture.layers, RADIANCE));
    let sum = |planes: &Option<[Plane; 3]>, i: usize| {
        planes
            .as_ref()
            .map(|planes| planes.iter().map(|plane| plane.at(i)).sum::<f64>())
    };
    // What a pixel shows of the reference's surface.
    let is_lacking = |i: usize| {
        let id = object(i)?;
        match case.points[1].object_at(i) {
            Some(shown) => Some(shown != id),
            None => Some(sum(&c, i)? == 0.0 && sum(&r, i)? > 0.0),
        }
    };
    let mut pixels: [Vec<usize>; 2] = Default::default();
    for i in case.region.pixels(size) {
        let mut near = around(size, i).map(is_lacking);
        if let Some(lacks) = is_lacking(i)
            && near.all(|other| other == Some(lacks))
        {
            pixels[usize::from(lacks)].push(i);
        }
    }
    let [shown, lacking] = &pixels;
    if lacking.len() < FEWEST {
        return None;
    }
    let count = ("pixels", lacking.len() as f64);
    // A plane does not move what it leaves.
    let off = shown
        .iter()
        .filter_map(|i| Some(case.field?.displacement(*i)?.length()));
    if let Some(off) = median(off.collect()).filter(|off| *off > DISPLACED) {
        return Some(Diagnosis {
            kind: Kind::ObjectElsewhere,
            what: format!(
                "surfaces are missing at {} pixels, and those that are shown are displaced, half of them by {off:.1} pixels or more: objects are elsewhere, or triangles are too large",
                lacking.len()
            )
            .into(),
            evidence: vec![("median displacement (pixels)", off), count],
        });
    }
    // Objects that are lacking as a whole are another matter.
    let is_cut = |i: &usize| shown.iter().any(|j| object(*j) == object(*i));
    let is_cut = lacking.first().is_some_and(is_cut) || lacking.iter().any(is_cut);
    let distance = Plane::aov(&case.pair[0].layers, Aov::Distance);
    let clipped = (0..BOUNDED.len()).filter(|_| is_cut).filter_map(|k| {
        let value = |i: &usize| {
            let s = distance.as_ref()?.at(*i);
            let all = depth::meanings(case, *i, s);
            [all.map(|all| all[0]), all.map(|all| all[2]), Some(s)][k]
        };
        let values = [shown, lacking].map(|of| of.iter().filter_map(value).collect());
        bound(values).map(|(bound, is_near, wrong)| (k, bound, is_near, wrong))
    });
    if let Some((k, bound, is_near, wrong)) = clipped.min_by_key(|found| found.3)
        && wrong as f64 <= NEAR * lacking.len() as f64
    {
        let [than, plane] = if is_near {
            ["nearer", "near"]
        } else {
            ["farther", "far"]
        };
        let what = format!(
            "surfaces {than} than {bound:.3} m {} are missing: a {plane} plane clips them",
            BOUNDED[k]
        );
        return Some(Diagnosis {
            kind: Kind::SurfacesClipped,
            what: what.into(),
            evidence: vec![("bound (m)", bound), count],
        });
    }
    let nothing = |i: &&usize| case.points[1].object_at(**i).is_some_and(|id| id < 0.0);
    let nothing = lacking.iter().filter(nothing).count() as f64;
    let all = (size[0] * size[1]) as f64;
    (nothing >= NOTABLE * all).then(|| Diagnosis {
        kind: Kind::SurfacesMissing,
        what: format!(
            "surfaces are missing: at {:.1} % of the pixels the reference shows one, and the candidate nothing",
            100.0 * nothing / all
        )
        .into(),
        evidence: vec![("pixels", nothing)],
    })
}

/// The number that tells most values of the second list from those of the first, whether it is a lower bound of what is shown, and how many
/// values are on the wrong side.
fn bound(values: [Vec<f64>; 2]) -> Option<(f64, bool, usize)> {
    let mut all: Vec<(f64, bool)> = Vec::new();
    for (lacks, values) in [false, true].into_iter().zip(&values) {
        all.extend(values.iter().filter(|v| v.is_finite()).map(|v| (*v, lacks)));
    }
    let lacking = all.iter().filter(|(_, lacks)| *lacks).count();
    let shown = all.len() - lacking;
    (lacking >= FEWEST && shown >= FEWEST).then_some(())?;
    all.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    // Numbers of each kind up to a value.
    let mut below = [0usize; 2];
    let bounds = all.windows(2).flat_map(|pair| {
        below[usize::from(pair[0].1)] += 1;
        let middle = 0.5 * (pair[0].0 + pair[1].0);
        let near = lacking - below[1] + below[0];
        [(middle, true, near), (middle, false, all.len() - near)]
    });
    bounds.min_by_key(|(.., wrong)| *wrong)
}
