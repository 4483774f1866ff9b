//! The scene that is compiled in.

use std::path::Path;

use nullray::figures::diagram::model::Diagram;
use nullray::io::files;
use nullray::scene::Overrides;
use nullray::scene::model::{Panel, Scene};
use nullray::{Result, figures, scene};

/// The text of the built-in scene.
pub const TEXT: &str = include_str!("../../scenes/corner.toml");
const NAME: &str = "built-in scene";
const FOLDER: &str = files::BUILT_IN;

/// The scene of a command: the file that was named, or the built-in one.
pub fn load(path: Option<&Path>, overrides: &Overrides) -> Result<Scene> {
    match path {
        Some(path) => scene::load(path, overrides),
        None => scene::parse(TEXT, NAME, Path::new(FOLDER), overrides),
    }
}

/// The space-time diagram of a command: of the file that was named, or of the built-in scene.
pub fn load_diagram(path: Option<&Path>, overrides: &Overrides) -> Result<Diagram> {
    match path {
        Some(path) => figures::diagram::load(path, overrides),
        None => figures::diagram::parse(TEXT, NAME, Path::new(FOLDER), overrides),
    }
}

/// The scene of a panel of `whole`, which was read from the same place.
pub fn load_panel(
    path: Option<&Path>,
    whole: &Scene,
    panel: &Panel,
    overrides: &Overrides,
) -> Result<Scene> {
    match path {
        Some(path) => scene::load_panel(path, whole, panel, overrides),
        None => scene::parse_panel(TEXT, Path::new(FOLDER), whole, panel, overrides),
    }
}
