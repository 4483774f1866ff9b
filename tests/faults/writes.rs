//! Failing writes.

use std::path::{Path, PathBuf};
use std::process::Command;

use super::{BAKE, Folder, SCENE, SEQUENCE, check_failure, cube, instants, lit_scene, said};

/// A library that makes the n-th call fail that changes a file: of `write` and its kin, `fsync`, `ftruncate`, `rename`, `mkdir`, or of
/// `open` where it makes a file. Those after it fail, too, as on a full disk, unless `FAIL_ONCE` is set. An `fsync` that does not fail does
/// nothing: what has been written is in the files without it, and only the power can fail before it is on the disk.
const LIBRARY: &str = r#"
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdlib.h>
#include <stdatomic.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>
static atomic_long calls;
static int fails(void) {
    const char *which = getenv("FAIL_AT");
    if (!which) return 0;
    long call = atomic_fetch_add(&calls, 1) + 1;
    return getenv("FAIL_ONCE") ? call == atol(which) : call >= atol(which);
}
static int is_file(int fd) {
    struct stat s;
    return fstat(fd, &s) == 0 && S_ISREG(s.st_mode);
}
#define REAL(name) __typeof__(&name) real = (__typeof__(&name))dlsym(RTLD_NEXT, #name)
#define ON_FILE(type, name, parameters, arguments, error) \
    type name parameters { REAL(name); if (is_file(fd) && fails()) { errno = error; return -1; } return real arguments; }
ON_FILE(ssize_t, write, (int fd, const void *data, size_t size), (fd, data, size), ENOSPC)
ON_FILE(ssize_t, writev, (int fd, const struct iovec *data, int count), (fd, data, count), ENOSPC)
ON_FILE(ssize_t, pwrite, (int fd, const void *data, size_t size, off_t at), (fd, data, size, at), ENOSPC)
ON_FILE(ssize_t, pwrite64, (int fd, const void *data, size_t size, off64_t at), (fd, data, size, at), ENOSPC)
int fsync(int fd) {
    if (is_file(fd) && fails()) { errno = EIO; return -1; }
    return 0;
}
ON_FILE(int, ftruncate, (int fd, off_t size), (fd, size), ENOSPC)
ON_FILE(int, ftruncate64, (int fd, off64_t size), (fd, size), ENOSPC)
int rename(const char *from, const char *to) {
    REAL(rename);
    if (fails()) { errno = ENOSPC; return -1; }
    return real(from, to);
}
int mkdir(const char *path, mode_t mode) {
    REAL(mkdir);
    if (fails()) { errno = ENOSPC; return -1; }
    return real(path, mode);
}
#define OPEN(name) \
    int name(const char *path, int flags, ...) { \
        REAL(name); \
        va_list list; \
        va_start(list, flags); \
        mode_t mode = flags & (O_CREAT | __O_TMPFILE) ? va_arg(list, mode_t) : 0; \
        va_end(list); \
        if ((flags & O_CREAT) && fails()) { errno = ENOSPC; return -1; } \
        return real(path, flags, mode); \
    }
OPEN(open)
OPEN(open64)
"#;

/// The library, where there is a C compiler for it.
fn library(folder: &Folder) -> Option<PathBuf> {
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

/// Whether the calls after the one that fails do so, too.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Failure {
    Once,
    FromThenOn,
}

