//! Isochrones as lines.

use super::Polyline;
use crate::error::{Error, Result};
use crate::figures::isochrones::contour::Grid;
use crate::figures::isochrones::lines::{is_heavy, isochrones};
use crate::figures::isochrones::range::Range;
use crate::figures::ticks::{Unit, number, round_step};

/// The factor on the step of a picture of isochrones only.
const COARSER: f64 = 2.5;
/// The most isochrones.
const MOST: f64 = 1000.0;
/// The least distance between neighbouring lines, as a part of the picture's longer side.
const CLOSEST: f64 = 1.0 / 120.0;

/// Lines of equal retarded time.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Isochrones {
    /// ct between neighbours, metres.
    pub step: f64,
    /// By time.
    pub lines: Vec<Isochrone>,
}

/// One line of equal retarded time.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Isochrone {
    /// World time of the emission × c, metres.
    pub ct: f64,
    /// Whether it is one of every five.
    pub is_heavy: bool,
    /// Its time with unit: "−8.5 m".
    pub label: String,
    /// In pixels of the film.
    pub lines: Vec<Polyline>,
}

impl Isochrones {
    /// The isochrones of times `ct`, metres (NaN for none); `None` if no time is finite.
    pub(super) fn trace(
        size: [u32; 2],
        ct: &[f64],
        step: Option<f64>,
    ) -> Result<Option<Isochrones>> {
        let Some(range) = coarse(ct, step) else {
            return Ok(None);
        };
        check(&range)?;
        let [width, height] = size.map(|side| side as usize);
        let grid = Grid { width, height, ct };
        // Densities are per pixel, and lines may be CLOSEST parts of the longer side apart.
        let crowded = 1.0 / (CLOSEST * f64::from(size[0].max(size[1])));
        let unit = Unit::metres(range.low.abs().max(range.high.abs()));
        let lines = isochrones(&grid, &range, crowded).into_iter();
        let lines = lines.map(|isochrone| {
            let ct = isochrone.number as f64 * range.step;
            let value = number(unit.count(ct), unit.count(range.step));
            Isochrone {
                ct,
                is_heavy: is_heavy(isochrone.number),
                label: format!("{value} {}", unit.name),
                lines: isochrone.lines,
            }
        });
        Ok(Some(Isochrones {
            step: range.step,
            lines: lines.filter(|line| !line.lines.is_empty()).collect(),
        }))
    }
}

fn coarse(ct: &[f64], step: Option<f64>) -> Option<Range> {
    let range = Range::of(ct, step)?;
    Some(match step {
        Some(_) => range,
        None => Range {
            step: round_step(COARSER * range.step),
            ..range
        },
    })
}

fn check(range: &Range) -> Result<()> {
    let count = range.line_count();
    if range.step > 0.0 && count <= MOST {
        return Ok(());
    }
    let what = format!("a step of {} m gives {count:.0} isochrones", range.step);
    let help = format!("more than 0, and at most {MOST} isochrones: a larger step");
    Err(Error::invalid("overlay", "step", what, help))
}
