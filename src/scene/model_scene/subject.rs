//! What the camera frames: a sphere around a model, and its outline.
//!
//! A model on a wide, level ground is framed without the ground: triangles at the very bottom are left out if all others fit into a sphere with
//! a quarter of the radius. A room whose walls face inwards is seen through those that are turned away, and lit from its middle.

use std::f64::consts::PI;
use std::path::Path;

use glam::DVec3;

use super::view::VIEWPOINT;
use crate::error::{Error, Result};
use crate::io::budget::Budget;
use crate::io::gltf::{self, BadTextures, BadVertices, GltfSummary, Want};
use crate::mesh::{self, Material, Mesh};

/// Cells of directions along each half axis: 1/12, or 5°, over which a sphere deviates from its tangent plane by 4·10⁻³.
const CELLS: usize = 12;
/// Points per radius on long edges, which appear curved: an arc of 1/8 radius deviates from its chord by less than 2·10⁻³ radii.
const PARTS: f64 = 8.0;
/// A ground is level to within the first fraction of the whole radius, and the subject on it has a radius below the second fraction of it.
const LEVEL: f64 = 0.01;
const WIDE: f64 = 0.25;
/// The distance of a camera from the centre that decides which sides of triangles it may see, in radii.
const EYE: f64 = 2.5;
/// A model has a ground of its own if triangles that face up cover this part of the rectangle around it (a round ground covers π/4), this
/// fraction of its radius above its bottom at most.
const COVERED: f64 = 0.5;
const THICK: f64 = 0.03;
/// The winding number about the middle of a room: between that of a flat box without its largest face and that of a corner.
const ROOM: f64 = -0.6;

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
    /// The height of a wide ground that is left out.
    pub(super) ground: Option<f64>,
    /// A point inside, the middle if possible, if it is a room: its walls surround the point and face it.
    pub(super) inside: Option<DVec3>,
    /// What of its surface a camera at [`VIEWPOINT`] may see, in pieces; empty unless it flashes.
    pub(super) seen: Vec<Piece>,
    /// The surfaces of the whole model that shine without a texture; none unless it flashes.
    pub(super) shining: Shining,
}

/// A piece of surface: all of one orientation in a small cube.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Piece {
    /// Its middle.
    pub(super) point: DVec3,
    /// Its mean normal, towards the camera.
    pub(super) normal: DVec3,
    pub(super) area: f64,
}

/// Surfaces that shine.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Shining {
    /// Their corners that are farthest in some direction, and their middle.
    pub(super) points: Vec<DVec3>,
    /// Their area as a fraction of the whole area.
    pub(super) part: f64,
    /// Their power over π: ∫ L dA of the mean L of the channels.
    pub(super) power: f64,
}

impl Subject {
    /// Bytes per vertex while a model is loaded without texture coordinates: its position, in a growing list.
    const VERTEX: u64 = 2 * 24;
    /// Bytes per triangle: its corners, in a growing list, and as they are in the file.
    const TRIANGLE: u64 = 2 * 12 + 12;

    pub(super) fn of(
        path: &Path,
        held: &GltfSummary,
        flashes: bool,
        budget: &Budget,
    ) -> Result<Subject> {
        let taken = Subject::VERTEX.saturating_mul(held.vertices);
        let taken = taken.saturating_add(held.placing);
        budget.take(
            taken.saturating_add(Subject::TRIANGLE.saturating_mul(held.triangles)),
            path,
        )?;
        let want = Want {
            uvs: false,
            textures: false,
            // Textures tell where materials shine.
            shading: flashes && held.factors.iter().any(|factors| factors.emits),
            normals: false,
            bad_vertices: BadVertices::Drop,
            bad_textures: BadTextures::Drop,
        };
        let mesh = gltf::load(path, None, want)?.mesh;
        let subject = Subject::in_mesh(&mesh).ok_or_else(|| {
            let what = "its triangles have no extent that a camera could frame";
            let help = "export a model whose triangles have an area, in metres from 1e-60 to 1e28, and no corner that is not finite";
            Error::invalid(path, "meshes", what, help)
        })?;
        Ok(match flashes {
            true => subject.with_surface(&mesh),
            false => subject,
        })
    }

