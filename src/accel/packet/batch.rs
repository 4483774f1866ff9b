//! Batches are cut into blocks, which are traced together if their rays are coherent, and otherwise ray by ray.

use glam::DVec3;

use super::any_hits::{AnyHits, SegmentSet};
use super::block::{Block, FRONT, is_far};
use super::closest_hits::ClosestHits;
use super::method::{Kernel, Precision, Traversal};
use super::ray_set::{ColumnsToPoint, OwnOrigins, RAYS, RaySet, SharedOrigin};
use super::refine::RefinedHits;
use super::tile::Tile;
use super::traverse::{Outcome, StackEntry};
use super::walk::{AnySingles, ClosestSingles, ThreadRoom};
use crate::accel::bvh::{Bvh, View};
use crate::accel::float::power_of_two;
use crate::accel::node::NodeRef;
use crate::accel::rays::{Converging, Hit, Origins, Segment};
use crate::accel::single::{ScaledRay, note};
use crate::accel::tally::{Counts, Work};
use crate::accel::vectors::prefetch_all;
use crate::accel::wide::WIDTH;

/// Stack entries that fit without allocation.
const USUAL_STACK: usize = 256;
/// A block with fewer rays is traced ray by ray. They are not interleaved either: the set-up costs more than it gains (measured in batches
/// of 1 to 32).
const FEW: usize = 8;

/// In a tree with at most this many leaves, directions are unrestricted: testing all its triangles for 64 rays together costs less than
/// 64 traversals (measured on boxes in a room).
const SMALL: usize = 48;

/// The most leaves, and triangles in them that rays may hit, that a block tests: where there are more, triangles are finer than the gaps
/// between its rays, which are traced one by one instead. That took as long as 50 to 500 of them (measured on meshes of 57,000 to 124,000
/// triangles in pictures 32 to 1024 pixels wide), and blocks of pixel-sized triangles, which are worth it, reach 600 hardly ever. A block
/// after such a one is mostly as fine, and is given up earlier.
const MOST_WORK: usize = 600;
const MOST_WORK_AFTER_FINE: usize = 100;

/// Buffers reused from block to block.
struct Workspace {
    block: Block,
    refined: RefinedHits,
    singles: ThreadRoom,
}

impl Bvh {
    /// For each direction, finds the first hit with s > 0 that is nearer than the entry in `hits`, and replaces that entry. The indices of
    /// replaced entries are added to `replaced`, and the work done to `counts`, where these are given.
    ///
    /// Fastest if the directions are those of a tile of pixels, row by row, and the origins are equal or close together. The number of rays
    /// is the length of the shortest slice.
    pub fn closest_by(
        &self,
        method: Traversal,
        from: Origins,
        directions: &[DVec3],
        hits: &mut [Option<Hit>],
        counts: Option<&mut Counts>,
        mut replaced: Option<&mut Vec<usize>>,
    ) {
        let mut unasked = Counts::default();
        let tally = counts.unwrap_or(&mut unasked);
        let count = from.limit(directions.len().min(hits.len()));
        let (directions, hits) = (&directions[..count], &mut hits[..count]);
        tally.add(Work::Rays, count);
        self.main().closest_of_batch(
            method,
            from,
            directions,
            hits,
            tally,
            replaced.as_deref_mut(),
        );
        for island in self.islands() {
            let replaced = replaced.as_deref_mut();
            island.closest_of_some(method, from, directions, hits, tally, replaced);
        }
    }

    /// Whether each segment is blocked. `counts`, if any, receives the work done.
    ///
    /// Fastest if the segments run from the points that a tile of pixels shows, row by row, to one common point or nearly so. Results are
    /// certified for any `method`.
    pub fn any_by(
        &self,
        method: Traversal,
        segments: &[Segment],
        blocked: &mut [bool],
        counts: Option<&mut Counts>,
    ) {
        let mut unasked = Counts::default();
        let tally = counts.unwrap_or(&mut unasked);
        let count = segments.len().min(blocked.len());
        let (segments, blocked) = (&segments[..count], &mut blocked[..count]);
        tally.add(Work::Rays, count);
        self.main().any_of_batch(method, segments, blocked, tally);
        for island in self.islands() {
            island.any_of_some(method, segments, blocked, tally);
        }
    }

