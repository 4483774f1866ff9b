//! Vertices that skins and morph targets place, and transforms in double precision, against positions computed by hand.

use std::path::Path;

use crate::ALL;
use glam::DVec3;
use nullray::Result;
use nullray::io::gltf::{self, Imported, Want};
use nullray::scene::model::BadVertices;

/// Numbers of one kind.
enum Numbers<'n> {
    Floats(&'n [f32]),
    Bytes(&'n [u8]),
}

use Numbers::{Bytes, Floats};

/// A file whose accessor k has the numbers of entry k, with this type and the JSON that follows.
fn load(
    arrays: &[(&str, Numbers)],
    rest: &str,
    node: Option<&str>,
    want: Want,
) -> Result<Imported> {
    let (mut bytes, mut views, mut accessors) = (Vec::new(), Vec::new(), Vec::new());
    for (view, (kind, numbers)) in arrays.iter().enumerate() {
        let start = bytes.len();
        let (component, length) = match numbers {
            Floats(all) => {
                bytes.extend(all.iter().flat_map(|x| x.to_le_bytes()));
                (5126, all.len())
            }
            Bytes(all) => {
                bytes.extend(*all);
                (5121, all.len())
            }
        };
        let size = match kind.split('"').next().unwrap_or_default() {
            "MAT4" => 16,
            "VEC4" => 4,
            "VEC3" => 3,
            _ => 1,
        };
        views.push(format!(
            r#"{{"buffer": 0, "byteOffset": {start}, "byteLength": {}}}"#,
            bytes.len() - start
        ));
        accessors.push(format!(
            r#"{{"bufferView": {view}, "componentType": {component}, "count": {}, "type": "{kind}"}}"#,
            length / size
        ));
        bytes.resize(bytes.len().next_multiple_of(4), 0);
    }
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.bin"), &bytes).unwrap();
    let text = format!(
        r#"{{"asset": {{"version": "2.0"}}, "buffers": [{{"uri": "a.bin", "byteLength": {}}}], "bufferViews": [{}],
        "accessors": [{}], {rest}}}"#,
        bytes.len(),
        views.join(","),
        accessors.join(",")
    );
    let path = folder.path().join("a.gltf");
    std::fs::write(&path, text).unwrap();
    gltf::load(&path, node, want)
}

fn assert_near(found: &[DVec3], expected: &[[f64; 3]]) {
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        let error = (*found - DVec3::from_array(*expected)).length();
        assert!(error < 1e-7, "{found} is not {expected:?}");
    }
}

fn wide(normals: &[[f32; 3]]) -> Vec<DVec3> {
    normals
        .iter()
        .map(|n| DVec3::from(n.map(f64::from)))
        .collect()
}

const CORNERS: [f32; 9] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
const NORMALS: [f32; 9] = [0.0, 0.0, 1.0, 1.0, 1.0, 0.0, 1.0, 0.0, 0.0];
/// The identity, and (x, y, z) ↦ (2x, y, z − 1).
const INVERSE: [f32; 32] = [
    1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, //
    2.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, -1.0, 1.0,
];

/// A triangle that follows a hip at (0, 1, 0) and a knee, turned by a quarter about z, at (0, 0, 2) from it; `hip` is more of the hip.
fn skinned(
    joints: &[u8],
    weights: Numbers,
    hip: &str,
    attributes: &str,
    want: Want,
) -> Result<Imported> {
    let of_weights = match weights {
        Floats(_) => "VEC4",
        Bytes(_) => "VEC4\", \"normalized\": true, \"name\": \"",
    };
    load(
        &[
            ("VEC3", Floats(&CORNERS)),
            ("VEC3", Floats(&NORMALS)),
            ("VEC4", Bytes(joints)),
            (of_weights, weights),
            ("MAT4", Floats(&INVERSE)),
            ("VEC4", Bytes(&[1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0])),
            (
                "VEC4",
                Floats(&[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.5, 0.0, 0.0, 0.0]),
            ),
        ],
        &format!(
            r#""scenes": [{{"nodes": [0, 1]}}], "scene": 0,
            "nodes": [{{"mesh": 0, "skin": 0, "translation": [100, 0, 0]}},
                {{"name": "hip", "children": [2], "translation": [0, 1, 0]{hip}}},
                {{"translation": [0, 0, 2], "rotation": [0, 0, 0.7071067811865476, 0.7071067811865476]}}],
            "skins": [{{"joints": [1, 2], "inverseBindMatrices": 4, "name": "legs"}}],
            "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0, "NORMAL": 1, {attributes}}}}}]}}]"#
        ),
        None,
        want,
    )
}

