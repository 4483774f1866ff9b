//! The sky: light from all directions, from infinity, at rest in the world.

use std::path::PathBuf;

use glam::DVec3;

#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::colour::Spectrum;

/// Light from infinity; its parts add.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Sky {
    /// Radiance from all directions.
    pub background: SkyRadiance,
    /// A sun.
    pub sun: Option<Sun>,
    /// Stars.
    pub stars: Option<Stars>,
    /// Whether it lights surfaces.
    pub lights: bool,
    /// Whether surfaces cast shadows in its light.
    pub shadows: bool,
    /// A byte range of the scene text to point at in messages.
    pub span: std::ops::Range<usize>,
}

/// Radiance from all directions, by channel or by wavelength.
#[derive(Debug, Clone, PartialEq)]
pub enum SkyRadiance {
    /// The same everywhere.
    Uniform([f64; 3]),
    /// horizon + (zenith − horizon) (1 − (1 − h)⁴) at h = sin of the elevation above 0, ground below.
    Gradient {
        /// Straight up.
        zenith: [f64; 3],
        /// At elevation 0.
        horizon: [f64; 3],
        /// Below.
        ground: [f64; 3],
    },
    /// An equirectangular picture: row 0 is up, its middle is −Z, and +X is to the right of that.
    Image {
        /// `.exr` or `.hdr`, relative paths already resolved against the scene file.
        path: PathBuf,
        /// Factor on its radiance, by channel.
        scale: [f64; 3],
        /// The angle of rotation about +Y, radians, right-handed.
        rotation: f64,
        /// What to do with radiances below 0.
        negative: SkyNegative,
    },
    /// The same everywhere, with this spectrum.
    Spectrum(Spectrum),
}

/// What to do with radiances below 0 in the picture of a sky, as filters and merged exposures leave them: no light is below 0.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum SkyNegative {
    /// The picture is refused.
    #[default]
    Refuse,
    /// They become 0.
    Zero,
}

/// A disc of uniform radiance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sun {
    /// Unit vector towards its middle.
    pub direction: DVec3,
    /// Its irradiance on a perpendicular surface at rest in the world, by channel.
    pub irradiance: [f64; 3],
    /// Angular radius, radians.
    pub radius: f64,
}

/// Stars: discs of uniform radiance, of the colours of blackbodies.
#[derive(Debug, Clone, PartialEq)]
pub struct Stars {
    /// The catalogue.
    pub catalogue: Catalogue,
    /// Irradiance (luminance of the linear RGB) of a star of magnitude 0.
    pub scale: f64,
    /// Angular radius of each disc, radians.
    pub radius: f64,
}

/// The origin of the stars.
#[derive(Debug, Clone, PartialEq)]
pub enum Catalogue {
    /// A table `x,y,z,magnitude,temperature` (CSV), relative paths already resolved against the scene file.
    File(PathBuf),
    /// Random stars: isotropic, with magnitudes m distributed as in a uniformly filled space, N(<m) ∝ 10^(0.6 m), and temperatures 3000 K
    /// · 4^(u²) with u uniform in [0, 1).
    Random {
        /// Number of stars.
        count: u32,
        /// Seed of the random numbers.
        seed: u32,
        /// The magnitude of the faintest.
        faintest: f64,
    },
}

impl Sky {
    /// The file of its picture, if it has one.
    pub fn picture(&self) -> Option<&PathBuf> {
        match &self.background {
            SkyRadiance::Image { path, .. } => Some(path),
            SkyRadiance::Uniform(_) | SkyRadiance::Gradient { .. } | SkyRadiance::Spectrum(_) => {
                None
            }
        }
    }

    /// The files that it names.
    pub fn files(&self) -> impl Iterator<Item = &PathBuf> {
        let table = self
            .stars
            .as_ref()
            .and_then(|stars| match &stars.catalogue {
                Catalogue::File(path) => Some(path),
                Catalogue::Random { .. } => None,
            });
        self.picture().into_iter().chain(table)
    }
}

impl Sun {
    /// Its radiance: E/(π sin² ρ).
    pub fn radiance(&self) -> [f64; 3] {
        let sine = libm::sin(self.radius);
        self.irradiance
            .map(|e| e / (std::f64::consts::PI * sine * sine))
    }
}