    /// Whether each of these segments is blocked; they all end at one point, like those to a lamp or a pinhole. They are traced from
    /// there, which is faster than [`Bvh::any_by`]; the answers are the same. `counts`, if any, receives the work done.
    pub fn any_to_point(
        &self,
        method: Traversal,
        segments: Converging,
        blocked: &mut [bool],
        counts: Option<&mut Counts>,
    ) {
        let count = segments.count().min(blocked.len());
        let main = self.main();
        // Holes are tested one by one, and single rays do not need columns.
        let is_usual = method.kernel != Kernel::Scalar && main.suits_packets() && !self.has_holes();
        let rays = ColumnsToPoint::new(segments, &main.tree.space).filter(|_| is_usual);
        let Some(rays) = rays else {
            let segments: Vec<_> = (0..count).map(|at| segments.segment(at)).collect();
            return self.any_by(method, &segments, blocked, counts);
        };
        let mut unasked = Counts::default();
        let tally = counts.unwrap_or(&mut unasked);
        tally.add(Work::Rays, count);
        let blocked = &mut blocked[..count];
        main.any_of_whole(method, rays, blocked, tally);
        for island in self.islands() {
            island.any_of_some(method, rays, blocked, tally);
        }
    }
}

impl View<'_> {
    /// [`Bvh::closest_by`] for this tree.
    fn closest_of_batch(
        self,
        method: Traversal,
        from: Origins,
        directions: &[DVec3],
        hits: &mut [Option<Hit>],
        tally: &mut Counts,
        mut replaced: Option<&mut Vec<usize>>,
    ) {
        if !self.has_holes() {
            return self.closest_of_whole(method, from, directions, hits, tally, replaced);
        }
        // Transparent hits are discarded, and their rays are traced again with an alpha test for everything they hit.
        let before = hits.to_vec();
        let mut nearer = Vec::new();
        self.closest_of_whole(method, from, directions, hits, tally, Some(&mut nearer));
        let is_opaque = |hit: &Hit| self.is_opaque(hit.triangle, [hit.u, hit.v]);
        let is_final = |ray: &usize| hits[*ray].as_ref().is_some_and(is_opaque);
        let (opaque, transparent): (Vec<usize>, Vec<_>) = nearer.into_iter().partition(is_final);
        for ray in &transparent {
            hits[*ray] = before[*ray];
        }
        let again = transparent.into_iter();
        if let Some(list) = &mut replaced {
            list.extend(opaque);
        }
        self.closest_singly(again, from, directions, hits, tally, replaced);
    }

    /// The same if only few of the rays come near the tree: the others are skipped.
    fn closest_of_some(
        self,
        method: Traversal,
        from: Origins,
        directions: &[DVec3],
        hits: &mut [Option<Hit>],
        tally: &mut Counts,
        mut replaced: Option<&mut Vec<usize>>,
    ) {
        let all = 0..directions.len();
        let near: Vec<usize> = all
            .filter(|&ray| self.tree.comes_near(from.of(ray), directions[ray]))
            .collect();
        if near.is_empty() {
            return;
        }
        let origins: Vec<_> = near.iter().map(|&ray| from.of(ray)).collect();
        let slots: Vec<_> = near.iter().map(|&ray| from.left(ray)).collect();
        let from = match from {
            Origins::Shared(origin) => Origins::Shared(origin),
            Origins::Each(_) => Origins::Each(&origins),
            Origins::Leaving { .. } => Origins::Leaving {
                origins: &origins,
                slots: &slots,
            },
        };
        let directions: Vec<_> = near.iter().map(|&ray| directions[ray]).collect();
        // Hits equal to a known one count, too: of two, the smaller id wins.
        let known = |&ray: &usize| hits[ray].map(|hit| hit.up_to());
        let mut found: Vec<_> = near.iter().map(known).collect();
        let mut nearer = Vec::new();
        self.closest_of_batch(
            method,
            from,
            &directions,
            &mut found,
            tally,
            Some(&mut nearer),
        );
        for place in nearer {
            let ray = near[place];
            let first = Hit::first(hits[ray], found[place]);
            if first != hits[ray] {
                hits[ray] = first;
                note(&mut replaced, ray);
            }
        }
    }

    /// [`Bvh::closest_by`] without holes; some of the hits may be on holes.
    fn closest_of_whole(
        self,
        method: Traversal,
        from: Origins,
        directions: &[DVec3],
        hits: &mut [Option<Hit>],
        tally: &mut Counts,
        replaced: Option<&mut Vec<usize>>,
    ) {
        let all = 0..directions.len();
        // The set-up of a block costs more than a few single rays; single rays are also used where the bounds of packets do not hold.
        if method.kernel == Kernel::Scalar || !self.suits_packets() {
            return self.closest_singly(all, from, directions, hits, tally, replaced);
        }
        match from {
            // From this distance, boxes are a single point in f32: single rays move to the tree before they are rounded.
            Origins::Shared(origin) if is_far(self.tree.space.map(origin)) => {
                self.closest_singly(all, from, directions, hits, tally, replaced);
            }
            Origins::Shared(origin) => {
                let rays = SharedOrigin::new(origin, directions);
                self.closest_of_tile(method, rays, (from, directions), hits, tally, replaced);
            }
            Origins::Each(origins) => {
                let rays = OwnOrigins {
                    origins,
                    directions,
                    left: &[],
                };
                self.closest_of_tile(method, rays, (from, directions), hits, tally, replaced);
            }
            Origins::Leaving { origins, slots } => {
                let rays = OwnOrigins {
                    origins,
                    directions,
                    left: slots,
                };
                self.closest_of_tile(method, rays, (from, directions), hits, tally, replaced);
            }
        }
    }

    /// [`Bvh::any_by`] for this tree.
    fn any_of_batch(
        self,
        method: Traversal,
        segments: &[Segment],
        blocked: &mut [bool],
        tally: &mut Counts,
    ) {
        if method.kernel == Kernel::Scalar || !self.suits_packets() {
            return self.any_singly(segments.iter().zip(blocked), tally);
        }
        self.any_of_whole(method, segments, blocked, tally);
        // Segments that may be blocked by a hole are tested again, with an alpha test for everything they hit.
        if self.has_holes() {
            let all = segments.iter().zip(blocked);
            self.any_singly(all.filter(|(_, blocked)| **blocked), tally);
        }
    }

    /// Occlusion of the segments that are not blocked yet, if few of them come near the tree.
    fn any_of_some(
        self,
        method: Traversal,
        segments: impl SegmentSet,
        blocked: &mut [bool],
        tally: &mut Counts,
    ) {
        let mut near = Vec::new();
        let mut open = Vec::new();
        for (at, _) in blocked.iter().enumerate().filter(|(_, blocked)| !**blocked) {
            let segment = segments.segment(at);
            if self
                .tree
                .comes_near(segment.ray.origin, segment.ray.direction)
            {
                near.push(at);
                open.push(segment);
            }
        }
        if open.is_empty() {
            return;
        }
        let mut found = vec![false; open.len()];
        self.any_of_batch(method, &open, &mut found, tally);
        for (at, found) in near.into_iter().zip(found) {
            blocked[at] = found;
        }
    }

    /// [`Bvh::any_by`] without holes; some of the segments may be blocked by holes only.
    fn any_of_whole(
        self,
        method: Traversal,
        segments: impl SegmentSet,
        blocked: &mut [bool],
        tally: &mut Counts,
    ) {
        let count = blocked.len();
        blocked.fill(false);
        let mut block = Block::EMPTY;
        let mut room = ThreadRoom::default();
        // If one block was incoherent, the next is checked beforehand; otherwise the check would only delay it until its directions are
        // loaded.
        let (mut was_incoherent, mut was_fine) = (false, false);
        // A single block needs no sorting.
        let tile = match self.is_small() && count > RAYS {
            true => Tile::by_signs(count, |at| segments.segment(at).ray.direction),
            false => Tile::of_count(count),
        };
        self.with_wide_stack(|stack| {
            for at in 0..tile.blocks() {
                tile.select(at, &mut block);
                // Blocks that are too small or incoherent are traced ray by ray.
                let mut outcome = Outcome::Incoherent;
                let direction = |at| segments.segment(at).ray.direction;
                let is_packet = block.count >= FEW
                    && !(was_incoherent && block.is_certainly_incoherent(self, direction));
                if is_packet {
                    outcome = method.kernel.run(AnyHits {
                        bvh: self,
                        segments,
                        blocked,
                        block: &mut block,
                        stack,
                        most: self.most_work(was_fine),
                        tally,
                    });
                }
                was_incoherent = outcome == Outcome::Incoherent;
                was_fine = outcome == Outcome::Fine;
                if was_incoherent || was_fine {
                    let order = &block.order[..block.count];
                    self.any_of_singles(method, segments, order, blocked, &mut room, tally);
                }
            }
        });
    }

    /// Traces segments one by one.
    fn any_of_singles(
        self,
        method: Traversal,
        segments: impl SegmentSet,
        order: &[u32],
        blocked: &mut [bool],
        room: &mut ThreadRoom,
        tally: &mut Counts,
    ) {
        if order.len() < FEW {
            return self.any_one_by_one(segments, chosen(order, u64::MAX), blocked, tally);
        }
        let walked = method.kernel.of_singles().run(AnySingles {
            bvh: self,
            segments,
            order,
            blocked,
            room,
            tally,
        });
        self.any_one_by_one(segments, chosen(order, walked.left), blocked, tally);
    }

    fn any_one_by_one(
        self,
        segments: impl SegmentSet,
        rays: impl Iterator<Item = usize>,
        blocked: &mut [bool],
        tally: &mut Counts,
    ) {
        for ray in rays {
            let one = [(&segments.segment(ray), &mut blocked[ray])];
            self.any_singly(one.into_iter(), tally);
        }
    }

    fn closest_of_tile<R: RaySet>(
        self,
        method: Traversal,
        rays: R,
        (from, directions): (Origins, &[DVec3]),
        hits: &mut [Option<Hit>],
        tally: &mut Counts,
        mut replaced: Option<&mut Vec<usize>>,
    ) {
        // Blocks take rays from several rows of the batch, which the hardware does not prefetch.
        prefetch_all(directions);
        let mut space = Workspace {
            block: Block::EMPTY,
            refined: RefinedHits::NONE,
            singles: ThreadRoom::default(),
        };
        // As in `any_of_whole`; with own origins, the first block is checked, too.
        let (mut was_incoherent, mut was_fine) = (R::OWN_ORIGINS, false);
        // Rays that leave surfaces are incoherent: if sorted by the signs of their directions, those of a block still miss boxes together.
        let tile = match rays.leaves() && self.is_small() {
            true => Tile::by_signs(directions.len(), |ray| directions[ray]),
            false => Tile::of(directions),
        };
        self.with_wide_stack(|stack| {
            for at in 0..tile.blocks() {
                tile.select(at, &mut space.block);
                // Packets pay where their rays share nodes; the others are traced one by one.
                let block = &space.block;
                let outcome = match block.count {
                    0..FEW => Outcome::Incoherent,
                    _ if was_incoherent
                        && block.is_certainly_incoherent(self, |ray| rays.direction(ray)) =>
                    {
                        Outcome::Incoherent
                    }
                    // Rays that start near one point are treated as sharing it, if f64 certifies their hits: (K5) of `block`.
                    _ => {
                        let room = (&mut *stack, self.most_work(was_fine));
                        match rays.as_shared(&self.tree.space, &block.order) {
                            Some(rays) if method.precision == Precision::Certified => {
                                self.closest_of_block(method, rays, hits, &mut space, room, tally)
                            }
                            _ => self.closest_of_block(method, rays, hits, &mut space, room, tally),
                        }
                    }
                };
                was_incoherent = outcome == Outcome::Incoherent;
                was_fine = outcome == Outcome::Fine;
                match outcome {
                    Outcome::Missed => {}
                    Outcome::Traced => {
                        let precision = method.precision;
                        let replaced = replaced.as_deref_mut();
                        space.replace(self.bvh, precision, rays, hits, tally, replaced)
                    }
                    Outcome::Incoherent | Outcome::Fine => {
                        // Interleaved, unless there are too few.
                        let order = &space.block.order[..space.block.count];
                        if order.len() < FEW {
                            let all = chosen(order, u64::MAX);
                            let replaced = replaced.as_deref_mut();
                            self.closest_singly(all, from, directions, hits, tally, replaced);
                            continue;
                        }
                        let walked = method.kernel.of_singles().run(ClosestSingles {
                            bvh: self,
                            rays,
                            order,
                            hits,
                            room: &mut space.singles,
                            tally,
                        });
                        chosen(order, walked.replaced).for_each(|ray| note(&mut replaced, ray));
                        let replaced = replaced.as_deref_mut();
                        let left = chosen(order, walked.left);
                        self.closest_singly(left, from, directions, hits, tally, replaced);
                    }
                }
            }
        });
    }

    /// Whether the bounds of packets hold in this tree.
    fn suits_packets(self) -> bool {
        let usual = power_of_two(-300)..power_of_two(300);
        !self.tree.wide.nodes.is_empty() && usual.contains(&self.tree.space.scale)
    }

    /// Whether packets may be incoherent.
    pub(super) fn is_small(self) -> bool {
        self.tree.wide.leaves.len() <= SMALL
    }

    /// The most leaves and triangles that a block tests, after one that was too fine or not.
    fn most_work(self, was_fine: bool) -> usize {
        match was_fine {
            _ if self.is_small() => usize::MAX,
            true => MOST_WORK_AFTER_FINE,
            false => MOST_WORK,
        }
    }

    /// Traces the block through the tree.
    fn closest_of_block(
        self,
        method: Traversal,
        rays: impl RaySet,
        hits: &[Option<Hit>],
        Workspace { block, refined, .. }: &mut Workspace,
        (stack, most): (&mut [StackEntry], usize),
        tally: &mut Counts,
    ) -> Outcome {
        let bvh = self;
        match method.precision {
            Precision::Certified => method.kernel.run(ClosestHits::<_, true> {
                bvh,
                rays,
                hits,
                block,
                refined,
                stack,
                most,
                tally,
            }),
            Precision::Fast => method.kernel.run(ClosestHits::<_, false> {
                bvh,
                rays,
                hits,
                block,
                refined,
                stack,
                most,
                tally,
            }),
        }
    }

    fn with_wide_stack(self, run: impl FnOnce(&mut [StackEntry])) {
        const NONE: StackEntry = (0.0, NodeRef::ROOT);
        // A node leaves all its children on the stack except the next one.
        let most = self.tree.wide.depth * WIDTH + 1;
        if most <= USUAL_STACK {
            run(&mut [NONE; USUAL_STACK])
        } else {
            run(&mut vec![NONE; most])
        }
    }
}

