//! LZF decompression, as h5py writes it: runs of literal bytes, and copies of earlier output.
//!
//! A byte below 32 is the length of a run less 1. Otherwise, its upper three bits are the length of a copy less 2 (if they are all set, a
//! further byte is added), and the lower five bits with the following byte are the distance back to its start, less 1. Source: Lehmann,
//! liblzf 3.6, `lzf_d.c`; h5py 3, `lzf_filter.c` for the entries of the filter.

use hdf5_reader::error::{Error, Result};
use hdf5_reader::messages::filter_pipeline::FilterDescription;

/// Its number among HDF5's filters.
pub(super) const FILTER: u16 = 32000;

/// The bytes of a chunk, whose size is the filter's third entry.
pub(super) fn decompress(filter: &FilterDescription, data: &[u8], _: usize) -> Result<Vec<u8>> {
    let broken = || Error::DecompressionError("LZF: the chunk is broken".into());
    let size = *filter.client_data.get(2).ok_or_else(broken)? as usize;
    decoded(data, size).ok_or_else(broken)
}

fn decoded(data: &[u8], size: usize) -> Option<Vec<u8>> {
    let mut bytes = data.iter().copied();
    let mut out: Vec<u8> = Vec::new();
    while let Some(control) = bytes.next() {
        let control = usize::from(control);
        // Below 32: this many bytes plus one are literal.
        if control < 32 {
            let before = out.len();
            out.extend(bytes.by_ref().take(control + 1));
            (out.len() == before + control + 1).then_some(())?;
        } else {
            // The length of the copy is the upper three bits plus 2; if they are 7, a further byte is added.
            let more = match control >> 5 {
                7 => usize::from(bytes.next()?),
                _ => 0,
            };
            let back = ((control & 31) << 8) + usize::from(bytes.next()?) + 1;
            let start = out.len().checked_sub(back)?;
            // A copy may overlap its own output.
            for at in start..start + (control >> 5) + more + 2 {
                out.push(*out.get(at)?);
            }
        }
        (out.len() <= size).then_some(())?;
    }
    (out.len() == size).then_some(out)
}

#[cfg(test)]
mod tests {
    use super::decoded;

    #[test]
    fn runs_and_copies_make_the_bytes_again() {
        // "abc", then six bytes from three back, then "!".
        let data = [2, b'a', b'b', b'c', 4 << 5, 2, 0, b'!'];
        assert_eq!(decoded(&data, 10).unwrap(), b"abcabcabc!");
        // A long copy of one byte.
        assert_eq!(decoded(&[0, 7, 7 << 5, 100, 0], 110).unwrap(), vec![7; 110]);
        for broken in [&[3, 1][..], &[32, 0], &[0, 1, 32, 5], &[0, 1, 255]] {
            assert_eq!(decoded(broken, 4), None);
        }
    }
}
