//! Mistakes of single channels: indices, axes, units, texture coordinates.

use std::borrow::Cow;
use std::collections::BTreeMap;

use glam::DVec3;
use rayon::prelude::*;

use super::super::picture::Plane;
use super::super::points::place;
use super::{Case, Diagnosis, Kind, Tally, frames, median, motion, normals, time};
use crate::render::aov::Aov;
use crate::spacetime::SPEED_OF_LIGHT;

/// The fraction of an object's pixels at which a renamed index must appear in the candidate.
const ALMOST_ALL: f64 = 0.95;

/// Indices of objects, or of triangles, that count from 1 or are exchanged.
pub(super) fn identities(case: &Case) -> Option<Diagnosis> {
    let names = ["objects", "triangles"];
    let planes = [
        [case.points[0].object, case.points[1].object],
        [case.points[0].primitive, case.points[1].primitive],
    ];
    let found = |(name, planes): (&'static str, [Option<Plane>; 2])| renamed(case, name, planes);
    names.into_iter().zip(planes).find_map(found)
}

fn renamed(case: &Case, name: &'static str, [r, c]: [Option<Plane>; 2]) -> Option<Diagnosis> {
    let (r, c) = (r?, c?);
    let id = |plane: &Plane, i: usize| match plane.at(i) {
        // Markers of no hit: NaN, and −1 as an unsigned number.
        id if id.is_nan() || id >= 4_294_967_295.0 => -1,
        id => id as i64,
    };
    let mut names: BTreeMap<i64, BTreeMap<i64, u64>> = BTreeMap::new();
    for i in case.region.pixels(case.points[0].size()) {
        *names
            .entry(id(&r, i))
            .or_default()
            .entry(id(&c, i))
            .or_default() += 1;
    }
    let nothing = names.remove(&-1);
    let total: u64 = names.values().flat_map(BTreeMap::values).sum();
    let count = |of: &dyn Fn(i64) -> i64| -> f64 {
        let counts = names
            .iter()
            .map(|(r, c)| c.get(&of(*r)).copied().unwrap_or(0));
        counts.sum::<u64>() as f64 / total.max(1) as f64
    };
    let right = count(&|r| r);
    if total < super::FEWEST as u64 {
        return None;
    }
    // Each index is mapped to one other, and no two to the same.
    let most = |c: &BTreeMap<i64, u64>| c.iter().max_by_key(|(_, n)| **n).map(|(id, _)| *id);
    let map: BTreeMap<i64, i64> = names
        .iter()
        .filter_map(|(r, c)| Some((*r, most(c)?)))
        .collect();
    let mut targets: Vec<i64> = map.values().copied().collect();
    targets.sort_unstable();
    targets.dedup();
    let changes: Vec<(i64, i64)> = map
        .iter()
        .filter(|(r, c)| r != c)
        .map(|(r, c)| (*r, *c))
        .collect();
    // Almost all pixels of each object.
    let agrees = |(r, c): &(i64, i64)| {
        let all: u64 = names[r].values().sum();
        names[r][c] as f64 >= ALMOST_ALL * all as f64
    };
    let unique = targets.len() == map.len() && !targets.contains(&-1);
    // Small objects may be exchanged, too, if nearly all of the rest is right.
    let is_small = |(r, _): &(i64, i64)| names[r].values().sum::<u64>() < super::FEWEST as u64;
    if right >= ALMOST_ALL && (changes.is_empty() || changes.iter().any(is_small)) {
        return None;
    }
    let is_exchange =
        name == "objects" && unique && changes.len() > 1 && changes.iter().all(agrees);
    let one_based = count(&|r| r + 1);
    let exchanged = count(&|r| map[&r]);
    // For an object that fills the picture, both explain almost all pixels.
    if right < ALMOST_ALL && one_based >= ALMOST_ALL && !(is_exchange && exchanged > one_based) {
        let zero = nothing.is_some_and(|c| c.contains_key(&0));
        let at = if zero { ", and 0 marks no hit" } else { "" };
        return Some(Diagnosis {
            kind: Kind::IdentitiesOneBased,
            what: format!("indices of {name} count from 1 and should count from 0{at}").into(),
            evidence: vec![("part of the pixels with surfaces", one_based)],
        });
    }
    let words = changes.iter().take(6).map(|(r, c)| format!("{c} for {r}"));
    is_exchange.then(|| Diagnosis {
        kind: Kind::IdentitiesSwapped,
        what: format!(
            "indices of {name} are exchanged: {}",
            words.collect::<Vec<_>>().join(", ")
        )
        .into(),
        evidence: vec![("part of the pixels with surfaces", exchanged)],
    })
}

/// Coordinates: axes, directions, units.
pub(super) fn coordinates(case: &Case) -> Vec<Diagnosis> {
    let mut found: Vec<Diagnosis> = Vec::new();
    for (name, planes) in vectors(case) {
        let [Some(r), Some(c)] = planes else { continue };
        let is_length = name != "direction" && name != "normal";
        let scaled = is_length.then(|| scale(case, name, &r, &c)).flatten();
        let pixels = match name == "normal" && found.is_empty() {
            true => same_places(case).into(),
            false => Cow::Borrowed(pixels_of(case, name)),
        };
        found.extend(scaled.or_else(|| axes(&pixels, name, &r, &c)));
    }
    found.extend(scale_of(case, Aov::Distance));
    // At a shot at ct = 0, light that arrives from the future comes from times of the opposite sign, but from other places, too.
    let signs = || match motion::of_all(case) {
        Some(_) => Vec::new(),
        None => frames::signs(case),
    };
    // Times that hardly vary look shifted and scaled alike: a shift takes precedence.
    if time::shifted(case).is_none() {
        found.extend(scales_of_times(case, &found));
        found.extend(signs());
    } else {
        found.extend(signs().into_iter().filter(leaves_nothing));
    }
    if found.is_empty() {
        found.extend(frames::frames(case));
        found.extend(normals::normals(case));
    }
    found
}

/// Whether a sign explains times to rounding; a shift of varying times cannot.
fn leaves_nothing(found: &Diagnosis) -> bool {
    let sizes: Vec<f64> = found.evidence.iter().map(|(_, size)| *size).collect();
    matches!(sizes[..], [error, rest] if rest <= 1e-6 * error)
}

type Planes<'a> = Option<[Plane<'a>; 3]>;

