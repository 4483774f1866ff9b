//! Cameras: from a film point and a moment of the exposure to an event and a null ray of the world.
//!
//! A camera is a pinhole on a world line and a sensor. A sensor element at event E, with four-velocity
//! u, is reached by light that passed the pinhole at P: the event of the pinhole's world line on the
//! past light cone of E. The ray leaves P along the same line, and with k its null vector
//!
//! ```text
//! W = λ′/λ = (k·u_source)/(k·u)
//! ```
//!
//! for a source at rest in the world. Light in the camera travels in vacuum, whatever the medium.
//!
//! | view | camera | rays leave |
//! |---|---|---|
//! | [`Still`], [`Moving`], [`Unaberrated`] | a point (no sensor), at one camera time | one event |
//! | [`Inertial`] | without acceleration, with a sensor or a shutter | the pinhole's world line |
//! | [`Accelerated`] | on any world line, with a sensor or a shutter | the pinhole's world line |
//! | [`Turning`] | without acceleration, with a rotating sensor | the pinhole's world line |
//! | [`Stereo`] | two of these side by side | either of two events |
//! | [`Paper`] | by the equations of Jarabo et al. 2015 | one event, with their times |
//!
//! [`Projection`]s map film points to look directions: perspective, fisheyes, panoramas. Film points outside a fisheye's image circle see
//! nothing, so such cameras are [`Inertial`], whose rays have weights.
//!
//! A view's type contains only what the camera needs: a camera at rest has no boost, and one whose rays all leave the event of the shot
//! stores no origins ([`View::SHARED_ORIGIN`]).

#[doc = include_str!("guide.md")]
pub mod guide {}

mod accelerated;
mod any_projection;
mod any_view;
mod curved;
mod field;
mod inertial;
mod origin;
mod paper;
mod point;
mod projection;
mod rays;
mod shot;
mod stereo;
mod turning;

pub use accelerated::Accelerated;
pub use any_projection::AnyProjection;
pub use any_view::{AnyView, Camera, ViewKind};
pub use curved::{Equirectangular, Fisheye, Radial};
pub use inertial::Inertial;
pub use origin::RayOrigin;
pub use paper::Paper;
pub use point::{Moving, Point, Still, Unaberrated};
pub(crate) use projection::rotation_matrix;
pub use projection::{Linear, Perspective, Projection};
pub use rays::{FilmPoints, RaySlices};
pub use shot::Shot;
pub use stereo::Stereo;
pub use turning::Turning;

use crate::spacetime::{Direction, World};

/// The ray of one film point.
#[derive(Debug, Clone, Copy)]
pub struct CameraRay {
    /// The look direction in the world.
    pub d: Direction<World>,
    /// W for a source at rest in the world.
    pub ratio: f64,
    /// Where the ray leaves.
    pub origin: RayOrigin,
}

/// From film points to rays of the world.
pub trait View: Sync {
    /// Whether all rays leave the event of the shot, and none has an origin of its own.
    const SHARED_ORIGIN: bool;

    /// Whether rays depend on the moment of the exposure; not if the exposure is an instant.
    fn uses_time(&self) -> bool;

    /// The projection of its film points.
    fn film(&self) -> &AnyProjection;

    /// The ray of film point `(x, y)`, pixels, at the moment `moment` of the exposure, 0 to 1. `film` must be [`View::film`]'s
    /// projection; loops over many rays match on it once.
    fn ray_through<P: Projection>(&self, film: &P, x: f64, y: f64, moment: f64) -> CameraRay;

    /// The rays of many film points: a plain loop, compiled for wide vectors.
    #[inline(always)]
    fn rays<P: Projection>(&self, film: &P, points: &FilmPoints, mut rays: RaySlices)
    where
        Self: Sized,
    {
        rays.fill(self, film, points);
    }

    /// The ray of film point `(x, y)`, pixels, at the moment `moment` of the exposure, 0 to 1.
    #[inline]
    fn ray(&self, x: f64, y: f64, moment: f64) -> CameraRay {
        self.ray_through(self.film(), x, y, moment)
    }
}