const ONE_SET: &str = r#""JOINTS_0": 2, "WEIGHTS_0": 3"#;

/// The hip moves by (0, 1, 0); the knee maps (x, y, z) to (−y, 1 + 2x, 1 + z), and normals by the inverse transpose of [[0, −1], [2, 0]]. Half
/// and half gives [[½, −½], [1, ½]], whose inverse transpose maps (1, 0) to (½, ½)/¾.
#[test]
fn vertices_follow_the_joints_of_their_skin_by_weights() {
    let expected = [[0.0, 1.0, 0.0], [0.0, 3.0, 1.0], [-0.5, 1.5, 0.5]];
    let (a, b) = (1.25f64.sqrt(), 0.5f64.sqrt());
    let normals = [[0.0, 0.0, 1.0], [-1.0 / a, 0.5 / a, 0.0], [b, b, 0.0]];
    // 9 is no joint, and has no weight.
    let joints = [0, 9, 0, 0, 1, 9, 0, 0, 0, 1, 0, 0];
    let floats = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.5, 0.5, 0.0, 0.0];
    // In bytes, the sum of 128 and 128 is not quite 1.
    let bytes = [255, 0, 0, 0, 255, 0, 0, 0, 128, 128, 0, 0];
    let of_set_0 = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.5, 0.0, 0.0, 0.0];
    let two = r#""JOINTS_0": 2, "WEIGHTS_0": 3, "JOINTS_1": 5, "WEIGHTS_1": 6"#;
    for (weights, attributes) in [
        (Floats(&floats), ONE_SET),
        (Bytes(&bytes), ONE_SET),
        (Floats(&of_set_0), two),
    ] {
        let imported = skinned(&joints, weights, "", attributes, ALL).unwrap();
        assert!(imported.warnings.is_empty(), "{:?}", imported.warnings);
        assert_near(&imported.mesh.positions, &expected);
        assert_near(&wide(&imported.mesh.normals), &normals);
        assert_eq!(imported.mesh.triangles, [[0, 1, 2]]);
    }
}

#[test]
fn a_mirrored_skeleton_turns_the_winding() {
    let weights = [1.0, 0.0, 0.0, 0.0].repeat(3);
    let hip = r#", "scale": [-1, 1, 1]"#;
    let mesh = skinned(&[0; 12], Floats(&weights), hip, ONE_SET, ALL)
        .unwrap()
        .mesh;
    assert_near(
        &mesh.positions,
        &[[0.0, 1.0, 0.0], [-1.0, 1.0, 0.0], [0.0, 2.0, 0.0]],
    );
    assert_eq!(mesh.triangles, [[0, 2, 1]]);
}

#[test]
fn weights_are_divided_by_their_sum_and_vertices_without_any_follow_the_first_joint() {
    let weights = [3.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0];
    let joints = [0, 1, 0, 0, 1, 1, 1, 1, 0, 0, 0, 0];
    let imported = skinned(&joints, Floats(&weights), "", ONE_SET, ALL).unwrap();
    // ¾ (0, 1, 0) + ¼ (0, 1, 1).
    assert_near(
        &imported.mesh.positions,
        &[[0.0, 1.0, 0.25], [1.0, 1.0, 0.0], [0.0, 2.0, 0.0]],
    );
    let place = "mesh 0, primitive 0, accessor 3";
    let told = [
        format!("{place}: vertices without weights follow the first joint of their skin"),
        format!("{place}: weights of joints that do not add up to 1 are divided by their sum"),
    ];
    assert_eq!(imported.warnings, told);
}

