//! Coverage by samples: each triangle is tested against the samples of all pixels that it may reach.

use super::buffers::TileBuffers;
use super::depth::{BLOCKS, LANES, Samples, cover_block, resolve};
use super::gather::{Gathered, Pieces, SEVERAL, gather};
use super::setup::Functions;
use crate::accel::vectors::{VectorLoop, dispatch};
use crate::approximate::raster::draw::Strip;
use crate::render::film::Tile;

impl TileBuffers {
    /// Finds the nearest triangle at the samples of `tile`, one for each pixel, at these points of it. Most triangles smaller than a pixel contain no
    /// sample; they are dropped.
    pub fn cover_tile(&mut self, pieces: &Pieces, tile: Tile, x: &[f64], y: &[f64]) {
        dispatch(Start {
            points: [x, y],
            samples: &mut self.samples,
        });
        self.is_complete = false;
        let Samples { x, y, .. } = &*self.samples;
        let points = [x, y].map(|all| all.as_flattened().first_chunk());
        let points = match points {
            [Some(x), Some(y)] => Some([x, y]),
            _ => None,
        };
        gather(&mut self.triangles, pieces, tile, points);
        self.set_up(pieces, tile);
        let strip = Strip {
            rows: tile,
            first: 0,
            each: 1,
        };
        dispatch(Cover {
            triangles: &self.triangles,
            functions: &self.functions,
            list: &self.every,
            strip: &strip,
            samples: &mut self.samples,
        });
    }

    /// Finds the nearest triangle at the samples of `strip`, which are at these points of the tile.
    pub fn cover(&mut self, strip: &Strip, x: &[f64], y: &[f64]) {
        debug_assert!(self.is_complete);
        dispatch(Start {
            points: [x, y],
            samples: &mut self.samples,
        });
        let list = match self.is_listed {
            true => self.lists.of(strip.first as usize),
            false => &self.every,
        };
        dispatch(Cover {
            triangles: &self.triangles,
            functions: &self.functions,
            list,
            strip,
            samples: &mut self.samples,
        });
    }
}

/// The loop over samples that stores their points.
struct Start<'a> {
    points: [&'a [f64]; 2],
    samples: &'a mut Samples,
}

impl VectorLoop for Start<'_> {
    #[inline(always)]
    fn run(self) {
        let [x, y] = self.points;
        self.samples.start(x, y);
    }
}

/// The loop over triangles and blocks of samples.
struct Cover<'a> {
    triangles: &'a [Gathered],
    functions: &'a [Functions],
    /// Indices of the triangles that may reach the strip.
    list: &'a [u32],
    strip: &'a Strip,
    samples: &'a mut Samples,
}

impl VectorLoop for Cover<'_> {
    #[inline(always)]
    fn run(self) {
        let Cover {
            triangles,
            functions,
            list,
            strip,
            samples,
        } = self;
        let [first, each] = [strip.first as usize, strip.each];
        let [width, height] = strip.rows.size.map(|n| n as usize);
        for &index in list {
            let of = &functions[index as usize];
            let Gathered { pixels, only, .. } = triangles[index as usize];
            // Triangles whose only sample is outside were dropped, so this one is inside.
            if only != SEVERAL {
                cover_one(functions, index, samples, usize::from(only));
                continue;
            }
            let [left, top, right, bottom] = pixels.map(usize::from);
            for row in top.max(first)..=bottom.min(first + height - 1) {
                // Whole blocks: samples beside the triangle are outside it in any case.
                let begin = (row - first) * width * each;
                let blocks =
                    (begin + left * each) / LANES..=(begin + right * each + each - 1) / LANES;
                for block in blocks {
                    if block < BLOCKS && cover_block(of, index, samples, block) {
                        resolve(functions, index, samples, block);
                    }
                }
            }
        }
    }
}

/// Replaces what is behind a triangle at a sample inside it.
#[inline(always)]
fn cover_one(functions: &[Functions], index: u32, samples: &mut Samples, sample: usize) {
    let (of, block, i) = (&functions[index as usize], sample / LANES, sample % LANES);
    let [a, b, c] = of.depth;
    let near = a * samples.x[block][i] + b * samples.y[block][i] + c;
    // As in `cover_block`: certainly nearer, or too close to decide in f32.
    let (low, high) = (near - of.slack, near + of.slack);
    if low > samples.most[block][i] {
        samples.least[block][i] = low;
        samples.most[block][i] = high;
        samples.nearest[block][i] = index;
    } else if high >= samples.least[block][i] {
        resolve(functions, index, samples, block);
    }
}

#[cfg(test)]
mod tests {
    use super::super::random_triangles::{Random, RandomTriangles, TILE_AT};
    use super::*;

    /// Triangles of half a pixel or less, and some larger ones: those that are dropped contain no sample.
    #[test]
    fn triangles_that_are_not_kept_hold_no_sample() {
        let mut random = Random(1);
        let triangles = RandomTriangles::new(&mut random, 3000, 50, 6.0);
        let pieces = triangles.pieces();
        let pixels = || (0..TILE_AT.pixels()).map(|k| [k % 16, k / 16].map(|n| n as f64));
        let x: Vec<f64> = pixels().map(|[x, _]| x + random.next()).collect();
        let y: Vec<f64> = pixels().map(|[_, y]| y + random.next()).collect();
        let strip = Strip {
            rows: TILE_AT,
            first: 0,
            each: 1,
        };
        let mut buffers = TileBuffers::default();
        let mut nearest = [false, true].map(|is_complete| {
            match is_complete {
                true => {
                    buffers.complete(&pieces, TILE_AT, 16);
                    buffers.cover(&strip, &x, &y);
                }
                false => buffers.cover_tile(&pieces, TILE_AT, &x, &y),
            }
            let piece = |k: &u32| buffers.triangles.get(*k as usize).map(|one| one.piece);
            let seen: Vec<_> = buffers.nearest()[..x.len()].iter().map(piece).collect();
            (buffers.triangles.len(), seen)
        });
        assert_eq!(nearest[0].1, nearest[1].1);
        let count = nearest[1].0;
        assert!(count > 2900 && nearest[0].0 < count / 2, "{}", nearest[0].0);
        // Small triangles are visible too, not only large ones.
        let (_, seen) = &mut nearest[0];
        seen.retain(|piece| piece.is_some_and(|piece| piece % 50 != 0));
        assert!(seen.len() > 20, "{}", seen.len());
    }
}
