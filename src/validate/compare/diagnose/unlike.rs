//! Channels that are wrong in a way that no other hypothesis explains, at pixels that show the right points.
//!
//! Samples elsewhere in a pixel give other values, but not beyond those around it, and not to one side. So a channel is wrong in an object
//! if many of its values are outside of the reference's range over the pixel and its neighbours by more than that range and a tolerance; or
//! if the median of the differences is more than half of the change from a pixel to the next, a tolerance, and what chance allows. Triangles
//! are compared where a pixel and its neighbours show one of them: then all of the pixel does.

use std::collections::{BTreeMap, BTreeSet};

use rayon::prelude::*;

use super::super::picture::Plane;
use super::super::points::around;
use super::channels::same_places;
use super::{Case, Diagnosis, FEWEST, Kind, median};
use crate::render::aov::{Aov, group, group_of};

/// The fraction of an object's pixels at which a channel must be wrong to be named.
const NOTABLE: f64 = 0.1;
/// The tolerance relative to the largest value of the group, for noise of one percent in each picture, and relative to the variation over the pixels.
const OF_LARGEST: f64 = 0.02;
const OF_VARIATION: f64 = 0.03;
/// The tolerances of the median: relative to the largest value, relative to the change from a pixel to the next, and in standard errors.
const MEDIAN_OF_LARGEST: f64 = 0.005;
const MEDIAN_OF_STEP: f64 = 0.5;
const MEDIAN_BY_CHANCE: f64 = 6.0;

/// Channels of surfaces. Points of objects have their own measure, displacements.
const OF_SURFACES: [Aov; 17] = [
    Aov::EventX,
    Aov::EventY,
    Aov::EventZ,
    Aov::EventCt,
    Aov::ObjectEventCt,
    Aov::DirectionX,
    Aov::DirectionY,
    Aov::DirectionZ,
    Aov::Distance,
    Aov::WavelengthRatio,
    Aov::NormalX,
    Aov::NormalY,
    Aov::NormalZ,
    Aov::UvU,
    Aov::UvV,
    Aov::BarycentricU,
    Aov::BarycentricV,
];

/// Channels of the whole film.
const OF_FILM: [Aov; 6] = [
    Aov::Alpha,
    Aov::Coverage,
    Aov::MissingBefore,
    Aov::MissingAfter,
    Aov::MissingOffTexture,
    Aov::MissingOccluded,
];

/// Pixels by object.
type Objects = BTreeMap<i64, Vec<usize>>;

