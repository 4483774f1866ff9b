//! The camera that captured a cube: the position of a point in its image, and what it saw there.
//!
//! The camera is a pinhole at `eye` with a [`Projection`], which maps points to its image.
//!
//! During preparation one ray is traced through each pixel's centre, and its *distance* r (along the ray, not the depth z) is stored. A
//! cube in the capture camera's own time shows at time t + η r what left that pixel's surface at t. Neighbouring pixels differ in r by
//! about a pixel's footprint, often more than a bin, so every tap of a lookup is read at its own r.
//!
//! Renderers whose rays begin on a near plane at depth n record times without the path to it, n / cos θ with θ the angle between ray and
//! axis: what left a surface at t shows at t + η (r − n / cos θ).
//!
//! A tap is used for a point p with normal n only if it saw *that* surface, at q with normal m. It did if all three hold, where a is the
//! width of a pixel at p:
//! - |n·(q − p)| ≤ a: q lies near p's tangent plane;
//! - |m·(q − p)| ≤ a: p lies near q's (or else a ray that grazes p's plane past a silhouette, and
//!   goes on to whatever is far behind, would pass);
//! - n·m ≥ cos 60°: no crease between them.
//!
//! A plane always passes, a curved surface as long as a pixel resolves it; an occluder, and anything behind a silhouette or across an
//! edge, does not pass.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use crate::camera::{AnyProjection, Projection};
use crate::scene::model::CaptureCamera;

/// cos 60°.
const LEAST_NORMAL_AGREEMENT: f64 = 0.5;

/// A surface point for a lookup, in the capture camera's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CapturePoint {
    /// Metres.
    pub position: DVec3,
    /// Unit geometric normal on the visible side.
    pub normal: DVec3,
}

/// A capture camera's view of a surface point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CaptureView {
    /// The width on the surface, along its tilt, of a pixel, metres.
    pub footprint: f64,
    /// The cosine between the normal and the direction to the pinhole, above 0.
    pub cosine: f64,
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
    lens: Lens,
    /// Metres of capture time per metre of distance: η, or 0 for a cube in another clock.
    delay: f64,
    /// Row by row, what each pixel has seen, as words.
    seen: Vec<[u32; 8]>,
    /// Per pixel, if needed: whether both neighbours in its row saw its surface, and both in its column.
    joined: Vec<[bool; 2]>,
}

#[derive(Debug, Clone)]
struct Lens {
    eye: DVec3,
    /// The projection of the whole film.
    projection: AnyProjection,
    /// Columns and rows of the film left of the cube and above it.
    offset: [f64; 2],
    /// Depth of the near plane.
    near: f64,
    /// Pixels in a row.
    width: usize,
}

/// What one pixel saw, in camera coordinates. Position and normal are only compared with footprints, so f32 is enough. The distance is
/// that from the beginning of the ray, which is on the near plane if there is one; 0: nothing.
#[derive(Debug, Clone, Copy)]
pub(super) struct Seen {
    pub distance: f64,
    pub position: [f32; 3],
    /// On the side of the pinhole.
    pub normal: [f32; 3],
}

pub(super) const NOTHING: Seen = Seen {
    distance: 0.0,
    position: [0.0; 3],
    normal: [0.0; 3],
};

impl Seen {
    /// The halves of the distance, position and normal: loops read many of them at a time.
    fn to_words(self) -> [u32; 8] {
        let distance = self.distance.to_bits();
        let [[x, y, z], [u, v, w]] = [self.position, self.normal].map(|v| v.map(f32::to_bits));
        [distance as u32, (distance >> 32) as u32, x, y, z, u, v, w]
    }

    #[inline(always)]
    pub(super) fn of_words([low, high, x, y, z, u, v, w]: [u32; 8]) -> Seen {
        Seen {
            distance: f64::from_bits(u64::from(low) | u64::from(high) << 32),
            position: [f32::from_bits(x), f32::from_bits(y), f32::from_bits(z)],
            normal: [f32::from_bits(u), f32::from_bits(v), f32::from_bits(w)],
        }
    }
}

/// A surface point in the capture camera's coordinates, prepared for comparing with pixels.
#[derive(Debug, Clone, Copy)]
pub(super) struct Aim {
    pub position: DVec3,
    pub normal: DVec3,
    /// Width of a pixel at the point's depth.
    pub footprint: f64,
}

impl Aim {
    /// Whether the visible side faces the pinhole.
    #[inline(always)]
    pub fn faces(&self) -> bool {
        self.normal.dot(self.position) < 0.0
    }

    /// Whether a surface at `position` with `normal` is the one around the point: the three conditions in the module documentation.
    #[inline(always)]
    pub fn is_of(&self, position: DVec3, normal: DVec3) -> bool {
        let apart = position - self.position;
        (self.normal.dot(apart).abs() <= self.footprint)
            & (normal.dot(apart).abs() <= self.footprint)
            & (self.normal.dot(normal) >= LEAST_NORMAL_AGREEMENT)
    }
}

