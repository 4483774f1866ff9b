//! `nullray render`.

use std::path::PathBuf;
use std::time::Instant;

use nullray::plan::{self, Plan};
use nullray::prepare::Prepared;
use nullray::scene::model::Scene;
use nullray::{Error, Result};

use super::args::RenderArguments;
use super::output::{Isochrones, Outputs};
use super::progress::Bar;
use super::{builtin, inputs, interrupt, print, remarks};

pub fn run(arguments: &RenderArguments) -> Result<()> {
    let scene = builtin::scene_or_builtin(&arguments.scene)?;
    let outputs = Outputs {
        images: images(arguments),
        isochrones: isochrones(arguments, &scene),
        aovs: arguments.scene.request().aovs,
    };
    let mut request = arguments.scene.request();
    request.aovs = outputs.needs();
    in_pool(arguments.threads, || {
        one(&scene, &request, &outputs, arguments.quiet)
    })
}

/// Renders one scene to its outputs; says what was written unless `quiet`.
pub fn one(scene: &Scene, request: &plan::Request, outputs: &Outputs, quiet: bool) -> Result<()> {
    let mut say = |text: &str| if quiet { Ok(()) } else { print(text) };
    let plan = Plan::new(scene, request)?;
    outputs.check(&inputs::of(scene, &plan))?;
    let bar = Bar::new(plan.rays.camera, quiet);
    let start = Instant::now();
    let prepared = Prepared::new(scene, &plan, &bar)?;
    let prepared_in = start.elapsed().as_secs_f64();
    bar.start();
    let film = nullray::render::render(&prepared, &bar)?;
    drop(bar);
    interrupt::check()?;
    let rendered_in = start.elapsed().as_secs_f64() - prepared_in;
    outputs.write(scene, &film, &mut say)?;
    say(&remarks::cost(plan.rays.camera, prepared_in, rendered_in))?;
    say(&remarks::coverage(&film))?;
    say(&remarks::blackness(&film))?;
    for warning in &prepared.warnings {
        say(&format!("warning: {}\n", super::info::escaped(warning)))?;
    }
    Ok(())
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

/// What `-o` says, or the scene's name with .png.
fn images(arguments: &RenderArguments) -> Vec<PathBuf> {
    if !arguments.output.is_empty() {
        return arguments.output.clone();
    }
    let stem = arguments.scene.scene.as_ref().and_then(|p| p.file_stem());
    // Not `with_extension`, which would take the ".9" of "approaching-0.9" for one.
    let mut name = stem.unwrap_or("nullray".as_ref()).to_os_string();
    name.push(".png");
    vec![name.into()]
}

fn isochrones(arguments: &RenderArguments, scene: &Scene) -> Option<Isochrones> {
    let path = arguments.isochrones.clone()?;
    let step = arguments
        .isochrone_step
        .map(|time| time.metres(scene.speed_of_light));
    Some(Isochrones { path, step })
}
