//! Numbers of a scene that no scene file can have: a program that changes a [`Scene`] may leave them there.

use crate::error::{Error, Result};
use crate::mesh::shapes::Shape;
use crate::scene::model::{Geometry, MOST_SAMPLES, Object, Scene};

/// Refuses sizes, counts and indices with which nothing can be rendered.
pub(super) fn check(scene: &Scene) -> Result<()> {
    let refuse =
        |place: &str, what: String, help: &str| Err(Error::invalid(&scene.name, place, what, help));
    let [width, height] = scene.camera.size;
    let area = u64::from(width) * u64::from(height);
    if width.max(height) > 65_536 || !(1..=1 << 28).contains(&area) {
        let what = format!("a picture of {width} × {height} pixels");
        return refuse("camera.size", what, "each 1 to 65536, together at most 2²⁸");
    }
    let samples = scene.samples_per_pixel;
    if !(1..=MOST_SAMPLES).contains(&samples) {
        let what = format!("{samples} samples per pixel");
        return refuse("samples_per_pixel", what, "from 1 to 65536");
    }
    // In this form also for NaN.
    let fov = scene.camera.horizontal_fov;
    if !(fov > 0.0 && fov.is_finite()) {
        let what = format!("a field of view of {fov} rad");
        return refuse("camera.horizontal_fov", what, "above 0");
    }
    let index = scene.medium_index;
    if !(index >= 1.0 && index.is_finite()) {
        let what = format!("a refractive index of {index}");
        return refuse("medium_index", what, "1 for vacuum, or more");
    }
    scene
        .objects
        .iter()
        .try_for_each(|object| shape(scene, object))
}

/// The same of an object.
fn shape(scene: &Scene, object: &Object) -> Result<()> {
    let refuse = |what: String, help: &str| {
        let place = format!("object \"{}\"", object.name);
        Err(Error::invalid(&scene.name, place, what, help))
    };
    match &object.geometry {
        Geometry::Mesh(mesh) => match mesh.check() {
            Err(error) => refuse(
                format!("{}: {}", error.field, error.what),
                "arrays of a mesh must fit each other",
            ),
            Ok(()) => Ok(()),
        },
        Geometry::Shape { shape, .. } => match shape {
            Shape::Sphere { subdivisions, .. } if *subdivisions > 8 => refuse(
                format!("{subdivisions} subdivisions would be 20·4^{subdivisions} triangles"),
                "0 to 8",
            ),
            Shape::Lattice { cells, .. } if !cells.iter().all(|n| (1..=64).contains(n)) => refuse(
                format!("a lattice of {cells:?} cells"),
                "1 to 64 along each axis",
            ),
            _ => Ok(()),
        },
        Geometry::Gltf { .. } => Ok(()),
    }
}
