//! The contents of glTF files, against positions computed by hand.

use crate::common::png::decode;
use std::path::{Path, PathBuf};

use crate::ALL;
use glam::DVec3;
use nullray::io::gltf::{self, GltfLightKind, Imported, Want};
use nullray::mesh::{AlphaMode, Material, Mesh, TextureFilter, Wrap};
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;
use nullray::render::progress::Silent;
use nullray::render::render;
use nullray::scene::{self, Overrides};

fn valid(file: &str) -> PathBuf {
    Path::new("tests/data/valid").join(file)
}

fn load(file: &str, node: Option<&str>) -> Imported {
    gltf::load(&valid(file), node, ALL).unwrap()
}

/// The corners of all triangles.
fn triangles(mesh: &Mesh) -> Vec<[DVec3; 3]> {
    let indices = 0..mesh.triangles.len() as u32;
    indices.map(|index| mesh.corners(index)).collect()
}

fn assert_near(found: &[[DVec3; 3]], expected: &[[[f64; 3]; 3]]) {
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
        let error = (*found - DVec3::from_array(*expected)).abs().max_element();
        assert!(error <= 1e-14, "{found} is not {expected:?}");
    }
}

const FLAT: [[f64; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

/// The root maps (x, y, z) to (1 − 2y, 2 + 2x, 3 + 2z): a quarter turn about z, doubled, moved. The
/// wheel's matrix maps it to (10 + x, −z, ½ + y) first.
#[test]
fn transforms_multiply_from_the_root_down_and_mirroring_turns_the_winding() {
    let imported = load("hierarchy.glb", None);
    let wheel = [[1.0, 22.0, 4.0], [1.0, 24.0, 4.0], [1.0, 22.0, 6.0]];
    let mirrored = [[1.0, 2.0, 3.0], [-1.0, 2.0, 3.0], [1.0, 0.0, 3.0]];
    let twice = [[1.0, 2.0, 3.0], [1.0, 0.0, 3.0], [3.0, 2.0, 3.0]];
    assert_near(&triangles(&imported.mesh), &[wheel, mirrored, twice]);
    let nodes: Vec<&str> = imported
        .mesh
        .parts
        .iter()
        .map(|p| p.node.as_str())
        .collect();
    assert_eq!(nodes, ["wheel", "mirrored", "twice mirrored"]);
}

#[test]
fn one_node_brings_those_below_it_and_the_transforms_above_it() {
    let all = triangles(&load("hierarchy.glb", None).mesh);
    let below = triangles(&load("hierarchy.glb", Some("mirrored")).mesh);
    assert_eq!(below, all[1..]);
}

#[test]
fn nodes_outside_the_scene_can_be_named() {
    let mesh = load("hierarchy.glb", Some("elsewhere")).mesh;
    assert_eq!(mesh.positions[0], DVec3::new(0.1, 0.0, 0.0));
    assert_eq!(mesh.positions[1].x, 0.1 + 1.0);
}

#[test]
fn an_unknown_node_is_refused_with_the_names_there_are() {
    let error = gltf::load(&valid("hierarchy.glb"), Some("whel"), ALL).unwrap_err();
    let help = error.help();
    assert!(
        help.contains("\"wheel\"") && help.contains("\"elsewhere\""),
        "{help}"
    );
}

#[test]
fn every_topology_gives_its_triangles_with_and_without_indices() {
    for (node, expected) in [
        ("list", vec![[0, 1, 2], [3, 4, 5]]),
        ("indexed list", vec![[0, 1, 2], [2, 1, 3]]),
        ("strip", vec![[0, 1, 2], [1, 3, 2], [2, 3, 4], [3, 5, 4]]),
        (
            "indexed strip",
            vec![[0, 1, 2], [1, 3, 2], [2, 3, 4], [3, 5, 4]],
        ),
        ("fan", vec![[1, 2, 0], [2, 3, 0]]),
        ("indexed fan", vec![[0, 1, 3], [1, 2, 3]]),
    ] {
        assert_eq!(
            load("topologies.glb", Some(node)).mesh.triangles,
            expected,
            "{node}"
        );
    }
}

/// All strips and fans of the file lie counter-clockwise in the plane z = 0.
#[test]
fn strips_and_fans_keep_one_winding() {
    for node in ["strip", "indexed strip", "fan", "indexed fan"] {
        for [a, b, c] in triangles(&load("topologies.glb", Some(node)).mesh) {
            assert!((b - a).cross(c - a).z > 0.0, "{node}: {a} {b} {c}");
        }
    }
}

#[test]
fn points_and_lines_are_skipped_with_a_warning() {
    let imported = load("topologies.glb", None);
    assert_eq!(imported.mesh.parts.len(), 6);
    let skipped = "mesh 6 \"dots\", primitive 0: points and lines have no surface: skipped";
    assert_eq!(imported.warnings, [format!("{skipped} (2 times in all)")]);
}

#[test]
fn parts_cover_all_triangles_and_primitives_share_their_vertices() {
    let mesh = load("textured.glb", None).mesh;
    let runs: Vec<_> = (mesh.parts.iter())
        .map(|p| (p.first_triangle, p.triangles, p.material))
        .collect();
    assert_eq!(runs, [(0, 1, 0), (1, 1, 1), (2, 1, 2), (3, 1, 0)]);
    // The second and the fourth primitive share; the third has texture coordinates of its own.
    assert_eq!(mesh.triangles, [[0, 1, 2], [3, 4, 5], [6, 7, 8], [3, 4, 5]]);
    assert_eq!(mesh.positions.len(), 9);
}

#[test]
fn materials_are_those_in_use_and_so_are_images() {
    let imported = load("textured.glb", None);
    let [plain, default, shifted] = &imported.mesh.materials[..] else {
        panic!("three materials");
    };
    assert_eq!(
        [&plain.name, &default.name, &shifted.name],
        ["plain", "", "shifted"]
    );
    assert_eq!(plain.base_colour, [0.5, 0.25, 0.125]);
    assert_eq!(
        (default.base_colour, &default.base_colour_texture),
        ([1.0; 3], &None)
    );
    assert!(plain.double_sided && !default.double_sided && !shifted.double_sided);
    let plain = plain.base_colour_texture.as_ref().unwrap();
    assert_eq!(
        (plain.image, plain.uv_set, plain.sampler.wrap),
        (0, 1, [Wrap::Clamp, Wrap::Mirror])
    );
    let shifted = shifted.base_colour_texture.as_ref().unwrap();
    assert_eq!(
        (shifted.image, shifted.uv_set, shifted.sampler.wrap),
        (0, 3, [Wrap::Repeat; 2])
    );
    // Neither sampler names a filter.
    assert_eq!(plain.sampler.filter, TextureFilter::Linear);
    assert_eq!(imported.images.len(), 1);
    assert_eq!(imported.images[0].place, "image 1 \"stripes\"");
    let pixels = decode(&imported.images[0].bytes).unwrap();
    assert_eq!(pixels.rgba, [255, 0, 0, 255, 0, 0, 255, 255]);
}

#[test]
fn a_sampler_says_whether_texels_are_blended() {
    // The sampler of the file, and others of as many bytes.
    let before: &[u8] = br#"{"wrapS":33071,"wrapT":33648}"#;
    let bytes = std::fs::read(valid("textured.glb")).unwrap();
    let at = bytes
        .windows(before.len())
        .position(|found| found == before)
        .unwrap();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("sampler.glb");
    let load = |sampler: &str| {
        let mut bytes = bytes.clone();
        bytes[at..at + before.len()].fill(b' ');
        bytes[at..at + sampler.len()].copy_from_slice(sampler.as_bytes());
        std::fs::write(&file, bytes).unwrap();
        let all = gltf::load(&file, None, ALL);
        all.map(|all| {
            all.mesh.materials[0]
                .base_colour_texture
                .as_ref()
                .unwrap()
                .sampler
                .filter
        })
    };
    assert_eq!(
        load(r#"{"magFilter":9728}"#).unwrap(),
        TextureFilter::Nearest
    );
    assert_eq!(
        load(r#"{"magFilter":9729}"#).unwrap(),
        TextureFilter::Linear
    );
    assert_eq!(
        load(r#"{"minFilter":9728}"#).unwrap(),
        TextureFilter::Linear
    );
    let refused = load(r#"{"magFilter":9987}"#).unwrap_err().to_string();
    assert!(refused.contains("filter is not valid in glTF"), "{refused}");
}

#[test]
fn texture_coordinates_are_floats_or_normalized_integers() {
    let mesh = load("textured.glb", None).mesh;
    assert_eq!(mesh.uvs[0][..3], [[0.0, 0.0], [1.0, 0.0], [0.25, 0.75]]);
    for set in [1, 2] {
        assert_eq!(
            mesh.uvs[set][..3],
            [[0.0, 1.0], [0.2, 0.4], [1.0, 0.0]],
            "set {set}"
        );
    }
}

/// Offset (½, ¼) and scale (2, 4) of set 0, which the extension names instead of set 1.
#[test]
fn a_texture_transform_makes_coordinates_of_its_own_and_leaves_the_set_alone() {
    let mesh = load("textured.glb", None).mesh;
    assert_eq!(mesh.uvs[3][6..], [[0.5, 0.25], [2.5, 0.25], [1.0, 3.25]]);
    assert_eq!(mesh.uvs[0][6..], [[0.0, 0.0], [1.0, 0.0], [0.25, 0.75]]);
}

#[test]
fn a_primitive_without_coordinates_has_none_among_those_that_have() {
    let imported = load("textured.glb", None);
    let mesh = &imported.mesh;
    assert!(mesh.uvs.iter().all(|set| set.len() == mesh.positions.len()));
    assert_eq!(mesh.uv(0, 1, [0.25, 0.25]), None);
    assert!(mesh.uv(0, 0, [0.25, 0.25]).is_some());
    assert!(
        imported
            .warnings
            .iter()
            .any(|w| w.contains("lacks the texture coordinates TEXCOORD_1"))
    );
    // Headers tell it already.
    let held = gltf::inspect(&valid("textured.glb"), None).unwrap();
    assert_eq!(held.warnings, imported.warnings);
}

#[test]
fn only_the_sets_that_textures_need_are_read_unless_all_are_wanted() {
    let want = Want { uvs: false, ..ALL };
    let mesh = gltf::load(&valid("textured.glb"), None, want).unwrap().mesh;
    let read: Vec<bool> = mesh.uvs.iter().map(|set| !set.is_empty()).collect();
    // Sets 0 and 1, and the transformed coordinates after them.
    assert_eq!(read, [true, true, true]);
    assert_eq!(
        mesh.materials[2]
            .base_colour_texture
            .as_ref()
            .unwrap()
            .uv_set,
        2
    );
}

#[test]
fn sparse_elements_replace_dense_ones_or_zeros() {
    let mesh = load("sparse.glb", None).mesh;
    let over_dense = [[0.0, 0.0, 0.0], [7.0, 8.0, 9.0], [0.0, 1.0, 0.0]];
    let over_zeros = [[0.0, 0.0, 1.0], [0.0, 0.0, 0.0], [0.0, 1.0, 1.0]];
    assert_near(&triangles(&mesh), &[over_dense, over_zeros]);
}

#[test]
fn interleaved_vertices_are_read_from_another_file_and_from_a_data_uri() {
    for file in ["external.gltf", "embedded.gltf"] {
        let mesh = load(file, None).mesh;
        assert_eq!(mesh.positions, FLAT.map(DVec3::from_array), "{file}");
        assert_eq!(mesh.uvs, [[[0.0, 0.0], [0.25, 0.5], [0.5, 1.0]]], "{file}");
        assert_eq!(mesh.triangles, [[2, 0, 1]], "{file}");
    }
}

#[test]
fn quantized_positions_are_read_where_the_extension_is_used() {
    let mesh = load("quantized.glb", None).mesh;
    let plain = [[0.0; 3], [127.0, -128.0, 64.0], [1.0, 2.0, 3.0]];
    let n = |c: f64| c / 127.0;
    let normalized = [[0.0; 3], [1.0, -1.0, n(64.0)], [n(1.0), n(2.0), n(3.0)]];
    assert_near(&triangles(&mesh), &[plain, normalized]);
}

#[test]
fn a_triangle_without_area_is_kept_and_counted() {
    let json = r#"{"asset":{"version":"2.0"},"nodes":[{"mesh":0}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
        "accessors":[{"bufferView":0,"componentType":5126,"type":"VEC3","count":6}],
        "bufferViews":[{"buffer":0,"byteLength":72}],
        "buffers":[{"byteLength":72,"uri":"data:;base64,DATA"}]}"#;
    let zeros = json.replace("DATA", &"A".repeat(96));
    let imported = gltf::load_bytes(zeros.as_bytes(), "memory", None, ALL).unwrap();
    assert_eq!(imported.mesh.triangles.len(), 2);
    let [warning] = &imported.warnings[..] else {
        panic!("one warning");
    };
    assert!(
        warning.contains("without area, which are never seen (2 times in all)"),
        "{warning}"
    );
}

#[test]
fn inspecting_tells_what_loading_gives_without_the_data() {
    let summary = gltf::inspect(&valid("textured.glb"), None).unwrap();
    assert_eq!(summary.nodes, ["card"]);
    assert_eq!(summary.materials, ["plain", "", "shifted"]);
    assert_eq!(
        (summary.meshes, summary.primitives, summary.images),
        (1, 4, 1)
    );
    assert_eq!(
        (summary.triangles, summary.vertices, summary.uv_sets),
        (4, 12, 3)
    );
    let card = [DVec3::ZERO, DVec3::ONE];
    assert_eq!(summary.bounds, Some(card));
    let summary = gltf::inspect(&valid("hierarchy.glb"), None).unwrap();
    let [least, greatest] = summary.bounds.unwrap();
    assert!(
        (least - DVec3::new(-1.0, 0.0, 3.0)).length() < 1e-14,
        "{least}"
    );
    assert!(
        (greatest - DVec3::new(3.0, 24.0, 6.0)).length() < 1e-14,
        "{greatest}"
    );
    // The buffer's file is not even there.
    let missing = Path::new("tests/data/invalid/buffer-file-missing.gltf");
    assert_eq!(gltf::inspect(missing, None).unwrap().triangles, 1);
}

/// The rig turns −Z to −X, triples and lifts by 5: the camera 2 behind it is at (6, 5, 0).
#[test]
fn a_camera_is_placed_by_its_node_and_scale_drops_out_of_its_axes() {
    let camera = gltf::camera(&valid("cameras.glb"), Some("main")).unwrap();
    assert!(
        (camera.eye - DVec3::new(6.0, 5.0, 0.0)).length() < 1e-14,
        "{}",
        camera.eye
    );
    for (axis, expected) in camera
        .axes
        .iter()
        .zip([DVec3::NEG_Z, DVec3::Y, DVec3::NEG_X])
    {
        assert!(
            (*axis - expected).length() < 1e-15,
            "{axis} is not {expected}"
        );
    }
    // A right angle high, and twice as wide: 2 atan 2.
    assert!((camera.horizontal_fov.unwrap() - 2.0 * 2_f64.atan()).abs() < 1e-7);
    assert_eq!(camera.aspect, Some(2.0));
}

#[test]
fn a_camera_is_found_by_its_own_name_and_below_a_node() {
    let file = valid("cameras.glb");
    let wide = gltf::camera(&file, Some("wide")).unwrap();
    assert_eq!(wide, gltf::camera(&file, Some("main")).unwrap());
    let tall = gltf::camera(&file, Some("tall")).unwrap();
    assert_eq!(gltf::camera(&file, Some("boom")).unwrap(), tall);
    assert_eq!((tall.vertical_fov, tall.horizontal_fov), (1.0, None));
    assert!(
        gltf::camera(&file, Some("plan"))
            .unwrap_err()
            .to_string()
            .contains("orthographic")
    );
    assert!(
        gltf::camera(&file, Some("rig"))
            .unwrap_err()
            .to_string()
            .contains("2 cameras")
    );
    let names = gltf::inspect(&file, None).unwrap().cameras;
    assert_eq!(names, ["main", "tall", "plan"]);
}

/// The file's numbers are those that are written here.
#[test]
fn materials_have_metal_roughness_emission_and_alpha() {
    let imported = load("materials.gltf", None);
    let mesh = &imported.mesh;
    let called = |name: &str| mesh.materials.iter().find(|m| m.name == name).unwrap();
    assert!(called("unlit").unlit);
    let full = called("full");
    assert_eq!((full.base_colour, full.alpha), ([0.5, 0.25, 1.0], 0.75));
    assert_eq!((full.metallic, full.roughness), (0.5, 0.25));
    assert_eq!(full.emissive, [4.0, 2.0, 0.0]);
    assert_eq!(full.alpha_mode, AlphaMode::Mask { cutoff: 0.25 });
    assert!(full.double_sided && !full.unlit);
    // One set in the file, and a list for each of the two transforms.
    let textures = [
        &full.base_colour_texture,
        &full.metallic_roughness_texture,
        &full.emissive_texture,
    ];
    let sets = textures.map(|t| t.as_ref().unwrap().uv_set);
    assert_eq!(sets, [1, 2, 0]);
    assert_eq!(imported.images.len(), 1);
    let part = mesh.parts.iter().find(|p| p.node == "bytes").unwrap();
    let first = |set| {
        mesh.uv(set, part.first_triangle, [0.0; 2])
            .unwrap()
            .to_array()
    };
    assert_eq!(
        [first(0), first(1), first(2)],
        [[0.0, 0.0], [0.5, 0.0], [0.25, 0.0]]
    );
    let plain = &mesh.materials[mesh.parts.last().unwrap().material as usize];
    assert_eq!(*plain, Material::default());
}

#[test]
fn vertex_colours_are_floats_or_normalized_integers_with_alpha_or_without() {
    let mesh = load("materials.gltf", None).mesh;
    let colour = |node: &str| {
        let part = mesh.parts.iter().find(|p| p.node == node).unwrap();
        mesh.colour(part.first_triangle, [0.0; 2])
            .unwrap()
            .map(|c| c as f32)
    };
    assert_eq!(colour("many"), [1.0, 0.5, 0.25, 1.0]);
    assert_eq!(colour("bytes"), [1.0, 0.2, 0.0, 0.4]);
    assert_eq!(colour("words"), [1.0, 0.2, 0.0, 0.4]);
    let middle = mesh.colour(0, [0.5, 0.5]).unwrap();
    assert_eq!(middle, [0.5, 0.5, 0.5, 1.0]);
}

/// What a camera at `eye` sees of a node of materials.gltf straight ahead, where −z is.
fn seen(node: &str, eye: [f64; 3], light: &str) -> ([f64; 3], Plan) {
    let text = format!(
        "[camera]\neye = {eye:?}\nforward = [0, 0, -1]\nhfov = \"0.01 deg\"\nsize = [1, 1]\n\
         [[object]]\ngltf = \"materials.gltf\"\nnode = \"{node}\"\n{light}"
    );
    let folder = valid("");
    let scene = scene::parse(&text, "test scene", &folder, &Overrides::default()).unwrap();
    let plan = Plan::new(&scene, &Request::default()).unwrap();
    let film = render(&Prepared::new(&scene, &plan, &Silent).unwrap(), &Silent).unwrap();
    (film.radiance()[0], plan)
}

/// Beside the first corner of each node's triangle, whose colour is known; neither node has a texture.
#[test]
fn vertex_colours_are_seen_without_textures_and_unlit_materials_without_light() {
    let (words, many) = ([0.001, 0.001, 3.0], [10.001, 0.001, 8.0]);
    let dark = "[sky]\nradiance = 0\n";
    let flash = "[[light]]\nposition = [10, 0, 9]\nemission = { gaussian = { time = \"90 m\", sigma = \"1 m\" } }\n";
    for (node, eye, light, expected) in [
        ("words", words, "", [1.0, 0.2, 0.0]),
        ("words", words, dark, [0.0; 3]),
        ("many", many, "", [1.0, 0.5, 0.25]),
        // It is unlit.
        ("many", many, dark, [1.0, 0.5, 0.25]),
        // All light comes as a pulse, which has not come yet.
        ("many", many, flash, [0.0; 3]),
    ] {
        let (radiance, plan) = seen(node, eye, light);
        for (found, expected) in radiance.iter().zip(expected) {
            assert!(
                (found - expected).abs() < 2e-3,
                "{node} {light}: {radiance:?}"
            );
        }
        let says_unlit = plan.objects[0].radiance[0].contains("KHR_materials_unlit");
        assert_eq!(says_unlit, node == "many" && light == dark);
    }
}

/// The node moves by (0, 0, 5); its second instance is turned by half a turn about z, doubled, and moved by
/// (0, 20, 0).
#[test]
fn instances_are_placed_by_their_own_transforms_first() {
    let mesh = load("materials.gltf", Some("many")).mesh;
    let first = [[10.0, 0.0, 5.0], [11.0, 0.0, 5.0], [10.0, 1.0, 5.0]];
    let second = [[0.0, 20.0, 5.0], [-2.0, 20.0, 5.0], [0.0, 18.0, 5.0]];
    assert_near(&triangles(&mesh), &[first, second]);
    let held = gltf::inspect(&valid("materials.gltf"), Some("many")).unwrap();
    assert_eq!((held.triangles, held.vertices, held.primitives), (2, 6, 2));
}

#[test]
fn hidden_nodes_are_left_out_with_all_below_them_unless_named() {
    let nodes = |node| {
        let mesh = load("materials.gltf", node).mesh;
        let names = mesh.parts.iter().map(|part| part.node.clone());
        names.collect::<Vec<String>>()
    };
    assert_eq!(nodes(None), ["many", "many", "bytes", "words"]);
    assert_eq!(nodes(Some("hidden")), ["hidden", "below"]);
}

#[test]
fn lights_shine_along_the_minus_z_of_their_nodes() {
    let lights = gltf::lights(&valid("materials.gltf")).unwrap();
    let names: Vec<&str> = lights.iter().map(|light| light.name.as_str()).collect();
    assert_eq!(names, ["lamp", "torch", "sun"]);
    assert_eq!(lights[0].kind, GltfLightKind::Point);
    assert_eq!(lights[0].intensity, [8.0, 4.0, 2.0]);
    assert_eq!(lights[0].position, DVec3::new(1.0, 2.0, 3.0));
    // A quarter turn about x takes −z to +y.
    let (inner, outer) = (0.25, 0.5);
    assert_eq!(lights[1].kind, GltfLightKind::Spot { inner, outer });
    assert!((lights[1].direction - DVec3::Y).length() < 1e-7);
    assert_eq!(lights[2].kind, GltfLightKind::Directional);
    assert_eq!(lights[2].direction, DVec3::NEG_Z);
}

#[test]
fn lights_below_hidden_nodes_are_not_listed() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("hidden.gltf");
    let text = std::fs::read_to_string(valid("materials.gltf")).unwrap();
    let mut model: serde_json::Value = serde_json::from_str(&text).unwrap();
    let nodes = model["nodes"].as_array_mut().unwrap();
    let place = |name: &str| nodes.iter().position(|node| node["name"] == name);
    let [below, lamp] = ["below", "lamp"].map(|name| place(name).unwrap());
    let light = nodes[lamp]["extensions"]["KHR_lights_punctual"].clone();
    nodes[below]["extensions"]["KHR_lights_punctual"] = light;
    std::fs::write(&file, model.to_string()).unwrap();
    let held = gltf::inspect(&file, None).unwrap();
    assert_eq!(held.lights, ["lamp", "torch", "sun"]);
}

#[test]
fn a_file_without_anything_to_show_says_what_is_hidden() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gltf");
    let refusal = |nodes: &str| {
        let text = format!(
            r#"{{"asset": {{"version": "2.0"}}, "extensionsUsed": ["KHR_node_visibility"], "nodes": [{nodes}], {}}}"#,
            point()
        );
        std::fs::write(&path, text).unwrap();
        let loaded = gltf::load(&path, None, ALL).unwrap_err();
        let inspected = gltf::inspect(&path, None).unwrap_err();
        assert_eq!(loaded.to_string(), inspected.to_string());
        loaded.to_string()
    };
    let visible = |value: &str| {
        format!(r#"{{"mesh": 0, "extensions": {{"KHR_node_visibility": {{"visible": {value}}}}}}}"#)
    };
    let said = refusal(&visible("false"));
    assert!(
        said.contains("scene: all nodes are hidden (KHR_node_visibility)"),
        "{said}"
    );
    let said = refusal(&format!(r#"{{"children": [1]}}, {}"#, visible("false")));
    assert!(
        said.contains(
            "node 0: there are no triangles here or in the nodes below, apart from hidden ones"
        ),
        "{said}"
    );
    let said = refusal(r#"{"name": "empty"}"#);
    assert!(
        said.contains("there are no triangles") && !said.contains("hidden"),
        "{said}"
    );
    for value in ["\"no\"", "0", "[false]"] {
        let said = refusal(&visible(value));
        assert!(
            said.contains("node 0: `visible` of its KHR_node_visibility is neither true nor false"),
            "{said}"
        );
    }
    // A node that is asked for by name is shown.
    refusal(&visible("false"));
    assert!(gltf::load(&path, Some("node 0"), ALL).is_ok());
}

#[test]
fn what_is_not_read_is_named_once() {
    let warnings = load("materials.gltf", None).warnings;
    for said in [
        "extensionsUsed: the extension \"KHR_materials_clearcoat\" is not supported",
        "animation 0: animations of meshes are not played",
        "node 4 \"lamp\": the file's lights shine in a scene only if it names them, by gltf and node in [[light]]",
        "node 2 \"hidden\": hidden nodes and what is below them are left out",
        "material 1 \"full\": normal maps are not read",
        "material 1 \"full\": occlusion maps are not read",
    ] {
        let count = warnings.iter().filter(|w| w.starts_with(said)).count();
        assert_eq!(count, 1, "{said}: {warnings:?}");
    }
    let held = gltf::inspect(&valid("materials.gltf"), None).unwrap();
    assert_eq!(held.warnings, warnings);
}

#[test]
fn extensions_that_a_file_uses_and_does_not_declare_are_named_too() {
    let text = format!(
        r#"{{"asset": {{"version": "2.0"}}, "extensionsUsed": ["ABC_declared"], "nodes": [{{"mesh": 0, "extensions": {{
        "ABC_declared": {{}}, "XYZ_own": {{"extensions": {{"XYZ_inner": {{}}}}}}, "KHR_node_visibility": {{"visible": true}}}},
        "extras": {{"extensions": {{"XYZ_extra": {{}}}}}}}}], {}}}"#,
        point()
    );
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gltf");
    std::fs::write(&path, text).unwrap();
    let warnings = gltf::inspect(&path, None).unwrap().warnings;
    let own = |name: &str| {
        format!(
            "extensions: the extension \"{name}\", which extensionsUsed lacks, is not supported"
        )
    };
    let declared = "extensionsUsed: the extension \"ABC_declared\" is not supported".to_owned();
    assert_eq!(warnings, [declared, own("XYZ_inner"), own("XYZ_own")]);
}

