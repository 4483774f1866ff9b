//! Zarr arrays of versions 2 and 3 in a local folder: chunks in files of their own, or in shards.
//!
//! The crate `zarrs` reads many more kinds, at the cost of a C compiler and some hundred crates; here are those that zarr-python uses for
//! numbers: bytes, transpose, blosc, gzip, zlib, lz4, zstd, crc32c, sharding. Only the chunks that a window touches are read, and of a
//! shard only its index and those. A missing chunk has the fill value, as the specification says; the number of missing ones is reported.

mod blosc;
mod codecs;
mod decompress;
mod json;
mod metadata;
mod number;
mod version_2;
mod write;

use std::collections::{BTreeMap, HashMap};
use std::io::{Read, SeekFrom, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

use self::codecs::Codec;
use self::metadata::Metadata;
use self::number::Number;
pub(super) use self::write::Writer;
use super::axes::Axes;
use super::format::{CubeFormat, Parts, Recognition, itself};
use super::layout::StoredLayout;
use super::samples::Cube;
use super::selection::{Open, Selection, Taken, Windows, name_and_choices};
use super::wanted::{CubeInfo, FileTimes, Wanted};
use super::zarr_folder::ZARR_FOLDER;
use crate::error::{Error, Result};
use crate::io::npy::{Dtype, Header};
use crate::io::open::open_regular;

/// Decoded chunks that are cached while all of an array is read, bytes.
const CACHE: usize = 256 << 20;
/// Bytes that the lists take for a decoded chunk, besides its numbers and its position, if they are at worst half full.
const KEPT: usize = 256;
/// The number of chunks whose files are checked when missing ones are counted.
const MOST_COUNTED: usize = 1 << 16;
/// The largest number of arrays of a group that are listed.
const MOST_LISTED: usize = 1000;

/// Folders of Zarr.
pub(super) const FORMAT: CubeFormat = CubeFormat {
    name: "Zarr folder",
    key: "zarr",
    extensions: &[],
    named: true,
    pictures: false,
    recognition: Recognition::ByPath(ZARR_FOLDER),
    files: itself,
    inspect: |input, wanted| inspect(input.path, wanted),
    load: |input, wanted| load(input.path, wanted),
    arrays,
    times: |input, array| times(input.path, array),
    wall: |_, _| Ok(None),
    parts: Parts::Windows(windows, |input, wanted, to| {
        write_out(input.path, wanted, to)
    }),
};

/// The properties of the cube that would be loaded.
fn inspect(path: &Path, wanted: Wanted) -> Result<CubeInfo> {
    let (metadata, selection, said) = known(path, wanted)?;
    let mut notes = vec![format!(
        "Zarr array of {} in chunks of {:?}",
        metadata.number.name(),
        metadata.chunk
    )];
    if let Said::ByFile(by) = said {
        notes.push(format!("axes {}, by its {by}", selection.axes));
    }
    if let Some(times) = times_of(&metadata) {
        notes.push(format!(
            "start {} m, bin_width {} m, by its attributes",
            times.start, times.width
        ));
    }
    let mut info = selection.info(path, said == Said::Nowhere, notes)?;
    info.remarks.extend(missing(&metadata));
    Ok(info)
}

/// Loads the cube.
fn load(path: &Path, wanted: Wanted) -> Result<Cube> {
    let (metadata, selection, _) = known(path, wanted)?;
    selection.load(&mut Array::new(metadata, CACHE), path)
}

/// Writes the requested samples to `to`.
fn write_out(path: &Path, wanted: Wanted, to: &mut dyn Write) -> Result<StoredLayout> {
    let (metadata, selection, _) = known(path, wanted)?;
    selection.write_out(&mut Array::new(metadata, CACHE), path, to)
}

/// The part of the array that is read, and how it is opened with `room` bytes for decoded chunks.
fn windows(path: &Path, wanted: Wanted, room: usize) -> Result<(Selection, Open)> {
    let (metadata, selection, _) = known(path, wanted)?;
    let open = move || Ok(Box::new(Array::new(metadata.clone(), room)) as Box<dyn Windows + Send>);
    Ok((selection, Box::new(open)))
}

/// The array's time axis, if the file gives it.
fn times(path: &Path, array: Option<&str>) -> Result<Option<FileTimes>> {
    let name = array
        .map(|name| name_and_choices(name).0)
        .filter(|name| !name.is_empty());
    // What cannot be known yet, such as which of several arrays is meant, is reported when it is loaded.
    let metadata = chosen(path, name).and_then(|folder| Metadata::read(&folder));
    Ok(metadata.ok().and_then(|metadata| times_of(&metadata)))
}

/// The arrays in the folder.
fn arrays(path: &Path) -> Result<Vec<Header>> {
    let mut headers = Vec::new();
    for (name, folder) in folders(path)? {
        let metadata = Metadata::read(&folder)?;
        headers.push(Header {
            name,
            shape: metadata.shape.iter().map(|n| *n as usize).collect(),
            dtype: match metadata.number {
                Number::F16 => Dtype::F16,
                Number::F32 => Dtype::F32,
                Number::F64 => Dtype::F64,
                other => Dtype::Other(other.name().into()),
            },
            fortran_order: false,
            big_endian: false,
        });
    }
    Ok(headers)
}

fn times_of(metadata: &Metadata) -> Option<FileTimes> {
    let (start, width) = (
        metadata.number_of("start")?,
        metadata.number_of("bin_width")?,
    );
    (start.is_finite() && width > 0.0).then_some(FileTimes {
        start,
        width,
        at_sensor: false,
    })
}

/// The arrays in `path`: itself, or those directly below a group.
fn folders(path: &Path) -> Result<Vec<(Option<String>, PathBuf)>> {
    let is_array_2 = |folder: &Path| folder.join(version_2::ARRAY).is_file();
    if is_array_2(path) {
        return Ok(vec![(None, path.to_path_buf())]);
    }
    if !path.join(version_2::GROUP).is_file() {
        let document = json::document(&path.join("zarr.json"))?;
        if document.get("node_type").and_then(|kind| kind.as_str()) != Some("group") {
            return Ok(vec![(None, path.to_path_buf())]);
        }
    }
    let failed = || Error::io(path, "cannot read the folder");
    let mut found = Vec::new();
    for entry in std::fs::read_dir(path).map_err(failed())? {
        let folder = entry.map_err(failed())?.path();
        let file = folder.join("zarr.json");
        let is_array = || {
            let document = json::document(&file).ok()?;
            Some(document.get("node_type")?.as_str()? == "array")
        };
        let is_array = || is_array_2(&folder) || (file.is_file() && is_array() == Some(true));
        if found.len() < MOST_LISTED && is_array() {
            let name = folder
                .file_name()
                .map(|name| name.to_string_lossy().into_owned());
            found.push((name, folder));
        }
    }
    found.sort();
    Ok(found)
}

/// The origin of the order of axes.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Said {
    /// The caller.
    Wanted,
    /// The file, in this attribute.
    ByFile(&'static str),
    /// An assumption.
    Nowhere,
}

/// The folder of the array of this name, or of the only one.
fn chosen(path: &Path, name: Option<&str>) -> Result<PathBuf> {
    let invalid = |what: String, help: &str| Error::invalid(path, "", what, help);
    let mut folders = folders(path)?;
    let names: Vec<_> = folders
        .iter()
        .filter_map(|(name, _)| name.clone())
        .collect();
    if let Some(name) = name {
        folders.retain(|(known, _)| known.as_deref() == Some(name));
    }
    match (folders.len(), name) {
        (1, _) => Ok(folders.remove(0).1),
        (0, Some(name)) if names.is_empty() => Err(invalid(
            format!("there is no array {name:?}: this is a single array"),
            "leave `array` out",
        )),
        (0, Some(name)) => Err(invalid(
            format!("there is no array {name:?}"),
            &format!("it holds {}", names.join(", ")),
        )),
        (0, None) => Err(invalid(
            "the group holds no arrays".into(),
            "name the folder of an array",
        )),
        (_, None) => {
            let help = format!("name one of them, like array = {:?}", names[0]);
            Err(invalid(
                format!("the group holds several arrays: {}", names.join(", ")),
                &help,
            ))
        }
        (_, Some(_)) => Err(invalid("the array is there twice".into(), "")),
    }
}

/// The array `wanted`, the part of it that is read, and the origin of its axes.
fn known(path: &Path, wanted: Wanted) -> Result<(Metadata, Selection, Said)> {
    let (name, choices) = match wanted.array {
        Some(text) => {
            let (name, choices) = name_and_choices(text);
            (Some(name).filter(|name| !name.is_empty()), choices)
        }
        None => (None, Vec::new()),
    };
    let invalid = |what: String, help: &str| Error::invalid(path, "", what, help);
    let metadata = Metadata::read(&chosen(path, name)?)?;
    let refused = |(what, help): (String, String)| invalid(what, &help);
    let (axes, said) = match wanted.axes {
        Some(axes) => (axes.clone(), Said::Wanted),
        None => match metadata.axes().map_err(refused)? {
            Some((axes, by)) => (axes, Said::ByFile(by)),
            None => {
                let sizes: Vec<usize> = metadata.shape.iter().map(|n| *n as usize).collect();
                let axes = Axes::assumed(&sizes).map_err(|(what, help)| invalid(what, help))?;
                (axes, Said::Nowhere)
            }
        },
    };
    let taken = Taken {
        axes: axes.list(),
        choices: &choices,
        columns: None,
        without_alpha: false,
        channels: wanted.channels,
    };
    let dtype = match metadata.number {
        Number::F16 => Dtype::F16,
        Number::F32 | Number::I8 | Number::I16 | Number::U8 | Number::U16 => Dtype::F32,
        Number::F64 | Number::I32 | Number::I64 | Number::U32 | Number::U64 => Dtype::F64,
    };
    let selection = Selection::new(&metadata.shape, dtype, &taken)
        .map_err(|(what, help)| invalid(what, &help))?;
    Ok((metadata, selection, said))
}

/// The number of chunks (or shards) without a file, if any.
fn missing(metadata: &Metadata) -> Option<String> {
    let chunks = metadata.chunks();
    let count = chunks.iter().try_fold(1usize, |n, k| n.checked_mul(*k))?;
    if count > MOST_COUNTED {
        return None;
    }
    let place = |n: usize| {
        let mut rest = n;
        let mut place: Vec<usize> = chunks
            .iter()
            .rev()
            .map(|count| {
                let at = rest % count;
                rest /= count;
                at
            })
            .collect();
        place.reverse();
        place
    };
    let missing = (0..count)
        .filter(|n| !metadata.chunk_file(&place(*n)).is_file())
        .count();
    let part = match sharding(&metadata.codecs) {
        Some(_) => "shards",
        None => "chunks",
    };
    (missing > 0).then(|| {
        format!(
            "{missing} of {count} {part} are missing: they are read as the fill value, {}",
            metadata.fill
        )
    })
}

/// The storage of chunks in shards.
struct Shards<'a> {
    /// The size of a chunk in a shard.
    inner: &'a Vec<usize>,
    /// The codecs of the chunks.
    codecs: &'a [Codec],
    /// Whether the index ends in a checksum.
    has_checksum: bool,
    /// Whether the index is at the start of a shard rather than at its end.
    at_start: bool,
}

