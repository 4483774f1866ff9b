//! The scene that is compiled in, and what happens without a command.

use std::fs;
use std::path::Path;

use nullray::scene::Overrides;
use nullray::scene::model::Scene;
use nullray::{Error, Result, files};

use super::args::SceneArguments;
use super::output::{Isochrones, Outputs};
use super::{print, render};

const TEXT: &str = include_str!("../../scenes/corner.toml");
const NAME: &str = "built-in scene";
const DIRECTORY: &str = "nullray-out";

/// The scene of a command: the file that was named, or the built-in one.
pub fn scene_or_builtin(arguments: &SceneArguments) -> Result<Scene> {
    match &arguments.scene {
        Some(path) => nullray::scene::load(path, &arguments.overrides()),
        None => scene(&arguments.overrides()),
    }
}

fn scene(overrides: &Overrides) -> Result<Scene> {
    nullray::scene::parse(TEXT, NAME, Path::new(files::BUILT_IN), overrides)
}

/// Renders the built-in scene three times: as a camera at rest sees it, as the moving one does, and
/// the times at which its light left.
pub fn render() -> Result<()> {
    let directory = Path::new(DIRECTORY);
    fs::create_dir_all(directory).map_err(Error::io(directory, "cannot create the directory"))?;
    print("nullray: a pulse of light in a corner, at one moment: seen at rest, then at 0.9 c\n")?;
    let set = |key: &str, value: &str| (key.to_string(), value.to_string());
    let at_rest = Overrides {
        set: vec![
            set("camera.velocity", "{ beta = [0.0, 0.0, 0.0] }"),
            set("camera.look_at", "[1.36, 1.9, 2.82]"),
            set("camera.hfov", "\"60 deg\""),
        ],
        ..Overrides::default()
    };
    one(
        &at_rest,
        Outputs {
            images: vec![directory.join("at-rest.png")],
            ..Outputs::default()
        },
    )?;
    let moving = Outputs {
        images: vec![directory.join("moving.png"), directory.join("moving.exr")],
        isochrones: Some(Isochrones {
            path: directory.join("moving-isochrones.png"),
            step: None,
        }),
        ..Outputs::default()
    };
    one(&Overrides::default(), moving)?;
    print(NEXT)
}

fn one(overrides: &Overrides, outputs: Outputs) -> Result<()> {
    let request = nullray::plan::Request {
        aovs: outputs.needs(),
        ..Default::default()
    };
    print(&render::one(&scene(overrides)?, &request, &outputs, false)?)
}

const NEXT: &str = "
What to try next:
  nullray render --set camera.velocity.beta=[0.0,0.0,0.5] --time \"0.4 m\" -o slower.png
  nullray plan                     what that needs, and what is skipped
  nullray render scenes/cube/approaching-0.9.toml -o cube.png
";
