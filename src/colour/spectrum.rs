//! Spectra of light sources, and the colours in which a moving observer sees them.
//!
//! A spectrum is a radiance (or intensity, or irradiance) per wavelength L(λ) in the rest frame of its source. An observer for whom all
//! its wavelengths are multiplied by W sees
//!
//! ```text
//! L′(λ) = W⁻⁵ L(λ/W),      c_j(W) = ∫ L′(λ) m_j(λ) dλ,      m = linear sRGB of (x̄, ȳ, z̄).
//! ```
//!
//! (L_ν/ν³ is invariant, and L_λ = L_ν |dν/dλ|; Weiskopf, Kraus, Ruder, ACM TOG 18(3), 1999.) So
//!
//! - a line of energy E at λ₀ has c = W⁻⁴ E m(W λ₀), since δ(λ/W − λ₀) = W δ(λ − W λ₀);
//! - a blackbody of temperature T is seen as one of temperature T/W: W⁻⁵ B(λ/W; T) = B(λ; T/W), as Planck's exponential depends on λT
//!   alone;
//! - RGB is `white · Σ b_i`, with three weights b_i that add up to 1 ([`rgb_basis`](super::rgb_basis)).
//!
//! A surface with the reflectance Σ r_k b_k under the light of a spectrum has the colour Σ_k R_jk(W) r_k, R_jk(W) = ∫ L′(λ) b_k(λ) m_j(λ)
//! dλ: [`Spectrum::reflected_at`]. Under the white at rest, R is the unit matrix.
//!
//! Integrals use three-point Gauss quadrature between all knots of observer and spectrum: exact for functions that are linear between
//! knots (products of three are cubic), and to 1e-12 for Planck's law over 1 nm.
//!
//! Luminance is in units of that of linear RGB (1, 1, 1): ∫ L ȳ dλ with L per metre.

use std::sync::LazyLock;

use super::observer::{FIRST, LAST, colour_matching};
use super::planck::{planck, planck_total};
use super::rgb_basis::{self, Continuation};
use super::rgb_from_xyz;
use super::sampled::{Line, Wavelengths, per_wavelength_power};

/// Points of Gauss on [0, 1], and their weights.
const GAUSS: [(f64, f64); 3] = [
    (0.112_701_665_379_258_31, 5.0 / 18.0),
    (0.5, 8.0 / 18.0),
    (0.887_298_334_620_741_7, 5.0 / 18.0),
];

/// Where a Gaussian ends, in standard deviations: below 1e-14 of its peak.
const GAUSSIAN_REACH: f64 = 8.0;

/// Knots of a Gaussian per standard deviation: three points between two of them integrate it to 1e-10.
const GAUSSIAN_KNOTS: u32 = 4;

/// The distribution of a spectrum's energy over wavelengths (metres, in the rest frame of the source).
#[derive(Debug, Clone, PartialEq)]
pub enum SpectrumShape {
    /// Spectral lines: wavelength and energy of each.
    Lines(Vec<[f64; 2]>),
    /// Planck's law at a temperature in kelvin, W m⁻² sr⁻¹ per metre.
    Blackbody(f64),
    /// A Gaussian of energy 1.
    Gaussian {
        /// The wavelength of its peak.
        centre: f64,
        /// Standard deviation.
        sigma: f64,
    },
    /// Wavelengths, ascending, and the values per metre there; linear between, 0 beyond.
    Table(Vec<[f64; 2]>),
    /// Linear sRGB, and its continuation outside 360 to 830 nm.
    Rgb([f64; 3], Continuation),
    /// Another shape behind a filter at rest with its source, which transmits red, green and blue by these factors.
    Filtered(Box<SpectrumShape>, [f64; 3]),
}

/// The scale of a shape's values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Scale {
    /// This factor.
    Factor(f64),
    /// The factor that gives this luminance at rest.
    Luminance(f64),
    /// The factor that gives this sum over all wavelengths.
    Total(f64),
}

/// A spectrum, in the rest frame of its source.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrum {
    shape: SpectrumShape,
    factor: f64,
}

impl Spectrum {
    /// A spectrum of this shape, scaled; `None` if the scale is impossible: a luminance if nothing is visible at rest, or the sum of a
    /// spectrum without an end.
    pub fn new(shape: SpectrumShape, scale: Scale) -> Option<Spectrum> {
        let unscaled = Spectrum::unscaled(shape);
        let factor = match scale {
            Scale::Factor(factor) => factor,
            Scale::Luminance(wanted) => wanted / unscaled.xyz_at(1.0)[1],
            Scale::Total(wanted) => wanted / unscaled.total()?,
        };
        // A luminance of 0 at rest gives an infinite or NaN factor.
        (factor.is_finite() && factor >= 0.0).then_some(Spectrum { factor, ..unscaled })
    }

