//! `nullray render`.

use std::path::{Path, PathBuf};

use nullray::approximate::raster::Method;
use nullray::render::metadata;
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::{LoadedCubes, check_files};
use nullray::scene::model::Scene;
use nullray::scene::{ModelScene, ModelView, Overrides, SceneFile};
use nullray::{Error, Result};

use super::args::{FrameArguments, RenderArguments};
use super::check::{check_all, check_statistics};
use super::console::{print, say, warn};
use super::failure::refused;
use super::film::{Ready, check_one, finish, in_pool, one};
use super::flash::{self, FlashFilm};
use super::frames::{self, Frames, Job, SharedExposure};
use super::names::{named_after, numbered, suffixed};
use super::output::{Kind, Outputs, extension};
use super::progress::Bar;
use super::reel::{self, Folder, Reel};
use super::stats::Account;
use super::{builtin, caption, exposure, inputs, panels, passes};

/// The default film rate, pictures per second.
pub const PLAY_FPS: f64 = 24.0;

pub fn run(mut arguments: RenderArguments) -> Result<()> {
    // Films are made from the pictures of a sequence; all other outputs are written picture by picture.
    let (films, images) = arguments
        .output
        .into_iter()
        .partition(|path| reel::is_film(path));
    arguments.output = images;
    let arguments = &arguments;
    if !arguments.print_scene {
        reel::keep_pipe(&films);
    }
    let overrides = arguments.changes.overrides();
    let (file, model) = file(arguments, &overrides, &films)?;
    if let Some(Model::Flashed(flash)) = &model {
        if arguments.print_scene {
            return print(&file.changed_text(&overrides)?);
        }
        // Everything that can be refused before its light is baked.
        let scene = flash.direct.scene(&overrides)?;
        check_sequence(arguments, &films, &scene)?;
        in_pool(arguments.work.threads.count, || flash.bake(arguments))?;
    }
    let scene = file.scene(&overrides)?;
    // Everything that can be refused is refused before anything heavy is loaded.
    if arguments.changes.pixel_centers && scene.camera.shutter.is_some() {
        return Err(refused(
            "--pixel-centers",
            "takes one ray per pixel at one instant, but the shutter of this scene's camera is open for some time",
            "leave out --pixel-centers, or remove the shutter",
        ));
    }
    let checked = match arguments.print_scene {
        true => None,
        false => Some(check_sequence(arguments, &films, &scene)?),
    };
    let alone = match &checked {
        Some((outputs, None, _)) => Some(outputs),
        _ => None,
    };
    let (file, scene, ready) = match model {
        Some(Model::Alone(path, made)) => in_pool(arguments.work.threads.count, || {
            exposed((file, scene), path, &made, arguments, alone)
        })?,
        _ => (file, scene, None),
    };
    let Some((outputs, frames, film)) = checked else {
        return print(&scene.text);
    };
    // Three ways from here: a sequence, all panels, or one picture, which passes may improve.
    let of_panels = shows_panels(arguments, &scene);
    let wanted = arguments.stats || arguments.stats_json.is_some();
    let mut account = wanted.then(Account::default);
    let improves = arguments.passes.given();
    in_pool(arguments.work.threads.count, || match frames {
        Some(_) if of_panels => Err(panels_and_frames()),
        Some(frames) => {
            warn(arguments.work.quiet.on, &frames.far_apart(&scene));
            let request = request(arguments, &outputs, &scene);
            let job = Job {
                changes: &arguments.changes,
                shared_exposure: match arguments.exposure.is_same() {
                    true => SharedExposure::OfMiddle,
                    false => SharedExposure::None,
                },
                quiet: arguments.work.quiet.on,
                file: &file,
                scene: &scene,
                frames: &frames,
                request: &request,
                outputs: &outputs,
                can_resume: true,
            };
            film.make(&job, account.as_mut())
        }
        None if of_panels => all_panels(arguments, &file, &scene, &outputs, account.as_mut()),
        None if improves.is_some() => {
            let request = request(arguments, &outputs, &scene);
            passes::one(
                passes::Of::Scene,
                &scene,
                request,
                &outputs,
                arguments.passes,
                arguments.work.quiet.on,
            )
        }
        None => {
            let request = request(arguments, &outputs, &scene);
            let reports = (arguments.work.quiet.on, account.as_mut());
            match ready {
                Some((plan, ready)) => finish(&scene, &plan, ready, &outputs, reports),
                None => one(
                    &scene,
                    &request,
                    &outputs,
                    reports,
                    &mut LoadedCubes::default(),
                ),
            }
        }
    })?;
    account.map_or(Ok(()), |account| settle(arguments, &account))
}

