//! Geometry from the measurements of a capture camera: distances along its pixels' rays, or first arrivals of light.
//!
//! *Distances.* A pulse from a lamp at l, emitted at time t₀, that hits the point o + r d of a pixel's ray (o the pinhole, d a unit
//! vector) and continues to the pinhole arrives at t₀ + |o + r d − l| + r, in metres of light path in vacuum. With s the light path t −
//! t₀ and q = o − l this is |q + r d| = s − r, and squared it is linear in r:
//!
//! ```text
//! r = (s² − q²) / 2 (s + q·d),      r < s   (the ellipse with the foci o and l in polar coordinates about o)
//! ```
//!
//! In a medium of index η all lengths are η times as long. For a lamp in the pinhole q = 0 and r = s/2.
//!
//! *First arrivals.* Among a pixel's bins, the first maximum that is at least a fraction `peak_fraction` of the highest. Light via a second
//! surface arrives later than the direct light of the same pixel, but may be brighter. A Gaussian is fitted through the three bins about
//! the maximum: ln a is a parabola there, whose vertex is at k + ½ (ln a₋ − ln a₊)/(ln a₋ − 2 ln a₀ + ln a₊) from the bin's centre. Bins
//! that are means of a Gaussian have the same vertex if they are symmetric about it, and otherwise an error below 10⁻³ of a bin for σ of
//! a bin or more. Pixels whose maximum is below a fraction `dark_fraction` of the picture's brightest are taken as dark: shadow, or nothing
//! there.
//!
//! *Mesh.* Vertices are at pixel centres, with the texture coordinates of these centres, so that a cube of the same camera fits the mesh.
//! Neighbours are joined unless the surface is torn between them: that is, if their distances from the pinhole differ by more than `max_step`
//! pixel widths, unless the line through the two pixels before them meets the second one's ray within that tolerance, and the line
//! through the two behind them the first one's, if these have distances. On a plane they meet exactly, at any tilt. A triangle is made if
//! both of its sides along rows and columns are joined.

use glam::{DVec2, DVec3};

use crate::camera::{AnyProjection, Projection};
use crate::io::cube::Cube;
use crate::mesh::{Material, Mesh, Part};
use crate::scene::model::CaptureCamera;

/// A pulse from a lamp.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Flash {
    /// The position of emission, metres.
    pub position: DVec3,
    /// The emission time of its centre, metres of light path.
    pub time: f64,
}

/// The criteria for first light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FirstLight {
    /// The fraction of a pixel's highest value that its first maximum must reach.
    pub peak_fraction: f64,
    /// The fraction of the brightest pixel's highest value below which a pixel is dark.
    pub dark_fraction: f64,
}

impl Default for FirstLight {
    fn default() -> Self {
        FirstLight {
            peak_fraction: 0.2,
            dark_fraction: 0.02,
        }
    }
}

/// A mesh from distances, and statistics of the pixels.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct DepthMesh {
    /// The mesh, in the camera's coordinates.
    pub mesh: Mesh,
    /// Pixels without a distance.
    pub unknown: usize,
    /// Pairs of neighbours that are not joined, although both have a distance.
    pub torn: usize,
}

/// The rays of a capture camera's pixels.
#[derive(Debug)]
pub struct PixelRays {
    eye: DVec3,
    projection: AnyProjection,
    offset: [f64; 2],
    /// Depth of the near plane, from which times are measured.
    near: f64,
    size: [usize; 2],
}

impl PixelRays {
    /// The rays of `camera`, whose picture has `size` (columns, rows).
    pub fn new(camera: &CaptureCamera, size: [usize; 2]) -> PixelRays {
        PixelRays {
            eye: camera.eye,
            projection: AnyProjection::of_capture(camera, size),
            offset: (camera.crop).map_or([0.0; 2], |crop| crop.offset.map(f64::from)),
            near: camera.near_clip,
            size,
        }
    }

    /// The unit direction through the centre of a pixel (row · columns + column); `None` for a pixel that sees nothing.
    fn direction(&self, pixel: usize) -> Option<DVec3> {
        let [width, _] = self.size;
        let x = (pixel % width) as f64 + 0.5 + self.offset[0];
        let y = (pixel / width) as f64 + 0.5 + self.offset[1];
        let [right, up, forward] = self.projection.axes();
        let v = self.projection.components(x, y);
        let d = (right * v.x + up * v.y + forward * v.z).try_normalize()?;
        self.projection.sees(x, y).then_some(d)
    }

    /// The width of a pixel at a point.
    fn footprint(&self, point: DVec3) -> f64 {
        let along = self.projection.along_axes(point - self.eye);
        self.projection.footprint(along)
    }

