//! The measurement: a reference, the geometry of every method, then rounds of timed pictures.

use std::sync::OnceLock;
use std::time::{Duration, Instant};

use super::entry::{Entry, Family, Front, LeftOut, Once, Reference, Study, Timing, Verdict};
use super::errors::{self, GeometricError, RadianceError};
use super::options::{StudyOptions, Subject};
use super::statistics::{front, quantile, within};
use crate::accel::Preset;
use crate::approximate::projection::Observer;
use crate::approximate::raster;
use crate::error::{Error, Result};
use crate::render::film::Film;
use crate::render::metadata::sha256;
use crate::render::plan::{Plan, Request};
use crate::render::prepare::Prepared;
use crate::render::progress::Progress;
use crate::render::sampler::Sampler;
use crate::scene::model::Scene;
use crate::validate::compare::{Picture, working_memory_of_light};

/// The geometric errors for which verdicts are given, pixels.
const ERRORS: [f64; 2] = [0.1, 0.01];

/// Studies `scene` on rayon's current thread pool.
///
/// # Errors
/// A scene without objects; a camera whose rays leave separate events, which has no exact film points; a method that cannot render the
/// scene (see [`crate::approximate::raster::render`]), if it is the only one; files that are missing or broken; [`Error::Cancelled`] when
/// `progress` says so.
pub fn study(scene: &Scene, options: &StudyOptions, progress: &dyn Progress) -> Result<Study> {
    if scene.objects.is_empty() {
        let what = "the scene has no object: there is no geometry whose errors could be measured";
        return Err(Error::invalid(
            &scene.name,
            "object",
            what,
            "add an [[object]]",
        ));
    }
    let plan = plan(scene, options)?;
    let start = Instant::now();
    let mut prepared = Prepared::new(scene, &plan, progress)?;
    let once = once(&prepared);
    let prepare_seconds = start.elapsed().as_secs_f64();
    Observer::new(&prepared)?;
    // Methods that cannot render this scene are left out, with the reason.
    let (able, left_out) = geometries(&mut prepared, &plan, options, progress)?;
    let start = Instant::now();
    // All are compared with the ray tracer with many samples.
    let truth = picture(
        &mut prepared,
        &Subject::REFERENCE,
        options.reference_samples,
        None,
        progress,
    )?;
    let truth = errors::picture("reference", &truth.0)?;
    let reference = Reference {
        samples: options.reference_samples,
        seconds: start.elapsed().as_secs_f64(),
    };
    // Rounds go through all methods in turn, so that a disturbance of the machine slows all of them.
    let mut rounds = Rounds::new(options, &able);
    let was_cut_short = rounds.run(&mut prepared, options, &truth, progress)?;
    let jobs = rounds.jobs.into_iter();
    let mut entries: Vec<_> = jobs.map(|job| job.finish(&once)).collect();
    mark_fronts(&mut entries);
    Ok(Study {
        format: "nullray-study",
        version: 1,
        software: format!("nullray {}", env!("CARGO_PKG_VERSION")),
        scene: scene.name.clone(),
        scene_sha256: sha256(scene.text.as_bytes()),
        size: plan.film.size,
        triangles: plan.frames.iter().map(|frame| frame.triangles).sum(),
        platform: format!("{} {}", std::env::consts::ARCH, std::env::consts::OS),
        threads: rayon::current_num_threads(),
        prepare_seconds,
        once,
        reference,
        verdicts: verdicts(&entries, &options.samples),
        entries,
        left_out,
        was_cut_short,
    })
}

impl StudyOptions {
    /// Camera rays of a study that its budget does not cut short, for progress.
    pub fn rays(&self, size: [u32; 2]) -> u64 {
        let pixels = u64::from(size[0]) * u64::from(size[1]);
        let samples: u64 = self.samples.iter().map(|n| u64::from(*n)).sum();
        let methods = self.methods.len() as u64;
        let timed = methods * samples * u64::from(self.runs);
        pixels * (timed + methods + 1 + u64::from(self.reference_samples))
    }
}

