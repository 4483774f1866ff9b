//! `nullray diagram`.

mod pixel;

use std::path::{Path, PathBuf};

use nullray::drawing::{self, Drawing, pdf, png, svg};
use nullray::scene::Overrides;
use nullray::scene::model::diagram::Diagram;
use nullray::{Result, diagram};

use super::args::DiagramArguments;
use super::failure::refused;
use super::panels::named_after;
use super::{builtin, inputs, print};

pub fn run(arguments: &DiagramArguments) -> Result<()> {
    let outputs = outputs(arguments)?;
    let mut model = match arguments.pixel.pixel {
        Some(pixel) => pixel::model(arguments, pixel)?,
        None => model(arguments)?,
    };
    restyle(&mut model, arguments);
    let layout = diagram::layout(&model);
    let drawing = diagram::draw(&layout, &model.style)?;
    for output in &outputs {
        save(&drawing, output, arguments.scale)?;
        if !arguments.quiet && !arguments.pixel.json {
            let [width, height] = [drawing.width, drawing.height].map(f64::round);
            print(&format!(
                "wrote {} ({width} × {height} points)\n",
                output.display()
            ))?;
        }
    }
    Ok(())
}

/// What the file says, or its scene: without a look at meshes and cubes.
fn model(arguments: &DiagramArguments) -> Result<Diagram> {
    let path = arguments.scene.as_deref();
    let overrides = overrides(arguments, arguments.frame.as_deref());
    match &arguments.panel {
        None => builtin::load_diagram(path, &overrides),
        Some(_) => pixel::diagram_of(arguments, &pixel::scene(arguments, &overrides)?),
    }
}

fn save(drawing: &Drawing, path: &Path, scale: f64) -> Result<()> {
    match extension(path).as_str() {
        "svg" => drawing::save(path, svg::write(drawing)?),
        "pdf" => drawing::save(path, pdf::write(drawing)?),
        _ => drawing::save(path, png::write(&png::render(drawing, scale)?)?),
    }
}

/// Where to write; refused before anything is read.
fn outputs(arguments: &DiagramArguments) -> Result<Vec<PathBuf>> {
    let path = arguments.scene.as_deref();
    if arguments.output.is_empty() {
        return Ok(vec![named_after(path, ".svg")]);
    }
    let read = path.map(inputs::identity);
    for output in &arguments.output {
        let option = format!("-o {}", output.display());
        if !["svg", "pdf", "png"].contains(&extension(output).as_str()) {
            let what = "the name does not say which kind of drawing to write";
            return Err(refused(option, what, "end it in .svg, .pdf or .png"));
        }
        if Some(inputs::identity(output)) == read {
            let what = "this is the file that the diagram is made of: it would be overwritten";
            return Err(refused(option, what, "write to another name"));
        }
    }
    Ok(arguments.output.clone())
}

fn extension(path: &Path) -> String {
    let extension = path.extension().unwrap_or_default();
    extension.to_string_lossy().to_ascii_lowercase()
}

/// What the command line changes of the file; drawn in `frame`.
fn overrides(arguments: &DiagramArguments, frame: Option<&str>) -> Overrides {
    let quoted = |text: &str| format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""));
    let mut set = arguments.set.clone();
    let said = [
        ("diagram.view", frame),
        ("diagram.dimensions", arguments.dimensions.as_deref()),
    ];
    let said = said
        .into_iter()
        .filter_map(|(key, text)| Some((key.to_string(), quoted(text?))));
    set.extend(said);
    Overrides {
        set,
        time: arguments.time.clone(),
        size: arguments.pixel.image_size,
        ..Overrides::default()
    }
}

/// What the command line says of looks goes before what the file says.
fn restyle(model: &mut Diagram, arguments: &DiagramArguments) {
    model.style.dark |= arguments.dark;
    if let Some([width, height]) = arguments.size {
        model.style.width = Some(f64::from(width));
        model.style.height = Some(f64::from(height));
    }
}
