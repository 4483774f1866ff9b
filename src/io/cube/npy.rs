//! NumPy arrays as cubes: half, single or double precision, or integers (counts), of either byte order, in C or Fortran order, with axes
//! in any declared order; C is 1 or 3, or the number of declared channels.
//!
//! Samples go to their places in the cube as they are read, so that no second copy is held.

use std::io::Write;
use std::path::Path;

use half::f16;

use super::axes::{Arrangement, Axes};
use super::byte_order::ByteOrder;
use super::channels::Channels;
use super::format::{CubeFormat, Parts, Recognition, itself};
use super::layout::StoredLayout;
use super::number::{Number, exact_i64, exact_u64};
use super::recorded;
use super::samples::{Cube, CubeSamples, place_of};
use super::wanted::{CubeInfo, FileTimes, Wanted};
use crate::Result;
use crate::io::files::ReadSeek;
use crate::io::npy::{self, Dtype, Header, Place, Stored, WRITE_AGAIN};
use crate::io::temporary;

/// `.npy`: one array.
pub(super) const ARRAY: CubeFormat = CubeFormat {
    name: "NumPy array",
    key: "numpy",
    extensions: &["npy"],
    named: false,
    pictures: false,
    recognition: Recognition::ByStart(&[b"\x93NUMPY"]),
    files: itself,
    inspect: |input, wanted| {
        let path = input.path;
        inspect(&mut input.buffered()?, path, wanted)
    },
    load: |input, wanted| {
        let path = input.path;
        load(&mut input.buffered()?, path, wanted)
    },
    arrays,
    times: |_, _| Ok(None),
    wall: |_, _| Ok(None),
    parts: Parts::InPlace(stored),
};

/// `.npz`: a zip archive of arrays.
pub(super) const ARCHIVE: CubeFormat = CubeFormat {
    name: "NumPy archive",
    extensions: &["npz"],
    named: true,
    inspect: |input, wanted| {
        let path = input.path;
        let mut info = inspect(&mut input.buffered()?, path, wanted)?;
        let recorded = recorded::of_archive(path, wanted.array);
        let times = recorded.and_then(|recorded| recorded.times);
        info.notes
            .extend(times.map(|FileTimes { start, width, .. }| {
                format!("start {start} m, bin_width {width} m, by its metadata")
            }));
        Ok(info)
    },
    times: |input, array| {
        Ok(recorded::of_archive(input.path, array).and_then(|recorded| recorded.times))
    },
    // A local file header, or the end record of an archive without members.
    recognition: Recognition::ByStart(&[b"PK\x03\x04", b"PK\x05\x06"]),
    parts: Parts::WrittenOut(|input, wanted, to| {
        let path = input.path;
        write_out(&mut input.reader()?, path, wanted, to)
    }),
    ..ARRAY
};

fn arrays(path: &Path) -> Result<Vec<Header>> {
    npy::inspect(path, None)
}

fn inspect(reader: &mut dyn ReadSeek, file: &Path, wanted: Wanted) -> Result<CubeInfo> {
    npy::with_array(reader, file, wanted.array, |stored| {
        Ok(layout(stored, wanted)?.info())
    })
}

fn load(reader: &mut dyn ReadSeek, file: &Path, wanted: Wanted) -> Result<Cube> {
    npy::with_array(reader, file, wanted.array, |stored| {
        let layout = layout(stored, wanted)?;
        let samples = samples(stored, &layout)?;
        Ok(Cube {
            shape: layout.arrangement.shape,
            samples,
        })
    })
}

/// The layout of the samples in a file of one array.
fn stored(reader: &mut dyn ReadSeek, file: &Path, wanted: Wanted) -> Result<StoredLayout> {
    npy::with_array(reader, file, wanted.array, |stored| {
        Ok(layout(stored, wanted)?.stored())
    })
}

/// Writes the samples of an archived array to `to`, starting at 0.
fn write_out(
    reader: &mut dyn ReadSeek,
    file: &Path,
    wanted: Wanted,
    to: &mut dyn Write,
) -> Result<StoredLayout> {
    npy::with_array(reader, file, wanted.array, |stored| {
        let layout = layout(stored, wanted)?.stored();
        let count = layout.sizes.iter().product::<usize>() * layout.number.stored() as usize;
        stored.pieces(count, |_, _, bytes: &[[u8; 1]]| {
            let failed = temporary::in_directory("cannot write a file");
            to.write_all(bytes.as_flattened()).map_err(failed)
        })?;
        Ok(StoredLayout { start: 0, ..layout })
    })
}

