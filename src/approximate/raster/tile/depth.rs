//! The depth test: the nearest triangle so far for each sample of a strip.
//!
//! 1/z is compared in f32, where its error is at most a triangle's slack (`setup`). Depths that differ by no more than the slack of
//! either triangle are compared in f64.

use super::setup::{Functions, SIDE};

/// No triangle.
pub const NOTHING: u32 = u32::MAX;
/// The number of samples that loops process together: eight f32 fill an AVX2 vector.
pub(super) const LANES: usize = 8;
/// The samples of a pixel fill whole blocks if their number is a multiple of this.
pub const WHOLE: usize = LANES;
/// Blocks of the samples of a strip: as many as a tile has pixels.
pub(super) const BLOCKS: usize = SIDE * SIDE / LANES;
/// The maximum number of samples of a pixel that a strip can hold; a strip is at least one row of pixels.
pub const MOST_TOGETHER: u32 = SIDE as u32;

/// Consecutive values for samples, pixel by pixel.
pub(super) type Block<T> = [T; LANES];

/// The samples of a strip.
#[derive(Debug)]
pub(super) struct Samples {
    /// Their positions relative to the tile's corner, pixels; NaN after the last.
    pub x: [Block<f32>; BLOCKS],
    pub y: [Block<f32>; BLOCKS],
    /// Bounds on 1/z of the nearest triangle so far.
    pub least: [Block<f32>; BLOCKS],
    pub most: [Block<f32>; BLOCKS],
    /// Index of its triangle.
    pub nearest: [Block<u32>; BLOCKS],
}

impl Samples {
    /// No samples.
    pub const NONE: Samples = Samples {
        x: [[f32::NAN; LANES]; BLOCKS],
        y: [[f32::NAN; LANES]; BLOCKS],
        least: [[0.0; LANES]; BLOCKS],
        most: [[0.0; LANES]; BLOCKS],
        nearest: [[NOTHING; LANES]; BLOCKS],
    };

    /// Sets the points of all samples, none of which sees anything yet.
    #[inline(always)]
    pub fn start(&mut self, x: &[f64], y: &[f64]) {
        let count = x.len().min(y.len()).min(BLOCKS * LANES);
        let blocks = count.div_ceil(LANES);
        // NaN is inside no triangle: lanes beyond the last sample see none.
        self.x[..blocks].fill([f32::NAN; LANES]);
        self.y[..blocks].fill([f32::NAN; LANES]);
        self.least[..blocks].fill([0.0; LANES]);
        self.most[..blocks].fill([0.0; LANES]);
        self.nearest[..blocks].fill([NOTHING; LANES]);
        let (to_x, to_y) = (self.x.as_flattened_mut(), self.y.as_flattened_mut());
        for (to, from) in to_x[..count].iter_mut().zip(&x[..count]) {
            *to = *from as f32;
        }
        for (to, from) in to_y[..count].iter_mut().zip(&y[..count]) {
            *to = *from as f32;
        }
    }
}

/// Replaces what is behind a triangle in a block. Returns whether two depths are too close to decide here.
#[inline(always)]
pub(super) fn cover_block(of: &Functions, index: u32, samples: &mut Samples, block: usize) -> bool {
    let [a, b, c] = of.edges;
    let [dx, dy, dz] = of.depth;
    let (x, y) = (&samples.x[block], &samples.y[block]);
    // Read before the branch and written as a whole after it: otherwise the compiler would make masked writes of it, which are slow, and so
    // are the reads after them.
    let (known_least, known_most) = (samples.least[block], samples.most[block]);
    let known = samples.nearest[block];
    let (mut any, mut is_inside, mut depths) = (0, [0u32; LANES], [0.0; LANES]);
    for i in 0..LANES {
        let ea = a[0] * x[i] + a[1] * y[i] + a[2];
        let eb = b[0] * x[i] + b[1] * y[i] + b[2];
        let ec = c[0] * x[i] + c[1] * y[i] + c[2];
        let near = dx * x[i] + dy * y[i] + dz;
        let inside = (ea >= 0.0) & (eb >= 0.0) & (ec >= 0.0);
        (is_inside[i], depths[i]) = (u32::from(inside), near);
        any |= u32::from(inside & (near + of.slack >= known_least[i]) & (known[i] != index));
    }
    // Few of the blocks that a small triangle may reach contain samples inside it, and not behind what is seen there.
    if any == 0 {
        return false;
    }
    let (mut least, mut most, mut nearest) = ([0.0; LANES], [0.0; LANES], [0; LANES]);
    let mut close = 0;
    for i in 0..LANES {
        let (inside, near) = (is_inside[i] != 0, depths[i]);
        let (low, high) = (near - of.slack, near + of.slack);
        let seen = inside & (low > known_most[i]);
        close |= u32::from(inside & (low <= known_most[i]) & (high >= known_least[i]));
        least[i] = if seen { low } else { known_least[i] };
        // What is seen is nearer than all before it, so that the larger bound is its own.
        let own = if seen { high } else { 0.0 };
        most[i] = if own > known_most[i] {
            own
        } else {
            known_most[i]
        };
        nearest[i] = if seen { index } else { known[i] };
    }
    samples.least[block] = least;
    samples.most[block] = most;
    samples.nearest[block] = nearest;
    close != 0
}

/// Decides in f64 what [`cover_block`] could not.
#[cold]
pub(super) fn resolve(functions: &[Functions], index: u32, samples: &mut Samples, block: usize) {
    let of = &functions[index as usize];
    for i in 0..LANES {
        let (x, y) = (samples.x[block][i], samples.y[block][i]);
        let at = |[a, b, c]: [f32; 3]| a * x + b * y + c;
        let (low, high) = (at(of.depth) - of.slack, at(of.depth) + of.slack);
        let (least, most) = (&mut samples.least[block][i], &mut samples.most[block][i]);
        let nearest = &mut samples.nearest[block][i];
        let is_inside = of.edges.iter().all(|edge| at(*edge) >= 0.0);
        let is_close = low <= *most && high >= *least;
        if !is_inside || !is_close || *nearest == index {
            continue;
        }
        let exactly = |index: u32| {
            let [a, b, c] = functions.get(index as usize).map_or([0.0; 3], |f| f.exact);
            a * f64::from(x) + b * f64::from(y) + c
        };
        // Among equals the first stays.
        if exactly(index) > exactly(*nearest) {
            (*least, *most, *nearest) = (low, high, index);
        }
    }
}
