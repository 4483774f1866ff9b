//! Equirectangular pictures of the sky.
//!
//! Texel (j, i) of N × N/2 has its centre at u = (j + ½)/N, v = (i + ½)/(N/2), longitude 2π (u − ½) and latitude π (½ − v): the direction
//! (sin λ cos φ, sin φ, −cos λ cos φ). The picture is stored in sizes that are halved, each texel being the mean by solid angle of those it
//! replaces, and looked up bilinearly in the two sizes whose texels are closest to the width that a pixel sees, with linear interpolation
//! in the logarithm (Williams, "Pyramidal parametrics", SIGGRAPH 1983). Near the poles texels are narrower than that: the average is over
//! rows, not along them.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;

use super::{LookDirections, PixelAngles};
use crate::accel::texels::{Taps, TapsBlock, mixed, mixed_each};
use crate::accel::vectors::{BLOCK, VectorLoop, dispatch, prefetch};

/// An equirectangular picture with a pyramid of halved sizes.
#[derive(Debug)]
pub struct Panorama {
    /// Texels of all sizes, the largest first; the last is 1 texel high. By rows, each followed by a copy of its first texel, so that two
    /// horizontal neighbours are always adjacent; three channels, with [`MORE`] numbers of padding at the end.
    texels: Vec<f32>,
    sizes: Box<Sizes>,
    /// Number of sizes.
    count: usize,
    /// Scale factor by channel.
    scale: [f64; 3],
    /// The inverse rotation: cosine and sine of the rotation about +Y.
    turn: [f32; 2],
}

/// The maximum number of sizes: with more, the largest would have 2³¹ columns.
const MOST: usize = 32;

/// Padding after the last texel: two texels are read as eight numbers.
const MORE: usize = 2;

/// Columns and rows by size, and the index of its first texel.
#[derive(Debug, Default)]
struct Sizes {
    widths: [f32; MOST],
    heights: [f32; MOST],
    begins: [u32; MOST],
}

/// The layout of one size.
#[derive(Debug, Clone, Copy)]
struct Size {
    width: f32,
    height: f32,
    begin: u32,
}

/// The picture at one size.
#[derive(Debug)]
struct Level {
    width: usize,
    height: usize,
    texels: Vec<[f32; 3]>,
}

impl Panorama {
    /// The picture of `width` × `width`/2 texels by rows from the top, scaled by `scale` and rotated by `rotation` about +Y.
    pub fn new(texels: Vec<[f32; 3]>, width: usize, scale: [f64; 3], rotation: f64) -> Panorama {
        let mut panorama = Panorama {
            texels: Vec::with_capacity(numbers(width)),
            sizes: Box::default(),
            count: 0,
            scale,
            turn: [libm::cos(rotation) as f32, libm::sin(rotation) as f32],
        };
        let mut next = Some(Level {
            width,
            height: width / 2,
            texels,
        });
        while let Some(level) = next.filter(|_| panorama.count < MOST) {
            next = level.half();
            panorama.add(&level);
        }
        panorama.texels.extend([0.0; MORE]);
        panorama
    }

    /// Bytes of all sizes of a picture of `width` × `width`/2 texels.
    pub fn bytes(width: usize) -> u64 {
        (numbers(width) * size_of::<f32>()) as u64
    }

    /// Whether its radiance is 0 in all directions.
    pub(super) fn is_black(&self) -> bool {
        self.scale == [0.0; 3] || self.texels.iter().all(|number| *number == 0.0)
    }

    /// Columns of the largest size.
    pub(super) fn width(&self) -> usize {
        self.sizes.widths[0] as usize
    }

