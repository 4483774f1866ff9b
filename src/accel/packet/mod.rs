//! Rays that share their origin, in blocks of 64 and packets of as many as the processor has lanes.
//!
//! A block goes down the tree as one ([`block`]: the interval test); at the leaves packets of its rays
//! are tested against triangles in f32 ([`facet`]: the bounds). What the bounds leave open is
//! decided by the f64 test of single rays, and every hit that is handed out comes from it: which
//! triangle is met, and all its numbers, are those of single rays, bit for bit, with every kernel.
//!
//! Rays that don't go together, and origins more than 2¹⁰ scene sizes away, are traced singly.

mod block;
mod facet;
mod finish;
#[allow(unsafe_code)]
mod simd;
mod walk;

use glam::DVec3;

use super::query::Probe;
use super::slab::{Link, power_of_two};
use super::{Bvh, Hit, Ray};
use block::{Block, NONE, RAYS};
use finish::Numbers;
use simd::{Portable, Simd};
use walk::{Outcome, Waiting, Walk};

/// How rays with a common origin are traced.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Method {
    /// The instructions to use.
    pub kernel: Kernel,
    /// What results are worth.
    pub precision: Precision,
}

/// A set of instructions. Certified results are the same with each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kernel {
    /// AVX-512: packets of 16.
    Avx512,
    /// AVX2 and FMA: packets of 8.
    Avx2,
    /// Any processor: packets of 8, in whatever vectors there are.
    Portable,
    /// Single rays: the reference for the others.
    Scalar,
}

/// What results are worth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Precision {
    /// The triangle that exact arithmetic says, and its numbers in f64.
    Certified,
    /// All in f32, for previews: rays along an edge may miss both its triangles, and near depths may
    /// be mistaken. With [`Kernel::Scalar`] and for rays that don't go together as certified.
    Fast,
}

impl Default for Method {
    /// The best kernel of this processor, certified.
    fn default() -> Method {
        Method {
            kernel: Kernel::best(),
            precision: Precision::Certified,
        }
    }
}

impl Kernel {
    /// All of them, best first.
    pub const ALL: [Kernel; 4] = [
        Kernel::Avx512,
        Kernel::Avx2,
        Kernel::Portable,
        Kernel::Scalar,
    ];

    /// Whether this processor has the instructions. A kernel that isn't supported is replaced by
    /// [`Kernel::Portable`].
    pub fn is_supported(self) -> bool {
        match self {
            #[cfg(target_arch = "x86_64")]
            Kernel::Avx512 => simd::Avx512::detect().is_some(),
            #[cfg(target_arch = "x86_64")]
            Kernel::Avx2 => simd::Avx2::detect().is_some(),
            #[cfg(not(target_arch = "x86_64"))]
            Kernel::Avx512 | Kernel::Avx2 => false,
            Kernel::Portable | Kernel::Scalar => true,
        }
    }

    /// The fastest that this processor has.
    pub fn best() -> Kernel {
        let supported = Kernel::ALL.into_iter().find(|k| k.is_supported());
        supported.unwrap_or(Kernel::Portable)
    }

    fn run<const CERTIFIED: bool>(self, walk: Walk<CERTIFIED>) {
        #[cfg(target_arch = "x86_64")]
        match self {
            Kernel::Avx512 if let Some(k) = simd::Avx512::detect() => return k.run(walk),
            Kernel::Avx2 if let Some(k) = simd::Avx2::detect() => return k.run(walk),
            _ => {}
        }
        Portable.run(walk)
    }
}

/// Origins farther than this many scene sizes are left to single rays, which rebase them.
const FAR: f64 = power_of_two(10);
/// Waiting children that are kept without allocation.
const USUAL_STACK: usize = 256;
/// A block with fewer rays is traced ray by ray.
const FEW: usize = 8;

