//! Arrays on disk with axes that a cube does not have: entries along an axis are summed or one is selected, a list of points is arranged
//! in rows and columns, channels beyond red, green and blue are left out.
//!
//! They are read in windows, or completely in slabs: ranges of the slowest axis that is kept, so that memory is bounded whatever their
//! size.

use std::io::Write;
use std::ops::Range;
use std::path::Path;

use half::f16;

use super::axes::{Arrangement, Axes, Axis, NAME_AXES};
use super::channels::Channels;
use super::layout::StoredLayout;
use super::number::Number;
use super::samples::{Cube, CubeSamples, place_of};
use super::wanted::CubeInfo;
use crate::error::{Error, Result};
use crate::io::npy::Dtype;
use crate::io::temporary;

/// Samples of a slab, as numbers: 32 MiB of them.
const SLAB: usize = if cfg!(test) { 50 } else { 4 << 20 };

/// The largest number of bins, rows or samples along an axis.
const LONGEST: u64 = 1 << 40;

/// An array that is read in windows.
pub(super) trait Windows {
    /// Replaces `to` by the samples of a window, a range per axis, in C order.
    fn read(&mut self, window: &[Range<usize>], to: &mut Vec<f64>) -> Result<()>;

    /// Entries along each axis that are stored together.
    fn together(&self) -> Vec<usize>;

    /// Whether they can only be read together, so that all are decoded for one.
    fn decodes(&self) -> bool {
        true
    }
}

/// Opens the array again, so that threads need not share one.
pub(super) type Open = Box<dyn Fn() -> Result<Box<dyn Windows + Send>> + Send + Sync>;

/// The meaning in a cube of the entries along an axis of the array.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Lies {
    Row,
    Column,
    /// Pixels in a list, row after row.
    Listed {
        columns: usize,
    },
    Time,
    Channel,
    /// An axis of one entry.
    Nothing,
}

/// What to do with an axis of the array.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Role {
    /// Keep this many of its entries.
    Kept(usize),
    /// Sum over its entries.
    Summed(usize),
    /// Select one entry.
    Chosen(usize),
}

/// The part of an array that is read.
#[derive(Debug, Clone)]
pub(super) struct Selection {
    roles: Vec<Role>,
    /// The axes that are kept: which they are, and what their entries mean.
    lies: Vec<(usize, Lies)>,
    /// Sizes and axes of the result, slowest first.
    pub sizes: Vec<usize>,
    pub axes: Axes,
    pub dtype: Dtype,
}

/// How to read the axes of an array.
#[derive(Debug, Clone)]
pub(super) struct Taken<'a> {
    /// A name per axis.
    pub axes: &'a [Axis],
    /// For axes named L: the selected entry of each.
    pub choices: &'a [usize],
    /// Entries of the axis of columns are points of a grid with this many columns, row after row.
    pub columns: Option<usize>,
    /// Whether a fourth channel is left out.
    pub without_alpha: bool,
    /// What the channels are, if declared.
    pub channels: Option<&'a Channels>,
}