    /// The mean radiance by solid angle in each texel of an unrotated grid of all directions, `columns` × `columns`/2: every texel of the
    /// largest size is distributed over the grid texels that it overlaps.
    pub(super) fn means(&self, columns: usize) -> Vec<[f64; 3]> {
        let (width, rows) = (self.width(), columns / 2);
        let height = self.sizes.heights[0] as usize;
        let [cosine, sine] = self.turn.map(f64::from);
        // Offset in grid columns from the picture's left edge to the grid's.
        let turned = libm::atan2(sine, cosine) / (2.0 * PI) * columns as f64;
        let across = columns as f64 / width as f64;
        // y of an edge at this fraction of the height.
        let y = |part: f64| libm::cos(PI * part);
        let mut means = vec![[0.0; 3]; columns * rows];
        let mut line = vec![[0.0; 3]; columns];
        for i in 0..height {
            // A row of the picture resampled to columns of the grid.
            line.fill([0.0; 3]);
            for j in 0..width {
                let at = 3 * (i * (width + 1) + j);
                let texel: [f64; 3] =
                    std::array::from_fn(|c| f64::from(self.texels[at + c]) * self.scale[c]);
                let (from, to) = (j as f64 * across - turned, (j + 1) as f64 * across - turned);
                each_covered(from, to, |column, begin, end| {
                    let sum = &mut line[column.rem_euclid(columns as i64) as usize];
                    for (sum, texel) in sum.iter_mut().zip(texel) {
                        *sum += texel * (end - begin);
                    }
                });
            }
            // Its share of each row of the grid, by solid angle.
            let [from, to] = [i, i + 1].map(|i| i as f64 * rows as f64 / height as f64);
            each_covered(from, to, |row, begin, end| {
                let row = (row as usize).min(rows - 1);
                let part = |row: f64| y(row / rows as f64);
                let whole = part(row as f64) - part(row as f64 + 1.0);
                let share = (part(begin) - part(end)) / whole;
                let to = &mut means[row * columns..(row + 1) * columns];
                for (mean, line) in to.iter_mut().zip(&line) {
                    for (mean, line) in mean.iter_mut().zip(line) {
                        *mean += line * share;
                    }
                }
            });
        }
        means
    }

    /// Adds the next size.
    fn add(&mut self, level: &Level) {
        let Sizes {
            widths,
            heights,
            begins,
        } = &mut *self.sizes;
        widths[self.count] = level.width as f32;
        heights[self.count] = level.height as f32;
        begins[self.count] = (self.texels.len() / 3) as u32;
        self.count += 1;
        for row in level.texels.chunks(level.width) {
            self.texels.extend(row.iter().chain(row.first()).flatten());
        }
    }

    /// Radiance along `d` with texels about `angle` wide.
    #[inline]
    pub fn radiance(&self, d: DVec3, angle: f64) -> [f64; 3] {
        let place = place(self.turn, d.as_vec3().to_array());
        // Each halving doubles the width of texels: log₂ of the pixel's width in texels of the largest size.
        let halvings = logarithm(angle as f32 * self.texels_per_angle());
        let halvings = lesser(halvings, self.last());
        let (size, weight) = whole_and_rest(halvings);
        let fine = self.sizes.get(size).taps(place);
        let coarse = self.sizes.get(self.next(size)).taps(place);
        mixed(&self.texels, [fine, coarse], weight, self.scale)
    }

    /// Sets `radiance` along `look`, each with texels about as wide as `angles` says: [`Panorama::radiance`] in vector loops.
    pub(super) fn radiance_each(
        &self,
        look: LookDirections,
        angles: PixelAngles,
        radiance: &mut [[f64; 3]],
    ) {
        dispatch(LookUp {
            panorama: self,
            look,
            angles,
            radiance,
        });
    }

    /// The number of texels of the largest size per radian along the equator.
    #[inline(always)]
    fn texels_per_angle(&self) -> f32 {
        self.sizes.widths[0] * TURN
    }

    /// The index of the smallest size.
    #[inline(always)]
    fn last(&self) -> f32 {
        (self.count - 1) as f32
    }

    /// The index of the next smaller size, or of this one if it is the smallest.
    #[inline(always)]
    fn next(&self, size: u32) -> u32 {
        (size + 1).min(self.count as u32 - 1)
    }
}

impl Sizes {
    #[inline(always)]
    fn get(&self, size: u32) -> Size {
        // A power of 2: the remainder is a mask, after which the index needs no check.
        let size = size as usize % MOST;
        Size {
            width: self.widths[size],
            height: self.heights[size],
            begin: self.begins[size],
        }
    }
}