fn vectors<'a>(case: &Case<'a>) -> [(&'static str, [Planes<'a>; 2]); 4] {
    let normal = [Aov::NormalX, Aov::NormalY, Aov::NormalZ];
    [
        ("event", case.points.map(|p| p.world)),
        ("object_event", case.points.map(|p| p.material)),
        ("direction", case.points.map(|p| p.direction)),
        ("normal", case.pair.map(|p| Plane::aovs(&p.layers, normal))),
    ]
}

/// The pixels at which a vector of this name is compared.
fn pixels_of<'a>(case: &'a Case, name: &str) -> &'a [usize] {
    match name {
        "direction" => case.everywhere(),
        _ => case.pixels(),
    }
}

/// Pixels known to show the same position in both pictures, on the film and along the ray, because normals differ elsewhere. All pixels if
/// nothing is known.
pub(super) fn same_places(case: &Case) -> Vec<usize> {
    let pixels = case.pixels().par_iter().copied();
    let is_same = |i: &usize| case.field.is_none_or(|field| field.is_at_place(*i));
    pixels.filter(is_same).collect()
}

/// The six orders of x, y and z.
const ORDERS: [[usize; 3]; 6] = [
    [0, 1, 2],
    [0, 2, 1],
    [1, 0, 2],
    [1, 2, 0],
    [2, 0, 1],
    [2, 1, 0],
];

