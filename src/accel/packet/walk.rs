//! Single rays through the wide tree: up to 32 interleaved, each on its own path.
//!
//! A single ray spends most of its time waiting: for a node from memory, or for a decision at the previous node. So the rays of a block are
//! interleaved, and when one finishes the next one starts. In each round every ray makes one step, through a node or a leaf, and prefetches
//! what it needs in the next round while the others step. A round first handles all rays at leaves, then all at nodes, which avoids an
//! unpredictable branch, and then the triangles that the rays at leaves may hit: meanwhile these were loaded.
//!
//! Boxes are tested with the start and the bounds of [`slab`](crate::accel::slab), except for (W3). Triangles of a leaf that a ray
//! certainly misses are identified in f32; the others are decided in f64 as everywhere, eight pairs of
//! ray and triangle at a time, so that results are those of the binary tree.
//!
//! **(W1) Shear.** Let z be the axis along which |d| is greatest, x and y the others, and Sx = dx/dz, Sy = dy/dz, neither of which exceeds
//! 1 in size (Woop, Benthin, Wald, JCGT 2(1), 2013). The leaf's corners A are relative to its centre, and so is the point p at which the
//! ray crosses the plane z = 0. With a = (Ax − px − Sx Az, Ay − py − Sy Az), and b and c likewise, d·((B − p) × (C − p)) is dz (bx cy − by
//! cx): the three edge functions, up to a common factor. Let η be the error of corners and h their largest coordinate, P = |p|∞, v = 2⁻²⁴.
//! In f64 p has an error of 2ρ, with ρ of (S2), and 2⁻⁴⁶(2 + |r|). In a, rounding p to f32 adds v P, rounding Sx adds v h, and the
//! roundings of the difference, of the product and of the sum add v (h + P), v h and v (2h + P). So a has an error of at most e = 2η + 2ρ +
//! 2⁻⁴⁶(2 + |r|) + 6 v (h + P).
//!
//! **(W2) Edge functions.** No coordinate of a, b and c exceeds M = 2h + P + 2e. Two products of two have an error of 4 M e, and including
//! their rounding and that of their difference 4 M e + 4.1 v M². M (6 e + 6 v M) is more. A ray hits if U, V and W have the same sign: it
//! certainly misses if one of them is below minus that bound, and another above it.
//!
//! **(W3) Slabs.** The ray crosses a plane p at t = p/d − r/d, one multiplication and subtraction with 1/d and r/d in f32, |d| not below
//! 2⁻⁶⁰ (S4). With |p| ≤ 1 the rounding of 1/d adds v/|d|, that of the product, if it is rounded, the same, that of r/d v |r/d|, and r has
//! an error of ρ: in all less than m = (v (2.1 + 1.1 |r|) + ρ)/|d|. Entry planes use r/d + m, exit planes r/d − m. So after the last
//! rounding, which preserves order, no entry is too late and no exit too early.

use std::cell::Cell;

use super::any_hits::SegmentSet;
use super::lanes::{Boxes, Given, Lines, next_lane};
use super::ray_set::{RAYS, RaySet};
use super::refine::{Answer, Crossings, GROUP, Pairs};
use super::simd::{Eight, Simd, Task};
use crate::accel::bvh::View;
use crate::accel::float::power_of_two;
use crate::accel::node::NodeRef;
use crate::accel::rays::{Hit, NO_SLOT};
use crate::accel::single::{Blocked, Collector, Nearest};
use crate::accel::slab::far_of;
use crate::accel::tally::{Counts, Work};
use crate::accel::vectors::{prefetch, prefetch_either};
use crate::accel::wide::{WIDTH, WideLeaf};

/// The nearest hits of rays, each traced individually.
pub(super) struct ClosestSingles<'a, R> {
    pub bvh: View<'a>,
    pub rays: R,
    /// Indices of the rays, at most 64.
    pub order: &'a [u32],
    pub hits: &'a mut [Option<Hit>],
    pub room: &'a mut ThreadRoom,
    pub tally: &'a mut Counts,
}

/// Occlusion of segments, each traced individually.
pub(super) struct AnySingles<'a, S> {
    pub bvh: View<'a>,
    pub segments: S,
    /// Indices of the segments, at most 64.
    pub order: &'a [u32],
    pub blocked: &'a mut [bool],
    pub room: &'a mut ThreadRoom,
    pub tally: &'a mut Counts,
}

/// The outcome for rays, as bits by their position in the order.
pub(super) struct Walked {
    /// The rays whose hits were replaced.
    pub replaced: u64,
    /// The rays that are not traced here: their values are outside the limits, or they start too far away.
    pub left: u64,
}