    /// Distances, metres, of surfaces from which light of `flash` arrived at the times `arrivals`, metres of light path, row by row from
    /// the top; NaN if no surface could have sent it then.
    pub fn distances(&self, arrivals: &[f64], flash: &Flash, index: f64) -> Vec<f64> {
        let q = self.eye - flash.position;
        let distance = |(pixel, arrival): (usize, &f64)| {
            let d = self.direction(pixel).unwrap_or(DVec3::NAN);
            // Times lack the path to the near plane, n / cos θ.
            let lacking = self.near / d.dot(self.projection.forward());
            let s = (arrival - flash.time) / index + lacking;
            let r = (s * s - q.length_squared()) / (2.0 * (s + q.dot(d)));
            match r > 0.0 && r < s && r.is_finite() {
                true => r,
                false => f64::NAN,
            }
        };
        arrivals.iter().enumerate().map(distance).collect()
    }

    /// Distances along the rays of points at these depths along the forward axis, both in metres and row by row from the top.
    pub fn distances_of_depths(&self, depths: &[f64]) -> Vec<f64> {
        let forward = self.projection.forward();
        let distance = |(pixel, depth): (usize, &f64)| {
            let d = self.direction(pixel).unwrap_or(DVec3::NAN);
            depth / d.dot(forward)
        };
        depths.iter().enumerate().map(distance).collect()
    }

    /// The mesh through points at `distances` from the pinhole, metres, row by row; distances that are not above 0 are left out.
    pub fn mesh(&self, distances: &[f64], max_step: f64) -> DepthMesh {
        let points: Vec<Option<DVec3>> = (0..self.size[0] * self.size[1])
            .map(|pixel| {
                let r = *distances.get(pixel)?;
                let d = self.direction(pixel)?;
                (r > 0.0 && r.is_finite()).then(|| self.eye + d * r)
            })
            .collect();
        Weaver {
            rays: self,
            points: &points,
            max_step,
        }
        .weave()
    }
}

/// The time of first light in each pixel of `cube`, metres of light path: `start` is the start of its bin 0, `width` the width of a bin.
/// NaN for dark pixels.
pub fn first_light(cube: &Cube, start: f64, width: f64, first: &FirstLight) -> Vec<f64> {
    let [h, w, bins, _] = cube.shape;
    let value = |pixel: usize, bin: usize| cube.total(pixel, bin);
    let highest = |pixel: usize| (0..bins).map(|bin| value(pixel, bin)).fold(0.0, f64::max);
    let all: Vec<f64> = (0..h * w).map(highest).collect();
    let brightest = all.iter().copied().fold(0.0, f64::max);
    let arrival = |pixel: usize| {
        let highest = all[pixel];
        if highest <= first.dark_fraction * brightest {
            return f64::NAN;
        }
        // The first maximum that is high enough; a plateau counts from its beginning.
        let at = |bin: usize| value(pixel, bin);
        let is_peak = |bin: &usize| {
            let (before, after) = (
                if *bin == 0 { 0.0 } else { at(bin - 1) },
                if bin + 1 == bins { 0.0 } else { at(bin + 1) },
            );
            at(*bin) >= first.peak_fraction * highest && at(*bin) > before && at(*bin) >= after
        };
        let Some(peak) = (0..bins).find(is_peak) else {
            return f64::NAN;
        };
        let centre = start + (peak as f64 + 0.5) * width;
        if peak == 0 || peak + 1 == bins {
            return centre;
        }
        let [before, own, after] = [peak - 1, peak, peak + 1].map(|bin| at(bin).ln());
        // The vertex of the parabola through ln a at the three bins, in bins from the middle one.
        let curvature = before - 2.0 * own + after;
        let beside = 0.5 * (before - after) / curvature;
        match curvature < 0.0 && beside.abs() <= 1.0 {
            true => centre + beside * width,
            false => centre,
        }
    };
    (0..h * w).map(arrival).collect()
}

/// Joins pixels to triangles.
struct Weaver<'a> {
    rays: &'a PixelRays,
    points: &'a [Option<DVec3>],
    max_step: f64,
}

