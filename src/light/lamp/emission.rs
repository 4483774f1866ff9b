//! The light of a lamp, or of an emissive surface, as a function of its proper time.

use std::f64::consts::{FRAC_1_SQRT_2, TAU};
use std::sync::LazyLock;

use crate::accel::vectors::{VectorLoop, dispatch};
use crate::scene::model::EmissionProfile;

/// Intensity as a function of proper time.
#[derive(Debug, Clone)]
pub(crate) enum Emission {
    Steady,
    /// `scale` times the density of a normal distribution.
    Gaussian {
        centre: f64,
        sigma: f64,
        scale: f64,
    },
    Train {
        centre: f64,
        sigma: f64,
        period: f64,
        count: f64,
    },
    Table(Table),
}

/// Linear between knots, 0 outside.
#[derive(Debug, Clone)]
pub(crate) struct Table {
    /// Times, ascending, and values.
    knots: Vec<[f64; 2]>,
    /// For each knot, the integral up to it.
    integrals: Vec<f64>,
}

impl From<&EmissionProfile> for Emission {
    fn from(profile: &EmissionProfile) -> Self {
        match profile {
            EmissionProfile::Steady => Emission::Steady,
            EmissionProfile::Gaussian { centre, sigma } => Emission::Gaussian {
                centre: *centre,
                sigma: *sigma,
                // 1 at the peak.
                scale: sigma * TAU.sqrt(),
            },
            EmissionProfile::Train {
                centre,
                sigma,
                period,
                count,
            } => Emission::Train {
                centre: *centre,
                sigma: *sigma,
                period: *period,
                count: count.map_or(f64::INFINITY, f64::from),
            },
            EmissionProfile::Table(knots) => Emission::Table(Table::new(knots.clone())),
        }
    }
}

impl Emission {
    /// Whether it is constant.
    pub(crate) fn is_steady(&self) -> bool {
        matches!(self, Emission::Steady)
    }

    /// The factor on the intensity at a proper time.
    #[inline]
    pub(crate) fn at(&self, proper_time: f64) -> f64 {
        match self {
            Emission::Steady => 1.0,
            Emission::Gaussian {
                centre,
                sigma,
                scale,
            } => gaussian((proper_time - centre) / sigma) / sigma * scale,
            Emission::Train {
                centre,
                sigma,
                period,
                count,
            } => train((proper_time - centre) / period, period / sigma, *count),
            Emission::Table(table) => table.at(proper_time),
        }
    }
}

impl Emission {
    /// Replaces each of `times` by [`Emission::at`] of it.
    pub(crate) fn at_each(&self, times: &mut [f64]) {
        match self {
            Emission::Steady => times.fill(1.0),
            Emission::Gaussian {
                centre,
                sigma,
                scale,
            } => dispatch(Gaussians {
                times,
                centre: *centre,
                sigma: *sigma,
                scale: *scale,
            }),
            Emission::Train { .. } | Emission::Table(_) => {
                times.iter_mut().for_each(|time| *time = self.at(*time));
            }
        }
    }

    /// The proper times between which it is not 0.
    pub(crate) fn span(&self) -> Option<[f64; 2]> {
        match self {
            Emission::Steady => None,
            Emission::Gaussian { centre, sigma, .. } => {
                Some([centre - CUT * sigma, centre + CUT * sigma])
            }
            Emission::Train {
                centre,
                sigma,
                period,
                count,
            } => {
                let last = centre + (count - 1.0) * period;
                last.is_finite()
                    .then(|| [centre - CUT * sigma, last + CUT * sigma])
            }
            Emission::Table(Table { knots, .. }) => Some([knots.first()?[0], knots.last()?[0]]),
        }
    }

    /// The standard deviation of its pulses; `None` if it has no pulses, and may have corners.
    pub(crate) fn sigma(&self) -> Option<f64> {
        match self {
            Emission::Gaussian { sigma, .. } | Emission::Train { sigma, .. } => Some(*sigma),
            Emission::Steady | Emission::Table(_) => None,
        }
    }

    /// The proper times of its first and last light, infinite for an infinite train of pulses; `None` if it neither begins nor pauses.
    pub(crate) fn lit_times(&self) -> Option<[f64; 2]> {
        let endless = [f64::NEG_INFINITY, f64::INFINITY];
        self.span().or(self.pauses().then_some(endless))
    }

    /// Whether it is dark between its pulses.
    fn pauses(&self) -> bool {
        matches!(self, Emission::Train { sigma, period, .. } if *period > 2.0 * CUT * sigma)
    }

