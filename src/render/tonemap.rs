//! Linear radiance → 8-bit or 16-bit sRGB.
//!
//! Radiance is divided by the white radiance. Colours above white move towards white instead of being clipped per component, which would
//! turn a bright blue to magenta: with m > 1 the largest component of c, the result is c/m + (1 − 1/m)(1 − c/m). That is c itself at m =
//! 1, keeps the hue, and tends to white. A neutral colour is simply clipped.
//!
//! A component below 0 is a colour outside the gamut. It is mixed with white until no component is negative: c becomes Y + t (c − Y),
//! with Y the luminance and t = Y/(Y − least component). That keeps luminance and hue (the direction from white in the chromaticity
//! diagram). Colours without luminance are black.
//!
//! On a logarithmic scale from b (black) to w (white), the code of the largest component m is ln (m/b)/ln (w/b) of the maximum, so that
//! equal ratios are equal steps of code; the other components keep their ratios to it as light.

use crate::colour::{srgb_decode, srgb_encode_8, srgb_encode_16};
use crate::error::{Error, Result};
use crate::scene::model::Exposure;

/// A conspicuous colour for pixels that are NaN: magenta.
pub(crate) const NOT_A_NUMBER: [u8; 3] = [255, 0, 255];

/// A display picture, and its scale.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Display {
    /// 8-bit sRGB, 3 bytes per pixel.
    pub rgb: Vec<u8>,
    /// The radiance that became white. 1 if a percentile was requested for an image without a lit pixel.
    pub white: f64,
    /// The radiance that became black, on a logarithmic scale.
    pub black: Option<f64>,
}

/// Shows linear RGB `pixels`.
///
/// A percentile p is a nearest-rank one: of the n pixels whose brightest component, as displayed, is above 0 and finite, in ascending
/// order of that component, the ⌈p n / 100⌉-th becomes white. Colours outside the gamut count as displayed, infinite components are
/// white, and a pixel with NaN is magenta.
///
/// # Errors
/// A percentile outside (0, 100], a white that is not above 0 and finite.
pub fn tonemap<T: Copy + Into<f64>>(pixels: &[[T; 3]], exposure: Exposure) -> Result<Display> {
    let scale = Scale::of(pixels, exposure)?;
    let code =
        |p: &[T; 3]| show(p.map(Into::into), scale).map_or(NOT_A_NUMBER, |p| p.map(srgb_encode_8));
    Ok(Display {
        rgb: pixels.iter().flat_map(code).collect(),
        white: scale.white,
        black: scale.black,
    })
}

/// The same in 16 bits: sRGB codes, 3 per pixel, and the radiances that became white and, on a logarithmic scale, black.
///
/// # Errors
/// As [`tonemap`].
pub fn tonemap_16<T: Copy + Into<f64>>(
    pixels: &[[T; 3]],
    exposure: Exposure,
) -> Result<(Vec<u16>, f64, Option<f64>)> {
    let scale = Scale::of(pixels, exposure)?;
    let code = |p: &[T; 3]| match show(p.map(Into::into), scale) {
        Some(rgb) => rgb.map(srgb_encode_16),
        None => NOT_A_NUMBER.map(|code| u16::from(code) * 257),
    };
    let codes = pixels.iter().flat_map(code).collect();
    Ok((codes, scale.white, scale.black))
}

/// The radiance that becomes white.
///
/// # Errors
/// As [`tonemap`].
pub fn white<T: Copy + Into<f64>>(pixels: &[[T; 3]], exposure: Exposure) -> Result<f64> {
    match exposure {
        Exposure::White(white) if white > 0.0 && white.is_finite() => Ok(white),
        Exposure::White(white) => Err(wrong(format!("{white} as the radiance of white"))),
        Exposure::Percentile(p) if p > 0.0 && p <= 100.0 => Ok(percentile(pixels, p)),
        Exposure::Percentile(p) => Err(wrong(format!("a percentile of {p}"))),
        Exposure::Logarithmic([black, white])
            if 0.0 < black && black < white && white.is_finite() =>
        {
            Ok(white)
        }
        Exposure::Logarithmic([black, white]) => Err(wrong(format!(
            "{black} and {white} as the radiances of black and white"
        ))),
    }
}

