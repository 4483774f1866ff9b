//! `nullray tessellation`.

use nullray::approximate::raster::{Method, Raster, Tessellation};
use nullray::approximate::tessellation;
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;
use nullray::{Error, Result};

use super::args::TessellationArguments;
use super::progress::Bar;
use super::{builtin, interrupt, panels, print, render};

pub fn run(arguments: &TessellationArguments) -> Result<()> {
    let path = arguments.scene.as_deref();
    let overrides = arguments.changes.overrides();
    let whole = builtin::load(path, &overrides)?;
    let chosen = panels::chosen(&whole, arguments.panel.as_slice())?;
    let scene = match (&arguments.panel, chosen.as_slice()) {
        (Some(_), [panel]) => builtin::load_panel(path, &whole, panel, &overrides)?,
        _ => whole,
    };
    let request = Request {
        pixel_centers: true,
        ..arguments.changes.request()
    };
    let plan = Plan::new(&scene, &request)?;
    Method::Raster(Raster::new(Tessellation::None)).check(&plan)?;
    render::in_pool(arguments.threads, || {
        let bar = Bar::new(plan.rays.camera, arguments.quiet);
        let prepared = Prepared::new(&scene, &plan, &bar)?;
        bar.start();
        let forecast = tessellation::forecast(&scene, &prepared, arguments.pixels, &bar)?;
        drop(bar);
        interrupt::check()?;
        if !arguments.json {
            return print(&forecast.to_string());
        }
        let json = serde_json::to_string_pretty(&forecast).map_err(|e| {
            Error::invalid(
                &scene.name,
                "",
                e.to_string(),
                "a forecast that JSON can hold",
            )
        })?;
        print(&(json + "\n"))
    })
}
