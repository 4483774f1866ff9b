//! Meshes: every `*.tri` (little-endian f32, nine per triangle) of the folder `NULLRAY_BENCH_MESHES`,
//! or generated ones.

use std::fs;
use std::path::{Path, PathBuf};

use glam::{DVec3, Vec3Swizzles};

use super::grid;

/// A name and triangles.
pub type Mesh = (String, Vec<[DVec3; 3]>);

/// The meshes to measure; generated ones have 6 · `detail`²/2 triangles or so.
pub fn meshes(smoke: bool, detail: usize) -> Vec<Mesh> {
    let folder = std::env::var_os("NULLRAY_BENCH_MESHES").filter(|_| !smoke);
    match folder {
        Some(folder) => read_meshes(Path::new(&folder)),
        None => generated_meshes(detail),
    }
}

/// Every `*.tri` of `folder`.
fn read_meshes(folder: &Path) -> Vec<Mesh> {
    let files = fs::read_dir(folder).expect("NULLRAY_BENCH_MESHES is a folder");
    let mut paths: Vec<PathBuf> = files.flatten().map(|f| f.path()).collect();
    paths.retain(|p| p.extension().is_some_and(|e| e == "tri"));
    paths.sort();
    paths.iter().map(|p| read_mesh(p)).collect()
}

fn read_mesh(path: &Path) -> Mesh {
    let bytes = fs::read(path).expect("a mesh");
    let number = |b: &[u8]| f32::from_le_bytes([b[0], b[1], b[2], b[3]]) as f64;
    let numbers: Vec<f64> = bytes.chunks_exact(4).map(number).collect();
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    let triangles = numbers
        .chunks_exact(9)
        .map(|n| [0, 3, 6].map(|i| DVec3::from_slice(&n[i..])));
    (name.into_owned(), triangles.collect())
}

fn generated_meshes(detail: usize) -> Vec<Mesh> {
    vec![
        ("sphere".into(), sphere(detail)),
        ("heightfield".into(), heightfield(detail)),
        ("room".into(), room(detail * detail / 2)),
    ]
}

/// A patch of `n` × `n` quads of the surface p(u, v), u and v in [0, 1].
fn patch(n: usize, point: impl Fn(f64, f64) -> DVec3) -> Vec<[DVec3; 3]> {
    let at = |y: usize, x: usize| point(x as f64 / n as f64, y as f64 / n as f64);
    let quad = |(y, x)| {
        let [a, b, c, d] = [at(y, x), at(y, x + 1), at(y + 1, x + 1), at(y + 1, x)];
        [[a, b, c], [a, c, d]]
    };
    grid(n).flat_map(quad).collect()
}

/// A unit sphere: the faces of a cube, blown up; 3 · `detail`² triangles.
pub fn sphere(detail: usize) -> Vec<[DVec3; 3]> {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let face = |i: usize, side: f64| {
        let (n, a, b) = (axes[i % 3], axes[(i + 1) % 3], axes[(i + 2) % 3]);
        let point = move |u: f64, v: f64| {
            (n * side + a * (2.0 * u - 1.0) + b * (2.0 * v - 1.0)).normalize()
        };
        patch(detail / 2, point)
    };
    (0..3)
        .flat_map(|i| [face(i, 1.0), face(i, -1.0)].concat())
        .collect()
}

/// Noise over the x-y plane, seen from above.
fn heightfield(detail: usize) -> Vec<[DVec3; 3]> {
    let mut random = random_numbers();
    let bumps: Vec<[f64; 4]> = (0..24).map(|_| [0; 4].map(|_| random())).collect();
    let height = move |u: f64, v: f64| -> f64 {
        let bump = |b: &[f64; 4]| 0.02 * libm::sin(40.0 * (b[0] * u + b[1] * v) + 6.3 * b[2]);
        bumps.iter().map(bump).sum()
    };
    patch(detail, |u, v| DVec3::new(u - 0.5, v - 0.5, height(u, v)))
}

/// Small triangles all over the inside of a cube, and its six walls.
fn room(count: usize) -> Vec<[DVec3; 3]> {
    let mut random = random_numbers();
    let mut point = |size: f64| DVec3::from([0; 3].map(|_| (2.0 * random() - 1.0) * size));
    let mut triangles: Vec<[DVec3; 3]> = (0..count)
        .map(|_| (point(1.0), point(0.02), point(0.02)))
        .map(|(c, a, b)| [c, c + a, c + b])
        .collect();
    for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
        let (a, b) = (axis.zxy(), axis.yzx());
        for side in [axis, -axis] {
            triangles.extend(patch(4, |u, v| {
                side + a * (2.0 * u - 1.0) + b * (2.0 * v - 1.0)
            }));
        }
    }
    triangles
}

/// SplitMix64, as numbers in [0, 1).
fn random_numbers() -> impl FnMut() -> f64 {
    let mut state = 1u64;
    move || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
}