#[test]
fn texture_coordinates_and_colours_without_data_are_zeros() {
    let text = r#"{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}}]}],
        "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3, "min": [0, 0, 0], "max": [1, 1, 0]},
                      {"componentType": 5126, "type": "VEC2", "count": COUNT}]}"#;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gltf");
    let load = |count: &str| {
        std::fs::write(&path, text.replace("COUNT", count)).unwrap();
        gltf::load(&path, None, ALL)
    };
    assert_eq!(load("3").unwrap().mesh.uvs, [vec![[0.0; 2]; 3]]);
    // No more of them than positions, which have data.
    let error = load("4000000000").unwrap_err().to_string();
    assert!(error.contains("4000000000"), "{error}");
}

/// A mesh of one triangle, all of whose corners are at the origin.
fn point() -> String {
    let zeros = "A".repeat(48);
    format!(
        r#""meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}}}]}}],
        "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}}],
        "bufferViews": [{{"buffer": 0, "byteLength": 36}}],
        "buffers": [{{"byteLength": 36, "uri": "data:application/octet-stream;base64,{zeros}"}}]"#
    )
}

#[test]
fn thousands_of_extensions_are_one_warning() {
    let names: Vec<String> = (0..5000).map(|i| format!("\"X_{i:04}\"")).collect();
    let text = format!(
        r#"{{"asset": {{"version": "2.0"}}, "extensionsUsed": [{}], "nodes": [{{"mesh": 0}}], {}}}"#,
        names.join(", "),
        point()
    );
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gltf");
    std::fs::write(&path, text).unwrap();
    let warnings = gltf::inspect(&path, None).unwrap().warnings;
    assert_eq!(warnings.len(), 21, "{warnings:?}");
    assert!(warnings[0].contains("\"X_0000\""), "{}", warnings[0]);
    assert!(
        warnings[20].contains("4980 more extensions"),
        "{}",
        warnings[20]
    );
}

