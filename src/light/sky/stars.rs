//! Stars: discs of uniform radiance, found by a grid on the faces of a cube.
//!
//! A star is a blackbody: seen at W it is one of the temperature T/W, for W⁻⁵ B(λ/W; T) = B(λ; T/W). What comes of it
//! through a surface across is that times the solid angle Ω that a blackbody would have, and with dω_F = W² dω
//!
//! ```text
//! E_F = W² Ω B(λ; T/W).
//! ```

use glam::DVec3;

use super::panorama::{greater, integer, lesser};
use crate::accel::vectors::{BLOCK, Columns, VectorLoop, dispatch};
use crate::colour::blackbody_colour;

/// A star.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Star {
    /// Unit vector towards it.
    pub direction: DVec3,
    /// Of its spectrum, in kelvin.
    pub temperature: f64,
    /// Ω: what it sends through a surface across, over the radiance of a blackbody.
    pub solid_angle: f64,
}

impl Star {
    /// One that sends light of this luminance through a surface across, at rest in the world.
    pub fn new(direction: DVec3, temperature: f64, luminance: f64) -> Star {
        let [r, g, b] = blackbody_colour(temperature);
        Star {
            direction,
            temperature,
            // Y of linear sRGB.
            solid_angle: luminance / (0.2126 * r + 0.7152 * g + 0.0722 * b),
        }
    }

    /// Linear sRGB of Ω B(λ; T/W).
    #[inline]
    pub fn colour(&self, w: f64) -> [f64; 3] {
        blackbody_colour(self.temperature / w).map(|c| c * self.solid_angle)
    }

    /// The same at rest, within sRGB.
    #[inline]
    pub fn channels(&self) -> [f64; 3] {
        self.colour(1.0).map(|c| c.max(0.0))
    }
}

/// Stars of one angular radius ρ: radiance E/(π sin² ρ) within it.
#[derive(Debug)]
pub struct StarMap {
    stars: Vec<Star>,
    /// cos ρ, and 1/(π sin² ρ).
    cosine: f64,
    density: f64,
    grid: Grid,
    /// Stars that reach into each cell: where its list begins, and the lists one after the other.
    begins: Vec<u32>,
    lists: Vec<u32>,
}

/// Square cells on the faces of a cube about the observer.
#[derive(Debug, Clone, Copy)]
struct Grid {
    /// Along an edge of a face.
    cells: usize,
}

impl StarMap {
    /// `stars` of the angular `radius`, at most some degrees.
    pub fn new(stars: Vec<Star>, radius: f64) -> StarMap {
        let sine = libm::sin(radius);
        let grid = Grid::new(stars.len(), radius);
        let mut entries: Vec<(u32, u32)> = Vec::new();
        for (index, star) in stars.iter().enumerate() {
            grid.each_reached(star.direction, sine, |cell| {
                entries.push((cell, index as u32))
            });
        }
        entries.sort_unstable();
        entries.dedup();
        // Where lists begin, by counting.
        let mut begins = vec![0; 6 * grid.cells * grid.cells + 1];
        for (cell, _) in &entries {
            begins[*cell as usize + 1] += 1;
        }
        let mut sum = 0;
        for begin in &mut begins {
            sum += *begin;
            *begin = sum;
        }
        StarMap {
            cosine: libm::cos(radius),
            density: 1.0 / (std::f64::consts::PI * sine * sine),
            grid,
            begins,
            lists: entries.into_iter().map(|(_, star)| star).collect(),
            stars,
        }
    }

    /// The sum of the radiances of the stars within whose discs `d` lies, `light` of each being what it sends through a
    /// surface across.
    #[inline]
    pub fn radiance(&self, d: DVec3, light: impl Fn(&Star) -> [f64; 3]) -> [f64; 3] {
        let cell = self.grid.cell(d.as_vec3().to_array()) as usize;
        let list = self.begins[cell] as usize..self.begins[cell + 1] as usize;
        let mut sum = [0.0; 3];
        for &index in &self.lists[list] {
            let star = &self.stars[index as usize];
            if d.dot(star.direction) > self.cosine {
                for (sum, e) in sum.iter_mut().zip(light(star)) {
                    *sum += e * self.density;
                }
            }
        }
        sum
    }

