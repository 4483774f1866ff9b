//! Meshes and numbers with known geometry.

use glam::DVec3;

use crate::accel::{Bvh, Facing};

pub(super) type Triangle = [DVec3; 3];

/// SplitMix64 (Steele, Lea, Flood 2014), as numbers in [−1, 1).
pub(super) struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    pub fn number(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    pub fn vector(&mut self) -> DVec3 {
        DVec3::new(self.number(), self.number(), self.number())
    }

    pub fn direction(&mut self) -> DVec3 {
        loop {
            let v = self.vector();
            // Evenly over the sphere: within the ball, and long enough to keep its digits.
            if (1e-6..1.0).contains(&v.length_squared()) {
                return v.normalize();
            }
        }
    }

    /// One of 0, 1, … `count` − 1.
    pub fn below(&mut self, count: u64) -> u64 {
        self.bits() % count
    }
}

pub(super) fn build(triangles: Vec<Triangle>) -> Bvh {
    Bvh::build(triangles, |_| Facing::TwoSided)
}

/// A subdivided octahedron: a closed mesh about the origin with corners shared bit for bit, each f32.
pub(super) fn sphere(levels: usize) -> Vec<Triangle> {
    let mut triangles = Vec::new();
    for octant in 0..8 {
        let sign = |bit: u32| if octant >> bit & 1 == 0 { 1.0 } else { -1.0 };
        let [a, b, c] = [DVec3::X * sign(0), DVec3::Y * sign(1), DVec3::Z * sign(2)];
        // An odd number of mirrored axes reverses the corners.
        let outward = sign(0) * sign(1) * sign(2) > 0.0;
        triangles.push(if outward { [a, b, c] } else { [a, c, b] });
    }
    let middle = |p: DVec3, q: DVec3| (p + q).normalize().as_vec3().as_dvec3();
    for _ in 0..levels {
        let four = |[a, b, c]: Triangle| {
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        };
        triangles = triangles.into_iter().flat_map(four).collect();
    }
    triangles
}

/// The same, squashed to a disc of slivers.
pub(super) fn disc(levels: usize) -> Vec<Triangle> {
    placed(sphere(levels), DVec3::new(1.0, 1.0, 1e-4), DVec3::ZERO)
}

/// Each corner times `scale`, plus `shift`.
pub(super) fn placed(triangles: Vec<Triangle>, scale: DVec3, shift: DVec3) -> Vec<Triangle> {
    let place = |t: Triangle| t.map(|corner| corner * scale + shift);
    triangles.into_iter().map(place).collect()
}

/// The scales and positions at which closed meshes are viewed from inside.
pub(super) const PLACES: [(f64, DVec3); 6] = [
    (1.0, DVec3::ZERO),
    (1e-9, DVec3::ZERO),
    (1e9, DVec3::ZERO),
    (1.0, DVec3::new(3.0, 0.1, -2.0)),
    (1e-5, DVec3::ONE),
    (1.0, DVec3::new(1e9, -1e9, 1e9)),
];

/// Random triangles within 1 of the origin, of size `size`.
pub(super) fn soup(random: &mut Random, count: usize, size: f64) -> Vec<Triangle> {
    let mut triangle = |_| {
        let at = random.vector();
        [0; 3].map(|_| at + random.vector() * size)
    };
    (0..count).map(&mut triangle).collect()
}

/// Directions of a tile of 16 × 16 about `axis`, `pitch` apart, each jittered by up to half of that.
pub(super) fn tile(random: &mut Random, axis: DVec3, pitch: f64) -> Vec<DVec3> {
    let (right, up) = axis.normalize().any_orthonormal_pair();
    let size = axis.length() * pitch;
    let mut directions = Vec::with_capacity(256);
    for place in 0..256u32 {
        let (x, y) = (f64::from(place % 16) - 8.0, f64::from(place / 16) - 8.0);
        let (u, v) = (x + 0.5 * random.number(), y + 0.5 * random.number());
        directions.push(axis + (right * u + up * v) * size);
    }
    directions
}

/// A flat grid of n × n unit squares at z = 0, each of two triangles: of square i, from its corner
/// (i mod n, i/n) on, 2i is at or below the diagonal and 2i + 1 at or above it.
pub(super) fn grid(n: u64) -> Vec<Triangle> {
    let at = |x: u64, y: u64| DVec3::new(x as f64, y as f64, 0.0);
    let square = |i: u64| {
        let (x, y) = (i % n, i / n);
        let [a, b, c, d] = [at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)];
        [[a, b, c], [a, c, d]]
    };
    (0..n * n).flat_map(square).collect()
}

/// The triangle of the grid that a ray down to (x, y) hits: the first of those that share the point.
pub(super) fn of_grid(n: u64, x: f64, y: f64) -> u32 {
    // At a point on a line between squares, those to the left and below come first.
    let before = |t: f64| ((t.ceil() as u64).max(1) - 1).min(n - 1);
    let (column, row) = (before(x), before(y));
    let (fx, fy) = (x - column as f64, y - row as f64);
    (2 * (row * n + column)) as u32 + u32::from(fy > fx)
}

/// A cone of `count` triangles that share their first corner, the apex (0, 0, 1).
pub(super) fn fan(count: usize) -> Vec<Triangle> {
    let rim = |i: usize| {
        let angle = std::f64::consts::TAU * (i % count) as f64 / count as f64;
        let at = DVec3::new(libm::cos(angle), libm::sin(angle), 0.0);
        at.as_vec3().as_dvec3()
    };
    (0..count).map(|i| [DVec3::Z, rim(i), rim(i + 1)]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_the_triangles_of_a_grid_that_share_a_point_the_first_is_told() {
        let n = 4;
        let mesh = grid(n);
        for (i, j) in (0..=16).flat_map(|i| (0..=16).map(move |j| (i, j))) {
            let (x, y) = (f64::from(i) / 4.0, f64::from(j) / 4.0);
            let inside = |t: &Triangle| {
                let turn =
                    |a: DVec3, b: DVec3| (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x) >= 0.0;
                turn(t[0], t[1]) && turn(t[1], t[2]) && turn(t[2], t[0])
            };
            let first = mesh.iter().position(inside);
            assert_eq!(first, Some(of_grid(n, x, y) as usize), "{x} {y}");
        }
    }
}
