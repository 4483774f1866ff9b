//! All projections that a scene can name. To add one, write a file for it and add a row here.

use glam::{DMat3, DVec3};

use super::curved::{Equirectangular, Fisheye, Radial};
use super::projection::{Linear, Perspective, Projection};
use crate::accel::vectors::Block;
use crate::scene::model::{CameraModel, CaptureCamera, ProjectionKind};

/// Any of the projections.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum AnyProjection {
    /// Through a pinhole onto a plane.
    Perspective(Perspective),
    /// Circles about the forward axis stay circles.
    Fisheye(Fisheye),
    /// Longitudes and latitudes.
    Equirectangular(Equirectangular),
}

impl AnyProjection {
    /// The projection of an unrotated camera.
    pub fn new(model: &CameraModel) -> Self {
        let [width, height] = model.size.map(f64::from);
        let eyes = if model.stereo.is_some() { 2.0 } else { 1.0 };
        let size = [width / eyes, height];
        AnyProjection::of_kind(model.projection, model.axes, model.horizontal_fov, size)
    }

    /// The projection of this kind with unit axes right, up and forward, a horizontal field of view in
    /// radians, and `size` in columns and rows.
    pub fn of_kind(kind: ProjectionKind, axes: [DVec3; 3], fov: f64, size: [f64; 2]) -> Self {
        let fisheye = |radial| AnyProjection::Fisheye(Fisheye::new(radial, axes, fov, size));
        match kind {
            ProjectionKind::Perspective => {
                AnyProjection::Perspective(Perspective::new(axes, fov, size))
            }
            ProjectionKind::FisheyeEquidistant => fisheye(Radial::Equidistant),
            ProjectionKind::FisheyeEquisolid => fisheye(Radial::Equisolid),
            ProjectionKind::FisheyeOrthographic => fisheye(Radial::Orthographic),
            ProjectionKind::Equirectangular => {
                AnyProjection::Equirectangular(Equirectangular::new(axes, fov, size))
            }
        }
    }

    /// The projection of the whole film of a capture camera whose cube has `size` columns and rows.
    pub(crate) fn of_capture(camera: &CaptureCamera, size: [usize; 2]) -> Self {
        let (fov, film) = (camera.horizontal_fov(size), camera.film(size));
        AnyProjection::of_kind(camera.projection, camera.axes, fov, film)
    }

    /// Whether some film points see nothing; if any do, a corner does.
    pub(crate) fn has_blind_points(&self) -> bool {
        self.corners().into_iter().any(|[x, y]| !self.sees(x, y))
    }

    /// The same with `stretch` times the focal length: the field of view narrows.
    #[must_use]
    pub fn stretched(&self, stretch: f64) -> Self {
        match self {
            AnyProjection::Perspective(p) => AnyProjection::Perspective(p.stretched(stretch)),
            AnyProjection::Fisheye(p) => AnyProjection::Fisheye(p.stretched(stretch)),
            AnyProjection::Equirectangular(p) => {
                AnyProjection::Equirectangular(p.stretched(stretch))
            }
        }
    }

    /// The same with rotated axes.
    #[must_use]
    pub fn turned(&self, turn: DMat3) -> Self {
        match self {
            AnyProjection::Perspective(p) => AnyProjection::Perspective(p.turned(turn)),
            AnyProjection::Fisheye(p) => AnyProjection::Fisheye(p.turned(turn)),
            AnyProjection::Equirectangular(p) => AnyProjection::Equirectangular(p.turned(turn)),
        }
    }
}

/// Forwards each method to the current projection.
macro_rules! each {
    ($($method:ident($($name:ident: $type:ty),*) -> $out:ty;)+) => {
        impl Projection for AnyProjection {
            $(
                #[inline(always)]
                fn $method(&self, $($name: $type),*) -> $out {
                    match self {
                        AnyProjection::Perspective(p) => p.$method($($name),*),
                        AnyProjection::Fisheye(p) => p.$method($($name),*),
                        AnyProjection::Equirectangular(p) => p.$method($($name),*),
                    }
                }
            )+
        }
    };
}

each! {
    size() -> [f64; 2];
    axes() -> [DVec3; 3];
    film_axes() -> [DVec3; 3];
    vector(x: f64, y: f64) -> DVec3;
    sees(x: f64, y: f64) -> bool;
    components(x: f64, y: f64) -> DVec3;
    directions_and_lengths(at: [&Block; 2], to: &mut [Block; 3], lengths: &mut Block) -> ();
    film_point(v: DVec3) -> Option<[f64; 2]>;
    footprint(v: DVec3) -> f64;
    density() -> f64;
    linear() -> Option<Linear>;
}