impl Workspace {
    /// Writes the block's hits to `hits`.
    #[inline]
    fn replace(
        &self,
        bvh: &Bvh,
        precision: Precision,
        rays: impl RaySet,
        hits: &mut [Option<Hit>],
        tally: &mut Counts,
        mut replaced: Option<&mut Vec<usize>>,
    ) {
        let block = &self.block;
        let certified = precision == Precision::Certified;
        let mut left = block.hit;
        while left != 0 {
            // The remainder changes nothing, but lets the compiler drop the bounds check.
            let lane = left.trailing_zeros() as usize % RAYS;
            left &= left - 1;
            let ray = block.order[lane] as usize;
            let entry = &mut hits[ray];
            // From the refined f64 values, or one by one if those were left open; or the f32 values.
            let is_replaced = if certified && !self.refined.has(lane) {
                replace_singly(bvh, rays, ray, block.slots[lane], entry, tally)
            } else {
                let numbers = match certified {
                    true => self.refined.of(lane),
                    false => rough(block, lane),
                };
                replace(bvh, block.slots[lane] & !FRONT, numbers, entry)
            };
            if is_replaced {
                note(&mut replaced, ray);
            }
        }
    }
}

/// The entries of `order` whose bit is set in `places`.
fn chosen(order: &[u32], places: u64) -> impl Iterator<Item = usize> {
    let rays = order.iter().enumerate();
    rays.filter(move |(place, _)| places >> place & 1 != 0)
        .map(|(_, &ray)| ray as usize)
}

/// s, u, v and front of a lane's hit, in f32 precision.
#[inline(always)]
fn rough(block: &Block, lane: usize) -> (f64, f64, f64, bool) {
    (
        f64::from(block.far[lane]) / block.tau_from_s,
        f64::from(block.barycentrics[0][lane]),
        f64::from(block.barycentrics[1][lane]),
        block.slots[lane] & FRONT != 0,
    )
}

/// Replaces `entry` by a hit with these s, u, v and front if it is nearer.
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
        // In place: reading back what was just written would stall.
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

/// Replaces `entry` by the single-ray hit with the triangle in `slot`, if it is nearer.
#[cold]
fn replace_singly(
    bvh: &Bvh,
    rays: impl RaySet,
    ray: usize,
    slot: u32,
    entry: &mut Option<Hit>,
    tally: &mut Counts,
) -> bool {
    let hit = ScaledRay::new(&rays.ray(ray)).and_then(|ray| {
        let crossing = ray.line.intersect(&bvh.corners[slot as usize], tally)?;
        Some(ray.hit(bvh, &crossing, slot))
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
