//! Where scenes come from: files, standard input, and the built-in scene.

use std::io;
use std::path::Path;
use std::sync::Mutex;

use nullray::figures::diagram::model::Diagram;
use nullray::io::budget::Budget;
use nullray::io::files;
use nullray::scene::{ModelScene, ModelView, Overrides, SceneFile};
use nullray::{Result, figures, scene};

use super::failure::refused;

/// The text of the built-in scene.
pub const TEXT: &str = include_str!("../../scenes/corner.toml");
const NAME: &str = "built-in scene";
const FOLDER: &str = files::BUILT_IN;
/// The name of a scene from standard input.
const STANDARD_INPUT: &str = "<stdin>";

/// The scene file of a command, read once: the named one, or the scene for a named model, or the built-in one. A model may take `memory`
/// bytes to load.
pub fn open(path: Option<&Path>, overrides: &Overrides, memory: u64) -> Result<SceneFile> {
    match path {
        Some(path) if is_model(path) => {
            let made = model_scene(path, &ModelView::default(), overrides, memory)?;
            Ok(of_model(path, &made.text()))
        }
        Some(path) => read(path),
        None => Ok(SceneFile::of_text(TEXT, NAME, Path::new(FOLDER))),
    }
}

/// The scene file at `path`, or from standard input; paths in the latter resolve against the working directory.
pub fn read(path: &Path) -> Result<SceneFile> {
    // Standard input can be read only once, but some commands ask for their scene more than once.
    static TEXT: Mutex<Option<String>> = Mutex::new(None);
    if !is_standard_input(path) {
        return SceneFile::read(path);
    }
    let mut text = TEXT.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
    let text = match &mut *text {
        Some(text) => text,
        none => {
            let file = SceneFile::read_from(io::stdin().lock(), STANDARD_INPUT, Path::new(""))?;
            none.insert(file.text().to_string())
        }
    };
    Ok(SceneFile::of_text(text, STANDARD_INPUT, Path::new("")))
}

/// Whether this name means standard input.
pub fn is_standard_input(path: &Path) -> bool {
    const NAMES: [&str; 4] = ["-", "/dev/stdin", "/dev/fd/0", "/proc/self/fd/0"];
    NAMES.iter().any(|name| path.as_os_str() == *name)
}

/// The folder against which paths of the scene of a command resolve.
pub fn base(path: Option<&Path>) -> &Path {
    match path {
        Some(path) if is_standard_input(path) || is_model(path) => Path::new(""),
        Some(path) => path.parent().unwrap_or(Path::new("")),
        None => Path::new(FOLDER),
    }
}

/// Like [`open`], but a model is viewed according to `model`; scenes refuse those options.
pub fn open_as(
    path: Option<&Path>,
    model: &ModelView,
    overrides: &Overrides,
    memory: u64,
) -> Result<SceneFile> {
    match model_as(path, model, overrides, memory)? {
        Some((path, made)) => Ok(of_model(path, &made.text())),
        None => open(path, overrides, memory),
    }
}

/// If `path` is a model: the model, and the scene for it, viewed according to `model`; scenes refuse those options.
pub fn model_as<'a>(
    path: Option<&'a Path>,
    model: &ModelView,
    overrides: &Overrides,
    memory: u64,
) -> Result<Option<(&'a Path, ModelScene)>> {
    let moves = model.beta.is_some() || model.flyby || model.flash.is_some();
    if model.direction.is_some() && model.beta.is_none() && !model.flyby {
        let what = "it says where a moving camera goes, but this one is at rest";
        return Err(refused("--direction", what, "add --beta 0.9, or --flyby"));
    }
    match path {
        Some(path) if is_model(path) => {
            let made = model_scene(path, model, overrides, memory)?;
            Ok(Some((path, made)))
        }
        _ if model.flash.is_some() => {
            let what = "it lights a model without a scene, but this is a scene";
            let help = "give a [[light]] of the scene an emission, like { gaussian = { sigma = \"5 cm\" } }, and `nullray bake` it";
            Err(refused("--flash", what, help))
        }
        _ if moves => {
            let option = match model.flyby {
                true => "--flyby",
                false => "--beta",
            };
            let what = "it sets the view of a model without a scene, but this is a scene";
            let help =
                "set the camera's velocity: --set camera.velocity={beta=0.9,direction=[1,0,0]}";
            Err(refused(option, what, help))
        }
        _ => Ok(None),
    }
}

/// Whether the file is a model, judging by its name.
pub fn is_model(path: &Path) -> bool {
    let extension = path.extension().unwrap_or_default();
    ["glb", "gltf"]
        .iter()
        .any(|e| extension.eq_ignore_ascii_case(e))
}

/// The scene for a model, viewed according to `view`; loading may take `memory` bytes.
pub fn model_scene(
    path: &Path,
    view: &ModelView,
    overrides: &Overrides,
    memory: u64,
) -> Result<ModelScene> {
    let view = ModelView {
        size: overrides.size,
        allow_outside: overrides.allow_outside,
        ..view.clone()
    };
    scene::model_scene(path, &view, &Budget::new(memory))
}

/// The scene with this text for the model at `path`.
pub fn of_model(path: &Path, text: &str) -> SceneFile {
    let name = path.display().to_string();
    let own = path.parent().unwrap_or(Path::new(""));
    SceneFile::of_text(text, &name, Path::new("")).reaching(own)
}

/// The space-time diagram of the file that [`open`] returns.
pub fn diagram(file: &SceneFile, overrides: &Overrides) -> Result<Diagram> {
    figures::diagram::parse(file.text(), file.name(), file.base(), overrides)
}
