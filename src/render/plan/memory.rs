//! The memory that a plan needs.

use glam::DVec3;

use super::planned::{Memory, PlannedCube, PlannedFrame, PlannedObject, Request};
use crate::accel::Bvh;
use crate::io::cube::{BRICK, LEAST_ROOM};
use crate::io::image::panorama;
use crate::light::sky::{LightGrid, Panorama};
use crate::light::time_texture::Capture;
use crate::render::film::Layout;
use crate::scene::model::{self, Scene};

/// Bytes per triangle while a BVH is built, in addition to what is kept. Measured with 1.6 million triangles: 35.
const BUILDING: u64 = 100;

/// Once this many triangles are gathered, their trees are built, those of several frames in parallel.
pub(crate) const BUILT_TOGETHER: u64 = 1 << 18;

/// The memory for writing, in tenths of the film: channels, their single-precision copy, the compressed file. Measured: 1.6 for EXR, 1.1
/// for npz.
const WRITING_TENTHS: u64 = 17;

/// The memory of the program itself, bytes: pages of its code, stacks, allocator overhead. Measured: 33 MiB with two threads, and two
/// thirds of the room not given to bricks are not resident.
const PROGRAM: u64 = 64 << 20;

/// The most that is kept of a cube that is read in parts: more than neighbouring tiles share.
const MOST_HELD: u64 = 1 << 30;

/// Switches cubes to reading in parts, the largest first, until what is loaded fits into `limit`. They share the remainder.
pub(super) fn read_in_parts(
    cubes: &mut [Option<PlannedCube>],
    limit: u64,
    memory: &dyn Fn(&[Option<PlannedCube>]) -> Memory,
) {
    loop {
        let total = memory(cubes).total();
        if total <= limit {
            break;
        }
        let whole = cubes.iter().flatten().filter(|c| c.held.is_none());
        let largest = whole.filter(|c| c.file.is_some()).max_by_key(|c| c.bytes);
        // At most its full size can be saved.
        let Some(largest) = largest.filter(|c| c.bytes > 2 * LEAST_ROOM) else {
            return;
        };
        let (file, array) = (largest.file.clone(), largest.array.clone());
        let same = |cube: &&mut PlannedCube| cube.file == file && cube.array == array;
        for cube in cubes.iter_mut().flatten().filter(same) {
            cube.held = Some(LEAST_ROOM);
        }
    }
    let in_parts = cubes.iter().flatten().filter(|c| c.held.is_some()).count() as u64;
    // Resident memory should stay within the limit, as far as that leaves room.
    let planned = memory(cubes);
    let left = limit - planned.total();
    let left = left - PROGRAM.saturating_sub(planned.program).min(left / 4);
    let Some(each) = left.checked_div(in_parts) else {
        return;
    };
    for cube in cubes.iter_mut().flatten() {
        // All of it, the overhead of bricks beside their samples, and those in use by threads.
        let most = (2 * cube.bytes).min(MOST_HELD);
        cube.held = cube.held.map(|least| (least + each).min(most));
    }
}

/// The memory of the parts of a plan, with or without `normals` of triangles.
pub(super) fn memory(
    scene: &Scene,
    frames: &[PlannedFrame],
    normals: bool,
    objects: &[PlannedObject],
    cubes: &[Option<PlannedCube>],
    layout: &Layout,
    request: &Request,
) -> Memory {
    let bvhs = frames
        .iter()
        .map(|f| Bvh::estimate_bytes(f.triangles as usize) as u64)
        .sum::<u64>();
    let normals = match normals {
        true => frames.iter().map(|f| f.triangles).sum::<u64>() * size_of::<DVec3>() as u64,
        false => 0,
    };
    // Three indices per triangle, and two f32 per vertex and set.
    let uvs = objects
        .iter()
        .filter(|o| o.uvs)
        // All sets of the file, and one more if a texture transform makes one.
        .map(|o| 12 * o.triangles + 8 * o.vertices * (o.uv_sets as u64 + 1))
        .sum::<u64>();
    // Triangles are already counted with texture coordinates.
    let vertex_normals = objects
        .iter()
        .filter(|o| o.normals)
        .map(|o| 12 * o.vertices + if o.uvs { 0 } else { 12 * o.triangles })
        .sum::<u64>();
    let cubes = cubes.iter().flatten();
    // A cube with named channels is loaded as it is, and then split into a cube of colours and one for each companion.
    let splitting = cubes
        .clone()
        .filter(|c| c.channels.is_some() && c.held.is_none());
    let splitting = splitting.map(|c| c.bytes).max().unwrap_or(0);
    let captures = cubes.clone().map(|c| {
        c.capture_rays * Capture::BYTES_PER_PIXEL + if c.held.is_some() { 0 } else { c.sums }
    });
    // An array that several sources use is loaded once; those in memory already exist.
    let mut files: Vec<_> = cubes
        .clone()
        .filter(|c| c.file.is_some())
        .map(|c| {
            (
                &c.file,
                &c.array,
                c.held.map_or(c.bytes, |held| held + tables(c.bytes)),
            )
        })
        .collect();
    files.sort();
    files.dedup();
    let [sky, reading] = sky(scene);
    let placing = objects.iter().map(|o| o.placing).max().unwrap_or(0);
    Memory {
        geometry: bvhs + normals + uvs + vertex_normals,
        cubes: files.iter().map(|f| f.2).sum::<u64>() + captures.sum::<u64>(),
        sky,
        film: layout.bytes(),
        temporary: (temporary(frames, layout).max(splitting))
            .max(reading)
            .max(placing),
        beside: request.beside,
        program: request.program,
    }
}

/// The memory of the sky's picture, and the additional memory for reading it.
fn sky(scene: &Scene) -> [u64; 2] {
    let head = scene.sky.as_ref().and_then(model::Sky::picture);
    match head.and_then(|path| panorama::head(path)) {
        // Pictures of other shapes are refused before anything is made of them.
        Some(head) if head.width == 2 * head.height => {
            let lights = scene.sky.as_ref().is_some_and(|sky| sky.lights);
            let grid = if lights {
                LightGrid::bytes(head.width)
            } else {
                0
            };
            [Panorama::bytes(head.width) + grid, head.reading]
        }
        _ => [0; 2],
    }
}

/// Tables of the bricks of a cube of `bytes`: a bit for each, if samples take at least two bytes more than in the file.
fn tables(bytes: u64) -> u64 {
    bytes / BRICK + (1 << 16)
}

/// The larger of the memory for building and for writing, which do not happen at once.
fn temporary(frames: &[PlannedFrame], layout: &Layout) -> u64 {
    let largest = frames.iter().map(|f| f.triangles).max().unwrap_or(0);
    // Trees are built in parallel from what was gathered, until the last frame makes it enough.
    let all = frames
        .iter()
        .fold(0u64, |all, f| all.saturating_add(f.triangles));
    let together = all.min(largest.saturating_add(BUILT_TOGETHER));
    let building = together.saturating_mul(BUILDING);
    building.max(layout.bytes() / 10 * WRITING_TENTHS)
}
