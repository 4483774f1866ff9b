//! Coverage by pixels: whether a triangle covers a whole pixel, in front of or behind everything there, follows from the pixel's corners,
//! without its samples. For strips whose samples fill whole blocks of each pixel.

use super::buffers::{PIXELS, Pixels, TileBuffers};
use super::depth::{BLOCKS, LANES, Samples, cover_block, resolve};
use super::gather::Gathered;
use super::setup::{Functions, SIDE};
use crate::accel::vectors::{VectorLoop, dispatch};
use crate::approximate::raster::draw::Strip;

/// Computes the positions of the samples of a strip's pixel, and stores them at the pixel's place in lists of x and y of all samples.
pub type SamplePixel<'a> = dyn FnMut(usize, &mut [f64], &mut [f64]) + 'a;

/// Triangles that span fewer columns are tested directly against the samples of all their pixels.
const WIDE: usize = 3;

impl TileBuffers {
    /// Resets the pixels of `strip`: nothing is known about them.
    fn clear_pixels(&mut self, strip: &Strip) {
        debug_assert!(self.is_complete && strip.each.is_multiple_of(LANES));
        *self.pixels = Pixels::EMPTY;
    }

    /// Finds the nearest triangle at the samples of `strip`, which fill whole blocks of each pixel and are at these points of the tile; pixels are tested
    /// first.
    pub fn cover_by_pixels(&mut self, strip: &Strip, x: &mut [f64], y: &mut [f64]) {
        self.clear_pixels(strip);
        self.pixels.is_sampled.fill(true);
        self.cover_each(strip, (x, y, false), &mut |_, _, _| {});
    }

    /// Determines the pixels of `strip` whose samples are needed: those that a triangle may cover partly, and all that may see one of the batches marked
    /// in `needs`. For strips whose samples fill whole blocks of each pixel.
    pub fn begin_pixels(&mut self, strip: &Strip, needs: &[bool]) -> &[bool] {
        self.clear_pixels(strip);
        let list = match self.is_listed {
            true => self.lists.of(strip.first as usize),
            false => &self.every,
        };
        dispatch(Reached {
            strip,
            triangles: &self.triangles,
            functions: &self.functions,
            list,
            needs,
            pixels: &mut self.pixels,
        });
        &self.pixels.is_sampled[..strip.rows.pixels()]
    }

    /// Finds the nearest triangle at the samples of `strip`, after [`TileBuffers::begin_pixels`]. `sample` is called for pixels whose samples turn out to be
    /// needed although that function did not mark them. `x` and `y` are the sample positions in their pixels.
    pub fn cover_pixels(
        &mut self,
        strip: &Strip,
        (x, y): (&mut [f64], &mut [f64]),
        sample: &mut SamplePixel,
    ) {
        self.cover_each(strip, (x, y, true), sample);
    }

    /// The same, with points relative to their pixels or to the tile.
    fn cover_each(
        &mut self,
        strip: &Strip,
        (x, y, are_in_pixels): (&mut [f64], &mut [f64], bool),
        sample: &mut SamplePixel,
    ) {
        let list = match self.is_listed {
            true => self.lists.of(strip.first as usize),
            false => &self.every,
        };
        dispatch(CoverPixels {
            triangles: &self.triangles,
            functions: &self.functions,
            list,
            strip,
            samples: &mut self.samples,
            pixels: &mut self.pixels,
            points: [x, y],
            are_in_pixels,
            sample,
        });
    }

    /// Calls `each` for each run of samples with the same nearest triangle, in order, with the triangle's index and the length of the run, after
    /// [`TileBuffers::cover_pixels`].
    #[inline(always)]
    pub fn each_run_of_pixels(&self, strip: &Strip, mut each: impl FnMut(u32, usize)) {
        let nearest = self.samples.nearest.as_flattened();
        for pixel in 0..strip.rows.pixels().min(PIXELS) {
            if !self.pixels.is_mixed[pixel] {
                each(self.pixels.nearest[pixel], strip.each);
                continue;
            }
            let own = &nearest[pixel * strip.each..(pixel + 1) * strip.each];
            for alike in own.chunk_by(|a, b| a == b) {
                each(alike[0], alike.len());
            }
        }
    }
}

