//! `nullray render`.

use std::path::PathBuf;
use std::time::Instant;

use nullray::approximate::raster::{self, Method};
use nullray::render::film::Film;
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;
use nullray::scene::model::Scene;
use nullray::{Error, Result, render};

use super::args::RenderArguments;
use super::failure::refused;
use super::frames::{self, Frames};
use super::output::{Outputs, check_all, check_statistics, suffixed, will_write};
use super::panels::{self, named_after};
use super::progress::Bar;
use super::stats::{Account, Preparation};
use super::{builtin, inputs, interrupt, overlay, print, remarks};

pub fn run(arguments: &RenderArguments) -> Result<()> {
    let overrides = arguments.scene.changes.overrides();
    let scene = builtin::load(arguments.scene.scene.as_deref(), &overrides)?;
    let outputs = outputs(arguments, &scene);
    let frames = Frames::of(&arguments.frames, &scene)?;
    let of_panels = !scene.panels.is_empty() || !arguments.panel.is_empty();
    if let Some(path) = &arguments.stats_json {
        let plan = Plan::new(&scene, &request(arguments, &outputs))?;
        check_statistics(path, &inputs::of(&scene, &plan))?;
    }
    let wanted = arguments.stats || arguments.stats_json.is_some();
    if wanted && arguments.method != Method::Trace {
        return Err(refused(
            "--stats",
            "counts what the ray tracer does",
            "leave out --method, or --stats",
        ));
    }
    let mut account = wanted.then(Account::default);
    in_pool(arguments.threads, || match frames {
        Some(_) if of_panels => Err(panels_and_frames()),
        Some(frames) => {
            let request = request(arguments, &outputs);
            let account = account.as_mut();
            frames::run(arguments, &scene, &frames, &request, &outputs, account)
        }
        None if of_panels => all_panels(arguments, &scene, &outputs, account.as_mut()),
        None => {
            let request = request(arguments, &outputs);
            one(
                &scene,
                &request,
                &outputs,
                arguments.quiet,
                account.as_mut(),
            )
        }
    })?;
    account.map_or(Ok(()), |account| settle(arguments, &account))
}

/// Says and writes what it has cost, as far as that is wanted.
fn settle(arguments: &RenderArguments, account: &Account) -> Result<()> {
    if arguments.stats {
        print(&account.table())?;
    }
    let Some(path) = &arguments.stats_json else {
        return Ok(());
    };
    will_write(path);
    account.write(path)?;
    match arguments.quiet {
        true => Ok(()),
        false => print(&format!("wrote {}\n", path.display())),
    }
}

fn request(arguments: &RenderArguments, outputs: &Outputs) -> Request {
    Request {
        aovs: outputs.needs(),
        ..arguments.scene.request()
    }
}

fn panels_and_frames() -> Error {
    refused(
        "--frames, --from",
        "a sequence is made of one scene, and this one has panels",
        "render the panels without frames, or give a scene without panels",
    )
}

/// Renders the panels that are asked for.
fn all_panels(
    arguments: &RenderArguments,
    whole: &Scene,
    outputs: &Outputs,
    mut account: Option<&mut Account>,
) -> Result<()> {
    let path = arguments.scene.scene.as_deref();
    let chosen = panels::chosen(whole, &arguments.panel)?;
    let scenes = panels::load_all(path, whole, &arguments.scene.changes.overrides())?;
    // With one panel and a name for it there is nothing to be told apart.
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
        jobs.push((request(arguments, &outputs), scene, outputs));
    }
    let mut read = Vec::new();
    for (request, scene, _) in &jobs {
        read.extend(inputs::of(scene, &Plan::new(scene, request)?));
    }
    check_all(jobs.iter().map(|(.., outputs)| outputs.clone()), &read)?;
    for (request, scene, outputs) in &jobs {
        let account = account.as_deref_mut();
        one(scene, request, outputs, arguments.quiet, account)?;
    }
    Ok(())
}

/// Renders one scene to its outputs; says what was written unless `quiet`, and notes the cost on `account`.
pub fn one(
    scene: &Scene,
    request: &Request,
    outputs: &Outputs,
    quiet: bool,
    account: Option<&mut Account>,
) -> Result<()> {
    let mut say = |text: &str| if quiet { Ok(()) } else { print(text) };
    let plan = Plan::new(scene, request)?;
    outputs.method.check(&plan)?;
    check_all([outputs.clone()], &inputs::of(scene, &plan))?;
    let mut rendered = film(scene, &plan, &outputs.method, quiet, account)?;
    outputs.write(scene, &rendered.film, &mut say)?;
    rendered.remark(&plan, &mut say)?;
    let Rendered { film, prepared, .. } = &mut rendered;
    overlay::write(outputs, scene, film, prepared, quiet)
}

/// A finished film, and what there is to say of it.
pub struct Rendered {
    pub film: Film,
    /// Seconds.
    prepared_in: f64,
    rendered_in: f64,
    warnings: Vec<String>,
    /// What was rendered, for more pictures of it.
    pub prepared: Prepared,
}

impl Rendered {
    /// Says what it cost, and what is odd.
    pub fn remark(&self, plan: &Plan, say: &mut dyn FnMut(&str) -> Result<()>) -> Result<()> {
        let rays = plan.rays.camera;
        say(&remarks::cost(rays, self.prepared_in, self.rendered_in))?;
        say(&remarks::coverage(&self.film, plan))?;
        say(&remarks::blackness(&self.film))?;
        for warning in &self.warnings {
            say(&format!("warning: {}\n", super::info::escaped(warning)))?;
        }
        Ok(())
    }
}

/// Loads, builds and renders, with a progress bar unless `quiet`.
pub fn film(
    scene: &Scene,
    plan: &Plan,
    method: &Method,
    quiet: bool,
    mut account: Option<&mut Account>,
) -> Result<Rendered> {
    let bar = Bar::new(plan.rays.camera, quiet);
    let start = Instant::now();
    let mut prepared = Prepared::new(scene, plan, &bar)?;
    let prepared_in = start.elapsed().as_secs_f64();
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
        rendered_in: start.elapsed().as_secs_f64() - prepared_in,
        warnings: std::mem::take(&mut prepared.warnings),
        prepared,
    })
}

/// Takes the picture of what is prepared, and notes what the ray tracer's cost on `account`.
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
    let pool = pool
        .map_err(|e| Error::invalid("command line", "--threads", e.to_string(), "fewer threads"))?;
    pool.install(work)
}

fn outputs(arguments: &RenderArguments, scene: &Scene) -> Outputs {
    let step = arguments.isochrone_step;
    Outputs {
        images: images(arguments),
        isochrones: arguments.isochrones.clone(),
        overlays: arguments.overlay.clone(),
        parts: arguments.overlay_parts.unwrap_or_default(),
        step: step.map(|time| time.metres(scene.speed_of_light)),
        aovs: arguments.scene.request().aovs,
        method: arguments.method,
        ..Outputs::default()
    }
}

/// What `-o` says, or the scene's name with .png.
fn images(arguments: &RenderArguments) -> Vec<PathBuf> {
    match arguments.output.as_slice() {
        [] => vec![named_after(arguments.scene.scene.as_deref(), ".png")],
        said => said.to_vec(),
    }
}
