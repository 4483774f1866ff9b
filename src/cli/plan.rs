//! `nullray plan`.

use nullray::Result;
use nullray::figures::overlay;
use nullray::render;
use nullray::render::plan::{Plan, Request};

use super::args::PlanArguments;
use super::progress::Bar;
use super::{print, print_json};

pub fn run(arguments: &PlanArguments) -> Result<()> {
    let scene = arguments.scene.load()?;
    let aovs = arguments.channels.list();
    let mut beside = arguments.method.bytes(aovs.len());
    if arguments.overlay {
        let parts = arguments.overlay_parts.unwrap_or_default();
        beside += overlay::bytes(scene.camera.size, parts);
    }
    let request = Request {
        aovs,
        beside,
        ..arguments.scene.changes.request()
    };
    let mut plan = Plan::new(&scene, &request)?;
    arguments.method.check(&plan)?;
    let bar = Bar::new(plan.rays.camera, arguments.json).named("what will be read".into());
    render::foretell(&scene, &mut plan, &bar)?;
    drop(bar);
    match arguments.json {
        true => print_json(&plan),
        false => print(&plan.to_string()),
    }
}
