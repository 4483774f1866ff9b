//! The rows of the self-test: the worst of all cases, with their references.

use std::path::Path;

use nullray::validate::selftest::{REGIMES, Row, embedded};

use crate::stability::{CASES, cases, reference};

/// Rows of each regime and family that are carried.
const CARRIED: usize = 6;

/// The first `count` cases of a family, with their references.
pub fn of_family(family: &str, count: usize) -> Vec<Row> {
    (0..count)
        .map(|index| row(family, cases::inputs(family, index)))
        .collect()
}

fn row(family: &str, inputs: Vec<f64>) -> Row {
    Row {
        family: family.into(),
        reference: reference::of(family, &inputs),
        inputs,
    }
}

#[test]
fn the_rows_of_the_self_test_are_what_arbitrary_precision_gives() {
    let size = include_str!("../../../src/validate/selftest/rows.csv").len();
    assert!(size < 60_000, "{size} bytes");
    for carried in embedded() {
        let right = row(&carried.family, carried.inputs.clone());
        // As texts: NaN is what it is.
        assert_eq!(carried.line(), right.line());
    }
    for regime in &REGIMES {
        let of = |family: &&str| {
            embedded()
                .iter()
                .filter(|row| row.family == **family)
                .count()
        };
        let counts: Vec<usize> = regime.families.iter().map(of).collect();
        assert!(
            counts.iter().all(|&n| n >= CARRIED),
            "{}: {counts:?}",
            regime.name
        );
    }
}

#[test]
#[ignore = "writes target/tmp/rows.csv, to be carried"]
fn the_worst_cases_are_written_as_rows() {
    let mut lines: Vec<String> = Vec::new();
    for regime in &REGIMES {
        for family in regime.families {
            let mut rows = of_family(family, CASES);
            rows.sort_by(|a, b| regime.error(b).total_cmp(&regime.error(a)));
            let worst = rows.iter().take(CARRIED).map(|row| row.line() + "\n");
            lines.extend(worst);
        }
    }
    lines.sort();
    lines.dedup();
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("rows.csv");
    std::fs::write(path, lines.concat()).unwrap();
}
