//! Pixels whose points may be means over several surfaces.
//!
//! With several samples per pixel a position is the mean over the samples, while the index of the object is that of one of them. At the rim
//! of an object the mean lies between this and what is behind, possibly far from both, wherever the object is. It lies within the box
//! around the points that the pixel and its neighbours show. So a point says nothing of its object if the other picture shows several
//! objects, or none, around this pixel, with the point in their box. Pictures of single samples have no means.

use super::super::picture::Picture;
use super::super::points::around;
use super::super::points::{Points, place};
use glam::DVec3;

/// Whether each picture states that its pixels are single samples.
fn are_single(pair: [&Picture; 2]) -> bool {
    pair.into_iter().all(|picture| {
        picture.metadata("pixel_centers") == Some("true")
            || picture.metadata("samples_per_pixel") == Some("1")
    })
}

/// What is added on each side of a box, relative to its size.
const MARGIN: f64 = 0.5;

/// For each pixel, whether its points may be means over several surfaces; empty if there are none.
pub(in super::super) fn pixels(pair: [&Picture; 2], points: &[Points; 2]) -> Vec<bool> {
    let (Some(planes), false) = (Points::places(points), are_single(pair)) else {
        return Vec::new();
    };
    if points.iter().any(|points| points.object.is_none()) {
        return Vec::new();
    }
    let size = points[0].size();
    let is_mixed = |i: usize, which: usize, other: usize| {
        let id = points[which].object_at(i);
        let is_rim = around(size, i).any(|j| points[other].object_at(j) != id);
        if !is_rim {
            return false;
        }
        let none = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        let beside = around(size, i).map(|j| place(&planes[other], j));
        let [low, high] = beside
            .filter(|p| p.is_finite())
            .fold(none, |[low, high], p| [low.min(p), high.max(p)]);
        // The other picture may hold means, too: the points themselves are farther apart.
        let margin = MARGIN * (high - low);
        let point = place(&planes[which], i);
        point.cmpge(low - margin).all() && point.cmple(high + margin).all()
    };
    (0..size[0] * size[1])
        .map(|i| is_mixed(i, 1, 0) || is_mixed(i, 0, 1))
        .collect()
}
