//! Culling of invisible triangles, and the pixels that the others can reach.
//!
//! A triangle's directions, seen in its rest coordinates c, lie in a cone about a unit vector â with
//! half-angle α. Aberration takes circles of directions to circles (Penrose, "The apparent shape of a
//! relativistically moving sphere", 1959): look directions (−1, d) in the cone are those with
//!
//! ```text
//! k·N ≥ 0,     N = (−cos α, â),     signature (−, +, +, +),
//! ```
//!
//! and N is a four-vector: boosted, it gives the cone that the camera sees.

use glam::DVec3;

use super::vertices::Vertex;
use crate::accel::vectors::VectorLoop;
use crate::approximate::projection::ApparentProjection;
use crate::camera::Projection as _;
use crate::render::film::TILE;
use crate::render::sampler::{Sampler, pixel_key};
use crate::spacetime::Displacement;

/// How far outside a triangle samples may still count as inside, pixels: twice the bound on edge functions in f32 (`tile`).
const BESIDE: f64 = 2e-5;

/// More than the rounding error of f32.
const ROUNDING: f64 = 1.0 / (1u32 << 23) as f64;

/// The part of the film that a triangle can reach, pixels: left, top, right, bottom.
#[derive(Debug, Clone, Copy)]
pub(super) struct ScreenBounds(pub [f32; 4]);

impl ScreenBounds {
    /// For a triangle that reaches several tiles.
    pub const SEVERAL: u32 = u32::MAX;

    /// The index of the only tile of a film of `size` pixels that it reaches, or [`ScreenBounds::SEVERAL`].
    #[inline(always)]
    pub fn tile(&self, size: [u32; 2]) -> u32 {
        let ScreenBounds([left, top, right, bottom]) = *self;
        let last = size.map(|n| (n - 1) as f32);
        let (left, right) = (tiles(left.min(last[0])), tiles(right.min(last[0])));
        let (top, bottom) = (tiles(top.min(last[1])), tiles(bottom.min(last[1])));
        // All tiles of a film can be counted in u32: it has fewer than 2³² pixels.
        let only = top * size[0].div_ceil(TILE) + left;
        match (left == right) & (top == bottom) {
            true => only,
            false => ScreenBounds::SEVERAL,
        }
    }

    /// Its pixels within those from column and row `first` to column and row `last`, counted from `first`: first column and row, last
    /// column and row.
    #[inline(always)]
    pub fn pixels(&self, first: [u32; 2], last: [u32; 2]) -> [u32; 4] {
        let ScreenBounds([left, top, right, bottom]) = *self;
        let within = |x: f32, axis: usize| (x as u32).clamp(first[axis], last[axis]) - first[axis];
        [
            within(left, 0),
            within(top, 1),
            within(right, 0),
            within(bottom, 1),
        ]
    }
}

/// The integer part of a number from 0 to 2²³, from the last digits of its sum with 2²³: no vector conversion truncates out-of-range
/// values.
#[inline(always)]
pub(super) fn whole(x: f32) -> u32 {
    const BEFORE: f32 = (1u32 << 23) as f32;
    (x.floor() + BEFORE).to_bits() - BEFORE.to_bits()
}

/// The number of whole tiles in the pixels before a point in a row or a column.
#[inline(always)]
fn tiles(x: f32) -> u32 {
    whole(x * (1.0 / TILE as f32))
}

/// The surroundings of the film in which a triangle's image is searched.
#[derive(Debug)]
pub(super) struct Frustum {
    sides: [DVec3; 4],
    size: [f64; 2],
}

/// The edges of the film: its size, pixels.
#[derive(Debug, Clone, Copy)]
pub(super) struct FilmEdges {
    size: [f64; 2],
}

impl FilmEdges {
    /// Columns and rows of pixels.
    #[inline(always)]
    pub fn pixels(self) -> [u32; 2] {
        self.size.map(|n| n as u32)
    }

    /// Whether anything with these bounds (left, top, right and bottom) can reach the film, and which part of it.
    #[inline(always)]
    pub fn reach(self, [left, top, right, bottom]: [f64; 4]) -> (bool, [f32; 4]) {
        let [width, height] = self.size;
        // NaN is not outside: undecided cases are kept.
        let outside = (right < -BESIDE) | (bottom < -BESIDE) | (left > width) | (top > height);
        let within = |x: f64, size: f64| x.max(0.0).min(size);
        // Widened by at least the rounding error of f32.
        let before = |x: f64, size: f64| (within(x - BESIDE, size) * (1.0 - ROUNDING)) as f32;
        let after = |x: f64, size: f64| (within(x + BESIDE, size) * (1.0 + ROUNDING)) as f32;
        let reach = [
            before(left, width),
            before(top, height),
            after(right, width),
            after(bottom, height),
        ];
        (!outside, reach)
    }
}

/// The samples of a film with one for each pixel: most triangles smaller than a pixel contain none.
#[derive(Debug)]
pub(super) struct SoleSamples {
    size: [u32; 2],
    /// Their film points, row by row.
    points: Vec<[f32; 2]>,
}