impl Weaver<'_> {
    fn point(&self, column: i64, row: i64) -> Option<DVec3> {
        let [width, height] = self.rays.size.map(|n| n as i64);
        let inside = (0..width).contains(&column) && (0..height).contains(&row);
        self.points[inside.then_some((row * width + column) as usize)?]
    }

    /// Whether the surface continues from a pixel to its neighbour `step` further; `None` if one has no distance.
    fn joins(&self, [column, row]: [i64; 2], [across, down]: [i64; 2]) -> Option<bool> {
        let at = |n: i64| self.point(column + n * across, row + n * down);
        let (a, b) = (at(0)?, at(1)?);
        let [r_a, r_b] = [a, b].map(|p| p.distance(self.rays.eye));
        // Tears are judged by the nearer pixel's width, which is the smaller.
        let nearer = if r_a < r_b { a } else { b };
        let tolerance = self.max_step * self.rays.footprint(nearer);
        if (r_a - r_b).abs() <= tolerance {
            return Some(true);
        }
        // By the line through the pixels on either side, if they exist.
        let goes_on = |before: Option<DVec3>, from: DVec3, to: DVec3| {
            let met = self.met(before?, from, (to - self.rays.eye).normalize());
            let to = to.distance(self.rays.eye);
            Some(met.is_some_and(|r| (r - to).abs() <= tolerance))
        };
        let sides = [goes_on(at(-1), a, b), goes_on(at(2), b, a)];
        Some(sides != [None; 2] && !sides.contains(&Some(false)))
    }

    /// The distance at which a ray from the pinhole is nearest to the extension of the line from `before` through `from`.
    fn met(&self, before: DVec3, from: DVec3, d: DVec3) -> Option<f64> {
        let (e, p) = ((from - before).try_normalize()?, from - self.rays.eye);
        // Least squares of r d − (p + s e).
        let c = d.dot(e);
        let r = (p.dot(d) - c * p.dot(e)) / (1.0 - c * c);
        (r > 0.0 && r.is_finite()).then_some(r)
    }

    fn weave(&self) -> DepthMesh {
        let [width, height] = self.rays.size;
        let mut torn = 0;
        let mut sides = |step: [i64; 2]| -> Vec<bool> {
            (0..width * height)
                .map(|pixel| {
                    let place = [(pixel % width) as i64, (pixel / width) as i64];
                    let joins = self.joins(place, step);
                    torn += usize::from(joins == Some(false));
                    joins == Some(true)
                })
                .collect()
        };
        let (across, down) = (sides([1, 0]), sides([0, 1]));
        // Two triangles per square of four pixels: those at two opposite corners whose sides are joined.
        let mut triangles: Vec<[usize; 3]> = Vec::new();
        for row in 0..height.saturating_sub(1) {
            for column in 0..width.saturating_sub(1) {
                let a = row * width + column;
                let (b, c, d) = (a + 1, a + width, a + width + 1);
                let (top, bottom, left, right) = (across[a], across[c], down[a], down[b]);
                // Along the shorter diagonal if all four exist, and else along the one whose triangles exist.
                let length = |from: usize, to: usize| match (self.points[from], self.points[to]) {
                    (Some(from), Some(to)) => from.distance_squared(to),
                    _ => f64::INFINITY,
                };
                let slash = [(top && left, [a, c, b]), (bottom && right, [d, b, c])];
                let backslash = [(left && bottom, [c, d, a]), (top && right, [b, a, d])];
                let count = |pair: &[(bool, [usize; 3]); 2]| pair.iter().filter(|t| t.0).count();
                let prefers_slash = match count(&slash).cmp(&count(&backslash)) {
                    std::cmp::Ordering::Greater => true,
                    std::cmp::Ordering::Less => false,
                    std::cmp::Ordering::Equal => length(b, c) <= length(a, d),
                };
                let chosen = if prefers_slash { slash } else { backslash };
                triangles.extend(chosen.into_iter().filter(|t| t.0).map(|t| t.1));
            }
        }
        DepthMesh {
            mesh: self.compacted(&triangles),
            unknown: self.points.iter().filter(|p| p.is_none()).count(),
            torn,
        }
    }

    /// The mesh of these triangles of pixels, with only the vertices in use.
    fn compacted(&self, triangles: &[[usize; 3]]) -> Mesh {
        let [width, height] = self.rays.size;
        // Vertices are numbered in the order in which triangles use them.
        let mut numbers = vec![u32::MAX; self.points.len()];
        let (mut positions, mut uvs) = (Vec::new(), Vec::new());
        let mut number = |pixel: usize| {
            if numbers[pixel] == u32::MAX
                && let Some(point) = self.points[pixel]
            {
                numbers[pixel] = positions.len() as u32;
                positions.push(point);
                let centre = DVec2::new((pixel % width) as f64, (pixel / width) as f64) + 0.5;
                let uv = centre / DVec2::new(width as f64, height as f64);
                uvs.push(uv.as_vec2().to_array());
            }
            numbers[pixel]
        };
        let triangles: Vec<[u32; 3]> = triangles.iter().map(|t| t.map(&mut number)).collect();
        Mesh {
            parts: vec![Part {
                first_triangle: 0,
                triangles: triangles.len() as u32,
                material: 0,
                node: "surface".into(),
            }],
            materials: vec![Material {
                name: "surface".into(),
                double_sided: true,
                ..Material::matte([0.8; 3])
            }],
            positions,
            uvs: vec![uvs],
            normals: Vec::new(),
            triangles,
            colours: Vec::new(),
        }
    }
}

#[cfg(test)]
mod tests;
