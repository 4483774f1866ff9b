//! An HDF5 file, opened without reading ahead, so that nothing in it can request much memory.

use std::io::SeekFrom;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use hdf5_reader::group::Group;
use hdf5_reader::storage::{RangeRequestStorage, Storage};
use hdf5_reader::{
    ByteOrder, Datatype, FilterRegistry, H5Type, Hdf5File, OpenOptions, SliceInfo, SliceInfoElem,
};

use super::super::number::Number;
use super::super::selection::Windows;
use super::lzf;
use crate::error::{Error, Result};
use crate::io::files::Reader;
use crate::io::npy::{Dtype, Header};

/// Samples read together if there are no chunks.
const TOGETHER: usize = 1024;
/// The largest chunk, and the largest single read, bytes.
const LARGEST: usize = 1 << 30;
/// The most numbers of a small array, such as positions of points.
const MOST_NUMBERS: u64 = 1 << 24;
/// The depth to which groups are searched, and the number of arrays listed.
const DEEPEST: usize = 8;
const MOST_LISTED: usize = 1000;

/// An open file.
pub(super) struct File {
    file: Hdf5File,
    path: PathBuf,
}

impl File {
    /// With `cache` bytes of decoded chunks that are kept.
    pub fn open(mut reader: Reader, path: &Path, cache: usize) -> Result<File> {
        let failed = || Error::io(path, "cannot read");
        let length = reader.seek(SeekFrom::End(0)).map_err(failed())?;
        let reader = Mutex::new(reader);
        let storage = RangeRequestStorage::new(length, move |offset, count| {
            let mut reader = reader.lock().unwrap_or_else(PoisonError::into_inner);
            let mut bytes = vec![0; count];
            reader.seek(SeekFrom::Start(offset))?;
            reader.read_exact(&mut bytes)?;
            Ok(bytes)
        });
        let storage: std::sync::Arc<dyn Storage> = std::sync::Arc::new(storage);
        let mut filters = FilterRegistry::new();
        filters.register(lzf::FILTER, Box::new(lzf::decompress));
        let options = OpenOptions {
            filter_registry: Some(filters),
            chunk_cache_bytes: cache,
            max_chunk_bytes: LARGEST,
            max_read_bytes: LARGEST,
            ..OpenOptions::default()
        };
        let file = Hdf5File::from_storage_with_options(storage, options)
            .map_err(|error| refused(path, "", error))?;
        Ok(File {
            file,
            path: path.to_path_buf(),
        })
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Names of the groups and of the arrays of a group.
    pub fn names(&self, group: &str) -> Result<(Vec<String>, Vec<String>)> {
        let group = self.group(group)?;
        group
            .member_names()
            .map_err(|error| refused(&self.path, "", error))
    }

    fn group(&self, name: &str) -> Result<Group> {
        let group = match name {
            "" => self.file.root_group(),
            name => self.file.group(name),
        };
        group.map_err(|error| refused(&self.path, name, error))
    }

    pub fn array(&self, name: &str) -> Result<Array> {
        match self.file.dataset(name) {
            Ok(dataset) => Ok(Array {
                dataset,
                name: name.into(),
                path: self.path.clone(),
            }),
            Err(error) => {
                let names: Vec<_> = self.arrays()?.into_iter().filter_map(|h| h.name).collect();
                match names.iter().any(|known| known == name) {
                    true => Err(refused(&self.path, name, error)),
                    false => {
                        let what = format!("there is no array {name:?}");
                        let help = format!("it holds {}", names.join(", "));
                        Err(Error::invalid(&self.path, "", what, help))
                    }
                }
            }
        }
    }

    /// The numbers of a small array, and its sizes; `None` if it does not exist or is empty.
    pub fn numbers(&self, name: &str) -> Result<Option<(Vec<f64>, Vec<u64>)>> {
        let Ok(dataset) = self.file.dataset(name) else {
            return Ok(None);
        };
        let failed = |error| refused(&self.path, name, error);
        match dataset.num_elements().map_err(failed)? {
            0 => Ok(None),
            count if count > MOST_NUMBERS => {
                let what = format!("{count} numbers are too many for the description of a capture");
                Err(Error::invalid(&self.path, name, what, "check the file"))
            }
            _ => {
                if kind(dataset.dtype()).is_none() {
                    let what = "these are not numbers";
                    return Err(Error::invalid(&self.path, name, what, "check the file"));
                }
                let numbers = dataset.read_array::<Sample>().map_err(failed)?;
                let numbers: Vec<f64> = numbers.iter().map(|sample| sample.0).collect();
                match numbers.iter().all(|x| x.is_finite()) {
                    true => Ok(Some((numbers, dataset.shape().to_vec()))),
                    false => {
                        let what = "a number is not finite";
                        Err(Error::invalid(&self.path, name, what, "check the file"))
                    }
                }
            }
        }
    }

    /// The one number of an array.
    pub fn number(&self, name: &str) -> Result<Option<f64>> {
        Ok(self.numbers(name)?.and_then(|(numbers, _)| match *numbers {
            [number] => Some(number),
            _ => None,
        }))
    }

    /// The names of an array's axes, and their origin: the labels of its dimensions (`dims[0].label` of h5py), or the names of the scales
    /// attached to them (netCDF, xarray). Axes without names are "".
    pub fn axis_names(&self, array: &Array) -> Option<(Vec<String>, &'static str)> {
        let count = array.sizes().len();
        let labels = array.texts("DIMENSION_LABELS").unwrap_or_default();
        if labels.len() == count && labels.iter().any(|label| !label.is_empty()) {
            return Some((labels, "dimension labels"));
        }
        let scales = self.scales(array)?;
        (scales.len() == count && scales.iter().any(|name| !name.is_empty()))
            .then_some((scales, "dimension scales"))
    }

    /// The name of the first scale of each axis. The attribute `DIMENSION_LIST` is a list, per axis, of references to them, which are
    /// addresses of objects ("HDF5 Dimension Scale Specification").
    fn scales(&self, array: &Array) -> Option<Vec<String>> {
        let list = array.dataset.attribute("DIMENSION_LIST").ok()?;
        let each = array.dataset.vlen_reference_size();
        let group = array.name.rsplit_once('/').map_or("", |(group, _)| group);
        let groups = [self.group(group).ok()?, self.group("").ok()?];
        let name = |of_axis: &[u8]| {
            let addresses = array
                .dataset
                .resolve_vlen_reference_bytes(of_axis, each - 8);
            let addresses = addresses.ok()?;
            let mut address = [0; 8];
            let bytes = addresses.get(..(each - 8).min(8))?;
            address[..bytes.len()].copy_from_slice(bytes);
            let address = u64::from_le_bytes(address);
            let known = |group: &Group| group.child_name_by_address(address).ok().flatten();
            groups.iter().find_map(known)
        };
        let of_axes = list.raw_data.chunks_exact(each);
        Some(
            of_axes
                .map(|of_axis| name(of_axis).unwrap_or_default())
                .collect(),
        )
    }

    /// All arrays, those of groups with their path.
    pub fn arrays(&self) -> Result<Vec<Header>> {
        let mut found = Vec::new();
        self.list("", DEEPEST, &mut found)?;
        Ok(found)
    }

    fn list(&self, group: &str, depth: usize, found: &mut Vec<Header>) -> Result<()> {
        let (groups, arrays) = self.names(group)?;
        let inside = |name: &str| match group {
            "" => name.to_string(),
            group => format!("{group}/{name}"),
        };
        for name in arrays {
            if found.len() == MOST_LISTED {
                return Ok(());
            }
            let name = inside(&name);
            // Arrays that cannot be opened cannot be used either.
            let Ok(dataset) = self.file.dataset(&name) else {
                continue;
            };
            let (dtype, big_endian) = match kind(dataset.dtype()) {
                Some(kind) => (kind.shown(), kind.big_endian),
                None => (Dtype::Other(described(dataset.dtype()).into()), false),
            };
            found.push(Header {
                name: Some(name),
                shape: dataset.shape().iter().map(|n| *n as usize).collect(),
                dtype,
                fortran_order: false,
                big_endian,
            });
        }
        // MATLAB keeps its own notes under #refs#.
        for name in groups.iter().filter(|name| !name.starts_with('#')) {
            if depth > 0 && found.len() < MOST_LISTED {
                self.list(&inside(name), depth - 1, found)?;
            }
        }
        Ok(())
    }
}

/// An array of a file.
pub(super) struct Array {
    dataset: hdf5_reader::Dataset,
    name: String,
    path: PathBuf,
}

impl Array {
    pub fn name(&self) -> &str {
        &self.name
    }

