//! Texture coordinates for surfaces that do not have their own everywhere: an atlas of flat charts.
//!
//! A chart is a connected part of the surface whose normals are within 45° of one axis, projected along it: texels are stretched by at
//! most 1/cos 45°. It grows from the first triangle that has no chart yet, over shared edges, in the order of the triangles. Such a part
//! may still overlap itself (a spiral ramp does): of two overlapping triangles, the later is given back and becomes part of another
//! chart; this is checked each time the chart has doubled. Charts are rotated to lie in the smallest rectangle, and packed on shelves,
//! tallest first, at the largest common scale at which they fit (bisection). Two columns or rows of texels separate charts, so that
//! bilinear lookups at the border of a chart, which reach one texel beyond, never read another one's.
//!
//! The same triangles give the same coordinates, bit for bit. Files store them beside what is baked with them; nothing that is read later
//! depends on this code.

use std::collections::{HashMap, VecDeque};
use std::ops::RangeInclusive;

use glam::{DVec2, DVec3};

/// The texture coordinates of the corners of a triangle, 0 to 1.
pub type Corners = [[f32; 2]; 3];

/// Cosine of the largest angle between a chart's axis and its normals.
const STEEPEST: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// Texels of margin on each side of a chart.
const MARGIN: usize = 1;

/// Bisections of the scale: to a relative precision of 2⁻⁴⁰.
const BISECTIONS: u32 = 40;

/// Triangles overlap if by more than this part of their size; those that share an edge overlap by rounding.
const ROUNDING: f64 = 1e-9;

/// A texture too small for its charts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("its {charts} charts need a texture of at least {least}x{least} texels")]
#[non_exhaustive]
pub struct TooSmall {
    /// The number of charts.
    pub charts: usize,
    /// Columns (and rows) of a square texture that has room for them.
    pub least: u32,
}

crate::error::value_errors!(TooSmall);

/// The coordinates of the corners of all `triangles` (positions in metres) on a texture of `size` columns and rows. Triangles without
/// area get the corner (0, 0).
///
/// # Errors
/// The texture has less than one texel per chart.
pub fn atlas(triangles: &[[DVec3; 3]], size: [u32; 2]) -> Result<Vec<Corners>, TooSmall> {
    let charts = charts(triangles);
    let mut corners = vec![[[0.0; 2]; 3]; triangles.len()];
    if charts.is_empty() {
        return Ok(corners);
    }
    let (scale, places) = packed(&charts, size.map(|n| n as usize))?;
    let texels = DVec2::new(f64::from(size[0]), f64::from(size[1]));
    for (chart, place) in charts.iter().zip(places) {
        let origin = place + DVec2::splat(MARGIN as f64);
        for (triangle, flat) in chart.triangles.iter().zip(&chart.flat) {
            corners[*triangle as usize] =
                flat.map(|p| ((origin + p * scale) / texels).as_vec2().to_array());
        }
    }
    Ok(corners)
}

/// Part of a surface on a plane.
struct Chart {
    triangles: Vec<u32>,
    /// The corners of its triangles, metres from the lower left corner of the chart.
    flat: Vec<[DVec2; 3]>,
    size: DVec2,
}

/// The normal of a triangle, if it has an area.
fn normal([a, b, c]: [DVec3; 3]) -> Option<DVec3> {
    let n = (b - a).cross(c - a);
    n.try_normalize().filter(|n| n.is_finite())
}

fn charts(triangles: &[[DVec3; 3]]) -> Vec<Chart> {
    counted_charts(triangles).0
}

