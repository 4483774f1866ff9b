//! Stars: discs of uniform radiance, found by a grid on the faces of a cube.
//!
//! A star is a blackbody: seen at W it is one of the temperature T/W, for W⁻⁵ B(λ/W; T) = B(λ; T/W). What comes of it
//! through a surface across is that times the solid angle Ω that a blackbody would have, and with dω_F = W² dω
//!
//! ```text
//! E_F = W² Ω B(λ; T/W).
//! ```

use glam::DVec3;

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
    /// Stars that reach into each cell: where its list begins, and the lists one after the other.
    begins: Vec<u32>,
    lists: Vec<u32>,
}

/// Cells along an edge of a face.
const CELLS: usize = 64;

impl StarMap {
    /// `stars` of the angular `radius`, at most some degrees.
    pub fn new(stars: Vec<Star>, radius: f64) -> StarMap {
        let sine = libm::sin(radius);
        let mut entries: Vec<(u32, u32)> = Vec::new();
        for (index, star) in stars.iter().enumerate() {
            reached(star.direction, sine, |cell| {
                entries.push((cell, index as u32))
            });
        }
        entries.sort_unstable();
        entries.dedup();
        let cells = 6 * CELLS * CELLS;
        let begin = |cell: usize| entries.partition_point(|(c, _)| (*c as usize) < cell) as u32;
        StarMap {
            cosine: libm::cos(radius),
            density: 1.0 / (std::f64::consts::PI * sine * sine),
            begins: (0..=cells).map(begin).collect(),
            lists: entries.into_iter().map(|(_, star)| star).collect(),
            stars,
        }
    }

    /// The sum of the radiances of the stars within whose discs `d` lies, `light` of each being what it sends through a
    /// surface across.
    #[inline]
    pub fn radiance(&self, d: DVec3, light: impl Fn(&Star) -> [f64; 3]) -> [f64; 3] {
        let (face, [x, y]) = on_cube(d);
        let cell = cell(face, x, y);
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

    /// The stars.
    pub fn stars(&self) -> &[Star] {
        &self.stars
    }
}

/// Calls `each` with the cells that a disc about `d` may reach into, which has a radius of this sine.
fn reached(d: DVec3, sine: f64, mut each: impl FnMut(u32)) {
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
            // The disc's edge is off by at most sin ρ (1 + |middle|)/(depth − sin ρ) on the face.
            let reach = sine * (1.0 + middle.abs()) / nearest;
            let at = |x: f64| ((0.5 * (x + 1.0)) * CELLS as f64).floor();
            (
                at(middle - reach).max(0.0),
                at(middle + reach).min(CELLS as f64 - 1.0),
            )
        };
        let ((left, right), (top, bottom)) = (range(u), range(v));
        let mut y = top;
        while y <= bottom {
            let mut x = left;
            while x <= right {
                each(((face * CELLS + y as usize) * CELLS + x as usize) as u32);
                x += 1.0;
            }
            y += 1.0;
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

#[inline]
fn cell(face: usize, x: f64, y: f64) -> usize {
    let at = |x: f64| ((0.5 * (x + 1.0) * CELLS as f64) as usize).min(CELLS - 1);
    (face * CELLS + at(y)) * CELLS + at(x)
}

#[cfg(test)]
mod tests {
    use super::*;

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
