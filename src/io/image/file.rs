//! Files that appear whole or not at all.
//!
//! The bytes go to a temporary file in the directory of the target, which takes the target's name when
//! all is on the disk. Until then a file of that name stays as it was, and on any failure the temporary
//! file is removed.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::error::{Error, Result};

/// Makes temporary names of one process distinct.
static COUNTER: AtomicU64 = AtomicU64::new(0);

/// Writes the file `path` through `write`, so that it appears whole or not at all.
///
/// The writer can seek, and the file can be read back. A symbolic link is followed. Writers of one path
/// at the same time do not disturb each other: the last one to finish stays.
///
/// # Errors
/// Those of `write`; I/O errors of `path`; a target that is a directory or a device.
pub fn write_atomically(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> Result<()>,
) -> Result<()> {
    let target = target(path)?;
    let failed = || Error::io(path, "cannot write");
    let (temporary, file) = Temporary::create(&target).map_err(failed())?;
    let mut writer = BufWriter::with_capacity(1 << 16, file);
    write(&mut writer)?;
    let file = writer.into_inner().map_err(|e| failed()(e.into_error()))?;
    file.sync_all().map_err(failed())?;
    drop(file);
    fs::rename(&temporary.path, &target).map_err(failed())?;
    temporary.keep();
    sync_directory(&target);
    Ok(())
}

/// The file to replace: `path` with links followed, refused where it is there and is not a file.
fn target(path: &Path) -> Result<PathBuf> {
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
    match fs::metadata(&target) {
        Ok(found) if !found.is_file() => {
            let what = "there is something of this name that is not a file";
            Err(Error::invalid(
                path,
                "",
                what,
                "name a file that is new, or that may be replaced",
            ))
        }
        _ => Ok(target),
    }
}

/// A temporary file, removed when dropped.
struct Temporary {
    path: PathBuf,
    kept: bool,
}

impl Temporary {
    /// A new file beside `target`.
    fn create(target: &Path) -> io::Result<(Temporary, File)> {
        let directory = target.parent().unwrap_or(Path::new(""));
        loop {
            let n = COUNTER.fetch_add(1, Ordering::Relaxed);
            let path = directory.join(format!(".nullray-{}-{n}.part", process::id()));
            let mut options = OpenOptions::new();
            match options.read(true).write(true).create_new(true).open(&path) {
                Ok(file) => return Ok((Temporary { path, kept: false }, file)),
                // Left by another machine, or by a process of the past with our number.
                Err(e) if e.kind() == io::ErrorKind::AlreadyExists => continue,
                Err(e) => return Err(e),
            }
        }
    }

    /// The file has its final name now.
    fn keep(mut self) {
        self.kept = true;
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        if !self.kept {
            // Nothing more can be done about a file that cannot be removed.
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// Makes the new name itself durable, where the system can; the file is complete in any case.
fn sync_directory(target: &Path) {
    let directory = match target.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    if let Ok(directory) = File::open(directory) {
        let _ = directory.sync_all();
    }
}

/// For `map_err`: an I/O error while writing `path`.
pub(super) fn write_failed(path: &Path) -> impl FnOnce(io::Error) -> Error {
    Error::io(path, "cannot write")
}

/// Writes `bytes` with the error of `path`.
pub(super) fn write_all(writer: &mut impl Write, path: &Path, bytes: &[u8]) -> Result<()> {
    writer.write_all(bytes).map_err(write_failed(path))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(directory: &Path) -> Vec<String> {
        let entries = fs::read_dir(directory).unwrap();
        let mut names: Vec<_> = entries
            .map(|e| e.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn a_failure_leaves_the_old_file_and_nothing_else() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.bin");
        fs::write(&path, "old").unwrap();
        let failed = write_atomically(&path, |w| {
            w.write_all(b"half of the new").unwrap();
            Err(Error::Cancelled)
        });
        assert!(matches!(failed, Err(Error::Cancelled)));
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        assert_eq!(names(directory.path()), ["a.bin"]);
    }

    #[test]
    fn success_replaces_the_old_file() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.bin");
        fs::write(&path, "old and longer").unwrap();
        write_atomically(&path, |w| write_all(w, &path, b"new")).unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "new");
        assert_eq!(names(directory.path()), ["a.bin"]);
    }

    #[test]
    fn writers_at_the_same_time_leave_one_whole_file() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.bin");
        std::thread::scope(|scope| {
            for byte in 0..8u8 {
                let path = &path;
                scope.spawn(move || {
                    let bytes = vec![byte; 100_000];
                    write_atomically(path, |w| write_all(w, path, &bytes)).unwrap();
                });
            }
        });
        let bytes = fs::read(&path).unwrap();
        assert_eq!(bytes, vec![bytes[0]; 100_000]);
        assert_eq!(names(directory.path()), ["a.bin"]);
    }

    #[test]
    fn a_missing_directory_is_an_error_that_names_the_file() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("missing").join("a.bin");
        let error = write_atomically(&path, |_| Ok(())).unwrap_err();
        assert!(matches!(&error, Error::Io { path: p, .. } if *p == path));
        assert!(error.to_string().contains("cannot write"), "{error}");
    }

    #[test]
    fn a_directory_is_not_replaced() {
        let directory = tempfile::tempdir().unwrap();
        let error = write_atomically(directory.path(), |_| Ok(())).unwrap_err();
        assert!(error.to_string().contains("not a file"), "{error}");
    }

    #[cfg(unix)]
    #[test]
    fn a_link_is_followed() {
        let directory = tempfile::tempdir().unwrap();
        let [real, link] = ["real", "link"].map(|name| directory.path().join(name));
        fs::write(&real, "old").unwrap();
        std::os::unix::fs::symlink(&real, &link).unwrap();
        write_atomically(&link, |w| write_all(w, &link, b"new")).unwrap();
        assert_eq!(fs::read_to_string(&real).unwrap(), "new");
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    }
}
