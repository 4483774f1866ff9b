//! What samples stand for on surfaces: `reconstruction = "footprint"`.
//!
//! A sample at film point (x, y) stands for its cell of the pixel, a × b pixels (all of it, where there is one sample). The
//! camera's own rays through (x + h, y) and (x, y + h), h = ±2⁻¹⁰ towards the middle of the pixel, are carried into the
//! rest frame of what the sample hit, and meet the plane of the triangle at events X_x and X_y, each at its own retarded
//! time. (X_x − X)/h and (X_y − X)/h are the derivatives of the seen event by the place on the film (Igehy, "Tracing ray
//! differentials", SIGGRAPH 1999, with differences for differentials). Distance, tilt, aberration, the motion of either and
//! of the pinhole itself are in them, of whatever camera. With (ξ₀, υ₀) the sample's place in its cell, from 0 to 1, the
//! cell shows to first order
//!
//! ```text
//! X(ξ, υ) = X + (ξ − ξ₀) a ∂X/∂x + (υ − υ₀) b ∂X/∂y,   0 ≤ ξ, υ ≤ 1.
//! ```
//!
//! The mean over it is that of n × m lookups at ((i + ½)/n, (j + ½)/m), each at its own place and time: n and m are the
//! lengths of the two sides in texels, rounded up, so that lookups, which interpolate linearly, are no more than a texel
//! apart. Along a tilted surface only one of them is large: the filter is anisotropic. The cells of a pixel's samples make
//! up the pixel. A side shorter than a texel is not filtered, and where both are, it is the one lookup at the sample.

use glam::{DVec2, DVec3};

use super::camera_rays::CameraRays;
use super::emitted::{Emission, Emitted};
use super::point::EmissionClock;
use super::run::Run;
use crate::light::time_texture::{
    Capture, Located, Sampled, SurfacePoint as CapturePoint, TimeTexture,
};
use crate::scene::model::Reconstruction;
use crate::spacetime::{Direction, NullRay, World};

/// The most lookups along a side.
const MOST: f64 = 64.0;

/// What a sample stands for.
pub(super) struct Footprint {
    /// Where in its cell the sample lies, from 0 to 1.
    within: [f64; 2],
    sides: [Side; 2],
}

/// From one side of a cell to the other.
#[derive(Debug, Clone, Copy)]
struct Side {
    /// In the rest frame, metres.
    position: DVec3,
    /// In barycentric coordinates of the triangle.
    barycentric: DVec2,
    /// Of emission, by the clock that was asked for, metres.
    time: f64,
}

/// Where a ray meets a plane.
struct Meeting {
    position: DVec3,
    barycentric: DVec2,
    time: f64,
}

impl Run<'_> {
    /// Whether lookups in `texture` are means over what samples stand for.
    pub(super) fn filters(&self, texture: &TimeTexture) -> bool {
        texture.reconstruction() == Reconstruction::Footprint
            && self.traced.rays.samples.cells.is_some()
    }

    /// What member `k` stands for, with times by `clock`; none where a ray beside it does not meet its plane.
    pub(super) fn footprint(&self, k: usize, clock: EmissionClock) -> Option<Footprint> {
        let cells = self.traced.rays.samples.cells.as_ref()?;
        let (hit, ray) = (self.hit(k)?, self.members[k] as usize);
        let corners = self.rest.bvh.corners(hit.slot);
        let own = self.meeting(cells.rays, ray, corners, clock)?;
        let offset = cells.rays.offset(ray);
        let mut sides = [None; 2];
        for (axis, side) in sides.iter_mut().enumerate() {
            let beside = &cells.beside[axis];
            let met = self.meeting(beside, ray, corners, clock)?;
            let per_side = cells.size[axis] / (beside.offset(ray)[axis] - offset[axis]);
            *side = Some(Side {
                position: (met.position - own.position) * per_side,
                barycentric: (met.barycentric - own.barycentric) * per_side,
                time: (met.time - own.time) * per_side,
            });
        }
        let [Some(across), Some(down)] = sides else {
            return None;
        };
        let within = |axis: usize| {
            let cell = offset[axis] / cells.size[axis];
            cell - cell.floor()
        };
        Some(Footprint {
            within: [within(0), within(1)],
            sides: [across, down],
        })
    }

    /// Where ray `ray` of `rays` meets the plane of the triangle with these corners.
    fn meeting(
        &self,
        rays: &CameraRays,
        ray: usize,
        [a, b, c]: [DVec3; 3],
        clock: EmissionClock,
    ) -> Option<Meeting> {
        let origin = rays.origin(ray);
        let event = self.traced.event + origin.displacement;
        let d = Direction::<World>::from_unit(rays.directions[ray]);
        let index = self.traced.index * origin.delay;
        let local = self.rest.frame.ray_from_world(event, d, index);
        let (e1, e2) = (b - a, c - a);
        let normal = e1.cross(e2);
        // The parameter is the same in all frames.
        let s = normal.dot(a - local.origin.x) / normal.dot(local.tangent.x);
        if !(s > 0.0 && s.is_finite()) {
            return None;
        }
        let met = local.at(s);
        let from_a = met.x - a;
        let square = normal.length_squared();
        Some(Meeting {
            position: met.x,
            barycentric: DVec2::new(
                from_a.cross(e2).dot(normal) / square,
                e1.cross(from_a).dot(normal) / square,
            ),
            time: match clock {
                EmissionClock::World => NullRay::new(event, d, index).at(s).ct,
                EmissionClock::Object => met.ct,
            },
        })
    }
}

