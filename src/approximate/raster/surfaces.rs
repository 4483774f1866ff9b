//! Surfaces: small visible triangles, as functions of the film point, computed in batches.
//!
//! With eᵢ of a small triangle, the positions cᵢ of its corners and their weights (uᵢ, vᵢ) on the triangle of the tree,
//!
//! ```text
//! (c, u, v) = Σ eᵢ·p (cᵢ, uᵢ, vᵢ) / Σ eᵢ·p,
//! ```
//!
//! six linear functions of the film point over a seventh, computed once for each visible triangle. Anything on which neither radiance nor
//! channels depend is left out.

use glam::DVec3;

use super::tile::Gathered;
use super::triangles::Triangles;
use super::vertices::Vertex;
use crate::accel::vectors::{VectorLoop, dispatch};
use crate::approximate::projection::ApparentProjection;
use crate::render::film::Tile;
use crate::render::trace::Dependence;

/// A small visible triangle, as functions of the point (x, y, 1) of the tile.
#[derive(Debug)]
pub(super) struct Surface {
    /// Σ eᵢ.
    pub sum: DVec3,
    /// Σ eᵢ cᵢ, by coordinate.
    pub c: [DVec3; 3],
    /// Σ eᵢ (uᵢ, vᵢ).
    weights: [DVec3; 2],
    /// Σ eᵢ (tᵢ, Wᵢ) if they are interpolated: time of emission relative to the shot in the rest frame, metres, and wavelength ratio.
    pub attributes: Option<[DVec3; 2]>,
    pub frame: u32,
    /// The slot and the triangle of the tree, and whether its front is visible.
    pub slot: u32,
    pub triangle: u32,
    pub front: bool,
}

/// The number of triangles whose functions are computed together.
const LOT: usize = 16;

/// Visible triangles, by coordinate.
#[derive(Debug)]
struct Lot {
    /// By corner, homogeneous film coordinates from the corner of the tile, and positions c.
    film: [[[f64; LOT]; 3]; 3],
    places: [[[f64; LOT]; 3]; 3],
    /// eᵢ, their sum, and Σ eᵢ cᵢ by coordinate of c.
    e: [[[f64; LOT]; 3]; 3],
    sum: [[f64; LOT]; 3],
    c: [[[f64; LOT]; 3]; 3],
    /// Whether its front is visible.
    is_front: [u32; LOT],
}

impl Lot {
    const EMPTY: Lot = Lot {
        film: [[[0.0; LOT]; 3]; 3],
        places: [[[0.0; LOT]; 3]; 3],
        e: [[[0.0; LOT]; 3]; 3],
        sum: [[0.0; LOT]; 3],
        c: [[[0.0; LOT]; 3]; 3],
        is_front: [0; LOT],
    };

    /// Sets the corners of a triangle, relative to that of the tile.
    #[inline(always)]
    fn set(&mut self, at: usize, corners: [&Vertex; 3], places: [DVec3; 3], [left, top]: [f64; 2]) {
        let to = self.film.iter_mut().zip(&mut self.places);
        for (([x, y, z], places), (corner, c)) in to.zip(corners.into_iter().zip(places)) {
            let h = corner.film;
            (x[at], y[at], z[at]) = (h.x - left * h.z, h.y - top * h.z, h.z);
            (places[0][at], places[1][at], places[2][at]) = (c.x, c.y, c.z);
        }
    }
}

/// Vector `at` of vectors by coordinate.
#[inline(always)]
fn vector([x, y, z]: &[[f64; LOT]; 3], at: usize) -> DVec3 {
    DVec3::new(x[at], y[at], z[at])
}

/// The loop over triangles that computes their functions.
struct WorkOut<'a> {
    lot: &'a mut Lot,
}

impl VectorLoop for WorkOut<'_> {
    #[inline(always)]
    fn run(self) {
        let Lot {
            film,
            places,
            e,
            sum,
            c,
            is_front,
        } = self.lot;
        // Short loops: compilers do not vectorize long ones for AVX2.
        for (k, [x, y, z]) in e.iter_mut().enumerate() {
            let (from, to) = (&film[(k + 1) % 3], &film[(k + 2) % 3]);
            for at in 0..LOT {
                let own = vector(from, at).cross(vector(to, at));
                (x[at], y[at], z[at]) = (own.x, own.y, own.z);
            }
        }
        let [ea, eb, ec] = &*e;
        for (axis, sum) in sum.iter_mut().enumerate() {
            for at in 0..LOT {
                sum[at] = ea[axis][at] + eb[axis][at] + ec[axis][at];
            }
        }
        let [a, b, third] = &*places;
        for (coordinate, of_c) in c.iter_mut().enumerate() {
            let (a, b, c) = (&a[coordinate], &b[coordinate], &third[coordinate]);
            for (axis, of_c) in of_c.iter_mut().enumerate() {
                for at in 0..LOT {
                    of_c[at] = ea[axis][at] * a[at] + eb[axis][at] * b[at] + ec[axis][at] * c[at];
                }
            }
        }
        // As in `is_front`: the map from rest coordinates to c preserves orientation.
        for (at, is_front) in is_front.iter_mut().enumerate() {
            let (a, b, c) = (vector(a, at), vector(b, at), vector(third, at));
            *is_front = u32::from((b - a).cross(c - a).dot(a) < 0.0);
        }
    }
}

/// The triangles of a tile while their functions are computed.
#[derive(Debug)]
pub(super) struct SurfaceLots {
    lot: Box<Lot>,
    pub all: Vec<Surface>,
}

impl Default for SurfaceLots {
    fn default() -> Self {
        SurfaceLots {
            lot: Box::new(Lot::EMPTY),
            all: Vec::new(),
        }
    }
}

