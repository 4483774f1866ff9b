//! `nullray mesh-from-depth`: from the transient renderer's capture, and from a picture of distances.

use std::fs;
use std::path::Path;

use glam::DVec3;
use nullray::io::budget::Budget;
use nullray::io::cube::{Cube, CubeSamples};
use nullray::io::gltf::{self, BadTextures, BadVertices, Want};
use nullray::io::image::npz;
use nullray::io::npy;

use super::{Folder, repository};

const EYE: DVec3 = DVec3::new(3.2, 3.0, 4.6);
const CAMERA: [&str; 6] = [
    "--eye",
    "3.2,3,4.6",
    "--look-at",
    "-0.4,1,-0.6",
    "--fov",
    "45 deg",
];

/// What the camera of the capture sees of the corner: distances, (128, 128).
fn seen(folder: &Folder) -> Vec<f64> {
    fs::copy(
        repository("scenes/corner/corner.glb"),
        folder.path("corner.glb"),
    )
    .unwrap();
    folder.write(
        "seen.toml",
        "[camera]\neye = [3.2, 3.0, 4.6]\nlook_at = [-0.4, 1.0, -0.6]\nhfov = \"45 deg\"\nsize = [128, 128]\n\
         [display]\nback_faces = \"two_sided\"\n[[object]]\ngltf = \"corner.glb\"\n",
    );
    folder.ok(&[
        "render",
        "seen.toml",
        "--aovs",
        "distance",
        "--pixel-centers",
        "-o",
        "seen.npz",
    ]);
    let map = npy::load_plain(
        &folder.path("seen.npz"),
        Some("distance"),
        &Budget::default(),
    );
    map.unwrap().samples.into_f64()
}

/// By vertex of a mesh, how much farther it is from the pinhole than what the camera sees in its pixel.
fn errors(path: &Path, seen: &[f64]) -> Vec<f64> {
    let want = Want {
        uvs: true,
        textures: false,
        shading: false,
        normals: false,
        bad_vertices: BadVertices::Refuse,
        bad_textures: BadTextures::Refuse,
    };
    let mesh = gltf::load(path, None, want).unwrap().mesh;
    let error = |(position, [u, v]): (&DVec3, &[f32; 2])| {
        let [column, row] = [u, v].map(|x| (f64::from(*x) * 128.0 - 0.5).round() as usize);
        position.distance(EYE) - seen[row * 128 + column]
    };
    mesh.positions.iter().zip(&mesh.uvs[0]).map(error).collect()
}

#[test]
fn light_that_first_came_back_gives_the_corner_of_the_transient_renderer() {
    let folder = Folder::empty();
    let seen = seen(&folder);
    let input = repository("tests/data/transient/capture_camera.npz");
    let mut arguments = vec!["mesh-from-depth", input.as_str()];
    arguments.extend(CAMERA);
    arguments.extend([
        "--start",
        "7.2 m",
        "--bin-width",
        "0.05 m",
        "--lamp",
        "1.2,2.8,1",
    ]);
    arguments.extend(["-o", "corner-found.glb"]);
    let text = folder.ok(&arguments);
    assert!(
        text.contains("triangles") && text.contains("uv = 0"),
        "{text}"
    );
    let mut errors: Vec<f64> = errors(&folder.path("corner-found.glb"), &seen)
        .into_iter()
        .map(f64::abs)
        .collect();
    errors.sort_by(f64::total_cmp);
    let at = |part: f64| errors[(part * errors.len() as f64) as usize];
    println!(
        "{} vertices; error {:.4} m in the middle, {:.4} m of 90 %",
        errors.len(),
        at(0.5),
        at(0.9)
    );
    // A bin is 0.05 m wide, a pixel about 0.04.
    assert!(errors.len() > 128 * 128 / 2, "{}", errors.len());
    assert!(at(0.5) < 0.01 && at(0.9) < 0.05, "{} {}", at(0.5), at(0.9));
}

#[test]
fn a_picture_of_distances_becomes_a_mesh_with_the_places_of_its_pixels() {
    let folder = Folder::empty();
    let seen = seen(&folder);
    let made = ["mesh-from-depth", "seen.npz", "--from", "distance"];
    folder.ok(&[&made[..], &CAMERA].concat());
    let errors = errors(&folder.path("seen.glb"), &seen);
    assert!(errors.len() > 128 * 128 / 2);
    // Positions are rounded to single precision.
    assert!(errors.iter().all(|error| error.abs() < 2e-6));
}

