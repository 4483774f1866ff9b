//! Tessellation: triangles divided until straight edges will do.
//!
//! Each edge is halved, or not, by its two ends alone, and its halves likewise: triangles that share it
//! divide it alike, and no cracks open. A triangle is cut by those of its edges that are halved into two,
//! three or four, and so on.
//!
//! *Uniform*: an edge longer than L is halved, so that all are at most L and longer than L/2, or whole.
//!
//! *Adaptive*: with Δ of [`apparent`](crate::apparent), an edge is halved where
//!
//! ```text
//! 4/3 · max |Δ/δ| · |c_A × c_B|² / (8 |c|³_min) > ε,
//! ```
//!
//! |c|_min being that of its nearest point and |Δ/δ| that of the end where a metre is more. |c| is convex,
//! its second derivative largest at the nearest point, so that this bounds δ wherever on the edge. Within a
//! triangle whose edges are all at most L, δ is at most 4/3 of what it can be on an edge (Jung: it lies in a
//! circle of radius L/√3). Ends beside the film, or behind the camera, count as if they were in its corner,
//! where a radian has most pixels.

use glam::DVec3;

use super::Tessellation;
use super::batch::Parts;
use super::cull::Frustum;
use crate::apparent::{Image, Sight};

/// So often an edge is halved at most: 10⁻⁹ of it is left.
const DEEPEST: u32 = 30;

/// A point of a triangle that is being divided.
#[derive(Debug, Clone, Copy)]
pub(super) struct Corner {
    /// In the rest frame, metres.
    pub x: DVec3,
    /// See [`apparent`](crate::apparent).
    pub c: DVec3,
    pub image: Image,
    /// Barycentric weights of the second and third corner of the triangle.
    pub weights: [f64; 2],
    /// |c| |Δ/δ|, pixels; 0 where nobody asks.
    scale: f64,
    /// Its index among the vertices.
    pub index: u32,
}

/// The up to four parts of a triangle; none where a corner cannot be seen.
type Cut = Option<[Option<[Corner; 3]>; 4]>;

/// Divides triangles of one rest frame.
#[derive(Debug)]
pub(super) struct Divider<'a> {
    pub sight: &'a Sight<'a>,
    pub frustum: &'a Frustum,
    pub tessellation: Tessellation,
    /// Pixels per radian in the corner of the film.
    density: f64,
}

impl<'a> Divider<'a> {
    pub fn new(sight: &'a Sight<'a>, frustum: &'a Frustum, tessellation: Tessellation) -> Self {
        Divider {
            sight,
            frustum,
            tessellation,
            density: sight.film().density(),
        }
    }

    /// Makes the corner at `x` one of the vertices; none at the place of the camera.
    fn corner(&self, x: DVec3, weights: [f64; 2], parts: &mut Parts) -> Option<Corner> {
        let c = self.sight.optical(x);
        let image = self.sight.image_of(c)?;
        Some(Corner {
            x,
            c,
            image,
            weights,
            scale: match self.tessellation {
                Tessellation::Adaptive(_) => self.scale(c, &image),
                _ => 0.0,
            },
            index: parts.add(weights, &image),
        })
    }

    /// |c| |Δ/δ| in pixels.
    fn scale(&self, c: DVec3, image: &Image) -> f64 {
        let [width, height] = self.sight.film().size();
        let near = |x: f64, size: f64| x > -0.5 * size && x < 1.5 * size;
        let pixels = match (image.film_point(), self.sight.slide(image.film)) {
            (Some([x, y]), Some([u, v])) if near(x, width) && near(y, height) => {
                (u * u + v * v).sqrt()
            }
            _ => self.density * self.sight.turn(image),
        };
        c.length() * pixels
    }

    /// Whether the edge is halved.
    fn halves(&self, a: &Corner, b: &Corner) -> bool {
        match self.tessellation {
            Tessellation::None => false,
            Tessellation::Uniform(length) => a.x.distance_squared(b.x) > length * length,
            Tessellation::Adaptive(pixels) => self.error(a, b) > pixels,
        }
    }

