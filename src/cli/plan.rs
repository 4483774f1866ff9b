//! `nullray plan`.

use nullray::render::plan::Plan;
use nullray::{Error, Result};

use super::args::PlanArguments;
use super::{panels, print};

pub fn run(arguments: &PlanArguments) -> Result<()> {
    let path = arguments.scene.scene.as_deref();
    let overrides = arguments.scene.changes.overrides();
    let scene = panels::scene(path, arguments.panel.as_ref(), &overrides)?;
    let plan = Plan::new(&scene, &arguments.scene.request())?;
    if !arguments.json {
        return print(&plan.to_string());
    }
    let json = serde_json::to_string_pretty(&plan).map_err(|e| {
        Error::invalid(
            &scene.name,
            "plan",
            e.to_string(),
            "a plan that JSON can hold",
        )
    })?;
    print(&(json + "\n"))
}