    pub fn sizes(&self) -> &[u64] {
        self.dataset.shape()
    }

    /// The type of samples in memory.
    pub fn dtype(&self) -> Result<Dtype> {
        match kind(self.dataset.dtype()) {
            Some(kind) => Ok(kind.loaded()),
            None => Err(Error::unsupported(
                &self.path,
                &self.name,
                format!("{} cannot hold radiance", described(self.dataset.dtype())),
                "give floating-point samples of 16, 32 or 64 bits, or integers: array.astype(numpy.float32)",
            )),
        }
    }

    /// A text attribute of the array.
    pub fn text(&self, attribute: &str) -> Option<String> {
        self.texts(attribute)?.into_iter().next()
    }

    /// Text attributes of the array, of fixed or variable length.
    fn texts(&self, attribute: &str) -> Option<Vec<String>> {
        let attribute = self.dataset.attribute(attribute).ok()?;
        if let Ok(texts) = attribute.read_strings() {
            return Some(texts);
        }
        let each = self.dataset.vlen_reference_size();
        let text = |reference: &[u8]| {
            let length = u32::from_le_bytes(reference[..4].try_into().ok()?);
            if length == 0 {
                return Some(String::new());
            }
            let bytes = self
                .dataset
                .resolve_vlen_reference_bytes(reference, 1)
                .ok()?;
            let text = String::from_utf8(bytes).ok()?;
            Some(text.trim_end_matches('\0').to_string())
        };
        match &attribute.datatype {
            Datatype::VarLen { .. } if attribute.raw_data.len() % each == 0 => {
                attribute.raw_data.chunks_exact(each).map(text).collect()
            }
            _ => attribute.read_string().ok().map(|text| vec![text]),
        }
    }

