//! `nullray diagram`.

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
    let path = arguments.scene.as_deref();
    let outputs = outputs(arguments)?;
    let overrides = Overrides {
        set: changes(arguments),
        ..Overrides::default()
    };
    let mut model = builtin::load_diagram(path, &overrides)?;
    restyle(&mut model, arguments);
    let layout = diagram::layout(&model);
    let drawing = diagram::draw(&layout, &model.style)?;
    for output in &outputs {
        save(&drawing, output, arguments.scale)?;
        if !arguments.quiet {
            let [width, height] = [drawing.width, drawing.height].map(f64::round);
            print(&format!(
                "wrote {} ({width} × {height} points)\n",
                output.display()
            ))?;
        }
    }
    Ok(())
}

/// Writes `drawing` as the extension of `path` says; what is no vector format is a .png of `scale` pixels a point.
pub fn save(drawing: &Drawing, path: &Path, scale: f64) -> Result<()> {
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

fn changes(arguments: &DiagramArguments) -> Vec<(String, String)> {
    let mut set = arguments.set.clone();
    if let Some(frame) = &arguments.frame {
        let quoted = format!("\"{}\"", frame.replace('\\', "\\\\").replace('"', "\\\""));
        set.push(("diagram.view".into(), quoted));
    }
    set
}

/// What the command line says of looks goes before what the file says.
fn restyle(model: &mut Diagram, arguments: &DiagramArguments) {
    model.style.dark |= arguments.dark;
    if let Some([width, height]) = arguments.size {
        model.style.width = Some(f64::from(width));
        model.style.height = Some(f64::from(height));
    }
}
