//! s, u and v of hits in f64, eight at a time: those of a block, and those of single rays.
//!
//! The arithmetic is that of [`Line::intersect`], operation by operation, so that each number is the same bit for bit; sums and products
//! are never fused. If that test would switch to exact arithmetic or move s into the triangle's box, nothing is stored, and the hit is left
//! to single rays.

use glam::DVec3;

use super::block::{Block, NONE};
use super::ray_set::{RAYS, RaySet};
use super::simd::Simd;
use crate::accel::bvh::Bvh;
use crate::accel::float::{greater, lesser, norm1};
use crate::accel::triangle::{Crossing, GRAZING, Line};

/// Hits computed together.
pub(super) const GROUP: usize = 8;

/// Hits of a block, lane by lane.
#[repr(C, align(64))]
pub(super) struct RefinedHits {
    s: [f64; RAYS],
    u: [f64; RAYS],
    v: [f64; RAYS],
    /// n·d, or 0 if the hit is left to single rays.
    delta: [f64; RAYS],
}

impl RefinedHits {
    pub const NONE: RefinedHits = RefinedHits {
        s: [0.0; RAYS],
        u: [0.0; RAYS],
        v: [0.0; RAYS],
        delta: [0.0; RAYS],
    };

    /// Computes all hits of `block`.
    #[inline(always)]
    pub fn fill<K: Simd, R: RaySet>(&mut self, k: K, bvh: &Bvh, rays: R, block: &Block) {
        if R::OWN_ORIGINS || rays.origins().is_some() {
            self.fill_from::<K, R, true>(k, bvh, rays, block);
        } else {
            self.fill_from::<K, R, false>(k, bvh, rays, block);
        }
    }

    /// The same for rays with their own starts, or with a common one.
    #[inline(always)]
    fn fill_from<K: Simd, R: RaySet, const EACH: bool>(
        &mut self,
        k: K,
        bvh: &Bvh,
        rays: R,
        block: &Block,
    ) {
        let mut first = 0;
        while first < RAYS {
            if block.hit >> first & 0xff == 0 {
                first += GROUP;
                continue;
            }
            let slots = &block.slots[first..first + GROUP];
            // Whether all lanes hit the same triangle: then it is loaded once.
            let (mut hit, mut same) = (NONE, true);
            for &slot in slots {
                if slot != NONE {
                    same &= hit == NONE || hit == slot;
                    hit = slot;
                }
            }
            let order = &block.order[first..first + GROUP];
            let mut pairs = Pairs::load::<K, R, EACH>(k, rays, order, block.in_fours);
            if same {
                self.intersect_one::<EACH>(&pairs, &bvh.corners[hit as usize], first);
            } else {
                pairs.collect(bvh, slots, hit);
                self.intersect_each::<EACH>(&pairs, first);
            }
            first += GROUP;
        }
    }

    /// Whether the hit of a lane is computed.
    #[inline(always)]
    pub fn has(&self, lane: usize) -> bool {
        self.delta[lane] != 0.0
    }

    /// s, u, v and front of a lane.
    #[inline(always)]
    pub fn of(&self, lane: usize) -> (f64, f64, f64, bool) {
        let front = self.delta[lane] < 0.0;
        (self.s[lane], self.u[lane], self.v[lane], front)
    }

    /// Each line with its own triangle.
    #[inline(always)]
    fn intersect_each<const EACH: bool>(&mut self, pairs: &Pairs, first: usize) {
        for i in 0..GROUP {
            let origin = pairs.origin(if EACH { i } else { 0 });
            let corners = [pairs.corner(0, i), pairs.corner(3, i), pairs.corner(6, i)];
            let (numbers, _) = intersect(origin, pairs.direction(i), corners);
            self.set(first + i, numbers, pairs.unit[i]);
        }
    }

    /// All lines with one triangle.
    #[inline(always)]
    fn intersect_one<const EACH: bool>(
        &mut self,
        pairs: &Pairs,
        corners: &[DVec3; 3],
        first: usize,
    ) {
        for i in 0..GROUP {
            let origin = pairs.origin(if EACH { i } else { 0 });
            let (numbers, _) = intersect(origin, pairs.direction(i), *corners);
            self.set(first + i, numbers, pairs.unit[i]);
        }
    }

