//! Equirectangular pictures of all directions.
//!
//! Texel (j, i) of N × N/2 has its centre at u = (j + ½)/N, v = (i + ½)/(N/2), longitude 2π (u − ½) and latitude
//! π (½ − v): the direction (sin λ cos φ, sin φ, −cos λ cos φ). The picture is kept in sizes of halves, each texel the
//! mean of those above it by solid angle, and looked up bilinearly in the two sizes whose texels are next to the width
//! that a pixel sees, linearly between them in the logarithm (Williams, "Pyramidal parametrics", SIGGRAPH 1983). Near
//! the poles texels are narrower than that: the mean is over rows, not along them.

use std::f64::consts::{FRAC_1_PI, FRAC_PI_2, PI};

use glam::DVec3;

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
    texels: Vec<[f32; 3]>,
}

impl Panorama {
    /// The picture of `width` × `width`/2 texels by rows from the top, by `scale`, turned by `rotation` about +Y.
    pub fn new(texels: Vec<[f32; 3]>, width: usize, scale: [f64; 3], rotation: f64) -> Panorama {
        let mut levels = vec![Level {
            width,
            height: width / 2,
            texels,
        }];
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
        let [cosine, sine] = self.turn;
        let (x, z) = (cosine * d.x - sine * d.z, sine * d.x + cosine * d.z);
        let u = arctan(x, -z) * (0.5 * FRAC_1_PI) + 0.5;
        let v = 0.5 - arctan(d.y, (x * x + z * z).sqrt()) * FRAC_1_PI;
        // How many texels of the largest size the pixel sees, and by how many halvings they are one.
        let texels = angle * self.levels[0].width as f64 * (0.5 * FRAC_1_PI);
        let last = self.levels.len() - 1;
        let halvings = logarithm(texels.max(1.0)).min(last as f64);
        let (first, weight) = (halvings as usize, halvings.fract());
        let fine = self.levels[first].sample(u, v);
        let texel = match weight > 0.0 {
            false => fine,
            true => mix(
                fine,
                self.levels[(first + 1).min(last)].sample(u, v),
                weight,
            ),
        };
        std::array::from_fn(|c| texel[c] * self.scale[c])
    }
}

impl Level {
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
                        let texel = self.texels[i * self.width + j];
                        for c in 0..3 {
                            sum[c] += f64::from(texel[c]) * (in_row * in_column);
                        }
                    }
                }
                texels.push(sum.map(|x| x as f32));
            }
        }
        Some(Level {
            width,
            height,
            texels,
        })
    }

    /// Bilinear between texel centres, around the longitudes.
    #[inline]
    fn sample(&self, u: f64, v: f64) -> [f64; 3] {
        let (x, y) = (u * self.width as f64 - 0.5, v * self.height as f64 - 0.5);
        let (left, top) = (x.floor(), y.floor());
        let wrapped = |j: f64| {
            let j = if j < 0.0 { j + self.width as f64 } else { j } as usize;
            if j >= self.width { 0 } else { j }
        };
        let (j0, j1) = (wrapped(left), wrapped(left + 1.0));
        let clamped = |i: f64| (i.max(0.0) as usize).min(self.height - 1) * self.width;
        let (i0, i1) = (clamped(top), clamped(top + 1.0));
        let texel = |at: usize| self.texels[at].map(f64::from);
        let row = |i: usize| mix(texel(i + j0), texel(i + j1), x - left);
        mix(row(i0), row(i1), y - top)
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

#[inline]
fn mix(a: [f64; 3], b: [f64; 3], weight: f64) -> [f64; 3] {
    std::array::from_fn(|c| a[c] + (b[c] - a[c]) * weight)
}

/// The angle of (x, y) from +x to y, right to 2·10⁻⁸ rad, which is far below a texel: Abramowitz and Stegun 4.4.49.
#[inline]
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

/// About the logarithm to base 2 of x ≥ 1: exact at powers of 2, linear between them (0.09 too low at most).
#[inline]
fn logarithm(x: f64) -> f64 {
    let bits = x.to_bits();
    let exponent = (bits >> 52) as i64 - 1023;
    let mantissa = f64::from_bits(bits & ((1 << 52) - 1) | 1023 << 52);
    exponent as f64 + (mantissa - 1.0)
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
        let got = top.texels.iter().map(|t| f64::from(t[0])).sum::<f64>() / top.texels.len() as f64;
        assert_eq!(top.height, 1);
        // Odd widths leave parts of three texels: of equal columns that is a per cent.
        assert!((got - mean).abs() < 0.05 * mean, "{got} {mean}");
    }
}
