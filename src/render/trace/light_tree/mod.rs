//! A tree over the shining triangles of one rest frame, for sampling one of them for a point that they light.
//!
//! Every node has two to eight children or is a triangle. From the root down, a child is chosen with a probability proportional to its
//! importance, an approximation of its light at the point that is 0 only if no light can arrive. Everything is computed in the rest frame
//! of the triangles, where they do not move and the event that receives their light is a point x: the emission time does not matter.
//!
//! # Importance
//!
//! Let a node lie in a ball of radius R about c, with its normals within the angle θ_o of an axis, and let its power, area times radiance, be Φ.
//! From x at the distance d it appears within the angle θ_b of c, sin θ_b = R/d. With θ_w the angle between the axis and the direction from c to
//! x, no normal is nearer to the direction to x than θ′ = max(0, θ_w − θ_o − θ_b), and
//!
//! ```text
//! I = Φ cos θ′ κ/max(d², R²),                                                                 (1)
//! ```
//!
//! is 0 for θ′ ≥ π/2: a one-sided light shines to no other side (Conty Estevez and Kulla, "Importance sampling of many lights with adaptive
//! tree splitting", HPG 2018; Pharr, Jakob, Humphreys, "Physically based rendering", 4th ed., 12.6.3). For two-sided triangles, |cos θ_w|
//! is used. Triangles are compared by radiance times solid angle, I = L Ω κ, so that a distant panel of two triangles is sampled uniformly
//! in solid angle.
//!
//! A bound alone would sample many hidden points, particularly of large nodes. So a quarter of the bound is used, plus three quarters of
//! the value of cos θ′ κ at the middle of the node: cos θ_w and N⁰ + **N**·l towards c, if these are above 0.
//!
//! κ is an upper bound of the cosine at the receiver. The condition is n·l > 0 in the frame F of the receiver; with N = (0, n) and the null
//! vector k = (−1, l) of the triangles' frame G, N·k is invariant, and n·l_F = W (N⁰ + **N**·l): a bound of the expression with l is a bound
//! of the cosine, without error by aberration. With θ_i the angle between **N** and the direction to c, κ = N⁰ + |**N**| cos max(0, θ_i −
//! θ_b); |**N**|² = 1 + (N⁰)².
//!
//! # The tree
//!
//! Nodes are split in two, and the largest of the parts again until there are eight, always with triangles in their given order, so that
//! the tree depends on nothing else. They are cut at the minimum of the surface area orientation heuristic of the same authors, among 12
//! bins of each axis: Σ Φ M_A M_Ω with the area M_A of the box and the measure M_Ω of directions. For this, the angle of a part's normals
//! is estimated from the length of their area-weighted mean: for a full cone it is (1 + cos θ_o)/2.

mod build;

use glam::DVec3;

use super::spherical_triangle::{Triangle, above_zero, is_wide};
use crate::accel::vectors::{BLOCK, Block, Vectors};

/// The maximum number of children of a node: with fewer, more triangles are chosen that turn out to be hidden further down.
const CHILDREN: usize = 8;
/// The weight of the bounds in cosines: with a higher weight, more hidden triangles are sampled; with a lower one, partly visible triangles
/// are sampled more rarely.
const BOUND: f64 = 0.25;
/// Added to cosines in (1): cos θ_o is rounded to 2⁻⁵³, which near 1 is an angle of 2⁻²⁶.
const SLACK: f64 = 1.0 / (1u64 << 23) as f64;

/// A point that is lit, as seen in the frame of the triangles.
#[derive(Debug, Clone, Copy)]
pub(super) struct Receiver {
    /// If it rests with the triangles, lifted off its surface: the share of a triangle that a ray has hit is computed from the origin of that ray.
    pub x: DVec3,
    /// **N** and N⁰, from the normal of the receiver's triangle.
    pub normal: DVec3,
    pub tilt: f64,
}

