//! Sequences: one scene at many times. Everything is loaded and built once; existing frames are not rendered again.

pub mod existing;
mod range;

use std::path::Path;
use std::time::Instant;

use nullray::error::number;
use nullray::render::film::Film;
use nullray::render::plan;
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;
use nullray::render::survey;
use nullray::scene::SceneFile;
use nullray::scene::model::{Exposure, Scene};
use nullray::{Error, Result};

use super::args::Changes;
use super::check::check_all;
use super::console::{escaped, say, warn};
use super::failure::refused;
use super::names::{check_places, numbered};
use super::output::{Ends, Identity, Inputs, Kind, Outputs, Stamp};
use super::progress::Bar;
use super::stats::{Account, Preparation};
use super::{exposure, film, inputs, interrupt, overlay, remarks};

pub use range::{Frames, Shot};

/// The number of frames that are previewed for a common exposure.
const MEASURED: u64 = 9;

/// The inputs of a sequence.
pub struct Job<'a> {
    pub changes: &'a Changes,
    pub shared_exposure: SharedExposure<'a>,
    pub quiet: bool,
    pub file: &'a SceneFile,
    pub scene: &'a Scene,
    pub frames: &'a Frames,
    pub request: &'a Request,
    /// The file names, still to be numbered.
    pub outputs: &'a Outputs,
    /// Whether the files stay if the work is stopped.
    pub can_resume: bool,
}

/// The common exposure of the frames of a sequence if neither the scene nor the command line sets it.
#[derive(Clone, Copy)]
pub enum SharedExposure<'a> {
    /// Each has its own.
    None,
    /// That of the middle third.
    OfMiddle,
    /// That of all these frames, which show one place at many speeds.
    OfSpeeds(&'a Frames),
}

impl<'a> SharedExposure<'a> {
    /// That of one place at many speeds, `frames`, if they share one.
    pub fn at_speeds(is_same: bool, frames: &'a Frames) -> Self {
        match is_same {
            true => SharedExposure::OfSpeeds(frames),
            false => SharedExposure::None,
        }
    }
}

/// Renders the frames of a scene, and returns the fingerprints of their display pictures, in order. As soon as the files of a frame
/// exist, `ready` gets its index from 0 and its fingerprint.
pub fn run(
    job: &Job,
    account: Option<&mut Account>,
    ready: &mut dyn FnMut(u64, &str) -> Result<()>,
) -> Result<Vec<String>> {
    let Job {
        scene,
        frames,
        request,
        outputs,
        ..
    } = *job;
    // Trees are built once, for the rays of all frames.
    let numbers = &frames.numbers;
    let request = &Request {
        pictures: numbers.end.saturating_sub(numbers.start),
        ..request.clone()
    };
    let plan = outputs.method.plan(scene, request)?;
    overlay::check(outputs, scene)?;
    let read = inputs::of(scene, &plan);
    (outputs.paths()).try_for_each(|(option, path)| check_places(option, path))?;
    let all = frames.numbers.clone();
    check_all(
        all.map(|k| outputs.renamed(|path| numbered(path, k))),
        &read,
    )?;
    if job.can_resume {
        interrupt::can_resume("run the same command again to render the missing frames");
    }
    let mut sequence = Sequence {
        job,
        plan,
        // The scene's own text is hashed separately, after its changes.
        inputs: Inputs::read(read.get(1..).unwrap_or_default()),
        scene_file: Stamp::of(read.iter().take(1)),
        prepared: None,
        began: Instant::now(),
        done: Done::default(),
        account,
        exposure: None,
        unwritten: None,
        fingerprints: Vec::new(),
        passed_on: 0,
        ready,
    };
    // A sequence that extends beyond the camera's motion is not started.
    if let Some(last) = frames.numbers.clone().last() {
        for number in [frames.numbers.start, last] {
            sequence.check_time(number)?;
        }
        sequence.scene_at(last)?;
    }
    match job.shared_exposure {
        _ if !is_shown(outputs) => (),
        SharedExposure::None => (),
        SharedExposure::OfMiddle => sequence.measure(frames, exposure::of_film)?,
        SharedExposure::OfSpeeds(frames) => sequence.measure(frames, exposure::of_speeds)?,
    }
    let rendered = frames.numbers.clone().try_for_each(|number| {
        interrupt::check()?;
        sequence.frame(number)
    });
    // Even if the rest was abandoned: rendered frames are kept.
    let written = sequence.write_last();
    rendered.and(written)?;
    sequence.conclude()?;
    Ok(sequence.fingerprints)
}

/// Up to this number, frames are reported one by one as they are written.
const NAMED_ONE_BY_ONE: u64 = 12;

