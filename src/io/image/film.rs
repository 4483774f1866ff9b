//! Films: sequences of pictures of one size, as animated PNG or raw video.
//!
//! Animated PNG stores the pictures exactly. Raw video is YUV4MPEG2 of 8 bits without subsampling (C444), which ffmpeg and other encoders
//! read from a pipe. Its components are those of BT.709 in the limited range; with R′, G′, B′ the codes of sRGB,
//!
//! ```text
//! Y′ = 0.2126 R′ + 0.7152 G′ + 0.0722 B′,   Cb = (B′ − Y′)/1.8556,   Cr = (R′ − Y′)/1.5748,
//! codes: 16 + 219/255 Y′,   128 + 224/255 Cb,   128 + 224/255 Cr,   each rounded.
//! ```
//!
//! After decoding, each component of a picture is within 2 codes: rounding contributes up to ½·255/219 + 1.8556·½·255/224 = 1.64 to B′,
//! less to the others, and the final rounding to a code cannot turn that into 3.
//!
//! Sources: ITU-R BT.709-6, 3; yuv4mpeg(5) of the MJPEG tools; the PNG specification, third edition, 11.3.6.

use std::io::Write;
use std::path::{Path, PathBuf};

use ::png::{BlendOp, ColorType, DisposeOp, Encoder, EncodingError};

use super::RgbImage;
use super::file::write_failed;
use super::png::encoder;
use crate::error::{Error, Result, number};

/// The duration of a picture, as a fraction of a second.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Delay {
    /// The numerator.
    pub numerator: u16,
    /// The denominator; not 0.
    pub denominator: u16,
}

impl Delay {
    /// The delay for this number of pictures per second: in whole milliseconds if exact, otherwise the best fraction, like 1001/30000.
    ///
    /// # Errors
    /// A rate that no fraction of numbers up to 65535 approximates to 1e-5, which is a second per day.
    pub fn of_rate(fps: f64) -> Result<Delay> {
        let milliseconds = 1000.0 / fps;
        let is_whole = |x: f64| x == x.round() && (1.0..=f64::from(u16::MAX)).contains(&x);
        let [numerator, denominator] = match fps {
            fps if is_whole(fps) => [1, fps as u16],
            _ if is_whole(milliseconds) => [milliseconds as u16, 1000],
            fps => best_fraction(1.0 / fps),
        };
        let stated = f64::from(denominator) / f64::from(numerator);
        match denominator > 0 && (stated - fps).abs() <= RATE_ERROR * fps {
            true => Ok(Delay {
                numerator,
                denominator,
            }),
            false => Err(wrong(
                &format!(
                    "a rate of {} pictures per second, which cannot be expressed as a fraction of numbers up to 65535",
                    number(fps)
                ),
                "a rate like 25, 29.97 or 0.5",
            )),
        }
    }
}

/// The maximum relative error of a rate.
const RATE_ERROR: f64 = 1e-5;

/// The last continued-fraction convergent of `x` above 0 whose parts are at most 65535; its parts may be 0 only if `x` is out of range or
/// not finite.
fn best_fraction(x: f64) -> [u16; 2] {
    let most = f64::from(u16::MAX);
    // Convergents p/q of [a₀; a₁, a₂ …]: p_k = a_k p_(k−1) + p_(k−2), and q alike.
    let (mut last, mut before) = ([1.0, 0.0], [0.0, 1.0]);
    let mut rest = x;
    for _ in 0..64 {
        let whole = rest.floor();
        let next = [0, 1].map(|i| whole * last[i] + before[i]);
        // False for NaN.
        if !next.iter().all(|n| *n <= most) {
            break;
        }
        (before, last) = (last, next);
        // If the fraction equals the number, the rest is rounding error.
        if rest == whole || last[0] / last[1] == x {
            break;
        }
        rest = 1.0 / (rest - whole);
    }
    last.map(|n| n as u16)
}

/// A film being written.
pub struct FilmWriter<W: Write> {
    format: Format<W>,
    /// For errors.
    name: PathBuf,
    size: [u32; 2],
    /// Bytes per pixel.
    samples: usize,
    /// The number of pictures announced, and the number written.
    count: u32,
    done: u32,
}

enum Format<W: Write> {
    Apng(Box<::png::Writer<W>>),
    Y4m(W),
}

impl<W: Write> FilmWriter<W> {
    /// An animated PNG of `count` pictures of this size, which repeats for ever; errors of `writer` are those of the file `name`. `text`
    /// entries become text chunks, like those of [`png::write`](super::png::write()).
    ///
    /// # Errors
    /// A size, a count or a denominator of 0, keys that PNG cannot store, and I/O errors.
    pub fn apng(
        name: &Path,
        writer: W,
        size: [u32; 2],
        count: u32,
        delay: Delay,
        text: &[(String, String)],
    ) -> Result<Self> {
        let mut encoder = encoder(writer, size, ColorType::Rgb);
        for (key, value) in text {
            let text = encoder.add_itxt_chunk(key.clone(), value.clone());
            text.map_err(|error| failure(name, error))?;
        }
        Self::animated(name, encoder, size, 3, count, delay)
    }

