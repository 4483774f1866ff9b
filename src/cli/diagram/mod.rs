//! `nullray diagram`.

mod series;

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use nullray::drawing::{self, Drawing, pdf, png, svg};
use nullray::scene::Overrides;
use nullray::scene::model::diagram::Diagram;
use nullray::{Result, diagram};

use super::args::DiagramArguments;
use super::failure::refused;
use super::output::{extension, will_write};
use super::panels::named_after;
use super::{builtin, inputs, interrupt, metadata, print};

/// The kinds of files, by extension.
const KINDS: [&str; 4] = ["svg", "pdf", "png", "apng"];

/// A file to be written.
pub struct Output {
    path: PathBuf,
    /// Its extension, one of [`KINDS`].
    kind: String,
}

pub fn run(arguments: &DiagramArguments) -> Result<()> {
    let path = arguments.scene.as_deref();
    let outputs = outputs(arguments)?;
    let overrides = Overrides {
        set: changes(arguments),
        ..Overrides::default()
    };
    let mut model = builtin::load_diagram(path, &overrides)?;
    restyle(&mut model, arguments);
    let page = Pages {
        arguments,
        origin: metadata::of_text(&model.name, &model.text),
        outputs,
    };
    if arguments.frames.is_none() {
        page.still(&model)?;
    }
    series::write(&page, &model)
}

/// What is to be written.
pub struct Pages<'a> {
    arguments: &'a DiagramArguments,
    outputs: Vec<Output>,
    /// What files say of it.
    origin: Vec<(String, String)>,
}

impl Pages<'_> {
    fn stills(&self) -> impl Iterator<Item = &Output> {
        self.outputs.iter().filter(|output| !output.is_animated())
    }

    fn animated(&self) -> impl Iterator<Item = &Output> {
        self.outputs.iter().filter(|output| output.is_animated())
    }

    /// Writes the diagram as it stands.
    fn still(&self, model: &Diagram) -> Result<()> {
        if self.stills().next().is_none() {
            return Ok(());
        }
        let drawing = diagram::draw(&diagram::layout(model), &model.style)?;
        self.stills()
            .try_for_each(|output| self.save(&drawing, output, &output.path))
    }

    /// Writes one file; says so unless asked to be quiet.
    fn save(&self, drawing: &Drawing, output: &Output, path: &Path) -> Result<()> {
        interrupt::check()?;
        will_write(path);
        drawing::save(path, self.bytes(drawing, &output.kind)?)?;
        if self.arguments.quiet {
            return Ok(());
        }
        let [width, height] = [drawing.width, drawing.height].map(f64::round);
        let path = path.display();
        print(&format!("wrote {path} ({width} × {height} points)\n"))
    }

    fn bytes(&self, drawing: &Drawing, kind: &str) -> Result<Vec<u8>> {
        match kind {
            "svg" => Ok(svg::write_with(drawing, &self.origin)?.into_bytes()),
            "pdf" => pdf::write_with(drawing, &self.origin),
            _ => {
                let raster = png::render(drawing, self.arguments.scale)?;
                png::write_with(&raster, &self.origin)
            }
        }
    }
}

impl Output {
    fn of(path: &Path) -> Output {
        Output {
            path: path.into(),
            kind: extension(path),
        }
    }

    fn is_animated(&self) -> bool {
        self.kind == "apng"
    }
}

/// Where to write; refused before anything is read.
fn outputs(arguments: &DiagramArguments) -> Result<Vec<Output>> {
    let path = arguments.scene.as_deref();
    let outputs: Vec<Output> = match arguments.output.as_slice() {
        [] => vec![Output::of(&named_after(path, ".svg"))],
        said => said.iter().map(|path| Output::of(path)).collect(),
    };
    let read = path.map(inputs::identity);
    let mut written = HashSet::new();
    for output in &outputs {
        let option = format!("-o {}", output.path.display());
        if !KINDS.contains(&output.kind.as_str()) {
            let what = "the name does not say which kind of drawing to write";
            let help = "end it in .svg, .pdf, .png, or .apng (animated)";
            return Err(refused(option, what, help));
        }
        for name in series::names(arguments, output) {
            let identity = inputs::identity(&name);
            if Some(&identity) == read.as_ref() {
                let what = "this is the file that the diagram is made of: it would be overwritten";
                return Err(refused(option, what, "write to another name"));
            }
            if !written.insert(identity) {
                let help = "give each drawing a name of its own";
                return Err(refused(option, "two outputs have this name", help));
            }
        }
    }
    Ok(outputs)
}

fn changes(arguments: &DiagramArguments) -> Vec<(String, String)> {
    let quoted = |name: &str| format!("\"{}\"", name.replace('\\', "\\\\").replace('"', "\\\""));
    let mut set = arguments.set.clone();
    if let Some(frame) = &arguments.frame {
        set.push(("diagram.view".into(), quoted(frame)));
    }
    if let Some(frame) = &arguments.boost_to {
        set.push(("diagram.animation.boost_to".into(), quoted(frame)));
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
