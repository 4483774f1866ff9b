//! `nullray plan`.

use nullray::Result;
use nullray::render::plan::{Plan, Request};

use super::args::PlanArguments;
use super::{print, print_json};

pub fn run(arguments: &PlanArguments) -> Result<()> {
    let request = Request {
        aovs: arguments.channels.list(),
        ..arguments.scene.changes.request()
    };
    let plan = Plan::new(&arguments.scene.load()?, &request)?;
    match arguments.json {
        true => print_json(&plan),
        false => print(&plan.to_string()),
    }
}
