//! Files and directories in the making, under names that say so: `.nullray-XXXXXX.part`, with six random characters.
//!
//! They lie beside what they will become, are locked as long as their process lives, and are removed when it gives up.
//! What a process leaves behind that was killed is removed by the next one that writes into the directory: things of such
//! names that belong to its own user, are locked by nobody, and have not changed for `FILE_AGE` or `FOLDER_AGE`.
//! The lock tells at once on a local disk, also between containers; on file systems of clusters a lock may not be seen
//! from other machines, hence the age.

use std::collections::BTreeSet;
use std::fs::{self, File, Metadata, OpenOptions, TryLockError};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use crate::error::Error;

const PREFIX: &str = ".nullray-";
const SUFFIX: &str = ".part";

/// For how long nothing was written to a file that is a left-over. Encoders write every few seconds.
const FILE_AGE: Duration = Duration::from_secs(5 * 60);
/// For how long nothing was put into a directory that is a left-over. A long rendering may stand between two files.
const FOLDER_AGE: Duration = Duration::from_secs(24 * 3600);

/// What this process has in the making.
static LIVE: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());
/// The directories from which left-overs were removed.
static CLEARED: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// A file or directory in the making; removed when dropped, unless it has its name or is kept.
#[derive(Debug)]
pub(crate) struct Temporary {
    path: PathBuf,
    kept: bool,
    /// Of a directory, which has to stay locked; a file is locked by whoever writes it.
    _lock: Option<File>,
}

/// The error of a file in a directory under its `temporary` name, as one of the file that it would have become.
pub(crate) fn in_target(error: Error, temporary: &Path, target: &Path) -> Error {
    match error {
        Error::Io {
            path,
            action,
            source,
        } => Error::Io {
            path: match path.strip_prefix(temporary) {
                Ok(name) => target.join(name),
                Err(_) => path,
            },
            action,
            source,
        },
        error => error,
    }
}

impl Temporary {
    /// A new file beside `target`, open for reading and writing and locked; who may read it is as of the file that it is to take the
    /// place of.
    ///
    /// # Errors
    /// The file cannot be made, or not be given the permissions of `target`.
    pub fn file(target: &Path) -> io::Result<(Temporary, File)> {
        let (path, file) = make_beside(target, |path| {
            let mut options = OpenOptions::new();
            options.read(true).write(true).create_new(true).open(path)
        })?;
        let temporary = Temporary {
            path,
            kept: false,
            _lock: None,
        };
        // Before the first byte is in it. Where the system keeps no permissions, they are the same.
        if let Ok(old) = fs::metadata(target)
            && old.is_file()
            && old.permissions() != file.metadata()?.permissions()
        {
            file.set_permissions(old.permissions())?;
        }
        Ok((temporary, file))
    }

    /// A new directory beside `target`.
    ///
    /// # Errors
    /// The directory cannot be made.
    pub fn folder(target: &Path) -> io::Result<Temporary> {
        let (path, lock) = make_beside(target, |path| {
            fs::create_dir(path)?;
            // Where directories cannot be opened they are not locked either.
            File::open(path).or_else(|_| tempfile::tempfile_in(path))
        })?;
        Ok(Temporary {
            path,
            kept: false,
            _lock: Some(lock),
        })
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Gives it the name `target`, in place of the file that has it.
    pub(crate) fn persist(self, target: &Path) -> io::Result<()> {
        // What has its name is not found under the temporary one when this is dropped.
        fs::rename(&self.path, target)
    }

    /// Leaves it where it is.
    pub fn keep(mut self) {
        self.kept = true;
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        if !self.kept {
            remove(&self.path);
        }
        live().remove(&self.path);
    }
}

/// An error of a file in the directory for temporary files.
pub fn in_directory(action: &str) -> impl Fn(io::Error) -> Error {
    move |source| {
        let what = format!("{action} in the directory for temporary files: {source}");
        let help = "set the environment variable TMPDIR to a directory that exists, may be written to, and has room";
        Error::invalid(std::env::temp_dir(), "", what, help)
    }
}

/// Notes a directory that this process has made otherwise, for [`remove_all`].
pub fn note(directory: &Path) {
    live().insert(directory.into());
}

/// Removes what this process has in the making: for when it is about to exit without unwinding.
pub fn remove_all() {
    live().iter().for_each(|path| remove(path));
}

fn live() -> std::sync::MutexGuard<'static, BTreeSet<PathBuf>> {
    LIVE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes a file, or a directory with all that is in it.
fn remove(path: &Path) {
    match fs::remove_file(path) {
        Err(error) if error.kind() != ErrorKind::NotFound => {
            // Under another name first: a thread that still writes files into it finds it no more, and cannot keep it from being empty.
            let name = path.file_name().and_then(|name| name.to_str());
            let name = name.and_then(|name| name.strip_suffix(SUFFIX));
            let renamed = name.map(|name| path.with_file_name(format!("{name}-removed{SUFFIX}")));
            let renamed = renamed.filter(|to| fs::rename(path, to).is_ok());
            // Nothing more can be done about a directory that cannot be removed.
            let _ = fs::remove_dir_all(renamed.as_deref().unwrap_or(path));
        }
        _ => {}
    }
}

/// Something new that `make` makes beside `target`, locked and noted.
fn make_beside(
    target: &Path,
    make: impl Fn(&Path) -> io::Result<File>,
) -> io::Result<(PathBuf, File)> {
    let directory = match target.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    let mut builder = tempfile::Builder::new();
    let made = builder
        .prefix(PREFIX)
        .suffix(SUFFIX)
        .make_in(directory, |path| {
            let file = make(path)?;
            // Another process may be looking for left-overs just now: what it has locked or removed is left to it.
            let taken = matches!(file.try_lock(), Err(TryLockError::WouldBlock));
            match taken || !path.exists() {
                true => Err(ErrorKind::AlreadyExists.into()),
                false => {
                    live().insert(path.to_path_buf());
                    Ok(file)
                }
            }
        })?;
    let (file, path) = made.keep().map_err(|error| error.error)?;
    if let Ok(metadata) = file.metadata() {
        clear_once(directory, &metadata);
    }
    Ok((path, file))
}

/// Removes left-overs from `directory`, when it is first written to; `ours` is of something that was just made there,
/// which tells its file system's time and our user.
fn clear_once(directory: &Path, ours: &Metadata) {
    let key = directory
        .canonicalize()
        .unwrap_or_else(|_| directory.into());
    let mut cleared = CLEARED.lock().unwrap_or_else(PoisonError::into_inner);
    if !cleared.insert(key) {
        return;
    }
    drop(cleared);
    clear_from(directory, |path, metadata| {
        is_left_over(path, metadata, ours)
    });
}

/// Removes what has names of things in the making from `directory`, and `is_left`.
fn clear_from(directory: &Path, is_left: impl Fn(&Path, &Metadata) -> bool) {
    for entry in fs::read_dir(directory).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        let is_named = name.starts_with(PREFIX) && name.ends_with(SUFFIX);
        if is_named && entry.metadata().is_ok_and(|m| is_left(&entry.path(), &m)) {
            remove(&entry.path());
        }
    }
}

