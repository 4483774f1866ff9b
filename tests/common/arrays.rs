//! Arrays of .npz files as numbers.

use std::path::Path;

use nullray::io::cube::{self, CubeSamples, Wanted};

/// All numbers of an array of an .npz file.
pub fn array_at(path: &Path, name: &str) -> Vec<f64> {
    match cube::load(path, Wanted::array(name)).unwrap().samples {
        CubeSamples::F16(v) => v.iter().map(|x| x.to_f64()).collect(),
        CubeSamples::F32(v) => v.iter().map(|x| f64::from(*x)).collect(),
        CubeSamples::F64(v) => v,
    }
}
