//! From a cube on disk to another, in bounded memory: crops, merged bins, and times shifted pixel by pixel ([`shifts`](super::shifts)).

use std::io::Write;
use std::ops::Range;
use std::path::{Path, PathBuf};

use half::f16;

use super::axes::{Arrangement, Axes};
use super::channels::Channels;
#[cfg(feature = "hdf5")]
use super::hdf5;
use super::recorded::{self, Recorded};
use super::shifts::Shifts;
use super::store::Store;
use super::wanted::{FileTimes, Wanted};
#[cfg(feature = "zarr")]
use super::zarr;
use crate::error::{Error, Message, Result, Setting};
use crate::io::budget::Budget;
use crate::io::image::{self, Channel, Layers, Samples, npz};
use crate::io::npy::Dtype;
use crate::io::temporary::{Temporary, in_target};

/// The changes to a cube on its way.
#[derive(Debug, Clone)]
pub struct Changes {
    /// The rows to keep; all by default.
    pub rows: Option<Range<usize>>,
    /// The columns to keep.
    pub columns: Option<Range<usize>>,
    /// The bins to keep.
    pub bins: Option<Range<usize>>,
    /// How many neighbouring bins are merged into one; 0 or 1 leaves them.
    pub merge: usize,
    /// Whether values are densities, so that merged bins are means, not sums.
    pub density: bool,
    /// The delay of each pixel of the whole picture, in bins; NaN if unknown.
    pub shift: Option<Vec<f64>>,
    /// The name of the clock to which that delay turns times, for formats that can store it.
    pub clock: Option<String>,
    /// The type of the samples; that of the input by default.
    pub dtype: Option<Dtype>,
    /// The order of the axes of an array, H or T the slowest.
    pub axes: Option<Axes>,
    /// The time axis of the input, written to formats that can store it.
    pub times: Option<FileTimes>,
    /// The memory limit, bytes; 16 GiB by default.
    pub memory: u64,
}

impl Default for Changes {
    fn default() -> Self {
        Changes {
            rows: None,
            columns: None,
            bins: None,
            merge: 0,
            density: false,
            shift: None,
            clock: None,
            dtype: None,
            axes: None,
            times: None,
            memory: 16 << 30,
        }
    }
}

/// What was written.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Converted {
    /// H, W, T, C.
    pub shape: [usize; 4],
    /// The type of the samples.
    pub dtype: Dtype,
    /// The start of bin 0 relative to that of the input, in bins of the input.
    pub later: f64,
    /// How many bins of the input form one.
    pub merged: usize,
    /// The sum of the dropped samples of pixels with an unknown shift.
    pub dropped: f64,
    /// The part of the sum of all magnitudes that is in samples below the smallest normal number of the type, which holds few of their
    /// digits or none.
    pub faint: f64,
}

/// The most memory that the parts use together, whatever the limit, bytes; in tests so little that there are many parts.
const ROOM: usize = if cfg!(test) { 1 << 10 } else { 256 << 20 };
/// The most memory for decoded chunks of the input, bytes.
const CACHE: u64 = 256 << 20;
/// The most memory for a layer of chunks, so that each is decoded once, bytes.
const THICKEST: u64 = 4 << 30;
/// How many times as many samples may be decoded as there are: beyond this, a temporary file is faster.
const MOST_DECODED: f64 = 4.0;

