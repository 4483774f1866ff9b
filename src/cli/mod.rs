//! One thin file per command; [`run`] shows the whole program.

mod args;
mod bake;
mod builtin;
mod caption;
mod check;
mod compare;
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

use std::borrow::Cow;
use std::collections::BTreeSet;
use std::io::{self, ErrorKind, Write};
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

use clap::Parser;
use nullray::io::npy::Dtype;
use nullray::{Error, Result};
use serde::Serialize;

use args::{Arguments, Command};
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

/// `text` without terminal escapes or characters that change the writing direction; line breaks and tabs are kept. File names, names in
/// files and metadata are untrusted.
fn harmless(text: &str) -> Cow<'_, str> {
    let is_harmful =
        |c: char| c.is_control() && !matches!(c, '\n' | '\t') || info::is_reordering(c);
    if !text.contains(is_harmful) {
        return text.into();
    }
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match is_harmful(c) {
            true => out.extend(c.escape_default()),
            false => out.push(c),
        }
    }
    out.into()
}

/// `text` with long lines cut.
fn with_short_lines(text: &str) -> String {
    const LONGEST: usize = 2000;
    let lines = text.split_inclusive('\n');
    let lines = lines.map(|line| match line.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}…\n", &line[..end]),
        None => line.to_string(),
    });
    lines.collect()
}

/// Whether a film goes to standard output.
static CARRIES_FILM: AtomicBool = AtomicBool::new(false);

/// Keeps standard output free for a film: from now on messages are not written, and results that options request go to standard error.
fn keep_for_film() {
    CARRIES_FILM.store(true, Ordering::Relaxed);
}

fn carries_film() -> bool {
    CARRIES_FILM.load(Ordering::Relaxed)
}

/// Prints `text` on standard output. A closed pipe ("nullray info … | head") is not an error: the work continues.
fn print(text: &str) -> Result<()> {
    if carries_film() {
        complain(text);
        return Ok(());
    }
    write_to(io::stdout().lock(), &harmless(text))
}

/// Prints a styled text on standard output, in colour if that is supported.
fn print_styled(text: &str) -> Result<()> {
    write_to(anstream::stdout().lock(), text)
}

fn write_to(mut out: impl Write, text: &str) -> Result<()> {
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Error::io("standard output", "cannot write")(error))
        }
        _ => Ok(()),
    }
}

/// Prints `text` unless `quiet`, or unless a film goes to standard output.
fn say(quiet: bool, text: &str) -> Result<()> {
    match quiet || carries_film() {
        true => Ok(()),
        false => print(text),
    }
}

/// Writes warnings to standard error unless `quiet`, each once: a model is loaded to frame it, to expose it, and to render it.
fn warn<'a>(quiet: bool, warnings: impl IntoIterator<Item = &'a String>) {
    static TOLD: Mutex<BTreeSet<String>> = Mutex::new(BTreeSet::new());
    let mut told = TOLD.lock().unwrap_or_else(PoisonError::into_inner);
    let news = |text: &&String| !quiet && told.insert((*text).clone());
    for text in warnings.into_iter().filter(news) {
        complain(&format!("warning: {}\n", info::escaped(text)));
    }
}

/// The warning about light in numbers too small for their type, if it is more than a hundredth of all.
fn faint((part, dtype): (f64, &Dtype), help: &str) -> Option<String> {
    let name = match dtype {
        Dtype::F16 => "f16",
        Dtype::F64 => "f64",
        Dtype::F32 | Dtype::Other(_) => "f32",
    };
    (part > 0.01).then(|| {
        format!(
            "{:.1} % of the light is in numbers below {:.1e}, of which {name} holds few digits or none; {help}",
            100.0 * part,
            dtype.smallest_normal()
        )
    })
}

/// Prints `value` as JSON.
fn print_json(value: &impl Serialize) -> Result<()> {
    let help = "leave --json out; numbers that JSON cannot represent are a bug";
    let text = serde_json::to_string_pretty(value);
    let text = text.map_err(|e| failure::refused("--json", e.to_string(), help))?;
    print(&(escaped_json(&text) + "\n"))
}

/// A JSON text in whose strings all characters that are not [`harmless`] are escaped by number.
fn escaped_json(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match u32::from(c) {
            // Line breaks are layout: those in strings are already escaped.
            code if code != 10 && (c.is_control() || info::is_reordering(c)) => {
                out.push_str(&format!("\\u{code:04x}"));
            }
            _ => out.push(c),
        }
    }
    out
}

/// Writes `text` to standard error, if there is one.
fn complain(text: &str) {
    complain_styled(&harmless(text));
}

/// Writes a styled text to standard error, in colour if that is supported.
fn complain_styled(text: &str) {
    let _ = anstream::stderr().lock().write_all(text.as_bytes());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_that_is_printed_steers_a_terminal() {
        assert_eq!(harmless("a\tb\nγ = 1 × 2"), "a\tb\nγ = 1 × 2");
        assert_eq!(
            harmless("\u{1b}[2J\u{9b}m\u{202e}\r"),
            "\\u{1b}[2J\\u{9b}m\\u{202e}\\r"
        );
        let value = serde_json::json!({ "name": "\u{9b}\u{202e}\u{7f}\u{1b}é" });
        let text = escaped_json(&serde_json::to_string_pretty(&value).unwrap());
        assert!(!text.contains(|c: char| c.is_control() && c != '\n' || info::is_reordering(c)));
        assert_eq!(
            serde_json::from_str::<serde_json::Value>(&text).unwrap(),
            value
        );
    }
}
