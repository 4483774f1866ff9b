//! glTF and GLB 2.0 (Khronos, "glTF 2.0 Specification", ISO/IEC 12113:2022).
//!
//! Axes, units and winding are the file's, which are also ours: right-handed, +Y up, metres, counter-clockwise front faces, texture v = 0
//! at the top row. All node transforms are applied in f64; if a transform mirrors, the winding is reversed, so that front faces stay front
//! faces.
//!
//! The crate `gltf` parses the JSON. Buffers and images are read here, because that crate's readers trust counts and offsets. Here each is
//! checked against its container before anything is read, and only the bytes needed are read at all.
//!
//! Vertices are used unchanged, including denormal numbers, which f64 holds exactly. NaN and infinities are refused, or their triangles
//! dropped, as the scene specifies.
//!
//! Skins and morph targets place vertices at the poses and with the weights that the file itself gives.
//!
//! Not read, each with a warning if it would be visible: alpha blending, normal and occlusion maps, points and lines, animations, unknown
//! extensions. Unknown extensions that a file *requires* are refused.

mod accessor;
mod animation;
mod assemble;
mod buffers;
mod camera;
mod container;
mod document;
mod draft;
mod extensions;
mod glass;
pub(crate) mod glb;
mod holders;
mod images;
mod import;
mod instances;
mod lights;
mod materials;
mod morphs;
mod nodes;
mod pieces;
mod primitive;
mod skins;
mod summary;
mod transforms;
mod uri;
mod vertices;
mod warnings;

use std::path::Path;

pub use animation::GltfTrack;
pub use camera::GltfCamera;
pub(crate) use draft::{ANIMATIONS_UNREAD, CAMERAS_UNREAD, LIGHTS_UNREAD};
pub use glb::save;
pub use import::{BadTextures, BadVertices, EncodedImage, Imported, Want};
pub use lights::{GltfLight, GltfLightKind};
pub use summary::GltfSummary;

use crate::error::{Message, Result, Setting};
use document::Document;

/// Loads the triangles of the default scene of a `.gltf` or `.glb` file, or of the node named `node` and everything below it (placed as in
/// the whole scene).
///
/// # Errors
/// The file or one that it refers to cannot be read, or is not glTF 2.0; it requires an unknown extension; a count, offset or index is out
/// of range; a vertex is not finite (if these are refused); there are no triangles, or more than 2²⁶.
pub fn load(path: &Path, node: Option<&str>, want: Want) -> Result<Imported> {
    assemble::load(&mut Document::open(path)?, node, want)
}

/// Like [`load`], from bytes in memory; `name` stands for the file in messages. The document cannot refer to other files.
///
/// # Errors
/// As for [`load`].
pub fn load_bytes(bytes: &[u8], name: &str, node: Option<&str>, want: Want) -> Result<Imported> {
    assemble::load(&mut Document::from_bytes(bytes, name)?, node, want)
}

/// What [`load`] would read, from JSON and headers only: buffers and images need not exist, and no image is read but those that decide
/// whether surfaces are glass.
///
/// # Errors
/// As for [`load`], if they can be detected without reading data.
pub fn inspect(path: &Path, node: Option<&str>) -> Result<GltfSummary> {
    inspect_for(path, node, BadTextures::Refuse)
}

/// The same for an import that treats textures as `bad_textures` says.
///
/// # Errors
/// As for [`load`], if they can be detected without reading data.
pub fn inspect_for(
    path: &Path,
    node: Option<&str>,
    bad_textures: BadTextures,
) -> Result<GltfSummary> {
    summary::summary(&mut Document::open(path)?, node, bad_textures)
}

/// The lights of the default scene (KHR_lights_punctual), in the order of their nodes.
///
/// # Errors
/// The file cannot be read or is not glTF 2.0; a light does not exist, is not valid in glTF, or has no direction.
pub fn lights(path: &Path) -> Result<Vec<GltfLight>> {
    lights::all_shown(&Document::open(path)?)
}

/// The light named `node`: the name of a node that has a light, of a node with exactly one light below it, or of a light. Without a name,
/// the only light of the file.
///
/// # Errors
/// The file cannot be read or is not glTF 2.0; there is no such light, or more than one; it is not valid in glTF, or has no direction.
pub fn light(path: &Path, node: Option<&str>) -> Result<GltfLight> {
    lights::find(&Document::open(path)?, node)
}

/// The camera named `node`: the name of a node that has a camera, of a node with exactly one camera below it, or of a camera. Without a
/// name, the only camera of the file.
///
/// # Errors
/// The file cannot be read or is not glTF 2.0; there is no such camera, or more than one; the
/// camera is orthographic, or its transform is singular or mirrors.
pub fn camera(path: &Path, node: Option<&str>) -> Result<GltfCamera> {
    camera::find(&Document::open(path)?, node)
}

/// Refuses a file that refers to files outside its own folder, before any of them is read.
///
/// # Errors
/// It does; or it cannot be read or is not glTF 2.0.
pub(crate) fn refuse_outside(path: &Path) -> Result<()> {
    summary::refuse_outside(&Document::open(path)?, outside_help())
}

/// The remedy if a file refers to others outside its folder.
pub(crate) fn outside_help() -> Message {
    Message::from("put the file beside it, or allow this (")
        + Setting::AllowOutside
        + ") if you trust the file"
}

/// The path of the origin of the node named `node`, and how it turns, in the animation named `animation`, or else in the only one of the
/// file. The data may be in the file, or in its folder.
///
/// # Errors
/// The file cannot be read or is not glTF 2.0; there is no such node or animation, or more than one; the animation does not move the node,
/// or moves it in steps; its data are invalid.
pub fn track(path: &Path, node: &str, animation: Option<&str>) -> Result<GltfTrack> {
    animation::load(path, node, animation)
}
