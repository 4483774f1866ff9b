//! What a prepared scene holds: at most 200 bytes per triangle of mesh and BVH, and every cube once. What a picture takes
//! while it is made: no more than its plan says, and not much less.
//!
//! Of a prepared scene the capacities of all that grows with triangles are counted: BVH, indices, texture coordinates; of a
//! picture whatever is allocated.

#[path = "common/counting.rs"]
mod counting;

use std::path::Path;
use std::sync::Mutex;

use nullray::approximate::raster::{self, Method};
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::{Light, Prepared};
use nullray::render::progress::Silent;
use nullray::render::trace::RestFrame;
use nullray::scene::{Overrides, parse};

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
    frame.bvh.bytes() + meshes.sum::<usize>()
}

fn bytes_per_triangle(shape: &str, sources: usize) -> f64 {
    let (plan, prepared) = prepare(&object(0, shape, 0.5), sources);
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
fn a_cube_that_several_sources_show_is_held_once() {
    let _alone = ALONE.lock();
    let shapes = object(0, SPHERE, 0.0) + &object(1, SPHERE, 0.5);
    let (plan, prepared) = prepare(&shapes, 2);
    assert_eq!(plan.memory.cubes, 4 * 4 * 5 * 6);
    let Light::TimeResolved(light) = prepared.light else {
        panic!("no cube");
    };
    let [first, second] = light.cubes.as_slice() else {
        panic!("{} sources", light.cubes.len());
    };
    assert!(std::ptr::eq(
        first.cube().in_memory().unwrap(),
        second.cube().in_memory().unwrap()
    ));
}

/// Bytes that the picture of a sphere of 82 k triangles takes from its plan on, and what its plan says.
fn of_picture(method: &str) -> Result<[u64; 2], nullray::Error> {
    let camera = "[camera]\neye = [0, 0, 3]\nlook_at = [0, 0, 0]\nsize = [320, 240]\n";
    let text = camera.to_string() + &object(0, SPHERE, 0.0);
    let scene = parse(&text, "memory", Path::new(""), &Overrides::default()).unwrap();
    let method: Method = method.parse().unwrap();
    let request = Request {
        memory_limit: 1 << 30,
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
        let [taken, planned] = of_picture(method).unwrap();
        assert!(taken <= planned, "{method}: {taken} of {planned}");
        assert!(planned <= 3 * taken, "{method}: {taken} of {planned}");
    }
}

#[test]
fn cut_triangles_stay_within_the_memory_limit_and_nearly_reach_it() {
    let _alone = ALONE.lock();
    // Ever shorter edges, until they are refused.
    let mut largest = 0;
    for k in 0..24 {
        let length = 0.01 / 2f64.powf(0.25 * f64::from(k));
        match of_picture(&format!("raster:uniform={length}")) {
            Ok([taken, _]) => {
                assert!(taken <= 1 << 30, "{length}: {taken}");
                largest = taken;
            }
            Err(error) => {
                assert!(error.to_string().contains("points"), "{error}");
                assert!(largest > 1 << 28, "{length} is refused after {largest}");
                return;
            }
        }
    }
    panic!("nothing is refused");
}