impl Bvh {
    /// For each direction from `origin` the first hit with s > 0 that is nearer than the entry of
    /// `hits`, which it replaces; `replaced` is told the indices of those entries.
    ///
    /// Fastest where the directions are those of a tile of pixels, row by row.
    pub fn closest_by(
        &self,
        method: Method,
        origin: DVec3,
        directions: &[DVec3],
        hits: &mut [Option<Hit>],
        mut replaced: impl FnMut(usize),
    ) {
        let count = directions.len().min(hits.len());
        let (directions, hits) = (&directions[..count], &mut hits[..count]);
        if method.kernel == Kernel::Scalar || count < FEW || !self.suits_packets(origin) {
            return self.closest_singly(origin, directions, hits, replaced);
        }
        let mut block = Block::EMPTY;
        let mut numbers = Numbers::NONE;
        let tile = Tile::of(directions);
        self.with_wide_stack(|stack| {
            for at in 0..tile.blocks() {
                tile.select(at, &mut block);
                let walked = self.walk(
                    method,
                    origin,
                    directions,
                    hits,
                    &mut block,
                    &mut numbers,
                    stack,
                );
                match walked {
                    Outcome::Missed => {}
                    Outcome::Met => block.replace(
                        self,
                        &numbers,
                        method.precision,
                        origin,
                        directions,
                        hits,
                        &mut replaced,
                    ),
                    Outcome::Apart => {
                        for &ray in &block.order[..block.count] {
                            let ray = ray as usize;
                            let (direction, hit) = (&directions[ray..=ray], &mut hits[ray..=ray]);
                            self.closest_singly(origin, direction, hit, |_| replaced(ray));
                        }
                    }
                }
            }
        });
    }

    /// Whether the bounds of packets hold for rays from `origin`.
    fn suits_packets(&self, origin: DVec3) -> bool {
        let distance = (origin - self.lattice.centre).abs().max_element() * self.lattice.scale;
        let usual = power_of_two(-300)..power_of_two(300);
        !self.wide.is_empty()
            && usual.contains(&self.lattice.scale)
            && origin.is_finite()
            && distance <= FAR
    }

    /// Leads the block's rays through the tree.
    #[allow(clippy::too_many_arguments)]
    fn walk(
        &self,
        method: Method,
        origin: DVec3,
        directions: &[DVec3],
        hits: &[Option<Hit>],
        block: &mut Block,
        numbers: &mut Numbers,
        stack: &mut [Waiting],
    ) -> Outcome {
        let mut outcome = Outcome::Apart;
        if block.count >= FEW {
            match method.precision {
                Precision::Certified => method.kernel.run(Walk::<true> {
                    bvh: self,
                    origin,
                    directions,
                    hits,
                    block,
                    numbers,
                    stack,
                    outcome: &mut outcome,
                }),
                Precision::Fast => method.kernel.run(Walk::<false> {
                    bvh: self,
                    origin,
                    directions,
                    hits,
                    block,
                    numbers,
                    stack,
                    outcome: &mut outcome,
                }),
            }
        }
        outcome
    }

    fn with_wide_stack(&self, run: impl FnOnce(&mut [Waiting])) {
        const NOBODY: Waiting = (0.0, Link::ROOT);
        let most = self.wide_depth * super::wide::WIDTH + 1;
        if most <= USUAL_STACK {
            run(&mut [NOBODY; USUAL_STACK])
        } else {
            run(&mut vec![NOBODY; most])
        }
    }
}

/// How a batch is cut into blocks.
struct Tile {
    /// Rays per row; 0 if there are no rows.
    width: usize,
    count: usize,
    /// Of a block's rays, from its first one on.
    places: [u32; RAYS],
}

/// Pixels of a block's side.
const SIDE: usize = 8;

/// Column and row of a lane: 4 × 4 pixels after each other.
const fn pixel(lane: usize) -> (usize, usize) {
    let (x, y) = (lane >> 4 & 1, lane >> 5);
    (x * 4 + (lane & 3), y * 4 + (lane >> 2 & 3))
}

