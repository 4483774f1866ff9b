//! Plain loops over arrays, compiled for the widest vectors that the processor has.
//!
//! A [`VectorLoop`] is ordinary Rust. [`dispatch`] contains a copy of it for each instruction set and picks one at run time. IEEE 754
//! rounds sums, products, quotients and roots the same at every width, and the compiler does not fuse operations: results are the same bit
//! for bit.
//!
//! A loop gets the wide instructions only if all of it is inlined: everything that it calls per element must be `#[inline(always)]`, and it
//! must not contain closures.

#![allow(unsafe_code)]

use glam::DVec3;

use crate::colour::ShiftMatrix;

/// A loop over arrays, with what it reads and writes.
pub(crate) trait VectorLoop {
    /// Runs the loop. Implementations must be `#[inline(always)]`.
    fn run(self);
}

/// Runs `work` with the widest vectors that this processor has.
#[inline]
pub(crate) fn dispatch(work: impl VectorLoop) {
    #[cfg(target_arch = "x86_64")]
    {
        if x86::has_avx512() {
            // SAFETY: the processor has these instructions.
            return unsafe { x86::avx512(work) };
        }
        if x86::has_avx2() {
            // SAFETY: as above.
            return unsafe { x86::avx2(work) };
        }
    }
    work.run();
}

/// Number of elements that a loop processes together. For arrays of this size on the stack, the compiler knows that they do not overlap
/// and that no index is out of bounds.
pub(crate) const BLOCK: usize = 64;

/// A number for each element of a block.
pub(crate) type Block = [f64; BLOCK];

/// The numbers of `from` from `begin` on, with zeros after the last.
#[inline(always)]
pub(crate) fn load(from: &[f64], begin: usize) -> Block {
    // Whole blocks, which are the vast majority, are copied in registers, without a call.
    match from.get(begin..).and_then(<[f64]>::first_chunk) {
        Some(block) => *block,
        None => load_last(from, begin),
    }
}

/// The same without a copy, except for a partial block, which goes to `last`.
#[inline(always)]
pub(crate) fn block_of<'a>(from: &'a [f64], begin: usize, last: &'a mut Block) -> &'a Block {
    match from.get(begin..).and_then(<[f64]>::first_chunk) {
        Some(block) => block,
        None => {
            *last = load_last(from, begin);
            last
        }
    }
}

#[cold]
#[inline(never)]
fn load_last(from: &[f64], begin: usize) -> Block {
    let mut to = [0.0; BLOCK];
    let rest = from.get(begin..).unwrap_or_default();
    to[..rest.len()].copy_from_slice(rest);
    to
}

/// Copies `from` into `to` from `begin` on, up to the end of `to`.
#[inline(always)]
pub(crate) fn store(from: &Block, to: &mut [f64], begin: usize) {
    match to.get_mut(begin..).and_then(<[f64]>::first_chunk_mut) {
        Some(block) => *block = *from,
        None => store_last(from, to, begin),
    }
}

#[cold]
#[inline(never)]
fn store_last(from: &Block, to: &mut [f64], begin: usize) {
    let rest = to.get_mut(begin..).unwrap_or_default();
    rest.copy_from_slice(&from[..rest.len()]);
}

/// Vectors by component, for loops over many of them.
#[derive(Debug, Default, Clone)]
pub(crate) struct Columns {
    count: usize,
    /// In whole blocks: values after the last vector are meaningless.
    columns: [Vec<f64>; 3],
}

impl Columns {
    /// The number of vectors.
    #[inline(always)]
    pub fn len(&self) -> usize {
        self.count
    }

    /// Resizes to `count` vectors, whose values are then to be overwritten.
    pub fn resize(&mut self, count: usize) {
        self.count = count;
        let room = count.next_multiple_of(BLOCK);
        if self.columns[0].len() < room {
            for column in &mut self.columns {
                column.resize(room, 0.0);
            }
        }
    }

    /// Sets the contents to `count` copies of `v`.
    pub fn fill(&mut self, count: usize, v: DVec3) {
        self.resize(count);
        for (column, x) in self.columns.iter_mut().zip(v.to_array()) {
            column[..count].fill(x);
        }
    }

    /// Removes all vectors.
    pub fn clear(&mut self) {
        self.count = 0;
    }

    /// Appends a vector.
    #[inline(always)]
    pub fn push(&mut self, v: DVec3) {
        let at = self.count;
        self.count += 1;
        if at >= self.columns[0].len() {
            self.resize(at + 1);
        }
        self.set(at, v);
    }