    /// A bound on how far points are drawn from their places, pixels. It is the same from either end.
    fn error(&self, a: &Corner, b: &Corner) -> f64 {
        let e = b.c - a.c;
        let cross = a.c.cross(b.c).length_squared();
        let between = a.c.dot(e) < 0.0 && b.c.dot(e) > 0.0;
        let nearest = match between {
            true => cross / e.length_squared(),
            false => a.c.length_squared().min(b.c.length_squared()),
        };
        // |c|² of the nearest point, squared: one |c| for the scale.
        4.0 / 3.0 / 8.0 * a.scale.max(b.scale) * cross / (nearest * nearest)
    }

    /// Divides the triangle with these corners, in the rest frame, into `parts`.
    pub fn divide(&self, [a, b, c]: [DVec3; 3], parts: &mut Parts) {
        let corners = (
            self.corner(a, [0.0, 0.0], parts),
            self.corner(b, [1.0, 0.0], parts),
            self.corner(c, [0.0, 1.0], parts),
        );
        if let (Some(a), Some(b), Some(c)) = corners {
            self.divide_by([a, b, c], DEEPEST, parts);
        }
    }

    /// Of the edges opposite to each corner, which are halved.
    fn edges(&self, [a, b, c]: &[Corner; 3]) -> [bool; 3] {
        [self.halves(b, c), self.halves(c, a), self.halves(a, b)]
    }

    fn divide_by(&self, mut corners: [Corner; 3], depth: u32, parts: &mut Parts) {
        let halved = self.edges(&corners);
        if halved == [false; 3] || depth == 0 {
            return parts.keep(&corners, self.frustum);
        }
        if parts.is_full()
            || self
                .frustum
                .misses(self.sight, corners.map(|corner| corner.c))
        {
            return;
        }
        let count = halved.iter().filter(|h| **h).count();
        // Turned so that the one edge that differs from the others is opposite to the first corner.
        let first = match count {
            1 => halved.iter().position(|h| *h),
            2 => halved.iter().position(|h| !*h),
            _ => None,
        };
        corners.rotate_left(first.unwrap_or(0));
        let cut = match count {
            1 => self.two(&corners, parts),
            2 => self.three(&corners, parts),
            _ => self.four(&corners, parts),
        };
        for part in cut.into_iter().flatten().flatten() {
            self.divide_by(part, depth - 1, parts);
        }
    }

    fn middle(&self, a: &Corner, b: &Corner, parts: &mut Parts) -> Option<Corner> {
        let x = (a.x + b.x) * 0.5;
        let weights = [0, 1].map(|i| (a.weights[i] + b.weights[i]) * 0.5);
        self.corner(x, weights, parts)
    }

    /// Cut by the middle of the edge opposite to the first corner.
    fn two(&self, [a, b, c]: &[Corner; 3], parts: &mut Parts) -> Cut {
        let m = self.middle(b, c, parts)?;
        Some([Some([*a, *b, m]), Some([*a, m, *c]), None, None])
    }

    /// Cut by the middles of the two edges at the first corner, and by the shorter diagonal.
    fn three(&self, [a, b, c]: &[Corner; 3], parts: &mut Parts) -> Cut {
        let (ab, ca) = (self.middle(a, b, parts)?, self.middle(c, a, parts)?);
        let [second, third] = match ab.x.distance_squared(c.x) <= ca.x.distance_squared(b.x) {
            true => [[ab, *b, *c], [ab, *c, ca]],
            false => [[ab, *b, ca], [*b, *c, ca]],
        };
        Some([Some([*a, ab, ca]), Some(second), Some(third), None])
    }

    fn four(&self, [a, b, c]: &[Corner; 3], parts: &mut Parts) -> Cut {
        let ab = self.middle(a, b, parts)?;
        let bc = self.middle(b, c, parts)?;
        let ca = self.middle(c, a, parts)?;
        Some([
            Some([*a, ab, ca]),
            Some([ab, *b, bc]),
            Some([ca, bc, *c]),
            Some([ab, bc, ca]),
        ])
    }
}
