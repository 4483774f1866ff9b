//! Coherent primary rays: this crate's certified closest hits against obvhs' own f32 traversal.
//!
//! Both are measured in turn, one thread, best of several rounds; one line per case is printed and
//! written as JSON to `target/bench/visibility.jsonl`. Meshes: every `*.tri` (little-endian f32, nine
//! per triangle) of the folder `NULLRAY_BENCH_MESHES`, else generated ones. `--smoke`,
//! `NULLRAY_BENCH_SMOKE=1` and `cargo test --benches` use tiny sizes.
//!
//! Camera, with c the centre of the mesh's bounding box and R half its diagonal: pixel-centre rays
//! along −z, "outside" from c + (0, 0, 2.2 R) with half-width 0.5 of the image plane at distance
//! 1, "inside" from c + (0, 0, 0.3 R) with half-width 0.7.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use glam::{DVec3, Vec3A, Vec3Swizzles};
use nullray::accel::{Bvh, Facing, Hit, Ray};
use obvhs::BvhBuildParams;
use obvhs::bvh2::{Bvh2, builder::build_bvh2_from_tris};
use obvhs::ray::{Ray as PeerRay, RayHit};
use obvhs::triangle::Triangle;

/// Rays per batch: a tile of 8 × 8 pixels.
const TILE: usize = 8;

type Mesh = (String, Vec<[DVec3; 3]>);

struct Size {
    image: usize,
    rounds: usize,
    detail: usize,
}

fn main() {
    // `cargo bench` passes --bench, `cargo test --benches` doesn't.
    let arguments: Vec<String> = std::env::args().collect();
    let has = |flag: &str| arguments.iter().any(|a| a == flag);
    let smoke =
        has("--smoke") || !has("--bench") || std::env::var_os("NULLRAY_BENCH_SMOKE").is_some();
    let size = if smoke {
        Size {
            image: 64,
            rounds: 1,
            detail: 16,
        }
    } else {
        Size {
            image: 1024,
            rounds: 7,
            detail: 256,
        }
    };
    let mut report = report_file();
    let meshes = std::env::var_os("NULLRAY_BENCH_MESHES").filter(|_| !smoke);
    let meshes = match meshes {
        Some(folder) => read_meshes(Path::new(&folder)),
        None => generated_meshes(size.detail),
    };
    for (name, triangles) in meshes {
        measure_mesh(&name, triangles, &size, &mut report);
    }
}

fn report_file() -> fs::File {
    let target = std::env::var_os("CARGO_TARGET_DIR").map(PathBuf::from);
    let target = target.unwrap_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("target"));
    let folder = target.join("bench");
    fs::create_dir_all(&folder).expect("target/bench");
    fs::File::create(folder.join("visibility.jsonl")).expect("report")
}

fn measure_mesh(name: &str, triangles: Vec<[DVec3; 3]>, size: &Size, report: &mut fs::File) {
    let count = triangles.len();
    let peer = Peer::build(&triangles);
    let begin = Instant::now();
    let bvh = Bvh::build(triangles, |_| Facing::TwoSided);
    let build = begin.elapsed();
    let bytes = bvh.bytes() as f64 / count as f64;
    println!(
        "{name}: {count} triangles, {bytes:.1} bytes each, built in {build:.2?} (obvhs alone {:.2?})",
        peer.build
    );
    for (place, distance, half_width) in [("outside", 2.2, 0.5), ("inside", 0.3, 0.7)] {
        let camera = Camera::new(&bvh, distance, half_width, size.image);
        let case = format!("{name}/{place}");
        let result = measure(&bvh, &peer, &camera, size.rounds);
        println!("  {case}: {result}");
        let line = serde_json::json!({
            "case": case, "precision": "certified", "kernel": "scalar", "threads": 1,
            "triangles": count, "rays": camera.rays(), "hits": result.hits,
            "mrays_per_s": result.batch, "single_mrays_per_s": result.single,
            "any_mrays_per_s": result.any,
            "obvhs_mrays_per_s": result.peer, "obvhs_hits": result.peer_hits,
            "bytes_per_triangle": bytes, "build_s": build.as_secs_f64(),
        });
        writeln!(report, "{line}").expect("report");
    }
}

struct Rates {
    batch: f64,
    single: f64,
    any: f64,
    peer: f64,
    hits: usize,
    peer_hits: usize,
}

impl std::fmt::Display for Rates {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "{:.2} Mrays/s (single {:.2}, any {:.2}), obvhs {:.2}, ratio {:.2}, hits {} (obvhs {})",
            self.batch,
            self.single,
            self.any,
            self.peer,
            self.batch / self.peer,
            self.hits,
            self.peer_hits
        )
    }
}

