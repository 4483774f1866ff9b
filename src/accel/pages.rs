//! Long arrays in large memory pages, if the system has them.
//!
//! Rays read trees at scattered addresses. With pages of 4 KiB, address translation takes as long as the access itself; pages of 2 MiB are
//! few enough for the TLB. With 1.6 million triangles, incoherent rays then take three quarters of the time.
//!
//! But large pages can take longer to allocate: a virtual machine that returns free memory to its host must first fetch each of them again
//! (25 MB in 3 ms if they were kept, in 95 ms if not; in small pages in 20 ms). So arrays state whether enough rays read them for this to
//! pay. If the system has no large pages, or does not grant them, ordinary memory is used.

use std::fmt;
use std::mem::MaybeUninit;
use std::ops::{Deref, DerefMut};
use std::ptr::NonNull;

use memmap2::MmapMut;
use rayon::prelude::*;

/// The size of a large page on most systems, bytes.
const PAGE: usize = 1 << 21;
/// Arrays of fewer bytes do not get their own memory map.
const LARGE: usize = 2 * PAGE;
/// The number of elements that one thread builds at a time.
const CHUNK: usize = 1 << 12;

/// The kind of memory pages for an array.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) enum PageSize {
    /// Ordinary pages.
    #[default]
    Usual,
    /// Large pages, if the array is long: for arrays that many rays read.
    Large,
}

/// An array of plain values, of fixed length.
pub(crate) struct Pages<T> {
    /// The first value, in `_memory`, aligned for `T`, followed by the others, `len` in all.
    start: NonNull<T>,
    len: usize,
    /// Owns the memory to which `start` points.
    _memory: Memory<T>,
}

enum Memory<T> {
    Heap(#[expect(dead_code, reason = "owns what the array points to")] Vec<T>),
    Map(#[expect(dead_code, reason = "owns what the array points to")] MmapMut),
}

// SAFETY: it owns its values as a `Vec` does, and nothing else refers to the map.
unsafe impl<T: Send> Send for Pages<T> {}
// SAFETY: as above; `&Pages` only gives out `&[T]`.
unsafe impl<T: Sync> Sync for Pages<T> {}

impl<T: Copy + Send + Sync> Pages<T> {
    /// The values of `value` for 0 to `len` − 1, in pages of this `size`.
    pub fn build(size: PageSize, len: usize, value: impl Fn(usize) -> T + Sync) -> Pages<T> {
        let map = match size {
            PageSize::Usual => None,
            PageSize::Large => map::<T>(len),
        };
        let Some((mut map, offset)) = map else {
            return (0..len)
                .into_par_iter()
                .map(&value)
                .collect::<Vec<T>>()
                .into();
        };
        // SAFETY: `map` guarantees room for `len` aligned values from `offset` on; uninitialized values may be any bytes.
        let values = unsafe {
            let start = map.as_mut_ptr().add(offset).cast::<MaybeUninit<T>>();
            std::slice::from_raw_parts_mut(start, len)
        };
        let chunks = values.par_chunks_mut(CHUNK).enumerate();
        chunks.for_each(|(chunk, values)| {
            for (at, to) in values.iter_mut().enumerate() {
                to.write(value(chunk * CHUNK + at));
            }
        });
        let start = NonNull::from(values).cast();
        Pages {
            start,
            len,
            _memory: Memory::Map(map),
        }
    }
}

/// A map with room for `len` values from an offset on, where a large page begins; `None` if there are too few values, or if the system has
/// no maps.
fn map<T>(len: usize) -> Option<(MmapMut, usize)> {
    let bytes = len.checked_mul(size_of::<T>()).filter(|&b| b >= LARGE)?;
    // One page more than needed, because the map itself may not begin at a large page.
    let map = MmapMut::map_anon(bytes.checked_add(PAGE)?).ok()?;
    // Without large pages it is ordinary memory.
    #[cfg(all(target_os = "linux", not(miri)))]
    let _ = map.advise(memmap2::Advice::HugePage);
    let offset = map.as_ptr().align_offset(PAGE.max(align_of::<T>()));
    // `align_offset` may fail, and then returns `usize::MAX`.
    (offset <= PAGE).then_some((map, offset))
}

impl<T> From<Vec<T>> for Pages<T> {
    /// The same values, without copying.
    fn from(mut values: Vec<T>) -> Self {
        Pages {
            start: NonNull::from(values.as_mut_slice()).cast(),
            len: values.len(),
            _memory: Memory::Heap(values),
        }
    }
}

impl<T> Default for Pages<T> {
    fn default() -> Self {
        Vec::new().into()
    }
}

impl<T: Copy + Send + Sync> Clone for Pages<T> {
    fn clone(&self) -> Self {
        let size = match self._memory {
            Memory::Heap(_) => PageSize::Usual,
            Memory::Map(_) => PageSize::Large,
        };
        Pages::build(size, self.len, |at| self[at])
    }
}

impl<T: fmt::Debug> fmt::Debug for Pages<T> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        self.deref().fmt(f)
    }
}

impl<T> Deref for Pages<T> {
    type Target = [T];

    #[inline(always)]
    fn deref(&self) -> &[T] {
        // SAFETY: `_memory` contains `len` values from `start` on, and nothing writes to them while `self` is borrowed.
        unsafe { std::slice::from_raw_parts(self.start.as_ptr(), self.len) }
    }
}

impl<T> DerefMut for Pages<T> {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut [T] {
        // SAFETY: as in `deref`; nothing else borrows `self`.
        unsafe { std::slice::from_raw_parts_mut(self.start.as_ptr(), self.len) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrays_of_all_lengths_hold_what_was_made() {
        #[derive(Clone, Copy, PartialEq, Debug)]
        #[repr(align(64))]
        struct Line(u64);
        // Empty, short, and just below and above the length that gets its own map.
        let worth = LARGE / size_of::<Line>();
        for len in [0, 1, 1000, worth - 1, worth, worth + 777] {
            for size in [PageSize::Usual, PageSize::Large] {
                let value = |at: usize| Line(at as u64 * 3);
                let mut pages = Pages::build(size, len, value);
                let is_map = matches!(pages._memory, Memory::Map(_));
                assert_eq!(is_map, size == PageSize::Large && len >= worth);
                assert_eq!(pages.len(), len);
                assert!(pages.iter().enumerate().all(|(at, x)| *x == value(at)));
                assert!(pages.as_ptr().is_aligned());
                let copy = pages.clone();
                if let Some(last) = pages.last_mut() {
                    *last = Line(1);
                    assert_eq!(copy[len - 1], value(len - 1));
                }
            }
        }
    }

    #[test]
    fn what_no_memory_can_hold_has_no_map() {
        assert!(map::<f64>(usize::MAX).is_none());
        assert!(map::<f64>(usize::MAX / 16).is_none());
    }
}
