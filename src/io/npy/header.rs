//! The header of one array.

use std::io::Read;

use super::literal::{Literal, dictionary};
use super::{CubeInfo, Place, WRITE_AGAIN};
use crate::Result;

const MAGIC: &[u8; 6] = b"\x93NUMPY";

/// Headers that numpy writes for floats are some hundred bytes long; structured types need more.
const LONGEST_HEADER: u32 = 1 << 16;

/// What an array holds.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Dtype {
    /// IEEE half precision, `f2`.
    F16,
    /// Single precision, `f4`.
    F32,
    /// Double precision, `f8`.
    F64,
    /// Something else, as the file says it (`<i4`, `|O`, …); it cannot be loaded as a cube.
    Other(String),
}

/// The header of an array.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Header {
    /// The array's name in a `.npz` archive; none in a `.npy` file.
    pub name: Option<String>,
    /// Sizes, the slowest first unless `fortran_order`.
    pub shape: Vec<usize>,
    /// The type of its samples.
    pub dtype: Dtype,
    /// Whether the first index varies fastest in the file.
    pub fortran_order: bool,
    /// Whether samples lie with their most significant byte first.
    pub big_endian: bool,
}

impl Dtype {
    /// Bytes of a sample, where the type can be loaded.
    fn size(&self) -> Option<u64> {
        match self {
            Dtype::F16 => Some(2),
            Dtype::F32 => Some(4),
            Dtype::F64 => Some(8),
            Dtype::Other(_) => None,
        }
    }
}

/// Reads magic, version and header; gives the header and how many bytes it took.
pub(super) fn read(reader: &mut dyn Read, place: &Place) -> Result<(Header, u64)> {
    let mut start = [0; 8];
    fill(reader, &mut start, place)?;
    let [magic @ .., major, minor] = start;
    if &magic != MAGIC {
        return Err(place.invalid(
            "header",
            "this is not a .npy array: it does not start with \\x93NUMPY",
            "write it with numpy.save or numpy.savez",
        ));
    }
    let (length, prefix) = match major {
        1 => (u32::from(u16::from_le_bytes(array(reader, place)?)), 10),
        2 | 3 => (u32::from_le_bytes(array(reader, place)?), 12),
        _ => {
            return Err(place.unsupported(
                "header",
                format!("version {major}.{minor} of the .npy format is not known"),
                "versions 1.0, 2.0 and 3.0 are read; write it again with numpy.save",
            ));
        }
    };
    let header = parse(&text(reader, length, place)?, place)?;
    Ok((header, prefix + u64::from(length)))
}

fn fill(reader: &mut dyn Read, bytes: &mut [u8], place: &Place) -> Result<()> {
    reader
        .read_exact(bytes)
        .map_err(|error| place.read_error("header", error))
}

fn array<const N: usize>(reader: &mut dyn Read, place: &Place) -> Result<[u8; N]> {
    let mut bytes = [0; N];
    fill(reader, &mut bytes, place)?;
    Ok(bytes)
}

