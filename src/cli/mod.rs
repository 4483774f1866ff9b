//! One thin file per command; [`run`] shows the whole program.

mod args;
mod bake;
mod builtin;
mod caption;
mod check;
mod compare;
mod console;
mod convert;
mod demo;
mod diagram;
mod export;
mod exposure;
mod failure;
mod film;
mod flags;
mod flash;
mod frames;
mod help;
mod info;
mod inputs;
mod interrupt;
mod memory;
mod mesh_from_depth;
mod motion;
mod names;
mod output;
mod overlay;
mod page;
mod panels;
mod passes;
mod plan;
mod preview;
mod progress;
mod reel;
mod reference;
mod remarks;
mod render;
mod selftest;
mod sheet;
mod stats;
mod study;
mod tessellation;
mod times;
mod values;

use std::process::ExitCode;

use clap::Parser;
use nullray::Result;

use args::{Arguments, Command};
use console::print_styled;
use failure::Done;

/// Parses the command line, runs the command, and reports errors.
pub fn run() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        // Help and version are not errors, and may be long.
        Err(said) if !said.use_stderr() => {
            let text = said.render().ansi().to_string();
            return failure::outcome(|| print_styled(&text).map(|()| Done::Well));
        }
        Err(said) => return failure::of_command_line(said),
    };
    interrupt::install();
    failure::outcome(|| carry_out(arguments.command))
}

fn carry_out(command: Option<Command>) -> Result<Done> {
    let done = match command {
        Some(Command::Compare(compare)) => return compare::run(&compare),
        None => demo::run(),
        Some(Command::Render(mut render)) => {
            render.flash.add_to(&mut render.changes);
            render::run(*render)
        }
        Some(Command::Film(film)) => motion::run(*film),
        Some(Command::Page(page)) => page::run(&page),
        Some(Command::Sheet(sheet)) => sheet::run(&sheet),
        Some(Command::Bake(bake)) if bake.flash.flash => flash::bake(&bake),
        Some(Command::Bake(mut bake)) => {
            bake.flash.add_to(&mut bake.scene.changes);
            bake::run(&bake)
        }
        Some(Command::Diagram(diagram)) => diagram::run(*diagram),
        Some(Command::Export(export)) => export::run(&export),
        Some(Command::Convert(convert)) => convert::run(&convert),
        Some(Command::MeshFromDepth(mesh)) => mesh_from_depth::run(&mesh),
        Some(Command::Plan(plan)) => plan::run(&plan),
        Some(Command::Tessellation(forecast)) => tessellation::run(&forecast),
        Some(Command::Info(info)) => info::run(&info),
        Some(Command::Selftest(selftest)) => return selftest::run(&selftest),
        Some(Command::Study(study)) => study::run(&study),
        Some(Command::Schema) => reference::schema(),
        Some(Command::Completions { shell }) => reference::completions(shell),
        Some(Command::Man { directory }) => reference::man(directory.as_deref()),
    };
    done.map(|()| Done::Well)
}
