//! Films through baked light, against path tracing in space-time.

use std::path::Path;

use glam::DVec3;
use nullray::io::gltf;
use nullray::io::image::npz;
use nullray::mesh::{Material, Mesh, Part};
use nullray::render::bake::{Bins, Coordinates, Surface};
use nullray::render::film::Film;
use nullray::scene::model::{Geometry, Scene};
use nullray::scene::{self, Overrides};

use super::{cube_of, prepared, surface_cube};
use crate::pipeline::stage;

/// √(Σ(a−b)²/Σb²) of all pixels below 5 %, and the sums within 1 %.
fn assert_same_film(stored: &Film, traced: &Film) {
    let (mut squares, mut all, mut sums) = (0.0, 0.0, [0.0; 2]);
    for (a, b) in stored.radiance().iter().zip(traced.radiance()) {
        for c in 0..3 {
            squares += (a[c] - b[c]).powi(2);
            all += b[c] * b[c];
            sums[0] += a[c];
            sums[1] += b[c];
        }
    }
    let error = f64::sqrt(squares / all);
    assert!(all > 0.0 && error < 5e-2, "{error}");
    stage::assert_relative(sums[0], sums[1], 1e-2, "whole film");
}

#[test]
fn a_film_through_baked_light_is_the_path_traced_one() {
    // A floor and a wall, a flash, and a camera at 0.7 c: once through cubes of both, once by following light.
    let head = "
[camera]
eye = [0.5, 1.2, 4]
look_at = [-0.3, 0.5, 0]
hfov = \"50 deg\"
size = [32, 24]
velocity = { beta = [0.2, 0, -0.7] }
clock_zero = \"8.5 m\"
[display]
samples_per_pixel = 1024
[[object]]
name = \"floor\"
shape = { plane = { size = [3, 3] } }
colour = [0.8, 0.8, 0.8]
[[object]]
name = \"wall\"
shape = { plane = { size = [3, 2] } }
transform = { translate = [0, 1, -1.5], rotate = { axis = [1, 0, 0], angle = \"90 deg\" } }
colour = [0.9, 0.5, 0.3]
";
    let light = "[[light]]\nposition = [0.4, 1.5, 0.3]\nintensity = 2\nemission = { gaussian = { sigma = \"0.3 m\" } }\n";
    let lit = stage::scene(&format!("render = {{ bounces = 2 }}\n{head}{light}"));
    let bins = Bins {
        start: -2.0,
        width: 0.1,
        count: 120,
    };
    let folder = tempfile::tempdir().unwrap();
    let mut sources = String::new();
    for (object, name) in ["floor", "wall"].into_iter().enumerate() {
        let mut scene = lit.clone();
        scene.samples_per_pixel = 16;
        let baked = surface_cube(&scene, object, [48, 48], &bins).unwrap();
        let file = folder.path().join(format!("{name}.npy"));
        npz::write_cube(&file, &baked.cube).unwrap();
        sources += &format!(
            "[[source]]\nobjects = [\"{name}\"]\ncube = {{ file = {:?}, start = \"-2 m\", bin_width = \"0.1 m\", clock = \"world\", filter = \"linear\", uv = 0 }}\n",
            file.to_str().unwrap()
        );
    }
    let stored = stage::scene(&format!("{head}{sources}"));
    let film = |scene: &Scene| stage::rendered(scene, &stage::sampled()).unwrap();
    let (traced, stored) = (film(&lit), film(&stored));
    // Half of it has been reflected more than once.
    let mut direct = lit.clone();
    direct.bounces = 0;
    let direct: f64 = film(&direct).radiance().iter().flatten().sum();
    let all: f64 = traced.radiance().iter().flatten().sum();
    assert!(direct < 0.6 * all, "{direct} {all}");
    assert_same_film(&stored, &traced);
}

/// A floor, and a plate of 3 × 3 cells whose normals are those of a wave across it: once through baked light of both, once by following light.
#[test]
fn a_film_through_light_baked_on_smooth_surfaces_is_the_path_traced_one() {
    let folder = tempfile::tempdir().unwrap();
    let mut plate = Mesh::default();
    for k in 0..16 {
        let (u, v) = (f64::from(k % 4) / 3.0, f64::from(k / 4) / 3.0);
        plate
            .positions
            .push(DVec3::new(3.0 * u - 1.5, 2.0 * v, -1.5));
        plate.normals.push([
            0.8 * (6.0 * u as f32).sin(),
            0.5 * (5.0 * v as f32).cos(),
            1.0,
        ]);
        plate.uvs.resize(1, Vec::new());
        plate.uvs[0].push([u as f32, 1.0 - v as f32]);
    }
    for k in [0, 1, 2, 4, 5, 6, 8, 9, 10] {
        plate
            .triangles
            .extend([[k, k + 1, k + 5], [k, k + 5, k + 4]]);
    }
    plate.parts.push(Part {
        first_triangle: 0,
        triangles: 18,
        material: 0,
        node: "plate".into(),
    });
    plate.materials.push(Material::matte([0.9, 0.5, 0.3]));
    let flat = Mesh {
        normals: Vec::new(),
        ..plate.clone()
    };
    for (name, mesh) in [("smooth.glb", &plate), ("flat.glb", &flat)] {
        gltf::save(&folder.path().join(name), "plate", mesh).unwrap();
    }
    let head = |file: &str| {
        format!(
            "
[camera]
eye = [0.5, 1.2, 4]
look_at = [-0.3, 0.5, 0]
hfov = \"50 deg\"
size = [32, 24]
velocity = {{ beta = [0.2, 0, -0.7] }}
clock_zero = \"8.5 m\"
[display]
samples_per_pixel = 256
[[object]]
name = \"floor\"
shape = {{ plane = {{ size = [3, 3] }} }}
colour = [0.8, 0.8, 0.8]
[[object]]
name = \"plate\"
gltf = \"{file}\"
"
        )
    };
    let light = "[[light]]\nposition = [0.4, 1.5, 0.3]\nintensity = 2\nemission = { gaussian = { sigma = \"0.3 m\" } }\n";
    let lit = |file: &str| {
        let text = format!("render = {{ bounces = 1 }}\n{}{light}", head(file));
        stage::scene_in(folder.path(), &text)
    };
    let bins = Bins {
        start: -2.0,
        width: 0.1,
        count: 120,
    };
    let mut sources = String::new();
    for (object, name) in ["floor", "plate"].into_iter().enumerate() {
        let mut scene = lit("smooth.glb");
        scene.samples_per_pixel = 16;
        let baked = surface_cube(&scene, object, [48, 48], &bins).unwrap();
        npz::write_cube(&folder.path().join(format!("{name}.npy")), &baked.cube).unwrap();
        sources += &format!(
            "[[source]]\nobjects = [\"{name}\"]\ncube = {{ file = \"{name}.npy\", start = \"-2 m\", bin_width = \"0.1 m\", clock = \"world\", filter = \"linear\", uv = 0 }}\n",
        );
    }
    let stored = stage::scene_in(folder.path(), &(head("smooth.glb") + &sources));
    let film = |scene: &Scene| stage::rendered(scene, &stage::sampled()).unwrap();
    let traced = film(&lit("smooth.glb"));
    assert_same_film(&film(&stored), &traced);
    // Flat it would be another film.
    let other = film(&lit("flat.glb"));
    let pixels = traced.radiance().iter().zip(other.radiance());
    let (difference, all) = pixels.fold((0.0, 0.0), |(difference, all), (a, b)| {
        (difference + (a[0] - b[0]).powi(2), all + a[0] * a[0])
    });
    let error = f64::sqrt(difference / all);
    assert!(error > 0.1, "{error}");
}

/// Objects none of whose texture coordinates would do: a box, whose faces share theirs; a mesh from a file without any, mirrored; and a sphere. Baked with atlases, and read by their files, the light is the one that paths find.
#[test]
fn a_film_through_light_on_atlases_is_the_path_traced_one() {
    let folder = tempfile::tempdir().unwrap();
    let positions = [
        [0f32, 0.0, 0.0],
        [0.8, 0.0, 0.0],
        [0.8, 1.0, 0.2],
        [0.0, 1.0, 0.2],
        [0.4, 0.5, 0.5],
    ];
    let triangles = [0u32, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4];
    let mut bytes: Vec<u8> = positions
        .as_flattened()
        .iter()
        .flat_map(|x| x.to_le_bytes())
        .collect();
    bytes.extend(triangles.iter().flat_map(|x| x.to_le_bytes()));
    std::fs::write(folder.path().join("pyramid.bin"), &bytes).unwrap();
    let json = r#"{ "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [0] }], "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1, "material": 0 }] }],
        "materials": [{ "pbrMetallicRoughness": { "metallicFactor": 0 } }],
        "buffers": [{ "uri": "pyramid.bin", "byteLength": 108 }],
        "bufferViews": [{ "buffer": 0, "byteLength": 60 }, { "buffer": 0, "byteOffset": 60, "byteLength": 48 }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 5, "type": "VEC3", "min": [0, 0, 0], "max": [0.8, 1, 0.5] },
            { "bufferView": 1, "componentType": 5125, "count": 12, "type": "SCALAR" }] }"#;
    std::fs::write(folder.path().join("pyramid.gltf"), json).unwrap();
    let pyramid = folder.path().join("pyramid.gltf");
    let head = "
[camera]
eye = [0.3, 1.6, 4]
look_at = [0, 0.5, 0]
hfov = \"45 deg\"
size = [32, 24]
velocity = { beta = [0.3, 0, -0.5] }
clock_zero = \"8 m\"
[display]
samples_per_pixel = 1024
[[object]]
name = \"floor\"
shape = { plane = { size = [4, 4] } }
colour = [0.8, 0.8, 0.8]
";
    let light = "[[light]]\nposition = [0.2, 2, 1.5]\nintensity = 2\nemission = { gaussian = { sigma = \"0.3 m\" } }\n";
    let objects = |files: [&str; 3]| {
        format!(
            "[[object]]\nname = \"box\"\nshape = {{ box = {{ size = [0.7, 1, 0.7] }} }}\ncolour = [0.9, 0.5, 0.3]\n{}\n\
             transform = {{ translate = [-0.9, 0.5, -0.2], rotate = {{ axis = [0, 1, 0], angle = \"20 deg\" }} }}\n\
             [[object]]\nname = \"pyramid\"\ngltf = {pyramid:?}\n{}\n\
             transform = {{ translate = [0.3, 0, 0.4], scale = [-1, 1, 1] }}\n\
             [[object]]\nname = \"ball\"\nshape = {{ sphere = {{ radius = 0.4, subdivisions = 3 }} }}\n{}\n\
             transform = {{ translate = [1, 0.4, 0] }}\n",
            files[0], files[1], files[2]
        )
    };
    let lit = format!(
        "render = {{ bounces = 1 }}\n{head}{}{light}",
        objects([""; 3])
    );
    let lit = stage::scene(&lit);
    let bins = Bins {
        start: -2.0,
        width: 0.1,
        count: 120,
    };
    let mut sources = String::new();
    let mut files = Vec::new();
    for (object, name) in ["floor", "box", "pyramid", "ball"].into_iter().enumerate() {
        let mut scene = lit.clone();
        scene.samples_per_pixel = 16;
        let surface = Surface {
            object,
            coordinates: Coordinates::Atlas,
            size: [128, 128],
        };
        let baked = cube_of(&scene, &prepared(&scene), &surface, &bins).unwrap();
        let corners = baked.texture_coordinates.unwrap();
        let corners: Vec<f64> = corners
            .iter()
            .flatten()
            .flatten()
            .map(|x| f64::from(*x))
            .collect();
        let file = folder.path().join(format!("{name}.npz"));
        let options = npz::CubeOptions {
            arrays: &[("texture_coordinates", &[corners.len() / 6, 3, 2], &corners)],
            ..npz::CubeOptions::default()
        };
        npz::write_cube_with(&file, &baked.cube, &options).unwrap();
        // A mesh without coordinates has set 0 of the file alone; shapes have one of their own.
        let set = usize::from(name != "pyramid");
        files.push(format!("texture_coordinates = {{ file = {file:?} }}"));
        sources += &format!(
            "[[source]]\nobjects = [\"{name}\"]\ncube = {{ file = {file:?}, array = \"radiance\", start = \"-2 m\", bin_width = \"0.1 m\", \
             clock = \"world\", filter = \"linear\", uv = {set} }}\n"
        );
    }
    let floor = format!("{head}{}\n", files[0]);
    let stored = format!(
        "{floor}{}{sources}",
        objects([&files[1], &files[2], &files[3]])
    );
    let stored = stage::scene(&stored);
    let film = |scene: &Scene| stage::rendered(scene, &stage::sampled()).unwrap();
    let (traced, stored) = (film(&lit), film(&stored));
    assert_same_film(&stored, &traced);
}

