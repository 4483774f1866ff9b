//! The scene that a panel shows: the file's, with the panel's changes and then those of the command line.

use std::path::Path;
use std::str::FromStr;
use std::sync::Arc;

use toml_edit::DocumentMut;

use super::load::{self, base, text_of};
use super::memory::Memory;
use super::model::{Panel, Scene};
use super::overrides::{self, Overrides};
use super::report::Report;
use crate::error::{Error, Result};

/// Reads the scene of `panel`, one of those of `scene`, which was read from the file at `path`.
///
/// Changes are made in the order panel, `overrides`. The scene's text is one without panels that shows
/// the same.
///
/// # Errors
/// As [`load`](super::load); where the panel's own changes are wrong, with the place of the panel.
pub fn load_panel(
    path: &Path,
    scene: &Scene,
    panel: &Panel,
    overrides: &Overrides,
) -> Result<Scene> {
    parse_panel(&text_of(path)?, base(path), scene, panel, overrides)
}

/// As [`load_panel`], from the text of the file that `scene` was read from.
///
/// # Errors
/// As [`load_panel`].
pub fn parse_panel(
    text: &str,
    base: &Path,
    scene: &Scene,
    panel: &Panel,
    overrides: &Overrides,
) -> Result<Scene> {
    with_memory(text, base, &Memory::default(), scene, panel, overrides)
}

/// As [`parse_panel`], with meshes and cubes in memory.
pub(super) fn with_memory(
    text: &str,
    base: &Path,
    memory: &Memory,
    scene: &Scene,
    panel: &Panel,
    overrides: &Overrides,
) -> Result<Scene> {
    let changed = |overrides: &Overrides| {
        let report = changed(text, &scene.name, panel, overrides)?;
        load::scene(report, base, memory.clone())
    };
    changed(overrides).map_err(|error| match changed(&Overrides::default()) {
        // Without the command line all is well.
        Ok(_) => error,
        Err(error) => blame(scene, panel, error),
    })
}

/// The text with all changes made.
fn changed(text: &str, name: &str, panel: &Panel, overrides: &Overrides) -> Result<Report> {
    let of_panel = Overrides {
        set: panel.set.clone(),
        ..Overrides::default()
    };
    let (text, _) = overrides::apply(text, &of_panel)?;
    let (text, edits) = overrides::apply(&text, overrides)?;
    Ok(Report {
        name: name.to_string(),
        text: without_panels(&text),
        edits,
    })
}

/// The text without its panels and their sheet. One that is not TOML stays as it is.
fn without_panels(text: &str) -> Arc<str> {
    let Ok(mut document) = DocumentMut::from_str(text) else {
        return text.into();
    };
    document.remove("panel");
    document.remove("sheet");
    document.to_string().into()
}

/// The refusal of what `panel` sets, at its place in the file.
fn blame(scene: &Scene, panel: &Panel, error: Error) -> Error {
    let problem = match error {
        Error::Invalid(problem) => problem,
        other => return other,
    };
    let report = Report {
        name: scene.name.clone(),
        text: scene.text.as_str().into(),
        edits: Vec::new(),
    };
    let from_file = problem.file == scene.name && !problem.place.is_empty();
    let place = match from_file {
        true => format!("`{}`: ", problem.place),
        false => String::new(),
    };
    let what = format!("panel \"{}\": {place}{}", panel.name, problem.what);
    report.refuse(&panel.span, what, problem.help)
}
