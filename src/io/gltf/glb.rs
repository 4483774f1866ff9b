//! A mesh as binary glTF 2.0 (Khronos, "glTF 2.0 Specification", ISO/IEC 12113:2022).
//!
//! One node, one mesh, one buffer. All primitives share the vertex list; their triangles follow each other in the order of the mesh, so
//! that triangle i of the mesh is triangle i in the sequence of all primitives' triangles.

use std::io::Write;
use std::path::Path;

use glam::{DVec3, Vec3};
use serde_json::{Value, json};

use super::import::EncodedImage;
use crate::error::{Error, Result as FileResult};
use crate::io::image::write_atomically;
use crate::mesh::{AlphaMode, Material, Mesh, TextureFilter, Wrap};

const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;

/// Consecutive triangles with one material whose corners all have the same sets of texture coordinates, and either all or none have
/// normals.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Run {
    /// The first triangle.
    pub first: u32,
    /// The number of triangles.
    pub count: u32,
    /// Index of the material.
    pub material: u32,
    /// The sets of texture coordinates.
    pub uv_sets: Vec<usize>,
    /// Whether corners have normals.
    pub normals: bool,
}

/// The primitives of `mesh`.
pub fn runs(mesh: &Mesh) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    for part in &mesh.parts {
        let start = runs.len();
        for triangle in part.first_triangle..part.first_triangle + part.triangles {
            let (uv_sets, normals) = (sets(mesh, triangle), has_normals(mesh, triangle));
            match runs[start..].last_mut() {
                Some(run) if run.uv_sets == uv_sets && run.normals == normals => run.count += 1,
                _ => runs.push(Run {
                    first: triangle,
                    count: 1,
                    material: part.material,
                    uv_sets,
                    normals,
                }),
            }
        }
    }
    runs
}

/// The sets of texture coordinates that all corners of a triangle have.
fn sets(mesh: &Mesh, triangle: u32) -> Vec<usize> {
    let corners = mesh.triangles[triangle as usize];
    let has = |set: &usize| {
        let uv = |v: &u32| mesh.uvs[*set].get(*v as usize);
        corners
            .iter()
            .all(|v| uv(v).is_some_and(|uv| uv.iter().all(|x| x.is_finite())))
    };
    (0..mesh.uvs.len()).filter(has).collect()
}

/// Whether all corners of a triangle have normals.
fn has_normals(mesh: &Mesh, triangle: u32) -> bool {
    let corners = mesh.triangles[triangle as usize];
    let normal = |v: &u32| mesh.normals.get(*v as usize);
    corners
        .iter()
        .all(|v| normal(v).is_some_and(|normal| *normal != [0.0; 3]))
}

/// Whether all positions of `mesh` are representable in single precision.
pub(crate) fn is_exact(mesh: &Mesh) -> bool {
    mesh.positions.iter().all(|p| p.as_vec3().as_dvec3() == *p)
}

/// Writes `mesh` to a `.glb` file, as a node named `name`. Positions are rounded to single precision.
///
/// # Errors
/// The mesh is too large for the format, or exceeds single precision; I/O errors.
pub fn save(path: &Path, name: &str, mesh: &Mesh) -> FileResult<()> {
    let bytes = write(name, mesh, &runs(mesh), &[], |m| m.unlit)
        .map_err(|what| Error::unsupported(path, "", what, "write a part of it"))?;
    let failed = Error::io(path, "cannot write");
    write_atomically(path, |writer| writer.write_all(&bytes).map_err(failed))
}