fn text(reader: &mut dyn Read, length: u32, place: &Place) -> Result<String> {
    if length > LONGEST_HEADER {
        return Err(place.invalid(
            "header",
            format!("it claims to be {length} bytes long"),
            format!("a header of at most {LONGEST_HEADER} bytes; {WRITE_AGAIN}"),
        ));
    }
    let mut bytes = vec![0; length as usize];
    fill(reader, &mut bytes, place)?;
    // Versions 1 and 2 say Latin-1, but what is needed of a header is ASCII in all versions.
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

fn parse(text: &str, place: &Place) -> Result<Header> {
    let broken = |what: String| place.invalid("header", what, WRITE_AGAIN);
    let mut header = Header {
        name: place.array.clone(),
        shape: Vec::new(),
        dtype: Dtype::Other(String::new()),
        fortran_order: false,
        big_endian: false,
    };
    let mut found = [false; 3];
    for (key, value) in dictionary(text).map_err(broken)? {
        let slot = match (key.as_str(), value) {
            ("descr", Literal::Text(descr)) => {
                (header.dtype, header.big_endian) = dtype(&descr);
                0
            }
            ("descr", Literal::List(descr)) => {
                header.dtype = Dtype::Other(descr);
                0
            }
            ("fortran_order", Literal::Bool(order)) => {
                header.fortran_order = order;
                1
            }
            ("shape", Literal::Tuple(shape)) => {
                header.shape = shape;
                2
            }
            (key, _) => return Err(broken(format!("the entry {key:?} is not of the format"))),
        };
        if std::mem::replace(&mut found[slot], true) {
            return Err(broken(format!("the entry {key:?} stands twice")));
        }
    }
    match found {
        [true, true, true] => Ok(header),
        _ => Err(broken("descr, fortran_order or shape is missing".into())),
    }
}

/// The type that `descr` names, and whether its byte order is big-endian.
fn dtype(descr: &str) -> (Dtype, bool) {
    let (order, kind) = match descr.split_at_checked(1) {
        Some((order @ ("<" | ">"), kind)) => (order, kind),
        _ => ("", ""),
    };
    let dtype = match kind {
        "f2" => Dtype::F16,
        "f4" => Dtype::F32,
        "f8" => Dtype::F64,
        _ => Dtype::Other(descr.to_owned()),
    };
    (dtype, order == ">")
}

impl Header {
    /// The cube that this array is, or why it cannot be one.
    pub(super) fn cube(&self, place: &Place) -> Result<CubeInfo> {
        let size = self.sample_size(place)?;
        let shape = self.cube_shape(place)?;
        if self.fortran_order {
            return Err(place.invalid(
                "header",
                "the array is in Fortran order (its first index varies fastest)",
                "save it in C order: numpy.save(path, numpy.ascontiguousarray(array))",
            ));
        }
        let bytes = shape
            .iter()
            .try_fold(size, |product, &n| product.checked_mul(n as u64))
            .filter(|&bytes| bytes <= isize::MAX as u64);
        let bytes = bytes.ok_or_else(|| {
            place.invalid(
                "header",
                format!(
                    "the shape {:?} has more samples than memory can address",
                    self.shape
                ),
                WRITE_AGAIN,
            )
        })?;
        Ok(CubeInfo {
            shape,
            dtype: self.dtype.clone(),
            bytes,
        })
    }

    fn sample_size(&self, place: &Place) -> Result<u64> {
        self.dtype.size().ok_or_else(|| {
            let descr = match &self.dtype {
                Dtype::Other(descr) => descr.chars().take(40).collect::<String>(),
                _ => String::new(),
            };
            let what = match descr.as_str() {
                "|O" => "the array holds Python objects, which are never unpickled".to_owned(),
                _ => format!("samples of type {descr:?} are not floating-point numbers"),
            };
            let help = "give f2, f4 or f8 samples: \
                        numpy.save(path, array.astype(numpy.float32))";
            place.unsupported("header", what, help)
        })
    }

    fn cube_shape(&self, place: &Place) -> Result<[usize; 4]> {
        let shape = match *self.shape.as_slice() {
            [h, w, t] => [h, w, t, 1],
            [h, w, t, c] => [h, w, t, c],
            _ => {
                return Err(place.invalid(
                    "header",
                    format!("an array of shape {:?} is not a cube", self.shape),
                    "give three or four axes: (H, W, T) or (H, W, T, C); one frame in time is \
                     array[:, :, numpy.newaxis]",
                ));
            }
        };
        if shape.contains(&0) {
            return Err(place.invalid(
                "header",
                format!("an array of shape {:?} has no samples", self.shape),
                "every axis must have a size of at least 1",
            ));
        }
        if !matches!(shape[3], 1 | 3) {
            return Err(place.invalid(
                "header",
                format!("shape {:?} means {} channels", self.shape, shape[3]),
                "axes are (H, W, T, C) with C of 1 or 3; numpy.moveaxis brings another order \
                 into this one",
            ));
        }
        Ok(shape)
    }
}
