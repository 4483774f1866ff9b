//! glTF and GLB 2.0 (Khronos, "glTF 2.0 Specification", ISO/IEC 12113:2022).
//!
//! Axes, units and winding are the file's, which are also ours: right-handed, +Y up, metres,
//! counter-clockwise front faces, texture v = 0 at the top row. All node transforms are applied in
//! f64; a mirroring one turns the winding, so that front faces stay front faces.
//!
//! The crate `gltf` parses the JSON. Buffers and images are read here, because that crate's readers
//! trust counts and offsets: here each is checked against what it lies in before anything is read,
//! and only the bytes that are wanted are read at all.
//!
//! Vertices are taken as they are, denormal numbers too, which f64 holds exactly. NaN and infinities are
//! refused, or their triangles dropped, as the scene says.
//!
//! Not read, each with a warning where it would be seen: skins, morph targets, blending by alpha, normal
//! and occlusion maps, points and lines, animations, extensions that are not known. Extensions that a file
//! *requires* and that are not known here are refused.

mod accessor;
mod animation;
mod assemble;
mod buffers;
mod camera;
mod container;
mod document;
mod draft;
mod extensions;
pub(crate) mod glb;
mod images;
mod import;
mod instances;
mod lights;
mod materials;
mod nodes;
mod pieces;
mod primitive;
mod summary;
mod uri;
mod vertices;
mod warnings;

use std::path::Path;

pub use animation::GltfTrack;
pub use camera::GltfCamera;
pub(crate) use draft::{ANIMATIONS_UNREAD, LIGHTS_UNREAD};
pub use glb::save;
pub use import::{BadVertices, EncodedImage, Imported, Want};
pub use lights::{GltfLight, GltfLightKind};
pub use summary::GltfSummary;

use crate::error::{Message, Result, Setting};
use document::Document;

/// The triangles of the default scene of a `.gltf` or `.glb` file, or of the node called `node`
/// and all below it (placed as in the whole scene).
///
/// # Errors
/// The file or one that it refers to cannot be read, or is not glTF 2.0; it requires an extension
/// that is not known; any count, offset or index is out of range; a vertex is not finite (where these are
/// refused); there
/// are no triangles, or more than 2²⁶.
pub fn load(path: &Path, node: Option<&str>, want: Want) -> Result<Imported> {
    assemble::load(&mut Document::open(path)?, node, want)
}

/// As [`load`], from bytes in memory; `name` stands for the file in messages. The document cannot
/// refer to other files.
///
/// # Errors
/// As for [`load`].
pub fn load_bytes(bytes: &[u8], name: &str, node: Option<&str>, want: Want) -> Result<Imported> {
    assemble::load(&mut Document::from_bytes(bytes, name)?, node, want)
}

/// What [`load`] would read, from JSON and headers only: no buffer or image is read, nor need they
/// be there.
///
/// # Errors
/// As for [`load`], as far as it shows without reading data.
pub fn inspect(path: &Path, node: Option<&str>) -> Result<GltfSummary> {
    summary::summary(&Document::open(path)?, node)
}

/// The lights of the default scene (KHR_lights_punctual), in the order of their nodes.
///
/// # Errors
/// The file cannot be read or is not glTF 2.0; a light that is not there, is not of glTF, or has no direction.
pub fn lights(path: &Path) -> Result<Vec<GltfLight>> {
    lights::find(&Document::open(path)?)
}

/// The camera called `node` (the name of a node that has a camera, of the only one with a camera below
/// it, or of a camera); without a name, the only camera of the file.
///
/// # Errors
/// The file cannot be read or is not glTF 2.0; there is no such camera, or more than one; the
/// camera is orthographic, or its transform is singular or mirrors.
pub fn camera(path: &Path, node: Option<&str>) -> Result<GltfCamera> {
    camera::find(&Document::open(path)?, node)
}

/// Refuses a file that refers to others outside its own folder, before any of them is read.
///
/// # Errors
/// It does, or it cannot be read or is not glTF 2.0.
pub(crate) fn refuse_outside(path: &Path) -> Result<()> {
    summary::refuse_outside(&Document::open(path)?, outside_help())
}

/// What to do where a file refers to others outside its folder.
pub(crate) fn outside_help() -> Message {
    Message::from("put the file beside it, or allow this (")
        + Setting::AllowOutside
        + ") if you trust the file"
}

/// The way of the origin of the node called `node`, by the animation called `animation`, or else by the only one of the file.
/// Its data lie in the file, or in its folder.
///
/// # Errors
/// The file cannot be read or is not glTF 2.0; there is no such node or animation, or more than one; the animation does not
/// move the node, or in steps; its data are not sound.
pub fn track(path: &Path, node: &str, animation: Option<&str>) -> Result<GltfTrack> {
    animation::load(path, node, animation)
}
