//! Fragments: what samples see of the triangles that cover them, in the terms of the ray tracer.
//!
//! With eᵢ of a small triangle, its corners' places cᵢ and weights (uᵢ, vᵢ) on the triangle of the tree,
//!
//! ```text
//! (c, u, v) = Σ eᵢ·p (cᵢ, uᵢ, vᵢ) / Σ eᵢ·p,
//! ```
//!
//! six linear functions of the film point over a seventh, which are worked out once for each triangle that is seen at
//! all. From c the look direction and the distance follow.

use glam::DVec3;

use super::draw::{RayBatch, TileSamples};
use super::tile::Gathered;
use super::triangles::{Triangles, is_front};
use crate::accel::Hit;
use crate::accel::vectors::{VectorLoop, dispatch};
use crate::approximate::projection::{Apparent, Projection};
use crate::camera::RayOrigin;
use crate::render::film::Tile;
use crate::render::trace::{HitBuffer, SurfaceHit};
use crate::spacetime::{Boost, Direction, Displacement, Rest, World};

/// A small triangle that is seen, as functions of the point (x, y, 1) of the tile.
#[derive(Debug)]
pub(super) struct Surface {
    /// Σ eᵢ.
    sum: DVec3,
    /// Σ eᵢ cᵢ, by coordinate.
    c: [DVec3; 3],
    /// Σ eᵢ (uᵢ, vᵢ).
    weights: [DVec3; 2],
    /// Σ eᵢ (tᵢ, Wᵢ), where they are interpolated: time of emission relative to the shot in the rest frame, metres,
    /// and wavelength ratio.
    attributes: Option<[DVec3; 2]>,
    frame: u32,
    /// The slot and the triangle of the tree, and whether its front is seen.
    slot: u32,
    triangle: u32,
    front: bool,
}