    /// A spectrum with the shape's own values.
    pub(super) fn unscaled(shape: SpectrumShape) -> Spectrum {
        Spectrum { shape, factor: 1.0 }
    }

    /// Linear sRGB, as it is seen at rest.
    pub fn rgb(rgb: [f64; 3], continuation: Continuation) -> Spectrum {
        Spectrum::unscaled(SpectrumShape::Rgb(rgb, continuation))
    }

    /// The distribution of the energy.
    pub fn shape(&self) -> &SpectrumShape {
        &self.shape
    }

    /// The factor on the shape's values.
    pub fn factor(&self) -> f64 {
        self.factor
    }

    /// The same spectrum, `factor` times as bright.
    pub fn scaled(&self, factor: f64) -> Spectrum {
        Spectrum {
            shape: self.shape.clone(),
            factor: self.factor * factor,
        }
    }

    /// The same spectrum behind a filter at rest with its source, which transmits red, green and blue by these factors: Σ c_j b_j(λ) L(λ).
    pub fn filtered(&self, rgb: [f64; 3]) -> Spectrum {
        let [r, g, b] = rgb;
        if r == g && g == b {
            return self.scaled(r);
        }
        let shape = match &self.shape {
            SpectrumShape::Lines(lines) => {
                let behind = |&[wavelength, energy]: &[f64; 2]| {
                    [wavelength, energy * rgb_basis::reflectance(wavelength, rgb)]
                };
                SpectrumShape::Lines(lines.iter().map(behind).collect())
            }
            other => SpectrumShape::Filtered(Box::new(other.clone()), rgb),
        };
        Spectrum {
            shape,
            factor: self.factor,
        }
    }

    /// L(λ), per metre, at a wavelength in metres; 0 for lines, which have none.
    pub fn per_wavelength(&self, wavelength: f64) -> f64 {
        self.factor * self.shape.per_wavelength(wavelength)
    }

    /// W⁻⁵ L(λ/W) at each of `wavelengths` of an observer for whom they are multiplied by `w`; 0 for lines.
    #[inline]
    pub(crate) fn at(&self, w: f64, wavelengths: Wavelengths) -> [f64; 3] {
        let scale = self.factor * per_wavelength_power(w);
        wavelengths.map(|l| scale * self.shape.per_wavelength(l / w))
    }

    /// Its lines, if it consists of lines.
    #[inline]
    pub(crate) fn lines(&self) -> impl Iterator<Item = Line> {
        let lines = match &self.shape {
            SpectrumShape::Lines(lines) => lines.as_slice(),
            SpectrumShape::Blackbody(_)
            | SpectrumShape::Gaussian { .. }
            | SpectrumShape::Table(_)
            | SpectrumShape::Rgb(..)
            | SpectrumShape::Filtered(..) => &[],
        };
        lines.iter().map(|&[wavelength, energy]| Line {
            wavelength,
            energy: self.factor * energy,
        })
    }

    /// Whether it consists of lines, which have no width.
    #[inline]
    pub(crate) fn is_of_lines(&self) -> bool {
        matches!(self.shape, SpectrumShape::Lines(_))
    }

    /// The sum over all wavelengths: ∫ L dλ. `None` for RGB, whose continuation need not have one, and behind filters.
    pub fn total(&self) -> Option<f64> {
        let total = match &self.shape {
            SpectrumShape::Lines(lines) => lines.iter().map(|[_, energy]| energy).sum(),
            SpectrumShape::Blackbody(t) => planck_total(*t),
            SpectrumShape::Gaussian { .. } => 1.0,
            SpectrumShape::Table(rows) => {
                let trapezium =
                    |pair: &[[f64; 2]]| (pair[1][0] - pair[0][0]) * 0.5 * (pair[0][1] + pair[1][1]);
                rows.windows(2).map(trapezium).sum()
            }
            SpectrumShape::Rgb(..) | SpectrumShape::Filtered(..) => return None,
        };
        Some(self.factor * total)
    }

    /// CIE XYZ of the spectrum seen with wavelengths times `w`.
    pub fn xyz_at(&self, w: f64) -> [f64; 3] {
        match self.thermal_at(w) {
            Some(temperature) => self.thermal_sums(temperature, |node| node.xyz),
            None => self.seen_at(w, colour_matching),
        }
    }

    /// Linear sRGB of the spectrum seen with wavelengths times `w`; below 0 outside the gamut.
    pub fn colour_at(&self, w: f64) -> [f64; 3] {
        rgb_from_xyz(self.xyz_at(w))
    }

