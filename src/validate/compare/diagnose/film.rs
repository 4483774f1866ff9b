//! Pictures that are mirrored, shifted or scaled as a whole.
//!
//! # Mirrors and whole pixels
//!
//! The candidate is mirrored, rotated or shifted, and compared again by its objects, positions and light, if available. The measure is the
//! largest of their fractions of pixels that differ by more than one percent, with light and positions up to the most common factor, and
//! objects up to renaming, because a picture with another exposure, in millimetres, or with indices from 1 may be turned, too. Panoramas
//! are also moved around their edge by quarters of their width: conventions differ in what is in the middle. Exchanged eyes of a stereo
//! pair are such a move by half of the width.
//!
//! # Other films
//!
//! A point that the candidate shows at p belongs at p′ = p + δ(p). Two pinhole cameras of the same pose see a direction q (components
//! perpendicular to the axis over that along it) at p = c + f q, so that about the film's centre
//!
//! ```text
//! p′ = a + k p,      k = f_reference / f_candidate = tan(½ fov_candidate) / tan(½ fov_reference)
//! ```
//!
//! along each axis: a ≠ 0 is a shift, k_x = k_y ≠ 1 another field of view, k_x ≠ k_y another aspect. The four parameters are fitted by
//! least squares, twice, the second time without the tenth of the pixels that fit worst.

use std::collections::{BTreeMap, BTreeSet};

use glam::{DVec2, DVec3};

use super::super::geometry::Field;
use super::super::picture::{Plane, RADIANCE};
use super::super::points::{Points, place};
use super::{Case, Diagnosis, Kind, MOST, NEAR, Tally, light, median, registration};
use crate::render::aov::Aov;
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

const LEFT_RIGHT: &str = "the picture is mirrored left to right";
const UP_DOWN: &str = "the picture is upside down: row 0 is the top row";
const BOTH: &str = "the picture is turned by 180 degrees";

/// The dissimilarity of two pictures.
#[derive(Debug, Clone, Copy)]
struct Unlike {
    /// The fraction of pixels that differ: the largest of objects, positions and light.
    part: f64,
    /// The factor of the candidate's light on the reference's.
    factor: f64,
}

/// Pictures that differ at a smaller fraction of pixels are alike.
const ALIKE: f64 = 0.02;
/// Relative tolerance for equal values.
const SAME: f64 = 0.01;
/// The largest shift to try, pixels.
const FARTHEST: i64 = 2;

/// A candidate that is mirrored, rotated, or shifted by whole pixels.
pub(super) fn turned(case: &Case) -> Option<Diagnosis> {
    let before = differing(case, Turn::Moved([0, 0]));
    if before.part <= ALIKE {
        return None;
    }
    let steps = -FARTHEST..=FARTHEST;
    let moves = steps
        .clone()
        .flat_map(|dy| steps.clone().map(move |dx| [dx, dy]));
    let moves = moves.filter(|step| *step != [0, 0]).map(Turn::Moved);
    let tried = mirrors_and_quarters(case)
        .chain(moves)
        .map(|turn| (turn, differing(case, turn)));
    let (turn, after) = tried.min_by(|a, b| a.1.part.total_cmp(&b.1.part))?;
    match after.part <= NEAR * before.part {
        true => Some(turn.describe(before, after)),
        // Two films that differ by a turn of a panorama are not those of another camera.
        false if is_panorama(case) => turned_by_light(case).map(|(found, _)| found),
        false => None,
    }
}

/// The fraction of the squared error of blurred light that may be left after a turn.
const LEFT_BY_TURN: f64 = 0.1;

