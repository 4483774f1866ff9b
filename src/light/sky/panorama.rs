//! Equirectangular pictures of all directions.
//!
//! Texel (j, i) of N × N/2 has its centre at u = (j + ½)/N, v = (i + ½)/(N/2), longitude 2π (u − ½) and latitude
//! π (½ − v): the direction (sin λ cos φ, sin φ, −cos λ cos φ). The picture is kept in sizes of halves, each texel the
//! mean of those above it by solid angle, and looked up bilinearly in the two sizes whose texels are next to the width
//! that a pixel sees, linearly between them in the logarithm (Williams, "Pyramidal parametrics", SIGGRAPH 1983). Near
//! the poles texels are narrower than that: the mean is over rows, not along them.

use std::f64::consts::{FRAC_1_PI, FRAC_PI_2, PI};

use glam::DVec3;

use crate::accel::vectors::{BLOCK, Columns, VectorLoop, dispatch, load};

/// An equirectangular picture in sizes of halves.
#[derive(Debug)]
pub struct Panorama {
    /// The largest first; the last is 1 texel high.
    levels: Vec<Level>,
    /// Factor by channel.
    scale: [f64; 3],
    /// Turns it back: cosine and sine of the rotation about +Y.
    turn: [f64; 2],
}

#[derive(Debug)]
struct Level {
    width: usize,
    height: usize,
    /// Three channels each, by rows, and one number more: a texel is read as four, of which the last does not count.
    texels: Vec<f32>,
}

impl Panorama {
    /// The picture of `width` × `width`/2 texels by rows from the top, by `scale`, turned by `rotation` about +Y.
    pub fn new(texels: Vec<[f32; 3]>, width: usize, scale: [f64; 3], rotation: f64) -> Panorama {
        let mut levels = vec![Level::new(width, width / 2, texels)];
        while let Some(smaller) = levels.last().and_then(Level::half) {
            levels.push(smaller);
        }
        Panorama {
            levels,
            scale,
            turn: [libm::cos(rotation), libm::sin(rotation)],
        }
    }

    /// Radiance along `d` in texels about `angle` wide.
    #[inline]
    pub fn radiance(&self, d: DVec3, angle: f64) -> [f64; 3] {
        let (u, v) = place(self.turn, d.x, d.y, d.z);
        let halvings = logarithm(angle * self.texels_per_angle()).min(self.last());
        self.scaled(self.at(u, v, halvings))
    }

    /// Sets `radiance` to that along `directions`, each in texels about `angles` wide: [`Panorama::radiance`] in vector loops.
    pub(super) fn radiance_each(
        &self,
        directions: &Columns,
        angles: &[f64],
        radiance: &mut [[f64; 3]],
    ) {
        dispatch(LookUp {
            panorama: self,
            directions,
            angles,
            radiance,
        });
    }

    /// How many texels of the largest size a radian of the equator has.
    #[inline(always)]
    fn texels_per_angle(&self) -> f64 {
        self.levels[0].width as f64 * (0.5 * FRAC_1_PI)
    }

    /// The number of the smallest size.
    #[inline(always)]
    fn last(&self) -> f64 {
        (self.levels.len() - 1) as f64
    }

    /// The texels at a place so many halvings below the largest size, and a fourth number that does not count.
    #[inline(always)]
    fn at(&self, u: f64, v: f64, halvings: f64) -> [f64; 4] {
        let whole = halvings.floor();
        let (first, weight) = (index(whole), halvings - whole);
        let last = self.levels.len() - 1;
        let fine = self.levels[first.min(last)].sample(u, v);
        if weight > 0.0 {
            let coarse = self.levels[(first + 1).min(last)].sample(u, v);
            return mix(fine, coarse, weight);
        }
        fine
    }

    #[inline(always)]
    fn scaled(&self, [r, g, b, _]: [f64; 4]) -> [f64; 3] {
        let [by_r, by_g, by_b] = self.scale;
        [r * by_r, g * by_g, b * by_b]
    }
}

