//! Cubes on disk, read in parts: for cubes that are too large for memory, or only passed on.
//!
//! Arrays of `.npy` and `.ti` files are read in place, and those of HDF5 and Zarr in windows. Archive members and pictures of sequences,
//! which have no random access, are first written to a temporary file, and so are chunked arrays that would be decoded repeatedly
//! ([`Store::decoded_together`]).

use std::fs::File;
use std::io::{BufWriter, SeekFrom, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

use super::axes::Arrangement;
use super::dead::DeadBins;
use super::format::{InPlace, Input, Parts};
use super::layout::{StoredLayout, strides};
use super::negative::Negative;
use super::number::Number;
#[cfg(any(feature = "hdf5", feature = "zarr"))]
use super::samples::place_of;
#[cfg(any(feature = "hdf5", feature = "zarr"))]
use super::selection::{Lies, Open, Selection, Windows};
use super::table;
use super::wanted::Wanted;
use crate::error::{Error, Result};
use crate::io::files::{ReadSeek, Reader};
use crate::io::npy::Dtype;
use crate::io::temporary;

/// A cube on disk.
pub(super) struct Store {
    source: Source,
    path: PathBuf,
    /// The type of the samples in the file, or in windows.
    number: Number,
    /// H, W, T, C.
    pub shape: [usize; 4],
    dead: DeadBins,
    negative: Negative,
}

/// Where samples come from.
enum Source {
    /// A file with random access.
    Places(Places),
    /// An array that is read in windows.
    #[cfg(any(feature = "hdf5", feature = "zarr"))]
    Windows(Box<dyn Windows + Send>, Selection),
}

/// A file in which each sample has a known position.
struct Places {
    reader: Reader,
    layout: StoredLayout,
    /// A run of samples, as stored and as numbers.
    bytes: Vec<u8>,
    run: Vec<f64>,
}

impl Store {
    /// Opens the part `wanted` of the cube at `path`, with the checks of loading it. Decoded chunks may take `room` bytes.
    pub fn open(path: &Path, wanted: Wanted, room: usize) -> Result<Store> {
        #[cfg(any(feature = "hdf5", feature = "zarr"))]
        if let Some((selection, open)) = Store::windows(path, wanted, room)? {
            let (shape, number) = (selection.arrangement(path)?.shape, selection.number());
            let source = Source::Windows(open()?, selection);
            return Store::new(path, wanted, source, shape, number);
        }
        let _ = room;
        Store::with_places(path, wanted)
    }

    /// The same, from a file with random access, or a temporary one if necessary.
    pub fn with_places(path: &Path, wanted: Wanted) -> Result<Store> {
        let (located, layout) = Store::locate(path, wanted)?;
        let (shape, number) = (layout.shape(path)?, layout.number);
        let source = Source::Places(Places {
            reader: located.into_reader(),
            layout,
            bytes: Vec::new(),
            run: Vec::new(),
        });
        Store::new(path, wanted, source, shape, number)
    }

    fn new(
        path: &Path,
        wanted: Wanted,
        source: Source,
        shape: [usize; 4],
        number: Number,
    ) -> Result<Store> {
        Ok(Store {
            dead: DeadBins::new(path, wanted, shape[2])?,
            negative: wanted.negative.unwrap_or(Negative::Keep),
            source,
            path: path.to_path_buf(),
            number,
            shape,
        })
    }

    /// How many rows and how many bins are decoded together, whatever part of them is needed; `None` for random access.
    pub fn decoded_together(&self) -> Option<[usize; 2]> {
        #[cfg(any(feature = "hdf5", feature = "zarr"))]
        if let Source::Windows(array, selection) = &self.source {
            return Some(self.decoded_by(&**array, selection));
        }
        None
    }

    #[cfg(any(feature = "hdf5", feature = "zarr"))]
    fn decoded_by(&self, array: &dyn Windows, selection: &Selection) -> [usize; 2] {
        let (together, decodes) = (array.together(), array.decodes());
        let mut thickness = [1, 1];
        for &(axis, lies) in selection.lies() {
            match lies {
                _ if !decodes => {}
                Lies::Row => thickness[0] = together[axis],
                Lies::Listed { columns } => thickness[0] = together[axis].div_ceil(columns),
                Lies::Time => thickness[1] = together[axis],
                Lies::Column | Lies::Channel | Lies::Nothing => {}
            }
        }
        // Rows are axis 0 of a cube, and bins axis 2.
        [0, 1].map(|n| thickness[n].clamp(1, self.shape[2 * n]))
    }

    /// Finds the positions of the cube's samples.
    pub fn locate(path: &Path, wanted: Wanted) -> Result<(Located, StoredLayout)> {
        let (input, format) = table::open(path)?;
        let write_out = match format.parts {
            Parts::InPlace(stored) => return Located::in_place(input, stored, wanted),
            #[cfg(any(feature = "hdf5", feature = "zarr"))]
            Parts::Windows(_, write_out) => write_out,
            Parts::WrittenOut(write_out) => write_out,
        };
        let mut spool = Spool::new()?;
        let layout = write_out(input, wanted, &mut spool.0)?;
        Ok((Located::Spooled(spool.finish()?), layout))
    }

    /// The same for files in which samples have known positions.
    pub fn locate_in_place(path: &Path, wanted: Wanted) -> Result<Option<(Located, StoredLayout)>> {
        let (input, format) = table::open(path)?;
        match format.parts {
            Parts::InPlace(stored) => Located::in_place(input, stored, wanted).map(Some),
            _ => Ok(None),
        }
    }

    /// What is read of a chunked array, and how to open it repeatedly, each time with `room` bytes for decoded chunks; `None` if it is
    /// not chunked.
    #[cfg(any(feature = "hdf5", feature = "zarr"))]
    pub fn windows(path: &Path, wanted: Wanted, room: usize) -> Result<Option<(Selection, Open)>> {
        match table::open(path)?.1.parts {
            Parts::Windows(windows, _) => windows(path, wanted, room).map(Some),
            Parts::InPlace(_) | Parts::WrittenOut(_) => Ok(None),
        }
    }

    /// The type of samples in memory.
    pub fn dtype(&self) -> Dtype {
        self.number.loaded().0
    }

    /// Replaces `to` by the samples of these rows, columns and bins, in the order of a cube.
    ///
    /// # Errors
    /// The file cannot be read, or a sample is not finite.
    pub fn read(
        &mut self,
        rows: Range<usize>,
        columns: Range<usize>,
        bins: Range<usize>,
        to: &mut Vec<f64>,
    ) -> Result<()> {
        // A dead bin is interpolated from the nearest live ones, which may be outside.
        let reach = self.dead.reach(bins.clone());
        self.read_stored(rows, columns, reach.clone(), to)?;
        if self.dead.is_empty() || bins.is_empty() {
            return Ok(());
        }
        let (dtype, channels) = (self.dtype(), self.shape[3]);
        let mut mended = Vec::with_capacity(to.len());
        let within = (bins.start - reach.start) * channels..(bins.end - reach.start) * channels;
        for stored in to.chunks(reach.len() * channels) {
            let begin = mended.len();
            mended.extend_from_slice(&stored[within.clone()]);
            let read = |bin: usize, end: &mut [f64]| {
                let at = (bin - reach.start) * channels;
                end.copy_from_slice(&stored[at..at + channels]);
            };
            self.dead
                .mend(bins.clone(), &dtype, &mut mended[begin..], read);
        }
        *to = mended;
        Ok(())
    }

    fn read_stored(
        &mut self,
        rows: Range<usize>,
        columns: Range<usize>,
        bins: Range<usize>,
        to: &mut Vec<f64>,
    ) -> Result<()> {
        let window = [rows, columns, bins, 0..self.shape[3]];
        if window.iter().any(Range::is_empty) {
            to.clear();
            return Ok(());
        }
        match &mut self.source {
            Source::Places(places) => places.read(window, &self.path, to),
            #[cfg(any(feature = "hdf5", feature = "zarr"))]
            Source::Windows(array, selection) => {
                read_window(&mut **array, selection, window, &self.path, to)
            }
        }?;
        self.negative.apply(to, &self.path)
    }

    /// The error for samples that cannot be read.
    pub fn unreadable(path: &Path, error: std::io::Error) -> Error {
        match error.kind() {
            std::io::ErrorKind::UnexpectedEof => Error::invalid(
                path,
                "samples",
                "the file has become shorter while it was read",
                "make sure that no program writes to it meanwhile",
            ),
            _ => Error::io(path, "cannot read")(error),
        }
    }

    /// The error for a sample of this type that is not finite.
    pub fn not_finite(path: &Path, number: Number, sample: u64) -> Error {
        let [what, help] = number.refusal();
        Error::invalid(path, format!("sample {sample} of the file"), what, help)
    }
}

impl Places {
    fn read(&mut self, window: [Range<usize>; 4], path: &Path, to: &mut Vec<f64>) -> Result<()> {
        let ranges: Vec<Range<usize>> = (self.layout.axes.slots().into_iter())
            .map(|slot| slot.map_or(0..1, |slot| window[slot].clone()))
            .collect();
        let sizes: Vec<usize> = ranges.iter().map(ExactSizeIterator::len).collect();
        let arrangement = Arrangement::of(&sizes, &self.layout.axes, false)
            .map_err(|what| Error::invalid(path, "", what, ""))?;
        to.clear();
        to.resize(sizes.iter().product(), 0.0);
        // Contiguous runs in the file: the last axes that are needed completely, and a part of the one before them.
        let whole = |axis: &usize| sizes[*axis] == self.layout.sizes[*axis];
        let last = sizes.len() - 1;
        let split = (1..=last)
            .rev()
            .take_while(whole)
            .last()
            .unwrap_or(last + 1)
            - 1;
        let run: usize = sizes[split..].iter().product();
        let strides = strides(&self.layout.sizes);
        for number in 0..to.len() / run {
            // Where the run begins: the index along each axis before it.
            let mut rest = number;
            let mut place = ranges[split].start * strides[split];
            for axis in (0..split).rev() {
                place += (ranges[axis].start + rest % sizes[axis]) * strides[axis];
                rest /= sizes[axis];
            }
            self.read_run(place, run, path)?;
            arrangement.put(number * run, &self.run, to);
        }
        Ok(())
    }

    /// Reads `count` samples from the `first` of the file on.
    fn read_run(&mut self, first: usize, count: usize, path: &Path) -> Result<()> {
        let StoredLayout {
            start,
            number,
            big_endian,
            ..
        } = self.layout;
        let size = number.stored();
        let failed = |error| Store::unreadable(path, error);
        self.reader
            .seek(SeekFrom::Start(start + first as u64 * size))
            .map_err(failed)?;
        self.bytes.resize(count * size as usize, 0);
        self.reader.read_exact(&mut self.bytes).map_err(failed)?;
        self.run.clear();
        number.decode(&self.bytes, big_endian, &mut self.run);
        match self.run.iter().position(|sample| !sample.is_finite()) {
            None => Ok(()),
            Some(bad) => Err(Store::not_finite(path, number, (first + bad) as u64)),
        }
    }
}

#[cfg(any(feature = "hdf5", feature = "zarr"))]
/// The samples of these rows, columns, bins and channels of an array, in the order of a cube.
fn read_window(
    array: &mut dyn Windows,
    selection: &Selection,
    window: [Range<usize>; 4],
    path: &Path,
    to: &mut Vec<f64>,
) -> Result<()> {
    let [rows, columns, bins, channels] = window;
    // Points in a list are read row by row, all columns of each.
    let mut listed = None;
    let ranges: Vec<Range<usize>> = (selection.lies().iter())
        .map(|(_, lies)| match *lies {
            Lies::Row => rows.clone(),
            Lies::Column => columns.clone(),
            Lies::Listed { columns } => {
                listed = Some(columns);
                rows.start * columns..rows.end * columns
            }
            Lies::Time => bins.clone(),
            Lies::Channel => channels.clone(),
            Lies::Nothing => 0..1,
        })
        .collect();
    let mut stored = Vec::new();
    selection.window(array, &ranges, &mut stored)?;
    selection.rounded(&mut stored);

    // From the order of the array to that of the cube.
    let read = match listed {
        Some(all) => [rows.clone(), 0..all, bins, channels],
        None => [rows.clone(), columns.clone(), bins, channels],
    };
    let sizes: Vec<usize> = (selection.axes.slots().into_iter())
        .map(|slot| slot.map_or(1, |slot| read[slot].len()))
        .collect();
    let arrangement = Arrangement::of(&sizes, &selection.axes, false)
        .map_err(|what| Error::invalid(path, "", what, ""))?;
    if let Some(bad) = stored.iter().position(|sample| !sample.is_finite()) {
        let place = place_of(arrangement.place(bad), arrangement.shape);
        let place = [0, 1, 2, 3].map(|n| place[n] + read[n].start);
        return Err(Selection::not_finite(path, place));
    }
    to.clear();
    to.resize(stored.len(), 0.0);
    arrangement.put(0, &stored, to);

    // Of points in a list, only the requested columns.
    if listed.is_some_and(|all| columns.len() < all) {
        let pixel = read[2].len() * read[3].len();
        let line = read[1].len() * pixel;
        let own = columns.start * pixel..columns.end * pixel;
        for row in 0..rows.len() {
            let from = row * line + own.start..row * line + own.end;
            to.copy_within(from, row * own.len());
        }
        to.truncate(rows.len() * own.len());
    }
    Ok(())
}

/// Where samples are read.
pub(super) enum Located {
    /// In the cube's own file.
    InPlace(Reader),
    /// In a temporary one.
    Spooled(File),
}

impl Located {
    fn in_place(input: Input, stored: InPlace, wanted: Wanted) -> Result<(Located, StoredLayout)> {
        let path = input.path;
        let mut reader = input.reader()?;
        let layout = stored(&mut reader, path, wanted)?;
        Ok((Located::InPlace(reader), layout))
    }

    pub fn into_reader(self) -> Reader {
        match self {
            Located::InPlace(reader) => reader,
            Located::Spooled(file) => Box::new(file) as Box<dyn ReadSeek>,
        }
    }
}

/// A temporary file, which no other process sees and which vanishes with this one.
struct Spool(BufWriter<File>);

impl Spool {
    fn new() -> Result<Spool> {
        let file = tempfile::tempfile().map_err(temporary::in_directory("cannot make a file"))?;
        Ok(Spool(BufWriter::with_capacity(1 << 16, file)))
    }

    fn finish(mut self) -> Result<File> {
        let failed = temporary::in_directory("cannot write a file");
        self.0.flush().map_err(&failed)?;
        self.0
            .into_inner()
            .map_err(|error| failed(error.into_error()))
    }
}
