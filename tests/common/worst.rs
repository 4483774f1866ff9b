//! The largest error of a test, relative to its tolerance.

/// The largest relative rounding error of one operation: half the spacing of f64 at 1.
pub const EPS: f64 = f64::EPSILON / 2.0;

/// The largest error so far, in units of its tolerance, and where it was met.
#[derive(Default)]
pub struct Worst {
    ratio: f64,
    place: String,
}

impl Worst {
    /// Notes an error; NaN counts as infinite, and an error where none is allowed too.
    pub fn note(&mut self, error: f64, tolerance: f64, place: impl FnOnce() -> String) {
        let ratio = match error.abs() / tolerance {
            _ if error == 0.0 => 0.0,
            ratio if ratio.is_nan() => f64::INFINITY,
            ratio => ratio,
        };
        if ratio > self.ratio || (self.place.is_empty() && ratio > 0.0) {
            self.ratio = ratio;
            self.place = place();
        }
    }

    /// Fails where any error was above its tolerance; says how large the worst was in any case.
    pub fn assert_within(&self, what: &str) {
        let Worst { ratio, place } = self;
        println!("{what}: at worst {ratio:.3} of the tolerance, {place}");
        assert!(
            *ratio <= 1.0,
            "{what}: {ratio:.3} times the tolerance, {place}"
        );
    }
}
