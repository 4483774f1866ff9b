//! Vertex normals in glTF files, against vectors computed by hand.

use std::path::{Path, PathBuf};

use crate::ALL;
use glam::DVec3;
use nullray::io::gltf::{self, Imported, Want};
use nullray::mesh::{Material, Mesh, Part};
use nullray::scene::model::BadVertices;

/// The normals of the file, of length 2, 5 and 3.
const NORMALS: [[f32; 3]; 3] = [[0.0, 0.0, 2.0], [3.0, 0.0, 4.0], [1.0, 2.0, 2.0]];

/// A triangle with `normals`, whose accessor is `accessor`: `floats`, `bytes` and `sparse` are bufferViews 1, 2, and 3 with 4. Nodes: "plain",
/// "stretched", which is mirrored along x, too, and "bare", whose primitive has none.
fn file(folder: &Path, normals: [[f32; 3]; 3], accessor: &str, extensions: &str) -> PathBuf {
    let mut bytes = Vec::new();
    let places = [[0f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    for x in places.iter().chain(&normals).flatten() {
        bytes.extend(x.to_le_bytes());
    }
    // (0, 0, 1), (0, −1, 0) and (1, 0, 0) as normalized bytes, each with a byte beside it.
    bytes.extend([0, 0, 127, 0, 0, 129, 0, 0, 127, 0, 0, 0]);
    // The place and the value of a sparse one.
    bytes.extend([1, 0, 0, 0]);
    bytes.extend([0f32, 1.0, 0.0].iter().flat_map(|x| x.to_le_bytes()));
    std::fs::write(folder.join("normals.bin"), &bytes).unwrap();
    let text = format!(
        r#"{{ "asset": {{ "version": "2.0" }}, {extensions} "scene": 0, "scenes": [{{ "nodes": [0, 1, 2] }}],
        "nodes": [{{ "name": "plain", "mesh": 0 }}, {{ "name": "stretched", "mesh": 0, "scale": [-2, 1, 3] }}, {{ "name": "bare", "mesh": 1 }}],
        "meshes": [{{ "primitives": [{{ "attributes": {{ "POSITION": 0, "NORMAL": 1 }} }}] }},
                   {{ "primitives": [{{ "attributes": {{ "POSITION": 0 }} }}] }}],
        "buffers": [{{ "uri": "normals.bin", "byteLength": {} }}],
        "bufferViews": [{{ "buffer": 0, "byteLength": 36 }}, {{ "buffer": 0, "byteOffset": 36, "byteLength": 36 }},
            {{ "buffer": 0, "byteOffset": 72, "byteLength": 12, "byteStride": 4 }},
            {{ "buffer": 0, "byteOffset": 84, "byteLength": 1 }}, {{ "buffer": 0, "byteOffset": 88, "byteLength": 12 }}],
        "accessors": [{{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" }}, {{ {accessor} }}] }}"#,
        bytes.len()
    );
    let path = folder.join("normals.gltf");
    std::fs::write(&path, text).unwrap();
    path
}

const FLOATS: &str = r#""bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC3""#;

fn load(accessor: &str, extensions: &str) -> nullray::Result<Imported> {
    let folder = tempfile::tempdir().unwrap();
    gltf::load(
        &file(folder.path(), NORMALS, accessor, extensions),
        None,
        ALL,
    )
}

fn assert_near(found: &[[f32; 3]], expected: &[[f64; 3]]) {
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        let error = DVec3::from(found.map(f64::from)) - DVec3::from_array(*expected);
        assert!(error.length() < 1e-7, "{found:?} is not {expected:?}");
    }
}

#[test]
fn normals_are_unit_vectors_and_go_by_the_inverse_transpose_of_their_nodes() {
    let imported = load(FLOATS, "").unwrap();
    assert!(imported.warnings.is_empty(), "{:?}", imported.warnings);
    // By (−x/2, y, z/3): (0, 0, 2/3), (−1.5, 0, 4/3) and (−1/2, 2, 2/3); and those of a primitive without any are 0.
    let (a, b) = ((2.25f64 + 16.0 / 9.0).sqrt(), (4.25f64 + 4.0 / 9.0).sqrt());
    let expected = [
        [0.0, 0.0, 1.0],
        [0.6, 0.0, 0.8],
        [1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0],
        [0.0, 0.0, 1.0],
        [-1.5 / a, 0.0, 4.0 / 3.0 / a],
        [-0.5 / b, 2.0 / b, 2.0 / 3.0 / b],
        [0.0; 3],
        [0.0; 3],
        [0.0; 3],
    ];
    assert_near(&imported.mesh.normals, &expected);
    imported.mesh.check().unwrap();
}

#[test]
fn normals_are_read_where_they_are_wanted_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = file(folder.path(), NORMALS, &FLOATS.replace("VEC3", "VEC2"), "");
    let without = Want {
        normals: false,
        ..ALL
    };
    assert!(
        gltf::load(&path, None, without)
            .unwrap()
            .mesh
            .normals
            .is_empty()
    );
    let error = gltf::load(&path, None, ALL).unwrap_err();
    assert!(
        error.to_string().contains("normals of type Vec2"),
        "{error}"
    );
    let path = file(folder.path(), NORMALS, FLOATS, "");
    let has_normals = |node| gltf::inspect(&path, node).unwrap().has_normals;
    assert!(has_normals(None) && has_normals(Some("plain")) && !has_normals(Some("bare")));
}

#[test]
fn quantized_normals_need_their_extension() {
    let bytes =
        r#""bufferView": 2, "componentType": 5120, "normalized": true, "count": 3, "type": "VEC3""#;
    let error = load(bytes, "").unwrap_err().to_string();
    assert!(error.contains("without KHR_mesh_quantization"), "{error}");
    let used = r#""extensionsUsed": ["KHR_mesh_quantization"],"#;
    let normals = load(bytes, used).unwrap().mesh.normals;
    assert_near(
        &normals[..3],
        &[[0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]],
    );
    let error = load(&bytes.replace("true", "false"), used).unwrap_err();
    assert!(
        error.to_string().contains("normals of type Vec3"),
        "{error}"
    );
}

#[test]
fn sparse_normals_are_read_and_those_of_length_0_are_told() {
    let sparse = r#""componentType": 5126, "count": 3, "type": "VEC3", "sparse": { "count": 1,
        "indices": { "bufferView": 3, "componentType": 5121 }, "values": { "bufferView": 4 } }"#;
    let imported = load(sparse, "").unwrap();
    assert_near(
        &imported.mesh.normals[..3],
        &[[0.0; 3], [0.0, 1.0, 0.0], [0.0; 3]],
    );
    // Two of three, at two nodes.
    let told = "mesh 0, primitive 0, accessor 1: normals of length 0: triangles that have one are shaded as flat (4 times in all)";
    assert_eq!(imported.warnings, [told]);
}

#[test]
fn normals_that_are_too_few_or_not_finite_are_refused_with_their_place() {
    let error = load(&FLOATS.replace("\"count\": 3", "\"count\": 2"), "").unwrap_err();
    let said = error.to_string();
    assert!(
        said.contains("NORMAL has 2 elements and POSITION 3"),
        "{said}"
    );
    let folder = tempfile::tempdir().unwrap();
    let mut normals = NORMALS;
    normals[1][0] = f32::NAN;
    let path = file(folder.path(), normals, FLOATS, "");
    let error = gltf::load(&path, None, ALL).unwrap_err();
    let said = error.to_string();
    for part in [
        "normals.gltf",
        "mesh 0, primitive 0, accessor 1, vertex 1",
        "the normal NaN, 0, 4 is not finite",
    ] {
        assert!(said.contains(part), "{said}");
    }
    let drop = Want {
        bad_vertices: BadVertices::Drop,
        ..ALL
    };
    let imported = gltf::load(&path, None, drop).unwrap();
    let dropped = "triangles with a vertex that is not finite are dropped (2 times in all)";
    assert!(
        imported.warnings.iter().any(|said| said.ends_with(dropped)),
        "{:?}",
        imported.warnings
    );
    assert_eq!(imported.warnings.len(), 1);
    assert!(
        imported
            .mesh
            .normals
            .iter()
            .flatten()
            .all(|x| x.is_finite())
    );
}

#[test]
fn a_mesh_that_is_written_and_read_again_has_its_normals() {
    let place = |x: f64, y: f64| DVec3::new(x, y, 0.0);
    let part = |first_triangle: u32| Part {
        first_triangle,
        triangles: 1,
        material: 0,
        node: "quad".into(),
    };
    // The second triangle has a corner without one, and is flat.
    let mesh = Mesh {
        positions: vec![
            place(0.0, 0.0),
            place(1.0, 0.0),
            place(0.0, 1.0),
            place(1.0, 1.0),
        ],
        normals: vec![[0.0, 0.0, 1.0], [0.6, 0.0, 0.8], [0.0, -0.6, 0.8], [0.0; 3]],
        triangles: vec![[0, 1, 2], [1, 3, 2]],
        parts: vec![part(0), part(1)],
        materials: vec![Material::matte([1.0; 3])],
        ..Mesh::default()
    };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("quad.glb");
    gltf::save(&path, "quad", &mesh).unwrap();
    let again = gltf::load(&path, None, ALL).unwrap().mesh;
    let normals =
        |mesh: &Mesh, triangle: usize| mesh.triangles[triangle].map(|v| mesh.normals[v as usize]);
    assert_eq!(normals(&again, 0), normals(&mesh, 0));
    assert_eq!(normals(&again, 1), [[0.0; 3]; 3]);
}