/// The shards of an array with these codecs; `None` if its chunks have their own files.
fn sharding(codecs: &[Codec]) -> Option<Shards<'_>> {
    codecs.iter().find_map(|codec| match codec {
        Codec::Sharding {
            inner,
            codecs,
            has_checksum,
            at_start,
        } => Some(Shards {
            inner,
            codecs,
            has_checksum: *has_checksum,
            at_start: *at_start,
        }),
        Codec::Transpose { .. }
        | Codec::Bytes { .. }
        | Codec::Blosc
        | Codec::Gzip
        | Codec::Lz4
        | Codec::Zlib
        | Codec::Zstd
        | Codec::Crc32c => None,
    })
}

/// An array being read.
struct Array {
    metadata: Metadata,
    /// The size of the unit of decoding: chunks, or those in shards.
    unit: Vec<usize>,
    /// By position in units: the time of last use, and the numbers; `None` if the chunk is missing.
    kept: HashMap<Vec<usize>, (u64, Option<Vec<f64>>)>,
    /// Their positions by the time of last use.
    used: BTreeMap<u64, Vec<usize>>,
    /// The number of uses of units so far.
    clock: u64,
    /// The memory limit for kept units, bytes, not counting the last one.
    room: usize,
    /// The index of the most recently used shard.
    index: Option<(Vec<usize>, codecs::Index)>,
}

