//! A flash of light on a model without a scene: its light is baked, and a film reads it.
//!
//! The baked light depends neither on the camera nor on the display, so films at all speeds share it.

use std::path::{Path, PathBuf};

use nullray::render::bake::{self, Bins, Coordinates, CubePrecision};
use nullray::scene::{Flash, FlashLight, ModelScene, ModelView, Overrides, SceneFile};
use nullray::{Error, Result};
use toml_edit::Value;

use super::args::{BakeArguments, Changes, RenderArguments, WorkArguments};
use super::bake::goal::Goal;
use super::bake::{Bake, check_effects, surfaces};
use super::console::warn;
use super::failure::refused;
use super::names::{named_after, stem};
use super::{builtin, exposure, reel};

/// Samples per texel: on the models of scenes/ the standard error of a bin is a few percent of the root mean square of all bins.
const SAMPLES: u32 = 512;
/// Texels along a side of a model if the size is not given: if an atlas does not have enough room, the next size that fits in memory is
/// tried.
const SIDES: [u32; 7] = [64, 96, 128, 192, 256, 384, 512];
const SIDE: u32 = 192;
/// The memory limit of a bake whose size is chosen automatically, bytes.
const MOST_MEMORY: u64 = 1 << 30;
/// The number of pictures that are previewed for the exposure.
const MEASURED: u64 = 8;

/// `nullray bake MODEL --flash`.
pub fn bake(arguments: &BakeArguments) -> Result<()> {
    check_effects(arguments)?;
    let (path, changes) = (arguments.scene.path(), &arguments.scene.changes);
    let file = match &arguments.output {
        Some(file) => file.clone(),
        None => named_after(path, ENDING),
    };
    if file.extension().is_none_or(|ending| ending != "npz") {
        let what =
            "the light of a flash is written with texture coordinates, which a .npz file holds";
        return Err(refused(
            format!("-o {}", file.display()),
            what,
            "end it in .npz",
        ));
    }
    let view = ModelView {
        flash: arguments.flash.flash(|| file.clone()),
        ..ModelView::default()
    };
    let memory = changes.memory.bytes();
    let made = builtin::model_as(path, &view, &changes.overrides(), memory)?;
    let Some((path, Some(light))) = made.as_ref().map(|(path, made)| (*path, made.flash())) else {
        return Ok(());
    };
    Work {
        path,
        changes,
        samples: changes.spp,
        texels: arguments.texels,
        work: &arguments.work,
        goal: Goal::of(arguments.goal),
        plan: arguments.plan,
    }
    .bake(light, &file)
}

/// The end of the name of baked light.
const ENDING: &str = "-light.npz";

/// The parameters of a flash's bake.
struct Work<'a> {
    path: &'a Path,
    changes: &'a Changes,
    /// Per texel.
    samples: Option<u32>,
    texels: Option<[u32; 2]>,
    work: &'a WorkArguments,
    goal: Option<Goal>,
    /// Whether to print what the bake would take, and bake nothing.
    plan: bool,
}

impl Work<'_> {
    /// Bakes `light` into `file`, or into one file for each object beside it, unless it already exists.
    fn bake(&self, light: &FlashLight, file: &Path) -> Result<()> {
        let overrides = Overrides {
            set: of_light(self.changes).cloned().collect(),
            samples_per_pixel: Some(self.samples.unwrap_or(SAMPLES)),
            allow_outside: self.changes.files.allow_outside,
            ..Overrides::default()
        };
        let scene = builtin::of_model(self.path, &light.scene).scene(&overrides)?;
        bake::check(&scene)?;
        if light.leaves_out_emission {
            let what = "the steady light that the model's materials emit is left out of its flash: pictures without --flash show it";
            warn(self.work.quiet.on, &[what.into()]);
        }
        let bins = Bins {
            start: light.start,
            width: light.width,
            count: light.bins as usize,
        };
        let bake = Bake {
            scene: &scene,
            path: Some(self.path),
            bins,
            precision: CubePrecision::Single,
            coordinates: Some(Coordinates::Atlas),
            request: self.changes.request(self.work.threads.count),
            work: self.work,
            goal: self.goal,
            of_flash: true,
        };
        let sizes = match self.texels {
            Some(size) => vec![size],
            None => sizes(&bins),
        };
        let mut refusal = Ok(());
        for size in sizes {
            let jobs = surfaces(&scene, &[], file, size);
            refusal = jobs.and_then(|jobs| match self.plan {
                true => bake.print_plan(jobs),
                false => bake.run(jobs),
            });
            // A larger texture may have enough room.
            if !matches!(refusal, Err(Error::Invalid { .. })) {
                break;
            }
        }
        refusal
    }
}

