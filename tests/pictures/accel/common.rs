//! Meshes, rays and random numbers for the tests.

use glam::DVec3;
use nullray::accel::{Bvh, Facing, Hit, Kernel, Origins, Precision, Ray, Traversal};

pub type Triangle = [DVec3; 3];

pub fn build(triangles: &[Triangle]) -> Bvh {
    Bvh::build(triangles.to_vec(), |_| Facing::TwoSided)
}

pub fn ray(origin: DVec3, direction: DVec3) -> Ray {
    Ray {
        origin,
        direction,
        s_min: 0.0,
    }
}

pub fn closest(bvh: &Bvh, origin: DVec3, direction: DVec3) -> Option<Hit> {
    bvh.closest(&ray(origin, direction), f64::INFINITY)
}

/// SplitMix64, as numbers in [−1, 1).
pub struct Random(pub u64);

impl Random {
    pub fn number(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    pub fn vector(&mut self) -> DVec3 {
        DVec3::new(self.number(), self.number(), self.number())
    }

    pub fn direction(&mut self) -> DVec3 {
        let v = self.vector();
        if v.length_squared() < 1.0 && v.length_squared() > 1e-6 {
            v.normalize()
        } else {
            self.direction()
        }
    }

    /// Triangles of size `size` with corners near the ball of radius `radius` about `centre`.
    pub fn soup(&mut self, count: usize, centre: DVec3, radius: f64, size: f64) -> Vec<Triangle> {
        (0..count)
            .map(|_| {
                let at = centre + self.vector() * radius;
                [0; 3].map(|_| at + self.vector() * size)
            })
            .collect()
    }
}

/// Subdivided octahedron: unit vectors as corners, shared bit for bit.
pub fn sphere(levels: usize) -> Vec<Triangle> {
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    let mut triangles = Vec::new();
    for (sx, sy, sz) in [1.0, -1.0].iter().flat_map(|&a| {
        [1.0, -1.0]
            .into_iter()
            .flat_map(move |b| [1.0, -1.0].map(|c| (a, b, c)))
    }) {
        let corners = [x * sx, y * sy, z * sz];
        let [a, b, c] = corners;
        triangles.push(if sx * sy * sz > 0.0 {
            [a, b, c]
        } else {
            [a, c, b]
        });
    }
    for _ in 0..levels {
        triangles = triangles
            .into_iter()
            .flat_map(|[a, b, c]| {
                let middle = |p: DVec3, q: DVec3| (p + q).normalize();
                let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    triangles
}

pub fn scaled(triangles: &[Triangle], scale: f64, shift: DVec3) -> Vec<Triangle> {
    triangles
        .iter()
        .map(|t| t.map(|c| c * scale + shift))
        .collect()
}

/// The kernels that this processor has and that trace packets: all others do what one of these or the scalar one does.
pub fn packet_kernels() -> impl Iterator<Item = Kernel> {
    let all = Kernel::ALL.into_iter();
    all.filter(|kernel| kernel.is_supported() && *kernel != Kernel::Scalar)
}

pub fn certified(kernel: Kernel) -> Traversal {
    Traversal {
        kernel,
        precision: Precision::Certified,
    }
}

/// Traces rays from one point as pictures do.
pub fn trace(bvh: &Bvh, origin: DVec3, directions: &[DVec3], hits: &mut [Option<Hit>]) {
    let (method, from) = (Traversal::default(), Origins::Shared(origin));
    bvh.closest_by(method, from, directions, hits, None, None);
}

/// A tile of `n` × `n` directions about `axis`, `pitch` apart, each off its place by as much as `jitter`.
pub fn tile(random: &mut Random, axis: DVec3, n: usize, pitch: f64, jitter: f64) -> Vec<DVec3> {
    let (right, up) = axis.normalize().any_orthonormal_pair();
    let size = axis.length() * pitch;
    let at = |i: usize| i as f64 - n as f64 / 2.0;
    let mut directions = Vec::new();
    for y in 0..n {
        for x in 0..n {
            let (u, v) = (
                at(x) + jitter * random.number(),
                at(y) + jitter * random.number(),
            );
            directions.push(axis + (right * u + up * v) * size);
        }
    }
    directions
}