    /// Calls `each` with the numbers of the directions near which there is a star: all others lie in no disc.
    pub(crate) fn each_near(&self, directions: &Columns, mut each: impl FnMut(usize)) {
        let (mut cells, mut near) = ([0; BLOCK], [0; BLOCK]);
        let mut begin = 0;
        while begin < directions.len() {
            dispatch(Cells {
                grid: self.grid,
                directions,
                begin,
                cells: &mut cells,
            });
            // Whether there is one near goes into the count, and not into a branch that would often be guessed wrongly.
            let mut count = 0;
            for (k, cell) in cells.iter().enumerate() {
                let cell = *cell as usize;
                near[count % BLOCK] = begin + k;
                count += usize::from(self.begins[cell] != self.begins[cell + 1]);
            }
            for k in &near[..count] {
                // The last block is filled up.
                if *k < directions.len() {
                    each(*k);
                }
            }
            begin += BLOCK;
        }
    }

    /// The stars.
    pub fn stars(&self) -> &[Star] {
        &self.stars
    }
}

impl Grid {
    /// For so many stars of the angular `radius`: most cells are empty, unless discs are as wide as cells.
    fn new(stars: usize, radius: f64) -> Grid {
        // 16 cells per star, and an edge of a cell, 2 of the face's own units, at least as long as a disc is wide.
        let by_count = (16.0 / 6.0 * stars as f64).sqrt();
        let by_radius = 1.0 / radius;
        let cells = by_count.min(by_radius).clamp(64.0, 512.0) as usize;
        Grid {
            cells: cells.next_power_of_two(),
        }
    }

    /// The cell in which a direction lies, whose place on its face is right to 1·10⁻⁶.
    #[inline(always)]
    fn cell(self, [x, y, z]: [f32; 3]) -> u32 {
        // The longest axis, and the others in turn after it.
        let (a, b, c) = (x.abs(), y.abs(), z.abs());
        let (is_x, is_y) = ((a >= b) & (a >= c), b >= c);
        let (first, u, v, face) = if is_y { (y, z, x, 2) } else { (z, x, y, 4) };
        let (first, u, v, face) = if is_x {
            (x, y, z, 0)
        } else {
            (first, u, v, face)
        };
        let face = face + u32::from(first < 0.0);
        // Rounding may reach the end of the last cell.
        let half = 0.5 * self.cells as f32;
        let (scale, most) = (half / first.abs(), self.cells as f32 - 1.0);
        let column = integer(lesser(greater(u * scale + half, 0.0).floor(), most));
        let row = integer(lesser(greater(v * scale + half, 0.0).floor(), most));
        let cells = self.cells as u32;
        (face * cells + row) * cells + column
    }

    /// Calls `each` with the cells that a disc about `d` may reach into, which has a radius of this sine.
    fn each_reached(self, d: DVec3, sine: f64, mut each: impl FnMut(u32)) {
        // The chord to the edge is longer than the sine by less than that.
        let sine = 1.01 * sine;
        for face in 0..6 {
            let (axis, u, v) = axes(face);
            let depth = d.dot(axis);
            // A disc that is not before the face by at least its radius reaches at most its edge from behind.
            let nearest = depth - sine;
            if nearest <= 0.4 {
                continue;
            }
            let range = |side: DVec3| {
                let middle = d.dot(side) / depth;
                // The disc's edge is off by at most sin ρ (1 + |middle|)/(depth − sin ρ) on the face, and its place by 1·10⁻⁶.
                let reach = sine * (1.0 + middle.abs()) / nearest + 1e-6;
                let at = |x: f64| ((0.5 * (x + 1.0)) * self.cells as f64).floor();
                (
                    at(middle - reach).max(0.0),
                    at(middle + reach).min(self.cells as f64 - 1.0),
                )
            };
            let ((left, right), (top, bottom)) = (range(u), range(v));
            let mut y = top;
            while y <= bottom {
                let mut x = left;
                while x <= right {
                    each(((face * self.cells + y as usize) * self.cells + x as usize) as u32);
                    x += 1.0;
                }
                y += 1.0;
            }
        }
    }
}

/// Directions of a block to cells.
struct Cells<'a> {
    grid: Grid,
    directions: &'a Columns,
    begin: usize,
    cells: &'a mut [u32; BLOCK],
}

impl VectorLoop for Cells<'_> {
    #[inline(always)]
    fn run(self) {
        let d = self.directions.block(self.begin);
        let (mut x, mut y, mut z) = ([0.0; BLOCK], [0.0; BLOCK], [0.0; BLOCK]);
        for k in 0..BLOCK {
            let d = d.get(k).as_vec3();
            (x[k], y[k], z[k]) = (d.x, d.y, d.z);
        }
        for k in 0..BLOCK {
            self.cells[k] = self.grid.cell([x[k], y[k], z[k]]);
        }
    }
}

