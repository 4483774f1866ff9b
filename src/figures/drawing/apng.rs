//! Animated PNG: what browsers play without a player.
//!
//! Every frame is whole and replaces the one before; the animation repeats for ever. Programs that know
//! no animation show the first frame.

use ::png::{BlendOp, ColorType, DisposeOp, EncodingError};

use super::png::{Raster, encoder};
use crate::error::{Error, Result};

pub use crate::io::image::film::Delay;

/// The frames as one file, its origin being that of the first; `count` of them are taken one after another, so that one is held at a time.
///
/// # Errors
/// Those of the frames; no frames, or fewer than `count`; frames of another size than the first; a delay
/// with the denominator 0; keys that PNG does not hold.
pub fn write(
    count: u32,
    frames: impl IntoIterator<Item = Result<Raster>>,
    delay: Delay,
) -> Result<Vec<u8>> {
    if delay.denominator == 0 {
        return Err(wrong(
            "a delay with the denominator 0",
            "1/25 for 25 frames per second",
        ));
    }
    let mut frames = frames.into_iter();
    let first = match frames.next().filter(|_| count > 0) {
        Some(first) => first?,
        None => return Err(wrong("an animation without frames", "one frame or more")),
    };
    let mut bytes = Vec::new();
    let mut encoder = encoder(&mut bytes, &first, ColorType::Rgba).map_err(failure)?;
    set_up(&mut encoder, count, delay).map_err(failure)?;
    let mut writer = encoder.write_header().map_err(failure)?;
    writer.write_image_data(&first.rgba).map_err(failure)?;
    for index in 1..count {
        let Some(frame) = frames.next() else {
            let what = format!("{index} frames of {count}");
            return Err(wrong(&what, "as many frames as are announced"));
        };
        let frame = frame?;
        same_size(index, &frame, &first)?;
        writer.write_image_data(&frame.rgba).map_err(failure)?;
    }
    writer.finish().map_err(failure)?;
    Ok(bytes)
}

fn set_up(
    encoder: &mut ::png::Encoder<&mut Vec<u8>>,
    count: u32,
    delay: Delay,
) -> Result<(), EncodingError> {
    encoder.set_animated(count, 0)?;
    encoder.set_frame_delay(delay.numerator, delay.denominator)?;
    encoder.set_dispose_op(DisposeOp::None)?;
    encoder.set_blend_op(BlendOp::Source)
}

fn same_size(index: u32, frame: &Raster, first: &Raster) -> Result<()> {
    if (frame.width, frame.height) == (first.width, first.height) {
        return Ok(());
    }
    let size = |raster: &Raster| format!("{} × {} pixels", raster.width, raster.height);
    let what = format!(
        "frame {index} has {}, the first {}",
        size(frame),
        size(first)
    );
    Err(wrong(&what, "frames of one size"))
}

fn wrong(what: &str, help: &str) -> Error {
    Error::invalid("animation", "", what, help)
}

fn failure(error: EncodingError) -> Error {
    wrong(&format!("cannot be written as PNG: {error}"), "")
}
