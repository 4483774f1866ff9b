//! The film: from film points, in pixels, to directions and sensor points of the camera frame.
//!
//! Film point (x, y), in pixels from the top left corner, belongs to the vector
//!
//! ```text
//! D = forward + (2x/width − 1) t right + (1 − 2y/height) t (height/width) up,   t = tan(fov/2),
//! ```
//!
//! along which a pinhole camera looks. A sensor at focal length f behind the pinhole has that element
//! at −f D: the picture on it stands upside down, and is shown upright.

use glam::{DMat3, DVec3};

use crate::scene::model::CameraModel;
use crate::spacetime::{Camera, Direction};

/// The film of a pinhole camera in the camera frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Pinhole {
    forward: DVec3,
    right: DVec3,
    up: DVec3,
    size: [f64; 2],
    /// 1 / size.
    pixel: [f64; 2],
}

impl Pinhole {
    /// The pinhole of `model`: axes scaled so that film coordinates in pixels address them.
    pub fn new(model: &CameraModel) -> Self {
        let [right, up, forward] = model.axes;
        let [width, height] = model.size.map(f64::from);
        let t = libm::tan(0.5 * model.horizontal_fov);
        Pinhole {
            forward,
            right: right * t,
            up: up * (t * height / width),
            size: [width, height],
            pixel: [1.0 / width, 1.0 / height],
        }
    }

    /// The same with `stretch` times the focal length: the field of view narrows.
    pub fn stretched(&self, stretch: f64) -> Self {
        Pinhole {
            right: self.right / stretch,
            up: self.up / stretch,
            ..self.clone()
        }
    }

    /// The same with its axes turned.
    pub fn turned(&self, turn: DMat3) -> Self {
        Pinhole {
            forward: turn * self.forward,
            right: turn * self.right,
            up: turn * self.up,
            ..self.clone()
        }
    }

    /// The forward axis, a unit vector of the camera frame.
    pub fn forward(&self) -> DVec3 {
        self.forward
    }

    /// The film's corners, in pixels.
    pub fn corners(&self) -> [[f64; 2]; 4] {
        let [w, h] = self.size;
        [[0.0, 0.0], [w, 0.0], [0.0, h], [w, h]]
    }

    /// The vector D of film point `(x, y)`, pixels: its part along the forward axis is 1.
    #[inline(always)]
    pub fn vector(&self, x: f64, y: f64) -> DVec3 {
        let [width, height] = self.size;
        self.forward
            + self.right * ((2.0 * x - width) * self.pixel[0])
            + self.up * ((height - 2.0 * y) * self.pixel[1])
    }

    /// The matrix from vectors of the camera frame to homogeneous film coordinates (x z, y z, z), with x and
    /// y in pixels and z the part along the forward axis, which is negative behind the camera.
    pub fn homogeneous_from_camera(&self) -> DMat3 {
        let [width, height] = self.size;
        let right = self.right / self.right.length_squared();
        let up = self.up / self.up.length_squared();
        let x = (self.forward + right) * (0.5 * width);
        let y = (self.forward - up) * (0.5 * height);
        DMat3::from_cols(x, y, self.forward).transpose()
    }

    /// The inward unit normals of the four planes through the pinhole and an edge of the film: left, right,
    /// top, bottom. What is seen lies on the inner side of all of them.
    pub fn sides(&self) -> [DVec3; 4] {
        let right = self.right / self.right.length_squared();
        let up = self.up / self.up.length_squared();
        [right, -right, -up, up].map(|side| (self.forward + side).normalize())
    }

    /// Pixels per radian in the film's corners, away from the centre: nowhere are there more.
    pub fn density(&self) -> f64 {
        let (right, up) = (self.right.length_squared(), self.up.length_squared());
        0.5 * self.size[0] / right.sqrt() * (1.0 + right + up)
    }

    /// Columns and rows.
    pub fn size(&self) -> [f64; 2] {
        self.size
    }

    /// The camera-frame look direction at film point `(x, y)`, pixels.
    #[inline(always)]
    pub fn direction(&self, x: f64, y: f64) -> Direction<Camera> {
        let d = self.vector(x, y);
        // Divisions are what this costs: one does for three components.
        Direction::from_unit(d * (1.0 / d.length()))
    }

    /// The look direction at film point `(x, y)`, pixels, and |D|: the distance of its sensor element
    /// from the pinhole per unit of focal length.
    #[inline(always)]
    pub fn direction_and_length(&self, x: f64, y: f64) -> (Direction<Camera>, f64) {
        let d = self.vector(x, y);
        let length = d.length();
        (Direction::from_unit(d * (1.0 / length)), length)
    }
}
