use super::*;

#[test]
fn a_grid_finds_what_is_near_and_forgets_what_was_taken_out() {
    let mut grid = Grid::new(32.0);
    let at = |x: f64, y: f64| moved(UNIT, [x, y]);
    for (index, place) in [[0.0, 0.0], [31.5, 0.0], [500.0, 700.0], [1e300, -1e300]]
        .iter()
        .enumerate()
    {
        grid.insert(index, at(place[0], place[1]));
    }
    assert_eq!(grid.near(widened(UNIT, 40.0)), [0, 1]);
    assert_eq!(grid.near(at(500.5, 700.5)), [2]);
    assert_eq!(grid.near(at(1e299, -1e301)), [3]);
    grid.remove(1, at(31.5, 0.0));
    assert_eq!(grid.near(widened(UNIT, 40.0)), [0]);
}

#[test]
fn a_search_of_a_crowded_place_looks_at_a_bounded_number() {
    let mut grid = Grid::new(32.0);
    (0..5000).for_each(|index| grid.insert(index, moved(UNIT, [index as f64 * 1e-3, 0.0])));
    let found = grid.near(widened(UNIT, 20.0));
    assert!(
        (8..=Grid::MOST_FOUND).contains(&found.len()),
        "{}",
        found.len()
    );
    (0..5000).for_each(|index| grid.remove(index, moved(UNIT, [index as f64 * 1e-3, 0.0])));
    assert!(grid.near(widened(UNIT, 20.0)).is_empty());
}

#[test]
fn a_grid_finds_the_lines_that_cross_a_rectangle() {
    let ends = |k: usize| {
        [
            [k as f64 * 7.3 % 90.0, k as f64 * 3.1 % 70.0],
            [k as f64 * 5.7 % 80.0, k as f64 * 9.9 % 95.0],
        ]
    };
    let mut grid = Grid::new(8.0);
    for k in 0..200 {
        grid.insert_line(k, &ends(k));
    }
    for place in 0..100 {
        let rect = moved(UNIT, [place as f64 * 3.7 % 88.0, place as f64 * 1.9 % 92.0]);
        let crossed = |k: &usize| rect.is_crossed(ends(*k)[0], ends(*k)[1]);
        let found: Vec<usize> = grid.near(rect).into_iter().filter(crossed).collect();
        let all: Vec<usize> = (0..200).filter(crossed).collect();
        assert_eq!(found, all);
    }
}

const UNIT: Rect = Rect {
    min: [0.0; 2],
    max: [1.0; 2],
};

#[test]
fn rectangles_are_apart_by_their_nearest_points() {
    assert_eq!(distance(UNIT, moved(UNIT, [0.5, 0.5])), 0.0);
    assert_eq!(distance(UNIT, moved(UNIT, [4.0, 5.0])), 5.0);
}

#[test]
fn words_follow_each_other_on_a_line_or_as_indices_and_not_from_line_to_line() {
    let follows = |by: [f64; 2]| is_next_word(UNIT, moved(UNIT, by), 2.0);
    assert!(follows([2.5, 0.0]) && follows([-2.5, 0.4]));
    assert!(follows([1.5, -0.9]));
    assert!(!follows([3.5, 0.0]) && !follows([2.0, 1.1]) && !follows([0.0, 1.5]));
}

#[test]
fn lines_cross_a_rectangle_or_miss_it() {
    assert!(UNIT.is_crossed([-1.0, 0.5], [2.0, 0.6]));
    assert!(!UNIT.is_crossed([-1.0, 0.5], [0.4, 2.0]));
    assert!(!UNIT.is_crossed([2.0, 0.5], [3.0, 0.5]));
}

#[test]
fn a_line_is_interrupted_at_rectangles_that_may_overlap() {
    let ends = [[-1.0, 0.5], [9.0, 0.5]];
    assert_eq!(without(ends, &[]), [ends]);
    let gaps = [4.0, 0.0, 0.5].map(|x| moved(UNIT, [x, 0.0]));
    assert_eq!(
        without(ends, &gaps),
        [
            [[-1.0, 0.5], [0.0, 0.5]],
            [[1.5, 0.5], [4.0, 0.5]],
            [[5.0, 0.5], [9.0, 0.5]]
        ]
    );
    // At its ends, and where nothing is left.
    assert_eq!(
        without([[0.5, 0.5], [3.0, 0.5]], &[UNIT]),
        [[[1.0, 0.5], [3.0, 0.5]]]
    );
    assert!(without([[0.2, 0.5], [0.8, 0.5]], &[UNIT]).is_empty());
}

#[test]
fn points_are_inside_polygons_that_are_not_convex() {
    let edge = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [2.0, 1.0], [0.0, 4.0]];
    assert!(is_inside([0.5, 2.0], &edge));
    assert!(!is_inside([2.0, 2.0], &edge));
    assert!(!is_inside([5.0, 0.5], &edge));
}
