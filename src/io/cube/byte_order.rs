//! Detects samples that were read with the wrong byte order.
//!
//! **Single and double precision.** In the other order the exponent of a sample is its lowest mantissa bits. If those are effectively
//! random, exponents are uniformly distributed over their whole range, so that 2 · 44/254 = 0.34 of single samples lie outside
//! 10⁻²⁵ … 10²⁵, and 2 · 691/2046 = 0.67 of double ones outside 10⁻¹⁰⁰ … 10¹⁰⁰; if samples have few digits these bits are 0, and all
//! samples lie outside. Radiance in any common unit does not. So samples of which more than a fifth lie outside, and less than a tenth
//! after byte swapping, were read in the wrong order. Correct samples are not misjudged even if they are tiny: after byte swapping, a third
//! of them or more lies outside.
//!
//! **Half precision** has no room for unusual sizes. If mantissas are effectively random, exponents in the other order are uniformly
//! distributed over 0 … 31, and log₂ of the samples has a standard deviation of 32/√12 = 9, which real data only have if they span nine
//! decades. So if it is above 6, and less than half as large after byte swapping, the samples were read in the wrong order. Samples with
//! few digits have an exponent and first two mantissa bits of 0 in the other order: if nine tenths of the samples are below 2⁻¹⁶, and after
//! byte swapping nine tenths are above 2⁻⁸, they were read in the wrong order, too.
//!
//! **Integers** of two or four bytes: small ones have a highest byte of 0 (or 255, below 0), which in the other order is the lowest. Of
//! random numbers 1/256 have such a byte; so if more than half of the samples have it as the lowest, and less than a tenth after byte
//! swapping, they were read in the wrong order. Larger integers vary from bin to bin by less than their size. In the other order they are
//! effectively random, for which Σ|b − a| / Σ(|a| + |b|) over neighbours is 1/3: if it is above 0.3, and less than half as large after byte
//! swapping, they were read in the wrong order. The same test, with 0.5, applies to half precision.
//!
//! Noise from bin to bin varies as much in either order. All 256 values of its lowest byte are equally likely, but not those of its highest
//! byte, unless it fills its type: 256 times the probability that two samples share a byte is 1 if all values are equally likely, and 256/n
//! if n of them are. So if it is below 1.2 for the highest byte and above 1.5 for the lowest, the samples were read in the wrong order.
//! Noise that fills more than two thirds of its type looks the same in either order, and is not detected.
//!
//! **Integers of eight bytes** are loaded in double precision, which holds 53 bits: small ones are detected as above, because in the other
//! order their bytes are in the upper bits. Larger ones have lost their low bits.

/// Evidence of a wrong byte order: fractions of the samples that are not 0, or a size, as they were read and after byte swapping.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ByteOrder {
    /// The kind of evidence.
    pub sign: Sign,
    /// As they were read.
    pub now: f64,
    /// After byte swapping.
    pub turned: f64,
}

/// The kinds of evidence of a wrong byte order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sign {
    /// The fraction outside the range of usual sizes.
    Sizes,
    /// The part whose lowest byte is that of small numbers in the other order; of half precision, the part that is too small.
    Bytes,
    /// The standard deviation of log₂.
    Spread,
    /// The differences of neighbours relative to their sums.
    Steps,
    /// 256 times the probability that two samples share their highest byte: 1 if all values are equally likely. After byte swapping, the
    /// lowest byte is the highest.
    Evenness,
}

/// Fewer samples are no evidence.
const FEWEST: usize = 64;
/// Fewer samples are no evidence about the distribution of bytes.
const FEWEST_EVEN: usize = 1000;