impl SurfaceLots {
    /// Adds the visible ones among `triangles` of `tile`, whose indices are `seen`, with the functions that are needed.
    pub fn add(&mut self, all: &Triangles, tile: Tile, triangles: &[Gathered], seen: &[u32]) {
        let corner = tile.corner.map(f64::from);
        for seen in seen.chunks(LOT) {
            let begin = self.all.len();
            for (at, number) in seen.iter().enumerate() {
                let triangle = &triangles[*number as usize];
                let batch = &all.batches[triangle.batch as usize];
                let piece = &batch.pieces[triangle.piece as usize];
                let corners = batch.corners(&all.seen[batch.frame as usize], piece);
                let positions = &all.frames[batch.frame as usize].shared_vertices().positions;
                let projection = &all.projections[batch.frame as usize];
                let places = batch.places(positions, piece);
                let places = places.map(|x| projection.optical(x));
                self.lot.set(at, corners, places, corner);
                self.all.push(Surface {
                    sum: DVec3::ZERO,
                    c: [DVec3::ZERO; 3],
                    weights: [DVec3::ZERO; 2],
                    attributes: None,
                    frame: batch.frame,
                    slot: piece.slot,
                    triangle: all.frames[batch.frame as usize].bvh.triangle(piece.slot).0,
                    front: false,
                });
            }
            dispatch(WorkOut { lot: &mut self.lot });
            let has_weights = all.needed >= Dependence::Weights || all.has_holes;
            for (at, surface) in self.all[begin..].iter_mut().enumerate() {
                surface.sum = vector(&self.lot.sum, at);
                for (function, of_c) in surface.c.iter_mut().zip(&self.lot.c) {
                    *function = vector(of_c, at);
                }
                surface.front = self.lot.is_front[at] != 0;
                if has_weights {
                    let e = self.lot.e.each_ref().map(|e| vector(e, at));
                    surface.weigh(all, &triangles[seen[at] as usize], e);
                }
            }
        }
    }
}

impl Surface {
    /// Computes the functions of its weights, and of interpolated attributes; `e` are its edge functions.
    fn weigh(&mut self, all: &Triangles, triangle: &Gathered, e: [DVec3; 3]) {
        let batch = &all.batches[triangle.batch as usize];
        let piece = &batch.pieces[triangle.piece as usize];
        let rest = &all.frames[batch.frame as usize];
        let corners = rest.bvh.corners(piece.slot);
        let sum_of = |values: [f64; 3]| e[0] * values[0] + e[1] * values[1] + e[2] * values[2];
        let known = rest.shared_vertices().corners[piece.slot as usize];
        let weights = piece.corners.map(|index| {
            // A corner of the tree's triangle has its weights by definition; those of a cut follow from its position.
            match (
                known.iter().position(|own| *own == index),
                index.checked_sub(batch.shared),
            ) {
                (None, Some(cut)) => weights(corners, batch.places[cut as usize]),
                (Some(1), _) => [1.0, 0.0],
                (Some(2), _) => [0.0, 1.0],
                _ => [0.0, 0.0],
            }
        });
        self.weights = [0, 1].map(|k| sum_of(weights.map(|weights| weights[k])));
        if all.has_interpolated_attributes() {
            let projection = &all.projections[batch.frame as usize];
            let known = weights.map(|weights| attributes(projection, place(corners, weights)));
            self.attributes = Some([0, 1].map(|k| sum_of(known.map(|values| values[k]))));
        }
    }

    /// The barycentric weights of its second and third corner at p = (x, y, 1) over Σ eᵢ·(x, y, 1). Up to rounding, samples are on the
    /// triangle.
    #[inline(always)]
    pub fn barycentric(&self, p: DVec3) -> [f64; 2] {
        let [u, v] = self.weights.map(|weight| weight.dot(p));
        let u = u.clamp(0.0, 1.0);
        [u, v.max(0.0).min(1.0 - u)]
    }

    /// Whether the surface exists at the point (x, y) of the tile, rather than having a hole there.
    pub fn is_opaque(&self, all: &Triangles, x: f64, y: f64) -> bool {
        let p = DVec3::new(x, y, 1.0);
        let weights = self.barycentric(p / self.sum.dot(p));
        let rest = &all.frames[self.frame as usize];
        rest.bvh.is_opaque(self.triangle, weights)
    }
}

/// The point of a triangle with these weights of its second and third corner.
pub(super) fn place([a, b, c]: [DVec3; 3], [u, v]: [f64; 2]) -> DVec3 {
    a + (b - a) * u + (c - a) * v
}

/// The weights of the second and third corner of a triangle at the point `x` in its plane.
fn weights([a, b, c]: [DVec3; 3], x: DVec3) -> [f64; 2] {
    // Scaled, so that products stay within range.
    let (e1, e2) = (b - a, c - a);
    let scale = 1.0 / e1.abs().max(e2.abs()).max_element();
    let (e1, e2, p) = (e1 * scale, e2 * scale, (x - a) * scale);
    let n = e1.cross(e2);
    // Fractions of the area, as lengths along the normal.
    [p.cross(e2).dot(n), e1.cross(p).dot(n)].map(|part| part / n.length_squared())
}

/// Time of emission relative to the shot in the rest frame, metres, and W, of the point `x`.
fn attributes(projection: &ApparentProjection, x: DVec3) -> [f64; 2] {
    projection.image(x).map_or([f64::NAN; 2], |image| {
        let (_, emission) = projection.emission(image.d, image.s);
        [emission.ct, projection.wavelength_ratio(image.d)]
    })
}
