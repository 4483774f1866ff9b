//! Arrays, which compilers turn into whatever vectors the processor has.

use glam::DVec3;

use super::{Eight, LOWEST, Simd, Task};
use crate::accel::node::NodeRef;

/// Eight lanes on any processor.
#[derive(Debug, Clone, Copy)]
pub(in super::super) struct Portable;

type Lanes = [f32; 8];

/// Operations lane by lane: their names, and the result for a lane.
macro_rules! lanewise {
    ($($name:ident($($x:ident),+) = $result:expr;)+) => {$(
        #[inline(always)]
        fn $name(self, $($x: Lanes),+) -> Lanes {
            std::array::from_fn(|i| {
                $(let $x = $x[i];)+
                $result
            })
        }
    )+};
}

const SIGN: u32 = 1 << 31;

#[inline(always)]
fn mask(f: impl Fn(usize) -> bool) -> u32 {
    (0..8).fold(0, |bits, i| bits | u32::from(f(i)) << i)
}

impl Simd for Portable {
    type F = Lanes;
    type Children = Portable;
    const LANES: usize = 8;

    lanewise! {
        add(x, y) = x + y;
        sub(x, y) = x - y;
        mul(x, y) = x * y;
        div(x, y) = x / y;
        mul_add(x, y, z) = x * y + z;
        mul_sub(x, y, z) = x * y - z;
        abs(x) = x.abs();
        flip(x, by) = f32::from_bits(x.to_bits() ^ (by.to_bits() & SIGN));
        min(x, y) = if x < y { x } else { y };
        max(x, y) = if x > y { x } else { y };
    }

    #[inline(always)]
    fn children(self) -> Portable {
        self
    }

    #[inline(always)]
    fn run<T: Task>(self, task: T) -> T::Output {
        task.run(self)
    }

    #[inline(always)]
    fn splat(self, x: f32) -> Lanes {
        [x; 8]
    }

    #[inline(always)]
    fn load(self, from: &[f32]) -> Lanes {
        let mut lanes = [0.0; 8];
        lanes.copy_from_slice(&from[..8]);
        lanes
    }

    #[inline(always)]
    fn store(self, to: &mut [f32], x: Lanes) {
        to[..8].copy_from_slice(&x);
    }

    #[inline(always)]
    fn store_some(self, to: &mut [f32], mask: u32, x: Lanes) {
        let to = &mut to[..8];
        for i in 0..8 {
            to[i] = if mask >> i & 1 != 0 { x[i] } else { to[i] };
        }
    }

    #[inline(always)]
    fn store_index(self, to: &mut [u32], mask: u32, x: u32) {
        let to = &mut to[..8];
        for (i, to) in to.iter_mut().enumerate() {
            *to = if mask >> i & 1 != 0 { x } else { *to };
        }
    }

    #[inline(always)]
    fn store_vectors(self, vectors: &[DVec3], scale: f64, [x, y, z]: [&mut [f32]; 3]) {
        // With known lengths, so that the loop has no bounds checks.
        let (vectors, x, y, z) = (&vectors[..4], &mut x[..4], &mut y[..4], &mut z[..4]);
        for (i, v) in vectors.iter().enumerate() {
            x[i] = (v.x * scale) as f32;
            y[i] = (v.y * scale) as f32;
            z[i] = (v.z * scale) as f32;
        }
    }

    #[inline(always)]
    fn split_vectors(self, vectors: &[DVec3], [x, y, z]: [&mut [f64]; 3]) {
        let (vectors, x, y, z) = (&vectors[..4], &mut x[..4], &mut y[..4], &mut z[..4]);
        for (i, v) in vectors.iter().enumerate() {
            (x[i], y[i], z[i]) = (v.x, v.y, v.z);
        }
    }

    #[inline(always)]
    fn select(self, mask: u32, x: Lanes, y: Lanes) -> Lanes {
        std::array::from_fn(|i| if mask >> i & 1 != 0 { x[i] } else { y[i] })
    }

    #[inline(always)]
    fn le(self, x: Lanes, y: Lanes) -> u32 {
        mask(|i| x[i] <= y[i])
    }

    #[inline(always)]
    fn not_negative(self, x: Lanes, y: Lanes, z: Lanes) -> u32 {
        mask(|i| (x[i] >= 0.0) & (y[i] >= 0.0) & (z[i] >= 0.0))
    }

    #[inline(always)]
    fn signs(self, x: Lanes) -> u32 {
        mask(|i| x[i].is_sign_negative())
    }

    #[inline(always)]
    fn greatest(self, x: Lanes) -> f32 {
        x.into_iter()
            .fold(f32::NEG_INFINITY, |g, x| if x > g { x } else { g })
    }

    #[inline(always)]
    fn smallest(self, x: Lanes) -> f32 {
        x.into_iter()
            .fold(f32::INFINITY, |s, x| if x < s { x } else { s })
    }
}

impl Eight for Portable {
    #[inline(always)]
    fn smallest_of_each(self, x: [Lanes; 4]) -> [f32; 4] {
        x.map(|x| self.smallest(x))
    }

    #[inline(always)]
    fn push_hits(
        self,
        enter: Lanes,
        leave: Lanes,
        nodes: &[NodeRef; 8],
        entries: &mut [u32],
        to: &mut [NodeRef],
    ) -> usize {
        let mut count = 0;
        for i in 0..8 {
            if enter[i] <= leave[i] {
                // Insertion sort, the farthest first.
                let entry = enter[i].to_bits() & !SIGN & !LOWEST | i as u32;
                let mut place = count;
                while place > 0 && entries[place - 1] < entry {
                    (entries[place], to[place]) = (entries[place - 1], to[place - 1]);
                    place -= 1;
                }
                (entries[place], to[place]) = (entry, nodes[i]);
                count += 1;
            }
        }
        count
    }

    #[inline(always)]
    fn push_bits(self, bits: u32, first: u32, to: &mut [u32]) -> usize {
        let mut count = 0;
        for i in 0..8 {
            if bits >> i & 1 != 0 {
                to[count] = first + i;
                count += 1;
            }
        }
        count
    }

    #[inline(always)]
    fn within(self, entries: &[u32], limit: f32) -> u32 {
        let entries = &entries[..8];
        mask(|i| f32::from_bits(entries[i] & !LOWEST) <= limit)
    }
}