    /// R(W): linear sRGB (rows) of surfaces with the reflectances of linear red, green and blue (columns), under this spectrum with
    /// wavelengths times `w`.
    pub fn reflected_at(&self, w: f64) -> [[f64; 3]; 3] {
        let products = match self.thermal_at(w) {
            Some(temperature) => self.thermal_sums(temperature, |node| node.reflected),
            None => self.seen_at(w, reflected),
        };
        let column = |k: usize| rgb_from_xyz([products[k], products[3 + k], products[6 + k]]);
        let columns = [0, 1, 2].map(column);
        std::array::from_fn(|j| std::array::from_fn(|k| columns[k][j]))
    }

    /// The temperature of the blackbody as seen, T/W: no factor that could overflow.
    fn thermal_at(&self, w: f64) -> Option<f64> {
        match &self.shape {
            SpectrumShape::Blackbody(t) if w > 0.0 && w.is_finite() => Some(t / w),
            _ => None,
        }
    }

    /// ∫ L′(λ) f(λ) dλ for a blackbody that is seen with `temperature`, and an f whose values at the nodes of all such integrals are
    /// known.
    fn thermal_sums<const N: usize>(
        &self,
        temperature: f64,
        f: impl Fn(&Node) -> [f64; N],
    ) -> [f64; N] {
        let mut sums = [0.0; N];
        for node in NODES.iter() {
            let radiance = self.factor * planck(node.wavelength, temperature);
            node.add(&mut sums, radiance, f(node));
        }
        sums
    }

    /// ∫ L′(λ) f(λ) dλ for a function of the observer, `w` being W.
    fn seen_at<const N: usize>(&self, w: f64, f: impl Fn(f64) -> [f64; N]) -> [f64; N] {
        if !(w > 0.0 && w.is_finite()) {
            return [0.0; N];
        }
        match &self.shape {
            SpectrumShape::Lines(lines) => {
                // W⁻⁵ of the radiance, times the W of δ(λ/W − λ₀).
                let scale = self.factor / (w * w * w * w);
                lines.iter().fold([0.0; N], |sum, [wavelength, energy]| {
                    let seen = f(wavelength * w);
                    std::array::from_fn(|k| sum[k] + scale * energy * seen[k])
                })
            }
            shape => {
                let scale = self.factor / (w * w * w * w * w);
                integrate(&shape.knots(w), |l| {
                    let radiance = scale * shape.per_wavelength(l / w);
                    f(l).map(|f| f * radiance)
                })
            }
        }
    }
}

impl SpectrumShape {
    /// As [`Spectrum::per_wavelength`].
    fn per_wavelength(&self, wavelength: f64) -> f64 {
        match self {
            SpectrumShape::Lines(_) => 0.0,
            SpectrumShape::Blackbody(t) => planck(wavelength, *t),
            SpectrumShape::Gaussian { centre, sigma } => {
                let x = (wavelength - centre) / sigma;
                libm::exp(-0.5 * x * x) / (sigma * std::f64::consts::TAU.sqrt())
            }
            SpectrumShape::Table(rows) => between(rows, wavelength),
            SpectrumShape::Rgb(rgb, continuation) => {
                let basis = rgb_basis::radiances(wavelength, *continuation);
                rgb[0] * basis[0] + rgb[1] * basis[1] + rgb[2] * basis[2]
            }
            SpectrumShape::Filtered(light, rgb) => {
                light.per_wavelength(wavelength) * rgb_basis::reflectance(wavelength, *rgb)
            }
        }
    }

    /// The shape without the filters before it.
    pub(crate) fn unfiltered(&self) -> &SpectrumShape {
        match self {
            SpectrumShape::Filtered(light, _) => light.unfiltered(),
            own => own,
        }
    }

    /// Wavelengths between which the spectrum is smooth, times `w`.
    fn knots(&self, w: f64) -> Vec<f64> {
        match self {
            SpectrumShape::Lines(_) | SpectrumShape::Blackbody(_) => Vec::new(),
            SpectrumShape::Gaussian { centre, sigma } => {
                let steps = 2 * GAUSSIAN_REACH as u32 * GAUSSIAN_KNOTS;
                let knot = |k| f64::from(k) / f64::from(GAUSSIAN_KNOTS) - GAUSSIAN_REACH;
                (0..=steps)
                    .map(|k| w * (centre + sigma * knot(k)))
                    .collect()
            }
            SpectrumShape::Table(rows) => rows.iter().map(|row| w * row[0]).collect(),
            SpectrumShape::Rgb(..) => rgb_basis::knots().map(|knot| w * knot).collect(),
            SpectrumShape::Filtered(light, _) => {
                let mut knots = light.knots(w);
                knots.extend(rgb_basis::knots().map(|knot| w * knot));
                knots.sort_unstable_by(f64::total_cmp);
                knots
            }
        }
    }
}