    /// Vector `k`.
    #[inline(always)]
    pub fn get(&self, k: usize) -> DVec3 {
        let [x, y, z] = &self.columns;
        DVec3::new(x[k], y[k], z[k])
    }

    /// Writes vector `k`.
    #[inline(always)]
    pub fn set(&mut self, k: usize, v: DVec3) {
        let [x, y, z] = &mut self.columns;
        [x[k], y[k], z[k]] = v.to_array();
    }

    /// The coordinates of all vectors, axis by axis.
    #[inline(always)]
    pub fn axes(&self) -> [&[f64]; 3] {
        let [x, y, z] = &self.columns;
        [&x[..self.count], &y[..self.count], &z[..self.count]]
    }

    /// Replaces the contents by the vectors of `from` at these indices.
    pub fn gather(&mut self, from: &Columns, numbers: &[u32]) {
        self.resize(numbers.len());
        for (to, from) in self.columns.iter_mut().zip(&from.columns) {
            for (to, number) in to.iter_mut().zip(numbers) {
                *to = from[*number as usize];
            }
        }
    }

    /// Replaces the contents by these vectors.
    pub fn take(&mut self, from: &[DVec3]) {
        self.resize(from.len());
        dispatch(Deinterleave { from, to: self });
    }

    /// Appends all vectors to `to`.
    pub fn add_to(&self, to: &mut Vec<[f64; 3]>) {
        let begin = to.len();
        to.resize(begin + self.count, [0.0; 3]);
        dispatch(Interleave {
            from: self.axes(),
            to: &mut to[begin..],
        });
    }

    /// The vectors from `begin` on, which must be the start of a block.
    #[inline(always)]
    pub fn block(&self, begin: usize) -> VectorsRef<'_> {
        const NONE: &Block = &[0.0; BLOCK];
        VectorsRef(self.columns.each_ref().map(|column| {
            let from = column.get(begin..).unwrap_or_default();
            from.first_chunk().unwrap_or(NONE)
        }))
    }

    /// The same, mutable; `None` after the last.
    #[inline(always)]
    pub fn block_mut(&mut self, begin: usize) -> Option<[&mut Block; 3]> {
        let [x, y, z] = &mut self.columns;
        Some([
            x.get_mut(begin..)?.first_chunk_mut()?,
            y.get_mut(begin..)?.first_chunk_mut()?,
            z.get_mut(begin..)?.first_chunk_mut()?,
        ])
    }

    /// A copy of the vectors from `begin` on.
    #[inline(always)]
    pub fn load(&self, begin: usize) -> Vectors {
        let VectorsRef([x, y, z]) = self.block(begin);
        Vectors([*x, *y, *z])
    }

    /// Overwrites the vectors from `begin` on.
    #[inline(always)]
    pub fn store(&mut self, from: &Vectors, begin: usize) {
        for (from, to) in from.0.iter().zip(&mut self.columns) {
            store(from, to, begin);
        }
    }
}

/// The loop that puts the components of each vector together.
struct Interleave<'a> {
    from: [&'a [f64]; 3],
    to: &'a mut [[f64; 3]],
}

impl VectorLoop for Interleave<'_> {
    #[inline(always)]
    fn run(self) {
        let [x, y, z] = self.from;
        for (to, ((x, y), z)) in self.to.iter_mut().zip(x.iter().zip(y).zip(z)) {
            *to = [*x, *y, *z];
        }
    }
}

/// The loop that splits consecutive vectors by component.
struct Deinterleave<'a> {
    from: &'a [DVec3],
    to: &'a mut Columns,
}

impl VectorLoop for Deinterleave<'_> {
    #[inline(always)]
    fn run(self) {
        let (blocks, rest) = self.from.as_chunks::<BLOCK>();
        let mut begin = 0;
        for from in blocks {
            if let Some([x, y, z]) = self.to.block_mut(begin) {
                for (k, v) in from.iter().enumerate() {
                    (x[k], y[k], z[k]) = (v.x, v.y, v.z);
                }
            }
            begin += BLOCK;
        }
        for (k, v) in (begin..).zip(rest) {
            self.to.set(k, *v);
        }
    }
}

/// A block of vectors by component, by reference.
#[derive(Debug, Clone, Copy)]
pub(crate) struct VectorsRef<'a>([&'a Block; 3]);

