//! Variants of one scene side by side: the panels of a figure, and their sheet.

#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A variant of the scene: a picture of its own.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// Unique, of letters, digits, dots, underscores and hyphens: part of file names.
    pub name: String,
    /// The text below it on a sheet.
    pub label: String,
    /// What its picture shows.
    pub show: Show,
    /// Whether it starts a new row of the sheet.
    pub new_row: bool,
    /// Dotted keys and the TOML text of their values, as [`Overrides::set`](crate::scene::Overrides::set) takes them.
    pub set: Vec<(String, String)>,
    /// A byte range of the scene text to point at in messages.
    pub span: std::ops::Range<usize>,
}

/// What a picture shows.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Show {
    /// Radiance, tone-mapped.
    #[default]
    Picture,
    /// Retarded times.
    Isochrones,
    /// Luminance, in colours by its logarithm.
    Luminance,
}

/// How panels are arranged on one page.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Sheet {
    /// Above the panels.
    pub title: Option<String>,
    /// Panels per row; `None` for as many as there are rows, or one more.
    pub columns: Option<u32>,
}