#[test]
fn what_makes_no_mesh_is_refused_and_leaves_nothing() {
    let folder = Folder::empty();
    folder.write("map.npy", {
        let header = "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }";
        let mut file = b"\x93NUMPY\x01\x00\x76\x00".to_vec();
        file.extend(format!("{header:<117}\n").bytes());
        file.extend([f64::NAN; 6].iter().flat_map(|x| x.to_le_bytes()));
        file
    });
    let made = [&["mesh-from-depth", "map.npy"], &CAMERA[..]].concat();
    let map = ["--from", "distance"];
    for (arguments, says) in [
        (&map[..], "one surface"),
        (&["--from", "depth", "-o", "a.obj"], ".glb"),
        (&[], "--lamp"),
        (&["--lamp", "1,2"], "three numbers"),
        (&["--lamp", "0,0,0"], "--bin-width"),
        (&["--from", "distance", "--up", "-3.6,-2,-5.2"], "--up"),
        // Found before the file is read.
        (&["-o", "nodir/d.glb", "--from", "depth"], "no directory"),
        (&["--near-clip", "nan"], "--near-clip"),
        (&["--from", "distance", "--lamp", "1,2,3"], "--lamp"),
        (&["--from", "distance", "--lamp-time", "0 m"], "--lamp-time"),
        (&["--from", "distance", "--start", "0 m"], "--start"),
        (&["--from", "depth", "--bin-width", "1 m"], "--bin-width"),
        (&["--from", "depth", "--axes", "T H W"], "--axes"),
        (
            &["--from", "depth", "--medium-index", "2"],
            "--medium-index",
        ),
        (
            &["--from", "depth", "--peak-fraction", "0.5"],
            "--peak-fraction",
        ),
        (
            &["--from", "depth", "--dark-fraction", "0.5"],
            "--dark-fraction",
        ),
    ] {
        let run = folder.run(&[&made[..], arguments].concat());
        assert_eq!(run.code, 2, "{arguments:?}");
        assert!(
            run.message().contains(says),
            "{arguments:?}: {}",
            run.message()
        );
    }
    assert_eq!(folder.names(), ["map.npy"]);
}

/// A wall 3 m ahead, lit from the pinhole through a medium: light is on its way for 2 · 1.4 times the distance.
#[test]
fn the_medium_of_a_cube_is_taken_from_its_file_and_times_of_emission_are_refused() {
    let folder = Folder::empty();
    let write = |clock: &str| {
        const WIDTH: f64 = 0.1;
        let side = |n: usize| ((n as f64 + 0.5) / 3.0 - 1.0) * 20f64.to_radians().tan();
        let samples = (0..36 * 120).map(|n| {
            let (pixel, bin) = (n / 120, n % 120);
            let (x, y) = (side(pixel % 6), side(pixel / 6));
            let arrival = 2.0 * 1.4 * 3.0 * (1.0 + x * x + y * y).sqrt();
            let off = (WIDTH * (bin as f64 + 0.5) - arrival).abs() / WIDTH;
            (1.0 - 0.5 * off).max(0.0)
        });
        let cube = Cube::new([6, 6, 120, 1], CubeSamples::F64(samples.collect())).unwrap();
        let said = [
            ("start", "0"),
            ("bin_width", "0.1"),
            ("clock", clock),
            ("medium_index", "1.4"),
        ];
        let metadata = said.map(|(key, text)| (key.to_string(), text.to_string()));
        let options = npz::CubeOptions {
            metadata: &metadata,
            ..Default::default()
        };
        npz::write_cube_with(&folder.path("a.npz"), &cube, &options).unwrap();
    };
    let command = [
        "mesh-from-depth",
        "a.npz",
        "--eye=0,0,0",
        "--look-at=0,0,-1",
        "--fov=40 deg",
        "--lamp=0,0,0",
    ];
    write("capture");
    let said = folder.ok(&command);
    assert!(!said.contains("warning"), "{said}");
    let want = Want {
        uvs: true,
        textures: false,
        shading: false,
        normals: false,
        bad_vertices: BadVertices::Refuse,
        bad_textures: BadTextures::Refuse,
    };
    let mesh = gltf::load(&folder.path("a.glb"), None, want).unwrap().mesh;
    assert_eq!(mesh.positions.len(), 36);
    for position in &mesh.positions {
        // Half a bin is 0.018 m of distance here.
        assert!((position.z + 3.0).abs() < 0.018, "{position}");
    }
    let said = folder.ok(&[&command[..], &["--medium-index", "1", "-o", "b.glb"]].concat());
    assert!(said.contains("medium_index = \"1.4\""), "{said}");
    write("world");
    let run = folder.run(&command);
    assert_eq!(run.code, 2);
    let message = run.message();
    assert!(message.contains("times are those of emission"), "{message}");
}
