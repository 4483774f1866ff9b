//! Round numbers and their units.

/// The prefixes of SI units, by powers of a thousand.
const PREFIXES: [(i32, &str); 11] = [
    (-15, "f"),
    (-12, "p"),
    (-9, "n"),
    (-6, "µ"),
    (-3, "m"),
    (0, ""),
    (3, "k"),
    (6, "M"),
    (9, "G"),
    (12, "T"),
    (15, "P"),
];

/// A unit with a prefix: `ns`, one of which is 1e-9 of the base unit.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Unit {
    pub name: String,
    exponent: i32,
}

impl Unit {
    /// The unit in which a size of at most `largest` base units has one to three digits before the point.
    pub fn prefixed(base: &str, largest: f64) -> Unit {
        let fits = |&&(exponent, _): &&(i32, &str)| largest >= power(exponent);
        let (exponent, prefix) = *PREFIXES.iter().rev().find(fits).unwrap_or(&(0, ""));
        Unit {
            name: format!("{prefix}{base}"),
            exponent,
        }
    }

    /// Metres as far as they read well, with a prefix otherwise.
    pub fn metres(largest: f64) -> Unit {
        if (0.01..10_000.0).contains(&largest) {
            Unit {
                name: "m".into(),
                exponent: 0,
            }
        } else {
            Unit::prefixed("m", largest)
        }
    }

    /// The number of units in `value` base units.
    pub fn count(&self, value: f64) -> f64 {
        // Powers with a positive exponent are exact.
        if self.exponent < 0 {
            value * power(-self.exponent)
        } else {
            value / power(self.exponent)
        }
    }
}

fn power(exponent: i32) -> f64 {
    libm::pow(10.0, f64::from(exponent))
}

/// The smallest of 1, 2, 5 × 10ⁿ that is at least `least`; `least` above 0.
pub(crate) fn round_step(least: f64) -> f64 {
    let exponent = libm::log10(least).floor().clamp(-300.0, 300.0) as i32;
    let scaled = |mantissa: f64| {
        // 2 / 10³ is the double nearest to 0.002; 2 × 10⁻³ need not be.
        if exponent < 0 {
            mantissa / power(-exponent)
        } else {
            mantissa * power(exponent)
        }
    };
    let steps = [1.0, 2.0, 5.0].map(scaled);
    // 1e-9, so that rounding of the range skips no step.
    let enough = steps.into_iter().find(|&step| step >= least * (1.0 - 1e-9));
    enough.unwrap_or(scaled(10.0))
}

/// `value` (a multiple of `step`) with as many digits after the point as `step` has, and a true minus.
pub(crate) fn number(value: f64, step: f64) -> String {
    let whole = |digits: &i32| {
        let scaled = step * power(*digits);
        // A whole number, but for rounding.
        (scaled - scaled.round()).abs() <= 1e-6 * scaled
    };
    let digits = (0..9).find(whole).unwrap_or(9) as usize;
    let text = format!("{value:.digits$}");
    let is_zero = text.bytes().all(|b| matches!(b, b'-' | b'0' | b'.'));
    match text.strip_prefix('-') {
        Some(text) if is_zero => text.to_string(),
        Some(text) => format!("−{text}"),
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_round_and_at_least_what_is_needed() {
        for (least, step) in [
            (1.0, 1.0),
            (1.1, 2.0),
            (3.0, 5.0),
            (7.0, 10.0),
            (0.0021, 0.005),
            (0.002, 0.002),
            (4e5, 5e5),
        ] {
            assert_eq!(round_step(least), step);
        }
        for least in [f64::MIN_POSITIVE, 1e-320, f64::MAX] {
            assert!(round_step(least) > 0.0);
        }
    }

    #[test]
    fn numbers_have_the_digits_of_their_step() {
        assert_eq!(number(0.30000000000000004, 0.1), "0.3");
        assert_eq!(number(-2.5, 0.25), "−2.50");
        assert_eq!(number(40.0, 20.0), "40");
        assert_eq!(number(-0.0, 0.5), "0.0");
    }

    #[test]
    fn units_suit_the_size_of_what_they_measure() {
        let name = |largest| Unit::prefixed("s", largest).name;
        assert_eq!(
            [1e-8, 2e-12, 0.5e-3, 3.0].map(name),
            ["ns", "ps", "µs", "s"]
        );
        assert_eq!(Unit::prefixed("s", 1e-8).count(1e-8), 10.0);
        assert_eq!(Unit::metres(0.3).name, "m");
        assert_eq!(Unit::metres(2e-3).name, "mm");
        assert_eq!(Unit::metres(3e8).name, "Mm");
    }
}