impl Array {
    fn new(metadata: Metadata, room: usize) -> Array {
        let shards = sharding(&metadata.codecs);
        Array {
            unit: shards
                .map_or(&metadata.chunk, |shards| shards.inner)
                .clone(),
            metadata,
            kept: HashMap::new(),
            used: BTreeMap::new(),
            clock: 0,
            room,
            index: None,
        }
    }

    /// Makes the unit at `place` the most recently used one, reading it if necessary.
    fn fetch(&mut self, place: &[usize]) -> Result<()> {
        self.clock += 1;
        if let Some((used, _)) = self.kept.get_mut(place) {
            if let Some(place) = self.used.remove(used) {
                self.used.insert(self.clock, place);
            }
            *used = self.clock;
            return Ok(());
        }
        let numbers = self.read_unit(place)?;
        let each = self.kept_bytes();
        // There is always room for one, whatever its size.
        while self.kept.len() * each >= self.room.max(each) {
            if let Some((_, place)) = self.used.pop_first() {
                self.kept.remove(&place);
            }
        }
        self.used.insert(self.clock, place.to_vec());
        self.kept.insert(place.to_vec(), (self.clock, numbers));
        Ok(())
    }

    /// Bytes of a kept unit: its numbers, and its position in two lists.
    fn kept_bytes(&self) -> usize {
        8 * self.unit.iter().product::<usize>() + 16 * self.unit.len() + KEPT
    }

