//! The rows that the self-test carries.

use std::path::Path;

use nullray::selftest::{REGIMES, Row, embedded};

use crate::{cases, reference};

/// Rows of each family that are carried.
const CARRIED: usize = 12;

/// The first `count` cases of a family, with their references.
pub fn of_family(family: &str, count: usize) -> Vec<Row> {
    let row = |index| {
        let inputs = cases::inputs(family, index);
        let reference = reference::of(family, &inputs);
        let family = family.into();
        Row {
            family,
            inputs,
            reference,
        }
    };
    (0..count).map(row).collect()
}

#[test]
fn the_rows_of_the_self_test_are_what_arbitrary_precision_gives() {
    let mut families: Vec<&str> = Vec::new();
    for family in REGIMES.iter().flat_map(|regime| regime.families) {
        if !families.contains(family) {
            families.push(family);
        }
    }
    let rows = families
        .iter()
        .flat_map(|family| of_family(family, CARRIED));
    let text: String = rows.map(|row| row.line() + "\n").collect();
    let carried: String = embedded().iter().map(|row| row.line() + "\n").collect();
    let right = Path::new(env!("CARGO_TARGET_TMPDIR")).join("rows.csv");
    std::fs::write(&right, &text).unwrap();
    assert!(text.len() < 60_000, "{} bytes", text.len());
    assert!(
        text == carried,
        "src/selftest/rows.csv holds other rows than {}",
        right.display()
    );
}