/// Runs a command again and again, with the n-th write failing, for every n up to where none fails, or for as many of
/// them as [`instants`] says, spread evenly. Each time every file is whole, the one that was there before, or absent; nothing else is left; and
/// the command run again gives the same bits as without failures.
fn with_failing_writes(inputs: &[(&str, Vec<u8>)], arguments: &[&str], old: Option<&str>) {
    let tools = Folder::new();
    let Some(library) = library(&tools) else {
        crate::common::skipped::skipped("there is no C compiler for Linux");
        return;
    };
    let begun = || {
        let folder = Folder::new();
        for (name, content) in inputs {
            folder.write(name, content);
        }
        if let Some(old) = old {
            folder.write(old, OLD);
        }
        folder
    };
    let with_library = |folder: &Folder| {
        let mut command = folder.program(arguments);
        command.env("LD_PRELOAD", &library);
        command
    };
    let succeed = |folder: &Folder| {
        let output = with_library(folder).output().unwrap();
        assert!(output.status.success(), "{arguments:?}: {}", said(&output));
    };
    let reference = begun();
    succeed(&reference);
    let expected = reference.files(&[]);
    let failing = |folder: &Folder, n: u64, failure| {
        let mut command = with_library(folder);
        command.env("FAIL_AT", n.to_string());
        if failure == Failure::Once {
            command.env("FAIL_ONCE", "1");
        }
        command.output().unwrap()
    };
    // How many calls there are: the first that is never made, found by doubling and halving.
    let succeeds = |n: u64| failing(&begun(), n, Failure::FromThenOn).status.success();
    let mut above = 4;
    while !succeeds(above) {
        above *= 2;
        assert!(above < 1 << 20, "it never succeeds");
    }
    let mut below = above / 2;
    while above - below > 1 {
        let middle = below.midpoint(above);
        *if succeeds(middle) {
            &mut above
        } else {
            &mut below
        } = middle;
    }
    assert!(above > 2, "nothing was written");
    let step = (above / (4 * instants())).max(1);
    for n in (1..above).step_by(step as usize) {
        for failure in [Failure::FromThenOn, Failure::Once] {
            let folder = begun();
            let before = folder.files(&[]);
            let output = failing(&folder, n, failure);
            match failure {
                // What fails once only may be done without: a file that is made to see whether it can be.
                Failure::Once if output.status.success() => {}
                _ => check_failure(&output),
            }
            for (name, content) in folder.files(&[]) {
                let is_old = before.get(&name) == Some(&content);
                // Pictures of an unfinished film and parts of a bake are kept to be gone on from, and go when it is finished.
                let is_whole = expected.get(&name) == Some(&content)
                    || name.contains(".frames/") && content.starts_with(b"\x89PNG")
                    || name.ends_with(".parts");
                assert!(
                    is_old || is_whole,
                    "call {n}, {failure:?}: {name}: {}",
                    said(&output)
                );
            }
            succeed(&folder);
            let after = folder.files(&[]);
            assert!(
                after == expected,
                "call {n}, {failure:?}: {:?}",
                after.keys()
            );
        }
    }
}

const OLD: &str = "what was there before";

fn scene() -> (&'static str, Vec<u8>) {
    ("a.toml", SCENE.into())
}

#[test]
fn a_write_of_a_png_that_fails_leaves_what_was_there() {
    with_failing_writes(
        &[scene()],
        &["render", "a.toml", "-o", "a.png"],
        Some("a.png"),
    );
}

#[test]
fn a_write_of_an_exr_that_fails_leaves_what_was_there() {
    let render = ["render", "a.toml", "--aovs", "event", "-o", "a.exr"];
    with_failing_writes(&[scene()], &render, Some("a.exr"));
}

#[test]
fn a_write_of_an_npz_that_fails_leaves_what_was_there_and_says_one_thing() {
    let render = ["render", "a.toml", "--aovs", "event", "-o", "a.npz"];
    with_failing_writes(&[scene()], &render, Some("a.npz"));
}

#[test]
fn a_write_of_a_sequence_that_fails_leaves_whole_frames_that_are_gone_on_from() {
    with_failing_writes(&[scene()], &SEQUENCE, None);
}

#[test]
fn a_write_of_a_film_that_fails_leaves_what_was_there() {
    let film = [
        "film",
        "a.toml",
        "--speeds",
        "0.5",
        "--pictures",
        "3",
        "--size",
        "24x16",
        "-o",
        "a.apng",
    ];
    with_failing_writes(&[scene()], &film, Some("a.apng"));
}