impl Capture {
    /// Bytes held per pixel.
    pub const BYTES_PER_PIXEL: u64 = (size_of::<[u32; 8]>() + size_of::<[bool; 2]>()) as u64;

    /// Traces one ray through the centre of each of `size` (width, height: those of the cube) pixels, in parallel. `trace` takes the
    /// pinhole and a unit direction. `warped` says that the cube's clock is this camera's own; `index` is η of the medium (of the
    /// capture, that is: even if a rendering turns off its own delay).
    pub fn new(
        camera: &CaptureCamera,
        size: [usize; 2],
        warped: bool,
        index: f64,
        trace: impl Fn(DVec3, DVec3) -> Option<SeenPoint> + Sync,
    ) -> Capture {
        let lens = Lens {
            eye: camera.eye,
            projection: AnyProjection::of_capture(camera, size),
            offset: camera
                .crop
                .map_or([0.0; 2], |crop| crop.offset.map(f64::from)),
            near: camera.near_clip,
            width: size[0],
        };
        let seen = (0..size[0].saturating_mul(size[1]))
            .into_par_iter()
            .map(|pixel| lens.look_through(pixel, &trace).to_words())
            .collect();
        Capture {
            lens,
            delay: if warped { index } else { 0.0 },
            seen,
            joined: Vec::new(),
        }
    }

    /// The same, with the neighbour data for [`Reconstruction::Sharp`](crate::scene::model::Reconstruction::Sharp).
    #[must_use]
    pub fn with_neighbours(mut self) -> Capture {
        let [width, height] = [self.lens.width, self.seen.len() / self.lens.width.max(1)];
        let joined = |pixel: usize| {
            let aim = self.aim_of(pixel);
            let all = |apart: usize| {
                aim.is_some_and(|aim| {
                    self.saw(pixel - apart, &aim) && self.saw(pixel + apart, &aim)
                })
            };
            // Pixels at the border lack a neighbour.
            let within = |at: usize, count: usize| at > 0 && at + 1 < count;
            [
                within(pixel % width, width) && all(1),
                within(pixel / width, height) && all(width),
            ]
        };
        self.joined = (0..self.seen.len()).into_par_iter().map(joined).collect();
        self
    }

    /// Whether both neighbours of a pixel in its row saw its surface, and both in its column.
    pub(super) fn joined(&self, pixel: usize) -> [bool; 2] {
        self.joined.get(pixel).copied().unwrap_or_default()
    }

    /// What a pixel saw, for comparison with others.
    pub(super) fn aim_of(&self, pixel: usize) -> Option<Aim> {
        let seen = self.seen_by(pixel);
        if seen.distance <= 0.0 {
            return None;
        }
        let position = Vec3::from_array(seen.position).as_dvec3();
        Some(Aim {
            position,
            normal: Vec3::from_array(seen.normal).as_dvec3(),
            footprint: self.lens.projection.footprint(position),
        })
    }

    /// The pinhole.
    pub fn eye(&self) -> DVec3 {
        self.lens.eye
    }

    /// Whether the cube's clock is this camera's own.
    pub fn is_warped(&self) -> bool {
        self.delay != 0.0
    }

    /// The position of `point` in the image, pixels from its top left corner; `None` behind the pinhole.
    pub fn project(&self, point: DVec3) -> Option<[f64; 2]> {
        let point = CapturePoint {
            position: point,
            normal: DVec3::ZERO,
        };
        self.look_at(&self.lens.projection, &point).0
    }

    /// The projection of the whole film.
    pub(super) fn projection(&self) -> &AnyProjection {
        &self.lens.projection
    }

    /// The position of `point` in the image, pixels from its top left corner, `None` behind the pinhole; and the point in the camera's
    /// axes. `film` is [`Capture::projection`], or its inner type.
    #[inline(always)]
    pub(super) fn look_at<P: Projection>(
        &self,
        film: &P,
        point: &CapturePoint,
    ) -> (Option<[f64; 2]>, Aim) {
        let position = film.along_axes(point.position - self.lens.eye);
        let aim = Aim {
            position,
            normal: film.along_axes(point.normal),
            footprint: film.footprint(position),
        };
        let [left, above] = self.lens.offset;
        let place = film.film_point(position);
        (place.map(|[x, y]| [x - left, y - above]), aim)
    }

    /// The distance, metres, of what pixel (row · width + column) saw; `None` if it saw nothing.
    #[inline]
    pub fn distance(&self, pixel: usize) -> Option<f64> {
        let seen = self.seen_by(pixel);
        // From the pinhole, not from the near plane.
        let distance = match self.lens.near > 0.0 {
            true => Vec3::from_array(seen.position).as_dvec3().length(),
            false => seen.distance,
        };
        (seen.distance > 0.0).then_some(distance)
    }

