//! NumPy archives: every channel in its own precision.
//!
//! `numpy.load` gives arrays of shape (H, W), one per channel, with the channel's name: `<f4`, `<f8`, `<u4` or `<i4`, C order, row 0 at the
//! top. `radiance.R`, `.G`, `.B` become one array `radiance` of shape (H, W, 3). `metadata` is JSON text, an object of strings:
//! `json.loads(archive["metadata"].item())`. Nothing needs pickle. The same layers give the same bytes.
//!
//! Formats: NEP 1 (npy 1.0) in a deflated zip archive, zip64 if an array needs it.

use std::cell::RefCell;
use std::fs::File;
use std::io::{self, BufWriter, Cursor, Seek, SeekFrom, Write};
use std::path::Path;

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

use super::file::{Seekable, write_all, write_atomically, write_failed};
use super::layers::{Channel, Layers, Samples};
use crate::error::{Error, Result};
use crate::io::cube::{Cube, CubeSamples};
use crate::io::sealed;

const RADIANCE: [&str; 3] = ["radiance.R", "radiance.G", "radiance.B"];

type Archive<'a> = ZipWriter<Unfailing<'a>>;

/// Writes `layers` to `path`, completely or not at all.
///
/// # Errors
/// Layers that fail [`Layers::check`]; names that an archive cannot store; I/O errors.
pub fn write(path: &Path, layers: &Layers) -> Result<()> {
    write_with(path, layers, false)
}

/// The same with a checksum of the whole file in the archive's comment: [`sealed`].
///
/// # Errors
/// As for [`write()`].
pub fn write_sealed(path: &Path, layers: &Layers) -> Result<()> {
    write_with(path, layers, true)
}

fn write_with(path: &Path, layers: &Layers, is_sealed: bool) -> Result<()> {
    let arrays = checked_arrays(path, layers)?;
    write_atomically(path, |writer| {
        write_layers(writer, path, layers, &arrays, is_sealed)?;
        match is_sealed {
            true => seal(writer).map_err(write_failed(path)),
            false => Ok(()),
        }
    })
}

/// The bytes that [`write()`] would write to `path`, which is only the name in errors.
///
/// # Errors
/// As for [`write()`].
pub fn encode(path: &Path, layers: &Layers) -> Result<Vec<u8>> {
    let arrays = checked_arrays(path, layers)?;
    let mut bytes = Cursor::new(Vec::new());
    write_layers(&mut bytes, path, layers, &arrays, false)?;
    Ok(bytes.into_inner())
}

/// The arrays of an archive with `layers`, which it can store.
fn checked_arrays<'a>(path: &Path, layers: &'a Layers) -> Result<Vec<Array<'a>>> {
    layers.check()?;
    let arrays = arrays(layers);
    check_names(path, &arrays)?;
    Ok(arrays)
}

fn write_layers(
    writer: &mut dyn Seekable,
    path: &Path,
    layers: &Layers,
    arrays: &[Array],
    is_sealed: bool,
) -> Result<()> {
    let failed = RefCell::new(None);
    let mut archive = ZipWriter::new(Unfailing::new(writer, &failed));
    if is_sealed {
        let set = archive.set_comment(sealed::blank());
        set.map_err(|e| failure(path, e))?;
    }
    let written = write_archive(archive, path, layers, arrays, &failed);
    match failed.into_inner() {
        None => written,
        Some(failure) => Err(write_failed(path)(failure)),
    }
}

fn seal(writer: &mut BufWriter<File>) -> io::Result<()> {
    writer.flush()?;
    sealed::seal(writer.get_mut())
}

/// Writes all members, or those before a failure.
fn write_archive(
    mut archive: Archive,
    path: &Path,
    layers: &Layers,
    arrays: &[Array],
    failed: &RefCell<Option<io::Error>>,
) -> Result<()> {
    for array in arrays {
        write_array(&mut archive, path, layers, array)?;
        if failed.borrow().is_some() {
            return Ok(());
        }
    }
    write_metadata(&mut archive, path, &layers.metadata)?;
    archive.finish().map_err(|e| failure(path, e))?;
    Ok(())
}