/// Channels that are wrong, with the objects in which they are.
pub(super) fn channels(case: &Case) -> Vec<Diagnosis> {
    // What the candidate does not say of itself is not said of it.
    let of = match case.field {
        Some(_) => " of the pixels that show the right points",
        None => " of the pixels",
    };
    let inside = match case.points[1].object {
        Some(_) => "in",
        None => "where the reference shows",
    };
    let mut objects = Objects::new();
    for i in same_places(case) {
        let object = case.points[0].object_at(i).unwrap_or(0.0);
        objects.entry(object as i64).or_default().push(i);
    }
    let film = case.everywhere();
    let film = Objects::from([(0, film.to_vec())]);
    // Channels of a group together, with the numbers of the first of them.
    let mut groups: Vec<(Vec<&str>, Wrong)> = Vec::new();
    // What is smaller than a pixel has another value at its centre than in the mean.
    let sampled = case.pair.map(|picture| picture.metadata("pixel_centers"));
    let are_alike = sampled[0] == sampled[1] || sampled.contains(&None);
    let of_surfaces = OF_SURFACES.into_iter().filter(|_| are_alike);
    let of_surfaces = of_surfaces.map(|aov| (aov, &objects));
    for (aov, objects) in of_surfaces.chain(OF_FILM.into_iter().map(|aov| (aov, &film))) {
        let Some(wrong) = in_objects(objects, |pixels| wrong_values(case, pixels, aov)) else {
            continue;
        };
        let of_group = |(names, _): &&mut (Vec<&str>, Wrong)| group(names[0]) == group(aov.name());
        match groups.iter_mut().find(of_group) {
            Some((names, all)) => {
                names.push(aov.name());
                all.objects.extend(wrong.objects);
            }
            None => groups.push((vec![aov.name()], wrong)),
        }
    }
    let describe = |(names, wrong): (Vec<&str>, Wrong)| {
        let verb = if names.len() == 1 { "is" } else { "are" };
        let of_first = match names.as_slice() {
            [first, _, ..] => format!("{first} "),
            _ => String::new(),
        };
        let unit = if is_length(names[0]) { " m" } else { "" };
        let what = format!(
            "{}{} {verb} wrong: {of_first}at {:.0} %{of}, by {:.4}{unit} at half of these",
            wrong.place(inside),
            listed(&names),
            100.0 * wrong.part,
            wrong.off
        );
        (
            what,
            vec![
                ("part of the pixels", wrong.part),
                ("off by (median)", wrong.off),
            ],
        )
    };
    let mut found: Vec<_> = groups.into_iter().map(describe).collect();
    let triangles = in_objects(&objects, |pixels| wrong_triangles(case, pixels));
    found.extend(triangles.map(|wrong| {
        let what = format!(
            "{}indices of triangles are wrong: of the pixels inside a triangle {:.0} % have that of another one",
            wrong.place(inside),
            100.0 * wrong.part
        );
        (what, vec![("part of the pixels", wrong.part)])
    }));
    let kind = Kind::ChannelWrong;
    let describe = |(what, evidence): (String, _)| Diagnosis {
        kind,
        what: what.into(),
        evidence,
    };
    found.into_iter().map(describe).collect()
}

/// Where a channel is wrong, and by how much.
struct Wrong {
    objects: BTreeSet<i64>,
    /// The number of objects that were tested.
    tested: usize,
    /// The fraction of the objects' pixels, and the median error there.
    part: f64,
    off: f64,
}

impl Wrong {
    /// The beginning of a sentence, "in object 3, " with `inside` = "in"; empty for all objects.
    fn place(&self, inside: &str) -> String {
        let named: Vec<String> = self.objects.iter().map(i64::to_string).collect();
        match named.as_slice() {
            _ if named.len() == self.tested => String::new(),
            [one] => format!("{inside} object {one}, "),
            several => format!("{inside} objects {}, ", several.join(", ")),
        }
    }
}

/// The objects in which values are wrong at enough pixels; `wrong` gives the sizes of errors for the pixels of an object, and how many pixels
/// were tested.
fn in_objects(
    objects: &Objects,
    wrong: impl Fn(&[usize]) -> Option<(Vec<f64>, usize)>,
) -> Option<Wrong> {
    let (mut named, mut tested, mut count, mut all) = (BTreeSet::new(), 0, 0, Vec::new());
    for (object, pixels) in objects {
        let (wrong, of) = wrong(pixels)?;
        tested += usize::from(of >= FEWEST);
        if are_many(wrong.len(), of) {
            named.insert(*object);
            count += of;
            all.extend(wrong);
        }
    }
    (!named.is_empty()).then(|| Wrong {
        objects: named,
        tested,
        part: all.len() as f64 / count as f64,
        off: median(all).unwrap_or(0.0),
    })
}

/// Whether this number of an object's pixels is enough for a channel to be named.
fn are_many(wrong: usize, of: usize) -> bool {
    wrong >= FEWEST && wrong as f64 >= NOTABLE * of as f64
}

/// Whether the channel is a length, or a time in metres of light path.
fn is_length(name: &str) -> bool {
    ["event", "object_event", "distance"].contains(&group(name))
}

fn listed(names: &[&str]) -> String {
    match names {
        [others @ .., last] if !others.is_empty() => format!("{} and {last}", others.join(", ")),
        _ => names.concat(),
    }
}

