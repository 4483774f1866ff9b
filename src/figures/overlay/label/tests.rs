use super::*;

#[test]
fn a_level_label_is_at_the_first_free_place_that_no_line_goes_through() {
    let upright: Polyline = vec![[100.0, 0.0], [100.0, 200.0]];
    let level: Polyline = vec![[120.0, 44.0], [160.0, 44.0]];
    let labels = |lines: &[&Polyline]| {
        let mut labels = Labels::new([300.0, 200.0]);
        let lines = lines.iter().copied().cloned();
        lines.for_each(|line| labels.keep_off_line(line));
        labels
    };
    let places = [[95.0, 50.0], [140.0, 50.0], [200.0, 50.0]];
    let at = |places: &[[f64; 2]], height| labels(&[&upright]).level(places, [30.0, height]);
    assert_eq!(at(&places, 8.0), Some(places[1]));
    assert_eq!(at(&places[..1], 8.0), Some(places[0]));
    // Where lines are clear of its height.
    let mut both = labels(&[&upright, &level]);
    assert_eq!(both.level(&places, [30.0, 8.0]), Some(places[1]));
    let at = |height| labels(&[&upright, &level]).level(&places, [30.0, height]);
    assert_eq!(at(14.0), Some(places[2]));
    // A place is taken once, and its lines are interrupted.
    assert_eq!(both.level(&places[1..2], [30.0, 8.0]), None);
    assert_eq!(both.level(&places[..1], [30.0, 8.0]), Some(places[0]));
    assert_eq!(both.beside(&upright).len(), 2);
    // Nothing is placed beyond the page.
    assert_eq!(
        both.level(&[[290.0, 150.0], [200.0, 2.0]], [30.0, 8.0]),
        None
    );
}

#[test]
fn a_label_is_where_no_other_line_goes_through_it() {
    let text = || RichText::plain("12 ns").unwrap();
    let line: Polyline = (0..=100)
        .map(|k| [2.0 * f64::from(k) + 50.0, 100.0])
        .collect();
    let middle = |others: &[Polyline]| {
        let mut labels = Labels::new([300.0, 200.0]);
        labels.keep_off_line(line.clone());
        others
            .iter()
            .for_each(|other| labels.keep_off_line(other.clone()));
        labels
            .along(&line, text(), Colour::WHITE)
            .unwrap()
            .map(|label| label.at)
    };
    // In the middle; if a line crosses there, clear of it; and still somewhere if lines cross everywhere.
    assert_eq!(middle(&[]), Some([150.0, 100.0]));
    let across = |x: f64| vec![[x, 0.0], [x + 3.0, 200.0]];
    let [x, y] = middle(&[across(150.0)]).unwrap();
    let half = 0.5 * text().width(SIZE).unwrap();
    assert!((x - 151.5).abs() > half && y == 100.0, "{x}, {y}");
    let everywhere: Vec<Polyline> = (0..60).map(|k| across(5.0 * f64::from(k))).collect();
    assert!(middle(&everywhere).is_some());
}

#[test]
fn a_line_is_interrupted_at_its_own_label_and_does_not_come_back_through_it() {
    let text = || RichText::plain("12 ns").unwrap();
    let half = 0.5 * text().width(SIZE).unwrap();
    let straight: Polyline = (0..=100)
        .map(|k| [2.0 * f64::from(k) + 50.0, 100.0])
        .collect();
    let along = |line: &Polyline| {
        let mut labels = Labels::new([300.0, 200.0]);
        labels.keep_off_line(line.clone());
        let label = labels.along(line, text(), Colour::WHITE).unwrap();
        (label.unwrap(), labels)
    };
    let (label, labels) = along(&straight);
    let [left, right] = &labels.beside(&straight)[..] else {
        panic!("two parts")
    };
    let ends = (left[0], right[right.len() - 1]);
    assert_eq!(ends, ([50.0, 100.0], [250.0, 100.0]));
    assert!(label.at[0] - left[left.len() - 1][0] > half);
    assert!(right[0][0] - label.at[0] > half);
    // Other lines that cross it are interrupted, too, and those that pass it are whole.
    let across = vec![[150.0, 50.0], [150.0, 150.0]];
    assert_eq!(labels.beside(&across).len(), 2);
    let aside = vec![[50.0, 110.0], [250.0, 110.0], [250.0, 150.0]];
    assert_eq!(labels.beside(&aside), vec![aside]);
    // A line that turns back beyond its end and passes over its middle.
    let mut back = straight;
    back.extend([[280.0, 140.0], [150.0, 140.0], [150.0, 60.0]]);
    let (label, _) = along(&back);
    let away = (label.at[0] - 150.0).abs();
    assert!(away > half || label.at[1] != 100.0, "{:?}", label.at);
}