    /// The delay between the emission and the recording of this pixel's light, metres.
    #[inline]
    pub(super) fn delay_of(&self, pixel: usize) -> f64 {
        self.delay_from(&self.seen_by(pixel))
    }

    /// The same for what a pixel saw.
    #[inline(always)]
    pub(super) fn delay_from(&self, seen: &Seen) -> f64 {
        // Of what saw nothing the distance is 0.
        self.delay * seen.distance
    }

    /// The point, if its visible side faces the pinhole and it is in front of it.
    #[inline]
    pub(super) fn aim(&self, point: &CapturePoint) -> Option<Aim> {
        let (place, aim) = self.look_at(&self.lens.projection, point);
        (place.is_some() && aim.faces()).then_some(aim)
    }

    /// This camera's view of the point; `None` from behind its surface, and behind the pinhole.
    pub fn view_of(&self, point: &CapturePoint) -> Option<CaptureView> {
        let aim = self.aim(point)?;
        // On a tilted surface a pixel is 1/cos θ times as wide.
        let cosine = -aim.normal.dot(aim.position) / aim.position.length();
        Some(CaptureView {
            footprint: aim.footprint / cosine,
            cosine,
        })
    }

    /// Whether this pixel saw the surface around the point.
    #[inline]
    pub(super) fn saw(&self, pixel: usize, aim: &Aim) -> bool {
        let seen = self.seen_by(pixel);
        let position = Vec3::from_array(seen.position).as_dvec3();
        let normal = Vec3::from_array(seen.normal).as_dvec3();
        seen.distance > 0.0 && aim.is_of(position, normal)
    }

    /// What this pixel saw.
    #[inline(always)]
    pub(super) fn seen_by(&self, pixel: usize) -> Seen {
        self.seen
            .get(pixel)
            .map_or(NOTHING, |words| Seen::of_words(*words))
    }

    /// What all pixels saw, as words.
    #[inline(always)]
    pub(super) fn all_seen(&self) -> &[[u32; 8]] {
        &self.seen
    }
}

impl Lens {
    /// What the ray through the centre of a pixel sees.
    #[inline]
    fn look_through(
        &self,
        pixel: usize,
        trace: &impl Fn(DVec3, DVec3) -> Option<SeenPoint>,
    ) -> Seen {
        let (row, column) = ((pixel / self.width) as f64, (pixel % self.width) as f64);
        // The ray at depth 1: the distance is measured along it.
        let [left, above] = self.offset;
        let ray = (self.projection).components(column + 0.5 + left, row + 0.5 + above);
        let length = ray.length();
        let [right, up, forward] = self.projection.axes();
        let direction = (right * ray.x + up * ray.y + forward * ray.z) / length;
        // The ray begins on the near plane.
        let skipped = self.near * length;
        match trace(self.eye + direction * skipped, direction) {
            Some(hit) if hit.distance > 0.0 && hit.distance.is_finite() => {
                let distance = skipped + hit.distance;
                Seen {
                    distance: hit.distance,
                    position: (ray * (distance / length)).as_vec3().to_array(),
                    normal: self.facing(hit.normal, ray).as_vec3().to_array(),
                }
            }
            _ => NOTHING,
        }
    }

    /// The normal by its components along the axes, on the side that the ray comes from.
    #[inline]
    fn facing(&self, normal: DVec3, ray: DVec3) -> DVec3 {
        let normal = self.projection.along_axes(normal);
        if normal.dot(ray) > 0.0 {
            -normal
        } else {
            normal
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn delays_lack_the_way_to_the_near_plane_to_double_precision() {
        let camera = CaptureCamera {
            near_clip: 2.0,
            ..CaptureCamera::new(DVec3::ZERO, [DVec3::X, DVec3::Y, DVec3::NEG_Z], 1.5)
        };
        let wall = |origin: DVec3, d: DVec3| {
            Some(SeenPoint {
                distance: (-7.0 - origin.z) / d.z,
                normal: DVec3::Z,
            })
        };
        let capture = Capture::new(&camera, [9, 5], true, 1.4, wall);
        let step = 2.0 * 0.75f64.tan() / 9.0;
        for pixel in 0..45 {
            let (x, y) = ((pixel % 9) as f64 - 4.0, 2.0 - (pixel / 9) as f64);
            // The length of the ray between the depths 0 and 1; its light is timed from depth 2 to depth 7.
            let length = (1.0 + step * step * (x * x + y * y)).sqrt();
            assert!((capture.delay_of(pixel) - 1.4 * 5.0 * length).abs() < 1e-13);
            assert!((capture.distance(pixel).unwrap() - 7.0 * length).abs() < 1e-5);
        }
    }
}
