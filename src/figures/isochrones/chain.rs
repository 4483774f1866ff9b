//! Pieces of lines, joined to polylines.

use std::collections::BTreeMap;

use super::contour::{Crossing, Piece};

/// Points in pixels.
pub(crate) type Points = Vec<[f64; 2]>;

/// A line; closed if its first point is its last.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Polyline {
    pub points: Points,
    /// Average number of lines per pixel along this one.
    pub density: f64,
}

/// Joins the pieces of one line: at most two pieces meet at an edge of the grid.
pub(crate) fn polylines(pieces: &[Piece]) -> Vec<Polyline> {
    let mut ends: BTreeMap<usize, [Option<usize>; 2]> = BTreeMap::new();
    for (index, piece) in pieces.iter().enumerate() {
        for crossing in piece.ends {
            let pair = ends.entry(crossing.edge).or_default();
            if let Some(free) = pair.iter_mut().find(|end| end.is_none()) {
                *free = Some(index);
            }
        }
    }
    let mut used = vec![false; pieces.len()];
    let mut lines = Vec::new();
    // Open lines from their ends first; the remaining ones are closed.
    let open = ends.values().filter_map(|pair| match pair {
        [Some(index), None] => Some(*index),
        _ => None,
    });
    for start in open.chain(0..pieces.len()) {
        if !used[start] {
            lines.push(follow(pieces, &ends, &mut used, start));
        }
    }
    lines
}

/// The polyline through piece `start`, which is at its beginning or lies on a closed one.
fn follow(
    pieces: &[Piece],
    ends: &BTreeMap<usize, [Option<usize>; 2]>,
    used: &mut [bool],
    start: usize,
) -> Polyline {
    let next_at = |crossing: &Crossing, used: &[bool]| {
        let pair = ends.get(&crossing.edge)?;
        pair.iter().flatten().copied().find(|&index| !used[index])
    };
    used[start] = true;
    let Piece {
        ends: [a, b],
        mut density,
    } = pieces[start];
    // An open line begins at the end that no other piece shares.
    let a_goes_on = next_at(&a, used).is_some();
    let b_goes_on = next_at(&b, used).is_some();
    let (first, mut head) = if a_goes_on && !b_goes_on {
        (b, a)
    } else {
        (a, b)
    };
    let mut points = vec![first.at, head.at];
    while let Some(index) = next_at(&head, used) {
        used[index] = true;
        let [a, b] = pieces[index].ends;
        density += pieces[index].density;
        head = if a.edge == head.edge { b } else { a };
        points.push(head.at);
    }
    density /= points.len() as f64 - 1.0;
    Polyline { points, density }
}

#[cfg(test)]
mod tests;
