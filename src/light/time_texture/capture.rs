//! The camera that captured a cube: where a point lies in its image, and what it saw there.
//!
//! Pinhole at `eye` with axes (right, up, forward); with (x, y, z) the point's coordinates along
//! them and focal length F = W / (2 tan(fov/2)) in pixels, the point lies at
//! (W/2 + F x/z, H/2 − F y/z) pixels from the top left corner. Pixels are square.
//!
//! At preparation one ray goes through each pixel's centre, and its *distance* r (along the ray, not
//! the depth z) is kept. A cube in the capture camera's own time shows at time t + η r what left that
//! pixel's surface at t. Neighbouring pixels differ in r by about a pixel's footprint, often more
//! than a bin is wide, so every tap of a lookup is read at its own r.
//!
//! A tap stands for a point p with normal n only if it saw *that* surface, at q with normal m. It did
//! if all three hold, a = z/F being the width of a pixel at p:
//! - |n·(q − p)| ≤ a: q lies near p's tangent plane;
//! - |m·(q − p)| ≤ a: p lies near q's (or else a ray that grazes p's plane past a silhouette, and
//!   goes on to whatever is far behind, would pass);
//! - n·m ≥ cos 60°: no crease between them.
//!
//! A plane passes exactly, a curved surface as long as a pixel resolves it; an occluder, and what
//! lies behind a silhouette or across an edge, does not pass.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use crate::scene::model::CaptureCamera;

/// cos 60°.
const LEAST_NORMAL_AGREEMENT: f64 = 0.5;

/// A point on a surface whose radiance is asked for, in the capture camera's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfacePoint {
    /// Metres.
    pub position: DVec3,
    /// Unit geometric normal on the side that is looked at.
    pub normal: DVec3,
}

/// What the capture camera saw along a ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SeenPoint {
    /// Distance from the pinhole, metres.
    pub distance: f64,
    /// Unit geometric normal, on either side.
    pub normal: DVec3,
}

/// A capture camera and what it saw through the centre of every pixel.
#[derive(Debug, Clone)]
pub struct Capture {
    view: View,
    /// Metres of capture time per metre of distance: η, or 0 for a cube in another clock.
    delay: f64,
    /// Row by row.
    seen: Vec<Seen>,
}

#[derive(Debug, Clone)]
struct View {
    eye: DVec3,
    axes: [DVec3; 3],
    focal: f64,
    size: [usize; 2],
}

/// What one pixel saw, in camera coordinates. Place and normal are only compared with footprints, so
/// f32 does for them. Distance 0: nothing.
#[derive(Debug, Clone, Copy)]
struct Seen {
    distance: f64,
    position: [f32; 3],
    /// On the side of the pinhole.
    normal: [f32; 3],
}

const NOTHING: Seen = Seen {
    distance: 0.0,
    position: [0.0; 3],
    normal: [0.0; 3],
};

/// A surface point in the capture camera's coordinates, prepared for comparing with pixels.
#[derive(Debug, Clone, Copy)]
pub(super) struct Aim {
    position: DVec3,
    normal: DVec3,
    /// Width of a pixel at the point's depth.
    footprint: f64,
}

impl Capture {
    /// Bytes held per pixel.
    pub const BYTES_PER_PIXEL: u64 = size_of::<Seen>() as u64;

    /// Sends one ray through the centre of each of `size` (width, height: those of the cube) pixels,
    /// in parallel. `trace` takes the pinhole and a unit direction. `warped` says that the cube's
    /// clock is this camera's own; `index` is η of the medium (of the capture, that is: also where a
    /// rendering leaves out the delay on its own way).
    pub fn new(
        camera: &CaptureCamera,
        size: [usize; 2],
        warped: bool,
        index: f64,
        trace: impl Fn(DVec3, DVec3) -> Option<SeenPoint> + Sync,
    ) -> Capture {
        let view = View::new(camera, size);
        let seen = (0..size[0].saturating_mul(size[1]))
            .into_par_iter()
            .map(|pixel| view.look_through(pixel, &trace))
            .collect();
        Capture {
            view,
            delay: if warped { index } else { 0.0 },
            seen,
        }
    }

    /// The pinhole.
    pub fn eye(&self) -> DVec3 {
        self.view.eye
    }