/// Several receivers in arrays.
pub(super) struct Receivers {
    pub x: Vectors,
    pub normal: Vectors,
    pub tilt: Block,
}

/// A shining triangle, with the data for its sampling.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shining {
    pub triangle: Triangle,
    /// Radiance, scaled so that the power of all lights is 1.
    pub brightness: f64,
    pub two_sided: bool,
}

impl Shining {
    /// Like [`Triangle::half_angle`].
    #[inline(always)]
    fn half_angle(&self, x: DVec3) -> f64 {
        let two_sided = if self.two_sided { 1.0 } else { 0.0 };
        self.triangle.half_angle(x, two_sided)
    }
}

/// A tree over the triangles of one frame, which are in a given order.
#[derive(Debug)]
pub(super) struct LightTree {
    /// The root, then the children of each node, which are adjacent.
    nodes: Vec<Node>,
    /// The node of each triangle.
    leaves: Vec<u32>,
    /// The triangles.
    all: Vec<Shining>,
}

/// A chosen triangle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Choice {
    pub triangle: u32,
    /// The probability of choosing it.
    pub share: f64,
    /// What is left of the random number that chose it, from 0 to 1.
    pub number: f64,
}

/// The density with which points of a triangle are sampled, in its frame.
#[derive(Debug, Clone, Copy)]
pub(super) enum Density {
    PerArea(f64),
    PerSolidAngle(f64),
}

impl Density {
    /// The density per solid angle of the triangle's frame, at a distance whose square is `r2` and with cos θ_y.
    pub fn per_solid_angle(self, r2: f64, cosine: f64) -> f64 {
        match self {
            Density::PerArea(density) => density * r2 / cosine,
            Density::PerSolidAngle(density) => density,
        }
    }
}

#[derive(Debug, Clone, Copy)]
struct Node {
    /// The bounding ball.
    centre: DVec3,
    radius2: f64,
    /// The cone of normals.
    axis: DVec3,
    cosine: f64,
    sine: f64,
    power: f64,
    /// 1 if any triangle is two-sided, else 0.
    two_sided: f64,
    parent: u32,
    /// The first child and the number of children, or the triangle and 0.
    first: u32,
    children: u32,
}

/// A ball as seen from a receiver.
struct Sight {
    /// Towards its centre; NaN if the receiver is there.
    l: DVec3,
    distance2: f64,
    is_inside: bool,
    /// Sine and cosine of θ_b.
    sine: f64,
    cosine: f64,
    /// κ, and N·k for the centre, or 0 if that is negative.
    most: f64,
    middle: f64,
}

impl Node {
    #[inline(always)]
    fn sight(&self, receiver: &Receiver) -> Sight {
        let way = self.centre - receiver.x;
        let distance2 = way.length_squared();
        let l = way / distance2.sqrt();
        let is_inside = distance2 <= self.radius2;
        // sin θ_b = R/d; from within the ball every direction leads to the node.
        let sine2 = if is_inside {
            1.0
        } else {
            self.radius2 / distance2
        };
        let (sine, cosine) = (sine2.sqrt(), (1.0 - sine2).sqrt());
        // |**N**|² = 1 + (N⁰)².
        let length = (1.0 + receiver.tilt * receiver.tilt).sqrt();
        let nearest = cosine_of_difference(receiver.normal.dot(l) / length, (sine, cosine));
        let nearest = if is_inside { 1.0 } else { nearest.0 };
        Sight {
            l,
            distance2,
            is_inside,
            sine,
            cosine,
            most: above_zero(receiver.tilt + length * (nearest + SLACK)),
            middle: above_zero(receiver.tilt + receiver.normal.dot(l)),
        }
    }