/// Texture sizes to try, the smallest first.
fn sizes(bins: &Bins) -> Vec<[u32; 2]> {
    let fits = |side: &u32| {
        // For both sides of a surface, on one thread: the size must not depend on the number of threads.
        let bytes = bake::surface_bytes([*side, 2 * side], bins, CubePrecision::Single, 1);
        bytes <= MOST_MEMORY
    };
    let fitting: Vec<u32> = SIDES.into_iter().filter(fits).collect();
    let first = fitting.iter().rposition(|side| *side <= SIDE).unwrap_or(0);
    let tried = fitting.get(first..).unwrap_or_default();
    match tried {
        [] => vec![[SIDES[0]; 2]],
        tried => tried.iter().map(|side| [*side; 2]).collect(),
    }
}

/// The changes that light depends on.
fn of_light(changes: &Changes) -> impl Iterator<Item = &(String, String)> {
    let of_picture = |key: &str| ["camera", "display", "sheet"].contains(&key);
    let set = changes.edits.set.iter();
    set.filter(move |(key, _)| !of_picture(key.split('.').next().unwrap_or_default()))
}

/// The file beside a film for its baked light.
pub fn light_file(outputs: &[PathBuf], model: Option<&Path>) -> PathBuf {
    let mut name = stem(model).into_os_string();
    name.push(ENDING);
    let beside = outputs.iter().find(|path| !reel::is_pipe(path));
    beside.map_or_else(|| PathBuf::from(&name), |path| path.with_file_name(&name))
}

/// A film of a flash.
pub struct FlashFilm<'a> {
    path: &'a Path,
    light: FlashLight,
    /// The file for its baked light.
    file: PathBuf,
    /// The film's scene with direct light, which is ray traced; everything that can be refused before anything is baked is refused with it.
    pub direct: SceneFile,
}

impl<'a> FlashFilm<'a> {
    /// The film of a model's flash, and its scene, which reads the baked light.
    pub fn of(
        path: &'a Path,
        made: &ModelScene,
        flash: &Flash,
        arguments: &RenderArguments,
    ) -> Result<(SceneFile, FlashFilm<'a>)> {
        let light = made.flash().cloned().unwrap_or_default();
        let direct = builtin::of_model(path, light.direct());
        let text = match white(&direct, arguments)? {
            Some(white) => made.exposed(white),
            None => made.text(),
        };
        let text = with_commands(&text, path, flash, arguments);
        let film = FlashFilm {
            path,
            light,
            file: flash.file.clone(),
            direct,
        };
        Ok((builtin::of_model(path, &text), film))
    }

    /// Bakes its light, unless the file already exists.
    pub fn bake(&self, arguments: &RenderArguments) -> Result<()> {
        Work {
            path: self.path,
            changes: &arguments.changes,
            samples: None,
            texels: arguments.texels,
            work: &arguments.work,
            goal: None,
            plan: false,
        }
        .bake(&self.light, &self.file)
    }
}

/// The white radiance of a film, from direct light in some of its pictures; `None` if the command line sets it.
fn white(direct: &SceneFile, arguments: &RenderArguments) -> Result<Option<f64>> {
    let changes = &arguments.changes;
    let mut overrides = changes.overrides();
    if changes.says_exposure() {
        return Ok(None);
    }
    let first = direct.scene(&overrides)?;
    let (start, interval) = (first.camera.time, first.camera.frame_interval);
    let Some(interval) = interval else {
        return Ok(None);
    };
    let mut scenes = Vec::new();
    for k in 0..MEASURED {
        // In the middle of each of the film's equal parts.
        let part = (k as f64 + 0.5) / MEASURED as f64;
        let time = start + part * interval * (ModelView::FLYBY_FRAMES - 1) as f64;
        overrides.time = Some(format!("{time} m"));
        scenes.push(direct.scene(&overrides)?);
    }
    let measured = exposure::of_surfaces(&scenes, &changes.request(None), None)?;
    measured.of_model(arguments.work.quiet.on)
}

/// The text of a film's scene, with the commands that make its light and the film.
fn with_commands(text: &str, path: &Path, flash: &Flash, arguments: &RenderArguments) -> String {
    let quoted = |path: &Path| format!("{:?}", path.display().to_string());
    let mut bake = format!("nullray bake {} --flash", quoted(path));
    bake += &format!(" --bounces {} -o {}", flash.bounces, quoted(&flash.file));
    if let Some([w, h]) = arguments.texels {
        bake += &format!(" --texels {w}x{h}");
    }
    if arguments.changes.files.allow_outside {
        bake += " --allow-outside";
    }
    for (key, value) in of_light(&arguments.changes) {
        bake += &format!(" --set {:?}", format!("{key}={value}"));
    }
    let frames = ModelView::FLYBY_FRAMES;
    let film = quoted(&named_after(Some(path), ".apng"));
    let head = text.lines().next().unwrap_or_default();
    let rest = text.strip_prefix(head).unwrap_or_default();
    let missing = Value::from(format!("bake its light first: {bake}"));
    format!(
        "{head} Its light is baked, and then looked up:\n#\n#   {bake}\n#   nullray render SCENE.toml --frames 0..{frames} -o {film}\n\nif_missing = {}{rest}",
        missing.to_string().trim()
    )
}