/// The same, and how often a triangle was visited from a neighbour.
fn counted_charts(triangles: &[[DVec3; 3]]) -> (Vec<Chart>, usize) {
    let mut visits = 0;
    let normals: Vec<_> = triangles.iter().map(|t| normal(*t)).collect();
    let neighbours = Neighbours::of(triangles);
    let mut taken: Vec<bool> = normals.iter().map(Option::is_none).collect();
    let mut charts = Vec::new();
    // Triangles that a chart gives back are tried again, as first triangles of their own charts.
    let mut seeds: VecDeque<u32> = (0..triangles.len() as u32).collect();
    while let Some(seed) = seeds.pop_front() {
        let Some(axis) = normals[seed as usize].filter(|_| !taken[seed as usize]) else {
            continue;
        };
        let (x, y) = axis.any_orthonormal_pair();
        let on_plane = |t: u32| triangles[t as usize].map(|p| DVec2::new(p.dot(x), p.dot(y)));
        taken[seed as usize] = true;
        let (mut members, mut flat) = (vec![seed], vec![on_plane(seed)]);
        let (mut next, mut checked) = (0, 1);
        let mut given_back = Vec::new();
        while next < members.len() {
            let beside = neighbours.of_triangle(members[next]);
            visits += beside.len();
            for &other in beside {
                let along = normals[other as usize].map_or(0.0, |n| n.dot(axis));
                if !taken[other as usize] && along >= STEEPEST {
                    taken[other as usize] = true;
                    members.push(other);
                    flat.push(on_plane(other));
                }
            }
            next += 1;
            // Checked at each doubling, so that a chart does not grow over everything that lies on top of it: among many copies of a mesh
            // each chart would try all of them.
            let is_last = next == members.len() && checked < members.len();
            if members.len() >= 2 * checked || is_last {
                let covering = covering(&flat);
                let covers = |k: &usize| covering[*k];
                given_back.extend((0..members.len()).filter(covers).map(|k| members[k]));
                next -= (0..next).filter(covers).count();
                let mut covers = covering.iter();
                members.retain(|_| !covers.next().unwrap_or(&false));
                let mut covers = covering.iter();
                flat.retain(|_| !covers.next().unwrap_or(&false));
                checked = members.len();
            }
        }
        for triangle in given_back {
            taken[triangle as usize] = false;
            seeds.push_back(triangle);
        }
        charts.push(Chart::laid(members, flat));
    }
    (charts, visits)
}

/// Which triangles share an edge, that is, edges with the same end points.
struct Neighbours {
    /// By triangle, the index of its first neighbour.
    first: Vec<usize>,
    all: Vec<u32>,
}

impl Neighbours {
    fn of(triangles: &[[DVec3; 3]]) -> Self {
        let mut places: HashMap<[u64; 3], u32> = HashMap::new();
        let mut place = |p: DVec3| {
            // Adding 0 turns −0 into 0.
            let key = (p + DVec3::ZERO).to_array().map(f64::to_bits);
            let new = places.len() as u32;
            *places.entry(key).or_insert(new)
        };
        let mut edges = Vec::with_capacity(3 * triangles.len());
        for (triangle, corners) in (0u32..).zip(triangles) {
            let [a, b, c] = corners.map(&mut place);
            for (from, to) in [(a, b), (b, c), (c, a)] {
                edges.push((from.min(to), from.max(to), triangle));
            }
        }
        edges.sort_unstable();
        let mut pairs = Vec::new();
        for shared in edges.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            // If very many triangles share an edge, each is linked to its predecessor and its successor.
            for pair in shared.windows(2) {
                pairs.extend([(pair[0].2, pair[1].2), (pair[1].2, pair[0].2)]);
            }
        }
        pairs.sort_unstable();
        pairs.dedup();
        let mut first = vec![0; triangles.len() + 1];
        for (triangle, _) in &pairs {
            first[*triangle as usize + 1] += 1;
        }
        for k in 1..first.len() {
            first[k] += first[k - 1];
        }
        Neighbours {
            first,
            all: pairs.into_iter().map(|pair| pair.1).collect(),
        }
    }

    fn of_triangle(&self, triangle: u32) -> &[u32] {
        let k = triangle as usize;
        &self.all[self.first[k]..self.first[k + 1]]
    }
}