/// A triangle's functions over a row of pixels: whether it reaches each pixel at all, and whether it covers all of it. In f32 the functions are monotonic
/// in x and in y, because sums, products and rounding are: their values at samples lie between those at two corners of the pixel, bit for bit.
#[inline(always)]
fn over_row(of: &Functions, row: usize) -> [[u32; SIDE]; 2] {
    let (mut reached, mut full) = ([1; SIDE], [1; SIDE]);
    for [a, b, c] in of.edges {
        let (low, high) = corners_of_row([a, b, c], row);
        for i in 0..SIDE {
            reached[i] &= u32::from(high[i] >= 0.0);
            full[i] &= u32::from(low[i] >= 0.0);
        }
    }
    [reached, full]
}

/// The smallest and the largest value of a function over each pixel of a row.
#[inline(always)]
fn corners_of_row([a, b, c]: [f32; 3], row: usize) -> ([f32; SIDE], [f32; SIDE]) {
    // The corner at which the function is smallest, and the opposite one.
    let [left, right] = if a >= 0.0 { [0.0, 1.0] } else { [1.0, 0.0] };
    let row = row as f32;
    let [top, bottom] = if b >= 0.0 {
        [row, row + 1.0]
    } else {
        [row + 1.0, row]
    };
    let (mut low, mut high) = ([0.0; SIDE], [0.0; SIDE]);
    for i in 0..SIDE {
        let column = i as u32 as f32;
        low[i] = a * (column + left) + b * top + c;
        high[i] = a * (column + right) + b * bottom + c;
    }
    (low, high)
}

/// Bounds on 1/z over a pixel.
#[inline(always)]
fn bounds_over(of: &Functions, column: usize, row: usize) -> [f32; 2] {
    // At the corners where it is smallest and largest, as in `corners_of_row`.
    let [a, b, c] = of.depth;
    let (column, row) = (column as f32, row as f32);
    let [left, right] = if a >= 0.0 { [0.0, 1.0] } else { [1.0, 0.0] };
    let [top, bottom] = if b >= 0.0 { [0.0, 1.0] } else { [1.0, 0.0] };
    let low = a * (column + left) + b * (row + top) + c;
    let high = a * (column + right) + b * (row + bottom) + c;
    [low - of.slack, high + of.slack]
}

/// The loop over triangles that records which pixels have to be sampled.
struct Reached<'a> {
    strip: &'a Strip,
    triangles: &'a [Gathered],
    functions: &'a [Functions],
    list: &'a [u32],
    /// By batch, whether all of its pixels have to be sampled.
    needs: &'a [bool],
    pixels: &'a mut Pixels,
}

impl VectorLoop for Reached<'_> {
    #[inline(always)]
    fn run(self) {
        let first = self.strip.first as usize;
        let [width, height] = self.strip.rows.size.map(|n| n as usize);
        for &index in self.list {
            let triangle = &self.triangles[index as usize];
            let [left, top, right, bottom] = triangle.pixels.map(usize::from);
            for row in top.max(first)..=bottom.min(first + height - 1) {
                // Pixels are numbered from the first row of the strip.
                let begin = (row - first) * width;
                let of_row = &mut self.pixels.is_sampled[begin + left..=begin + right];
                // Narrow triangles are tested sample by sample.
                if right - left + 1 < WIDE {
                    for is_sampled in of_row {
                        *is_sampled = true;
                    }
                    continue;
                }
                let needs = self.needs[triangle.batch as usize];
                let [reached, full] = over_row(&self.functions[index as usize], row);
                let reached = reached[left..=right].iter().zip(&full[left..=right]);
                for (is_sampled, (reached, full)) in of_row.iter_mut().zip(reached) {
                    *is_sampled |= (*reached != 0) & (needs | (*full == 0));
                }
            }
        }
    }
}

