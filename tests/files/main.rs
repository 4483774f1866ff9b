//! Files that come in and go out: scene files, glTF, NumPy arrays, pictures.

#[path = "../common"]
mod common {
    pub mod png;
}

#[cfg(all(feature = "hdf5", feature = "zarr"))]
mod chunks;
mod colmap;
mod cubes;
mod gltf;
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
