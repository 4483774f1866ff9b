//! `nullray diagram`.

mod pixel;
mod series;

use std::path::{Path, PathBuf};

use nullray::Result;
use nullray::figures::diagram;
use nullray::figures::diagram::model::Diagram;
use nullray::figures::drawing::{self, Drawing, pdf, svg};
use nullray::render::metadata;
use nullray::scene::Overrides;

use super::args::DiagramArguments;
use super::check::{Names, by_ffmpeg, unknown_format};
use super::console::say;
use super::failure::refused;
use super::names::named_after;
use super::output::{encoded, extension};
use super::{builtin, inputs, interrupt, reel};

/// The kinds of files, by extension.
const KINDS: [&str; 6] = ["svg", "pdf", "png", "tex", "apng", "y4m"];

/// A file to be written.
pub struct Output {
    path: PathBuf,
    /// Its extension, one of [`KINDS`].
    kind: String,
}

pub fn run(arguments: DiagramArguments) -> Result<()> {
    let arguments = &arguments;
    reel::keep_pipe(&arguments.output);
    let outputs = outputs(arguments)?;
    check_boost(arguments, &outputs)?;
    check_speed(arguments, &outputs)?;
    let mut model = match arguments.pixel.pixel {
        Some(pixel) => pixel::model(arguments, pixel)?,
        None => model(arguments)?,
    };
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

/// Refuses a boost of which no output shows more than the first picture.
fn check_boost(arguments: &DiagramArguments, outputs: &[Output]) -> Result<()> {
    let is_shown = arguments.frames.is_some() || outputs.iter().any(Output::is_animated);
    match &arguments.boost_to {
        Some(name) if !is_shown => {
            let what = "a single picture does not show a boost";
            let help = format!(
                "-o FILE.apng, numbered pictures with --frames 0..72, or --frame {name} for the last one alone"
            );
            Err(refused(format!("--boost-to {name}"), what, &help))
        }
        _ => Ok(()),
    }
}

/// Refuses a speed of a film that is not written.
fn check_speed(arguments: &DiagramArguments, outputs: &[Output]) -> Result<()> {
    if arguments.fps.is_none() || outputs.iter().any(Output::is_animated) {
        return Ok(());
    }
    let what = "it is the speed of a film, but none of these files is one";
    let help = "add an output, -o FILE.apng or -o FILE.y4m, or leave out --play-fps";
    Err(refused("--play-fps", what, help))
}

/// The file's diagram, or that of its scene; meshes and cubes are not read.
fn model(arguments: &DiagramArguments) -> Result<Diagram> {
    let path = arguments.scene.path();
    let overrides = overrides(arguments, arguments.frame.as_deref());
    match arguments.panel.name() {
        None => {
            let memory = arguments.pixel.memory.bytes();
            builtin::diagram(&builtin::open(path, &overrides, memory)?, &overrides)
        }
        Some(_) => pixel::diagram_of(arguments, &pixel::scene(arguments, &overrides)?),
    }
}

/// The outputs to write.
pub struct Pages<'a> {
    arguments: &'a DiagramArguments,
    outputs: Vec<Output>,
    /// The metadata of files.
    origin: Vec<(String, String)>,
}

impl Pages<'_> {
    fn stills(&self) -> impl Iterator<Item = &Output> {
        self.outputs.iter().filter(|output| !output.is_animated())
    }

    fn animated(&self) -> impl Iterator<Item = &Output> {
        self.outputs.iter().filter(|output| output.is_animated())
    }

    /// The drawing with its metadata.
    fn signed(&self, drawing: Drawing) -> Drawing {
        Drawing {
            origin: self.origin.clone(),
            ..drawing
        }
    }

    /// Writes the diagram as a single picture.
    fn still(&self, model: &Diagram) -> Result<()> {
        if self.stills().next().is_none() {
            return Ok(());
        }
        let drawing = self.signed(diagram::draw(&diagram::layout(model), &model.style)?);
        self.stills()
            .try_for_each(|output| self.save(&drawing, output, &output.path))
    }

    /// Writes one file, and reports it unless quiet.
    fn save(&self, drawing: &Drawing, output: &Output, path: &Path) -> Result<()> {
        interrupt::check()?;
        let bytes = match (self.arguments.text, output.kind.as_str()) {
            (true, "svg") => svg::write_with_text(drawing)?.into_bytes(),
            (true, "pdf") => pdf::write_with_text(drawing)?,
            (_, kind) => encoded(drawing, kind, self.arguments.scale)?,
        };
        drawing::save(path, bytes)?;
        let [width, height] = [drawing.width, drawing.height].map(f64::round);
        let path = path.display();
        let quiet = self.arguments.quiet.on || self.arguments.pixel.json;
        say(
            quiet,
            &format!("wrote {path} ({width} × {height} points)\n"),
        )
    }
}

impl Output {
    fn of(path: &Path) -> Output {
        Output {
            path: path.into(),
            kind: match reel::is_pipe(path) {
                true => "y4m".into(),
                false => extension(path),
            },
        }
    }

    fn is_animated(&self) -> bool {
        matches!(self.kind.as_str(), "apng" | "y4m")
    }
}

/// The outputs; problems with them are reported before anything is read.
fn outputs(arguments: &DiagramArguments) -> Result<Vec<Output>> {
    let path = arguments.scene.path();
    let outputs: Vec<Output> = match arguments.output.as_slice() {
        [] => vec![Output::of(&named_after(path, ".svg"))],
        said => said.iter().map(|path| Output::of(path)).collect(),
    };
    let overwritten = "the diagram is made from this file, which would be overwritten";
    let mut names = Names::new(read(arguments), overwritten, " drawing");
    for output in &outputs {
        let option = format!("-o {}", output.path.display());
        if !KINDS.contains(&output.kind.as_str()) {
            let known =
                "end it in .svg, .pdf, .png, .tex (TikZ), .apng (animated) or .y4m (raw video)";
            let help = known.to_string() + &by_ffmpeg(&output.kind);
            return Err(unknown_format(option, &output.path, "drawing", &help));
        }
        if reel::is_pipe(&output.path) {
            continue;
        }
        for name in series::names(arguments, output) {
            names.check(&option, &name)?;
        }
    }
    Ok(outputs)
}

/// The file, and the inputs of the scene in it, if there is one.
fn read(arguments: &DiagramArguments) -> Vec<PathBuf> {
    let path = arguments.scene.path();
    // Errors in the scene are reported later, where they matter.
    let scene = pixel::scene(arguments, &overrides(arguments, None));
    let files = scene.map_or_else(|_| Vec::new(), |scene| inputs::of_any(&scene));
    path.into_iter().map(PathBuf::from).chain(files).collect()
}

/// The command line's changes to the file, with `frame` as the frame to draw in.
fn overrides(arguments: &DiagramArguments, frame: Option<&str>) -> Overrides {
    Overrides {
        set: arguments.edits.set.clone(),
        time: arguments.edits.time.clone(),
        size: arguments.pixel.image_size,
        frame: frame.map(String::from),
        boost_to: arguments.boost_to.clone(),
        dimensions: arguments.dimensions.clone(),
        allow_outside: arguments.pixel.files.allow_outside,
        ..Overrides::default()
    }
}

/// Style options of the command line take precedence over the file's.
fn restyle(model: &mut Diagram, arguments: &DiagramArguments) {
    model.style.dark |= arguments.dark;
    if let Some([width, height]) = arguments.size {
        model.style.width = Some(f64::from(width));
        model.style.height = Some(f64::from(height));
    }
}