#[test]
fn a_write_of_a_diagram_that_fails_leaves_what_was_there() {
    for name in ["a.svg", "a.pdf", "a.png"] {
        with_failing_writes(&[scene()], &["diagram", "a.toml", "-o", name], Some(name));
    }
}

#[test]
fn a_write_of_an_export_that_fails_leaves_nothing() {
    with_failing_writes(&[scene()], &["export", "a.toml", "-o", "bundle"], None);
}

#[test]
fn a_write_of_a_page_that_fails_leaves_what_was_there() {
    let page = [
        "page", "a.toml", "--beta", "0.5", "--steps", "2", "--size", "24x16", "-o", "page",
    ];
    with_failing_writes(&[scene()], &page, None);
}

#[test]
fn a_write_of_a_comparison_that_fails_leaves_what_was_there() {
    let picture = |beta: &str| {
        let folder = Folder::new();
        folder.write("a.toml", SCENE);
        let velocity = format!("camera.velocity={{beta=[{beta},0,0]}}");
        folder.succeed(&["render", "a.toml", "--set", &velocity, "-o", "a.exr"]);
        std::fs::read(folder.path("a.exr")).unwrap()
    };
    let pair = [("a.exr", picture("0.5")), ("b.exr", picture("0.51"))];
    for [option, name] in [
        ["--maps", "c.exr"],
        ["--error-map", "c.png"],
        ["--strip", "c.png"],
        ["--report", "c.html"],
    ] {
        let compare = ["compare", "a.exr", "b.exr", "--no-flip", option, name];
        with_failing_writes(&pair, &compare, Some(name));
    }
}

#[test]
fn a_write_of_a_baked_cube_that_fails_leaves_what_was_there() {
    with_failing_writes(&[lit_scene()], &BAKE, Some("a.npy"));
}

#[test]
fn a_write_of_a_converted_cube_that_fails_leaves_what_was_there() {
    for (name, old) in [("b.npy", true), ("b.npz", true), ("frames", false)] {
        let convert = ["convert", "a.npy", "-o", name];
        with_failing_writes(&[cube()], &convert, old.then_some(name));
    }
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
fn a_full_disk_is_reported_with_the_name_of_the_requested_export() {
    let folder = Folder::new();
    folder.write("a.toml", SCENE.replace("[48, 32]", "[400, 300]"));
    std::fs::create_dir(folder.path("disk")).unwrap();
    let script = "mount -t tmpfs -o size=64k none disk || exit 77; \"$1\" export a.toml -o disk/bundle; \
                  code=$?; ls -A disk >&2; exit $code";
    match apart(&folder, script) {
        Some(output) => {
            check_failure(&output);
            let text = said(&output);
            assert!(
                text.contains("space") && text.contains("disk/bundle/"),
                "{text}"
            );
            assert!(!text.contains(".part"), "{text}");
        }
        None => skipped(),
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

/// The kernel sends a signal, too, which ends a program that does not expect it.
#[cfg(target_os = "linux")]
#[test]
fn a_file_larger_than_the_limit_is_an_error_and_leaves_nothing() {
    let folder = Folder::new();
    folder.write("a.toml", SCENE);
    let mut limited = Command::new("sh");
    let run = "ulimit -f 8; exec \"$0\" render a.toml -o a.exr --aovs all --size 128x128";
    limited.args(["-c", run, env!("CARGO_BIN_EXE_nullray")]);
    limited.current_dir(folder.path(""));
    let output = limited.output().unwrap();
    check_failure(&output);
    for part in ["a.exr", "File too large", "ulimit -f"] {
        assert!(said(&output).contains(part), "{}", said(&output));
    }
    let left: Vec<String> = folder.files(&[]).into_keys().collect();
    assert_eq!(left, ["a.toml"]);
}
