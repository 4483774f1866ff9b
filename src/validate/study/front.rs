//! Which results no other beats.

/// For each pair (time, error), whether no other is at least as good in both and better in one. Pairs that
/// are not finite are not.
pub(super) fn front(results: &[[f64; 2]]) -> Vec<bool> {
    let finite = |r: &[f64; 2]| r.iter().all(|x| x.is_finite());
    let beats = |a: &[f64; 2], b: &[f64; 2]| a[0] <= b[0] && a[1] <= b[1] && a != b;
    let unbeaten = |r: &[f64; 2]| !results.iter().any(|other| finite(other) && beats(other, r));
    results.iter().map(|r| finite(r) && unbeaten(r)).collect()
}

#[cfg(test)]
mod tests {
    use super::front;

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
