//! Estimates the memory of a comparison, so that one that is too large can be refused before it starts.
//!
//! Bytes per pixel were measured with a counting allocator over pictures of light only, of all channels, grey and with NaN: the search for
//! curves applied to the light takes most (up to 214 bytes), and is freed before error pictures are made.

use super::options::{CompareOptions, NotFinite};
use super::picture::Picture;
use crate::io::image::{Layers, Samples};

/// Bytes that the search for shifts takes for pictures of any size.
const SEARCHED: u64 = 48 << 20;
/// Bytes per pixel of measurements and searches, whatever the channels.
const MEASURED: u64 = 232;
/// Bytes per pixel of the error pictures: both for a display, maps in false colours, their files.
const DRAWN: u64 = 160;
/// Bytes per pixel of one channel of the maps: the difference, both inputs of it in f64 or, later, the encoded file.
const MAPPED: u64 = 12;

/// The most bytes that [`compare`](super::compare()) takes beside the pictures, including [`report`](super::report) if maps are requested.
pub fn working_memory(reference: &Picture, candidate: &Picture, options: &CompareOptions) -> u64 {
    let pair = [&reference.layers, &candidate.layers];
    let pixels = u64::from(pair[0].width).saturating_mul(pair[0].height.into());
    let common = pair[0].channels.iter();
    let common = common
        .filter(|c| pair[1].channel(&c.name).is_some())
        .count() as u64;
    let drawn = match options.maps {
        true => DRAWN + MAPPED * (common + 2),
        false => 0,
    };
    // Grey pictures become three channels, and replaced samples are in copies.
    let is_grey = pair.map(|layers| layers.channel("radiance.R").is_none());
    let copied = (0..2)
        .filter(|k| is_grey[*k] != is_grey[1 - *k] || options.not_finite != NotFinite::Refuse);
    let copied: u64 = copied.map(|k| 3 * bytes(pair[k])).sum();
    pixels
        .saturating_mul(MEASURED.max(drawn))
        .saturating_add(copied)
        .saturating_add(SEARCHED)
}

/// The same for two pictures of light only, whose samples may be replaced; including the pictures.
pub(crate) fn working_memory_of_light(pixels: u64) -> u64 {
    const PICTURE: u64 = 3 * 4;
    pixels
        .saturating_mul(MEASURED + 2 * (PICTURE + 3 * PICTURE))
        .saturating_add(SEARCHED)
}

fn bytes(layers: &Layers) -> u64 {
    let of = |samples: &Samples| match samples {
        Samples::F32(v) => 4 * v.len() as u64,
        Samples::F64(v) => 8 * v.len() as u64,
        Samples::U32(v) => 4 * v.len() as u64,
        Samples::I32(v) => 4 * v.len() as u64,
    };
    layers.channels.iter().map(|c| of(&c.samples)).sum()
}
