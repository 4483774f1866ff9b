//! The errors stated on the page of the self-test, against measurements.

use nullray::validate::selftest::{Check, REGIMES, checks};

use crate::stability::measured;

const PAGE: &str = include_str!("../../../src/validate/selftest/README.md");

/// A row of the page's table: name, what, unit, bound, worst.
fn rows() -> Vec<[&'static str; 5]> {
    let rows = PAGE.lines().filter(|line| line.starts_with("| `"));
    let cells = |row: &'static str| {
        let cells: Vec<&str> = row.trim_matches('|').split(" | ").map(str::trim).collect();
        cells
            .try_into()
            .unwrap_or_else(|_| panic!("five cells in {row}"))
    };
    rows.map(cells).collect()
}

fn row_of(check: &Check, worst: &str) -> String {
    let Check {
        name,
        what,
        unit,
        bound,
        ..
    } = check;
    let bound = match *bound {
        x if x > 0.0 && x < 0.01 => format!("{x:e}"),
        x => x.to_string(),
    };
    format!("| `{name}` | {what} | {unit} | {bound} | {worst} |")
}

#[test]
fn the_page_holds_every_check_with_its_unit_and_bound() {
    let (rows, checks) = (rows(), checks());
    let right: String = checks.iter().map(|c| row_of(c, "…") + "\n").collect();
    assert_eq!(rows.len(), checks.len(), "{right}");
    for (row, check) in rows.iter().zip(&checks) {
        let [.., worst] = row;
        assert!(
            PAGE.contains(&row_of(check, worst)),
            "{row:?}, not\n{}",
            row_of(check, "…")
        );
    }
}

#[test]
fn the_page_says_the_worst_errors_as_they_are_measured() {
    for regime in &REGIMES {
        let name = format!("`{}`", regime.name);
        let row = rows().into_iter().find(|row| row[0] == name).unwrap();
        let said: f64 = row[4].parse().unwrap();
        let worst = measured(regime).worst;
        // Rounded up to two digits, and with room for a compiler's other choice.
        let stale = said > 1.3 * worst && said > worst + 0.1;
        assert!(
            worst <= said && !stale,
            "{name}: {worst:.3e} is measured, {said} said"
        );
    }
}