    /// Whether the cube's clock is this camera's own.
    pub fn is_warped(&self) -> bool {
        self.delay != 0.0
    }

    /// Where `point` lies in the image, pixels from its top left corner; none behind the pinhole.
    #[inline]
    pub fn project(&self, point: DVec3) -> Option<[f64; 2]> {
        self.view.project(point)
    }

    /// Distance, metres, of what pixel (row · width + column) saw; none where it saw nothing.
    #[inline]
    pub fn distance(&self, pixel: usize) -> Option<f64> {
        self.seen
            .get(pixel)
            .map(|seen| seen.distance)
            .filter(|distance| *distance > 0.0)
    }

    /// How much later than it left its surface this pixel's light is recorded, metres.
    #[inline]
    pub(super) fn delay_of(&self, pixel: usize) -> f64 {
        self.delay * self.distance(pixel).unwrap_or(0.0)
    }

    /// The point, if its looked-at side faces the pinhole and is before it.
    #[inline]
    pub(super) fn aim(&self, point: &SurfacePoint) -> Option<Aim> {
        let p = self.view.coordinates(point.position - self.view.eye);
        let normal = self.view.coordinates(point.normal);
        (normal.dot(p) < 0.0 && p.z > 0.0).then(|| Aim {
            position: p,
            normal,
            footprint: p.z / self.view.focal,
        })
    }

    /// Whether this pixel saw the surface around the point.
    #[inline]
    pub(super) fn saw(&self, pixel: usize, aim: &Aim) -> bool {
        let Some(seen) = self.seen.get(pixel).filter(|seen| seen.distance > 0.0) else {
            return false;
        };
        let apart = Vec3::from_array(seen.position).as_dvec3() - aim.position;
        let normal = Vec3::from_array(seen.normal).as_dvec3();
        aim.normal.dot(apart).abs() <= aim.footprint
            && normal.dot(apart).abs() <= aim.footprint
            && aim.normal.dot(normal) >= LEAST_NORMAL_AGREEMENT
    }
}

impl View {
    fn new(camera: &CaptureCamera, size: [usize; 2]) -> View {
        View {
            eye: camera.eye,
            axes: camera.axes,
            focal: 0.5 * size[0] as f64 / libm::tan(0.5 * camera.horizontal_fov),
            size,
        }
    }

    /// Components of a vector along right, up and forward.
    #[inline]
    fn coordinates(&self, v: DVec3) -> DVec3 {
        let [right, up, forward] = self.axes;
        DVec3::new(v.dot(right), v.dot(up), v.dot(forward))
    }

    #[inline]
    fn project(&self, point: DVec3) -> Option<[f64; 2]> {
        let p = self.coordinates(point - self.eye);
        let [width, height] = self.size.map(|n| n as f64);
        (p.z > 0.0).then(|| {
            let scale = self.focal / p.z;
            [0.5 * width + scale * p.x, 0.5 * height - scale * p.y]
        })
    }

    /// The ray through a pixel's centre in camera coordinates, of depth 1.
    fn ray(&self, pixel: usize) -> DVec3 {
        let [width, height] = self.size;
        let (row, column) = ((pixel / width) as f64, (pixel % width) as f64);
        let x = column + 0.5 - 0.5 * width as f64;
        let y = 0.5 * height as f64 - row - 0.5;
        DVec3::new(x / self.focal, y / self.focal, 1.0)
    }

    fn look_through(
        &self,
        pixel: usize,
        trace: &impl Fn(DVec3, DVec3) -> Option<SeenPoint>,
    ) -> Seen {
        let ray = self.ray(pixel);
        let length = ray.length();
        let [right, up, forward] = self.axes;
        let direction = (right * ray.x + up * ray.y + forward) / length;
        match trace(self.eye, direction) {
            Some(hit) if hit.distance > 0.0 && hit.distance.is_finite() => Seen {
                distance: hit.distance,
                position: (ray * (hit.distance / length)).as_vec3().to_array(),
                normal: self.facing(hit.normal, ray).as_vec3().to_array(),
            },
            _ => NOTHING,
        }
    }

    /// The normal in camera coordinates, on the side that the ray comes from.
    fn facing(&self, normal: DVec3, ray: DVec3) -> DVec3 {
        let normal = self.coordinates(normal);
        if normal.dot(ray) > 0.0 {
            -normal
        } else {
            normal
        }
    }
}
