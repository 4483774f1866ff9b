//! The scene that is compiled in.

use std::path::Path;

use nullray::figures::diagram::model::Diagram;
use nullray::io::files;
use nullray::scene::model::{Panel, Scene};
use nullray::scene::{ModelView, Overrides};
use nullray::{Result, figures, scene};

/// The text of the built-in scene.
pub const TEXT: &str = include_str!("../../scenes/corner.toml");
const NAME: &str = "built-in scene";
const FOLDER: &str = files::BUILT_IN;

/// The scene of a command: the file that was named, or that which a named model stands for, or the built-in one.
pub fn load(path: Option<&Path>, overrides: &Overrides) -> Result<Scene> {
    match path {
        Some(path) if is_model(path) => load_model(path, &ModelView::default(), overrides),
        Some(path) => scene::load(path, overrides),
        None => scene::parse(TEXT, NAME, Path::new(FOLDER), overrides),
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
pub fn load_model(path: &Path, view: &ModelView, overrides: &Overrides) -> Result<Scene> {
    let view = ModelView {
        size: overrides.size,
        ..view.clone()
    };
    let text = scene::model_scene(path, &view)?;
    scene::parse(&text, &path.display().to_string(), Path::new(""), overrides)
}

/// `whole` again, which was loaded from `path`, with its shot at `time`, a text with its unit.
pub fn at_time(
    path: Option<&Path>,
    whole: &Scene,
    overrides: Overrides,
    time: String,
) -> Result<Scene> {
    match path {
        // Its text has the other overrides in it, and took a look at the model.
        Some(path) if is_model(path) => {
            let overrides = Overrides {
                time: Some(time),
                ..Overrides::default()
            };
            scene::parse(&whole.text, &whole.name, Path::new(""), &overrides)
        }
        path => load(
            path,
            &Overrides {
                time: Some(time),
                ..overrides
            },
        ),
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