/// The loop over triangles and the pixels that they may cover.
struct CoverPixels<'a> {
    triangles: &'a [Gathered],
    functions: &'a [Functions],
    list: &'a [u32],
    strip: &'a Strip,
    samples: &'a mut Samples,
    pixels: &'a mut Pixels,
    points: [&'a mut [f64]; 2],
    /// Whether points are relative to the corners of their pixels, rather than to that of the tile.
    are_in_pixels: bool,
    sample: &'a mut SamplePixel<'a>,
}

impl VectorLoop for CoverPixels<'_> {
    #[inline(always)]
    fn run(mut self) {
        let first = self.strip.first as usize;
        let [width, height] = self.strip.rows.size.map(|n| n as usize);
        for &index in self.list {
            let of = &self.functions[index as usize];
            let [left, top, right, bottom] = self.triangles[index as usize].pixels.map(usize::from);
            for row in top.max(first)..=bottom.min(first + height - 1) {
                let begin = (row - first) * width;
                if right - left + 1 < WIDE {
                    for column in left..=right {
                        let bounds = bounds_over(of, column, row);
                        self.cover_some(index, (begin + column, row), bounds);
                    }
                    continue;
                }
                let [reached, full] = over_row(of, row);
                let (low, high) = corners_of_row(of.depth, row);
                for column in left..=right.min(SIDE - 1) {
                    if reached[column] != 0 {
                        let bounds = [low[column] - of.slack, high[column] + of.slack];
                        let is_full = full[column] != 0;
                        self.cover(index, (begin + column, row), bounds, is_full);
                    }
                }
            }
        }
    }
}

