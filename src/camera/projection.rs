//! Projections: from film points, in pixels from the top left corner, to directions, and back.
//!
//! Cameras, capture cameras and overlays use projections only through [`Projection`]. [`AnyProjection`](super::AnyProjection) lists them
//! all. Vectors are in the frame of the camera, or given by components along the projection's [axes](Projection::axes).

use glam::{DMat3, DVec3};

use crate::accel::vectors::{BLOCK, Block};
use crate::spacetime::{CameraFrame, Direction};

/// From film points to directions, and back.
pub trait Projection {
    /// Columns and rows.
    fn size(&self) -> [f64; 2];

    /// Unit vectors right, up and forward.
    fn axes(&self) -> [DVec3; 3];

    /// The same axes as the film's vectors give them, which differ from the axes by rounding; overlays draw with these.
    fn film_axes(&self) -> [DVec3; 3] {
        self.axes()
    }

    /// The vector D of film point `(x, y)`: it looks along D, and its element of a sensor at focal length f behind the pinhole is at −f
    /// D. The picture on the sensor is upside down, and is shown upright.
    #[inline(always)]
    fn vector(&self, x: f64, y: f64) -> DVec3 {
        let [right, up, forward] = self.axes();
        let v = self.components(x, y);
        right * v.x + up * v.y + forward * v.z
    }

    /// Whether film point `(x, y)` sees anything: a fisheye's picture may be smaller than its film. For a film point that sees nothing, D
    /// is the forward axis.
    #[inline(always)]
    fn sees(&self, _x: f64, _y: f64) -> bool {
        true
    }

    /// The components of D along the axes.
    fn components(&self, x: f64, y: f64) -> DVec3;

    /// The film point that sees the direction `v`, given by components along the axes; it may lie beyond the film's edges. `None` if no
    /// film point looks in that direction, however large the film.
    fn film_point(&self, v: DVec3) -> Option<[f64; 2]>;

    /// The width of a pixel at the point `v`, given by components along the axes.
    fn footprint(&self, v: DVec3) -> f64;

    /// Pixels per radian where they are densest.
    fn density(&self) -> f64;

    /// What rasterizers need, if straight lines are seen straight.
    fn linear(&self) -> Option<Linear>;

    /// The unit vector forward.
    fn forward(&self) -> DVec3 {
        self.axes()[2]
    }

    /// The film's corners, in pixels.
    fn corners(&self) -> [[f64; 2]; 4] {
        let [w, h] = self.size();
        [[0.0, 0.0], [w, 0.0], [0.0, h], [w, h]]
    }

    /// The components of `v` along the axes.
    #[inline(always)]
    fn along_axes(&self, v: DVec3) -> DVec3 {
        let [right, up, forward] = self.axes();
        DVec3::new(v.dot(right), v.dot(up), v.dot(forward))
    }

    /// The look direction at film point `(x, y)`, and |D|: the distance of its sensor element from the
    /// pinhole per unit of focal length.
    #[inline(always)]
    fn direction_and_length(&self, x: f64, y: f64) -> (Direction<CameraFrame>, f64) {
        let d = self.vector(x, y);
        let length = d.length();
        // Divisions dominate the cost: one serves all three components.
        (Direction::from_unit(d * (1.0 / length)), length)
    }

    /// The same for a block of film points, given by x and y, with the same bits: components of the look directions, and |D| of each. To
    /// be compiled for wide vectors.
    #[inline(always)]
    fn directions_and_lengths(
        &self,
        [x, y]: [&Block; 2],
        to: &mut [Block; 3],
        lengths: &mut Block,
    ) {
        let [to_x, to_y, to_z] = to;
        for k in 0..BLOCK {
            let (direction, length) = self.direction_and_length(x[k], y[k]);
            let d = direction.unit();
            (to_x[k], to_y[k], to_z[k], lengths[k]) = (d.x, d.y, d.z, length);
        }
    }

    /// The look direction at film point `(x, y)`.
    #[inline(always)]
    fn direction(&self, x: f64, y: f64) -> Direction<CameraFrame> {
        self.direction_and_length(x, y).0
    }
}

/// A projection that sees straight lines straight, in homogeneous film coordinates.
#[derive(Debug, Clone, Copy)]
pub struct Linear {
    /// The matrix from vectors to homogeneous film coordinates (x z, y z, z), with x and y in pixels and z
    /// the part along the forward axis, which is negative behind the camera.
    pub homogeneous_from_camera: DMat3,
    /// The inward unit normals of the four planes through the pinhole and an edge of the film: left, right,
    /// top, bottom. What is seen lies on the inner side of all of them.
    pub sides: [DVec3; 4],
}