impl Surface {
    /// What is seen of a triangle of `tile`.
    pub fn of(all: &Triangles, triangle: &Gathered, tile: Tile) -> Surface {
        let batch = &all.batches[triangle.batch as usize];
        let piece = &batch.pieces[triangle.piece as usize];
        let (rest, projection) = (
            &all.frames[batch.frame as usize],
            &all.projections[batch.frame as usize],
        );
        let vertices = batch.corners(&all.seen[batch.frame as usize], piece);
        // eᵢ relative to the tile's corner.
        let [left, top] = tile.corner.map(f64::from);
        let film = vertices.map(|v| v.film);
        let [a, b, c] = film.map(|h| DVec3::new(h.x - left * h.z, h.y - top * h.z, h.z));
        let e = [b.cross(c), c.cross(a), a.cross(b)];
        let sum_of = |values: [f64; 3]| e[0] * values[0] + e[1] * values[1] + e[2] * values[2];
        let corners = rest.bvh.corners(piece.slot);
        let known = rest.shared_vertices().corners[piece.slot as usize];
        let weights = piece.corners.map(|index| {
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
        let attributes = all.has_interpolated_attributes().then(|| {
            let known = weights.map(|weights| attributes(projection, place(corners, weights)));
            [0, 1].map(|k| sum_of(known.map(|values| values[k])))
        });
        Surface {
            sum: e[0] + e[1] + e[2],
            c: [
                sum_of(vertices.map(|v| v.c.x)),
                sum_of(vertices.map(|v| v.c.y)),
                sum_of(vertices.map(|v| v.c.z)),
            ],
            weights: [0, 1].map(|k| sum_of(weights.map(|weights| weights[k]))),
            attributes,
            frame: batch.frame,
            slot: piece.slot,
            triangle: rest.bvh.triangle(piece.slot).0,
            front: is_front(corners, projection),
        }
    }

    /// Barycentric weights of its second and third corner at p = (x, y, 1) over Σ eᵢ·(x, y, 1). Samples are on the triangle but
    /// for rounding.
    #[inline(always)]
    fn barycentric(&self, p: DVec3) -> [f64; 2] {
        let [u, v] = self.weights.map(|weight| weight.dot(p));
        let u = u.clamp(0.0, 1.0);
        [u, v.max(0.0).min(1.0 - u)]
    }

    /// Whether it is there at the point (x, y) of the tile, and not a hole.
    pub fn is_opaque(&self, all: &Triangles, x: f64, y: f64) -> bool {
        let p = DVec3::new(x, y, 1.0);
        let weights = self.barycentric(p / self.sum.dot(p));
        let rest = &all.frames[self.frame as usize];
        rest.bvh.is_opaque(self.triangle, weights)
    }
}

/// The point of a triangle with these weights of its second and third corner.
fn place([a, b, c]: [DVec3; 3], [u, v]: [f64; 2]) -> DVec3 {
    a + (b - a) * u + (c - a) * v
}

/// The weights of the second and third corner of a triangle at the point `x` in its plane.
fn weights([a, b, c]: [DVec3; 3], x: DVec3) -> [f64; 2] {
    // Scaled, so that products stay within range.
    let (e1, e2) = (b - a, c - a);
    let scale = 1.0 / e1.abs().max(e2.abs()).max_element();
    let (e1, e2, p) = (e1 * scale, e2 * scale, (x - a) * scale);
    let n = e1.cross(e2);
    [p.cross(e2).dot(n), e1.cross(p).dot(n)].map(|part| part / n.length_squared())
}

/// Time of emission relative to the shot in the rest frame, metres, and W, of the point `x`.
fn attributes(projection: &Projection, x: DVec3) -> [f64; 2] {
    projection.image(x).map_or([f64::NAN; 2], |image| {
        let (_, emission) = projection.emission(image.d, image.s);
        [emission.ct, projection.wavelength_ratio(image.d)]
    })
}

/// The fragments of one sample of each pixel of a tile.
#[derive(Debug, Default)]
pub(super) struct Fragments {
    /// Their places c, metres; a unit vector where nothing is seen.
    c: Vec<DVec3>,
    /// World distances, metres.
    distances: Vec<f64>,
    /// Runs of fragments in one rest frame: the frame, and where the run begins.
    runs: Vec<(u32, usize)>,
    /// Interpolated time of emission and W.
    attributes: Vec<[f64; 2]>,
}

impl Fragments {
    /// Forgets all.
    pub fn start(&mut self) {
        self.c.clear();
        self.runs.clear();
        self.attributes.clear();
    }

    /// Adds what the sample at point (x, y) of the tile sees of `surface`, and what is known of it to `hits`.
    #[inline]
    pub fn add(&mut self, surface: Option<&Surface>, x: f64, y: f64, hits: &mut HitBuffer) {
        let fragment = surface.and_then(|surface| {
            let p = DVec3::new(x, y, 1.0);
            let scale = 1.0 / surface.sum.dot(p);
            let [cx, cy, cz] = &surface.c;
            let c = DVec3::new(cx.dot(p) * scale, cy.dot(p) * scale, cz.dot(p) * scale);
            // None at the camera's own place.
            let is_seen = c.is_finite() && c != DVec3::ZERO;
            is_seen.then_some((surface, p * scale, c))
        });
        let Some((surface, p, c)) = fragment else {
            self.c.push(DVec3::Z);
            self.attributes.push([f64::NAN; 2]);
            return hits.push(None);
        };
        if self.runs.last().is_none_or(|run| run.0 != surface.frame) {
            self.runs.push((surface.frame, self.c.len()));
        }
        self.c.push(c);
        if let Some(known) = surface.attributes {
            self.attributes.push(known.map(|value| value.dot(p)));
        }
        let [u, v] = surface.barycentric(p);
        let hit = Hit {
            s: 0.0,
            u,
            v,
            triangle: surface.triangle,
            slot: surface.slot,
            front: surface.front,
        };
        hits.push(Some(SurfaceHit {
            hit,
            frame: surface.frame,
        }));
    }

    /// Fills `rays` with the rays that meet the fragments at their own events of emission, or at those that are
    /// interpolated.
    pub fn finish(&mut self, all: &Triangles, samples: &TileSamples, rays: &mut RayBatch) {
        let count = self.c.len();
        rays.directions.resize(count, DVec3::Z);
        self.distances.resize(count, 0.0);
        rays.ratios.extend_from_slice(&samples.camera_rays.ratios);
        // What comes before the first run sees nothing.
        let ends = self.runs.iter().skip(1).map(|run| run.1).chain([count]);
        for ((frame, begin), end) in self.runs.iter().zip(ends) {
            let projection = &all.projections[*frame as usize];
            let boost = all.frames[*frame as usize].frame.frame_from_world();
            dispatch(Look {
                apparent: projection.apparent(),
                boost,
                c: &self.c[*begin..end],
                sampled: &samples.camera_rays.directions[*begin..end],
                directions: &mut rays.directions[*begin..end],
                distances: &mut self.distances[*begin..end],
                ratios: &mut rays.ratios[*begin..end],
            });
        }
        rays.hits.set_distances(&self.distances);
        if all.has_interpolated_attributes() {
            self.interpolate(all, samples, rays);
        }
    }

    /// Turns rays to those that meet the fragments at interpolated times, and have interpolated W.
    fn interpolate(&self, all: &Triangles, samples: &TileSamples, rays: &mut RayBatch) {
        let at_shot = RayOrigin {
            delay: samples.index,
            ..RayOrigin::AT_SHOT
        };
        rays.origins.resize(self.c.len(), at_shot);
        for (ray, [time, w]) in self.attributes.iter().enumerate() {
            let Some(SurfaceHit { hit, frame }) = rays.hits.hit(ray) else {
                continue;
            };
            let rest = &all.frames[frame as usize];
            // The point of the triangle, at the interpolated time in place of its retarded one, from the camera.
            let x = place(rest.bvh.corners(hit.slot), [hit.u, hit.v]);
            let from = x - all.projections[frame as usize].origin();
            let world = rest
                .frame
                .world_from_frame()
                .displacement(Displacement::new(*time, from));
            let s = world.x.length();
            if let Some(d) = Direction::new(world.x) {
                rays.directions[ray] = d.unit();
                // The time that light would have had to take, per metre of its way.
                rays.origins[ray].delay = -world.ct / s;
                rays.ratios[ray] = samples.ratio_of(*w, frame, d);
                rays.hits.set_distance(ray, s);
            }
        }
    }
}

/// The loop over fragments of one rest frame.
struct Look<'a> {
    apparent: &'a Apparent,
    boost: &'a Boost<Rest, World>,
    c: &'a [DVec3],
    /// The look directions of the samples.
    sampled: &'a [DVec3],
    directions: &'a mut [DVec3],
    distances: &'a mut [f64],
    ratios: &'a mut [f64],
}

impl VectorLoop for Look<'_> {
    #[inline(always)]
    fn run(self) {
        let count = self.c.len();
        let (directions, distances) = (&mut self.directions[..count], &mut self.distances[..count]);
        for k in 0..count {
            let c = self.c[k];
            let (d, s) = self.apparent.look(c, c.length());
            directions[k] = d.unit();
            distances[k] = s;
        }
        if self.boost.is_identity() {
            return;
        }
        // W as the sample's own direction gives it: shading multiplies by what the fragment's direction gives.
        let (sampled, ratios) = (&self.sampled[..count], &mut self.ratios[..count]);
        for k in 0..count {
            let (_, own) = self.boost.direction(Direction::from_unit(sampled[k]));
            let (_, taken) = self.boost.direction(Direction::from_unit(directions[k]));
            ratios[k] *= own / taken;
        }
    }
}