    /// The numbers of a unit; `None` if it is missing.
    fn read_unit(&mut self, place: &[usize]) -> Result<Option<Vec<f64>>> {
        let Metadata {
            codecs,
            chunk,
            number,
            ..
        } = &self.metadata;
        // A unit is a chunk, or a chunk within a shard; `outer` is the position of its file.
        let per_shard: Vec<usize> = chunk
            .iter()
            .zip(&self.unit)
            .map(|(shard, unit)| shard / unit)
            .collect();
        let outer: Vec<usize> = place
            .iter()
            .zip(&per_shard)
            .map(|(at, count)| at / count)
            .collect();
        let file = self.metadata.chunk_file(&outer);
        let broken =
            |what| Error::invalid(&file, "", what, "copy the array again, or write it again");
        if std::fs::symlink_metadata(&file)
            .is_err_and(|error| error.kind() == std::io::ErrorKind::NotFound)
        {
            return Ok(None);
        }
        let (mut reader, length) = open_regular(&file)?;
        let failed = || Error::io(&file, "cannot read");
        // Compression may make a chunk slightly longer: a much larger file is not read.
        let most = (chunk.iter().product::<usize>() * number.bytes()) as u64 * 2 + (1 << 20);
        let (bytes, codecs) = match sharding(codecs) {
            None => {
                if length > most {
                    return Err(broken(format!(
                        "it has {length} bytes, more than a chunk can have"
                    )));
                }
                let mut bytes = Vec::new();
                reader
                    .take(most)
                    .read_to_end(&mut bytes)
                    .map_err(failed())?;
                (bytes, codecs.as_slice())
            }
            Some(Shards {
                codecs,
                has_checksum,
                at_start,
                ..
            }) => {
                if self.index.as_ref().is_none_or(|(kept, _)| *kept != outer) {
                    let count = per_shard.iter().product();
                    let index = codecs::index(&mut reader, count, has_checksum, at_start)
                        .map_err(broken)?;
                    self.index = Some((outer.clone(), index));
                }
                // Within a shard, chunks are numbered in C order.
                let inside = place
                    .iter()
                    .zip(&per_shard)
                    .fold(0, |n, (at, count)| n * count + at % count);
                let entry = self
                    .index
                    .as_ref()
                    .and_then(|(_, index)| index.get(inside).copied().flatten());
                let Some((offset, bytes)) = entry else {
                    return Ok(None);
                };
                if bytes > most {
                    return Err(broken(format!(
                        "a chunk of {bytes} bytes is longer than it can be"
                    )));
                }
                reader.seek(SeekFrom::Start(offset)).map_err(failed())?;
                let mut chunk = vec![0; bytes as usize];
                reader.read_exact(&mut chunk).map_err(failed())?;
                (chunk, codecs)
            }
        };
        codecs::decode(bytes, codecs, &self.unit, *number)
            .map(Some)
            .map_err(broken)
    }
}

