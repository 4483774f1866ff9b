//! The apparent positions of objects, and their positions at the world time of the shot: one ray through the centre of each pixel.
//!
//! With a refractive index of 0 a ray hits everything at one world time, t of the shot: along it the retarded event is P + s·(0, d). In the
//! rest frame of an object that moves at β this is a ray along which time passes, and it hits the object where that is in the world at t:
//! contracted to 1/γ. Directions of the camera frame are used as those of the world, so there is no aberration.

use super::{Outline, Parts, outlines};
use crate::camera::Camera;
use crate::error::Result;
use crate::render::aov::Aov;
use crate::render::film::{Film, Layout};
use crate::render::identities::objects_at;
use crate::render::prepare::Prepared;
use crate::render::progress::Progress;
use crate::render::render;
use crate::render::sampler::Sampler;
use crate::scene::model::{Equations, Scene};

/// A picture of one ray through the centre of each pixel.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct CentredPicture {
    /// The channels.
    pub film: Film,
    /// The outlines of objects, if requested.
    pub outlines: Vec<Outline>,
}

/// Renders the channels that `parts` need, with one ray through the centre of each pixel, so that lines do not depend on the sample
/// positions of the display's picture; `prepared` is not changed.
///
/// # Errors
/// [`Error::Cancelled`](crate::Error::Cancelled) when `progress` is cancelled.
pub fn apparent(
    prepared: &mut Prepared,
    parts: Parts,
    progress: &dyn Progress,
) -> Result<CentredPicture> {
    centred(prepared, parts.needs(), progress)
}

/// The picture of these channels at the centres of pixels; `prepared` is left as it was.
///
/// # Errors
/// As [`apparent`].
pub fn centred(
    prepared: &mut Prepared,
    channels: Vec<Aov>,
    progress: &dyn Progress,
) -> Result<CentredPicture> {
    let layout = Layout {
        samples: 1,
        pixel_centers: true,
        channels,
        ..prepared.layout.clone()
    };
    let layout = std::mem::replace(&mut prepared.layout, layout);
    let sampler = std::mem::replace(&mut prepared.sampler, Sampler::centred());
    let film = render(prepared, progress);
    (prepared.layout, prepared.sampler) = (layout, sampler);
    let film = film?;
    let outlines = match film.aov(Aov::Object) {
        Some(objects) => outlines(film.size(), objects, |points| {
            let seen = objects_at(prepared, points, progress)?.into_iter();
            Ok(seen.map(|object| object.map_or(-1.0, f64::from)).collect())
        })?,
        None => Vec::new(),
    };
    Ok(CentredPicture { film, outlines })
}

/// Takes the picture of identities ([`Aov::Object`]) without delay and aberration, one ray through the
/// centre of each pixel, of the same geometry: `prepared` is that of `scene`, and is left as it was.
///
/// The camera is a point at the event of the shot: a sensor or a shutter would look at several moments.
/// A focal length that is fixed in the world is taken as the world measures it.
///
/// # Errors
/// [`Error::Cancelled`](crate::Error::Cancelled) when `progress` is cancelled.
pub fn instantaneous(
    scene: &Scene,
    prepared: &mut Prepared,
    progress: &dyn Progress,
) -> Result<CentredPicture> {
    let mut scene = scene.clone();
    scene.equations = Equations::Exact;
    scene.effects.aberration = false;
    scene.effects.retardation = false;
    (scene.camera.sensor, scene.camera.shutter) = (None, None);
    let camera = std::mem::replace(&mut prepared.camera, Camera::new(&scene)?);
    let ray_index = std::mem::replace(&mut prepared.ray_index, 0.0);
    let seen = centred(prepared, vec![Aov::Object], progress);
    (prepared.camera, prepared.ray_index) = (camera, ray_index);
    seen
}
