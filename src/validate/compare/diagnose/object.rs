//! Mistakes in single objects out of several.
//!
//! If nothing explains the errors of the whole picture, channels and light are tested again with the pixels where both pictures show one
//! object.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::OnceLock;

use super::super::options::Region;
use super::super::picture::{Plane, is_auxiliary};
use super::{
    Case, Diagnosis, FEWEST, Kind, MOST, PixelLists, channels, frames, light, ratios, time,
};
use crate::error::Message;

/// The most objects that are tested, the largest first.
const MOST_OBJECTS: usize = 32;

/// Objects with less than this fraction of the picture's rms light are ignored for light: it comes from their edges.
const DIM: f64 = 0.05;

/// Light at a smaller fraction of an object's pixels is ignored.
const FEWEST_LIT: f64 = 0.1;

/// The largest fraction of lit pixels whose light may differ as edges do.
const MOST_AT_EDGES: f64 = 0.25;

/// Mistakes of single objects.
pub(super) fn single(case: &Case) -> Vec<Diagnosis> {
    let usual = light::lit(case).map_or(0.0, |lit| light::middle(&lit));
    let mut found = of_each(case, |case| of_object(case, usual));
    // The light of one object has a factor of its own by chance where something else changes the light of the others, or its exponent.
    let is_of_light = |kind| matches!(kind, Kind::Exposure | Kind::ExponentWrong);
    let is_exponent = found.iter().any(|(_, d)| d.kind == Kind::ExponentWrong);
    let explained: BTreeSet<i64> = (found.iter())
        .filter(|(_, d)| is_of_light(d.kind))
        .map(|(object, _)| *object)
        .collect();
    if is_exponent || is_light_wrong_beside(case, &explained) {
        found.retain(|(_, d)| d.kind != Kind::Exposure);
    }
    together(found, objects(case).len())
}

/// Whether the light of other objects than these differs at more than their edges.
fn is_light_wrong_beside(case: &Case, explained: &BTreeSet<i64>) -> bool {
    let is_beside = |i: usize| {
        let object = case.points[0].object_at(i);
        object.is_some_and(|object| !explained.contains(&(object as i64)))
    };
    let beside = light::lit(case)
        .into_iter()
        .flatten()
        .filter(|(i, _)| is_beside(*i));
    let (mut all, mut wrong) = (0usize, 0usize);
    for (_, [r, c]) in beside {
        all += 1;
        let size = light::distance(r, [0.0; 3]);
        wrong += usize::from(light::distance(c, r) > light::NOTABLE * size);
    }
    wrong >= FEWEST && wrong as f64 > MOST_AT_EDGES * all as f64
}

/// Lengths and times of single objects in another unit; tested only for objects that are not resized or elsewhere.
pub(super) fn units(case: &Case) -> Vec<Diagnosis> {
    together(of_each(case, channels::units), objects(case).len())
}

/// The pixels of each object that is tested; none if there are fewer than two.
fn objects(case: &Case) -> Vec<(i64, Vec<usize>)> {
    let mut pixels: BTreeMap<i64, Vec<usize>> = BTreeMap::new();
    if case.points.iter().any(|points| points.object.is_none()) {
        return Vec::new();
    }
    for &i in case.of_same_object() {
        let object = case.points[0].object_at(i).unwrap_or(-1.0) as i64;
        pixels.entry(object).or_default().push(i);
    }
    let mut objects: Vec<(i64, Vec<usize>)> = pixels.into_iter().collect();
    objects.retain(|(_, pixels)| pixels.len() >= FEWEST);
    objects.sort_by_key(|(object, pixels)| (std::cmp::Reverse(pixels.len()), *object));
    objects.truncate(MOST_OBJECTS);
    objects.sort_by_key(|(object, _)| *object);
    if objects.len() < 2 {
        objects.clear();
    }
    objects
}

/// The diagnoses from the pixels of each object, if there are several.
fn of_each(case: &Case, of: impl Fn(&Case) -> Vec<Diagnosis>) -> Vec<(i64, Diagnosis)> {
    let size = case.points[0].size();
    let found = objects(case).into_iter().flat_map(|(object, pixels)| {
        let mut mask = vec![false; size[0] * size[1]];
        pixels.iter().for_each(|i| mask[*i] = true);
        let region = Region {
            crop: None,
            mask: Some(mask),
        };
        let lists = PixelLists {
            same: OnceLock::from(pixels),
            ..PixelLists::default()
        };
        let case = Case {
            region: &region,
            lists: &lists,
            ..*case
        };
        of(&case).into_iter().map(move |found| (object, found))
    });
    found.collect()
}