/// Removes what killed processes have left in `directory`, however young it is: for one that the caller has locked for itself.
pub fn clear(directory: &Path) {
    let Ok(ours) = fs::metadata(directory) else {
        return;
    };
    clear_from(directory, |path, metadata| {
        is_left_for(path, metadata, &ours, Duration::ZERO)
    });
}

/// Removes folders in `directory` that killed processes have left: those whose name `is_folder`, except for `own`, where each file is one
/// whose name `is_file` or one in the making, and everything is old, belongs to our user and is locked by nobody. A folder in which anything
/// else lies is no left-over.
pub fn clear_folders(
    directory: &Path,
    own: &Path,
    is_folder: impl Fn(&str) -> bool,
    is_file: impl Fn(&str) -> bool,
) {
    // What is made now tells the file system's time and our user.
    let Ok(Ok(ours)) = tempfile::tempfile_in(directory).map(|file| file.metadata()) else {
        return;
    };
    let is_old = |entry: &fs::DirEntry| {
        let metadata = entry.metadata();
        metadata.is_ok_and(|m| is_left_for(&entry.path(), &m, &ours, FOLDER_AGE))
    };
    let name = |entry: &fs::DirEntry| entry.file_name().to_string_lossy().into_owned();
    let is_making = |name: &str| name.starts_with(PREFIX) && name.ends_with(SUFFIX);
    for folder in fs::read_dir(directory).into_iter().flatten().flatten() {
        let path = folder.path();
        if !is_folder(&name(&folder)) || path.file_name() == own.file_name() || !is_old(&folder) {
            continue;
        }
        let Ok(entries) = fs::read_dir(&path).and_then(Iterator::collect::<io::Result<Vec<_>>>)
        else {
            continue;
        };
        let is_ours = |entry: &fs::DirEntry| {
            let name = name(entry);
            let is_file_of_ours = entry.file_type().is_ok_and(|kind| kind.is_file());
            is_file_of_ours && (is_file(&name) || is_making(&name)) && is_old(entry)
        };
        if entries.iter().all(is_ours) {
            for entry in &entries {
                let _ = fs::remove_file(entry.path());
            }
            // It stays where something was put into it just now.
            let _ = fs::remove_dir(&path);
        }
    }
}

/// Whether nobody works at the file or directory at `path`.
fn is_left_over(path: &Path, metadata: &Metadata, ours: &Metadata) -> bool {
    let needed = if metadata.is_dir() {
        FOLDER_AGE
    } else {
        FILE_AGE
    };
    is_left_for(path, metadata, ours, needed)
}

/// The same where it has not changed for as long as is `needed`.
fn is_left_for(path: &Path, metadata: &Metadata, ours: &Metadata, needed: Duration) -> bool {
    let lock = match metadata {
        m if m.is_dir() => File::open(path),
        m if m.is_file() => OpenOptions::new().read(true).write(true).open(path),
        _ => return false,
    };
    let age = |m: &Metadata| {
        ours.modified()
            .ok()?
            .duration_since(m.modified().ok()?)
            .ok()
    };
    let is_locked = lock.is_ok_and(|file| matches!(file.try_lock(), Err(TryLockError::WouldBlock)));
    let is_old = needed.is_zero() || age(metadata).is_some_and(|age| age >= needed);
    same_owner(metadata, ours) && !is_locked && is_old
}

#[cfg(unix)]
fn same_owner(a: &Metadata, b: &Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    a.uid() == b.uid()
}

#[cfg(not(unix))]
fn same_owner(_: &Metadata, _: &Metadata) -> bool {
    true
}

#[cfg(test)]
mod tests;