/// The candidate's coordinates are permuted, or negated.
fn axes(pixels: &[usize], name: &'static str, r: &[Plane; 3], c: &[Plane; 3]) -> Option<Diagnosis> {
    let lengths = pixels.par_iter().map(|i| place(r, *i).length());
    let scale = median(lengths.filter(|l| l.is_finite()).collect())?;
    let apart = |i: usize| Some([(place(c, i) - place(r, i)).length(), 0.0]);
    let error = Tally::of_all(pixels, apart).error();
    // Right to a twentieth of the rms distance: nothing to explain.
    if error <= 0.05 * scale {
        return None;
    }
    let mut best: Option<([usize; 3], DVec3, Tally)> = None;
    // All 48 ways to permute and mirror axes.
    for order in ORDERS {
        // For flat faces several fit equally: prefer that all are reversed.
        let all_first = u32::from(order == ORDERS[0]) * 7;
        for signs in (0..8u32).map(|signs| signs ^ all_first) {
            let sign = |axis: u32| if signs >> axis & 1 == 1 { -1.0 } else { 1.0 };
            let signs = DVec3::new(sign(0), sign(1), sign(2));
            let tally = Tally::of_pixels(pixels, |i| {
                let (r, c) = (place(r, i), place(c, i));
                let turned = DVec3::from(order.map(|axis| r[axis])) * signs;
                Some([(c - r).length(), (c - turned).length()])
            });
            let better = best
                .as_ref()
                .is_none_or(|(.., found)| tally.is_better_than(found));
            if tally.explains(0.05 * scale) && better {
                best = Some((order, signs, tally));
            }
        }
    }
    let (order, signs, tally) = best?;
    let letters = ["x", "y", "z"];
    let words: Vec<String> = (0..3)
        .map(|k| {
            format!(
                "{}{}",
                if signs[k] < 0.0 { "−" } else { "" },
                letters[order[k]]
            )
        })
        .collect();
    let reversed = order == ORDERS[0] && signs == DVec3::NEG_ONE && name == "direction";
    let normals = order == ORDERS[0] && signs == DVec3::NEG_ONE && name == "normal";
    let (kind, what) = match (reversed, normals) {
        (true, _) => (
            Kind::DirectionsReversed,
            "look directions are reversed: they point along the light and should point out of the camera".into(),
        ),
        (_, true) => (
            Kind::AxesExchanged,
            "normals are reversed: they point to the other side of their surfaces".into(),
        ),
        _ => (
            Kind::AxesExchanged,
            format!("axes of {name} are exchanged: (x, y, z) holds ({})", words.join(", ")),
        ),
    };
    Some(Diagnosis {
        kind,
        what: what.into(),
        evidence: vec![
            ("vectors differ from the reference by (rms)", tally.error()),
            ("and from the hypothesis by (rms)", tally.rest()),
        ],
    })
}

/// Whether look directions have exchanged axes.
pub(super) fn has_other_axes(case: &Case) -> bool {
    let [r, c] = case.points.map(|points| points.direction);
    let found = r
        .zip(c)
        .and_then(|(r, c)| axes(case.everywhere(), "direction", &r, &c));
    found.is_some()
}

/// Events whose four components are in another order: the time last, or anywhere but first.
pub(super) fn order_of_events(case: &Case) -> Option<Diagnosis> {
    const ORDERS: [([usize; 4], &str); 3] = [
        ([1, 2, 3, 0], "x, y, z, ct"),
        ([1, 0, 2, 3], "x, ct, y, z"),
        ([1, 2, 0, 3], "x, y, ct, z"),
    ];
    let events = |which: usize| {
        let time = Plane::aov(&case.pair[which].layers, Aov::EventCt)?;
        Some((time, case.points[which].world?))
    };
    let ((r_time, r), (c_time, c)) = (events(0)?, events(1)?);
    let event = |time: &Plane, place: &[Plane; 3], i: usize| {
        let [x, y, z] = place.each_ref().map(|p| p.at(i));
        [time.at(i), x, y, z]
    };
    let pixels = case.pixels();
    let distance = |a: [f64; 4], b: [f64; 4]| {
        let squares = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b));
        squares.sum::<f64>().sqrt()
    };
    let found = ORDERS.map(|(order, words)| {
        let tally = Tally::of_pixels(pixels, |i| {
            let (r, c) = (event(&r_time, &r, i), event(&c_time, &c, i));
            Some([distance(c, r), distance(c, order.map(|k| r[k]))])
        });
        (tally, words)
    });
    let explaining = found.into_iter().filter(|(tally, _)| tally.explains(0.0));
    let best = explaining.reduce(|a, b| if b.0.is_better_than(&a.0) { b } else { a });
    let (tally, words) = best?;
    Some(Diagnosis {
        kind: Kind::AxesExchanged,
        what: format!("the numbers of event are in another order: (ct, x, y, z) holds ({words})")
            .into(),
        evidence: vec![
            (
                "events differ from the reference by (m, rms)",
                tally.error(),
            ),
            ("and from the hypothesis by (m, rms)", tally.rest()),
        ],
    })
}