    /// A number attribute of the array.
    pub fn number(&self, attribute: &str) -> Option<f64> {
        let number = self.dataset.attribute(attribute).ok()?.read_as_f64().ok()?;
        number.is_finite().then_some(number)
    }
}

impl Windows for Array {
    fn read(&mut self, window: &[Range<usize>], to: &mut Vec<f64>) -> Result<()> {
        let selections = window.iter().map(|range| SliceInfoElem::Slice {
            start: range.start as u64,
            end: range.end as u64,
            step: 1,
        });
        let selection = SliceInfo {
            selections: selections.collect(),
        };
        let failed = |error| refused(&self.path, &self.name, error);
        let samples = self
            .dataset
            .read_slice::<Sample>(&selection)
            .map_err(failed)?;
        to.clear();
        to.extend(samples.iter().map(|sample| sample.0));
        let count: usize = window.iter().map(ExactSizeIterator::len).product();
        match to.len() == count {
            true => Ok(()),
            false => Err(Error::invalid(
                &self.path,
                &self.name,
                "the array has fewer samples than it declares",
                AGAIN,
            )),
        }
    }

    fn together(&self) -> Vec<usize> {
        if let Some(chunks) = self.dataset.chunks() {
            return chunks.into_iter().map(|n| n as usize).collect();
        }
        // Runs along the last axes.
        let mut left = TOGETHER;
        let mut together: Vec<usize> = (self.sizes().iter().rev())
            .map(|size| {
                let run = (*size).clamp(1, left as u64) as usize;
                left = if run as u64 == *size { left / run } else { 1 };
                run
            })
            .collect();
        together.reverse();
        together
    }

    fn decodes(&self) -> bool {
        self.dataset.chunks().is_some()
    }
}

const AGAIN: &str = "copy the file again, or write it again";

/// The class of layout of virtual datasets.
const VIRTUAL: u8 = 3;

/// The reader's error as an error of this crate.
fn refused(path: &Path, place: &str, error: hdf5_reader::error::Error) -> Error {
    use hdf5_reader::error::Error as Reading;
    match error {
        Reading::Io(error) => Error::io(path, "cannot read")(error),
        Reading::Context { source, .. } => refused(path, place, *source),
        Reading::InvalidMagic => Error::invalid(path, place, "this is not an HDF5 file", AGAIN),
        Reading::UnsupportedFilter(filter) => Error::unsupported(
            path,
            place,
            format!("its chunks are compressed by a filter that is not supported ({filter})"),
            "write it again with gzip: h5repack -f GZIP=4 IN OUT",
        ),
        Reading::ResourceLimit(what) => Error::unsupported(
            path,
            place,
            what,
            "write it in smaller chunks: h5repack -l CHUNK=… IN OUT",
        ),
        Reading::UnsupportedLayoutClass(VIRTUAL) => Error::unsupported(
            path,
            place,
            "it holds a virtual dataset, whose samples are in other files",
            "write its samples into one file, in h5py by create_dataset(name, data=virtual[()])",
        ),
        other => Error::invalid(
            path,
            place,
            format!("it is damaged, or of a kind that is not supported: {other}"),
            AGAIN,
        ),
    }
}

/// Numbers as they are stored.
#[derive(Debug, Clone, Copy)]
struct Kind {
    number: Number,
    big_endian: bool,
}

impl Kind {
    fn loaded(self) -> Dtype {
        self.number.loaded().0
    }

