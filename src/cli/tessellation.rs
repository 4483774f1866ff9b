//! `nullray tessellation`.

use nullray::Result;
use nullray::approximate::raster::{Method, Raster, Tessellation};
use nullray::approximate::tessellation;
use nullray::render::plan::{Plan, Request};
use nullray::render::prepare::Prepared;

use super::args::TessellationArguments;
use super::console::{print, print_json};
use super::flags::with_flags;
use super::progress::Bar;
use super::{film, interrupt};

pub fn run(arguments: &TessellationArguments) -> Result<()> {
    let scene = arguments.scene.load()?;
    let request = Request {
        pixel_centers: true,
        ..arguments
            .scene
            .changes
            .request(arguments.work.threads.count)
    };
    let plan = Plan::new(&scene, &request)?;
    Method::Raster(Raster::new(Tessellation::None)).check(&plan)?;
    film::in_pool(arguments.work.threads.count, || {
        let bar = Bar::new(plan.rays.camera, arguments.work.quiet.on);
        let prepared = Prepared::new(&scene, &plan, &bar)?;
        bar.start();
        let forecast = tessellation::forecast(&scene, &prepared, arguments.pixels, &bar)?;
        drop(bar);
        interrupt::check()?;
        match arguments.json.on {
            true => print_json(&forecast),
            false => print(&with_flags(&forecast.report())),
        }
    })
}
