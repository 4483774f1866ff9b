//! Alpha masks (glTF 2.0 §3.9.4): a surface is there where alpha, the factor of its material times its texture and the alpha of
//! its vertices, is at least the cutoff. Holes belong to the shape, not to the light: rays of cameras and shadows, of captures and
//! of bounces go through them alike, at any velocity, because masks rest where triangles do.
//!
//! Files hold cutoffs in f32, which f64 tells from the same number of a texel: f32(0.2) > 51/255. So both are compared in f32.

use std::sync::Arc;

use crate::accel::AlphaTest;
use crate::io::image::Texture;
use crate::mesh::{Mesh, TextureSampler};

/// Where the surfaces of a material have holes.
#[derive(Debug, Clone)]
pub(crate) struct AlphaMask {
    /// Factor on alpha.
    pub factor: f64,
    /// Its texture, the set of texture coordinates, and how it is looked up.
    pub texture: Option<(Arc<Texture>, usize, TextureSampler)>,
    /// The least alpha that is there.
    pub cutoff: f32,
}

/// The alpha masks of a rest frame.
#[derive(Debug)]
pub(crate) struct AlphaMasks {
    /// Runs of triangles with a mask, ascending.
    runs: Vec<MaskedRun>,
    /// Those of the rest frame.
    meshes: Arc<[Mesh]>,
}

/// Triangles of one object with one mask.
#[derive(Debug)]
pub(crate) struct MaskedRun {
    /// The first triangle, and the first one after them: indices in the frame's BVH.
    pub first: u32,
    pub end: u32,
    /// The triangle that is triangle 0 of the object.
    pub object_first: u32,
    /// Index of its mesh.
    pub mesh: u32,
    pub mask: AlphaMask,
}

impl AlphaMask {
    /// Alpha at a point of triangle `triangle` of `mesh`. Without texture coordinates, of the factor and the vertices alone.
    fn alpha(&self, mesh: &Mesh, triangle: u32, barycentric: [f64; 2]) -> f64 {
        let mut alpha = self.factor;
        if let Some((texture, set, sampler)) = &self.texture
            && let Some(uv) = mesh.uv(*set, triangle, barycentric)
        {
            alpha *= texture.sample_alpha(uv.to_array(), *sampler);
        }
        if let Some([.., of_vertices]) = mesh.colour(triangle, barycentric) {
            alpha *= of_vertices;
        }
        alpha
    }
}

impl AlphaMasks {
    /// The masks of `runs`, which ascend; none without runs.
    pub fn new(runs: Vec<MaskedRun>, meshes: Arc<[Mesh]>) -> Option<AlphaMasks> {
        (!runs.is_empty()).then_some(AlphaMasks { runs, meshes })
    }
}

impl AlphaTest for AlphaMasks {
    fn is_opaque(&self, id: u32, u: f64, v: f64) -> bool {
        let after = self.runs.partition_point(|run| run.first <= id);
        let run = after.checked_sub(1).map(|at| &self.runs[at]);
        let Some(run) = run.filter(|run| id < run.end) else {
            return true;
        };
        let mesh = &self.meshes[run.mesh as usize];
        let alpha = run.mask.alpha(mesh, id - run.object_first, [u, v]);
        alpha as f32 >= run.mask.cutoff
    }
}