/// The outputs, the frames of a sequence, and its films; refuses options that do not fit them.
fn check_sequence<'a>(
    arguments: &RenderArguments,
    films: &'a [PathBuf],
    scene: &Scene,
) -> Result<(Outputs, Option<Frames>, Film<'a>)> {
    let mut outputs = outputs(arguments, scene);
    // A film alone leaves no numbered pictures behind.
    if !films.is_empty() && arguments.output.is_empty() {
        outputs.images.clear();
    }
    let is_film = arguments.model.flyby || arguments.flash.flash;
    let frames = match Frames::of(&arguments.frames, scene)? {
        None if is_film => Frames::of(&FrameArguments::all_of_model(), scene)?,
        frames => frames,
    };
    let film = Film {
        films,
        fps: arguments.play_fps.unwrap_or(PLAY_FPS),
    };
    film.check(frames.is_some())?;
    check_caption(arguments, &outputs, films)?;
    check_effects(arguments, &outputs, films)?;
    if let Some(option) = arguments.passes.given() {
        check_passes(option, arguments, frames.is_some())?;
    }
    if arguments.exposure.says_same() && frames.is_none() && !shows_panels(arguments, scene) {
        let what = "the option has no effect on a single picture";
        return Err(refused("--same-exposure", what, "leave it out"));
    }
    if let Some(path) = &arguments.stats_json {
        let plan = Plan::new(scene, &request(arguments, &outputs, scene))?;
        check_statistics(path, &inputs::of(scene, &plan))?;
    }
    let counts = arguments.stats || arguments.stats_json.is_some();
    if counts && arguments.method.method != Method::Trace {
        return Err(refused(
            "--stats",
            "counts what the ray tracer does",
            "leave out --method, or --stats",
        ));
    }
    Ok((outputs, frames, film))
}

/// Whether all panels of the scene are rendered, or some.
fn shows_panels(arguments: &RenderArguments, scene: &Scene) -> bool {
    !scene.panels.is_empty() || !arguments.panel.is_empty()
}

/// The films of a sequence.
struct Film<'a> {
    films: &'a [PathBuf],
    fps: f64,
}

impl Film<'_> {
    /// Refuses films of a single picture.
    fn check(&self, is_sequence: bool) -> Result<()> {
        match self.films.first() {
            Some(film) if !is_sequence => {
                let option = format!("-o {}", film.display());
                let what = "a film is made of the frames of a sequence";
                let help = "say which, like --from \"0 m\" --to \"5 m\" --interval \"5 cm\", or let `nullray film` choose a motion";
                Err(refused(option, what, help))
            }
            _ => Ok(()),
        }
    }

    /// Renders the sequence, and puts the films together from its pictures.
    fn make(&self, job: &Job, account: Option<&mut Account>) -> Result<()> {
        if self.films.is_empty() {
            return frames::run(job, account, &mut |_, _| Ok(())).map(drop);
        }
        let plan = Plan::new(job.scene, job.request)?;
        reel::check(self.films, &inputs::of(job.scene, &plan))?;
        reel::tell_bits(self.films, job.scene, job.quiet)?;
        let kept = job
            .outputs
            .images
            .iter()
            .find(|path| extension(path) == "png");
        let (pattern, folder) = match kept {
            Some(path) => (path.clone(), None),
            None => {
                let folder = Folder::of(self.films)?;
                (folder.pattern("film"), Some(folder))
            }
        };
        let mut outputs = job.outputs.clone();
        if kept.is_none() {
            outputs.images.push(pattern.clone());
        }
        let numbers = job.frames.numbers.clone();
        let name = |k: u64| numbered(&pattern, numbers.start + k);
        let reel = Reel {
            films: self.films,
            count: numbers.end - numbers.start,
            fps: self.fps,
            metadata: &metadata::of_text(&job.scene.name, &job.scene.text),
            quiet: job.quiet,
        };
        let picture = |k: u64, fingerprint: &str| reel::read(&name(k), fingerprint);
        // Work whose only reader has gone ends.
        let is_alone = self.films.len() == 1 && job.outputs.paths().next().is_none();
        let mut stream = reel.stream(is_alone);
        let made = frames::run(
            &Job {
                outputs: &outputs,
                can_resume: folder.as_ref().is_none_or(Folder::stays),
                ..*job
            },
            account,
            &mut |k, fingerprint| stream.send(|| picture(k, fingerprint)),
        );
        let Some(fingerprints) = reel::unless_closed(made)? else {
            return Ok(());
        };
        reel.write(|k| picture(k, &fingerprints[k as usize]))?;
        if let Some(folder) = folder {
            folder.remove();
        }
        Ok(())
    }
}

