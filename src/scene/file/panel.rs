//! `[sheet]` and every `[[panel]]`.

#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::scene::at::At;
use crate::scene::model::Show;

/// How the panels of the scene are arranged on one page.
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
    /// Panels per row, 1 to 100. Default: the same as the number of rows, or one more.
    pub columns: Option<At<u32>>,
}

/// A variant of the scene that is a separate picture, and a part of the scene's contact sheet.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table like { name = \"still\", set = { \"camera.time\" = \"2 ns\" } }"
)]
pub(in crate::scene) struct Panel {
    /// Unique name, of letters, digits, dots, underscores and hyphens: part of file names.
    pub name: At<String>,
    /// The text below the panel on a sheet. Default: the name.
    pub label: Option<At<String>>,
    /// What the panel shows: "picture", "isochrones" (the retarded times in colours, with a legend) or "luminance" (the luminance
    /// likewise, on a logarithmic scale). Default: "picture".
    #[serde(default)]
    pub show: Show,
    /// Whether it starts a new row of the sheet, however many panels are in the row before. Default: false.
    #[serde(default)]
    pub new_row: bool,
    /// The differences from the scene: dotted keys and their values, as --set takes them, like { "camera.velocity.beta" = [0, 0, -0.9] }.
    #[serde(default)]
    pub set: At<Changes>,
}

/// A table of any keys and values. They are read from the document itself, because only that distinguishes a dotted key from a table.
#[derive(Debug, Default, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(expecting = "a table like { \"camera.time\" = \"2 ns\" }")]
#[cfg_attr(feature = "schema", schemars(inline))]
pub(in crate::scene) struct Changes {}
