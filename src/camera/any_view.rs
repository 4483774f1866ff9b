//! The view that a scene needs.

use super::shot::impossible;
use super::{
    Accelerated, CameraRay, Inertial, Moving, Paper, Point, Shot, Stereo, Still, Turning,
    Unaberrated, View,
};
use crate::error::{Error, Result};
use crate::scene::model::{Assembly, CameraModel, Equations, Motion, Scene};

/// Which of the views a camera needs; see the [module](super).
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum ViewKind {
    /// A point at rest in the world: no boost. Parts of the film of such a point, as of the next two, may see nothing.
    Still,
    /// A moving point: directions are boosted.
    Moving,
    /// A moving point with aberration turned off.
    Unaberrated,
    /// A sensor or a shutter, without acceleration.
    Inertial,
    /// A sensor or a shutter on a world line.
    Accelerated,
    /// A rotating sensor.
    Turning,
    /// Two pinholes side by side.
    Stereo,
    /// The equations of Jarabo et al. 2015.
    Paper,
}

/// The view that a camera needs, of whichever kind.
#[derive(Debug)]
#[allow(missing_docs)]
#[non_exhaustive]
pub enum AnyView {
    Still(Still),
    Moving(Moving),
    Unaberrated(Unaberrated),
    Inertial(Inertial),
    Accelerated(Box<Accelerated>),
    Turning(Turning),
    Stereo(Stereo),
    Paper(Paper),
}

/// A camera ready to take its picture.
#[derive(Debug)]
pub struct Camera {
    /// When and where.
    pub shot: Shot,
    /// How film points become rays.
    pub view: AnyView,
}

impl Camera {
    /// Whether parts of the film see nothing: corners outside a fisheye's image circle, or what is beyond the poles of a panorama.
    pub fn has_blind_points(&self) -> bool {
        self.shot.projection.has_blind_points()
    }

    /// The camera of `scene`.
    ///
    /// # Errors
    /// The motion is impossible, or the exposure starts before it begins or ends after it.
    pub fn new(scene: &Scene) -> Result<Self> {
        let aberration = scene.effects.aberration;
        Camera::of(&scene.camera, scene.equations, aberration, &scene.name)
    }

    /// The camera of `model`. `name` is that of its scene, for errors.
    ///
    /// # Errors
    /// As [`Camera::new`].
    pub(crate) fn of(
        model: &CameraModel,
        equations: Equations,
        aberration: bool,
        name: &str,
    ) -> Result<Self> {
        let shot = Shot::new(model)?;
        let view = AnyView::new(model, equations, aberration, &shot, name)?;
        Ok(Camera { shot, view })
    }
}

impl AnyView {
    /// The view for the camera of `model` at `shot`.
    fn new(
        model: &CameraModel,
        equations: Equations,
        aberration: bool,
        shot: &Shot,
        name: &str,
    ) -> Result<Self> {
        let rests = shot.frame.velocity().is_rest();
        let moves = !rests || model.motion != Motion::Inertial;
        let instant_point = model.sensor.is_none() && model.shutter.is_none();
        // Cameras whose rays are not a single boost of film directions.
        if let Some(stereo) = model.stereo {
            let view = Stereo::new(model, stereo.interpupillary_distance, shot, aberration);
            return Ok(AnyView::Stereo(view));
        }
        if let (Some(rotation), false) = (model.rotation, instant_point) {
            let view = Turning::new(model, rotation, shot, equations, aberration);
            return Ok(AnyView::Turning(view));
        }
        if equations == Equations::Paper2015 && moves {
            return Ok(AnyView::Paper(Paper::new(model, shot, aberration)));
        }
        // Film points that see nothing need weights, which rays from one event do not have.
        if instant_point && shot.projection.has_blind_points() {
            return Ok(AnyView::Inertial(Inertial::new(model, shot, aberration)));
        }
        // The others, by what their rays need: nothing, a boost, an event of their own, or a world line.
        Ok(match (instant_point, rests, aberration) {
            (true, true, _) => AnyView::Still(Still(shot.projection.clone())),
            (true, false, true) => AnyView::Moving(Moving::new(shot)),
            (true, false, false) => AnyView::Unaberrated(Unaberrated(Moving::new(shot))),
            (false, ..) if model.motion == Motion::Inertial && !is_pair(model, rests) => {
                AnyView::Inertial(Inertial::new(model, shot, aberration))
            }
            (false, ..) => AnyView::Accelerated(accelerated(model, aberration, shot, name)?),
        })
    }

    /// The ray of film point `(x, y)`, pixels, at the moment `moment` of the exposure, 0 to 1.
    pub fn ray(&self, x: f64, y: f64, moment: f64) -> CameraRay {
        match self {
            AnyView::Still(view) => view.ray(x, y, moment),
            AnyView::Moving(view) => view.ray(x, y, moment),
            AnyView::Unaberrated(view) => view.ray(x, y, moment),
            AnyView::Inertial(view) => view.ray(x, y, moment),
            AnyView::Accelerated(view) => view.ray(x, y, moment),
            AnyView::Turning(view) => view.ray(x, y, moment),
            AnyView::Stereo(view) => view.ray(x, y, moment),
            AnyView::Paper(view) => view.ray(x, y, moment),
        }
    }

    /// The view of a camera whose rays all leave one event, and whose whole film sees something; `None` for others.
    pub fn point(&self) -> Option<Point<'_>> {
        match self {
            AnyView::Still(view) => Some(Point::Still(view)),
            AnyView::Moving(view) => Some(Point::Moving(view)),
            AnyView::Unaberrated(view) => Some(Point::Unaberrated(view)),
            AnyView::Inertial(_)
            | AnyView::Accelerated(_)
            | AnyView::Turning(_)
            | AnyView::Stereo(_)
            | AnyView::Paper(_) => None,
        }
    }

    /// The kind of view: what the camera is, whether or not its whole film sees something.
    pub fn kind(&self) -> ViewKind {
        match self {
            AnyView::Still(_) => ViewKind::Still,
            AnyView::Moving(_) => ViewKind::Moving,
            AnyView::Unaberrated(_) => ViewKind::Unaberrated,
            AnyView::Inertial(view) if view.is_point() => match (view.rests(), view.aberration()) {
                (true, _) => ViewKind::Still,
                (false, true) => ViewKind::Moving,
                (false, false) => ViewKind::Unaberrated,
            },
            AnyView::Inertial(_) => ViewKind::Inertial,
            AnyView::Accelerated(_) => ViewKind::Accelerated,
            AnyView::Turning(_) => ViewKind::Turning,
            AnyView::Stereo(_) => ViewKind::Stereo,
            AnyView::Paper(_) => ViewKind::Paper,
        }
    }
}

/// Whether sensor and pinhole are on separate world lines with a separation that is fixed in the world.
fn is_pair(model: &CameraModel, rests: bool) -> bool {
    !rests && model.sensor.is_some_and(|s| s.assembly == Assembly::Bell)
}

/// The view of an accelerated camera, if all of its elements see something.
fn accelerated(
    model: &CameraModel,
    aberration: bool,
    shot: &Shot,
    name: &str,
) -> Result<Box<Accelerated>> {
    let line = model.world_line().map_err(impossible)?;
    let view = Accelerated::new(model, line, shot, aberration);
    if view.sees_everywhere() {
        return Ok(Box::new(view));
    }
    Err(Error::invalid(
        name,
        "camera.time",
        "the light that reaches the sensor during the exposure passed the pinhole before the camera's world line begins, or never passed it",
        "expose later and within the motion, or shorten the focal length",
    ))
}