/// Refuses options that apply to none of the outputs.
fn check_effects(arguments: &RenderArguments, outputs: &Outputs, films: &[PathBuf]) -> Result<()> {
    if arguments.half && !outputs.files().any(|(_, kind)| kind == Kind::Exr) {
        let what = "it is the precision of .exr files, but none of these files is one";
        let help = "add an output, -o FILE.exr, or leave out --half";
        return Err(refused("--half", what, help));
    }
    if arguments.play_fps.is_some() && films.is_empty() {
        let what = "it is the speed of a film, but none of these files is one";
        let help = "add an output, -o FILE.apng or -o FILE.y4m, or leave out --play-fps";
        return Err(refused("--play-fps", what, help));
    }
    let option = match &arguments.changes {
        changes if changes.white.is_some() => "--white",
        changes if changes.exposure.is_some() => "--exposure",
        _ => return Ok(()),
    };
    if frames::is_shown(outputs) || !films.is_empty() {
        return Ok(());
    }
    let what = "it sets the white of display pictures, but none of these files is one";
    let help = format!("add an output, -o FILE.png, or leave out {option}");
    Err(refused(option, what, &help))
}

/// Refuses a caption without a picture for it, and characters that the font lacks.
fn check_caption(arguments: &RenderArguments, outputs: &Outputs, films: &[PathBuf]) -> Result<()> {
    let shown = outputs.files().any(|(_, kind)| kind == Kind::Display);
    if arguments.caption.is_some() && !shown && films.is_empty() {
        let what = "it is written below pictures, but none of these files is one";
        return Err(refused(
            "--caption",
            what,
            "add a picture or a film: -o FILE.png or -o FILE.apng",
        ));
    }
    caption::check(arguments.caption.as_deref())
}

/// A model without a scene of its own.
enum Model<'a> {
    /// In the light of its own lamps or of a sun, and of a sky.
    Alone(&'a Path, ModelScene),
    Flashed(Box<FlashFilm<'a>>),
}

/// The named scene file, or the scene for a model.
fn file<'a>(
    arguments: &'a RenderArguments,
    overrides: &Overrides,
    films: &[PathBuf],
) -> Result<(SceneFile, Option<Model<'a>>)> {
    let path = arguments.scene.path();
    let memory = arguments.changes.memory.bytes();
    let outputs: Vec<PathBuf> = films.iter().chain(&arguments.output).cloned().collect();
    let flash = arguments.flash.flash(|| flash::light_file(&outputs, path));
    let view = arguments.model.view(flash);
    let Some((path, made)) = builtin::model_as(path, &view, overrides, memory)? else {
        return Ok((builtin::open(path, overrides, memory)?, None));
    };
    if let Some(flash) = &view.flash {
        let (file, film) = FlashFilm::of(path, &made, flash, arguments)?;
        return Ok((file, Some(Model::Flashed(Box::new(film)))));
    }
    let file = builtin::of_model(path, &made.text());
    Ok((file, Some(Model::Alone(path, made))))
}

