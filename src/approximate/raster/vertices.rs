//! The distinct corners of a rest frame's triangles, moved to where they appear: each once.

use glam::DVec3;
use rayon::prelude::*;

use crate::accel::vectors::{BLOCK, VectorLoop, dispatch};
use crate::approximate::projection::{Apparent, ApparentProjection, VertexBlock};

pub(super) use crate::approximate::projection::ApparentVertex as Vertex;

/// Number of vertices of a task.
const TASK: usize = 64 * BLOCK;

/// A vertex that has yet to be transformed.
const NOWHERE: Vertex = Vertex {
    c: DVec3::ZERO,
    film: DVec3::ZERO,
    point: [0.0; 2],
    scale: 0.0,
};

/// The vertices at `positions`, metres in the rest frame of `projection`.
pub(super) fn transformed(projection: &ApparentProjection, positions: &[DVec3]) -> Vec<Vertex> {
    let mut vertices = vec![NOWHERE; positions.len()];
    let tasks = vertices
        .par_chunks_mut(TASK)
        .zip(positions.par_chunks(TASK));
    tasks.for_each(|(vertices, positions)| transform(projection, positions, vertices));
    vertices
}

/// Appends the vertices at those of `positions` that `vertices` does not hold yet.
pub(super) fn extend(
    projection: &ApparentProjection,
    positions: &[DVec3],
    vertices: &mut Vec<Vertex>,
) {
    let known = vertices.len();
    vertices.resize(positions.len(), NOWHERE);
    transform(projection, &positions[known..], &mut vertices[known..]);
}

fn transform(projection: &ApparentProjection, positions: &[DVec3], vertices: &mut [Vertex]) {
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
    let mut block = VertexBlock::ZERO;
    for (at, x) in positions.iter().enumerate().take(BLOCK) {
        block.c.set(at, *x);
    }
    apparent.see(&mut block);
    for (at, vertex) in vertices.iter_mut().enumerate().take(BLOCK) {
        *vertex = block.get(at);
    }
}