#[test]
fn joints_that_do_not_exist_and_bad_weights_are_refused_with_their_place() {
    let one = [1.0, 0.0, 0.0, 0.0].repeat(3);
    let mut bad = one.clone();
    bad[4] = -0.5;
    let mut joints = [0; 12];
    joints[8] = 2;
    let only_joints = r#""JOINTS_0": 2"#;
    for (joints, weights, attributes, place, what) in [
        (
            joints,
            &one,
            ONE_SET,
            "mesh 0, primitive 0, accessor 2, vertex 2",
            "it follows joint 2 of a skin with 2 joints",
        ),
        (
            [0; 12],
            &bad,
            ONE_SET,
            "mesh 0, primitive 0, accessor 3, vertex 1",
            "the weights of its joints are -0.5, 0, 0, 0",
        ),
        (
            [0; 12],
            &one,
            only_joints,
            "mesh 0, primitive 0",
            "it has JOINTS_0 and no WEIGHTS_0",
        ),
    ] {
        let error = skinned(&joints, Floats(weights), "", attributes, ALL).unwrap_err();
        let said = error.to_string();
        assert!(said.contains(place) && said.contains(what), "{said}");
    }
    let drop = Want {
        bad_vertices: BadVertices::Drop,
        ..ALL
    };
    let dropped = skinned(&[0; 12], Floats(&bad), "", ONE_SET, drop).unwrap();
    assert_eq!(dropped.mesh.triangles, [[0; 3]]);
    let warnings = &dropped.warnings;
    assert!(
        warnings[0].ends_with("not finite are dropped"),
        "{warnings:?}"
    );
}

/// Of target 0, a quarter of (0, 0, 4) at one vertex and of (4, 0, 0) at one normal; of target 1, (1, 2, 3) everywhere.
#[test]
fn morph_targets_displace_by_the_weights_of_the_node_or_else_of_the_mesh() {
    let normals = [0.0, 0.0, 1.0].repeat(3);
    let arrays = || {
        [
            ("VEC3", Floats(&CORNERS)),
            ("VEC3", Floats(&normals)),
            ("VEC3", Floats(&[0.0, 0.0, 4.0])),
            ("SCALAR", Bytes(&[1])),
            (
                "VEC3\", \"sparse\": {\"count\": 1, \"indices\": {\"bufferView\": 3, \"componentType\": 5121}, \"values\": {\"bufferView\": 2}}, \"name\": \"",
                Floats(&[0.0; 9]),
            ),
            (
                "VEC3",
                Floats(&[4.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
            ),
            (
                "VEC3",
                Floats(&[1.0, 2.0, 3.0, 1.0, 2.0, 3.0, 1.0, 2.0, 3.0]),
            ),
        ]
    };
    let rest = r#""nodes": [{"name": "mesh", "mesh": 0}, {"name": "node", "mesh": 0, "weights": [0, 1]},
            {"name": "none", "mesh": 0, "weights": [0, 0]}, {"name": "few", "mesh": 0, "weights": [0.25]}],
        "meshes": [{"weights": [0.25, 0], "primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1},
            "targets": [{"POSITION": 4, "NORMAL": 5}, {"POSITION": 6}]}]}]"#;
    let flat = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let raised = [[0.0, 0.0, 0.0], [1.0, 0.0, 1.0], [0.0, 1.0, 0.0]];
    let moved = [[1.0, 2.0, 3.0], [2.0, 2.0, 3.0], [1.0, 3.0, 3.0]];
    let half = 0.5f64.sqrt();
    for (node, expected, first) in [
        ("mesh", raised, [half, 0.0, half]),
        ("node", moved, [0.0, 0.0, 1.0]),
        ("none", flat, [0.0, 0.0, 1.0]),
    ] {
        let imported = load(&arrays(), rest, Some(node), ALL).unwrap();
        assert!(imported.warnings.is_empty(), "{:?}", imported.warnings);
        assert_near(&imported.mesh.positions, &expected);
        assert_near(&wide(&imported.mesh.normals[..1]), &[first]);
    }
    let few = load(&arrays(), rest, Some("few"), ALL).unwrap();
    assert_near(&few.mesh.positions, &raised);
    let told = "node 3 \"few\": it has 1 weights for 2 morph targets: missing weights are 0";
    assert_eq!(few.warnings, [told]);
    // What no node uses is not read.
    let broken = rest.replace("\"POSITION\": 6", "\"POSITION\": 3");
    assert!(load(&arrays(), &broken, Some("mesh"), ALL).is_ok());
    let error = load(&arrays(), &broken, Some("node"), ALL).unwrap_err();
    let place = "mesh 0, primitive 0, target 1, accessor 3";
    assert!(error.to_string().contains(place), "{error}");
}

