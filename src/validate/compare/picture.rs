//! A picture to compare, and what its values are.

use serde::Serialize;

use crate::io::image::Layers;

/// What the values of a picture's light are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Encoding {
    /// Proportional to light, of any range.
    Linear,
    /// sRGB codes in [0, 1], as a display shows them. Errors are errors of codes; ꟻLIP decodes them.
    Srgb,
}

/// A picture and what is known of its file.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// For messages: the name of its file.
    pub name: String,
    /// What its light's values are.
    pub encoding: Encoding,
    /// Channels and metadata.
    pub layers: Layers,
    /// Channels that the file holds in half precision, which ends at 65504.
    pub half: Vec<String>,
}

/// Who made a picture, by its metadata.
pub(super) const METHOD: &str = "method";
/// Values of [`METHOD`] of ray-traced pictures, which need not say it.
const RAY_TRACED: [&str; 2] = ["nullray", "trace"];

impl Picture {
    /// A picture of linear light.
    pub fn linear(name: impl Into<String>, layers: Layers) -> Self {
        Picture {
            name: name.into(),
            encoding: Encoding::Linear,
            layers,
            half: Vec::new(),
        }
    }

    /// The value of a metadata entry.
    pub fn metadata(&self, key: &str) -> Option<&str> {
        let mut entries = self.layers.metadata.iter();
        entries
            .find(|(k, _)| k == key)
            .map(|(_, value)| value.as_str())
    }

    /// How the picture was made where that was an approximation (`method = "raster:uniform=0.05"`); none for one that
    /// was ray-traced, or says nothing of it.
    pub fn approximation(&self) -> Option<&str> {
        self.metadata(METHOD)
            .filter(|method| !RAY_TRACED.contains(method))
    }

    /// Whether the picture says that this program made it by tracing rays.
    pub(super) fn is_ray_traced(&self) -> bool {
        let ours = self
            .metadata("software")
            .is_some_and(|s| s.starts_with("nullray"));
        ours && self.approximation().is_none()
    }
}
