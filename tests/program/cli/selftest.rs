//! `nullray selftest`.

use serde_json::Value;

use super::Folder;

#[test]
fn the_self_test_holds_and_says_every_check_once() {
    let said = Folder::empty().ok(&["selftest"]);
    let checks = nullray::validate::selftest::checks();
    for check in &checks {
        let lines = said
            .lines()
            .filter(|line| line.split(' ').next() == Some(check.name));
        assert_eq!(lines.count(), 1, "{}:\n{said}", check.name);
    }
    let verdict = format!("all {} checks hold\n", checks.len());
    assert!(said.ends_with(&verdict), "{said}");
    assert!(!said.contains("FAIL"), "{said}");
}

#[test]
fn checks_are_chosen_by_name_and_an_unknown_one_is_refused_with_those_there_are() {
    let said = Folder::empty().ok(&["selftest", "--check", "horizon", "--check", "events"]);
    assert!(said.ends_with("all 2 checks hold\n"), "{said}");
    let run = Folder::empty().run(&["selftest", "--check", "horizons"]);
    assert_eq!((run.code, run.stdout.as_str()), (2, ""));
    assert!(
        run.message().contains("there is no check \"horizons\""),
        "{}",
        run.stderr
    );
    assert!(
        run.message().contains("aberration, wavelength"),
        "{}",
        run.stderr
    );
}

#[test]
fn as_json_it_is_one_value_that_tells_bounds_and_worst_errors() {
    let said = Folder::empty().ok(&["selftest", "--json", "--threads", "1"]);
    let report: Value = serde_json::from_str(&said).unwrap();
    assert_eq!(report["holds"], true);
    assert_eq!(
        (&report["thorough"], &report["threads"]),
        (&false.into(), &1.into())
    );
    let checks = report["checks"].as_array().unwrap();
    assert_eq!(checks.len(), nullray::validate::selftest::checks().len());
    for check in checks {
        let number = |key: &str| check[key].as_f64().unwrap();
        assert!(number("worst") <= number("bound"), "{check}");
        assert!(number("cases") > 0.0 && number("seconds") >= 0.0, "{check}");
    }
}
