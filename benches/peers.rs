//! Certified packets beside Embree, in turn: primary rays, shadow rays, single rays, incoherent rays (those of the camera in another
//! order, and from anywhere in the mesh's box any way; through the balanced tree and the thorough one, which is made for many such rays), builds, whole pictures against Embree's
//! bare rate, and the first picture of a mesh, tree included, against Embree's medium tree and bare rays.
//!
//! ```sh
//! cargo bench --features peers --bench peers
//! ```
//!
//! Needs a C++ compiler and Embree 3 with its headers (Debian: `libembree-dev`); without them it says so and measures
//! nothing. `benches/peers/embree.cpp` is compiled with all instructions of this processor and runs beside this program on one
//! thread; both trace the same rays in turn, so that what else the machine does slows both alike. For each mesh the best of
//! all rounds is printed, and ratios of rounds: their median and quartiles. Meshes, camera and lamp are those of `visibility`,
//! and nefertiti (or else the last mesh) at sixteen times its triangles is one more. Everything is written as
//! JSON to `target/bench/peers.jsonl`.

mod common;

#[path = "frame/scene.rs"]
#[allow(dead_code)]
mod scene;

use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::Mutex;
use std::time::Instant;

use glam::DVec3;
use nullray::accel::{
    Bvh, Converging, Facing, Hit, Kernel, Origins, Precision, Preset, Ray, Segment, Traversal,
};
use nullray::render::progress::Silent;

use common::{Camera, Ratio, TILE, best, meshes, render_next, seconds_of};
use scene::{Files, Place};

const SIZE: usize = 1024;
const ROUNDS: usize = 11;

fn main() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let program = match compiled(folder.path()) {
        Ok(program) => program,
        Err(why) => return println!("skipped: {why}"),
    };
    let mut report = common::report_file("peers");
    let mut all = meshes(false, 256);
    let split = all.iter().find(|(name, _)| name == "nefertiti");
    if let Some((name, triangles)) = split.or(all.last()) {
        let finer = scene::split(&scene::split(triangles));
        all.push((format!("{name}x16"), finer));
    }
    let mut ratios = Vec::new();
    for (name, triangles) in all {
        let ratio = measure(&name, &triangles, &program, folder.path(), &mut report);
        if !name.ends_with("x16") {
            ratios.push(ratio.ln());
        }
    }
    let mean = (ratios.iter().sum::<f64>() / ratios.len() as f64).exp();
    println!(
        "certified primary rays: {mean:.2} times Embree's 16-wide rate (geometric mean of the meshes)"
    );
}

/// The program that traces by Embree.
fn compiled(folder: &Path) -> Result<PathBuf, String> {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/peers/embree.cpp");
    let program = folder.join("embree");
    let mut compile = Command::new("c++");
    compile.args(["-O3", "-march=native", "-o"]).arg(&program);
    let done = compile.arg(source).arg("-lembree3").output();
    let done = done.map_err(|e| format!("there is no C++ compiler (c++: {e})"))?;
    match done.status.success() {
        true => Ok(program),
        false => Err("Embree 3 and its headers are not installed".into()),
    }
}

/// Embree at work on one mesh.
struct Embree {
    child: Child,
    asked: ChildStdin,
    answers: BufReader<ChildStdout>,
    /// Seconds for the trees of high and of medium quality.
    built: [f64; 2],
}

impl Embree {
    fn start(program: &Path, mesh: &Path, [distance, half_width]: [f64; 2]) -> Embree {
        let mut child = Command::new(program)
            .arg(mesh)
            .args([
                distance.to_string(),
                half_width.to_string(),
                SIZE.to_string(),
            ])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("Embree starts");
        let asked = child.stdin.take().expect("its input");
        let answers = BufReader::new(child.stdout.take().expect("its output"));
        let mut embree = Embree {
            child,
            asked,
            answers,
            built: [0.0; 2],
        };
        let line = embree.line();
        let mut numbers = line
            .split_whitespace()
            .skip(1)
            .map(|n| n.parse().expect("seconds"));
        embree.built = [
            numbers.next().expect("high"),
            numbers.next().expect("medium"),
        ];
        embree
    }

    fn line(&mut self) -> String {
        let mut line = String::new();
        self.answers.read_line(&mut line).expect("an answer");
        line
    }

