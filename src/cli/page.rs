//! `nullray page`: an HTML page that shows a scene at many speeds.

use std::path::Path;

use nullray::figures::diagram;
use nullray::figures::drawing::{png, svg};
use nullray::figures::page::{self, Page};
use nullray::figures::pixel_probe;
use nullray::io::image::write_atomically;
use nullray::render::plan::Plan;
use nullray::scene::model::Scene;
use nullray::scene::{Overrides, SceneFile};
use nullray::{Error, Result};

use super::args::PageArguments;
use super::check::{Names, refuse_dangling};
use super::console::say;
use super::failure::refused;
use super::film::in_pool;
use super::frames::{self, Frames, Job, SharedExposure, Shot};
use super::names::{numbered, stem};
use super::output::Outputs;
use super::progress::Bar;
use super::reel::{self, Folder};
use super::{builtin, inputs, interrupt, motion};

/// Pixels per point in the diagrams of pixels.
const PROBE_SCALE: f64 = 1.6;

pub fn run(arguments: &PageArguments) -> Result<()> {
    let overrides = arguments.changes.overrides();
    let file = builtin::open(
        arguments.scene.path(),
        &overrides,
        arguments.changes.memory.bytes(),
    )?;
    let scene = file.scene(&overrides)?;
    let directory = &arguments.output;
    let option = format!("-o {}", directory.display());
    if reel::is_pipe(directory) {
        let what = "a page is a directory, which cannot go to standard output";
        return Err(refused(option, what, "give the name of a directory"));
    }
    refuse_dangling(&option, directory)?;
    let is_new = !directory.exists();
    std::fs::create_dir_all(directory)
        .map_err(Error::io(directory, "cannot create the directory"))?;
    let path = directory.join("index.html");
    let made = check(arguments, &scene, &option, &path).and_then(|()| {
        in_pool(arguments.work.threads.count, || {
            make(arguments, &file, &scene, &path)
        })
    });
    if made.is_err() && is_new {
        // It is not empty if it holds pictures to resume from; then it stays.
        let _ = std::fs::remove_dir(directory);
    }
    made
}

/// Refuses to overwrite an input of the page, and diagrams of pixels that a camera does not have.
fn check(arguments: &PageArguments, scene: &Scene, option: &str, path: &Path) -> Result<()> {
    if arguments.grid.is_some() {
        pixel_probe::check(scene)?;
    }
    let plan = Plan::new(
        scene,
        &arguments.changes.request(arguments.work.threads.count),
    )?;
    let read = inputs::of(scene, &plan);
    let overwritten = "the page is made from this file, which would be overwritten";
    Names::new(&read, overwritten, " page").check(option, path)
}

fn make(arguments: &PageArguments, file: &SceneFile, scene: &Scene, path: &Path) -> Result<()> {
    let quiet = arguments.work.quiet.on;
    let steps = arguments.steps;
    // One picture for every combination of speed and time on the sliders.
    let still = motion::speeds("--beta", arguments.direction, scene, arguments.beta, steps)?;
    let times = times(arguments, scene)?;
    let moment = |time: &f64| {
        let later = time - scene.camera.time;
        still.iter().map(move |shot| shot.later(later))
    };
    let shots: Vec<Shot> = times.iter().flat_map(moment).collect();
    let frames = Frames::of_shots(shots.clone());
    // Before pictures are rendered: a diagram that cannot be drawn is refused early.
    let diagrams = diagrams(arguments, file, &still, &times)?;
    let probes = probes(arguments, scene, &shots)?;
    let folder = Folder::of(&[path.to_path_buf()])?;
    let pattern = folder.pattern("page");
    let outputs = Outputs {
        images: vec![pattern.clone()],
        ..Outputs::default()
    };
    let job = Job {
        changes: &arguments.changes,
        shared_exposure: SharedExposure::at_speeds(arguments.exposure.is_same(), &frames),
        quiet,
        file,
        scene,
        frames: &frames,
        request: &arguments.changes.request(arguments.work.threads.count),
        outputs: &outputs,
        can_resume: true,
    };
    let fingerprints = frames::run(&job, None, &mut |_, _| Ok(()))?;
    let files = frames.numbers.clone().map(|k| numbered(&pattern, k));
    // Base 64 uses four characters for three bytes. Files that are too large are not read.
    let bytes = files
        .clone()
        .map(|path| std::fs::metadata(path).map_or(0, |file| file.len()));
    check_size(bytes.sum::<u64>() as f64 / 0.75e6, arguments)?;
    let pictures = files
        .zip(&fingerprints)
        .map(|(path, fingerprint)| reel::read_bytes(&path, fingerprint));
    let title = arguments.title.clone();
    let page = Page {
        title: title.unwrap_or_else(|| stem(arguments.scene.path()).display().to_string()),
        text: arguments.text.clone().unwrap_or_default(),
        betas: still
            .iter()
            .map(|shot| shot.velocity.beta().length())
            .collect(),
        diagrams,
        times,
        size: scene.camera.size,
        pictures: pictures.collect::<Result<_>>()?,
        grid: arguments.grid.unwrap_or_default(),
        probes,
    };
    let html = page::html(&page)?;
    let megabytes = html.len() as f64 / 1e6;
    check_size(megabytes, arguments)?;
    interrupt::check()?;
    write_atomically(path, |out| {
        std::io::Write::write_all(out, html.as_bytes()).map_err(Error::io(path, "cannot write"))
    })?;
    folder.remove();
    let count = page.pictures.len();
    say(
        quiet,
        &format!(
            "wrote {} ({megabytes:.1} MB, {count} pictures)\n",
            path.display()
        ),
    )
}

