//! Medians and other quantiles, and Pareto fronts.

/// The `part` quantile of `values`, 0 to 1, linear between ranks; NaN if there are none. NaN counts as largest.
pub(super) fn quantile(values: &[f64], part: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let Some(last) = sorted.len().checked_sub(1) else {
        return f64::NAN;
    };
    let place = part.clamp(0.0, 1.0) * last as f64;
    let below = place.floor() as usize;
    let above = (below + 1).min(last);
    match place - below as f64 {
        0.0 => sorted[below],
        rest => sorted[below] + (sorted[above] - sorted[below]) * rest,
    }
}

/// For each pair (time, error), whether no other is at least as good in both and better in one. Pairs that are not finite do not count.
pub(super) fn front(results: &[[f64; 2]]) -> Vec<bool> {
    let finite = |r: &[f64; 2]| r.iter().all(|x| x.is_finite());
    let beats = |a: &[f64; 2], b: &[f64; 2]| a[0] <= b[0] && a[1] <= b[1] && a != b;
    let unbeaten = |r: &[f64; 2]| !results.iter().any(|other| finite(other) && beats(other, r));
    results.iter().map(|r| finite(r) && unbeaten(r)).collect()
}

/// The indices of the shortest of these times whose sum is at most `most`, and those of the others; both in their order.
pub(super) fn within(times: &[f64], most: f64) -> (Vec<usize>, Vec<usize>) {
    let mut sorted: Vec<usize> = (0..times.len()).collect();
    sorted.sort_by(|a, b| times[*a].total_cmp(&times[*b]));
    let mut sum = 0.0;
    let is_within = |index: &&usize| {
        sum += times[**index];
        sum <= most
    };
    let count = sorted.iter().take_while(is_within).count();
    let mut others = sorted.split_off(count);
    sorted.sort_unstable();
    others.sort_unstable();
    (sorted, others)
}

#[cfg(test)]
mod tests {
    use super::{front, quantile, within};

    #[test]
    fn the_shortest_times_are_within_the_sum() {
        let times = [4.0, 1.0, 9.0, 2.0, 3.0];
        assert_eq!(within(&times, 6.0), (vec![1, 3, 4], vec![0, 2]));
        assert_eq!(within(&times, 0.5), (vec![], vec![0, 1, 2, 3, 4]));
        assert!(within(&times, f64::INFINITY).1.is_empty());
    }

    #[test]
    fn quantiles_lie_between_ranks() {
        let values = [4.0, 1.0, 3.0, 2.0];
        assert_eq!(quantile(&values, 0.0), 1.0);
        assert_eq!(quantile(&values, 0.5), 2.5);
        assert_eq!(quantile(&values, 1.0), 4.0);
        assert_eq!(quantile(&[7.0], 0.3), 7.0);
        assert!(quantile(&[], 0.5).is_nan());
    }

    #[test]
    fn an_infinite_value_does_not_spoil_the_median() {
        assert_eq!(quantile(&[1.0, f64::INFINITY, 2.0], 0.5), 2.0);
    }

    #[test]
    fn what_is_slower_and_worse_than_another_is_not_on_the_front() {
        let results = [[1.0, 4.0], [2.0, 2.0], [3.0, 3.0], [4.0, 1.0], [4.0, 1.5]];
        assert_eq!(front(&results), [true, true, false, true, false]);
    }

    #[test]
    fn equals_share_the_front_and_what_is_unknown_is_not_on_it() {
        assert_eq!(
            front(&[[1.0, 1.0], [1.0, 1.0], [0.5, f64::NAN]]),
            [true, true, false]
        );
    }
}
