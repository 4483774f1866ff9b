//! How Zarr folders are recognised, whether this build can read them or not.

use std::path::Path;

use super::format::ByPath;

/// The folder of an array, or of a group of them.
pub(super) const ZARR_FOLDER: ByPath = ByPath {
    is: is_zarr,
    called: "Zarr folders",
    folder_of: "Zarr",
    help: "name the folder of a Zarr array, or of a group of them",
};

fn is_zarr(path: &Path) -> bool {
    ["zarr.json", ".zarray", ".zgroup"]
        .iter()
        .any(|name| path.join(name).is_file())
}