/// A candidate with other samples than the reference that is mirrored, or moved around the edge of a panorama: then all pixels at edges
/// and of textures differ, and the squared error of blurred light tells.
pub(super) fn turned_by_light(case: &Case) -> Option<(Diagnosis, f64)> {
    let [width, height] = case.points[0].size();
    let size = [width, height].map(|n| n as i64);
    let blurred = registration::Blurred::of(case)?;
    let error =
        |turn: Turn| blurred.error(|i| turn.source([i as i64 % size[0], i as i64 / size[0]], size));
    let before = error(Turn::Moved([0, 0]));
    let turns = mirrors_and_quarters(case).map(|turn| (turn, error(turn) / before));
    let (turn, left) = turns.min_by(|a, b| a.1.total_cmp(&b.1))?;
    (before > 0.0 && left <= LEFT_BY_TURN).then(|| {
        let same = |part| Unlike { part, factor: 1.0 };
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
    let eyes = super::stereo::is_pair(case).then_some(Turn::Eyes);
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

/// The dissimilarity of the pictures after the candidate is turned back.
fn differing(case: &Case, turn: Turn) -> Unlike {
    let [r, c] = &case.points;
    let size = r.size().map(|n| n as i64);
    let pixels: Vec<[usize; 2]> = (case.region.pixels(r.size()))
        .filter_map(|i| {
            let at = [i as i64 % size[0], i as i64 / size[0]];
            Some([i, turn.source(at, size)?])
        })
        .collect();
    let part = |differs: &dyn Fn(usize, usize) -> bool| {
        let count = pixels.iter().filter(|[i, j]| differs(*i, *j)).count();
        count as f64 / pixels.len().max(1) as f64
    };
    let mut worst: f64 = 0.0;
    if r.object.is_some() && c.object.is_some() {
        let names = renamed(&pixels, &case.points);
        let name = |i: usize| r.object_at(i).map(|id| names.get(&(id as i64)).copied());
        let shown = |j: usize| c.object_at(j).map(|id| Some(id as i64));
        worst = part(&|i, j| name(i) != shown(j));
    }
    for planes in [[r.material, c.material], [r.world, c.world]] {
        if let [Some(r), Some(c)] = planes {
            let ratios = pixels.iter();
            let ratios = ratios.map(|[i, j]| place(&c, *j).length() / place(&r, *i).length());
            let unit = common_factor(ratios);
            worst = worst.max(part(&|i, j| differ(place(&r, i) * unit, place(&c, j))));
        }
    }
    let mut factor = 1.0;
    if let [Some(r), Some(c)] = [light(case, 0), light(case, 1)] {
        let sum = |of: &[Plane; 3], i: usize| of.iter().map(|p| p.at(i)).sum::<f64>();
        let ratios = pixels.iter().map(|[i, j]| sum(&c, *j) / sum(&r, *i));
        factor = common_factor(ratios);
        worst = worst.max(part(&|i, j| differ(place(&r, i) * factor, place(&c, j))));
    }
    Unlike {
        part: worst,
        factor,
    }
}

/// The most common factor.
fn common_factor(ratios: impl Iterator<Item = f64>) -> f64 {
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

/// The smallest notable displacement, pixels, rms.
const NOTABLE: f64 = 0.1;
/// Films of a smaller scale show the same point everywhere: fields of view of one degree instead of 90.
const LEAST_SCALE: f64 = 0.01;

/// A candidate whose film is shifted or scaled.
pub(super) fn scaled(case: &Case) -> Option<Diagnosis> {
    scaled_and_rest(case).map(|(found, _)| found)
}

/// The same, with the rms displacement, in pixels, that this hypothesis leaves.
pub(super) fn scaled_and_rest(case: &Case) -> Option<(Diagnosis, f64)> {
    let by_points = case.field.and_then(|field| of_field(case, field, false));
    let by_points = by_points.or_else(|| {
        let directions = Field::of_directions(&case.points)?;
        of_field(case, &directions, true)
    });
    by_points.or_else(|| of_events(case))
}

/// The same from look directions, which show displacements of any size.
pub(super) fn of_directions(case: &Case) -> Option<(Diagnosis, f64)> {
    let directions = Field::of_directions(&case.points)?;
    let pixels = case.region.pixels(case.points[0].size()).collect();
    of_displacements(case, pixels, 0.0, |i| directions.displacement(i))
}

/// Another film, from events of moving objects only: whichever point of the object it is, an event E on the past light cone of the shot P
/// is seen along E − P.
fn of_events(case: &Case) -> Option<(Diagnosis, f64)> {
    let known = case.known?;
    let [r, c] = &case.points;
    let [width, _] = r.size();
    let planes = [r.world?, c.world?];
    let times = case.pair.map(|p| Plane::aov(&p.layers, Aov::EventCt));
    let times = [times[0]?, times[1]?];
    let seen = |which: usize, i: usize| {
        let (ct, x) = (times[which].at(i), place(&planes[which], i));
        known.film_point_along(known.look_to(ct, x)?)
    };
    let displacement = |i: usize| {
        let centre = DVec2::new((i % width) as f64 + 0.5, (i / width) as f64 + 0.5);
        Some(seen(1, i)? - seen(0, i).unwrap_or(centre))
    };
    of_displacements(case, case.pixels(), NOTABLE, displacement)
}

/// a + k p along both axes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Film {
    pub a: DVec2,
    pub k: DVec2,
}

impl Film {
    /// The best fit to pairs of p and p′.
    fn fit(pairs: &[[DVec2; 2]]) -> Option<Film> {
        let n = pairs.len() as f64;
        let mean = |which: usize| pairs.iter().map(|pair| pair[which]).sum::<DVec2>() / n;
        let (p, q) = (mean(0), mean(1));
        // Least squares, for each axis separately.
        let (mut pp, mut pq) = (DVec2::ZERO, DVec2::ZERO);
        for pair in pairs {
            pp += (pair[0] - p) * (pair[0] - p);
            pq += (pair[0] - p) * (pair[1] - q);
        }
        let k = pq / pp;
        k.is_finite().then(|| Film { a: q - k * p, k })
    }

    pub fn of(&self, p: DVec2) -> DVec2 {
        self.a + self.k * p
    }

    /// Whether it shows a picture rather than the same point everywhere.
    fn is_film(&self) -> bool {
        self.k.abs().min_element() > LEAST_SCALE
    }
}

/// Another film, from where the candidate shows points: at all pixels with `everywhere`, otherwise at those that differ.
fn of_field(case: &Case, field: &Field, everywhere: bool) -> Option<(Diagnosis, f64)> {
    let pixels = match everywhere {
        true => case.region.pixels(case.points[0].size()).collect(),
        false => case.pixels(),
    };
    of_displacements(case, pixels, NOTABLE, |i| field.displacement(i))
}

/// The same from the displacements of these pixels' points, of more than `notable` pixels rms.
fn of_displacements(
    case: &Case,
    pixels: Vec<usize>,
    notable: f64,
    displacement: impl Fn(usize) -> Option<DVec2>,
) -> Option<(Diagnosis, f64)> {
    let [width, height] = case.points[0].size();
    let half = 0.5 * DVec2::new(width as f64, height as f64);
    let pair = |i: usize| {
        let p = DVec2::new((i % width) as f64 + 0.5, (i / width) as f64 + 0.5) - half;
        Some([p, p + displacement(i)?])
    };
    let mut pairs: Vec<[DVec2; 2]> = pixels.into_iter().filter_map(pair).collect();
    if pairs.len() < super::FEWEST {
        return None;
    }
    // Fitted twice: the worst fits are left out of the second one, because they are due to other mistakes.
    let first = Film::fit(&pairs)?;
    let off = |film: &Film, [p, q]: &[DVec2; 2]| (*q - film.of(*p)).length();
    let all = pairs.clone();
    pairs.sort_by(|a, b| off(&first, a).total_cmp(&off(&first, b)));
    pairs.truncate((MOST * pairs.len() as f64).ceil() as usize);
    let film = Film::fit(&pairs)?;
    let tally = Tally::of(
        all.iter()
            .map(|pair| [(pair[1] - pair[0]).length(), off(&film, pair)]),
    );
    let evidence = vec![
        ("points are displaced by (pixels, rms)", tally.error()),
        ("and from the hypothesis by (pixels, rms)", tally.rest()),
    ];
    let moved = all.iter().map(|[p, _]| film.of(*p).distance_squared(*p));
    let moved = (moved.sum::<f64>() / all.len() as f64).sqrt();
    (moved > notable && film.is_film() && tally.explains(notable))
        .then(|| (describe(case, &film, BY_PLACES, evidence), tally.rest()))
}

/// Tolerances for a shift to count as half a pixel: by positions, and by light, which edges between pixels blur.
const BY_PLACES: f64 = 0.05;
pub(super) const BY_LIGHT: f64 = 0.2;

/// The diagnosis of a film whose shift is known to `precision` pixels.
pub(super) fn describe(
    case: &Case,
    film: &Film,
    precision: f64,
    mut evidence: Vec<(&'static str, f64)>,
) -> Diagnosis {
    let Film { a, k } = *film;
    let [width, height] = case.points[0].size();
    let half = 0.5 * DVec2::new(width as f64, height as f64);
    // The effect of the scale at the film's edges compared with that of the shift.
    let scale = (k - 1.0).abs() * half;
    if scale.max_element() <= 2.0 * NEAR * a.abs().max_element() {
        // A point that belongs to the right is seen displaced to the left.
        let [x, y] = [-a.x, -a.y];
        evidence.extend([("to the right (pixels)", x), ("down (pixels)", y)]);
        let is_half = |v: f64| (v.abs() - 0.5).abs() < precision || v.abs() < precision;
        // More than a quarter: 0 does not count as half a pixel.
        let is_half = is_half(x) && is_half(y) && a.abs().max_element() > 0.25;
        let [words, about] = match is_half {
            true if precision <= BY_PLACES => ["by half a pixel, ", ""],
            true => ["by ", ", measured by light alone: that may be half a pixel"],
            false if precision <= BY_PLACES => ["by ", ""],
            false => [
                "by ",
                ", measured by light alone: the camera may also be elsewhere, or turned",
            ],
        };
        return Diagnosis {
            kind: Kind::FilmShifted,
            what: format!(
                "the picture is moved {words}({x:+.2}, {y:+.2}) pixels to the right and down{about}"
            )
            .into(),
            evidence,
        };
    }
    let alike = (k.x - k.y).abs() <= NEAR * (k - 1.0).abs().max_element();
    evidence.extend([
        ("tan(fov/2) across over the reference's", k.x),
        ("tan(fov/2) down over the reference's", k.y),
    ]);
    if k.min_element() < 0.0 {
        let what = match (k.x < 0.0, k.y < 0.0) {
            (true, true) => BOTH,
            (true, false) => LEFT_RIGHT,
            _ => UP_DOWN,
        };
        return Diagnosis {
            kind: Kind::Mirrored,
            what: what.into(),
            evidence,
        };
    }
    if !alike {
        return Diagnosis {
            kind: Kind::Aspect,
            what: format!(
                "the aspect ratio differs: tan(fov/2) is {:.4} times the reference's across and {:.4} times down",
                k.x, k.y
            ).into(),
            evidence,
        };
    }
    let fov = case.known.map(|known| {
        let fov = known.horizontal_fov();
        let found = 2.0 * libm::atan(k.x * libm::tan(0.5 * fov));
        format!(
            ": {:.3} degrees across for {:.3}",
            found.to_degrees(),
            fov.to_degrees()
        )
    });
    let aspect = half.x / half.y;
    // A horizontal field of view used as the vertical one scales by the aspect ratio; square pictures cannot show this.
    let vertical = (k.x - aspect).abs() < 0.02 * aspect && (aspect - 1.0).abs() > 0.05;
    let why = match vertical {
        true => "; that is the horizontal field of view taken for the vertical one",
        false => "",
    };
    Diagnosis {
        kind: Kind::FieldOfView,
        what: format!(
            "the field of view differs: tan(fov/2) is {:.4} times the reference's, the focal length {:.4} times{}{why}",
            0.5 * (k.x + k.y),
            2.0 / (k.x + k.y),
            fov.unwrap_or_default()
        ).into(),
        evidence,
    }
}
