//! The files that a command reads, which it must not overwrite.

use std::path::{Path, PathBuf};

use nullray::io::cube;
use nullray::io::{colmap, files};
use nullray::render::plan::{Plan, Request};
use nullray::scene::model::{Geometry, Scene, SourceKind};

/// All files that `scene` and `plan` name, including sources that light no surface.
pub fn of(scene: &Scene, plan: &Plan) -> Vec<PathBuf> {
    let meshes = plan
        .objects
        .iter()
        .flat_map(|o| o.file.iter().chain(&o.files).cloned());
    with(scene, meshes)
}

/// Like [`of`], for a scene that may not be renderable: if it cannot be planned, the files beside its meshes are unknown.
pub fn of_any(scene: &Scene) -> Vec<PathBuf> {
    match Plan::new(scene, &Request::default()) {
        Ok(plan) => of(scene, &plan),
        Err(_) => {
            let meshes = scene.objects.iter().filter_map(|o| match &o.geometry {
                Geometry::Gltf { path, .. } => Some(path.clone()),
                _ => None,
            });
            with(scene, meshes)
        }
    }
}

/// All files that `scene` names, and `meshes`.
fn with(scene: &Scene, meshes: impl Iterator<Item = PathBuf>) -> Vec<PathBuf> {
    let cubes = scene.sources.iter().filter_map(|s| match &s.kind {
        SourceKind::Cube(cube) => cube.data.path(),
        SourceKind::Pulse(_) => None,
    });
    let cubes = cubes.flat_map(|path| cube::files(path).unwrap_or_default());
    let coordinates = scene.objects.iter().filter_map(|o| {
        let file = o.texture_coordinates.as_ref()?;
        Some(file.path.clone())
    });
    let sky = scene.sky.iter().flat_map(|sky| sky.files().cloned());
    let read = scene.read.iter().flat_map(|path| match path.is_dir() {
        true => colmap::files(path),
        false => vec![path.clone()],
    });
    let named = cubes
        .chain(read)
        .chain(meshes)
        .chain(coordinates)
        .chain(sky)
        .filter(|p| !p.starts_with(files::BUILT_IN));
    // The built-in scene has a name, but no file.
    std::iter::once(PathBuf::from(&scene.name))
        .chain(named)
        .collect()
}

/// One name per file, whether it exists or not: follows links and resolves `.` and `..`.
pub fn identity(path: &Path) -> PathBuf {
    if let Ok(path) = path.canonicalize() {
        return path;
    }
    let directory = directory(path).canonicalize().unwrap_or_default();
    directory.join(path.file_name().unwrap_or_default())
}

/// The directory that a file is in.
pub fn directory(path: &Path) -> &Path {
    let parent = path.parent().filter(|d| !d.as_os_str().is_empty());
    parent.unwrap_or(Path::new("."))
}
