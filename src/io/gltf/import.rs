//! The request for an import, and its result.

#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::mesh::Mesh;

/// What to read in addition to positions and indices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Want {
    /// All texture coordinate sets. Without it, only those that textures need are read.
    pub uvs: bool,
    /// Base colours: the images of their textures, the coordinates that address them, and vertex colours. Those of materials with a mask
    /// are always read.
    pub textures: bool,
    /// Further material properties for lighting: textures of metalness and roughness, and of emission.
    pub shading: bool,
    /// Vertex normals, for reflection.
    pub normals: bool,
    /// What to do about positions, texture coordinates and normals that are not finite. Dropped triangles keep their indices: their corners
    /// are collapsed to one point, so that no ray hits them.
    pub bad_vertices: BadVertices,
    /// What to do about textures that cannot be shown.
    pub bad_textures: BadTextures,
}

/// The imported mesh, with its images and warnings.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Imported {
    /// The triangles, in the coordinates of the file's root, metres. If a primitive lacks a texture coordinate set that others have, its
    /// vertices have NaN in it, which [`Mesh::uv`] treats as missing. The coordinates of textures with their own transforms
    /// (KHR_texture_transform) are in further lists after the file's sets. Likewise, vertices without a colour are white if others have
    /// colours, and vertices without a normal have 0 if others have normals.
    pub mesh: Mesh,
    /// The number of texture coordinate sets in the file.
    pub uv_sets: usize,
    /// Encoded images of the materials in use, if requested; [`TextureRef::image`] is an index into these.
    ///
    /// [`TextureRef::image`]: crate::mesh::TextureRef::image
    pub images: Vec<EncodedImage>,
    /// Ignored features, with their place, one sentence each.
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

/// What to do about textures whose image is missing or neither PNG nor JPEG.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum BadTextures {
    /// The file is refused.
    #[default]
    Refuse,
    /// The material has its factors alone, with a warning.
    Drop,
}

/// An image as stored in the file.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct EncodedImage {
    /// A PNG or JPEG file; only its first bytes have been checked.
    pub bytes: Vec<u8>,
    /// Either "image/png" or "image/jpeg".
    pub media_type: &'static str,
    /// Where it is in the file, for messages: `image 2 "bricks"`.
    pub place: String,
}