impl<'a> VectorsRef<'a> {
    /// Their coordinates, axis by axis.
    #[inline(always)]
    pub fn axes(self) -> [&'a Block; 3] {
        self.0
    }

    /// Vector `k`.
    #[inline(always)]
    pub fn get(&self, k: usize) -> DVec3 {
        let [x, y, z] = &self.0;
        DVec3::new(x[k], y[k], z[k])
    }
}

/// A block of vectors by component.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Vectors([Block; 3]);

impl Vectors {
    /// Zeros, to be overwritten.
    pub const ZERO: Vectors = Vectors([[0.0; BLOCK]; 3]);

    /// The same vector everywhere.
    #[inline(always)]
    pub fn splat(v: DVec3) -> Vectors {
        Vectors([[v.x; BLOCK], [v.y; BLOCK], [v.z; BLOCK]])
    }

    /// Vector `k`.
    #[inline(always)]
    pub fn get(&self, k: usize) -> DVec3 {
        let [x, y, z] = &self.0;
        DVec3::new(x[k], y[k], z[k])
    }

    /// The same by reference.
    #[inline(always)]
    pub fn as_ref(&self) -> VectorsRef<'_> {
        VectorsRef(self.0.each_ref())
    }

    /// The coordinates, axis by axis, mutable.
    #[inline(always)]
    pub fn axes_mut(&mut self) -> &mut [Block; 3] {
        &mut self.0
    }

    /// Writes vector `k`.
    #[inline(always)]
    pub fn set(&mut self, k: usize, v: DVec3) {
        let [x, y, z] = &mut self.0;
        (x[k], y[k], z[k]) = (v.x, v.y, v.z);
    }
}

/// The index that stands for no row.
pub(crate) const NO_ROW: u32 = u32::MAX;

/// Fills `to`, word by word, with the rows at these indices; with zeros for indices out of range, such as [`NO_ROW`].
pub(crate) fn gather_rows(rows: &[[u32; 8]], numbers: &[u32; BLOCK], to: &mut [[u32; BLOCK]; 8]) {
    #[cfg(target_arch = "x86_64")]
    if x86::has_avx2() {
        // SAFETY: the processor has these instructions.
        return unsafe { x86::gather_rows(rows, numbers, to) };
    }
    gather_rows_singly(rows, numbers, to);
}

/// The same without vectors.
fn gather_rows_singly(rows: &[[u32; 8]], numbers: &[u32; BLOCK], to: &mut [[u32; BLOCK]; 8]) {
    for (k, number) in numbers.iter().enumerate() {
        let row = row(rows, *number);
        for (to, word) in to.iter_mut().zip(row) {
            to[k] = *word;
        }
    }
}

#[inline(always)]
fn row(rows: &[[u32; 8]], number: u32) -> &[u32; 8] {
    const NOTHING: &[u32; 8] = &[0; 8];
    rows.get(number as usize).unwrap_or(NOTHING)
}

/// Fills `to`, axis by axis, with the vectors at these indices times their factors; with zeros for indices out of range.
pub(crate) fn gather_vectors(
    from: &[DVec3],
    numbers: &[u32; BLOCK],
    factors: &Block,
    to: [&mut Block; 3],
) {
    #[cfg(target_arch = "x86_64")]
    if x86::has_avx2() {
        // SAFETY: the processor has these instructions.
        return unsafe { x86::gather_vectors(from, numbers, factors, to) };
    }
    gather_vectors_singly(from, numbers, factors, to);
}

/// The same without vectors.
fn gather_vectors_singly(
    from: &[DVec3],
    numbers: &[u32; BLOCK],
    factors: &Block,
    [x, y, z]: [&mut Block; 3],
) {
    for (k, number) in numbers.iter().enumerate() {
        let v = from.get(*number as usize).copied().unwrap_or_default() * factors[k];
        (x[k], y[k], z[k]) = (v.x, v.y, v.z);
    }
}

/// Multiplies each of `rgb` by the interpolated matrix at its place, its factor and the common gain. Places are matrix indices and
/// fractions of the step to the next; if there is no matrix with an index, `rgb` is unchanged.
pub(crate) fn shift_each(
    matrices: &[ShiftMatrix],
    places: (&[u64; BLOCK], &Block),
    factors: (&[f64], f64),
    rgb: &mut [[f64; 3]],
) {
    #[cfg(target_arch = "x86_64")]
    if x86::has_avx2() {
        // SAFETY: the processor has these instructions.
        return unsafe { x86::shift_each(matrices, places, factors, rgb) };
    }
    shift_singly(matrices, places, factors, rgb);
}