    /// The same with its surface.
    pub(super) fn with_surface(self, mesh: &Mesh) -> Subject {
        Subject {
            seen: pieces(self.ball, mesh),
            shining: Shining::of(mesh),
            ..self
        }
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
                Some(above) => Subject {
                    ground: Some(bottom),
                    ..Subject::within(above, mesh, is_above)
                },
                None => {
                    let inside = inside_room(mesh, all.centre);
                    let has_floor =
                        inside.is_some() || has_ground(mesh, bottom + THICK * all.radius);
                    Subject {
                        floor: (!has_floor).then_some(bottom),
                        inside,
                        ..Subject::within(all, mesh, |_| true)
                    }
                }
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
            ground: None,
            inside: None,
            seen: Vec::new(),
            shining: Shining::default(),
        }
    }
}

/// A point that the surfaces of `mesh` surround and face, as the walls of a room do: the winding number about it, which is 1 inside a
/// closed body and 0 outside (Jacobson, Kavan, Sorkine-Hornung, "Robust inside-outside segmentation using generalized winding numbers",
/// 2013), is near −1. Of a cube without one face it is −5/6, of a corner of three walls of a box −1/2.
///
/// Something may stand at the `centre` of a room, about which the winding number is then 0. If the whole mesh faces inwards, that is, if its
/// signed volume is below 0, it is also a room if most of the points half-way to the corners of its box are inside: of two opposite points
/// in a corner of three walls, one at most is. Then it is the first of these, from above and towards the viewer.
fn inside_room(mesh: &Mesh, centre: DVec3) -> Option<DVec3> {
    // Both sides of it are seen.
    if with_materials(mesh).any(|(_, material)| material.double_sided) {
        return None;
    }
    let triangles = || counted(mesh, |_| true);
    let is_inside = |point: &DVec3| {
        let solid_angle: f64 = triangles().map(|t| mesh::solid_angle(t, *point)).sum();
        solid_angle < ROOM * 4.0 * PI
    };
    if is_inside(&centre) {
        return Some(centre);
    }
    let (mut six_volumes, mut reach) = (0.0, DVec3::ZERO);
    for [a, b, c] in triangles().map(|t| t.map(|p| p - centre)) {
        six_volumes += a.dot(b.cross(c));
        reach = [a, b, c].iter().fold(reach, |most, p| most.max(p.abs()));
    }
    if six_volumes >= 0.0 {
        return None;
    }
    let sides = [1.0, -1.0];
    let corners = sides.iter().flat_map(|&y| {
        let x = move |z: f64| sides.map(|x| DVec3::new(x, y, z));
        sides.into_iter().flat_map(x)
    });
    let points = corners.map(|corner| centre + 0.5 * corner * reach);
    let points: Vec<DVec3> = points.filter(is_inside).collect();
    points.first().copied().filter(|_| points.len() > 4)
}

