//! The contents of a bundle, and its description of them.

use std::fs;
use std::path::Path;
use std::sync::Arc;

use glam::DVec3;
use nullray::colour::{Continuation, RgbShift, rgb_from_xyz};
use nullray::io::cube::{self, Cube, CubeSamples};
use nullray::io::gltf;
use nullray::io::image;
use nullray::mesh::{AlphaMode, Mesh};
use nullray::render::aov::Aov;
use nullray::render::metadata;
use nullray::render::progress::Silent;
use nullray::scene::model::{BadTextures, BadVertices};
use nullray::scene::{self, Builder, Overrides};
use nullray::validate::export::{BUNDLE_SCHEMA, Cubes, ExportOptions, README, export};

use super::{Exported, exported, exported_scene, exported_with};

const SMALL: &str = r#"
camera = { eye = [0, 1, 4], look_at = [0, 0, 0], size = [16, 12] }
[[object]]
name = "crate"
shape = { box = { size = [1, 2, 1] } }
colour = [0.5, 2.0, 0.25]
"#;

fn capture(options: &ExportOptions) -> Exported {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let text = fs::read_to_string(scenes.join("capture.toml")).unwrap();
    let text = text.replace("size = [640, 480]", "size = [16, 12]");
    exported_with(&text, &scenes, options)
}

#[test]
fn every_file_is_listed_with_its_length_and_sum() {
    let exported = capture(&ExportOptions::default());
    let files = exported.bundle.json["files"].as_array().unwrap();
    for file in files {
        let bytes = fs::read(exported.path(file["path"].as_str().unwrap())).unwrap();
        assert_eq!(file["bytes"], bytes.len());
        assert_eq!(file["sha256"], metadata::sha256(&bytes));
    }
    let mut names: Vec<_> = files.iter().map(|f| f["path"].as_str().unwrap()).collect();
    names.sort_unstable();
    let expected = [
        "README.md",
        "bundle.schema.json",
        "geometry/000.glb",
        "reference/reference.exr",
        "reference/reference.npz",
        "reference/reference.png",
        "scene.toml",
        "sources/000.npz",
    ];
    assert_eq!(names, expected);
}

#[test]
fn a_cube_is_copied_as_it_is_or_named() {
    let original = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/corner/capture_rgb.npz");
    let copied = capture(&ExportOptions::default());
    let source = &copied.bundle.json["sources"][0];
    assert_eq!(source["file"], "sources/000.npz");
    assert_eq!(
        fs::read(copied.path("sources/000.npz")).unwrap(),
        fs::read(&original).unwrap()
    );
    let named = capture(&ExportOptions {
        cubes: Cubes::Referenced,
        reference: false,
        ..ExportOptions::default()
    });
    let source = &named.bundle.json["sources"][0];
    assert_eq!(source["is_copied"], false);
    assert_eq!(
        source["sha256"],
        metadata::sha256(&fs::read(&original).unwrap())
    );
    assert!(!named.path("sources").exists() && !named.path("reference").exists());
    assert!(named.bundle.json["reference"].is_null());
}

#[test]
fn a_cube_in_memory_is_written_into_the_bundle() {
    let samples = (0..2 * 3 * 4).map(f64::from).collect();
    let held = Cube::new([2, 3, 4, 1], CubeSamples::F64(samples)).unwrap();
    let scene = Builder::from_toml("memory", SMALL).cube("light", Arc::new(held.clone()), 0.1);
    let options = ExportOptions {
        reference: false,
        // There is no file to refer to.
        cubes: Cubes::Referenced,
        ..ExportOptions::default()
    };
    let exported = exported_scene(&scene.build().unwrap(), &options);
    let source = &exported.bundle.json["sources"][0];
    assert_eq!(source["is_copied"], true);
    assert_eq!(source["shape"], serde_json::json!([2, 3, 4, 1]));
    let path = exported.path(source["file"].as_str().unwrap());
    assert_eq!(
        source["sha256"],
        metadata::sha256(&fs::read(&path).unwrap())
    );
    assert_eq!(cube::load(&path, Default::default()).unwrap(), held);
}

