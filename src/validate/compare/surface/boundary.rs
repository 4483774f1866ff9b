//! Which objects are seen where, and where one ends and another begins.

use std::f64::consts::FRAC_PI_4;

use super::points::Points;
use super::{Share, Silhouette};
use crate::validate::compare::region::Region;

/// Farther than any pixel.
const FAR: u32 = u32::MAX / 2;

/// Pixels of the region that show another object.
pub(super) fn wrong(pair: &[Points; 2], region: &Region) -> Option<Share> {
    let [r, c] = pair;
    (r.object.is_some() && c.object.is_some()).then_some(())?;
    let [width, height] = r.size();
    let mut share = Share { pixels: 0, of: 0 };
    for y in 0..height {
        for (x, _) in region
            .row(y, width)
            .iter()
            .enumerate()
            .filter(|(_, chosen)| **chosen)
        {
            let i = y * width + x;
            share.of += 1;
            share.pixels += u64::from(r.object_at(i) != c.object_at(i));
        }
    }
    Some(share)
}

/// How far the boundaries between objects are off.
pub(super) fn silhouette(pair: &[Points; 2], region: &Region) -> Option<Silhouette> {
    let wrong = wrong(pair, region)?;
    let length = FRAC_PI_4 * crossings(&pair[0], region) as f64;
    let mean = match (wrong.pixels, length) {
        (0, _) => 0.0,
        (_, 0.0) => f64::INFINITY,
        (pixels, length) => pixels as f64 / length,
    };
    let [r, c] = pair.each_ref().map(|points| boundary(points, region));
    let size = pair[0].size();
    let largest = match wrong.pixels {
        0 => Some(0.0),
        _ => farthest(&r, &c, size)
            .zip(farthest(&c, &r, size))
            .map(|(a, b)| a.max(b)),
    };
    Some(Silhouette {
        mean,
        largest,
        length,
    })
}

/// Neighbours of which one lies across a boundary.
fn crossings(points: &Points, region: &Region) -> u64 {
    let [width, height] = points.size();
    let mut count = 0;
    for y in 0..height {
        for (x, _) in region
            .row(y, width)
            .iter()
            .enumerate()
            .filter(|(_, chosen)| **chosen)
        {
            let i = y * width + x;
            let differs = |j: usize| points.object_at(i) != points.object_at(j);
            count += u64::from(x + 1 < width && differs(i + 1));
            count += u64::from(y + 1 < height && differs(i + width));
        }
    }
    count
}

/// Pixels of the region that have a neighbour of another object, beside or beneath or above.
fn boundary(points: &Points, region: &Region) -> Vec<bool> {
    let [width, height] = points.size();
    let mut marks = vec![false; width * height];
    for y in 0..height {
        for (x, _) in region
            .row(y, width)
            .iter()
            .enumerate()
            .filter(|(_, chosen)| **chosen)
        {
            let i = y * width + x;
            let differs = |j: usize| points.object_at(i) != points.object_at(j);
            marks[i] = (x + 1 < width && differs(i + 1))
                || (x > 0 && differs(i - 1))
                || (y + 1 < height && differs(i + width))
                || (y > 0 && differs(i - width));
        }
    }
    marks
}

/// The largest distance from a marked pixel to the nearest one marked in `other`; none where either has none.
fn farthest(marks: &[bool], other: &[bool], [width, height]: [usize; 2]) -> Option<f64> {
    (marks.contains(&true) && other.contains(&true)).then_some(())?;
    let columns = vertical(other, [width, height]);
    let mut most = 0u64;
    for y in 0..height {
        let row = &columns[y * width..(y + 1) * width];
        for x in (0..width).filter(|x| marks[y * width + x]) {
            most = most.max(nearest(row, x));
        }
    }
    Some((most as f64).sqrt())
}

/// The distance of each pixel to the nearest mark in its column.
fn vertical(marks: &[bool], [width, height]: [usize; 2]) -> Vec<u32> {
    let mut distances: Vec<u32> = marks.iter().map(|m| if *m { 0 } else { FAR }).collect();
    for i in width..width * height {
        distances[i] = distances[i].min(distances[i - width] + 1);
    }
    for i in (0..width * (height - 1)).rev() {
        distances[i] = distances[i].min(distances[i + width] + 1);
    }
    distances
}

/// The least squared distance from column `x` to a mark, given the vertical distances of its row. Columns are
/// visited outwards, and no farther than the nearest mark found so far.
fn nearest(row: &[u32], x: usize) -> u64 {
    let square = |n: u64| n * n;
    let mut best = square(row[x].into());
    let mut reach = 1u64;
    while square(reach) < best && reach < row.len() as u64 {
        let step = reach as usize;
        for side in [x.checked_sub(step), Some(x + step)].into_iter().flatten() {
            if let Some(distance) = row.get(side) {
                best = best.min(square(reach) + square((*distance).into()));
            }
        }
        reach += 1;
    }
    best
}