/// The sizes of the errors of a channel that is wrong at these pixels (none if it is right), and the number of pixels with numbers; `None` if
/// a picture lacks the channel.
fn wrong_values(case: &Case, pixels: &[usize], aov: Aov) -> Option<(Vec<f64>, usize)> {
    let [r, c] = case.pair.map(|picture| Plane::aov(&picture.layers, aov));
    let (r, c) = (r?, c?);
    let is_number = |i: &usize| r.at(*i).is_finite() && c.at(*i).is_finite();
    let pixels: Vec<usize> = pixels.par_iter().copied().filter(is_number).collect();
    // Of all channels of the group: a coordinate that is 0 has the rounding errors of the others.
    let planes = group_of(group(aov.name()));
    let planes = planes
        .into_iter()
        .filter_map(|aov| Plane::aov(&case.pair[0].layers, aov));
    let largest = planes.map(|plane| {
        let sizes = pixels.par_iter().map(|i| plane.at(*i).abs());
        sizes.filter(|v| v.is_finite()).reduce(|| 0.0, f64::max)
    });
    let largest = largest.fold(0.0, f64::max);
    // Few are off by more than rounding, as in most pictures.
    let differences: Vec<f64> = pixels.par_iter().map(|i| c.at(*i) - r.at(*i)).collect();
    let sizes = differences.iter().map(|d| d.abs());
    let wrong: Vec<f64> = sizes
        .filter(|size| *size > MEDIAN_OF_LARGEST * largest)
        .collect();
    if !are_many(wrong.len(), pixels.len()) {
        return Some((Vec::new(), pixels.len()));
    }
    let right = || pixels.par_iter().map(|i| r.at(*i));
    let middle = median(right().collect())?;
    let variation = median(right().map(|v| (v - middle).abs()).collect())?;
    let tolerance = OF_LARGEST * largest + OF_VARIATION * variation;
    let range = |i: usize| {
        let around = around(case.points[0].size(), i).map(|j| r.at(j));
        let none = [f64::INFINITY, f64::NEG_INFINITY];
        let finite = around.filter(|v| v.is_finite());
        finite.fold(none, |[low, high], v| [low.min(v), high.max(v)])
    };
    // Beyond what is around a pixel.
    let is_beyond = |i: &&usize| {
        let [low, high] = range(**i);
        let margin = high - low + tolerance;
        c.at(**i) < low - margin || c.at(**i) > high + margin
    };
    let beyond = pixels.par_iter().filter(is_beyond).count();
    // To one side: of two pixels and the one between, values differ by two steps.
    let shift = median(differences.clone())?;
    let spread = median(differences.iter().map(|d| (d - shift).abs()).collect())?;
    let steps = pixels
        .par_iter()
        .map(|i| range(*i))
        .map(|[low, high]| 0.5 * (high - low));
    let step = median(steps.collect())?;
    // The median of normal numbers has the standard error 1.25 σ/√n, with σ = 1.48 times the median deviation.
    let chance = MEDIAN_BY_CHANCE * 1.86 * spread / (pixels.len() as f64).sqrt();
    let is_aside = shift.abs() > MEDIAN_OF_LARGEST * largest + MEDIAN_OF_STEP * step + chance;
    let is_wrong = are_many(beyond, pixels.len()) || is_aside;
    Some((if is_wrong { wrong } else { Vec::new() }, pixels.len()))
}

/// A one for each pixel inside a triangle that has the index of another one, and the number of such pixels; `None` if a picture lacks indices.
fn wrong_triangles(case: &Case, pixels: &[usize]) -> Option<(Vec<f64>, usize)> {
    let [r, c] = case.points.map(|points| points.primitive);
    let (r, c) = (r?, c?);
    let object = |i: usize| case.points[0].object_at(i);
    let is_inside = |i: &&usize| {
        let mut around = around(case.points[0].size(), **i);
        around.all(|j| r.at(j) == r.at(**i) && object(j) == object(**i))
    };
    let inside: Vec<&usize> = pixels.par_iter().filter(is_inside).collect();
    let wrong = inside.iter().filter(|i| c.at(***i) != r.at(***i));
    Some((wrong.map(|_| 1.0).collect(), inside.len()))
}
