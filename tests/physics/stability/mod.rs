//! Numerical stability at the ends of the supported ranges, against arbitrary precision.
//!
//! `src/validate/selftest` defines the regimes, the units of errors and the derivations of their bounds. Here each is tested with thousands
//! of cases, with references computed with 320 bits and more; the rows of `nullray selftest` are a part of them; and the worst errors
//! stated on the page of `src/validate/selftest` are compared with measurements.

mod cases;
mod limits;
mod page;
mod reference;
mod rows;
mod vertices;

use nullray::validate::selftest::{Effort, Outcome, REGIMES, Regime, Row, checks};

/// Cases of each family.
const CASES: usize = 1500;

/// What is found in the first `CASES` cases of each family of a regime.
fn measured(regime: &Regime) -> Outcome {
    let rows: Vec<Row> = regime
        .families
        .iter()
        .flat_map(|family| rows::of_family(family, CASES))
        .collect();
    regime.worst(rows.iter())
}

#[test]
fn every_regime_is_within_its_bound_of_arbitrary_precision() {
    for regime in &REGIMES {
        let Outcome { worst, cases, .. } = measured(regime);
        let (name, bound, unit) = (regime.name, regime.bound, regime.unit);
        println!("{name:<14} {worst:9.2e} of {bound:8.1e} {unit}, {cases} cases");
        assert!(cases >= CASES as u64);
        assert!(worst <= bound, "{name}: {worst} above {bound} {unit}");
    }
}

#[test]
fn the_self_test_holds_on_this_machine() {
    // Not those that take seconds each: the test of the command that runs them takes all.
    const LONG: [&str; 5] = ["corners", "fans", "large", "kernels", "presets"];
    for check in checks() {
        if LONG.contains(&check.name) {
            continue;
        }
        let outcome = check
            .run(Effort::Quick, &nullray::render::progress::Silent)
            .unwrap();
        assert!(check.holds(&outcome), "{}: {outcome:?}", check.name);
        let announced = check.cases(Effort::Quick);
        let close = outcome.cases.abs_diff(announced) < 1024;
        assert!(close, "{}: {outcome:?}, {announced} announced", check.name);
    }
}

#[test]
fn a_wrong_reference_is_noticed() {
    // An error of a hundred units in any result of any row is above every bound.
    for regime in REGIMES.iter().filter(|r| r.unit != "pixel") {
        let mut noticed = 0;
        for row in regime.rows() {
            for at in 0..row.reference.len() {
                let mut wrong = row.clone();
                let fine = &mut wrong.reference[at];
                fine.value *= 1.0 + 1e-9;
                let was = row.reference[at].value;
                noticed += usize::from(was != fine.value && regime.error(&wrong) > regime.bound);
            }
        }
        assert!(noticed > 0, "{}", regime.name);
    }
}
