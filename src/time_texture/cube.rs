//! A cube of samples as it stood in the file: shape (H, W, T, C), C order, one copy in memory.

/// Samples in their stored precision.
#[derive(Debug, Clone, PartialEq)]
pub enum Samples {
    /// IEEE half precision.
    F16(Vec<half::f16>),
    /// Single precision.
    F32(Vec<f32>),
    /// Double precision.
    F64(Vec<f64>),
}

/// A cube of finite samples, shape (H, W, T, C), C order; row 0 is the top row.
#[derive(Debug, Clone, PartialEq)]
pub struct Cube {
    /// H, W, T, C; each at least 1.
    pub shape: [usize; 4],
    /// H·W·T·C samples.
    pub samples: Samples,
}
