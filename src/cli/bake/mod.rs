//! `nullray bake`.

mod earlier;
mod existing;
pub mod goal;
mod report;

use std::path::{Path, PathBuf};
use std::time::Instant;

use nullray::error::{Message, Setting, number};
use nullray::io::image::npz::{self, CubeOptions};
use nullray::io::npy;
use nullray::io::sealed::hexadecimal;
use nullray::render::aov::Aov;
use nullray::render::bake::{
    self, Baked, Bins, Coordinates, CubePrecision, Surface, SurfaceNeeds, Trials,
};
use nullray::render::journal::Journal;
use nullray::render::metadata;
use nullray::render::plan::{Lit, Plan, Request, lit_by};
use nullray::render::prepare::Prepared;
use nullray::render::progress::{Progress, Silent};
use nullray::scene::model::Scene;
use nullray::{Error, Result};

use self::earlier::Earlier;
use self::goal::{Chosen, Goal};
use self::report::{WAYS, planned, report, source};
use super::args::{BakeArguments, WorkArguments};
use super::builtin::is_model;
use super::check::Names;
use super::console::{print, say, warn};
use super::failure::refused;
use super::film::in_pool;
use super::names::{in_file_name, named_after, suffixed};
use super::output::extension;
use super::progress::Bar;
use super::{inputs, interrupt, remarks};

/// The content of one baked file.
pub struct Job {
    path: PathBuf,
    /// An object's surface; `None` for what the camera sees.
    surface: Option<Surface>,
    /// Whether light may reach its back, and the bytes of lists beside the cube, as far as they are known yet.
    has_backs: bool,
    lists: u64,
    /// The number of its sets of texture coordinates, as far as it is known yet.
    sets: usize,
}

pub fn run(arguments: &BakeArguments) -> Result<()> {
    check_effects(arguments)?;
    let scene = arguments.scene.load()?;
    // A wrong name is reported before any problem of objects, which may be different ones.
    let named = named(arguments, &scene)?;
    bake::check(&scene).map_err(|error| match error {
        // Its light is not written by the user, who could give it an end.
        Error::Invalid(mut problem) if arguments.scene.path().is_some_and(is_model) => {
            problem.help = FLASH.into();
            Error::Invalid(problem)
        }
        error => error,
    })?;
    let threads = arguments.work.threads.count;
    let bake = Bake {
        scene: &scene,
        path: arguments.scene.path(),
        bins: bins(arguments, &scene)?,
        precision: match arguments.half {
            true => CubePrecision::Half,
            false => CubePrecision::Single,
        },
        coordinates: match (arguments.atlas, arguments.uv) {
            (true, _) => Some(Coordinates::Atlas),
            (false, set) => set.map(|set| Coordinates::Set(set.into())),
        },
        request: arguments.scene.changes.request(threads),
        work: &arguments.work,
        goal: Goal::of(arguments.goal),
        of_flash: false,
    };
    let jobs = jobs(arguments, &scene, named)?;
    match arguments.plan {
        true => bake.print_plan(jobs),
        false => bake.run(jobs),
    }
}

/// What to do about the steady light of a model.
const FLASH: &str = "--flash lights the model by a flash; or a scene with the model and a [[light]] that has an emission";

/// A bake of a scene.
pub struct Bake<'a> {
    pub scene: &'a Scene,
    /// The scene file.
    pub path: Option<&'a Path>,
    pub bins: Bins,
    pub precision: CubePrecision,
    /// Texture coordinates for all surfaces; `None`: the first set, or an atlas for objects to which no set gives places of their own.
    pub coordinates: Option<Coordinates>,
    pub request: Request,
    pub work: &'a WorkArguments,
    /// What the number of samples is chosen for; `None`: it is the scene's.
    pub goal: Option<Goal>,
    /// Whether it is for a film of a flash: existing files are kept, and the tables of sources are not printed.
    pub of_flash: bool,
}

