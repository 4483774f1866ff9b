//! `nullray plan`.

use nullray::plan::Plan;
use nullray::scene::model::Scene;
use nullray::{Error, Result};

use super::args::PlanArguments;
use super::{builtin, panels, print};

pub fn run(arguments: &PlanArguments) -> Result<()> {
    let scene = scene(arguments)?;
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

/// The scene as it stands, or a panel of it.
fn scene(arguments: &PlanArguments) -> Result<Scene> {
    let path = arguments.scene.scene.as_deref();
    let overrides = arguments.scene.changes.overrides();
    let whole = builtin::load(path, &overrides)?;
    let chosen = panels::chosen(&whole, arguments.panel.as_slice())?;
    match (&arguments.panel, chosen.as_slice()) {
        (Some(_), [panel]) => builtin::load_panel(path, &whole, panel, &overrides),
        _ => Ok(whole),
    }
}
