//! Small .npy and .glb files for tests.

use std::path::Path;

/// Writes an array of f64 as .npy (version 1.0, C order).
pub fn npy(path: &Path, shape: &[usize], values: impl IntoIterator<Item = f64>) {
    let dims: String = shape.iter().map(|n| format!("{n}, ")).collect();
    let mut header =
        format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({dims}), }}").into_bytes();
    // Magic, version, length and header together are a multiple of 64 bytes and end with a newline.
    header.resize((header.len() + 11).next_multiple_of(64) - 11, b' ');
    header.push(b'\n');
    let mut file = b"\x93NUMPY\x01\x00".to_vec();
    file.extend((header.len() as u16).to_le_bytes());
    file.extend(header);
    file.extend(values.into_iter().flat_map(f64::to_le_bytes));
    std::fs::write(path, file).unwrap();
}

/// What a .glb of [`glb`] holds.
pub struct Quad<'a> {
    /// Texture coordinates, NaN in place of numbers.
    pub nan_uvs: bool,
    /// The bytes of its image, the only texture: that of the base colour where no material says otherwise.
    pub image: Option<&'a [u8]>,
    /// The material in JSON, in place of one with the base colour (0.5, 0.25, 0.125).
    pub material: Option<&'a str>,
    /// Indices of triangles into the corners (−1,−1), (1,−1), (1,1), (−1,1) of the plane z = 0.
    pub indices: &'a [u16],
}

impl Quad<'_> {
    /// A square that faces +z.
    pub const PLAIN: Quad<'static> = Quad {
        nan_uvs: false,
        image: None,
        material: None,
        indices: &[0, 1, 2, 0, 2, 3],
    };
}

/// Writes a square of one material "paint".
pub fn glb(path: &Path, quad: &Quad) {
    let floats = |v: &[f32]| v.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
    let positions = floats(&[-1., -1., 0., 1., -1., 0., 1., 1., 0., -1., 1., 0.]);
    let uvs = match quad.nan_uvs {
        true => floats(&[f32::NAN; 8]),
        false => floats(&[0., 1., 1., 1., 1., 0., 0., 0.]),
    };
    let indices: Vec<u8> = quad.indices.iter().flat_map(|i| i.to_le_bytes()).collect();
    let mut bin = Vec::new();
    let mut views = Vec::new();
    for part in [&positions[..], &uvs, &indices, quad.image.unwrap_or(&[0])] {
        views.push(serde_json::json!({
            "buffer": 0, "byteOffset": bin.len(), "byteLength": part.len()
        }));
        bin.extend(part);
        bin.resize(bin.len().next_multiple_of(4), 0);
    }
    let mut paint = serde_json::json!({ "baseColorFactor": [0.5, 0.25, 0.125, 1.0] });
    let mut json = serde_json::json!({
        "asset": { "version": "2.0" },
        "scene": 0, "scenes": [{ "nodes": [0] }], "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{
            "attributes": { "POSITION": 0, "TEXCOORD_0": 1 }, "indices": 2, "material": 0
        }]}],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3",
              "min": [-1, -1, 0], "max": [1, 1, 0] },
            { "bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2" },
            { "bufferView": 2, "componentType": 5123, "count": quad.indices.len(), "type": "SCALAR" }
        ],
        "buffers": [{ "byteLength": bin.len() }],
        "bufferViews": views,
    });
    if quad.image.is_some() {
        paint["baseColorTexture"] = serde_json::json!({ "index": 0 });
        json["textures"] = serde_json::json!([{ "source": 0 }]);
        json["images"] = serde_json::json!([{ "bufferView": 3, "mimeType": "image/png" }]);
    }
    let paint = serde_json::json!({ "name": "paint", "pbrMetallicRoughness": paint });
    let material = quad
        .material
        .map(|text| serde_json::from_str(text).unwrap());
    json["materials"] = serde_json::json!([material.unwrap_or(paint)]);
    std::fs::write(path, container(json.to_string().into_bytes(), &bin)).unwrap();
}

fn container(mut json: Vec<u8>, bin: &[u8]) -> Vec<u8> {
    json.resize(json.len().next_multiple_of(4), b' ');
    let word = |n: usize| (n as u32).to_le_bytes();
    let mut file = b"glTF".to_vec();
    file.extend(word(2));
    file.extend(word(28 + json.len() + bin.len()));
    for (kind, chunk) in [(b"JSON", &json[..]), (b"BIN\0", bin)] {
        file.extend(word(chunk.len()));
        file.extend(kind);
        file.extend(chunk);
    }
    file
}
