use super::*;

fn pattern(name: &str) -> Option<(String, String)> {
    Pattern::of(Path::new(name)).map(|p| (p.before, p.after))
}

#[test]
fn placeholders_of_python_c_and_hashes_are_known() {
    for name in [
        "a/f_{i:03d}.exr",
        "f_{:d}.exr",
        "f_{}.exr",
        "f_{frame}.exr",
        "f_%04d.exr",
        "f_%d.exr",
        "f_###.exr",
    ] {
        assert_eq!(pattern(name), Some(("f_".into(), ".exr".into())), "{name}");
    }
    for name in [
        "f.exr",
        "f_{i:03f}.exr",
        "f_%s.exr",
        "f_100%.exr",
        "a%04d/f.exr",
    ] {
        assert_eq!(pattern(name), None, "{name}");
    }
}

#[test]
fn a_file_that_has_the_name_of_a_pattern_is_that_file() {
    let names = ["shot#1.png", "run_%d.png", "x{i}.png", "run#2.npy"];
    let found = folder(&[&names[..], &["shot01.png", "run_0.png", "x0.png"]].concat());
    for name in &names[..3] {
        let path = found.path().join(name);
        assert_eq!(
            pictures(&path).unwrap(),
            std::slice::from_ref(&path),
            "{name}"
        );
    }
    assert!(!is_sequence(&found.path().join("run#2.npy")));
    // Unless such a file exists, it is a pattern.
    let numbered = pictures(&found.path().join("shot#.png")).unwrap();
    assert_eq!(numbered, [found.path().join("shot01.png")]);
}

fn folder(names: &[&str]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for name in names {
        fs::write(folder.path().join(name), "").unwrap();
    }
    folder
}

#[test]
fn files_are_ordered_by_their_numbers_and_none_is_missing() {
    let found = folder(&["f8.exr", "f10.exr", "f9.exr", "notes.txt", "steady.exr"]);
    let names: Vec<_> = pictures(found.path())
        .unwrap()
        .iter()
        .map(|f| file_name(f))
        .collect();
    assert_eq!(names, ["f8.exr", "f9.exr", "f10.exr"]);
    for (names, wrong) in [
        (
            &["f1.exr", "f4.exr", "f05.exr"][..],
            "between the first and the last: 2, 3",
        ),
        (&["f1.exr", "f01.exr"], "same number"),
        (&["f1.exr", "g1.exr"], "several sequences"),
        (&["f1.exr", "f1.png"], "several sequences"),
        (&["a.exr"], "no numbered pictures"),
        (
            &["f1.exr", "f900000000000000000.exr"],
            "899999999999999988 more",
        ),
    ] {
        let error = pictures(folder(names).path()).unwrap_err().to_string();
        assert!(error.contains(wrong), "{names:?}: {error}");
    }
    let several = folder(&["f_0001.exr", "f_0002.exr", "f_0001_variance.exr"]);
    let named = pictures(&several.path().join("f_%04d.exr")).unwrap();
    assert_eq!(named.len(), 2);
    let error = pictures(&several.path().join("g_%04d.exr"))
        .unwrap_err()
        .to_string();
    assert!(error.contains("no file g_number.exr"), "{error}");
}