impl Size {
    /// Selects the first or the second, without a branch.
    #[inline(always)]
    fn choose(is_first: bool, first: Size, second: Size) -> Size {
        Size {
            width: if is_first { first.width } else { second.width },
            height: if is_first {
                first.height
            } else {
                second.height
            },
            begin: if is_first { first.begin } else { second.begin },
        }
    }

    /// The texels around a position, wrapping in longitude.
    #[inline(always)]
    fn taps(self, [u, v]: [f32; 2]) -> Taps {
        let Size {
            width,
            height,
            begin,
        } = self;
        let (x, y) = (u * width - 0.5, v * height - 0.5);
        let (left, top) = (x.floor(), y.floor());
        // Left of the first column is the last, whose right neighbour is the copy at the end of the row.
        let column = if left < 0.0 { width - 1.0 } else { left };
        let column = integer(lesser(column, width - 1.0));
        // Beyond a pole the outermost row goes on.
        let row = |i: f32| integer(lesser(greater(i, 0.0), height - 1.0));
        let first = |row: u32| begin + row * (integer(width) + 1) + column;
        Taps {
            upper: first(row(top)),
            lower: first(row(top + 1.0)),
            right: x - left,
            below: y - top,
        }
    }
}

/// Calls `each` with every integer k whose interval k to k + 1 overlaps `from` to `to`, and with the ends of the overlap.
fn each_covered(from: f64, to: f64, mut each: impl FnMut(i64, f64, f64)) {
    let mut begin = from;
    while begin < to {
        let k = begin.floor();
        let end = to.min(k + 1.0);
        each(k as i64, begin, end);
        begin = end;
    }
}

/// 1/2π.
const TURN: f32 = 0.5 * std::f32::consts::FRAC_1_PI;

/// The position of a direction in the picture, rotated back by `turn`: from 0 to 1 along its width and its height, to 2·10⁻⁷.
#[inline(always)]
fn place([cosine, sine]: [f32; 2], [x, y, z]: [f32; 3]) -> [f32; 2] {
    let (x, z) = (cosine * x - sine * z, sine * x + cosine * z);
    let u = arctan_f32(x, -z) * TURN + 0.5;
    let v = 0.5 - arctan_f32(y, (x * x + z * z).sqrt()) * (2.0 * TURN);
    [u, v]
}

