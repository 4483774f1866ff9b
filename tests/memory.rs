//! The memory of a prepared scene: at most 200 bytes per triangle of mesh and BVH, and every cube once. The memory for rendering a picture:
//! no more than its plan states, and not much less.
//!
//! For a prepared scene, the capacities of everything that grows with triangles are counted: BVH, normals, indices, texture coordinates;
//! for a picture, all allocations.

#[path = "common/counting.rs"]
mod counting;

use std::path::Path;
use std::sync::{Arc, Mutex};

use nullray::approximate::raster::{self, Method};
use nullray::io::cube::{Bricks, Cube, CubeSamples, Wanted};
use nullray::io::image::{Channel, Layers, Samples, npz};
use nullray::light::time_texture::survey::{Order, of_samples};
use nullray::render::aov::Aov;
use nullray::render::bake::{self, Bins, Coordinates, CubePrecision, Surface};
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;
use nullray::render::progress::Silent;
use nullray::render::trace::RestFrame;
use nullray::scene::model::Scene;
use nullray::scene::{Overrides, parse};
use nullray::validate::compare::{
    CompareOptions, NotFinite, Picture, compare, report, working_memory,
};

#[global_allocator]
static ALLOCATOR: counting::Counting = counting::Counting;

/// Allocations of tests at the same time would count, too.
static ALONE: Mutex<()> = Mutex::new(());

/// `shapes` lit by a cube of 4 × 5 texels and 6 bins, which as many sources hold as `sources` says.
fn prepare(shapes: &str, sources: usize) -> (Plan, Prepared) {
    let folder = tempfile::tempdir().unwrap();
    write_cube(&folder.path().join("cube.npy"));
    let mut text = format!("[camera]\neye = [0, 0, 5]\nlook_at = [0, 0, 0]\n{shapes}");
    for i in 0..sources {
        text += &format!(
            "[[source]]\nname = \"source {i}\"\nobjects = [\"object {i}\"]\n\
             cube = {{ file = \"cube.npy\", bin_width = \"1 m\", uv = 0 }}\n"
        );
    }
    let scene = parse(&text, "memory", folder.path(), &Overrides::default()).unwrap();
    let plan = Plan::new(&scene, &Request::default()).unwrap();
    let prepared = Prepared::new(&scene, &plan, &Silent).unwrap();
    (plan, prepared)
}

fn write_cube(path: &Path) {
    let header = "{'descr': '<f4', 'fortran_order': False, 'shape': (4, 5, 6), }";
    let mut file = b"\x93NUMPY\x01\x00".to_vec();
    file.extend([118, 0]);
    file.extend(format!("{header:<117}\n").bytes());
    file.extend([0; 4 * 4 * 5 * 6]);
    std::fs::write(path, file).unwrap();
}

fn object(i: usize, shape: &str, beta: f64) -> String {
    format!(
        "[[object]]\nname = \"object {i}\"\nshape = {shape}\nvelocity = {{ beta = [{beta}, 0, 0] }}\n"
    )
}

fn bytes(frame: &RestFrame) -> usize {
    let meshes = frame.meshes.iter().map(|mesh| {
        24 * mesh.positions.capacity()
            + 12 * mesh.triangles.capacity()
            + mesh.uvs.iter().map(|uvs| 8 * uvs.capacity()).sum::<usize>()
    });
    frame.bvh.bytes() + 24 * frame.normals().len() + meshes.sum::<usize>()
}

fn bytes_per_triangle(shape: &str, sources: usize) -> f64 {
    bytes_per_triangle_of(&object(0, shape, 0.5), sources)
}

fn bytes_per_triangle_of(shape: &str, sources: usize) -> f64 {
    let (plan, prepared) = prepare(shape, sources);
    let held: usize = prepared.frames.iter().map(bytes).sum();
    assert!(
        held as u64 <= plan.memory.geometry,
        "{shape}: {held} held, {} planned",
        plan.memory.geometry
    );
    held as f64 / prepared.frames[0].bvh.len() as f64
}

const SPHERE: &str = "{ sphere = { radius = 1, subdivisions = 6 } }";
const LATTICE: &str = "{ lattice = { cells = [12, 12, 12], spacing = 1, bar = 0.1 } }";

#[test]
fn a_mesh_with_texture_coordinates_takes_at_most_200_bytes_per_triangle() {
    let _alone = ALONE.lock();
    for shape in [SPHERE, LATTICE] {
        let held = bytes_per_triangle(shape, 1);
        assert!(held <= 200.0, "{shape}: {held} bytes");
    }
}

