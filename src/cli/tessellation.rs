//! `nullray tessellation`.

use nullray::Result;
use nullray::approximate::raster::{Method, Raster, Tessellation};
use nullray::approximate::tessellation;
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;

use super::args::TessellationArguments;
use super::progress::Bar;
use super::{film, interrupt, panels, print, print_json};

pub fn run(arguments: &TessellationArguments) -> Result<()> {
    let path = arguments.scene.as_deref();
    let overrides = arguments.changes.overrides();
    let scene = panels::scene(path, arguments.panel.as_ref(), &overrides)?;
    let request = Request {
        pixel_centers: true,
        ..arguments.changes.request()
    };
    let plan = Plan::new(&scene, &request)?;
    Method::Raster(Raster::new(Tessellation::None)).check(&plan)?;
    film::in_pool(arguments.threads, || {
        let bar = Bar::new(plan.rays.camera, arguments.quiet);
        let prepared = Prepared::new(&scene, &plan, &bar)?;
        bar.start();
        let forecast = tessellation::forecast(&scene, &prepared, arguments.pixels, &bar)?;
        drop(bar);
        interrupt::check()?;
        match arguments.json {
            true => print_json(&forecast),
            false => print(&forecast.to_string()),
        }
    })
}