/// Writes `rows` to `path` as one array of shape (rows, 3) and type `<f8`, a .npy file, completely or not at all.
///
/// # Errors
/// I/O errors.
pub(crate) fn write_vectors(path: &Path, rows: &[[f64; 3]]) -> Result<()> {
    write_atomically(path, |writer| {
        let shape = format!("({}, 3)", rows.len());
        write_all(writer, path, &npy_header("<f8", &shape))?;
        rows.iter()
            .flatten()
            .try_for_each(|value| write_all(writer, path, &value.to_le_bytes()))
    })
}

/// Writes `cube` to `path` as one array of shape (H, W, T, C), as a .npy file or as the array `radiance` of an .npz file; completely or not
/// at all.
///
/// # Errors
/// I/O errors.
pub fn write_cube(path: &Path, cube: &Cube) -> Result<()> {
    write_cube_with(path, cube, &CubeOptions::default())
}

/// Additional contents of a cube's file, and its precision.
#[derive(Debug, Clone, Copy, Default)]
pub struct CubeOptions<'a> {
    /// Whether to store single precision as half, rounded to the nearest.
    pub half: bool,
    /// More arrays, with name, shape and samples in C order; only in an .npz file.
    pub arrays: &'a [(&'a str, &'a [usize], &'a [f64])],
    /// The contents of `metadata`; only in an .npz file.
    pub metadata: &'a [(String, String)],
}

/// The same with `options`.
///
/// # Errors
/// I/O errors.
pub fn write_cube_with(path: &Path, cube: &Cube, options: &CubeOptions) -> Result<()> {
    let shape = format!("{:?}", cube.shape).replace(['[', ']'], "");
    let descriptor = match (&cube.samples, options.half) {
        (CubeSamples::F16(_), _) | (CubeSamples::F32(_), true) => "<f2",
        (CubeSamples::F32(_), false) => "<f4",
        (CubeSamples::F64(_), _) => "<f8",
    };
    let half = |x: &f32| half::f16::from_f32(*x).to_le_bytes();
    let mut samples = |writer: &mut dyn Write| {
        let mut write = |bytes: &mut dyn Iterator<Item = u8>| {
            let mut block = Vec::new();
            loop {
                block.clear();
                block.extend(bytes.take(1 << 16));
                match block.as_slice() {
                    [] => return Ok(()),
                    block => writer.write_all(block).map_err(write_failed(path))?,
                }
            }
        };
        match &cube.samples {
            CubeSamples::F16(v) => write(&mut v.iter().flat_map(|x| x.to_le_bytes())),
            CubeSamples::F32(v) if options.half => write(&mut v.iter().flat_map(half)),
            CubeSamples::F32(v) => write(&mut v.iter().flat_map(|x| x.to_le_bytes())),
            CubeSamples::F64(v) => write(&mut v.iter().flat_map(|x| x.to_le_bytes())),
        }
    };
    write_arrays(
        path,
        (descriptor, &format!("({shape})")),
        &mut samples,
        options,
    )
}

/// Writes an array whose bytes `write` provides, as the array `radiance` of a `.npz` file, with `metadata` if there are any, or as a `.npy`
/// file, completely or not at all. `shape` is in Python syntax.
///
/// # Errors
/// Those of `write`; I/O errors.
pub(crate) fn write_stream(
    path: &Path,
    descriptor: &str,
    shape: &str,
    metadata: &[(String, String)],
    write: &mut dyn FnMut(&mut dyn Write) -> Result<()>,
) -> Result<()> {
    let options = CubeOptions {
        metadata,
        ..CubeOptions::default()
    };
    write_arrays(path, (descriptor, shape), write, &options)
}

