//! The samples of one array, decoded in pieces straight into the vector that is kept.

use std::io::Read;

use half::f16;

use super::{Dtype, Header, Place, WRITE_AGAIN};
use crate::Result;
use crate::light::time_texture::Samples;

/// Bytes that are read at a time; a multiple of every sample's size.
const PIECE: usize = 1 << 16;

/// All samples of a cube of this shape; there must be exactly as many bytes as they take.
pub(super) fn read(
    reader: &mut dyn Read,
    header: &Header,
    shape: [usize; 4],
    place: &Place,
) -> Result<Samples> {
    let mut source = Source {
        reader,
        shape,
        place,
    };
    let big = header.big_endian;
    let samples = match header.dtype {
        Dtype::F16 if big => Samples::F16(source.decode(f16::from_be_bytes, f16::is_finite)?),
        Dtype::F16 => Samples::F16(source.decode(f16::from_le_bytes, f16::is_finite)?),
        Dtype::F32 if big => Samples::F32(source.decode(f32::from_be_bytes, f32::is_finite)?),
        Dtype::F32 => Samples::F32(source.decode(f32::from_le_bytes, f32::is_finite)?),
        Dtype::F64 if big => Samples::F64(source.decode(f64::from_be_bytes, f64::is_finite)?),
        Dtype::F64 => Samples::F64(source.decode(f64::from_le_bytes, f64::is_finite)?),
        Dtype::Other(_) => return Err(place.unsupported("header", "not floating-point", "")),
    };
    source.expect_end()?;
    Ok(samples)
}

struct Source<'a> {
    reader: &'a mut dyn Read,
    shape: [usize; 4],
    place: &'a Place,
}

impl Source<'_> {
    fn decode<S: Copy, const N: usize>(
        &mut self,
        sample: fn([u8; N]) -> S,
        is_finite: fn(S) -> bool,
    ) -> Result<Vec<S>> {
        let count: usize = self.shape.iter().product();
        let mut samples = Vec::new();
        // Memory is only promised here; it is taken as samples arrive.
        samples.try_reserve_exact(count).map_err(|_| {
            let what = format!("there is not enough memory for {count} samples");
            let help = "crop the cube, or store it in half precision (numpy.float16)";
            self.place.unsupported("", what, help)
        })?;
        let mut piece = vec![0; PIECE];
        while samples.len() < count {
            let bytes = &mut piece[..PIECE.min((count - samples.len()).saturating_mul(N))];
            self.reader
                .read_exact(bytes)
                .map_err(|error| self.place.read_error("samples", error))?;
            let first = samples.len();
            samples.extend(bytes.as_chunks::<N>().0.iter().map(|b| sample(*b)));
            if let Some(bad) = samples[first..].iter().position(|&s| !is_finite(s)) {
                return Err(self.not_finite(first + bad));
            }
        }
        Ok(samples)
    }

    fn not_finite(&self, index: usize) -> crate::Error {
        let [_, w, t, c] = self.shape;
        let [i, j, k, l] = [
            index / (w * t * c),
            index / (t * c) % w,
            index / c % t,
            index % c,
        ];
        self.place.invalid(
            &format!("sample [{i}, {j}, {k}, {l}]"),
            "the sample is not a finite number",
            "radiance must be finite; numpy.nan_to_num replaces NaN and infinity",
        )
    }

    /// One more read: an archive's checksum is compared at the end, and a member may be longer
    /// than its directory says.
    fn expect_end(&mut self) -> Result<()> {
        match self.reader.read(&mut [0]) {
            Ok(0) => Ok(()),
            Ok(_) => Err(self.place.invalid(
                "samples",
                "there are bytes after the last sample",
                WRITE_AGAIN,
            )),
            Err(error) => Err(self.place.read_error("samples", error)),
        }
    }
}
