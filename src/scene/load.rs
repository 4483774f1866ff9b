//! From a file, or its text, to a scene.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use serde::de::DeserializeOwned;

use super::at::At;
use super::file;
use super::model::Scene;
use super::overrides::{self, Overrides};
use super::report::Report;
use super::resolve::{self, Context, Outline};
use crate::error::{Error, Result};
use crate::scene::schema::JsonSchema;

/// The longest scene file, bytes. Scenes name their data; they do not hold them.
const LONGEST: usize = 4 << 20;

/// Reads the scene file at `path`; relative paths in it resolve against its folder.
///
/// # Errors
/// [`Error::Io`] where the file cannot be read; [`Error::Invalid`] where it is not a scene, with the
/// place in it and what would be right. Files that it names are looked for, not read (except for the
/// pose of a glTF camera).
pub fn load(path: &Path, overrides: &Overrides) -> Result<Scene> {
    let name = path.display().to_string();
    parse(&text_of(path)?, &name, base(path), overrides)
}

/// The text of the scene file at `path`.
pub(crate) fn text_of(path: &Path) -> Result<String> {
    String::from_utf8(read(path)?).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        let help = "a scene is a TOML file in UTF-8";
        Error::invalid(path, format!("byte {at}"), "not UTF-8 text", help)
    })
}

/// The folder against which relative paths in the scene file at `path` resolve.
pub(crate) fn base(path: &Path) -> &Path {
    path.parent().unwrap_or(Path::new(""))
}

/// Reads the text of a scene called `name`; relative paths in it resolve against `base`.
///
/// # Errors
/// As [`load`].
pub fn parse(text: &str, name: &str, base: &Path, overrides: &Overrides) -> Result<Scene> {
    let report = report(text, name, overrides)?;
    let file = report.read()?;
    resolve::scene(report, base, &file)
}

/// Reads the text of a file whose `[diagram]` is a `D`; what it means is resolved by `resolve`, from what the
/// scene has of world lines. No mesh and no cube is looked for.
pub(crate) fn parse_diagram<D: DeserializeOwned + JsonSchema, T>(
    text: &str,
    name: &str,
    base: &Path,
    overrides: &Overrides,
    resolve: impl FnOnce(&Context, &Outline, Option<&At<D>>) -> Result<T>,
) -> Result<T> {
    let report = report(text, name, overrides)?;
    let file: file::Scene<D> = report.read()?;
    let cx = Context::new(report, base, &file.speed_of_light)?;
    resolve(&cx, &Outline::new(&cx, &file)?, file.diagram.as_ref())
}

/// The text of a scene, with its overrides.
fn report(text: &str, name: &str, overrides: &Overrides) -> Result<Report> {
    refuse_long(text.len(), name)?;
    let (text, edits) = overrides::apply(text, overrides)?;
    Ok(Report {
        name: name.to_string(),
        text: text.into(),
        edits,
    })
}

fn read(path: &Path) -> Result<Vec<u8>> {
    let file = File::open(path).map_err(Error::io(path, "cannot open"))?;
    let mut bytes = Vec::new();
    let mut start = file.take(LONGEST as u64 + 1);
    start
        .read_to_end(&mut bytes)
        .map_err(Error::io(path, "cannot read"))?;
    refuse_long(bytes.len(), path)?;
    Ok(bytes)
}

fn refuse_long(bytes: usize, name: impl AsRef<Path>) -> Result<()> {
    if bytes <= LONGEST {
        return Ok(());
    }
    let help = "a scene names its meshes and data; it does not hold them";
    let what = format!("a scene file is at most {} MiB long", LONGEST >> 20);
    Err(Error::invalid(name, "", what, help))
}
