//! Single lookups in cubes on disk, several at a time: sharp ones, means over sample footprints, and those near the ends of data.
//!
//! They are carried out twice. The first time nothing is read, and the bricks that they need are recorded; then the missing ones are read
//! together, in file order, and the second time all are available without a lock. Results are the same bit for bit.

use std::cell::{Cell, RefCell};

use crate::io::cube::{Bricks, Held};

/// The most lookups that are carried out together.
const TOGETHER: usize = 256;

/// Bricks that a thread holds for single lookups.
#[derive(Debug, Default)]
pub struct Near {
    held: RefCell<Held>,
    wanted: RefCell<Vec<u64>>,
    is_asking: Cell<bool>,
}

impl Near {
    /// Whether lookups only record what they need; what they return then has no meaning.
    pub fn is_asking(&self) -> bool {
        self.is_asking.get()
    }

    /// The samples of bins `bin` and on of a texel, as many as `to` has room for.
    pub(super) fn samples(&self, bricks: &Bricks, texel: usize, bin: usize, to: &mut [f64]) {
        let mut held = self.held.borrow_mut();
        match self.is_asking.get() {
            true => {
                let bins = to.len() / bricks.shape()[3];
                bricks.want(&held, texel, bin, bins, &mut self.wanted.borrow_mut());
            }
            false => bricks.samples(&mut held, texel, bin, to),
        }
    }

    /// Whether as many bricks are requested as fit.
    fn wants_enough(&self, bricks: &Bricks) -> bool {
        let mut wanted = self.wanted.borrow_mut();
        if wanted.len() < bricks.at_hand() {
            return false;
        }
        wanted.sort_unstable();
        wanted.dedup();
        // Two that share a slot evict each other: fewer than the number of slots.
        wanted.len() >= bricks.at_hand().div_ceil(4)
    }

    /// Carries out `count` lookups, by number, each twice: the results count only when this [is not asking](Near::is_asking).
    pub(super) fn look_up_each(
        &self,
        bricks: &Bricks,
        count: usize,
        mut look_up: impl FnMut(usize),
    ) {
        let mut begin = 0;
        while begin < count {
            let mut end = begin;
            self.is_asking.set(true);
            while end < count && end - begin < TOGETHER && !self.wants_enough(bricks) {
                look_up(end);
                end += 1;
            }
            self.is_asking.set(false);
            bricks.bring(&mut self.held.borrow_mut(), &mut self.wanted.borrow_mut());
            (begin..end).for_each(&mut look_up);
            begin = end;
        }
        self.held.borrow_mut().clear();
    }
}
