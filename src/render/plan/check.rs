//! Numbers of a scene that no scene file can contain: a program that changes a [`Scene`] may set them.

use crate::error::{Error, Result, number};
use crate::mesh::shapes::Shape;
use crate::mesh::{Material, Mesh, MeshError};
use crate::scene::limits::{self, Wrong};
use crate::scene::model::{Geometry, LightKind, Object, Scene};

/// Refuses sizes, counts, indices and materials with which nothing can be rendered.
pub(super) fn check(scene: &Scene) -> Result<()> {
    let refuse =
        |place: &str, (what, help): Wrong| Err(Error::invalid(&scene.name, place, what, help));
    let camera = &scene.camera;
    let checks = [
        ("camera.size", limits::image_size(camera.size)),
        (
            "samples_per_pixel",
            limits::samples_per_pixel(scene.samples_per_pixel),
        ),
        ("bounces", limits::bounces(scene.bounces)),
        ("spectra", limits::spectra(scene)),
        ("medium_index", limits::medium_index(scene.medium_index)),
        ("camera.time", finite(camera.time)),
    ];
    for (place, check) in checks {
        if let Err(wrong) = check {
            return refuse(place, wrong);
        }
    }
    let (fov, projection) = (camera.horizontal_fov, camera.projection);
    if !limits::is_field_of_view(fov, projection) {
        let what = format!("a field of view of {fov} rad");
        let help = format!("above 0, and at most {} degrees", projection.widest());
        return refuse("camera.horizontal_fov", (what, help));
    }
    for light in &scene.lights {
        let emission = match &light.kind {
            LightKind::Lamp(lamp) => &lamp.emission,
            LightKind::Area { emission, .. } => emission,
        };
        if let Err(wrong) = limits::emission(emission) {
            return refuse(&format!("light \"{}\", emission", light.name), wrong);
        }
    }
    scene.objects.iter().try_for_each(|one| object(scene, one))
}

/// The same of an object.
fn object(scene: &Scene, object: &Object) -> Result<()> {
    let name = &object.name;
    let refuse =
        |place: String, (what, help): Wrong| Err(Error::invalid(&scene.name, place, what, help));
    match &object.geometry {
        Geometry::Mesh(mesh) => match mesh.check() {
            Err(MeshError { field, what, .. }) => refuse(
                format!("object \"{name}\", {field}"),
                (what, Mesh::CHECKED.into()),
            ),
            Ok(()) => Ok(()),
        },
        Geometry::Shape {
            shape: of,
            colour,
            metallic,
            roughness,
            transmission,
            ior,
        } => {
            let material = Material {
                metallic: *metallic,
                roughness: *roughness,
                transmission: *transmission,
                ior: *ior,
                ..Material::matte(*colour)
            };
            if let Err(MeshError { field, what, .. }) = material.check() {
                // Here the base colour is called by its name.
                let field = field.trim_start_matches("base_");
                return refuse(
                    format!("object \"{name}\", {field}"),
                    (what, Mesh::CHECKED.into()),
                );
            }
            let Err((field, wrong)) = shape(of) else {
                return Ok(());
            };
            refuse(format!("object \"{name}\", {field}"), wrong)
        }
        Geometry::Gltf { .. } => Ok(()),
    }
}

/// The invalid field of a shape, and what is wrong with it.
fn shape(shape: &Shape) -> Result<(), (&'static str, Wrong)> {
    let positive = |field, lengths: &[f64]| match lengths.iter().find(|x| !is_length(**x)) {
        Some(bad) => {
            let what = format!("{} m is not above 0", number(*bad));
            Err((field, (what, "give a length in metres, like 1".into())))
        }
        None => Ok(()),
    };
    match shape {
        Shape::Box { size } => positive("size", size),
        Shape::Plane { size } => positive("size", size),
        Shape::Sphere {
            radius,
            subdivisions,
        } => {
            positive("radius", &[*radius])?;
            limits::subdivisions(*subdivisions).map_err(|wrong| ("subdivisions", wrong))
        }
        Shape::Lattice {
            cells,
            spacing,
            bar,
        } => {
            positive("spacing", &[*spacing])?;
            positive("bar", &[*bar])?;
            limits::cells(*cells).map_err(|wrong| ("cells", wrong))
        }
    }
}

/// Whether a shape may have this length; false for NaN.
fn is_length(length: f64) -> bool {
    length > 0.0 && length.is_finite()
}

fn finite(value: f64) -> Result<(), Wrong> {
    match value.is_finite() {
        true => Ok(()),
        false => Err((format!("{value} is not finite"), "give a number".into())),
    }
}
