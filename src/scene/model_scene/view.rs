//! How a model without a scene is seen.

use std::path::PathBuf;

use glam::DVec3;

/// How to look at a model without a scene.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ModelView {
    /// The camera's speed v/c. Default: at rest, and 0.5 for a fly-by.
    pub beta: Option<f64>,
    /// The direction of its motion. Default: along +x.
    pub direction: Option<Heading>,
    /// Whether it passes by, in a sequence of [`ModelView::FLYBY_FRAMES`] pictures.
    pub flyby: bool,
    /// Columns and rows of the picture. Default: 640 × 480.
    pub size: Option<[u32; 2]>,
    /// Whether the model may refer to files outside its own folder.
    pub allow_outside: bool,
    /// The flash whose light in flight is shown, if any.
    pub flash: Option<Flash>,
}

impl ModelView {
    /// The number of pictures of a fly-by or a flash.
    pub const FLYBY_FRAMES: u64 = 48;
    /// The default speed of a fly-by: passing objects appear rotated by 30° and change their hue.
    pub(super) const FLYBY_SPEED: f64 = 0.5;
}

/// The direction of motion of a camera that looks at a model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Heading {
    /// Along this vector, which must not be 0.
    Along(DVec3),
    /// Towards the model.
    Towards,
    /// Away from the model.
    Away,
}

/// A flash of light on a model.
#[derive(Debug, Clone, PartialEq)]
pub struct Flash {
    /// Number of reflections after the first.
    pub bounces: u32,
    /// The `.npz` file for the baked light. With a floor there are two files, with `-model` and `-floor` in their names.
    pub file: PathBuf,
}

impl Flash {
    /// The file for the light on this object.
    pub(super) fn of(&self, object: &str, has_floor: bool) -> String {
        if !has_floor {
            return self.file.display().to_string();
        }
        let stem = self.file.file_stem().unwrap_or_default().to_string_lossy();
        let name = self.file.with_file_name(format!("{stem}-{object}.npz"));
        name.display().to_string()
    }
}

/// From the model to the camera: in front (+z, as in glTF), somewhat to the right and above.
pub(super) const VIEWPOINT: DVec3 = DVec3::new(0.5, 0.35, 1.0);
