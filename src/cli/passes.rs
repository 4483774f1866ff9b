//! Progressive rendering: `nullray render --error`, `--budget` and `--passes`.
//!
//! The sums of finished passes are kept in a file beside the first picture, under its name with `.passes`, until the picture has the
//! requested quality, so that stopped work can be resumed.

use std::path::{Path, PathBuf};
use std::time::Instant;

use nullray::render::passes::{self, Passes};
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;
use nullray::render::survey;
use nullray::scene::model::Scene;
use nullray::{Error, Result};

use super::args::PassArguments;
use super::check::{check_all, check_beside};
use super::console::{say, warn};
use super::film::{Rendered, times};
use super::frames::existing;
use super::output::{Identity, Inputs, Outputs, Samples};
use super::progress::Bar;
use super::values::MOST_PASSES;
use super::{inputs, interrupt, overlay, remarks};

/// Files are written again after this many times the duration of writing them, and after this many seconds.
const WRITING_SHARE: f64 = 10.0;
const LEAST_BETWEEN: f64 = 1.0;
/// The number of passes for which trees are built, because the actual one is unknown.
const USUAL_PASSES: u64 = 16;

/// The message when work is stopped, once a file has passes to resume from.
const RESUME: &str =
    "the passes up to the last save are kept: run the same command again to resume";

/// The message between panels.
const OTHERS: &str = "finished panels are kept: run the same command again to render the others";

/// What a picture of passes is a part of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Of {
    /// Nothing: it is made anew unless it is unfinished.
    Scene,
    /// Panels: one that an earlier run finished is kept, as a frame of a sequence is.
    Panels,
}

impl Of {
    /// Notes what is kept of a finished picture if the work is stopped after it.
    fn is_done(self) {
        match self {
            Of::Scene => interrupt::keeps_nothing(),
            Of::Panels => interrupt::keeps(OTHERS),
        }
    }
}

/// Everything that the requested passes of one scene need. Refuses everything that can be refused before anything heavy is loaded.
pub fn check_one(
    scene: &Scene,
    mut request: Request,
    outputs: &Outputs,
) -> Result<(Request, Plan)> {
    // Isochrones come from a picture of their own, so the passes have no channels for them.
    request.aovs.clone_from(&outputs.aovs);
    // The sums of the passes take memory beside the scene, so the plan is made twice; only the second is held to the limit.
    let unlimited = Request {
        memory_limit: u64::MAX,
        ..request.clone()
    };
    let layout = Plan::new(scene, &unlimited)?.film;
    request.beside = request.beside.saturating_add(passes::bytes(&layout));
    request.pictures = USUAL_PASSES;
    let plan = Plan::new(scene, &request)?;
    overlay::check(outputs, scene)?;
    // No output may overwrite an input or another output.
    let read = inputs::of(scene, &plan);
    check_all([outputs.clone()], &read)?;
    check_beside(&sums_of(outputs), outputs, &read)?;
    Ok((request, plan))
}

/// Renders one scene, or a panel, to its outputs in passes.
pub fn one(
    of: Of,
    scene: &Scene,
    request: Request,
    outputs: &Outputs,
    wanted: PassArguments,
    quiet: bool,
) -> Result<()> {
    let began = Instant::now();
    let (request, plan) = check_one(scene, request, outputs)?;
    let read = inputs::of(scene, &plan);
    let sums = sums_of(outputs);
    let inputs = Inputs::read(read.get(1..).unwrap_or_default());
    let samples = Samples::new(scene, &request, &inputs);
    let fingerprint = samples.of_sums(&format!("passes {:?}", wanted.error));
    let identity = || Identity::new(scene, &request, outputs, &inputs, &format!("{wanted:?}"));
    let finished = Outputs {
        identity: (of == Of::Panels).then(identity),
        ..outputs.clone()
    };
    if existing::all(&finished) {
        of.is_done();
        let mut paths = outputs.paths().map(|(_, path)| path.display());
        return paths.try_for_each(|path| say(quiet, &format!("{path} exists already\n")));
    }
    let bar = Bar::new(plan.rays.camera, quiet);
    let mut prepared = Prepared::new(scene, &plan, &bar)?;
    drop(bar);
    let prepared_in = began.elapsed().as_secs_f64();
    let misfits = survey::misfits(scene, &mut prepared);
    prepared.warnings.extend(misfits);
    warn(quiet, &std::mem::take(&mut prepared.warnings));
    let mut work = Work {
        passes: Passes::new(&prepared, wanted.error)?,
        of,
        scene,
        outputs,
        finished: &finished,
        sums,
        fingerprint,
        wanted,
        quiet,
        began,
        rays: 0,
    };
    work.resume(&prepared)?;
    work.go_on(&prepared)?;
    let rendered = Rendered::of_passes(
        work.passes.film()?,
        [prepared_in, began.elapsed().as_secs_f64() - prepared_in],
        std::mem::take(&mut prepared.warnings),
        prepared,
    );
    work.conclude(rendered)
}

