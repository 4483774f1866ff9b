//! `nullray diagram --pixel`.

use nullray::figures;
use nullray::figures::diagram::model::Diagram;
use nullray::figures::pixel_probe::{self, Probe};
use nullray::scene::Overrides;
use nullray::scene::model::Scene;
use nullray::{Error, Result};

use super::overrides;
use crate::cli::args::{DiagramArguments, Origin};
use crate::cli::console::{print_json, say};
use crate::cli::failure::refused;
use crate::cli::progress::Bar;
use crate::cli::{builtin, interrupt, panels};

/// Returns the diagram of what a pixel sees, and prints its numbers.
pub fn model(arguments: &DiagramArguments, pixel: [u32; 2]) -> Result<Diagram> {
    let scene = scene(arguments, &overrides(arguments, None))?;
    let base = diagram_of(arguments, &scene)?;
    let quiet = arguments.quiet.on || arguments.pixel.json;
    let bar = Bar::new(0, quiet);
    let limit = arguments.pixel.memory.bytes();
    let probe = pixel_probe::trace(&scene, pixel, limit, &bar)?;
    drop(bar);
    interrupt::check()?;
    let known = known(&base, &probe);
    let frame = arguments.frame.as_deref();
    let origin = arguments.pixel.origin.map(|origin| match origin {
        Origin::Camera => pixel_probe::Origin::Reception,
        Origin::Object => pixel_probe::Origin::Emission,
    });
    if origin == Some(pixel_probe::Origin::Emission) && probe.hit.is_none() {
        let what = format!("nothing is visible in pixel {},{}", pixel[0], pixel[1]);
        let help = "choose a pixel that shows an object, or leave out --origin";
        return Err(refused("--origin object", what, help));
    }
    let model = pixel_probe::diagram(&probe, base, frame, origin);
    let model = model.ok_or_else(|| unknown(frame.unwrap_or_default(), &known))?;
    print_numbers(arguments, &probe)?;
    Ok(model)
}

/// The scene, or a panel of it.
pub fn scene(arguments: &DiagramArguments, overrides: &Overrides) -> Result<Scene> {
    let path = arguments.scene.path();
    let memory = arguments.pixel.memory.bytes();
    panels::scene(path, arguments.panel.name(), overrides, memory)
}

/// The diagram of `scene`, whose text already has all changes.
pub fn diagram_of(arguments: &DiagramArguments, scene: &Scene) -> Result<Diagram> {
    let base = builtin::base(arguments.scene.path());
    figures::diagram::parse(&scene.text, &scene.name, base, &Overrides::default())
}

/// The frames in which a diagram can be drawn.
fn known(base: &Diagram, probe: &Probe) -> Vec<String> {
    let frames = base.frames.iter().map(|frame| frame.name.clone());
    let mut names: Vec<String> = frames
        .chain(probe.hit.iter().map(|hit| hit.name.clone()))
        .collect();
    names.dedup();
    names
}

fn unknown(name: &str, known: &[String]) -> Error {
    let help = format!("there are: {}", known.join(", "));
    refused(
        format!("--frame {}", name.escape_debug()),
        "there is no frame of this name",
        &help,
    )
}

fn print_numbers(arguments: &DiagramArguments, probe: &Probe) -> Result<()> {
    if arguments.pixel.json {
        return print_json(probe);
    }
    say(arguments.quiet.on, &probe.to_string())
}
