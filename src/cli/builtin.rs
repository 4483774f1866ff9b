//! The scene that is compiled in.

use std::path::Path;

use nullray::figures::diagram::model::Diagram;
use nullray::io::files;
use nullray::scene::{ModelView, Overrides, SceneFile};
use nullray::{Result, figures, scene};

/// The text of the built-in scene.
pub const TEXT: &str = include_str!("../../scenes/corner.toml");
const NAME: &str = "built-in scene";
const FOLDER: &str = files::BUILT_IN;

/// The scene file of a command, read once: the one that was named, or that which a named model stands for, or the built-in one.
pub fn open(path: Option<&Path>, overrides: &Overrides) -> Result<SceneFile> {
    match path {
        Some(path) if is_model(path) => open_model(path, &ModelView::default(), overrides),
        Some(path) => SceneFile::read(path),
        None => Ok(SceneFile::of_text(TEXT, NAME, Path::new(FOLDER))),
    }
}

/// Whether a file is a model, by its name.
pub fn is_model(path: &Path) -> bool {
    let extension = path.extension().unwrap_or_default();
    ["glb", "gltf"]
        .iter()
        .any(|e| extension.eq_ignore_ascii_case(e))
}

/// The scene that a model stands for, seen as `view` says.
pub fn open_model(path: &Path, view: &ModelView, overrides: &Overrides) -> Result<SceneFile> {
    open_model_with(path, view, overrides, "")
}

/// The same, with further tables at its end.
pub fn open_model_with(
    path: &Path,
    view: &ModelView,
    overrides: &Overrides,
    more: &str,
) -> Result<SceneFile> {
    let view = ModelView {
        size: overrides.size,
        ..view.clone()
    };
    let text = scene::model_scene(path, &view)? + more;
    let name = path.display().to_string();
    let own = path.parent().unwrap_or(Path::new(""));
    Ok(SceneFile::of_text(&text, &name, Path::new("")).reaching(own))
}

/// The space-time diagram of a command: of the file that was named, or of the built-in scene.
pub fn load_diagram(path: Option<&Path>, overrides: &Overrides) -> Result<Diagram> {
    match path {
        Some(path) => figures::diagram::load(path, overrides),
        None => figures::diagram::parse(TEXT, NAME, Path::new(FOLDER), overrides),
    }
}
