//! Isochrones: the retarded time of every pixel as a coloured picture with a legend.
//!
//! Each pixel of a photograph shows its surface at the time when the light left it; lines of equal
//! time are isochrones (Figure 2 of Jarabo et al., CGF 34(8), 2015). Colours run from early (dark) to
//! late (bright) over the range of the picture; lines are drawn at round steps, every fifth heavier, by
//! linear interpolation between pixel centres, and stop where one surface hides another. Pixels in which
//! nothing was seen (NaN) are pale grey. The legend has the time both as ct in metres and in seconds.
//!
//! Far outliers, such as a floor that extends to the horizon, do not compress the rest: the range then ends before them, an arrow on the
//! legend shows that there is more, and no lines are drawn beyond it. Lines that would be too close together are left out, except heavy
//! ones that are far enough apart.
//!
//! [`flash_times`] gives other times to draw: the arrival of the light of one flash.
//!
//! [`draw_radiance`] draws luminance the same way: colours and lines by its logarithm, the legend by its value.

pub(crate) mod chain;
pub(crate) mod contour;
mod flash;
mod legend;
pub(crate) mod lines;
mod page;
mod picture;
pub(crate) mod range;
pub(crate) mod viridis;

use crate::error::{Error, Result};
use crate::io::image::RgbImage;

pub use flash::{NEEDED as FLASH_NEEDS, flash_times, title as flash_title};
use page::Page;
use range::Range;

/// The most isochrones that a picture can have.
const MAX_LINES: f64 = 1000.0;

/// Options of isochrones.
#[derive(Debug, Clone, PartialEq)]
pub struct IsochroneOptions {
    /// ct between two lines, metres; `None` for a round number that gives 10 to 80 lines.
    pub step: Option<f64>,
    /// The range of the colours, metres of ct, earliest first; `None` for the range of the image.
    pub range: Option<[f64; 2]>,
    /// Speed of light, metres per second, for the legend's seconds.
    pub speed_of_light: f64,
    /// Above the picture.
    pub title: String,
}

/// The quantity of values and legend.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Values {
    /// ct in metres; the speed of light in metres per second.
    Times(f64),
    /// Logarithms of luminances to the base 10.
    Luminances,
}

/// Draws the luminance of linear sRGB `pixels` (row 0 at the top; those without any are pale grey): colours over its logarithm, lines at
/// equal ratios, and a legend with its values, in the units of the radiance. They span `range`, or the range of the picture.
///
/// # Errors
/// As [`draw`].
pub fn draw_radiance(
    width: u32,
    height: u32,
    pixels: &[[f64; 3]],
    title: &str,
    range: Option<[f64; 2]>,
) -> Result<RgbImage> {
    let logarithm = |[r, g, b]: &[f64; 3]| {
        // Y of sRGB; 0, negative and infinite ones have no place on the scale.
        let y = 0.2126390058715103 * r + 0.7151686787677559 * g + 0.0721923153607337 * b;
        match y > 0.0 && y.is_finite() {
            true => libm::log10(y),
            false => f64::NAN,
        }
    };
    let values: Vec<f64> = pixels.iter().map(logarithm).collect();
    let options = IsochroneOptions {
        title: title.into(),
        range: range.map(|range| range.map(libm::log10)),
        ..IsochroneOptions::default()
    };
    check(width, height, &values, &options)?;
    let range = match options.range {
        Some(span) => Some(Range::spanning(span, &values, None)),
        None => Range::of(&values, None),
    };
    let page = Page::lay_out(width, height, range, &options.title, Values::Luminances)?;
    page.draw(&values, &options)
}

impl Default for IsochroneOptions {
    /// An automatic step, and light in vacuum.
    fn default() -> Self {
        IsochroneOptions {
            step: None,
            range: None,
            speed_of_light: crate::spacetime::SPEED_OF_LIGHT,
            title: "When the light left: retarded time".into(),
        }
    }
}

/// Draws `ct`, the retarded time of each pixel in metres (row 0 at the top, NaN where nothing is seen).
///
/// A small picture is enlarged by a whole factor, so that its lines and the legend can be read.
///
/// # Errors
/// A size that is 0, too large or not that of `ct`; a step that is not above 0 or gives more than 1000
/// lines; a range that spans nothing; a speed of light that is not above 0; characters in the title that the font does not have.
pub fn draw(width: u32, height: u32, ct: &[f64], options: &IsochroneOptions) -> Result<RgbImage> {
    check(width, height, ct, options)?;
    let range = match options.range {
        Some(span) => Some(Range::spanning(span, ct, options.step)),
        None => Range::of(ct, options.step),
    };
    let lines = range.map_or(0.0, |range| range.line_count());
    if lines.is_nan() || lines > MAX_LINES {
        let what = format!(
            "a step of {} m gives {lines:.0} isochrones",
            options.step.unwrap_or_default()
        );
        let help = format!("at most {MAX_LINES} isochrones: a larger step");
        return Err(Error::invalid("isochrones", "step", what, help));
    }
    let values = Values::Times(options.speed_of_light);
    Page::lay_out(width, height, range, &options.title, values)?.draw(ct, options)
}

fn check(width: u32, height: u32, ct: &[f64], options: &IsochroneOptions) -> Result<()> {
    let refuse = |place: &str, what: String| Err(Error::invalid("isochrones", place, what, ""));
    let pixels = u64::from(width) * u64::from(height);
    if pixels == 0 || pixels != ct.len() as u64 {
        let what = format!("{} values for {width} × {height} pixels", ct.len());
        return refuse("", what);
    }
    let above_zero = |x: f64| x > 0.0 && x.is_finite();
    if let Some(step) = options.step.filter(|&step| !above_zero(step)) {
        return refuse("step", format!("{step} m is not a step above 0"));
    }
    let spans = |[low, high]: [f64; 2]| low < high && (high - low).is_finite();
    if let Some([low, high]) = options.range.filter(|range| !spans(*range)) {
        return refuse("range", format!("{low} m to {high} m span nothing"));
    }
    if !above_zero(options.speed_of_light) {
        let what = format!("{} m/s is not a speed of light", options.speed_of_light);
        return refuse("speed of light", what);
    }
    Ok(())
}