/// The smaller and the larger of two numbers; `b` if `a` is NaN.
#[inline(always)]
pub(super) fn lesser(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[inline(always)]
pub(super) fn greater(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// An integer from 0 to 2²³ − 1, arbitrary for other input: adding 2²³ puts it into the last bits.
#[inline(always)]
pub(super) fn integer(whole: f32) -> u32 {
    (whole + 8_388_608.0).to_bits() & 0x7f_ffff
}

/// Splits a nonnegative number into integer and fraction.
#[inline(always)]
fn whole_and_rest(x: f32) -> (u32, f32) {
    let whole = x.floor();
    (integer(whole), x - whole)
}

/// Looks up radiances of directions.
struct LookUp<'a> {
    panorama: &'a Panorama,
    look: LookDirections<'a>,
    angles: PixelAngles<'a>,
    radiance: &'a mut [[f64; 3]],
}

impl TapsBlock {
    /// Sets the taps around positions, in the sizes with these indices.
    #[inline(always)]
    fn fill(&mut self, sizes: &Sizes, numbers: &[u32; BLOCK], [u, v]: [&[f32; BLOCK]; 2]) {
        let (mut first, mut last) = (u32::MAX, 0);
        for number in numbers {
            first = first.min(*number);
            last = last.max(*number);
        }
        let [one, other] = [sizes.get(first), sizes.get(last)];
        if last - first <= 1 {
            // Neighbours usually share one or two sizes, which are then looked up only once.
            for k in 0..BLOCK {
                let size = Size::choose(numbers[k] == first, one, other);
                self.set(k, size.taps([u[k], v[k]]));
            }
        } else {
            for k in 0..BLOCK {
                self.set(k, sizes.get(numbers[k]).taps([u[k], v[k]]));
            }
        }
    }

    #[inline(always)]
    fn set(&mut self, k: usize, taps: Taps) {
        self.upper[k] = taps.upper;
        self.lower[k] = taps.lower;
        self.right[k] = taps.right;
        self.below[k] = taps.below;
    }

    /// Prefetches every `STEP`th set of texels: neighbours read texels close to each other, five of which share a cache line.
    #[inline(always)]
    fn prefetch<const STEP: usize>(&self, texels: &[f32]) {
        let mut k = 0;
        while k < BLOCK {
            prefetch(texels, 3 * self.upper[k] as usize);
            prefetch(texels, 3 * self.lower[k] as usize);
            k += STEP;
        }
    }
}

/// The positions of a block of directions in two sizes, the second of which has weight `weight`.
struct PlacesBlock {
    fine: TapsBlock,
    coarse: TapsBlock,
    weight: [f32; BLOCK],
}

impl PlacesBlock {
    const ZERO: PlacesBlock = PlacesBlock {
        fine: TapsBlock::ZERO,
        coarse: TapsBlock::ZERO,
        weight: [0.0; BLOCK],
    };

    /// Sets the positions of directions, given by component, for texels of these widths in radians.
    #[inline(always)]
    fn fill(&mut self, panorama: &Panorama, [x, y, z]: [&[f32; BLOCK]; 3], width: &[f32; BLOCK]) {
        let (turn, last) = (panorama.turn, panorama.last());
        let (mut u, mut v) = ([0.0; BLOCK], [0.0; BLOCK]);
        for k in 0..BLOCK {
            [u[k], v[k]] = place(turn, [x[k], y[k], z[k]]);
        }
        let texels_per_angle = panorama.texels_per_angle();
        let (mut size, mut next) = ([0; BLOCK], [0; BLOCK]);
        for k in 0..BLOCK {
            let halvings = lesser(logarithm(width[k] * texels_per_angle), last);
            (size[k], self.weight[k]) = whole_and_rest(halvings);
            next[k] = panorama.next(size[k]);
        }
        let sizes = &*panorama.sizes;
        self.fine.fill(sizes, &size, [&u, &v]);
        self.fine.prefetch::<1>(&panorama.texels);
        // If texels are wider than pixels, no smaller size is needed.
        let mut is_mixed = false;
        for weight in &self.weight {
            is_mixed |= *weight > 0.0;
        }
        if is_mixed {
            self.coarse.fill(sizes, &next, [&u, &v]);
            self.coarse.prefetch::<2>(&panorama.texels);
        }
    }
}

impl VectorLoop for LookUp<'_> {
    #[inline(always)]
    fn run(self) {
        let panorama = self.panorama;
        let PixelAngles { angle, ratios, .. } = self.angles;
        let LookDirections { directions, rays } = self.look;
        let (mut x, mut y, mut z) = ([0.0; BLOCK], [0.0; BLOCK], [0.0; BLOCK]);
        let mut widths = [0.0; BLOCK];
        let mut places = PlacesBlock::ZERO;
        let blocks = rays.chunks(BLOCK).zip(ratios.chunks(BLOCK));
        for (radiance, (rays, ratios)) in self.radiance.chunks_mut(BLOCK).zip(blocks) {
            // Converted to single precision in a separate loop: a mixed loop would use vectors of half the length. Rays in a row, the usual
            // case, have contiguous directions.
            match row(directions, rays) {
                Some(row) => {
                    for (k, d) in row.iter().enumerate() {
                        (x[k], y[k], z[k]) = (d.x as f32, d.y as f32, d.z as f32);
                    }
                }
                None => {
                    for (k, ray) in rays.iter().enumerate() {
                        let d = directions[*ray as usize].as_vec3();
                        (x[k], y[k], z[k]) = (d.x, d.y, d.z);
                    }
                }
            }
            for (width, ratio) in widths.iter_mut().zip(ratios) {
                // Of the world, a pixel sees a/W.
                *width = (angle / *ratio) as f32;
            }
            // Positions of a block in vectors.
            places.fill(panorama, [&x, &y, &z], &widths);
            // Texels in groups of eight.
            let taps = [&places.fine, &places.coarse];
            mixed_each(
                &panorama.texels,
                taps,
                &places.weight,
                panorama.scale,
                radiance,
            );
        }
    }
}

