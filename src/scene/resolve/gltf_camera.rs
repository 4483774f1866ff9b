//! The pose of a camera from a glTF file.

use std::path::Path;

use glam::DVec3;

use crate::error::{Error, Result};

/// A camera as a glTF file describes it, in the world coordinates of that file.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct GltfCamera {
    /// The pinhole, metres.
    pub eye: DVec3,
    /// Orthonormal axes: right, up, forward.
    pub axes: [DVec3; 3],
    /// Horizontal field of view, radians, where the file gives an aspect ratio.
    pub horizontal_fov: Option<f64>,
    /// Vertical field of view, radians.
    pub vertical_fov: f64,
}

/// The camera of `node` in the glTF file at `path`; of its only camera without a node.
///
/// # Errors
/// [`Error::Unsupported`].
pub(super) fn resolve_gltf_camera(path: &Path, _node: Option<&str>) -> Result<GltfCamera> {
    let help = "give eye, look_at, up and hfov instead";
    let what = "cameras of glTF files are not read yet";
    Err(Error::unsupported(path, "", what, help))
}
