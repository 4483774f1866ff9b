//! Objects that are larger or smaller than they should be.
//!
//! If a pixel shows the same side of a body in both pictures, at r and c in its own coordinates, with the normal n there, a body scaled by
//! k about its origin satisfies
//!
//! ```text
//! n·(c − r) = (k − 1) n·r,
//! ```
//!
//! whichever point of the side the pixel shows. For a few flat sides a displacement fits equally: the bounding boxes of all points
//! distinguish the two, because opposite ends of a larger body move apart.

use std::collections::BTreeMap;

use glam::{DMat3, DVec3};
use rayon::prelude::*;

use super::super::picture::Plane;
use super::super::points::{WORLD_POINT, place};
use super::motion::FEWEST;
use super::{Case, Diagnosis, Kind, Tally, without_worst};
use crate::render::aov::Aov;
use crate::spacetime::Event;

/// The smallest notable relative error of sizes.
const NOTABLE: f64 = 0.005;

/// A side of a body: its normal, and the points that the two pictures show of it.
struct Side {
    n: DVec3,
    r: DVec3,
    c: DVec3,
}

impl Side {
    /// The distance of the candidate's point from the reference's side.
    fn off(&self) -> f64 {
        self.n.dot(self.c - self.r)
    }
}

/// Objects of another size.
pub(super) fn wrong(case: &Case) -> Vec<Diagnosis> {
    let mut pixels: BTreeMap<usize, [Vec<usize>; 2]> = BTreeMap::new();
    let all = case.region.pixels(case.points[0].size());
    for i in all.filter(|i| !case.is_mixed(*i)) {
        for (which, points) in case.points.iter().enumerate() {
            if let Some(object) = points.object_at(i).filter(|object| *object >= 0.0) {
                pixels.entry(object as usize).or_default()[which].push(i);
            }
        }
    }
    let found = pixels.iter();
    found
        .filter_map(|(object, pixels)| of_object(case, *object, pixels))
        .collect()
}

/// The point that a picture shows at a pixel, in the object's coordinates.
fn own(case: &Case, which: usize, object: usize, i: usize) -> Option<DVec3> {
    let points = &case.points[which];
    if case.points.iter().all(|points| points.material.is_some()) {
        return points.own_point(i);
    }
    let frame = case.known?.frame(object)?;
    let place = Plane::aovs(&case.pair[which].layers, WORLD_POINT).map(|world| place(&world, i))?;
    if frame.velocity().is_rest() {
        return Some(place - frame.origin().x);
    }
    let time = Plane::aov(&case.pair[which].layers, Aov::EventCt)?;
    Some(frame.event_from_world(Event::new(time.at(i), place)).x)
}

fn of_object(case: &Case, object: usize, [in_r, in_c]: &[Vec<usize>; 2]) -> Option<Diagnosis> {
    let points = |which: usize, pixels: &[usize]| -> BTreeMap<usize, DVec3> {
        let point = |i: &usize| Some((*i, own(case, which, object, *i)?));
        let points = pixels.iter().filter_map(point);
        points.filter(|(_, p)| p.is_finite()).collect()
    };
    let [r, c] = [points(0, in_r), points(1, in_c)];
    let sides = sides(case, &r, &c);
    if sides.len() < FEWEST {
        return None;
    }
    let extent = sides.iter().map(|side| side.r.length()).fold(0.0, f64::max);
    // About the origin, by least squares; and again without the worst tenth.
    let factor = |sides: &[&Side]| {
        let (above, below) = sides.iter().fold((0.0, 0.0), |(above, below), side| {
            let h = side.n.dot(side.r);
            (above + side.off() * h, below + h * h)
        });
        1.0 + above / below
    };
    let all: Vec<&Side> = sides.iter().collect();
    let first = factor(&all);
    let rest = |k: f64, side: &Side| (side.off() - (k - 1.0) * side.n.dot(side.r)).abs();
    let k = factor(&without_worst(&all, |side| rest(first, side)));
    let tally = Tally::of(
        sides
            .par_iter()
            .map(|side| [side.off().abs(), rest(k, side)]),
    );
    // The far sides of a body are its near ones times a negative number.
    let explains = k > 0.0 && (k - 1.0).abs() > NOTABLE && tally.explains(0.5 * NOTABLE * extent);
    let t = displacement(&sides);
    let by_t = sides
        .par_iter()
        .map(|side| [side.off().abs(), (side.off() - side.n.dot(t)).abs()]);
    let is_displaced = Tally::of(by_t).explains(0.5 * NOTABLE * extent);
    let is_size = !is_displaced || boxes_say_so(&r, &c, k, t);
    (explains && is_size).then(|| Diagnosis {
        kind: Kind::SizeWrong,
        what: format!(
            "object {object} is {k:.4} times as large as it should be ({:+.2} %)",
            100.0 * (k - 1.0)
        )
        .into(),
        evidence: vec![
            ("factor", k),
            ("its sides are off by (m, rms)", tally.error()),
            ("and from those of that size by (m, rms)", tally.rest()),
            ("pixels", sides.len() as f64),
        ],
    })
}