fn plan(scene: &Scene, options: &StudyOptions) -> Result<Plan> {
    let request = Request {
        memory_limit: options.memory_limit,
        program: options.program,
        ..Request::default()
    };
    if options.methods.is_empty() || options.samples.is_empty() || options.runs == 0 {
        let what = "there is nothing to measure";
        let help = "give methods, numbers of samples, and one run at least";
        return Err(Error::invalid(&scene.name, "study", what, help));
    }
    // Times of single pictures are compared, without the time for trees.
    let [width, height] = scene.camera.size.map(u64::from);
    let plan = Plan::new(scene, &request)?;
    Ok(Plan {
        trees: Preset::Balanced,
        ..plan.holding(0, working_memory_of_light(width * height))?
    })
}

/// The data that `prepared` has built, or builds now, once.
fn once(prepared: &Prepared) -> Once {
    let start = Instant::now();
    for frame in &prepared.frames {
        frame.shared_vertices();
    }
    let vertex_seconds = start.elapsed().as_secs_f64();
    let frames = prepared.frames.iter();
    Once {
        tree_seconds: prepared.built_in,
        tree_bytes: frames.clone().map(|frame| frame.bvh.bytes() as u64).sum(),
        vertex_seconds,
        vertex_bytes: frames.map(|frame| frame.shared_vertices().bytes()).sum(),
    }
}

/// A picture with `samples` samples per pixel, in the memory of `over`, and the bytes that the method holds for it.
fn picture(
    prepared: &mut Prepared,
    subject: &Subject,
    samples: u32,
    over: Option<Film>,
    progress: &dyn Progress,
) -> Result<(Film, u64)> {
    prepared.layout.channels.clear();
    prepared.layout.samples = samples;
    prepared.layout.pixel_centers = false;
    prepared.sampler = Sampler::stratified(samples);
    taken(prepared, subject, over, progress)
}

/// The picture for which `prepared` is set up.
fn taken(
    prepared: &mut Prepared,
    subject: &Subject,
    over: Option<Film>,
    progress: &dyn Progress,
) -> Result<(Film, u64)> {
    prepared.method.precision = subject.precision;
    raster::counted(prepared, &subject.method, over, progress)
}

/// A method that can render the scene, its geometric error, and the seconds of the picture that shows it.
type Shown = (Subject, GeometricError, f64);

/// The methods that can render the scene, and those that cannot.
type Able = (Vec<Shown>, Vec<LeftOut>);

/// The geometric errors of all methods.
fn geometries(
    prepared: &mut Prepared,
    plan: &Plan,
    options: &StudyOptions,
    progress: &dyn Progress,
) -> Result<Able> {
    prepared.layout.channels = errors::geometry_channels();
    prepared.layout.samples = 1;
    prepared.layout.pixel_centers = true;
    prepared.sampler = Sampler::centred();
    let (exact, _) = taken(prepared, &Subject::REFERENCE, None, progress)?;
    let (mut able, mut left_out) = (Vec::new(), Vec::new());
    for subject in &options.methods {
        let start = Instant::now();
        let able_to = subject.method.added_to(plan.clone());
        let film = able_to.and_then(|plan| {
            prepared.memory_left = plan.memory_left();
            taken(prepared, subject, None, progress)
        });
        match film {
            Ok((film, _)) => {
                let seconds = start.elapsed().as_secs_f64();
                let error = GeometricError::of(prepared, &film, &exact)?;
                able.push((*subject, error, seconds));
            }
            Err(Error::Cancelled) => return Err(Error::Cancelled),
            Err(error) if options.methods.len() == 1 => return Err(error),
            Err(error) => left_out.push(LeftOut {
                method: subject.to_string(),
                why: error.to_string(),
            }),
        }
    }
    Ok((able, left_out))
}

/// One method with one number of samples, during the measurement.
struct Job {
    subject: Subject,
    samples: u32,
    geometry: GeometricError,
    /// The seconds that a run takes: of the last one, or estimated from the picture of the geometric error.
    expected: f64,
    runs: Vec<f64>,
    setups: Vec<f64>,
    memory: Option<u64>,
    radiance: Option<RadianceError>,
}

/// All of them, in the order of their samples.
struct Rounds {
    jobs: Vec<Job>,
}

