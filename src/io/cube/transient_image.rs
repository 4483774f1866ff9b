//! Transient images of the University of Bonn (`.ti`): single precision, little-endian.
//!
//! Version 4: a header of 28 bytes (the magic `TI04`, the pixel mode, pixels, bins, the time of bin 0 and the width of a bin, the size of
//! the block that follows the samples), then (pixel, bin), the block, and properties as JSON. In pixel mode 10 the pixels are a grid on a
//! wall, rows of columns, and the block has its two sizes, its corners (top left, top right, bottom left, bottom right; assumed to be the
//! outer corners of the corner pixels, so that centres are half a pixel inside) and the laser's position. Versions 0 and 1 have 24 bytes
//! (bins, columns, rows, first and last time; version 0 has columns where version 1 has bins, and so on cyclically), and no block.
//!
//! The time of bin 0 is that of its centre. Times are metres of light path.

use std::io::{Read, SeekFrom};
use std::path::Path;

use glam::DVec3;

use super::axes::Axes;
use super::format::{CubeFormat, Parts, Recognition, itself};
use super::layout::StoredLayout;
use super::number::Number;
use super::samples::{Cube, CubeSamples, place_of};
use super::wall::Wall;
use super::wanted::{CubeInfo, FileTimes, Wanted};
use crate::error::{Error, Result};
use crate::io::files::ReadSeek;
use crate::io::npy::{Dtype, Header as ArrayHeader};
use crate::io::open::open_regular;

/// `.ti`.
pub(super) const FORMAT: CubeFormat = CubeFormat {
    name: "transient image",
    key: "transient_image",
    extensions: &["ti"],
    named: false,
    pictures: false,
    recognition: Recognition::ByStart(&[b"TI04", b"TI01", b"TI00"]),
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
    times: |input, _| {
        let path = input.path;
        times(&mut input.buffered()?, path)
    },
    wall: |input, wanted| {
        let path = input.path;
        wall(&mut input.buffered()?, path, wanted)
    },
    parts: Parts::InPlace(stored),
};

/// The only arrangement of pixels that is a picture.
const GRID: u32 = 10;

/// Bytes of the block of a grid: two sizes, five positions.
const BLOCK: u64 = 2 * 4 + 5 * 3 * 4;

/// Samples that are read at a time.
const PIECE: usize = 1 << 14;

const HELP: &str = "copy the file again, or write it again with LibTransientImage";

/// The header before the samples.
#[derive(Debug, Clone, Copy)]
struct Header {
    rows: usize,
    columns: usize,
    bins: usize,
    /// The time of the centre of bin 0.
    first: f64,
    width: f64,
    /// Bytes before the samples.
    start: u64,
    /// Bytes of the block after them.
    block: u64,
}

impl Header {
    fn count(&self) -> usize {
        self.rows * self.columns * self.bins
    }

    fn shape(&self) -> [usize; 4] {
        [self.rows, self.columns, self.bins, 1]
    }
}

/// The header, checked against the length of the file; leaves the reader at the first sample.
fn header(reader: &mut dyn ReadSeek, file: &Path) -> Result<Header> {
    let failed = || Error::io(file, "cannot read");
    let length = reader.seek(SeekFrom::End(0)).map_err(failed())?;
    reader.rewind().map_err(failed())?;
    // The magic gives the version, and the version determines the rest.
    let invalid = |what: String| Error::invalid(file, "header", what, HELP);
    let mut magic = [0; 4];
    let short = |error: std::io::Error| match error.kind() {
        std::io::ErrorKind::UnexpectedEof => invalid("the file ends within it".into()),
        _ => failed()(error),
    };
    reader.read_exact(&mut magic).map_err(short)?;
    let mut next = || {
        let mut bytes = [0; 4];
        reader.read_exact(&mut bytes).map_err(short).map(|()| bytes)
    };
    let header = match &magic {
        b"TI04" => {
            let mode = u32::from_le_bytes(next()?);
            if mode != GRID {
                let what = format!("pixels of mode {mode} are not a grid");
                return Err(Error::unsupported(
                    file,
                    "header",
                    what,
                    "pixels of mode 10, a grid on a wall, are read",
                ));
            }
            let pixels = u32::from_le_bytes(next()?) as usize;
            let bins = u32::from_le_bytes(next()?) as usize;
            let (first, width) = (f32::from_le_bytes(next()?), f32::from_le_bytes(next()?));
            let block = u64::from(u32::from_le_bytes(next()?));
            if block < BLOCK {
                return Err(invalid(format!(
                    "the block of a grid has {BLOCK} bytes, and this says {block}"
                )));
            }
            Header {
                rows: 1,
                columns: pixels,
                bins,
                first: first.into(),
                width: width.into(),
                start: 28,
                block,
            }
        }
        // The same three sizes, in a different order.
        b"TI00" | b"TI01" => {
            let [a, b, c] = [next()?, next()?, next()?].map(|n| u32::from_le_bytes(n) as usize);
            let (bins, columns, rows) = if magic[3] == b'0' {
                (b, c, a)
            } else {
                (a, b, c)
            };
            let (first, last) = (f32::from_le_bytes(next()?), f32::from_le_bytes(next()?));
            Header {
                rows,
                columns,
                bins,
                first: first.into(),
                width: (f64::from(last) - f64::from(first)) / bins.max(1) as f64,
                start: 24,
                block: 0,
            }
        }
        _ => {
            return Err(invalid(
                "this is not a transient image: it does not begin with TI00, TI01 or TI04".into(),
            ));
        }
    };
    // Nothing is allocated yet: sizes whose samples exceed the file are refused here, including overflow.
    let count = [header.rows, header.columns, header.bins]
        .iter()
        .try_fold(4u64, |n, k| n.checked_mul(*k as u64));
    let expected = count.and_then(|n| n.checked_add(header.start + header.block));
    match expected {
        Some(expected)
            if header.rows > 0 && header.columns > 0 && header.bins > 0 && expected <= length => {}
        _ => {
            let Header {
                rows,
                columns,
                bins,
                ..
            } = header;
            let what = format!(
                "{rows} rows, {columns} columns and {bins} bins do not fit in a file of {length} bytes: it is truncated"
            );
            return Err(invalid(what));
        }
    }
    if !(header.width > 0.0 && header.width.is_finite() && header.first.is_finite()) {
        let what = format!(
            "bins of width {} that start at {} do not form a time axis",
            header.width, header.first
        );
        return Err(invalid(what));
    }
    match header.block {
        0 => Ok(header),
        _ => grid(reader, file, header),
    }
}

