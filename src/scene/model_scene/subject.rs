//! What the camera frames: a sphere around a model, and its outline.
//!
//! A model on a wide, level ground is framed without the ground: triangles at the very bottom are left out if all others fit into a sphere with
//! a quarter of the radius.

use std::path::Path;

use glam::DVec3;

use crate::error::{Error, Result};
use crate::io::budget::Budget;
use crate::io::gltf::{self, BadVertices, GltfSummary, Want};
use crate::mesh::Mesh;

/// Cells of directions along each half axis: 1/12, or 5°, over which a sphere deviates from its tangent plane by 4·10⁻³.
const CELLS: usize = 12;
/// Points per radius on long edges, which appear curved: an arc of 1/8 radius deviates from its chord by less than 2·10⁻³ radii.
const PARTS: f64 = 8.0;
/// A ground is level to within the first fraction of the whole radius, and the subject on it has a radius below the second fraction of it.
const LEVEL: f64 = 0.01;
const WIDE: f64 = 0.25;
/// A model has a ground of its own if triangles that face up cover this part of the rectangle around it (a round ground covers π/4), this
/// fraction of its radius above its bottom at most.
const COVERED: f64 = 0.5;
const THICK: f64 = 0.03;

/// A sphere around all triangles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ball {
    pub(super) centre: DVec3,
    /// Above 0.
    pub(super) radius: f64,
}

/// What a camera frames.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Subject {
    pub(super) ball: Ball,
    /// The points of edges that are farthest from the middle of the ball, one in each cell of directions.
    pub(super) outline: Vec<DVec3>,
    /// The height of its bottom, unless it stands on its own ground.
    pub(super) floor: Option<f64>,
}

impl Subject {
    /// Bytes per vertex while a model is loaded without texture coordinates: its position, in a growing list.
    const VERTEX: u64 = 2 * 24;
    /// Bytes per triangle: its corners, in a growing list, and as they are in the file.
    const TRIANGLE: u64 = 2 * 12 + 12;

    pub(super) fn of(path: &Path, held: &GltfSummary, budget: &Budget) -> Result<Subject> {
        let taken = Subject::VERTEX.saturating_mul(held.vertices);
        budget.take(
            taken.saturating_add(Subject::TRIANGLE.saturating_mul(held.triangles)),
            path,
        )?;
        let want = Want {
            uvs: false,
            textures: false,
            shading: false,
            normals: false,
            bad_vertices: BadVertices::Drop,
        };
        let mesh = gltf::load(path, None, want)?.mesh;
        Subject::in_mesh(&mesh).ok_or_else(|| {
            let what = "its triangles have no extent that a camera could frame";
            let help = "export a model whose triangles have an area, in metres from 1e-60 to 1e28, and no corner that is not finite";
            Error::invalid(path, "meshes", what, help)
        })
    }

    /// The subject of all triangles whose corners are distinct; for a model on a wide and level ground, only of those above the ground.
    pub(super) fn in_mesh(mesh: &Mesh) -> Option<Subject> {
        let all = Ball::of_those(mesh, |_| true)?;
        let corners = (0..mesh.triangles.len() as u32).flat_map(|i| mesh.corners(i));
        let bottom = corners.map(|p| p.y).fold(f64::INFINITY, f64::min);
        let top = bottom + LEVEL * all.radius;
        let is_above = |corners: &[DVec3; 3]| corners.iter().any(|p| p.y > top);
        let above = Ball::of_those(mesh, is_above);
        Some(
            match above.filter(|above| above.radius < WIDE * all.radius) {
                Some(above) => Subject::within(above, mesh, is_above),
                None => Subject {
                    floor: (!has_ground(mesh, bottom + THICK * all.radius)).then_some(bottom),
                    ..Subject::within(all, mesh, |_| true)
                },
            },
        )
    }

    /// The subject of the triangles that `count` selects, which are within `ball`.
    fn within(ball: Ball, mesh: &Mesh, count: impl Fn(&[DVec3; 3]) -> bool) -> Subject {
        const SIDE: usize = 2 * CELLS + 1;
        let mut farthest = vec![(0.0, DVec3::ZERO); SIDE * SIDE * SIDE];
        let step = ball.radius / PARTS;
        for point in counted(mesh, count).flat_map(|corners| along_edges(corners, step)) {
            let from_middle = point - ball.centre;
            let distance = from_middle.length();
            if distance == 0.0 {
                continue;
            }
            // Unit vectors lie in those cells of a cube of side 2 that the unit sphere passes through.
            let cell = |x: f64| (CELLS as f64 * (1.0 + x / distance)).round() as usize;
            let [x, y, z] = from_middle.to_array().map(cell);
            let slot = &mut farthest[(x * SIDE + y) * SIDE + z];
            if distance > slot.0 {
                *slot = (distance, point);
            }
        }
        let outline = farthest.into_iter().filter(|(distance, _)| *distance > 0.0);
        Subject {
            ball,
            outline: outline.map(|(_, point)| point).collect(),
            floor: None,
        }
    }
}

/// Whether triangles below the height `top` that face up cover a good part of the rectangle around the mesh in x and z.
fn has_ground(mesh: &Mesh, top: f64) -> bool {
    let empty = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    let (mut extent, mut covered) = (empty, 0.0);
    for corners @ [a, b, c] in counted(mesh, |_| true) {
        extent = corners
            .iter()
            .fold(extent, |[l, g], p| [l.min(*p), g.max(*p)]);
        if corners.iter().all(|p| p.y <= top) {
            covered += 0.5 * (b - a).cross(c - a).y.max(0.0);
        }
    }
    let size = extent[1] - extent[0];
    covered > COVERED * size.x * size.z
}

/// Points on a triangle's edges, including its corners, at most about `step` apart.
fn along_edges([a, b, c]: [DVec3; 3], step: f64) -> impl Iterator<Item = DVec3> {
    [(a, b), (b, c), (c, a)]
        .into_iter()
        .flat_map(move |(p, q)| {
            // No edge is longer than the diameter.
            let count = (p.distance(q) / step).clamp(1.0, 2.0 * PARTS).ceil();
            (0..count as u32).map(move |k| p.lerp(q, f64::from(k) / count))
        })
}

/// The corners of the triangles that `count` selects and whose corners are distinct.
fn counted(mesh: &Mesh, count: impl Fn(&[DVec3; 3]) -> bool) -> impl Iterator<Item = [DVec3; 3]> {
    let all = (0..mesh.triangles.len() as u32).map(|i| mesh.corners(i));
    all.filter(move |corners @ [a, b, c]| a != b && b != c && count(corners))
}

impl Ball {
    /// The ball around the triangles that `count` selects and whose corners are distinct.
    fn of_those(mesh: &Mesh, count: impl Fn(&[DVec3; 3]) -> bool) -> Option<Ball> {
        let seen = || counted(mesh, &count).flatten();
        let empty = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        let [least, greatest] = seen().fold(empty, |[l, g], p| [l.min(p), g.max(p)]);
        let centre = 0.5 * least + 0.5 * greatest;
        let radius = seen().map(|p| p.distance(centre)).fold(0.0, f64::max);
        // Squared lengths, and the camera's position at most a hundred radii away, stay within the limits of scenes, and the sphere is
        // larger than the rounding error of its position.
        let seen = (1e-60..1e28).contains(&radius)
            && centre.length() < 1e29
            && centre.length() * 1e-12 < radius;
        seen.then_some(Ball { centre, radius })
    }
}