/// The scenes of scenes/baked, baked small: what each shows is what paths in the scene that was baked show at that time.
#[test]
fn the_scenes_of_baked_light_show_what_paths_show() {
    let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/baked");
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("light")).unwrap();
    for entry in std::fs::read_dir(&from).unwrap().flatten() {
        let path = entry.path();
        if path.is_file() {
            std::fs::copy(&path, folder.path().join(entry.file_name())).unwrap();
        }
    }
    let small = Overrides {
        size: Some([40, 32]),
        samples_per_pixel: Some(16),
        ..Overrides::default()
    };
    for (name, width) in [("rabbit", 0.06), ("dragon", 0.06), ("tomatoes", 0.04)] {
        let load = |file: String| scene::load(&folder.path().join(file), &small).unwrap();
        let mut lit = load(format!("{name}-lit.toml"));
        lit.samples_per_pixel = 4;
        let bins = Bins {
            start: 0.0,
            width,
            count: 230,
        };
        let all = prepared(&lit);
        for (object, of) in lit.objects.iter().enumerate() {
            let is_flat = matches!(of.geometry, Geometry::Shape { .. });
            let surface = Surface {
                object,
                coordinates: match is_flat {
                    true => Coordinates::Set(0),
                    false => Coordinates::Atlas,
                },
                size: [128, 128],
            };
            let baked = cube_of(&lit, &all, &surface, &bins).unwrap();
            let corners = baked.texture_coordinates.iter().flatten();
            let corners: Vec<f64> = corners.flatten().flatten().map(|x| f64::from(*x)).collect();
            let file = folder.path().join(format!("light/{name}-{}.npz", of.name));
            let options = npz::CubeOptions {
                arrays: &[("texture_coordinates", &[corners.len() / 6, 3, 2], &corners)],
                ..npz::CubeOptions::default()
            };
            npz::write_cube_with(&file, &baked.cube, &options).unwrap();
        }
        lit.samples_per_pixel = 256;
        let mean = |scene: &Scene| {
            let film = stage::rendered(scene, &stage::sampled()).unwrap();
            film.radiance().iter().flatten().sum::<f64>()
        };
        // Two thirds of the light are on the columns, whose faces are few texels wide: on textures 64, 96, 128 and
        // 192 wide the sum is 0.978, 0.950, 0.976 and 0.998 of what it should be.
        let (seen, traced) = (mean(&load(format!("{name}.toml"))), mean(&lit));
        assert!(traced > 0.0);
        stage::assert_relative(seen, traced, 0.05, name);
    }
}