/// Writes the cube at `from` to `to`: a `.npy`, `.npz` or HDF5 file, a new Zarr folder (`.zarr`), or, for a name without an extension, a
/// new folder of EXR frames. `done` gets the number of samples written and the total; it returns whether to continue.
///
/// # Errors
/// Problems of the input, as in loading it; crops that do not fit; a type that cannot hold its samples; I/O errors; [`Error::Cancelled`].
/// Nothing appears at `to` then.
pub fn convert(
    (from, wanted): (&Path, Wanted),
    to: &Path,
    changes: &Changes,
    done: &mut dyn FnMut(u64, u64) -> bool,
) -> Result<Converted> {
    let cached = (changes.memory / 8).min(CACHE);
    let store = Store::open(from, wanted, cached as usize)?;
    let mut work = Work::new(store, (from, wanted), changes)?;
    let extension = to.extension().and_then(|e| e.to_str()).unwrap_or("");
    match extension.to_ascii_lowercase().as_str() {
        "npy" | "npz" => work.array(to, Form::Numpy, done)?,
        #[cfg(feature = "hdf5")]
        "h5" | "hdf5" => work.array(to, Form::Hdf5, done)?,
        #[cfg(not(feature = "hdf5"))]
        "h5" | "hdf5" => return Err(super::hdf5::refused(to)),
        #[cfg(feature = "zarr")]
        "zarr" => work.array(to, Form::Zarr, done)?,
        #[cfg(not(feature = "zarr"))]
        "zarr" => return Err(super::zarr::refused(to)),
        "" => work.frames(to, done)?,
        _ => {
            let what = format!("cubes cannot be written as .{extension}");
            let help = "a .npy, .npz, .h5 or .hdf5 file, a .zarr folder, or a folder, a name without an extension, for EXR frames";
            return Err(Error::unsupported(to, "", what, help));
        }
    }
    Ok(Converted {
        shape: work.shape,
        later: work.later(),
        merged: work.merge,
        dropped: work.dropped,
        faint: match work.sums {
            [_, 0.0] => 0.0,
            [faint, all] => faint / all,
        },
        dtype: work.dtype,
    })
}

/// The formats of an array.
enum Form {
    Numpy,
    #[cfg(feature = "hdf5")]
    Hdf5,
    #[cfg(feature = "zarr")]
    Zarr,
}

/// Accepts a part of the output: its sizes, its samples in the order of a cube, and the type to write them in.
type Take<'t> = dyn FnMut([usize; 4], &[f64], &Dtype) -> Result<()> + 't;

struct Work<'a> {
    from: PathBuf,
    wanted: Wanted<'a>,
    store: Store,
    to_come: &'a Changes,
    /// Rows, columns and bins of the input that are kept.
    kept: [Range<usize>; 3],
    merge: usize,
    dtype: Dtype,
    shifts: Shifts<'a>,
    shape: [usize; 4],
    dropped: f64,
    /// Sums of the magnitudes of the samples that are too small for the type, and of all.
    sums: [f64; 2],
    input: Vec<f64>,
}

impl<'a> Work<'a> {
    fn new(
        store: Store,
        (from, wanted): (&Path, Wanted<'a>),
        changes: &'a Changes,
    ) -> Result<Work<'a>> {
        let [h, w, t, c] = store.shape;
        let part = |range: &Option<Range<usize>>, count: usize, name: &str| match range {
            None => Ok(0..count),
            Some(range) if range.start < range.end && range.end <= count => Ok(range.clone()),
            Some(range) => Err(Error::invalid(
                from,
                "",
                format!("it has no {name} {}:{}", range.start, range.end),
                format!(
                    "{name} are counted from 0 to {count}; the second number is the first that is left out"
                ),
            )),
        };
        let kept = [
            part(&changes.rows, h, "rows")?,
            part(&changes.columns, w, "columns")?,
            part(&changes.bins, t, "bins")?,
        ];
        let shifts = Shifts::new(from, changes.shift.as_deref(), [h, w], &kept)?;
        let merge = changes.merge.max(1);
        let bins = kept[2].len() + shifts.largest;
        // Shifted data are padded with dark bins; others are not cut or extended silently.
        if !bins.is_multiple_of(merge) && changes.shift.is_none() {
            let plural = if bins == 1 { "" } else { "s" };
            let what = format!("{bins} bin{plural} cannot be merged by {merge}");
            let help = match bins < merge {
                true => format!("merge at most {bins}").into(),
                false => {
                    let end = kept[2].end - bins % merge;
                    Message::from(format!("keep a multiple of {merge}, like "))
                        + Setting::Bins
                        + format!(" {}:{end}", kept[2].start)
                }
            };
            return Err(Error::invalid(from, "", what, help));
        }
        Ok(Work {
            from: from.to_path_buf(),
            wanted,
            shape: [kept[0].len(), kept[1].len(), bins.div_ceil(merge), c],
            dtype: changes.dtype.clone().unwrap_or_else(|| store.dtype()),
            store,
            to_come: changes,
            kept,
            merge,
            shifts,
            dropped: 0.0,
            sums: [0.0; 2],
            input: Vec::new(),
        })
    }

