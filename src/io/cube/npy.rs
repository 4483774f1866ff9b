//! NumPy arrays as cubes: shape (H, W, T) or (H, W, T, C), C order, half, single or double precision, of
//! either byte order; C is 1 or 3.

use std::path::Path;

use half::f16;

use super::format::{CubeFormat, CubeInfo};
use super::samples::{Cube, Samples, place_of};
use crate::Result;
use crate::io::files::ReadSeek;
use crate::io::npy::{self, Dtype, Header, Place, Stored, WRITE_AGAIN};

/// `.npy`: one array.
pub(super) const ARRAY: CubeFormat = CubeFormat {
    name: "NumPy array",
    extension: "npy",
    magic: &[b"\x93NUMPY"],
    named: false,
    inspect,
    load,
    arrays,
};

/// `.npz`: a zip archive of arrays.
pub(super) const ARCHIVE: CubeFormat = CubeFormat {
    name: "NumPy archive",
    extension: "npz",
    // A local file header, or the end record of an archive without members.
    magic: &[b"PK\x03\x04", b"PK\x05\x06"],
    named: true,
    ..ARRAY
};

fn arrays(path: &Path) -> Result<Vec<Header>> {
    npy::inspect(path, None)
}

fn inspect(mut reader: &mut dyn ReadSeek, file: &Path, array: Option<&str>) -> Result<CubeInfo> {
    npy::with_array(&mut reader, file, array, |stored| Ok(layout(stored)?.1))
}

fn load(mut reader: &mut dyn ReadSeek, file: &Path, array: Option<&str>) -> Result<Cube> {
    npy::with_array(&mut reader, file, array, |stored| {
        let (header, CubeInfo { shape, .. }) = layout(stored)?;
        let big = header.big_endian;
        let samples = match header.dtype {
            Dtype::F16 if big => Samples::F16(finite(stored, shape, f16::from_be_bytes)?),
            Dtype::F16 => Samples::F16(finite(stored, shape, f16::from_le_bytes)?),
            Dtype::F32 if big => Samples::F32(finite(stored, shape, f32::from_be_bytes)?),
            Dtype::F32 => Samples::F32(finite(stored, shape, f32::from_le_bytes)?),
            Dtype::F64 if big => Samples::F64(finite(stored, shape, f64::from_be_bytes)?),
            Dtype::F64 => Samples::F64(finite(stored, shape, f64::from_le_bytes)?),
            Dtype::Other(descr) => return Err(not_floating_point(&stored.place, &descr)),
        };
        Ok(Cube { shape, samples })
    })
}

/// The samples of a cube, all finite.
fn finite<const N: usize, T: Copy + Into<f64>>(
    stored: &mut Stored,
    shape: [usize; 4],
    sample: fn([u8; N]) -> T,
) -> Result<Vec<T>> {
    let count = shape.iter().product();
    stored.samples(count, sample, |place, first, piece| {
        let is_bad = |sample: &T| !Into::<f64>::into(*sample).is_finite();
        let Some(bad) = piece.iter().position(is_bad) else {
            return Ok(());
        };
        let [i, j, k, l] = place_of(first + bad, shape);
        Err(place.invalid(
            &format!("sample [{i}, {j}, {k}, {l}]"),
            "the sample is not a finite number",
            "radiance must be finite; numpy.nan_to_num replaces NaN and infinity",
        ))
    })
}

/// Reads the header and checks that a cube of this size follows.
fn layout(stored: &mut Stored) -> Result<(Header, CubeInfo)> {
    let (header, header_bytes) = stored.header()?;
    let place = &stored.place;
    let size = match &header.dtype {
        Dtype::F16 => 2,
        Dtype::F32 => 4,
        Dtype::F64 => 8,
        Dtype::Other(descr) => return Err(not_floating_point(place, descr)),
    };
    let shape = cube_shape(&header, place)?;
    if header.fortran_order {
        return Err(place.invalid(
            "header",
            "the array is in Fortran order (its first index varies fastest)",
            "save it in C order: numpy.save(path, numpy.ascontiguousarray(array))",
        ));
    }
    let bytes = shape
        .iter()
        .try_fold(size, |product: u64, &n| product.checked_mul(n as u64))
        .filter(|&bytes| bytes <= isize::MAX as u64);
    let bytes = bytes.ok_or_else(|| {
        let what = format!(
            "the shape {:?} has more samples than memory can address",
            header.shape
        );
        place.invalid("header", what, WRITE_AGAIN)
    })?;
    stored.check_length(header_bytes.saturating_add(bytes))?;
    let dtype = header.dtype.clone();
    Ok((
        header,
        CubeInfo {
            shape,
            dtype,
            bytes,
        },
    ))
}

fn not_floating_point(place: &Place, descr: &str) -> crate::Error {
    let descr: String = descr.chars().take(40).collect();
    let what = match descr.as_str() {
        "|O" => "the array holds Python objects, which are never unpickled".to_owned(),
        _ => format!("samples of type {descr:?} are not floating-point numbers"),
    };
    let help = "give f2, f4 or f8 samples: numpy.save(path, array.astype(numpy.float32))";
    place.unsupported("header", what, help)
}

/// The shape (H, W, T, C) of an array.
fn cube_shape(header: &Header, place: &Place) -> Result<[usize; 4]> {
    let shape = match *header.shape.as_slice() {
        [h, w, t] => [h, w, t, 1],
        [h, w, t, c] => [h, w, t, c],
        _ => {
            return Err(place.invalid(
                "header",
                format!("an array of shape {:?} is not a cube", header.shape),
                "give three or four axes: (H, W, T) or (H, W, T, C); one frame in time is \
                 array[:, :, numpy.newaxis]",
            ));
        }
    };
    if shape.contains(&0) {
        return Err(place.invalid(
            "header",
            format!("an array of shape {:?} has no samples", header.shape),
            "every axis must have a size of at least 1",
        ));
    }
    if !matches!(shape[3], 1 | 3) {
        return Err(place.invalid(
            "header",
            format!("shape {:?} means {} channels", header.shape, shape[3]),
            "axes are (H, W, T, C) with C of 1 or 3; numpy.moveaxis brings another order \
             into this one",
        ));
    }
    Ok(shape)
}
