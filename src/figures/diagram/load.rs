//! From a scene file, or its text, to its diagram.

use std::path::Path;

use super::model::Diagram;
use super::resolve;
use crate::error::Result;
use crate::scene::{self, Overrides};

/// Reads the space-time diagram of the scene file at `path`: its `[diagram]`, or else one of the world lines of its scene. Does not read
/// meshes or cubes.
///
/// # Errors
/// As [`scene::load`].
pub fn load(path: &Path, overrides: &Overrides) -> Result<Diagram> {
    let name = path.display().to_string();
    parse(&scene::text_of(path)?, &name, scene::base(path), overrides)
}

/// As [`load`], from the text of a scene called `name`; relative paths in it resolve against `base`.
///
/// # Errors
/// As [`scene::load`].
pub fn parse(text: &str, name: &str, base: &Path, overrides: &Overrides) -> Result<Diagram> {
    scene::parse_diagram(text, name, base, overrides, resolve::resolve)
}

/// The JSON schema of a scene file with its `[diagram]`, made from the types that parse it: what [`scene::schema`] has to be.
#[cfg(feature = "schema")]
pub fn derived_schema() -> serde_json::Value {
    scene::derived_schema::<super::file::Diagram>()
}