/// Where (x, y, z) lies in the picture, turned back by `turn`: from 0 to 1 along its width and its height.
#[inline(always)]
fn place([cosine, sine]: [f64; 2], x: f64, y: f64, z: f64) -> (f64, f64) {
    let (x, z) = (cosine * x - sine * z, sine * x + cosine * z);
    let u = arctan(x, -z) * (0.5 * FRAC_1_PI) + 0.5;
    let v = 0.5 - arctan(y, (x * x + z * z).sqrt()) * FRAC_1_PI;
    (u, v)
}

/// A whole number from 0 to 2³² as an index, of anything else some index: a sum with 2⁵² has it in its last bits.
#[inline(always)]
fn index(whole: f64) -> usize {
    (whole + 4_503_599_627_370_496.0).to_bits() as u32 as usize
}

/// Directions to radiance.
struct LookUp<'a> {
    panorama: &'a Panorama,
    directions: &'a Columns,
    angles: &'a [f64],
    radiance: &'a mut [[f64; 3]],
}

impl VectorLoop for LookUp<'_> {
    #[inline(always)]
    fn run(self) {
        let (turn, last) = (self.panorama.turn, self.panorama.last());
        let texels_per_angle = self.panorama.texels_per_angle();
        let (mut u, mut v, mut halvings) = ([0.0; BLOCK], [0.0; BLOCK], [0.0; BLOCK]);
        let mut texels = [[0.0; 4]; BLOCK];
        let mut begin = 0;
        for radiance in self.radiance.chunks_mut(BLOCK) {
            // Places of a block in vectors.
            let d = self.directions.load(begin);
            for k in 0..BLOCK {
                let d = d.get(k);
                (u[k], v[k]) = place(turn, d.x, d.y, d.z);
            }
            let angles = load(self.angles, begin);
            for k in 0..BLOCK {
                halvings[k] = logarithm(angles[k] * texels_per_angle).min(last);
            }
            // Texels one by one, their channels in a vector.
            for k in 0..radiance.len() {
                texels[k] = self.panorama.at(u[k], v[k], halvings[k]);
            }
            for (radiance, texel) in radiance.iter_mut().zip(&texels) {
                *radiance = self.panorama.scaled(*texel);
            }
            begin += BLOCK;
        }
    }
}

impl Level {
    fn new(width: usize, height: usize, texels: Vec<[f32; 3]>) -> Level {
        let mut texels = texels.into_flattened();
        texels.push(0.0);
        Level {
            width,
            height,
            texels,
        }
    }

    /// Half as wide and high, as far as there are halves.
    fn half(&self) -> Option<Level> {
        if self.height < 2 {
            return None;
        }
        let (width, height) = ((self.width / 2).max(1), self.height / 2);
        let columns = shares(self.width, width, |j| j as f64 / self.width as f64);
        // The solid angle above row i is as 1 − sin φ.
        let rows = shares(self.height, height, |i| {
            0.5 * (1.0 - libm::cos(PI * i as f64 / self.height as f64))
        });
        let mut texels = Vec::with_capacity(width * height);
        for row in &rows {
            for column in &columns {
                let mut sum = [0.0; 3];
                for &(i, in_row) in row {
                    for &(j, in_column) in column {
                        let texel = self.texel(i * self.width + j);
                        for c in 0..3 {
                            sum[c] += texel[c] * (in_row * in_column);
                        }
                    }
                }
                texels.push(sum.map(|x| x as f32));
            }
        }
        Some(Level::new(width, height, texels))
    }

    /// The channels of a texel, and a fourth number that does not count.
    #[inline(always)]
    fn texel(&self, at: usize) -> [f64; 4] {
        let [r, g, b, next] = *self.texels[3 * at..]
            .first_chunk()
            .expect("one number more than those of texels");
        [f64::from(r), f64::from(g), f64::from(b), f64::from(next)]
    }

