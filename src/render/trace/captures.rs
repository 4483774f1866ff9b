//! Combines several captures of one surface into the radiance of a point.
//!
//! A capture contains a point if its camera sees it, by [`TimeTexture::locate`] and without an obstacle, and if it has data for the time at
//! which the light of the point arrived at the camera. The captures that contain it are weighted by
//!
//! ```text
//! w = s e (cos θ / a)⁴
//! ```
//!
//! - a / cos θ is the width on the surface of one of the capture's pixels along its tilt: a is the width of a pixel at the point's
//!   distance, θ the angle between the normal and the direction to the camera. A pixel is a mean over that width, whose error for a
//!   smooth surface is ∝ (a / cos θ)² by Taylor expansion: w is the inverse of the squared error, as for means of least variance.
//! - s is the fraction of the bilinear weights whose pixels saw the surface, and e the distance from the edge of the image in pixels, at
//!   most 1: this avoids seams where a capture ends. Neither is ever 0, so a point that only one camera sees still has its value.
//!
//! With [`CaptureChoice::First`] the first capture of the scene that contains the point is used.

use std::cell::Cell;

use super::blend::Blend;
use super::emitted::{Emission, Emitted};
use super::footprint::Recorded;
use super::occlusion::{any_hit, shadow_ray};
use super::run::Run;
use super::stats::{Counter, Meter};
use super::surface_point::SurfacePoint;
use super::time_resolved::{CapturedCube, TimeResolved};
use crate::accel::Segment;
use crate::light::time_texture::{Capture, CapturePoint, CaptureView, Located, Near, TimeTexture};

impl TimeResolved {
    /// The recorded light of `captures` at the points of `run`, from the cubes selected by `cube`, if they saw the points. The captures
    /// rest in the points' frame, and so does everything that can occlude.
    pub(super) fn blend(
        &self,
        captures: &[CapturedCube],
        cube: impl Fn(&CapturedCube) -> usize,
        run: &Run,
        emitted: &mut Emitted,
        meter: &mut Meter,
    ) {
        // Moved out while `emitted` lends its other buffers, and put back at the end for the next run.
        let mut blends = std::mem::take(&mut emitted.blends);
        blends.clear();
        blends.resize(run.count(), Blend::default());
        emitted.points.fill_places(run);
        let read = Cell::new(0);
        // For each capture: find what it may have seen, then obstacles, then do the lookups.
        for (index, captured) in captures.iter().enumerate() {
            let (texture, capture) = (
                &self.cubes[cube(captured)],
                &self.captures[captured.capture],
            );
            emitted.located.clear();
            emitted.capture_views.clear();
            emitted.segments.clear();
            for point in run.points() {
                let at = captured_point(&point);
                let located = texture.locate(capture, &at);
                if located.is_seen() {
                    emitted.segments.push(towards(&point, &at, capture));
                }
                emitted.located.push(located);
                emitted.capture_views.push(capture.view_of(&at));
            }
            emitted.times.resize(run.count(), 0.0);
            run.times(captured.clock, 0, &mut emitted.times);
            let (method, counts) = (run.traced.rays.method, meter.occlusion());
            let (segments, blocked) = (&emitted.segments, &mut emitted.blocked);
            any_hit(&run.rest.bvh, method, segments, blocked, counts);
            let means = run.spans(captured.clock, &mut emitted.spans);
            // Only points in the camera's image have a segment. Convert the answers to one flag per point.
            let mut answers = emitted.blocked.iter();
            let seen = emitted.located.iter().map(Located::is_seen);
            let blocked: Vec<bool> = seen
                .map(|seen| seen && answers.next() == Some(&true))
                .collect();
            let near = &emitted.near;
            texture.look_up_each(near, run.count(), |at| {
                let (located, view) = (&emitted.located[at], &emitted.capture_views[at]);
                let blocked = blocked[at];
                let time = emitted.times[at];
                let recorded = Recorded {
                    texture,
                    capture,
                    clock: captured.clock,
                    point: emitted.points.captured(at),
                    located,
                    time,
                    span: means.then(|| emitted.spans[at]),
                    blocked,
                    near,
                    read: meter.is_on().then_some(&read),
                };
                let sampled = recorded.look_up(run, at);
                if !near.is_asking() {
                    let weight = weight(texture, located, *view, blocked);
                    blends[at].add(self.choice, index, sampled, weight);
                }
            });
        }
        meter.count(Counter::TextureBytes, read.get());
        for blend in &blends {
            emitted.push(Emission::stored(blend.finish()));
        }
        emitted.blends = blends;
    }

    /// The blended data of `captures` at one point.
    pub(super) fn blend_at(&self, captures: &[CapturedCube], point: &SurfacePoint) -> Blend {
        let mut blend = Blend::default();
        let at = captured_point(point);
        for (index, captured) in captures.iter().enumerate() {
            let (texture, capture) = (&self.cubes[captured.cube], &self.captures[captured.capture]);
            let located = texture.locate(capture, &at);
            let segment = towards(point, &at, capture);
            let blocked = located.is_seen()
                && point
                    .rest
                    .bvh
                    .any(&segment.ray, segment.s_max, segment.skip);
            let time = captured.clock.time(point);
            let near = Near::default();
            let sampled = texture.sample_located(capture, &located, time, blocked, &near);
            let view = capture.view_of(&at);
            let weight = weight(texture, &located, view, blocked);
            blend.add(self.choice, index, sampled, weight);
        }
        blend
    }
}

/// The weight s e (cos θ / a)⁴ of a capture that sees a point.
fn weight(
    texture: &TimeTexture,
    located: &Located,
    view: Option<CaptureView>,
    blocked: bool,
) -> Option<f64> {
    let view = view.filter(|_| located.is_seen() && !blocked)?;
    // (cos θ/a)²: a pixel covers a/cos θ of the tilted surface.
    let fineness = 1.0 / (view.footprint * view.footprint);
    Some(texture.seen_part(located) * fineness * fineness)
}

/// A point in the form that captures look up.
pub(super) fn captured_point(point: &SurfacePoint) -> CapturePoint {
    CapturePoint {
        position: point.rest_event().x,
        normal: point.facing_normal(),
    }
}

/// The segment from a point to the pinhole of a capture camera.
pub(super) fn towards(point: &SurfacePoint, at: &CapturePoint, capture: &Capture) -> Segment {
    let from = at.position;
    Segment {
        ray: shadow_ray(point.local.origin.x, from, capture.eye() - from),
        s_max: 1.0,
        skip: Some(point.hit.triangle),
        end: None,
    }
}