    /// The animated PNG of `encoder`, whose pictures have `samples` bytes per pixel.
    pub(crate) fn animated(
        name: &Path,
        mut encoder: Encoder<'_, W>,
        size: [u32; 2],
        samples: usize,
        count: u32,
        delay: Delay,
    ) -> Result<Self> {
        checked(size, count, delay)?;
        let mut set_up = || {
            // 0 plays: for ever. Each picture replaces the whole previous one.
            encoder.set_animated(count, 0)?;
            encoder.set_frame_delay(delay.numerator, delay.denominator)?;
            encoder.set_dispose_op(DisposeOp::None)?;
            encoder.set_blend_op(BlendOp::Source)
        };
        let failed = |error| failure(name, error);
        set_up().map_err(failed)?;
        let writer = encoder.write_header().map_err(failed)?;
        Ok(FilmWriter {
            format: Format::Apng(Box::new(writer)),
            name: name.into(),
            size,
            samples,
            count,
            done: 0,
        })
    }

    /// Raw video of `count` pictures of this size; errors of `writer` are those of the file `name`.
    ///
    /// # Errors
    /// A size, a count or a denominator of 0, and I/O errors.
    pub fn y4m(
        name: &Path,
        mut writer: W,
        size: [u32; 2],
        count: u32,
        delay: Delay,
    ) -> Result<Self> {
        checked(size, count, delay)?;
        let [width, height] = size;
        // The header contains the rate, the reciprocal of the delay.
        let (numerator, denominator) = (delay.denominator, delay.numerator);
        writeln!(
            writer,
            "YUV4MPEG2 W{width} H{height} F{numerator}:{denominator} Ip A1:1 C444 XCOLORRANGE=LIMITED"
        )
        .map_err(write_failed(name))?;
        Ok(FilmWriter {
            format: Format::Y4m(writer),
            name: name.into(),
            size,
            samples: 3,
            count,
            done: 0,
        })
    }

    /// Writes the next picture; raw video is also flushed, for a reader that shows it at once.
    ///
    /// # Errors
    /// Another size than the film's, more pictures than announced, and I/O errors.
    pub fn picture(&mut self, picture: &RgbImage) -> Result<()> {
        self.pixels([picture.width, picture.height], &picture.rgb)
    }

    /// The same for pixels in the film's own format.
    pub(crate) fn pixels(&mut self, size: [u32; 2], pixels: &[u8]) -> Result<()> {
        let [width, height] = self.size;
        let length = self.samples * width as usize * height as usize;
        if size != self.size || pixels.len() != length {
            let (done, [w, h]) = (self.done, size);
            let what = format!("picture {done} has {w} × {h} pixels, the film {width} × {height}");
            return Err(wrong(&what, "pictures of one size"));
        }
        if self.done == self.count {
            return Err(wrong(
                "more pictures than announced",
                "as many as announced",
            ));
        }
        self.done += 1;
        let name = &self.name;
        match &mut self.format {
            Format::Apng(writer) => {
                let written = writer.write_image_data(pixels);
                written.map_err(|error| failure(name, error))
            }
            Format::Y4m(writer) => {
                let mut frame = b"FRAME\n".to_vec();
                frame.extend(planes(pixels));
                let written = writer.write_all(&frame).and_then(|()| writer.flush());
                written.map_err(write_failed(name))
            }
        }
    }

    /// Finishes the film.
    ///
    /// # Errors
    /// Fewer pictures than announced, and I/O errors.
    pub fn finish(self) -> Result<()> {
        if self.done < self.count {
            let what = format!("{} pictures of {}", self.done, self.count);
            return Err(wrong(&what, "as many as announced"));
        }
        match self.format {
            Format::Apng(writer) => writer.finish().map_err(|error| failure(&self.name, error)),
            Format::Y4m(mut writer) => writer.flush().map_err(write_failed(&self.name)),
        }
    }
}

fn checked([width, height]: [u32; 2], count: u32, delay: Delay) -> Result<()> {
    if delay.denominator == 0 {
        let what = "a delay with the denominator 0";
        return Err(wrong(what, "1/25 for 25 pictures per second"));
    }
    if width == 0 || height == 0 || count == 0 {
        return Err(wrong(
            "a film without a pixel",
            "at least one picture of at least one pixel",
        ));
    }
    Ok(())
}

/// All codes of Y′, then those of Cb, then those of Cr.
fn planes(rgb: &[u8]) -> Vec<u8> {
    let (pixels, _) = rgb.as_chunks::<3>();
    let mut out = vec![0; rgb.len()];
    let (luma, chroma) = out.split_at_mut(pixels.len());
    let (blue, red) = chroma.split_at_mut(pixels.len());
    for (((pixel, y), cb), cr) in pixels.iter().zip(luma).zip(blue).zip(red) {
        let [r, g, b] = pixel.map(f64::from);
        // Rec. 709 in the limited range: Y′, and Cb and Cr divided by 2 (1 − 0.0722) and 2 (1 − 0.2126).
        let brightness = 0.2126 * r + 0.7152 * g + 0.0722 * b;
        let code = |offset: f64, value: f64| (offset + value + 0.5).floor() as u8;
        *y = code(16.0, 219.0 / 255.0 * brightness);
        *cb = code(128.0, 224.0 / 255.0 * (b - brightness) / 1.8556);
        *cr = code(128.0, 224.0 / 255.0 * (r - brightness) / 1.5748);
    }
    out
}

fn wrong(what: &str, help: &str) -> Error {
    Error::invalid("film", "", what, help)
}

fn failure(name: &Path, error: EncodingError) -> Error {
    match error {
        EncodingError::IoError(error) => write_failed(name)(error),
        other => wrong(&format!("cannot be written as PNG: {other}"), ""),
    }
}

#[cfg(test)]
mod tests;
