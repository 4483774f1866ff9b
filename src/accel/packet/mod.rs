//! Rays that go nearly the same way, in blocks of 64 and packets of as many as the processor has lanes.
//!
//! A block goes down the tree as one (`beam`: the interval test); at the leaves it is seen which of eight triangles
//! may be met, and packets of its rays are tested against those in f32 (`facets`: the bounds). What the bounds leave
//! open is decided by the f64 test of single rays, and the numbers of every hit are worked out by its operations
//! (`finish`): which triangle is met, and s, u and v, are those of single rays, bit for bit, with every kernel.
//!
//! Rays may share their origin or have their own; the farther those are from one another, the less a block passes
//! over. Rays that don't go together, and origins more than 2¹⁰ scene sizes away, are traced singly.

mod beam;
mod block;
mod blocked;
mod bundle;
mod facet;
mod facets;
mod finish;
mod method;
mod nearest;
// The kernels' intrinsics, and nothing else.
#[allow(unsafe_code)]
mod simd;
mod slabs;
mod tile;
mod walk;

use glam::DVec3;

pub use method::{Kernel, Method, Precision};

use super::query::Probe;
use super::slab::{Link, power_of_two};
use super::wide::WIDTH;
use super::{Bvh, Hit, NoTally, Origins, Segment, Tally, Work};
use block::{Block, NONE};
use blocked::Blocked;
use bundle::{Bundle, Pencil, Sheaf, ray_of};
use finish::Numbers;
use nearest::Nearest;
use tile::Tile;
use walk::{Outcome, Waiting};

/// Origins farther than this many scene sizes are left to single rays, which rebase them.
const FAR: f64 = power_of_two(10);
/// Waiting children that are kept without allocation.
const USUAL_STACK: usize = 256;
/// A block with fewer rays is traced ray by ray.
const FEW: usize = 8;
/// Marks slots whose front was met, where nobody certifies it.
const FRONT: u32 = 1 << 31;

/// What is reused from block to block.
struct Workspace {
    block: Block,
    numbers: Numbers,
    outcome: Outcome,
}

impl Bvh {
    /// For each direction the first hit with s > 0 that is nearer than the entry of `hits`, which it
    /// replaces; `replaced` is told the indices of those entries. `tally` is told the work.
    ///
    /// Fastest where the directions are those of a tile of pixels, row by row, and the origins one or
    /// near one another. There are as many rays as the shortest of the slices has entries.
    pub fn closest_by(
        &self,
        method: Method,
        from: Origins,
        directions: &[DVec3],
        hits: &mut [Option<Hit>],
        tally: &mut impl Tally,
        replaced: impl FnMut(usize),
    ) {
        let count = from.limit(directions.len().min(hits.len()));
        let (directions, hits) = (&directions[..count], &mut hits[..count]);
        tally.add(Work::Rays, count);
        if method.kernel == Kernel::Scalar || count < FEW || !self.suits_packets() {
            return self.closest_singly(from, directions, hits, tally, replaced);
        }
        match from {
            Origins::Shared(origin) if is_far(self.lattice.place(origin)) => {
                self.closest_singly(from, directions, hits, tally, replaced);
            }
            Origins::Shared(origin) => {
                let rays = Pencil { origin, directions };
                self.closest_of_tile(method, rays, directions, hits, tally, replaced);
            }
            Origins::Each(origins) => {
                let rays = Sheaf {
                    origins,
                    directions,
                };
                self.closest_of_tile(method, rays, directions, hits, tally, replaced);
            }
        }
    }

    /// For each segment whether something blocks it. `tally` is told the work.
    ///
    /// Fastest where the segments leave the points that a tile of pixels shows, row by row, for one
    /// point in common or nearly so. Results are certified, whatever `method` says.
    pub fn any_by(
        &self,
        method: Method,
        segments: &[Segment],
        blocked: &mut [bool],
        tally: &mut impl Tally,
    ) {
        let count = segments.len().min(blocked.len());
        let (segments, blocked) = (&segments[..count], &mut blocked[..count]);
        tally.add(Work::Rays, count);
        if method.kernel == Kernel::Scalar || count < FEW || !self.suits_packets() {
            return self.any_singly(segments, blocked, tally);
        }
        blocked.fill(false);
        let mut space = Workspace::new();
        let tile = Tile::of_count(count);
        self.with_wide_stack(|stack| {
            for at in 0..tile.blocks() {
                tile.select(at, &mut space.block);
                space.outcome = Outcome::Apart;
                if space.block.count >= FEW {
                    method.kernel.run(Blocked {
                        bvh: self,
                        segments,
                        blocked,
                        space: &mut space,
                        stack,
                        tally,
                    });
                }
                if space.outcome == Outcome::Apart {
                    for &ray in &space.block.order[..space.block.count] {
                        let ray = ray as usize;
                        self.any_singly(&segments[ray..=ray], &mut blocked[ray..=ray], tally);
                    }
                }
            }
        });
    }

    /// [`Bvh::closest_by`] with the method of this processor, from one point.
    #[inline]
    pub fn closest_each(
        &self,
        origin: DVec3,
        directions: &[DVec3],
        hits: &mut [Option<Hit>],
        replaced: impl FnMut(usize),
    ) {
        let from = Origins::Shared(origin);
        let method = Method::default();
        self.closest_by(method, from, directions, hits, &mut NoTally, replaced);
    }

    /// [`Bvh::closest_by`] with the method of this processor, from a point for each.
    #[inline]
    pub fn closest_from_each(
        &self,
        origins: &[DVec3],
        directions: &[DVec3],
        hits: &mut [Option<Hit>],
        replaced: impl FnMut(usize),
    ) {
        let from = Origins::Each(origins);
        let method = Method::default();
        self.closest_by(method, from, directions, hits, &mut NoTally, replaced);
    }