    /// Replaces `out` by rows `rows` and bins `bins` of the output, in the order of a cube.
    fn part(&mut self, rows: Range<usize>, bins: Range<usize>, out: &mut Vec<f64>) -> Result<()> {
        let [_, width, _, channels] = self.shape;
        let merge = self.merge;
        // In bins before merging, extended to earlier bins by the largest shift.
        let fine = bins.start * merge..bins.end * merge;
        let count = self.kept[2].len();
        let begin = fine.start.saturating_sub(self.shifts.largest).min(count);
        let end = fine.end.min(count);
        let offset = |range: Range<usize>, start: usize| range.start + start..range.end + start;
        self.store.read(
            offset(rows.clone(), self.kept[0].start),
            self.kept[1].clone(),
            offset(begin..end.max(begin), self.kept[2].start),
            &mut self.input,
        )?;
        out.clear();
        out.resize(rows.len() * width * bins.len() * channels, 0.0);
        let stride = (end.max(begin) - begin) * channels;
        if stride == 0 {
            return Ok(());
        }
        // Energies of merged bins add up; densities are averaged.
        let factor = if self.to_come.density {
            1.0 / merge as f64
        } else {
            1.0
        };
        let pixels = self
            .input
            .chunks(stride)
            .zip(out.chunks_mut(bins.len() * channels));
        for (number, (samples, out)) in pixels.enumerate() {
            let row = self.kept[0].start + rows.start + number / width;
            let column = self.kept[1].start + number % width;
            let Some((whole, part)) = self.shifts.of(row * self.store.shape[1] + column) else {
                // Only what belongs to this part of the output, so that nothing is counted twice.
                let own = samples
                    .iter()
                    .enumerate()
                    .filter(|(at, _)| fine.contains(&(begin + at / channels)));
                self.dropped += own.map(|(_, sample)| sample).sum::<f64>();
                continue;
            };
            for (at, sample) in samples.iter().enumerate() {
                let (bin, channel) = (begin + at / channels + whole, at % channels);
                for (bin, weight) in [(bin, 1.0 - part), (bin + 1, part)] {
                    if weight != 0.0 && fine.contains(&bin) {
                        let place = (bin / merge - bins.start) * channels + channel;
                        out[place] += weight * factor * sample;
                    }
                }
            }
        }
        Ok(())
    }

    /// The start of bin 0 relative to that of the input, in bins of the input.
    fn later(&self) -> f64 {
        self.kept[2].start as f64 - self.shifts.ahead as f64
    }