/// An element that no byte of the file stands for costs memory all the same, and so does an empty node.
#[test]
fn what_costs_memory_and_no_bytes_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gltf");
    let sparse = |count: usize| {
        format!(
            r#"{{"asset": {{"version": "2.0"}}, "nodes": [{{"mesh": 0}}],
            "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}}}]}}],
            "accessors": [{{"componentType": 5126, "count": {count}, "type": "VEC3", "sparse": {{"count": 3,
            "indices": {{"bufferView": 0, "componentType": 5125}}, "values": {{"bufferView": 1}}}}}}],
            "bufferViews": [{{"buffer": 0, "byteLength": 12}}, {{"buffer": 0, "byteOffset": 12, "byteLength": 36}}],
            "buffers": [{{"byteLength": 48, "uri": "a.bin"}}]}}"#
        )
    };
    let nodes = |count: usize, node: &str| {
        let nodes = vec![node; count].join(",");
        format!(
            r#"{{"asset": {{"version": "2.0"}}, "nodes": [{{"mesh": 0}}, {nodes}], {}}}"#,
            point()
        )
    };
    for (text, said) in [
        (sparse(999_999), None),
        (
            sparse(1_100_000),
            Some("of its 1100000 elements 3 are given"),
        ),
        (nodes(100_000, "{}"), None),
        (nodes(200_000, "{}"), Some("200009 objects")),
        (nodes(200_000, r#"{"name":""}"#), None),
    ] {
        std::fs::write(&path, text).unwrap();
        match (gltf::inspect(&path, None), said) {
            (Ok(_), None) => {}
            (Err(error), Some(said)) => {
                let text = error.to_string();
                assert!(text.contains(said), "{text}");
            }
            (other, said) => panic!("{:?}, not {said:?}", other.map(|held| held.vertices)),
        }
    }
}

/// What is written for other programs and read again is lit as it was.
#[test]
fn written_meshes_are_unlit_where_they_were() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("again.glb");
    for (node, is_unlit) in [("many", true), ("words", false)] {
        gltf::save(&path, "again", &load("materials.gltf", Some(node)).mesh).unwrap();
        let again = gltf::load(&path, None, ALL).unwrap().mesh;
        assert_eq!(again.materials[0].unlit, is_unlit, "{node}");
    }
}