/// From radiance to the display.
#[derive(Clone, Copy)]
struct Scale {
    white: f64,
    /// Black on a logarithmic scale; `None` on a linear one.
    black: Option<f64>,
}

impl Scale {
    fn of<T: Copy + Into<f64>>(pixels: &[[T; 3]], exposure: Exposure) -> Result<Scale> {
        let black = match exposure {
            Exposure::Logarithmic([black, _]) => Some(black),
            _ => None,
        };
        Ok(Scale {
            white: white(pixels, exposure)?,
            black,
        })
    }
}

fn wrong(what: String) -> Error {
    let help = "a percentile in (0, 100], or a radiance above 0";
    Error::invalid("exposure", "", what, help)
}

fn percentile<T: Copy + Into<f64>>(pixels: &[[T; 3]], p: f64) -> f64 {
    // As displayed: monochromatic light is far outside the gamut, and has components far above those that a display can show of it.
    let shown = |pixel: &[T; 3]| {
        let rgb = pixel.map(Into::into);
        let is_number = rgb.iter().all(|c| !c.is_nan());
        is_number.then(|| brightest(within_gamut(rgb)))
    };
    let brightest = pixels.iter().filter_map(shown);
    let mut lit: Vec<f64> = brightest.filter(|&x| x > 0.0 && x.is_finite()).collect();
    if lit.is_empty() {
        return 1.0;
    }
    // 99.9 % of 1000 pixels is the 999th, though the product is 999.0000000000001.
    let rank = (p * lit.len() as f64 / 100.0 * (1.0 - 1e-12)).ceil();
    let index = (rank as usize).clamp(1, lit.len()) - 1;
    *lit.select_nth_unstable_by(index, f64::total_cmp).1
}

/// The largest component; NaN if any is NaN.
fn brightest(rgb: [f64; 3]) -> f64 {
    let larger = |a: f64, b: f64| if a.is_nan() || a > b { a } else { b };
    larger(larger(rgb[0], rgb[1]), rgb[2])
}

/// Linear light of the display, in [0, 1]; `None` for NaN.
fn show(rgb: [f64; 3], Scale { white, black }: Scale) -> Option<[f64; 3]> {
    if rgb.iter().any(|c| c.is_nan()) {
        return None;
    }
    let rgb = within_gamut(rgb).map(|c| c / white);
    let m = brightest(rgb);
    if let Some(black) = black.filter(|_| m <= 1.0) {
        let part = 1.0 - libm::log(m) / libm::log(black / white);
        let factor = match part > 0.0 {
            true => srgb_decode(part) / m,
            false => 0.0,
        };
        return Some(rgb.map(|c| c * factor));
    }
    if m <= 1.0 {
        return Some(rgb);
    }
    let excess = 1.0 - 1.0 / m;
    Some(rgb.map(|c| {
        let c = if m.is_finite() { c / m } else { 1.0 };
        c + excess * (1.0 - c)
    }))
}

/// Luminance of linear sRGB (the middle row of the matrix from its primaries to XYZ).
fn luminance([r, g, b]: [f64; 3]) -> f64 {
    0.2126390058715103 * r + 0.7151686787677559 * g + 0.0721923153607337 * b
}

/// A colour without components below 0, of the same luminance and hue.
fn within_gamut(rgb: [f64; 3]) -> [f64; 3] {
    let least = rgb.into_iter().fold(f64::INFINITY, f64::min);
    // Nothing to do; and an infinite colour has no luminance to keep.
    if least >= 0.0 || rgb.iter().any(|c| c.is_infinite()) {
        return rgb.map(|c| c.max(0.0));
    }
    let y = luminance(rgb);
    if y <= 0.0 {
        return [0.0; 3];
    }
    let t = y / (y - least);
    rgb.map(|c| (y + t * (c - y)).max(0.0))
}

#[cfg(test)]
mod tests;