fn check_size(megabytes: f64, arguments: &PageArguments) -> Result<()> {
    if megabytes <= arguments.max_size {
        return Ok(());
    }
    let what = format!(
        "the page would have {megabytes:.3} MB, more than {}",
        arguments.max_size
    );
    let help = "use fewer --steps, a smaller --size or --grid, or more --spp (less noise), or give a larger --max-size";
    Err(refused("--max-size", what, help))
}

/// The camera times of the pictures: the scene's own, or several.
fn times(arguments: &PageArguments, scene: &Scene) -> Result<Vec<f64>> {
    let metres = |time: nullray::spacetime::units::Time| time.metres(scene.speed_of_light);
    let (Some(from), Some(to)) = (arguments.from, arguments.to) else {
        return Ok(vec![scene.camera.time]);
    };
    let frames = Frames::evenly([metres(from), metres(to)], arguments.times)?;
    Ok(frames
        .numbers
        .clone()
        .filter_map(|k| frames.time(k))
        .collect())
}

/// The scene's diagram at each time, in the frame of each speed.
fn diagrams(
    arguments: &PageArguments,
    file: &SceneFile,
    shots: &[Shot],
    times: &[f64],
) -> Result<Vec<String>> {
    let Some(last) = shots.last().filter(|_| !arguments.no_diagram) else {
        return Ok(Vec::new());
    };
    let mut all = Vec::with_capacity(times.len() * shots.len());
    for time in times {
        let overrides = Overrides {
            time: Some(format!("{time:?} m")),
            ..arguments.changes.overrides()
        };
        let series = motion::boosts(
            file,
            &overrides,
            last.velocity.beta(),
            shots.len() as u32,
            None,
        )?;
        for drawing in series {
            interrupt::check()?;
            all.push(svg::write(&drawing?)?);
        }
    }
    Ok(all)
}

/// The diagrams of the pixels in the middle of the cells of the grid, for each picture.
fn probes(arguments: &PageArguments, scene: &Scene, shots: &[Shot]) -> Result<Vec<Vec<u8>>> {
    let Some([columns, rows]) = arguments.grid else {
        return Ok(Vec::new());
    };
    let base = builtin::base(arguments.scene.path());
    let base = diagram::parse(&scene.text, &scene.name, base, &Overrides::default())?;
    let limit = arguments.changes.memory.bytes();
    let [width, height] = scene.camera.size;
    let middle =
        |k: u32, count: u32, length: u32| ((2 * k + 1) * length / (2 * count)).min(length - 1);
    let mut probes = Vec::new();
    for shot in shots {
        let scene = shot.seen(scene);
        for row in 0..rows {
            for column in 0..columns {
                interrupt::check()?;
                let pixel = [middle(column, columns, width), middle(row, rows, height)];
                let probe = pixel_probe::trace(&scene, pixel, limit, &Bar::new(0, true))?;
                let model = pixel_probe::diagram(&probe, base.clone(), None, None);
                let model = model.ok_or_else(|| {
                    Error::invalid(
                        &scene.name,
                        "camera",
                        "a pixel has no diagram",
                        "leave out --grid",
                    )
                })?;
                let drawing = diagram::draw(&diagram::layout(&model), &model.style)?;
                probes.push(png::write(&png::render(&drawing, PROBE_SCALE)?)?);
            }
        }
    }
    Ok(probes)
}