/// The GLB file of `mesh`, whose primitives are `runs`; `is_unlit` says which materials show their base colours under any light.
///
/// # Errors
/// The reason why there is none: too large, or beyond single precision.
pub fn write(
    name: &str,
    mesh: &Mesh,
    runs: &[Run],
    images: &[EncodedImage],
    is_unlit: impl Fn(&Material) -> bool,
) -> Result<Vec<u8>, &'static str> {
    let mut file = File::default();
    let position = file.positions(&mesh.positions)?;
    let uvs = mesh.uvs.iter();
    let uvs: Vec<_> = uvs.map(|set| file.uvs(set, mesh.positions.len())).collect();
    let normals = (!mesh.normals.is_empty()).then(|| file.normals(&mesh.normals));
    let colours = (!mesh.colours.is_empty()).then(|| file.colours(&mesh.colours));
    let indices: Vec<_> = runs.iter().map(|run| file.indices(mesh, run)).collect();
    let images: Vec<_> = images.iter().map(|image| file.image(image)).collect();
    let primitives = runs
        .iter()
        .zip(indices)
        .map(|(run, indices)| file.primitive(run, [position, indices], &uvs, (normals, colours)));
    let primitives: Vec<_> = primitives.collect();
    let samplers = mesh.materials.iter().filter_map(sampler);
    let textures = mesh
        .materials
        .iter()
        .filter_map(|m| m.base_colour_texture.as_ref())
        .enumerate()
        .map(|(index, t)| json!({ "source": t.image, "sampler": index }));
    let any_unlit = mesh.materials.iter().any(&is_unlit);
    let extensions: &[&str] = if any_unlit {
        &["KHR_materials_unlit"]
    } else {
        &[]
    };
    let mut document = json!({
        "asset": { "version": "2.0", "generator": concat!("nullray ", env!("CARGO_PKG_VERSION")) },
        "extensionsUsed": extensions,
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0, "name": name }],
        "meshes": [{ "name": name, "primitives": primitives }],
        "materials": materials(&mesh.materials, is_unlit),
        "samplers": samplers.collect::<Vec<_>>(),
        "textures": textures.collect::<Vec<_>>(),
        "images": images,
        "accessors": file.accessors,
        "bufferViews": file.views,
        "buffers": [{ "byteLength": file.bytes.len() }],
    });
    if let Value::Object(map) = &mut document {
        // Lists may be absent, but must not be empty.
        map.retain(|_, value| value.as_array().is_none_or(|list| !list.is_empty()));
    }
    container(document.to_string().into_bytes(), file.bytes)
}

/// The header and the two chunks.
fn container(mut json: Vec<u8>, mut binary: Vec<u8>) -> Result<Vec<u8>, &'static str> {
    json.resize(json.len().next_multiple_of(4), b' ');
    binary.resize(binary.len().next_multiple_of(4), 0);
    let length = 12 + 8 + json.len() + 8 + binary.len();
    let length =
        u32::try_from(length).map_err(|_| "its mesh takes more than the 4 GiB of a GLB file")?;
    let mut file = Vec::with_capacity(length as usize);
    file.extend(b"glTF");
    file.extend(2u32.to_le_bytes());
    file.extend(length.to_le_bytes());
    for (kind, chunk) in [(b"JSON", json), (b"BIN\0", binary)] {
        file.extend((chunk.len() as u32).to_le_bytes());
        file.extend(kind);
        file.extend(chunk);
    }
    Ok(file)
}

fn materials(materials: &[Material], is_unlit: impl Fn(&Material) -> bool) -> Vec<Value> {
    let mut textures = 0;
    let material = |m: &Material| {
        // glTF has no factors above 1; the bundle's own description keeps them.
        let [r, g, b] = m.base_colour.map(|c| c.clamp(0.0, 1.0));
        let mut pbr = json!({ "baseColorFactor": [r, g, b, m.alpha], "metallicFactor": 0.0 });
        if let Some(texture) = &m.base_colour_texture {
            pbr["baseColorTexture"] = json!({ "index": textures, "texCoord": texture.uv_set });
            textures += 1;
        }
        let mut written = json!({
            "name": m.name,
            "doubleSided": m.double_sided,
            "pbrMetallicRoughness": pbr,
        });
        if is_unlit(m) {
            written["extensions"] = json!({ "KHR_materials_unlit": {} });
        }
        if let AlphaMode::Mask { cutoff } = m.alpha_mode {
            written["alphaMode"] = "MASK".into();
            written["alphaCutoff"] = cutoff.into();
        }
        written
    };
    materials.iter().map(material).collect()
}

fn sampler(material: &Material) -> Option<Value> {
    let code = |wrap| match wrap {
        Wrap::Repeat => 10497,
        Wrap::Mirror => 33648,
        Wrap::Clamp => 33071,
    };
    let sampler = material.base_colour_texture.as_ref()?.sampler;
    let [s, t] = sampler.wrap.map(code);
    let filter = match sampler.filter {
        TextureFilter::Nearest => 9728,
        TextureFilter::Linear => 9729,
    };
    Some(json!({ "wrapS": s, "wrapT": t, "magFilter": filter, "minFilter": filter }))
}

/// The buffer, and the views and accessors into it.
#[derive(Default)]
struct File {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl File {
    /// Adds a buffer view and returns its index.
    fn view(&mut self, bytes: impl IntoIterator<Item = u8>, target: Option<u32>) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let offset = self.bytes.len();
        self.bytes.extend(bytes);
        let mut view =
            json!({ "buffer": 0, "byteOffset": offset, "byteLength": self.bytes.len() - offset });
        if let Some(target) = target {
            view["target"] = target.into();
        }
        self.views.push(view);
        self.views.len() - 1
    }

