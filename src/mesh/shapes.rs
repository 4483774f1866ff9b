//! Built-in shapes: meshes that need no file.
//!
//! Counter-clockwise corners seen from outside, so that geometric normals point outward. Texture
//! coordinates: v = 0 is the top row of an image, as in glTF.

use std::collections::HashMap;

use glam::DVec3;

use super::triangles::{Material, Mesh, Part};

/// Shapes that need no file; each is closed or flat, with outward normals and TEXCOORD_0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// An axis-aligned box centred on the origin, edge lengths in metres.
    Box {
        /// Edge lengths along x, y, z.
        size: [f64; 3],
    },
    /// An icosphere centred on the origin.
    Sphere {
        /// Radius of the vertices, metres.
        radius: f64,
        /// Subdivisions of the icosahedron, 0 to 8; 20·4ⁿ triangles.
        subdivisions: u32,
    },
    /// A rectangle in the plane y = 0 centred on the origin, facing +y.
    Plane {
        /// Edge lengths along x and z.
        size: [f64; 2],
    },
    /// A wire lattice of square bars along the edges of cubic cells: the classic subject for seeing aberration.
    Lattice {
        /// Cells along x, y, z, each 1 to 64.
        cells: [u32; 3],
        /// Edge length of a cell, metres.
        spacing: f64,
        /// Thickness of a bar, metres, below `spacing`.
        bar: f64,
    },
}

/// How many triangles `shape` has, or 2⁶⁴ − 1 of more.
pub fn triangle_count(shape: Shape) -> u64 {
    match shape {
        Shape::Box { .. } => 12,
        Shape::Plane { .. } => 2,
        Shape::Sphere { subdivisions, .. } => 4u64.saturating_pow(subdivisions).saturating_mul(20),
        Shape::Lattice { cells, .. } => bars(cells).saturating_mul(12),
    }
}

/// The mesh of `shape` with one material of linear base colour `colour`.
pub fn mesh(shape: Shape, colour: [f32; 3]) -> Mesh {
    let mut mesh = match shape {
        Shape::Box { size } => cuboid(DVec3::from(size)),
        Shape::Plane { size: [x, z] } => plane(x, z),
        Shape::Sphere {
            radius,
            subdivisions,
        } => sphere(radius, subdivisions),
        Shape::Lattice {
            cells,
            spacing,
            bar,
        } => lattice(cells, spacing, bar),
    };
    mesh.parts = vec![Part {
        first_triangle: 0,
        triangles: mesh.triangles.len() as u32,
        material: 0,
        node: String::new(),
    }];
    mesh.materials = vec![Material {
        double_sided: matches!(shape, Shape::Plane { .. }),
        ..Material::matte(colour)
    }];
    mesh
}

/// Adds a rectangle with corner `p`, edges `right` and `down` as seen from its front.
fn quad(mesh: &mut Mesh, p: DVec3, right: DVec3, down: DVec3) {
    let first = mesh.positions.len() as u32;
    let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
    for (u, v) in corners {
        mesh.positions.push(p + right * u + down * v);
        uvs(mesh).push([u as f32, v as f32]);
    }
    mesh.triangles.push([first, first + 2, first + 1]);
    mesh.triangles.push([first, first + 3, first + 2]);
}

fn uvs(mesh: &mut Mesh) -> &mut Vec<[f32; 2]> {
    if mesh.uvs.is_empty() {
        mesh.uvs.push(Vec::new());
    }
    &mut mesh.uvs[0]
}

fn plane(x: f64, z: f64) -> Mesh {
    let mut mesh = Mesh::default();
    let corner = DVec3::new(-0.5 * x, 0.0, -0.5 * z);
    quad(&mut mesh, corner, DVec3::X * x, DVec3::Z * z);
    mesh
}

fn cuboid(size: DVec3) -> Mesh {
    let mut mesh = Mesh::default();
    add_cuboid(&mut mesh, DVec3::ZERO, size);
    mesh
}

fn add_cuboid(mesh: &mut Mesh, centre: DVec3, size: DVec3) {
    // Each face: its outward normal, and the direction to the right as seen from outside.
    let faces = [
        (DVec3::X, -DVec3::Z),
        (-DVec3::X, DVec3::Z),
        (DVec3::Y, DVec3::X),
        (-DVec3::Y, DVec3::X),
        (DVec3::Z, DVec3::X),
        (-DVec3::Z, -DVec3::X),
    ];
    for (normal, right) in faces {
        let down = right.cross(normal);
        let corner = centre + 0.5 * size * (normal - right - down);
        quad(mesh, corner, size * right, size * down);
    }
}

/// The number of bars of a lattice: along each axis, cells × nodes of the other two.
fn bars([x, y, z]: [u32; 3]) -> u64 {
    let [x, y, z] = [x, y, z].map(u64::from);
    let across = |a: u64, b: u64| (a + 1).saturating_mul(b + 1);
    across(y, z)
        .saturating_add(across(x, z))
        .saturating_add(across(x, y))
}

