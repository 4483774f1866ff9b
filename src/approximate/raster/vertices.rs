//! The distinct corners of a rest frame's triangles, each moved once to its apparent position.

use glam::DVec3;
use rayon::prelude::*;

use super::flatness::Straight;
use crate::accel::vectors::{BLOCK, VectorLoop, dispatch, load};
use crate::approximate::projection::{Apparent, ApparentProjection, VertexBlock};
use crate::render::trace::SharedVertices;

pub(super) use crate::approximate::projection::ApparentVertex as Vertex;

/// The number of vertices whose largest |z| are found side by side.
const LANES: usize = 8;
/// The number of vertices of a task.
const TASK: usize = 64 * BLOCK;

/// A vertex that has yet to be transformed.
const NOWHERE: Vertex = Vertex {
    film: DVec3::ZERO,
    scale: 0.0,
};

/// What is read of a vertex first: the film point, pixels, and z, or −1 if it is not in front of the camera or an edge that ends there may
/// have to be cut.
pub(super) type FilmCorner = [f64; 3];

/// The vertices of a rest frame at their apparent positions.
#[derive(Debug)]
pub(super) struct ApparentVertices {
    pub all: Vec<Vertex>,
    pub corners: Vec<FilmCorner>,
    /// The largest |z| of all.
    pub farthest: f64,
}

/// The vertices `shared` of the rest frame of `projection`; `straight` is the test for edges that need no cut.
pub(super) fn transformed(
    projection: &ApparentProjection,
    shared: &SharedVertices,
    straight: Straight,
) -> ApparentVertices {
    let SharedVertices {
        positions, longest, ..
    } = shared;
    let mut all = vec![NOWHERE; positions.len()];
    let mut corners = vec![[0.0; 3]; positions.len()];
    let to = all.par_chunks_mut(TASK).zip(corners.par_chunks_mut(TASK));
    let from = positions.par_chunks(TASK).zip(longest.par_chunks(TASK));
    let farthest = to
        .zip(from)
        .map(|((vertices, corners), (positions, longest))| {
            let mut farthest = [0.0; LANES];
            dispatch(Transform {
                apparent: projection.apparent(),
                positions,
                vertices,
                corners: Some(FilmCorners {
                    longest,
                    straight,
                    corners,
                    farthest: &mut farthest,
                }),
            });
            farthest.into_iter().fold(0.0, f64::max)
        })
        .reduce(|| 0.0, f64::max);
    ApparentVertices {
        all,
        corners,
        farthest,
    }
}

/// Appends the vertices for those of `positions` that `vertices` does not contain yet.
pub(super) fn extend(
    projection: &ApparentProjection,
    positions: &[DVec3],
    vertices: &mut Vec<Vertex>,
) {
    let known = vertices.len();
    vertices.resize(positions.len(), NOWHERE);
    dispatch(Transform {
        apparent: projection.apparent(),
        positions: &positions[known..],
        vertices: &mut vertices[known..],
        corners: None,
    });
}

/// The loop over vertices.
struct Transform<'a> {
    apparent: &'a Apparent,
    positions: &'a [DVec3],
    vertices: &'a mut [Vertex],
    corners: Option<FilmCorners<'a>>,
}

/// The numbers that are read of vertices first, and the data to compute them.
struct FilmCorners<'a> {
    longest: &'a [f64],
    straight: Straight,
    corners: &'a mut [FilmCorner],
    /// The largest |z| so far, of several vertices at a time, so that they do not depend on each other.
    farthest: &'a mut [f64; LANES],
}

impl VectorLoop for Transform<'_> {
    #[inline(always)]
    fn run(self) {
        let Transform {
            apparent,
            positions,
            vertices,
            mut corners,
        } = self;
        let mut block = VertexBlock::ZERO;
        let mut begin = 0;
        for (positions, vertices) in positions.chunks(BLOCK).zip(vertices.chunks_mut(BLOCK)) {
            transform_block(apparent, positions, vertices, &mut block);
            if let Some(corners) = &mut corners {
                corners.write(apparent, begin, &block);
            }
            begin += BLOCK;
        }
    }
}

/// One array for each number of a vertex, so that vectors hold one number of many vertices.
#[inline(always)]
fn transform_block(
    apparent: &Apparent,
    positions: &[DVec3],
    vertices: &mut [Vertex],
    block: &mut VertexBlock,
) {
    for (at, x) in positions.iter().enumerate().take(BLOCK) {
        block.c.set(at, *x);
    }
    apparent.see(block);
    for (at, vertex) in vertices.iter_mut().enumerate().take(BLOCK) {
        *vertex = block.get(at);
    }
}

impl FilmCorners<'_> {
    /// Writes the numbers of `block`, which begins with vertex `begin`.
    #[inline(always)]
    fn write(&mut self, apparent: &Apparent, begin: usize, block: &VertexBlock) {
        let (mut z, longest) = ([0.0; BLOCK], load(self.longest, begin));
        // Lengths of the rest frame grow at most by this factor in c.
        let (straight, stretch) = (self.straight, apparent.most_stretch());
        for at in 0..BLOCK {
            // None of its edges needs a cut if everything within the longest of them is straight enough.
            let ends_straight =
                straight.around(block.length[at], stretch * longest[at], block.scale[at]);
            let own = block.film.get(at).z;
            // If z is not in front of the camera, the triangles at this corner are examined one by one.
            z[at] = if ends_straight & (own > 0.0) {
                own
            } else {
                -1.0
            };
        }
        let [x, y] = &block.point;
        let corners = self.corners.iter_mut().skip(begin).take(BLOCK);
        for (at, corner) in corners.enumerate() {
            *corner = [x[at], y[at], z[at]];
            let farthest = &mut self.farthest[at % LANES];
            *farthest = farthest.max(block.film.get(at).z.abs());
        }
    }
}
