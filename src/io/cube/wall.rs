//! Points on a surface that the pixels of a cube see, as in captures around corners: a laser and a sensor point at a wall, and times are
//! known per point.
//!
//! Neighbouring points are joined by two triangles; the texture coordinates of point (i, j) of h × w are the centre of its pixel, ((j +
//! ½) / w, (i + ½) / h), v = 0 at the first row. The surface ends at the outermost points, because nothing was measured beyond them.

use std::ops::Range;

use glam::DVec3;

use crate::mesh::Mesh;

/// The points.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Wall {
    /// Rows and columns of pixels.
    pub size: [usize; 2],
    /// The position of each pixel's point, metres, row by row.
    pub points: Vec<DVec3>,
    /// The surface's normal at each; empty if unknown.
    pub normals: Vec<DVec3>,
    /// The position of the sensor, metres.
    pub sensor: Option<DVec3>,
}

impl Wall {
    /// The distance of each point from the sensor, metres; `None` if its position is unknown.
    pub fn distances(&self) -> Option<Vec<f64>> {
        let sensor = self.sensor?;
        Some(self.points.iter().map(|p| p.distance(sensor)).collect())
    }

    /// The surface through the points of these rows and columns, with texture coordinates for a cube of their pixels. Fronts are on the
    /// side of the normals. `None` if there are fewer than two rows or columns.
    pub fn mesh(&self, rows: Range<usize>, columns: Range<usize>) -> Option<Mesh> {
        let [_, width] = self.size;
        let (h, w) = (rows.len(), columns.len());
        if h < 2 || w < 2 || u32::try_from(h * w).is_err() {
            return None;
        }
        let index = |i: usize, j: usize| (rows.start + i) * width + columns.start + j;
        let pixels = || (0..h).flat_map(|i| (0..w).map(move |j| (i, j)));
        let positions = pixels().map(|(i, j)| self.points[index(i, j)]).collect();
        let uvs = pixels().map(|(i, j)| {
            let centre = |n: usize, count: usize| (n as f32 + 0.5) / count as f32;
            [centre(j, w), centre(i, h)]
        });
        let uvs = uvs.collect();
        let mut triangles = Vec::new();
        for (i, j) in pixels().filter(|(i, j)| i + 1 < h && j + 1 < w) {
            let corner = |di: usize, dj: usize| ((i + di) * w + j + dj) as u32;
            let [a, b, c, d] = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
            // Down and then right; reversed if that shows the back.
            let [p, q, r] =
                [index(i, j), index(i + 1, j), index(i + 1, j + 1)].map(|n| self.points[n]);
            let normal = self.normals.get(index(i, j));
            let is_back = normal.is_some_and(|n| (q - p).cross(r - p).dot(*n) < 0.0);
            triangles.extend(match is_back {
                false => [[a, b, c], [a, c, d]],
                true => [[a, c, b], [a, d, c]],
            });
        }
        let mut mesh = Mesh::new(positions, triangles, [1.0; 3]);
        mesh.uvs = vec![uvs];
        // Without known normals, either side may be the front.
        for material in &mut mesh.materials {
            material.double_sided = self.normals.is_empty();
        }
        Some(mesh)
    }
}

/// The number of columns of a list of points that form a grid, row after row; `None` if they do not.
#[cfg(any(feature = "hdf5", test))]
pub(super) fn columns_of(points: &[DVec3]) -> Option<usize> {
    let count = points.len();
    let (first, last) = (*points.first()?, *points.last()?);
    // About a thousandth of the distance between neighbours, which is the diagonal over the root of the number of points.
    let tolerance = 1e-3 * first.distance(last) / (count as f64).sqrt();
    let is_grid = |columns: usize| {
        let (along, down) = (points[1] - first, points[columns] - first);
        let place = |n: usize| first + (n / columns) as f64 * down + (n % columns) as f64 * along;
        let apart = along.length() > 2.0 * tolerance && down.length() > 2.0 * tolerance;
        apart && (0..count).all(|n| points[n].distance(place(n)) <= tolerance)
    };
    // The second row begins at the first point off the direction of the first row.
    let along = *points.get(1)? - first;
    let leaves = |n: &usize| points[*n].distance(first + *n as f64 * along) > tolerance;
    let columns = (2..count).find(leaves)?;
    (count.is_multiple_of(columns) && is_grid(columns)).then_some(columns)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(h: usize, w: usize) -> Vec<DVec3> {
        let point = |n: usize| DVec3::new(0.1 * (n % w) as f64, 2.0, 0.2 * (n / w) as f64);
        (0..h * w).map(point).collect()
    }

    #[test]
    fn a_list_of_points_in_rows_is_a_grid() {
        assert_eq!(columns_of(&grid(3, 4)), Some(4));
        assert_eq!(columns_of(&grid(2, 2)), Some(2));
        let mut bent = grid(3, 4);
        bent[7].y += 0.1;
        assert_eq!(columns_of(&bent), None);
        assert_eq!(columns_of(&grid(1, 5)), None);
        assert_eq!(columns_of(&[DVec3::ZERO; 6]), None);
        assert_eq!(columns_of(&[]), None);
    }

    /// 3 × 4 points at distances of 0.1 m and 0.2 m make 2 · 3 · 2 triangles of 0.01 m² each, whose fronts face along the normals.
    #[test]
    fn the_surface_has_its_area_and_its_front() {
        for up in [1.0, -1.0] {
            let wall = Wall {
                size: [3, 4],
                points: grid(3, 4),
                normals: vec![up * DVec3::Y; 12],
                sensor: Some(DVec3::new(0.0, 0.0, 0.0)),
            };
            let mesh = wall.mesh(0..3, 0..4).unwrap();
            mesh.check().unwrap();
            assert_eq!(mesh.triangles.len(), 12);
            for triangle in &mesh.triangles {
                let [a, b, c] = triangle.map(|v| mesh.positions[v as usize]);
                let area = (b - a).cross(c - a) / 2.0;
                assert!((area - 0.01 * up * DVec3::Y).length() < 1e-12);
            }
            assert_eq!(mesh.uvs[0][5], [1.5 / 4.0, 1.5 / 3.0]);
            assert_eq!(wall.distances().unwrap()[0], 2.0);
            assert_eq!(wall.mesh(1..3, 2..4).unwrap().positions[0], wall.points[6]);
            assert!(wall.mesh(0..1, 0..4).is_none());
        }
    }
}
