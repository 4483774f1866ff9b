//! Overlays: annotations drawn over a picture.
//!
//! | part | content |
//! |---|---|
//! | isochrones | lines of equal retarded time ct of the light's emission, labelled along the line |
//! | outlines | of every object, where it is seen (solid lines) and where it is (dashed lines); its name is placed where it is, or is seen |
//! | beta | the direction of the camera's motion in its picture: ⊗ ahead, ⊙ behind, an arrow at the edge if both are outside |
//! | legend | what the lines mean, the step of the isochrones, an angle to scale, and the camera's time |
//!
//! An object is *seen* where its light left it, in aberrated directions. It *is* at a position at the world time of the shot; a camera at
//! rest in the world at the same event would see it there, contracted to 1/γ along its motion, if light took no time ([`instantaneous`]).
//!
//! [`Overlay::trace`] finds all lines in pixels of the film, as data; [`Overlay::drawing`] draws them.
//!
//! ```text
//! apparent and instantaneous films → Overlay (polylines, labels, pointer) → Drawing → svg, pdf, png
//! ```

mod instant;
mod label;
mod legend;
mod name;
mod outline;
mod page;
mod parts;
mod pointer;
mod style;
mod times;

pub use instant::{CentredPicture, apparent, centred, instantaneous};
pub use outline::{Outline, outlines};
pub use page::{bytes, png_scale};
pub use parts::{Part, Parts};
pub use pointer::{Pointer, Target};
pub use times::{Isochrone, Isochrones};

use crate::camera::{AnyProjection, Camera, Projection as _};
use crate::error::{Error, Result};
use crate::render::aov::Aov;
use crate::scene::model::Scene;

/// A line in pixels of the film, with (0, 0) at its upper left corner; closed if its first point is its last.
pub type Polyline = Vec<[f64; 2]>;

/// The contents of an overlay.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Overlay {
    /// Columns and rows of the picture.
    pub size: [u32; 2],
    /// Lines of equal retarded time.
    pub isochrones: Option<Isochrones>,
    /// Where objects are seen.
    pub apparent: Vec<Outline>,
    /// Where objects are at the world time of the shot.
    pub instantaneous: Vec<Outline>,
    /// The object seen at the centre of each pixel, −1 for none; empty if outlines are not requested.
    pub objects_seen: Vec<i32>,
    /// The object there at the world time of the shot.
    pub objects_there: Vec<i32>,
    /// The names of objects, by their index.
    pub names: Vec<String>,
    /// The camera's direction of motion; `None` if it is at rest.
    pub pointer: Option<Pointer>,
    /// The contents of the legend below the picture.
    pub legend: Option<Facts>,
}

/// The contents of the legend beyond the lines.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Facts {
    /// Metres per second.
    pub speed_of_light: f64,
    /// The camera's proper time of the shot, metres.
    pub camera_time: f64,
    /// The tangent of half the horizontal field of view at the shot, camera frame.
    pub half_width: f64,
    /// The projection, if it bends straight lines.
    pub curved: Option<AnyProjection>,
}

impl Overlay {
    /// Whether an overlay can be drawn over pictures of `scene`.
    ///
    /// # Errors
    /// A stereo pair.
    pub fn check(scene: &Scene) -> Result<()> {
        match scene.camera.stereo {
            Some(_) => Err(Error::unsupported(
                &scene.name,
                "camera.stereo",
                "an overlay is drawn over one picture, but a stereo pair has two",
                "leave [camera.stereo] out, and draw over the picture of either eye",
            )),
            None => Ok(()),
        }
    }

    /// Finds the lines of `parts` of the [`apparent`] picture of `scene` and of its [`instantaneous`] one, as
    /// far as they are needed ([`Parts::needs`]); isochrones `step` metres apart, or at round numbers.
    ///
    /// Missing films and channels give no lines.
    ///
    /// # Errors
    /// A camera that is not on its world line at the time of the shot; a step that gives more than 1000
    /// isochrones.
    pub fn trace(
        scene: &Scene,
        apparent: Option<&CentredPicture>,
        instantaneous: Option<&CentredPicture>,
        parts: Parts,
        step: Option<f64>,
    ) -> Result<Overlay> {
        Overlay::check(scene)?;
        let camera = Camera::new(scene)?;
        let size = scene.camera.size;
        // The film of Bell's ships shows the direction of their motion where the projection of the scene does.
        let projection = camera.film().unwrap_or(camera.shot.projection.clone());
        let times = apparent.and_then(|seen| seen.film.aov(Aov::EventCt));
        let times = times.filter(|_| parts.has(Part::Isochrones));
        let isochrones = times.map(|ct| Isochrones::trace(size, ct, step));
        let outlined = |seen: Option<&CentredPicture>| {
            let seen = seen.filter(|_| parts.has(Part::Outlines));
            seen.map_or(Vec::new(), |seen| seen.outlines.clone())
        };
        let identities = |seen: Option<&CentredPicture>| {
            let seen = seen.filter(|_| parts.has(Part::Outlines));
            let ids = seen.and_then(|seen| seen.film.aov(Aov::Object));
            ids.map_or(Vec::new(), |ids| ids.iter().map(|id| *id as i32).collect())
        };
        let pointer = Pointer::of(&camera.shot, &projection);
        let facts = Facts {
            speed_of_light: scene.speed_of_light,
            camera_time: scene.camera.time,
            half_width: camera.half_width(&scene.camera),
            curved: Some(projection).filter(|projection| projection.linear().is_none()),
        };
        Ok(Overlay {
            size,
            isochrones: isochrones.transpose()?.flatten(),
            apparent: outlined(apparent),
            instantaneous: outlined(instantaneous),
            objects_seen: identities(apparent),
            objects_there: identities(instantaneous),
            names: scene.objects.iter().map(|o| o.name.clone()).collect(),
            pointer: pointer.filter(|_| parts.has(Part::Beta)),
            legend: parts.has(Part::Legend).then_some(facts),
        })
    }
}
