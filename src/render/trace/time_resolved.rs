//! Emission and reflection in a scene whose light varies with time.

use std::sync::Arc;

use super::area_lights::AreaLights;
use super::base_colours::{BaseColour, BaseColours, Finish};
use super::emitted::Response;
use super::rest_frame::RestFrame;
use super::sky_light::SkyLight;
use super::spectral::SampledSpectra;
use super::surface_point::EmissionClock;
use crate::io::cube::Bricks;
use crate::light::lamp::Lamp;
use crate::light::time_texture::{Capture, TimeTexture};
use crate::scene::model::CaptureChoice;

/// All kinds of emitters, some of which vary with time.
#[derive(Debug)]
pub struct TimeResolved {
    /// By emitter index.
    pub emitters: Vec<(Emitter, Response)>,
    /// Base colours (also albedos of surfaces lit by lamps).
    pub base: BaseColours,
    /// Cubes with their time axes.
    pub cubes: Vec<TimeTexture>,
    /// The index in the scene of the source of each cube.
    pub cube_sources: Vec<usize>,
    /// How several captures of one surface are combined.
    pub choice: CaptureChoice,
    /// Capture cameras and what they saw.
    pub captures: Vec<Capture>,
    /// Pulses by source of the scene, then the scene's lights without extent.
    pub lamps: Vec<Option<Lamp>>,
    /// Shining surfaces.
    pub areas: Option<Box<AreaLights>>,
    /// Objects that are area lights, and the index of each light, counted like `lamps`.
    pub area_lights: Vec<(u32, usize)>,
    /// The sky, if it lights the scene.
    pub sky: Option<SkyLight>,
    /// How reflected light is sampled at wavelengths; `None` if it is computed in red, green and blue.
    pub spectra: Option<SampledSpectra>,
    /// Refractive index of the medium.
    pub index: f64,
    /// Whether the camera sees the light that lit surfaces emit by themselves; it falls on others in any case.
    pub shows_emission: bool,
}

impl TimeResolved {
    /// Whether all light on the objects at rest in `rest`, the only frame of the scene, is constant in time.
    pub(super) fn is_steady_for(&self, rest: &RestFrame) -> bool {
        let velocity = rest.frame.velocity();
        // In a streaming medium, light does not take the same time both ways; this case is not supported.
        let is_still = self.index == 1.0 || velocity.is_rest();
        let steady = |colour: &BaseColour| colour.profile.is_none();
        let emits = |(emitter, _): &(Emitter, Response)| match emitter {
            Emitter::Base(colour) => steady(&self.base.colours[*colour]),
            Emitter::Lit { finish, .. } => finish.emission.as_ref().is_none_or(steady),
            Emitter::Uv { .. } | Emitter::Captured(_) => false,
        };
        let mut lamps = self.lamps.iter().flatten();
        is_still
            && self.emitters.iter().all(emits)
            && lamps.all(|lamp| lamp.is_constant_for(velocity))
            && !self.areas.as_ref().is_some_and(|areas| areas.changes())
    }

    /// Whether surfaces that reflect light emit some by themselves.
    pub(crate) fn emits(&self) -> bool {
        self.emitters.iter().any(|(emitter, _)| match emitter {
            Emitter::Lit { finish, .. } => finish.emission.is_some(),
            Emitter::Base(_) | Emitter::Uv { .. } | Emitter::Captured(_) => false,
        })
    }

    /// The emission of `finish` that the camera sees.
    #[inline]
    pub(super) fn shown_emission<'a>(&self, finish: &'a Finish) -> Option<&'a BaseColour> {
        finish.emission.as_ref().filter(|_| self.shows_emission)
    }

    /// Whether all reflection is diffuse.
    pub(super) fn is_diffuse(&self) -> bool {
        self.emitters.iter().all(|(emitter, _)| match emitter {
            Emitter::Lit { finish, .. } => finish.gloss.is_none() && finish.glass.is_none(),
            Emitter::Base(_) | Emitter::Uv { .. } | Emitter::Captured(_) => true,
        })
    }

    /// The cubes that are read from disk, without repetitions.
    pub(crate) fn on_disk(&self) -> impl Iterator<Item = &Bricks> {
        let bricks = |at: usize| self.cubes[at].cube().on_disk();
        let is_first = move |at: &usize| {
            let mut earlier = (0..*at).filter_map(bricks);
            bricks(*at).is_some_and(|own| !earlier.any(|other| Arc::ptr_eq(other, own)))
        };
        let first = (0..self.cubes.len()).filter(is_first);
        first.filter_map(move |at| bricks(at).map(Arc::as_ref))
    }
}

/// The source of the radiance of a patch.
#[derive(Debug, Clone)]
pub enum Emitter {
    /// A base colour.
    Base(usize),
    /// A cube in texture coordinates.
    Uv {
        /// Index of the cube.
        cube: usize,
        /// The cubes of its infrared and ultraviolet, if they are visible.
        companions: [Option<usize>; 2],
        /// TEXCOORD set.
        set: usize,
        /// The clock of its time axis.
        clock: EmissionClock,
    },
    /// Cubes projected from their capture cameras, one or more.
    Captured(Vec<CapturedCube>),
    /// Reflected light of lamps, shining surfaces and the sky.
    Lit {
        /// How the surface reflects.
        finish: Box<Finish>,
        /// The lamps that light it.
        lamps: Vec<usize>,
    },
}

/// A cube and the camera that captured it.
#[derive(Debug, Clone, Copy)]
pub struct CapturedCube {
    /// Index of the cube.
    pub cube: usize,
    /// The cubes of its infrared and ultraviolet, if they are visible.
    pub companions: [Option<usize>; 2],
    /// Index of the capture camera.
    pub capture: usize,
    /// The clock of the cube before the delay to the capture camera.
    pub clock: EmissionClock,
}