/// Through a pinhole onto a plane: square pixels, straight lines straight.
///
/// With t = tan(fov/2), film point (x, y) has the vector
///
/// ```text
/// D = forward + (2x/width − 1) t right + (1 − 2y/height) t (height/width) up,
/// ```
///
/// and what has the components (x, y, z) along the axes is seen, with the focal length
/// F = width / 2t in pixels, at (width/2 + F x/z, height/2 − F y/z).
#[derive(Debug, Clone, PartialEq)]
pub struct Perspective {
    forward: DVec3,
    /// t right, and t (height/width) up.
    edges: [DVec3; 2],
    size: [f64; 2],
    /// 1 / size.
    pixel: [f64; 2],
    axes: [DVec3; 3],
    /// F.
    focal: f64,
}

impl Perspective {
    /// A projection with unit axes right, up and forward, a horizontal field of view in radians, and `size`
    /// in columns and rows.
    pub fn new(axes: [DVec3; 3], horizontal_fov: f64, [width, height]: [f64; 2]) -> Self {
        let [right, up, forward] = axes;
        let t = libm::tan(0.5 * horizontal_fov);
        Perspective {
            forward,
            edges: [right * t, up * (t * height / width)],
            size: [width, height],
            pixel: [1.0 / width, 1.0 / height],
            axes,
            focal: 0.5 * width / t,
        }
    }

    pub(super) fn stretched(&self, stretch: f64) -> Self {
        Perspective {
            // At distance 1 the film's half width is tan(hfov/2), which is inversely proportional to the focal length.
            edges: self.edges.map(|edge| edge / stretch),
            focal: self.focal * stretch,
            ..self.clone()
        }
    }

    pub(super) fn turned(&self, turn: DMat3) -> Self {
        Perspective {
            forward: turn * self.forward,
            edges: self.edges.map(|edge| turn * edge),
            axes: self.axes.map(|axis| turn * axis),
            ..self.clone()
        }
    }
}

impl Projection for Perspective {
    fn size(&self) -> [f64; 2] {
        self.size
    }

    #[inline(always)]
    fn axes(&self) -> [DVec3; 3] {
        self.axes
    }

    fn film_axes(&self) -> [DVec3; 3] {
        let [width, height] = self.size;
        let corner = self.vector(0.0, 0.0);
        let step = |x, y| (self.vector(x, y) - corner).normalize_or_zero();
        [step(width, 0.0), -step(0.0, height), self.forward]
    }

    // Cameras compute millions of vectors: no division, axes scaled beforehand.
    #[inline(always)]
    fn vector(&self, x: f64, y: f64) -> DVec3 {
        let ([width, height], [right, up]) = (self.size, self.edges);
        // 2x − w is exact at the edges and centres of pixels, and antisymmetric about the middle.
        self.forward
            + right * ((2.0 * x - width) * self.pixel[0])
            + up * ((height - 2.0 * y) * self.pixel[1])
    }

    fn components(&self, x: f64, y: f64) -> DVec3 {
        let [width, height] = self.size;
        let (right, up) = (x - 0.5 * width, 0.5 * height - y);
        DVec3::new(right / self.focal, up / self.focal, 1.0)
    }

    #[inline(always)]
    fn film_point(&self, v: DVec3) -> Option<[f64; 2]> {
        let [width, height] = self.size;
        // Always divide, then select: loops over this vectorize.
        let scale = self.focal / v.z;
        let place = [0.5 * width + scale * v.x, 0.5 * height - scale * v.y];
        if v.z > 0.0 { Some(place) } else { None }
    }

    #[inline(always)]
    fn footprint(&self, v: DVec3) -> f64 {
        v.z / self.focal
    }

    // In the corners: |D|² times as dense as in the centre.
    fn density(&self) -> f64 {
        let [right, up] = self.edges.map(|edge| edge.length_squared());
        0.5 * self.size[0] / right.sqrt() * (1.0 + right + up)
    }

    fn linear(&self) -> Option<Linear> {
        let ([width, height], forward) = (self.size, self.forward);
        // Unit axes over t, and over t (height/width).
        let [right, up] = self.edges.map(|edge| edge / edge.length_squared());
        // v·x is x z and v·y is y z: linear in v, unlike x and y themselves.
        let x = (forward + right) * (0.5 * width);
        let y = (forward - up) * (0.5 * height);
        Some(Linear {
            homogeneous_from_camera: DMat3::from_cols(x, y, forward).transpose(),
            sides: [right, -right, -up, up].map(|side| (forward + side).normalize()),
        })
    }
}

/// The rotation by `angle` radians about the unit vector `axis`, right-handed (Rodrigues).
pub(crate) fn rotation_matrix(axis: DVec3, angle: f64) -> DMat3 {
    let (sin, cos) = libm::sincos(angle);
    let half = libm::sin(0.5 * angle);
    // 1 − cos without cancellation.
    let versine = 2.0 * half * half;
    let column = |e: DVec3| e * cos + axis.cross(e) * sin + axis * (axis.dot(e) * versine);
    DMat3::from_cols(column(DVec3::X), column(DVec3::Y), column(DVec3::Z))
}