impl Selection {
    /// What is read of an array with these sizes and this type of samples.
    ///
    /// # Errors
    /// What is wrong, and what would be right.
    pub fn new(sizes: &[u64], dtype: Dtype, taken: &Taken) -> Result<Selection, (String, String)> {
        if sizes.len() != taken.axes.len() {
            let what = format!(
                "an array of shape {sizes:?} has {} axes, and {} are named: {}",
                sizes.len(),
                taken.axes.len(),
                Axes::of(taken.axes.to_vec())
            );
            return Err((what, NAME_AXES.into()));
        }
        if sizes.contains(&0) {
            let what = format!("an array of shape {sizes:?} has no samples");
            return Err((what, "every axis must have a size of at least 1".into()));
        }
        // From here on, products of sizes cannot overflow.
        let count = sizes.iter().try_fold(1u64, |n, size| n.checked_mul(*size));
        if count.is_none_or(|count| count > LONGEST) {
            let what = format!("the shape {sizes:?} has more samples than this program can handle");
            return Err((what, "check the file".into()));
        }
        let sizes: Vec<usize> = sizes.iter().map(|size| *size as usize).collect();
        // The role of each axis: kept, summed, or one entry of it.
        let (mut roles, mut kept, mut lies) = (Vec::new(), Vec::new(), Vec::new());
        let mut choices = taken.choices.iter();
        for (number, (&axis, &size)) in taken.axes.iter().zip(&sizes).enumerate() {
            let role = match axis {
                Axis::Sum => Role::Summed(size),
                Axis::Choice => Role::Chosen(chosen(choices.next(), size)?),
                Axis::Channel if size == 4 && taken.without_alpha && taken.channels.is_none() => {
                    Role::Kept(3)
                }
                Axis::Row | Axis::Column | Axis::Time | Axis::Channel | Axis::Single => {
                    Role::Kept(size)
                }
            };
            roles.push(role);
            if let Role::Kept(_) = role {
                lies.push((number, Lies::of(axis, taken.columns)));
            }
            match (role, axis, taken.columns) {
                (Role::Kept(size), Axis::Column, Some(columns)) => {
                    kept.extend([(Axis::Row, size / columns), (Axis::Column, columns)]);
                }
                (Role::Kept(size), axis, _) => kept.push((axis, size)),
                (Role::Summed(_) | Role::Chosen(_), ..) => {}
            }
        }
        if choices.next().is_some() {
            let what = "the name of the array selects more entries than it has axes named L";
            return Err((what.into(), NAME_AXES.into()));
        }
        let (axes, kept): (Vec<_>, Vec<_>) = kept.into_iter().unzip();
        let selection = Selection {
            roles,
            lies,
            sizes: kept,
            axes: Axes::of(axes),
            // Sums of half precision exceed its range.
            dtype: match dtype {
                Dtype::F16 if taken.axes.contains(&Axis::Sum) => Dtype::F32,
                dtype => dtype,
            },
        };
        let arrangement = Arrangement::of(&selection.sizes, &selection.axes, false)
            .map_err(|what| (what, NAME_AXES.into()))?;
        let channels = arrangement.shape[3];
        Channels::check(taken.channels, channels, &selection.axes)
            .map_err(|(what, help)| (what, format!("{help}; {NAME_AXES}")))?;
        Ok(selection)
    }

    /// The properties of the cube in memory.
    pub fn info(&self, path: &Path, assumed: bool, notes: Vec<String>) -> Result<CubeInfo> {
        let arrangement = self.arrangement(path)?;
        let count = |n: u64, size: &usize| n.saturating_mul(*size as u64);
        Ok(CubeInfo {
            shape: arrangement.shape,
            bytes: arrangement.shape.iter().fold(self.number().stored(), count),
            dtype: self.dtype.clone(),
            axes: self.axes.clone(),
            assumed,
            array: None,
            notes,
            remarks: Vec::new(),
        })
    }

    /// Loads the cube.
    pub fn load(&self, from: &mut dyn Windows, path: &Path) -> Result<Cube> {
        let arrangement = self.arrangement(path)?;
        let count: usize = self.sizes.iter().product();
        let samples = match self.dtype {
            Dtype::F16 => CubeSamples::F16(self.gather(from, path, &arrangement, f16::from_f64)?),
            Dtype::F64 => CubeSamples::F64(self.gather(from, path, &arrangement, |x| x)?),
            Dtype::F32 | Dtype::Other(_) => {
                CubeSamples::F32(self.gather(from, path, &arrangement, |x| x as f32)?)
            }
        };
        debug_assert_eq!(samples.len(), count);
        Ok(Cube {
            shape: arrangement.shape,
            samples,
        })
    }

