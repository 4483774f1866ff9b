//! `[sheet]` and every `[[panel]]`.

#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::scene::at::At;
use crate::scene::model::Show;

/// How the panels of the scene are put on one page.
#[derive(Debug, Default, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    default,
    deny_unknown_fields,
    expecting = "a table like { title = \"Faster and faster\" }"
)]
pub(in crate::scene) struct Sheet {
    /// A line above the panels.
    pub title: Option<At<String>>,
    /// Panels side by side, 1 to 100. Default: as many as there are rows, or one more.
    pub columns: Option<At<u32>>,
}

/// A variant of the scene that is a picture of its own, and a part of the scene's contact sheet.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { name = \"still\", set = { \"camera.time\" = \"2 ns\" } }"
)]
pub(in crate::scene) struct Panel {
    /// Unique name, of letters, digits, dots, underscores and hyphens: part of the names of files.
    pub name: At<String>,
    /// What stands beneath the panel on a sheet. Default: the name.
    pub label: Option<At<String>>,
    /// What the panel shows: "picture", "isochrones" (the retarded times in colours, with a legend) or "luminance" (the same of
    /// the luminance, by its logarithm).
    /// Default: "picture".
    #[serde(default)]
    pub show: Show,
    /// Whether it begins a row of the sheet, however many panels are in the row before. Default: false.
    #[serde(default)]
    pub new_row: bool,
    /// What is different from the scene: dotted keys and their values, as --set takes them, like
    /// { "camera.velocity.beta" = [0, 0, -0.9] }.
    #[serde(default)]
    pub set: At<Changes>,
}

/// A table of any keys and values. What they are is asked of the document itself: only there a dotted key
/// and a table are told apart.
#[derive(Debug, Default, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(expecting = "a table like { \"camera.time\" = \"2 ns\" }")]
#[cfg_attr(feature = "schema", schemars(inline))]
pub(in crate::scene) struct Changes {}
