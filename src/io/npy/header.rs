//! The header of an array: a magic string, the version, a length and the text of a Python dictionary of `descr`, `fortran_order` and
//! `shape`.

use std::io::Read;

use half::f16;

use super::place::{Place, WRITE_AGAIN};
use crate::Result;

const MAGIC: &[u8; 6] = b"\x93NUMPY";

/// Headers that numpy writes for floats are about a hundred bytes long; structured types need more.
const LONGEST_HEADER: u32 = 1 << 16;

/// The maximum number of axes, as in numpy 2.
const MOST_AXES: usize = 64;

/// The type of an array's samples.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Dtype {
    /// IEEE half precision, `f2`.
    F16,
    /// Single precision, `f4`.
    F32,
    /// Double precision, `f8`.
    F64,
    /// Any other type, as given in the file (`<i4`, `|O`, …); it cannot be loaded as a cube.
    Other(String),
}

impl Dtype {
    /// The smallest number of which it holds all digits; for other types that of F32.
    pub fn smallest_normal(&self) -> f64 {
        match self {
            Dtype::F16 => f16::MIN_POSITIVE.to_f64(),
            Dtype::F32 | Dtype::Other(_) => f32::MIN_POSITIVE.into(),
            Dtype::F64 => f64::MIN_POSITIVE,
        }
    }

    /// Whether a number is below [`Dtype::smallest_normal`] and loses digits in this type, or is lost.
    pub(crate) fn blurs(&self, number: f64) -> bool {
        let held = match self {
            Dtype::F16 => f16::from_f64(number).to_f64(),
            Dtype::F32 | Dtype::Other(_) => f64::from(number as f32),
            Dtype::F64 => number,
        };
        number.abs() < self.smallest_normal() && held != number
    }

    /// Whether samples are real numbers, or booleans, of at most 64 bits.
    pub fn is_number(&self) -> bool {
        let Dtype::Other(descr) = self else {
            return true;
        };
        let kind = descr.trim_start_matches(['<', '>', '|', '=']);
        let kinds = ["b1", "u1", "i1", "u2", "i2", "u4", "i4", "u8", "i8"];
        kinds.contains(&kind)
    }

    /// Bytes of a number, if [it is one](Dtype::is_number).
    fn bytes(&self) -> Option<u64> {
        match self {
            Dtype::F16 => Some(2),
            Dtype::F32 => Some(4),
            Dtype::F64 => Some(8),
            // The last digit of a type like "<u4".
            Dtype::Other(descr) if self.is_number() => {
                descr.chars().last()?.to_digit(10).map(u64::from)
            }
            Dtype::Other(_) => None,
        }
    }

    /// The largest number of an unsigned type after reading: for `u8`, that of `u4`.
    pub(crate) fn largest_unsigned(&self) -> Option<f64> {
        let Dtype::Other(descr) = self else {
            return None;
        };
        match descr.trim_start_matches(['<', '>', '|', '=']) {
            "u1" => Some(u8::MAX.into()),
            "u2" => Some(u16::MAX.into()),
            "u4" | "u8" => Some(u32::MAX.into()),
            _ => None,
        }
    }
}

/// The header of an array.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct Header {
    /// The array's name in a `.npz` archive; `None` in a `.npy` file.
    pub name: Option<String>,
    /// Sizes, the slowest first unless `fortran_order`.
    pub shape: Vec<usize>,
    /// The type of its samples.
    pub dtype: Dtype,
    /// Whether the first index varies fastest in the file.
    pub fortran_order: bool,
    /// Whether samples have their most significant byte first.
    pub big_endian: bool,
}

impl Header {
    /// Bytes of all samples, if they are numbers.
    pub(super) fn bytes(&self) -> Option<u64> {
        let mut sizes = self.shape.iter();
        sizes.try_fold(self.dtype.bytes()?, |n, size| n.checked_mul(*size as u64))
    }
}