/// The number of pictures of a fly-by that are previewed for its exposure.
const MEASURED: u64 = 6;

/// A scene, and what is loaded for its picture, if it is.
type Exposed = (SceneFile, Scene, Option<(Plan, Ready)>);

/// The same scene, exposed for the model rather than for the sky, which may be far brighter ahead; for a fly-by, from some of its pictures.
/// If one picture is made, of `outputs`, what is loaded for its previews is that of the picture itself.
fn exposed(
    (file, scene): (SceneFile, Scene),
    path: &Path,
    made: &ModelScene,
    arguments: &RenderArguments,
    outputs: Option<&Outputs>,
) -> Result<Exposed> {
    let changes = &arguments.changes;
    if changes.says_exposure() {
        return Ok((file, scene, None));
    }
    let mut overrides = changes.overrides();
    // Passes plan for more rays, and rasterizers for more memory.
    let is_plain = arguments.method.method == Method::Trace && arguments.passes.given().is_none();
    let mut ready = None;
    if let (true, Some(outputs)) = (is_plain, outputs) {
        let plan = check_one(&scene, &request(arguments, outputs, &scene), outputs)?;
        let quiet = arguments.work.quiet.on;
        let loaded = Ready::new(&scene, &plan, quiet, &mut LoadedCubes::default())?;
        ready = Some((plan, loaded));
    }
    let mut scenes = vec![scene];
    if let (true, Some(interval)) = (arguments.model.flyby, scenes[0].camera.frame_interval) {
        let last = interval * (ModelView::FLYBY_FRAMES - 1) as f64;
        for k in 1..MEASURED {
            let time = last * k as f64 / (MEASURED - 1) as f64;
            overrides.time = Some(format!("{time} m"));
            scenes.push(file.scene(&overrides)?);
        }
    }
    let prepared = ready.as_mut().map(|(_, ready)| &mut ready.prepared);
    let measured = exposure::of_surfaces(&scenes, &changes.request(None), prepared)?;
    let white = measured.of_model(arguments.work.quiet.on)?;
    let file = white.map_or(file, |white| builtin::of_model(path, &made.exposed(white)));
    let scene = file.scene(&changes.overrides())?;
    if let Some((plan, ready)) = &mut ready {
        ready.prepared.retake_on_film(&scene, plan)?;
    }
    Ok((file, scene, ready))
}

/// Refuses passes for anything but a picture of the ray tracer.
fn check_passes(option: &str, arguments: &RenderArguments, is_sequence: bool) -> Result<()> {
    let refuse = |what: &str, help: &str| Err(refused(option, what, help));
    match () {
        () if is_sequence => refuse(
            "it improves one picture, but this is a sequence",
            "render each picture with a --time of its own, in a loop of commands, or give the samples of all frames: --spp N",
        ),
        () if arguments.method.method != Method::Trace => refuse(
            "it improves pictures of the ray tracer",
            "leave out --method",
        ),
        () if arguments.changes.pixel_centers => refuse(
            "each pixel has one ray, through its centre",
            "leave out --pixel-centers",
        ),
        () if arguments.stats || arguments.stats_json.is_some() => refuse(
            "it keeps no statistics",
            "leave out --stats, or give --spp N",
        ),
        () => Ok(()),
    }
}

/// Prints and writes the statistics, if requested.
fn settle(arguments: &RenderArguments, account: &Account) -> Result<()> {
    if arguments.stats {
        print(&account.table())?;
    }
    let Some(path) = &arguments.stats_json else {
        return Ok(());
    };
    account.write(path)?;
    say(
        arguments.work.quiet.on,
        &format!("wrote {}\n", path.display()),
    )
}

fn request(arguments: &RenderArguments, outputs: &Outputs, scene: &Scene) -> Request {
    Request {
        aovs: outputs.needs(scene),
        beside: outputs.beside(scene.camera.size),
        ..arguments.changes.request(arguments.work.threads.count)
    }
}

