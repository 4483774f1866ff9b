//! Pictures that are mirrored, rotated, or shifted by whole pixels.
//!
//! The candidate is mirrored, rotated or shifted, and compared again by its objects, positions and light, if available. The measure is the
//! largest of their fractions of pixels that differ by more than one percent, with light and positions up to the most common factor, and
//! objects up to renaming, because a picture with another exposure, in millimetres, or with indices from 1 may be turned, too. Panoramas
//! are also moved around their edge by quarters of their width: conventions differ in what is in the middle. Exchanged eyes of a stereo
//! pair are such a move by half of the width.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;
use rayon::prelude::*;

use super::super::picture::{Plane, RADIANCE};
use super::super::points::{Points, place};
use super::film::{BOTH, LEFT_RIGHT, OR_CAMERA, UP_DOWN};
use super::registration::Blurred;
use super::{ASKED, Case, Diagnosis, Kind, NEAR, light, median, spread};
use crate::scene::model::ProjectionKind;

/// A way to mirror, rotate or shift a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Turn {
    LeftRight,
    UpDown,
    Both,
    Diagonal,
    Moved([i64; 2]),
    /// Around the edge by quarters of the width, mirrored or not.
    Around {
        quarters: i64,
        mirrored: bool,
    },
    /// The halves of a stereo pair.
    Eyes,
}

impl Turn {
    /// The candidate's pixel that belongs at column x and row y.
    fn source(self, [x, y]: [i64; 2], [width, height]: [i64; 2]) -> Option<usize> {
        let [x, y] = match self {
            Turn::LeftRight => [width - 1 - x, y],
            Turn::UpDown => [x, height - 1 - y],
            Turn::Both => [width - 1 - x, height - 1 - y],
            Turn::Diagonal => [y, x],
            Turn::Moved([dx, dy]) => [x + dx, y + dy],
            Turn::Around { quarters, mirrored } => {
                let x = if mirrored { width - 1 - x } else { x };
                [(x + quarters * width / 4).rem_euclid(width), y]
            }
            Turn::Eyes => [(x + width / 2).rem_euclid(width), y],
        };
        let inside = (0..width).contains(&x) && (0..height).contains(&y);
        inside.then(|| (y * width + x) as usize)
    }

    /// The diagnosis of this turn, with the dissimilarity before and after it is undone.
    fn describe(self, before: Unlike, after: Unlike) -> Diagnosis {
        let (kind, mut what) = match self {
            Turn::LeftRight => (Kind::Mirrored, LEFT_RIGHT.into()),
            Turn::UpDown => (Kind::Mirrored, UP_DOWN.into()),
            Turn::Both => (Kind::Mirrored, BOTH.into()),
            Turn::Diagonal => (
                Kind::Mirrored,
                "rows and columns of the picture are exchanged".into(),
            ),
            Turn::Moved([dx, dy]) => (
                Kind::FilmShifted,
                format!("the picture is moved by ({dx:+}, {dy:+}) pixels to the right and down"),
            ),
            Turn::Around { quarters, mirrored } => {
                let moved = format!(
                    "moved around its edge by {} degrees to the right",
                    90 * quarters
                );
                match mirrored {
                    true => (Kind::Mirrored, format!("{LEFT_RIGHT}, and {moved}")),
                    false => (Kind::FilmShifted, format!("the panorama is {moved}")),
                }
            }
            Turn::Eyes => (
                Kind::EyesExchanged,
                "the pictures of the left and the right eye are exchanged".into(),
            ),
        };
        if (after.factor - 1.0).abs() > SAME {
            what += &light::beside(after.factor);
        }
        if after.by_light_alone && after.part > EXACT && matches!(self, Turn::Moved(_)) {
            what += OR_CAMERA;
        }
        let evidence = vec![
            ("part of the pixels that differ", before.part),
            ("the same after undoing it", after.part),
        ];
        Diagnosis {
            kind,
            what: what.into(),
            evidence,
        }
    }
}

/// The dissimilarity of two pictures.
#[derive(Debug, Clone, Copy)]
struct Unlike {
    /// The fraction of pixels that differ: the largest of objects, positions and light.
    part: f64,
    /// The factor of the candidate's light on the reference's.
    factor: f64,
    /// Whether neither objects nor positions were compared.
    by_light_alone: bool,
}