/// The surface of the triangles within `ball`, as far as a camera at [`VIEWPOINT`] may see it: whatever faces it.
fn pieces(ball: Ball, mesh: &Mesh) -> Vec<Piece> {
    // Rounding at the farthest corner.
    let reach = ball.radius * (1.0 + 1e-9);
    let cells = (2.0 * PARTS) as usize;
    let step = ball.radius / PARTS;
    let eye = ball.centre + EYE * ball.radius * VIEWPOINT.normalize();
    let none = (0.0, DVec3::ZERO, DVec3::ZERO);
    // The sums of areas, of places and of normals, both by area, in each cube for each of six orientations.
    let mut sums = vec![none; 6 * cells * cells * cells];
    for (corners @ [a, b, c], material) in with_materials(mesh) {
        let twice = (b - a).cross(c - a);
        let is_within = corners.iter().all(|p| p.distance(ball.centre) <= reach);
        if twice == DVec3::ZERO || !is_within {
            continue;
        }
        let longest = (b - a).length().max((c - b).length()).max((a - c).length());
        let parts = (longest / step).clamp(1.0, 2.0 * PARTS).ceil() as u32;
        let area = 0.5 * twice.length() / f64::from(parts * parts);
        for [u, v] in middles(parts) {
            let point = a + (b - a) * u + (c - a) * v;
            let towards = (eye - point).dot(twice);
            let is_seen = towards > 0.0 || material.double_sided;
            let normal = twice.normalize() * towards.signum();
            let within = (point - ball.centre) / step + PARTS;
            let [x, y, z] = within.to_array().map(|x| (x as usize).min(cells - 1));
            let axis = normal.abs().max_position();
            let side = 2 * axis + usize::from(normal[axis] > 0.0);
            if is_seen {
                let sum = &mut sums[((x * cells + y) * cells + z) * 6 + side];
                *sum = (sum.0 + area, sum.1 + area * point, sum.2 + area * normal);
            }
        }
    }
    let found = sums.into_iter().filter(|(area, ..)| *area > 0.0);
    let piece = |(area, places, normals): (f64, DVec3, DVec3)| Piece {
        point: places / area,
        normal: normals.normalize_or_zero(),
        area,
    };
    found.map(piece).collect()
}

/// The barycentric coordinates of the middles of the `parts`² equal parts of a triangle.
fn middles(parts: u32) -> impl Iterator<Item = [f64; 2]> {
    let n = f64::from(parts);
    let rows = (0..parts).flat_map(move |i| (0..parts - i).map(move |j| [i, j].map(f64::from)));
    rows.flat_map(move |[i, j]| {
        let third = |x: f64| (x + 1.0 / 3.0) / n;
        // The triangle that points the other way, if there is one.
        let other = (i + j + 2.0 <= n).then(|| [i, j].map(|x| third(x + 1.0 / 3.0)));
        std::iter::once([i, j].map(third)).chain(other)
    })
}

impl Shining {
    pub(super) fn of(mesh: &Mesh) -> Shining {
        let (mut whole, mut area, mut power, mut middle) = (0.0, 0.0, 0.0, DVec3::ZERO);
        let mut farthest: Vec<(DVec3, DVec3)> = Vec::new();
        let shines = |m: &Material| m.emissive != [0.0; 3] && m.emissive_texture.is_none();
        for ([a, b, c], material) in with_materials(mesh) {
            let own = 0.5 * (b - a).cross(c - a).length();
            whole += own;
            if own == 0.0 || !shines(material) {
                continue;
            }
            area += own;
            middle += own * (a + b + c) / 3.0;
            power += own * f64::from(material.emissive.iter().sum::<f32>()) / 3.0;
            if farthest.is_empty() {
                let steps = || [-1.0, 0.0, 1.0].into_iter();
                let all = steps().flat_map(|x| {
                    steps().flat_map(move |y| steps().map(move |z| DVec3::new(x, y, z)))
                });
                farthest = all.map(|direction| (direction, a)).collect();
            }
            for (direction, point) in &mut farthest {
                let farther = |p: DVec3| p.dot(*direction) > point.dot(*direction);
                if let Some(p) = [a, b, c].into_iter().find(|p| farther(*p)) {
                    *point = p;
                }
            }
        }
        if area == 0.0 {
            return Shining::default();
        }
        let corners = farthest.into_iter().map(|(_, point)| point);
        Shining {
            points: corners.chain([middle / area]).collect(),
            part: area / whole,
            power,
        }
    }
}

/// The corners of all triangles, with their materials.
fn with_materials(mesh: &Mesh) -> impl Iterator<Item = ([DVec3; 3], &Material)> {
    mesh.parts.iter().flat_map(move |part| {
        let all = part.first_triangle..part.first_triangle + part.triangles;
        let material = &mesh.materials[part.material as usize];
        all.map(move |i| (mesh.corners(i), material))
    })
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
