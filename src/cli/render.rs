//! `nullray render`.

use std::path::PathBuf;
use std::time::Instant;

use nullray::aov::Aov;
use nullray::film::Film;
use nullray::plan::Plan;
use nullray::prepare::Prepared;
use nullray::render::Progress;
use nullray::scene::model::Scene;
use nullray::{Error, Result};

use super::args::RenderArguments;
use super::interrupt::Interrupt;
use super::output::{Isochrones, Outputs};
use super::progress::Bar;
use super::{builtin, print};

pub fn run(arguments: &RenderArguments) -> Result<()> {
    let scene = builtin::scene_or_builtin(&arguments.scene)?;
    let outputs = Outputs {
        images: outputs(arguments, &scene),
        isochrones: isochrones(arguments, &scene),
        aovs: arguments.scene.request().aovs,
    };
    let mut request = arguments.scene.request();
    request.aovs = outputs.needs();
    let report = in_pool(arguments.threads, || {
        one(&scene, &request, &outputs, arguments.quiet)
    })?;
    if arguments.quiet {
        Ok(())
    } else {
        print(&report)
    }
}

/// Renders one scene to its outputs; says what was written.
pub fn one(
    scene: &Scene,
    request: &nullray::plan::Request,
    outputs: &Outputs,
    quiet: bool,
) -> Result<String> {
    outputs.check()?;
    let plan = Plan::new(scene, request)?;
    let bar = Bar::new(plan.rays.camera, quiet);
    let start = Instant::now();
    let prepared = Prepared::new(scene, &plan, &bar)?;
    let prepared_in = start.elapsed();
    let film = nullray::render::render(&prepared, &bar);
    bar.finish();
    let film = film?;
    if bar.is_cancelled() {
        return Err(Error::Cancelled);
    }
    let rendered_in = start.elapsed() - prepared_in;
    Interrupt::install().begin_writing();
    let mut report = outputs.write(scene, &film)?;
    let rate = plan.rays.camera as f64 / rendered_in.as_secs_f64() / 1e6;
    report += &format!(
        "{} rays, {:.2} s to prepare, {:.2} s to render ({rate:.1} Mrays/s)\n",
        plan.rays.camera,
        prepared_in.as_secs_f64(),
        rendered_in.as_secs_f64(),
    );
    report += &coverage(&film);
    for warning in &prepared.warnings {
        report += &format!("warning: {warning}\n");
    }
    Ok(report)
}

/// Runs `work` on a pool of `threads` threads, or on the default one.
fn in_pool<T: Send>(threads: Option<u16>, work: impl FnOnce() -> Result<T> + Send) -> Result<T> {
    let Some(threads) = threads else {
        return work();
    };
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads.into())
        .build();
    let pool = pool
        .map_err(|e| Error::invalid("command line", "--threads", e.to_string(), "fewer threads"))?;
    pool.install(work)
}

fn outputs(arguments: &RenderArguments, scene: &Scene) -> Vec<PathBuf> {
    if !arguments.output.is_empty() {
        return arguments.output.clone();
    }
    let stem = std::path::Path::new(&scene.name)
        .file_stem()
        .unwrap_or("nullray".as_ref());
    vec![PathBuf::from(stem).with_extension("png")]
}

fn isochrones(arguments: &RenderArguments, scene: &Scene) -> Option<Isochrones> {
    let path = arguments.isochrones.clone()?;
    let step = arguments
        .isochrone_step
        .map(|time| time.metres(scene.speed_of_light));
    Some(Isochrones { path, step })
}

/// What part of the picture the data cover, in words; empty where nothing was missing.
fn coverage(film: &Film) -> String {
    let Some(c) = film.mean_coverage() else {
        return String::new();
    };
    let parts = [
        (c.before, "before the first bin"),
        (c.after, "after the last bin"),
        (c.off_texture, "off the texture"),
        (c.occluded, "hidden from the capture camera"),
    ];
    let missing: Vec<_> = parts
        .iter()
        .filter(|(part, _)| *part > 0.0)
        .map(|(part, why)| format!("{:.1} % {why}", 100.0 * part))
        .collect();
    if missing.is_empty() {
        return String::new();
    }
    format!(
        "coverage {:.1} %; no data for {}\n",
        100.0 * c.held,
        missing.join(", ")
    )
}

/// The retarded time, which isochrones need.
pub const RETARDED_TIME: Aov = Aov::EventCt;
