//! Scene files: what is read, what is refused and where, and that no input breaks the reader.

#[macro_use]
mod cases;

mod accepted;
mod cameras;
mod hostile;
mod lights;
mod motion;
mod overridden;
mod refused;
mod refused_motion;
mod schema;
mod sensor;

use std::fs::File;
use std::path::Path;

use nullray::Error;
use nullray::error::{Problem, Result};
use nullray::scene::model::Scene;
use nullray::scene::{Overrides, parse};
use tempfile::TempDir;

/// A scene in which every table occurs, with files that `Folder` holds.
pub const VALID: &str = r#"
[medium]
index = 1.5
[camera]
eye = [0, 1, 5]
look_at = [0, 0, 0]
hfov = "40 deg"
size = [64, 48]
velocity = { beta = 0.5, direction = [0, 0, -1] }
time = "2 ns"
[[object]]
name = "wheel"
gltf = "a.glb"
node = "Wheel"
transform = { translate = [1, 2, 3], scale = 2 }
[[object]]
name = "floor"
shape = { plane = { size = [4, 4] } }
[[object]]
name = "ship"
shape = { box = { size = [1, 2, 3] } }
colour = [1, 0.5, 0.25]
velocity = { beta = [0.5, 0, 0] }
origin = { position = [1, 0, 0], time = "3 m" }
[[source]]
name = "data"
objects = ["wheel"]
materials = ["rim"]
cube = { file = "a.npz", array = "x", bin_width = "5 cm", clock = "capture", capture = { eye = [0, 0, 9], look_at = [0, 0, 0], hfov = "30 deg" } }
[[source]]
name = "flash"
objects = ["floor"]
pulse = { position = [0, 2, 0], sigma = "2 cm" }
[radiance]
quantity = "line"
wavelength = "532 nm"
[outside]
before = "hold"
after = { mark = [1, 0, 1] }
[display]
exposure = "98 %"
samples_per_pixel = 16
"#;

/// A folder with the (empty) files that scenes name: their contents are not looked at.
pub struct Folder(TempDir);

impl Folder {
    pub fn with_files() -> Self {
        let folder = tempfile::tempdir().unwrap();
        for name in ["a.glb", "b.glb", "a.npy", "a.npz"] {
            File::create(folder.path().join(name)).unwrap();
        }
        std::fs::create_dir(folder.path().join("folder.glb")).unwrap();
        Folder(folder)
    }

    pub fn path(&self) -> &Path {
        self.0.path()
    }

    pub fn parse(&self, text: &str) -> Result<Scene> {
        self.parse_with(text, &Overrides::default())
    }

    pub fn parse_with(&self, text: &str, overrides: &Overrides) -> Result<Scene> {
        parse(text, "scene.toml", self.path(), overrides)
    }
}

/// The problem of a refusal.
pub fn problem<T: std::fmt::Debug>(result: Result<T>) -> Box<Problem> {
    match result {
        Err(Error::Invalid(problem)) => problem,
        other => panic!("not refused as invalid: {other:?}"),
    }
}