/// Reads magic, version and header; returns the header and its length in bytes.
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
    // The length of the text has two bytes in version 1 and four in later ones.
    let mut length = [0; 4];
    let width = match major {
        1 => 2,
        2 | 3 => 4,
        _ => {
            return Err(place.unsupported(
                "header",
                format!("version {major}.{minor} of the .npy format is not known"),
                "versions 1.0, 2.0 and 3.0 are read; write it again with numpy.save",
            ));
        }
    };
    fill(reader, &mut length[..width], place)?;
    let length = u32::from_le_bytes(length);
    if length > LONGEST_HEADER {
        return Err(place.invalid(
            "header",
            format!("it claims to be {length} bytes long"),
            format!("a header of at most {LONGEST_HEADER} bytes; {WRITE_AGAIN}"),
        ));
    }
    let mut text = vec![0; length as usize];
    fill(reader, &mut text, place)?;
    // Versions 1 and 2 specify Latin-1, but everything needed of a header is ASCII in all versions.
    let header = parse(&String::from_utf8_lossy(&text), place.array.clone());
    let header = header.map_err(|what| place.invalid("header", what, WRITE_AGAIN))?;
    Ok((header, (start.len() + width) as u64 + u64::from(length)))
}

fn fill(reader: &mut dyn Read, bytes: &mut [u8], place: &Place) -> Result<()> {
    reader
        .read_exact(bytes)
        .map_err(|error| place.read_error("header", error))
}

/// The header of the array `name` that `text` describes, or what is wrong with the text.
fn parse(text: &str, name: Option<String>) -> Result<Header, String> {
    // The header is a Python literal: a dictionary of these three entries, in any order.
    let inside = text
        .trim()
        .strip_prefix('{')
        .and_then(|t| t.strip_suffix('}'));
    let entries = inside.and_then(parts).ok_or_else(|| {
        let start: String = text.trim().chars().take(20).collect();
        format!("{start:?} is not a dictionary")
    })?;
    let (mut descr, mut fortran_order, mut shape) = (None, None, None);
    for entry in entries {
        let (key, value) = entry.split_once(':').unwrap_or((entry, ""));
        let (key, value) = (unquoted(key.trim()), value.trim());
        let is_new = match key {
            Some("descr") => descr.replace(unquoted(value).unwrap_or(value)).is_none(),
            Some("fortran_order") => fortran_order.replace(value).is_none(),
            Some("shape") => shape.replace(sizes(value)?).is_none(),
            _ => false,
        };
        if !is_new {
            let key = key.unwrap_or(entry);
            return Err(format!("the entry {key:?} is unknown, or given twice"));
        }
    }
    let (Some(descr), Some(order), Some(shape)) = (descr, fortran_order, shape) else {
        return Err("descr, fortran_order or shape is missing".into());
    };
    let fortran_order = match order {
        "True" => true,
        "False" => false,
        _ => return Err(format!("fortran_order is {order:?} and not True or False")),
    };
    let (dtype, big_endian) = dtype(descr);
    Ok(Header {
        name,
        shape,
        dtype,
        fortran_order,
        big_endian,
    })
}

/// The parts of `text` between commas outside of brackets and strings; an empty last part is left out. `None` if a bracket or a string is
/// not closed.
fn parts(text: &str) -> Option<Vec<&str>> {
    let (mut parts, mut first) = (Vec::new(), 0);
    let (mut depth, mut quote) = (0_usize, None);
    for (at, c) in text.char_indices() {
        match (quote, c) {
            (Some(open), _) if open == c => quote = None,
            (Some(_), _) => {}
            (None, '\'' | '"') => quote = Some(c),
            (None, '(' | '[' | '{') => depth += 1,
            (None, ')' | ']' | '}') => depth = depth.checked_sub(1)?,
            (None, ',') if depth == 0 => {
                parts.push(text[first..at].trim());
                first = at + 1;
            }
            (None, _) => {}
        }
    }
    parts.extend(Some(text[first..].trim()).filter(|last| !last.is_empty()));
    (depth == 0 && quote.is_none()).then_some(parts)
}