impl Windows for Array {
    fn read(&mut self, window: &[Range<usize>], to: &mut Vec<f64>) -> Result<()> {
        to.clear();
        to.resize(
            window.iter().map(ExactSizeIterator::len).product(),
            self.metadata.fill,
        );
        if to.is_empty() {
            return Ok(());
        }
        let unit = self.unit.clone();
        let first: Vec<usize> = window
            .iter()
            .zip(&unit)
            .map(|(range, unit)| range.start / unit)
            .collect();
        let end: Vec<usize> = window
            .iter()
            .zip(&unit)
            .map(|(range, unit)| (range.end - 1) / unit + 1)
            .collect();
        let mut place = first.clone();
        loop {
            self.fetch(&place)?;
            if let Some((_, Some(numbers))) = self.kept.get(&place) {
                copy(numbers, &place, &unit, window, to);
            }
            // Moves to the next unit: increments the fastest axis that is not at its end.
            let Some(axis) = (0..place.len())
                .rev()
                .find(|axis| place[*axis] + 1 < end[*axis])
            else {
                return Ok(());
            };
            place[axis] += 1;
            place[axis + 1..].copy_from_slice(&first[axis + 1..]);
        }
    }

    fn together(&self) -> Vec<usize> {
        self.unit.clone()
    }
}

/// Copies the intersection of the unit at `place` and the window, in runs along the last axis.
fn copy(numbers: &[f64], place: &[usize], unit: &[usize], window: &[Range<usize>], to: &mut [f64]) {
    let shared: Vec<Range<usize>> = (0..unit.len())
        .map(|axis| {
            let start = place[axis] * unit[axis];
            window[axis].start.max(start)..window[axis].end.min(start + unit[axis])
        })
        .collect();
    let Some(last) = unit.len().checked_sub(1) else {
        to[0] = numbers[0];
        return;
    };
    let run = shared[last].len();
    let count: usize = shared[..last].iter().map(ExactSizeIterator::len).product();
    for n in 0..count {
        let (mut rest, mut from, mut at) = (n, 0, 0);
        let (mut from_stride, mut at_stride) = (unit[last], window[last].len());
        for axis in (0..last).rev() {
            let index = shared[axis].start + rest % shared[axis].len();
            rest /= shared[axis].len();
            from += (index - place[axis] * unit[axis]) * from_stride;
            at += (index - window[axis].start) * at_stride;
            from_stride *= unit[axis];
            at_stride *= window[axis].len();
        }
        from += shared[last].start - place[last] * unit[last];
        at += shared[last].start - window[last].start;
        to[at..at + run].copy_from_slice(&numbers[from..from + run]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// For chunks of one sample, positions take more memory than the sample: of 3000 chunks as many are kept as fit, and the most recently
    /// used ones stay.
    #[test]
    fn tiny_chunks_stay_within_the_room() {
        let folder = tempfile::tempdir().unwrap();
        let described = r#"{"zarr_format": 2, "shape": [2, 3, 500], "chunks": [1, 1, 1], "dtype": "<f4",
            "compressor": null, "filters": null, "fill_value": 0, "order": "C"}"#;
        std::fs::write(folder.path().join(".zarray"), described).unwrap();
        let mut array = Array::new(Metadata::read(folder.path()).unwrap(), 10_000);
        let mut to = Vec::new();
        array.read(&[0..2, 0..3, 0..500], &mut to).unwrap();
        assert_eq!((array.kept_bytes(), array.kept.len()), (312, 33));
        assert_eq!(array.used.len(), 33);
        for place in [[1, 2, 467], [1, 2, 499]] {
            assert!(array.kept.contains_key(&place[..]), "{place:?}");
        }
        array.fetch(&[1, 2, 467]).unwrap();
        array.fetch(&[0, 0, 0]).unwrap();
        assert!(array.kept.contains_key(&[1, 2, 467][..]));
        assert!(!array.kept.contains_key(&[1, 2, 468][..]));
        assert_eq!(array.kept.len(), 33);
    }
}
