//! `nullray plan`.

use nullray::Result;
use nullray::figures::overlay;
use nullray::render;
use nullray::render::plan::Request;

use super::args::PlanArguments;
use super::progress::Bar;
use super::{print, print_json, with_short_lines};

pub fn run(arguments: &PlanArguments) -> Result<()> {
    let scene = arguments.scene.load()?;
    let aovs = arguments.channels.list();
    let parts = arguments.lines.parts();
    let beside = match arguments.overlay {
        true => overlay::bytes(scene.camera.size, parts),
        false => 0,
    };
    let request = Request {
        aovs,
        beside,
        ..arguments.scene.changes.request()
    };
    let mut plan = arguments.method.method.plan(&scene, &request)?;
    let bar = Bar::new(plan.rays.camera, arguments.json.on).named("what will be read".into());
    render::foretell(&scene, &mut plan, &bar)?;
    drop(bar);
    match arguments.json.on {
        true => print_json(&plan),
        false => print(&with_short_lines(&plan.to_string())),
    }
}
