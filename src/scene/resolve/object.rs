//! Objects and their names.

use std::collections::HashMap;
use std::ops::Range;

use super::context::{Context, GLTF, NUMBERS};
use super::{shape, spectrum, transform, velocity};
use crate::colour::{Continuation, Spectrum};
use crate::error::{Result, number};
use crate::mesh::MOST_INDEX;
use crate::scene::at::At;
use crate::scene::file;
use crate::scene::model::{CoordinateFile, Geometry, Object};
use crate::scene::names;
use crate::scene::values::Number;
use crate::spacetime::units::quoted;
use crate::spacetime::{Event, Quantity};

/// All objects; `camera` is the place for the message about a scene without objects and sky; `spectral`: what radiance measures, and how
/// RGB continues if it is a spectrum.
pub(super) fn resolve_all(
    cx: &Context,
    objects: &[At<file::Object>],
    camera: &Range<usize>,
    has_sky: bool,
    spectral: (Quantity, Continuation),
) -> Result<Vec<Object>> {
    if objects.is_empty() && !has_sky {
        let what = "the scene has no object and no sky: there is nothing for this camera to see";
        let help = "add [[object]] with gltf = \"file.glb\" or shape = { box = { size = [1, 1, 1] } }, or [sky]";
        return Err(cx.report.refuse(camera, what, help));
    }
    refuse_duplicates(
        cx,
        objects.iter().filter_map(|at| at.value.name.as_ref()),
        "object",
    )?;
    // Default names yield to those in the file: `--set` and `objects` refer to either.
    let names = names::unique(objects.iter().map(|at| entry_names(&at.value)).collect());
    let named = objects.iter().zip(names);
    named
        .map(|(at, name)| resolve(cx, at, name, spectral))
        .collect()
}

/// Refuses a name that two objects, or two sources, share.
pub(crate) fn refuse_duplicates<'a>(
    cx: &Context,
    names: impl Iterator<Item = &'a At<String>>,
    thing: &str,
) -> Result<()> {
    let mut seen: HashMap<&str, &At<String>> = HashMap::new();
    for name in names {
        cx.text(name, "the name")?;
        if let Some(first) = seen.insert(&name.value, name) {
            let what = format!("two {thing}s are named {}", quoted(&name.value));
            let help = format!("give each {thing} a name of its own");
            let other = (&first.span, "first here");
            return Err(cx.report.refuse_two(&name.span, other, what, help));
        }
    }
    Ok(())
}

/// The name of an object in the file, and its default name.
pub(super) fn entry_names(object: &file::Object) -> (Option<String>, String) {
    let text = |at: &'_ Option<At<String>>| at.as_ref().map(|at| at.value.clone());
    let (gltf, node) = (text(&object.gltf), text(&object.node));
    let shape = object
        .shape
        .as_ref()
        .and_then(|shape| shape::kind(&shape.value));
    let default = names::object(gltf.as_deref(), node.as_deref(), shape);
    (text(&object.name), default)
}

fn resolve(
    cx: &Context,
    at: &At<file::Object>,
    name: String,
    spectral: (Quantity, Continuation),
) -> Result<Object> {
    let object = &at.value;
    let origin = &object.origin;
    Ok(Object {
        name,
        geometry: geometry(cx, at)?,
        spectrum: spectrum(cx, object, spectral)?,
        texture_coordinates: texture_coordinates(cx, object)?,
        transform: transform::resolve(cx, &object.transform)?,
        bad_vertices: object
            .bad_vertices
            .as_ref()
            .map(|at| at.value)
            .unwrap_or_default(),
        bad_textures: object
            .bad_textures
            .as_ref()
            .map(|at| at.value)
            .unwrap_or_default(),
        velocity: velocity::resolve(cx, &object.velocity)?,
        origin: Event::new(cx.time(&origin.time)?, origin.position.value.vec()),
        span: span(at),
    })
}

/// The spectrum that it emits in place of its base colours.
fn spectrum(
    cx: &Context,
    object: &file::Object,
    spectral: (Quantity, Continuation),
) -> Result<Option<Spectrum>> {
    cx.exclusive((&object.colour, "colour"), (&object.spectrum, "spectrum"))?;
    spectrum::resolve(cx, &object.spectrum, "an object", spectral)
}