#[test]
fn a_source_says_what_it_measures_and_how_it_lies_on_surface_and_time() {
    let exported = capture(&ExportOptions::default());
    let source = &exported.bundle.json["sources"][0];
    assert_eq!(source["name"], "recording");
    assert_eq!(source["kind"], "cube");
    assert_eq!(source["quantity"], "integrated");
    assert_eq!(source["exponent"], 4);
    assert_eq!(source["start"], 7.0);
    assert_eq!(source["bin_width"], 0.1);
    assert_eq!(source["clock"], "capture");
    assert_eq!(source["mapping"]["by"], "capture");
    assert_eq!(source["mapping"]["eye"][0], 3.2);
    assert_eq!(source["shape"], serde_json::json!([64, 64, 95, 3]));
    let part = &exported.bundle.json["objects"][0]["parts"][0];
    assert_eq!(part["radiance"], "cube");
    assert_eq!(part["sources"][0], 0);
}

#[test]
fn the_description_has_every_key_that_its_schema_requires_and_no_other() {
    let exported = capture(&ExportOptions::default());
    let stored = fs::read_to_string(exported.path("bundle.schema.json")).unwrap();
    let lines = stored.lines().flat_map(|line| [line.trim_start(), "\n"]);
    assert_eq!(lines.collect::<String>(), BUNDLE_SCHEMA);
    let schema = serde_json::from_str(&stored).unwrap();
    agree(&schema, &schema, &exported.bundle.json, "bundle");
}

/// Checks objects against `properties` and `required` of their schemas, through references and lists.
fn agree(
    root: &serde_json::Value,
    schema: &serde_json::Value,
    value: &serde_json::Value,
    at: &str,
) {
    if let Some(reference) = schema["$ref"].as_str() {
        let schema = root.pointer(reference.trim_start_matches('#')).unwrap();
        return agree(root, schema, value, at);
    }
    if let (Some(items), Some(list)) = (schema.get("items"), value.as_array()) {
        return list.iter().for_each(|value| agree(root, items, value, at));
    }
    let (Some(properties), Some(map)) = (schema["properties"].as_object(), value.as_object())
    else {
        return;
    };
    // Alternatives add keys of their own.
    let open = schema.get("oneOf").is_some() || schema.get("anyOf").is_some();
    for (key, value) in map {
        match properties.get(key) {
            Some(schema) => agree(root, schema, value, &format!("{at}.{key}")),
            None => assert!(open, "{at}.{key} is not in the schema"),
        }
    }
    for key in schema["required"].as_array().into_iter().flatten() {
        assert!(map.contains_key(key.as_str().unwrap()), "{at} lacks {key}");
    }
}

#[test]
fn the_page_defines_each_channel_as_the_table_does() {
    for aov in Aov::ALL {
        let (name, meaning) = (&aov.name(), &aov.meaning());
        let row = format!("| `{name}` | {meaning} | {} |", aov.definition());
        assert!(README.contains(&row), "{row}");
    }
    let exported = exported(SMALL);
    assert_eq!(
        fs::read_to_string(exported.path("README.md")).unwrap(),
        README
    );
    let channels = exported.bundle.json["channels"].as_array().unwrap();
    assert_eq!(channels.len(), Aov::ALL.len() + 3);
}

#[test]
fn the_schema_can_be_read_without_the_sources() {
    for link in ["crate::", "[`", "Mapping::"] {
        assert!(!BUNDLE_SCHEMA.contains(link), "{link}");
    }
}

