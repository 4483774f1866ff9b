//! Formats that this program was built without.

#[cfg(not(feature = "hdf5"))]
pub(super) mod hdf5 {
    use std::io::Write;
    use std::path::Path;

    use super::super::format::{CubeFormat, Wanted};
    use super::super::layout::StoredLayout;
    #[cfg(feature = "zarr")]
    use super::super::selection::{Open, Selection};
    use crate::error::{Error, Result};
    use crate::io::files::Reader;

    /// HDF5, refused.
    pub(in super::super) const FORMAT: CubeFormat = CubeFormat {
        name: "HDF5 file",
        extensions: &["h5", "hdf5", "mat"],
        magic: &[b"\x89HDF\r\n\x1a\n", b"MATLAB 7"],
        named: true,
        inspect: |_, path, _| Err(refused(path)),
        load: |_, path, _| Err(refused(path)),
        arrays: |path| Err(refused(path)),
        times: |_, path, _| Err(refused(path)),
        wall: |_, path, _| Err(refused(path)),
    };

    pub(in super::super) fn refused(path: &Path) -> Error {
        super::without(path, "HDF5", "hdf5")
    }

    pub(in super::super) fn write_out(
        _: Reader,
        path: &Path,
        _: Wanted,
        _: &mut dyn Write,
    ) -> Result<StoredLayout> {
        Err(refused(path))
    }

    /// What is stored in chunks is read where another format of such files is built in.
    #[cfg(feature = "zarr")]
    pub(in super::super) fn windows(path: &Path, _: Wanted, _: usize) -> Result<(Selection, Open)> {
        Err(refused(path))
    }
}

#[cfg(not(feature = "zarr"))]
pub(super) mod zarr {
    use std::io::Write;
    use std::path::Path;

    use super::super::format::{CubeInfo, FileTimes, Wanted};
    use super::super::layout::StoredLayout;
    use super::super::samples::Cube;
    #[cfg(feature = "hdf5")]
    use super::super::selection::{Open, Selection};
    use crate::error::{Error, Result};
    use crate::io::npy::Header;

    pub(in super::super) fn refused(path: &Path) -> Error {
        super::without(path, "Zarr", "zarr")
    }

    pub(in super::super) fn inspect(path: &Path, _: Wanted) -> Result<CubeInfo> {
        Err(refused(path))
    }

    pub(in super::super) fn load(path: &Path, _: Wanted) -> Result<Cube> {
        Err(refused(path))
    }

    pub(in super::super) fn write_out(
        path: &Path,
        _: Wanted,
        _: &mut dyn Write,
    ) -> Result<StoredLayout> {
        Err(refused(path))
    }

    pub(in super::super) fn times(path: &Path, _: Option<&str>) -> Result<Option<FileTimes>> {
        Err(refused(path))
    }

    pub(in super::super) fn arrays(path: &Path) -> Result<Vec<Header>> {
        Err(refused(path))
    }

    /// As for HDF5.
    #[cfg(feature = "hdf5")]
    pub(in super::super) fn windows(path: &Path, _: Wanted, _: usize) -> Result<(Selection, Open)> {
        Err(refused(path))
    }
}

/// A file that needs a feature which is off.
fn without(path: &std::path::Path, format: &str, feature: &str) -> crate::error::Error {
    let what = format!("this program was built without {format}");
    let help = format!(
        "install it with {format}: in its sources, cargo install --path . --features {feature}"
    );
    crate::error::Error::unsupported(path, "", what, help)
}
