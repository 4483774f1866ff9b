//! How far points are seen from where they should be, in the scene and in a changed one.

use glam::DVec2;

use super::super::known::KnownScene;
use super::{Case, Tally};

/// The smallest notable displacement, pixels, rms.
pub(super) const NOTABLE_DISPLACEMENT: f64 = 0.1;

/// The places in pixels at which pictures show points.
#[derive(Debug, Clone, Copy)]
pub(super) enum Aim {
    /// The centres of pixels.
    Centres,
    /// The places at which the reference's own points are seen: those of its samples, which the candidate may share.
    OfReference,
}

/// The farthest that the mean of a pixel's samples can be from its centre, pixels: a mean over several surfaces is seen elsewhere.
pub(super) const IN_PIXEL: f64 = 0.75;

impl Aim {
    /// The aims that the candidate may have.
    pub fn all(case: &Case) -> &'static [Aim] {
        match case.pair[0].metadata("pixel_centers") {
            Some("true") => &[Aim::Centres],
            _ => &[Aim::Centres, Aim::OfReference],
        }
    }

    /// The place in pixel `i`.
    pub fn place(self, case: &Case, known: &KnownScene, i: usize) -> DVec2 {
        let points = &case.points[0];
        let centre = DVec2::new((i % points.width) as f64, (i / points.width) as f64) + 0.5;
        let seen = match self {
            Aim::Centres => None,
            Aim::OfReference => known.place(points, i),
        };
        let seen = seen.filter(|seen| seen.distance(centre) <= IN_PIXEL);
        seen.unwrap_or(centre)
    }
}

/// Distances of the candidate's points from where they should be seen, in the scene and in the changed one; for the aim that leaves less.
pub(super) fn displaced(
    case: &Case,
    known: &KnownScene,
    changed: &KnownScene,
    object: Option<usize>,
) -> Tally {
    let aims = Aim::all(case).iter();
    least(aims.map(|aim| {
        let off = displacements(case, *aim, [known, changed], object);
        Tally::of_all(case.everywhere(), off)
    }))
}

/// The same for a hypothesis that is only of interest if it explains them: where it explains too little of some of them for any aim, only
/// those.
pub(super) fn displaced_if_promising(
    case: &Case,
    known: &KnownScene,
    changed: &KnownScene,
    object: Option<usize>,
) -> Tally {
    let some = Aim::all(case).iter().map(|aim| {
        let off = displacements(case, *aim, [known, changed], object);
        Tally::of_some(case.everywhere(), off)
    });
    match some.collect::<Option<Vec<_>>>() {
        Some(unpromising) => least(unpromising.into_iter()),
        None => displaced(case, known, changed, object),
    }
}

/// The one that leaves least.
fn least(tallies: impl Iterator<Item = Tally>) -> Tally {
    let least = tallies.reduce(|a, b| if b.rest() < a.rest() { b } else { a });
    least.unwrap_or_else(|| Tally::of(rayon::iter::empty()))
}

/// Distances at a pixel of the candidate's point from where it should be seen, in the scene and in the changed one.
fn displacements(
    case: &Case,
    aim: Aim,
    [known, changed]: [&KnownScene; 2],
    object: Option<usize>,
) -> impl Fn(usize) -> Option<[f64; 2]> + Sync {
    let points = &case.points[1];
    let [width, _] = points.size();
    move |i: usize| {
        let is_other = |id: f64| object.is_some_and(|object| id != object as f64);
        if case.is_mixed(i) || points.object_at(i).is_some_and(is_other) {
            return None;
        }
        let aimed = aim.place(case, known, i);
        let shown = changed.place(points, i)?;
        let (k, p) = known.point(points, i)?;
        let right = known.film_point(k, p);
        // A point that is not seen, or is far out of view, counts as the width of the picture away.
        let off = |p: DVec2| (p - aimed).length().min(width as f64);
        Some([right.map_or(width as f64, off), off(shown)])
    }
}