/// The same, and in an archive the additional contents of `options`.
fn write_arrays(
    path: &Path,
    (descriptor, shape): (&str, &str),
    write: &mut dyn FnMut(&mut dyn Write) -> Result<()>,
    options: &CubeOptions,
) -> Result<()> {
    let header = npy_header(descriptor, shape);
    let is_archive = path
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("npz"));
    write_atomically(path, |writer| {
        if !is_archive {
            write_all(writer, path, &header)?;
            return write(writer);
        }
        let failed = RefCell::new(None);
        let mut archive = ZipWriter::new(Unfailing::new(writer, &failed));
        // Its length is not known yet: allow any.
        start(&mut archive, path, "radiance", u64::MAX)?;
        write_all(&mut archive, path, &header)?;
        let written = write(&mut archive).and_then(|()| write_more(&mut archive, path, options));
        let finished = archive.finish().map(drop).map_err(|e| failure(path, e));
        match failed.into_inner() {
            None => written.and(finished),
            Some(failure) => Err(write_failed(path)(failure)),
        }
    })
}

/// Writes the contents of an archive other than its cube.
fn write_more(archive: &mut Archive, path: &Path, options: &CubeOptions) -> Result<()> {
    for (name, shape, values) in options.arrays {
        start(archive, path, name, values.len() as u64 * 8)?;
        let sizes: String = shape.iter().map(|size| format!("{size},")).collect();
        let header = npy_header("<f8", &format!("({sizes})"));
        write_all(archive, path, &header)?;
        let bytes: Vec<u8> = values.iter().flat_map(|x| x.to_le_bytes()).collect();
        write_all(archive, path, &bytes)?;
    }
    match options.metadata {
        [] => Ok(()),
        metadata => write_metadata(archive, path, metadata),
    }
}

/// A writer that keeps its first failure to itself and discards everything after it: an archive with a failed writer complains on standard
/// error when it is dropped.
struct Unfailing<'a> {
    writer: &'a mut dyn Seekable,
    failure: &'a RefCell<Option<io::Error>>,
    /// The position in the file, and the file's length, as they would be without a failure.
    at: u64,
    length: u64,
}

impl<'a> Unfailing<'a> {
    fn new(writer: &'a mut dyn Seekable, failure: &'a RefCell<Option<io::Error>>) -> Self {
        Unfailing {
            writer,
            failure,
            at: 0,
            length: 0,
        }
    }

    /// Does `work` unless something has failed, and records its failure.
    fn attempt<T>(&mut self, work: impl FnOnce(&mut dyn Seekable) -> io::Result<T>) {
        let mut failure = self.failure.borrow_mut();
        if failure.is_none() {
            *failure = work(self.writer).err();
        }
    }
}

impl Write for Unfailing<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.attempt(|writer| writer.write_all(bytes));
        self.at += bytes.len() as u64;
        self.length = self.length.max(self.at);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.attempt(|writer| writer.flush());
        Ok(())
    }
}

impl Seek for Unfailing<'_> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.at = match to {
            SeekFrom::Start(at) => at,
            SeekFrom::Current(by) => self.at.saturating_add_signed(by),
            SeekFrom::End(by) => self.length.saturating_add_signed(by),
        };
        let at = self.at;
        self.attempt(|writer| writer.seek(SeekFrom::Start(at)));
        Ok(at)
    }
}

/// An array of the archive: its name, and the channels whose samples are interleaved in it.
struct Array<'a> {
    name: &'a str,
    channels: Vec<&'a Channel>,
}

/// One array per channel, but a single one for radiance if its three channels have the same type.
fn arrays(layers: &Layers) -> Vec<Array<'_>> {
    let rgb: Option<Vec<_>> = RADIANCE.iter().map(|name| layers.channel(name)).collect();
    let rgb = rgb.filter(|c| c.iter().all(|x| descriptor(x) == descriptor(c[0])));
    let merged = |c: &&Channel| rgb.is_some() && RADIANCE.contains(&c.name.as_str());
    let single = layers.channels.iter().filter(|c| !merged(c));
    let single = single.map(|c| Array {
        name: &c.name,
        channels: vec![c],
    });
    let mut arrays: Vec<_> = single.collect();
    if let Some(channels) = rgb {
        let name = "radiance";
        arrays.insert(0, Array { name, channels });
    }
    arrays
}

fn check_names(path: &Path, arrays: &[Array]) -> Result<()> {
    let count = |name| arrays.iter().filter(|a| a.name == name).count();
    let unfit = arrays
        .iter()
        .find(|a| a.name.contains(['/', '\\', ':']) || a.name == "metadata" || count(a.name) > 1);
    match unfit {
        None => Ok(()),
        Some(array) => Err(Error::unsupported(
            path,
            array.name,
            "an array of an .npz cannot have this name",
            "a name without slashes and colons, other than metadata and radiance",
        )),
    }
}

