//! Outlines of objects, from the channel of their identities.
//!
//! With χ the indicator of an object's pixels (1 where it is seen, 0 elsewhere) and B the binomial
//! kernel (1, 4, 6, 4, 1)/16 in either direction, of variance 1 pixel², the outline is the line
//!
//! ```text
//! (B ∗ χ)(x, y) = ½,
//! ```
//!
//! by linear interpolation between pixel centres. B keeps a straight edge where it is, so that the line
//! lies within fractions of a pixel; an edge of radius r is drawn 1/(2r) pixels inwards (heat equation to
//! first order), and what is less than two pixels wide may have no outline.
//!
//! Where two objects meet, the lines of both are the same, since their smoothed indicators add up to 1:
//! the line is that of the object with fewer pixels, as a rule the one in front.

use std::collections::{BTreeMap, BTreeSet};

use super::Polyline;
use crate::figures::isochrones::chain::polylines;
use crate::figures::isochrones::contour::{Grid, Piece, pieces};
use crate::figures::isochrones::range::Range;

/// The binomial kernel, sixteenths.
const KERNEL: [f64; 5] = [1.0, 4.0, 6.0, 4.0, 1.0];
/// How far from an object's pixels its smoothed indicator reaches, pixels.
const REACH: usize = 2;

/// The outline of what is seen of an object.
#[derive(Debug, Clone, PartialEq)]
pub struct Outline {
    /// Its index in the scene.
    pub object: usize,
    /// In pixels of the film; closed where the first point is the last.
    pub lines: Vec<Polyline>,
}

/// A box of pixels, the last ones included.
#[derive(Debug, Clone, Copy)]
struct Area {
    object: usize,
    count: usize,
    min: [usize; 2],
    max: [usize; 2],
}

/// The outlines of all objects of a picture of this size, from the identity in each pixel (−1 where
/// nothing is seen; row 0 at the top). Ordered by object; objects without lines are left out.
pub fn outlines([width, height]: [u32; 2], objects: &[f64]) -> Vec<Outline> {
    let size = [width, height].map(|side| side as usize);
    if objects.len() != size[0] * size[1] {
        return Vec::new();
    }
    let mut areas = areas(size, objects);
    areas.sort_by_key(|area| (area.count, area.object));
    let mut taken = BTreeSet::new();
    let traced = areas.iter().map(|area| Outline {
        object: area.object,
        lines: trace(area, size, objects, &mut taken),
    });
    let mut outlines: Vec<Outline> = traced.filter(|o| !o.lines.is_empty()).collect();
    outlines.sort_by_key(|outline| outline.object);
    outlines
}

/// Where each object is seen.
fn areas([width, _]: [usize; 2], objects: &[f64]) -> Vec<Area> {
    let mut areas: BTreeMap<usize, Area> = BTreeMap::new();
    for (i, &object) in objects.iter().enumerate().filter(|(_, id)| **id >= 0.0) {
        let (at, object) = ([i % width, i / width], object as usize);
        let area = areas.entry(object).or_insert(Area {
            object,
            count: 0,
            min: at,
            max: at,
        });
        area.count += 1;
        area.min = [0, 1].map(|axis| area.min[axis].min(at[axis]));
        area.max = [0, 1].map(|axis| area.max[axis].max(at[axis]));
    }
    areas.into_values().collect()
}

/// The lines of one object, without what others have `taken`.
fn trace(
    area: &Area,
    size: [usize; 2],
    objects: &[f64],
    taken: &mut BTreeSet<usize>,
) -> Vec<Polyline> {
    let min = area.min.map(|side| side.saturating_sub(REACH + 1));
    let max = [0, 1].map(|axis| (area.max[axis] + REACH + 2).min(size[axis]));
    let [width, height] = [0, 1].map(|axis| max[axis] - min[axis]);
    let smoothed = smoothed(size, min, [width, height], |i| {
        objects[i] == area.object as f64
    });
    let grid = Grid {
        width,
        height,
        ct: &smoothed,
    };
    let in_film = |edge: usize| {
        let (column, row) = (edge / 2 % width + min[0], edge / 2 / width + min[1]);
        2 * (row * size[0] + column) + edge % 2
    };
    let edges = |piece: &Piece| piece.ends.map(|end| in_film(end.edge));
    let mut found = pieces(&grid, &HALF).pop().unwrap_or_default();
    found.retain(|piece| !edges(piece).iter().all(|edge| taken.contains(edge)));
    taken.extend(found.iter().flat_map(edges));
    let place = |[x, y]: [f64; 2]| [x + min[0] as f64, y + min[1] as f64];
    let lines = polylines(&found).into_iter();
    lines
        .map(|line| line.points.into_iter().map(place).collect())
        .collect()
}

/// One line, at 0: the smoothed indicator is taken less ½.
const HALF: Range = Range {
    low: -0.25,
    high: 0.25,
    step: 1.0,
    more_below: true,
    more_above: true,
};

/// B ∗ χ − ½ on the pixels from `min`; beyond the film's edge it goes on as it is there.
fn smoothed(
    film: [usize; 2],
    min: [usize; 2],
    [width, height]: [usize; 2],
    is_seen: impl Fn(usize) -> bool,
) -> Vec<f64> {
    let clamped = |axis: usize, at: usize, k: usize| {
        (min[axis] + at + k)
            .saturating_sub(REACH)
            .min(film[axis] - 1)
    };
    let along = |value: &dyn Fn(usize) -> f64| {
        let weighted = KERNEL
            .iter()
            .enumerate()
            .map(|(k, weight)| weight * value(k));
        weighted.sum::<f64>() / 16.0
    };
    // Rows first, on REACH rows more than are wanted to either side.
    let rows: Vec<f64> = (0..(height + 2 * REACH) * width)
        .map(|i| {
            let row = clamped(1, i / width, 0);
            let seen = |k| is_seen(row * film[0] + clamped(0, i % width, k));
            along(&|k| f64::from(u8::from(seen(k))))
        })
        .collect();
    (0..height * width)
        .map(|i| along(&|k| rows[i + k * width]) - 0.5)
        .collect()
}