/// Pictures that differ at a smaller fraction of pixels are alike.
const ALIKE: f64 = 0.02;
/// The fraction of pixels that may differ after a shift by whole pixels, which leaves none: a camera that is turned a little leaves some.
const EXACT: f64 = 1e-3;
/// Relative tolerance for equal values.
const SAME: f64 = 0.01;
/// The largest shift to try, pixels.
const FARTHEST: i64 = 2;

/// The fraction of some pixels that differ, relative to that before the turn, above which a turn is given up: three times what is accepted
/// for all.
const MAY_BE: f64 = 3.0 * NEAR;

/// A candidate that is mirrored, rotated, or shifted by whole pixels.
pub(super) fn turned(case: &Case) -> Option<Diagnosis> {
    let all = case.everywhere();
    let before = differing(case, all, Turn::Moved([0, 0]));
    if before.part <= ALIKE {
        return None;
    }
    let steps = -FARTHEST..=FARTHEST;
    let moves = steps
        .clone()
        .flat_map(|dy| steps.clone().map(move |dx| [dx, dy]));
    let moves = moves.filter(|step| *step != [0, 0]).map(Turn::Moved);
    // A turn that leaves more of some pixels than this leaves too much of all.
    let few: Vec<usize> = spread(all.len(), ASKED).map(|at| all[at]).collect();
    let may_be = |turn: &Turn| differing(case, &few, *turn).part <= MAY_BE * before.part;
    let tried = mirrors_and_quarters(case).chain(moves).filter(may_be);
    let tried = tried.map(|turn| (turn, differing(case, all, turn)));
    let best = tried.min_by(|a, b| a.1.part.total_cmp(&b.1.part));
    match best {
        Some((turn, after)) if after.part <= NEAR * before.part => {
            Some(turn.describe(before, after))
        }
        // Two films that differ by a turn of a panorama are not those of another camera.
        _ if is_panorama(case) => turned_by_light(case).map(|(found, _)| found),
        _ => None,
    }
}

/// The fraction of the squared error of blurred light that may be left after a turn.
const LEFT_BY_TURN: f64 = 0.1;

/// A candidate with other samples than the reference that is mirrored, or moved around the edge of a panorama: then all pixels at edges
/// and of textures differ, and the squared error of blurred light tells.
pub(super) fn turned_by_light(case: &Case) -> Option<(Diagnosis, f64)> {
    let [width, height] = case.points[0].size();
    let size = [width, height].map(|n| n as i64);
    let blurred = Blurred::of(case)?;
    let error =
        |turn: Turn| blurred.error(|i| turn.source([i as i64 % size[0], i as i64 / size[0]], size));
    let before = error(Turn::Moved([0, 0]));
    let turns = mirrors_and_quarters(case).map(|turn| (turn, error(turn) / before));
    let (turn, left) = turns.min_by(|a, b| a.1.total_cmp(&b.1))?;
    (before > 0.0 && left <= LEFT_BY_TURN).then(|| {
        let same = |part| Unlike {
            part,
            factor: 1.0,
            by_light_alone: true,
        };
        let mut found = turn.describe(same(1.0), same(left));
        found.evidence = vec![("what it leaves of the squared error of light", left)];
        (found, left)
    })
}

/// All turns but small shifts.
fn mirrors_and_quarters(case: &Case) -> impl Iterator<Item = Turn> {
    let [width, height] = case.points[0].size();
    let mirrors = [Turn::LeftRight, Turn::UpDown, Turn::Both];
    let diagonal = (width == height).then_some(Turn::Diagonal);
    let around = [1, 2, 3]
        .into_iter()
        .flat_map(|quarters| [false, true].map(|mirrored| Turn::Around { quarters, mirrored }));
    let is_around = is_panorama(case);
    let eyes = case.is_stereo_pair().then_some(Turn::Eyes);
    let around = around.filter(move |_| is_around);
    mirrors
        .into_iter()
        .chain(diagonal)
        .chain(around)
        .chain(eyes)
}

/// Whether the reference is a panorama of the whole sphere, by its metadata, or else by its shape.
fn is_panorama(case: &Case) -> bool {
    let [width, height] = case.points[0].size();
    let projection = case.pair[0].metadata("camera_projection");
    let has_camera = case.pair[0].metadata("camera_forward").is_some();
    let is_meant = match projection {
        Some(name) => name == ProjectionKind::Equirectangular.name(),
        None => !has_camera,
    };
    is_meant && width == 2 * height
}

