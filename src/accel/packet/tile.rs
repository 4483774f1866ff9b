//! How a batch of rays is cut into blocks: 8 × 8 pixels of a tile given row by row.
//!
//! If rows cannot be recognised, blocks are 64 consecutive rays. An unsuitable cut only costs time.

use glam::DVec3;

use super::block::Block;
use super::ray_set::RAYS;

/// How a batch is cut into blocks.
pub(super) struct Tile {
    /// Rays per row; 0 if there are no rows.
    width: usize,
    count: usize,
    /// Positions of a block's rays relative to its first.
    places: [u32; RAYS],
    /// The rays in another order; empty if they are used in the given order.
    order: Vec<u32>,
}

/// The side of a block, pixels.
const SIDE: usize = 8;

/// Column and row of a lane: one 4 × 4 square of pixels after another.
const fn pixel(lane: usize) -> (usize, usize) {
    let (x, y) = (lane >> 4 & 1, lane >> 5);
    (x * 4 + (lane & 3), y * 4 + (lane >> 2 & 3))
}

/// Positions of the rays of a block relative to its first.
const fn places(width: usize) -> [u32; RAYS] {
    let mut places = [0; RAYS];
    let mut lane = 0;
    while lane < RAYS {
        let (x, y) = pixel(lane);
        places[lane] = if width == 0 { lane } else { y * width + x } as u32;
        lane += 1;
    }
    places
}

/// The number of pixels in an image's tile, of which batches may have several samples, and its side.
const FULL: usize = SIDES * SIDES;
const SIDES: usize = 16;
const USUAL_PLACES: [u32; RAYS] = places(SIDES);

impl Tile {
    /// Rows end where the direction jumps back.
    pub fn of(directions: &[DVec3]) -> Tile {
        match directions.len() {
            count if count.is_multiple_of(FULL) => Tile::of_count(count),
            count => Tile::new(row_length(directions), count),
        }
    }

    /// 16 × 16 rays, or a multiple of that; otherwise rays without rows.
    pub fn of_count(count: usize) -> Tile {
        let are_tiles = count.is_multiple_of(FULL);
        Tile::new(if are_tiles { SIDES } else { 0 }, count)
    }

    fn new(width: usize, count: usize) -> Tile {
        Tile {
            width,
            count,
            places: match width {
                SIDES => USUAL_PLACES,
                width => places(width),
            },
            order: Vec::new(),
        }
    }

    /// Incoherent rays sorted by the signs of their directions: adjacent groups differ in one sign (Gray code), so that the rays of a block
    /// share signs, and miss boxes together.
    pub fn by_signs(count: usize, direction: impl Fn(usize) -> DVec3) -> Tile {
        // Indexed by the sign bits: the position of that pattern in Gray's order.
        const GRAY: [u8; 8] = [0, 1, 3, 2, 7, 6, 4, 5];
        let key = |ray: usize| {
            let d = direction(ray);
            let bits = usize::from(d.x < 0.0) | usize::from(d.y < 0.0) << 1;
            usize::from(GRAY[bits | usize::from(d.z < 0.0) << 2])
        };
        // Counting sort by key.
        let mut ends = [0; 9];
        for ray in 0..count {
            ends[key(ray) + 1] += 1;
        }
        for k in 1..9 {
            ends[k] += ends[k - 1];
        }
        let mut order = vec![0; count];
        for ray in 0..count {
            let place = &mut ends[key(ray)];
            order[*place] = ray as u32;
            *place += 1;
        }
        Tile {
            order,
            ..Tile::new(0, count)
        }
    }

    /// The number of blocks.
    pub fn blocks(&self) -> usize {
        match self.width {
            0 => self.count.div_ceil(RAYS),
            width => width.div_ceil(SIDE) * self.count.div_ceil(width).div_ceil(SIDE),
        }
    }

    /// Fills the block's order with the rays of block `at`.
    pub fn select(&self, at: usize, block: &mut Block) {
        if !self.order.is_empty() {
            // A partial block repeats its first ray, so that all lanes are valid.
            let rays = &self.order[at * RAYS..];
            block.in_fours = false;
            block.count = rays.len().min(RAYS);
            block.order[..block.count].copy_from_slice(&rays[..block.count]);
            block.order[block.count..].fill(rays[0]);
            return;
        }
        // The first ray of the block: at the block's corner in the tile, or in sequence if rows are unknown.
        let columns = self.width.div_ceil(SIDE).max(1);
        let (x, y) = (at % columns * SIDE, at / columns * SIDE);
        let first = if self.width == 0 {
            at * RAYS
        } else {
            y * self.width + x
        };
        let last = first + self.places[RAYS - 1] as usize;
        // The positions of a whole block are known in advance, and groups of four are adjacent in memory.
        block.in_fours = last < self.count && (self.width == 0 || x + SIDE <= self.width);
        if block.in_fours {
            block.count = RAYS;
            for (place, offset) in block.order.iter_mut().zip(&self.places) {
                *place = first as u32 + offset;
            }
        } else {
            self.select_some(first, self.width.wrapping_sub(x), block);
        }
    }

    /// The same if not all lanes have a ray.
    #[cold]
    fn select_some(&self, first: usize, columns: usize, block: &mut Block) {
        block.count = 0;
        for (lane, &offset) in self.places.iter().enumerate() {
            let ray = first + offset as usize;
            let in_row = self.width == 0 || pixel(lane).0 < columns;
            if in_row && ray < self.count {
                block.order[block.count] = ray as u32;
                block.count += 1;
            }
        }
        let repeated = block.order[0];
        block.order[block.count..].fill(repeated);
    }
}

/// The length of a row, from the first step back; 0 if there is none.
fn row_length(directions: &[DVec3]) -> usize {
    let [first, second, ..] = directions else {
        return 0;
    };
    let step = *second - *first;
    let steps = directions.windows(2).map(|d| d[1] - d[0]);
    // Opposite to the first step and more than three times as long: within a row, directions change evenly.
    let is_back =
        |back: DVec3| back.dot(step) < 0.0 && back.length_squared() > 9.0 * step.length_squared();
    steps.into_iter().position(is_back).map_or(0, |i| i + 1)
}
