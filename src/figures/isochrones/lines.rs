//! Isochrones as lines, without those that would be too close together.

use super::chain::{Points, polylines};
use super::contour::{Grid, pieces};
use super::range::Range;
use crate::figures::drawing::Path;

/// Open lines of less length are left out, in pixels of the grid: crumbs between the jumps at edges.
const SHORTEST: f64 = 6.0;
/// Every how many lines one is heavy.
const HEAVY: i64 = 5;

/// The lines of one time.
pub(crate) struct Isochrone {
    /// Its time is this many steps.
    pub number: i64,
    /// In pixels of the grid.
    pub lines: Vec<Points>,
}

/// Whether line `number` is one of every five.
pub(crate) fn is_heavy(number: i64) -> bool {
    number % HEAVY == 0
}

/// The isochrones of a grid, in order of time. Where there are more than `crowded` lines per pixel only the heavy ones are kept, unless
/// these are too close, too.
pub(crate) fn isochrones(grid: &Grid, range: &Range, crowded: f64) -> Vec<Isochrone> {
    let all = pieces(grid, range).into_iter().zip(range.lines());
    let isochrones = all.map(|(pieces, number)| {
        let most = match is_heavy(number) {
            true => HEAVY as f64 * crowded,
            false => crowded,
        };
        let lines = polylines(&pieces).into_iter();
        let lines = lines.filter(|line| line.density <= most && !is_crumb(&line.points));
        Isochrone {
            number,
            lines: lines.map(|line| line.points).collect(),
        }
    });
    isochrones.collect()
}

/// Whether the line is open and short.
fn is_crumb(points: &[[f64; 2]]) -> bool {
    let steps = points.iter().zip(points.iter().skip(1));
    let length: f64 = steps.map(|(a, b)| (b[0] - a[0]).hypot(b[1] - a[1])).sum();
    points.first() != points.last() && length < SHORTEST
}

/// Lines as one path, with each point at its `place`: a translucent line is not darker where its parts meet, and borders do not cover other
/// lines of their kind.
pub(crate) fn path_of<'a>(
    lines: impl IntoIterator<Item = &'a Points>,
    place: impl Fn([f64; 2]) -> [f64; 2],
) -> Path {
    let contours = lines.into_iter().map(|line| {
        let points: Points = line.iter().map(|p| place(*p)).collect();
        match line.split_last() {
            Some((last, rest)) if rest.len() > 2 && rest.first() == Some(last) => {
                Path::polygon(&points[..rest.len()])
            }
            _ => Path::polyline(&points),
        }
    });
    contours.fold(Path::default(), Path::and)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crumbs_are_left_out_and_small_rings_and_long_lines_stay() {
        assert!(is_crumb(&[[0.0, 0.0], [3.0, 4.0]]));
        assert!(!is_crumb(&[[0.0, 0.0], [3.0, 4.0], [6.0, 8.0]]));
        assert!(!is_crumb(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 0.0]]));
    }
}
