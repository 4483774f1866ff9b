//! Checks the files of several pictures before the first is rendered.

use std::collections::HashSet;
use std::path::PathBuf;

use super::{geometry, sky};
use crate::error::Result;
use crate::io::cube;
use crate::io::gltf::Want;
use crate::io::image::Texture;
use crate::render::plan::{Plan, PlannedObject};
use crate::render::progress::Progress;
use crate::scene::model::{CubeData, Geometry, Object, Scene, SourceKind};

/// The largest cube that is read completely to check it, bytes; for larger ones the header was checked.
const LARGEST: u64 = 1 << 28;

/// Reads the files that the pictures of `jobs` load, and drops them again, so that a broken file of a later picture is not found hours
/// after the first was started. The files of the first are checked when it is prepared; each other file is read once.
///
/// # Errors
/// Broken files, and [`Error::Cancelled`](crate::Error::Cancelled) when `progress` says so.
pub fn check_files<'a>(
    jobs: impl IntoIterator<Item = (&'a Scene, &'a Plan)>,
    progress: &dyn Progress,
) -> Result<()> {
    let mut seen = HashSet::new();
    for (index, (scene, plan)) in jobs.into_iter().enumerate() {
        // Different declarations lead to different reads; none is read twice the same way.
        let mut is_new = |what: String| seen.insert(what) && index > 0;
        for (object, planned) in scene.objects.iter().zip(&plan.objects) {
            progress.check()?;
            let want = geometry::want(scene, object, planned);
            if let Some(key) = key(object, want)
                && is_new(key)
            {
                mesh(scene, object, planned, want, plan.memory_left())?;
            }
        }
        for (source, planned) in scene.sources.iter().zip(&plan.cubes) {
            progress.check()?;
            let (SourceKind::Cube(cube), Some(planned)) = (&source.kind, planned) else {
                continue;
            };
            let CubeData::File(file) = &cube.data else {
                continue;
            };
            if is_new(format!("{file:?} {:?} {:?}", cube.channels, cube.negative))
                && planned.bytes <= LARGEST
            {
                let wanted = cube.wanted(file);
                cube::load(&file.path, wanted.within(plan.memory_limit))?;
            }
        }
        let files = scene.sky.iter().flat_map(|sky| sky.files());
        let files: Vec<&PathBuf> = files.collect();
        if !files.is_empty() && is_new(format!("{files:?}")) {
            sky::load(scene, plan)?;
        }
    }
    Ok(())
}

/// A key that identifies the mesh of an object, if it has files.
fn key(object: &Object, want: Want) -> Option<String> {
    let coordinates = &object.texture_coordinates;
    match &object.geometry {
        Geometry::Gltf { path, node } => {
            Some(format!("{path:?} {node:?} {coordinates:?} {want:?}"))
        }
        Geometry::Shape { .. } | Geometry::Mesh(_) => {
            coordinates.as_ref().map(|file| format!("{file:?}"))
        }
    }
}

fn mesh(
    scene: &Scene,
    object: &Object,
    planned: &PlannedObject,
    want: Want,
    memory: u64,
) -> Result<()> {
    let (_, images) = geometry::object_mesh(scene, object, want, &mut Vec::new())?;
    let unnamed = PathBuf::new();
    let file = planned.file.as_ref().unwrap_or(&unnamed);
    images.into_iter().try_for_each(|image| {
        Texture::decode_within(&image.bytes, &image.place, file, memory).map(drop)
    })
}