impl Rounds {
    fn new(options: &StudyOptions, able: &[Shown]) -> Self {
        let of = |samples: &u32| {
            let job = |(subject, geometry, seconds): &Shown| Job {
                subject: *subject,
                samples: *samples,
                geometry: *geometry,
                expected: seconds * f64::from(*samples),
                runs: Vec::new(),
                setups: Vec::new(),
                memory: None,
                radiance: None,
            };
            able.iter().map(job).collect::<Vec<_>>()
        };
        Rounds {
            jobs: options.samples.iter().flat_map(of).collect(),
        }
    }

    /// Runs round after round while the budget lasts; returns whether it ended them. The fast jobs come first, as many as have all their
    /// runs within the budget; then the others, the faster ones first in each round.
    fn run(
        &mut self,
        prepared: &mut Prepared,
        options: &StudyOptions,
        truth: &Picture,
        progress: &dyn Progress,
    ) -> Result<bool> {
        let start = Instant::now();
        let (mut cut, mut last) = (false, None);
        let runs = options.runs as usize;
        let expected: Vec<f64> = self.jobs.iter().map(|job| job.expected).collect();
        let (fast, slow) = within(&expected, options.budget.as_secs_f64() / runs as f64);
        for (jobs, is_fast) in [(fast, true), (slow, false)] {
            for round in 0..runs {
                let mut jobs = jobs.clone();
                match is_fast {
                    // Rounds start at different jobs, so that no job always follows the same one.
                    true => {
                        let first = (7 * round) % jobs.len().max(1);
                        jobs.rotate_left(first);
                    }
                    false => self.sort(&mut jobs),
                }
                for index in jobs {
                    let left = options.budget.saturating_sub(start.elapsed());
                    if !self.is_worth_it(index, round, left) {
                        cut = true;
                        continue;
                    }
                    let film = self.jobs[index].run(prepared, truth, last.take(), progress)?;
                    last = Some(film);
                }
            }
        }
        Ok(cut)
    }

    /// Sorts jobs by the times that are expected of them.
    fn sort(&self, jobs: &mut [usize]) {
        jobs.sort_by(|a, b| self.jobs[*a].expected.total_cmp(&self.jobs[*b].expected));
    }

    /// Whether the next run of a job is likely to end within `left`. An estimate may be far too large: a job without a run is tried while
    /// half of that is left.
    fn is_worth_it(&self, index: usize, round: usize, left: Duration) -> bool {
        let job = &self.jobs[index];
        let part = match (job.runs.is_empty(), round) {
            (true, 0) => ESTIMATED,
            (true, _) => return false,
            (false, _) => 1.0,
        };
        !left.is_zero() && part * job.expected <= left.as_secs_f64()
    }
}

/// The part of the estimated time of a first run that must be left for it.
const ESTIMATED: f64 = 0.5;

impl Job {
    fn run(
        &mut self,
        prepared: &mut Prepared,
        truth: &Picture,
        last: Option<Film>,
        progress: &dyn Progress,
    ) -> Result<Film> {
        // As a sequence of frames does, pictures take the memory of the last one.
        let watch = Watch {
            progress,
            start: Instant::now(),
            first: OnceLock::new(),
        };
        let (film, bytes) = picture(prepared, &self.subject, self.samples, last, &watch)?;
        let seconds = watch.start.elapsed().as_secs_f64();
        self.expected = seconds;
        self.runs.push(seconds);
        self.setups
            .push(watch.first.get().copied().unwrap_or(seconds));
        if self.radiance.is_none() {
            self.memory = Some(prepared.layout.bytes() + bytes);
            self.radiance = Some(RadianceError::of(&film, truth)?);
        }
        Ok(film)
    }

    fn finish(self, once: &Once) -> Entry {
        let timing = (!self.runs.is_empty()).then(|| Timing {
            median: quantile(&self.runs, 0.5),
            quartiles: [0.25, 0.75].map(|part| quantile(&self.runs, part)),
            setup: quantile(&self.setups, 0.5),
            runs: self.runs,
        });
        let family = Family::of(&self.subject);
        let (once_seconds, once_bytes) = match family.is_raster() {
            true => (once.vertex_seconds, once.vertex_bytes),
            false => (once.tree_seconds, once.tree_bytes),
        };
        Entry {
            method: self.subject.to_string(),
            family,
            samples: self.samples,
            timing,
            once_seconds,
            once_bytes,
            memory: self.memory,
            geometry: self.geometry,
            radiance: self.radiance,
            front: Front::default(),
        }
    }
}