impl<R: RaySet> Task for ClosestSingles<'_, R> {
    type Output = Walked;

    #[inline(always)]
    fn run<K: Simd>(self, k: K) -> Walked {
        let (bvh, rays) = (self.bvh, self.rays);
        let room = self.room.get();
        for (lane, &ray) in self.order.iter().enumerate().take(RAYS) {
            room.given.set(lane, &rays.ray(ray as usize));
        }
        let [entering, left] = room.set_up(bvh, self.order.len());
        let mut walked = Walked { replaced: 0, left };
        let traced = self.order.len().min(RAYS) - left.count_ones() as usize;
        self.tally.add(Work::Singles, traced);
        let mut nearest = [Nearest::none([0.0; 2], NO_SLOT); RAYS];
        let mut lanes = entering;
        while lanes != 0 {
            let lane = next_lane(&mut lanes);
            let ray = self.order[lane] as usize;
            // A known hit, in another tree, limits the ray: only nearer ones replace it.
            let s_max = match &self.hits[ray] {
                Some(hit) => hit.s,
                None => f64::INFINITY,
            };
            let range = [room.given.s_min[lane], s_max].map(|s| s * room.lines.per_unit(lane));
            nearest[lane] = Nearest::none(range, rays.left(ray));
        }
        Walk::new(k.children(), bvh, room, entering).run(&mut nearest, self.tally);
        let mut lanes = entering;
        while lanes != 0 {
            let lane = next_lane(&mut lanes);
            if let Some(hit) = nearest[lane].hit(bvh.bvh, room.lines.unit[lane]) {
                self.hits[self.order[lane] as usize] = Some(hit);
                walked.replaced |= 1 << lane;
            }
        }
        walked
    }
}

impl<S: SegmentSet> Task for AnySingles<'_, S> {
    type Output = Walked;

    #[inline(always)]
    fn run<K: Simd>(self, k: K) -> Walked {
        let bvh = self.bvh;
        let room = self.room.get();
        for (lane, &ray) in self.order.iter().enumerate().take(RAYS) {
            room.given
                .set(lane, &self.segments.segment(ray as usize).ray);
            self.blocked[ray as usize] = false;
        }
        let [entering, left] = room.set_up(bvh, self.order.len());
        let walked = Walked { replaced: 0, left };
        let traced = self.order.len().min(RAYS) - left.count_ones() as usize;
        self.tally.add(Work::Singles, traced);
        let mut blocked = [Blocked::NONE; RAYS];
        let mut lanes = entering;
        while lanes != 0 {
            let lane = next_lane(&mut lanes);
            let segment = self.segments.segment(self.order[lane] as usize);
            blocked[lane] = Blocked::none(&segment, room.lines.per_unit(lane));
        }
        Walk::new(k.children(), bvh, room, entering).run(&mut blocked, self.tally);
        let mut lanes = entering;
        while lanes != 0 {
            let lane = next_lane(&mut lanes);
            self.blocked[self.order[lane] as usize] = blocked[lane].is_found();
        }
        walked
    }
}

/// Number of rays in flight: enough to hide memory latency, and few enough that data prefetched for one is still in the L1 cache at its
/// turn (measured with 8 to 64).
const SLOTS: usize = 32;

/// Number of pending children per ray. A node leaves all its children except the next one on the stack; eight are always written, and eight
/// are always read.
const STACK: usize = 256;
/// Levels of nodes for which that is enough. Rays through deeper trees, which are rare, use the binary tree.
const DEPTH: usize = STACK / WIDTH - 2;

/// Buffers reused from block to block.
#[repr(align(64))]
pub(super) struct Room {
    given: Given,
    lines: Lines,
    boxes: Boxes,
    stacks: [Stack; SLOTS],
}

thread_local! {
    /// The buffers of the last batch: clearing new ones takes up to a tenth of the time of a batch of 256 rays.
    static LAST_ROOM: Cell<Option<Box<Room>>> = const { Cell::new(None) };
}

/// The thread's buffers, taken when they are first needed, and given back at the end.
#[derive(Default)]
pub(super) struct ThreadRoom {
    room: Option<Box<Room>>,
}

impl ThreadRoom {
    fn get(&mut self) -> &mut Room {
        // A thread that ends may have dropped its own already.
        let last = || LAST_ROOM.try_with(Cell::take).ok().flatten();
        self.room
            .get_or_insert_with(|| last().unwrap_or_else(Room::new))
    }
}

impl Drop for ThreadRoom {
    fn drop(&mut self) {
        if let Some(room) = self.room.take() {
            let _ = LAST_ROOM.try_with(|last| last.set(Some(room)));
        }
    }
}