/// Single precision has steps of half a metre at the radius of the Earth.
#[test]
fn transforms_have_double_precision() {
    let arrays = || [("VEC3", Floats(&CORNERS))];
    let x = 6_378_137.123_456_7;
    for transform in [
        format!(r#""translation": [{x}, 0, 0]"#),
        format!(r#""matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, {x}, 0, 0, 1]"#),
    ] {
        let rest = format!(
            r#""nodes": [{{"mesh": 0, {transform}}}], "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}}}]}}]"#
        );
        let mesh = load(&arrays(), &rest, None, ALL).unwrap().mesh;
        assert_eq!(mesh.positions[0], DVec3::new(x, 0.0, 0.0), "{transform}");
    }
}

#[test]
fn animations_of_joints_are_not_played_and_that_is_told() {
    let animated = |joint: usize| {
        let rest = format!(
            r#""nodes": [{{"mesh": 0, "skin": 0}}, {{}}, {{}}], "skins": [{{"joints": [1]}}],
            "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0, {ONE_SET}}}}}]}}],
            "animations": [{{"channels": [{{"sampler": 0, "target": {{"node": {joint}, "path": "rotation"}}}}],
                "samplers": [{{"input": 0, "output": 0}}]}}]"#
        );
        let arrays = [
            ("VEC3", Floats(&CORNERS)),
            ("VEC3", Floats(&CORNERS)),
            ("VEC4", Bytes(&[0; 12])),
            (
                "VEC4",
                Floats(&[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]),
            ),
        ];
        load(&arrays, &rest, None, ALL).unwrap().warnings
    };
    let [told] = &animated(1)[..] else {
        panic!("one warning");
    };
    let said = "animation 0: animations of meshes are not played: nodes, and joints of skins, stay as they are at rest";
    assert!(told.starts_with(said), "{told}");
    assert!(animated(2)[0].contains("no mesh moves with it"));
}

#[test]
fn inspecting_a_skinned_model_gives_no_bounds_and_counts_the_memory_of_its_joints() {
    let text = r#"{"asset": {"version": "2.0"}, "nodes": [{"mesh": 0, "skin": 0}], "skins": [{"joints": [0]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "JOINTS_0": 1, "WEIGHTS_0": 2}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 1]},
            {"bufferView": 0, "componentType": 5121, "count": 3, "type": "VEC4"},
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC4"}],
        "bufferViews": [{"buffer": 0, "byteLength": 48}], "buffers": [{"byteLength": 48, "uri": "a.bin"}]}"#;
    let folder = tempfile::tempdir().unwrap();
    let inspect = |text: &str| {
        let path = folder.path().join("a.gltf");
        std::fs::write(Path::new(&path), text).unwrap();
        gltf::inspect(&path, None).unwrap()
    };
    let held = inspect(text);
    // Joints and weights of a vertex: eight numbers of eight bytes.
    assert_eq!((held.bounds, held.placing), (None, 3 * 64));
    let plain = inspect(&text.replace(", \"skin\": 0", ""));
    assert_eq!(plain.bounds, Some([DVec3::ZERO, DVec3::ONE]));
    assert_eq!(plain.placing, 0);
}