impl Bake<'_> {
    /// The bytes of the largest of `jobs`, each counted alone: every thread needs a row or tile of its own beside the cube.
    fn largest(&self, jobs: &[Job]) -> u64 {
        let threads = self.work.threads.count;
        let threads = threads.map_or_else(rayon::current_num_threads, usize::from);
        let bytes = |job: &Job| {
            let (size, bins) = (job.size(self.scene), &self.bins);
            match job.surface {
                None => bake::camera_bytes(size, bins, self.precision, threads),
                Some(_) => bake::surface_bytes(size, bins, self.precision, threads)
                    .saturating_add(job.lists),
            }
        };
        jobs.iter().map(bytes).max().unwrap_or(0)
    }

    fn texels(&self, jobs: &[Job]) -> u64 {
        let sizes = jobs.iter().map(|job| job.size(self.scene));
        sizes.map(|[w, h]| u64::from(w) * u64::from(h)).sum()
    }

    /// The request and plan for `jobs`, whose coordinates are chosen.
    fn planned(&self, jobs: &mut [Job]) -> Result<(Request, Plan)> {
        let [width, height] = self.scene.camera.size.map(u64::from);
        let on_surfaces = jobs.iter().all(|job| job.surface.is_some());
        let request = Request {
            // Texture coordinates are loaded if a channel shows them.
            aovs: match on_surfaces {
                true => vec![Aov::UvU],
                false => Vec::new(),
            },
            // Whether light reaches backs is unknown until models are loaded.
            beside: self.largest(jobs),
            // As many paths as this number of pictures has.
            pictures: self.texels(jobs) / (width * height) + 1,
            ..self.request.clone()
        };
        let plan =
            Plan::new(self.scene, &request).map_err(|error| self.with_ways(on_surfaces, error))?;
        choose_coordinates(self.coordinates, &plan, jobs)?;
        Ok((request, plan))
    }

    /// An error about memory, with the options that make a bake smaller.
    fn with_ways(&self, on_surfaces: bool, mut error: Error) -> Error {
        if let Error::Invalid(problem) = &mut error
            && problem.place == "memory"
        {
            let size = if on_surfaces { "--texels" } else { "--size" };
            let half = match self.precision {
                CubePrecision::Single => ", --half",
                CubePrecision::Half => "",
            };
            let ways = match self.of_flash {
                true => format!("a smaller {size}, a smaller mesh, or a higher "),
                false => format!(
                    "a smaller {size}, fewer --bins (with a larger --bin-width){half}, a smaller mesh, or a higher "
                ),
            };
            problem.help = Message::from(ways) + Setting::MemoryLimit;
        }
        error
    }

    /// Refuses overlapping charts, unless other coordinates may replace them, and textures without enough room, before anything is baked.
    fn check(&self, prepared: &Prepared, jobs: &mut [Job]) -> Result<()> {
        for job in jobs {
            let Some(surface) = job.surface else {
                bake::check_camera(self.scene, prepared)?;
                continue;
            };
            let (coordinates, needs) = self.suitable(prepared, job, surface)?;
            job.surface = Some(Surface {
                coordinates,
                ..surface
            });
            (job.has_backs, job.lists) = (needs.backs, needs.lists);
        }
        Ok(())
    }

    /// The coordinates of `surface`, or others if none are asked for and light of one chart would show on another: those of most models are
    /// made for textures, and overlap or touch; some have a set for light, too.
    fn suitable(
        &self,
        prepared: &Prepared,
        job: &Job,
        surface: Surface,
    ) -> Result<(Coordinates, SurfaceNeeds)> {
        let check = |coordinates| {
            let surface = Surface {
                coordinates,
                ..surface
            };
            bake::check_surface(self.scene, prepared, &surface, &self.bins, self.precision)
        };
        let first = surface.coordinates;
        let checked = check(first);
        let name = self.scene.objects[surface.object].name.escape_debug();
        let too_near = |needs: SurfaceNeeds| {
            format!(
                "object \"{name}\": its charts are less than two texels apart: in {} light of one shows on another",
                texels(needs.shared)
            )
        };
        let problem = match &checked {
            _ if first == Coordinates::Atlas => None,
            Ok(needs) => (needs.shared > 0).then(|| too_near(*needs)),
            Err(Error::Invalid(refusal)) if self.coordinates.is_none() => {
                Some(format!("{}: {}", refusal.place, refusal.what))
            }
            Err(_) => None,
        };
        let checked = checked.map(|needs| (first, needs));
        let mut found = checked.map_err(|error| in_archive(job, error));
        let Some(problem) = problem else {
            return found;
        };
        let holds_atlas = extension(&job.path) == "npz";
        let mut others = Vec::new();
        if self.coordinates.is_none() {
            others.extend((1..job.sets).map(Coordinates::Set));
            others.extend(holds_atlas.then_some(Coordinates::Atlas));
        }
        let quiet = self.work.quiet.on;
        let tell = |coordinates| match coordinates {
            _ if coordinates == first => Ok(()),
            Coordinates::Set(set) => say(
                quiet,
                &format!("{problem}: set {set} takes its place (--uv {set})\n"),
            ),
            Coordinates::Atlas => say(
                quiet,
                &format!("{problem}: an atlas takes their place (--atlas)\n"),
            ),
        };
        for coordinates in others {
            let is_atlas = coordinates == Coordinates::Atlas;
            match check(coordinates) {
                Ok(needs) if needs.shared == 0 || is_atlas => {
                    tell(coordinates)?;
                    return Ok((coordinates, needs));
                }
                Ok(needs) => found = found.or(Ok((coordinates, needs))),
                Err(error) if is_atlas => found = found.or(Err(error)),
                Err(_) => {}
            }
        }
        // Charts that are too near are baked if there is nothing better.
        let (coordinates, needs) = found?;
        tell(coordinates)?;
        let atlas = match holds_atlas {
            true => "--atlas",
            false => "an .npz file, which can hold an atlas",
        };
        let help = format!("more --texels, if there is room between them, or {atlas}");
        warn(quiet, &[format!("{}: {help}", too_near(needs))]);
        Ok((coordinates, needs))
    }

    /// Prints what `jobs` would take.
    pub fn print_plan(&self, mut jobs: Vec<Job>) -> Result<()> {
        let (_, mut plan) = self.planned(&mut jobs)?;
        check_names(self.path, &jobs, &inputs::of(self.scene, &plan))?;
        self.check(&Prepared::new(self.scene, &plan, &Silent)?, &mut jobs)?;
        plan.memory.beside = self.largest(&jobs);
        let text = planned((self.scene, &plan), &jobs, &self.bins, self.precision);
        print(&text)
    }

    /// Trials of what `job` takes.
    fn trials<'b>(&'b self, prepared: &'b Prepared, job: &Job) -> Result<Trials<'b>> {
        match &job.surface {
            None => Trials::of_camera(self.scene, prepared, &self.bins),
            Some(surface) => Trials::of_surface(self.scene, prepared, surface, &self.bins),
        }
    }

    /// Bakes all `jobs`.
    pub fn run(&self, mut jobs: Vec<Job>) -> Result<()> {
        let began = Instant::now();
        let scene = self.scene;
        let (request, plan) = self.planned(&mut jobs)?;
        let read = inputs::of(scene, &plan);
        check_names(self.path, &jobs, &read)?;
        let earlier = Earlier::new(self, &request, &plan, &read);
        let quiet = self.work.quiet.on;
        if self.of_flash {
            jobs = earlier.left(jobs, |_| true, |path, _| format!("{path} exists already\n"))?;
        }
        if jobs.is_empty() {
            return Ok(());
        }
        in_pool(self.work.threads.count, || {
            let mut prepared = Prepared::new(scene, &plan, &Bar::new(0, true))?;
            self.check(&prepared, &mut jobs)?;
            say(quiet, &remarks::enclosed(scene, &prepared))?;
            if jobs.iter().any(|job| job.surface.is_none()) {
                say(quiet, &remarks::in_glass(scene, &prepared))?;
            }
            // Of several objects those that an earlier run finished are kept, as frames of a sequence are.
            let all = jobs.len();
            if jobs.len() > 1 && !self.of_flash {
                let is_whole = |job: &Job| existing::is_whole(&job.path, self.precision);
                jobs = earlier.left(jobs, is_whole, |path, table| {
                    format!("{path} exists already\n\n{table}")
                })?;
            }
            if self.of_flash {
                say(quiet, &self.size_of_flash(&jobs))?;
            }
            let of_all = match self.goal {
                None => self.texels(&jobs).saturating_mul(plan.film.samples.into()),
                Some(_) => 0,
            };
            let bar = Bar::new(of_all, quiet);
            let mut left = self.texels(&jobs);
            // A .npy file does not say what it is of: its parts are kept until all objects are done.
            let mut finished: Vec<Journal> = Vec::new();
            let mut is_first = jobs.len() == all;
            for job in &jobs {
                let texels = self.texels(std::slice::from_ref(job));
                let share = texels as f64 / left as f64;
                let chosen = self.chosen(&prepared, job, &earlier, (began, share))?;
                left -= texels;
                prepared.layout.samples = chosen.samples;
                let own = Bar::new(texels.saturating_mul(chosen.samples.into()), quiet);
                let bar = match self.goal {
                    None => &bar,
                    Some(_) => &own,
                };
                let sum = earlier.sum(job, chosen.samples);
                let journal = Journal::open(&job.unfinished(), &sum)?;
                match (is_first, finished.is_empty()) {
                    (true, _) => interrupt::can_resume(ANEW),
                    (false, true) => interrupt::can_resume(OTHERS),
                    (false, false) => interrupt::keeps(OTHERS),
                }
                is_first = false;
                self.say_found(job, &journal)?;
                let baked = self.baked(&prepared, job, &journal, bar);
                // Partial results of a refused bake are useless, unless the problem is the range of half precision.
                let baked = match baked {
                    Err(error @ Error::Invalid { .. }) => {
                        finished.push(journal);
                        return finished
                            .into_iter()
                            .try_for_each(Journal::remove)
                            .and(Err(error));
                    }
                    baked => baked?,
                };
                interrupt::check()?;
                let table = source((scene, &plan), &prepared, job, &self.bins, &baked);
                let mut metadata = metadata::of_baked(scene, &self.bins, chosen.samples, &baked);
                metadata.push(("source_table".into(), table.clone()));
                metadata.push((FINGERPRINT.into(), hexadecimal(&sum)));
                write(job, &metadata, self.bins.count, &baked)?;
                match extension(&job.path) == "npz" {
                    true => journal.remove()?,
                    false => finished.push(journal),
                }
                self.report(&plan, job, &baked, chosen.samples, &table)?;
                if let Some(goal) = self.goal {
                    let missed = goal.missed_by(&job.path, &baked, &chosen);
                    warn(quiet, missed.as_slice());
                }
            }
            finished.into_iter().try_for_each(Journal::remove)?;
            warn(quiet, &prepared.warnings);
            Ok(())
        })
    }

    /// What baking the light of a flash takes.
    fn size_of_flash(&self, jobs: &[Job]) -> String {
        let largest = self.largest(jobs) as f64 / 1e6;
        let [columns, rows] = jobs[0].surface.map_or([0; 2], |surface| surface.size);
        format!(
            "baking the light of the flash: {columns} × {rows} texels, {} bins; takes {largest:.0} MB of memory\n",
            self.bins.count
        )
    }

    /// The number of samples of `job`, which is this `share` of the work that is left: that of the parts that an earlier run has kept, or
    /// else by trials, if it is to be chosen.
    fn chosen(
        &self,
        prepared: &Prepared,
        job: &Job,
        earlier: &Earlier,
        (began, share): (Instant, f64),
    ) -> Result<Chosen> {
        let Some(goal) = self.goal else {
            return Ok(Chosen::of(prepared.layout.samples));
        };
        if let Some(samples) = earlier.unfinished(job)? {
            return Ok(Chosen::of(samples));
        }
        let quiet = self.work.quiet.on;
        let trials = self.trials(prepared, job)?;
        let chosen = goal.samples(&trials, (began, share), quiet)?;
        let unit = match job.surface {
            Some(_) => "texel",
            None => "pixel",
        };
        say(quiet, &chosen.text(&job.path, unit))?;
        Ok(chosen)
    }

    /// Says what an earlier run has left of `job`.
    fn say_found(&self, job: &Job, journal: &Journal) -> Result<()> {
        let quiet = self.work.quiet.on;
        if journal.found() > 0 {
            interrupt::keeps(RESUME);
            say(quiet, &format!("resuming {}\n", job.path.display()))?;
        }
        if journal.forgot() {
            let name = job.unfinished();
            let text = format!(
                "{} held parts of another bake (other options or another scene); starting over",
                name.display()
            );
            warn(quiet, &[text]);
        }
        Ok(())
    }

    /// The light of `job`, whose finished parts are kept in `journal`.
    fn baked(&self, prepared: &Prepared, job: &Job, journal: &Journal, bar: &Bar) -> Result<Baked> {
        let (scene, bins, precision) = (self.scene, &self.bins, self.precision);
        let (kept, bar) = (Some(journal), &Kept(bar));
        match &job.surface {
            None => bake::camera_cube(scene, prepared, bins, precision, kept, bar),
            Some(surface) => {
                bake::surface_cube(scene, prepared, surface, bins, precision, kept, bar)
            }
        }
    }

    /// Says what was written for `job`, which scenes show by the source `table`.
    fn report(
        &self,
        plan: &Plan,
        job: &Job,
        baked: &Baked,
        samples: u32,
        table: &str,
    ) -> Result<()> {
        let (text, warnings) = report(
            (self.scene, plan),
            job,
            (baked, &self.bins, self.precision),
            samples,
            table,
            self.of_flash,
        );
        // The command that makes a film of a flash neither asks for sources nor has other ways to bake.
        let (text, warnings) = match self.of_flash {
            true => (
                text.lines()
                    .take(1)
                    .map(|line| format!("{line}\n"))
                    .collect(),
                warnings.iter().map(|text| text.replace(WAYS, "")).collect(),
            ),
            false => (text, warnings),
        };
        say(self.work.quiet.on, &text)?;
        warn(self.work.quiet.on, &warnings);
        Ok(())
    }
}