    /// As numpy calls it.
    fn shown(self) -> Dtype {
        let name = match self.number {
            Number::F16 => return Dtype::F16,
            Number::F32 => return Dtype::F32,
            Number::F64 => return Dtype::F64,
            Number::U8 => "u1",
            Number::I8 => "i1",
            Number::U16 => "u2",
            Number::I16 => "i2",
            Number::U32 => "u4",
            Number::I32 => "i4",
            Number::I64 => "i8",
            Number::U64 => "u8",
        };
        Dtype::Other(format!("{}{name}", if self.big_endian { '>' } else { '<' }))
    }

    fn bytes(self) -> usize {
        self.number.stored() as usize
    }

    /// The numbers encoded in `bytes`.
    ///
    /// # Errors
    /// Integers that double precision cannot hold.
    fn decode(self, bytes: &[u8], to: &mut Vec<f64>) -> hdf5_reader::error::Result<()> {
        self.number.decode(bytes, self.big_endian, to);
        let is_whole = matches!(self.number, Number::I64 | Number::U64);
        match is_whole && to.iter().any(|x| x.is_nan()) {
            true => {
                let [what, _] = self.number.refusal();
                Err(hdf5_reader::error::Error::InvalidData(what.into()))
            }
            false => Ok(()),
        }
    }
}

/// The type of these numbers, if it can hold radiance.
fn kind(datatype: &Datatype) -> Option<Kind> {
    let is_big = |order: &ByteOrder| matches!(order, ByteOrder::BigEndian);
    let (number, order) = match datatype {
        Datatype::FloatingPoint { size, byte_order } => {
            let number = match size {
                2 => Number::F16,
                4 => Number::F32,
                8 => Number::F64,
                _ => return None,
            };
            (number, byte_order)
        }
        Datatype::FixedPoint {
            size,
            signed,
            byte_order,
        } => {
            let number = match (size, signed) {
                (1, false) => Number::U8,
                (1, true) => Number::I8,
                (2, false) => Number::U16,
                (2, true) => Number::I16,
                (4, false) => Number::U32,
                (4, true) => Number::I32,
                (8, false) => Number::U64,
                (8, true) => Number::I64,
                _ => return None,
            };
            (number, byte_order)
        }
        Datatype::Enum { base, .. } => return kind(base),
        _ => return None,
    };
    Some(Kind {
        number,
        big_endian: is_big(order),
    })
}

fn described(datatype: &Datatype) -> &'static str {
    match datatype {
        Datatype::FixedPoint { .. } | Datatype::FloatingPoint { .. } => "numbers of an odd size",
        Datatype::String { .. } => "texts",
        Datatype::Compound { .. } => "records",
        Datatype::VarLen { .. } => "texts or lists of any length",
        Datatype::Reference { .. } => "references",
        _ => "values",
    }
}

/// A sample of any type of numbers.
#[derive(Debug, Clone, Copy)]
struct Sample(f64);

impl H5Type for Sample {
    fn hdf5_type() -> Datatype {
        Datatype::FloatingPoint {
            size: 8,
            byte_order: ByteOrder::LittleEndian,
        }
    }

    fn from_bytes(bytes: &[u8], datatype: &Datatype) -> hdf5_reader::error::Result<Self> {
        let mut numbers = Vec::with_capacity(1);
        if let Some(kind) = kind(datatype) {
            kind.decode(bytes, &mut numbers)?;
        }
        let missing = || hdf5_reader::error::Error::InvalidData("this is not a number".into());
        numbers.first().copied().map(Sample).ok_or_else(missing)
    }

    fn element_size(datatype: &Datatype) -> usize {
        kind(datatype).map_or(1, Kind::bytes)
    }

    fn decode_vec(
        raw: &[u8],
        datatype: &Datatype,
        count: usize,
    ) -> Option<hdf5_reader::error::Result<Vec<Self>>> {
        let kind = kind(datatype)?;
        let bytes = raw.get(..count.checked_mul(kind.bytes())?)?;
        let mut numbers = Vec::with_capacity(count);
        let decoded = kind.decode(bytes, &mut numbers);
        Some(decoded.map(|()| numbers.into_iter().map(Sample).collect()))
    }
}
