//! `[sheet]` and every `[[panel]]`.

#[cfg(feature = "schema")]
use std::borrow::Cow;
use std::fmt;

#[cfg(feature = "schema")]
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{IgnoredAny, MapAccess, Visitor};
use serde::ser::SerializeMap;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::scene::at::At;

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
    /// What the panel shows: "picture", or "isochrones" (the retarded times in colours, with a legend).
    /// Default: "picture".
    #[serde(default)]
    pub show: Show,
    /// What is different from the scene: dotted keys and their values, as --set takes them, like
    /// { "camera.velocity.beta" = [0, 0, -0.9] }.
    #[serde(default)]
    pub set: At<Changes>,
}

/// What a panel shows.
#[derive(Debug, Clone, Copy, Default, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
#[cfg_attr(feature = "schema", schemars(inline))]
pub(in crate::scene) enum Show {
    #[default]
    Picture,
    Isochrones,
}

/// A table of any keys and values. What they are is asked of the document itself: only there a dotted key
/// and a table are told apart.
#[derive(Debug, Default)]
pub(in crate::scene) struct Changes;

struct ChangesVisitor;

impl<'de> Visitor<'de> for ChangesVisitor {
    type Value = Changes;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a table like { \"camera.time\" = \"2 ns\" }")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Changes, A::Error> {
        while map.next_entry::<IgnoredAny, IgnoredAny>()?.is_some() {}
        Ok(Changes)
    }
}

impl<'de> Deserialize<'de> for Changes {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(ChangesVisitor)
    }
}

impl Serialize for Changes {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_map(Some(0))?.end()
    }
}

#[cfg(feature = "schema")]
impl JsonSchema for Changes {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "changes".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "type": "object" })
    }
}
