//! The same bits on other processors: the program with fewer instructions than this machine has, emulated by qemu-user.

use std::fs;
use std::process::Command;

use super::{Folder, SMALL};

/// What was rendered for the arguments on a processor of qemu's, or by this one; none where there is no emulator.
fn rendered(folder: &Folder, processor: Option<&str>, options: &[&str]) -> Option<Vec<u8>> {
    let program = env!("CARGO_BIN_EXE_nullray");
    let mut command = match processor {
        None => Command::new(program),
        Some(name) => {
            let mut qemu = Command::new("qemu-x86_64");
            qemu.args(["-cpu", name, program]);
            qemu
        }
    };
    let render = ["render", "scene.toml", "-q", "--aovs", "all", "-o", "a.npz"];
    command
        .args(render)
        .args(options)
        .current_dir(folder.path(""));
    let output = command.output().ok()?;
    assert!(
        output.status.success(),
        "{processor:?}: {}",
        String::from_utf8_lossy(&output.stderr)
    );
    Some(fs::read(folder.path("a.npz")).unwrap())
}

/// Processors of qemu's and the kernels that they run: one without all beyond SSE2; one without FMA and AVX2; one without AVX-512.
const PROCESSORS: [(&str, &str); 3] = [
    ("qemu64", "portable"),
    ("SandyBridge", "portable"),
    ("Haswell", "avx2"),
];

/// Asserts that the emulator hides what it should.
fn assert_kernel(processor: &str, kernel: &str) {
    let mut qemu = Command::new("qemu-x86_64");
    qemu.args(["-cpu", processor, env!("CARGO_BIN_EXE_nullray")]);
    let output = qemu
        .args(["selftest", "--check", "denormals", "--json"])
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(
        said.contains(&format!("\"kernel\": \"{kernel}\"")),
        "{processor}: {said}"
    );
}

#[test]
fn certified_pictures_have_the_same_bits_whatever_instructions_there_are() {
    let folder = Folder::empty();
    let rounded = "[[object]]\nshape = { sphere = { radius = 0.4, subdivisions = 3 } }\norigin = { position = [-1, 0.5, 0] }\n";
    folder.write(
        "scene.toml",
        SMALL.replace("[[source]]", &format!("{rounded}[[source]]")),
    );
    let here = rendered(&folder, None, &[]).unwrap();
    for (processor, kernel) in PROCESSORS {
        match rendered(&folder, Some(processor), &[]) {
            Some(there) => {
                assert!(there == here, "{processor}");
                assert_kernel(processor, kernel);
            }
            None if cfg!(target_arch = "x86_64") => {
                return eprintln!("skipped: there is no qemu-x86_64");
            }
            None => return,
        }
    }
}

/// With one set of instructions, fast pictures do not depend on the number of threads; across sets they may.
#[test]
fn fast_pictures_have_the_same_bits_on_any_number_of_threads_of_each_processor() {
    let folder = Folder::new();
    for (processor, _) in PROCESSORS {
        let fast = |threads| {
            rendered(
                &folder,
                Some(processor),
                &["--precision", "fast", "--threads", threads],
            )
        };
        match (fast("1"), fast("3")) {
            (Some(one), Some(three)) => assert!(one == three, "{processor}"),
            _ => return eprintln!("skipped: there is no qemu-x86_64"),
        }
    }
}
