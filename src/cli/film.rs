//! Renders a scene to a finished picture, and writes its files.

use std::time::Instant;

use nullray::approximate::raster::{self, Method};
use nullray::figures::overlay::centred;
use nullray::render::film::Film;
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::{LoadedCubes, Prepared};
use nullray::render::survey;
use nullray::scene::model::Scene;
use nullray::{Error, Result, render};

use super::check::check_all;
use super::console::{say, warn};
use super::output::{Kind, Outputs, times_need};
use super::progress::Bar;
use super::stats::{Account, Preparation};
use super::{inputs, interrupt, overlay, remarks};

/// The preparation of one scene. Refuses everything that can be refused before anything heavy is loaded.
pub fn check_one(scene: &Scene, request: &Request, outputs: &Outputs) -> Result<Plan> {
    let plan = outputs.method.plan(scene, request)?;
    overlay::check(outputs, scene)?;
    check_all([outputs.clone()], &inputs::of(scene, &plan))?;
    Ok(plan)
}

/// Renders one scene to its outputs; prints what was written unless `quiet`, and records the cost in `account`. Cubes that are among
/// `cubes` are not loaded again.
pub fn one(
    scene: &Scene,
    request: &Request,
    outputs: &Outputs,
    (quiet, account): (bool, Option<&mut Account>),
    cubes: &mut LoadedCubes,
) -> Result<()> {
    let plan = check_one(scene, request, outputs)?;
    let ready = Ready::new(scene, &plan, quiet, cubes)?;
    finish(scene, &plan, ready, outputs, (quiet, account))
}

/// Like [`one`], for a scene that is loaded.
pub fn finish(
    scene: &Scene,
    plan: &Plan,
    ready: Ready,
    outputs: &Outputs,
    (quiet, account): (bool, Option<&mut Account>),
) -> Result<()> {
    let mut rendered = film(plan, ready, &outputs.method, (quiet, account))?;
    let times = times(outputs, scene, &mut rendered.prepared, quiet)?;
    outputs.write(scene, &rendered.film, times.as_ref(), quiet)?;
    warn(quiet, &outputs.beyond_precision(&rendered.film));
    rendered.remark(scene, plan.rays.camera, quiet)?;
    let Rendered { film, prepared, .. } = &mut rendered;
    overlay::write(outputs, scene, film, prepared, quiet)
}

/// The retarded times at pixel centres, if a picture of them is requested; times at randomly placed samples would break its lines.
pub fn times(
    outputs: &Outputs,
    scene: &Scene,
    prepared: &mut Prepared,
    quiet: bool,
) -> Result<Option<Film>> {
    let asked = outputs.files().any(|(_, kind)| kind == Kind::Isochrones);
    if !asked || outputs.method != Method::Trace {
        return Ok(None);
    }
    let [width, height] = scene.camera.size.map(u64::from);
    let bar = Bar::new(width * height, quiet).named("retarded times".into());
    let film = centred(prepared, times_need(scene), &bar)?.film;
    // The progress bar is removed first, so that later messages have their own line.
    drop(bar);
    interrupt::check()?;
    Ok(Some(film))
}

/// A scene that is loaded for a picture.
pub struct Ready {
    pub prepared: Prepared,
    /// How long that took.
    seconds: f64,
}

impl Ready {
    /// Loads what `plan` lists, but for what is among `cubes`.
    pub fn new(scene: &Scene, plan: &Plan, quiet: bool, cubes: &mut LoadedCubes) -> Result<Ready> {
        let bar = Bar::new(plan.rays.camera, quiet);
        let start = Instant::now();
        let mut prepared = Prepared::sharing(scene, plan, cubes, &bar)?;
        let misfits = survey::misfits(scene, &mut prepared);
        prepared.warnings.extend(misfits);
        Ok(Ready {
            prepared,
            seconds: start.elapsed().as_secs_f64(),
        })
    }
}