    /// (1) for a node that is not a triangle.
    #[inline(always)]
    fn importance(&self, receiver: &Receiver) -> f64 {
        let sight = self.sight(receiver);
        let cosine = -self.axis.dot(sight.l);
        let size = cosine.abs();
        let middle = if self.two_sided > 0.0 { size } else { cosine };
        let (cosine, sine) = cosine_of_difference(middle, (self.sine, self.cosine));
        // The difference is above θ_o, or 0, where its sine is 0 too.
        let nearer = cosine * sight.cosine + sine * sight.sine;
        let cosine = if (cosine >= sight.cosine) | sight.is_inside {
            1.0
        } else {
            nearer
        };
        // max(d², R²) of (1).
        let most2 = if sight.is_inside {
            self.radius2
        } else {
            sight.distance2
        };
        let most = above_zero(cosine + SLACK) * sight.most;
        self.power * mixed(above_zero(middle) * sight.middle, most) / most2
    }

    /// The importance of a triangle.
    #[inline(always)]
    fn importance_of(&self, shining: &Shining, receiver: &Receiver) -> f64 {
        let sight = self.sight(receiver);
        let half = shining.triangle.half_angle(receiver.x, self.two_sided);
        // For a triangle at rest with the receiver, at least one corner must be above the receiver's plane: excludes the receiver's own
        // triangle, and others of the same surface.
        let a = receiver.normal.dot(shining.triangle.corner - receiver.x);
        let b = a + receiver.normal.dot(shining.triangle.edges[0]);
        let c = a + receiver.normal.dot(shining.triangle.edges[1]);
        let is_above = (a > 0.0) | (b > 0.0) | (c > 0.0) | (receiver.tilt != 0.0);
        let cosine = if is_above {
            mixed(sight.middle, sight.most)
        } else {
            0.0
        };
        2.0 * half * shining.brightness * cosine
    }
}

/// The weighted mean of a product of cosines at the middle and its bound.
#[inline(always)]
fn mixed(middle: f64, most: f64) -> f64 {
    (1.0 - BOUND) * middle + BOUND * most
}

/// The cosine and the sine of max(0, α − β), from the cosine of α and the sine and cosine of β, which is at most π.
#[inline(always)]
fn cosine_of_difference(alpha: f64, (sine, cosine): (f64, f64)) -> (f64, f64) {
    let across = above_zero(1.0 - alpha * alpha).sqrt();
    let (difference, rest) = (
        alpha * cosine + across * sine,
        across * cosine - alpha * sine,
    );
    let is_within = alpha >= cosine;
    (
        if is_within { 1.0 } else { difference },
        if is_within { 0.0 } else { rest },
    )
}

/// x, clamped to the interval from 0 to 1, without a branch.
#[inline(always)]
pub(super) fn unit_interval(x: f64) -> f64 {
    let x = above_zero(x);
    if x < 1.0 { x } else { 1.0 }
}

/// The index chosen among some importances by a number in [0, 1), its probability, and what is left of the number; `None` if no importance
/// is above 0.
#[inline(always)]
pub(super) fn choose(number: f64, importances: &[f64]) -> Option<(usize, f64, f64)> {
    let sum: f64 = importances.iter().sum();
    // The last one with a positive importance gets what rounding leaves.
    let (mut left, mut chosen) = (number * sum, None);
    for (at, importance) in importances.iter().enumerate() {
        if *importance > 0.0 {
            chosen = Some((at, importance / sum, unit_interval(left / importance)));
            if left < *importance {
                break;
            }
            left -= importance;
        }
    }
    chosen
}

impl LightTree {
    /// A tree over `all`, which must not be empty.
    pub fn new(all: Vec<Shining>) -> LightTree {
        build::tree(all)
    }

    /// Triangle `k`.
    #[inline(always)]
    pub fn shining(&self, k: u32) -> &Shining {
        &self.all[k as usize]
    }

    /// Whether triangle `k` appears wide from `x`.
    #[inline(always)]
    pub fn is_wide(&self, k: u32, x: DVec3) -> bool {
        let node = &self.nodes[self.leaves[k as usize] as usize];
        is_wide(node.radius2, (node.centre - x).length_squared())
    }

