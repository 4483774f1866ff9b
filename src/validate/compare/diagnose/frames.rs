//! Vectors in coordinates of another frame, signs of times, and numberings of triangles and their vertices.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::super::picture::Plane;
use super::super::points::place;
use super::{Case, Diagnosis, FEWEST, Kind, MOST, Tally, median};
use crate::render::aov::Aov;

/// Vectors with smaller errors relative to their rms length are right.
const NOTABLE: f64 = 0.05;

/// Events and look directions in the coordinates of another frame than the world's.
pub(super) fn frames(case: &Case) -> Vec<Diagnosis> {
    let mut found: Vec<Diagnosis> = event(case).into_iter().collect();
    found.extend(direction(case));
    found
}

const WORLD: &str = "the world's";
pub(super) const VIEW: &str = "coordinates along the camera's own axes (right, up, backwards)";

/// The name of the coordinates, and a pixel's vector in them.
pub(super) type Hypothesis<'a> = (
    &'static str,
    Box<dyn Fn(usize) -> Option<DVec3> + Sync + 'a>,
);

/// The hypothesis that best explains the candidate's vectors, if one explains most of their error and this is at least `notable` times
/// their rms length.
pub(super) fn best(
    [name, right]: [&str; 2],
    notable: f64,
    pixels: &[usize],
    [r, c]: [[Plane; 3]; 2],
    hypotheses: Vec<Hypothesis>,
) -> Option<Diagnosis> {
    let lengths = pixels.iter().map(|i| place(&r, *i).length());
    let scale = median(lengths.filter(|l| l.is_finite()).collect())?;
    let tallies = hypotheses.into_iter().filter_map(|(words, of)| {
        let tally = Tally::of_pixels(pixels, |i| {
            let c = place(&c, i);
            Some([(c - place(&r, i)).length(), (c - of(i)?).length()])
        });
        tally.explains(notable * scale).then_some((words, tally))
    });
    let (words, tally) = tallies.reduce(|a, b| match b.1.is_better_than(&a.1) {
        true => b,
        false => a,
    })?;
    Some(Diagnosis {
        kind: Kind::FrameWrong,
        what: format!("{name} is in {words}, and should be in {right}").into(),
        evidence: vec![
            ("vectors differ from the reference by (rms)", tally.error()),
            ("and from the hypothesis by (rms)", tally.rest()),
        ],
    })
}

fn event(case: &Case) -> Option<Diagnosis> {
    let [r, c] = case.points.map(|points| points.world);
    let (r, c) = (r?, c?);
    let mut hypotheses: Vec<Hypothesis> = Vec::new();
    if let Some(own) = case.points[0].material {
        let own = move |i: usize| Some(place(&own, i));
        hypotheses.push(("the coordinates of the objects' own frames", Box::new(own)));
    }
    let time = Plane::aov(&case.pair[0].layers, Aov::EventCt);
    if let (Some(known), Some(time)) = (case.known, time) {
        let seen = move |i: usize| known.since_shot(time.at(i), place(&r, i));
        let words = "coordinates relative to the event of the shot";
        hypotheses.push((words, Box::new(move |i| Some(seen(i)[0]))));
        let words = "the coordinates of the camera's frame";
        hypotheses.push((words, Box::new(move |i| Some(seen(i)[1]))));
        hypotheses.push((VIEW, Box::new(move |i| Some(known.view(seen(i)[1])))));
    }
    best(["event", WORLD], NOTABLE, case.pixels(), [r, c], hypotheses)
}

pub(super) fn direction(case: &Case) -> Option<Diagnosis> {
    let [r, c] = case.points.map(|points| points.direction);
    let (r, c, known) = (r?, c?, case.known?);
    let view = move |i: usize| Some(known.view(known.own_look(place(&r, i))?));
    let pixels = case.everywhere();
    let hypotheses: Vec<Hypothesis> = vec![(VIEW, Box::new(view))];
    best(["direction", WORLD], NOTABLE, pixels, [r, c], hypotheses)
}

/// Times with the opposite sign.
pub(super) fn signs(case: &Case) -> Vec<Diagnosis> {
    let of = |aov: Aov| {
        let [r, c] = case.pair.map(|picture| Plane::aov(&picture.layers, aov));
        let (r, c) = (r?, c?);
        let pairs = case.pixels().par_iter().map(|&i| (r.at(i), c.at(i)));
        let tally = Tally::of(pairs.map(|(r, c)| [(c - r).abs(), (c + r).abs()]));
        // Times that are all about 0 have no sign.
        tally.explains(1e-6).then(|| Diagnosis {
            kind: Kind::SignOpposite,
            what: format!("{} has the opposite sign", aov.name()).into(),
            evidence: vec![
                ("differs from the reference by (m, rms)", tally.error()),
                ("and from the hypothesis by (m, rms)", tally.rest()),
            ],
        })
    };
    let times = [Aov::EventCt, Aov::ObjectEventCt];
    times.into_iter().filter_map(of).collect()
}