#[test]
fn a_mesh_that_no_cube_lies_on_is_its_bvh_alone() {
    let _alone = ALONE.lock();
    // Three corners of 24 bytes, an id, a node of 64 bytes for at most every triangle, and the wide nodes
    // of packets: 256 bytes for at least six triangles or so.
    let held = bytes_per_triangle(SPHERE, 0);
    assert!(held <= 72.0 + 4.0 + 64.0 + 256.0 / 6.0, "{held} bytes");
}

#[test]
fn a_mesh_that_lamps_light_has_its_normals_beside_and_takes_at_most_200_bytes_per_triangle() {
    let _alone = ALONE.lock();
    let lamp = "[[light]]\nposition = [0, 9, 9]\n";
    for shape in [SPHERE, LATTICE] {
        let object = object(0, shape, 0.5);
        for (text, normals) in [(object.clone(), 0), (object.clone() + lamp, 1)] {
            let (_, prepared) = prepare(&text, 0);
            let frame = &prepared.frames[0];
            assert_eq!(frame.normals().len(), normals * frame.bvh.len());
        }
        let lit = bytes_per_triangle_of(&(object + lamp), 0);
        assert!(lit <= 200.0, "{shape}: {lit} bytes");
    }
}

#[test]
fn a_cube_that_several_sources_show_is_held_once() {
    let _alone = ALONE.lock();
    let shapes = object(0, SPHERE, 0.0) + &object(1, SPHERE, 0.5);
    let (plan, prepared) = prepare(&shapes, 2);
    assert_eq!(plan.memory.cubes, 4 * 4 * 5 * 6);
    let [first, second] = prepared.cubes() else {
        panic!("{} sources", prepared.cubes().len());
    };
    assert!(std::ptr::eq(
        first.cube().in_memory().unwrap(),
        second.cube().in_memory().unwrap()
    ));
}

/// Bytes that the picture of a sphere of 82 k triangles takes from its plan on, and what its plan says, within `limit` bytes.
fn of_picture(method: &str, limit: u64) -> Result<[u64; 2], nullray::Error> {
    let camera = "[camera]\neye = [0, 0, 3]\nlook_at = [0, 0, 0]\nsize = [320, 240]\n";
    let text = camera.to_string() + &object(0, SPHERE, 0.0);
    let scene = parse(&text, "memory", Path::new(""), &Overrides::default()).unwrap();
    let method: Method = method.parse().unwrap();
    let request = Request {
        memory_limit: limit,
        ..Request::default()
    };
    let plan = method.plan(&scene, &request)?;
    let mut film = Ok(());
    let peak = counting::peak_of(|| {
        let prepared = Prepared::new(&scene, &plan, &Silent).unwrap();
        film = raster::render(&prepared, &method, &Silent).map(drop);
    });
    film?;
    Ok([peak as u64, plan.memory.total()])
}

#[test]
fn pictures_of_rasterizers_and_warps_take_what_their_plan_says() {
    let _alone = ALONE.lock();
    for method in [
        "raster:none",
        "warp:cube=512",
        "warp:panorama=2000x1000,lookup=nearest",
    ] {
        let [taken, planned] = of_picture(method, 1 << 30).unwrap();
        assert!(taken <= planned, "{method}: {taken} of {planned}");
        assert!(planned <= 3 * taken, "{method}: {taken} of {planned}");
    }
}

/// A body of this shape in the light of one lamp, ready to be baked.
fn lit(shape: &str, lamp: &str) -> (Scene, Prepared) {
    let camera = "[camera]\neye = [0, 0, 9]\nlook_at = [0, 0, 0]\n";
    let text = format!("{camera}{}[[light]]\n{lamp}\n", object(0, shape, 0.0));
    let scene = parse(&text, "memory", Path::new(""), &Overrides::default()).unwrap();
    let request = Request {
        aovs: vec![Aov::UvU],
        ..Request::default()
    };
    let plan = Plan::new(&scene, &request).unwrap();
    let prepared = Prepared::new(&scene, &plan, &Silent).unwrap();
    (scene, prepared)
}

#[test]
fn charts_that_all_cover_the_same_texels_are_refused_before_they_are_listed_by_texel() {
    let _alone = ALONE.lock();
    let lattice = "{ lattice = { cells = [4, 4, 4], spacing = 1, bar = 0.1 } }";
    let lamp = "position = [0, 9, 9]\nemission = { gaussian = { sigma = \"5 cm\" } }";
    let (scene, prepared) = lit(lattice, lamp);
    let surface = Surface {
        object: 0,
        coordinates: Coordinates::Set(0),
        size: [128, 128],
    };
    let bins = Bins {
        start: 0.0,
        width: 1.0,
        count: 1,
    };
    let mut baked = Ok(());
    let peak = counting::peak_of(|| {
        let cube = bake::surface_cube(
            &scene,
            &prepared,
            &surface,
            &bins,
            CubePrecision::Single,
            None,
            &Silent,
        );
        baked = cube.map(drop);
    });
    assert!(baked.unwrap_err().to_string().contains("charts overlap"));
    // Lists of all triangles for each texel would take a hundred times as much.
    assert!(peak < 4 << 20, "{peak}");
}

