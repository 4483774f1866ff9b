//! The scene that is compiled in.

use std::path::Path;

use nullray::scene::Overrides;
use nullray::scene::model::Scene;
use nullray::{Result, files};

use super::args::SceneArguments;

/// The text of the built-in scene.
pub const TEXT: &str = include_str!("../../scenes/corner.toml");
const NAME: &str = "built-in scene";

/// The scene of a command: the file that was named, or the built-in one.
pub fn scene_or_builtin(arguments: &SceneArguments) -> Result<Scene> {
    match &arguments.scene {
        Some(path) => nullray::scene::load(path, &arguments.overrides()),
        None => scene(&arguments.overrides()),
    }
}

/// The built-in scene.
pub fn scene(overrides: &Overrides) -> Result<Scene> {
    nullray::scene::parse(TEXT, NAME, Path::new(files::BUILT_IN), overrides)
}
