//! Formats that this program was built without.

#[cfg(not(feature = "hdf5"))]
pub(super) mod hdf5 {
    use std::path::Path;

    use super::super::format::{CubeFormat, Parts, Recognition, itself};
    use crate::error::Error;

    /// HDF5, refused.
    pub(in super::super) const FORMAT: CubeFormat = CubeFormat {
        name: "HDF5 file",
        key: "hdf5",
        extensions: &["h5", "hdf5", "mat"],
        named: true,
        pictures: false,
        recognition: Recognition::ByStart(&[b"\x89HDF\r\n\x1a\n", b"MATLAB 7"]),
        files: itself,
        inspect: |input, _| Err(refused(input.path)),
        load: |input, _| Err(refused(input.path)),
        arrays: |path| Err(refused(path)),
        times: |input, _| Err(refused(input.path)),
        wall: |input, _| Err(refused(input.path)),
        parts: Parts::WrittenOut(|input, _, _| Err(refused(input.path))),
    };

    pub(in super::super) fn refused(path: &Path) -> Error {
        super::without(path, "HDF5", "hdf5")
    }
}

#[cfg(not(feature = "zarr"))]
pub(super) mod zarr {
    use std::path::Path;

    use super::super::format::{CubeFormat, Parts, Recognition, itself};
    use super::super::zarr_folder::ZARR_FOLDER;
    use crate::error::Error;

    /// Folders of Zarr, refused.
    pub(in super::super) const FORMAT: CubeFormat = CubeFormat {
        name: "Zarr folder",
        key: "zarr",
        extensions: &[],
        named: true,
        pictures: false,
        recognition: Recognition::ByPath(ZARR_FOLDER),
        files: itself,
        inspect: |input, _| Err(refused(input.path)),
        load: |input, _| Err(refused(input.path)),
        arrays: |path| Err(refused(path)),
        times: |input, _| Err(refused(input.path)),
        wall: |_, _| Ok(None),
        parts: Parts::WrittenOut(|input, _, _| Err(refused(input.path))),
    };

    pub(in super::super) fn refused(path: &Path) -> Error {
        super::without(path, "Zarr", "zarr")
    }
}

/// The error for a file that needs a disabled feature.
fn without(path: &std::path::Path, format: &str, feature: &str) -> crate::error::Error {
    let what = format!("this program was built without {format}");
    let help = format!(
        "install it with {format}: in its sources, cargo install --path . --features {feature}"
    );
    crate::error::Error::unsupported(path, "", what, help)
}
