//! The scene that is compiled in.

use std::path::Path;

use nullray::figures::diagram::model::Diagram;
use nullray::io::budget::Budget;
use nullray::io::files;
use nullray::scene::{ModelView, Overrides, SceneFile};
use nullray::{Result, figures, scene};

use super::failure::refused;

/// The text of the built-in scene.
pub const TEXT: &str = include_str!("../../scenes/corner.toml");
const NAME: &str = "built-in scene";
const FOLDER: &str = files::BUILT_IN;

/// The scene file of a command, read once: the one that was named, or that which a named model stands for, or the built-in one.
/// A model is loaded for it in `memory` bytes.
pub fn open(path: Option<&Path>, overrides: &Overrides, memory: u64) -> Result<SceneFile> {
    match path {
        Some(path) if is_model(path) => {
            let text = model_text(path, &ModelView::default(), overrides, memory)?;
            Ok(of_model(path, &text))
        }
        Some(path) => SceneFile::read(path),
        None => Ok(SceneFile::of_text(TEXT, NAME, Path::new(FOLDER))),
    }
}

/// The same; a model is looked at as `model` says, which scenes refuse.
pub fn open_as(
    path: Option<&Path>,
    model: &ModelView,
    overrides: &Overrides,
    memory: u64,
) -> Result<SceneFile> {
    match model_as(path, model, overrides, memory)? {
        Some((path, text)) => Ok(of_model(path, &text)),
        None => open(path, overrides, memory),
    }
}

/// Where `path` is that of a model, it and the text of the scene that it stands for, seen as `model` says, which scenes refuse.
pub fn model_as<'a>(
    path: Option<&'a Path>,
    model: &ModelView,
    overrides: &Overrides,
    memory: u64,
) -> Result<Option<(&'a Path, String)>> {
    let moves = model.beta.is_some() || model.flyby;
    if model.direction.is_some() && !moves {
        let what = "it says where a moving camera goes, and this one is at rest";
        return Err(refused("--direction", what, "add --beta 0.9, or --flyby"));
    }
    match path {
        Some(path) if is_model(path) => {
            let text = model_text(path, model, overrides, memory)?;
            Ok(Some((path, text)))
        }
        _ if moves => {
            let option = match model.flyby {
                true => "--flyby",
                false => "--beta",
            };
            let what = "it tells how a model without a scene is looked at, and this is a scene";
            let help =
                "set the camera's velocity: --set camera.velocity={beta=0.9,direction=[1,0,0]}";
            Err(refused(option, what, help))
        }
        _ => Ok(None),
    }
}

/// Whether a file is a model, by its name.
pub fn is_model(path: &Path) -> bool {
    let extension = path.extension().unwrap_or_default();
    ["glb", "gltf"]
        .iter()
        .any(|e| extension.eq_ignore_ascii_case(e))
}

/// The text of the scene that a model stands for, seen as `view` says; `memory` bytes may be taken to load it.
pub fn model_text(
    path: &Path,
    view: &ModelView,
    overrides: &Overrides,
    memory: u64,
) -> Result<String> {
    let view = ModelView {
        size: overrides.size,
        ..view.clone()
    };
    scene::model_scene(path, &view, &Budget::new(memory))
}

/// The scene of this text, which stands for the model at `path`.
pub fn of_model(path: &Path, text: &str) -> SceneFile {
    let name = path.display().to_string();
    let own = path.parent().unwrap_or(Path::new(""));
    SceneFile::of_text(text, &name, Path::new("")).reaching(own)
}

/// The space-time diagram of a command: of the file that was named, or of the built-in scene.
pub fn load_diagram(path: Option<&Path>, overrides: &Overrides) -> Result<Diagram> {
    match path {
        Some(path) => figures::diagram::load(path, overrides),
        None => figures::diagram::parse(TEXT, NAME, Path::new(FOLDER), overrides),
    }
}
