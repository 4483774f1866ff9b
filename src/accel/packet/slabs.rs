//! The interval test: which children of a node a block may meet. [`beam`](super::beam) derives it.

use super::beam::{Axis, Beam};
use super::simd::Simd;
use crate::accel::wide::{WIDTH, Wide};

/// A beam in eight lanes.
pub(super) struct Slabs<K: Simd> {
    kernel: K,
    axes: [Slab<K::F>; 3],
}

struct Slab<F> {
    near: usize,
    straddles: bool,
    inverse: [F; 2],
    near_offset: [F; 2],
    far_offset: [F; 2],
}

impl<F: Copy> Slab<F> {
    #[inline(always)]
    fn new<K: Simd<F = F>>(k: K, axis: &Axis) -> Slab<F> {
        let [i, j] = axis.inverse;
        let [a, b] = axis.near_offset;
        let [c, d] = axis.far_offset;
        Slab {
            near: axis.near,
            straddles: axis.straddles,
            inverse: [k.splat(i), k.splat(j)],
            near_offset: [k.splat(a), k.splat(b)],
            far_offset: [k.splat(c), k.splat(d)],
        }
    }
}

impl<K: Simd> Slabs<K> {
    /// `beam` with the children's lanes.
    #[inline(always)]
    pub fn new(k: K, beam: &Beam) -> Slabs<K> {
        let [x, y, z] = &beam.axes;
        Slabs {
            kernel: k,
            axes: [Slab::new(k, x), Slab::new(k, y), Slab::new(k, z)],
        }
    }

    /// The children that a ray of the block may meet before `limit`, and where they are entered.
    #[inline(always)]
    pub fn meet(&self, node: &Wide, limit: f32, entries: &mut [f32; WIDTH]) -> u32 {
        let k = self.kernel;
        let (mut enter, mut leave) = (k.splat(0.0), k.splat(limit));
        let mut axis = 0;
        while axis < 3 {
            let (slab, planes) = (&self.axes[axis], &node.planes[axis]);
            axis += 1;
            let [i, j] = slab.inverse;
            let [a, b] = slab.near_offset;
            let near = k.load(&planes[slab.near]);
            let far = k.load(&planes[1 - slab.near]);
            if slab.straddles {
                enter = k.max(enter, k.max(k.mul_add(near, i, a), k.mul_add(far, j, b)));
            } else {
                let [c, d] = slab.far_offset;
                enter = k.max(enter, k.min(k.mul_add(near, i, a), k.mul_add(near, j, b)));
                leave = k.min(leave, k.max(k.mul_add(far, i, c), k.mul_add(far, j, d)));
            }
        }
        k.store(entries, enter);
        k.le(enter, leave)
    }
}
