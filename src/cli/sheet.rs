//! `nullray sheet`.

use std::fs;
use std::path::{Path, PathBuf};

use nullray::approximate::raster::Method;
use nullray::figures::contact_sheet::{self, Layout, SheetOptions, Size};
use nullray::io::image;
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::{LoadedCubes, check_files};
use nullray::scene::SceneFile;
use nullray::scene::model::{Panel, Scene, Show};
use nullray::{Error, Result};

use super::args::SheetArguments;
use super::check::{check_all, check_page};
use super::console::say;
use super::film::Ready;
use super::names::{named_after, stem, suffixed};
use super::output::{Outputs, Picture, picture};
use super::progress::Bar;
use super::{builtin, film, inputs, interrupt};

pub fn run(arguments: &SheetArguments) -> Result<()> {
    if let Some(output) = &arguments.output {
        check_page(output, arguments.scenes.len())?;
    }
    // Panels mostly show the same cubes.
    let mut cubes = LoadedCubes::default();
    let figures: Result<Vec<_>> = arguments
        .scenes
        .iter()
        .map(|path| Figure::new(path, arguments, &mut cubes))
        .collect();
    let figures = figures?;
    figures.iter().try_for_each(Figure::check_page)?;
    make_directory(arguments)?;
    check(&figures)?;
    film::in_pool(arguments.work.threads.count, || {
        figures
            .iter()
            .try_for_each(|figure| figure.make(arguments.work.quiet.on, &mut cubes))
    })
}

/// A page to make.
struct Figure {
    /// The scene with all its panels.
    whole: Scene,
    output: PathBuf,
    parts: Vec<Part>,
}

/// A panel to render.
struct Part {
    scene: Scene,
    label: String,
    /// Whether it begins a row.
    new_row: bool,
    /// The panel's own file, if it is kept.
    outputs: Outputs,
    request: Request,
}

impl Figure {
    fn new(path: &Path, arguments: &SheetArguments, cubes: &mut LoadedCubes) -> Result<Figure> {
        let (changes, overrides) = (&arguments.changes, arguments.changes.overrides());
        let file = builtin::open(Some(path), &overrides, changes.memory.bytes())?;
        let whole = file.scene(&overrides)?;
        let directory = arguments.directory.as_deref().unwrap_or(Path::new(""));
        let default = || directory.join(named_after(Some(path), "-sheet.png"));
        let output = arguments.output.clone().unwrap_or_else(default);
        let beside = output.with_file_name(named_after(Some(path), ".png"));
        let parts = parts(path, (&file, &whole), &beside, arguments, cubes)?;
        Ok(Figure {
            whole,
            output,
            parts,
        })
    }

    /// Refuses characters that the font lacks, and pictures that do not fit on a page, before anything is rendered. Legends can only
    /// enlarge pictures beyond the sizes used here.
    fn check_page<'s>(&'s self) -> Result<()> {
        let size = |part: &'s Part| {
            let [width, height] = part.scene.camera.size;
            Size {
                width,
                height,
                label: &part.label,
                new_row: part.new_row,
            }
        };
        let panels: Vec<Size> = self.parts.iter().map(size).collect();
        Layout::of_sizes(&panels, &self.options()).map(drop)
    }

    fn options(&self) -> SheetOptions {
        SheetOptions {
            title: self.whole.sheet.title.clone(),
            columns: self.whole.sheet.columns,
        }
    }

    /// All files that are read for it.
    fn inputs(&self) -> Result<Vec<PathBuf>> {
        let mut read = Vec::new();
        for part in &self.parts {
            read.extend(inputs::of(
                &part.scene,
                &Plan::new(&part.scene, &part.request)?,
            ));
        }
        Ok(read)
    }

    /// Renders all panels, and writes the page that they form.
    fn make(&self, quiet: bool, cubes: &mut LoadedCubes) -> Result<()> {
        let mut panels = Vec::new();
        for part in &self.parts {
            say(quiet, &format!("panel {}\n", part.label))?;
            panels.push(part.render(quiet, cubes)?);
        }
        let page = contact_sheet::compose(&panels, &self.options())?;
        interrupt::check()?;
        image::png::write(
            &self.output,
            page.width,
            page.height,
            &page.rgb,
            &self.metadata(),
        )?;
        let (width, height) = (page.width, page.height);
        let name = self.output.display();
        say(
            quiet,
            &format!("wrote {name} ({width} × {height} pixels)\n"),
        )
    }

    fn metadata(&self) -> Vec<(String, String)> {
        let labels: Vec<_> = self.parts.iter().map(|part| part.label.as_str()).collect();
        let pairs = [
            ("software", format!("nullray {}", env!("CARGO_PKG_VERSION"))),
            ("scene", self.whole.name.clone()),
            ("scene_text", self.whole.text.clone()),
            ("panels", labels.join("\n")),
        ];
        pairs.map(|(key, value)| (key.to_string(), value)).into()
    }
}