fn texture_coordinates(cx: &Context, object: &file::Object) -> Result<Option<CoordinateFile>> {
    let Some(at) = &object.texture_coordinates else {
        return Ok(None);
    };
    let path = cx.path(&at.value.file, NUMBERS)?;
    // The name that `bake` writes; files of one array have none.
    let is_archive = path
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("npz"));
    let array = cx.optional_text(&at.value.array, "the array's name")?;
    Ok(Some(CoordinateFile {
        path,
        array: array.or_else(|| is_archive.then(|| "texture_coordinates".to_string())),
    }))
}

/// The place for messages: the name, or its substitute.
fn span(at: &At<file::Object>) -> Range<usize> {
    let object = &at.value;
    let name = object.name.as_ref().or(object.gltf.as_ref());
    let shape = || object.shape.as_ref().map(|shape| shape.span.clone());
    let span = name.map(|name| name.span.clone()).or_else(shape);
    span.unwrap_or_else(|| at.span.clone())
}

/// The mesh of an object: from a file, from memory, or a shape. Keys of one kind are refused beside another.
fn geometry(cx: &Context, at: &At<file::Object>) -> Result<Geometry> {
    let object = &at.value;
    cx.exclusive((&object.gltf, "gltf"), (&object.shape, "shape"))?;
    if let Some(gltf) = &object.gltf {
        let in_memory = cx.in_memory(gltf, |name| cx.inputs.memory.mesh(name))?;
        let own = match &in_memory {
            Some(_) => (&object.gltf, "mesh"),
            None => (&object.gltf, "gltf"),
        };
        // These describe the one material of a built-in shape; a mesh brings its own.
        cx.exclusive(own, (&object.colour, "colour"))?;
        cx.exclusive(own, (&object.metallic, "metallic"))?;
        cx.exclusive(own, (&object.roughness, "roughness"))?;
        cx.exclusive(own, (&object.transmission, "transmission"))?;
        cx.exclusive(own, (&object.ior, "ior"))?;
        if let Some(mesh) = in_memory {
            cx.exclusive(own, (&object.node, "node"))?;
            return Ok(Geometry::Mesh(mesh));
        }
        return Ok(Geometry::Gltf {
            path: cx.path(gltf, GLTF)?,
            node: cx.optional_text(&object.node, "the node's name")?,
        });
    }
    cx.exclusive((&object.shape, "shape"), (&object.node, "node"))?;
    // A built-in shape has neither nodes nor bad vertices or textures.
    let bad_vertices = (&object.bad_vertices, "bad_vertices");
    cx.exclusive((&object.shape, "shape"), bad_vertices)?;
    let bad_textures = (&object.bad_textures, "bad_textures");
    cx.exclusive((&object.shape, "shape"), bad_textures)?;
    let Some(shape) = &object.shape else {
        let help = "add gltf = \"file.glb\" or shape = { box = { size = [1, 1, 1] } }";
        return Err(cx.refuse(at, "this object has no geometry", help));
    };
    Ok(Geometry::Shape {
        shape: shape::resolve(cx, shape)?,
        colour: colour(cx, object)?,
        metallic: part(cx, &object.metallic, "metallic", 0.0)?,
        roughness: part(cx, &object.roughness, "roughness", 1.0)?,
        transmission: part(cx, &object.transmission, "transmission", 0.0)?,
        ior: ior(cx, &object.ior)?,
    })
}

/// A number from 0 to 1.
fn part(cx: &Context, at: &Option<At<Number>>, key: &str, default: f32) -> Result<f32> {
    let Some(at) = at else {
        return Ok(default);
    };
    match at.value.0 {
        part if (0.0..=1.0).contains(&part) => Ok(part as f32),
        part => {
            let what = format!("`{key}` is {}, which is not from 0 to 1", number(part));
            Err(cx.refuse(at, what, format!("give `{key}` from 0 to 1, like 0.3")))
        }
    }
}

/// A refractive index.
fn ior(cx: &Context, at: &Option<At<Number>>) -> Result<f32> {
    match at.as_ref().map(|at| (at, at.value.0)) {
        // Glass, the default of KHR_materials_ior.
        None => Ok(1.5),
        Some((_, ior)) if (1.0..=f64::from(MOST_INDEX)).contains(&ior) => Ok(ior as f32),
        Some((at, ior)) => {
            let what = format!(
                "`ior` is {}, which is not from 1 to {MOST_INDEX}",
                number(ior)
            );
            Err(cx.refuse(at, what, "give a refractive index, like 1.5"))
        }
    }
}

fn colour(cx: &Context, object: &file::Object) -> Result<[f32; 3]> {
    let colour = object.colour.as_ref();
    let colour = colour.map_or(Ok(file::Object::COLOUR.0), |colour| cx.colour(colour))?;
    Ok(colour.map(|c| c as f32))
}