    /// The importance of the whole tree for `receiver`, and the direction to its centre.
    pub fn importance(&self, receiver: &Receiver) -> (f64, DVec3) {
        let root = &self.nodes[0];
        (self.importance_at(0, receiver), root.sight(receiver).l)
    }

    #[inline(always)]
    fn importance_at(&self, at: usize, receiver: &Receiver) -> f64 {
        let node = &self.nodes[at];
        match node.children {
            0 => node.importance_of(&self.all[node.first as usize], receiver),
            _ => node.importance(receiver),
        }
    }

    /// The importances of the children of a node; only as many are set as it has children.
    #[inline(always)]
    fn importances_below(&self, node: &Node, receiver: &Receiver) -> [f64; CHILDREN] {
        let mut importances = [0.0; CHILDREN];
        let first = node.first as usize;
        for (k, importance) in importances[..node.children as usize].iter_mut().enumerate() {
            *importance = self.importance_at(first + k, receiver);
        }
        importances
    }

    /// The same for a block of receivers.
    #[inline(always)]
    fn importances_at(&self, at: usize, receivers: &Receivers, to: &mut Block) {
        let node = self.nodes[at];
        if node.children == 0 {
            let shining = self.all[node.first as usize];
            for (k, importance) in to.iter_mut().enumerate() {
                *importance = node.importance_of(&shining, &receivers.get(k));
            }
        } else {
            for (k, importance) in to.iter_mut().enumerate() {
                *importance = node.importance(&receivers.get(k));
            }
        }
    }

    /// Chooses a triangle for `receiver` with a number in [0, 1).
    pub fn choose(&self, receiver: &Receiver, number: f64) -> Choice {
        let root = Choice {
            triangle: 0,
            share: 1.0,
            number,
        };
        self.choose_below(receiver, root)
    }

    /// The same for the first `count` receivers of a block, whose numbers are replaced by what is left of them. All choose among the children of the
    /// root together.
    #[inline(always)]
    pub fn choose_each(
        &self,
        receivers: &Receivers,
        count: usize,
        numbers: &mut Block,
        (triangles, shares): (&mut [u32; BLOCK], &mut Block),
    ) {
        let root = self.nodes[0];
        *shares = [1.0; BLOCK];
        *triangles = [0; BLOCK];
        if root.children == 0 {
            return;
        }
        // Like `choose`, for all receivers in parallel.
        let mut importances = [[0.0; BLOCK]; CHILDREN];
        let (mut sums, mut lefts) = ([0.0; BLOCK], [0.0; BLOCK]);
        let mut child = 0;
        while child < root.children as usize {
            let at = root.first as usize + child;
            self.importances_at(at, receivers, &mut importances[child]);
            for k in 0..BLOCK {
                sums[k] += importances[child][k];
            }
            child += 1;
        }
        // As in the function `choose`, but with selects instead of branches: the child at which the number is used up.
        let (mut own, mut rests) = ([0.0; BLOCK], [0.0; BLOCK]);
        let mut open = [true; BLOCK];
        for k in 0..BLOCK {
            lefts[k] = numbers[k] * sums[k];
        }
        let mut child = 0;
        while child < root.children as usize {
            let at = root.first + child as u32;
            for k in 0..BLOCK {
                let importance = importances[child][k];
                let takes = open[k] & (importance > 0.0);
                triangles[k] = if takes { at } else { triangles[k] };
                own[k] = if takes { importance } else { own[k] };
                rests[k] = if takes { lefts[k] } else { rests[k] };
                open[k] &= !(takes & (lefts[k] < importance));
                lefts[k] -= if takes { importance } else { 0.0 };
            }
            child += 1;
        }
        for k in 0..BLOCK {
            shares[k] = above_zero(own[k] / sums[k]);
            numbers[k] = unit_interval(rests[k] / own[k]);
        }
        // At this point `triangles` contains nodes.
        let mut k = 0;
        while k < count {
            let node = Choice {
                triangle: triangles[k],
                share: shares[k],
                number: numbers[k],
            };
            let choice = self.choose_below(&receivers.get(k), node);
            (triangles[k], shares[k], numbers[k]) = (choice.triangle, choice.share, choice.number);
            k += 1;
        }
    }