/// The outward axis of a face of the cube, and its sides.
pub(super) fn axes(face: usize) -> (DVec3, DVec3, DVec3) {
    let sign = if face.is_multiple_of(2) { 1.0 } else { -1.0 };
    match face / 2 {
        0 => (DVec3::X * sign, DVec3::Y, DVec3::Z),
        1 => (DVec3::Y * sign, DVec3::Z, DVec3::X),
        _ => (DVec3::Z * sign, DVec3::X, DVec3::Y),
    }
}

/// The face of the cube that `d` goes through, and where, from −1 to 1 along its sides.
#[inline]
pub(super) fn on_cube(d: DVec3) -> (usize, [f64; 2]) {
    let a = d.abs();
    if a.x >= a.y && a.x >= a.z {
        (usize::from(d.x < 0.0), [d.y / a.x, d.z / a.x])
    } else if a.y >= a.z {
        (2 + usize::from(d.y < 0.0), [d.z / a.y, d.x / a.y])
    } else {
        (4 + usize::from(d.z < 0.0), [d.x / a.z, d.y / a.z])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_near_no_star_lie_in_no_disc_and_are_most() {
        let mut state = 3u64;
        let mut next = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1);
            (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        };
        let mut vector = || DVec3::new(next(), next(), next()).normalize();
        let stars: Vec<_> = (0..3000)
            .map(|_| Star::new(vector(), 5000.0, 1.0))
            .collect();
        // As small as discs may be, and as wide as some pixels.
        for radius in [1e-9, 7e-4] {
            let map = StarMap::new(stars.clone(), radius);
            let mut directions = Columns::default();
            for k in 0..5000 {
                // Every fifth within a disc or at its edge.
                let d = match k % 5 {
                    0 => (stars[k % 3000].direction + vector() * radius).normalize(),
                    _ => vector(),
                };
                directions.push(d);
            }
            let mut is_near = vec![false; directions.len()];
            map.each_near(&directions, |k| is_near[k] = true);
            let mut seen = 0;
            for (k, is_near) in is_near.iter().enumerate() {
                let d = directions.get(k);
                let lies_in = stars.iter().any(|s| d.dot(s.direction) > map.cosine);
                assert!(*is_near || !lies_in, "{radius} {d}");
                assert!(*is_near || map.radiance(d, |_| [1.0; 3]) == [0.0; 3]);
                seen += usize::from(lies_in);
            }
            assert!(radius < 1e-6 || seen > 300, "{seen}");
            let near = is_near.iter().filter(|near| **near).count();
            assert!((1000..2000).contains(&near), "{near}");
        }
    }

    /// Cells of directions are found in single precision, which takes those closer to a cell's edge than its rounding for the next cell's.
    #[test]
    fn a_disc_that_ends_before_the_edge_of_a_cell_is_found_beyond_it() {
        const RADIUS: f64 = 3e-7;
        // On the face z = 1, where x = 0 is an edge between cells: directions just before it, and for each a star whose disc ends little beyond the
        // direction. Near x = 0 an angle is as wide there as du / √(1 + y²).
        let places = (0..2000).map(|k| {
            let (before, y) = (
                (f64::from(k) + 0.5) / 2000.0 * 4e-8,
                0.3 + f64::from(k) * 1e-4,
            );
            let along = |x: f64| DVec3::new(-x, y, 1.0).normalize();
            let star = along(before + 0.98 * RADIUS * (1.0 + y * y).sqrt());
            (along(before), Star::new(star, 5000.0, 1.0))
        });
        let (directions, stars): (Vec<_>, Vec<_>) = places.unzip();
        let map = StarMap::new(stars, RADIUS);
        for d in directions {
            assert!(map.radiance(d, |_| [1.0; 3]) != [0.0; 3], "{d}");
        }
    }

    #[test]
    fn every_direction_finds_the_stars_that_it_lies_in() {
        let mut state = 1u64;
        let mut next = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1);
            (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        };
        let mut vector = || DVec3::new(next(), next(), next()).normalize();
        let stars: Vec<_> = (0..400).map(|_| Star::new(vector(), 5000.0, 1.0)).collect();
        for radius in [1e-4, 0.01, 0.087] {
            let map = StarMap::new(stars.clone(), radius);
            for k in 0..4000 {
                let near = stars[k % stars.len()].direction;
                let d = (near + vector() * (radius * 1.2)).normalize();
                let lies_in = |s: &&Star| d.dot(s.direction) > libm::cos(radius);
                let count = stars.iter().filter(lies_in).count() as f64;
                let found = map.radiance(d, |_| [0.0, 1.0, 0.0])[1] / map.density;
                assert!(
                    (found - count).abs() < 1e-9,
                    "{radius} {d}: {found} {count}"
                );
            }
        }
    }
}