impl Footprint {
    /// The mean of `look_up` over the cell, whose sides are so many texels long: it is given parts of both sides to
    /// add; none where one lookup will do.
    fn mean(
        &self,
        texels: [f64; 2],
        mut look_up: impl FnMut([f64; 2]) -> Sampled,
    ) -> Option<Sampled> {
        // Rounding must not make two of one.
        let count = texels.map(|length| (length - 1e-9).ceil().clamp(1.0, MOST));
        let [n, m] = count.map(|count| count as usize);
        if n * m == 1 {
            return None;
        }
        let mut sum = Sampled::default();
        for (i, j) in (0..m).flat_map(|j| (0..n).map(move |i| (i, j))) {
            let part = |axis: usize, number: usize| match count[axis] > 1.0 {
                true => (number as f64 + 0.5) / count[axis] - self.within[axis],
                false => 0.0,
            };
            let one = look_up([part(0, i), part(1, j)]);
            for c in 0..3 {
                sum.radiance[c] += one.radiance[c];
                sum.unscaled[c] += one.unscaled[c];
            }
            sum.coverage += one.coverage;
        }
        let each = 1.0 / (n * m) as f64;
        Some(Sampled {
            radiance: sum.radiance.map(|c| c * each),
            unscaled: sum.unscaled.map(|c| c * each),
            coverage: sum.coverage * each,
        })
    }

    /// How much later light leaves there.
    fn later(&self, parts: [f64; 2]) -> f64 {
        parts[0] * self.sides[0].time + parts[1] * self.sides[1].time
    }
}

/// What `texture` holds by texture coordinates of what the points of `run` stand for. Places beyond the edges of a texture
/// that the sample itself is on count as those on its edges.
pub(super) fn look_up(
    texture: &TimeTexture,
    set: usize,
    clock: EmissionClock,
    run: &Run,
    emitted: &mut Emitted,
) {
    let spans = run.spans(clock, &mut emitted.spans);
    emitted.times.resize(run.count(), 0.0);
    run.times(clock, 0, &mut emitted.times);
    let size = DVec2::from_array(texture.size().map(|n| n as f64));
    for k in 0..run.count() {
        let hit = run.hit(k);
        let at = |u: f64, v: f64| {
            let hit = hit.map(|hit| crate::accel::Hit { u, v, ..hit })?;
            run.rest.uv(run.patch, set, &hit)
        };
        let uv = hit.and_then(|hit| at(hit.u, hit.v)).unwrap_or(DVec2::NAN);
        let time = emitted.times[k];
        let span = spans.then(|| emitted.spans[k]);
        let one = |uv: DVec2, time: f64| match span {
            Some(span) => texture.mean_uv(uv, span.map(|after| time + after)),
            None => texture.sample_uv(uv, time),
        };
        let mean = run
            .footprint(k, clock)
            .zip(hit)
            .and_then(|(footprint, hit)| {
                let beside =
                    |side: &Side| at(hit.u + side.barycentric.x, hit.v + side.barycentric.y);
                let [across, down] = [
                    beside(&footprint.sides[0])? - uv,
                    beside(&footprint.sides[1])? - uv,
                ];
                let is_on = |uv: DVec2| uv.cmpge(DVec2::ZERO).all() && uv.cmple(DVec2::ONE).all();
                let texels = [(across * size).length(), (down * size).length()];
                footprint.mean(texels, |parts| {
                    let place = uv + across * parts[0] + down * parts[1];
                    let place = match is_on(uv) {
                        true => place.clamp(DVec2::ZERO, DVec2::ONE),
                        false => place,
                    };
                    one(place, time + footprint.later(parts))
                })
            });
        let sampled = mean.unwrap_or_else(|| one(uv, time));
        emitted.push(Emission::stored(sampled));
    }
}

/// One point of a run as a capture saw it, with what its lookup takes.
pub(super) struct Recorded<'a> {
    pub texture: &'a TimeTexture,
    pub capture: &'a Capture,
    pub clock: EmissionClock,
    pub point: CapturePoint,
    pub located: &'a Located,
    pub time: f64,
    /// From where to where an exposure reaches about that.
    pub span: Option<[f64; 2]>,
    pub blocked: bool,
}

impl Recorded<'_> {
    /// What was recorded of what member `k` of `run` stands for.
    pub fn look_up(&self, run: &Run, k: usize) -> Sampled {
        let is_seen = self.located.is_seen() && !self.blocked;
        let mean = match is_seen && run.filters(self.texture) {
            true => self.mean(run, k),
            false => None,
        };
        mean.unwrap_or_else(|| self.at(self.located, self.time))
    }

    fn at(&self, located: &Located, time: f64) -> Sampled {
        let (texture, capture) = (self.texture, self.capture);
        match self.span {
            Some(span) => texture.mean_located(
                capture,
                located,
                span.map(|after| time + after),
                self.blocked,
            ),
            None => texture.sample_located(capture, located, time, self.blocked),
        }
    }

    fn mean(&self, run: &Run, k: usize) -> Option<Sampled> {
        let footprint = run.footprint(k, self.clock)?;
        let place = |position: DVec3| self.capture.project(position).map(DVec2::from_array);
        let own = place(self.point.position)?;
        let [across, down] = &footprint.sides;
        let length =
            |side: &Side| Some((place(self.point.position + side.position)? - own).length());
        let texels = [length(across)?, length(down)?];
        footprint.mean(texels, |parts| {
            let beside = across.position * parts[0] + down.position * parts[1];
            let point = CapturePoint {
                position: self.point.position + beside,
                ..self.point
            };
            let located = self.texture.locate(self.capture, &point);
            // Beyond the end of the surface, or where another hides it, the sample's own place stands in.
            let located = if located.is_seen() {
                located
            } else {
                *self.located
            };
            self.at(&located, self.time + footprint.later(parts))
        })
    }
}