    /// The triangle chosen below a node, whose index is in `choice.triangle`; triangle 0 with probability 0 if no triangle can be chosen.
    #[inline(never)]
    fn choose_below(&self, receiver: &Receiver, choice: Choice) -> Choice {
        let Choice {
            triangle: mut at,
            mut share,
            mut number,
        } = choice;
        loop {
            let node = &self.nodes[at as usize];
            if node.children == 0 {
                let triangle = node.first;
                break Choice {
                    triangle,
                    share,
                    number,
                };
            }
            let importances = self.importances_below(node, receiver);
            let children = &importances[..node.children as usize];
            match choose(number, children).filter(|_| share > 0.0) {
                Some((child, part, rest)) => {
                    at = node.first + child as u32;
                    (share, number) = (share * part, rest);
                }
                None => {
                    break Choice {
                        triangle: 0,
                        share: 0.0,
                        number: 0.0,
                    };
                }
            }
        }
    }

    /// Barycentrics of a point on the chosen triangle, for `x`, from what is left of the first number and from another.
    pub fn draw(&self, choice: &Choice, x: DVec3, number: f64) -> (f64, f64) {
        let shining = self.shining(choice.triangle);
        if !self.is_wide(choice.triangle, x) {
            return Triangle::draw_by_area([choice.number, number]);
        }
        let angle = libm::sincos(choice.number * shining.half_angle(x));
        shining.triangle.draw_by_angle(x, angle, number)
    }

    /// The density of points on triangle `k`, which is chosen for `x` with the probability `share`.
    pub fn density(&self, k: u32, share: f64, x: DVec3) -> Density {
        let shining = self.shining(k);
        match self.is_wide(k, x) {
            true => Density::PerSolidAngle(share / (2.0 * shining.half_angle(x))),
            false => Density::PerArea(share / shining.triangle.area()),
        }
    }

    /// The probability of choosing triangle `k` for `receiver`.
    pub fn share(&self, k: u32, receiver: &Receiver) -> f64 {
        let mut share = 1.0;
        let mut at = self.leaves[k as usize];
        while at > 0 {
            let parent = self.nodes[at as usize].parent;
            let node = &self.nodes[parent as usize];
            let importances = self.importances_below(node, receiver);
            let sum: f64 = importances[..node.children as usize].iter().sum();
            share *= above_zero(importances[(at - node.first) as usize] / sum);
            at = parent;
        }
        share
    }

    /// The same for a block of receivers.
    #[inline(always)]
    pub fn shares(&self, k: u32, receivers: &Receivers, shares: &mut Block) {
        *shares = [1.0; BLOCK];
        let mut at = self.leaves[k as usize];
        while at > 0 {
            let parent = self.nodes[at as usize].parent;
            let node = self.nodes[parent as usize];
            let (mut own, mut sums) = ([0.0; BLOCK], [0.0; BLOCK]);
            let mut child = node.first;
            while child < node.first + node.children {
                let mut importances = [0.0; BLOCK];
                self.importances_at(child as usize, receivers, &mut importances);
                for k in 0..BLOCK {
                    sums[k] += importances[k];
                }
                if child == at {
                    own = importances;
                }
                child += 1;
            }
            for k in 0..BLOCK {
                shares[k] *= above_zero(own[k] / sums[k]);
            }
            at = parent;
        }
    }
}

impl Receivers {
    #[inline(always)]
    pub fn get(&self, k: usize) -> Receiver {
        Receiver {
            x: self.x.get(k),
            normal: self.normal.get(k),
            tilt: self.tilt[k],
        }
    }
}

#[cfg(test)]
mod tests;
