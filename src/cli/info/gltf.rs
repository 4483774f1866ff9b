//! The contents of a glTF file, from its JSON alone.

use std::path::Path;

use glam::DVec3;
use nullray::Result;
use nullray::io::gltf::{self, BadTextures};
use nullray::render::plan::{count, count_of};
use serde_json::json;

use super::Info;

/// Rows to read, and the same as data for `--json`.
pub fn info(path: &Path) -> Result<Info> {
    let held = gltf::inspect_for(path, None, BadTextures::Drop)?;
    let mut info = Info::new("gltf", "glTF 2.0");
    if let Some(generator) = &held.generator {
        info.row("made by", generator);
    }
    info.data("generator", held.generator);
    for (what, n) in [("triangles", held.triangles), ("vertices", held.vertices)] {
        info.fact(what, count(n), what, n);
    }
    let primitives = count_of(held.primitives as u64, "primitive");
    let placed = format!("{}, placed as {primitives}", held.meshes);
    info.fact("meshes", placed, "meshes", held.meshes);
    info.data("primitives", held.primitives);
    if let Some([least, greatest]) = held.bounds {
        let (from, to, size) = (point(least), point(greatest), point(greatest - least));
        let text = format!("{from} to {to} (size {size}), metres, as the file declares them");
        info.row("bounds", text);
    }
    info.data(
        "bounds",
        json!(held.bounds.map(|b| b.map(|p| p.to_array()))),
    );
    info.names("nodes", held.nodes);
    info.names("cameras", held.cameras);
    info.names("lights", held.lights);
    info.names("animations", held.animations);
    let mut named = held.materials;
    if let Some(index) = held.default_material
        && let Some(name) = named.get_mut(index)
    {
        *name = "(the default of glTF, a white metal)".to_owned();
    }
    info.names("materials", named);
    if held.has_masks {
        info.row("holes", "by alpha masks");
    }
    info.data("has_masks", held.has_masks);
    if held.has_colours {
        info.row("colours", "of vertices");
    }
    info.data("has_colours", held.has_colours);
    info.names("unlit", held.unlit);
    let images = count_of(held.images as u64, "image");
    info.fact("textures", images, "images", held.images);
    info.fact("uv sets", held.uv_sets.to_string(), "uv_sets", held.uv_sets);
    info.list("file", &held.files, |path| there(path));
    let files: Vec<String> = held.files.iter().map(|p| p.display().to_string()).collect();
    info.data("files", files);
    info.list("warning", &held.warnings, String::clone);
    info.data("warnings", held.warnings);
    Ok(info)
}

fn point(p: DVec3) -> String {
    format!("({:.4}, {:.4}, {:.4})", p.x, p.y, p.z)
}

fn there(path: &Path) -> String {
    let note = if path.is_file() { "" } else { " (missing)" };
    format!("{}{note}", path.display())
}