/// The metadata key for the fingerprint of a bake's inputs.
const FINGERPRINT: &str = "bake_fingerprint";

/// The messages about stopped work: once a part of it is kept, before, and between objects.
const RESUME: &str = "its finished parts are kept: run the same command again to resume";
const ANEW: &str = "no part was finished; running the command again starts over";

const OTHERS: &str = "finished objects are kept: run the same command again to bake the others";

/// Counts rays as done once their part is kept, from which the work can be resumed.
struct Kept<'a>(&'a Bar);

impl Progress for Kept<'_> {
    fn rays_done(&self, rays: u64) {
        interrupt::keeps(RESUME);
        self.0.rays_done(rays);
    }

    fn is_cancelled(&self) -> bool {
        self.0.is_cancelled()
    }
}

/// The error about texture coordinates; only an archive can hold those that it advises to make.
fn in_archive(job: &Job, mut error: Error) -> Error {
    if let Error::Invalid(problem) = &mut error
        && problem.help.starts_with(&Setting::Atlas.to_string())
        && extension(&job.path) != "npz"
    {
        problem.help = Message::from("in an .npz file ") + problem.help.clone();
    }
    error
}

/// A number of texels.
fn texels(count: u64) -> String {
    match count {
        1 => "1 texel".into(),
        count => format!("{count} texels"),
    }
}