/// The samples in their own precision; integers as the floating-point type that holds them.
fn samples(stored: &mut Stored, layout: &Layout) -> Result<CubeSamples> {
    Ok(match (layout.number, layout.big_endian) {
        (Number::F16, true) => CubeSamples::F16(finite(stored, layout, f16::from_be_bytes)?),
        (Number::F16, false) => CubeSamples::F16(finite(stored, layout, f16::from_le_bytes)?),
        (Number::F32, true) => CubeSamples::F32(finite(stored, layout, f32::from_be_bytes)?),
        (Number::F32, false) => CubeSamples::F32(finite(stored, layout, f32::from_le_bytes)?),
        (Number::F64, true) => CubeSamples::F64(finite(stored, layout, f64::from_be_bytes)?),
        (Number::F64, false) => CubeSamples::F64(finite(stored, layout, f64::from_le_bytes)?),
        (Number::U8, _) => CubeSamples::F32(finite(stored, layout, |[b]: [u8; 1]| b.into())?),
        (Number::I8, _) => {
            CubeSamples::F32(finite(stored, layout, |b| i8::from_le_bytes(b).into())?)
        }
        (Number::U16, true) => {
            CubeSamples::F32(finite(stored, layout, |b| u16::from_be_bytes(b).into())?)
        }
        (Number::U16, false) => {
            CubeSamples::F32(finite(stored, layout, |b| u16::from_le_bytes(b).into())?)
        }
        (Number::I16, true) => {
            CubeSamples::F32(finite(stored, layout, |b| i16::from_be_bytes(b).into())?)
        }
        (Number::I16, false) => {
            CubeSamples::F32(finite(stored, layout, |b| i16::from_le_bytes(b).into())?)
        }
        (Number::U32, true) => {
            CubeSamples::F64(finite(stored, layout, |b| u32::from_be_bytes(b).into())?)
        }
        (Number::U32, false) => {
            CubeSamples::F64(finite(stored, layout, |b| u32::from_le_bytes(b).into())?)
        }
        (Number::I32, true) => {
            CubeSamples::F64(finite(stored, layout, |b| i32::from_be_bytes(b).into())?)
        }
        (Number::I32, false) => {
            CubeSamples::F64(finite(stored, layout, |b| i32::from_le_bytes(b).into())?)
        }
        (Number::U64, true) => CubeSamples::F64(finite(stored, layout, |b| {
            exact_u64(u64::from_be_bytes(b))
        })?),
        (Number::U64, false) => CubeSamples::F64(finite(stored, layout, |b| {
            exact_u64(u64::from_le_bytes(b))
        })?),
        (Number::I64, true) => CubeSamples::F64(finite(stored, layout, |b| {
            exact_i64(i64::from_be_bytes(b))
        })?),
        (Number::I64, false) => CubeSamples::F64(finite(stored, layout, |b| {
            exact_i64(i64::from_le_bytes(b))
        })?),
    })
}

/// The samples of a cube, all finite, in its order.
fn finite<const N: usize, T: Copy + Default + Into<f64>>(
    stored: &mut Stored,
    layout: &Layout,
    sample: fn([u8; N]) -> T,
) -> Result<Vec<T>> {
    let arrangement = &layout.arrangement;
    let count = arrangement.shape.iter().product();
    let check = |place: &Place, first: usize, piece: &[T]| {
        let is_bad = |sample: &T| !Into::<f64>::into(*sample).is_finite();
        let Some(bad) = piece.iter().position(is_bad) else {
            return Ok(());
        };
        let [i, j, k, l] = place_of(arrangement.place(first + bad), arrangement.shape);
        let numbers: Vec<f64> = piece.iter().map(|sample| (*sample).into()).collect();
        let [what, help] = layout.number.refusal();
        let help = match ByteOrder::of(&numbers, N, 1).is_some() {
            true => {
                "the samples make sense with their bytes in the other order: numpy.save(path, a.view(a.dtype.newbyteorder()))"
            }
            false => help,
        };
        Err(place.invalid(&format!("sample [{i}, {j}, {k}, {l}]"), what, help))
    };
    if arrangement.is_plain() {
        return stored.samples(count, sample, check);
    }
    let mut cube = stored.room(count)?;
    cube.resize(count, T::default());
    let mut decoded = Vec::new();
    stored.pieces(count, |place, first, bytes| {
        decoded.clear();
        decoded.extend(bytes.iter().map(|b| sample(*b)));
        check(place, first, &decoded)?;
        arrangement.put(first, &decoded, &mut cube);
        Ok(())
    })?;
    Ok(cube)
}

/// The type of an array, and whether its most significant byte comes first.
fn number(header: &Header, place: &Place) -> Result<(Number, bool)> {
    let number = match &header.dtype {
        Dtype::F16 => Number::F16,
        Dtype::F32 => Number::F32,
        Dtype::F64 => Number::F64,
        Dtype::Other(descr) => match descr.trim_start_matches(['<', '>', '|', '=']) {
            "u1" => Number::U8,
            "i1" => Number::I8,
            "u2" => Number::U16,
            "i2" => Number::I16,
            "u4" => Number::U32,
            "i4" => Number::I32,
            "u8" => Number::U64,
            "i8" => Number::I64,
            _ => return Err(no_radiance(place, descr)),
        },
    };
    Ok((number, header.big_endian))
}

/// The header of a cube.
struct Layout {
    arrangement: Arrangement,
    axes: Axes,
    assumed: bool,
    number: Number,
    big_endian: bool,
    /// Bytes before the samples.
    start: u64,
    /// Sizes and axes in the order of the file, the slowest first.
    sizes: Vec<usize>,
    stored_axes: Axes,
}