fn write_array(archive: &mut Archive, path: &Path, layers: &Layers, array: &Array) -> Result<()> {
    let Some(first) = array.channels.first() else {
        return Ok(());
    };
    let (h, w, n) = (layers.height, layers.width, array.channels.len());
    let shape = match n {
        1 => format!("({h}, {w})"),
        _ => format!("({h}, {w}, {n})"),
    };
    let descriptor = descriptor(first);
    let size = first.samples.len() as u64 * n as u64 * 8;
    start(archive, path, array.name, size)?;
    write_all(archive, path, &npy_header(descriptor, &shape))?;
    write_samples(archive, path, &array.channels)
}

/// The interleaved samples of all channels, pixel by pixel, little-endian, in blocks.
fn write_samples(archive: &mut Archive, path: &Path, channels: &[&Channel]) -> Result<()> {
    const BLOCK: usize = 1 << 13;
    let pixels = channels.first().map_or(0, |c| c.samples.len());
    let mut bytes = Vec::with_capacity(BLOCK * 8 * channels.len());
    for start in (0..pixels).step_by(BLOCK) {
        bytes.clear();
        for i in start..pixels.min(start + BLOCK) {
            for channel in channels {
                match &channel.samples {
                    Samples::F32(v) => bytes.extend(v[i].to_le_bytes()),
                    Samples::F64(v) => bytes.extend(v[i].to_le_bytes()),
                    Samples::U32(v) => bytes.extend(v[i].to_le_bytes()),
                    Samples::I32(v) => bytes.extend(v[i].to_le_bytes()),
                }
            }
        }
        write_all(archive, path, &bytes)?;
    }
    Ok(())
}

/// The metadata as JSON in a NumPy text of UTF-32, shape ().
fn write_metadata(archive: &mut Archive, path: &Path, metadata: &[(String, String)]) -> Result<()> {
    let entries = metadata.iter();
    let object: serde_json::Map<_, _> = entries
        .map(|(key, value)| (key.clone(), value.clone().into()))
        .collect();
    let json = serde_json::Value::Object(object).to_string();
    let text: Vec<u8> = json
        .chars()
        .flat_map(|c| u32::from(c).to_le_bytes())
        .collect();
    start(archive, path, "metadata", text.len() as u64)?;
    let descriptor = format!("<U{}", text.len() / 4);
    write_all(archive, path, &npy_header(&descriptor, "()"))?;
    write_all(archive, path, &text)
}

/// The npy 1.0 header, padded so that the samples begin at a multiple of 64 bytes.
fn npy_header(descriptor: &str, shape: &str) -> Vec<u8> {
    let dict = format!("{{'descr': '{descriptor}', 'fortran_order': False, 'shape': {shape}, }}");
    let padding = 63 - (10 + dict.len()) % 64;
    let length = (dict.len() + padding + 1) as u16;
    let mut header = b"\x93NUMPY\x01\x00".to_vec();
    header.extend(length.to_le_bytes());
    header.extend(dict.as_bytes());
    header.extend(vec![b' '; padding]);
    header.push(b'\n');
    header
}

fn start(archive: &mut Archive, path: &Path, name: &str, bytes: u64) -> Result<()> {
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        // Fast: the mantissas of f64 samples do not compress at any level.
        .compression_level(Some(1))
        .last_modified_time(DateTime::default())
        .large_file(bytes > u64::from(u32::MAX) / 2);
    archive
        .start_file(format!("{name}.npy"), options)
        .map_err(|e| failure(path, e))
}

fn descriptor(channel: &Channel) -> &'static str {
    match channel.samples {
        Samples::F32(_) => "<f4",
        Samples::F64(_) => "<f8",
        Samples::U32(_) => "<u4",
        Samples::I32(_) => "<i4",
    }
}

fn failure(path: &Path, error: zip::result::ZipError) -> Error {
    write_failed(path)(error.into())
}
