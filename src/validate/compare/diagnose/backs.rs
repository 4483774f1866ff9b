//! Points of a known scene that are seen where they belong, but are elsewhere along their rays: back faces, and bodies of another shape.
//!
//! In the frame of an object light comes to q, the place of the shot, along straight lines (in vacuum). A candidate's point Y on the ray of
//! the reference's X is behind it if |Y − q| > |X − q|. If nearly all of an object's are, it shows what its front hides, and its normals n
//! say so by n·(Y − q) > 0, where the reference's are n·(X − q) < 0.

use std::collections::BTreeMap;

use super::super::picture::Plane;
use super::super::points::place;
use super::{Case, Diagnosis, FEWEST, Kind, MOST, median};
use crate::render::aov::Aov;

/// The least fraction of an object's pixels that must be elsewhere along their rays.
const NOTABLE: f64 = 0.5;

/// An object's pixels whose points are elsewhere along their rays.
#[derive(Default)]
struct Elsewhere {
    /// All pixels of the object with points.
    all: usize,
    /// By how much they are farther from the shot, metres.
    farther: Vec<f64>,
    /// Those whose normals face the camera in the reference and away from it in the candidate.
    turned: usize,
}

/// Whether this part of `all` is nearly all of it.
fn are_most(part: usize, all: usize) -> bool {
    part as f64 >= MOST * all as f64
}

impl Elsewhere {
    fn is_behind(&self) -> bool {
        let behind = self.farther.iter().filter(|by| **by > 0.0).count();
        are_most(behind, self.farther.len())
    }

    fn describe(self, object: usize, is_behind: bool) -> Option<Diagnosis> {
        let part = self.farther.len() as f64 / self.all as f64;
        let by = median(self.farther.iter().map(|by| by.abs()).collect())?;
        let are = match are_most(self.turned, self.farther.len()) {
            true => "are",
            false => "may be",
        };
        let (kind, what) = match is_behind {
            true => (
                Kind::BackFaces,
                format!(
                    "back faces of object {object} {are} shown: its points are on the right rays, but {by:.4} m (at half of the pixels) behind those that face the camera: triangles wind the other way round, the wrong faces are culled, or what is farther hides what is nearer"
                ),
            ),
            false => (
                Kind::ObjectElsewhere,
                format!(
                    "object {object} is turned, of another shape, or elsewhere: its points are on the right rays, but {by:.4} m (at half of the pixels) off the surface that the reference shows there"
                ),
            ),
        };
        Some(Diagnosis {
            kind,
            what: what.into(),
            evidence: vec![
                ("part of the pixels", part),
                ("off along the rays by (m, median)", by),
            ],
        })
    }
}

/// Objects whose back faces are shown.
pub(super) fn shown(case: &Case) -> Vec<Diagnosis> {
    found(case, true)
}

/// Objects whose points are off the surface in another way.
pub(super) fn off_surface(case: &Case) -> Vec<Diagnosis> {
    found(case, false)
}

fn found(case: &Case, behind: bool) -> Vec<Diagnosis> {
    let (Some(known), Some(field)) = (case.known, case.field) else {
        return Vec::new();
    };
    let axes = [Aov::NormalX, Aov::NormalY, Aov::NormalZ];
    let normals = case.pair.map(|picture| Plane::aovs(&picture.layers, axes));
    let mut objects = BTreeMap::<usize, Elsewhere>::new();
    for &i in case.pixels() {
        let points = case.points.each_ref().map(|points| known.point(points, i));
        let [Some((object, x)), Some((_, y))] = points else {
            continue;
        };
        let Some(q) = known.shot_in(object) else {
            continue;
        };
        let of = objects.entry(object).or_default();
        of.all += 1;
        if field.is_elsewhere_along_ray(i) {
            of.farther.push((y - q).length() - (x - q).length());
            if let [Some(r), Some(c)] = &normals {
                let is_turned = place(r, i).dot(x - q) < 0.0 && place(c, i).dot(y - q) > 0.0;
                of.turned += usize::from(is_turned);
            }
        }
    }
    let is_notable = |of: &Elsewhere| {
        let count = of.farther.len();
        count >= FEWEST && count as f64 >= NOTABLE * of.all as f64 && of.is_behind() == behind
    };
    let found = objects.into_iter().filter(|(_, of)| is_notable(of));
    found
        .filter_map(|(object, of)| of.describe(object, behind))
        .collect()
}
