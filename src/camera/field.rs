//! The field of view of a camera at its shot, in its own frame: what metadata, bundles and figures say of it.
//!
//! Most films are perpendicular to the forward axis in the camera's frame, at the focal length that the camera itself measures. That of
//! Bell's ships is so in the world: the element −f D there is at −f S D in the camera's frame, where S stretches by γ along the motion.
//! S leaves directions along the motion and across it unchanged, and all others not: in motion the film is no projection.

use glam::DVec3;

use super::{AnyProjection, AnyView, Camera, Projection, View};
use crate::scene::model::{CameraModel, Sensor};

impl Camera {
    /// The projection of the film in the camera's own frame at the shot; `None` for Bell's ships in motion.
    pub fn film(&self) -> Option<AnyProjection> {
        match &self.view {
            AnyView::Still(view) => Some(view.film().clone()),
            AnyView::Moving(view) => Some(view.film().clone()),
            AnyView::Unaberrated(view) => Some(view.film().clone()),
            AnyView::Inertial(view) => Some(view.film().clone()),
            AnyView::Stereo(view) => Some(view.film().clone()),
            AnyView::Paper(view) => Some(view.film().clone()),
            AnyView::Turning(view) => Some(view.film_at_shot()),
            AnyView::Accelerated(view) => view.film_at_shot(&self.shot),
        }
    }

    /// The horizontal field of view of `model`, whose camera this is, at the shot: the angle in the camera's own frame between what the
    /// middles of its left and its right edge see, radians. For a stereo pair, that of each eye.
    pub fn horizontal_fov(&self, model: &CameraModel) -> f64 {
        let scene = &self.shot.projection;
        match self.film() {
            // As in the scene, without rounding; only perspective films are ever stretched.
            Some(film) if film == *scene => model.horizontal_fov,
            Some(film) => 2.0 * libm::atan(tangents(&film)[0]),
            None => {
                let [width, height] = scene.size();
                let [left, right] =
                    [0.0, width].map(|x| self.stretched(scene.vector(x, 0.5 * height)));
                angle(left, right)
            }
        }
    }

    /// Half the width of the film over its distance, as an angle near the middle measures it in the camera's own frame: tan(hfov/2) for
    /// all perspectives.
    pub(crate) fn half_width(&self, model: &CameraModel) -> f64 {
        match self.film() {
            Some(_) => libm::tan(0.5 * self.horizontal_fov(model)),
            None => {
                let [right, _, forward] = model.axes.map(|axis| self.stretched(axis));
                let t = libm::tan(0.5 * model.horizontal_fov);
                t * right.cross(forward).length() / forward.length_squared()
            }
        }
    }

    /// The distance of the middle of `sensor`, which is this camera's, from the pinhole in the camera's own frame at the shot, metres.
    pub(crate) fn own_focal_length(&self, sensor: &Sensor) -> f64 {
        let scene = &self.shot.projection;
        let stretch = match self.film() {
            Some(film) if film == *scene => 1.0,
            Some(film) => tangents(scene)[0] / tangents(&film)[0],
            None => self.stretched(scene.forward()).length(),
        };
        sensor.focal_length * stretch
    }

    /// S v: longer by γ along the motion.
    fn stretched(&self, v: DVec3) -> DVec3 {
        let (n, w) = self.shot.frame.velocity().split();
        v + n * ((libm::cosh(w) - 1.0) * n.dot(v))
    }

    /// The tangents of half the field of view, across and down, in the camera's own frame at the shot; `None` for films that are no
    /// perspective there. For a stereo pair, those of each eye.
    pub fn tan_half_fov(&self) -> Option<[f64; 2]> {
        let film = self.film()?;
        matches!(film, AnyProjection::Perspective(_)).then(|| tangents(&film))
    }

    /// The matrices of OpenEXR's `worldToCamera` and `worldToNDC` at the event of the shot, row by row, for points as
    /// rows (p M).
    ///
    /// Camera coordinates are right, up and forward (left-handed), metres. Normalised device coordinates are 0 to 1 from the
    /// left to the right and from the top to the bottom, after division by the fourth: the depth. They are those of a
    /// camera that rests where the pinhole is; aberration is in no matrix. The third is depth − 1 cm over depth: 0 at
    /// 1 cm, 1 far away. Only a single perspective picture has the second. The first of a stereo pair belongs to the point
    /// between its eyes, which are half their distance to the left and to the right of it. Source: ImfStandardAttributes.h of
    /// OpenEXR 3.
    pub fn matrices(&self) -> [Option<[f32; 16]>; 2] {
        let eye = self.shot.event.x;
        let [right, up, forward] = self.shot.projection.axes();
        // Columns of M are what is calculated of (p, 1).
        let camera = [
            (right, -right.dot(eye)),
            (up, -up.dot(eye)),
            (forward, -forward.dot(eye)),
            (DVec3::ZERO, 1.0),
        ];
        let ndc = self.single_tangents().map(|tangents| {
            // ½ (1 + x right/depth) and ½ (1 − y up/depth).
            let [x, y] = tangents.map(|t| 1.0 / t);
            let across = forward + right * x;
            let down = forward - up * y;
            let depth = -forward.dot(eye);
            [
                (across * 0.5, -0.5 * across.dot(eye)),
                (down * 0.5, -0.5 * down.dot(eye)),
                (forward, depth - 0.01),
                (forward, depth),
            ]
        });
        [Some(camera), ndc].map(|columns| {
            let columns = columns?;
            Some(std::array::from_fn(|k| {
                let (row, (axis, constant)) = (k / 4, columns[k % 4]);
                [axis.x, axis.y, axis.z, constant][row] as f32
            }))
        })
    }

    /// OpenEXR's `screenWindowWidth`: the width of the window at the distance 1 through which a single perspective picture looks, 2 tan
    /// (hfov/2); `None` for others. Source: ImfStandardAttributes.h and TechnicalIntroduction of OpenEXR 3.
    pub fn window_width(&self) -> Option<f32> {
        self.single_tangents()
            .map(|[across, _]| (2.0 * across) as f32)
    }

    /// [`Camera::tan_half_fov`] of a single picture; `None` for a pair.
    fn single_tangents(&self) -> Option<[f64; 2]> {
        let is_pair = matches!(self.view, AnyView::Stereo(_));
        self.tan_half_fov().filter(|_| !is_pair)
    }
}

fn angle(a: DVec3, b: DVec3) -> f64 {
    // Accurate at all angles, which acos is not near 0 and π.
    libm::atan2(a.cross(b).length(), a.dot(b))
}

/// From the middle of the perspective film `film`, whose distance is 1, to its right and its upper edge.
fn tangents(film: &AnyProjection) -> [f64; 2] {
    let [width, height] = film.size();
    let middle = film.vector(0.5 * width, 0.5 * height);
    [(width, 0.5 * height), (0.5 * width, 0.0)].map(|(x, y)| (film.vector(x, y) - middle).length())
}