/// Places in another known unit.
pub(super) fn units_of_places(case: &Case) -> Vec<Diagnosis> {
    let lengths = vectors(case)
        .into_iter()
        .filter(|(name, _)| *name != "direction" && *name != "normal");
    let scaled = lengths.filter_map(|(name, [r, c])| scale(case, name, &r?, &c?));
    scaled.filter(is_unit).collect()
}

/// Lengths and times in another known unit.
pub(super) fn units(case: &Case) -> Vec<Diagnosis> {
    let mut found = units_of_places(case);
    let mut others: Vec<Diagnosis> = scale_of(case, Aov::Distance).into_iter().collect();
    others.extend(scales_of_times(case, &found));
    found.extend(others.into_iter().filter(is_unit));
    found
}

/// Times in another unit, but for those of events whose places are `found` to be in the same: that names the group.
fn scales_of_times(case: &Case, found: &[Diagnosis]) -> Vec<Diagnosis> {
    let groups = [
        (Aov::EventCt, "event"),
        (Aov::ObjectEventCt, "object_event"),
    ];
    let scaled = groups.into_iter().filter_map(|(aov, group)| {
        let of_times = scale_of(case, aov)?;
        let of_places = of_times.what.to_string().replacen(aov.name(), group, 1);
        let is_same = |found: &Diagnosis| found.what == of_places;
        (!found.iter().any(is_same)).then_some(of_times)
    });
    scaled.collect()
}

fn is_unit(found: &Diagnosis) -> bool {
    let factor = found.evidence.iter().find(|(name, _)| *name == FACTOR);
    factor.is_some_and(|(_, factor)| unit(*factor).is_some())
}

const FACTOR: &str = "factor";
/// Relative tolerance for a factor to match a unit.
const SAME_UNIT: f64 = 0.005;

/// The unit of values that are `factor` times too large.
fn unit(factor: f64) -> Option<&'static str> {
    let mut units = UNITS.iter();
    let found = units.find(|(unit, _)| (factor / unit - 1.0).abs() < SAME_UNIT);
    found.map(|(_, words)| *words)
}

/// Units of length and of light path: number per metre.
const UNITS: [(f64, &str); 9] = [
    (1e3, "in millimetres"),
    (1e2, "in centimetres"),
    (1e6, "in micrometres"),
    (1e-3, "in kilometres"),
    (1.0 / 0.3048, "in feet"),
    (1.0 / SPEED_OF_LIGHT, "in seconds"),
    (1e9 / SPEED_OF_LIGHT, "in nanoseconds"),
    (1e12 / SPEED_OF_LIGHT, "in picoseconds"),
    (1e15 / SPEED_OF_LIGHT, "in femtoseconds"),
];
/// Relative differences of the factor between pixels, by samples elsewhere in them: a pixel of a floor at a grazing angle extends over more.
/// Factors that are no unit may be other functions of the values.
const SAME_IN_UNITS: f64 = 0.05;
const SAME_FACTOR: f64 = 0.01;
/// Factors closer to 1 than this are ignored.
const NOTABLE_FACTOR: f64 = 0.02;

fn scale(case: &Case, name: &'static str, r: &[Plane; 3], c: &[Plane; 3]) -> Option<Diagnosis> {
    let pixels = case.pixels();
    let ratios = pixels.par_iter();
    let ratios = ratios.map(|&i| place(c, i).length() / place(r, i).length());
    let ratios: Vec<f64> = ratios.filter(|x| x.is_finite()).collect();
    let tally = |factor: f64| {
        Tally::of_all(pixels, |i| {
            let (r, c) = (place(r, i), place(c, i));
            Some([(c - r).length(), (c - r * factor).length()])
        })
    };
    describe_scale(name, ratios, tally)
}

