//! Whether floating-point samples were read with their bytes in the wrong order.
//!
//! In the other order the exponent of a sample is its lowest mantissa bits. Where those are as good as random, exponents are
//! evenly spread over all that there are, so that 2 · 44/254 = 0.34 of single samples lie outside 10⁻²⁵ … 10²⁵, and
//! 2 · 691/2046 = 0.67 of double ones outside 10⁻¹⁰⁰ … 10¹⁰⁰; where samples have few digits these bits are 0, and all samples
//! lie outside. Radiance in any unit that people use does not. So samples of which more than a fifth lie outside, and less than a
//! tenth once their bytes are turned round, were read wrongly. Those read rightly are not taken for such even if they are tiny:
//! turned round, a third of them or more lies outside.

/// What tells of a wrong order of bytes: parts of the samples that are not 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ByteOrder {
    /// Outside of all usual sizes as they were read.
    pub now: f64,
    /// The same with their bytes in the other order.
    pub turned: f64,
}

/// Fewer samples tell nothing.
const FEWEST: usize = 64;

impl ByteOrder {
    /// Of floating-point samples that take so many bytes in their file, four or eight; none where their order is as likely right.
    pub fn of(samples: impl Iterator<Item = f64>, bytes: usize) -> Option<ByteOrder> {
        let most = match bytes {
            4 => 1e25,
            8 => 1e100,
            _ => return None,
        };
        // NaN is outside.
        let outside = |x: f64| !(x.abs() <= most && x.abs() >= 1.0 / most);
        let turned = |x: f64| match bytes {
            4 => f64::from(f32::from_bits((x as f32).to_bits().swap_bytes())),
            _ => f64::from_bits(x.to_bits().swap_bytes()),
        };
        let (mut count, mut now, mut then) = (0usize, 0usize, 0usize);
        for x in samples.filter(|x| *x != 0.0) {
            count += 1;
            now += usize::from(outside(x));
            then += usize::from(outside(turned(x)));
        }
        let part = |n: usize| n as f64 / count as f64;
        let found = ByteOrder {
            now: part(now),
            turned: part(then),
        };
        (count >= FEWEST && found.now > 0.2 && found.turned < 0.1).then_some(found)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers in (0, 1) without a pattern.
    fn noise(n: u64) -> f64 {
        let hash = (n + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        ((hash ^ (hash >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9) >> 11) as f64
            / (1u64 << 53) as f64
    }

    /// Samples rightly read, of any kind, and the same with their bytes turned round.
    #[test]
    fn a_wrong_order_is_told_of_all_kinds_of_samples_and_of_no_right_one() {
        type Kind = (&'static str, fn(u64) -> f64);
        let kinds: [Kind; 7] = [
            ("noise", noise),
            ("noise about 0", |n| noise(n) - 0.5),
            ("normal", |n| {
                (0..12).map(|k| noise(12 * n + k)).sum::<f64>() - 6.0
            }),
            ("counts", |n| (noise(n) * 40.0).floor()),
            ("half precision", |n| half::f16::from_f64(noise(n)).to_f64()),
            ("a decay over ten decades", |n| 10f64.powf(-10.0 * noise(n))),
            ("another unit", |n| 1e-12 * noise(n)),
        ];
        for (name, kind) in kinds {
            let singles: Vec<f32> = (0..4000).map(|n| kind(n) as f32).collect();
            let doubles: Vec<f64> = (0..4000).map(kind).collect();
            let read = |turn: bool| {
                let single = |x: &f32| match turn {
                    true => f64::from(f32::from_bits(x.to_bits().swap_bytes())),
                    false => f64::from(*x),
                };
                let double = |x: &f64| match turn {
                    true => f64::from_bits(x.to_bits().swap_bytes()),
                    false => *x,
                };
                [
                    ByteOrder::of(singles.iter().map(single), 4),
                    ByteOrder::of(doubles.iter().map(double), 8),
                ]
            };
            assert_eq!(read(false), [None, None], "{name}");
            assert!(
                read(true).iter().all(Option::is_some),
                "{name}: {:?}",
                read(true)
            );
        }
        // Tiny and huge ones, tails of a Gaussian down to nothing, and too few to tell.
        for size in [1e-35, 1e35] {
            let samples = (0..4000).map(|n| f64::from((size * noise(n)) as f32));
            assert_eq!(ByteOrder::of(samples, 4), None);
        }
        let tails = (0..4000).map(|n| f64::from((-80.0 * noise(n)).exp() as f32));
        assert_eq!(ByteOrder::of(tails, 4), None);
        assert_eq!(ByteOrder::of([1e-40; 63].into_iter(), 4), None);
    }
}
