//! Valid and invalid destinations of bundles.

use std::fs;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use nullray::Error;
use nullray::render::progress::{Progress, Silent};
use nullray::scene::{self, Overrides};
use nullray::validate::export::{ExportOptions, export};

const SCENE: &str = "camera = { eye = [0, 0, 4], look_at = [0, 0, 0], size = [8, 6] }\n\
                     object = [{ shape = { box = { size = [1, 1, 1] } } }]";

fn write(target: &Path, overwrite: bool, progress: &dyn Progress) -> Result<(), Error> {
    let scene = scene::parse(SCENE, "test", Path::new("."), &Overrides::default())?;
    let options = ExportOptions {
        overwrite,
        ..ExportOptions::default()
    };
    export(&scene, target, &options, progress).map(|_| ())
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<_> = entries
        .map(|e| e.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

#[test]
fn an_export_is_replaced_only_when_that_is_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let target = folder.path().join("bundle");
    write(&target, false, &Silent).unwrap();
    let refused = write(&target, false, &Silent).unwrap_err();
    assert!(
        refused.to_string().contains("an export of this name"),
        "{refused}"
    );
    fs::remove_file(target.join("README.md")).unwrap();
    write(&target, true, &Silent).unwrap();
    assert!(target.join("README.md").exists());
    assert_eq!(names(folder.path()), ["bundle"]);
}

#[test]
fn an_export_with_anything_else_in_it_is_not_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let target = folder.path().join("bundle");
    write(&target, false, &Silent).unwrap();
    for name in ["notes.txt", "geometry/mine.glb", "of-mine/a.txt"] {
        let mine = target.join(name);
        fs::create_dir_all(mine.parent().unwrap()).unwrap();
        fs::write(&mine, "of the user").unwrap();
        let refused = write(&target, true, &Silent).unwrap_err().to_string();
        let named = name.strip_suffix("/a.txt").unwrap_or(name);
        assert!(refused.contains(named), "{name}: {refused}");
        assert_eq!(fs::read_to_string(&mine).unwrap(), "of the user");
        assert_eq!(names(folder.path()), ["bundle"]);
        fs::remove_file(&mine).unwrap();
    }
    fs::remove_dir(target.join("of-mine")).unwrap();
    write(&target, true, &Silent).unwrap();
}

#[test]
fn a_list_that_leads_out_of_the_directory_removes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let (target, mine) = (folder.path().join("bundle"), folder.path().join("mine"));
    fs::write(&mine, "of the user").unwrap();
    fs::create_dir(&target).unwrap();
    for path in ["../mine", &mine.display().to_string()] {
        let list = serde_json::json!({ "format": "nullray-bundle", "files": [{ "path": path }] });
        fs::write(target.join("bundle.json"), list.to_string()).unwrap();
        let refused = write(&target, true, &Silent).unwrap_err().to_string();
        assert!(refused.contains("not an export"), "{refused}");
        assert!(mine.exists());
    }
}

#[test]
fn a_directory_that_is_not_an_export_is_never_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let target = folder.path().join("mine");
    fs::create_dir(&target).unwrap();
    fs::write(
        target.join("bundle.json"),
        "{ \"format\": \"of something else\" }",
    )
    .unwrap();
    let refused = write(&target, true, &Silent).unwrap_err();
    assert!(refused.to_string().contains("not an export"), "{refused}");
    assert_eq!(names(&target), ["bundle.json"]);
    assert_eq!(names(folder.path()), ["mine"]);
}

#[test]
fn an_empty_directory_is_filled() {
    let folder = tempfile::tempdir().unwrap();
    let target = folder.path().join("bundle");
    fs::create_dir(&target).unwrap();
    write(&target, false, &Silent).unwrap();
    assert!(target.join("bundle.json").exists());
}

#[test]
fn a_file_of_the_name_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let target = folder.path().join("file");
    fs::write(&target, "content").unwrap();
    let refused = write(&target, true, &Silent).unwrap_err();
    assert!(refused.to_string().contains("not a directory"), "{refused}");
    assert_eq!(fs::read_to_string(&target).unwrap(), "content");
}

#[test]
fn an_export_that_is_stopped_leaves_nothing_behind() {
    let folder = tempfile::tempdir().unwrap();
    let stopped = write(&folder.path().join("bundle"), false, &AtomicBool::new(true));
    assert!(matches!(stopped, Err(Error::Cancelled)));
    assert!(names(folder.path()).is_empty());
}

#[test]
fn a_missing_parent_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let error = write(&folder.path().join("none/bundle"), false, &Silent).unwrap_err();
    assert!(error.to_string().contains("none/bundle"), "{error}");
}