impl ByteOrder {
    /// The evidence in samples stored in two, four or eight bytes, in which each sample and the `apart`-th after it are neighbours in time;
    /// `None` unless the other order is more likely. If all samples are integers, they are assumed to be integers in the file.
    pub fn of(samples: &[f64], bytes: usize, apart: usize) -> Option<ByteOrder> {
        let any = samples.iter().filter(|x| **x != 0.0).count();
        if any < FEWEST {
            return None;
        }
        let all = |low: f64, high: f64| {
            let is_one = |x: &f64| x.fract() == 0.0 && (low..=high).contains(x);
            samples.iter().all(is_one)
        };
        let steps = |turned: &dyn Fn(f64) -> f64, most: f64| steps(samples, turned, apart, most);
        match bytes {
            2 => half_precision(samples).or_else(|| steps(&|x| turned_half(x).to_f64(), 0.5)),
            4 if all(0.0, 65535.0) => {
                let turned = |x: f64| f64::from((x as u16).swap_bytes());
                bytes_of(samples, turned, |x| (x as u16) & 255, false)
                    .or_else(|| steps(&turned, 0.3))
                    .or_else(|| evenness(samples, |x| (x as u16).to_le_bytes()))
            }
            4 if all(-32768.0, 32767.0) => {
                let turned = |x: f64| f64::from((x as i16).swap_bytes());
                bytes_of(samples, turned, |x| (x as i16 as u16) & 255, true)
                    .or_else(|| steps(&turned, 0.3))
                    .or_else(|| evenness(samples, |x| (x as i16).to_le_bytes()))
            }
            8 if all(0.0, f64::from(u32::MAX)) => {
                let turned = |x: f64| f64::from((x as u32).swap_bytes());
                bytes_of(samples, turned, |x| (x as u32 & 255) as u16, false)
                    .or_else(|| steps(&turned, 0.3))
                    .or_else(|| evenness(samples, |x| (x as u32).to_le_bytes()))
            }
            8 if all(f64::from(i32::MIN), f64::from(i32::MAX)) => {
                let turned = |x: f64| f64::from((x as i32).swap_bytes());
                bytes_of(samples, turned, |x| (x as i32 as u32 & 255) as u16, true)
                    .or_else(|| steps(&turned, 0.3))
                    .or_else(|| evenness(samples, |x| (x as i32).to_le_bytes()))
            }
            // Saturating conversions: 2⁶⁴ is the largest number but one that a sample can have become.
            8 if all(0.0, 18_446_744_073_709_551_616.0) => {
                let turned = |x: f64| (x as u64).swap_bytes() as f64;
                bytes_of(samples, turned, |x| (x as u64 & 255) as u16, false)
            }
            8 if all(-9_223_372_036_854_775_808.0, 9_223_372_036_854_775_808.0) => {
                let turned = |x: f64| (x as i64).swap_bytes() as f64;
                bytes_of(samples, turned, |x| (x as i64 as u64 & 255) as u16, true)
            }
            // Exponents of swapped numbers are uniformly distributed: a third of f32's lie outside 10^±25, two thirds of f64's outside
            // 10^±100.
            4 => sizes(samples, 1e25, |x| {
                f64::from(f32::from_bits((x as f32).to_bits().swap_bytes()))
            }),
            8 => sizes(samples, 1e100, |x| f64::from_bits(x.to_bits().swap_bytes())),
            _ => None,
        }
    }
}

/// The fraction of the `counted` samples that satisfy a condition.
fn part(samples: &[f64], counted: impl Fn(f64) -> bool, holds: impl Fn(f64) -> bool) -> f64 {
    let (mut count, mut found) = (0usize, 0usize);
    for x in samples.iter().copied().filter(|x| counted(*x)) {
        count += 1;
        found += usize::from(holds(x));
    }
    found as f64 / count.max(1) as f64
}

/// Evidence if `now` is above the first bound, and then what `turned` gives below the second. Few samples come that far.
fn evidence(
    sign: Sign,
    now: f64,
    above: f64,
    turned: impl Fn() -> f64,
    below: f64,
) -> Option<ByteOrder> {
    let turned = (now > above).then(turned)?;
    (turned < below).then_some(ByteOrder { sign, now, turned })
}

/// Evidence from samples outside the range of usual sizes, from 1/`most` to `most`.
fn sizes(samples: &[f64], most: f64, turned: impl Fn(f64) -> f64) -> Option<ByteOrder> {
    // NaN is outside.
    let outside = |x: f64| !(x.abs() <= most && x.abs() >= 1.0 / most);
    let now = part(samples, |x| x != 0.0, outside);
    let turned = || part(samples, |x| x != 0.0, |x| outside(turned(x)));
    evidence(Sign::Sizes, now, 0.2, turned, 0.1)
}

/// Evidence from the lowest bytes of integers, if they are those of small integers in the other order.
fn bytes_of(
    samples: &[f64],
    turned: impl Fn(f64) -> f64,
    lowest: impl Fn(f64) -> u16,
    is_signed: bool,
) -> Option<ByteOrder> {
    let is_small = |x: f64| match lowest(x) {
        0 => true,
        byte => byte == 255 && is_signed,
    };
    // 0 and −1 are the same in either order.
    let counted = |x: f64| turned(x) != x;
    let now = part(samples, counted, is_small);
    let then = || part(samples, counted, |x| is_small(turned(x)));
    evidence(Sign::Bytes, now, 0.5, then, 0.1)
}