fn lattice(cells: [u32; 3], spacing: f64, bar: f64) -> Mesh {
    let mut mesh = Mesh::default();
    let extent = cells.map(|n| n as f64 * spacing);
    for axis in 0..3 {
        let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
        for j in 0..=cells[b] {
            for k in 0..=cells[c] {
                let mut centre = DVec3::ZERO;
                centre[b] = j as f64 * spacing - 0.5 * extent[b];
                centre[c] = k as f64 * spacing - 0.5 * extent[c];
                let mut size = DVec3::splat(bar);
                size[axis] = extent[axis] + bar;
                add_cuboid(&mut mesh, centre, size);
            }
        }
    }
    mesh
}

/// An icosahedron, each triangle split in four `subdivisions` times, vertices on the sphere.
fn sphere(radius: f64, subdivisions: u32) -> Mesh {
    let (mut points, mut triangles) = icosahedron();
    for _ in 0..subdivisions {
        let mut midpoints = HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *midpoints.entry((a.min(b), a.max(b))).or_insert_with(|| {
                points.push((points[a as usize] + points[b as usize]).normalize());
                points.len() as u32 - 1
            })
        };
        triangles = triangles
            .iter()
            .flat_map(|&[a, b, c]| {
                let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    Mesh {
        uvs: vec![points.iter().map(|p| longitude_latitude(*p)).collect()],
        positions: points.into_iter().map(|p| p * radius).collect(),
        triangles,
        ..Mesh::default()
    }
}

/// Texture coordinates of a world map: u along the longitude, v = 0 at the north pole (+y).
fn longitude_latitude(p: DVec3) -> [f32; 2] {
    let u = 0.5 + libm::atan2(p.x, p.z) / std::f64::consts::TAU;
    let v = libm::acos(p.y.clamp(-1.0, 1.0)) / std::f64::consts::PI;
    [u as f32, v as f32]
}

fn icosahedron() -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let golden = 0.5 * (1.0 + 5f64.sqrt());
    let mut points = Vec::with_capacity(12);
    for (a, b) in [
        (1.0, golden),
        (-1.0, golden),
        (1.0, -golden),
        (-1.0, -golden),
    ] {
        points.push(DVec3::new(0.0, a, b).normalize());
        points.push(DVec3::new(a, b, 0.0).normalize());
        points.push(DVec3::new(b, 0.0, a).normalize());
    }
    (points.clone(), faces(&points))
}

/// All triples of mutually adjacent vertices, counter-clockwise from outside.
fn faces(points: &[DVec3]) -> Vec<[u32; 3]> {
    // Neighbours on the unit icosahedron enclose arccos(1/√5); the next ones are beyond 90°.
    let adjacent = |a: usize, b: usize| points[a].dot(points[b]) > 0.4;
    let n = points.len();
    let mut faces = Vec::with_capacity(20);
    for a in 0..n {
        for b in a + 1..n {
            for c in b + 1..n {
                if adjacent(a, b) && adjacent(b, c) && adjacent(c, a) {
                    let normal = (points[b] - points[a]).cross(points[c] - points[a]);
                    let flip = normal.dot(points[a]) < 0.0;
                    let [b, c] = if flip { [c, b] } else { [b, c] };
                    faces.push([a as u32, b as u32, c as u32]);
                }
            }
        }
    }
    faces
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Volume by the divergence theorem: Σ a·(b×c)/6; positive where normals point outward.
    fn volume(mesh: &Mesh) -> f64 {
        (0..mesh.triangles.len() as u32)
            .map(|i| mesh.corners(i))
            .map(|[a, b, c]| a.dot(b.cross(c)) / 6.0)
            .sum()
    }

    fn of(shape: Shape) -> Mesh {
        let mesh = mesh(shape, [1.0; 3]);
        assert_eq!(mesh.triangles.len() as u64, triangle_count(shape));
        mesh
    }

    #[test]
    fn a_box_has_outward_normals_and_its_volume() {
        let cube = of(Shape::Box {
            size: [1.0, 2.0, 3.0],
        });
        assert!((volume(&cube) - 6.0).abs() < 1e-12);
    }

    #[test]
    fn a_sphere_converges_to_the_volume_of_the_ball() {
        let ball = 4.0 / 3.0 * std::f64::consts::PI * 8.0;
        let error = |subdivisions| {
            let sphere = of(Shape::Sphere {
                radius: 2.0,
                subdivisions,
            });
            1.0 - volume(&sphere) / ball
        };
        // Second order: each subdivision leaves a quarter of the error.
        assert!(error(3) > 0.0 && (error(3) / error(4) - 4.0).abs() < 0.1);
    }

    #[test]
    fn a_plane_faces_up() {
        let plane = of(Shape::Plane { size: [2.0, 3.0] });
        let [a, b, c] = plane.corners(0);
        assert!((b - a).cross(c - a).y > 0.0);
    }

    #[test]
    fn a_lattice_has_all_its_bars() {
        let lattice = of(Shape::Lattice {
            cells: [2, 3, 4],
            spacing: 1.0,
            bar: 0.1,
        });
        assert_eq!(lattice.triangles.len(), 12 * (4 * 5 + 3 * 5 + 3 * 4));
        assert!(volume(&lattice) > 0.0);
    }
}