    /// For a train with pauses, the proper times of the first pulse that is not over at the start of a range, or of its last one.
    pub(crate) fn pulse_near(&self, [from, _]: [f64; 2]) -> Option<[f64; 2]> {
        let Emission::Train {
            centre,
            sigma,
            period,
            count,
        } = self
        else {
            return None;
        };
        let reach = CUT * sigma;
        // An infinite train has no beginning either.
        let [first, last] = match count.is_finite() {
            true => [0.0, count - 1.0],
            false => [f64::NEG_INFINITY, f64::INFINITY],
        };
        // The first k for which pulse k ends, at centre + k period + reach, no earlier than `from`.
        let k = ((from - reach - centre) / period).ceil().clamp(first, last);
        let middle = centre + k * period;
        self.pauses().then_some([middle - reach, middle + reach])
    }

    /// The integral up to a proper time; infinite if it has no beginning.
    pub(crate) fn until(&self, proper_time: f64) -> f64 {
        match self {
            Emission::Steady => f64::INFINITY,
            Emission::Gaussian {
                centre,
                sigma,
                scale,
            } => normal((proper_time - centre) / sigma) * scale,
            Emission::Train {
                centre,
                sigma,
                period,
                count,
            } => {
                let (phase, reach) = ((proper_time - centre) / period, CUT * sigma / period);
                // Pulses that are over, and those that are not.
                let over = (phase - reach).ceil().clamp(0.0, *count);
                let begun = (phase + reach).floor().min(count - 1.0);
                let rest = (0..=17)
                    .map(|n| over + f64::from(n))
                    .take_while(|k| *k <= begun);
                let rest: f64 = rest.map(|k| normal((phase - k) * period / sigma)).sum();
                // A pulse of height 1 has the integral √(2π) σ.
                (over + rest) * sigma * TAU.sqrt()
            }
            Emission::Table(table) => table.until(proper_time),
        }
    }
}

/// The integral of the normal distribution's density up to x, to an accuracy of 1·10⁻¹².
///
/// Φ by its Taylor series about the nearest point where Φ and its density φ are tabulated, with φ′ = −x φ. The first omitted term is φ⁗
/// d⁵/120, with |φ⁗| ≤ 1.2 and d ≤ 1/128: 3·10⁻¹³.
#[inline]
fn normal(x: f64) -> f64 {
    /// Table points per unit of x, from −`END` to `END`, beyond which Φ is 0 or 1.
    const PER_UNIT: usize = 64;
    const END: f64 = 8.0;
    static TABLE: LazyLock<Vec<[f64; 2]>> = LazyLock::new(|| {
        let place = |k: usize| k as f64 / PER_UNIT as f64 - END;
        let entry = |x: f64| {
            let density = libm::exp(-0.5 * x * x) / TAU.sqrt();
            [0.5 * libm::erfc(-x * FRAC_1_SQRT_2), density]
        };
        (0..=2 * END as usize * PER_UNIT)
            .map(|k| entry(place(k)))
            .collect()
    });
    let at = (x + END) * PER_UNIT as f64;
    // Rounded to the nearest by truncating conversion; NaN and values below the table give its first entry.
    let k = (at + 0.5) as usize;
    let Some([integral, density]) = TABLE.get(k).filter(|_| at >= 0.0) else {
        return if x > 0.0 { 1.0 } else { 0.0 };
    };
    let middle = k as f64 / PER_UNIT as f64 - END;
    let d = x - middle;
    let square = middle * middle;
    // 1, and the derivatives of φ over φ, divided by factorials.
    let series = d
        * (1.0
            + d * (-middle / 2.0
                + d * ((square - 1.0) / 6.0 + d * (middle * (3.0 - square) / 24.0))));
    integral + density * series
}

/// Pulses of standard deviation 1/`spacing` at the `count` integers from 0 on; at all integers if `count` is infinite.
fn train(phase: f64, spacing: f64, count: f64) -> f64 {
    let (first, last) = match count.is_finite() {
        true => (0.0, count - 1.0),
        false => (f64::NEG_INFINITY, f64::INFINITY),
    };
    // Pulses above the smallest value of the Gaussian: at most 17, because `spacing` is at least 1.
    let reach = CUT / spacing;
    let begin = (phase - reach).ceil().max(first);
    let end = (phase + reach).floor().min(last);
    let pulses = (0..=17).map(|n| begin + f64::from(n));
    let value = |k: f64| gaussian((phase - k) * spacing) * TAU.sqrt();
    pulses.take_while(|k| *k <= end).map(value).sum()
}

impl Table {
    pub fn new(knots: Vec<[f64; 2]>) -> Table {
        let mut integral = 0.0;
        let all = knots.windows(2).map(|pair| {
            let [a, b] = [pair[0], pair[1]];
            // As one segment, of which only a part is needed.
            integral += trapezoid(a, [b[0], between(a, b, b[0])]);
            integral
        });
        let integrals = std::iter::once(0.0).chain(all).collect();
        Table { knots, integrals }
    }