/// A part for each panel, or one for a scene without panels; pictures are named after `beside`.
fn parts(
    path: &Path,
    (file, whole): (&SceneFile, &Scene),
    beside: &Path,
    arguments: &SheetArguments,
    cubes: &mut LoadedCubes,
) -> Result<Vec<Part>> {
    if whole.panels.is_empty() {
        let alone = Panel {
            name: String::new(),
            label: stem(Some(path)).display().to_string(),
            show: Show::Picture,
            new_row: false,
            set: Vec::new(),
            span: 0..0,
        };
        return Ok(vec![part(whole.clone(), &alone, arguments, beside.into())]);
    }
    let (changes, threads) = (&arguments.changes, arguments.work.threads.count);
    let exposure = &arguments.exposure;
    let scenes = exposure.panels(file, whole, changes, threads, cubes, true)?;
    let part = |(panel, scene): (&Panel, Scene)| {
        let file = suffixed(beside, &panel.name);
        part(scene, panel, arguments, file)
    };
    Ok(whole.panels.iter().zip(scenes).map(part).collect())
}

fn part(scene: Scene, panel: &Panel, arguments: &SheetArguments, file: PathBuf) -> Part {
    let outputs = Outputs {
        images: vec![file],
        show: panel.show,
        ..Outputs::default()
    };
    let request = Request {
        aovs: outputs.needs(&scene),
        ..arguments.changes.request(arguments.work.threads.count)
    };
    let images = match arguments.keep_panels {
        true => outputs.images.clone(),
        false => Vec::new(),
    };
    Part {
        scene,
        label: panel.label.clone(),
        new_row: panel.new_row,
        outputs: Outputs { images, ..outputs },
        request,
    }
}

impl Part {
    fn render(&self, quiet: bool, cubes: &mut LoadedCubes) -> Result<contact_sheet::Panel> {
        let plan = Plan::new(&self.scene, &self.request)?;
        let ready = Ready::new(&self.scene, &plan, quiet, cubes)?;
        let mut rendered = film::film(&plan, ready, &Method::Trace, (quiet, None))?;
        let prepared = &mut rendered.prepared;
        // The file is never written: `times` only checks that it is a picture.
        let shown = Outputs {
            images: vec![PathBuf::from("panel.png")],
            ..self.outputs.clone()
        };
        let times = film::times(&shown, &self.scene, prepared, quiet)?;
        let outputs = &self.outputs;
        outputs.write(&self.scene, &rendered.film, times.as_ref(), quiet)?;
        rendered.remark(&self.scene, plan.rays.camera, quiet)?;
        let film = times.as_ref().unwrap_or(&rendered.film);
        let Picture { image, .. } = picture(&self.scene, film, self.outputs.show, None)?;
        Ok(contact_sheet::Panel {
            picture: image,
            label: self.label.clone(),
            new_row: self.new_row,
        })
    }
}

fn make_directory(arguments: &SheetArguments) -> Result<()> {
    match &arguments.directory {
        Some(directory) => fs::create_dir_all(directory)
            .map_err(Error::io(directory, "cannot create the directory")),
        None => Ok(()),
    }
}

/// Refuses outputs that cannot be written before anything is rendered.
fn check(figures: &[Figure]) -> Result<()> {
    // Across all figures: the page of one must not overwrite an input that another has still to read.
    let mut read = Vec::new();
    for figure in figures {
        read.extend(figure.inputs()?);
    }
    let pages = figures.iter().map(|figure| Outputs {
        images: vec![figure.output.clone()],
        ..Outputs::default()
    });
    let panels = || figures.iter().flat_map(|figure| &figure.parts);
    check_all(
        pages.chain(panels().map(|part| part.outputs.clone())),
        &read,
    )?;
    let plans = panels().map(|part| Plan::new(&part.scene, &part.request));
    let plans = plans.collect::<Result<Vec<_>>>()?;
    let scenes = panels().map(|part| &part.scene);
    check_files(scenes.zip(&plans), &Bar::new(0, true))
}