    fn array(
        &mut self,
        to: &Path,
        form: Form,
        done: &mut dyn FnMut(u64, u64) -> bool,
    ) -> Result<()> {
        let all = Axes::all();
        let axes = self.to_come.axes.as_ref().unwrap_or(&all);
        let slots = axes.slots();
        let help = "name H, W, T and C once each, H or T first, like \"T H W C\"; C may be left out where there is one channel";
        let refuse = |what: String| Err(Error::invalid(to, format!("axes {axes}"), what, help));
        // Parts are written as they come, so the first axis must be one along which a cube can be cut.
        let by_time = match slots.first() {
            Some(Some(0)) => false,
            Some(Some(2)) => true,
            _ => return refuse("arrays are written row by row or bin by bin".into()),
        };
        for (slot, name) in [(2, "bins"), (3, "channels")] {
            if self.shape[slot] != 1 && !slots.contains(&Some(slot)) {
                return refuse(format!("there are {} {name}", self.shape[slot]));
            }
        }
        let sizes: Vec<usize> = slots
            .iter()
            .map(|slot| slot.map_or(1, |slot| self.shape[slot]))
            .collect();
        let failed = || Error::io(to, "cannot write");
        let dtype = self.dtype.clone();
        let times = self.to_come.times.map(|times| FileTimes {
            start: times.start + self.later() * times.width,
            width: times.width * self.merge as f64,
            ..times
        });
        let recorded = recorded::of_archive(&self.from, self.wanted.array).unwrap_or_default();
        let metadata = Recorded {
            times,
            // Shifts are from one clock to another.
            clock: match &self.to_come.shift {
                Some(_) => self.to_come.clock.clone(),
                None => recorded.clock,
            },
            // Rows of backs lie behind those of fronts.
            backs: (recorded.backs).filter(|_| self.kept[0].len() == self.store.shape[0]),
            ..recorded
        }
        .metadata();
        #[cfg(feature = "zarr")]
        let zarr = match form {
            Form::Zarr => Some(ZarrFolder::new(to, &dtype, &sizes, axes, times)?),
            #[cfg(feature = "hdf5")]
            Form::Hdf5 => None,
            Form::Numpy => None,
        };
        #[cfg(feature = "zarr")]
        let multiple = zarr.as_ref().map_or(1, |zarr| zarr.writer.layer());
        #[cfg(not(feature = "zarr"))]
        let multiple = 1;
        let mut samples = |writer: &mut dyn Write| {
            let mut bytes = Vec::new();
            self.parts((by_time, multiple), done, &mut |window, part, dtype| {
                // From the order of a cube to that of the file.
                let sizes: Vec<usize> = slots
                    .iter()
                    .map(|slot| slot.map_or(1, |slot| window[slot]))
                    .collect();
                let arrangement = Arrangement::of(&sizes, axes, false)
                    .map_err(|what| Error::invalid(to, "", what, help))?;
                bytes.clear();
                arrangement.each_place(|place| {
                    let sample = part[place];
                    encode(sample, dtype, &mut bytes).ok_or_else(|| too_large(to, sample, dtype))
                })?;
                writer.write_all(&bytes).map_err(failed())
            })
        };
        match form {
            Form::Numpy => {
                let shape: Vec<String> = sizes.iter().map(usize::to_string).collect();
                let shape = format!("({})", shape.join(", "));
                npz::write_stream(to, descriptor(&dtype), &shape, &metadata, &mut samples)
            }
            #[cfg(feature = "hdf5")]
            Form::Hdf5 => image::write_atomically(to, |writer| {
                hdf5::write(writer, &dtype, &sizes, &axes.to_string(), times).map_err(failed())?;
                samples(writer)
            }),
            #[cfg(feature = "zarr")]
            Form::Zarr => {
                let Some(mut zarr) = zarr else { return Ok(()) };
                samples(&mut zarr)?;
                zarr.folder.persist(to).map_err(failed())
            }
        }
    }

