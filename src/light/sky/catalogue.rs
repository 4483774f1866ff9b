//! Catalogues of stars: tables, and random catalogues.
//!
//! A star of magnitude m has the luminance E = scale · 10^(−0.4 m) and the colour of a blackbody of its temperature.
//! Random catalogues fill space uniformly with stars of equal luminosity: the number within r is as r³, and E ∝ r⁻², so N(<m) ∝ 10^(0.6 m)
//! (Seeliger 1898), which is close to the counts of naked-eye stars.

use std::path::Path;

use glam::DVec3;

use super::Star;
use crate::error::{Error, Result};
use crate::io::spectrum::rows_of;
use crate::scene::model::{Catalogue, Stars};

/// The maximum number of stars in a table.
const MOST: usize = 1_000_000;

/// The expected format.
const FORM: &str = "lines are x,y,z,magnitude,temperature: a direction, a magnitude from -30 to 30, 1000 to 100000 K";

/// The stars of a catalogue; `text` is its table, if it has one.
///
/// # Errors
/// Lines of a table that are not stars, and a table without stars.
pub fn stars(stars: &Stars, text: &str) -> Result<Vec<Star>> {
    match &stars.catalogue {
        Catalogue::Random {
            count,
            seed,
            faintest,
        } => Ok((0..u64::from(*count))
            .map(|k| random(stars.scale, u64::from(*seed) << 32 | k, *faintest))
            .collect()),
        Catalogue::File(path) => table(stars.scale, text, path),
    }
}

fn star(scale: f64, d: DVec3, magnitude: f64, temperature: f64) -> Star {
    // Five magnitudes are a factor of 100.
    Star::new(d, temperature, scale * libm::pow(10.0, -0.4 * magnitude))
}

fn random(scale: f64, key: u64, faintest: f64) -> Star {
    let number = |k: u64| {
        // SplitMix64.
        let x = (key.wrapping_mul(8).wrapping_add(k)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (((x ^ (x >> 31)) >> 11) as f64 + 0.5) / (1u64 << 53) as f64
    };
    // Uniform in height and longitude, and so in solid angle.
    let height = 2.0 * number(0) - 1.0;
    let (sine, cosine) = libm::sincos(std::f64::consts::TAU * number(1));
    let across = (1.0 - height * height).sqrt();
    let d = DVec3::new(sine * across, height, cosine * across);
    // N(<m)/N = 10^(0.6 (m − faintest)) = u.
    let magnitude = faintest + libm::log10(number(2)) / 0.6;
    // From 3000 to 12000 K, with more cool than hot stars.
    let u = number(3);
    star(scale, d, magnitude, 3000.0 * libm::pow(4.0, u * u))
}

fn table(scale: f64, text: &str, path: &Path) -> Result<Vec<Star>> {
    let mut stars = Vec::new();
    for (number, line) in rows_of(text) {
        let refuse = |what: &str| Error::invalid(path, format!("line {number}"), what, FORM);
        if line.contains(';') {
            return Err(refuse("semicolons between numbers, where commas are right"));
        }
        let numbers: Option<Vec<f64>> = line.split(',').map(|n| n.trim().parse().ok()).collect();
        let numbers = numbers.ok_or_else(|| refuse("not numbers between commas"))?;
        let [x, y, z, magnitude, temperature] = numbers[..] else {
            return Err(refuse("not five numbers"));
        };
        let d = DVec3::new(x, y, z).try_normalize();
        let d = d.ok_or_else(|| refuse("its direction has no length"))?;
        if !(magnitude.abs() <= 30.0 && (1e3..=1e5).contains(&temperature)) {
            return Err(refuse("its magnitude or temperature is out of range"));
        }
        if stars.len() == MOST {
            return Err(refuse("more than 1000000 stars"));
        }
        stars.push(star(scale, d, magnitude, temperature));
    }
    match stars.is_empty() {
        true => Err(Error::invalid(path, "", "a table without stars", FORM)),
        false => Ok(stars),
    }
}

#[cfg(test)]
mod tests;
