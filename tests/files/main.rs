//! Files that come in and go out: scene files, glTF, NumPy arrays, pictures.

#[path = "../common"]
mod common {
    pub mod png;
    pub mod skipped;
}

#[cfg(all(feature = "hdf5", feature = "zarr"))]
mod chunks;
mod colmap;
mod cubes;
mod gltf;
mod gltf_animations;
mod gltf_materials;
mod gltf_normals;
mod gltf_poses;
#[cfg(feature = "hdf5")]
mod hdf5;
mod image_files;
mod invalid;
mod mutations;
mod npy;
mod scene_file;
#[cfg(feature = "tiff")]
mod tiff;
#[cfg(feature = "zarr")]
mod zarr;

use nullray::io::gltf::Want;
use nullray::scene::model::{BadTextures, BadVertices};

/// All that glTF files hold.
const ALL: Want = Want {
    uvs: true,
    textures: true,
    shading: true,
    normals: true,
    bad_vertices: BadVertices::Refuse,
    bad_textures: BadTextures::Refuse,
};

/// Numbers of a fixed sequence (xorshift), to damage files by.
fn random_numbers() -> impl FnMut() -> usize {
    let mut state = 0x9e37_79b9_7f4a_7c15u64;
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        state as usize
    }
}