fn panels_and_frames() -> Error {
    refused(
        "--frames, --from",
        "a sequence shows one scene, but this one has panels",
        "render the panels without frames; for a sequence of one of them, take the panels out of the scene and give its changes with --set",
    )
}

/// Renders the requested panels.
fn all_panels(
    arguments: &RenderArguments,
    file: &SceneFile,
    whole: &Scene,
    outputs: &Outputs,
    mut account: Option<&mut Account>,
) -> Result<()> {
    let chosen = panels::chosen(whole, &arguments.panel)?;
    let (changes, threads) = (&arguments.changes, arguments.work.threads.count);
    // Panels mostly show the same cubes.
    let mut cubes = LoadedCubes::default();
    let exposure = &arguments.exposure;
    let is_shown = frames::is_shown(outputs);
    let scenes = exposure.panels(file, whole, changes, threads, &mut cubes, is_shown)?;
    // A single panel with a named output needs no suffix to distinguish it.
    let exact = arguments.panel.len() == 1 && !arguments.output.is_empty();
    let mut jobs = Vec::new();
    for (panel, scene) in whole.panels.iter().zip(scenes) {
        if !chosen.contains(&panel) {
            continue;
        }
        let mut outputs = match exact {
            true => outputs.clone(),
            false => outputs.renamed(|path| suffixed(path, &panel.name)),
        };
        outputs.show = panel.show;
        outputs.caption = caption(arguments, &scene);
        jobs.push((request(arguments, &outputs, &scene), scene, outputs));
    }
    let mut read = Vec::new();
    for (request, scene, _) in &jobs {
        read.extend(inputs::of(scene, &Plan::new(scene, request)?));
    }
    check_all(jobs.iter().map(|(.., outputs)| outputs.clone()), &read)?;
    // No panel is rendered before all are known to be possible.
    let plan = |(request, scene, outputs): &(Request, Scene, Outputs)| {
        Ok(match arguments.passes.given() {
            Some(_) => passes::check_one(scene, request.clone(), outputs)?.1,
            None => check_one(scene, request, outputs)?,
        })
    };
    let plans = jobs.iter().map(plan).collect::<Result<Vec<_>>>()?;
    let scenes = jobs.iter().map(|(_, scene, _)| scene);
    check_files(scenes.zip(&plans), &Bar::new(0, true))?;
    drop(plans);
    for (request, scene, outputs) in &jobs {
        let quiet = arguments.work.quiet.on;
        match arguments.passes.given() {
            Some(_) => {
                let (of, wanted) = (passes::Of::Panels, arguments.passes);
                passes::one(of, scene, request.clone(), outputs, wanted, quiet)?;
            }
            None => {
                let reports = (quiet, account.as_deref_mut());
                one(scene, request, outputs, reports, &mut cubes)?;
            }
        }
    }
    Ok(())
}

fn outputs(arguments: &RenderArguments, scene: &Scene) -> Outputs {
    let step = arguments.isochrone_step;
    Outputs {
        images: images(arguments),
        isochrones: arguments.isochrones.clone(),
        luminance: arguments.luminance.clone(),
        overlays: arguments.overlay.clone(),
        parts: arguments.lines.parts(),
        step: step.map(|time| time.metres(scene.speed_of_light)),
        aovs: arguments.channels.list(),
        half: arguments.half,
        caption: caption(arguments, scene),
        method: arguments.method.method,
        ..Outputs::default()
    }
}

/// The caption of pictures of `scene`, which may be a panel with its own caption.
fn caption(arguments: &RenderArguments, scene: &Scene) -> Option<String> {
    arguments.caption.clone().or_else(|| scene.caption.clone())
}

/// The `-o` outputs, or the scene's name with .png.
fn images(arguments: &RenderArguments) -> Vec<PathBuf> {
    match arguments.output.as_slice() {
        [] => vec![named_after(arguments.scene.path(), ".png")],
        said => said.to_vec(),
    }
}