    /// Seconds for all rays of a kind, and how many hit.
    fn trace(&mut self, kind: &str) -> (f64, usize) {
        writeln!(self.asked, "{kind}").expect("it listens");
        let line = self.line();
        let (seconds, hits) = line.trim().split_once(' ').expect("two numbers");
        (
            seconds.parse().expect("seconds"),
            hits.parse().expect("hits"),
        )
    }
}

impl Drop for Embree {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// One way to do it, by us or by Embree: its name, and seconds by round.
struct Row {
    name: String,
    /// The kind of Embree's rays that it is compared with.
    rival: &'static str,
    rays: usize,
    seconds: Vec<f64>,
}

/// Measures a mesh; returns the ratio of certified primary rays.
fn measure(
    name: &str,
    triangles: &[[DVec3; 3]],
    program: &Path,
    folder: &Path,
    report: &mut fs::File,
) -> f64 {
    let view = match name {
        "kitchen" | "room" => [0.3, 0.7],
        _ => [2.2, 0.5],
    };
    let one = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .expect("a thread");
    let built = |preset| {
        let corners = triangles.to_vec();
        let begin = Instant::now();
        let bvh = one.install(|| Bvh::build_with(corners, |_| Facing::TwoSided, preset));
        (bvh, begin.elapsed().as_secs_f64())
    };
    let (bvh, build) = built(Preset::Balanced);
    let (_, quick_build) = built(Preset::Quick);
    let (thorough, thorough_build) = built(Preset::Thorough);
    let mesh = folder.join("mesh.tri");
    let numbers = triangles
        .iter()
        .flatten()
        .flat_map(|p| p.as_vec3().to_array());
    fs::write(
        &mesh,
        numbers.flat_map(f32::to_le_bytes).collect::<Vec<u8>>(),
    )
    .expect("a mesh");
    let mut embree = Embree::start(program, &mesh, view);
    println!(
        "{name}: {} triangles; trees built in {:.0} ms (balanced), {:.0} (quick) and {:.0} (thorough), Embree's in {:.0} (high quality) and {:.0} (medium)",
        triangles.len(),
        1e3 * build,
        1e3 * quick_build,
        1e3 * thorough_build,
        1e3 * embree.built[0],
        1e3 * embree.built[1],
    );

    let camera = Camera::new(&bvh, view[0], view[1], SIZE);
    let shadows = shadows(&bvh, &camera);
    let segments: Vec<Vec<Segment>> = shadows.iter().map(Shadows::segments).collect();
    // Rays that have nothing to do with one another: every 40,503rd.
    let rays = camera.rays();
    let shuffled: Vec<DVec3> = (0..rays)
        .map(|k| camera.directions[k * 40_503 % rays])
        .collect();
    let random = random_rays(&bvh, rays);
    let files = Files::write(folder, triangles, [256, 256, 64]);
    let place = Place::of(name);
    let pictures =
        [("picture at rest", false), ("picture at 0.9 c", true)].map(|(called, moving)| {
            let case = scene::Case {
                name: "",
                moving,
                light: scene::Light::Base,
            };
            (
                called,
                files.prepare(&scene::of_mesh(&files, &case, place, SIZE as u32)),
            )
        });
    let kernels: Vec<Kernel> = Kernel::ALL
        .into_iter()
        .filter(|k| k.is_supported() && *k != Kernel::Portable)
        .collect();

    // What is measured, in the order of a round.
    let mut works: Vec<(Row, Box<dyn Fn() + '_>)> = Vec::new();
    for kernel in kernels {
        let (bvh, camera, shadows, segments) = (&bvh, &camera, &shadows, &segments);
        let called = |what: &str| format!("{what} {kernel:?}").to_lowercase();
        let certified = Traversal {
            kernel,
            precision: Precision::Certified,
        };
        if kernel == Kernel::Scalar {
            let row = Row::new(
                called("certified, single rays,"),
                "closest 1",
                camera.rays(),
            );
            let trace = move || trace(bvh, camera.origin, &camera.directions, certified);
            works.push((row, Box::new(trace)));
            continue;
        }
        for (precision, what) in [
            (Precision::Certified, "certified, primary rays,"),
            (Precision::Fast, "f32 only, primary rays,"),
        ] {
            let method = Traversal { kernel, precision };
            let row = Row::new(called(what), "closest 16", camera.rays());
            let trace = move || trace(bvh, camera.origin, &camera.directions, method);
            works.push((row, Box::new(trace)));
        }
        let (shuffled, (origins, directions)) = (&shuffled, &random);
        for (bvh, tree) in [(bvh, ""), (&thorough, " thorough tree,")] {
            let what = format!("certified, shuffled rays,{tree}");
            let row = Row::new(called(&what), "shuffled 1", camera.rays());
            let trace = move || trace(bvh, camera.origin, shuffled, certified);
            works.push((row, Box::new(trace)));
            let what = format!("certified, random rays,{tree}");
            let row = Row::new(called(&what), "random 1", camera.rays());
            let trace = move || trace_each(bvh, origins, directions, certified);
            works.push((row, Box::new(trace)));
        }
        let count = shadows.iter().map(Shadows::len).sum();
        let row = Row::new(called("certified, shadow rays,"), "shadow 16", count);
        works.push((row, Box::new(move || block(bvh, shadows, certified))));
        let row = Row::new(
            called("certified, the same as single segments,"),
            "shadow 16",
            count,
        );
        works.push((
            row,
            Box::new(move || block_segments(bvh, segments, certified)),
        ));
    }
    for (called, picture) in &pictures {
        let row = Row::new(called.to_string(), "closest 16", camera.rays());
        let (one, film) = (&one, Mutex::new(None));
        works.push((
            row,
            Box::new(move || {
                one.install(|| {
                    let mut film = film.lock().expect("one thread");
                    render_next(picture, &mut film, &Silent);
                });
            }),
        ));
    }

    let rivals = [
        "closest 16",
        "closest 8",
        "closest 1",
        "shuffled 1",
        "random 1",
        "random 16",
        "shadow 16",
    ];
    let mut theirs = rivals.map(|kind| (kind, Vec::new(), 0));
    for _ in 0..ROUNDS {
        for (kind, seconds, hits) in &mut theirs {
            let (time, hit) = embree.trace(kind);
            seconds.push(time);
            *hits = hit;
        }
        for (row, work) in &mut works {
            row.seconds.push(seconds_of(work));
        }
    }

    let mut primary = 0.0f64;
    for (kind, seconds, hits) in &theirs {
        let rays = if kind.starts_with("shadow") {
            shadows.iter().map(Shadows::len).sum()
        } else {
            camera.rays()
        };
        println!(
            "  {:<44} {:7.2} Mrays/s, {hits} hits",
            format!("Embree, {kind}"),
            rays as f64 / best(seconds) / 1e6
        );
    }
    for (row, _) in &works {
        let rival = theirs
            .iter()
            .find(|(kind, ..)| *kind == row.rival)
            .expect("a rival");
        let ratio = Ratio::of(&rival.1, &row.seconds);
        let rate = row.rays as f64 / best(&row.seconds) / 1e6;
        println!(
            "  {:<44} {rate:7.2} Mrays/s, {ratio} times Embree's {}",
            row.name, row.rival
        );
        if row.name.starts_with("certified, primary") {
            primary = primary.max(ratio.middle);
        }
        let line = serde_json::json!({
            "mesh": name, "triangles": triangles.len(), "what": row.name, "mrays_per_s": rate, "rival": row.rival,
            "ratio": ratio.middle, "quartiles": ratio.quartiles(), "build_s": build, "embree_build_s": embree.built,
        });
        writeln!(report, "{line}").expect("report");
    }
    // One sample per pixel from the mesh on.
    let frame = |name: &str| {
        let row = works.iter().find(|(row, _)| row.name == name);
        best(&row.expect("a picture").0.seconds)
    };
    let embree_frame = theirs.iter().find(|(kind, ..)| *kind == "closest 16");
    let ours = quick_build + frame("picture at 0.9 c");
    let bare = embree.built[1] + best(&embree_frame.expect("a rival").1);
    println!(
        "  {:<44} {:7.1} ms, {:.2} times Embree's medium tree and bare rays",
        "first picture at 0.9 c, tree included",
        1e3 * ours,
        ours / bare
    );
    primary
}

impl Row {
    fn new(name: String, rival: &'static str, rays: usize) -> Row {
        Row {
            name,
            rival,
            rays,
            seconds: Vec::new(),
        }
    }
}

/// Traces all rays from `origin`, so many at a time as a tile has.
fn trace(bvh: &Bvh, origin: DVec3, directions: &[DVec3], method: Traversal) {
    for tile in directions.chunks(TILE * TILE) {
        let mut hits: [Option<Hit>; TILE * TILE] = [None; TILE * TILE];
        let from = Origins::Shared(origin);
        bvh.closest_by(method, from, tile, &mut hits[..tile.len()], None, None);
        std::hint::black_box(&hits);
    }
}

/// The same for rays that start anywhere.
fn trace_each(bvh: &Bvh, origins: &[DVec3], directions: &[DVec3], method: Traversal) {
    let batches = origins.chunks(TILE * TILE);
    for (origins, directions) in batches.zip(directions.chunks(TILE * TILE)) {
        let mut hits: [Option<Hit>; TILE * TILE] = [None; TILE * TILE];
        let (from, entries) = (Origins::Each(origins), &mut hits[..origins.len()]);
        bvh.closest_by(method, from, directions, entries, None, None);
        std::hint::black_box(&hits);
    }
}

/// Rays from anywhere in the box of the mesh any way: origins and directions. `peers/embree.cpp` makes the same.
fn random_rays(bvh: &Bvh, count: usize) -> (Vec<DVec3>, Vec<DVec3>) {
    let (lo, hi) = bvh.bounds().expect("a mesh");
    let mut state = 1u64;
    let mut next = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let (mut origins, mut directions) = (Vec::new(), Vec::new());
    while origins.len() < count {
        let origin = lo + (hi - lo) * DVec3::new(next(), next(), next());
        let direction = DVec3::new(next(), next(), next()) * 2.0 - 1.0;
        if (1e-4..=1.0).contains(&direction.length_squared()) {
            origins.push(origin);
            directions.push(direction.normalize());
        }
    }
    (origins, directions)
}

/// Ways from what a tile shows to the lamp, as the renderer keeps them.
struct Shadows {
    lamp: DVec3,
    from: [Vec<f64>; 3],
    s_min: Vec<f64>,
    /// The triangles that they leave.
    skip: Vec<u32>,
}

impl Shadows {
    fn len(&self) -> usize {
        self.skip.len()
    }

    /// The same, each by itself.
    fn segments(&self) -> Vec<Segment> {
        let [x, y, z] = &self.from;
        let segment = |at: usize| {
            let origin = DVec3::new(x[at], y[at], z[at]);
            Segment {
                ray: Ray {
                    origin,
                    direction: self.lamp - origin,
                    s_min: self.s_min[at],
                },
                s_max: 1.0,
                skip: Some(self.skip[at]),
                end: None,
            }
        };
        (0..self.len()).map(segment).collect()
    }
}

/// Asks what is in the way to the lamp, tile by tile.
fn block(bvh: &Bvh, tiles: &[Shadows], method: Traversal) {
    for tile in tiles {
        let mut blocked = [false; TILE * TILE];
        let segments = Converging {
            end: tile.lamp,
            from: tile.from.each_ref().map(Vec::as_slice),
            s_min: &tile.s_min,
            skip: &tile.skip,
            at: None,
        };
        bvh.any_to_point(method, segments, &mut blocked, None);
        std::hint::black_box(&blocked);
    }
}

/// The same for segments that may go anywhere.
fn block_segments(bvh: &Bvh, tiles: &[Vec<Segment>], method: Traversal) {
    for segments in tiles {
        let mut blocked = [false; TILE * TILE];
        bvh.any_by(method, segments, &mut blocked, None);
        std::hint::black_box(&blocked);
    }
}

/// From what the camera sees to the lamp, by tiles.
fn shadows(bvh: &Bvh, camera: &Camera) -> Vec<Shadows> {
    let (lo, hi) = bvh.bounds().expect("a mesh");
    let lamp = (lo + hi) / 2.0 + DVec3::new(0.5, 0.8, 0.6) * ((hi - lo).length() / 2.0);
    let of_tile = |tile: &[DVec3]| {
        let mut hits = vec![None; tile.len()];
        let from = Origins::Shared(camera.origin);
        let method = Traversal::default();
        bvh.closest_by(method, from, tile, &mut hits, None, None);
        let mut shadows = Shadows {
            lamp,
            from: Default::default(),
            s_min: Vec::new(),
            skip: Vec::new(),
        };
        for (direction, hit) in tile.iter().zip(hits) {
            let Some(hit) = hit else { continue };
            let origin = camera.origin + *direction * hit.s;
            for (axis, x) in shadows.from.iter_mut().zip(origin.to_array()) {
                axis.push(x);
            }
            let size = 1e-12 * origin.length();
            shadows.s_min.push(size / (lamp - origin).length());
            shadows.skip.push(hit.triangle);
        }
        shadows
    };
    camera.directions.chunks(TILE * TILE).map(of_tile).collect()
}