/// Refuses options that are shared with other commands and have no effect on a bake.
pub fn check_effects(arguments: &BakeArguments) -> Result<()> {
    let changes = &arguments.scene.changes;
    let picture = "a bake makes no picture, so there is no brightness to set";
    let camera = "light on surfaces does not depend on the camera";
    let on_surfaces = !arguments.camera;
    let without_effect = [
        (changes.exposure.is_some(), "--exposure", picture),
        (changes.white.is_some(), "--white", picture),
        (on_surfaces && changes.size.is_some(), "--size", camera),
        (
            on_surfaces && changes.pixel_centers,
            "--pixel-centers",
            camera,
        ),
        (
            changes.edits.time.is_some(),
            "--time",
            match on_surfaces {
                true => camera,
                false => "the cube of a camera holds light of all times",
            },
        ),
    ];
    match without_effect.into_iter().find(|(is_given, ..)| *is_given) {
        Some((_, option, why)) => {
            let help = match option {
                "--size" => {
                    "--texels is the size of a surface's texture, and --camera bakes what the camera sees"
                }
                _ => "leave it out",
            };
            Err(refused(option, why, help))
        }
        None => Ok(()),
    }
}

fn bins(arguments: &BakeArguments, scene: &Scene) -> Result<Bins> {
    let metres = |time: &nullray::spacetime::units::Time| time.metres(scene.speed_of_light);
    let bins = Bins {
        start: arguments.start.as_ref().map_or(0.0, metres),
        // Required for all but flashes.
        width: arguments.bin_width.as_ref().map_or(0.0, metres),
        count: arguments.bins as usize,
    };
    if !(bins.width > 0.0 && bins.width.is_finite()) {
        let what = "bins need a width above 0";
        return Err(refused("--bin-width", what, "like \"5 cm\""));
    }
    // Radiance 1 has the energy of one bin's width, which f32 holds with full precision from here on.
    let least = f64::from(f32::MIN_POSITIVE);
    if bins.width < least {
        let what = format!(
            "in bins of {} m the energies are too small for single precision: that of radiance 1 is the width of the bin in metres",
            number(bins.width)
        );
        let help = format!("{} m or more", number(least));
        return Err(refused("--bin-width", what, &help));
    }
    // Bins that f64 can distinguish.
    let end = bins.start + bins.width * bins.count as f64;
    let far = bins.start.abs().max(end.abs());
    if far >= 1e12 * bins.width || !far.is_finite() {
        let what = "bins so narrow cannot be told apart so far from time 0";
        return Err(refused(
            "--start",
            what,
            "a start nearer to 0, or wider bins",
        ));
    }
    Ok(bins)
}