    /// Bilinear between texel centres, around the longitudes.
    #[inline(always)]
    fn sample(&self, u: f64, v: f64) -> [f64; 4] {
        let (x, y) = (u * self.width as f64 - 0.5, v * self.height as f64 - 0.5);
        let (left, top) = (x.floor(), y.floor());
        let (j0, j1) = (self.wrapped(left), self.wrapped(left + 1.0));
        let (i0, i1) = (self.row(top), self.row(top + 1.0));
        let (right, below) = (x - left, y - top);
        let upper = mix(self.texel(i0 + j0), self.texel(i0 + j1), right);
        let lower = mix(self.texel(i1 + j0), self.texel(i1 + j1), right);
        mix(upper, lower, below)
    }

    #[inline(always)]
    fn wrapped(&self, j: f64) -> usize {
        let j = index(if j < 0.0 { j + self.width as f64 } else { j });
        if j >= self.width { 0 } else { j }
    }

    /// The first texel of row `i`.
    #[inline(always)]
    fn row(&self, i: f64) -> usize {
        index(i.max(0.0)).min(self.height - 1) * self.width
    }
}

/// For each of `to` equal parts of 0..`from`: which entries it takes, and what share of it each is by `measure`.
fn shares(from: usize, to: usize, measure: impl Fn(usize) -> f64) -> Vec<Vec<(usize, f64)>> {
    let part = |k: usize| {
        // From an odd number, the last part takes three.
        let (begin, end) = (k * from / to, (k + 1) * from / to);
        let whole = measure(end) - measure(begin);
        (begin..end)
            .map(|i| (i, (measure(i + 1) - measure(i)) / whole))
            .collect()
    };
    (0..to).map(part).collect()
}

#[inline(always)]
fn mix(mut a: [f64; 4], b: [f64; 4], weight: f64) -> [f64; 4] {
    for c in 0..4 {
        a[c] += (b[c] - a[c]) * weight;
    }
    a
}

/// The angle of (x, y) from +x to y, right to 2·10⁻⁸ rad, which is far below a texel: Abramowitz and Stegun 4.4.49.
#[inline(always)]
pub(super) fn arctan(y: f64, x: f64) -> f64 {
    let (a, b) = (x.abs(), y.abs());
    let (small, large) = if a < b { (a, b) } else { (b, a) };
    let t = small / large.max(f64::MIN_POSITIVE);
    let s = t * t;
    let series = 1.0
        + s * (-0.333_331_452_8
            + s * (0.199_935_508_5
                + s * (-0.142_088_994_4
                    + s * (0.106_562_639_3
                        + s * (-0.075_289_640_0
                            + s * (0.042_909_613_8
                                + s * (-0.016_165_736_7 + s * 0.002_866_225_7)))))));
    let angle = t * series;
    let angle = if a < b { FRAC_PI_2 - angle } else { angle };
    let angle = if x < 0.0 { PI - angle } else { angle };
    if y < 0.0 { -angle } else { angle }
}

/// About the logarithm to base 2 of x, from 0 on: exact at powers of 2, linear between them (0.09 too low at most).
#[inline(always)]
fn logarithm(x: f64) -> f64 {
    let bits = x.max(1.0).to_bits();
    let exponent = (bits >> 52) as i32 - 1023;
    let mantissa = f64::from_bits(bits & ((1 << 52) - 1) | 1023 << 52);
    f64::from(exponent) + (mantissa - 1.0)
}

