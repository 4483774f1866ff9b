//! Faults outside the program: it is killed, writes fail, disks are full or read-only, inputs vanish or change, and files have the wrong
//! contents.
//!
//! Each time, a file with a final name is complete, missing, or the previous one; the same command run again gives the same bits; nothing
//! else is left in the folder; an error is one message and exit code 2. By default each test takes seconds; `NULLRAY_FAULTS=1000` sets the
//! number of instants at which processes are killed.

#[path = "../common"]
mod common {
    pub mod skipped;
}

mod hostile;
mod interrupted;
mod writes;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::time::{Duration, SystemTime};

/// A folder of files.
struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Folder(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, content: impl AsRef<[u8]>) -> &Self {
        std::fs::write(self.path(name), content).unwrap();
        self
    }

    /// The program, to be run in the folder.
    fn program(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_nullray"));
        command.args(arguments).current_dir(self.0.path());
        command
    }

    fn run(&self, arguments: &[&str]) -> Output {
        self.program(arguments).output().unwrap()
    }

    fn succeed(&self, arguments: &[&str]) -> String {
        let output = self.run(arguments);
        assert!(output.status.success(), "{arguments:?}: {}", said(&output));
        said(&output)
    }

    /// One error and exit code 2; what it says.
    fn fail(&self, arguments: &[&str]) -> String {
        let output = self.run(arguments);
        check_failure(&output);
        said(&output)
    }

    /// Names and contents of all files that do not begin with `except`.
    fn files(&self, except: &[&str]) -> BTreeMap<String, Vec<u8>> {
        files(self.0.path(), except)
    }

    /// Makes what killed processes have left as old as left-overs are.
    fn age_left_overs(&self) {
        for entry in std::fs::read_dir(self.0.path()).unwrap().flatten() {
            if entry.file_name().to_string_lossy().ends_with(".part") {
                let file = std::fs::File::open(entry.path()).unwrap();
                let then = SystemTime::now() - Duration::from_secs(3 * 24 * 3600);
                file.set_modified(then).unwrap();
            }
        }
    }
}

fn files(folder: &Path, except: &[&str]) -> BTreeMap<String, Vec<u8>> {
    let mut all = BTreeMap::new();
    for entry in std::fs::read_dir(folder).unwrap().flatten() {
        let name = entry.file_name().into_string().unwrap();
        if except.iter().any(|except| name.starts_with(except)) {
            continue;
        }
        if entry.path().is_dir() {
            let inner = files(&entry.path(), &[]);
            // An empty directory counts as a file of its own.
            all.extend(inner.is_empty().then(|| (format!("{name}/"), Vec::new())));
            let inner = inner.into_iter();
            all.extend(inner.map(|(inner, content)| (format!("{name}/{inner}"), content)));
        } else if let Ok(content) = std::fs::read(entry.path()) {
            all.insert(name, content);
        }
    }
    all
}

/// What was said on both ways out.
fn said(output: &Output) -> String {
    String::from_utf8_lossy(&[output.stdout.as_slice(), &output.stderr].concat()).into_owned()
}

fn check_failure(output: &Output) {
    let text = said(output);
    assert_eq!(output.status.code(), Some(2), "{text}");
    assert!(text.contains("error: "), "{text}");
    assert!(
        !["panicked", "ZipWriter", ".nullray-"]
            .iter()
            .any(|word| text.contains(word)),
        "{text}"
    );
}

/// How many instants are tried.
fn instants() -> u64 {
    let said = std::env::var("NULLRAY_FAULTS").ok();
    said.and_then(|text| text.parse().ok()).unwrap_or(8)
}

/// Numbers that look random, the same each time.
struct Numbers(u64);

impl Numbers {
    fn below(&mut self, n: u64) -> u64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % n.max(1)
    }
}

const SCENE: &str = "\
[camera]
eye = [0, 0, 4]
look_at = [0, 0, 0]
size = [48, 32]
velocity = { beta = [0.5, 0, 0] }
[display]
white = 1
[[object]]
shape = { box = { size = [1, 1, 1] } }
";

/// A sequence of that scene.
const SEQUENCE: [&str; 14] = [
    "render",
    "a.toml",
    "--frames",
    "0..6",
    "--interval",
    "1 cm",
    "-o",
    "f-##.png",
    "-o",
    "f-##.exr",
    "-o",
    "f-##.npz",
    "--aovs",
    "event",
];

/// A scene with light to be baked.
fn lit_scene() -> (&'static str, Vec<u8>) {
    let light = "[[light]]\nposition = [0, 2, 2]\nintensity = 5\nemission = { gaussian = { sigma = \"30 cm\" } }\n";
    ("a.toml", format!("{SCENE}{light}").into())
}

/// Bakes it: what the camera sees, which does not move then.
const BAKE: [&str; 12] = [
    "bake",
    "a.toml",
    "--camera",
    "--set",
    "camera.velocity={beta=[0,0,0]}",
    "--spp",
    "1",
    "--bin-width",
    "10 cm",
    "--bins=64",
    "-o",
    "a.npy",
];

/// A cube of 6 rows, 5 columns and 40 bins of whole numbers.
fn cube() -> (&'static str, Vec<u8>) {
    let header = "{'descr': '<f4', 'fortran_order': False, 'shape': (6, 5, 40), }";
    let mut file = b"\x93NUMPY\x01\x00".to_vec();
    file.extend([118, 0]);
    file.extend(format!("{header:<117}\n").bytes());
    file.extend((0..6 * 5 * 40).flat_map(|k| (k as f32).to_le_bytes()));
    ("a.npy", file)
}
