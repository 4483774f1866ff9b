//! Displacements of one triangle or one object only; missing objects.

use std::collections::BTreeMap;

use glam::DVec2;
use rayon::prelude::*;

use super::super::geometry::Field;
use super::super::points::{FEWEST_OF_OBJECT, around};
use super::{Case, Diagnosis, FEWEST, Kind, MOST, camera, median, motion};

/// The smallest notable displacement, pixels.
const NOTABLE_DISPLACEMENT: f64 = 0.1;
/// The least ratio of mean to rms displacement for a part to be displaced as a whole.
const COHERENT: f64 = 0.5;
/// The largest fraction of the pixels with surfaces that a part may cover.
const LARGEST_PART: f64 = 0.5;

/// Displacements on one part of the picture.
#[derive(Debug, Default)]
struct Part {
    square: f64,
    displacements: Vec<DVec2>,
}

/// One triangle, or one object, that is not where it should be.
pub(super) fn displaced(case: &Case) -> Option<Diagnosis> {
    let by_points = case.field.and_then(|field| localised(case, field));
    // Positions in a known scene are exact; those on triangles seen at a grazing angle depend on few pixels.
    if let Some(Field::Known(..)) = case.field {
        return by_points;
    }
    by_points.or_else(|| localised(case, &Field::on_triangles(&case.points)?))
}

/// The smallest fraction of the picture where surfaces are shown that the reference does not show, and the fraction of its empty pixels
/// from which their index is taken for a mark of no hit.
const NOTABLE_PART: f64 = 0.01;
const MARKS: f64 = 0.95;

/// Surfaces where the reference shows none, but for rims, where samples elsewhere may hit what is beside.
pub(super) fn invented(case: &Case) -> Option<Diagnosis> {
    let [r, c] = &case.points;
    let (_, _) = (r.object?, c.object?);
    let size = r.size();
    let is_empty = |i: usize| r.object_at(i).is_some_and(|id| id < 0.0);
    let all = case.everywhere().iter().copied();
    let empty: Vec<usize> = all
        .filter(|i| is_empty(*i) && around(size, *i).all(is_empty))
        .collect();
    let mut counts = BTreeMap::<i64, usize>::new();
    for id in empty.iter().filter_map(|i| c.object_at(*i)) {
        if id >= 0.0 {
            *counts.entry(id as i64).or_default() += 1;
        }
    }
    let count: usize = counts.values().sum();
    let is_notable = count >= FEWEST && count as f64 >= NOTABLE_PART * (size[0] * size[1]) as f64;
    is_notable.then_some(())?;
    let (object, most) = counts.into_iter().max_by_key(|(_, n)| *n)?;
    let what = match most as f64 >= MARKS * empty.len() as f64 {
        true => format!(
            "object {object} is shown wherever the reference shows nothing: if {object} marks no hit, write −1 instead, as {object} is an object"
        ),
        false => format!(
            "surfaces are shown at {:.1} % of the pixels at which the reference shows nothing, most of them of object {object}",
            100.0 * count as f64 / empty.len() as f64
        ),
    };
    Some(Diagnosis {
        kind: Kind::SurfacesInvented,
        what: what.into(),
        evidence: vec![("pixels", count as f64)],
    })
}

/// An upper bound on the displacement, in pixels, by samples elsewhere in pixels.
const SAMPLED: f64 = 1.0;

/// Objects whose points, in a known scene, are not seen where the candidate shows them, whether or not the reference shows the object
/// there; or the camera that explains this. Empty if this is the case for all objects: then no object is to blame.
pub(super) fn misplaced(case: &Case) -> Vec<Diagnosis> {
    let (Some(known), [_, points]) = (case.known, &case.points) else {
        return Vec::new();
    };
    let [width, _] = points.size();
    let off = |i: &usize| {
        (!case.is_mixed(*i)).then_some(())?;
        let (object, p) = known.point(points, *i)?;
        let centre = DVec2::new((i % width) as f64 + 0.5, (i / width) as f64 + 0.5);
        // A point that is not seen counts as the width of the picture away.
        let off = known.film_point(object, p);
        let off = off.map_or(width as f64, |seen| (seen - centre).length());
        Some((object, off))
    };
    let all: Vec<(usize, f64)> = case.everywhere().par_iter().filter_map(off).collect();
    let mut objects: BTreeMap<usize, Vec<f64>> = BTreeMap::new();
    for (object, off) in all {
        objects.entry(object).or_default().push(off);
    }
    objects.retain(|_, off| off.len() >= FEWEST);
    let count = objects.len();
    let medians = objects
        .into_iter()
        .filter_map(|(object, off)| Some((object, off.len(), median(off)?)));
    let found: Vec<_> = medians.filter(|(.., off)| *off > SAMPLED).collect();
    if let Some(found) = (!found.is_empty())
        .then(|| camera::of_samples(case))
        .flatten()
    {
        return vec![found];
    }
    if found.len() == count {
        return Vec::new();
    }
    let describe = |(object, pixels, off): (usize, usize, f64)| {
        Diagnosis {
        kind: Kind::ObjectElsewhere,
        what: format!(
            "object {object} is elsewhere, has another velocity, or triangles that are too large: half of its points are shown {off:.1} pixels or more from where they should be seen"
        ).into(),
        evidence: vec![
            ("median displacement (pixels)", off),
            ("pixels", pixels as f64),
        ],
    }
    };
    found.into_iter().map(describe).collect()
}