/// Normals that differ by more than the angle of this cosine belong to two sides: 18 degrees, more than between the facets of a ball, less
/// than at an edge.
const SAME_SIDE: f64 = 0.95;

/// The sides that both pictures show at one pixel. For round bodies the two show different facets: the mean of both normals is that of the
/// chord between them.
fn sides(case: &Case, r: &BTreeMap<usize, DVec3>, c: &BTreeMap<usize, DVec3>) -> Vec<Side> {
    let names = [Aov::NormalX, Aov::NormalY, Aov::NormalZ];
    let given = case.pair.map(|p| Plane::aovs(&p.layers, names));
    let [width, _] = case.points[0].size();
    // From the channels, if both have them, or else from neighbouring points.
    let normal = |which: usize, i: usize, of: &BTreeMap<usize, DVec3>| {
        if let ([Some(_), Some(_)], Some(given)) = (&given, given[which]) {
            return place(&given, i).try_normalize();
        }
        let step = |by: usize| {
            let before = i.checked_sub(by)?;
            Some(*of.get(&(i + by))? - *of.get(&before)?)
        };
        step(1)?.cross(step(width)?).try_normalize()
    };
    let side = |(&i, &of_r): (&usize, &DVec3)| {
        let of_c = *c.get(&i)?;
        let (n_r, n_c) = (normal(0, i, r)?, normal(1, i, c)?);
        (n_r.dot(n_c) > SAME_SIDE).then(|| Side {
            n: (n_r + n_c).normalize(),
            r: of_r,
            c: of_c,
        })
    };
    r.iter().filter_map(side).collect()
}

/// The displacement that best explains the sides; the shortest if several fit equally.
fn displacement(sides: &[Side]) -> DVec3 {
    let (mut normal, mut right) = (DMat3::ZERO, DVec3::ZERO);
    for side in sides {
        normal += DMat3::from_cols(side.n * side.n.x, side.n * side.n.y, side.n * side.n.z);
        right += side.n * side.off();
    }
    // A small multiple of the unit matrix selects the shortest of the equally good displacements.
    let damped = normal + DMat3::from_diagonal(DVec3::splat(1e-9 * sides.len() as f64));
    damped.inverse() * right
}

/// Whether the bounding box of the candidate's points is closer to k times the reference's than to the displaced one.
fn boxes_say_so(r: &BTreeMap<usize, DVec3>, c: &BTreeMap<usize, DVec3>, k: f64, t: DVec3) -> bool {
    let around = |points: &BTreeMap<usize, DVec3>| {
        let none = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        let points = points.values();
        points.fold(none, |[low, high], p| [low.min(*p), high.max(*p)])
    };
    let [r, c] = [around(r), around(c)];
    let off = |of: &dyn Fn(DVec3) -> DVec3| {
        let ends = r.into_iter().zip(c);
        ends.map(|(r, c)| (c - of(r)).length_squared()).sum::<f64>()
    };
    off(&|p| k * p) < off(&|p| p + t)
}
