//! `nullray selftest`.

use nullray::validate::selftest::Effort;
use serde_json::Value;

use super::Folder;

/// All of the self-test: the others take parts of it.
#[test]
fn the_self_test_holds_and_says_every_check_once() {
    let said = Folder::empty().ok(&["selftest"]);
    let checks = nullray::validate::selftest::checks();
    for check in &checks {
        let lines = said
            .lines()
            .filter(|line| line.split(' ').next() == Some(check.name));
        let lines: Vec<&str> = lines.collect();
        assert_eq!(lines.len(), 1, "{}:\n{said}", check.name);
        // Whole batches: there may be a few cases more than are announced.
        let cases = lines[0].rsplit(' ').next().unwrap().replace(',', "");
        let announced = check.cases(Effort::Quick);
        let close = cases.parse::<u64>().unwrap().abs_diff(announced) < 1024;
        assert!(close, "{}, {announced} announced", lines[0]);
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

/// Checks that take seconds each.
const LONG: [&str; 5] = ["corners", "fans", "large", "kernels", "presets"];

#[test]
fn as_json_it_is_one_value_that_tells_bounds_and_worst_errors() {
    let mut asked = nullray::validate::selftest::checks();
    let all = asked.len();
    asked.retain(|check| !LONG.contains(&check.name));
    assert_eq!(asked.len(), all - LONG.len());
    let mut command = vec!["selftest", "--json", "--threads", "1"];
    command.extend(asked.iter().flat_map(|check| ["--check", check.name]));
    let said = Folder::empty().ok(&command);
    let report: Value = serde_json::from_str(&said).unwrap();
    assert_eq!(report["holds"], true);
    assert_eq!(
        (&report["thorough"], &report["threads"]),
        (&false.into(), &1.into())
    );
    let checks = report["checks"].as_array().unwrap();
    assert_eq!(checks.len(), asked.len());
    for (check, asked) in checks.iter().zip(asked) {
        let number = |key: &str| check[key].as_f64().unwrap();
        assert_eq!(check["name"], asked.name);
        assert!(number("worst") <= number("bound"), "{check}");
        assert!(number("cases") > 0.0 && number("seconds") >= 0.0, "{check}");
    }
}