    /// Writes the samples to `to`, little-endian.
    pub fn write_out(
        &self,
        from: &mut dyn Windows,
        path: &Path,
        to: &mut dyn Write,
    ) -> Result<StoredLayout> {
        let mut bytes = Vec::new();
        self.slabs(from, path, &mut |_, slab| {
            bytes.clear();
            match self.dtype {
                Dtype::F16 => {
                    bytes.extend(slab.iter().flat_map(|x| f16::from_f64(*x).to_le_bytes()))
                }
                Dtype::F64 => bytes.extend(slab.iter().flat_map(|x| x.to_le_bytes())),
                Dtype::F32 | Dtype::Other(_) => {
                    bytes.extend(slab.iter().flat_map(|x| (*x as f32).to_le_bytes()))
                }
            }
            to.write_all(&bytes)
                .map_err(temporary::in_directory("cannot write a file"))
        })?;
        Ok(StoredLayout {
            start: 0,
            number: self.number(),
            big_endian: false,
            sizes: self.sizes.clone(),
            axes: self.axes.clone(),
        })
    }

    /// Converts numbers to the precision of its samples.
    pub fn rounded(&self, numbers: &mut [f64]) {
        match self.dtype {
            Dtype::F16 => {
                (numbers.iter_mut()).for_each(|x| *x = f16::from_f64(*x).to_f64());
            }
            Dtype::F64 => {}
            Dtype::F32 | Dtype::Other(_) => {
                (numbers.iter_mut()).for_each(|x| *x = f64::from(*x as f32))
            }
        }
    }

    /// The number of entries read along each axis of the array, 1 for summed ones.
    pub fn kept_sizes(&self) -> Vec<usize> {
        (0..self.roles.len()).map(|axis| self.kept(axis)).collect()
    }

    /// The kept axes of the array, and the meaning of their entries.
    pub fn lies(&self) -> &[(usize, Lies)] {
        &self.lies
    }

    /// The error for a sample that is not finite, by its position in the cube.
    pub fn not_finite(path: &Path, [i, j, k, l]: [usize; 4]) -> Error {
        // Integers without an exact value are refused when they are decoded.
        let [what, help] = Number::F64.refusal();
        Error::invalid(path, format!("sample [{i}, {j}, {k}, {l}]"), what, help)
    }

    pub fn arrangement(&self, path: &Path) -> Result<Arrangement> {
        Arrangement::of(&self.sizes, &self.axes, false)
            .map_err(|what| Error::invalid(path, "", what, NAME_AXES))
    }

    /// The type in memory, as the type of samples in a temporary file.
    pub fn number(&self) -> Number {
        match self.dtype {
            Dtype::F16 => Number::F16,
            Dtype::F64 => Number::F64,
            Dtype::F32 | Dtype::Other(_) => Number::F32,
        }
    }

    /// The number of entries kept along an axis of the array.
    fn kept(&self, axis: usize) -> usize {
        match self.roles[axis] {
            Role::Kept(size) => size,
            Role::Summed(_) | Role::Chosen(_) => 1,
        }
    }

    fn gather<T: Copy + Default>(
        &self,
        from: &mut dyn Windows,
        path: &Path,
        arrangement: &Arrangement,
        stored: fn(f64) -> T,
    ) -> Result<Vec<T>> {
        let count = self.sizes.iter().product();
        let mut samples = Vec::new();
        samples.try_reserve_exact(count).map_err(|_| {
            let what = format!("there is not enough memory for {count} samples");
            Error::unsupported(path, "", what, "crop the array with `nullray convert`")
        })?;
        samples.resize(count, T::default());
        let mut piece = Vec::new();
        self.slabs(from, path, &mut |first, slab| {
            piece.clear();
            piece.extend(slab.iter().map(|x| stored(*x)));
            arrangement.put(first, &piece, &mut samples);
            Ok(())
        })?;
        Ok(samples)
    }