#[test]
fn the_matrix_of_rgb_follows_from_the_page_and_the_table_beside_it() {
    let text = format!("radiance = {{ quantity = \"rgb\", continuation = \"edge\" }}\n{SMALL}");
    let exported = exported(&text);
    let numbers = |text: &str| -> Vec<Vec<f64>> {
        let rows = text.lines().map(|row| {
            let cells: Result<Vec<f64>, _> = row.split(',').map(str::parse).collect();
            cells
        });
        rows.flatten().collect()
    };
    let basis = numbers(&fs::read_to_string(exported.path("rgb_basis.csv")).unwrap());
    let observer = numbers(include_str!("../../../src/colour/cie_1931_2deg.csv"));
    // D b_k, linear between the rows, which are 5 nm apart, and constant beyond them.
    let radiance = |nm: f64| {
        let at = ((nm - 360.0) / 5.0).clamp(0.0, basis.len() as f64 - 1.000_001);
        let (rows, part) = (&basis[at as usize..], at.fract());
        let value = |k: usize| rows[0][k] + part * (rows[1][k] - rows[0][k]);
        [2, 3, 4].map(|k| value(1) * value(k))
    };
    for w in [0.7, 0.9, 1.0, 1.2] {
        let mut columns = [[0.0; 3]; 3];
        for row in &observer {
            let of = radiance(row[0] / w);
            for (column, of) in columns.iter_mut().zip(of) {
                for (sum, matching) in column.iter_mut().zip(&row[1..4]) {
                    *sum += of * matching * 1e-9 / w.powi(5);
                }
            }
        }
        let ours = RgbShift::of(Continuation::Edge).matrix(w);
        for (k, column) in columns.into_iter().enumerate() {
            for (j, value) in rgb_from_xyz(column).into_iter().enumerate() {
                let error = (value - ours[j][k]).abs();
                assert!(error < 2e-3 * w.powi(-5), "{w}: {value}, {}", ours[j][k]);
            }
        }
    }
    // Without RGB that stands for a spectrum there is nothing to tell.
    assert!(
        !capture(&ExportOptions::default())
            .path("rgb_basis.csv")
            .exists()
    );
}

#[test]
fn the_page_names_every_key_in_code_that_it_uses() {
    let json = capture(&ExportOptions::default()).bundle.json.to_string();
    for key in [
        "shot_event",
        "world_from_camera",
        "tan_half_fov",
        "ray_index",
        "is_point",
        "world_from_object",
    ] {
        assert!(
            README.contains(key) && json.contains(&format!("\"{key}\"")),
            "{key}"
        );
    }
}

#[test]
fn our_own_importer_reads_the_geometry() {
    let exported = exported(SMALL);
    let want = gltf::Want {
        uvs: true,
        textures: true,
        shading: false,
        normals: false,
        bad_vertices: BadVertices::Refuse,
        bad_textures: BadTextures::Refuse,
    };
    let mesh = gltf::load(&exported.path("geometry/000.glb"), None, want)
        .unwrap()
        .mesh;
    assert_eq!(mesh.triangles.len(), 12);
    assert_eq!(mesh.positions.iter().map(|p| p.y).fold(0.0, f64::max), 1.0);
    assert_eq!(mesh.uvs.len(), 1);
}

#[test]
fn a_base_colour_that_gltf_cannot_hold_is_in_the_description() {
    let exported = exported(SMALL);
    let part = &exported.bundle.json["objects"][0]["parts"][0];
    assert_eq!(part["base_colour"], serde_json::json!([0.5, 2.0, 0.25]));
    let want = gltf::Want {
        uvs: false,
        textures: false,
        shading: false,
        normals: false,
        bad_vertices: BadVertices::Refuse,
        bad_textures: BadTextures::Refuse,
    };
    let mesh = gltf::load(&exported.path("geometry/000.glb"), None, want)
        .unwrap()
        .mesh;
    assert_eq!(mesh.materials[0].base_colour, [0.5, 1.0, 0.25]);
}

#[test]
fn textures_go_with_the_geometry() {
    let picture = tempfile::tempdir().unwrap();
    let source = picture.path().join("x.png");
    image::png::write(&source, 2, 1, &[255, 0, 0, 0, 255, 0], &[]).unwrap();
    let bytes = fs::read(&source).unwrap();
    fs::write(picture.path().join("quad.gltf"), textured()).unwrap();
    let text = "camera = { eye = [0, 0, 2], look_at = [0, 0, 0], size = [8, 6] }\n\
                [[object]]\ngltf = \"quad.gltf\"\n[display]\nback_faces = \"two_sided\"\n";
    let exported = exported_with(text, picture.path(), &ExportOptions::default());
    let part = &exported.bundle.json["objects"][0]["parts"][0];
    assert_eq!(part["has_texture"], true);
    assert!(exported.bundle.json["objects"][0]["positions"].is_null());
    let want = gltf::Want {
        uvs: true,
        textures: true,
        shading: false,
        normals: false,
        bad_vertices: BadVertices::Refuse,
        bad_textures: BadTextures::Refuse,
    };
    let loaded = gltf::load(&exported.path("geometry/000.glb"), None, want).unwrap();
    assert_eq!(loaded.images[0].bytes, bytes);
    assert!(loaded.mesh.materials[0].base_colour_texture.is_some());
}

