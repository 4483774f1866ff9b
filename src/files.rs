//! Files of scenes: on disk, or compiled into the program.
//!
//! Paths that begin with [`BUILT_IN`] name compiled-in files, so that the built-in scene goes the same
//! way through the program as any other.

use std::borrow::Cow;
use std::fs::{self, File};
use std::io::{self, BufReader, Cursor, Read, Seek};
use std::path::Path;

/// The folder of compiled-in files.
pub const BUILT_IN: &str = "builtin:";

/// Compiled-in files by path below [`BUILT_IN`].
const FILES: &[(&str, &[u8])] = &[
    ("corner/corner.glb", include_bytes!("../scenes/corner/corner.glb")),
    ("corner/lightmap.npz", include_bytes!("../scenes/corner/lightmap.npz")),
];

/// What can be read in any order.
pub trait ReadSeek: Read + Seek {}

impl<T: Read + Seek> ReadSeek for T {}

/// The compiled-in file at `path`, if `path` is such a path.
fn built_in(path: &Path) -> Option<io::Result<&'static [u8]>> {
    let below = path.strip_prefix(BUILT_IN).ok()?;
    let file = FILES.iter().find(|(name, _)| Path::new(name) == below);
    Some(file.map(|(_, bytes)| *bytes).ok_or_else(|| io::ErrorKind::NotFound.into()))
}

/// Opens a file for reading.
///
/// # Errors
/// As the operating system has them.
pub fn open(path: &Path) -> io::Result<Box<dyn ReadSeek>> {
    match built_in(path) {
        Some(bytes) => Ok(Box::new(Cursor::new(bytes?))),
        None => Ok(Box::new(BufReader::new(File::open(path)?))),
    }
}

/// The whole content of a file.
///
/// # Errors
/// As the operating system has them.
pub fn read(path: &Path) -> io::Result<Cow<'static, [u8]>> {
    match built_in(path) {
        Some(bytes) => Ok(Cow::Borrowed(bytes?)),
        None => Ok(Cow::Owned(fs::read(path)?)),
    }
}

/// Length of a file in bytes.
///
/// # Errors
/// As the operating system has them; directories are refused.
pub fn length(path: &Path) -> io::Result<u64> {
    if let Some(bytes) = built_in(path) {
        return Ok(bytes?.len() as u64);
    }
    let metadata = fs::metadata(path)?;
    if metadata.is_dir() {
        return Err(io::ErrorKind::IsADirectory.into());
    }
    Ok(metadata.len())
}
