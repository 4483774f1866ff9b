//! The scene of a panel: the file's, with the panel's changes and then the overrides.

use std::str::FromStr;
use std::sync::Arc;

use toml_edit::DocumentMut;

use super::load::{self, SceneFile};
use super::model::{Panel, Scene};
use super::overrides::{self, Overrides};
use super::report::Report;
use super::text::Text;
use crate::error::{Error, Message, Result};

impl SceneFile {
    /// The scene of `panel`, one of the panels of `scene`, which was made from this file.
    ///
    /// Changes are made in the order panel, `overrides`. The scene's text is an equivalent one without panels.
    ///
    /// # Errors
    /// As [`load`](super::load()); if the panel's own changes are wrong, with the place of the panel.
    pub fn panel(&self, scene: &Scene, panel: &Panel, overrides: &Overrides) -> Result<Scene> {
        let of_panel = Overrides {
            allow_outside: overrides.allow_outside,
            ..Overrides::default()
        };
        self.changed(panel, overrides)
            .map_err(|error| match self.changed(panel, &of_panel) {
                // Without the overrides there is no error.
                Ok(_) => error,
                Err(error) => blame(scene, panel, error),
            })
    }

    fn changed(&self, panel: &Panel, overrides: &Overrides) -> Result<Scene> {
        let of_panel = Overrides {
            set: panel.set.clone(),
            ..Overrides::default()
        };
        let (text, _) = overrides::apply(&self.text, &of_panel)?;
        let (text, edits) = overrides::apply(&text, overrides)?;
        let report = Report {
            name: self.name.clone(),
            text: Text {
                edited: without_panels(&text),
                file: self.text.as_str().into(),
            },
            edits,
        };
        load::scene(report, self, overrides.allow_outside)
    }
}

/// The text without its panels and their sheet. A text that is not TOML is returned unchanged.
fn without_panels(text: &str) -> Arc<str> {
    let Ok(mut document) = DocumentMut::from_str(text) else {
        return text.into();
    };
    document.remove("panel");
    document.remove("sheet");
    document.to_string().into()
}

/// The error for what `panel` sets, at its place in the file.
fn blame(scene: &Scene, panel: &Panel, error: Error) -> Error {
    let problem = match error {
        Error::Invalid(problem) => problem,
        other => return other,
    };
    let report = Report {
        name: scene.name.clone(),
        text: scene.text_and_file(),
        edits: Vec::new(),
    };
    let from_file = problem.file == scene.name && !problem.place.is_empty();
    let place = match from_file {
        true => format!("`{}`: ", problem.place),
        false => String::new(),
    };
    let what = Message::from(format!("panel \"{}\": {place}", panel.name)) + problem.what;
    report.refuse(&panel.span, what, problem.help)
}