/// Children that a ray visits later.
#[derive(Clone, Copy)]
struct Stack {
    /// Their entry parameters, or slightly less, and their indices. The first eight are sentinels.
    entries: [u32; STACK + 2 * WIDTH],
    nodes: [NodeRef; STACK + 2 * WIDTH],
}

impl Room {
    fn new() -> Box<Room> {
        Box::new(Room {
            given: Given::NONE,
            lines: Lines::NONE,
            boxes: Boxes::NONE,
            stacks: [Stack {
                entries: [0; STACK + 2 * WIDTH],
                nodes: [NodeRef::ROOT; STACK + 2 * WIDTH],
            }; SLOTS],
        })
    }

    /// Sets up the first `count` rays as given. Returns the ones that are traced through the tree, and the ones left to the binary one, as
    /// bits.
    #[inline(always)]
    fn set_up(&mut self, bvh: View, count: usize) -> [u64; 2] {
        let count = count.min(RAYS);
        self.lines.set_up(&bvh.tree.space, &self.given, count);
        let [entering, left] = self.lines.fates(count);
        if bvh.tree.wide.depth > DEPTH {
            return [0, left | entering];
        }
        self.boxes.set_up(&self.lines, count);
        [entering, left]
    }
}

/// Lanes in some order.
struct Lanes {
    lanes: [u8; RAYS],
    count: usize,
}

impl Lanes {
    const NONE: Lanes = Lanes {
        lanes: [0; RAYS],
        count: 0,
    };

    #[inline(always)]
    fn all(&self) -> &[u8] {
        &self.lanes[..self.count]
    }

    #[inline(always)]
    fn push(&mut self, lane: usize) {
        self.push_if(true, lane);
    }

    #[inline(always)]
    fn push_if(&mut self, is_pushed: bool, lane: usize) {
        self.lanes[self.count % RAYS] = lane as u8;
        self.count += usize::from(is_pushed);
    }
}

/// Rays on their way through a tree.
struct Walk<'a, K: Simd> {
    kernel: K,
    bvh: View<'a>,
    given: &'a Given,
    lines: &'a Lines,
    boxes: &'a mut Boxes,
    stacks: &'a mut [Stack; SLOTS],
    /// For each lane: its stack, its number of pending children, and its next node.
    slots: [u8; RAYS],
    counts: [u32; RAYS],
    next: [NodeRef; RAYS],
    /// Rays that are traced through the tree, and those of them that have yet to start, as bits.
    entering: u64,
    coming: u64,
    /// Rays at nodes and at leaves.
    at_nodes: Lanes,
    at_leaves: Lanes,
}

impl<'a, K: Eight> Walk<'a, K> {
    #[inline(always)]
    fn new(kernel: K, bvh: View<'a>, room: &'a mut Room, entering: u64) -> Self {
        Walk {
            kernel,
            bvh,
            given: &room.given,
            lines: &room.lines,
            boxes: &mut room.boxes,
            stacks: &mut room.stacks,
            slots: [0; RAYS],
            counts: [0; RAYS],
            next: [NodeRef::ROOT; RAYS],
            entering,
            coming: entering,
            at_nodes: Lanes::NONE,
            at_leaves: Lanes::NONE,
        }
    }

