//! The program as its users see it: what it prints, writes and refuses, and its exit codes.

mod bake;
mod bake_again;
mod bake_refused;
mod builtin;
mod channels;
mod convert;
mod dark;
mod depth;
mod diagram;
mod emulated;
mod export;
mod exposure;
mod film;
mod flashes;
mod frames;
mod goals;
mod info;
mod interrupt;
mod lamps;
mod memory;
mod methods;
mod model_parts;
mod models;
mod overlay;
mod page;
mod panels;
mod passes;
mod pixel;
mod plan;
mod recorded;
mod reference;
mod refused;
mod render;
mod resident;
mod resume;
mod selftest;
mod sheet;
mod skies;
mod spectra;
mod stats;
mod tessellation;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use tempfile::TempDir;

/// A scene that needs no file: a lit floor, and a box at 0.6 c.
const SMALL: &str = r#"
[display]
samples_per_pixel = 4
[camera]
eye = [0, 1, 4]
look_at = [0, 0.5, 0]
hfov = "60 deg"
size = [32, 24]
velocity = { beta = [0, 0, -0.3] }
[[object]]
name = "floor"
shape = { plane = { size = [8, 8] } }
[[object]]
name = "crate"
shape = { box = { size = [1, 1, 1] } }
velocity = { beta = [0.6, 0, 0] }
origin = { position = [0, 0.5, 0], time = "-4 m" }
[[source]]
name = "lamp"
pulse = { position = [1, 4, 2], time = "-5 m", sigma = "20 m", intensity = 100 }
"#;

/// A directory of its own for each test.
struct Folder(TempDir);

impl Folder {
    /// An empty one.
    fn empty() -> Self {
        Folder(tempfile::tempdir().unwrap())
    }

    /// One with `scene.toml`.
    fn new() -> Self {
        let folder = Folder::empty();
        folder.write("scene.toml", SMALL);
        folder
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        fs::write(self.path(name), content).unwrap();
    }

    fn read(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    /// The names in it, sorted.
    fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.0.path()).unwrap();
        let mut names: Vec<_> = entries
            .map(|e| e.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    /// The program, to be run here.
    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_nullray"));
        command.args(arguments).current_dir(self.0.path());
        command
    }

    fn run(&self, arguments: &[&str]) -> Run {
        Run::of(self.command(arguments).output().unwrap())
    }

    /// What a successful run prints, and its warnings before that.
    fn ok(&self, arguments: &[&str]) -> String {
        let run = self.run(arguments);
        assert_eq!(run.code, 0, "{arguments:?}: {}", run.stderr);
        let is_warning = |line: &str| line.starts_with("warning: ");
        assert!(
            run.stderr.lines().all(is_warning),
            "{arguments:?}: {}",
            run.stderr
        );
        assert!(
            !run.stdout.lines().any(is_warning),
            "{arguments:?}: {}",
            run.stdout
        );
        run.stderr + &run.stdout
    }
}

/// What a run of the program left.
struct Run {
    code: i32,
    stdout: String,
    stderr: String,
}

impl Run {
    fn of(output: Output) -> Run {
        Run {
            code: output.status.code().unwrap_or(-1),
            stdout: String::from_utf8(output.stdout).unwrap(),
            stderr: String::from_utf8(output.stderr).unwrap(),
        }
    }

    /// The message as one line, without the frame that is drawn around it.
    fn message(&self) -> String {
        let words = self.stderr.split_whitespace();
        words.filter(|w| *w != "|").collect::<Vec<_>>().join(" ")
    }
}

/// A file of this repository.
fn repository(path: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    path.to_str().unwrap().to_string()
}
