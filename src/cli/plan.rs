//! `nullray plan`.

use nullray::Result;
use nullray::render::plan::Plan;

use super::args::PlanArguments;
use super::{panels, print, print_json};

pub fn run(arguments: &PlanArguments) -> Result<()> {
    let path = arguments.scene.scene.as_deref();
    let overrides = arguments.scene.changes.overrides();
    let scene = panels::scene(path, arguments.panel.as_ref(), &overrides)?;
    let plan = Plan::new(&scene, &arguments.scene.request())?;
    match arguments.json {
        true => print_json(&plan),
        false => print(&plan.to_string()),
    }
}