/// A sequence that is being rendered.
struct Sequence<'a> {
    job: &'a Job<'a>,
    plan: Plan,
    inputs: Inputs,
    /// The scene file as it was when it was read.
    scene_file: Stamp,
    /// `None` until the first missing frame.
    prepared: Option<Prepared>,
    /// When the first frame was begun.
    began: Instant,
    done: Done,
    account: Option<&'a mut Account>,
    /// The exposure of all frames, if it was measured.
    exposure: Option<Exposure>,
    /// The last frame, which is written while the next one is rendered: most formats keep one thread busy.
    unwritten: Option<Unwritten>,
    /// Those of the display pictures of the frames so far.
    fingerprints: Vec<String>,
    /// The number of frames that were passed on to `ready`.
    passed_on: usize,
    ready: &'a mut dyn FnMut(u64, &str) -> Result<()>,
}

/// The exposure of frames of which some are given.
type Measure = fn(&[Scene], Exposure, &Request, &mut Prepared) -> Result<Exposure>;

/// A rendered frame that is not yet written.
struct Unwritten {
    scene: Scene,
    outputs: Outputs,
    film: Film,
    times: Option<Film>,
}

impl Unwritten {
    /// Writes the files of the frame; returns what to print for each.
    fn write(self) -> Result<Vec<String>> {
        let mut lines = Vec::new();
        let times = self.times.as_ref();
        (self.outputs).write_each(&self.scene, &self.film, times, |line| {
            lines.push(line);
            Ok(())
        })?;
        Ok(lines)
    }
}

/// The work done so far.
#[derive(Default)]
struct Done {
    rendered: u64,
    skipped: u64,
    /// Seconds.
    prepared_in: f64,
    rendered_in: f64,
    black: u64,
    /// The remark on the first black frame.
    remark: String,
    /// The number of frames whose light is entirely shifted out of the visible range, and the remark on the first of them.
    shifted: u64,
    shift: String,
    /// The remark on the first frame whose camera is inside glass.
    in_glass: String,
    /// The number of frames that exceed the precision of a file, and the message for the first of them.
    beyond_precision: u64,
    limited: Option<String>,
}