/// By triangle, whether it overlaps an earlier one that stays.
fn covering(flat: &[[DVec2; 3]]) -> Vec<bool> {
    let mut covers = vec![false; flat.len()];
    // A grid of about as many cells as triangles, whose rows and columns hold equally many corners, so that cells are small where
    // triangles are; each triangle is entered in the cells that it may touch, row by row.
    let (rows, columns) = (Lines::of(flat, |p| p.y), Lines::of(flat, |p| p.x));
    let mut grid: HashMap<(usize, usize), Vec<u32>> = HashMap::new();
    for (triangle, corners) in flat.iter().enumerate() {
        let (below, above) = bounds(std::slice::from_ref(corners));
        let mut cells = Vec::new();
        for row in rows.reached([below.y, above.y]) {
            let reach = extent(corners, rows.ends(row));
            cells.extend(columns.reached(reach).map(|column| (row, column)));
        }
        covers[triangle] = cells.iter().any(|cell| {
            let there = grid.get(cell).map_or(&[][..], Vec::as_slice);
            there
                .iter()
                .any(|other| overlap(corners, &flat[*other as usize]))
        });
        if !covers[triangle] {
            for cell in cells {
                grid.entry(cell).or_default().push(triangle as u32);
            }
        }
    }
    covers
}

/// The lines between rows, or columns, of a grid, ascending.
struct Lines {
    lines: Vec<f64>,
    /// A bound on the rounding error of a point between the ends of an edge.
    rounding: f64,
}

impl Lines {
    /// About as many lines as the root of the number of triangles, with equally many of their corners between them.
    fn of(flat: &[[DVec2; 3]], coordinate: impl Fn(&DVec2) -> f64) -> Lines {
        let mut all: Vec<f64> = flat.iter().flatten().map(coordinate).collect();
        all.sort_unstable_by(f64::total_cmp);
        let side = (flat.len() as f64).sqrt().ceil() as usize;
        let mut lines: Vec<f64> = (1..side).map(|k| all[k * all.len() / side]).collect();
        lines.dedup();
        let largest = all.iter().fold(0f64, |largest, x| largest.max(x.abs()));
        Lines {
            lines,
            rounding: 1e-12 * largest,
        }
    }

    /// The rows that an interval may touch.
    fn reached(&self, [from, to]: [f64; 2]) -> RangeInclusive<usize> {
        let row = |x: f64| self.lines.partition_point(|line| *line <= x);
        row(from - self.rounding)..=row(to + self.rounding)
    }

    /// The limits of a row.
    fn ends(&self, row: usize) -> [f64; 2] {
        let line = |k: usize| self.lines.get(k).copied();
        let begin = row.checked_sub(1).and_then(line);
        [
            begin.unwrap_or(f64::NEG_INFINITY),
            line(row).unwrap_or(f64::INFINITY),
        ]
    }
}

fn bounds(flat: &[[DVec2; 3]]) -> (DVec2, DVec2) {
    let all = || flat.iter().flatten().copied();
    let low = all().fold(DVec2::INFINITY, DVec2::min);
    (low, all().fold(DVec2::NEG_INFINITY, DVec2::max))
}

/// The horizontal extent of a triangle between two heights.
fn extent(corners: &[DVec2; 3], [from, to]: [f64; 2]) -> [f64; 2] {
    let mut reach = [f64::INFINITY, f64::NEG_INFINITY];
    let mut add = |x: f64| reach = [reach[0].min(x), reach[1].max(x)];
    for k in 0..3 {
        let (a, b) = (corners[k], corners[(k + 1) % 3]);
        if (from..=to).contains(&a.y) {
            add(a.x);
        }
        for height in [from, to] {
            if (a.y < height) != (b.y < height) {
                add(a.x + (b.x - a.x) * (height - a.y) / (b.y - a.y));
            }
        }
    }
    match reach[0] <= reach[1] {
        true => reach,
        // Rounding put it outside the row.
        false => {
            let x = corners.map(|p| p.x);
            [x[0].min(x[1]).min(x[2]), x[0].max(x[1]).max(x[2])]
        }
    }
}

/// Whether two triangles overlap: no line along an edge of one separates them.
fn overlap(a: &[DVec2; 3], b: &[DVec2; 3]) -> bool {
    let reach = |corners: &[DVec2; 3], axis: DVec2| {
        let x = corners.map(|p| p.dot(axis));
        [x[0].min(x[1]).min(x[2]), x[0].max(x[1]).max(x[2])]
    };
    let apart = |corners: &[DVec2; 3], k: usize| {
        let axis = (corners[(k + 1) % 3] - corners[k]).perp();
        let ([a0, a1], [b0, b1]) = (reach(a, axis), reach(b, axis));
        let size = (a1 - a0).max(b1 - b0);
        a1.min(b1) - a0.max(b0) <= ROUNDING * size
    };
    !(0..3).any(|k| apart(a, k) || apart(b, k))
}