    /// Writes a folder of EXR pictures, one per bin, that appears once it is complete.
    fn frames(&mut self, to: &Path, done: &mut dyn FnMut(u64, u64) -> bool) -> Result<()> {
        let failed = || Error::io(to, "cannot write");
        if self.dtype == Dtype::F64 && self.to_come.dtype.is_some() {
            let what = "EXR has no samples of double precision";
            return Err(Error::unsupported(
                to,
                "",
                what,
                "choose f16 or f32, or write a .npy file",
            ));
        }
        if let Some(axes) = &self.to_come.axes {
            let what = "EXR frames are pictures, one per bin: they have no order of axes";
            let help = "leave it out, or write a .npy file";
            return Err(Error::invalid(to, format!("axes {axes}"), what, help));
        }
        if self.dtype == Dtype::F64 {
            self.dtype = Dtype::F32;
        }
        let folder = new_folder(to)?;
        let digits = (self.shape[2] - 1).to_string().len().max(3);
        let options = image::exr::Options {
            half: self.dtype == Dtype::F16,
            ..image::exr::Options::default()
        };
        // Pictures have channels by name.
        let said = self.wanted.channels.map(Channels::in_pictures);
        let mut number = 0;
        self.parts(
            (true, 1),
            done,
            &mut |[h, w, bins, channels], part, dtype| {
                for bin in 0..bins {
                    let channel = |channel: usize| {
                        let samples =
                            (0..h * w).map(|pixel| part[(pixel * bins + bin) * channels + channel]);
                        samples
                            .map(|sample| match fits(sample, dtype) {
                                true => Ok(sample as f32),
                                false => Err(too_large(to, sample, dtype)),
                            })
                            .collect::<Result<Vec<f32>>>()
                    };
                    let names: &[&str] = match &said {
                        Some(names) => names,
                        None if channels == 3 => &["radiance.R", "radiance.G", "radiance.B"],
                        None => &["Y"],
                    };
                    let layers = names.iter().enumerate().map(|(index, name)| {
                        Ok(Channel {
                            name: (*name).into(),
                            samples: Samples::F32(channel(index)?),
                        })
                    });
                    let layers = Layers::new(
                        w as u32,
                        h as u32,
                        layers.collect::<Result<Vec<_>>>()?,
                        Vec::new(),
                    )?;
                    let name = format!("{number:0digits$}.exr");
                    image::exr::write_with(&folder.path().join(name), &layers, &options)
                        .map_err(|error| in_target(error, folder.path(), to))?;
                    number += 1;
                }
                Ok(())
            },
        )?;
        folder.persist(to).map_err(failed())
    }

    /// How many of `count` bins or rows, of `each` samples, are read, changed and written together, a multiple of `multiple`. For chunked
    /// input this is whole layers of chunks if memory allows; otherwise, if chunks would be decoded repeatedly, the input is first
    /// written to a temporary file.
    fn thickness(
        &mut self,
        by_time: bool,
        multiple: usize,
        count: usize,
        each: usize,
    ) -> Result<usize> {
        let memory = self.to_come.memory;
        let (axis, merge) = match by_time {
            true => (2, self.merge),
            false => (0, 1),
        };
        // Input and output in f64, and the bytes that are written; windows are rearranged; shifts read some more.
        let per_sample = |store: &Store| match store.decoded_together() {
            Some(_) => 48,
            None => 32,
        };
        let bytes = |store: &Store, count: usize| {
            per_sample(store) * (each * self.merge) as u64 * count as u64
        };
        let fitting = |store: &Store| {
            let room = (ROOM as u64).min(memory / 2);
            let together = (room / bytes(store, 1)).clamp(1, count as u64) as usize;
            (together / multiple * multiple).max(multiple)
        };
        let mut together = fitting(&self.store);
        let thickest = (memory / 8).min(THICKEST);
        if let Some(layers) = self.store.decoded_together() {
            let layer = layers[axis / 2];
            let thick = layer.div_ceil(merge).next_multiple_of(multiple).min(count);
            if together < thick {
                // A layer, or as much of it as memory allows.
                let most = (thickest / bytes(&self.store, 1)) as usize / multiple * multiple;
                together = together.max(most.min(thick));
            } else if together > thick {
                together = together / thick * thick;
            }
            // What parts read beyond themselves: chunks that they share, and the range of shifts.
            let span = (together * merge).min(self.kept[axis].len());
            let starts_inside = !self.kept[axis].start.is_multiple_of(layer);
            let shared = match span.is_multiple_of(layer) && !starts_inside {
                true => 0,
                false => layer - 1,
            };
            let back = if by_time { self.shifts.largest } else { 0 };
            let decoded = (span + shared + back) as f64 / span as f64;
            if together < count && decoded > MOST_DECODED {
                self.store = Store::with_places(&self.from, self.wanted)?;
                together = fitting(&self.store);
            }
        }
        Budget::new(memory).take(bytes(&self.store, together.min(count)), &self.from)?;
        Ok(together)
    }