/// Objects of the reference that no pixel of the candidate shows, and what may have moved them out of view.
pub(super) fn vanished(case: &Case) -> Vec<(usize, Diagnosis)> {
    let [r, c] = &case.points;
    let mut pixels: BTreeMap<i64, [u64; 2]> = BTreeMap::new();
    let mut pairs: BTreeMap<[i64; 2], u64> = BTreeMap::new();
    for i in case.region.pixels(r.size()) {
        let (Some(in_r), Some(in_c)) = (r.object_at(i), c.object_at(i)) else {
            return Vec::new();
        };
        let both = [in_r, in_c].map(|object| object as i64);
        *pairs.entry(both).or_default() += 1;
        for (which, object) in both.into_iter().enumerate() {
            if object >= 0 {
                pixels.entry(object).or_default()[which] += 1;
            }
        }
    }
    let is_gone = |[in_r, in_c]: &[u64; 2]| *in_r >= FEWEST_OF_OBJECT && *in_c == 0;
    let gone = pixels.iter().filter(|(_, pixels)| is_gone(pixels));
    // Another object that is shown at most of these pixels, and not where it should be.
    let hides = |object: i64, other: i64, count: u64| {
        let at = |pair| pairs.get(&pair).copied().unwrap_or(0);
        let is_displaced = 2 * at([other, other]) < pixels[&other][1];
        (other >= 0 && 2 * at([object, other]) >= count && is_displaced).then(|| {
            format!("; object {other} is shown at most of these, where it should not be, and may hide it")
        })
    };
    let describe = |(object, [count, _]): (&i64, &[u64; 2])| {
        let hidden = pixels
            .keys()
            .find_map(|other| hides(*object, *other, *count));
        let why = motion::out_of_view(case, *object as usize);
        let or = match why.is_empty() {
            true => String::new(),
            false => format!("; it would be out of view, too, by {}", why.join(", or ")),
        };
        let or = hidden.unwrap_or_default() + &or;
        let diagnosis = Diagnosis {
            kind: Kind::ObjectMissing,
            what: format!(
                "object {object} is missing: the reference shows it at {count} pixels, the candidate nowhere{or}"
            ).into(),
            evidence: vec![("pixels", *count as f64)],
        };
        (*object as usize, diagnosis)
    };
    gone.map(describe).collect()
}

/// A triangle, or otherwise an object, with nearly all of the squared displacement.
fn localised(case: &Case, field: &Field) -> Option<Diagnosis> {
    let pixels = case.pixels();
    let [mut triangles, mut objects] = [BTreeMap::<_, Part>::new(), BTreeMap::new()];
    let points = &case.points[0];
    let mut total = 0.0;
    for &i in pixels {
        let Some(d) = field.displacement(i) else {
            continue;
        };
        let object = points.object_at(i).unwrap_or(-1.0) as i64;
        let triangle = points.primitive.map_or(-1, |p| p.at(i) as i64);
        total += d.length_squared();
        for part in [
            triangles.entry((object, triangle)).or_default(),
            objects.entry((object, -1)).or_default(),
        ] {
            part.square += d.length_squared();
            part.displacements.push(d);
        }
    }
    let has_triangles = points.primitive.is_some();
    let triangle = worst(&triangles, total, pixels.len()).filter(|_| has_triangles);
    let object = worst(&objects, total, pixels.len());
    let (kind, place, named, part) = match triangle {
        Some(((object, triangle), part)) => {
            let place = format!("triangle {triangle} of object {object}");
            (Kind::TriangleDisplaced, place, object, part)
        }
        None => {
            let ((object, _), part) = object?;
            let place = format!("object {object}");
            (Kind::ObjectDisplaced, place, object, part)
        }
    };
    // A smaller displacement of a smaller object may be a mistake, too.
    let off = |part: &Part| {
        let off = median(part.displacements.iter().map(|d| d.length()).collect());
        let is_enough = part.displacements.len() as u64 >= FEWEST_OF_OBJECT;
        off.filter(|off| is_enough && *off > NOTABLE_DISPLACEMENT)
    };
    let others = objects.iter().filter(|((object, _), _)| *object != named);
    let others = others.filter_map(|((object, _), part)| {
        Some(format!(
            "object {object} by {:.2} pixels at half of its points",
            off(part)?
        ))
    });
    let others: Vec<String> = others.collect();
    let rest = match others.is_empty() {
        true => "the rest is where it should be".into(),
        false => others.join(", "),
    };
    describe_part(kind, &place, part, total, &rest)
}

type Name = (i64, i64);

/// The part with most of the displacement and little of the picture.
fn worst(parts: &BTreeMap<Name, Part>, total: f64, pixels: usize) -> Option<(Name, &Part)> {
    let (name, part) = parts
        .iter()
        .max_by(|a, b| a.1.square.total_cmp(&b.1.square))?;
    let count = part.displacements.len() as f64;
    let is_part = part.displacements.len() >= FEWEST && count <= LARGEST_PART * pixels as f64;
    let mean = part.displacements.iter().sum::<DVec2>() / count;
    let coherent = mean.length() >= COHERENT * (part.square / count).sqrt();
    (is_part && coherent && part.square >= MOST * total).then_some((*name, part))
}

fn describe_part(
    kind: Kind,
    place: &str,
    part: &Part,
    total: f64,
    rest: &str,
) -> Option<Diagnosis> {
    let middle = |of: fn(&DVec2) -> f64| median(part.displacements.iter().map(of).collect());
    // A point that belongs to the right is seen displaced to the left.
    let [x, y, length] = [
        middle(|d| -d.x)?,
        middle(|d| -d.y)?,
        middle(|d| d.length())?,
    ];
    (length > NOTABLE_DISPLACEMENT).then(|| Diagnosis {
        kind,
        what: format!("{place} is displaced by {length:.2} pixels, ({x:+.2}, {y:+.2}) to the right and down; {rest}").into(),
        evidence: vec![
            ("median displacement (pixels)", length),
            ("share of the displacement", part.square / total),
            ("pixels", part.displacements.len() as f64),
        ],
    })
}