impl Chart {
    /// The chart of these triangles, rotated to the smallest bounding rectangle among those along edges of its first triangle and at
    /// multiples of 10°, with its longer side horizontal.
    fn laid(triangles: Vec<u32>, flat: Vec<[DVec2; 3]>) -> Self {
        let [a, b, c] = flat[0];
        let edges = [b - a, c - b, a - c].map(|edge| edge.normalize_or(DVec2::X));
        let turns = (0..9).map(|k| DVec2::from_angle(f64::from(k) * 10f64.to_radians()));
        let turned = |turn: DVec2| {
            let across = DVec2::new(turn.x, -turn.y);
            let turned: Vec<_> = (flat.iter().map(|t| t.map(|p| across.rotate(p)))).collect();
            let (low, high) = bounds(&turned);
            (turned, low, high - low)
        };
        let mut best = turned(edges[0]);
        for turn in edges.into_iter().skip(1).chain(turns) {
            let other = turned(turn);
            // Better by more than rounding: among equally good ones, the first wins.
            if other.2.x * other.2.y < (1.0 - 1e-6) * best.2.x * best.2.y {
                best = other;
            }
        }
        let (mut flat, low, mut size) = best;
        let lies = size.x >= size.y;
        for p in flat.iter_mut().flatten() {
            *p -= low;
            if !lies {
                // A quarter turn, which does not flip the front.
                *p = DVec2::new(size.y - p.y, p.x);
            }
        }
        if !lies {
            size = DVec2::new(size.y, size.x);
        }
        Chart {
            triangles,
            flat,
            size,
        }
    }

    /// Columns and rows at this scale, including margins.
    fn texels(&self, scale: f64) -> [usize; 2] {
        [self.size.x, self.size.y]
            .map(|length| (length * scale).ceil().max(1.0) as usize + 2 * MARGIN)
    }
}

/// The largest scale, texels per metre, at which the charts fit, and the first texel of each.
fn packed(charts: &[Chart], size: [usize; 2]) -> Result<(f64, Vec<DVec2>), TooSmall> {
    let area: f64 = charts.iter().map(|c| c.size.x * c.size.y).sum();
    let mut order: Vec<usize> = (0..charts.len()).collect();
    order.sort_by(|a, b| charts[*b].size.y.total_cmp(&charts[*a].size.y));
    let mut best = (
        0.0,
        shelved(charts, &order, 0.0, size).ok_or_else(|| too_small(charts))?,
    );
    // A scale at which charts need more than all texels does not fit.
    let (mut low, mut high) = (0.0, (size[0] as f64 * size[1] as f64 / area).sqrt());
    for _ in 0..BISECTIONS {
        let scale = 0.5 * (low + high);
        match shelved(charts, &order, scale, size) {
            Some(places) => (low, best) = (scale, (scale, places)),
            None => high = scale,
        }
    }
    Ok(best)
}

fn too_small(charts: &[Chart]) -> TooSmall {
    let each = 1 + 2 * MARGIN;
    let columns = (charts.len() as f64).sqrt().ceil() as usize;
    TooSmall {
        charts: charts.len(),
        least: (each * columns) as u32,
    }
}

/// The first texel of each chart, packed on shelves in `order`; `None` if there is not enough room.
fn shelved(
    charts: &[Chart],
    order: &[usize],
    scale: f64,
    [width, height]: [usize; 2],
) -> Option<Vec<DVec2>> {
    let mut places = vec![DVec2::ZERO; charts.len()];
    let (mut column, mut row, mut shelf) = (0, 0, 0);
    for &chart in order {
        let [columns, rows] = charts[chart].texels(scale);
        if column + columns > width {
            (column, row, shelf) = (0, row + shelf, 0);
        }
        shelf = shelf.max(rows);
        if columns > width || row + rows > height {
            return None;
        }
        places[chart] = DVec2::new(column as f64, row as f64);
        column += columns;
    }
    Some(places)
}

#[cfg(test)]
mod tests;