/// The same without vectors.
fn shift_singly(
    matrices: &[ShiftMatrix],
    (at, rests): (&[u64; BLOCK], &Block),
    (factors, gain): (&[f64], f64),
    rgb: &mut [[f64; 3]],
) {
    let places = at.iter().zip(rests);
    for ((rgb, factor), (at, rest)) in rgb.iter_mut().zip(factors).zip(places) {
        if let Some(matrix) = ShiftMatrix::of(matrices, *at) {
            let factor = factor * gain;
            *rgb = matrix.times(*rest, *rgb).map(|x| x * factor);
        }
    }
}

/// Loads element `at` of `slice` into the cache, to be read soon. Does nothing if `at` is out of bounds.
#[inline(always)]
pub(crate) fn prefetch<T>(slice: &[T], at: usize) {
    #[cfg(target_arch = "x86_64")]
    if at < slice.len() {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // SAFETY: the element is in the slice, and prefetching reads nothing.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(slice.as_ptr().add(at).cast()) }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (slice, at);
}

/// Loads a whole element of `first` or of `second` into the cache, without a branch; elements of `second` must not be larger than those of
/// `first`.
#[inline(always)]
pub(crate) fn prefetch_either<T, U>(is_first: bool, first: &[T], second: &[U], at: usize) {
    const { assert!(size_of::<U>() <= size_of::<T>()) };
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        let first: *const i8 = first.as_ptr().wrapping_add(at).cast();
        let second: *const i8 = second.as_ptr().wrapping_add(at).cast();
        let element = std::hint::select_unpredictable(is_first, first, second);
        let mut offset = 0;
        while offset < size_of::<T>() {
            // SAFETY: prefetching reads nothing, wherever it points.
            unsafe { _mm_prefetch::<_MM_HINT_T0>(element.wrapping_add(offset)) };
            // One cache line.
            offset += 64;
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (is_first, first, second, at);
}

/// Loads all of `what` into the cache, to be read soon.
#[inline(always)]
pub(crate) fn prefetch_all<T: ?Sized>(what: &T) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        let first: *const i8 = std::ptr::from_ref(what).cast();
        let mut at = 0;
        while at < size_of_val(what) {
            // SAFETY: prefetching reads nothing, and `at` is within `what`.
            unsafe { _mm_prefetch::<_MM_HINT_T0>(first.add(at)) };
            // One cache line.
            at += 64;
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = what;
}

#[cfg(target_arch = "x86_64")]
pub(super) mod x86 {
    use glam::DVec3;

    use super::{BLOCK, Block, ShiftMatrix, VectorLoop, gather_vectors_singly, row};

    /// Whether [`avx512`] may be called.
    #[inline]
    pub fn has_avx512() -> bool {
        is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512dq")
            && is_x86_feature_detected!("avx512vl")
            && is_x86_feature_detected!("avx512bw")
            && has_avx2()
    }

    /// Whether [`avx2`] may be called.
    #[inline]
    pub fn has_avx2() -> bool {
        is_x86_feature_detected!("avx2")
    }

    #[target_feature(enable = "avx512f,avx512dq,avx512vl,avx512bw,avx2")]
    pub fn avx512(work: impl VectorLoop) {
        work.run();
    }

    #[target_feature(enable = "avx2")]
    pub fn avx2(work: impl VectorLoop) {
        work.run();
    }

    /// Loads four vectors at a time, each with one more number, and splits them by axis.
    #[target_feature(enable = "avx2")]
    pub fn gather_vectors(
        from: &[DVec3],
        numbers: &[u32; BLOCK],
        factors: &Block,
        [x, y, z]: [&mut Block; 3],
    ) {
        use std::arch::x86_64::{
            __m256d, _mm256_loadu_pd, _mm256_mul_pd, _mm256_permute2f128_pd, _mm256_storeu_pd,
            _mm256_unpackhi_pd, _mm256_unpacklo_pd,
        };
        // After the last vector there is no further number.
        let last = numbers.iter().fold(0, |last, number| last.max(*number));
        if last as usize + 1 >= from.len() {
            return gather_vectors_singly(from, numbers, factors, [x, y, z]);
        }
        let load = |number: u32| -> __m256d {
            // SAFETY: this vector and the next one exist, and four numbers are loaded, which need no alignment.
            unsafe { _mm256_loadu_pd(from.as_ptr().add(number as usize).cast()) }
        };
        for begin in (0..BLOCK).step_by(4) {
            let [a, b, c, d] = [0, 1, 2, 3].map(|k| load(numbers[begin + k]));
            // SAFETY: a block has four numbers from there on, which need no alignment.
            let factor = unsafe { _mm256_loadu_pd(factors.as_ptr().add(begin)) };
            // x and z of pairs, and y; then of all four.
            let (xz, xz_last) = (_mm256_unpacklo_pd(a, b), _mm256_unpacklo_pd(c, d));
            let (y_first, y_last) = (_mm256_unpackhi_pd(a, b), _mm256_unpackhi_pd(c, d));
            let all = [
                _mm256_permute2f128_pd::<0x20>(xz, xz_last),
                _mm256_permute2f128_pd::<0x20>(y_first, y_last),
                _mm256_permute2f128_pd::<0x31>(xz, xz_last),
            ];
            for (to, all) in [&mut *x, &mut *y, &mut *z].into_iter().zip(all) {
                // SAFETY: as above.
                unsafe { _mm256_storeu_pd(to.as_mut_ptr().add(begin), _mm256_mul_pd(all, factor)) };
            }
        }
    }

    /// Processes a column of the matrix as a vector.
    #[target_feature(enable = "avx2")]
    pub fn shift_each(
        matrices: &[ShiftMatrix],
        (at, rests): (&[u64; BLOCK], &Block),
        (factors, gain): (&[f64], f64),
        rgb: &mut [[f64; 3]],
    ) {
        use std::arch::x86_64::{
            _mm_loadu_ps, _mm256_add_pd, _mm256_cvtps_pd, _mm256_mul_pd, _mm256_set1_pd,
            _mm256_storeu_pd,
        };
        let places = at.iter().zip(rests);
        for ((rgb, factor), (at, rest)) in rgb.iter_mut().zip(factors).zip(places) {
            let Some(matrix) = ShiftMatrix::of(matrices, *at) else {
                continue;
            };
            let [a, b, c] = &matrix.columns;
            let rest = _mm256_set1_pd(*rest);
            let times = |column: &[f32; 8], x: f64| {
                let column = column.as_ptr();
                // SAFETY: a column has twice as many numbers as are loaded, which needs no alignment.
                let (below, growth) =
                    unsafe { (_mm_loadu_ps(column), _mm_loadu_ps(column.add(4))) };
                // In the order of `ShiftMatrix::times`, with nothing fused: the same bits.
                let growth = _mm256_mul_pd(_mm256_cvtps_pd(growth), rest);
                let between = _mm256_add_pd(_mm256_cvtps_pd(below), growth);
                _mm256_mul_pd(between, _mm256_set1_pd(x))
            };
            let [x, y, z] = *rgb;
            let sum = _mm256_add_pd(_mm256_add_pd(times(a, x), times(b, y)), times(c, z));
            let mut seen = [0.0; 4];
            // SAFETY: the array has as many numbers as are stored, which needs no alignment.
            unsafe {
                _mm256_storeu_pd(
                    seen.as_mut_ptr(),
                    _mm256_mul_pd(sum, _mm256_set1_pd(factor * gain)),
                );
            }
            *rgb = [seen[0], seen[1], seen[2]];
        }
    }

    /// Loads eight rows at a time, and transposes them in registers.
    #[target_feature(enable = "avx2")]
    pub fn gather_rows(rows: &[[u32; 8]], numbers: &[u32; BLOCK], to: &mut [[u32; BLOCK]; 8]) {
        use std::arch::x86_64::{
            __m256, __m256i, _mm256_castps_si256, _mm256_castsi256_ps, _mm256_loadu_si256,
            _mm256_permute2f128_ps, _mm256_shuffle_ps, _mm256_storeu_si256, _mm256_unpackhi_ps,
            _mm256_unpacklo_ps,
        };
        let load = |number: u32| -> __m256 {
            let row: *const __m256i = row(rows, number).as_ptr().cast();
            // SAFETY: a row has as many words as are loaded, which needs no alignment.
            _mm256_castsi256_ps(unsafe { _mm256_loadu_si256(row) })
        };
        for (group, numbers) in numbers.chunks_exact(8).enumerate() {
            let r = [
                load(numbers[0]),
                load(numbers[1]),
                load(numbers[2]),
                load(numbers[3]),
                load(numbers[4]),
                load(numbers[5]),
                load(numbers[6]),
                load(numbers[7]),
            ];
            // Words 0 1 4 5 and 2 3 6 7 of pairs, then of fours, then of all.
            let p = [
                _mm256_unpacklo_ps(r[0], r[1]),
                _mm256_unpackhi_ps(r[0], r[1]),
                _mm256_unpacklo_ps(r[2], r[3]),
                _mm256_unpackhi_ps(r[2], r[3]),
                _mm256_unpacklo_ps(r[4], r[5]),
                _mm256_unpackhi_ps(r[4], r[5]),
                _mm256_unpacklo_ps(r[6], r[7]),
                _mm256_unpackhi_ps(r[6], r[7]),
            ];
            let f = [
                _mm256_shuffle_ps::<0x44>(p[0], p[2]),
                _mm256_shuffle_ps::<0xee>(p[0], p[2]),
                _mm256_shuffle_ps::<0x44>(p[1], p[3]),
                _mm256_shuffle_ps::<0xee>(p[1], p[3]),
                _mm256_shuffle_ps::<0x44>(p[4], p[6]),
                _mm256_shuffle_ps::<0xee>(p[4], p[6]),
                _mm256_shuffle_ps::<0x44>(p[5], p[7]),
                _mm256_shuffle_ps::<0xee>(p[5], p[7]),
            ];
            let words = [
                _mm256_permute2f128_ps::<0x20>(f[0], f[4]),
                _mm256_permute2f128_ps::<0x20>(f[1], f[5]),
                _mm256_permute2f128_ps::<0x20>(f[2], f[6]),
                _mm256_permute2f128_ps::<0x20>(f[3], f[7]),
                _mm256_permute2f128_ps::<0x31>(f[0], f[4]),
                _mm256_permute2f128_ps::<0x31>(f[1], f[5]),
                _mm256_permute2f128_ps::<0x31>(f[2], f[6]),
                _mm256_permute2f128_ps::<0x31>(f[3], f[7]),
            ];
            for (to, words) in to.iter_mut().zip(words) {
                let to: *mut __m256i = to[group * 8..][..8].as_mut_ptr().cast();
                // SAFETY: the slice has as many words as are stored, which needs no alignment.
                unsafe { _mm256_storeu_si256(to, _mm256_castps_si256(words)) };
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Directions<'a>(&'a [f64], &'a mut [f64]);

    impl VectorLoop for Directions<'_> {
        #[inline(always)]
        fn run(self) {
            for (x, y) in self.0.iter().zip(self.1) {
                *y = (x * 1.7 + 0.3) / (x * x + 0.1).sqrt();
            }
        }
    }

    #[test]
    fn vectors_in_a_row_are_taken_apart_in_order_and_whatever_was_there_is_gone() {
        let row = |n: usize| -> Vec<DVec3> {
            let v = |k| DVec3::new(k as f64, 0.5 + k as f64, -(k as f64));
            (0..n).map(v).collect()
        };
        let mut columns = Columns::default();
        for count in [3 * BLOCK + 7, BLOCK, 5, 0] {
            let row = row(count);
            columns.take(&row);
            assert_eq!(columns.len(), count);
            let taken: Vec<_> = (0..count).map(|k| columns.get(k)).collect();
            assert_eq!(taken, row);
        }
    }

    #[test]
    fn rows_are_gathered_word_by_word_and_those_that_are_not_there_are_zeros() {
        // Including words that are NaN as f32.
        let word = |row: u32, k: u32| (row * 8 + k).wrapping_mul(0x9e37_79b9) | 0x7f80_0001;
        let rows: Vec<[u32; 8]> = (0..100)
            .map(|row| std::array::from_fn(|k| word(row, k as u32)))
            .collect();
        let numbers: [u32; BLOCK] = std::array::from_fn(|k| match k % 9 {
            4 => NO_ROW,
            7 => 100,
            _ => (k * 37 % 100) as u32,
        });
        let (mut wide, mut narrow) = ([[1; BLOCK]; 8], [[2; BLOCK]; 8]);
        gather_rows(&rows, &numbers, &mut wide);
        gather_rows_singly(&rows, &numbers, &mut narrow);
        assert_eq!(wide, narrow);
        for (k, number) in numbers.into_iter().enumerate() {
            for (at, column) in wide.iter().enumerate() {
                let is_there = number < 100;
                let expected = if is_there { word(number, at as u32) } else { 0 };
                assert_eq!(column[k], expected);
            }
        }
    }

    #[test]
    fn vectors_are_gathered_axis_by_axis_and_those_that_are_not_there_are_zeros() {
        let vectors: Vec<DVec3> = (0..100)
            .map(|k| DVec3::new(f64::from(k), 0.5 + f64::from(k), -f64::from(k)))
            .collect();
        let factors: Block = std::array::from_fn(|k| if k % 3 == 0 { -1.0 } else { 0.5 });
        // All before the last one; including the last one; and some out of range.
        for end in [99, 100, 103] {
            let numbers: [u32; BLOCK] = std::array::from_fn(|k| (end - 1 - k * 37 % end) as u32);
            assert!(numbers.contains(&(end as u32 - 1)));
            let all = |gather: fn(&[DVec3], &[u32; BLOCK], &Block, [&mut Block; 3])| {
                let mut all = [[7.0; BLOCK]; 3];
                gather(&vectors, &numbers, &factors, all.each_mut());
                all
            };
            let (wide, narrow) = (all(gather_vectors), all(gather_vectors_singly));
            assert_eq!(wide, narrow);
            for (k, number) in numbers.into_iter().enumerate() {
                let v = vectors.get(number as usize).copied().unwrap_or_default();
                assert_eq!(wide.map(|axis| axis[k]), (v * factors[k]).to_array());
            }
        }
    }

    #[test]
    fn colours_are_shifted_alike_in_vectors_and_one_by_one() {
        let number = |n: usize| ((n * 7919) % 1009) as f32 / 1009.0 - 0.3;
        let matrices: Vec<ShiftMatrix> = (0..20)
            .map(|n| ShiftMatrix {
                columns: [0, 1, 2].map(|c| std::array::from_fn(|k| number(n * 24 + c * 8 + k))),
            })
            .collect();
        // Some of the matrices do not exist.
        let at: [u64; BLOCK] = std::array::from_fn(|k| match k % 7 {
            3 => u64::MAX - k as u64,
            5 => 20,
            _ => k as u64 % 20,
        });
        let rests: Block = std::array::from_fn(|k| k as f64 / 64.0);
        let factors: Vec<f64> = (0..50).map(|k| 0.5 + f64::from(k)).collect();
        let start: Vec<[f64; 3]> = (0..50)
            .map(|k| [f64::from(k), 1.0 / f64::from(k + 1), -2.5])
            .collect();
        let (mut wide, mut narrow) = (start.clone(), start.clone());
        shift_each(&matrices, (&at, &rests), (&factors, 0.75), &mut wide);
        shift_singly(&matrices, (&at, &rests), (&factors, 0.75), &mut narrow);
        assert_eq!(wide, narrow);
        for (k, seen) in wide.iter().enumerate() {
            let (at, rest) = (at[k], rests[k]);
            let expected = match at < 20 {
                false => start[k],
                true => [0, 1, 2].map(|row| {
                    let column = |c: usize| matrices[at as usize].columns[c];
                    let between =
                        |c| f64::from(column(c)[row]) + f64::from(column(c)[row + 4]) * rest;
                    (0..3).map(|c| between(c) * start[k][c]).sum::<f64>() * factors[k] * 0.75
                }),
            };
            for (seen, expected) in seen.iter().zip(expected) {
                let error = (seen - expected).abs();
                assert!(error < 1e-12 * (1.0 + expected.abs()), "{k}: {error:e}");
            }
        }
    }

    #[test]
    fn every_width_of_vectors_gives_the_same_bits() {
        let x: Vec<f64> = (0..1003).map(|i| libm::exp(f64::from(i) * 0.01)).collect();
        let (mut narrow, mut wide) = (vec![0.0; x.len()], vec![0.0; x.len()]);
        Directions(&x, &mut narrow).run();
        dispatch(Directions(&x, &mut wide));
        assert_eq!(narrow, wide);
        #[cfg(target_arch = "x86_64")]
        if x86::has_avx2() {
            let mut middle = vec![0.0; x.len()];
            // SAFETY: the processor has these instructions.
            unsafe { x86::avx2(Directions(&x, &mut middle)) };
            assert_eq!(narrow, middle);
        }
    }
}
