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
#[allow(unsafe_code)]
mod simd;
mod walk;

use glam::DVec3;

use super::query::Probe;
use super::slab::{Link, power_of_two};
use super::{Bvh, Hit, Ray};
use block::{Block, NONE, RAYS};
use simd::{Portable, Simd};
use walk::{Waiting, Walk};

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
        let tile = Tile::of(directions);
        self.with_wide_stack(|stack| {
            for at in 0..tile.blocks() {
                tile.select(at, &mut block);
                if self.trace(method, origin, directions, hits, &mut block, stack) {
                    block.replace(
                        self,
                        method.precision,
                        origin,
                        directions,
                        hits,
                        &mut replaced,
                    );
                } else {
                    for &ray in &block.order[..block.count] {
                        let ray = ray as usize;
                        let (direction, hit) = (&directions[ray..=ray], &mut hits[ray..=ray]);
                        self.closest_singly(origin, direction, hit, |_| replaced(ray));
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

    /// Leads the block's rays through the tree; false if they don't go together.
    fn trace(
        &self,
        method: Method,
        origin: DVec3,
        directions: &[DVec3],
        hits: &[Option<Hit>],
        block: &mut Block,
        stack: &mut [Waiting],
    ) -> bool {
        let mut coherent = block.count >= FEW;
        if coherent {
            let coherent = &mut coherent;
            let bvh = self;
            match method.precision {
                Precision::Certified => method.kernel.run(Walk::<true> {
                    bvh,
                    origin,
                    directions,
                    hits,
                    block,
                    stack,
                    coherent,
                }),
                Precision::Fast => method.kernel.run(Walk::<false> {
                    bvh,
                    origin,
                    directions,
                    hits,
                    block,
                    stack,
                    coherent,
                }),
            }
        }
        coherent
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
}

/// Pixels of a block's side.
const SIDE: usize = 8;

impl Tile {
    /// Rows are where directions jump back.
    fn of(directions: &[DVec3]) -> Tile {
        let count = directions.len();
        let width = match count {
            256 => 16,
            _ => row_length(directions),
        };
        Tile { width, count }
    }

    fn blocks(&self) -> usize {
        match self.width {
            0 => self.count.div_ceil(RAYS),
            width => width.div_ceil(SIDE) * self.count.div_ceil(width).div_ceil(SIDE),
        }
    }

    /// Fills the block's order with rays of its part `at`, 4 × 4 pixels after each other.
    fn select(&self, at: usize, block: &mut Block) {
        let mut count = 0;
        if self.width == 0 {
            let first = at * RAYS;
            count = RAYS.min(self.count - first);
            for (i, place) in block.order[..count].iter_mut().enumerate() {
                *place = (first + i) as u32;
            }
        } else {
            let columns = self.width.div_ceil(SIDE);
            let (x0, y0) = (at % columns * SIDE, at / columns * SIDE);
            for i in 0..RAYS {
                let x = x0 + (i >> 4 & 1) * 4 + (i & 3);
                let y = y0 + (i >> 5) * 4 + (i >> 2 & 3);
                let ray = y * self.width + x;
                if x < self.width && ray < self.count {
                    block.order[count] = ray as u32;
                    count += 1;
                }
            }
        }
        let first = block.order[0];
        block.order[count..].fill(first);
        block.count = count;
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
        precision: Precision,
        origin: DVec3,
        directions: &[DVec3],
        hits: &mut [Option<Hit>],
        replaced: &mut impl FnMut(usize),
    ) {
        for lane in 0..self.count {
            if self.slots[lane] == NONE {
                continue;
            }
            let ray = self.order[lane] as usize;
            let hit = match precision {
                Precision::Certified => self.certified_hit(bvh, origin, directions[ray], lane),
                Precision::Fast => Some(self.fast_hit(bvh, lane)),
            };
            let nearer = hit.filter(|hit| hits[ray].is_none_or(|known| hit.s < known.s));
            if nearer.is_some() {
                hits[ray] = nearer;
                replaced(ray);
            }
        }
    }

    fn certified_hit(
        &self,
        bvh: &Bvh,
        origin: DVec3,
        direction: DVec3,
        lane: usize,
    ) -> Option<Hit> {
        let slot = self.slots[lane];
        let probe = Probe::new(&Ray {
            origin,
            direction,
            s_min: 0.0,
        })?;
        let crossing = probe.line.meet(&bvh.corners[slot as usize])?;
        Some(probe.hit(bvh, &crossing, slot))
    }

    fn fast_hit(&self, bvh: &Bvh, lane: usize) -> Hit {
        let slot = self.slots[lane] & !FRONT;
        Hit {
            s: f64::from(self.far[lane]) / self.tau_from_s,
            u: f64::from(self.weights[0][lane]),
            v: f64::from(self.weights[1][lane]),
            triangle: bvh.tags[slot as usize].id(),
            slot,
            front: self.slots[lane] & FRONT != 0,
        }
    }
}

/// Marks slots whose front was met, where nobody certifies it.
const FRONT: u32 = 1 << 31;