    #[inline(always)]
    fn set(&mut self, lane: usize, [s, u, v, delta]: [f64; 4], unit: f64) {
        self.s[lane] = s * unit;
        self.u[lane] = u;
        self.v[lane] = v;
        self.delta[lane] = delta;
    }
}

/// s, u, v and n·d, which is 0 if the hit is left to single rays, and whether the line certainly misses the triangle.
#[inline(always)]
fn intersect(origin: DVec3, d: DVec3, [c0, c1, c2]: [DVec3; 3]) -> ([f64; 4], bool) {
    // U, V and W of `triangle`, from r = a × d.
    let a = c0 - origin;
    let e1 = c1 - c0;
    let e2 = c2 - c0;
    let n = e1.cross(e2);
    let r = a.cross(d);
    let delta = n.dot(d);
    let ru = r.dot(e2);
    let rv = -r.dot(e1);
    let rw = delta - ru - rv;
    let length = norm1(e1) + norm1(e2);
    let bound = Line::bound(norm1(a), length);
    let (low, high) = (lesser(lesser(ru, rv), rw), greater(greater(ru, rv), rw));
    // Needs neither exact arithmetic nor the box, according to (T2) and `GRAZING` of `triangle`.
    let plain = ((low > bound) | (high < -bound)) & (delta.abs() >= GRAZING * (length * length));
    let inverse = 1.0 / delta;
    let s = n.dot(a) / delta;
    let numbers = [
        s,
        ru * inverse,
        rv * inverse,
        if plain { delta } else { 0.0 },
    ];
    (numbers, (low < -bound) & (high > bound))
}

/// Rays and triangles, one pair per lane.
#[repr(C, align(64))]
pub(super) struct Pairs {
    directions: [[f64; GROUP]; 3],
    origins: [[f64; GROUP]; 3],
    /// The factor from s of the line to s of the ray.
    unit: [f64; GROUP],
    /// Coordinates of the first corner, of the second and of the third.
    corners: [[f64; GROUP]; 9],
}

/// Where lines cross triangles, one pair per lane.
#[repr(C, align(64))]
pub(super) struct Crossings {
    /// s of the line, u and v.
    numbers: [[f64; GROUP]; 3],
    /// n·d, or 0 if single rays decide.
    delta: [f64; GROUP],
    /// 1 if the line certainly misses, else 0.
    missed: [f64; GROUP],
}

/// Whether a line crosses a triangle.
pub(super) enum Answer {
    Misses,
    Crosses(Crossing),
    /// Only exact arithmetic can tell, or s may have to be moved into the triangle's box.
    Open,
}

impl Crossings {
    /// Zeros, to be overwritten.
    pub const NONE: Crossings = Crossings {
        numbers: [[0.0; GROUP]; 3],
        delta: [0.0; GROUP],
        missed: [0.0; GROUP],
    };

    /// Intersects all of `pairs`.
    #[inline(always)]
    pub fn fill(&mut self, pairs: &Pairs) {
        for i in 0..GROUP {
            let corners = [pairs.corner(0, i), pairs.corner(3, i), pairs.corner(6, i)];
            let ([s, u, v, delta], missed) =
                intersect(pairs.origin(i), pairs.direction(i), corners);
            self.numbers[0][i] = s;
            self.numbers[1][i] = u;
            self.numbers[2][i] = v;
            self.delta[i] = delta;
            self.missed[i] = if missed { 1.0 } else { 0.0 };
        }
    }

    /// The answer for pair `i`.
    #[inline(always)]
    pub fn of(&self, i: usize) -> Answer {
        let i = i % GROUP;
        if self.missed[i] != 0.0 {
            return Answer::Misses;
        }
        if self.delta[i] == 0.0 {
            return Answer::Open;
        }
        Answer::Crosses(Crossing {
            s: self.numbers[0][i],
            u: self.numbers[1][i],
            v: self.numbers[2][i],
            front: self.delta[i] < 0.0,
        })
    }
}

