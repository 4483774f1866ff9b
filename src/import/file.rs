//! Opening files without surprises.

use std::fs::File;
use std::path::Path;

use crate::{Error, Result};

/// Opens a regular file and tells its length in bytes.
///
/// Devices, pipes and directories are refused first: opening one may block for ever, and reading
/// one may never end.
pub(super) fn open_regular(path: &Path) -> Result<(File, u64)> {
    let metadata = std::fs::metadata(path).map_err(Error::io(path, "cannot read"))?;
    if !metadata.is_file() {
        return Err(Error::invalid(
            path,
            "",
            "this is not a regular file",
            "give the path of a file, not of a directory or a device",
        ));
    }
    let file = File::open(path).map_err(Error::io(path, "cannot read"))?;
    Ok((file, metadata.len()))
}
