//! Cubes on disk, read part by part: what is too large for memory, or is only passed on.
//!
//! Arrays of `.npy` and `.ti` files are read where they lie. Members of archives and pictures of sequences, in which
//! nothing can be found without reading all before it, are written out to a temporary file first, and so are arrays in chunks
//! of which all is wanted in another order.

use std::fs::File;
use std::io::{BufWriter, SeekFrom, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

use super::axes::Arrangement;
use super::dead::DeadBins;
use super::format::Wanted;
use super::layout::{StoredLayout, strides};
use super::negative::Negative;
#[cfg(any(feature = "hdf5", feature = "zarr"))]
use super::selection::{Open, Selection};
use super::{hdf5, npy, sequence, transient_image, zarr};
use crate::error::{Error, Result};
use crate::io::files::{ReadSeek, Reader};
use crate::io::npy::Dtype;

/// A cube on disk.
pub(super) struct Store {
    reader: Reader,
    path: PathBuf,
    layout: StoredLayout,
    /// H, W, T, C.
    pub shape: [usize; 4],
    dead: DeadBins,
    negative: Negative,
    /// A run of samples, as it is stored and as numbers.
    bytes: Vec<u8>,
    run: Vec<f64>,
}

impl Store {
    /// The cube at `path` that is `wanted` of it, by the checks of loading it.
    pub fn open(path: &Path, wanted: Wanted) -> Result<Store> {
        let (located, layout) = Store::locate(path, wanted)?;
        let store = Store::new(path, located.into_reader(), layout)?;
        let dead = DeadBins::new(path, wanted.dead_bins, store.shape[2])?;
        Ok(Store {
            dead,
            negative: wanted.negative.unwrap_or(Negative::Keep),
            ..store
        })
    }

    /// Where the samples of the cube lie.
    pub fn locate(path: &Path, wanted: Wanted) -> Result<(Located, StoredLayout)> {
        if let Some(located) = Store::locate_in_place(path, wanted)? {
            return Ok(located);
        }
        let mut spool = Spool::new(path)?;
        let to = &mut spool.writer;
        let layout = if sequence::is_sequence(path) {
            sequence::write_out(path, wanted, to)?
        } else if sequence::is_zarr(path) {
            zarr::write_out(path, wanted, to)?
        } else {
            let (mut reader, _) = crate::io::open::open_regular(path)?;
            match hdf5::FORMAT.is(&mut reader, path)? {
                true => hdf5::write_out(reader, path, wanted, to)?,
                false => npy::write_out(&mut reader, path, wanted, to)?,
            }
        };
        Ok((Located::Spooled(spool.finish()?), layout))
    }

    /// The same of files in which samples have a place.
    pub fn locate_in_place(path: &Path, wanted: Wanted) -> Result<Option<(Located, StoredLayout)>> {
        if sequence::is_sequence(path) || sequence::is_zarr(path) {
            return Ok(None);
        }
        let (mut reader, _) = crate::io::open::open_regular(path)?;
        let layout = if transient_image::FORMAT.is(&mut reader, path)? {
            transient_image::stored(&mut reader, path, wanted)?
        } else if npy::ARRAY.is(&mut reader, path)? {
            npy::stored(&mut reader, path, wanted)?
        } else {
            return Ok(None);
        };
        Ok(Some((Located::InPlace(reader), layout)))
    }

    /// What is taken of an array in chunks, and how that is opened, time and again; none where it is in no chunks.
    #[cfg(any(feature = "hdf5", feature = "zarr"))]
    pub fn windows(path: &Path, wanted: Wanted) -> Result<Option<(Selection, Open)>> {
        if sequence::is_sequence(path) {
            return Ok(None);
        }
        if sequence::is_zarr(path) {
            return zarr::windows(path, wanted).map(Some);
        }
        let (mut reader, _) = crate::io::open::open_regular(path)?;
        match hdf5::FORMAT.is(&mut reader, path)? {
            true => hdf5::windows(path, wanted).map(Some),
            false => Ok(None),
        }
    }

    fn new(path: &Path, reader: Reader, layout: StoredLayout) -> Result<Store> {
        Ok(Store {
            reader,
            path: path.to_path_buf(),
            shape: layout.shape(path)?,
            dead: DeadBins::default(),
            negative: Negative::Keep,
            layout,
            bytes: Vec::new(),
            run: Vec::new(),
        })
    }

    /// The type that samples are loaded in.
    pub fn dtype(&self) -> Dtype {
        self.layout.number.loaded().0
    }

    /// The samples of these rows, columns and bins, in the order of a cube, in place of what is in `to`.
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
        let channels = 0..self.shape[3];
        let window = [rows, columns, bins, channels];
        let ranges: Vec<Range<usize>> = (self.layout.axes.slots().into_iter())
            .map(|slot| slot.map_or(0..1, |slot| window[slot].clone()))
            .collect();
        let sizes: Vec<usize> = ranges.iter().map(ExactSizeIterator::len).collect();
        let arrangement = Arrangement::of(&sizes, &self.layout.axes, false)
            .map_err(|what| Error::invalid(&self.path, "", what, ""))?;
        to.clear();
        to.resize(sizes.iter().product(), 0.0);
        if to.is_empty() {
            return Ok(());
        }
        // Runs that lie together in the file: the last axes that are wanted whole, and a part of the one before them.
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
            self.read_run(place, run)?;
            arrangement.put(number * run, &self.run, to);
        }
        Ok(())
    }

    /// `count` samples from the `first` of the file on.
    fn read_run(&mut self, first: usize, count: usize) -> Result<()> {
        let StoredLayout {
            start,
            number,
            big_endian,
            ..
        } = self.layout;
        let size = number.stored();
        let failed = |error| Store::unreadable(&self.path, error);
        self.reader
            .seek(SeekFrom::Start(start + first as u64 * size))
            .map_err(failed)?;
        self.bytes.resize(count * size as usize, 0);
        self.reader.read_exact(&mut self.bytes).map_err(failed)?;
        self.run.clear();
        number.decode(&self.bytes, big_endian, &mut self.run);
        match self.run.iter().position(|sample| !sample.is_finite()) {
            None => self.negative.apply(&mut self.run, &self.path),
            Some(bad) => Err(Store::not_finite(&self.path, (first + bad) as u64)),
        }
    }

    /// Samples that cannot be read.
    pub fn unreadable(path: &Path, error: std::io::Error) -> Error {
        match error.kind() {
            std::io::ErrorKind::UnexpectedEof => Error::invalid(
                path,
                "samples",
                "the file has become shorter while it was read",
                "let nobody write to it meanwhile",
            ),
            _ => Error::io(path, "cannot read")(error),
        }
    }

    /// A sample that is no number.
    pub fn not_finite(path: &Path, sample: u64) -> Error {
        Error::invalid(
            path,
            format!("sample {sample} of the file"),
            "the sample is not a finite number",
            "radiance must be finite; numpy.nan_to_num replaces NaN and infinity",
        )
    }
}

/// Where samples are read.
pub(super) enum Located {
    /// In the cube's own file.
    InPlace(Reader),
    /// In a temporary one.
    Spooled(File),
}

impl Located {
    pub fn into_reader(self) -> Reader {
        match self {
            Located::InPlace(reader) => reader,
            Located::Spooled(file) => Box::new(file) as Box<dyn ReadSeek>,
        }
    }
}

/// A temporary file, which nobody else sees and which vanishes with the process.
struct Spool {
    writer: BufWriter<File>,
    path: PathBuf,
}

impl Spool {
    fn new(path: &Path) -> Result<Spool> {
        let file =
            tempfile::tempfile().map_err(Error::io(path, "cannot make a temporary file for"))?;
        Ok(Spool {
            writer: BufWriter::with_capacity(1 << 16, file),
            path: path.to_path_buf(),
        })
    }

    fn finish(mut self) -> Result<File> {
        let failed = || Error::io(&self.path, "cannot write a temporary file for");
        self.writer.flush().map_err(failed())?;
        self.writer
            .into_inner()
            .map_err(|error| failed()(error.into_error()))
    }
}