/// Triangle indices that do not start at 0 in an object.
pub(super) fn beginnings(case: &Case) -> Option<Diagnosis> {
    let [r, c] = case.points.map(|points| points.primitive);
    let (r, c) = (r?, c?);
    let mut offsets: BTreeMap<i64, Vec<f64>> = BTreeMap::new();
    for &i in case.pixels() {
        let object = case.points[0].object_at(i).unwrap_or(0.0) as i64;
        let offset = c.at(i) - r.at(i);
        if offset.is_finite() {
            offsets.entry(object).or_default().push(offset);
        }
    }
    let first = |(object, offsets): (i64, Vec<f64>)| {
        let count = offsets.len();
        let offset = median(offsets.clone())?;
        let same = offsets.iter().filter(|other| **other == offset).count();
        let is_sure = count >= FEWEST && same as f64 >= MOST * count as f64;
        // Indices are not below 0, so none begins there.
        (is_sure && offset > 0.0).then_some((object, offset, count))
    };
    let found: Vec<(i64, f64, usize)> = offsets.into_iter().filter_map(first).collect();
    if let Some(only) = only_index(case, [&r, &c]) {
        return Some(only);
    }
    let words = found.iter().take(6);
    let words: Vec<String> = words
        .map(|(object, offset, _)| format!("at {offset} in object {object}"))
        .collect();
    (!found.is_empty()).then(|| Diagnosis {
        kind: Kind::IdentitiesShifted,
        what: format!(
            "indices of triangles begin {}, and should begin at 0 in each object",
            words.join(", ")
        )
        .into(),
        evidence: vec![(
            "pixels",
            found.iter().map(|(.., count)| *count as f64).sum(),
        )],
    })
}

/// One index for all triangles of all objects, although most pixels' objects have several in the reference.
fn only_index(case: &Case, [r, c]: [&Plane; 2]) -> Option<Diagnosis> {
    let pixels = case.pixels();
    let first = c.at(*pixels.first()?);
    let is_only = pixels.iter().all(|i| c.at(*i) == first);
    let wrong = pixels.iter().filter(|i| r.at(**i) != first).count();
    let is_notable = wrong >= FEWEST && wrong as f64 >= (1.0 - MOST) * pixels.len() as f64;
    (is_only && is_notable).then(|| Diagnosis {
        kind: Kind::IdentitiesShifted,
        what: format!("indices of triangles are {first} everywhere").into(),
        evidence: vec![("pixels with another triangle", wrong as f64)],
    })
}

/// Barycentric coordinates that are the weights of other vertices.
pub(super) fn weights(case: &Case) -> Option<Diagnosis> {
    let names = [Aov::BarycentricU, Aov::BarycentricV];
    let [r, c] = case.pair.map(|p| Plane::aovs(&p.layers, names));
    let (r, c) = (r?, c?);
    // For the same triangles only.
    let triangles = case.points.map(|points| points.primitive);
    let is_same = |i: &usize| match triangles {
        [Some(r), Some(c)] => r.at(*i) == c.at(*i),
        _ => true,
    };
    let pixels: Vec<usize> = case.pixels().iter().copied().filter(is_same).collect();
    let words = ["first", "second", "third"];
    let orders = [[2, 1], [0, 1], [1, 0], [0, 2], [2, 0]];
    orders.into_iter().find_map(|order: [usize; 2]| {
        let tally = Tally::of_pixels(&pixels, |i| {
            let [r, c] = [r, c].map(|planes| planes.map(|plane| plane.at(i)));
            let all = [1.0 - r[0] - r[1], r[0], r[1]];
            let [r, c] = [r, c].map(DVec2::from_array);
            let turned = DVec2::from_array(order.map(|corner| all[corner]));
            Some([(c - r).length(), (c - turned).length()])
        });
        tally.explains(0.05).then(|| Diagnosis {
            kind: Kind::WeightsExchanged,
            what: format!(
                "barycentric u and v are the weights of the {} and the {} corner, and should be those of the second and the third",
                words[order[0]], words[order[1]]
            ).into(),
            evidence: vec![
                ("weights differ by (rms)", tally.error()),
                ("and from the hypothesis by (rms)", tally.rest()),
            ],
        })
    })
}
