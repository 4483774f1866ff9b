//! Arrays, which compilers turn into what vectors there are.

use glam::DVec3;

use super::{Simd, Task};

/// Eight lanes on any processor.
#[derive(Debug, Clone, Copy)]
pub(in super::super) struct Portable;

type Lanes = [f32; 8];

#[inline(always)]
fn each(x: Lanes, y: Lanes, f: impl Fn(f32, f32) -> f32) -> Lanes {
    std::array::from_fn(|i| f(x[i], y[i]))
}

#[inline(always)]
fn mask(f: impl Fn(usize) -> bool) -> u32 {
    (0..8).fold(0, |bits, i| bits | u32::from(f(i)) << i)
}

impl Simd for Portable {
    type F = Lanes;
    type Children = Portable;
    const LANES: usize = 8;

    #[inline(always)]
    fn children(self) -> Portable {
        self
    }

    #[inline(always)]
    fn run(self, task: impl Task) {
        task.run(self);
    }

    #[inline(always)]
    fn prefetch<T>(self, _: &T) {}

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
    fn store_vectors(
        self,
        vectors: &[DVec3],
        scale: f64,
        x: &mut [f32],
        y: &mut [f32],
        z: &mut [f32],
    ) {
        let (vectors, x, y, z) = (&vectors[..4], &mut x[..4], &mut y[..4], &mut z[..4]);
        for (i, v) in vectors.iter().enumerate() {
            x[i] = (v.x * scale) as f32;
            y[i] = (v.y * scale) as f32;
            z[i] = (v.z * scale) as f32;
        }
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
    fn select(self, mask: u32, x: Lanes, y: Lanes) -> Lanes {
        std::array::from_fn(|i| if mask >> i & 1 != 0 { x[i] } else { y[i] })
    }

    #[inline(always)]
    fn store_index(self, to: &mut [u32], mask: u32, x: u32) {
        let to = &mut to[..8];
        for (i, to) in to.iter_mut().enumerate() {
            *to = if mask >> i & 1 != 0 { x } else { *to };
        }
    }

    #[inline(always)]
    fn add(self, x: Lanes, y: Lanes) -> Lanes {
        each(x, y, |x, y| x + y)
    }

    #[inline(always)]
    fn sub(self, x: Lanes, y: Lanes) -> Lanes {
        each(x, y, |x, y| x - y)
    }

    #[inline(always)]
    fn mul(self, x: Lanes, y: Lanes) -> Lanes {
        each(x, y, |x, y| x * y)
    }

    #[inline(always)]
    fn div(self, x: Lanes, y: Lanes) -> Lanes {
        each(x, y, |x, y| x / y)
    }

    #[inline(always)]
    fn mul_add(self, x: Lanes, y: Lanes, z: Lanes) -> Lanes {
        std::array::from_fn(|i| x[i] * y[i] + z[i])
    }

    #[inline(always)]
    fn mul_sub(self, x: Lanes, y: Lanes, z: Lanes) -> Lanes {
        std::array::from_fn(|i| x[i] * y[i] - z[i])
    }

    #[inline(always)]
    fn abs(self, x: Lanes) -> Lanes {
        x.map(f32::abs)
    }

    #[inline(always)]
    fn flip(self, x: Lanes, by: Lanes) -> Lanes {
        const SIGN: u32 = 1 << 31;
        each(x, by, |x, by| {
            f32::from_bits(x.to_bits() ^ (by.to_bits() & SIGN))
        })
    }

    #[inline(always)]
    fn min(self, x: Lanes, y: Lanes) -> Lanes {
        each(x, y, |x, y| if x < y { x } else { y })
    }

    #[inline(always)]
    fn max(self, x: Lanes, y: Lanes) -> Lanes {
        each(x, y, |x, y| if x > y { x } else { y })
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