/// The directions of a whole block of rays, if they are contiguous.
#[inline(always)]
fn row<'a>(directions: &'a [DVec3], rays: &[u32]) -> Option<&'a [DVec3; BLOCK]> {
    let rays: &[u32; BLOCK] = rays.first_chunk()?;
    let first = rays[0];
    // Without early exit, so that the loop is vectorized.
    let mut differences = 0;
    for (k, ray) in rays.iter().enumerate() {
        differences |= ray ^ first.wrapping_add(k as u32);
    }
    let row = directions.get(first as usize..)?.first_chunk();
    row.filter(|_| differences == 0)
}

/// Columns and rows of a picture of this width and of its halved sizes.
fn sizes(width: usize) -> impl Iterator<Item = [usize; 2]> {
    let first = [width, width / 2];
    std::iter::successors(Some(first), |size| half(*size)).take(MOST)
}

/// The number of floats in all sizes of a picture of this width.
fn numbers(width: usize) -> usize {
    let texels = sizes(width).map(|[width, height]| (width + 1) * height);
    3 * texels.sum::<usize>() + MORE
}

/// Half of a size, or `None` if it cannot be halved further.
fn half([width, height]: [usize; 2]) -> Option<[usize; 2]> {
    (height >= 2).then_some([(width / 2).max(1), height / 2])
}

impl Level {
    /// The picture at half the size, or `None` if it cannot be halved further.
    fn half(&self) -> Option<Level> {
        let [width, height] = half([self.width, self.height])?;
        let columns = shares(self.width, width, |j| j as f64 / self.width as f64);
        // The solid angle above row i is proportional to 1 − sin φ.
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
}

/// For each of `to` equal parts of 0..`from`: the entries it takes, and the share of each by `measure`.
fn shares(from: usize, to: usize, measure: impl Fn(usize) -> f64) -> Vec<Vec<(usize, f64)>> {
    let part = |k: usize| {
        // If `from` is odd, the last part takes three.
        let (begin, end) = (k * from / to, (k + 1) * from / to);
        let whole = measure(end) - measure(begin);
        (begin..end)
            .map(|i| (i, (measure(i + 1) - measure(i)) / whole))
            .collect()
    };
    (0..to).map(part).collect()
}

/// The angle of (x, y) from +x towards y, with an error of 2·10⁻⁸ rad, far below a texel: Abramowitz and Stegun 4.4.49.
#[inline(always)]
pub(super) fn arctan(y: f64, x: f64) -> f64 {
    let (a, b) = (x.abs(), y.abs());
    let (small, large) = if a < b { (a, b) } else { (b, a) };
    // The first octant; the others follow by reflection at the diagonal and at both axes.
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

/// The same in f32, with an error of 3·10⁻⁷ rad.
#[inline(always)]
fn arctan_f32(y: f32, x: f32) -> f32 {
    let (a, b) = (x.abs(), y.abs());
    let (small, large) = if a < b { (a, b) } else { (b, a) };
    let t = small / greater(large, f32::MIN_POSITIVE);
    let s = t * t;
    // In pairs that do not depend on each other.
    let (s2, s4) = (s * s, (s * s) * (s * s));
    let low = (1.0 - 0.333_331_45 * s) + (0.199_935_51 - 0.142_089 * s) * s2;
    let high = (0.106_562_64 - 0.075_289_64 * s) + (0.042_909_614 - 0.016_165_737 * s) * s2;
    let series = low + (high + 0.002_866_225_7 * s4) * s4;
    let angle = t * series;
    let angle = if a < b {
        std::f32::consts::FRAC_PI_2 - angle
    } else {
        angle
    };
    let angle = if x < 0.0 {
        std::f32::consts::PI - angle
    } else {
        angle
    };
    if y < 0.0 { -angle } else { angle }
}

/// An approximate logarithm to base 2 of x ≥ 0: exact at powers of 2, linear between them (at most 0.09 too low).
#[inline(always)]
fn logarithm(x: f32) -> f32 {
    let bits = greater(x, 1.0).to_bits();
    let exponent = (bits >> 23) as i32 - 127;
    let mantissa = f32::from_bits(bits & ((1 << 23) - 1) | 127 << 23);
    exponent as f32 + (mantissa - 1.0)
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
mod tests;
