//! obvhs' own f32 traversal of its own tree: what this crate's speed is compared with.

use std::time::Duration;

use glam::{DVec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::bvh2::{Bvh2, builder::build_bvh2_from_tris};
use obvhs::ray::{Ray as PeerRay, RayHit};
use obvhs::triangle::Triangle;

/// obvhs' tree, its triangles in leaf order, and its traversal.
pub struct Peer {
    tree: Bvh2,
    triangles: Vec<Triangle>,
}

impl Peer {
    /// The tree, and how long obvhs took to build it.
    pub fn build(triangles: &[[DVec3; 3]]) -> (Peer, Duration) {
        let triangles: Vec<Triangle> = triangles
            .iter()
            .map(|t| t.map(|c| c.as_vec3a()))
            .map(|[v0, v1, v2]| Triangle { v0, v1, v2 })
            .collect();
        let mut build = Duration::default();
        let preset = BvhBuildParams::medium_build();
        let tree = build_bvh2_from_tris(&triangles, preset, &mut build);
        let triangles = tree
            .primitive_indices
            .iter()
            .map(|&i| triangles[i as usize])
            .collect();
        (Peer { tree, triangles }, build)
    }

    /// How many of the rays from `origin` meet a triangle.
    pub fn trace(&self, origin: DVec3, directions: &[DVec3]) -> usize {
        let origin: Vec3A = origin.as_vec3a();
        let hit = |&d: &DVec3| {
            let ray = PeerRay::new_inf(origin, d.as_vec3a());
            let mut hit = RayHit::none();
            self.tree
                .ray_traverse(ray, &mut hit, |ray, i| self.triangles[i].intersect(ray));
            hit.t < f32::INFINITY
        };
        directions.iter().filter(|d| hit(d)).count()
    }
}