/// The dissimilarity of the pictures at these pixels of the reference after the candidate is turned back.
fn differing(case: &Case, pixels: &[usize], turn: Turn) -> Unlike {
    let [r, c] = &case.points;
    let size = r.size().map(|n| n as i64);
    let pixels: Vec<[usize; 2]> = (pixels.par_iter())
        .filter_map(|&i| {
            let at = [i as i64 % size[0], i as i64 / size[0]];
            Some([i, turn.source(at, size)?])
        })
        .collect();
    let part = |differs: &(dyn Fn(usize, usize) -> bool + Sync)| {
        let count = pixels.par_iter().filter(|[i, j]| differs(*i, *j)).count();
        count as f64 / pixels.len().max(1) as f64
    };
    let mut worst: f64 = 0.0;
    let mut by_light_alone = true;
    if r.object.is_some() && c.object.is_some() {
        by_light_alone = false;
        let names = renamed(&pixels, &case.points);
        let name = |i: usize| r.object_at(i).map(|id| names.get(&(id as i64)).copied());
        let shown = |j: usize| c.object_at(j).map(|id| Some(id as i64));
        worst = part(&|i, j| name(i) != shown(j));
    }
    for planes in [[r.material, c.material], [r.world, c.world]] {
        if let [Some(r), Some(c)] = planes {
            by_light_alone = false;
            let ratios = pixels.par_iter();
            let ratios = ratios.map(|[i, j]| place(&c, *j).length() / place(&r, *i).length());
            let unit = common_factor(ratios);
            worst = worst.max(part(&|i, j| differ(place(&r, i) * unit, place(&c, j))));
        }
    }
    let mut factor = 1.0;
    if let [Some(r), Some(c)] = [light(case, 0), light(case, 1)] {
        let sum = |of: &[Plane; 3], i: usize| of.iter().map(|p| p.at(i)).sum::<f64>();
        let ratios = pixels.par_iter();
        let ratios = ratios.map(|[i, j]| sum(&c, *j) / sum(&r, *i));
        factor = common_factor(ratios);
        worst = worst.max(part(&|i, j| differ(place(&r, i) * factor, place(&c, j))));
    }
    Unlike {
        part: worst,
        factor,
        by_light_alone,
    }
}

/// The most common factor.
fn common_factor(ratios: impl ParallelIterator<Item = f64>) -> f64 {
    let ratios = ratios.filter(|ratio| ratio.is_normal() && *ratio > 0.0);
    let factor = median(ratios.collect()).unwrap_or(1.0);
    // Noise is not a factor.
    match (factor - 1.0).abs() <= SAME {
        true => 1.0,
        false => factor,
    }
}

/// The candidate's indices of the reference's objects, and of no object, at pairs of pixels: the most frequent ones, if no two are equal;
/// otherwise the reference's own.
fn renamed(pixels: &[[usize; 2]], [r, c]: &[Points; 2]) -> BTreeMap<i64, i64> {
    let mut counts = BTreeMap::<[i64; 2], u64>::new();
    for [i, j] in pixels {
        if let (Some(in_r), Some(in_c)) = (r.object_at(*i), c.object_at(*j)) {
            *counts.entry([in_r as i64, in_c as i64]).or_default() += 1;
        }
    }
    let mut most = BTreeMap::<i64, (u64, i64)>::new();
    // No object remains no object, if any pixel has none.
    let has_nothing = counts.keys().any(|[_, in_c]| *in_c < 0);
    for ([in_r, in_c], count) in counts {
        if has_nothing && (in_r < 0) != (in_c < 0) {
            continue;
        }
        let found = most.entry(in_r).or_default();
        if count > found.0 {
            *found = (count, in_c);
        }
    }
    let names: BTreeMap<i64, i64> = most.into_iter().map(|(r, (_, c))| (r, c)).collect();
    let different: BTreeSet<i64> = names.values().copied().collect();
    match different.len() == names.len() {
        true => names,
        false => names.into_keys().map(|r| (r, r)).collect(),
    }
}

fn light<'a>(case: &Case<'a>, which: usize) -> Option<[Plane<'a>; 3]> {
    Plane::group(&case.pair[which].layers, RADIANCE)
}

/// Whether three values differ by more than rounding and slight noise.
fn differ(r: DVec3, c: DVec3) -> bool {
    match (r.is_finite(), c.is_finite()) {
        (true, true) => (c - r).length() > SAME * r.length().max(c.length()),
        (a, b) => a != b,
    }
}
