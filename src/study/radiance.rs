//! How far the radiance of a picture is from that of a reference.

use serde::Serialize;

/// Errors of radiance; see the [module](super) for their definitions.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RadianceError {
    /// Root mean square error over the mean of the reference.
    pub rel_rmse: f64,
    /// Mean relative squared error.
    pub mrse: f64,
}

impl RadianceError {
    /// The error of `picture` against `reference`, of the same pixels.
    pub fn of(picture: &[[f64; 3]], reference: &[[f64; 3]]) -> Self {
        let count = (3 * reference.len()) as f64;
        let mean = reference.iter().flatten().sum::<f64>() / count;
        let floor = 1e-4 * mean * mean;
        let pairs = picture.iter().flatten().zip(reference.iter().flatten());
        let (squares, relative) = pairs.fold((0.0, 0.0), |(squares, relative), (x, r)| {
            let square = (x - r) * (x - r);
            // A pixel that is black in a black picture has no error.
            let part = if square > 0.0 {
                square / (r * r + floor)
            } else {
                0.0
            };
            (squares + square, relative + part)
        });
        RadianceError {
            rel_rmse: (squares / count).sqrt() / mean,
            mrse: relative / count,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_errors_are_those_of_their_definitions() {
        // m = 2; differences 1 at r = 1 and 0 at r = 3, on half of the values each.
        let error = RadianceError::of(&[[2.0; 3], [3.0; 3]], &[[1.0; 3], [3.0; 3]]);
        assert!((error.rel_rmse - 0.5f64.sqrt() / 2.0).abs() < 1e-15);
        assert!((error.mrse - 0.5 / (1.0 + 4e-4)).abs() < 1e-15);
    }

    #[test]
    fn a_picture_has_no_error_against_itself_even_where_it_is_black() {
        let error = RadianceError::of(&[[0.0; 3], [1.0; 3]], &[[0.0; 3], [1.0; 3]]);
        assert_eq!((error.rel_rmse, error.mrse), (0.0, 0.0));
    }
}