/// The file of sums, beside the first picture.
fn sums_of(outputs: &Outputs) -> PathBuf {
    let first = outputs.paths().map(|(_, path)| path).next();
    let mut name = first.unwrap_or(Path::new("picture")).as_os_str().to_owned();
    name.push(".passes");
    name.into()
}

/// Work in passes.
struct Work<'a> {
    passes: Passes,
    of: Of,
    scene: &'a Scene,
    outputs: &'a Outputs,
    /// The same for a picture of the requested quality.
    finished: &'a Outputs,
    sums: PathBuf,
    fingerprint: [u8; 32],
    wanted: PassArguments,
    quiet: bool,
    began: Instant,
    /// Camera rays traced in this run.
    rays: u64,
}

impl Work<'_> {
    /// Resumes stopped work.
    fn resume(&mut self, prepared: &Prepared) -> Result<()> {
        if self.passes.resume(&self.sums, &self.fingerprint)? {
            interrupt::keeps(RESUME);
            let text = format!("resuming after pass {}\n", self.passes.done());
            say(self.quiet, &text)?;
        } else {
            if self.sums.exists() {
                let text = format!(
                    "{} held passes of another picture (other options or another scene); starting over",
                    self.sums.display()
                );
                warn(self.quiet, &[text]);
            }
            // Discards what was read of sums that belong to other work.
            self.passes = Passes::new(prepared, self.wanted.error)?;
        }
        Ok(())
    }

    /// Whether the picture has the requested quality.
    fn is_good(&self) -> bool {
        self.passes.is_settled() || self.has_all()
    }

    /// Whether it has all passes that this command takes.
    fn has_all(&self) -> bool {
        let most = self.wanted.passes.unwrap_or(self.passes.most());
        self.passes.done() >= most
    }

    /// Renders passes until the picture is good enough or the time is up.
    fn go_on(&mut self, prepared: &Prepared) -> Result<()> {
        let mut written = (Instant::now(), 0.0);
        while !self.is_good() {
            let start = Instant::now();
            self.pass(prepared)?;
            let took = start.elapsed().as_secs_f64();
            let time = self.began.elapsed().as_secs_f64() + took;
            if self.wanted.budget.is_some_and(|budget| time > budget) {
                break;
            }
            let since = written.0.elapsed().as_secs_f64();
            if since > LEAST_BETWEEN.max(WRITING_SHARE * written.1) {
                let start = Instant::now();
                self.passes.write(&self.sums, &self.fingerprint)?;
                let pictures = self.outputs.of_film_alone();
                pictures.write(self.scene, &self.passes.film()?, None, true)?;
                // Before this there is neither a picture nor a file to resume from.
                interrupt::keeps(RESUME);
                written = (Instant::now(), start.elapsed().as_secs_f64());
            }
        }
        Ok(())
    }

    /// Renders two passes.
    fn pass(&mut self, prepared: &Prepared) -> Result<()> {
        let rays = self.passes.rays();
        let done = self.passes.done();
        let error = match done {
            0 => String::new(),
            _ => format!(", error {:.2} %", 100.0 * self.passes.error()),
        };
        let bar = Bar::new(rays, self.quiet).named(format!("pass {}{error}", done + 2));
        self.passes.advance(prepared, &bar)?;
        drop(bar);
        self.rays += rays;
        interrupt::check()
    }

    /// Writes all files, reports the quality of the picture, and removes the sums if nothing is left to do.
    fn conclude(mut self, mut rendered: Rendered) -> Result<()> {
        let (quiet, scene) = (self.quiet, self.scene);
        // If an error was requested and is not reached yet, the work can be resumed later.
        let is_left = self.wanted.error.is_some() && !self.passes.is_settled();
        let outputs = match is_left {
            true => self.outputs,
            false => self.finished,
        };
        if is_left {
            self.passes.write(&self.sums, &self.fingerprint)?;
            interrupt::keeps(RESUME);
        }
        let times = times(outputs, scene, &mut rendered.prepared, quiet)?;
        outputs.write(scene, &rendered.film, times.as_ref(), quiet)?;
        warn(quiet, &outputs.beyond_precision(&rendered.film));
        let (passes, error) = (self.passes.done(), 100.0 * self.passes.error());
        let lacking = match rendered.prepared.lacks_light() {
            true => "; this leaves out the light that cannot be sampled (see the warning)",
            false => "",
        };
        let of_pixels =
            format!("{error:.3} % of the mean radiance (root mean square over pixels){lacking}");
        // The request applies to the pixels of each tile, in proportion to its own radiance if that is above the picture's.
        let beyond = self.passes.beyond();
        let text = match self.wanted.error {
            Some(wanted) if self.passes.is_settled() && beyond.tiles == 0 => format!(
                "{passes} passes: in each tile of 16 × 16 pixels the standard error of pixels has reached the requested {} % of the tile's \
                 radiance or of the picture's; in the whole picture it is {of_pixels}\n",
                100.0 * wanted
            ),
            Some(wanted) if self.passes.is_settled() => {
                let tiles = match beyond.tiles {
                    1 => "1 tile of 16 × 16 pixels".to_owned(),
                    count => format!("{count} tiles of 16 × 16 pixels"),
                };
                // At equal digits it must not look like the requested error.
                let largest = 100.0 * beyond.largest;
                format!(
                    "{passes} passes: in {tiles} the standard error of pixels is beyond the requested {} % of the tile's radiance or of the \
                     picture's, with up to {largest:.3} %, because light that few samples find was missed at first; passes of more samples \
                     (--spp) help. All others have reached it; in the whole picture it is {of_pixels}\n",
                    100.0 * wanted
                )
            }
            Some(_) | None => format!("{passes} passes, standard error {of_pixels}\n"),
        };
        say(quiet, &text)?;
        match is_left {
            true => warn(quiet, [&self.missing()]),
            false => {
                self.of.is_done();
                remove(&self.sums)?;
            }
        }
        rendered.remark(scene, self.rays, quiet)?;
        let Rendered { film, prepared, .. } = &mut rendered;
        overlay::write(outputs, scene, film, prepared, quiet)
    }

    /// The message about tiles that have not reached the requested error.
    fn missing(&self) -> String {
        let error = remarks::short(100.0 * self.wanted.error.unwrap_or_default());
        let tiles = match self.passes.unsettled() {
            1 => "1 tile has".to_owned(),
            count => format!("{count} tiles have"),
        };
        let (sums, done) = (self.sums.display(), self.passes.done());
        let next = match done.saturating_mul(2).min(MOST_PASSES) {
            _ if !self.has_all() => format!("run the same command again to continue from {sums}"),
            more if more > done => {
                format!("these were all {done} passes; --passes {more} continues from {sums}")
            }
            _ => "no picture takes more passes; larger ones (--spp) help".into(),
        };
        format!(
            "{tiles} not reached an error of {error} % yet: {next}; light that only a few of many paths find, as through mirrors and glass \
             from small lamps, may never converge"
        )
    }
}

/// Removes the sums, if there are any.
fn remove(path: &Path) -> Result<()> {
    match std::fs::remove_file(path) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
            Err(Error::io(path, "cannot remove")(error))
        }
        _ => Ok(()),
    }
}
