//! Opening files without surprises.

use std::path::Path;

use crate::io::files::{self, Reader};
use crate::{Error, Result};

/// Opens a regular file and tells its length in bytes.
pub(super) fn open_regular(path: &Path) -> Result<(Reader, u64)> {
    files::open(path).map_err(|error| match error.kind() {
        std::io::ErrorKind::InvalidInput => Error::invalid(
            path,
            "",
            error.to_string(),
            "give the path of a file, not of a directory or a device",
        ),
        _ => Error::io(path, "cannot read")(error),
    })
}