    /// Collects what the rays that are traced through the tree cross; `collectors` are by lane.
    #[inline(always)]
    fn run<C: Collector>(mut self, collectors: &mut [C; RAYS], tally: &mut Counts) {
        let bvh = self.bvh.bvh;
        let mut lanes = self.entering;
        while lanes != 0 {
            let lane = next_lane(&mut lanes);
            self.narrow(lane, collectors[lane].limit());
        }
        // Start as many as there are stacks; the others follow as stacks become free.
        for slot in 0..(self.entering.count_ones() as usize).min(SLOTS) {
            let lane = next_lane(&mut self.coming);
            self.slots[lane] = slot as u8;
            self.at_nodes.push(lane);
        }
        // Candidate triangles: their slots, and the lanes of their rays.
        let mut slots = [0; SLOTS * WIDTH + WIDTH];
        let mut lanes = [0u8; SLOTS * WIDTH + WIDTH];
        let (mut pairs, mut crossings) = (Pairs::NONE, Crossings::NONE);
        while self.at_nodes.count + self.at_leaves.count > 0 {
            let leaves = std::mem::replace(&mut self.at_leaves, Lanes::NONE);
            let mut found = 0;
            for &lane in leaves.all() {
                let leaf = &self.bvh.tree.wide.leaves[self.next[lane as usize % RAYS].index()];
                let candidates = self.candidates(lane as usize % RAYS, leaf);
                // Eight are always stored; those that are none are overwritten.
                let at = found % (SLOTS * WIDTH);
                lanes[at..at + WIDTH].fill(lane);
                found += self
                    .kernel
                    .push_bits(candidates, leaf.first, &mut slots[at..at + WIDTH]);
            }
            let found = found.min(SLOTS * WIDTH);
            let corners = bvh.corners.as_flattened();
            for &slot in &slots[..found] {
                // The first and the last corner: they may be in different cache lines.
                prefetch(corners, 3 * slot as usize);
                prefetch(corners, 3 * slot as usize + 2);
            }
            let nodes = std::mem::replace(&mut self.at_nodes, Lanes::NONE);
            tally.add(Work::Nodes, nodes.count);
            for &lane in nodes.all() {
                self.enter(lane as usize % RAYS);
            }
            // Last, because the prefetched triangles arrive while the other rays step through nodes.
            tally.add(Work::Triangles, found);
            let groups = slots[..found]
                .chunks(GROUP)
                .zip(lanes[..found].chunks(GROUP));
            for (slots, lanes) in groups {
                for (i, (&slot, &lane)) in slots.iter().zip(lanes).enumerate() {
                    let line = self.lines.line(self.given, lane as usize % RAYS);
                    pairs.set(i, &line, &bvh.corners[slot as usize]);
                }
                crossings.fill(&pairs);
                for (i, (&slot, &lane)) in slots.iter().zip(lanes).enumerate() {
                    let lane = lane as usize % RAYS;
                    let collector = &mut collectors[lane];
                    let is_done = match crossings.of(i) {
                        Answer::Misses => continue,
                        Answer::Crosses(_) if collector.ignores(slot) => continue,
                        Answer::Crosses(crossing) => collector.take(bvh, slot, crossing),
                        Answer::Open => {
                            let line = self.lines.line(self.given, lane);
                            collector.test(bvh, &line, slot, tally)
                        }
                    };
                    if is_done {
                        // No pending box matters any more.
                        self.counts[lane] = 0;
                    }
                }
            }
            for &lane in leaves.all() {
                let lane = lane as usize % RAYS;
                // A nearer hit narrows the range.
                self.narrow(lane, collectors[lane].limit());
                self.go_on(lane);
            }
            // After all of them, because values that were just stored cannot be loaded without a stall.
            for &lane in nodes.all() {
                self.go_on(lane as usize % RAYS);
            }
        }
    }

    /// Drops pending children that are farther along a ray than hits up to `s`.
    #[inline(always)]
    fn narrow(&mut self, lane: usize, s: f64) {
        let t = s * self.bvh.tree.space.scale - self.lines.start[lane];
        self.boxes.far[lane] = far_of(t, self.lines.blur[lane]);
    }

    /// Pushes the children of the next node that the ray hits.
    #[inline(always)]
    fn enter(&mut self, lane: usize) {
        let (k, boxes) = (self.kernel, &*self.boxes);
        let node = &self.bvh.tree.wide.nodes[self.next[lane].index()];
        let (mut enter, mut leave) = (k.splat(0.0), k.splat(boxes.far[lane]));
        // (W3).
        let mut axis = 0;
        while axis < 3 {
            let planes = node.planes[axis].as_flattened();
            // 0 or 8 already; the mask avoids a bounds check.
            let near = boxes.near[axis][lane] as usize & WIDTH;
            let inverse = k.splat(boxes.inverses[axis][lane]);
            let [offset, beyond] = &boxes.offsets[axis];
            let (offset, beyond) = (k.splat(offset[lane]), k.splat(beyond[lane]));
            let nearer = k.load(&planes[near..near + WIDTH]);
            let farther = k.load(&planes[WIDTH - near..2 * WIDTH - near]);
            enter = k.max(enter, k.mul_sub(nearer, inverse, offset));
            leave = k.min(leave, k.mul_sub(farther, inverse, beyond));
            axis += 1;
        }
        let count = self.counts[lane];
        let stack = &mut self.stacks[self.slots[lane] as usize % SLOTS];
        // Trees deep enough to fill the stack are excluded ([`DEPTH`]); the remainder avoids a bounds check.
        let first = WIDTH + count as usize % STACK;
        let entries = &mut stack.entries[first..first + WIDTH];
        let nodes = &mut stack.nodes[first..first + WIDTH];
        let hit = k.push_hits(enter, leave, &node.children, entries, nodes);
        self.counts[lane] = count + hit as u32;
    }

