//! The range of times for the colours, and the values of the lines.

use crate::figures::ticks::round_step;

/// Number of lines over the middle half of the pixels, if no step is given.
const LINES: f64 = 10.0;
/// The fewest and the most lines over the whole range then.
const LINES_IN_ALL: [f64; 2] = [10.0, 80.0];
/// Outliers lie beyond the middle half of the pixels by more than this many times its range ("far out"
/// in Tukey's terms).
const FENCE: f64 = 3.0;
/// Outliers are cut off if that saves more than this share of the range.
const WORTH: f64 = 0.3;

/// The times that the colours span, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Range {
    pub low: f64,
    pub high: f64,
    /// Between two lines.
    pub step: f64,
    /// Whether there are earlier times than `low`.
    pub more_below: bool,
    /// Whether there are later times than `high`.
    pub more_above: bool,
}

impl Range {
    /// The range of the finite values; `None` if there are none.
    ///
    /// Up to a tenth of the pixels may be cut off as too early (a floor that extends to the horizon), up to a hundredth as too late: small
    /// objects in the foreground must stay visible.
    pub fn of(ct: &[f64], step: Option<f64>) -> Option<Range> {
        let mut seen: Vec<f64> = ct.iter().copied().filter(|x| x.is_finite()).collect();
        seen.sort_unstable_by(f64::total_cmp);
        let (first, last) = (*seen.first()?, *seen.last()?);
        let at = |part: f64| seen[((seen.len() - 1) as f64 * part) as usize];
        let (quarter, three_quarters) = (at(0.25), at(0.75));
        let half = three_quarters - quarter;
        let low = at(0.1).min(quarter - FENCE * half);
        let high = at(0.99).max(three_quarters + FENCE * half);
        let worth_it = |outside: f64| half > 0.0 && outside > WORTH * (high - low);
        let low = if worth_it(low - first) { low } else { first };
        let high = if worth_it(last - high) { high } else { last };
        let (low, high) = widened(low, high);
        Some(Range {
            low,
            high,
            step: step.unwrap_or_else(|| Self::step(half, high - low)),
            more_below: first < low,
            more_above: last > high,
        })
    }

    /// A range that is given, low first, and which of the finite values are outside it.
    pub fn spanning([low, high]: [f64; 2], ct: &[f64], step: Option<f64>) -> Range {
        let mut seen = ct.iter().filter(|x| x.is_finite());
        Range {
            low,
            high,
            step: step.unwrap_or_else(|| round_step((high - low) / (2.0 * LINES))),
            more_below: seen.clone().any(|x| *x < low),
            more_above: seen.any(|x| *x > high),
        }
    }

    /// A round step that suits both the middle half of the pixels and the whole.
    fn step(half: f64, whole: f64) -> f64 {
        let [fewest, most] = LINES_IN_ALL;
        round_step((half / LINES).clamp(whole / most, whole / fewest))
    }

    /// Where `ct` lies between `low` (0) and `high` (1); outside it is cut off.
    pub fn part(&self, ct: f64) -> f64 {
        // Halves, so that the difference of the largest numbers stays finite.
        let span = self.high / 2.0 - self.low / 2.0;
        ((ct / 2.0 - self.low / 2.0) / span).clamp(0.0, 1.0)
    }

    /// The largest possible number of lines.
    pub fn line_count(&self) -> f64 {
        (self.high / self.step).floor() - (self.low / self.step).ceil() + 1.0
    }

    /// The number k of the lowest line (at k · step), and that of the highest.
    pub fn lines(&self) -> std::ops::RangeInclusive<i64> {
        (self.low / self.step).ceil() as i64..=(self.high / self.step).floor() as i64
    }
}

/// A range that is not empty: a picture of one time has a thousandth of it to either side.
fn widened(low: f64, high: f64) -> (f64, f64) {
    let size = low.abs().max(high.abs());
    if high - low > 1e-9 * size {
        return (low, high);
    }
    // About 0 a thousandth of it is nothing: one of a unit.
    let margin = if size > 1e-12 { 1e-3 * size } else { 1e-3 };
    (low - margin, high + margin)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_even_picture_is_shown_from_end_to_end() {
        let ct: Vec<f64> = (0..=1000).map(|i| f64::from(i) * 0.01 - 4.0).collect();
        let range = Range::of(&ct, None).unwrap();
        assert_eq!((range.low, range.high, range.step), (-4.0, 6.0, 0.5));
        assert!(!range.more_below && !range.more_above);
        assert_eq!(range.lines(), -8..=12);
    }

    #[test]
    fn a_far_horizon_does_not_squeeze_the_rest() {
        let far = (1..=90).map(|i| -1e3 * f64::from(i));
        let near = (0..910).map(|i| f64::from(i) * 0.001);
        let ct: Vec<f64> = far.chain(near).collect();
        let range = Range::of(&ct, None).unwrap();
        assert!(range.more_below && !range.more_above);
        assert!(range.low > -1.5 && range.high == 0.909, "{range:?}");
    }

    #[test]
    fn a_small_thing_in_front_of_a_flat_wall_is_within_the_range() {
        let wall = (0..980).map(|i| -5.0 - 1e-4 * f64::from(i));
        let ct: Vec<f64> = wall.chain([-2.0; 20]).collect();
        let range = Range::of(&ct, None).unwrap();
        assert_eq!((range.high, range.more_above), (-2.0, false));
    }

    #[test]
    fn pictures_of_one_time_or_none_have_a_range_or_none() {
        assert_eq!(Range::of(&[f64::NAN, f64::INFINITY], None), None);
        for ct in [0.0, 5.0, -1e300, 1e-300, f64::MAX] {
            let range = Range::of(&[ct, ct], None).unwrap();
            assert!(
                range.low < ct && ct < range.high || ct == f64::MAX,
                "{range:?}"
            );
            assert!(range.step > 0.0);
        }
    }
}
