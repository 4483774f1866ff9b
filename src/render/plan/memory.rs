//! How much memory a plan takes.

use super::planned::{Memory, PlannedCube, PlannedFrame, PlannedObject};
use crate::accel::Bvh;
use crate::light::time_texture::Capture;
use crate::render::film::Layout;

/// Bytes per triangle while a BVH is built, beside what stays. Measured: 206.
const BUILDING: u64 = 220;

/// What writing takes, in tenths of the film: channels, their single-precision copy, the
/// compressed file. Measured: 1.6 for EXR, 1.1 for npz.
const WRITING_TENTHS: u64 = 17;

/// What the parts of a plan take.
pub(super) fn memory(
    frames: &[PlannedFrame],
    objects: &[PlannedObject],
    cubes: &[Option<PlannedCube>],
    layout: &Layout,
    beside: u64,
) -> Memory {
    let bvhs = frames
        .iter()
        .map(|f| Bvh::estimate_bytes(f.triangles as usize) as u64)
        .sum::<u64>();
    let uvs = objects
        .iter()
        .filter(|o| o.uvs)
        // All sets of the file, and one more where a texture transform makes one.
        .map(|o| 12 * o.triangles + 8 * o.vertices * (o.uv_sets as u64 + 1))
        .sum::<u64>();
    let cubes = cubes.iter().flatten();
    let captures = cubes
        .clone()
        .map(|c| c.capture_rays * Capture::BYTES_PER_PIXEL);
    // One array that several sources use is loaded once; those in memory are there already.
    let mut files: Vec<_> = cubes
        .clone()
        .filter(|c| c.file.is_some())
        .map(|c| (&c.file, &c.array, c.bytes))
        .collect();
    files.sort();
    files.dedup();
    Memory {
        geometry: bvhs + uvs,
        cubes: files.iter().map(|f| f.2).sum::<u64>() + captures.sum::<u64>(),
        film: layout.bytes(),
        temporary: temporary(frames, layout),
        beside,
    }
}

/// The larger of what building and writing take: they do not happen at once.
fn temporary(frames: &[PlannedFrame], layout: &Layout) -> u64 {
    let largest = frames.iter().map(|f| f.triangles).max().unwrap_or(0);
    let building = largest.saturating_mul(BUILDING);
    building.max(layout.bytes() / 10 * WRITING_TENTHS)
}