impl Pairs {
    /// Zeros, to be overwritten.
    pub const NONE: Pairs = Pairs {
        directions: [[0.0; GROUP]; 3],
        origins: [[0.0; GROUP]; 3],
        unit: [0.0; GROUP],
        corners: [[0.0; GROUP]; 9],
    };

    /// Sets a pair: a line with |d|∞ in [1, 2), and a triangle.
    #[inline(always)]
    pub fn set(&mut self, i: usize, line: &Line, corners: &[DVec3; 3]) {
        let i = i % GROUP;
        let (o, d) = (line.origin, line.direction);
        let [x, y, z] = &mut self.origins;
        (x[i], y[i], z[i]) = (o.x, o.y, o.z);
        let [x, y, z] = &mut self.directions;
        (x[i], y[i], z[i]) = (d.x, d.y, d.z);
        self.set_corners(i, corners);
    }

    /// Rays with |d|∞ in [1, 2), scaled as single rays are.
    #[inline(always)]
    fn load<K: Simd, R: RaySet, const EACH: bool>(
        k: K,
        rays: R,
        order: &[u32],
        in_fours: bool,
    ) -> Pairs {
        let mut pairs = Pairs::NONE;
        let order = &order[..GROUP];
        let [x, y, z] = &mut pairs.directions;
        match rays.directions() {
            Some(directions) if in_fours => {
                let mut i = 0;
                while i < GROUP {
                    let ray = order[i] as usize;
                    let four = &directions[ray..ray + 4];
                    k.split_vectors(four, [&mut x[i..], &mut y[i..], &mut z[i..]]);
                    i += 4;
                }
            }
            _ => {
                for i in 0..GROUP {
                    let d = rays.direction(order[i] as usize);
                    (x[i], y[i], z[i]) = (d.x, d.y, d.z);
                }
            }
        }
        // A shared origin is stored once.
        let places = if EACH { GROUP } else { 1 };
        for (i, &ray) in order.iter().enumerate().take(places) {
            let origin = rays.origin(ray as usize);
            pairs.origins[0][i] = origin.x;
            pairs.origins[1][i] = origin.y;
            pairs.origins[2][i] = origin.z;
        }
        let [x, y, z] = &mut pairs.directions;
        for i in 0..GROUP {
            // The power of two that scales the greatest coordinate to [1, 2).
            let size = greater(greater(x[i].abs(), y[i].abs()), z[i].abs());
            let exponent = size.to_bits() >> 52;
            let unit = f64::from_bits((2046u64.wrapping_sub(exponent)) << 52);
            pairs.unit[i] = unit;
            x[i] *= unit;
            y[i] *= unit;
            z[i] *= unit;
        }
        pairs
    }

    /// The triangle of each lane, or the one in slot `instead`.
    #[inline(always)]
    fn collect(&mut self, bvh: &Bvh, slots: &[u32], instead: u32) {
        for (i, &slot) in slots.iter().enumerate().take(GROUP) {
            // Lanes without a hit compute with another lane's triangle, and their results are not read.
            let slot = if slot == NONE { instead } else { slot };
            self.set_corners(i, &bvh.corners[slot as usize]);
        }
    }

    #[inline(always)]
    fn set_corners(&mut self, i: usize, [a, b, c]: &[DVec3; 3]) {
        self.corners[0][i] = a.x;
        self.corners[1][i] = a.y;
        self.corners[2][i] = a.z;
        self.corners[3][i] = b.x;
        self.corners[4][i] = b.y;
        self.corners[5][i] = b.z;
        self.corners[6][i] = c.x;
        self.corners[7][i] = c.y;
        self.corners[8][i] = c.z;
    }

    #[inline(always)]
    fn direction(&self, i: usize) -> DVec3 {
        let [x, y, z] = &self.directions;
        DVec3::new(x[i], y[i], z[i])
    }

    #[inline(always)]
    fn origin(&self, i: usize) -> DVec3 {
        let [x, y, z] = &self.origins;
        DVec3::new(x[i], y[i], z[i])
    }

    #[inline(always)]
    fn corner(&self, first: usize, i: usize) -> DVec3 {
        let c = &self.corners;
        DVec3::new(c[first][i], c[first + 1][i], c[first + 2][i])
    }
}
