//! Images on surfaces: sRGB texels, looked up in linear light.
//!
//! Texel (j, i) of N × M has its centre at u = (j + ½)/N, v = (i + ½)/M, row 0 at v = 0. A lookup is bilinear between centres, after
//! decoding: light adds, code values do not. If the sampler requests it, the nearest texel is used.
//!
//! PNG and JPEG are decoded by `png` and `zune-jpeg`, as in the `image` crate. That crate also brings a library for colour management,
//! which is not used here, and the two of them took an eighth of a whole build.

use std::io::Cursor;
use std::path::Path;
use std::sync::LazyLock;

use ::png::{BitDepth, Decoder, Limits, Transformations};
use zune_jpeg::JpegDecoder;
use zune_jpeg::errors::DecodeErrors;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

use super::decoder::guarded;
use crate::colour::srgb_decode;
use crate::error::{Error, Message, Result, Setting};
use crate::mesh::{TextureFilter, TextureSampler, Wrap};

/// The longest side of an image, pixels.
const MAX_SIDE: usize = 16_384;
/// The maximum memory for a decoder, bytes.
const MAX_BYTES: usize = 1 << 30;

/// Linear light for 8-bit sRGB codes.
static LINEAR_8: LazyLock<Vec<f64>> = LazyLock::new(|| linear_table(u8::MAX.into()));
/// Linear light for 16-bit sRGB codes.
static LINEAR_16: LazyLock<Vec<f64>> = LazyLock::new(|| linear_table(u16::MAX));

fn linear_table(max: u16) -> Vec<f64> {
    let max = f64::from(max);
    let codes = (0..).map(f64::from).take_while(|&code| code <= max);
    codes.map(|code| srgb_decode(code / max)).collect()
}