/// A triangle with texture coordinates and the image beside it.
fn textured() -> String {
    let numbers: [f32; 15] = [
        -1.0, -1.0, 0.0, 1.0, -1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 1.0, 0.5, 0.0,
    ];
    let bytes: Vec<u8> = numbers.iter().flat_map(|x| x.to_le_bytes()).collect();
    serde_json::json!({
        "asset": { "version": "2.0" },
        "scene": 0, "scenes": [{ "nodes": [0] }], "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0, "TEXCOORD_0": 1 }, "material": 0 }] }],
        "materials": [{ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }],
        "textures": [{ "source": 0 }], "images": [{ "uri": "x.png" }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
              "min": [-1, -1, 0], "max": [1, 1, 0] },
            { "bufferView": 0, "byteOffset": 36, "componentType": 5126, "count": 3, "type": "VEC2" }
        ],
        "bufferViews": [{ "buffer": 0, "byteLength": 60 }],
        "buffers": [{ "byteLength": 60, "uri": format!("data:application/octet-stream;base64,{}", base64(&bytes)) }],
    })
    .to_string()
}

fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    assert_eq!(bytes.len() % 3, 0);
    let quads = bytes.chunks(3).flat_map(|b| {
        let n = u32::from(b[0]) << 16 | u32::from(b[1]) << 8 | u32::from(b[2]);
        [18, 12, 6, 0].map(|shift| DIGITS[(n >> shift & 63) as usize] as char)
    });
    quads.collect()
}

#[test]
fn the_same_scene_gives_the_same_bytes() {
    let (a, b) = (exported(SMALL), exported(SMALL));
    assert_eq!(a.bundle.json["files"], b.bundle.json["files"]);
}

#[test]
fn masks_and_colours_of_vertices_are_in_the_geometry_and_said() {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let positions = corners.map(|[x, y]| DVec3::new(x, y, 0.0)).to_vec();
    let mut mesh = Mesh::new(positions, vec![[0, 1, 2], [0, 2, 3]], [0.5; 3]);
    let colour = |k: usize| [0.25 * k as f32, 1.0, 0.5, 1.0 - 0.25 * k as f32];
    mesh.colours = (0..4).map(colour).collect();
    mesh.uvs = vec![corners.map(|c| c.map(|x| x as f32)).to_vec()];
    let material = &mut mesh.materials[0];
    (material.alpha, material.alpha_mode) = (0.75, AlphaMode::Mask { cutoff: 0.625 });
    let scene = Builder::from_toml("masked", SMALL).mesh("screen", Arc::new(mesh.clone()));
    let options = ExportOptions {
        reference: false,
        ..ExportOptions::default()
    };
    let exported = exported_scene(&scene.build().unwrap(), &options);
    let parts = |object: usize| &exported.bundle.json["objects"][object]["parts"][0];
    assert_eq!(parts(1)["alpha_cutoff"], 0.625);
    assert_eq!(parts(1)["has_vertex_colours"], true);
    assert!(parts(0)["alpha_cutoff"].is_null());
    assert_eq!(parts(0)["has_vertex_colours"], false);
    let want = gltf::Want {
        uvs: true,
        textures: true,
        shading: false,
        normals: false,
        bad_vertices: BadVertices::Refuse,
        bad_textures: BadTextures::Refuse,
    };
    let again = gltf::load(&exported.path("geometry/001.glb"), None, want).unwrap();
    assert_eq!(again.mesh.colours, mesh.colours);
    let own = &again.mesh.materials[0];
    assert_eq!(
        (own.alpha, own.alpha_mode),
        (0.75, AlphaMode::Mask { cutoff: 0.625 })
    );
}

