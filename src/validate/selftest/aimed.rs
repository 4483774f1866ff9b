//! Rays aimed exactly at points where several triangles meet.
//!
//! Every target here is an exact corner or edge point: coordinates are small multiples of powers of two. Which triangle is hit is known
//! beforehand, or found by testing each separately.

use glam::DVec3;

use super::meshes::{PLACES, Random, Triangle, build, disc, fan, grid, of_grid, placed, sphere};
use super::{Check, Outcome, count_in_batches, counted};
use crate::Result;
use crate::accel::{Bvh, Hit, Kernel, Origins, Precision, Ray, Traversal};
use crate::render::progress::Progress;

/// Bytes of a triangle while a tree is built over it. Measured: 270.
const TRIANGLE: u64 = 300;

pub(super) const CHECKS: [Check; 4] = [
    counted(
        "corners",
        "closed meshes from inside, at six sizes and places: rays at every corner and edge that are lost",
        "ray",
        [123_840, 1_967_040],
        corners,
    ),
    counted(
        "fans",
        "corners shared by 3 to 768 triangles: rays whose hit is not the nearest, or of equals the first",
        "ray",
        [9 * 128, 9 * 1024],
        fans,
    ),
    counted(
        "coplanar",
        "triangles in one plane, doubled and turned: rays whose hit is not the nearest, or of equals the first",
        "ray",
        [16_384, 262_144],
        coplanar,
    ),
    counted(
        "large",
        "a mesh of 5e5 (thorough: 1e7) triangles: rays aimed at its corners, edges and faces that hit another",
        "ray",
        [1 << 17, 1 << 22],
        large,
    )
    .taking([2 * 500 * 500 * TRIANGLE, 2 * 2237 * 2237 * TRIANGLE]),
];

fn certified(kernel: Kernel) -> Traversal {
    Traversal {
        kernel,
        precision: Precision::Certified,
    }
}

/// The hits of each kernel along `directions`.
fn by_every_kernel(bvh: &Bvh, origin: DVec3, directions: &[DVec3]) -> [Vec<Option<Hit>>; 4] {
    Kernel::ALL.map(|kernel| {
        let mut hits = vec![None; directions.len()];
        bvh.closest_by(
            certified(kernel),
            Origins::Shared(origin),
            directions,
            &mut hits,
            None,
            None,
        );
        hits
    })
}

/// Twenty rays per triangle, with every kernel, from inside.
fn corners(cases: u64, progress: &dyn Progress) -> Result<Outcome> {
    let levels = if cases > 1_000_000 { 5 } else { 3 };
    let (mut lost, mut rays) = (0, 0);
    for (scale, shift) in PLACES {
        for mesh in [sphere(levels), disc(levels)] {
            let mesh = placed(mesh, DVec3::splat(scale), shift);
            let bvh = build(mesh.clone());
            let fans = mesh.chunks(12).collect::<Vec<_>>();
            // With each of the four kernels, the targets of twelve triangles.
            let size = 4 * 12 * targets(&mesh[0]).len() as u64;
            let outcome = count_in_batches(fans.len() as u64 * size, size, progress, |i| {
                let targets = fans[i as usize].iter().flat_map(targets);
                let directions: Vec<DVec3> = targets.map(|p| p - shift).collect();
                let lost = |hits: Vec<Option<Hit>>| {
                    hits.iter().filter(|h| h.is_none_or(|h| h.front)).count() as u64
                };
                by_every_kernel(&bvh, shift, &directions)
                    .map(lost)
                    .iter()
                    .sum()
            })?;
            (lost, rays) = (lost + outcome.worst as u64, rays + outcome.cases);
        }
    }
    Ok(Outcome {
        worst: lost as f64,
        cases: rays,
    })
}

/// Corners and edge points.
fn targets(&[a, b, c]: &Triangle) -> [DVec3; 5] {
    [a, b, (a + b) * 0.5, a + (c - a) * 0.3, b.lerp(c, 0.7)]
}

/// Triangles in one tree, and each in its own.
struct Compared {
    together: Bvh,
    alone: Vec<Bvh>,
}

impl Compared {
    fn new(mesh: Vec<Triangle>) -> Compared {
        Compared {
            alone: mesh.iter().map(|&t| build(vec![t])).collect(),
            together: build(mesh),
        }
    }

