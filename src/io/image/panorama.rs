//! Headers of pictures of skies (EXR and Radiance).

use std::io::{BufReader, Read, Seek};
use std::path::Path;

use ::exr::meta::MetaData;

use super::decoder::guarded;
use super::hdr;
use crate::io::files;

/// The contents of a picture's header.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct PanoramaHead {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// The names of its channels.
    pub channels: Vec<String>,
    /// Bytes needed while its pixels are read, in addition to what remains.
    pub reading: u64,
}

/// Whether the file at `path` is a Radiance picture, by its name.
pub fn is_hdr(path: &Path) -> bool {
    path.extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("hdr"))
}

/// The header of the picture at `path`; `None` if it cannot be read, for which reading the pixels then gives the reason.
pub fn head(path: &Path) -> Option<PanoramaHead> {
    let (mut file, length) = files::open(path).ok()?;
    if is_hdr(path) {
        let mut bytes = Vec::new();
        let most = hdr::LONGEST_HEAD as u64;
        file.take(most).read_to_end(&mut bytes).ok()?;
        let [width, height] = hdr::size(&bytes)?;
        return Some(PanoramaHead {
            width,
            height,
            channels: ["R", "G", "B"].map(str::to_owned).into(),
            // The file, and three f32.
            reading: length.saturating_add(12 * (width * height) as u64),
        });
    }
    file.rewind().ok()?;
    let decoded = guarded(|| MetaData::read_from_buffered(BufReader::new(file), false));
    let first = decoded?.ok()?.headers.into_iter().next()?;
    let names = first.channels.list.iter().map(|c| c.name.to_string());
    let channels: Vec<String> = names.collect();
    let (width, height) = (first.layer_size.0, first.layer_size.1);
    // All channels in f32, then red, green and blue in f64 and in f32.
    let each = 4 * channels.len() as u64 + 24 + 12;
    Some(PanoramaHead {
        width,
        height,
        reading: each.saturating_mul((width as u64).saturating_mul(height as u64)),
        channels,
    })
}
