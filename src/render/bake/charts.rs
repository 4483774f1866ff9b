//! Which triangles form a chart, and which texels the lookups on a chart read.
//!
//! Triangles with a common corner, in space and in the texture, belong to one chart. A bilinear lookup at a point p, in texels, reads the
//! centres around it: of the cell ⌊p − ½⌋ of the grid of centres its four corners. So charts that lie two texels apart share none, and
//! charts that are nearer may. Within one chart neighbours on the texture are neighbours in space, and may share.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::ops::Range;

use glam::{DVec2, DVec3};

/// A texel that no lookup reads, and one that those on several charts read.
const UNREAD: u32 = u32::MAX;
const SHARED: u32 = u32::MAX - 1;

/// Lookups nearer to the edge of a chart than this, texels, are left out: rounding of f32 may put them beyond it, and they give texels
/// beyond it no more weight than this.
const ROUNDING: f64 = 1e-3;

/// Bytes per triangle while charts are found.
pub const BYTES: usize = 3 * size_of::<(u64, u32)>() + 2 * size_of::<u32>();

/// For each texel, row by row, the chart whose lookups read it; empty if there is one chart only.
#[derive(Default)]
pub struct Readers {
    charts: Vec<u32>,
}

impl Readers {
    /// Those of `count` triangles, whose corners are `at` these places (metres) and texture coordinates (texels), in a texture of `size`
    /// columns and rows.
    pub fn of(
        count: usize,
        at: impl Fn(usize) -> ([DVec3; 3], [DVec2; 3]),
        size: [usize; 2],
    ) -> Self {
        let charts = charts(count, &at);
        if charts.iter().all(|chart| *chart == 0) {
            return Readers { charts: Vec::new() };
        }
        let [width, height] = size;
        let mut readers = vec![UNREAD; width * height];
        for (k, chart) in charts.into_iter().enumerate() {
            // Cell 0 begins at the centre before the first.
            let cells = at(k).1.map(|p| p + DVec2::splat(0.5));
            for (i, columns) in reached(cells, -ROUNDING, [width + 1, height + 1]) {
                for j in columns {
                    // At the border of the texture its last texel takes the place of those beyond it.
                    for row in [i.max(1) - 1, i.min(height - 1)] {
                        for column in [j.max(1) - 1, j.min(width - 1)] {
                            let reader = &mut readers[row * width + column];
                            *reader = match *reader {
                                UNREAD => chart,
                                other if other == chart => chart,
                                _ => SHARED,
                            };
                        }
                    }
                }
            }
        }
        Readers { charts: readers }
    }

    /// Number of texels that lookups on several charts read.
    pub fn shared(&self) -> u64 {
        self.charts.iter().filter(|chart| **chart == SHARED).count() as u64
    }

    pub fn bytes(&self) -> usize {
        size_of_val(self.charts.as_slice())
    }

    /// Whether lookups that read a texel expect the light of another one's chart there.
    pub fn belong_together(&self, texel: usize, other: usize) -> bool {
        match (self.charts.get(texel), self.charts.get(other)) {
            (Some(&UNREAD | &SHARED), _) | (_, Some(&SHARED)) => true,
            (a, b) => a == b,
        }
    }
}

/// The rows of cells that a triangle with these corners touches, and the range of columns in each: between the extremes of its edges
/// within the row. It touches a cell if it comes nearer than `margin` to it, or, below 0, farther into it than that.
pub fn reached(
    corners: [DVec2; 3],
    margin: f64,
    size: [usize; 2],
) -> impl Iterator<Item = (usize, Range<usize>)> {
    let span = move |low: f64, high: f64, size: usize| {
        (low - margin).max(0.0) as usize..((high + margin).max(0.0) as usize + 1).min(size)
    };
    let low = corners[0].min(corners[1]).min(corners[2]);
    let high = corners[0].max(corners[1]).max(corners[2]);
    span(low.y, high.y, size[1]).map(move |i| {
        let [from, to] = [i as f64 - margin, i as f64 + 1.0 + margin];
        let (mut left, mut right) = (f64::INFINITY, f64::NEG_INFINITY);
        for (k, p) in corners.into_iter().enumerate() {
            let q = corners[(k + 1) % 3];
            if p.y.max(q.y) < from || p.y.min(q.y) > to {
                continue;
            }
            for end in [p, q] {
                // If an end is outside the row, the edge counts where it crosses the border of the row.
                let y = end.y.clamp(from, to);
                let x = match y == end.y {
                    true => end.x,
                    false => p.x + (q.x - p.x) * ((y - p.y) / (q.y - p.y)),
                };
                (left, right) = (left.min(x), right.max(x));
            }
        }
        (i, span(left, right, size[0]))
    })
}

/// The chart of each triangle: the least of their indices.
fn charts(count: usize, at: impl Fn(usize) -> ([DVec3; 3], [DVec2; 3])) -> Vec<u32> {
    let key = |corner: u32| {
        let (places, coordinates) = at(corner as usize / 3);
        let (p, uv) = (
            places[corner as usize % 3],
            coordinates[corner as usize % 3],
        );
        // Adding 0 turns −0 into 0.
        [p.x, p.y, p.z, uv.x, uv.y].map(|x| (x + 0.0).to_bits())
    };
    let hash = |corner: u32| {
        let mut hasher = DefaultHasher::new();
        key(corner).hash(&mut hasher);
        hasher.finish()
    };
    let mut corners: Vec<(u64, u32)> = (0..3 * count as u32).map(|k| (hash(k), k)).collect();
    corners.sort_unstable();
    let mut links: Vec<u32> = (0..count as u32).collect();
    for pair in corners.windows(2) {
        let [(hash, a), (next, b)] = [pair[0], pair[1]];
        if hash == next && key(a) == key(b) {
            let (a, b) = (first(&mut links, a / 3), first(&mut links, b / 3));
            links[a.max(b) as usize] = a.min(b);
        }
    }
    (0..count as u32).map(|k| first(&mut links, k)).collect()
}

/// The first triangle that is linked with this one.
fn first(links: &mut [u32], mut triangle: u32) -> u32 {
    while links[triangle as usize] != triangle {
        let next = links[triangle as usize];
        // Halves the way for the next search.
        links[triangle as usize] = links[next as usize];
        triangle = next;
    }
    triangle
}

#[cfg(test)]
mod tests;