/// Columns and rows of a surface if none are given.
const TEXELS: [u32; 2] = [64, 64];

/// One file for the camera, or one for each object.
fn jobs(arguments: &BakeArguments, scene: &Scene, named: Vec<usize>) -> Result<Vec<Job>> {
    let path = match &arguments.output {
        Some(path) => path.clone(),
        None => named_after(arguments.scene.path(), "-light.npz"),
    };
    if !["npy", "npz"].contains(&extension(&path).as_str()) {
        let what = "a cube is written as .npy, or as .npz with its metadata";
        return Err(refused(
            format!("-o {}", path.display()),
            what,
            "end it in .npz or .npy",
        ));
    }
    if arguments.camera {
        return Ok(vec![Job {
            path,
            surface: None,
            has_backs: false,
            lists: 0,
            sets: 0,
        }]);
    }
    surfaces(scene, &named, &path, arguments.texels.unwrap_or(TEXELS))
}

/// Jobs for these objects, or for all that reflect light: one file for each.
pub fn surfaces(scene: &Scene, named: &[usize], path: &Path, size: [u32; 2]) -> Result<Vec<Job>> {
    let objects = match named.is_empty() {
        true => reflecting(scene)?,
        false => named.to_vec(),
    };
    if let Some(object) = objects.iter().find(|k| !reflects(scene, **k)) {
        return Err(nothing_to_bake(scene, *object));
    }
    let alone = objects.len() == 1;
    let job = |object: usize| Job {
        path: match alone {
            true => path.to_path_buf(),
            false => suffixed(path, &in_file_name(&scene.objects[object].name)),
        },
        surface: Some(Surface {
            object,
            coordinates: Coordinates::Set(0),
            size,
        }),
        has_backs: false,
        lists: 0,
        sets: 0,
    };
    Ok(objects.into_iter().map(job).collect())
}