impl CoverPixels<'_> {
    /// Covers a pixel, or some of its samples, with 1/z within these bounds.
    #[inline(always)]
    fn cover(
        &mut self,
        index: u32,
        (pixel, row): (usize, usize),
        [low, high]: [f32; 2],
        is_full: bool,
    ) {
        // Never true for these strips, but with it the indices below need no checks.
        if pixel >= PIXELS {
            return;
        }
        let pixels = &mut *self.pixels;
        // In front of everything there for all samples (1/z is larger), or not behind all of it.
        if is_full && low > pixels.most[pixel] {
            pixels.nearest[pixel] = index;
            (pixels.least[pixel], pixels.most[pixel]) = (low, high);
            pixels.is_mixed[pixel] = false;
        } else if high >= pixels.least[pixel] {
            self.cover_some(index, (pixel, row), [low, high]);
        }
    }

    /// Covers samples of a pixel.
    #[inline(always)]
    fn cover_some(&mut self, index: u32, (pixel, row): (usize, usize), [low, high]: [f32; 2]) {
        if pixel >= PIXELS {
            return;
        }
        if !self.pixels.is_mixed[pixel] {
            self.mix(pixel, row);
        }
        let Pixels { least, most, .. } = &mut *self.pixels;
        // Other samples still see what was there before, so the bounds include both.
        least[pixel] = least[pixel].min(low);
        most[pixel] = most[pixel].max(high);
        let (each, of) = (self.strip.each, &self.functions[index as usize]);
        // `each` is a multiple of LANES: a pixel's samples fill whole blocks.
        for block in pixel * each / LANES..(pixel + 1) * each / LANES {
            if block < BLOCKS && cover_block(of, index, self.samples, block) {
                resolve(self.functions, index, self.samples, block);
            }
        }
    }

    /// Gives all samples of a pixel the triangle of the pixel.
    #[inline(always)]
    fn mix(&mut self, pixel: usize, row: usize) {
        let each = self.strip.each;
        let [x, y] = &mut self.points;
        // Positions that were not needed before are needed now.
        if !self.pixels.is_sampled[pixel] {
            (self.sample)(pixel, x, y);
            self.pixels.is_sampled[pixel] = true;
        }
        self.pixels.is_mixed[pixel] = true;
        let nearest = self.pixels.nearest[pixel];
        let of = self.functions.get(nearest as usize);
        let column = pixel % self.strip.rows.size[0] as usize;
        let (column, row) = match self.are_in_pixels {
            true => (column as f64, row as f64),
            false => (0.0, 0.0),
        };
        for block in pixel * each / LANES..(pixel + 1) * each / LANES {
            let samples = &mut *self.samples;
            let own = block * LANES..(block + 1) * LANES;
            let (Some(in_x), Some(in_y)) = (
                x[own.clone()].first_chunk::<LANES>(),
                y[own].first_chunk::<LANES>(),
            ) else {
                return;
            };
            let (to_x, to_y) = (&mut samples.x[block], &mut samples.y[block]);
            for i in 0..LANES {
                to_x[i] = (column + in_x[i]) as f32;
                to_y[i] = (row + in_y[i]) as f32;
            }
            samples.nearest[block] = [nearest; LANES];
            // 1/z of the pixel's triangle at each sample, within its rounding; 0 if there is none.
            let (least, most) = (&mut samples.least[block], &mut samples.most[block]);
            match of {
                None => (*least, *most) = ([0.0; LANES], [0.0; LANES]),
                Some(of) => {
                    let [a, b, c] = of.depth;
                    for i in 0..LANES {
                        let near = a * to_x[i] + b * to_y[i] + c;
                        (least[i], most[i]) = (near - of.slack, near + of.slack);
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::depth::NOTHING;
    use super::super::random_triangles::{Random, RandomTriangles, TILE_AT};
    use super::*;

    /// Triangles that cover whole pixels and parts of them, in front of, behind and through each other.
    #[test]
    fn pixels_that_are_covered_as_a_whole_see_what_their_samples_do() {
        let mut random = Random(2);
        let (mut whole, mut mixed) = (0, 0);
        for (count, often, large) in [
            (3000, 50, 12.0),
            (40, 1, 30.0),
            (12, 1, 60.0),
            (300, 10, 4.0),
        ] {
            let triangles = RandomTriangles::new(&mut random, count, often, large);
            let pieces = triangles.pieces();
            for each in [8, 16] {
                let rows = 16 / each as u32;
                let mut buffers = TileBuffers::default();
                buffers.complete(&pieces, TILE_AT, rows);
                for strip in Strip::of(TILE_AT, rows, each) {
                    let pixels = (0..strip.samples()).map(|k| k / each);
                    let mut inside = |n: usize| n as f64 + random.next();
                    let at =
                        pixels.map(|k| [inside(k % 16), inside(strip.first as usize + k / 16)]);
                    let (mut x, mut y): (Vec<f64>, Vec<f64>) = at.map(|[x, y]| (x, y)).unzip();
                    buffers.cover(&strip, &x, &y);
                    let expected = buffers.nearest()[..x.len()].to_vec();
                    buffers.cover_by_pixels(&strip, &mut x, &mut y);
                    let mut seen = Vec::new();
                    buffers.each_run_of_pixels(&strip, |triangle, samples| {
                        seen.extend(std::iter::repeat_n(triangle, samples));
                    });
                    assert_eq!(seen, expected, "{large} {each} {}", strip.first);
                    let are_mixed = &buffers.pixels.is_mixed[..strip.rows.pixels()];
                    mixed += are_mixed.iter().filter(|is_mixed| **is_mixed).count();
                    let nearest = &buffers.pixels.nearest[..are_mixed.len()];
                    let full = are_mixed.iter().zip(nearest);
                    whole += full
                        .filter(|(mixed, one)| !**mixed && **one != NOTHING)
                        .count();
                }
            }
        }
        assert!(whole > 200 && mixed > 200, "{whole} {mixed}");
    }
}