/// Below this, half precision has at most eight bits; few samples with few digits are below the second bound.
const LOW: f64 = 1.0 / 65536.0;
const USUAL: f64 = 1.0 / 256.0;

fn turned_half(x: f64) -> half::f16 {
    half::f16::from_bits(half::f16::from_f64(x).to_bits().swap_bytes())
}

/// Evidence from highest bytes of 0, or from the spread of sizes.
fn half_precision(samples: &[f64]) -> Option<ByteOrder> {
    let turned = |x: f64| turned_half(x).to_f64();
    let below =
        |most: f64, of: &dyn Fn(f64) -> f64| part(samples, |x| x != 0.0, |x| of(x).abs() < most);
    let then = || below(USUAL, &turned);
    let bytes = evidence(Sign::Bytes, below(LOW, &|x| x), 0.9, then, 0.1);
    bytes.or_else(|| {
        // log₂ is the exponent and less than 1 more, which adds at most 1/2 to the deviation: nearly always this decides, without logarithms.
        let exponent = |x: f64| (x.to_bits() >> 52) as f64;
        if spread(samples, |x| x, exponent) < 5.4 {
            return None;
        }
        let now = spread(samples, |x| x, libm::log2);
        let then = || spread(samples, turned, libm::log2);
        evidence(Sign::Spread, now, 6.0, then, 0.5 * now)
    })
}

/// The standard deviation of the sizes of what `of` makes of the samples, except 0 and what is not finite.
fn spread(samples: &[f64], of: impl Fn(f64) -> f64, size: impl Fn(f64) -> f64) -> f64 {
    let (mut count, mut sum, mut squares) = (0.0, 0.0, 0.0);
    for x in samples.iter().map(|x| of(*x).abs()) {
        if x > 0.0 && x.is_finite() {
            let size = size(x);
            (count, sum, squares) = (count + 1.0, sum + size, squares + size * size);
        }
    }
    (squares / count - (sum / count) * (sum / count))
        .max(0.0)
        .sqrt()
}

/// Evidence from the differences of neighbours.
fn steps(
    samples: &[f64],
    turned: impl Fn(f64) -> f64,
    apart: usize,
    most: f64,
) -> Option<ByteOrder> {
    let turned: Vec<f64> = samples.iter().map(|x| turned(*x)).collect();
    let (mut sums, mut differences) = ([0.0; 2], [0.0; 2]);
    for at in apart..samples.len() {
        let pairs = [samples, &turned].map(|all| [all[at - apart], all[at]]);
        if pairs.iter().flatten().all(|x| x.is_finite()) {
            for (k, [a, b]) in pairs.into_iter().enumerate() {
                sums[k] += a.abs() + b.abs();
                differences[k] += (b - a).abs();
            }
        }
    }
    let [now, turned] = [0, 1].map(|k| differences[k] / sums[k]);
    evidence(Sign::Steps, now, most, || turned, 0.5 * now)
}

/// Evidence from the distributions of the highest and of the lowest bytes.
fn evenness<const N: usize>(samples: &[f64], bytes: impl Fn(f64) -> [u8; N]) -> Option<ByteOrder> {
    let mut counts = [[0u64; 256]; 2];
    for bytes in samples.iter().filter(|x| **x != 0.0).map(|x| bytes(*x)) {
        counts[0][usize::from(bytes[N - 1])] += 1;
        counts[1][usize::from(bytes[0])] += 1;
    }
    let [now, turned] = counts.map(|counts| {
        let all: u64 = counts.iter().sum();
        let pairs: u64 = counts.iter().map(|n| n * n.saturating_sub(1)).sum();
        // 1 if all 256 values are equally frequent.
        256.0 * pairs as f64 / (all * all.saturating_sub(1)) as f64
    });
    let sign = Sign::Evenness;
    // For a thousand samples the standard deviation of this is 256 √(2/256)/1000 = 0.02.
    let any = samples.iter().filter(|x| **x != 0.0).count();
    (any >= FEWEST_EVEN && now < 1.2 && turned > 1.5).then_some(ByteOrder { sign, now, turned })
}

#[cfg(test)]
mod tests;