#[test]
fn a_bake_takes_what_it_says_and_in_half_precision_little_more_than_half_of_it() {
    let _alone = ALONE.lock();
    let plane = "{ plane = { size = [4, 4] } }";
    let lamp = "position = [0, 1, 0]\nemission = { gaussian = { sigma = \"50 cm\" } }";
    let (scene, prepared) = lit(plane, lamp);
    // The sums of one texel are few beside a large cube, and beside a small one with many bins.
    for (size, count) in [([128, 128], 400), ([16, 16], 6000)] {
        let surface = Surface {
            object: 0,
            coordinates: Coordinates::Set(0),
            size,
        };
        let bins = Bins {
            start: 0.0,
            width: 8.0 / count as f64,
            count,
        };
        let [whole, half] = [CubePrecision::Single, CubePrecision::Half].map(|precision| {
            let needs = bake::check_surface(&scene, &prepared, &surface, &bins, precision).unwrap();
            // The backs of a plane are seen, and no light comes to them.
            assert!(!needs.backs);
            let threads = rayon::current_num_threads();
            let said = bake::surface_bytes(size, &bins, precision, threads) + needs.lists;
            // 16 rows of 16 texels at once have as many numbers as the cube, and their sums.
            let cube = u64::from(size[0] * size[1]) * count as u64 * 12;
            assert!(said < 6 * cube, "{said} of {cube}");
            let mut baked = None;
            let peak = counting::peak_of(|| {
                let cube = bake::surface_cube(
                    &scene, &prepared, &surface, &bins, precision, None, &Silent,
                );
                baked = Some(cube.unwrap());
            });
            assert!(!baked.unwrap().is_dark());
            assert!((peak as u64) < said, "{precision:?}: {peak} of {said}");
            peak
        });
        if count == 400 {
            assert!(half * 10 < whole * 7, "{half} {whole}");
        }
    }
}

#[test]
fn cut_triangles_stay_within_the_memory_limit_and_nearly_reach_it() {
    let _alone = ALONE.lock();
    const LIMIT: u64 = 1 << 28;
    // Ever shorter edges, until they are refused.
    let mut largest = 0;
    for k in 0..24 {
        let length = 0.02 / 2f64.powf(0.25 * f64::from(k));
        match of_picture(&format!("raster:uniform={length}"), LIMIT) {
            Ok([taken, _]) => {
                assert!(taken <= LIMIT, "{length}: {taken}");
                largest = taken;
            }
            Err(error) => {
                assert!(error.to_string().contains("points"), "{error}");
                assert!(largest > LIMIT / 4, "{length} is refused after {largest}");
                return;
            }
        }
    }
    panic!("nothing is refused");
}

#[test]
fn tessellations_beyond_the_limit_are_refused_before_they_fill_it() {
    let _alone = ALONE.lock();
    let scene = "[camera]\neye = [0, 0, 3]\nlook_at = [0, 0, 0]\nsize = [320, 240]\nvelocity = { beta = [0, 0, -0.5] }\n";
    for shape in [
        "{ sphere = { radius = 1, subdivisions = 1 } }",
        "{ plane = { size = [2, 2] } }",
    ] {
        let text = scene.to_string() + &object(0, shape, 0.0);
        let scene = parse(&text, "memory", Path::new(""), &Overrides::default()).unwrap();
        // A limit for some 300,000 points.
        let plain = Plan::new(&scene, &Request::default())
            .unwrap()
            .memory
            .total();
        let request = Request {
            memory_limit: plain + (180 << 20),
            ..Request::default()
        };
        let mut refused = 0;
        for k in 0..12 {
            // Each has twice as many points as the one before.
            let pixels = 1e-4 / 2f64.powi(k);
            let method: Method = format!("raster:adaptive={pixels}").parse().unwrap();
            let plan = method.plan(&scene, &request).unwrap();
            let prepared = Prepared::new(&scene, &plan, &Silent).unwrap();
            let mut failed = false;
            let peak = counting::peak_of(|| {
                failed = raster::render(&prepared, &method, &Silent).is_err();
            });
            assert!(peak < 180 << 20, "{shape}, {pixels}: {peak}");
            refused += u64::from(failed);
            // What is refused at first may be close to the limit, and be found too large only there.
            assert!(
                refused < 3 || peak < 90 << 20,
                "{shape}, {pixels}: {peak} before it is refused"
            );
        }
        assert!(refused > 4, "{shape}: {refused} are refused");
    }
}