    fn accessor(&mut self, accessor: Value) -> usize {
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    fn positions(&mut self, positions: &[DVec3]) -> Result<usize, &'static str> {
        let single: Vec<Vec3> = positions.iter().map(|p| p.as_vec3()).collect();
        if single.iter().any(|p| !p.is_finite()) {
            return Err("a vertex is beyond the range of single precision");
        }
        let fold = |f: fn(Vec3, Vec3) -> Vec3| single.iter().copied().reduce(f).unwrap_or_default();
        let (least, most) = (fold(Vec3::min), fold(Vec3::max));
        let bytes = single
            .iter()
            .flat_map(|p| p.to_array())
            .flat_map(f32::to_le_bytes);
        let view = self.view(bytes, Some(ARRAY_BUFFER));
        Ok(self.accessor(json!({
            "bufferView": view, "componentType": FLOAT, "count": single.len(), "type": "VEC3",
            "min": least.to_array(), "max": most.to_array(),
        })))
    }

    /// Vertices without coordinates get 0, and so do all vertices of a set that none has: an accessor without data.
    fn uvs(&mut self, set: &[[f32; 2]], vertices: usize) -> usize {
        if set.is_empty() {
            let zeros = json!({ "componentType": FLOAT, "count": vertices, "type": "VEC2" });
            return self.accessor(zeros);
        }
        let number = |x: &f32| if x.is_finite() { *x } else { 0.0 };
        let bytes = set.iter().flatten().map(number).flat_map(f32::to_le_bytes);
        let view = self.view(bytes, Some(ARRAY_BUFFER));
        self.accessor(json!({
            "bufferView": view, "componentType": FLOAT, "count": set.len(), "type": "VEC2",
        }))
    }

    fn indices(&mut self, mesh: &Mesh, run: &Run) -> usize {
        let triangles = &mesh.triangles[run.first as usize..(run.first + run.count) as usize];
        let bytes = triangles.iter().flatten().flat_map(|v| v.to_le_bytes());
        let view = self.view(bytes, Some(ELEMENT_ARRAY_BUFFER));
        self.accessor(json!({
            "bufferView": view, "componentType": UNSIGNED_INT, "count": 3 * triangles.len(), "type": "SCALAR",
        }))
    }

    fn image(&mut self, image: &EncodedImage) -> Value {
        let view = self.view(image.bytes.iter().copied(), None);
        json!({ "bufferView": view, "mimeType": image.media_type, "name": image.place })
    }

    /// Unit vectors; arbitrary ones for vertices without a normal.
    fn normals(&mut self, normals: &[[f32; 3]]) -> usize {
        let unit = |n: &[f32; 3]| DVec3::from(n.map(f64::from)).normalize_or(DVec3::Z);
        let bytes = normals
            .iter()
            .flat_map(|n| unit(n).as_vec3().to_array())
            .flat_map(f32::to_le_bytes);
        let view = self.view(bytes, Some(ARRAY_BUFFER));
        self.accessor(json!({
            "bufferView": view, "componentType": FLOAT, "count": normals.len(), "type": "VEC3",
        }))
    }

    fn colours(&mut self, colours: &[[f32; 4]]) -> usize {
        let bytes = colours.iter().flatten().flat_map(|c| c.to_le_bytes());
        let view = self.view(bytes, Some(ARRAY_BUFFER));
        self.accessor(json!({
            "bufferView": view, "componentType": FLOAT, "count": colours.len(), "type": "VEC4",
        }))
    }

    fn primitive(
        &self,
        run: &Run,
        [position, indices]: [usize; 2],
        uvs: &[usize],
        (normals, colours): (Option<usize>, Option<usize>),
    ) -> Value {
        let mut attributes = json!({ "POSITION": position });
        if let Some(normals) = normals.filter(|_| run.normals) {
            attributes["NORMAL"] = normals.into();
        }
        if let Some(colours) = colours {
            attributes["COLOR_0"] = colours.into();
        }
        // Sets are numbered without gaps: a missing set below an existing one gets zeros.
        let last = run.uv_sets.last().map_or(0, |last| last + 1);
        for (set, accessor) in uvs.iter().enumerate().take(last) {
            attributes[format!("TEXCOORD_{set}")] = (*accessor).into();
        }
        json!({ "attributes": attributes, "indices": indices, "material": run.material })
    }
}