    /// Passes the output to `take`, part by part, with the sizes of each: bin by bin or row by row, in multiples of `multiple` except for
    /// the last.
    fn parts(
        &mut self,
        (by_time, multiple): (bool, usize),
        done: &mut dyn FnMut(u64, u64) -> bool,
        take: &mut Take<'_>,
    ) -> Result<()> {
        let [h, w, t, c] = self.shape;
        let (count, each) = if by_time {
            (t, h * w * c)
        } else {
            (h, w * t * c)
        };
        let together = self.thickness(by_time, multiple, count, each)?;
        let (total, dtype) = ((h * w * t * c) as u64, self.dtype.clone());
        let mut out = Vec::new();
        for first in (0..count).step_by(together) {
            let range = first..(first + together).min(count);
            let window = match by_time {
                true => [h, w, range.len(), c],
                false => [range.len(), w, t, c],
            };
            match by_time {
                true => self.part(0..h, range.clone(), &mut out)?,
                false => self.part(range.clone(), 0..t, &mut out)?,
            }
            for sample in &out {
                self.sums[0] += if dtype.blurs(*sample) {
                    sample.abs()
                } else {
                    0.0
                };
                self.sums[1] += sample.abs();
            }
            take(window, &out, &dtype)?;
            if !done((range.end * each) as u64, total) {
                return Err(Error::Cancelled);
            }
        }
        Ok(())
    }
}

/// A temporary folder that is to become `to`, which must not exist yet.
fn new_folder(to: &Path) -> Result<Temporary> {
    if std::fs::symlink_metadata(to).is_ok() {
        let what = "a file or folder has this name already";
        return Err(Error::invalid(to, "", what, "name a new folder"));
    }
    Temporary::folder(to).map_err(Error::io(to, "cannot write"))
}

/// A Zarr array under construction, as a writer of samples: each write has whole layers of chunks.
#[cfg(feature = "zarr")]
struct ZarrFolder {
    folder: Temporary,
    writer: zarr::Writer,
}

#[cfg(feature = "zarr")]
impl ZarrFolder {
    fn new(
        to: &Path,
        dtype: &Dtype,
        sizes: &[usize],
        axes: &Axes,
        times: Option<FileTimes>,
    ) -> Result<ZarrFolder> {
        let folder = new_folder(to)?;
        let writer = zarr::Writer::new(folder.path(), dtype, sizes, axes, times);
        Ok(ZarrFolder {
            writer: writer.map_err(Error::io(to, "cannot write"))?,
            folder,
        })
    }
}

#[cfg(feature = "zarr")]
impl Write for ZarrFolder {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.writer.write(self.folder.path(), bytes)?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

fn descriptor(dtype: &Dtype) -> &'static str {
    match dtype {
        Dtype::F16 => "<f2",
        Dtype::F64 => "<f8",
        Dtype::F32 | Dtype::Other(_) => "<f4",
    }
}

/// Whether a number remains finite when converted to this type.
fn fits(sample: f64, dtype: &Dtype) -> bool {
    match dtype {
        Dtype::F16 => f16::from_f64(sample).is_finite(),
        Dtype::F64 => true,
        Dtype::F32 | Dtype::Other(_) => (sample as f32).is_finite(),
    }
}

fn encode(sample: f64, dtype: &Dtype, bytes: &mut Vec<u8>) -> Option<()> {
    match dtype {
        _ if !fits(sample, dtype) => return None,
        Dtype::F16 => bytes.extend(f16::from_f64(sample).to_le_bytes()),
        Dtype::F64 => bytes.extend(sample.to_le_bytes()),
        Dtype::F32 | Dtype::Other(_) => bytes.extend((sample as f32).to_le_bytes()),
    }
    Some(())
}

fn too_large(to: &Path, sample: f64, dtype: &Dtype) -> Error {
    let name = match dtype {
        Dtype::F16 => "f16",
        Dtype::F32 | Dtype::F64 | Dtype::Other(_) => "f32",
    };
    let what = format!("{name} cannot hold a sample of {sample:e}");
    let help = "choose a wider type; EXR has none wider than f32";
    Error::invalid(to, "", what, help)
}

#[cfg(test)]
mod tests;