/// An image, as compact as it was stored. Colours ignore alpha.
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

    /// Decodes a PNG or JPEG image, whose format is detected from its content. `file` and `place` are for messages.
    ///
    /// # Errors
    /// Other formats, broken images, sides above 16384 pixels, more than 1 GiB decoded.
    pub fn decode(bytes: &[u8], place: &str, file: &Path) -> Result<Texture> {
        Texture::decode_within(bytes, place, file, MAX_BYTES as u64)
    }

    /// The same for an image whose texels may take at most `memory` bytes, according to its header.
    ///
    /// # Errors
    /// As for [`Texture::decode`]; an image that takes more.
    pub fn decode_within(bytes: &[u8], place: &str, file: &Path, memory: u64) -> Result<Texture> {
        let help = "a PNG or JPEG image of at most 16384 × 16384 pixels";
        match guarded(|| decode(bytes, memory)) {
            Some(Ok(texture)) => Ok(texture),
            Some(Err(Refused::Memory)) => {
                let what = "with this image, textures take more memory than the limit leaves";
                let help = Message::from("smaller textures, or a higher ") + Setting::MemoryLimit;
                Err(Error::invalid(file, place, what, help))
            }
            Some(Err(Refused::Unsupported(what))) => {
                Err(Error::unsupported(file, place, what, help))
            }
            Some(Err(Refused::Broken(why))) => {
                let what = format!("not a readable image: {why}");
                Err(Error::invalid(file, place, what, help))
            }
            None => Err(Error::invalid(file, place, "not a readable image", help)),
        }
    }

    fn new(size: [usize; 2], stride: usize, texels: Texels) -> Result<Texture, Refused> {
        let [width, height] = size;
        let samples = match &texels {
            Texels::Eight(v) => v.len(),
            Texels::Sixteen(v) => v.len(),
        };
        if width == 0 || height == 0 || samples != width * height * stride {
            return Err(Refused::Broken("some of its pixels are missing".into()));
        }
        Ok(Texture {
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

    /// The linear red of each texel, or its grey, from 0 to 1.
    pub(crate) fn reds(&self) -> impl Iterator<Item = f64> {
        (0..self.width * self.height).map(|texel| match &self.texels {
            Texels::Eight(v) => f64::from(v[texel * self.stride]) / 255.0,
            Texels::Sixteen(v) => f64::from(v[texel * self.stride]) / 65535.0,
        })
    }

    /// Linear RGB at `uv`. A coordinate that is not finite counts as 0.
    pub fn sample(&self, uv: [f64; 2], sampler: TextureSampler) -> [f64; 3] {
        let [u, v] = self.taps(uv, sampler);
        let row = |i: usize| mix(self.texel(u.0[0], i), self.texel(u.0[1], i), u.1);
        mix(row(v.0[0]), row(v.0[1]), v.1)
    }

    /// The same for a texture whose values are not colours but linear, from 0 to 1.
    pub(crate) fn sample_linear(&self, uv: [f64; 2], sampler: TextureSampler) -> [f64; 3] {
        let [u, v] = self.taps(uv, sampler);
        let texel = |j, i| match &self.texels {
            Texels::Eight(v) => self.channels(j, i).map(|k| f64::from(v[k]) / 255.0),
            Texels::Sixteen(v) => self.channels(j, i).map(|k| f64::from(v[k]) / 65535.0),
        };
        let row = |i: usize| mix(texel(u.0[0], i), texel(u.0[1], i), u.1);
        mix(row(v.0[0]), row(v.0[1]), v.1)
    }

    /// The minimum of the green channel, linear, from 0 to 1.
    pub(crate) fn least_green(&self) -> f64 {
        let [_, green, _] = self.channels(0, 0);
        match &self.texels {
            Texels::Eight(v) => least(v, green, self.stride).map_or(1.0, |v| f64::from(v) / 255.0),
            Texels::Sixteen(v) => {
                least(v, green, self.stride).map_or(1.0, |v| f64::from(v) / 65535.0)
            }
        }
    }

    /// Alpha at `uv`, looked up like the colour in [`Texture::sample`]; 1 if the image has none.
    pub(crate) fn sample_alpha(&self, uv: [f64; 2], sampler: TextureSampler) -> f64 {
        // Alpha is the last of two or four samples.
        if !self.stride.is_multiple_of(2) {
            return 1.0;
        }
        let [u, v] = self.taps(uv, sampler);
        let texel = |j: usize, i: usize| {
            let at = (i * self.width + j + 1) * self.stride - 1;
            match &self.texels {
                Texels::Eight(v) => f64::from(v[at]) / 255.0,
                Texels::Sixteen(v) => f64::from(v[at]) / 65535.0,
            }
        };
        let row = |i: usize| texel(u.0[0], i) + (texel(u.0[1], i) - texel(u.0[0], i)) * u.1;
        row(v.0[0]) + (row(v.0[1]) - row(v.0[0])) * v.1
    }

    /// The texels on either side of `uv` along u and v, with the weights of the second ones.
    fn taps(&self, uv: [f64; 2], sampler: TextureSampler) -> [([usize; 2], f64); 2] {
        let [width, height] = self.size();
        let taps = [
            taps(uv[0], width, sampler.wrap[0]),
            taps(uv[1], height, sampler.wrap[1]),
        ];
        match sampler.filter {
            TextureFilter::Linear => taps,
            // The nearer one, twice: blending it with itself gives that texel bit for bit.
            TextureFilter::Nearest => taps.map(|([first, second], weight)| {
                let nearer = if weight < 0.5 { first } else { second };
                ([nearer; 2], 0.0)
            }),
        }
    }

    /// The indices of the samples of texel `j` in row `i`, for red, green and blue.
    fn channels(&self, j: usize, i: usize) -> [usize; 3] {
        let first = (i * self.width + j) * self.stride;
        let offsets = if self.stride < 3 { [0; 3] } else { [0, 1, 2] };
        offsets.map(|k| first + k)
    }

    /// Linear RGB of texel `j` in row `i`.
    fn texel(&self, j: usize, i: usize) -> [f64; 3] {
        let channels = self.channels(j, i);
        match &self.texels {
            Texels::Eight(v) => channels.map(|k| LINEAR_8[usize::from(v[k])]),
            Texels::Sixteen(v) => channels.map(|k| LINEAR_16[usize::from(v[k])]),
        }
    }
}

/// The minimum of every `stride`-th sample from `first` on.
fn least<T: Copy + Ord>(samples: &[T], first: usize, stride: usize) -> Option<T> {
    samples.iter().skip(first).step_by(stride).copied().min()
}

/// Why an image is refused.
enum Refused {
    Unsupported(String),
    Broken(String),
    Memory,
}

fn decode(bytes: &[u8], memory: u64) -> Result<Texture, Refused> {
    match bytes {
        [0x89, b'P', b'N', b'G', ..] => decode_png(bytes, memory),
        [0xff, 0xd8, 0xff, ..] => decode_jpeg(bytes, memory),
        _ => Err(Refused::Unsupported("it is neither PNG nor JPEG".into())),
    }
}

fn decode_png(bytes: &[u8], memory: u64) -> Result<Texture, Refused> {
    let broken = |e: ::png::DecodingError| Refused::Broken(e.to_string());
    let limits = Limits { bytes: MAX_BYTES };
    let mut decoder = Decoder::new_with_limits(Cursor::new(bytes), limits);
    let info = decoder.read_header_info().map_err(broken)?;
    let size = [info.width, info.height].map(|side| side as usize);
    check_size(size)?;
    // Palettes become colours, and fewer than 8 bits become 8; 16 bits stay.
    decoder.set_transformations(Transformations::EXPAND);
    let mut reader = decoder.read_info().map_err(broken)?;
    let length = reader.output_buffer_size();
    let length = length.filter(|length| *length <= MAX_BYTES);
    let length = length.ok_or_else(too_large)?;
    check_memory(length, memory)?;
    let mut samples = vec![0; length];
    reader.next_frame(&mut samples).map_err(broken)?;
    let (colour, depth) = reader.output_color_type();
    let texels = match depth {
        BitDepth::Sixteen => {
            let pairs = samples.chunks_exact(2);
            Texels::Sixteen(pairs.map(|b| u16::from_be_bytes([b[0], b[1]])).collect())
        }
        _ => Texels::Eight(samples),
    };
    Texture::new(size, colour.samples(), texels)
}

fn decode_jpeg(bytes: &[u8], memory: u64) -> Result<Texture, Refused> {
    let refused = |e: DecodeErrors| match e {
        DecodeErrors::Unsupported(what) => Refused::Unsupported(format!("{what:?}")),
        DecodeErrors::LargeDimensions(_) => too_large(),
        e => Refused::Broken(e.to_string()),
    };
    let options = DecoderOptions::default()
        // Otherwise truncated or broken data silently become grey.
        .set_strict_mode(true)
        .set_max_width(MAX_SIDE)
        .set_max_height(MAX_SIDE);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    decoder.decode_headers().map_err(refused)?;
    // Grey stays grey; everything else becomes RGB.
    let colours = match decoder.input_colorspace() {
        Some(
            grey_or_rgb @ (ColorSpace::Luma
            | ColorSpace::LumaA
            | ColorSpace::RGB
            | ColorSpace::RGBA),
        ) => grey_or_rgb,
        _ => ColorSpace::RGB,
    };
    decoder.set_options(decoder.options().jpeg_set_out_colorspace(colours));
    let (width, height) = decoder.dimensions().unwrap_or_default();
    check_memory(width * height * colours.num_components(), memory)?;
    let texels = Texels::Eight(decoder.decode().map_err(refused)?);
    if !ends(bytes) {
        return Err(Refused::Broken("it ends before its last pixel".into()));
    }
    let size = decoder.dimensions().unwrap_or_default().into();
    Texture::new(size, colours.num_components(), texels)
}

/// Whether the data of a JPEG file have an end marker: the decoder does not notice if it is missing in the last row of blocks.
fn ends(bytes: &[u8]) -> bool {
    const SCAN: u8 = 0xda;
    const END: [u8; 2] = [0xff, 0xd9];
    // Segments before the first scan have lengths, and may contain pictures with their own end markers.
    let mut at = 2;
    while let Some(&[0xff, kind, high, low]) = bytes.get(at..at + 4) {
        match kind {
            0xff => at += 1,
            SCAN => break,
            _ => at += 2 + usize::from(u16::from_be_bytes([high, low])),
        }
    }
    // In the data a 0xff is followed by 0.
    let data = bytes.get(at..).unwrap_or_default();
    data.windows(2).any(|pair| pair == END)
}

/// Refuses texels that need more memory than is left.
fn check_memory(bytes: usize, memory: u64) -> Result<(), Refused> {
    match bytes as u64 <= memory {
        true => Ok(()),
        false => Err(Refused::Memory),
    }
}

fn check_size(size: [usize; 2]) -> Result<(), Refused> {
    match size.iter().all(|side| *side <= MAX_SIDE) {
        true => Ok(()),
        false => Err(too_large()),
    }
}

fn too_large() -> Refused {
    Refused::Broken("it is over the limit of 16384 × 16384 pixels and 1 GiB".into())
}

/// The two texels on either side of coordinate `x` among `n`, and the weight of the second one.
fn taps(x: f64, n: usize, wrap: Wrap) -> ([usize; 2], f64) {
    let x = if x.is_finite() { x } else { 0.0 };
    let inside = match wrap {
        Wrap::Repeat => x - x.floor(),
        Wrap::Clamp => x.clamp(0.0, 1.0),
        Wrap::Mirror => {
            // Every second repetition is mirrored.
            let period = x - 2.0 * (0.5 * x).floor();
            if period > 1.0 { 2.0 - period } else { period }
        }
    };
    // The centres of texels are at half-integers.
    let position = inside * n as f64 - 0.5;
    let first = position.floor();
    let index = |i: f64| match wrap {
        Wrap::Repeat if i < 0.0 => n - 1,
        Wrap::Repeat if i >= n as f64 => 0,
        // A mirrored edge texel is its own neighbour, like a clamped one.
        _ => (i.max(0.0) as usize).min(n - 1),
    };
    ([index(first), index(first + 1.0)], position - first)
}

fn mix(a: [f64; 3], b: [f64; 3], weight: f64) -> [f64; 3] {
    std::array::from_fn(|k| a[k] + (b[k] - a[k]) * weight)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A grey JPEG of 64 × 64 pixels: per block, one bit, 0, for an unchanged mean, and another for the end of the block.
    fn grey(data: &[u8], end: &[u8]) -> Vec<u8> {
        let table = |kind: u8| {
            let mut lengths = [0; 16];
            lengths[0] = 1;
            [&[0xff, 0xc4, 0, 20, kind][..], &lengths, &[0]].concat()
        };
        [
            &[0xff, 0xd8, 0xff, 0xdb, 0, 67, 0][..],
            &[1; 64],
            &[0xff, 0xc0, 0, 11, 8, 0, 64, 0, 64, 1, 1, 0x11, 0],
            &table(0),
            &table(0x10),
            &[0xff, 0xda, 0, 8, 1, 1, 0, 0, 63, 0],
            data,
            end,
        ]
        .concat()
    }

    #[test]
    fn a_jpeg_that_is_cut_short_or_broken_is_refused() {
        let end = [0xff, 0xd9];
        let decode = |bytes: Vec<u8>| Texture::decode(&bytes, "image 0", Path::new("a.glb"));
        let whole = decode(grey(&[0; 16], &end)).unwrap();
        assert_eq!(whole.size(), [64, 64]);
        assert_eq!(whole.texels, Texels::Eight(vec![128; 4096]));
        // In the last row of blocks, before it, and with bits that are not a valid code.
        let broken: [(&[u8], &[u8]); 3] = [(&[0; 16], &[]), (&[0; 4], &[]), (&[0x55; 16], &end)];
        for (data, end) in broken {
            let error = decode(grey(data, end)).map(drop).unwrap_err().to_string();
            assert!(error.contains("image 0"), "{data:?}: {error}");
            assert!(error.contains("not a readable image"), "{data:?}: {error}");
        }
    }
}
