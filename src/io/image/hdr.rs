//! Radiance HDR files (`.hdr`, RGBE): linear, read only.
//!
//! A text header that ends with an empty line, a line `-Y height +X width`, then scan lines of four bytes per pixel, run-length encoded by
//! component or by pixel, or not at all. A pixel is (m + ½) 2^(e − 136) per mantissa m, and 0 if e is 0. Source: Ward, "Real Pixels",
//! Graphics Gems II, 1991, and the reference decoder color.c of Radiance.

use std::borrow::Cow;
use std::path::Path;

use crate::error::{Error, Result};
use crate::io::budget::Budget;

/// The longest side, pixels, and the longest header, bytes.
const MAX_SIDE: usize = 32_768;
const MAX_HEADER: usize = 1 << 16;
/// A bound on the length of the header with its resolution line, bytes.
pub(super) const LONGEST_HEAD: usize = 2 * MAX_HEADER;
/// The maximum number of pixels.
const MAX_PIXELS: usize = 1 << 28;

/// The primaries of Rec. 709 with its white, and with that of Radiance, which are assumed if a file says nothing.
const PRIMARIES: [f32; 6] = [0.64, 0.33, 0.30, 0.60, 0.15, 0.06];
const WHITES: [[f32; 2]; 2] = [[0.3127, 0.3290], [0.3333, 0.3333]];
/// The tolerance for equal chromaticities: they are written with three digits, red of Radiance is 0.640 and green 0.290.
const SAME: f32 = 0.0101;

/// Width, height and linear RGB, row by row from the top, of the file in `bytes`, using memory from `budget`; `path` is for messages.
///
/// # Errors
/// Files that are not RGBE, or are broken; XYZE, other primaries and orientations; sides above 32768 pixels.
pub fn read(bytes: &[u8], path: &Path, budget: &Budget) -> Result<([usize; 2], Vec<[f32; 3]>)> {
    let help = "a Radiance picture (.hdr) in RGBE, rows from the top";
    let refuse = |what| Error::invalid(path, "", what, help);
    let mut rest = bytes;
    let (size, factors) = header(&mut rest).map_err(refuse)?;
    // A run of four bytes gives at most 255 pixels: refuse, before allocating, more than the file can contain.
    let missing = || refuse("some of its pixels are missing".into());
    if size[0] * size[1] / 256 > rest.len() {
        return Err(missing());
    }
    budget.take((size[0] * size[1]) as u64 * 12, path)?;
    let pixels = decode(rest, size, &factors);
    Ok((size, pixels.ok_or_else(missing)?))
}

/// Width and height from the first bytes of a file; `None` if they are not a valid header.
pub(super) fn size(mut head: &[u8]) -> Option<[usize; 2]> {
    header(&mut head).ok().map(|(size, _)| size)
}

/// The factors by which the values in a file differ from those of the scene.
struct Factors {
    exposure: f32,
    /// For red, green and blue.
    corrections: [f32; 3],
}

/// Width and height, and the factors in the pixels.
fn header(rest: &mut &[u8]) -> Result<([usize; 2], Factors), String> {
    let first = line(rest).unwrap_or_default();
    if !first.starts_with("#?") {
        return Err("not a Radiance HDR file: it does not begin with #?".into());
    }
    let mut factors = Factors {
        exposure: 1.0,
        corrections: [1.0; 3],
    };
    loop {
        let line = line(rest).ok_or("its header has no end")?;
        if line.is_empty() {
            break;
        }
        // Lines about other pictures from which this one was made begin with a tab, and their keys do not apply.
        let Some((key, value)) = line.split_once('=') else {
            continue;
        };
        let wrong = || format!("its {} is {value:?}", key.trim_end());
        match key.trim_end() {
            "FORMAT" => match value.trim() {
                "32-bit_rle_rgbe" => {}
                "32-bit_rle_xyze" => return Err("its pixels are XYZE".into()),
                _ => return Err(wrong()),
            },
            // Values in the file are those of the scene, multiplied by all of these.
            "EXPOSURE" => {
                let [factor] = above_zero(value).ok_or_else(wrong)?;
                factors.exposure *= factor;
            }
            "COLORCORR" => {
                let all = above_zero::<3>(value).ok_or_else(wrong)?;
                (factors.corrections.iter_mut().zip(all)).for_each(|(c, factor)| *c *= factor);
            }
            "PRIMARIES" => {
                let said = numbers::<8>(value).ok_or_else(wrong)?;
                let is_near = |known: &[f32], from: usize| {
                    let pairs = known.iter().zip(&said[from..]);
                    pairs.into_iter().all(|(a, b)| (a - b).abs() < SAME)
                };
                if !is_near(&PRIMARIES, 0) || !WHITES.iter().any(|white| is_near(white, 6)) {
                    return Err(format!("{}, which are not those of Rec. 709", wrong()));
                }
            }
            _ => {}
        }
    }
    let size = line(rest).ok_or("its size is missing")?;
    let size = size.as_ref();
    let words: Vec<&str> = size.split_whitespace().collect();
    let ["-Y", height, "+X", width] = words[..] else {
        return Err(format!("its rows are ordered by {size:?}"));
    };
    let side = |text: &str| text.parse().ok().filter(|n| (1..=MAX_SIDE).contains(n));
    let (Some(width), Some(height)) = (side(width), side(height)) else {
        return Err(format!("its size is {size:?}"));
    };
    if width * height > MAX_PIXELS {
        return Err("some of its pixels are missing".into());
    }
    Ok(([width, height], factors))
}