/// The contents of a quoted string.
fn unquoted(text: &str) -> Option<&str> {
    let inside = |quote| text.strip_prefix(quote)?.strip_suffix(quote);
    inside('\'').or_else(|| inside('"'))
}

/// A tuple of sizes; Python 2 wrote a final L.
fn sizes(text: &str) -> Result<Vec<usize>, String> {
    let inside = text.strip_prefix('(').and_then(|t| t.strip_suffix(')'));
    let sizes = inside
        .and_then(parts)
        .ok_or_else(|| format!("the shape {text:?} is not a tuple"))?;
    if sizes.len() > MOST_AXES {
        return Err(format!(
            "the array has {} axes, and no program makes more than {MOST_AXES}",
            sizes.len()
        ));
    }
    let size = |text: &str| text.strip_suffix('L').unwrap_or(text).parse().ok();
    let all = sizes
        .iter()
        .map(|text| size(text).ok_or_else(|| format!("{text:?} is not the size of an array")));
    all.collect()
}

/// The type that `descr` names, and whether its byte order is big-endian.
fn dtype(descr: &str) -> (Dtype, bool) {
    let dtype = match descr {
        "<f2" | ">f2" => Dtype::F16,
        "<f4" | ">f4" => Dtype::F32,
        "<f8" | ">f8" => Dtype::F64,
        _ => Dtype::Other(descr.to_owned()),
    };
    (dtype, descr.starts_with('>'))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header(text: &str) -> Result<(Dtype, bool, Vec<usize>), String> {
        parse(text, None).map(|h| (h.dtype, h.fortran_order, h.shape))
    }

    #[test]
    fn a_header_as_numpy_writes_it_is_read() {
        let text = "{'descr': '<f4', 'fortran_order': False, 'shape': (3, 4, 5), }   \n";
        assert_eq!(header(text), Ok((Dtype::F32, false, vec![3, 4, 5])));
    }

    #[test]
    fn tuples_of_none_one_and_python_2_integers_are_read() {
        for (shape, expected) in [("()", vec![]), ("(7,)", vec![7]), ("(7L, 8L)", vec![7, 8])] {
            let text = format!("{{\"shape\":{shape},'descr':\">f8\",'fortran_order':True}}");
            assert_eq!(header(&text), Ok((Dtype::F64, true, expected)));
        }
    }

    #[test]
    fn as_many_axes_as_numpy_has_are_read() {
        let shape = format!("({})", "1, ".repeat(MOST_AXES));
        let text = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': {shape}}}");
        assert_eq!(header(&text).unwrap().2, [1; MOST_AXES]);
    }

    #[test]
    fn a_structured_type_is_kept_as_text() {
        let list = "[('a', '<f4', [2]), ('b', '<i4')]";
        let text = format!("{{'descr': {list}, 'fortran_order': False, 'shape': ()}}");
        assert_eq!(header(&text).unwrap().0, Dtype::Other(list.into()));
    }

    #[test]
    fn what_is_no_header_is_refused() {
        let with =
            |shape: &str| format!("{{'descr': '<f4', 'fortran_order': False, 'shape': {shape}}}");
        assert!(header(&with("(1, 2)")).is_ok());
        for text in [
            "",
            "{",
            "}",
            "{'descr'}",
            "{'descr': }",
            "{'descr': [",
            &with("(1, -2)"),
            &with("(1"),
            &with("(99999999999999999999999,)"),
            &with(&format!("({})", "1, ".repeat(65))),
            &with("(1,)} 1"),
            &with("(1,), 'shape': (1,)"),
            &with("(1,)").replace("False", "0"),
            &with("(1,)").replace('d', "D"),
        ] {
            assert!(header(text).is_err(), "{text:?}");
        }
    }
}
