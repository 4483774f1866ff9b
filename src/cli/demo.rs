//! The program without a command: renders the built-in scene, and suggests what to try next.

use std::fs;
use std::io::{Read, Write};
use std::path::Path;

use nullray::io::files;
use nullray::io::image::write_atomically;
use nullray::scene::Overrides;
use nullray::{Error, Result};

use super::builtin::{self, TEXT};
use super::console::print;
use super::output::Outputs;
use super::{film, interrupt};
use nullray::render::prepare::LoadedCubes;

const DIRECTORY: &str = "nullray-out";

/// Renders the built-in scene twice: as seen by a camera at rest, and by the moving one, with retarded times. Leaves the scene and its data
/// there for changes.
pub fn run() -> Result<()> {
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
        isochrones: Some(directory.join("moving-isochrones.png")),
        ..Outputs::default()
    };
    one(&Overrides::default(), moving)?;
    leave_scene(directory)?;
    print(&next())
}

fn one(overrides: &Overrides, outputs: Outputs) -> Result<()> {
    let scene = builtin::open(None, overrides, 0)?.scene(overrides)?;
    let request = nullray::render::plan::Request {
        aovs: outputs.needs(&scene),
        ..Default::default()
    };
    film::one(
        &scene,
        &request,
        &outputs,
        (false, None),
        &mut LoadedCubes::default(),
    )
}

/// Writes the built-in scene and its files into `directory`; existing files are kept.
fn leave_scene(directory: &Path) -> Result<()> {
    leave(&directory.join("corner.toml"), TEXT.as_bytes())?;
    for name in files::built_in_names() {
        let source = Path::new(files::BUILT_IN).join(name);
        let mut bytes = Vec::new();
        let (mut reader, _) = files::open(&source).map_err(Error::io(&source, "cannot read"))?;
        (reader.read_to_end(&mut bytes)).map_err(Error::io(&source, "cannot read"))?;
        leave(&directory.join(name), &bytes)?;
    }
    Ok(())
}

/// Writes a new file; an existing one is kept, because its owner may have changed it.
fn leave(path: &Path, bytes: &[u8]) -> Result<()> {
    if path.exists() {
        return print(&format!("kept {} as it is\n", path.display()));
    }
    interrupt::check()?;
    if let Some(parent) = path.parent() {
        fs::create_dir_all(parent).map_err(Error::io(parent, "cannot create the directory"))?;
    }
    write_atomically(path, |file| {
        file.write_all(bytes)
            .map_err(Error::io(path, "cannot write"))
    })?;
    print(&format!("wrote {}\n", path.display()))
}

/// Commands to try next, with the name by which the program was started.
fn next() -> String {
    let program = std::env::args_os().next();
    let program = program.map_or("nullray".into(), |name| name.to_string_lossy().into_owned());
    format!(
        "
What to try next:
  {program} plan {DIRECTORY}/corner.toml
  {program} info {DIRECTORY}/corner/lightmap.npz
  {program} render {DIRECTORY}/corner.toml --set camera.velocity.beta=0.8 -o slower.png
"
    )
}
