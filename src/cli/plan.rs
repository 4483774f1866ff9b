//! `nullray plan`.

use nullray::plan::Plan;
use nullray::{Error, Result};

use super::args::PlanArguments;
use super::{builtin, print};

pub fn run(arguments: &PlanArguments) -> Result<()> {
    let scene = builtin::scene_or_builtin(&arguments.scene)?;
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