/// The direction of longitude and latitude.
#[cfg(test)]
fn direction(longitude: f64, latitude: f64) -> DVec3 {
    let across = libm::cos(latitude);
    DVec3::new(
        libm::sin(longitude) * across,
        libm::sin(latitude),
        -libm::cos(longitude) * across,
    )
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    #[test]
    fn the_arctangent_is_right_to_its_bound() {
        for k in -1000..=1000 {
            let angle = PI * f64::from(k) / 1000.0;
            let (y, x) = (libm::sin(angle), libm::cos(angle));
            let error = (arctan(y, x) - libm::atan2(y, x)).abs();
            assert!(error < 2.1e-8 || (TAU - error) < 2.1e-8, "{angle}: {error}");
        }
        assert_eq!(arctan(0.0, 0.0), 0.0);
    }

    #[test]
    fn texels_are_where_they_are_said_to_be() {
        let (width, height) = (16, 8);
        let texels: Vec<_> = (0..width * height).map(|k| [k as f32, 1.0, 0.0]).collect();
        let sky = Panorama::new(texels, width, [1.0, 2.0, 1.0], 0.0);
        for (j, i) in [(0, 0), (8, 4), (15, 7), (4, 3)] {
            let longitude = TAU * ((j as f64 + 0.5) / 16.0 - 0.5);
            let latitude = PI * (0.5 - (i as f64 + 0.5) / 8.0);
            let [r, g, _] = sky.radiance(direction(longitude, latitude), 0.0);
            assert!((r - (i * width + j) as f64).abs() < 1e-4, "{j} {i}: {r}");
            assert_eq!(g, 2.0);
        }
    }

    #[test]
    fn many_directions_at_once_are_seen_as_each_alone() {
        let (width, height) = (50, 25);
        let value = |k: usize| ((k * 7919) % 1009) as f32;
        let texels: Vec<_> = (0..width * height)
            .map(|k| [value(k), value(k + 1), value(k + 2)])
            .collect();
        let sky = Panorama::new(texels, width, [1.0, 2.0, 3.0], 0.7);
        let mut directions = Columns::default();
        // The poles, the seam, and what lies between, as parts of texels and as many of them.
        let all: Vec<DVec3> = (0..=180)
            .flat_map(|i| {
                (0..7).map(move |j| direction(f64::from(j) - PI, PI * (f64::from(i) / 180.0 - 0.5)))
            })
            .collect();
        let angles: Vec<f64> = (0..all.len())
            .map(|k| 1e-3 * 1.007f64.powi(k as i32))
            .collect();
        all.iter().for_each(|d| directions.push(*d));
        let mut radiance = vec![[0.0; 3]; all.len()];
        sky.radiance_each(&directions, &angles, &mut radiance);
        for ((d, angle), together) in all.iter().zip(&angles).zip(radiance) {
            assert_eq!(sky.radiance(*d, *angle), together, "{d}, {angle}");
        }
    }

    #[test]
    fn a_picture_is_turned_right_handed_about_y() {
        // One bright texel in the middle, −Z; by +90° about +Y −Z goes to −X.
        let mut texels = vec![[0.0f32; 3]; 64 * 32];
        for (i, j) in [(15, 31), (15, 32), (16, 31), (16, 32)] {
            texels[i * 64 + j] = [1.0; 3];
        }
        let sky = Panorama::new(texels, 64, [1.0; 3], FRAC_PI_2);
        assert!(sky.radiance(DVec3::NEG_X, 0.0)[0] > 0.99);
        assert_eq!(sky.radiance(DVec3::NEG_Z, 0.0)[0], 0.0);
    }

    #[test]
    fn smaller_sizes_keep_the_mean_over_the_sphere() {
        let (width, height) = (50, 25);
        let value = |j: usize, i: usize| ((j * 7 + i * 13) % 11) as f32;
        let texels: Vec<_> = (0..width * height)
            .map(|k| [value(k % width, k / width); 3])
            .collect();
        let weight = |i: usize| {
            let edge = |i: usize| libm::cos(PI * i as f64 / height as f64);
            0.5 * (edge(i) - edge(i + 1)) / width as f64
        };
        let mean: f64 = (0..width * height)
            .map(|k| f64::from(texels[k][0]) * weight(k / width))
            .sum();
        let sky = Panorama::new(texels, width, [1.0; 3], 0.0);
        let top = sky.levels.last().unwrap();
        let got = (0..top.width).map(|j| top.texel(j)[0]).sum::<f64>() / top.width as f64;
        assert_eq!(top.height, 1);
        // Odd widths leave parts of three texels: of equal columns that is a per cent.
        assert!((got - mean).abs() < 0.05 * mean, "{got} {mean}");
    }
}