#[test]
fn a_film_that_is_no_perspective_has_no_tangents() {
    let tangents = |assembly: &str| {
        let text = format!(
            "camera = {{ eye = [0, 1, 4], forward = [0, 0, -1], size = [16, 12], velocity = {{ beta = [0, 0, -0.6] }}, \
             sensor = {{ focal_length = \"1 cm\", width = \"2 cm\", assembly = \"{assembly}\" }} }}\n\
             object = [{{ shape = {{ box = {{ size = [1, 2, 1] }} }} }}]"
        );
        exported(&text).bundle.json["camera"].clone()
    };
    let bell = tangents("bell");
    assert!(bell["tan_half_fov"].is_null());
    // Along the motion γ = 5/4.
    for camera in [bell, tangents("world_length")] {
        let own = camera["sensor"]["own_focal_length"].as_f64().unwrap();
        assert!((own - 0.0125).abs() < 1e-15, "{own}");
        let fov = camera["horizontal_fov_rad"].as_f64().unwrap();
        assert!(((0.5 * fov).tan() - 0.8).abs() < 1e-12, "{fov}");
    }
}

#[test]
fn cubes_that_are_mended_when_read_are_in_the_bundle_as_they_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let held = Cube::new(
        [1, 1, 5, 1],
        CubeSamples::F64(vec![2.0, 0.0, 6.0, -3.0, 1.0]),
    );
    image::npz::write_cube(&folder.path().join("a.npy"), &held.unwrap()).unwrap();
    let written = |keys: &str, cubes: Cubes| {
        let text = format!(
            "{SMALL}[[source]]\ncube = {{ file = \"a.npy\", bin_width = \"1 m\", axes = \"H W T C\"{keys} }}\n"
        );
        let options = ExportOptions {
            reference: false,
            cubes,
            ..ExportOptions::default()
        };
        let exported = exported_with(&text, folder.path(), &options);
        let source = exported.bundle.json["sources"][0].clone();
        let path = exported.path(source["file"].as_str().unwrap());
        let cube = cube::load(&path, Default::default()).unwrap();
        let bins: Vec<f64> = (0..5).map(|bin| cube.total(0, bin)).collect();
        (bins, source["is_copied"] == true, source["axes"].is_null())
    };
    let read = (vec![2.0, 4.0, 6.0, 0.0, 1.0], true, true);
    let keys = ", dead_bins = [1], negative = \"zero\"";
    for cubes in [Cubes::Copied, Cubes::Referenced] {
        assert_eq!(written(keys, cubes), read);
    }
    let unchanged = vec![2.0, 0.0, 6.0, -3.0, 1.0];
    let keep = ", negative = \"keep\"";
    assert_eq!(
        written(keep, Cubes::Copied),
        (unchanged.clone(), true, false)
    );
    assert_eq!(written(keep, Cubes::Referenced), (unchanged, false, false));
}

#[test]
fn a_bundle_says_which_of_several_captures_counts() {
    for (keys, expected) in [("", "blend"), ("[render]\ncaptures = \"first\"\n", "first")] {
        let exported = exported(&format!("{SMALL}{keys}"));
        assert_eq!(exported.bundle.json["scene"]["captures"], expected);
    }
}

#[test]
fn a_warning_about_a_file_that_objects_share_is_given_once() {
    let models = tempfile::tempdir().unwrap();
    let source = models.path().join("x.png");
    image::png::write(&source, 2, 1, &[255, 0, 0, 0, 255, 0], &[]).unwrap();
    let used = "{\"extensionsUsed\":[\"ACME_fur\"],";
    fs::write(
        models.path().join("quad.gltf"),
        textured().replacen('{', used, 1),
    )
    .unwrap();
    let object = "[[object]]\ngltf = \"quad.gltf\"\n";
    let text = format!(
        "camera = {{ eye = [0, 0, 2], look_at = [0, 0, 0], size = [8, 6] }}\n{object}{object}"
    );
    let scene = scene::parse(&text, "test", models.path(), &Overrides::default()).unwrap();
    let target = models.path().join("bundle");
    let done = export(&scene, &target, &ExportOptions::default(), &Silent).unwrap();
    let about = done
        .warnings
        .iter()
        .filter(|text| text.contains("ACME_fur"));
    assert_eq!(about.count(), 1, "{:?}", done.warnings);
}
