//! The request for an import, and its result.

#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::mesh::Mesh;

/// What to read besides positions and indices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Want {
    /// All texture coordinate sets. Without it, only those that textures need are read.
    pub uvs: bool,
    /// Base colours: the images of their textures, the coordinates that address them, and vertex colours.
    /// Those of materials with a mask are read anyway.
    pub textures: bool,
    /// Further material properties under lamps: its textures of metalness and roughness, and of emission.
    pub shading: bool,
    /// Normals of vertices, for reflection.
    pub normals: bool,
    /// What to do about positions, texture coordinates and normals that are not finite. Dropped triangles keep their numbers: their
    /// corners are collapsed to one point, so that no ray hits them.
    pub bad_vertices: BadVertices,
}

/// What was read.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Imported {
    /// The triangles, in the coordinates of the file's root, metres. Vertices of a primitive
    /// without a texture coordinate set that others have hold NaN in it, which
    /// [`Mesh::uv`] takes for none. Textures with transforms of their own
    /// (KHR_texture_transform) have their coordinates in further lists after the file's sets. Vertices without
    /// a colour that others have are white, and those without a normal that others have hold 0.
    pub mesh: Mesh,
    /// The number of texture coordinate sets in the file.
    pub uv_sets: usize,
    /// Encoded images of the materials in use, if requested; [`TextureRef::image`] counts these.
    ///
    /// [`TextureRef::image`]: crate::mesh::TextureRef::image
    pub images: Vec<EncodedImage>,
    /// Ignored features, a sentence each, with the place.
    pub warnings: Vec<String>,
}

/// What to do about vertices that are NaN or infinite, or too far away for a ray to hit.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum BadVertices {
    /// The file is refused.
    #[default]
    Refuse,
    /// Triangles with such a vertex are never visible, and are counted in a warning.
    Drop,
}

/// An image as stored in the file.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct EncodedImage {
    /// A PNG or JPEG file; only its first bytes have been looked at.
    pub bytes: Vec<u8>,
    /// Which of the two: "image/png" or "image/jpeg".
    pub media_type: &'static str,
    /// Where it stands, for messages: `image 2 "bricks"`.
    pub place: String,
}
