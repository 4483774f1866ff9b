//! Meshes and cubes that a program gives in memory, in place of files.
//!
//! The text of a scene names them by their content, as `memory:` and the SHA-256 of the arrays, so that different scenes have different
//! texts.

use std::collections::HashMap;
use std::sync::Arc;

use sha2::{Digest, Sha256};

use crate::io::cube::{Cube, CubeSamples};
use crate::mesh::{AlphaMode, Material, Mesh, Part};

/// The prefix of names of objects in memory, in place of a path.
pub(super) const PREFIX: &str = "memory:";

/// Meshes and cubes by name; they are shared, not copied.
#[derive(Debug, Clone, Default)]
pub(super) struct Memory {
    meshes: HashMap<String, Arc<Mesh>>,
    cubes: HashMap<String, Arc<Cube>>,
}

impl Memory {
    /// Stores `mesh`; returns the name by which the text of a scene refers to it.
    pub fn add_mesh(&mut self, mesh: Arc<Mesh>) -> String {
        let name = name(|hash| hash_mesh(hash, &mesh));
        self.meshes.insert(name.clone(), mesh);
        name
    }

    /// Stores `cube`; returns the name by which the text of a scene refers to it.
    pub fn add_cube(&mut self, cube: Arc<Cube>) -> String {
        let name = name(|hash| hash_cube(hash, &cube));
        self.cubes.insert(name.clone(), cube);
        name
    }

    /// The mesh of this name.
    pub fn mesh(&self, name: &str) -> Option<Arc<Mesh>> {
        self.meshes.get(name).cloned()
    }

    /// The cube of this name.
    pub fn cube(&self, name: &str) -> Option<Arc<Cube>> {
        self.cubes.get(name).cloned()
    }
}

fn name(add: impl FnOnce(&mut Sha256)) -> String {
    let mut hash = Sha256::new();
    add(&mut hash);
    let digits = hash
        .finalize()
        .iter()
        .map(|b| format!("{b:02x}"))
        .collect::<String>();
    format!("{PREFIX}{digits}")
}

/// Adds numbers, in blocks, after their count.
fn add<T, const N: usize>(hash: &mut Sha256, numbers: &[T], bytes: impl Fn(&T) -> [u8; N]) {
    hash.update((numbers.len() as u64).to_le_bytes());
    for block in numbers.chunks(4096) {
        hash.update(block.iter().flat_map(&bytes).collect::<Vec<u8>>());
    }
}

fn add_text(hash: &mut Sha256, text: &str) {
    add(hash, text.as_bytes(), |&byte| [byte]);
}

fn hash_cube(hash: &mut Sha256, cube: &Cube) {
    add(hash, &cube.shape, |&n| (n as u64).to_le_bytes());
    match &cube.samples {
        CubeSamples::F16(samples) => add(hash, samples, |x| x.to_le_bytes()),
        CubeSamples::F32(samples) => add(hash, samples, |x| x.to_le_bytes()),
        CubeSamples::F64(samples) => add(hash, samples, |x| x.to_le_bytes()),
    }
}

fn hash_mesh(hash: &mut Sha256, mesh: &Mesh) {
    // Destructured by name, because a forgotten field would make different meshes equal.
    let Mesh {
        positions,
        uvs,
        normals,
        colours,
        triangles,
        parts,
        materials,
    } = mesh;
    for axis in 0..3 {
        add(hash, positions, |p| p[axis].to_le_bytes());
        add(hash, triangles, |t| t[axis].to_le_bytes());
    }
    // The number of sets, because they are concatenated.
    hash.update((uvs.len() as u64).to_le_bytes());
    for set in uvs {
        add(hash, set, |uv| uv[0].to_le_bytes());
        add(hash, set, |uv| uv[1].to_le_bytes());
    }
    for axis in 0..3 {
        add(hash, normals, |n| n[axis].to_le_bytes());
    }
    for channel in 0..4 {
        add(hash, colours, |c| c[channel].to_le_bytes());
    }
    hash.update((parts.len() as u64).to_le_bytes());
    for part in parts {
        let Part {
            first_triangle,
            triangles,
            material,
            node,
        } = part;
        add(hash, &[first_triangle, triangles, material], |n| {
            n.to_le_bytes()
        });
        add_text(hash, node);
    }
    hash.update((materials.len() as u64).to_le_bytes());
    for material in materials {
        let Material {
            name,
            base_colour,
            metallic,
            roughness,
            emissive,
            transmission,
            ior,
            solid,
            alpha,
            alpha_mode,
            unlit,
            double_sided,
            // Images of files, which meshes in memory do not show.
            base_colour_texture: _,
            metallic_roughness_texture: _,
            emissive_texture: _,
        } = material;
        add_text(hash, name);
        let (mode, cutoff) = match alpha_mode {
            AlphaMode::Opaque => (0.0, 0.0),
            AlphaMode::Mask { cutoff } => (1.0, *cutoff),
            AlphaMode::Blend => (2.0, 0.0),
        };
        let flags = [*solid, *unlit, *double_sided].map(|flag| f32::from(u8::from(flag)));
        let factors = [*metallic, *roughness, *transmission, *ior, *alpha];
        let alpha = [mode, cutoff];
        for numbers in [&base_colour[..], &emissive[..], &factors, &flags, &alpha] {
            add(hash, numbers, |number| number.to_le_bytes());
        }
    }
}