/// A finished film, and remarks on it.
pub struct Rendered {
    pub film: Film,
    /// Seconds.
    prepared_in: f64,
    rendered_in: f64,
    warnings: Vec<String>,
    /// The loaded data, for further pictures of the same scene.
    pub prepared: Prepared,
}

impl Rendered {
    /// A film of passes, with the seconds that preparation and rendering took.
    pub fn of_passes(
        film: Film,
        [prepared_in, rendered_in]: [f64; 2],
        warnings: Vec<String>,
        prepared: Prepared,
    ) -> Self {
        Rendered {
            film,
            prepared_in,
            rendered_in,
            warnings,
            prepared,
        }
    }

    /// Prints the cost, with the given number of camera rays, and remarks, unless `quiet`.
    pub fn remark(&mut self, scene: &Scene, rays: u64, quiet: bool) -> Result<()> {
        let cost = remarks::cost(rays, self.prepared_in, self.rendered_in);
        say(quiet, &cost)?;
        say(quiet, &remarks::coverage(&self.film))?;
        // These survey the scene again, which is worth it only if nothing is visible.
        let is_black = remarks::is_black(&self.film);
        let (times, shift) = match is_black {
            true => (
                remarks::times(scene, &mut self.prepared),
                remarks::shift(scene, &self.prepared),
            ),
            false => (String::new(), remarks::shifted(scene, &self.prepared)),
        };
        let prepared = Some(&self.prepared);
        let blackness = remarks::blackness(scene, &self.film, !shift.is_empty(), prepared);
        say(quiet, &blackness)?;
        say(quiet, &remarks::only_sky(scene, &self.film, &self.prepared))?;
        say(
            quiet,
            &remarks::other_times(scene, &self.film, &mut self.prepared),
        )?;
        say(quiet, &remarks::enclosed(scene, &self.prepared))?;
        say(quiet, &remarks::in_glass(scene, &self.prepared))?;
        say(quiet, &times)?;
        say(quiet, &shift)?;
        warn(quiet, &self.warnings);
        Ok(())
    }
}

/// Renders what is loaded, with a progress bar unless `quiet`.
pub fn film(
    plan: &Plan,
    ready: Ready,
    method: &Method,
    (quiet, mut account): (bool, Option<&mut Account>),
) -> Result<Rendered> {
    let Ready {
        mut prepared,
        seconds: prepared_in,
    } = ready;
    warn(quiet, &std::mem::take(&mut prepared.warnings));
    let bar = Bar::new(plan.rays.camera, quiet);
    let start = Instant::now();
    bar.start();
    if let Some(account) = account.as_deref_mut() {
        account.prepared(Preparation {
            seconds: prepared_in,
            built_in: prepared.built_in,
        });
    }
    let film = picture(&prepared, method, &bar, account)?;
    drop(bar);
    interrupt::check()?;
    Ok(Rendered {
        film,
        prepared_in,
        rendered_in: start.elapsed().as_secs_f64(),
        warnings: std::mem::take(&mut prepared.warnings),
        prepared,
    })
}

/// Renders the prepared picture, and records the ray tracer's cost in `account`.
pub fn picture(
    prepared: &Prepared,
    method: &Method,
    bar: &Bar,
    account: Option<&mut Account>,
) -> Result<Film> {
    let (Method::Trace, Some(account)) = (method, account) else {
        return raster::render(prepared, method, bar);
    };
    let start = Instant::now();
    let (film, stats) = render::render_with_stats(prepared, bar)?;
    account.picture(stats, start.elapsed().as_secs_f64());
    Ok(film)
}

/// Runs `work` on a pool of `threads` threads, or on the default one.
pub fn in_pool<T: Send>(
    threads: Option<u16>,
    work: impl FnOnce() -> Result<T> + Send,
) -> Result<T> {
    let Some(threads) = threads else {
        return work();
    };
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads.into())
        .build();
    let pool = pool.map_err(|e| {
        Error::invalid(
            "command line",
            "--threads",
            e.to_string(),
            "use fewer threads",
        )
    })?;
    pool.install(work)
}