/// Chooses the coordinates `said`, or set 0, or an atlas for objects without any; and a file that can hold them.
fn choose_coordinates(said: Option<Coordinates>, plan: &Plan, jobs: &mut [Job]) -> Result<()> {
    for job in jobs {
        let Some(surface) = &mut job.surface else {
            continue;
        };
        job.sets = plan.objects[surface.object].uv_sets;
        let own = match job.sets {
            0 => Coordinates::Atlas,
            _ => Coordinates::Set(0),
        };
        surface.coordinates = said.unwrap_or(own);
        if surface.coordinates == Coordinates::Atlas && extension(&job.path) != "npz" {
            let what =
                "a .npy file cannot hold the texture coordinates that are made for the light";
            return Err(refused(
                format!("-o {}", job.path.display()),
                what,
                "end it in .npz",
            ));
        }
    }
    Ok(())
}

/// The indices of the named objects.
fn named(arguments: &BakeArguments, scene: &Scene) -> Result<Vec<usize>> {
    let index = |name: &String| {
        let found = scene.objects.iter().position(|o| o.name == *name);
        found.ok_or_else(|| {
            let names: Vec<_> = scene.objects.iter().map(|o| o.name.as_str()).collect();
            let what = "there is no object of this name";
            let help = format!("one of {}", names.join(", "));
            refused(format!("--object {name}"), what, &help)
        })
    };
    arguments.object.iter().map(index).collect()
}