impl SoleSamples {
    /// The samples that `sampler`, which has one for each pixel, puts into a film of `size` pixels.
    pub fn new(sampler: &Sampler, size: [u32; 2]) -> Self {
        let width = size[0] as usize;
        let mut points = vec![[0.0; 2]; width * size[1] as usize];
        let (within, salt) = sampler.replicate(0);
        let rows = (0..).zip(points.chunks_mut(width));
        let (mut x, mut y) = (vec![0.0; width], vec![0.0; width]);
        let mut keys = Vec::with_capacity(width);
        for (row, points) in rows {
            keys.clear();
            keys.extend((0..size[0]).map(|column| pixel_key(column, row) ^ salt));
            sampler.offsets(&keys, within, &mut x, &mut y);
            for ((column, point), (x, y)) in (0u32..).zip(points).zip(x.iter().zip(&y)) {
                *point = [(f64::from(column) + x) as f32, (f64::from(row) + y) as f32];
            }
        }
        SoleSamples { size, points }
    }

    /// Whether a triangle that can reach this part of the film contains none of them. Not known, and false, if it is larger than a pixel.
    #[inline(always)]
    pub fn miss(&self, reach: ScreenBounds) -> bool {
        let ScreenBounds([left, top, right, bottom]) = reach;
        let last = self.size.map(|n| n - 1);
        let [column, row, last_column, last_row] = reach.pixels([0; 2], last);
        // Rounding to f32 keeps the order of numbers, so that none inside is missed.
        let holds = |column: u32, row: u32| {
            let [x, y] = self.points[row as usize * self.size[0] as usize + column as usize];
            (x >= left) & (x <= right) & (y >= top) & (y <= bottom)
        };
        let is_small = (last_column - column <= 1) & (last_row - row <= 1);
        is_small
            && !(holds(column, row)
                | holds(last_column, row)
                | holds(column, last_row)
                | holds(last_column, last_row))
    }
}

/// The number of triangles whose reach is computed together.
pub(super) const LOT: usize = 64;

/// Triangles that are entirely in front of the camera, and their reach; others, whose z is not above 0 everywhere, are left out.
pub(super) struct Before {
    /// By corner, the film point and z.
    pub corners: [[[f64; LOT]; 3]; 3],
    pub kinds: [Kind; LOT],
    /// The part of the film that visible triangles can reach, and its only tile.
    pub reach: [[f32; LOT]; 4],
    pub tiles: [u32; LOT],
}

/// The result for a triangle.
pub(super) type Kind = u32;
/// It is outside the film.
pub(super) const UNSEEN: Kind = 0;
/// It is in front of the camera, and can reach the film.
pub(super) const SEEN: Kind = 1;
/// Undecided.
pub(super) const UNKNOWN: Kind = 2;

impl Before {
    pub const EMPTY: Before = Before {
        corners: [[[0.0; LOT]; 3]; 3],
        kinds: [UNKNOWN; LOT],
        reach: [[0.0; LOT]; 4],
        tiles: [0; LOT],
    };
}

/// The loop over triangles that computes their reach.
pub(super) struct ReachAll<'a> {
    pub lot: &'a mut Before,
    pub film: FilmEdges,
}

impl VectorLoop for ReachAll<'_> {
    #[inline(always)]
    fn run(self) {
        let Before {
            corners,
            kinds,
            reach,
            tiles,
        } = self.lot;
        let [[ax, ay, az], [bx, by, bz], [cx, cy, cz]] = corners;
        let [left, top, right, bottom] = reach;
        for at in 0..LOT {
            let bounds = [
                ax[at].min(bx[at]).min(cx[at]),
                ay[at].min(by[at]).min(cy[at]),
                ax[at].max(bx[at]).max(cx[at]),
                ay[at].max(by[at]).max(cy[at]),
            ];
            let (is_seen, [l, t, r, b]) = self.film.reach(bounds);
            (left[at], top[at], right[at], bottom[at]) = (l, t, r, b);
            let kind = if is_seen { SEEN } else { UNSEEN };
            let is_known = is_before(az[at], bz[at], cz[at]);
            kinds[at] = if is_known { kind } else { UNKNOWN };
        }
        let size = self.film.pixels();
        for at in 0..LOT {
            tiles[at] = ScreenBounds([left[at], top[at], right[at], bottom[at]]).tile(size);
        }
    }
}

/// Whether points with these z are all in front of the camera, and, up to rounding, none is in its plane.
#[inline(always)]
pub(super) fn is_before(a: f64, b: f64, c: f64) -> bool {
    a.min(b).min(c) > 1e-9 * a.abs().max(b.abs()).max(c.abs())
}

impl Frustum {
    pub fn of(projection: &ApparentProjection) -> Self {
        Frustum {
            sides: projection.linear().sides,
            size: projection.film().size(),
        }
    }

