//! Pictures that are shifted or scaled as a whole, by points and directions.
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

use glam::DVec2;
use rayon::prelude::*;

use super::super::geometry::Field;
use super::super::picture::Plane;
use super::super::points::place;
use super::{Case, Diagnosis, Kind, NEAR, Tally, without_worst};
use crate::render::aov::Aov;

/// What is said of mirrored pictures.
pub(super) const LEFT_RIGHT: &str = "the picture is mirrored left to right";
pub(super) const UP_DOWN: &str = "the picture is upside down: row 0 is the top row";
pub(super) const BOTH: &str = "the picture is turned by 180 degrees";

/// The smallest notable displacement, pixels, rms.
const NOTABLE: f64 = 0.1;
/// Films of a smaller scale show the same point everywhere: fields of view of one degree instead of 90.
const LEAST_SCALE: f64 = 0.01;

/// A candidate whose film is shifted or scaled.
pub(super) fn scaled(case: &Case) -> Option<Diagnosis> {
    scaled_and_rest(case).map(|(found, _)| found)
}

/// A candidate whose film is mirrored about other than its pixels, and which shows other objects as a result: exchanged axes of points do
/// not.
pub(super) fn mirrored(case: &Case) -> Option<Diagnosis> {
    let [r, c] = &case.points;
    (r.object.is_some() && c.object.is_some()).then_some(())?;
    let (same, all) = (case.of_same_object().len(), case.everywhere().len());
    (same as f64 <= (1.0 - NEAR) * all as f64).then_some(())?;
    scaled(case).filter(|found| found.kind == Kind::Mirrored)
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
    of_displacements(case, case.everywhere(), 0.0, |i| directions.displacement(i))
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
        true => case.everywhere(),
        false => case.pixels(),
    };
    of_displacements(case, pixels, NOTABLE, |i| field.displacement(i))
}

/// The same from the displacements of these pixels' points, of more than `notable` pixels rms.
fn of_displacements(
    case: &Case,
    pixels: &[usize],
    notable: f64,
    displacement: impl Fn(usize) -> Option<DVec2> + Sync,
) -> Option<(Diagnosis, f64)> {
    let [width, height] = case.points[0].size();
    let half = 0.5 * DVec2::new(width as f64, height as f64);
    let pair = |i: usize| {
        let p = DVec2::new((i % width) as f64 + 0.5, (i / width) as f64 + 0.5) - half;
        Some([p, p + displacement(i)?])
    };
    let all: Vec<[DVec2; 2]> = pixels.par_iter().filter_map(|i| pair(*i)).collect();
    if all.len() < super::FEWEST {
        return None;
    }
    // Fitted twice: the worst fits are left out of the second one, because they are due to other mistakes.
    let first = Film::fit(&all)?;
    let off = |film: &Film, [p, q]: &[DVec2; 2]| (*q - film.of(*p)).length();
    let film = Film::fit(&without_worst(&all, |pair| off(&first, pair)))?;
    let tally = Tally::of(
        all.par_iter()
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

/// What is said beside a film that light alone shows.
pub(super) const OR_CAMERA: &str =
    ", measured by light alone: the camera may also be elsewhere, or turned";

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
            false => ["by ", OR_CAMERA],
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
    let or = if precision > BY_PLACES { OR_CAMERA } else { "" };
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
                "the aspect ratio differs: tan(fov/2) is {:.4} times the reference's across and {:.4} times down{or}",
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
            "the field of view differs: tan(fov/2) is {:.4} times the reference's, the focal length {:.4} times{}{why}{or}",
            0.5 * (k.x + k.y),
            2.0 / (k.x + k.y),
            fov.unwrap_or_default()
        ).into(),
        evidence,
    }
}
