//! The root of a decreasing function: Newton's method, kept within a bracket.

/// The maximum number of evaluations. Bisection alone needs about 1,100 from the widest bracket, but it is only used when Newton's steps leave the
/// bracket or stop halving.
const MOST: usize = 200;

/// A function at one point.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    pub value: f64,
    /// Derivative, below 0.
    pub slope: f64,
    /// A bound on the rounding error of the value.
    pub noise: f64,
}

/// The root of the strictly decreasing function `f` in `bracket`, starting at `start`; an end of the bracket if there is no root inside.
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
        // The bracket closes around the root from both sides.
        if value > 0.0 {
            low = s;
        } else {
            high = s;
        }
        let newton = s - value / slope;
        // As near as rounding allows.
        if value.abs() <= noise {
            return newton.clamp(bracket[0], bracket[1]);
        }
        // If Newton's steps do not shrink, bisect.
        let step = newton - s;
        let good = newton >= low && newton <= high && step.abs() <= 0.5 * last_step.abs();
        let next = if good { newton } else { 0.5 * (low + high) };
        last_step = next - s;
        // No step is left, or no bracket.
        if next == s || next <= low && next >= high {
            return next;
        }
        s = next;
    }
    s
}