    /// Among all triangles that are hit, the one with the smallest s, and among equals the first.
    fn first(&self, origin: DVec3, direction: DVec3) -> Option<(u32, f64)> {
        let ray = Ray {
            origin,
            direction,
            s_min: 0.0,
        };
        let mut best: Option<(u32, f64)> = None;
        for (id, alone) in (0..).zip(&self.alone) {
            let s_max = best.map_or(f64::INFINITY, |(_, s)| s);
            if let Some(hit) = alone.closest(&ray, s_max) {
                best = Some((id, hit.s));
            }
        }
        best
    }

    /// The number of rays along `directions` that hit another triangle than the first, or hit it at another point.
    fn mistakes(&self, origin: DVec3, directions: &[DVec3]) -> u64 {
        let mut expected: Vec<Option<(u32, f64)>> = Vec::with_capacity(directions.len());
        for (i, &d) in directions.iter().enumerate() {
            // Exact arithmetic is slow, so not twice for the same ray.
            let known = directions[..i].iter().position(|&other| other == d);
            expected.push(known.map_or_else(|| self.first(origin, d), |at| expected[at]));
        }
        let wrong = |hits: Vec<Option<Hit>>| {
            let found = hits.iter().map(|hit| hit.map(|h| (h.triangle, h.s)));
            found.zip(&expected).filter(|(a, b)| a != *b).count() as u64
        };
        let hits = by_every_kernel(&self.together, origin, directions);
        hits.map(wrong).iter().sum()
    }
}

/// Rays at the apex, which all triangles share, at s = 1 up to rounding.
fn fans(cases: u64, progress: &dyn Progress) -> Result<Outcome> {
    let size = cases / 9;
    count_in_batches(cases, size, progress, |i| {
        let fan = Compared::new(fan(3 << i));
        let mut random = Random(i);
        let mut wrong = 0;
        for _ in 0..size / 64 {
            // Multiples of 2⁻¹⁰ within the cone's box: the vector to the apex is exact.
            let origin = (random.vector() * 512.0).round() / 1024.0;
            wrong += fan.mistakes(origin, &[DVec3::Z - origin; 16]);
        }
        wrong
    })
}

/// A triangle with small integer coordinates, twelve times, and others in its plane: rays at their points.
fn coplanar(cases: u64, progress: &dyn Progress) -> Result<Outcome> {
    count_in_batches(cases, 256, progress, |i| {
        let mut random = Random(i);
        let mut whole = |size: f64| (random.vector() * size).round();
        let [a, b, c, origin] = [whole(8.0), whole(8.0), whole(8.0), whole(64.0)];
        let mut mesh = [[a, b, c], [b, c, a], [a, c, b]].repeat(4);
        // Reflected at its corners, which stays exactly in the plane.
        mesh.extend([[a, a * 2.0 - b, c], [b, c, b + c - a], [a, b, a + b - c]]);
        let points = [
            a,
            b,
            c,
            (a + b) * 0.5,
            (a + b) * 0.25 + c * 0.5,
            a * 1.5 - b * 0.5,
        ];
        let directions: Vec<DVec3> = (0..64).map(|k| points[k % 6] - origin).collect();
        Compared::new(mesh).mistakes(origin, &directions)
    })
}

/// Rays down to points of a flat grid, whose triangle is known.
fn large(cases: u64, progress: &dyn Progress) -> Result<Outcome> {
    // 5·10⁵ or 10⁷ triangles.
    let n = if cases > 1 << 17 { 2237 } else { 500 };
    let bvh = build(grid(n));
    count_in_batches(cases, 1024, progress, |i| {
        let mut random = Random(i);
        // Multiples of ¼ and 1/1024 above the grid, and points at most 64 away.
        let around = DVec3::new(
            random.below(n - 128) as f64,
            random.below(n - 128) as f64,
            0.0,
        );
        let origin = around + DVec3::new(64.25, 63.5, 32.0);
        let mut wrong = 0;
        for step in [1.0, 0.5, 0.25, 0.0009765625] {
            let mut point = || {
                let at = |k: u64| (k as f64 * step).min(128.0);
                let steps = (128.0 / step) as u64;
                around
                    + DVec3::new(
                        at(random.below(steps + 1)),
                        at(random.below(steps + 1)),
                        0.0,
                    )
            };
            let points: Vec<DVec3> = (0..64).map(|_| point()).collect();
            let directions: Vec<DVec3> = points.iter().map(|&p| p - origin).collect();
            for hits in by_every_kernel(&bvh, origin, &directions) {
                let is_right = |(hit, p): (&Option<Hit>, &DVec3)| {
                    hit.is_some_and(|h| h.triangle == of_grid(n, p.x, p.y) && h.s == 1.0)
                };
                wrong += hits.iter().zip(&points).filter(|h| !is_right(*h)).count() as u64;
            }
        }
        wrong
    })
}