impl Sequence<'_> {
    fn say(&self, text: &str) -> Result<()> {
        say(self.job.quiet, text)
    }

    /// Renders a frame, unless its files exist: complete, and from the same scene and options.
    fn frame(&mut self, number: u64) -> Result<()> {
        let scene = self.scene_at(number)?;
        let mut outputs = self.job.outputs.renamed(|path| numbered(path, number));
        let identity = Identity::new(&scene, self.job.request, &outputs, &self.inputs, "");
        self.fingerprints.push(identity.fingerprint(Kind::Display));
        outputs.identity = Some(identity);
        // In long sequences a line for each frame adds nothing to the count at the end.
        let quiet = self.job.quiet || self.is_long();
        if existing::all(&outputs) {
            self.write_last()?;
            self.done.skipped += 1;
            return self.pass_on(&[format!("frame {number} exists already\n")]);
        }
        let film = self.film(&scene, number)?;
        let times = match &mut self.prepared {
            Some(prepared) => super::film::times(&outputs, &scene, prepared, self.job.quiet)?,
            None => None,
        };
        if let Some(prepared) = &mut self.prepared {
            overlay::write(&outputs, &scene, &film, prepared, quiet)?;
        }
        self.note(number, &scene, &film);
        let frame = Unwritten {
            scene,
            outputs,
            film,
            times,
        };
        // A second film must fit in memory beside that of the next frame.
        let Plan {
            memory,
            memory_limit,
            ..
        } = &self.plan;
        if memory_limit.saturating_sub(memory.total()) >= memory.film {
            self.unwritten = Some(frame);
            return Ok(());
        }
        self.pass_on(&frame.write()?)
    }

    /// Writes the last frame, if it is not yet written.
    fn write_last(&mut self) -> Result<()> {
        match self.unwritten.take() {
            Some(frame) => self.pass_on(&frame.write()?),
            None => Ok(()),
        }
    }

    /// Reports the files of the next frame in `lines`, except for long sequences, and passes it on.
    fn pass_on(&mut self, lines: &[String]) -> Result<()> {
        let quiet = self.job.quiet || self.is_long();
        lines.iter().try_for_each(|line| say(quiet, line))?;
        let index = self.passed_on;
        self.passed_on += 1;
        (self.ready)(index as u64, &self.fingerprints[index])
    }

    fn is_long(&self) -> bool {
        let numbers = &self.job.frames.numbers;
        numbers.end - numbers.start > NAMED_ONE_BY_ONE
    }

    /// Refuses a frame outside of the camera's motion.
    fn check_time(&self, frame: u64) -> Result<()> {
        let camera = &self.job.scene.camera;
        let (Some(from), Ok(line)) = (self.job.frames.time(frame), camera.world_line()) else {
            return Ok(());
        };
        let to = from + camera.shutter.map_or(0.0, |shutter| shutter.duration);
        let [first, last] = line.span();
        if first <= from && to <= last {
            return Ok(());
        }
        let exposed = match to > from {
            true => format!("from {} m to {} m", number(from), number(to)),
            false => format!("at {} m", number(from)),
        };
        let what = format!(
            "frame {frame} is taken {exposed} of the camera's clock, but its motion lasts from {} m to {} m",
            number(first),
            number(last)
        );
        Err(refused(
            "--frames, --from",
            what,
            "ask for frames within the motion, or lengthen it",
        ))
    }

    /// The scene at the time of a frame.
    fn scene_at(&self, number: u64) -> Result<Scene> {
        let mut scene = self.unexposed(self.job.frames, number)?;
        scene.exposure = self.exposure.unwrap_or(scene.exposure);
        Ok(scene)
    }

    /// The scene at the time of a frame of `frames`, before their exposure is measured.
    fn unexposed(&self, frames: &Frames, number: u64) -> Result<Scene> {
        let file = self.job.file;
        let mut overrides = self.job.changes.overrides();
        if let Some(time) = frames.time(number) {
            overrides.time = Some(format!("{time} m"));
        }
        let mut scene = file.scene(&overrides)?;
        if let Some(shot) = frames.shot(number) {
            scene = shot.seen(&scene);
            // The scene's own white is meant for its own camera; at other speeds the light is different.
            if matches!(scene.exposure, Exposure::White(_)) && !self.job.changes.says_exposure() {
                scene.exposure = Exposure::default();
            }
        }
        Ok(scene)
    }

    /// Measures one exposure for all frames, by `measured_of` at most [`MEASURED`] of `frames`, including the first and the last.
    fn measure(&mut self, frames: &Frames, measured_of: Measure) -> Result<()> {
        let numbers = frames.numbers.clone();
        let count = numbers.end - numbers.start;
        let measured = count.min(MEASURED);
        let number = |k: u64| match measured {
            0 | 1 => numbers.start,
            _ => numbers.start + k * (count - 1) / (measured - 1),
        };
        let scenes = (0..measured).map(|k| self.unexposed(frames, number(k)));
        let scenes = scenes.collect::<Result<Vec<_>>>()?;
        let Some(percentile) = scenes.first().and_then(exposure::percentile) else {
            return Ok(());
        };
        let prepared = self.prepare(&scenes[0])?;
        let prepared = self.prepared.insert(prepared);
        let exposure = measured_of(&scenes, percentile, self.job.request, prepared)?;
        self.exposure = Some(exposure);
        match Ends::of(exposure) {
            Some(ends) => self.say(&format!("one exposure for all frames: {ends}\n")),
            None => Ok(()),
        }
    }

    /// Loads `scene` and builds its trees, for this and all other frames.
    fn prepare(&mut self, scene: &Scene) -> Result<Prepared> {
        let start = Instant::now();
        let prepared = Prepared::new(scene, &self.plan, &Bar::new(0, true))?;
        // The fingerprints must belong to the data that were loaded.
        if let Some(path) = self.inputs.stamp.changed() {
            return Err(changed(path));
        }
        let preparation = Preparation {
            seconds: start.elapsed().as_secs_f64(),
            built_in: prepared.built_in,
        };
        self.done.prepared_in += preparation.seconds;
        if let Some(account) = self.account.as_deref_mut() {
            account.prepared(preparation);
        }
        Ok(prepared)
    }

    fn film(&mut self, scene: &Scene, number: u64) -> Result<Film> {
        let Frames { numbers, .. } = self.job.frames;
        let (index, count) = (number - numbers.start + 1, numbers.end - numbers.start);
        let what = format!("frame {index} of {count}");
        let rays = self.plan.rays.camera;
        // Frames that an earlier run finished took no time in this one.
        let (own, rendered) = (count - self.done.skipped, self.done.rendered);
        let bar = Bar::new(rays.saturating_mul(own), self.job.quiet)
            .after(rays.saturating_mul(rendered), self.began)
            .named(what);
        let prepared = match self.prepared.take() {
            Some(prepared) => prepared,
            None => self.prepare(scene)?,
        };
        let prepared = self.prepared.insert(prepared);
        let start = Instant::now();
        let (method, unwritten) = (&self.job.outputs.method, self.unwritten.take());
        let (plan, account) = (&self.plan, self.account.as_deref_mut());
        prepared.retake_on_film(scene, plan)?;
        let (film, written) = rayon::join(
            || film::picture(prepared, method, &bar, account),
            || unwritten.map(Unwritten::write),
        );
        drop(bar);
        if let Some(lines) = written {
            self.pass_on(&lines?)?;
        }
        let film = film?;
        interrupt::check()?;
        self.done.rendered_in += start.elapsed().as_secs_f64();
        Ok(film)
    }

    fn note(&mut self, number: u64, scene: &Scene, film: &Film) {
        self.done.rendered += 1;
        if let Some(text) = self.job.outputs.beyond_precision(film) {
            self.done.beyond_precision += 1;
            let first = &mut self.done.limited;
            first.get_or_insert_with(|| format!("frame {number}: {text}"));
        }
        if let (false, Some(prepared)) = (remarks::is_black(film), &self.prepared) {
            let shift = remarks::shifted(scene, prepared);
            self.done.shifted += u64::from(!shift.is_empty());
            if self.done.shift.is_empty() && !shift.is_empty() {
                self.done.shift = format!("frame {number}: {shift}");
            }
        }
        if let (true, Some(prepared)) = (self.done.in_glass.is_empty(), &self.prepared) {
            let text = remarks::in_glass(scene, prepared);
            if !text.is_empty() {
                self.done.in_glass = format!("frame {number}: {text}");
            }
        }
        let remark = remarks::blackness(scene, film, false, self.prepared.as_ref());
        if !remark.is_empty() {
            self.done.black += 1;
            if self.done.remark.is_empty() {
                let times = self.prepared.as_mut().map(|p| {
                    let misfits = survey::misfits(scene, p).into_iter();
                    let line = |text: String| format!("{}\n", escaped(&text));
                    let others = remarks::other_times(scene, film, p);
                    others + &remarks::times(scene, p) + &misfits.map(line).collect::<String>()
                });
                let text = format!("frame {number}: {remark}{}", times.unwrap_or_default());
                // --time does not choose the times of frames that follow a clock.
                self.done.remark = match self.job.frames.time(number) {
                    Some(_) => text.replace("--time", "camera time"),
                    None => text,
                };
            }
        }
    }

    /// Reports the work done, and whatever concerns all frames: changed inputs, and black frames.
    fn conclude(&self) -> Result<()> {
        let done = &self.done;
        if done.rendered > 0 && self.is_long() {
            let numbers = &self.job.frames.numbers;
            for (_, path) in self.job.outputs.paths() {
                let [first, last] = [numbers.start, numbers.end - 1].map(|k| numbered(path, k));
                self.say(&format!(
                    "wrote {} to {}\n",
                    first.display(),
                    last.display()
                ))?;
            }
        }
        let rays = self.plan.rays.camera.saturating_mul(done.rendered);
        if done.rendered > 0 {
            self.say(&remarks::cost(rays, done.prepared_in, done.rendered_in))?;
        }
        let counted = plan::count;
        self.say(&format!(
            "{} rendered, {} existed already\n",
            counted(done.rendered),
            counted(done.skipped)
        ))?;
        let stamps = [&self.scene_file, &self.inputs.stamp];
        if let Some(path) = stamps.into_iter().find_map(Stamp::changed) {
            let text = format!(
                "{} has changed since: all frames show it as it was when the sequence began",
                path.display()
            );
            warn(self.job.quiet, [&text]);
        }
        if done.black > 1 {
            self.say(&format!(
                "{} frames are black, the first of them:\n",
                counted(done.black)
            ))?;
        }
        self.say(&done.remark)?;
        if done.shifted > 1 {
            self.say(&format!(
                "in {} frames all light in view is shifted out of sight, the first of them:\n",
                counted(done.shifted)
            ))?;
        }
        self.say(&done.shift)?;
        self.say(&done.in_glass)?;
        let more = done.beyond_precision.saturating_sub(1);
        let limited = done.limited.iter().map(|text| match more {
            0 => text.clone(),
            1 => format!("{text} (and the same for one more frame)"),
            more => format!("{text} (and the same for {} more frames)", counted(more)),
        });
        warn(self.job.quiet, &limited.collect::<Vec<_>>());
        let warnings = self.prepared.iter().flat_map(|p| &p.warnings);
        warn(self.job.quiet, warnings);
        Ok(())
    }
}

/// The error for files that change while they are read.
fn changed(path: &Path) -> Error {
    let what = "the file was changed while it was read";
    Error::invalid(path, "", what, "run the command again when it is complete")
}

/// Whether brightness matters to the output.
pub fn is_shown(outputs: &Outputs) -> bool {
    outputs.files().any(|(_, kind)| kind == Kind::Display) || !outputs.overlays.is_empty()
}
