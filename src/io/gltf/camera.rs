//! Cameras of a file (glTF 2.0 §3.10): they look along their local −Z, with +Y up.

use ::gltf::json::camera::{Camera, Perspective, Type};
use ::gltf::json::validation::Checked;
use glam::{DAffine3, DVec3};

use super::document::Document;
use super::holders::{self, Held};
use super::nodes::Hierarchy;
use super::warnings::Warnings;
use crate::Result;

/// A perspective camera with its position and axes.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct GltfCamera {
    /// The pinhole, metres, in the coordinates of the file's root.
    pub eye: DVec3,
    /// Right, up, forward: orthonormal.
    pub axes: [DVec3; 3],
    /// Horizontal field of view, radians, if the file gives an aspect ratio: tan(h/2) = aspect · tan(v/2).
    pub horizontal_fov: Option<f64>,
    /// Vertical field of view, radians, in (0, π).
    pub vertical_fov: f64,
    /// Width divided by height, if the file gives it.
    pub aspect: Option<f64>,
}

const CAMERAS: Held = Held {
    noun: "camera",
    otherwise: "export the model with its cameras, or give eye, look_at and up",
    of: own_name,
};

fn own_name<'d>(document: &'d Document, node: usize) -> Option<&'d str> {
    let camera = document.root.get(document.root.nodes.get(node)?.camera?);
    let name = camera.and_then(|camera| camera.name.as_deref());
    Some(name.unwrap_or_default())
}

/// Names of the cameras.
pub(super) fn names(document: &Document) -> Vec<String> {
    holders::names(document, 0..document.root.nodes.len(), &CAMERAS)
}

/// The camera with this name, or the only one.
pub(super) fn find(document: &Document, name: Option<&str>) -> Result<GltfCamera> {
    let hierarchy = Hierarchy::new(document, &mut Warnings::default())?;
    let node = holders::find(document, &hierarchy, name, &CAMERAS)?;
    placed(document, node, hierarchy.world(node))
}

/// The camera of a node: glTF gives the vertical angle, and the horizontal one only if there is an aspect ratio.
fn placed(document: &Document, node: usize, world: DAffine3) -> Result<GltfCamera> {
    let place = document.node_label(node);
    let index = document.root.nodes.get(node).and_then(|node| node.camera);
    let camera = match index {
        Some(index) => document.get(index, "camera", &place)?,
        None => return Err(document.invalid(place, "the node has no camera", "")),
    };
    let perspective = perspective(document, camera, &place)?;
    let vertical_fov = f64::from(perspective.yfov);
    if !(vertical_fov > 0.0 && vertical_fov < std::f64::consts::PI) {
        let what = format!("the vertical field of view is {vertical_fov}");
        return Err(document.invalid(place, what, "yfov is in radians, between 0 and π"));
    }
    let aspect = perspective.aspect_ratio.map(f64::from);
    if aspect.is_some_and(|aspect| !(aspect > 0.0 && aspect.is_finite())) {
        let what = format!("the aspect ratio is {}", aspect.unwrap_or_default());
        return Err(document.invalid(place, what, "aspectRatio is above 0: width over height"));
    }
    let half_height = libm::tan(vertical_fov / 2.0);
    Ok(GltfCamera {
        eye: world.translation,
        axes: axes(document, world, &place)?,
        horizontal_fov: aspect.map(|aspect| 2.0 * libm::atan(aspect * half_height)),
        vertical_fov,
        aspect,
    })
}

fn perspective<'c>(
    document: &Document,
    camera: &'c Camera,
    place: &str,
) -> Result<&'c Perspective> {
    match (&camera.type_, &camera.perspective) {
        (Checked::Valid(Type::Perspective), Some(perspective)) => Ok(perspective),
        (Checked::Valid(Type::Orthographic), _) => Err(document.unsupported(
            place,
            "the camera is orthographic: its rays do not pass through one point",
            "use a perspective camera",
        )),
        _ => Err(document.invalid(
            place,
            "the camera is not described",
            "a camera of type \"perspective\" has a property \"perspective\"",
        )),
    }
}

fn axes(document: &Document, world: DAffine3, place: &str) -> Result<[DVec3; 3]> {
    let refused = || {
        document.invalid(
            place,
            "the camera's transform is singular or mirrors",
            "place cameras by rotation and translation",
        )
    };
    orthonormal(world).ok_or_else(refused)
}

/// Right, up, forward: −Z keeps its direction, +Y is made perpendicular to it; scale is removed. `None` for a transform that is singular or
/// mirrors.
pub(super) fn orthonormal(world: DAffine3) -> Option<[DVec3; 3]> {
    let axes = world.matrix3;
    let forward = unit(-axes.z_axis)?;
    let up = unit(unit(axes.y_axis)?.reject_from_normalized(forward))?;
    (axes.determinant() >= 0.0).then_some([forward.cross(up), up, forward])
}

/// `v` normalized; scaled first, since the square of a small number may underflow.
fn unit(v: DVec3) -> Option<DVec3> {
    let scale = v.abs().max_element();
    let v = (scale > 0.0 && scale.is_finite()).then(|| v / scale)?;
    Some(v / v.length())
}
