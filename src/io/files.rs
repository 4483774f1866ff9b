//! Files of scenes: on disk, or compiled into the program.
//!
//! Paths that begin with [`BUILT_IN`] name compiled-in files, so that the built-in scene is treated like any other.

use std::fs::{File, Metadata};
use std::io::{self, Cursor, Read, Seek};
use std::path::Path;
use std::sync::LazyLock;
use std::time::SystemTime;

use super::packed;

/// The folder of compiled-in files.
pub const BUILT_IN: &str = "builtin:";

/// Compiled-in files by path below [`BUILT_IN`].
static FILES: [(&str, LazyLock<io::Result<Vec<u8>>>); 2] = [
    (
        "corner/corner.glb",
        LazyLock::new(|| Ok(include_bytes!("../../scenes/corner/corner.glb").to_vec())),
    ),
    ("corner/lightmap.npz", LazyLock::new(packed::lightmap)),
];

/// The paths of the compiled-in files below [`BUILT_IN`].
pub fn built_in_names() -> impl Iterator<Item = &'static str> {
    FILES.iter().map(|(name, _)| *name)
}

/// What can be read in any order.
pub trait ReadSeek: Read + Seek + Send {}

impl<T: Read + Seek + Send> ReadSeek for T {}

/// An open file.
pub type Reader = Box<dyn ReadSeek>;

/// The length in bytes of a regular file.
///
/// # Errors
/// Those of the operating system; anything but a regular file is refused, because opening a pipe may block for ever, and reading a device
/// may never end.
pub fn length(path: &Path) -> io::Result<u64> {
    if let Some(bytes) = built_in(path) {
        return Ok(bytes?.len() as u64);
    }
    let metadata = std::fs::metadata(path)?;
    if metadata.is_file() {
        return Ok(metadata.len());
    }
    Err(io::Error::new(
        io::ErrorKind::InvalidInput,
        match metadata.is_dir() {
            true => "this is a directory, not a regular file",
            false => "this is not a regular file",
        },
    ))
}

/// Opens a regular file for reading; also its length in bytes.
///
/// # Errors
/// As [`length`] has them.
pub fn open(path: &Path) -> io::Result<(Reader, u64)> {
    let length = length(path)?;
    let reader: Reader = match built_in(path) {
        Some(bytes) => Box::new(Cursor::new(bytes?)),
        None => Box::new(File::open(path)?),
    };
    Ok((reader, length))
}

/// Detects changes to the content of an open file, even if its modification time is restored.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stamp {
    length: u64,
    modified: Option<SystemTime>,
    /// The time of the last change of any kind, and the number of its names: a rename over it changes both.
    #[cfg(unix)]
    any_change: [i64; 2],
    #[cfg(unix)]
    names: u64,
}

impl Stamp {
    pub fn of(metadata: &Metadata) -> Stamp {
        #[cfg(unix)]
        use std::os::unix::fs::MetadataExt;
        Stamp {
            length: metadata.len(),
            modified: metadata.modified().ok(),
            #[cfg(unix)]
            any_change: [metadata.ctime(), metadata.ctime_nsec()],
            #[cfg(unix)]
            names: metadata.nlink(),
        }
    }

    /// Whether the file's content is still what it was when this was made.
    pub fn holds(&self, now: &Metadata) -> bool {
        let now = Stamp::of(now);
        let same = self.length == now.length && self.modified == now.modified;
        #[cfg(unix)]
        let same = same && (self.any_change == now.any_change || self.names != now.names);
        same
    }
}

/// Whether the file at `path` is one of the operating system's.
pub(super) fn is_on_disk(path: &Path) -> bool {
    path.strip_prefix(BUILT_IN).is_err()
}

fn built_in(path: &Path) -> Option<io::Result<&'static [u8]>> {
    let below = path.strip_prefix(BUILT_IN).ok()?;
    let file = FILES.iter().find(|(name, _)| Path::new(name) == below);
    Some(match file.map(|(_, bytes)| bytes.as_ref()) {
        Some(Ok(bytes)) => Ok(bytes.as_slice()),
        Some(Err(error)) => Err(io::Error::new(error.kind(), error.to_string())),
        None => Err(io::ErrorKind::NotFound.into()),
    })
}
