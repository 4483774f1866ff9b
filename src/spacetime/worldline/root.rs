//! The root of a decreasing function: Newton's method, kept within a bracket.

/// The most evaluations. Bisection alone needs some 1,100 from the widest bracket, but every other step halves
/// what Newton's does not.
const MOST: usize = 200;

/// A function at one place.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    pub value: f64,
    /// Derivative, below 0.
    pub slope: f64,
    /// What rounding may have added to the value.
    pub noise: f64,
}

/// The root of the strictly decreasing function `f` in `bracket`, from `start` on; an end of the bracket where
/// there is none inside.
pub(super) fn decreasing(bracket: [f64; 2], start: f64, f: impl Fn(f64) -> Sample) -> f64 {
    let [mut low, mut high] = bracket;
    let mut s = if start > low && start < high {
        start
    } else {
        0.5 * (low + high)
    };
    let mut last_step = high - low;
    for _ in 0..MOST {
        let Sample {
            value,
            slope,
            noise,
        } = f(s);
        // The bracket closes about the root on both sides.
        if value > 0.0 {
            low = s;
        } else {
            high = s;
        }
        let newton = s - value / slope;
        // As near as rounding lets one tell.
        if value.abs() <= noise {
            return newton.clamp(bracket[0], bracket[1]);
        }
        // Where Newton's steps do not shrink, bisection does.
        let step = newton - s;
        let good = newton >= low && newton <= high && step.abs() <= 0.5 * last_step.abs();
        let next = if good { newton } else { 0.5 * (low + high) };
        last_step = next - s;
        // There is no step left, or no bracket.
        if next == s || next <= low && next >= high {
            return next;
        }
        s = next;
    }
    s
}