/// Merges diagnoses of `count` objects, with one for all objects that share it.
fn together(found: Vec<(i64, Diagnosis)>, count: usize) -> Vec<Diagnosis> {
    let mut same: Vec<(Vec<i64>, Diagnosis)> = Vec::new();
    for (object, next) in found {
        let is_same =
            |(_, d): &&mut (Vec<i64>, Diagnosis)| d.kind == next.kind && d.what == next.what;
        match same.iter_mut().find(is_same) {
            Some((objects, found)) => {
                objects.push(object);
                add_pixels(found, &next);
            }
            None => same.push((vec![object], next)),
        }
    }
    let say = |(objects, found): (Vec<i64>, Diagnosis)| {
        let words: Vec<String> = objects.iter().map(i64::to_string).collect();
        let of = match objects.len() {
            n if n == count => String::new(),
            1 => format!("in object {}, ", words[0]),
            _ => format!("in objects {}, ", words.join(", ")),
        };
        let what = Message::from(of) + found.what;
        Diagnosis { what, ..found }
    };
    // Numbers may differ between objects.
    let mut said = Vec::new();
    while !same.is_empty() {
        let kind = same[0].1.kind;
        let (of_kind, others) = same.into_iter().partition(|(_, found)| found.kind == kind);
        let of_kind: Vec<(Vec<i64>, Diagnosis)> = of_kind;
        let objects: usize = of_kind.iter().map(|(objects, _)| objects.len()).sum();
        match of_kind.len() > 1 && objects == count {
            true => said.push(in_each(of_kind)),
            false => said.extend(of_kind.into_iter().map(say)),
        }
        same = others;
    }
    said
}

/// The most objects that are listed separately.
const MOST_TOLD: usize = 4;

/// The diagnosis of a mistake that all objects have, each with different numbers.
fn in_each(found: Vec<(Vec<i64>, Diagnosis)>) -> Diagnosis {
    let more = if found.len() > MOST_TOLD { "; …" } else { "" };
    let mut what = Message::from("in each object by itself: ");
    for (n, (objects, found)) in found.iter().take(MOST_TOLD).enumerate() {
        let words: Vec<String> = objects.iter().map(i64::to_string).collect();
        let separator = if n > 0 { "; " } else { "" };
        what += Message::from(format!("{separator}in {}, ", words.join(", "))) + found.what.clone();
    }
    what += more;
    let (kind, evidence) = (found[0].1.kind, found[0].1.evidence.clone());
    Diagnosis {
        kind,
        what,
        evidence,
    }
}

/// Adds the number of pixels where another object has the same mistake.
fn add_pixels(found: &mut Diagnosis, more: &Diagnosis) {
    for (name, value) in &mut found.evidence {
        let added = more.evidence.iter().find(|(other, _)| other == name);
        if let Some((_, more)) = added.filter(|_| *name == PIXELS) {
            *value += more;
        }
    }
}

/// The name of the number of pixels in the evidence.
const PIXELS: &str = "pixels";

/// Explanations of the errors of one object's pixels.
fn of_object(case: &Case, usual: f64) -> Vec<Diagnosis> {
    let mut found: Vec<Diagnosis> = not_numbers(case).into_iter().collect();
    if found.is_empty() {
        found.extend(channels::coordinates(case));
        found.extend(ratios::forms(case));
        found.extend(channels::texture(case));
        found.extend(frames::weights(case));
        // An object that is elsewhere has other times.
        let is_there =
            channels::same_places(case).len() as f64 >= MOST * case.pixels().len() as f64;
        found.extend(is_there.then(|| time::shifted(case)).flatten());
    }
    // Light at a few pixels comes from their edges, too.
    let pixels = case.of_same_object().len() as f64;
    let is_bright = light::lit(case).is_some_and(|lit| {
        light::middle(&lit) >= DIM * usual && lit.len() as f64 >= FEWEST_LIT * pixels
    });
    let by_light = is_bright.then(|| light::light(case)).flatten();
    found.extend(by_light.map(|(found, _)| found));
    found
}

/// Channels that hold NaN where the reference has numbers.
fn not_numbers(case: &Case) -> Option<Diagnosis> {
    let pixels = case.pixels();
    let [r, c] = case.pair.map(|picture| &picture.layers);
    let names = r.channels.iter().map(|channel| channel.name.as_str());
    let lost = |name: &&str| {
        let planes = [r, c].map(|layers| Plane::find(layers, name));
        let [Some(r), Some(c)] = planes else {
            return false;
        };
        let there = pixels.iter().filter(|i| r.at(**i).is_finite());
        let (all, lost) = there.fold((0usize, 0usize), |(all, lost), i| {
            (all + 1, lost + usize::from(!c.at(*i).is_finite()))
        });
        all >= FEWEST && lost as f64 >= MOST * all as f64
    };
    // Standard errors do not exist for single samples.
    let names = names.filter(|name| is_auxiliary(name) && !name.starts_with("standard_error"));
    let names: Vec<&str> = names.filter(lost).collect();
    (!names.is_empty()).then(|| Diagnosis {
        kind: Kind::NotANumber,
        what: format!("there are no numbers in {}", names.join(", ")).into(),
        evidence: vec![(PIXELS, pixels.len() as f64)],
    })
}
