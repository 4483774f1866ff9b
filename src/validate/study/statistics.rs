//! Medians and other quantiles.

/// The `part` quantile of `values`, 0 to 1, linear between ranks; NaN of nothing. NaN counts as largest.
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

#[cfg(test)]
mod tests {
    use super::quantile;

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
}