    /// Passes the samples to `take`, slab by slab, with the index of the first.
    fn slabs(
        &self,
        from: &mut dyn Windows,
        path: &Path,
        take: &mut dyn FnMut(usize, &[f64]) -> Result<()>,
    ) -> Result<()> {
        let is_kept = |role: &Role| matches!(role, Role::Kept(_));
        let Some(slowest) = self.roles.iter().position(is_kept) else {
            return Ok(());
        };
        let Role::Kept(length) = self.roles[slowest] else {
            return Ok(());
        };
        // As thick as the chunks, if that is not too much, so that nothing is read twice.
        let each = self.sizes.iter().product::<usize>() / length;
        let most = (SLAB / each.max(1)).clamp(1, length);
        let together = from.together().get(slowest).copied().unwrap_or(1).max(1);
        let thickness = match most / together {
            0 => most,
            whole => whole * together,
        };
        let arrangement = self.arrangement(path)?;
        let mut slab = Vec::new();
        for begin in (0..length).step_by(thickness) {
            let range = begin..(begin + thickness).min(length);
            let mut ranges: Vec<Range<usize>> = (self.lies.iter())
                .map(|(axis, _)| 0..self.kept(*axis))
                .collect();
            ranges[0] = range;
            self.window(from, &ranges, &mut slab)?;
            let first = begin * each;
            if let Some(bad) = slab.iter().position(|sample| !sample.is_finite()) {
                let place = place_of(arrangement.place(first + bad), arrangement.shape);
                return Err(Selection::not_finite(path, place));
            }
            take(first, &slab)?;
        }
        Ok(())
    }

    /// Replaces `to` by the samples of a window, a range per axis that is kept: once for every combination of summed entries.
    pub fn window(
        &self,
        from: &mut dyn Windows,
        ranges: &[Range<usize>],
        to: &mut Vec<f64>,
    ) -> Result<()> {
        let summed = |role: &Role| match role {
            Role::Summed(size) => *size,
            Role::Kept(_) | Role::Chosen(_) => 1,
        };
        let combinations: usize = self.roles.iter().map(summed).product();
        let mut part = Vec::new();
        for number in 0..combinations {
            let (mut rest, mut kept) = (number, ranges.iter());
            let window: Vec<Range<usize>> = (self.roles.iter())
                .map(|role| match *role {
                    Role::Kept(size) => kept.next().cloned().unwrap_or(0..size),
                    Role::Chosen(entry) => entry..entry + 1,
                    Role::Summed(size) => {
                        let entry = rest % size;
                        rest /= size;
                        entry..entry + 1
                    }
                })
                .collect();
            match number {
                0 => from.read(&window, to)?,
                _ => {
                    from.read(&window, &mut part)?;
                    for (sum, sample) in to.iter_mut().zip(part.iter()) {
                        *sum += sample;
                    }
                }
            }
        }
        Ok(())
    }
}

impl Lies {
    /// The meaning of a kept axis.
    fn of(axis: Axis, columns: Option<usize>) -> Lies {
        match (axis, columns) {
            (Axis::Row, _) => Lies::Row,
            (Axis::Column, Some(columns)) => Lies::Listed { columns },
            (Axis::Time, _) => Lies::Time,
            (Axis::Channel, _) => Lies::Channel,
            (Axis::Column, None) => Lies::Column,
            (Axis::Single | Axis::Sum | Axis::Choice, _) => Lies::Nothing,
        }
    }
}

/// The entry of an axis named L.
fn chosen(choice: Option<&usize>, size: usize) -> Result<usize, (String, String)> {
    let help = format!(
        "choose one of them by numbers behind the array's name, like array = \"H[{}]\"",
        size / 2
    );
    match choice {
        Some(choice) if *choice < size => Ok(*choice),
        Some(choice) => Err((
            format!("there is no entry {choice} along an axis of {size}"),
            help,
        )),
        None if size == 1 => Ok(0),
        None => Err((
            format!(
                "an axis of the array has {size} entries, like points that a laser lights one after the other"
            ),
            help,
        )),
    }
}

/// The name of an array and the entries that it selects, like `H[3, 4]`.
pub(super) fn name_and_choices(name: &str) -> (&str, Vec<usize>) {
    let split = || {
        let (name, rest) = name.strip_suffix(']')?.rsplit_once('[')?;
        let choices: Option<Vec<usize>> = rest.split(',').map(|n| n.trim().parse().ok()).collect();
        Some((name, choices?))
    };
    split().unwrap_or((name, Vec::new()))
}

#[cfg(test)]
mod tests;
