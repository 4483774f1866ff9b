//! Time shifts of a cube, pixel by pixel.
//!
//! A shift by s bins, which need not be an integer, moves bin k to [k + s, k + s + 1]. With i = ⌊s⌋ and f = s − i that covers two bins,
//! which get (1 − f) and f of its value: out_j = (1 − f) a_(j−i) + f a_(j−i−1). The sum of all bins is preserved, and their mean time
//! moves by exactly s, while a step is blurred over one more bin. It is the same for energies per bin and for densities.
//!
//! Unwarping subtracts the path from the time of arrival at a camera, t + η r with r the *distance* (along the ray, not the depth): s =
//! −η r/w for bins of width w. Warping adds it again. All shifts are made ≥ 0 by a whole number of bins that all pixels share, by which
//! the start of the data moves.

use std::ops::Range;
use std::path::Path;

use crate::error::{Error, Result};

/// The delay of each pixel's bins.
pub(super) struct Shifts<'a> {
    /// By pixel of the whole picture, in bins; `None` if nothing is shifted.
    by: Option<&'a [f64]>,
    /// Bins added to all shifts, so that none is below 0.
    pub ahead: i64,
    /// The largest shift, in whole bins, after that.
    pub largest: usize,
}

impl<'a> Shifts<'a> {
    /// The shifts of the rows and columns `kept` of a picture of the size `[h, w]`.
    ///
    /// # Errors
    /// A wrong number of shifts, none that is finite, or some that are longer than any cube.
    pub fn new(
        from: &Path,
        by: Option<&'a [f64]>,
        [h, w]: [usize; 2],
        kept: &[Range<usize>; 3],
    ) -> Result<Shifts<'a>> {
        /// More bins than any cube has.
        const MOST: f64 = 1e9;
        let refuse = |what: String, help: &str| Err(Error::invalid(from, "", what, help));
        let Some(shift) = by else {
            let (ahead, largest) = (0, 0);
            return Ok(Shifts { by, ahead, largest });
        };
        if shift.len() != h * w {
            let count = shift.len();
            let what = format!("{count} distances for a picture of {h} rows and {w} columns");
            return refuse(what, "give a distance per pixel of the whole picture");
        }
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        for row in kept[0].clone() {
            let shifts = &shift[row * w..][kept[1].clone()];
            for shift in shifts.iter().filter(|shift| shift.is_finite()) {
                (least, most) = (least.min(*shift), most.max(*shift));
            }
        }
        if !(least.abs() < MOST && most.abs() < MOST && most - least < MOST) {
            let what = match least > most {
                true => "no pixel has a distance".to_string(),
                false => format!("distances are {least:e} to {most:e} bins of light path"),
            };
            let help = "check the unit of the distances and of the bins' width";
            return refuse(what, help);
        }
        // A whole number of bins, so that fractions of bins stay the same.
        let ahead = -least.floor() as i64;
        let largest = (most + ahead as f64).ceil() as usize;
        Ok(Shifts { by, ahead, largest })
    }

    /// The delay of a pixel in whole bins, and the fraction of one; `None` if unknown.
    pub fn of(&self, pixel: usize) -> Option<(usize, f64)> {
        let Some(by) = self.by else {
            return Some((0, 0.0));
        };
        let shift = by[pixel];
        let shift = shift.is_finite().then_some(shift + self.ahead as f64)?;
        Some((shift as usize, shift - shift.floor()))
    }
}
