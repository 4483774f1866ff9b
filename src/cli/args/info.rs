//! `nullray info`.

use std::path::PathBuf;

use clap::Args;

use super::shared::{Json, MemoryLimit};

#[derive(Debug, Args)]
pub struct InfoArguments {
    /// A .gltf, .glb, .npy, .npz, .ti, .exr, .png, .hdr, .csv or .toml file, recognised by its content, or a folder of pictures; HDF5
    /// (.h5, .mat), .tif and Zarr, if the program was built with the features hdf5, tiff or zarr.
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    #[command(flatten)]
    pub memory: MemoryLimit,
    #[command(flatten)]
    pub json: Json,
}
