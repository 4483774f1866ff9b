//! NumPy arrays: `.npy` files, and `.npz` archives of them.
//!
//! Format: NEP 1 and `numpy.lib.format`, versions 1.0, 2.0 and 3.0: a magic string, a header (a
//! Python dictionary of `descr`, `fortran_order` and `shape`), then the samples. An `.npz` is a
//! zip archive whose member `name.npy` is the array `name`.
//!
//! Lengths are checked before memory is allocated, and samples are decoded directly into the vector that is returned, through one buffer of
//! 64 KiB. That is why the header is parsed here and not by a crate.

mod archive;
mod array;
mod header;
mod place;

use std::io::BufReader;
use std::path::Path;

use serde_json::{Map, Value};

pub(super) use archive::{Stored, with_array};
pub use array::{Numbers, Plain};
pub use header::{Dtype, Header};
pub(super) use place::{Place, WRITE_AGAIN};

use super::budget::Budget;
use super::open::open_regular;
use crate::Result;

/// The array of the texts that describe the others of an archive of nullray.
const METADATA: &str = "metadata";

/// The headers of all arrays of a `.npy` or `.npz` file, or of the one named `array`; no samples
/// are read.
///
/// # Errors
/// The file cannot be read, is neither a `.npy` nor a `.npz` file, or has no such array.
pub fn inspect(path: &Path, array: Option<&str>) -> Result<Vec<Header>> {
    let (file, _) = open_regular(path)?;
    archive::headers(&mut BufReader::new(file), path, array)
}

/// An array of numbers of any shape, or the one named `array` in a `.npz` file (the name may be omitted if the archive contains only one
/// array).
///
/// # Errors
/// The file cannot be read; it is truncated or longer than its header says; the array does not contain numbers of at most 64 bits, or
/// contains integers beyond 2⁵³; it needs more memory than `budget` has.
pub fn load_plain(path: &Path, array: Option<&str>, budget: &Budget) -> Result<Plain> {
    let (file, _) = open_regular(path)?;
    let read = |stored: &mut Stored| array::read(stored, path, budget);
    with_array(&mut BufReader::new(file), path, array, read)
}

/// The numbers of an array with one axis.
///
/// # Errors
/// As for [`load_plain`]; an array with more or fewer axes.
pub(crate) fn load_numbers(path: &Path, array: Option<&str>, budget: &Budget) -> Result<Vec<f64>> {
    let (file, _) = open_regular(path)?;
    let read = |stored: &mut Stored| array::read_list(stored, path, budget);
    let samples = with_array(&mut BufReader::new(file), path, array, read)?;
    Ok(samples.into_f64())
}

/// The text in the array named `array` of a `.npz` file.
///
/// # Errors
/// The file cannot be read; there is no such array; it is not a single text.
pub(crate) fn load_text(path: &Path, array: &str, budget: &Budget) -> Result<String> {
    let (file, _) = open_regular(path)?;
    let read = |stored: &mut Stored| array::text(stored, path, budget);
    with_array(&mut BufReader::new(file), path, Some(array), read)
}

/// The metadata that nullray writes into its archives, an object of texts; `None` for other files.
pub fn load_metadata(path: &Path) -> Option<Map<String, Value>> {
    // No longer than a few scenes.
    let text = load_text(path, METADATA, &Budget::new(1 << 26)).ok()?;
    serde_json::from_str(&text).ok()
}