/// Records when the first tile is done.
struct Watch<'a> {
    progress: &'a dyn Progress,
    start: Instant,
    first: OnceLock<f64>,
}

impl Progress for Watch<'_> {
    fn rays_done(&self, rays: u64) {
        self.first
            .get_or_init(|| self.start.elapsed().as_secs_f64());
        self.progress.rays_done(rays);
    }

    fn is_cancelled(&self) -> bool {
        self.progress.is_cancelled()
    }
}

fn mark_fronts(entries: &mut [Entry]) {
    let time = |e: &Entry| e.timing.as_ref().map_or(f64::NAN, |t| t.median);
    let radiance = |e: &Entry| [time(e), e.radiance.map_or(f64::NAN, |r| r.relrmse)];
    let fewest = entries.iter().map(|e| e.samples).min();
    let geometry = |e: &Entry| match Some(e.samples) == fewest {
        true => [time(e), e.geometry.pixels.max],
        false => [f64::NAN; 2],
    };
    let of_radiance = front(&entries.iter().map(radiance).collect::<Vec<_>>());
    let of_geometry = front(&entries.iter().map(geometry).collect::<Vec<_>>());
    for ((entry, radiance), geometry) in entries.iter_mut().zip(of_radiance).zip(of_geometry) {
        entry.front = Front { geometry, radiance };
    }
}

fn verdicts(entries: &[Entry], samples: &[u32]) -> Vec<Verdict> {
    let all = ERRORS.iter();
    all.flat_map(|pixels| samples.iter().map(|n| verdict(entries, *pixels, *n)))
        .collect()
}

/// The fastest methods with an error of at most `pixels` and `samples` samples per pixel.
fn verdict(entries: &[Entry], pixels: f64, samples: u32) -> Verdict {
    let fits = |e: &&Entry| e.samples == samples && e.geometry.pixels.max <= pixels;
    let fastest = |is: fn(Family) -> bool| {
        let timed = entries.iter().filter(fits).filter(|e| is(e.family));
        let timed = timed.filter_map(|e| Some((e, e.timing.as_ref()?)));
        timed.min_by(|a, b| a.1.median.total_cmp(&b.1.median))
    };
    let named = |found: Option<(&Entry, &Timing)>| found.map(|(e, t)| (e.method.clone(), t.median));
    let trace = fastest(|family| family == Family::Trace);
    let fast = fastest(|family| family == Family::FastTrace);
    let (raster, warp) = (fastest(Family::is_raster), fastest(Family::is_warp));
    Verdict {
        pixels,
        samples,
        fastest: first([trace, fast, raster, warp]),
        trace: trace.map(|(_, timing)| timing.median),
        trace_fast: fast.map(|(_, timing)| timing.median),
        raster: named(raster),
        raster_over_trace: raster
            .zip(trace)
            .map(|((_, raster), (_, trace))| ratios(raster, trace)),
        runs: raster.zip(trace).map_or(0, |((_, raster), (_, trace))| {
            raster.runs.len().min(trace.runs.len())
        }),
        warp: named(warp),
    }
}

/// The method that is faster than all others, if the quartiles of its ratio to the next say so: those of one run say nothing.
fn first(found: [Option<(&Entry, &Timing)>; 4]) -> Option<String> {
    let mut found: Vec<_> = found.into_iter().flatten().collect();
    found.sort_by(|a, b| a.1.median.total_cmp(&b.1.median));
    let (entry, timing) = found.first()?;
    let is_first = match found.get(1) {
        Some((_, next)) => {
            let has_spread = timing.runs.len().min(next.runs.len()) > 1;
            has_spread && ratios(timing, next)[2] < 1.0
        }
        None => true,
    };
    is_first.then(|| entry.method.clone())
}

/// The ratio of times, run by run: median and quartiles.
fn ratios(a: &Timing, b: &Timing) -> [f64; 3] {
    let ratios: Vec<_> = a.runs.iter().zip(&b.runs).map(|(a, b)| a / b).collect();
    [0.5, 0.25, 0.75].map(|part| quantile(&ratios, part))
}
