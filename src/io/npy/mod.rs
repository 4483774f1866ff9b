//! NumPy arrays: `.npy` files, and `.npz` archives of them.
//!
//! Format: NEP 1 and `numpy.lib.format`, versions 1.0, 2.0 and 3.0: a magic string, a header (a
//! Python dictionary of `descr`, `fortran_order` and `shape`), then the samples. An `.npz` is a
//! zip archive whose member `name.npy` is the array `name`.
//!
//! A cube is an array of shape (H, W, T) or (H, W, T, C), C order, half, single or double
//! precision, of either byte order; C is 1 or 3. Its samples are decoded straight into the vector
//! that the renderer keeps, through one buffer of 64 KiB.
//!
//! The header is parsed here and not by the crate `npyz`: what is needed of it is a hundred lines,
//! and length checks before allocation, one copy in memory, and messages that name the array and
//! the sample would have to be built around the crate in any case.

mod archive;
mod header;
mod literal;
mod plain;
mod samples;

use std::io::{BufReader, Cursor, Read, Seek};
use std::path::{Path, PathBuf};

pub use header::{Dtype, Header};
pub use plain::{Numbers, Plain};

use super::open::open_regular;
use crate::light::time_texture::Cube;
use crate::{Error, Result};

/// What a cube will be once it is loaded: its shape and its size in memory.
#[derive(Debug, Clone, PartialEq)]
pub struct CubeInfo {
    /// H, W, T, C; each at least 1.
    pub shape: [usize; 4],
    /// The precision of the samples.
    pub dtype: Dtype,
    /// Bytes of the samples in memory.
    pub bytes: u64,
}

/// The headers of all arrays of a `.npy` or `.npz` file, or of the one named `array`; no samples
/// are read, and arrays need not be cubes.
///
/// # Errors
/// The file cannot be read, is neither a `.npy` nor a `.npz` file, or has no such array.
pub fn inspect(path: &Path, array: Option<&str>) -> Result<Vec<Header>> {
    let (file, _) = open_regular(path)?;
    archive::headers(BufReader::new(file), path, array)
}

/// What [`load`] would load, by the same checks of headers and lengths; no samples are read.
///
/// # Errors
/// As for [`load`], except for what is wrong with samples.
pub fn inspect_cube(path: &Path, array: Option<&str>) -> Result<CubeInfo> {
    let (file, _) = open_regular(path)?;
    let mut reader = BufReader::new(file);
    archive::with_array(&mut reader, path, array, |stored| {
        Ok(stored.cube_layout()?.1)
    })
}

/// The cube in a `.npy` file, or the one named `array` in a `.npz` file (which may be left out
/// where the archive holds one array only).
///
/// # Errors
/// The file cannot be read; it is truncated or longer than its header says; the array is not of
/// shape (H, W, T) or (H, W, T, C) with C of 1 or 3, not in C order, not floating-point; a sample
/// is not finite.
pub fn load(path: &Path, array: Option<&str>) -> Result<Cube> {
    let (file, _) = open_regular(path)?;
    load_from(BufReader::new(file), path, array)
}

/// An array of numbers of any shape, or the one named `array` in a `.npz` file (which may be left out where the archive
/// holds one array only).
///
/// # Errors
/// The file cannot be read; it is truncated or longer than its header says; the array is in Fortran order or
/// does not hold numbers of at most 32 bits, or f8.
pub fn load_plain(path: &Path, array: Option<&str>) -> Result<Plain> {
    let (file, _) = open_regular(path)?;
    archive::with_array(&mut BufReader::new(file), path, array, plain::read)
}

/// The text that the array named `array` of a `.npz` file is.
///
/// # Errors
/// The file cannot be read; there is no such array; it is no single text.
pub fn load_text(path: &Path, array: &str) -> Result<String> {
    let (file, _) = open_regular(path)?;
    archive::with_array(&mut BufReader::new(file), path, Some(array), plain::text)
}

/// As [`load`], from bytes in memory; `name` stands for the file in messages.
///
/// # Errors
/// As for [`load`].
pub fn load_bytes(bytes: &[u8], name: &str, array: Option<&str>) -> Result<Cube> {
    load_from(Cursor::new(bytes), Path::new(name), array)
}

fn load_from<R: Read + Seek>(mut reader: R, file: &Path, array: Option<&str>) -> Result<Cube> {
    archive::with_array(&mut reader, file, array, |stored| {
        let (header, info) = stored.cube_layout()?;
        let samples = samples::read(stored.reader, &header, info.shape, &stored.place)?;
        Ok(Cube {
            shape: info.shape,
            samples,
        })
    })
}

/// Where something is, for messages: a file and, in an archive, one of its arrays.
#[derive(Debug, Clone)]
struct Place {
    file: PathBuf,
    array: Option<String>,
}

impl Place {
    fn new(file: &Path, array: Option<&str>) -> Self {
        Place {
            file: file.to_path_buf(),
            array: array.map(str::to_owned),
        }
    }

    /// "array "name", detail", or whichever of the two there are.
    fn text(&self, detail: &str) -> String {
        match &self.array {
            Some(array) if detail.is_empty() => format!("array {array:?}"),
            Some(array) => format!("array {array:?}, {detail}"),
            None => detail.to_owned(),
        }
    }

    fn invalid(&self, detail: &str, what: impl Into<String>, help: impl Into<String>) -> Error {
        Error::invalid(&self.file, self.text(detail), what, help)
    }

    fn unsupported(&self, detail: &str, what: impl Into<String>, help: impl Into<String>) -> Error {
        Error::unsupported(&self.file, self.text(detail), what, help)
    }

    /// An I/O error while reading: a short file and a broken archive are the file's fault.
    fn read_error(&self, detail: &str, error: std::io::Error) -> Error {
        use std::io::ErrorKind::{InvalidData, InvalidInput, UnexpectedEof, Unsupported};
        match error.kind() {
            UnexpectedEof => self.invalid(detail, "the file ends too early", WRITE_AGAIN),
            Unsupported => self.unsupported(detail, error.to_string(), MEMBERS),
            InvalidData | InvalidInput => self.invalid(
                detail,
                format!("the archive is broken: {error}"),
                WRITE_AGAIN,
            ),
            _ => Error::io(&self.file, "cannot read")(error),
        }
    }
}

/// What members of an archive may be.
const MEMBERS: &str = "members may be stored or deflated, without a password, as numpy.savez and \
                       numpy.savez_compressed write them";

/// The remedy for a file that was cut or damaged.
const WRITE_AGAIN: &str = "copy the file again, or write it again with numpy.save or numpy.savez";
