//! A directory that appears whole or not at all.
//!
//! It is filled under a temporary name beside the target, and renamed to the target when complete: if an export has that name, the two
//! are exchanged atomically. On any failure the new one is removed, and the old one stays as it was. Only those files of an old export
//! are removed that its own list names; a directory that contains anything else is not replaced.

use std::collections::BTreeSet;
use std::fs;
use std::io::{self, ErrorKind, Read};
use std::path::{Component, Path, PathBuf};

use super::{DESCRIPTION, FORMAT};
use crate::error::{Error, Message, Result, Setting};
use crate::io::temporary::Temporary;

/// The longest description that is read, bytes.
const LONGEST: u64 = 256 << 20;

/// A directory under construction; removed if dropped before it is finished.
#[derive(Debug)]
pub(super) struct Folder {
    target: PathBuf,
    overwrite: bool,
    temporary: Temporary,
}

impl Folder {
    /// Starts the directory that will be `target`. An existing one is replaced if it is empty, or with `overwrite` if it is an export and
    /// nothing else.
    pub fn create(target: &Path, overwrite: bool) -> Result<Self> {
        check(target, overwrite)?;
        let temporary =
            Temporary::folder(target).map_err(Error::io(target, "cannot create the directory"))?;
        Ok(Folder {
            target: target.to_path_buf(),
            overwrite,
            temporary,
        })
    }

    /// The path under which file `name` of the directory is written.
    pub fn path(&self, name: &str) -> PathBuf {
        self.temporary.path().join(name)
    }

    /// Makes a subdirectory, if it does not exist.
    pub fn subfolder(&self, name: &str) -> Result<()> {
        let path = self.path(name);
        fs::create_dir_all(&path).map_err(Error::io(&path, "cannot create the directory"))
    }

    /// Renames the directory to its target.
    pub fn finish(self) -> Result<()> {
        let failed = Error::io(&self.target, "cannot replace the directory");
        // Something may have been created there meanwhile.
        let Some(old) = check(&self.target, self.overwrite)? else {
            return self.temporary.persist(&self.target).map_err(failed);
        };
        exchange(self.temporary.path(), &self.target).map_err(failed)?;
        let path = self.temporary.path().to_path_buf();
        self.temporary.keep();
        remove_listed(&path, &old).map_err(Error::io(&path, "cannot remove the old directory"))
    }
}

/// The files that an export lists, and the list itself.
type Listed = BTreeSet<PathBuf>;

/// Exchanges the names of two directories.
#[cfg(target_os = "linux")]
fn exchange(new: &Path, target: &Path) -> io::Result<()> {
    use rustix::fs::{CWD, RenameFlags, renameat_with};
    let swapped = renameat_with(CWD, new, CWD, target, RenameFlags::EXCHANGE);
    // Some file systems cannot do it atomically.
    swapped.or_else(|_| exchange_in_turn(new, target))
}

#[cfg(not(target_os = "linux"))]
fn exchange(new: &Path, target: &Path) -> io::Result<()> {
    exchange_in_turn(new, target)
}

fn exchange_in_turn(new: &Path, target: &Path) -> io::Result<()> {
    let aside = Temporary::folder(target)?;
    fs::remove_dir(aside.path())?;
    fs::rename(target, aside.path())?;
    if let Err(error) = fs::rename(new, target) {
        // The first error is the one to report.
        let _ = fs::rename(aside.path(), target);
        return Err(error);
    }
    fs::rename(aside.path(), new)
}

/// Removes the files that are `listed`, and the directories that become empty.
fn remove_listed(directory: &Path, listed: &Listed) -> io::Result<()> {
    for name in listed {
        match fs::remove_file(directory.join(name)) {
            Err(error) if error.kind() != ErrorKind::NotFound => return Err(error),
            _ => {}
        }
    }
    let mut parents: BTreeSet<&Path> = listed
        .iter()
        .flat_map(|name| name.ancestors().skip(1))
        .collect();
    // Of two nested names, the longer is inside the shorter; the last is the directory itself.
    while let Some(parent) = parents.pop_last() {
        match fs::remove_dir(directory.join(parent)) {
            Err(error) if error.kind() != ErrorKind::NotFound => return Err(error),
            _ => {}
        }
    }
    Ok(())
}

/// Refuses a target whose content would be lost, or that cannot be a directory; returns the list of an existing export.
fn check(target: &Path, overwrite: bool) -> Result<Option<Listed>> {
    let refused = |what: String, help: Message| Err(Error::invalid(target, "", what, help));
    if target.file_name().is_none() {
        return refused(
            "no directory can be made with this name".into(),
            "name a new directory".into(),
        );
    }
    match target.symlink_metadata() {
        Err(e) if e.kind() == ErrorKind::NotFound => return Ok(None),
        Err(e) => return Err(Error::io(target, "cannot look at the directory")(e)),
        Ok(found) if !found.is_dir() => {
            let what = "something that is not a directory has this name";
            return refused(what.into(), "name a new directory".into());
        }
        Ok(_) => {}
    }
    let failed = || Error::io(target, "cannot read the directory");
    if fs::read_dir(target).map_err(failed())?.next().is_none() {
        return Ok(None);
    }
    let Some(listed) = listed(target) else {
        return refused(
            "there is a directory of this name that is not an export, and it is not empty".into(),
            "name a new directory".into(),
        );
    };
    if !overwrite {
        return refused(
            "there is an export of this name already".into(),
            Message::from("name a new directory, or replace that one (") + Setting::Overwrite + ")",
        );
    }
    match stranger(target, Path::new(""), &listed).map_err(failed())? {
        None => Ok(Some(listed)),
        Some(name) => refused(
            format!(
                "{} is in it and does not belong to the export: it would be lost",
                name.display()
            ),
            "move it elsewhere, or name a new directory".into(),
        ),
    }
}

/// The files that the description of an export in `directory` lists, and its own name; `None` if there is no such description.
fn listed(directory: &Path) -> Option<Listed> {
    let mut text = Vec::new();
    let file = fs::File::open(directory.join(DESCRIPTION)).ok()?;
    file.take(LONGEST).read_to_end(&mut text).ok()?;
    let bundle: serde_json::Value = serde_json::from_slice(&text).ok()?;
    if bundle.get("format")?.as_str()? != FORMAT {
        return None;
    }
    let path = |file: &serde_json::Value| {
        let path = PathBuf::from(file.get("path")?.as_str()?);
        // A list with paths outside the directory was not written by an export.
        let is_inside = path
            .components()
            .all(|part| matches!(part, Component::Normal(_)));
        (is_inside && path.file_name().is_some()).then_some(path)
    };
    let files = bundle.get("files")?.as_array()?;
    files
        .iter()
        .map(path)
        .chain([Some(DESCRIPTION.into())])
        .collect()
}

/// Finds anything below `at` in `directory` that is neither a `listed` file nor a directory with such files.
fn stranger(directory: &Path, at: &Path, listed: &Listed) -> io::Result<Option<PathBuf>> {
    for entry in fs::read_dir(directory.join(at))? {
        let entry = entry?;
        let name = at.join(entry.file_name());
        let kind = entry.file_type()?;
        let holds_files = || {
            listed
                .iter()
                .any(|file| *file != name && file.starts_with(&name))
        };
        if kind.is_dir() && holds_files() {
            if let Some(inner) = stranger(directory, &name, listed)? {
                return Ok(Some(inner));
            }
        } else if !(kind.is_file() && listed.contains(&name)) {
            return Ok(Some(name));
        }
    }
    Ok(None)
}