    /// Whether the triangle with these positions c, and every part of it, however it is divided, is seen outside the film.
    pub fn misses(
        &self,
        projection: &ApparentProjection,
        [a, b, c]: [DVec3; 3],
        film: [DVec3; 3],
    ) -> bool {
        // Most triangles that are divided have a corner on the film.
        if film.into_iter().any(|h| self.is_inside(h)) {
            return false;
        }
        let centre = (a + b + c) / 3.0;
        let radius = centre
            .distance(a)
            .max(centre.distance(b))
            .max(centre.distance(c));
        let distance = centre.length();
        // sin α of the cone about the centre that holds the triangle; 1e-9 covers the rounding of these few steps.
        let sine = radius / distance * (1.0 + 1e-9);
        if sine.is_nan() || sine >= 1.0 {
            return false;
        }
        let cosine = ((1.0 - sine) * (1.0 + sine)).sqrt();
        let normal = Displacement::new(-cosine, centre / distance);
        let (t, axis) = projection.in_camera(normal);
        // In the camera's frame the cone is k·N ≥ 0 again; it misses a side that lies beyond its angle.
        let length = axis.length();
        // N·N = sin²α is the same in all frames, so that in the camera's the sine is `sine`/`length`; 1e-9 covers the roundings.
        // A cone as wide as a hemisphere or wider may reach around any side.
        let narrow = t < 0.0;
        narrow
            && self
                .sides
                .iter()
                .any(|side| side.dot(axis) < -sine * (1.0 + 1e-9) - 1e-9 * length)
    }

    /// The part of the film that a flat triangle can reach: left, top, right, bottom. `None` if it is outside the film.
    #[inline]
    pub fn reach(&self, [a, b, c]: [&Vertex; 3]) -> Option<ScreenBounds> {
        let bounds = match is_before(a.film.z, b.film.z, c.film.z) {
            true => {
                let [a, b, c] = [a, b, c].map(|v| v.film.truncate() / v.film.z);
                let (least, most) = (a.min(b).min(c), a.max(b).max(c));
                [least.x, least.y, most.x, most.y]
            }
            false => self.bounds_beside([a.film, b.film, c.film])?,
        };
        let (is_seen, reach) = self.edges().reach(bounds);
        is_seen.then_some(ScreenBounds(reach))
    }

    /// Whether a point is seen on the film.
    fn is_inside(&self, h: DVec3) -> bool {
        let [width, height] = self.size;
        // Times z, without a division. Behind the camera z < 0, and no x z is between 0 and width z.
        (h.x >= 0.0) & (h.x <= width * h.z) & (h.y >= 0.0) & (h.y <= height * h.z)
    }

    /// The edges of the film.
    #[inline(always)]
    pub fn edges(&self) -> FilmEdges {
        FilmEdges { size: self.size }
    }

    /// The bounds of a triangle that may be partly behind the camera.
    #[cold]
    fn bounds_beside(&self, film: [DVec3; 3]) -> Option<[f64; 4]> {
        match film.iter().all(|h| h.z <= 0.0) {
            true => None,
            false => bounds(&self.clipped(film)),
        }
    }

    /// The part of the triangle that is seen on the film, as a polygon (Sutherland & Hodgman 1974).
    fn clipped(&self, film: [DVec3; 3]) -> Vec<DVec3> {
        let [width, height] = self.size;
        // 0 ≤ x ≤ width and 0 ≤ y ≤ height, times z: for example width z − x z ≥ 0.
        let planes = [
            DVec3::new(1.0, 0.0, 0.0),
            DVec3::new(-1.0, 0.0, width),
            DVec3::new(0.0, 1.0, 0.0),
            DVec3::new(0.0, -1.0, height),
        ];
        let mut polygon = film.to_vec();
        for plane in planes {
            polygon = clip(&polygon, plane);
        }
        polygon
    }
}

fn clip(polygon: &[DVec3], plane: DVec3) -> Vec<DVec3> {
    let mut inside = Vec::with_capacity(polygon.len() + 1);
    for (at, b) in polygon.iter().enumerate() {
        let a = polygon[(at + polygon.len() - 1) % polygon.len()];
        // Where the edge from a to b crosses the plane, its point there; then b, if it is inside.
        let (before, after) = (plane.dot(a), plane.dot(*b));
        if (before < 0.0) != (after < 0.0) {
            inside.push(a + (*b - a) * (before / (before - after)));
        }
        if after >= 0.0 {
            inside.push(*b);
        }
    }
    inside
}

/// Least and greatest x and y: left, top, right, bottom.
fn bounds(polygon: &[DVec3]) -> Option<[f64; 4]> {
    let start = [
        f64::INFINITY,
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::NEG_INFINITY,
    ];
    // Points that are not in front of the camera have no film point.
    let found = polygon.iter().filter(|h| h.z > 0.0).fold(start, |b, h| {
        let (x, y) = (h.x / h.z, h.y / h.z);
        [b[0].min(x), b[1].min(y), b[2].max(x), b[3].max(y)]
    });
    (found[0] <= found[2]).then_some(found)
}