/// The N numbers of a line; `None` if it has another number of them.
fn numbers<const N: usize>(text: &str) -> Option<[f32; N]> {
    let all: Option<Vec<f32>> = text.split_whitespace().map(|n| n.parse().ok()).collect();
    let all: [f32; N] = all?.try_into().ok()?;
    all.iter().all(|x| x.is_finite()).then_some(all)
}

/// The same, if all are above 0.
fn above_zero<const N: usize>(text: &str) -> Option<[f32; N]> {
    numbers(text).filter(|all: &[f32; N]| all.iter().all(|x| *x > 0.0))
}

fn decode(
    mut rest: &[u8],
    [width, height]: [usize; 2],
    factors: &Factors,
) -> Option<Vec<[f32; 3]>> {
    let mut pixels = Vec::with_capacity(width * height);
    let mut row = vec![[0u8; 4]; width];
    for _ in 0..height {
        scan_line(&mut rest, &mut row)?;
        pixels.extend(row.iter().map(|rgbe| linear(*rgbe, factors)));
    }
    Some(pixels)
}

/// The next line, without its end. Its comments may be in any encoding.
fn line<'a>(rest: &mut &'a [u8]) -> Option<Cow<'a, str>> {
    let end = rest.iter().take(MAX_HEADER).position(|b| *b == b'\n')?;
    let text = &rest[..end];
    *rest = &rest[end + 1..];
    Some(String::from_utf8_lossy(
        text.strip_suffix(b"\r").unwrap_or(text),
    ))
}

fn take<'a>(rest: &mut &'a [u8], count: usize) -> Option<&'a [u8]> {
    let (taken, left) = rest.split_at_checked(count)?;
    *rest = left;
    Some(taken)
}

fn scan_line(rest: &mut &[u8], row: &mut [[u8; 4]]) -> Option<()> {
    let width = row.len();
    match rest.get(..4)? {
        // The mark of a line whose components are stored one after another, with its width.
        &[2, 2, high, low] if high < 128 => {
            *rest = &rest[4..];
            let said = usize::from(high) << 8 | usize::from(low);
            if said != width {
                return None;
            }
            (0..4).try_for_each(|component| run_lengths(rest, row, component))
        }
        _ => old_scan_line(rest, row),
    }
}

/// One component of a row, in runs (a count above 128 and a value) and literals (a count and that many values).
fn run_lengths(rest: &mut &[u8], row: &mut [[u8; 4]], component: usize) -> Option<()> {
    let mut at = 0;
    while at < row.len() {
        let count = usize::from(take(rest, 1)?[0]);
        let is_run = count > 128;
        let count = if is_run { count - 128 } else { count };
        let values = take(rest, if is_run { 1 } else { count })?;
        let pixels = row.get_mut(at..at + count).filter(|_| count > 0)?;
        for (k, pixel) in pixels.iter_mut().enumerate() {
            pixel[component] = values[if is_run { 0 } else { k }];
        }
        at += count;
    }
    Some(())
}

/// Pixels one by one; (1, 1, 1, n) repeats the previous one n times, and 256 n times after another such code.
fn old_scan_line(rest: &mut &[u8], row: &mut [[u8; 4]]) -> Option<()> {
    let (mut at, mut shift) = (0, 0);
    while at < row.len() {
        let pixel: [u8; 4] = take(rest, 4)?.try_into().ok()?;
        if let [1, 1, 1, count] = pixel {
            let count = usize::from(count).checked_shl(shift)?;
            let before = row[at.checked_sub(1)?];
            row.get_mut(at..at.checked_add(count)?)?.fill(before);
            at += count;
            shift += 8;
            // Counts of 0 could continue as long as there are bytes; this stops them, too.
            if shift > 24 {
                return None;
            }
        } else {
            row[at] = pixel;
            at += 1;
            shift = 0;
        }
    }
    Some(())
}

fn linear([r, g, b, e]: [u8; 4], factors: &Factors) -> [f32; 3] {
    if e == 0 {
        return [0.0; 3];
    }
    // The exponent's bias is 128, and mantissas are in units of 1/256; each stands for the middle of its step.
    let scale = libm::exp2f(f32::from(e) - 136.0) / factors.exposure;
    let [cr, cg, cb] = factors.corrections;
    [(r, cr), (g, cg), (b, cb)].map(|(m, c)| (f32::from(m) + 0.5) * scale / c)
}

#[cfg(test)]
mod tests;