/// The header with the sizes of the grid, which are stored after the samples.
fn grid(reader: &mut dyn ReadSeek, file: &Path, header: Header) -> Result<Header> {
    let failed = || Error::io(file, "cannot read");
    reader
        .seek(SeekFrom::Start(header.start + 4 * header.count() as u64))
        .map_err(failed())?;
    let mut sizes = [[0; 4]; 2];
    for size in &mut sizes {
        reader.read_exact(size).map_err(failed())?;
    }
    reader
        .seek(SeekFrom::Start(header.start))
        .map_err(failed())?;
    let [columns, rows] = sizes.map(|size| u32::from_le_bytes(size) as usize);
    if rows.checked_mul(columns) != Some(header.columns) {
        let what = format!(
            "a grid of {columns} columns and {rows} rows does not have the {} pixels of the header",
            header.columns
        );
        return Err(Error::invalid(file, "block", what, HELP));
    }
    Ok(Header {
        rows,
        columns,
        ..header
    })
}

/// The positions in the block: the corners of the grid (top left, top right, bottom left, bottom right), and that of the laser; `None`
/// without a block.
fn places(reader: &mut dyn ReadSeek, file: &Path, header: &Header) -> Result<Option<[DVec3; 5]>> {
    if header.block == 0 {
        return Ok(None);
    }
    let failed = || Error::io(file, "cannot read");
    // After the two sizes.
    let start = header.start + 4 * header.count() as u64 + 8;
    reader.seek(SeekFrom::Start(start)).map_err(failed())?;
    let mut places = [DVec3::ZERO; 5];
    for place in &mut places {
        let mut coordinates = [[0; 4]; 3];
        for coordinate in &mut coordinates {
            reader.read_exact(coordinate).map_err(failed())?;
        }
        *place = DVec3::from_array(coordinates.map(|bytes| f32::from_le_bytes(bytes).into()));
    }
    Ok(Some(places))
}

/// The centres of the pixels: the grid is evenly spaced between its corners. In images of older versions all corners are 0.
fn wall(reader: &mut dyn ReadSeek, file: &Path, wanted: Wanted) -> Result<Option<Wall>> {
    refuse_wishes(file, wanted)?;
    let header = header(reader, file)?;
    let Some([top_left, top_right, bottom_left, bottom_right, _]) = places(reader, file, &header)?
    else {
        return Ok(None);
    };
    let corners = [top_left, top_right, bottom_left, bottom_right];
    if let Some(bad) = corners.iter().find(|corner| !corner.is_finite()) {
        let what = format!(
            "a corner of the grid is at ({}, {}, {})",
            bad.x, bad.y, bad.z
        );
        return Err(Error::invalid(file, "block", what, HELP));
    }
    if (top_right - top_left).cross(bottom_left - top_left) == DVec3::ZERO {
        return Ok(None);
    }
    let (h, w) = (header.rows, header.columns);
    let centre = |n: usize, count: usize| (n as f64 + 0.5) / count as f64;
    let point = |pixel: usize| {
        let (u, v) = (centre(pixel % w, w), centre(pixel / w, h));
        top_left
            .lerp(top_right, u)
            .lerp(bottom_left.lerp(bottom_right, u), v)
    };
    Ok(Some(Wall {
        size: [h, w],
        points: (0..h * w).map(point).collect(),
        normals: Vec::new(),
        sensor: None,
    }))
}