/// All objects that reflect light; if there are none, the error gives the reason for the first object.
fn reflecting(scene: &Scene) -> Result<Vec<usize>> {
    let all = 0..scene.objects.len();
    let found: Vec<usize> = all.filter(|k| reflects(scene, *k)).collect();
    match (found.is_empty(), scene.objects.is_empty()) {
        (false, _) => Ok(found),
        (true, false) => Ok(vec![0]),
        (true, true) => {
            let what = "the scene has no objects: there is nothing to bake";
            Err(Error::invalid(
                &scene.name,
                "object",
                what,
                "add an [[object]]",
            ))
        }
    }
}

/// Whether an object reflects light.
fn reflects(scene: &Scene, object: usize) -> bool {
    matches!(lit_by(scene, object, ""), Lit::Reflecting(_))
}

/// The error for an object that reflects no light.
fn nothing_to_bake(scene: &Scene, object: usize) -> Error {
    let (what, help) = match lit_by(scene, object, "") {
        Lit::Spectrum => (
            "it shows its own `spectrum` and reflects no light: there is nothing to bake",
            "leave `spectrum` out, or bake another object",
        ),
        Lit::Cube(_) | Lit::Captures(_) => (
            "it shows the light of a cube already: there is nothing to bake",
            "leave its [[source]] out, or bake another object",
        ),
        Lit::Base | Lit::Reflecting(_) => (
            "no light falls on it: there is nothing to bake",
            "a [[light]], or a pulse, for this object",
        ),
    };
    let place = format!("object \"{}\"", scene.objects[object].name);
    Error::invalid(&scene.name, place, what, help)
}

fn check_names(scene: Option<&Path>, jobs: &[Job], inputs: &[PathBuf]) -> Result<()> {
    let overwritten = "the scene reads this file: it would be overwritten";
    let mut names = Names::new(
        scene.into_iter().chain(inputs.iter().map(PathBuf::as_path)),
        overwritten,
        " cube",
    );
    for job in jobs {
        names.check(&format!("-o {}", job.path.display()), &job.path)?;
        let unfinished = job.unfinished();
        names.check(&format!("parts in {}", unfinished.display()), &unfinished)?;
    }
    Ok(())
}

impl Job {
    /// Columns and rows of its cube, including those of a back.
    fn size(&self, scene: &Scene) -> [u32; 2] {
        let [columns, rows] = self
            .surface
            .map_or(scene.camera.size, |surface| surface.size);
        [columns, rows * (1 + u32::from(self.has_backs))]
    }

    /// The fingerprint of the bake that wrote its file, if that exists.
    fn fingerprint(&self) -> Option<String> {
        self.said(FINGERPRINT)
    }

    /// An entry of the metadata of its file, if that exists.
    fn said(&self, key: &str) -> Option<String> {
        let said = npy::load_metadata(&self.path)?;
        said.get(key)?.as_str().map(str::to_owned)
    }

    /// The file that keeps finished parts.
    fn unfinished(&self) -> PathBuf {
        let mut name = self.path.as_os_str().to_owned();
        name.push(".parts");
        name.into()
    }
}

/// Writes the light of one object, or of the camera, with the metadata needed to read it.
fn write(job: &Job, metadata: &[(String, String)], bins: usize, baked: &Baked) -> Result<()> {
    let coordinates = baked.texture_coordinates.iter().flatten();
    let coordinates: Vec<f64> = coordinates
        .flatten()
        .flatten()
        .map(|x| f64::from(*x))
        .collect();
    let (bins_shape, corners_shape) = ([bins], [coordinates.len() / 6, 3, 2]);
    let arrays: [(&str, &[usize], &[f64]); 2] = [
        ("standard_error", &bins_shape, &baked.standard_error),
        ("texture_coordinates", &corners_shape, &coordinates),
    ];
    let options = CubeOptions {
        half: false,
        arrays: match baked.texture_coordinates {
            Some(_) => &arrays,
            None => &arrays[..1],
        },
        metadata,
    };
    npz::write_cube_with(&job.path, &baked.cube, &options)
}
