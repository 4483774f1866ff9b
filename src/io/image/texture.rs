//! Images that surfaces show: sRGB texels, looked up in linear light.
//!
//! Texel (j, i) of N × M has its centre at u = (j + ½)/N, v = (i + ½)/M, row 0 at v = 0. A lookup is
//! bilinear between centres, after decoding: light adds, code values do not.

use std::io::Cursor;
use std::path::Path;
use std::sync::LazyLock;

use ::image::{DynamicImage, ImageError, ImageReader, ImageResult, Limits};

use super::guarded;
use crate::colour::srgb_decode;
use crate::error::{Error, Result};
use crate::mesh::Wrap;

/// The longest side of an image that is decoded, pixels.
const MAX_SIDE: u32 = 16_384;
/// The most memory that a decoder may take, bytes.
const MAX_BYTES: u64 = 1 << 30;

/// Linear light of 8-bit sRGB.
static LINEAR_8: LazyLock<Vec<f64>> = LazyLock::new(|| linear_table(u8::MAX.into()));
/// Linear light of 16-bit sRGB.
static LINEAR_16: LazyLock<Vec<f64>> = LazyLock::new(|| linear_table(u16::MAX));

fn linear_table(max: u16) -> Vec<f64> {
    let max = f64::from(max);
    let codes = (0..).map(f64::from).take_while(|&code| code <= max);
    codes.map(|code| srgb_decode(code / max)).collect()
}

/// An image, as compact as it was stored. Alpha is ignored.
#[derive(Debug, Clone, PartialEq)]
pub struct Texture {
    width: usize,
    height: usize,
    /// Samples per texel: 1 or 2 for grey (and alpha), 3 or 4 for RGB (and alpha).
    stride: usize,
    texels: Texels,
}

#[derive(Debug, Clone, PartialEq)]
enum Texels {
    Eight(Vec<u8>),
    Sixteen(Vec<u16>),
}

impl Texture {
    /// Bytes in memory.
    pub fn bytes(&self) -> usize {
        match &self.texels {
            Texels::Eight(texels) => texels.len(),
            Texels::Sixteen(texels) => 2 * texels.len(),
        }
    }

    /// Decodes a PNG or JPEG image, by its content. `file` and `place` are for messages.
    ///
    /// # Errors
    /// Other formats, broken images, sides above 16384 pixels, more than 1 GiB decoded.
    pub fn decode(bytes: &[u8], place: &str, file: &Path) -> Result<Texture> {
        let help = "a PNG or JPEG image of at most 16384 × 16384 pixels";
        let texture = match guarded(|| decode(bytes)) {
            Some(Ok(image)) => Texture::new(image),
            Some(Err(ImageError::Unsupported(e))) => {
                return Err(Error::unsupported(file, place, e.to_string(), help));
            }
            Some(Err(e)) => {
                let what = format!("not a readable image: {e}");
                return Err(Error::invalid(file, place, what, help));
            }
            None => None,
        };
        texture.ok_or_else(|| Error::invalid(file, place, "not a readable image", help))
    }

    fn new(image: DynamicImage) -> Option<Texture> {
        let (width, height) = (image.width() as usize, image.height() as usize);
        let stride = usize::from(image.color().channel_count());
        let texels = match image {
            DynamicImage::ImageLuma8(i) => Texels::Eight(i.into_raw()),
            DynamicImage::ImageLumaA8(i) => Texels::Eight(i.into_raw()),
            DynamicImage::ImageRgb8(i) => Texels::Eight(i.into_raw()),
            DynamicImage::ImageRgba8(i) => Texels::Eight(i.into_raw()),
            DynamicImage::ImageLuma16(i) => Texels::Sixteen(i.into_raw()),
            DynamicImage::ImageLumaA16(i) => Texels::Sixteen(i.into_raw()),
            DynamicImage::ImageRgb16(i) => Texels::Sixteen(i.into_raw()),
            DynamicImage::ImageRgba16(i) => Texels::Sixteen(i.into_raw()),
            _ => return None,
        };
        let samples = match &texels {
            Texels::Eight(v) => v.len(),
            Texels::Sixteen(v) => v.len(),
        };
        let whole = width > 0 && height > 0 && samples == width * height * stride;
        whole.then_some(Texture {
            width,
            height,
            stride,
            texels,
        })
    }

    /// Width and height, texels.
    pub fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    /// Linear RGB at `uv`, `wrap` saying what lies outside [0, 1] along u and v. A coordinate that is
    /// not finite counts as 0.
    pub fn sample(&self, uv: [f64; 2], wrap: [Wrap; 2]) -> [f64; 3] {
        let u = taps(uv[0], self.width, wrap[0]);
        let v = taps(uv[1], self.height, wrap[1]);
        let row = |i: usize| mix(self.texel(u.0[0], i), self.texel(u.0[1], i), u.1);
        mix(row(v.0[0]), row(v.0[1]), v.1)
    }

    /// Linear RGB of texel `j` of row `i`.
    fn texel(&self, j: usize, i: usize) -> [f64; 3] {
        let first = (i * self.width + j) * self.stride;
        let offsets = if self.stride < 3 { [0; 3] } else { [0, 1, 2] };
        match &self.texels {
            Texels::Eight(v) => offsets.map(|k| LINEAR_8[usize::from(v[first + k])]),
            Texels::Sixteen(v) => offsets.map(|k| LINEAR_16[usize::from(v[first + k])]),
        }
    }
}

fn decode(bytes: &[u8]) -> ImageResult<DynamicImage> {
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIDE);
    limits.max_image_height = Some(MAX_SIDE);
    limits.max_alloc = Some(MAX_BYTES);
    let mut reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format()?;
    reader.limits(limits);
    reader.decode()
}

/// The two texels on either side of coordinate `x` among `n`, and the weight of the second.
fn taps(x: f64, n: usize, wrap: Wrap) -> ([usize; 2], f64) {
    let x = if x.is_finite() { x } else { 0.0 };
    let inside = match wrap {
        Wrap::Repeat => x - x.floor(),
        Wrap::Clamp => x.clamp(0.0, 1.0),
        Wrap::Mirror => {
            let period = x - 2.0 * (0.5 * x).floor();
            if period > 1.0 { 2.0 - period } else { period }
        }
    };
    let position = inside * n as f64 - 0.5;
    let first = position.floor();
    let index = |i: f64| match wrap {
        Wrap::Repeat if i < 0.0 => n - 1,
        Wrap::Repeat if i >= n as f64 => 0,
        // A mirrored edge texel is its own neighbour, as a clamped one is.
        _ => (i.max(0.0) as usize).min(n - 1),
    };
    ([index(first), index(first + 1.0)], position - first)
}

fn mix(a: [f64; 3], b: [f64; 3], weight: f64) -> [f64; 3] {
    std::array::from_fn(|k| a[k] + (b[k] - a[k]) * weight)
}
