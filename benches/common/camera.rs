//! The camera of benchmarks of visibility.

use glam::DVec3;
use nullray::accel::{Bvh, Hit, Origins, Traversal};

use super::grid;

/// Rays per batch: a tile of 16 × 16 pixels, as in images.
pub const TILE: usize = 16;

/// Rays from one point through the centres of a square image's pixels.
pub struct Camera {
    /// Where they leave.
    pub origin: DVec3,
    /// By tiles.
    pub directions: Vec<DVec3>,
}

impl Camera {
    /// Along −z at `bvh`, from `distance` half-diagonals in front of its centre; `half_width` of the image plane
    /// at distance 1.
    pub fn new(bvh: &Bvh, distance: f64, half_width: f64, size: usize) -> Camera {
        let (lo, hi) = bvh.bounds().expect("a mesh");
        let origin = (lo + hi) / 2.0 + DVec3::Z * (distance * (hi - lo).length() / 2.0);
        let pixel = |i: usize| ((i as f64 + 0.5) / size as f64 * 2.0 - 1.0) * half_width;
        let mut directions = Vec::with_capacity(size * size);
        for (y0, x0) in grid(size / TILE).map(|(y, x)| (y * TILE, x * TILE)) {
            let direction = |(y, x)| DVec3::new(pixel(x0 + x), -pixel(y0 + y), -1.0).normalize();
            directions.extend(grid(TILE).map(direction));
        }
        Camera { origin, directions }
    }

    /// How many there are.
    pub fn rays(&self) -> usize {
        self.directions.len()
    }
}

/// The closest hits of a tile's rays, traced as pictures trace them; how many there are.
pub fn trace_tile(bvh: &Bvh, origin: DVec3, directions: &[DVec3]) -> usize {
    let mut hits: [Option<Hit>; TILE * TILE] = [None; TILE * TILE];
    let (method, from) = (Traversal::default(), Origins::Shared(origin));
    let entries = &mut hits[..directions.len()];
    bvh.closest_by(method, from, directions, entries, None, None);
    std::hint::black_box(&hits);
    hits.iter().flatten().count()
}
