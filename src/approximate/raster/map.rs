//! Pictures of all directions: from texels to directions and back.
//!
//! A *cube* has six square faces, +x, −x, +y, −y, +z, −z; a texel of face f lies at f + u a + v b, u and v
//! from −1 to 1. A *panorama* has longitude along its columns, from −π to π about +y with 0 along −z, and
//! latitude along its rows, +y at the top.

use glam::DVec3;

use super::method::{Lookup, Map};

/// Four texels and their weights; the first has the largest.
pub(super) type Taps = [(u32, f64); 4];

/// A place on a face, or on the panorama, in texels from its upper left corner.
struct Place {
    face: u32,
    x: f64,
    y: f64,
}

impl Map {
    /// Columns and rows of a face, or of the panorama.
    fn size(self) -> [u32; 2] {
        match self {
            Map::Cube(side) => [side, side],
            Map::Panorama(size) => size,
        }
    }

    /// The unit direction of the centre of texel `index`.
    pub(super) fn direction(self, index: u64) -> DVec3 {
        let [columns, rows] = self.size().map(u64::from);
        let (face, within) = (index / (columns * rows), index % (columns * rows));
        self.along(Place {
            face: face as u32,
            x: (within % columns) as f64 + 0.5,
            y: (within / columns) as f64 + 0.5,
        })
    }

    fn along(self, place: Place) -> DVec3 {
        let [columns, rows] = self.size().map(f64::from);
        match self {
            Map::Cube(_) => {
                // From −1 to 1 over the face; rows go down.
                let (u, v) = (2.0 * place.x / columns - 1.0, 2.0 * place.y / rows - 1.0);
                let [axis, a, b] = face(place.face);
                (axis + a * u + b * v).normalize()
            }
            Map::Panorama(_) => {
                // Its middle looks along −z.
                let longitude = (place.x / columns - 0.5) * std::f64::consts::TAU;
                let latitude = (0.5 - place.y / rows) * std::f64::consts::PI;
                let (sin, cos) = libm::sincos(longitude);
                let (up, along) = libm::sincos(latitude);
                DVec3::new(along * sin, up, -along * cos)
            }
        }
    }

    fn place(self, d: DVec3) -> Place {
        let [columns, rows] = self.size().map(f64::from);
        match self {
            Map::Cube(_) => {
                let index = face_of(d);
                let [axis, a, b] = face(index);
                // A texel's u is a·d/(axis·d), from −1 to 1.
                let scale = 0.5 / axis.dot(d);
                Place {
                    face: index,
                    x: (a.dot(d) * scale + 0.5) * columns,
                    y: (b.dot(d) * scale + 0.5) * rows,
                }
            }
            Map::Panorama(_) => {
                let longitude = libm::atan2(d.x, -d.z);
                // A component of a unit vector may exceed 1 by rounding.
                let latitude = libm::asin(d.y.clamp(-1.0, 1.0));
                Place {
                    face: 0,
                    x: (longitude / std::f64::consts::TAU + 0.5) * columns,
                    y: (0.5 - latitude / std::f64::consts::PI) * rows,
                }
            }
        }
    }

    /// The texel that holds direction `d`.
    fn nearest(self, d: DVec3) -> u32 {
        let place = self.place(d);
        self.index(place.face, place.x, place.y)
    }

    fn index(self, face: u32, x: f64, y: f64) -> u32 {
        let [columns, rows] = self.size();
        // Rounding may give a place before the first texel, which the cast turns into 0, or one after the last, which becomes the last.
        let (column, row) = ((x as u32).min(columns - 1), (y as u32).min(rows - 1));
        (face * rows + row) * columns + column
    }

    /// The texels in which direction `d` is looked up, and their weights.
    pub(super) fn taps(self, lookup: Lookup, d: DVec3) -> Taps {
        let place = self.place(d);
        let nearest = self.index(place.face, place.x, place.y);
        if lookup == Lookup::Nearest {
            return [
                (nearest, 1.0),
                (nearest, 0.0),
                (nearest, 0.0),
                (nearest, 0.0),
            ];
        }
        let (left, top) = ((place.x - 0.5).floor(), (place.y - 0.5).floor());
        let (x, y) = (place.x - 0.5 - left, place.y - 0.5 - top);
        let mut taps = [
            (self.texel(place.face, left, top), (1.0 - x) * (1.0 - y)),
            (self.texel(place.face, left + 1.0, top), x * (1.0 - y)),
            (self.texel(place.face, left, top + 1.0), (1.0 - x) * y),
            (self.texel(place.face, left + 1.0, top + 1.0), x * y),
        ];
        // The tap with the largest weight comes first.
        let largest = usize::from(x >= 0.5) + 2 * usize::from(y >= 0.5);
        taps.swap(0, largest);
        taps
    }

    /// The texel in this column and row; beyond an edge, the one that lies there on the sphere.
    fn texel(self, face: u32, column: f64, row: f64) -> u32 {
        let [columns, rows] = self.size().map(f64::from);
        let (x, y) = (column + 0.5, row + 0.5);
        if x > 0.0 && x < columns && y > 0.0 && y < rows {
            return self.index(face, x, y);
        }
        self.nearest(self.along(Place { face, x, y }))
    }
}

/// The axis of a face, and the directions in which its columns and rows are counted.
fn face(index: u32) -> [DVec3; 3] {
    match index {
        0 => [DVec3::X, -DVec3::Z, -DVec3::Y],
        1 => [-DVec3::X, DVec3::Z, -DVec3::Y],
        2 => [DVec3::Y, DVec3::X, DVec3::Z],
        3 => [-DVec3::Y, DVec3::X, -DVec3::Z],
        4 => [DVec3::Z, DVec3::X, -DVec3::Y],
        _ => [-DVec3::Z, -DVec3::X, -DVec3::Y],
    }
}

fn face_of(d: DVec3) -> u32 {
    let size = d.abs();
    let (axis, part) = match () {
        () if size.x >= size.y && size.x >= size.z => (0, d.x),
        () if size.y >= size.z => (2, d.y),
        () => (4, d.z),
    };
    axis + u32::from(part < 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const MAPS: [Map; 3] = [Map::Cube(7), Map::Cube(16), Map::Panorama([24, 11])];

    #[test]
    fn every_texel_holds_its_own_direction() {
        for map in MAPS {
            for index in 0..map.texels() {
                let d = map.direction(index);
                assert_eq!(u64::from(map.nearest(d)), index, "{map:?}");
            }
        }
    }

    #[test]
    fn the_parts_of_four_texels_sum_to_one_and_reproduce_the_direction() {
        for map in [Map::Cube(64), Map::Panorama([256, 128])] {
            for k in 0..2000 {
                // Points of a spiral over the sphere, away from the panorama's poles.
                let z = -0.9 + 1.8 * f64::from(k) / 1999.0;
                let angle = 2.4 * f64::from(k);
                let r = (1.0 - z * z).sqrt();
                let d = DVec3::new(r * angle.cos(), z, r * angle.sin());
                let taps = map.taps(Lookup::Bilinear, d);
                let sum: f64 = taps.iter().map(|t| t.1).sum();
                let mean: DVec3 = taps.iter().map(|t| map.direction(t.0.into()) * t.1).sum();
                assert!((sum - 1.0).abs() < 1e-12);
                assert!((mean - d).length() < 0.02, "{map:?} {d} {mean}");
                assert!(taps.iter().all(|t| t.1 <= taps[0].1));
            }
        }
    }
}