fn scale_of(case: &Case, aov: Aov) -> Option<Diagnosis> {
    let [r, c] = case.pair.map(|picture| Plane::aov(&picture.layers, aov));
    let (r, c) = (r?, c?);
    let pixels = case.pixels();
    let ratios = pixels.par_iter().map(|&i| c.at(i) / r.at(i));
    let ratios: Vec<f64> = ratios.filter(|x| x.is_finite()).collect();
    let tally = |factor: f64| {
        Tally::of_all(pixels, |i| {
            let (r, c) = (r.at(i), c.at(i));
            Some([(c - r).abs(), (c - r * factor).abs()])
        })
    };
    describe_scale(aov.name(), ratios, tally)
}

/// The diagnosis of values in these ratios to the reference's, if one factor explains them.
fn describe_scale(
    name: &'static str,
    ratios: Vec<f64>,
    tally: impl Fn(f64) -> Tally,
) -> Option<Diagnosis> {
    let factor = median(ratios.clone())?;
    let notable = factor > 0.0 && (factor - 1.0).abs() > NOTABLE_FACTOR;
    notable.then_some(())?;
    let tally = tally(factor);
    tally.explains(0.0).then_some(())?;
    // Where the factor is small, so is the error that it leaves, whatever the values are: they have to be in this ratio themselves.
    let near = match unit(factor) {
        Some(_) => SAME_IN_UNITS,
        None => SAME_FACTOR,
    };
    let is_same = |ratio: &&f64| (*ratio / factor - 1.0).abs() <= near;
    let same = ratios.iter().filter(is_same).count() as f64;
    (same >= super::MOST * ratios.len() as f64).then_some(())?;
    let what = match unit(factor) {
        Some(words) => {
            format!("{name} is {words} and should be in metres (of light path, for times)")
        }
        None => format!("{name} is {factor:.6} times what it should be"),
    };
    let evidence = vec![
        (FACTOR, factor),
        ("part of the pixels with it", tally.share()),
    ];
    Some(Diagnosis {
        kind: Kind::Units,
        what: what.into(),
        evidence,
    })
}

/// Texture coordinates that run in the opposite direction.
pub(super) fn texture(case: &Case) -> Option<Diagnosis> {
    let [Some(r), Some(c)] = case
        .pair
        .map(|p| Plane::aovs(&p.layers, [Aov::UvU, Aov::UvV]))
    else {
        return None;
    };
    type Turn = fn(f64, f64) -> [f64; 2];
    let turns: [(&str, Turn); 5] = [
        (
            "v is flipped: it holds 1 − v, and v = 0 is the top row",
            |u, v| [u, 1.0 - v],
        ),
        ("u is flipped: it holds 1 − u", |u, v| [1.0 - u, v]),
        ("u and v are flipped", |u, v| [1.0 - u, 1.0 - v]),
        ("u and v are exchanged", |u, v| [v, u]),
        ("u and v are exchanged, and v is flipped", |u, v| {
            [1.0 - v, u]
        }),
    ];
    let pixels = case.pixels();
    turns.into_iter().find_map(|(words, turn)| {
        let tally = Tally::of_pixels(pixels, |i| {
            let ([u, v], [a, b]) = (r.map(|p| p.at(i)), c.map(|p| p.at(i)));
            let [x, y] = turn(u, v);
            Some([libm::hypot(a - u, b - v), libm::hypot(a - x, b - y)])
        });
        // Coordinates that are off by less than a twentieth are not flipped.
        tally.explains(0.05).then(|| Diagnosis {
            kind: Kind::TextureFlipped,
            what: format!("texture coordinate {words}").into(),
            evidence: vec![
                ("texture coordinates differ by (rms)", tally.error()),
                ("and from the hypothesis by (rms)", tally.rest()),
            ],
        })
    })
}
