//! The distinct corners of a rest frame's triangles, moved to where they appear: each once.

use glam::DVec3;
use rayon::prelude::*;

use crate::accel::vectors::{VectorLoop, dispatch};
use crate::approximate::projection::{Apparent, Projection};

pub(super) use crate::approximate::projection::ApparentVertex as Vertex;

/// So many vertices are transformed at once.
const BLOCK: usize = 64;
/// So many are one task.
const TASK: usize = 64 * BLOCK;

/// A vertex that has yet to be transformed.
const NOWHERE: Vertex = Vertex {
    c: DVec3::ZERO,
    film: DVec3::ZERO,
    point: [0.0; 2],
    scale: 0.0,
};

/// The vertices at `positions`, metres in the rest frame of `projection`.
pub(super) fn transformed(projection: &Projection, positions: &[DVec3]) -> Vec<Vertex> {
    let mut vertices = vec![NOWHERE; positions.len()];
    let tasks = vertices
        .par_chunks_mut(TASK)
        .zip(positions.par_chunks(TASK));
    tasks.for_each(|(vertices, positions)| transform(projection, positions, vertices));
    vertices
}

/// Appends the vertices at those of `positions` that `vertices` does not hold yet.
pub(super) fn extend(projection: &Projection, positions: &[DVec3], vertices: &mut Vec<Vertex>) {
    let known = vertices.len();
    vertices.resize(positions.len(), NOWHERE);
    transform(projection, &positions[known..], &mut vertices[known..]);
}

fn transform(projection: &Projection, positions: &[DVec3], vertices: &mut [Vertex]) {
    dispatch(Transform {
        apparent: projection.apparent(),
        positions,
        vertices,
    });
}

/// The loop over vertices.
struct Transform<'a> {
    apparent: &'a Apparent,
    positions: &'a [DVec3],
    vertices: &'a mut [Vertex],
}

impl VectorLoop for Transform<'_> {
    #[inline(always)]
    fn run(self) {
        let blocks = self.positions.chunks(BLOCK);
        for (positions, vertices) in blocks.zip(self.vertices.chunks_mut(BLOCK)) {
            transform_block(self.apparent, positions, vertices);
        }
    }
}

/// One array for each number of a vertex, so that vectors hold one number of many vertices.
#[inline(always)]
fn transform_block(apparent: &Apparent, positions: &[DVec3], vertices: &mut [Vertex]) {
    let mut x = [[0.0; BLOCK]; 3];
    let count = positions.len().min(BLOCK);
    for k in 0..count {
        x[0][k] = positions[k].x;
        x[1][k] = positions[k].y;
        x[2][k] = positions[k].z;
    }
    let mut seen = [[0.0; BLOCK]; 9];
    for k in 0..BLOCK {
        let vertex = apparent.vertex(DVec3::new(x[0][k], x[1][k], x[2][k]));
        seen[0][k] = vertex.c.x;
        seen[1][k] = vertex.c.y;
        seen[2][k] = vertex.c.z;
        seen[3][k] = vertex.film.x;
        seen[4][k] = vertex.film.y;
        seen[5][k] = vertex.film.z;
        seen[6][k] = vertex.point[0];
        seen[7][k] = vertex.point[1];
        seen[8][k] = vertex.scale;
    }
    for (k, vertex) in vertices.iter_mut().enumerate().take(count) {
        *vertex = Vertex {
            c: DVec3::new(seen[0][k], seen[1][k], seen[2][k]),
            film: DVec3::new(seen[3][k], seen[4][k], seen[5][k]),
            point: [seen[6][k], seen[7][k]],
            scale: seen[8][k],
        };
    }
}
