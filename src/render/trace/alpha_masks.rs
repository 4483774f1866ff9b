//! Alpha masks (glTF 2.0 §3.9.4): a surface exists where alpha, the product of its material's factor, its texture and its vertices'
//! alpha, is at least the cutoff. Holes belong to the shape, not to the light: camera rays, shadow rays, rays of captures and bounces all
//! pass through them, at any velocity, because masks rest with their triangles.
//!
//! Files store cutoffs in f32, which can differ from the same number of a texel in f64: f32(0.2) > 51/255. So both are compared in f32.

use std::sync::Arc;

use crate::accel::AlphaTest;
use crate::io::image::Texture;
use crate::mesh::{Mesh, TextureSampler};

/// The alpha mask of a material.
#[derive(Debug, Clone)]
pub(crate) struct AlphaMask {
    /// Factor on alpha.
    pub factor: f64,
    /// Alpha texture, the set of texture coordinates, and the sampler.
    pub texture: Option<(Arc<Texture>, usize, TextureSampler)>,
    /// The smallest alpha at which the surface exists.
    pub cutoff: f32,
}

/// The alpha masks of a rest frame.
#[derive(Debug)]
pub(crate) struct AlphaMasks {
    /// Runs of triangles with a mask, ascending.
    runs: Vec<MaskedRun>,
    /// The meshes of the rest frame.
    meshes: Arc<[Mesh]>,
}

/// Triangles of one object with one mask.
#[derive(Debug)]
pub(crate) struct MaskedRun {
    /// The first triangle, and one past the last: indices in the frame's BVH.
    pub first: u32,
    pub end: u32,
    /// The triangle that is number 0 in the object.
    pub object_first: u32,
    /// Index of its mesh.
    pub mesh: u32,
    pub mask: AlphaMask,
}

impl AlphaMask {
    /// Alpha at a point of triangle `triangle` of `mesh`. Without texture coordinates, from the factor and the vertices only.
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
    /// The masks of `runs`, which must be ascending; `None` if there are no runs.
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
