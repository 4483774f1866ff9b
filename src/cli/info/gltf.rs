//! What a glTF file holds, from its JSON alone.

use std::path::Path;

use glam::DVec3;
use nullray::Result;
use nullray::io::gltf;
use nullray::render::plan::count;
use serde_json::json;

use super::{Info, Sheet};

pub fn info(path: &Path) -> Result<Info> {
    let held = gltf::inspect(path, None)?;
    let mut sheet = Sheet::new();
    if let Some(generator) = &held.generator {
        sheet.row("made by", generator);
    }
    sheet.row("triangles", count(held.triangles));
    sheet.row("vertices", count(held.vertices));
    sheet.row(
        "meshes",
        format!("{}, placed as {} primitives", held.meshes, held.primitives),
    );
    if let Some([least, greatest]) = held.bounds {
        let size = greatest - least;
        let text = format!(
            "{} to {} (size {}), metres",
            point(least),
            point(greatest),
            point(size)
        );
        sheet.row("bounds", text);
    }
    sheet.names("nodes", &held.nodes);
    sheet.names("cameras", &held.cameras);
    sheet.names("materials", &held.materials);
    sheet.row("textures", format!("{} base colour images", held.images));
    sheet.row("uv sets", held.uv_sets.to_string());
    let files: Vec<String> = held.files.iter().map(|p| there(p)).collect();
    sheet.list("file", &files, String::clone);
    sheet.list("warning", &held.warnings, String::clone);
    let data = json!({
        "kind": "gltf",
        "generator": held.generator,
        "triangles": held.triangles,
        "vertices": held.vertices,
        "meshes": held.meshes,
        "primitives": held.primitives,
        "bounds": held.bounds.map(|b| b.map(|p| p.to_array())),
        "nodes": held.nodes,
        "cameras": held.cameras,
        "materials": held.materials,
        "images": held.images,
        "uv_sets": held.uv_sets,
        "files": held.files.iter().map(|p| p.display().to_string()).collect::<Vec<_>>(),
        "warnings": held.warnings,
    });
    Info::new(path, "glTF 2.0", sheet, &data)
}

fn point(p: DVec3) -> String {
    format!("({:.4}, {:.4}, {:.4})", p.x, p.y, p.z)
}

fn there(path: &Path) -> String {
    let note = if path.is_file() { "" } else { " (missing)" };
    format!("{}{note}", path.display())
}
