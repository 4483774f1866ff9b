//! `nullray info`.

use std::path::PathBuf;

use clap::Args;

use super::shared::{Json, MemoryLimit};

#[derive(Debug, Args)]
pub struct InfoArguments {
    /// A .gltf, .glb, .npy, .npz, .ti, HDF5 (.h5, .mat), .exr, .png, .hdr, .tif, .csv or .toml file, recognised by its content, or a
    /// folder of pictures or a Zarr array.
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    #[command(flatten)]
    pub memory: MemoryLimit,
    #[command(flatten)]
    pub json: Json,
}
