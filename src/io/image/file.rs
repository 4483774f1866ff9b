//! Atomic writing: files appear completely or not at all.
//!
//! The bytes go to a temporary file in the directory of the target, which takes the target's name when everything is on disk. Until then an
//! existing file of that name is unchanged, and on any failure the temporary file is removed.

use std::fs::{self, File};
use std::io::{self, BufWriter, Seek, Write};
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::io::temporary::Temporary;

/// Writes the file `path` through `write`, so that it appears completely or not at all.
///
/// The writer can seek, and the file can be read back. Symbolic links are followed. Concurrent writers of one path do not disturb each
/// other: the last one to finish wins.
///
/// # Errors
/// Those of `write`; I/O errors of `path`; a target that is a directory or a device.
pub fn write_atomically(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> Result<()>,
) -> Result<()> {
    let target = target(path)?;
    let failed = || Error::io(path, "cannot write");
    let (temporary, file) = Temporary::file(&target).map_err(failed())?;
    let mut writer = BufWriter::with_capacity(1 << 16, file);
    write(&mut writer)?;
    let file = writer.into_inner().map_err(|e| failed()(e.into_error()))?;
    file.sync_all().map_err(failed())?;
    // The file stays open, and locked, until it has its final name.
    temporary.persist(&target).map_err(failed())?;
    sync_directory(&target);
    Ok(())
}

/// The file to replace: `path` with links followed; refused if it exists and is not a regular file, or is a dangling link.
fn target(path: &Path) -> Result<PathBuf> {
    let refused = |what: String, help| Err(Error::invalid(path, "", what, help));
    let target = match fs::canonicalize(path) {
        Ok(target) => target,
        Err(_) => match fs::read_link(path) {
            Ok(link) => {
                let what = format!("this is a link to {}, which does not exist", link.display());
                return refused(what, "remove the link, or create its target");
            }
            Err(_) => path.to_path_buf(),
        },
    };
    match fs::metadata(&target) {
        Ok(found) if !found.is_file() => refused(
            "something that is not a file has this name".into(),
            "name a new file, or one that may be replaced",
        ),
        _ => Ok(target),
    }
}

/// Makes the new name itself durable, if the system supports it; the file is complete in any case.
fn sync_directory(target: &Path) {
    let directory = match target.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    if let Ok(directory) = File::open(directory) {
        let _ = directory.sync_all();
    }
}

/// A file, or one in memory, that is written at any place.
pub(super) trait Seekable: Write + Seek {}

impl<W: Write + Seek> Seekable for W {}

/// For `map_err`: an I/O error while writing `path`.
pub(super) fn write_failed(path: &Path) -> impl FnOnce(io::Error) -> Error {
    Error::io(path, "cannot write")
}

/// Writes `bytes`; errors name `path`.
pub(super) fn write_all(writer: &mut impl Write, path: &Path, bytes: &[u8]) -> Result<()> {
    writer.write_all(bytes).map_err(write_failed(path))
}

#[cfg(test)]
mod tests;