fn measure(bvh: &Bvh, peer: &Peer, camera: &Camera, rounds: usize) -> Rates {
    let mut best = [Duration::MAX; 4];
    let mut hits = [0; 4];
    for _ in 0..rounds {
        let kinds: [&dyn Fn() -> usize; 4] = [
            &|| trace_batches(bvh, camera),
            &|| trace_singles(bvh, camera),
            &|| trace_any(bvh, camera),
            &|| peer.trace(camera),
        ];
        for (i, kind) in kinds.iter().enumerate() {
            let begin = Instant::now();
            hits[i] = kind();
            best[i] = best[i].min(begin.elapsed());
        }
    }
    assert_eq!(hits[0], hits[1], "single rays and batches agree");
    assert_eq!(hits[0], hits[2], "closest and any hits agree");
    let [batch, single, any, peer] = best.map(|t| camera.rays() as f64 / t.as_secs_f64() / 1e6);
    Rates {
        batch,
        single,
        any,
        peer,
        hits: hits[0],
        peer_hits: hits[3],
    }
}

fn trace_batches(bvh: &Bvh, camera: &Camera) -> usize {
    let mut hits: [Option<Hit>; TILE * TILE];
    let mut count = 0;
    for tile in camera.directions.chunks(TILE * TILE) {
        hits = [None; TILE * TILE];
        bvh.closest_many(camera.origin, tile, &mut hits[..tile.len()]);
        count += hits.iter().flatten().count();
    }
    count
}

fn trace_singles(bvh: &Bvh, camera: &Camera) -> usize {
    let hit = |&d: &DVec3| bvh.closest(&camera.ray(d), f64::INFINITY).is_some();
    camera.directions.iter().filter(|d| hit(d)).count()
}

fn trace_any(bvh: &Bvh, camera: &Camera) -> usize {
    let hit = |&d: &DVec3| bvh.any(&camera.ray(d), f64::INFINITY, None);
    camera.directions.iter().filter(|d| hit(d)).count()
}

struct Camera {
    origin: DVec3,
    /// By tiles.
    directions: Vec<DVec3>,
}

impl Camera {
    fn new(bvh: &Bvh, distance: f64, half_width: f64, size: usize) -> Camera {
        let (lo, hi) = bvh.bounds().expect("a mesh");
        let origin = (lo + hi) / 2.0 + DVec3::Z * (distance * (hi - lo).length() / 2.0);
        let pixel = |i: usize| ((i as f64 + 0.5) / size as f64 * 2.0 - 1.0) * half_width;
        let mut directions = Vec::with_capacity(size * size);
        for (y0, x0) in grid(size / TILE).map(|(y, x)| (y * TILE, x * TILE)) {
            let direction = |(y, x)| DVec3::new(pixel(x0 + x), -pixel(y0 + y), -1.0).normalize();
            directions.extend(grid(TILE).map(direction));
        }
        Camera { origin, directions }
    }

    fn rays(&self) -> usize {
        self.directions.len()
    }

    fn ray(&self, direction: DVec3) -> Ray {
        Ray {
            origin: self.origin,
            direction,
            s_min: 0.0,
        }
    }
}

fn grid(n: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..n).flat_map(move |y| (0..n).map(move |x| (y, x)))
}

/// obvhs' tree, its triangles in leaf order, and its traversal.
struct Peer {
    tree: Bvh2,
    triangles: Vec<Triangle>,
    build: Duration,
}

impl Peer {
    fn build(triangles: &[[DVec3; 3]]) -> Peer {
        let triangles: Vec<Triangle> = triangles
            .iter()
            .map(|t| t.map(|c| c.as_vec3a()))
            .map(|[v0, v1, v2]| Triangle { v0, v1, v2 })
            .collect();
        let mut build = Duration::default();
        let preset = BvhBuildParams::medium_build();
        let tree = build_bvh2_from_tris(&triangles, preset, &mut build);
        let triangles = tree
            .primitive_indices
            .iter()
            .map(|&i| triangles[i as usize])
            .collect();
        Peer {
            tree,
            triangles,
            build,
        }
    }

    fn trace(&self, camera: &Camera) -> usize {
        let origin: Vec3A = camera.origin.as_vec3a();
        let hit = |&d: &DVec3| {
            let ray = PeerRay::new_inf(origin, d.as_vec3a());
            let mut hit = RayHit::none();
            self.tree
                .ray_traverse(ray, &mut hit, |ray, i| self.triangles[i].intersect(ray));
            hit.t < f32::INFINITY
        };
        camera.directions.iter().filter(|d| hit(d)).count()
    }
}

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

/// A unit sphere: the faces of a cube, blown up.
fn sphere(detail: usize) -> Vec<[DVec3; 3]> {
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
