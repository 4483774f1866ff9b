//! Bilinear weights of texels, texel (i, j) centred at (x, y) = (j + ½, i + ½).

/// One texel and its weight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Tap {
    /// Row · width + column.
    pub texel: usize,
    /// In [0, 1].
    pub weight: f64,
}

/// The four taps around `(x, y)` texels from the top left corner of an image of `width` × `height`, in row order. Weights sum to 1.
/// Positions beyond the outermost centres (or NaN) are clamped to them.
#[inline]
pub(super) fn taps(x: f64, y: f64, width: usize, height: usize) -> [Tap; 4] {
    let (left, right, fx) = neighbours(x, width);
    let (top, bottom, fy) = neighbours(y, height);
    let tap = |row: usize, column: usize, weight: f64| Tap {
        texel: row * width + column,
        weight,
    };
    [
        tap(top, left, (1.0 - fx) * (1.0 - fy)),
        tap(top, right, fx * (1.0 - fy)),
        tap(bottom, left, (1.0 - fx) * fy),
        tap(bottom, right, fx * fy),
    ]
}

/// The two cells of `count` whose centres enclose `x`, and the weight of the second.
#[inline]
fn neighbours(x: f64, count: usize) -> (usize, usize, f64) {
    let last = count - 1;
    // max first: it turns NaN into 0. Then x ≥ 0, and the conversion to an integer is the floor.
    let x = (x - 0.5).max(0.0).min(last as f64);
    let first = (x as usize).min(last);
    (first, (first + 1).min(last), x - first as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_texel_centre_reads_that_texel_alone() {
        let at = taps(2.5, 1.5, 4, 3);
        assert_eq!(
            at[0],
            Tap {
                texel: 6,
                weight: 1.0
            }
        );
        assert!(at[1..].iter().all(|tap| tap.weight == 0.0));
    }

    #[test]
    fn within_half_a_texel_of_the_edge_the_edge_texel_stands_in() {
        let corner = taps(0.0, 3.0, 4, 3);
        let weight: f64 = corner
            .iter()
            .filter(|t| t.texel == 8)
            .map(|t| t.weight)
            .sum();
        assert_eq!(weight, 1.0);
    }

    proptest! {
        #[test]
        fn bilinear_functions_are_reproduced_between_centres(x in 0.5f64..6.5, y in 0.5f64..4.5) {
            let f = |x: f64, y: f64| 2.0 - 3.0 * x + 0.5 * y + 0.25 * x * y;
            let sum: f64 = taps(x, y, 7, 5)
                .iter()
                .map(|t| t.weight * f((t.texel % 7) as f64 + 0.5, (t.texel / 7) as f64 + 0.5))
                .sum();
            prop_assert!((sum - f(x, y)).abs() < 1e-13);
        }

        #[test]
        fn every_place_even_none_gives_taps_in_range(
            x in prop::num::f64::ANY, y in prop::num::f64::ANY, w in 1usize..5, h in 1usize..5,
        ) {
            let taps = taps(x, y, w, h);
            prop_assert!(taps.iter().all(|t| t.texel < w * h && t.weight >= 0.0));
            let sum: f64 = taps.iter().map(|t| t.weight).sum();
            prop_assert!((sum - 1.0).abs() < 1e-15);
        }
    }
}
