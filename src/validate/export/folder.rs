//! A directory that appears whole or not at all.
//!
//! It is filled under a temporary name beside the target, and takes the target's name when all is in it. On
//! any failure it is removed, and what was there stays as it was.

use std::fs;
use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};
use std::process;
use std::sync::atomic::{AtomicU64, Ordering};

use super::{DESCRIPTION, MARK};
use crate::error::{Error, Result};

/// Makes temporary names of one process distinct.
static COUNTER: AtomicU64 = AtomicU64::new(0);

/// A directory in the making; removed when dropped before it is finished.
#[derive(Debug)]
pub(super) struct Folder {
    target: PathBuf,
    temporary: PathBuf,
    finished: bool,
}

impl Folder {
    /// Begins the directory that will be `target`. One of this name is replaced where it is empty, and
    /// with `overwrite` where it is an export.
    pub fn create(target: &Path, overwrite: bool) -> Result<Self> {
        check(target, overwrite)?;
        let temporary = beside(target);
        fs::create_dir(&temporary).map_err(Error::io(target, "cannot create the directory"))?;
        Ok(Folder {
            target: target.to_path_buf(),
            temporary,
            finished: false,
        })
    }

    /// Where file `name` of the directory is written.
    pub fn path(&self, name: &str) -> PathBuf {
        self.temporary.join(name)
    }

    /// Makes a directory in it, where it is not there.
    pub fn subfolder(&self, name: &str) -> Result<()> {
        let path = self.path(name);
        fs::create_dir_all(&path).map_err(Error::io(&path, "cannot create the directory"))
    }

    /// Gives the directory its name.
    pub fn finish(mut self) -> Result<()> {
        let failed = || Error::io(&self.target, "cannot replace the directory");
        let old = beside(&self.target);
        let replaces = self.target.symlink_metadata().is_ok();
        if replaces {
            fs::rename(&self.target, &old).map_err(failed())?;
        }
        if let Err(error) = fs::rename(&self.temporary, &self.target) {
            if replaces {
                // The first error is the one to report.
                let _ = fs::rename(&old, &self.target);
            }
            return Err(failed()(error));
        }
        self.finished = true;
        if replaces {
            fs::remove_dir_all(&old).map_err(Error::io(&old, "cannot remove the old directory"))?;
        }
        Ok(())
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        if !self.finished {
            // Nothing more can be done about a directory that cannot be removed.
            let _ = fs::remove_dir_all(&self.temporary);
        }
    }
}

/// A name beside `target` that is not in use by this process.
fn beside(target: &Path) -> PathBuf {
    let n = COUNTER.fetch_add(1, Ordering::Relaxed);
    target.with_file_name(format!(".nullray-{}-export-{n}.part", process::id()))
}

/// Refuses a target whose content would be lost, or that cannot be a directory.
fn check(target: &Path, overwrite: bool) -> Result<()> {
    let refused = |what, help| Err(Error::invalid(target, "", what, help));
    if target.file_name().is_none() {
        return refused(
            "this is not the name of a directory to be made",
            "name a new directory",
        );
    }
    match target.symlink_metadata() {
        Err(e) if e.kind() == ErrorKind::NotFound => return Ok(()),
        Err(e) => return Err(Error::io(target, "cannot look at the directory")(e)),
        Ok(found) if !found.is_dir() => {
            let what = "there is something of this name that is not a directory";
            return refused(what, "name a new directory");
        }
        Ok(_) => {}
    }
    let mut entries =
        fs::read_dir(target).map_err(Error::io(target, "cannot read the directory"))?;
    if entries.next().is_none() {
        return Ok(());
    }
    match (is_export(target), overwrite) {
        (true, true) => Ok(()),
        (true, false) => refused(
            "there is an export of this name already",
            "name a new directory, or replace that one with --overwrite",
        ),
        (false, _) => refused(
            "there is a directory of this name that is no export, and it is not empty",
            "name a new directory",
        ),
    }
}

/// Whether `directory` was written by this module.
fn is_export(directory: &Path) -> bool {
    let mut start = Vec::new();
    let opened = fs::File::open(directory.join(DESCRIPTION));
    let read = opened.and_then(|file| file.take(256).read_to_end(&mut start));
    read.is_ok() && String::from_utf8_lossy(&start).contains(MARK)
}