/// A picture of noise, shifted by some columns.
fn noise(name: &str, side: usize, channels: &[&str], shift: usize) -> Picture {
    let channel = |(k, name): (usize, &&str)| {
        let sample = |at: usize| {
            let (x, y) = ((at % side + shift) % side, at / side);
            let bits = (x * 7919 + y * 104_729 + k * 1_299_709) as u64;
            let sample = (bits.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40) as f32 / 16_777_216.0;
            // Indices are whole.
            match name.contains(['.', '_']) {
                true => sample,
                false => (8.0 * sample).floor(),
            }
        };
        Channel {
            name: (*name).into(),
            samples: Samples::F32((0..side * side).map(sample).collect()),
        }
    };
    let channels = channels.iter().enumerate().map(channel).collect();
    let side = side as u32;
    Picture::linear(name, Layers::new(side, side, channels, vec![]).unwrap())
}

#[test]
fn comparing_takes_no_more_than_is_estimated() {
    let _alone = ALONE.lock();
    const RGB: [&str; 3] = ["radiance.R", "radiance.G", "radiance.B"];
    let all: Vec<&str> = nullray::render::aov::Aov::ALL
        .iter()
        .map(|aov| aov.name())
        .collect();
    let all: Vec<&str> = RGB.into_iter().chain(all).collect();
    let refuse = CompareOptions::default();
    let maps = CompareOptions {
        maps: true,
        ..CompareOptions::default()
    };
    let count = CompareOptions {
        not_finite: NotFinite::CountAs(0.0),
        ..CompareOptions::default()
    };
    let mut wrong = false;
    for (what, side, reference, candidate, options) in [
        ("light", 256, &RGB[..], &RGB[..], &refuse),
        ("more light", 700, &RGB, &RGB, &refuse),
        ("light with maps", 512, &RGB, &RGB, &maps),
        ("grey", 512, &["Y"], &RGB, &refuse),
        ("all channels", 384, &all, &all, &refuse),
        ("all channels with maps", 384, &all, &all, &maps),
        ("what is not finite", 512, &RGB, &RGB, &count),
    ] {
        let reference = noise("a", side, reference, 0);
        let mut candidate = noise("b", side, candidate, 3);
        if options.not_finite != NotFinite::Refuse
            && let Samples::F32(samples) = &mut candidate.layers.channels[0].samples
        {
            samples[100] = f32::NAN;
        }
        let estimated = working_memory(&reference, &candidate, options);
        let folder = tempfile::tempdir().unwrap();
        let peak = counting::peak_of(|| {
            let found = compare(&reference, &candidate, options).unwrap();
            if options.maps {
                let maps = report::maps(&found, &reference, &candidate).unwrap();
                nullray::io::image::exr::write(&folder.path().join("a.exr"), &maps).unwrap();
                drop(maps);
                let map = report::error_map(&found, &reference, &candidate);
                report::strip(&reference, &map, &candidate).unwrap();
                report::page(&found, &[], [&reference, &candidate], &[map]).unwrap();
            }
        }) as u64;
        let each = peak / (side * side) as u64;
        println!("{what}, {side}: {each} per pixel, {peak} taken, {estimated} estimated");
        wrong |= peak > estimated || estimated > 4 * peak;
    }
    assert!(!wrong);
}

#[test]
fn checks_of_a_cube_on_disk_take_little_memory() {
    let _alone = ALONE.lock();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("noise.npy");
    // 64 MiB, of which 1/8 is checked: 2 million samples.
    let shape = [128, 128, 1024, 1];
    let noise = |n: u32| (n.wrapping_mul(2_654_435_761) >> 8) as f32 / 16_777_216.0;
    let samples = (0..128 * 128 * 1024).map(noise).collect();
    npz::write_cube(&path, &Cube::new(shape, CubeSamples::F32(samples)).unwrap()).unwrap();
    let bricks = Bricks::open(&path, Wanted::default(), 8 << 20).unwrap();
    let store = Arc::new(bricks).into();
    let mut found = Vec::new();
    let peak = counting::peak_of(|| found = of_samples(&store, Order::Stated));
    assert_eq!(found, [""; 0]);
    assert!(peak < 16 << 20, "{peak} bytes");
}
