//! OpenEXR files: linear, for every viewer and compositor.
//!
//! One part, scan lines, lossless compression. Samples and names in the file:
//!
//! | in memory | in the file |
//! |---|---|
//! | `radiance.R`, `radiance.G`, `radiance.B` | `R`, `G`, `B`, the image that viewers show |
//! | any other name | the same name: `event.ct` is component `ct` of layer `event` |
//! | f32, u32 | as they are |
//! | f64 | rounded to f32 (EXR has no f64; `.npz` has) |
//! | i32 | two's complement in u32, so that every identifier is exact: −1 is 4294967295 |
//!
//! RGB has the primaries and white of sRGB (Rec. 709, D65), stated in the file. The attribute
//! `nullray.signed` lists the channels that hold i32. Metadata entry `key` becomes the text attribute
//! `nullray.key`, UTF-8. The same layers give the same bytes.

mod header;
mod read;
mod write;

pub use read::{half_channels, read};
pub use write::write;

/// Before the keys of our attributes, so that none is taken for one of the standard's.
const PREFIX: &str = "nullray.";
/// The key of the attribute that lists channels of i32.
const SIGNED: &str = "signed";
/// The layer whose R, G, B are the image's own.
const MAIN: &str = "radiance.";

/// A channel's name in the file.
fn name_in_file(name: &str) -> &str {
    match name.strip_prefix(MAIN) {
        Some(component @ ("R" | "G" | "B")) => component,
        _ => name,
    }
}

/// A channel's name in memory.
fn name_in_memory(name: &str) -> String {
    match name {
        "R" | "G" | "B" => format!("{MAIN}{name}"),
        _ => name.to_string(),
    }
}