    fn closest_of_tile(
        &self,
        method: Method,
        rays: impl Bundle,
        directions: &[DVec3],
        hits: &mut [Option<Hit>],
        tally: &mut impl Tally,
        mut replaced: impl FnMut(usize),
    ) {
        let mut space = Workspace::new();
        let tile = Tile::of(directions);
        self.with_wide_stack(|stack| {
            for at in 0..tile.blocks() {
                tile.select(at, &mut space.block);
                self.walk(method, rays, hits, &mut space, stack, tally);
                match space.outcome {
                    Outcome::Missed => {}
                    Outcome::Met => {
                        let precision = method.precision;
                        space.replace(self, precision, rays, hits, tally, &mut replaced)
                    }
                    Outcome::Apart => {
                        space
                            .block
                            .trace_singly(self, rays, hits, tally, &mut replaced)
                    }
                }
            }
        });
    }

    /// Whether the bounds of packets hold in this tree.
    fn suits_packets(&self) -> bool {
        let usual = power_of_two(-300)..power_of_two(300);
        !self.wide.nodes.is_empty() && usual.contains(&self.lattice.scale)
    }

    /// Leads the block's rays through the tree.
    fn walk(
        &self,
        method: Method,
        rays: impl Bundle,
        hits: &[Option<Hit>],
        space: &mut Workspace,
        stack: &mut [Waiting],
        tally: &mut impl Tally,
    ) {
        space.outcome = Outcome::Apart;
        if space.block.count < FEW {
            return;
        }
        let bvh = self;
        match method.precision {
            Precision::Certified => method.kernel.run(Nearest::<_, _, true> {
                bvh,
                rays,
                hits,
                space,
                stack,
                tally,
            }),
            Precision::Fast => method.kernel.run(Nearest::<_, _, false> {
                bvh,
                rays,
                hits,
                space,
                stack,
                tally,
            }),
        }
    }

    fn with_wide_stack(&self, run: impl FnOnce(&mut [Waiting])) {
        const NOBODY: Waiting = (0.0, Link::ROOT);
        let most = self.wide.depth * WIDTH + 1;
        if most <= USUAL_STACK {
            run(&mut [NOBODY; USUAL_STACK])
        } else {
            run(&mut vec![NOBODY; most])
        }
    }
}

impl Workspace {
    fn new() -> Workspace {
        Workspace {
            block: Block::EMPTY,
            numbers: Numbers::NONE,
            outcome: Outcome::Missed,
        }
    }

    /// Puts what the block has met into `hits`.
    #[inline]
    fn replace(
        &self,
        bvh: &Bvh,
        precision: Precision,
        rays: impl Bundle,
        hits: &mut [Option<Hit>],
        tally: &mut impl Tally,
        replaced: &mut impl FnMut(usize),
    ) {
        let block = &self.block;
        let certified = precision == Precision::Certified;
        for lane in 0..block.count {
            if block.slots[lane] == NONE {
                continue;
            }
            let ray = block.order[lane] as usize;
            let entry = &mut hits[ray];
            let is_replaced = if certified && !self.numbers.has(lane) {
                replace_singly(bvh, rays, ray, block.slots[lane], entry, tally)
            } else {
                let numbers = match certified {
                    true => self.numbers.of(lane),
                    false => block.rough(lane),
                };
                replace(bvh, block.slots[lane] & !FRONT, numbers, entry)
            };
            if is_replaced {
                replaced(ray);
            }
        }
    }
}

/// Whether single rays are to be asked from here, in the frame of the boxes; also for NaN.
#[inline(always)]
fn is_far(place: DVec3) -> bool {
    let near = place.abs().cmple(DVec3::splat(FAR));
    !near.all()
}

/// Replaces `entry` by a hit with these s, u, v and front if it comes before.
#[inline(always)]
fn replace(
    bvh: &Bvh,
    slot: u32,
    (s, u, v, front): (f64, f64, f64, bool),
    entry: &mut Option<Hit>,
) -> bool {
    let nearer = comes_before(s, entry);
    if nearer {
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
    }
    nearer
}

/// The same for a ray that single rays are to work out.
#[cold]
fn replace_singly(
    bvh: &Bvh,
    rays: impl Bundle,
    ray: usize,
    slot: u32,
    entry: &mut Option<Hit>,
    tally: &mut impl Tally,
) -> bool {
    let hit = Probe::new(&ray_of(rays, ray)).and_then(|probe| {
        let crossing = probe.line.meet(&bvh.corners[slot as usize], tally)?;
        Some(probe.hit(bvh, &crossing, slot))
    });
    let nearer = hit.filter(|hit| comes_before(hit.s, entry));
    if nearer.is_some() {
        *entry = nearer;
    }
    nearer.is_some()
}

#[inline(always)]
fn comes_before(s: f64, entry: &Option<Hit>) -> bool {
    match entry {
        Some(known) => s < known.s,
        None => true,
    }
}

impl Block {
    /// For rays that don't go together.
    #[cold]
    fn trace_singly(
        &self,
        bvh: &Bvh,
        rays: impl Bundle,
        hits: &mut [Option<Hit>],
        tally: &mut impl Tally,
        replaced: &mut impl FnMut(usize),
    ) {
        for &ray in &self.order[..self.count] {
            let ray = ray as usize;
            let from = Origins::Shared(rays.origin(ray));
            let hit = &mut hits[ray..=ray];
            bvh.closest_singly(from, &[rays.direction(ray)], hit, tally, |_| replaced(ray));
        }
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
