//! A reader of bundles that shares no code with the program: JSON, GLB, npy and zip, and the formulas of the bundle's README.

use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};

use serde_json::Value;

pub type Vec3 = [f64; 3];
pub type Vec4 = [f64; 4];
pub type Matrix = [Vec4; 4];

pub struct Bundle {
    pub folder: PathBuf,
    pub json: Value,
    pub objects: Vec<Object>,
}

pub struct Object {
    pub positions: Vec<Vec3>,
    pub triangles: Vec<[usize; 3]>,
    pub uvs: Vec<[f64; 2]>,
    pub origin: Vec4,
    pub world_from_object: Matrix,
}

impl Bundle {
    pub fn read(folder: &Path) -> Bundle {
        let json: Value =
            serde_json::from_slice(&fs::read(folder.join("bundle.json")).unwrap()).unwrap();
        assert_eq!(json["format"], "nullray-bundle");
        assert_eq!(json["version"], 1);
        let objects = json["objects"].as_array().unwrap();
        Bundle {
            folder: folder.into(),
            objects: objects.iter().map(|o| object(folder, o)).collect(),
            json,
        }
    }

    /// An array of the reference, and how many numbers it has for each pixel.
    pub fn reference(&self, name: &str) -> Vec<f64> {
        let path = self.json["reference"]["npz"].as_str().unwrap();
        let file = fs::File::open(self.folder.join(path)).unwrap();
        let mut archive = zip::ZipArchive::new(file).unwrap();
        let mut bytes = Vec::new();
        let mut member = archive.by_name(&format!("{name}.npy")).unwrap();
        member.read_to_end(&mut bytes).unwrap();
        npy(&bytes)
    }
}

pub fn vector<const N: usize>(json: &Value) -> [f64; N] {
    let list = json.as_array().unwrap();
    assert_eq!(list.len(), N);
    std::array::from_fn(|i| list[i].as_f64().unwrap())
}

pub fn matrix(json: &Value) -> Matrix {
    std::array::from_fn(|row| vector(&json[row]))
}

fn object(folder: &Path, json: &Value) -> Object {
    let glb = fs::read(folder.join(json["geometry"].as_str().unwrap())).unwrap();
    let glb = Glb::read(&glb);
    let mut object = glb.object();
    if let Some(path) = json["positions"].as_str() {
        let exact = npy(&fs::read(folder.join(path)).unwrap());
        let exact: Vec<Vec3> = exact.chunks(3).map(|p| [p[0], p[1], p[2]]).collect();
        assert_eq!(exact.len(), object.positions.len());
        for (single, double) in object.positions.iter().zip(&exact) {
            assert_eq!(single.map(|x| x as f32), double.map(|x| x as f32));
        }
        object.positions = exact;
    }
    object.origin = vector(&json["origin"]);
    object.world_from_object = matrix(&json["world_from_object"]);
    assert_eq!(object.triangles.len() as u64, json["triangles"]);
    object
}

/// A GLB file's two chunks.
struct Glb<'a> {
    json: Value,
    binary: &'a [u8],
}

impl Glb<'_> {
    fn read(bytes: &[u8]) -> Glb<'_> {
        let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
        assert_eq!(&bytes[..4], b"glTF");
        assert_eq!((word(4), word(8)), (2, bytes.len()));
        let length = word(12);
        assert_eq!(&bytes[16..20], b"JSON");
        let json = serde_json::from_slice(&bytes[20..20 + length]).unwrap();
        let binary = 20 + length;
        assert_eq!(&bytes[binary + 4..binary + 8], b"BIN\0");
        Glb {
            json,
            binary: &bytes[binary + 8..binary + 8 + word(binary)],
        }
    }

    fn object(&self) -> Object {
        let mut object = Object {
            positions: Vec::new(),
            triangles: Vec::new(),
            uvs: Vec::new(),
            origin: [0.0; 4],
            world_from_object: [[0.0; 4]; 4],
        };
        for primitive in self.json["meshes"][0]["primitives"].as_array().unwrap() {
            let positions = self.accessor(&primitive["attributes"]["POSITION"]);
            object.positions = positions.chunks(3).map(|p| [p[0], p[1], p[2]]).collect();
            let uvs = self.accessor(&primitive["attributes"]["TEXCOORD_0"]);
            object.uvs = uvs.chunks(2).map(|p| [p[0], p[1]]).collect();
            let indices = self.accessor(&primitive["indices"]);
            let triangles = indices.chunks(3);
            object
                .triangles
                .extend(triangles.map(|t| [t[0] as usize, t[1] as usize, t[2] as usize]));
        }
        object
    }

    fn accessor(&self, index: &Value) -> Vec<f64> {
        let accessor = &self.json["accessors"][index.as_u64().unwrap() as usize];
        let view = accessor["bufferView"].as_u64().unwrap() as usize;
        let view = &self.json["bufferViews"][view];
        let size = |key: &str| view[key].as_u64().unwrap() as usize;
        let bytes = &self.binary[size("byteOffset")..size("byteOffset") + size("byteLength")];
        let words = bytes.chunks(4).map(|b| b.try_into().unwrap());
        match accessor["componentType"].as_u64().unwrap() {
            5126 => words.map(|w| f64::from(f32::from_le_bytes(w))).collect(),
            5125 => words.map(|w| f64::from(u32::from_le_bytes(w))).collect(),
            other => panic!("component type {other}"),
        }
    }
}

/// The numbers of an npy file.
fn npy(bytes: &[u8]) -> Vec<f64> {
    assert_eq!(&bytes[..6], b"\x93NUMPY");
    let length = usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    let header = std::str::from_utf8(&bytes[10..10 + length]).unwrap();
    let data = &bytes[10 + length..];
    if header.contains("'<f8'") {
        let words = data.chunks_exact(8).map(|b| b.try_into().unwrap());
        return words.map(f64::from_le_bytes).collect();
    }
    assert!(header.contains("'<i4'"), "{header}");
    let words = data.chunks_exact(4).map(|b| b.try_into().unwrap());
    words.map(|w| f64::from(i32::from_le_bytes(w))).collect()
}

pub fn dot(a: Vec3, b: Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub fn minkowski(a: Vec4, b: Vec4) -> f64 {
    a[1] * b[1] + a[2] * b[2] + a[3] * b[3] - a[0] * b[0]
}

pub fn apply(m: &Matrix, v: Vec4) -> Vec4 {
    std::array::from_fn(|row| (0..4).map(|c| m[row][c] * v[c]).sum())
}

/// G Mᵀ G.
pub fn inverse(m: &Matrix) -> Matrix {
    let sign = |i: usize| if i == 0 { -1.0 } else { 1.0 };
    std::array::from_fn(|r| std::array::from_fn(|c| sign(r) * sign(c) * m[c][r]))
}

pub fn minus(a: Vec4, b: Vec4) -> Vec4 {
    std::array::from_fn(|i| a[i] - b[i])
}

pub fn plus(a: Vec4, b: Vec4) -> Vec4 {
    std::array::from_fn(|i| a[i] + b[i])
}

pub fn place(v: Vec4) -> Vec3 {
    [v[1], v[2], v[3]]
}

pub fn length(v: Vec3) -> f64 {
    dot(v, v).sqrt()
}