impl Layout {
    fn stored(self) -> StoredLayout {
        StoredLayout {
            start: self.start,
            number: self.number,
            big_endian: self.big_endian,
            sizes: self.sizes,
            axes: self.stored_axes,
        }
    }

    fn info(self) -> CubeInfo {
        let (dtype, each) = self.number.loaded();
        let count = |n: u64, size: &usize| n.saturating_mul(*size as u64);
        CubeInfo {
            shape: self.arrangement.shape,
            bytes: self.arrangement.shape.iter().fold(each, count),
            dtype,
            axes: self.axes,
            assumed: self.assumed,
            array: None,
            notes: Vec::new(),
            remarks: Vec::new(),
        }
    }
}

/// Reads the header and checks that a cube of this size follows.
fn layout(stored: &mut Stored, wanted: Wanted) -> Result<Layout> {
    let axes = wanted.axes;
    let (header, header_bytes) = stored.header()?;
    let place = &stored.place;
    let (number, big_endian) = number(&header, place)?;
    if header.shape.contains(&0) {
        return Err(place.invalid(
            "header",
            format!("an array of shape {:?} has no samples", header.shape),
            "every axis must have a size of at least 1",
        ));
    }
    // A loaded sample takes at most eight bytes.
    let count = (header.shape.iter())
        .try_fold(1, |product: u64, &n| product.checked_mul(n as u64))
        .filter(|&count| count <= isize::MAX as u64 / 8);
    let count = count.ok_or_else(|| {
        let what = format!(
            "the shape {:?} has more samples than memory can address",
            header.shape
        );
        place.invalid("header", what, WRITE_AGAIN)
    })?;
    let named = match axes {
        Some(axes) => axes.clone(),
        None => Axes::assumed(&header.shape)
            .map_err(|(what, help)| place.invalid("header", what, help))?,
    };
    let arrangement = Arrangement::of(&header.shape, &named, header.fortran_order)
        .map_err(|what| place.invalid("header", what, AXES))?;
    let channels = arrangement.shape[3];
    let film = film_without_radiance(&arrangement, &named);
    if let Some(film) = film.filter(|_| wanted.channels.is_none()) {
        let help = "the film of mitransient that holds radiance is transient_hdr_film in a variant without `polarized`; \
                    of a polarised one, save the intensity alone: array[..., :1]";
        return Err(place.unsupported("header", film, help));
    }
    Channels::check(wanted.channels, channels, &named).map_err(|(what, help)| {
        let what = format!("shape {:?} means {what}", header.shape);
        place.invalid("header", what, format!("{help}; {AXES}"))
    })?;
    stored.check_length(header_bytes.saturating_add(count * number.stored()))?;
    let (mut sizes, mut stored_axes) = (header.shape, named.clone());
    if header.fortran_order {
        sizes.reverse();
        stored_axes = stored_axes.reversed();
    }
    Ok(Layout {
        arrangement,
        start: header_bytes,
        sizes,
        stored_axes,
        assumed: axes.is_none(),
        axes: named,
        number,
        big_endian,
    })
}

/// How mitransient's films of other quantities are recognised: by the channel axis, (H, W, T, 4) for Stokes components, (H, W, T, 12) for
/// those of three colours, and (H, W, frequencies, 2) for real and imaginary parts.
fn film_without_radiance(arrangement: &Arrangement, axes: &Axes) -> Option<String> {
    let [.., bins, channels] = arrangement.shape;
    match channels {
        _ if !axes.has_time() => None,
        2 => Some(format!(
            "2 channels: this looks like a phasor film (phasor_hdr_film), which holds real and imaginary parts of \
             frequencies ({bins} of them) in place of radiance in time"
        )),
        12 => Some(
            "12 channels: this looks like a polarised film in colours, which holds four Stokes components of each of three \
             channels in place of radiance"
                .into(),
        ),
        4 => Some(
            "4 channels: this looks like a polarised film, which holds the four Stokes components in place of radiance"
                .into(),
        ),
        _ => None,
    }
}

/// The advice about an order of axes.
const AXES: &str = "name the axes of the array in `axes`, like \"T H W\" or \"C T H W\": \
                    H rows, W columns, T time bins, C channels, 1 an axis of one entry";

fn no_radiance(place: &Place, descr: &str) -> crate::Error {
    let descr: String = descr.chars().take(40).collect();
    let what = match descr.as_str() {
        "|O" => "the array holds Python objects, which are never unpickled".to_owned(),
        "<c8" | "<c16" | ">c8" | ">c16" => {
            "the array holds complex numbers, as phasor films do, which are not radiance over time"
                .to_owned()
        }
        _ => format!("samples of type {descr:?} cannot hold radiance"),
    };
    let help = match descr.as_str() {
        "<c8" | "<c16" | ">c8" | ">c16" => {
            "give radiance in bins of time: transform the film back from frequencies to times, and save it as f4"
        }
        _ => {
            "give f2, f4 or f8 samples, or integers: numpy.save(path, array.astype(numpy.float32))"
        }
    };
    place.unsupported("header", what, help)
}