    /// Pops the nearest pending child that is not too far; if there is none, the ray is finished, and another starts.
    #[inline(always)]
    fn go_on(&mut self, lane: usize) {
        let (k, far) = (self.kernel, self.boxes.far[lane]);
        let stack = &self.stacks[self.slots[lane] as usize % SLOTS];
        let mut count = self.counts[lane] as usize % STACK;
        // Eight at a time; of these, the last that is not too far. The first eight are the sentinels below those of the ray.
        loop {
            let near = k.within(&stack.entries[count..count + WIDTH], far);
            // The nearest of the eight is the last: the leading zeros are those that are too far.
            let skipped = (near << 24).leading_zeros() as usize;
            if skipped < WIDTH.min(count) {
                count -= skipped + 1;
                break;
            }
            if count <= WIDTH {
                return self.start_next(self.slots[lane]);
            }
            count -= WIDTH;
        }
        let next = stack.nodes[count + WIDTH];
        self.counts[lane] = count as u32;
        self.next[lane] = next;
        // Into one of the lists, without a branch.
        let is_leaf = next.is_leaf();
        self.at_leaves.push_if(is_leaf, lane);
        self.at_nodes.push_if(!is_leaf, lane);
        let tree = &self.bvh.tree.wide;
        prefetch_either(is_leaf, &tree.leaves, &tree.nodes, next.index());
    }

    /// Starts the next ray, with a stack that has become free.
    #[inline(always)]
    fn start_next(&mut self, slot: u8) {
        if self.coming != 0 {
            let lane = next_lane(&mut self.coming);
            self.slots[lane] = slot;
            self.at_nodes.push(lane);
        }
    }

    /// The triangles of `leaf` that the ray does not certainly miss, as bits.
    #[inline(always)]
    fn candidates(&self, lane: usize, leaf: &WideLeaf) -> u32 {
        let (k, lines, boxes) = (self.kernel, self.lines, &*self.boxes);
        // p: (W1).
        let [x, y, z] = &boxes.axes;
        let (x, y, z) = (x[lane] as usize, y[lane] as usize, z[lane] as usize);
        let centre = &leaf.centre;
        let height = f64::from(centre[z]) - lines.sheared[2][lane];
        let px = (lines.sheared[0][lane] - f64::from(centre[x])) + height * lines.slopes[0][lane];
        let py = (lines.sheared[1][lane] - f64::from(centre[y])) + height * lines.slopes[1][lane];
        let (px, py) = (px as f32, py as f32);
        // e and M, and the bound of (W2).
        const V: f32 = power_of_two(-24) as f32;
        let from = if px.abs() > py.abs() {
            px.abs()
        } else {
            py.abs()
        };
        let e = 2.0 * leaf.error + boxes.off[lane] + 6.0 * V * (leaf.size + from);
        let m = 2.0 * leaf.size + from + 2.0 * e;
        let bound = k.splat(m * (6.0 * e + 6.0 * V * m));
        // a, b and c.
        let p = [k.splat(px), k.splat(py)];
        let slopes = [
            k.splat(boxes.slopes[0][lane]),
            k.splat(boxes.slopes[1][lane]),
        ];
        let [a, b, c] = &leaf.corners;
        let a = sheared(k, [&a[x], &a[y], &a[z]], &p, &slopes);
        let b = sheared(k, [&b[x], &b[y], &b[z]], &p, &slopes);
        let c = sheared(k, [&c[x], &c[y], &c[z]], &p, &slopes);
        let u = k.mul_sub(b[0], c[1], k.mul(b[1], c[0]));
        let v = k.mul_sub(c[0], a[1], k.mul(c[1], a[0]));
        let w = k.mul_sub(a[0], b[1], k.mul(a[1], b[0]));
        let least = k.min(u, k.min(v, w));
        let greatest = k.max(u, k.max(v, w));
        // By (W2), unless two signs are certainly opposite.
        let none_below = k.le(k.splat(0.0), k.add(least, bound));
        let none_above = k.le(greatest, bound);
        (none_below | none_above) & leaf.present
    }
}

/// Corners relative to p, sheared: (W1).
#[inline(always)]
fn sheared<K: Simd>(
    k: K,
    [x, y, z]: [&[f32; WIDTH]; 3],
    p: &[K::F; 2],
    slopes: &[K::F; 2],
) -> [K::F; 2] {
    let z = k.load(z);
    [
        k.mul_add(slopes[0], z, k.sub(k.load(x), p[0])),
        k.mul_add(slopes[1], z, k.sub(k.load(y), p[1])),
    ]
}

#[cfg(test)]
mod tests;
