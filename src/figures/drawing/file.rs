//! Drawings as files.

use std::io::Write;
use std::path::Path;

use crate::error::{Error, Result};
use crate::io::image::write_atomically;

/// Writes the output of a writer of this module to `path`, completely or not at all.
///
/// # Errors
/// I/O errors.
pub fn save(path: &Path, bytes: impl AsRef<[u8]>) -> Result<()> {
    write_atomically(path, |file| {
        let written = file.write_all(bytes.as_ref());
        written.map_err(Error::io(path, "cannot write"))
    })
}