/// Linear between rows of ascending first elements, 0 beyond the first and the last.
fn between(rows: &[[f64; 2]], at: f64) -> f64 {
    let after = rows.partition_point(|row| row[0] < at);
    match (after.checked_sub(1).map(|k| rows[k]), rows.get(after)) {
        (Some([x0, y0]), Some([x1, y1])) => y0 + (y1 - y0) * ((at - x0) / (x1 - x0)),
        // At the first row itself nothing is before it.
        (None, Some([x, y])) if *x == at => *y,
        _ => 0.0,
    }
}

/// x̄, ȳ, z̄ (rows) of the light that linear red, green and blue surfaces (columns) reflect at a wavelength.
fn reflected(wavelength: f64) -> [f64; 9] {
    let basis = rgb_basis::weights(wavelength);
    let xyz = colour_matching(wavelength);
    std::array::from_fn(|k| xyz[k / 3] * basis[k % 3])
}

/// A wavelength at which integrals evaluate spectra without knots, with the observer's functions there.
pub(super) struct Node {
    pub(super) wavelength: f64,
    weight: f64,
    pub(super) xyz: [f64; 3],
    reflected: [f64; 9],
}

impl Node {
    /// Adds its part of ∫ L f dλ for the radiance L and f at its wavelength, with products in the order of [`add_panel`]: both round alike.
    #[inline]
    pub(super) fn add<const N: usize>(&self, sums: &mut [f64; N], radiance: f64, f: [f64; N]) {
        for (sum, f) in sums.iter_mut().zip(f) {
            *sum += self.weight * (f * radiance);
        }
    }
}

/// The panels of integrals: the nodes of each, and the wavelengths between which it is.
pub(super) fn panels() -> impl Iterator<Item = (&'static [Node; GAUSS.len()], [f64; 2])> {
    let ends = |k: usize| [k, k + 1].map(|k| f64::from(FIRST as u32 + k as u32) * 1e-9);
    let panels = NODES.as_chunks().0.iter().enumerate();
    panels.map(move |(k, nodes)| (nodes, ends(k)))
}

/// All of them, in the order of [`integrate`].
static NODES: LazyLock<Vec<Node>> = LazyLock::new(|| {
    let mut nodes = Vec::new();
    let mut from = FIRST * 1e-9;
    for nanometre in FIRST as u32 + 1..=LAST as u32 {
        // From the whole nanometre, as in `integrate`: no rounding adds up, and both have the same nodes.
        let to = f64::from(nanometre) * 1e-9;
        let width = to - from;
        nodes.extend(GAUSS.map(|(at, weight)| {
            let wavelength = from + width * at;
            Node {
                wavelength,
                weight: width * weight,
                xyz: colour_matching(wavelength),
                reflected: reflected(wavelength),
            }
        }));
        from = to;
    }
    nodes
});

/// ∫ f dλ over the wavelengths that the observer sees (metres), between whose knots and `knots`, which ascend, f is
/// smooth.
pub(super) fn integrate<const N: usize>(knots: &[f64], f: impl Fn(f64) -> [f64; N]) -> [f64; N] {
    let (first, last) = (FIRST * 1e-9, LAST * 1e-9);
    // Wavelengths below the observer's range are not visible, and make no panel.
    let begin = knots.partition_point(|knot| *knot <= first);
    let mut own = knots[begin..].iter().copied().peekable();
    let mut sum = [0.0; N];
    let mut from = first;
    for nanometre in FIRST as u32 + 1..=LAST as u32 {
        let to = f64::from(nanometre) * 1e-9;
        while let Some(knot) = own.next_if(|knot| *knot < to) {
            add_panel(&mut sum, from, knot, &f);
            from = knot;
        }
        add_panel(&mut sum, from, to, &f);
        from = to;
    }
    debug_assert!(from == last);
    sum
}

/// Adds ∫ f between two knots.
#[inline]
pub(super) fn add_panel<const N: usize>(
    sum: &mut [f64; N],
    from: f64,
    to: f64,
    f: impl Fn(f64) -> [f64; N],
) {
    let width = to - from;
    for (at, weight) in GAUSS {
        let value = f(from + width * at);
        for (sum, value) in sum.iter_mut().zip(value) {
            *sum += width * weight * value;
        }
    }
}

#[cfg(test)]
mod tests;
