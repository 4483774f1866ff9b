//! Animated PNG, which browsers play without a player.
//!
//! Every frame is complete and replaces the previous one; the animation loops for ever. Programs without animation support show the first
//! frame.

use ::png::ColorType;

use super::png::{RgbaImage, encoder};
use crate::error::{Error, Result};
use crate::io::image::film::FilmWriter;

pub use crate::io::image::film::Delay;

/// The frames as one file, its origin being that of the first; `count` of them are taken one after another, so that one is held at a time.
///
/// # Errors
/// Those of the frames; no frames, or fewer than `count`; frames of another size than the first; keys that PNG does not hold.
pub fn write(
    count: u32,
    frames: impl IntoIterator<Item = Result<RgbaImage>>,
    delay: Delay,
) -> Result<Vec<u8>> {
    let mut frames = frames.into_iter().take(count as usize);
    let Some(first) = frames.next() else {
        let help = "one frame or more";
        return Err(Error::invalid(
            "film",
            "",
            "an animation without frames",
            help,
        ));
    };
    let first = first?;
    let mut bytes = Vec::new();
    let encoder = encoder(&mut bytes, &first, ColorType::Rgba).map_err(|error| {
        Error::invalid("film", "", format!("cannot be written as PNG: {error}"), "")
    })?;
    let size = [first.width, first.height];
    // Errors of the file are those of its own writing.
    let mut film = FilmWriter::animated("film".as_ref(), encoder, size, 4, count, delay)?;
    film.pixels(size, &first.rgba)?;
    for frame in frames {
        let frame = frame?;
        film.pixels([frame.width, frame.height], &frame.rgba)?;
    }
    film.finish()?;
    Ok(bytes)
}