    /// The number of knots at or before a time.
    fn passed(&self, time: f64) -> usize {
        self.knots.partition_point(|[at, _]| *at <= time)
    }

    fn at(&self, time: f64) -> f64 {
        let after = self.passed(time);
        let Some(&last) = after.checked_sub(1).and_then(|k| self.knots.get(k)) else {
            return 0.0;
        };
        match self.knots.get(after) {
            Some(next) => between(last, *next, time),
            None if time == last[0] => last[1],
            None => 0.0,
        }
    }

    /// The integral up to a time: up to the last knot before it, plus the rest.
    fn until(&self, time: f64) -> f64 {
        let after = self.passed(time);
        let Some(before) = after.checked_sub(1) else {
            return 0.0;
        };
        let (last, integral) = (self.knots[before], self.integrals[before]);
        match self.knots.get(after) {
            Some(next) => integral + trapezoid(last, [time, between(last, *next, time)]),
            None => integral,
        }
    }
}

/// The value at a time on the line through two knots.
fn between([last, value]: [f64; 2], [next, then]: [f64; 2], time: f64) -> f64 {
    value + (then - value) * ((time - last) / (next - last))
}

/// The integral of the line between two knots.
fn trapezoid([from, first]: [f64; 2], [to, last]: [f64; 2]) -> f64 {
    0.5 * (first + last) * (to - from)
}

/// Beyond this the unit Gaussian is set to 0: below the smallest value that matters, 5·10⁻¹⁵.
const CUT: f64 = 8.0;

#[inline]
fn gaussian(x: f64) -> f64 {
    if x.abs() > CUT {
        return 0.0;
    }
    libm::exp(-0.5 * x * x) / TAU.sqrt()
}

/// Maps proper times to intensities.
struct Gaussians<'a> {
    times: &'a mut [f64],
    centre: f64,
    sigma: f64,
    scale: f64,
}

impl VectorLoop for Gaussians<'_> {
    #[inline(always)]
    fn run(self) {
        let (centre, sigma, scale) = (self.centre, self.sigma, self.scale);
        for time in self.times {
            let x = (*time - centre) / sigma;
            let value = exp_of_negative(-0.5 * x * x) / TAU.sqrt();
            let value = if x.abs() > CUT { 0.0 } else { value };
            *time = value / sigma * scale;
        }
    }
}

/// e^x for −700 < x ≤ 0 without branches, with the same bits as `libm::exp`, whose steps it follows (fdlibm's e_exp.c: a remainder within ±
/// ½ ln 2 and a rational function of it).
#[inline(always)]
fn exp_of_negative(x: f64) -> f64 {
    const LN2_HI: f64 = 6.931_471_803_691_238e-1;
    const LN2_LO: f64 = 1.908_214_929_270_587_7e-10;
    const INV_LN2: f64 = std::f64::consts::LOG2_E;
    const P: [f64; 5] = [
        1.666_666_666_666_660_2e-1,
        -2.777_777_777_701_559_3e-3,
        6.613_756_321_437_934e-5,
        -1.653_390_220_546_525_2e-6,
        4.138_136_797_057_238_5e-8,
    ];
    /// 1.5·2⁵²: adding it to an integer of moderate size leaves that in the low bits.
    const SHIFTER: f64 = 6_755_399_441_055_744.0;
    // x = k ln 2 + r; the limits are those of the high words of ½ ln 2, 1.5 ln 2 and 2⁻²⁸.
    let high = (x.to_bits() >> 32) & 0x7fff_ffff;
    let k = if high >= 0x3ff0_a2b2 {
        (INV_LN2 * x - 0.5).trunc()
    } else {
        -1.0
    };
    let k = if high > 0x3fd6_2e42 { k } else { 0.0 };
    let (hi, lo) = (x - k * LN2_HI, k * LN2_LO);
    let r = hi - lo;
    // e^r = 1 + (r c/(2 − c) − lo + hi), with c = r − r² P(r²).
    let square = r * r;
    let c =
        r - square * (P[0] + square * (P[1] + square * (P[2] + square * (P[3] + square * P[4]))));
    let y = 1.0 + (r * c / (2.0 - c) - lo + hi);
    // 2ᵏ by its exponent.
    let bits = (k + SHIFTER).to_bits().wrapping_sub(SHIFTER.to_bits());
    let power = f64::from_bits(bits.wrapping_add(1023) << 52);
    if high > 0x3e30_0000 {
        y * power
    } else {
        1.0 + x
    }
}

#[cfg(test)]
mod tests;
