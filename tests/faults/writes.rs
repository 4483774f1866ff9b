//! Writes that fail.

use std::path::Path;
use std::process::Command;

use super::{Folder, SCENE, check_failure, said};

/// A library that makes the n-th call of `write`, `fsync` or `rename` on a file fail as on a full disk.
const LIBRARY: &str = r#"
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <stdlib.h>
#include <stdatomic.h>
#include <sys/stat.h>
#include <unistd.h>
static atomic_long calls;
static int fails(void) {
    const char *which = getenv("FAIL_AT");
    return which && atomic_fetch_add(&calls, 1) + 1 >= atol(which);
}
static int is_file(int fd) {
    struct stat s;
    return fstat(fd, &s) == 0 && S_ISREG(s.st_mode);
}
ssize_t write(int fd, const void *data, size_t size) {
    static ssize_t (*real)(int, const void *, size_t);
    if (!real) real = dlsym(RTLD_NEXT, "write");
    if (is_file(fd) && fails()) { errno = ENOSPC; return -1; }
    return real(fd, data, size);
}
int fsync(int fd) {
    static int (*real)(int);
    if (!real) real = dlsym(RTLD_NEXT, "fsync");
    if (is_file(fd) && fails()) { errno = EIO; return -1; }
    return real(fd);
}
int rename(const char *from, const char *to) {
    static int (*real)(const char *, const char *);
    if (!real) real = dlsym(RTLD_NEXT, "rename");
    if (fails()) { errno = ENOSPC; return -1; }
    return real(from, to);
}
"#;

/// The library, where there is a C compiler for it.
fn library(folder: &Folder) -> Option<std::path::PathBuf> {
    folder.write("fail.c", LIBRARY);
    let path = folder.path("fail.so");
    let mut cc = Command::new("cc");
    cc.args(["-shared", "-fPIC", "-O1", "-o"])
        .arg(&path)
        .arg(folder.path("fail.c"))
        .arg("-ldl");
    let made = cfg!(target_os = "linux") && cc.status().is_ok_and(|status| status.success());
    made.then_some(path)
}

/// Runs a command again and again, with the n-th write failing, until none does.
fn with_failing_writes(arguments: &[&str], target: &str) {
    let tools = Folder::new();
    let Some(library) = library(&tools) else {
        crate::common::skipped::skipped("there is no C compiler for Linux");
        return;
    };
    let folder = Folder::new();
    folder.write("a.toml", SCENE);
    let is_folder = !target.contains('.');
    if !is_folder {
        folder.write(target, "what was there before");
    }
    let before = folder.files(&[]);
    for n in 1..10_000 {
        let mut command = folder.program(arguments);
        command
            .env("LD_PRELOAD", &library)
            .env("FAIL_AT", n.to_string());
        let output = command.output().unwrap();
        if output.status.success() {
            assert!(n > 2, "nothing was written: {}", said(&output));
            assert!(folder.path(target).exists());
            return;
        }
        check_failure(&output);
        assert!(
            folder.files(&[]) == before,
            "write {n}: {:?}",
            folder.files(&[]).keys()
        );
    }
    panic!("it never succeeds");
}

#[test]
fn a_write_of_a_png_that_fails_leaves_what_was_there() {
    with_failing_writes(&["render", "a.toml", "-o", "a.png"], "a.png");
}

#[test]
fn a_write_of_an_exr_that_fails_leaves_what_was_there() {
    with_failing_writes(
        &["render", "a.toml", "--aovs", "event", "-o", "a.exr"],
        "a.exr",
    );
}

#[test]
fn a_write_of_an_npz_that_fails_leaves_what_was_there_and_says_one_thing() {
    with_failing_writes(
        &["render", "a.toml", "--aovs", "event", "-o", "a.npz"],
        "a.npz",
    );
}

#[test]
fn a_write_of_an_export_that_fails_leaves_nothing() {
    with_failing_writes(&["export", "a.toml", "-o", "bundle"], "bundle");
}

/// Runs a shell script with the program as `$1` in name spaces of its own, where file systems can be mounted; none where
/// the system does not allow that.
fn apart(folder: &Folder, script: &str) -> Option<std::process::Output> {
    let mut command = Command::new("unshare");
    command.args(["--user", "--map-root-user", "--mount", "sh", "-c"]);
    command
        .args([script, "sh", env!("CARGO_BIN_EXE_nullray")])
        .current_dir(folder.path(""));
    let output = command.output().ok()?;
    let refused = said(&output).contains("unshare:") || output.status.code() == Some(77);
    (!refused).then_some(output)
}

fn skipped() {
    crate::common::skipped::skipped("file systems cannot be mounted here");
}

#[test]
fn a_full_disk_is_said_and_nothing_half_written_stays() {
    for name in ["a.png", "a.exr", "a.npz"] {
        let folder = Folder::new();
        folder.write("a.toml", SCENE.replace("[48, 32]", "[400, 300]"));
        std::fs::create_dir(folder.path("disk")).unwrap();
        let script = format!(
            "mount -t tmpfs -o size=16k none disk || exit 77; \"$1\" render a.toml --aovs event -o disk/{name} {more}; \
             code=$?; ls -A disk >&2; exit $code",
            more = if name == "a.png" { "-o b.exr" } else { "" }
        );
        match apart(&folder, &script) {
            // A PNG of one colour may fit.
            Some(output) if name == "a.png" && output.status.success() => {}
            Some(output) => {
                check_failure(&output);
                let text = said(&output);
                assert!(text.contains("space"), "{text}");
                assert!(!text.contains(".part"), "{text}");
            }
            None => skipped(),
        }
    }
}

#[test]
fn a_read_only_disk_is_refused_before_anything_is_rendered() {
    let folder = Folder::new();
    folder.write("a.toml", SCENE);
    std::fs::create_dir(folder.path("disk")).unwrap();
    let script = "mount -t tmpfs -o ro none disk || exit 77; \"$1\" render a.toml -o disk/a.png";
    match apart(&folder, script) {
        Some(output) => {
            check_failure(&output);
            assert!(
                said(&output).contains("no file can be written"),
                "{}",
                said(&output)
            );
        }
        None => skipped(),
    }
}

#[test]
fn left_overs_of_equal_process_ids_do_not_stand_in_the_way() {
    let folder = Folder::new();
    folder.write("a.toml", SCENE);
    for id in 1..200 {
        folder.write(&format!(".nullray-{id}-probe.part"), "");
        folder.write(&format!(".nullray-{id}-0.part"), "");
    }
    folder.age_left_overs();
    folder.succeed(&["render", "a.toml", "-o", "a.png"]);
    let names: Vec<_> = folder.files(&[]).into_keys().collect();
    assert_eq!(names, ["a.png", "a.toml"]);
    assert!(Path::new(&folder.path("a.png")).is_file());
}
