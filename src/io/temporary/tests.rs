use super::*;
use std::time::SystemTime;

fn aged(path: &Path, age: Duration) {
    let file = File::open(path).unwrap();
    file.set_modified(SystemTime::now() - age).unwrap();
}

#[test]
fn left_overs_are_removed_and_what_lives_or_is_not_ours_stays() {
    let directory = tempfile::tempdir().unwrap();
    let at = |name: &str| directory.path().join(name);
    let names = [
        ".nullray-1-probe.part",
        ".nullray-young.part",
        ".nullray-locked.part",
        ".nullray-other.txt",
    ];
    for name in names {
        fs::write(at(name), "x").unwrap();
    }
    fs::create_dir(at(".nullray-folder.part")).unwrap();
    fs::write(at(".nullray-folder.part/a"), "x").unwrap();
    fs::create_dir(at(".nullray-young-folder.part")).unwrap();
    for name in [names[0], names[2], names[3], ".nullray-young-folder.part"] {
        aged(&at(name), 2 * FILE_AGE);
    }
    aged(&at(".nullray-folder.part"), 2 * FOLDER_AGE);
    let locked = File::open(at(names[2])).unwrap();
    locked.try_lock().unwrap();
    drop(Temporary::file(&at("a.png")).unwrap());
    let mut left: Vec<_> = fs::read_dir(directory.path())
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    left.sort();
    assert_eq!(
        left,
        [
            ".nullray-locked.part",
            ".nullray-other.txt",
            ".nullray-young-folder.part",
            ".nullray-young.part"
        ]
    );
}

#[test]
fn a_folder_goes_while_another_thread_writes_into_it() {
    let directory = tempfile::tempdir().unwrap();
    let target = directory.path().join("frames");
    for _ in 0..20 {
        let folder = Temporary::folder(&target).unwrap();
        let path = folder.path().to_path_buf();
        let writer = std::thread::spawn(move || {
            let mut number = 0;
            while fs::write(path.join(format!("{number}.exr")), "x").is_ok() {
                number += 1;
            }
        });
        while !folder.path().join("99.exr").exists() {
            std::thread::yield_now();
        }
        drop(folder);
        writer.join().unwrap();
        assert_eq!(fs::read_dir(directory.path()).unwrap().count(), 0);
    }
}

#[test]
fn what_is_in_the_making_goes_when_it_is_given_up() {
    let directory = tempfile::tempdir().unwrap();
    let target = directory.path().join("a");
    let (file, _open) = Temporary::file(&target).unwrap();
    let folder = Temporary::folder(&target).unwrap();
    fs::write(folder.path().join("b"), "x").unwrap();
    assert_eq!(fs::read_dir(directory.path()).unwrap().count(), 2);
    drop((file, folder));
    assert_eq!(fs::read_dir(directory.path()).unwrap().count(), 0);
    let (file, _open) = Temporary::file(&target).unwrap();
    file.persist(&target).unwrap();
    assert!(target.is_file());
    assert_eq!(fs::read_dir(directory.path()).unwrap().count(), 1);
}