/// Where the rays of a block are from its first on.
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

const USUAL_PLACES: [u32; RAYS] = places(16);

impl Tile {
    /// Rows are where directions jump back.
    fn of(directions: &[DVec3]) -> Tile {
        let count = directions.len();
        let width = match count {
            256 => 16,
            _ => row_length(directions),
        };
        Tile {
            width,
            count,
            places: match width {
                16 => USUAL_PLACES,
                width => places(width),
            },
        }
    }

    fn blocks(&self) -> usize {
        match self.width {
            0 => self.count.div_ceil(RAYS),
            width => width.div_ceil(SIDE) * self.count.div_ceil(width).div_ceil(SIDE),
        }
    }

    /// Fills the block's order with the rays of its part `at`.
    fn select(&self, at: usize, block: &mut Block) {
        let columns = self.width.div_ceil(SIDE).max(1);
        let (x, y) = (at % columns * SIDE, at / columns * SIDE);
        let first = if self.width == 0 {
            at * RAYS
        } else {
            y * self.width + x
        };
        let last = first + self.places[RAYS - 1] as usize;
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

    /// The same where not all lanes have a ray.
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
    let is_back =
        |back: DVec3| back.dot(step) < 0.0 && back.length_squared() > 9.0 * step.length_squared();
    steps.into_iter().position(is_back).map_or(0, |i| i + 1)
}

impl Block {
    /// Puts what was met into `hits`.
    #[inline]
    fn replace(
        &self,
        bvh: &Bvh,
        numbers: &Numbers,
        precision: Precision,
        origin: DVec3,
        directions: &[DVec3],
        hits: &mut [Option<Hit>],
        replaced: &mut impl FnMut(usize),
    ) {
        for lane in 0..self.count {
            let slot = self.slots[lane];
            if slot == NONE {
                continue;
            }
            let ray = self.order[lane] as usize;
            let entry = &mut hits[ray];
            let certified = precision == Precision::Certified;
            if certified && numbers.delta[lane] == 0.0 {
                let hit = self.single_hit(bvh, origin, directions[ray], lane);
                if let Some(hit) = hit.filter(|hit| comes_before(hit.s, entry)) {
                    *entry = Some(hit);
                    replaced(ray);
                }
                continue;
            }
            let (s, u, v, front) = match certified {
                true => numbers.of(lane),
                false => self.rough(lane),
            };
            if comes_before(s, entry) {
                let slot = slot & !FRONT;
                let triangle = bvh.tags[slot as usize].id();
                // In place: a copy of what was just written would wait for it.
                *entry = Some(Hit {
                    s,
                    u,
                    v,
                    triangle,
                    slot,
                    front,
                });
                replaced(ray);
            }
        }
    }

    #[cold]
    fn single_hit(&self, bvh: &Bvh, origin: DVec3, direction: DVec3, lane: usize) -> Option<Hit> {
        let slot = self.slots[lane];
        let probe = Probe::new(&Ray {
            origin,
            direction,
            s_min: 0.0,
        })?;
        let crossing = probe.line.meet(&bvh.corners[slot as usize])?;
        Some(probe.hit(bvh, &crossing, slot))
    }

    /// s, u, v and front as f32 has them.
    #[inline(always)]
    fn rough(&self, lane: usize) -> (f64, f64, f64, bool) {
        (
            f64::from(self.far[lane]) / self.tau_from_s,
            f64::from(self.weights[0][lane]),
            f64::from(self.weights[1][lane]),
            self.slots[lane] & FRONT != 0,
        )
    }
}

#[inline(always)]
fn comes_before(s: f64, entry: &Option<Hit>) -> bool {
    match entry {
        Some(known) => s < known.s,
        None => true,
    }
}

/// Marks slots whose front was met, where nobody certifies it.
const FRONT: u32 = 1 << 31;