/// The information in the block and the properties, for display.
fn notes(mut reader: &mut dyn ReadSeek, file: &Path, header: &Header) -> Result<Vec<String>> {
    /// Characters of the properties that are shown.
    const SHOWN: u64 = 400;
    let failed = || Error::io(file, "cannot read");
    let end = header.start + 4 * header.count() as u64;
    let mut notes = Vec::new();
    if let Some(places) = places(reader, file, header)? {
        let names = [
            "top left",
            "top right",
            "bottom left",
            "bottom right",
            "laser",
        ];
        for (name, place) in names.into_iter().zip(places) {
            notes.push(format!("{name} ({}, {}, {})", place.x, place.y, place.z));
        }
    }
    reader
        .seek(SeekFrom::Start(end + header.block))
        .map_err(failed())?;
    let mut properties = Vec::new();
    (&mut reader)
        .take(SHOWN)
        .read_to_end(&mut properties)
        .map_err(failed())?;
    if !properties.is_empty() {
        let text = String::from_utf8_lossy(&properties);
        notes.push(format!(
            "properties {}",
            text.split_whitespace().collect::<Vec<_>>().join(" ")
        ));
    }
    notes.push(format!(
        "bins of {} m, the first about {} m",
        header.width, header.first
    ));
    Ok(notes)
}

/// Refuses requests for axes or arrays, which the format itself defines.
fn refuse_wishes(file: &Path, wanted: Wanted) -> Result<()> {
    let refuse = |place: String, what, help| Err(Error::invalid(file, place, what, help));
    if let Some(axes) = wanted.axes.filter(|axes| **axes != Axes::of_array()) {
        let place = format!("axes {axes}");
        return refuse(
            place,
            "the axes of a transient image are H W T",
            "leave out `axes`",
        );
    }
    if wanted.channels.is_some() {
        let what = "a transient image is grey";
        return refuse("channels".into(), what, "leave out `channels`");
    }
    match wanted.array {
        Some(array) => refuse(
            format!("array {array:?}"),
            "a transient image has no arrays with names",
            "leave out the name of the array",
        ),
        None => Ok(()),
    }
}

/// The layout of the samples in the file.
fn stored(reader: &mut dyn ReadSeek, file: &Path, wanted: Wanted) -> Result<StoredLayout> {
    refuse_wishes(file, wanted)?;
    let header = header(reader, file)?;
    Ok(StoredLayout {
        start: header.start,
        number: Number::F32,
        big_endian: false,
        sizes: header.shape()[..3].to_vec(),
        axes: Axes::of_array(),
    })
}

fn inspect(reader: &mut dyn ReadSeek, file: &Path, wanted: Wanted) -> Result<CubeInfo> {
    refuse_wishes(file, wanted)?;
    let header = header(reader, file)?;
    Ok(CubeInfo {
        shape: header.shape(),
        dtype: Dtype::F32,
        bytes: 4 * header.count() as u64,
        axes: Axes::of_array(),
        assumed: false,
        array: None,
        notes: notes(reader, file, &header)?,
        remarks: Vec::new(),
    })
}

/// Reads all samples, in pieces, after their memory has been reserved.
fn load(reader: &mut dyn ReadSeek, file: &Path, wanted: Wanted) -> Result<Cube> {
    refuse_wishes(file, wanted)?;
    let header = header(reader, file)?;
    let count = header.count();
    let mut samples = Vec::new();
    samples.try_reserve_exact(count).map_err(|_| {
        let what = format!("there is not enough memory for {count} samples");
        Error::unsupported(file, "", what, "crop the image")
    })?;
    let mut piece = vec![0; 4 * PIECE];
    while samples.len() < count {
        let bytes = &mut piece[..4 * PIECE.min(count - samples.len())];
        reader
            .read_exact(bytes)
            .map_err(Error::io(file, "cannot read"))?;
        samples.extend(bytes.as_chunks().0.iter().map(|b| f32::from_le_bytes(*b)));
    }
    if let Some(bad) = samples.iter().position(|sample| !sample.is_finite()) {
        let [i, j, k, _] = place_of(bad, header.shape());
        let what = "the sample is not a finite number";
        return Err(Error::invalid(
            file,
            format!("sample [{i}, {j}, {k}]"),
            what,
            "radiance must be finite",
        ));
    }
    Ok(Cube {
        shape: header.shape(),
        samples: CubeSamples::F32(samples),
    })
}

fn times(reader: &mut dyn ReadSeek, file: &Path) -> Result<Option<FileTimes>> {
    let Header { first, width, .. } = header(reader, file)?;
    Ok(Some(FileTimes {
        // The file gives the centre of bin 0.
        start: first - 0.5 * width,
        width,
        at_sensor: false,
    }))
}

fn arrays(path: &Path) -> Result<Vec<ArrayHeader>> {
    let (mut reader, _) = open_regular(path)?;
    let header = header(&mut reader, path)?;
    Ok(vec![ArrayHeader {
        name: None,
        shape: vec![header.rows, header.columns, header.bins],
        dtype: Dtype::F32,
        fortran_order: false,
        big_endian: false,
    }])
}
