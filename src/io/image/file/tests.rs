use super::*;

fn names(directory: &Path) -> Vec<String> {
    let entries = fs::read_dir(directory).unwrap();
    let mut names: Vec<_> = entries
        .map(|e| e.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

#[cfg(unix)]
#[test]
fn who_may_read_a_file_is_as_before_when_it_is_replaced() {
    use std::os::unix::fs::PermissionsExt;
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("a.bin");
    for mode in [0o600, 0o664, 0o444] {
        fs::write(&path, "old").unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(mode)).unwrap();
        write_atomically(&path, |w| w.write_all(b"new").map_err(write_failed(&path))).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        let now = fs::metadata(&path).unwrap().permissions().mode();
        assert_eq!(now & 0o777, mode);
        fs::remove_file(&path).unwrap();
    }
}

#[test]
fn a_failure_leaves_the_old_file_and_nothing_else() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("a.bin");
    fs::write(&path, "old").unwrap();
    let failed = write_atomically(&path, |w| {
        w.write_all(b"half of the new").unwrap();
        Err(Error::Cancelled)
    });
    assert!(matches!(failed, Err(Error::Cancelled)));
    assert_eq!(fs::read_to_string(&path).unwrap(), "old");
    assert_eq!(names(directory.path()), ["a.bin"]);
}

#[test]
fn success_replaces_the_old_file() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("a.bin");
    fs::write(&path, "old and longer").unwrap();
    write_atomically(&path, |w| write_all(w, &path, b"new")).unwrap();
    assert_eq!(fs::read_to_string(&path).unwrap(), "new");
    assert_eq!(names(directory.path()), ["a.bin"]);
}

#[test]
fn writers_at_the_same_time_leave_one_whole_file() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("a.bin");
    std::thread::scope(|scope| {
        for byte in 0..8u8 {
            let path = &path;
            scope.spawn(move || {
                let bytes = vec![byte; 100_000];
                write_atomically(path, |w| write_all(w, path, &bytes)).unwrap();
            });
        }
    });
    let bytes = fs::read(&path).unwrap();
    assert_eq!(bytes, vec![bytes[0]; 100_000]);
    assert_eq!(names(directory.path()), ["a.bin"]);
}

#[test]
fn a_missing_directory_is_an_error_that_names_the_file() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("missing").join("a.bin");
    let error = write_atomically(&path, |_| Ok(())).unwrap_err();
    assert!(matches!(&error, Error::Io { path: p, .. } if *p == path));
    assert!(error.to_string().contains("cannot write"), "{error}");
}

#[test]
fn a_directory_is_not_replaced() {
    let directory = tempfile::tempdir().unwrap();
    let error = write_atomically(directory.path(), |_| Ok(())).unwrap_err();
    assert!(error.to_string().contains("not a file"), "{error}");
}

#[cfg(unix)]
#[test]
fn a_link_is_followed() {
    let directory = tempfile::tempdir().unwrap();
    let [real, link] = ["real", "link"].map(|name| directory.path().join(name));
    fs::write(&real, "old").unwrap();
    std::os::unix::fs::symlink(&real, &link).unwrap();
    write_atomically(&link, |w| write_all(w, &link, b"new")).unwrap();
    assert_eq!(fs::read_to_string(&real).unwrap(), "new");
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
}

#[cfg(unix)]
#[test]
fn a_link_to_nothing_is_refused_and_stays() {
    let directory = tempfile::tempdir().unwrap();
    let link = directory.path().join("link");
    std::os::unix::fs::symlink("nowhere", &link).unwrap();
    let error = write_atomically(&link, |_| Ok(())).unwrap_err();
    assert!(error.to_string().contains("a link to nowhere"), "{error}");
    assert_eq!(names(directory.path()), ["link"]);
}
