//! Sample footprints on surfaces: `reconstruction = "footprint"`.
//!
//! A sample at film point (x, y) stands for its cell of the pixel, a × b pixels (the whole pixel if there is one sample). The camera's own
//! rays through (x + h, y) and (x, y + h), h = ±2⁻¹⁰ towards the middle of the pixel, are transformed to the rest frame of the surface that
//! the sample hit. They intersect the plane of the triangle at events X_x and X_y, each at its own retarded time. (X_x − X)/h and (X_y −
//! X)/h are the derivatives of the seen event with respect to the film point (Igehy, "Tracing ray differentials", SIGGRAPH 1999, with
//! finite differences for differentials). They include distance, tilt, aberration, and the motion of the object, the camera and the pinhole
//! itself, for any camera. With (ξ₀, υ₀) the sample's position in its cell, from 0 to 1, the cell shows to first order
//!
//! ```text
//! X(ξ, υ) = X + (ξ − ξ₀) a ∂X/∂x + (υ − υ₀) b ∂X/∂y,   0 ≤ ξ, υ ≤ 1.
//! ```
//!
//! The mean over the cell is computed from n × m lookups at ((i + ½)/n, (j + ½)/m), each at its own position and time: n and m are the
//! lengths of the two sides in texels, rounded up, so that lookups, which interpolate linearly, are at most a texel apart. On a tilted
//! surface only one of the two numbers is large: the filter is anisotropic. The cells of a pixel's samples add up to the pixel. A side
//! shorter than a texel is not filtered; if both are, the result is the single lookup at the sample.
//!
//! **Time.** The light that a cell shows left at different times. For a pinhole at rest at distance r from a surface at rest, in a medium
//! of index η, the light left at t − ηr. Between the positions X and X + ∂X dx it is earlier by
//!
//! ```text
//! dt = η dr = η d̂ · ∂X dx = η r tan θ dφ        (d̂ the look direction, θ its angle with the normal, dφ that between rays)
//! ```
//!
//! The differences above contain this and all contributions of motion, as the times of X_x and X_y are those of the rays themselves. A part
//! of the cell, 1/n × 1/m of it, thus spans the times
//!
//! ```text
//! t + u α + v β,   |u|, |v| ≤ ½,   α = (a/n) ∂t/∂x,  β = (b/m) ∂t/∂y,
//! ```
//!
//! If |α| + |β| is at most one bin, the part is read at t. Otherwise the mean over (u, v) is that with a trapezoid in time, the convolution of boxes with
//! lengths α and β. The longer box is the mean over a span, by prefix sums, for any number of bins. The side of the shorter one is split into parts of one
//! bin, up to 16: then the slopes of the trapezoid become stairs of 16 steps, which leave less than 2/(12·16²) < 1/1000 of the variance of noise between
//! bins. If bins differ in width, lengths are in the narrowest.
//!
//! **Exposures.** If samples average over an exposure, the camera's time is a third side, from a ray through the same film point 2⁻¹⁰ of the
//! exposure sooner or later. If camera and object move relative to each other, the seen point slides: the side has a length in texels, and the
//! times of its ends are those at which the light left *there*. In time it is a third box. Samples stand for boxes in (x, y, time) that
//! together must fill the whole pixel and the whole exposure. The cells of n = a b samples, 1/a × 1/b of the pixel, each with its own n-th of
//! the time, do not: these are n of n² boxes, and average noise between bins or texels over only 1/n of the data. But of the samples in each
//! column of cells, one lies in each b-th of the time ([`Sampler::moment`](crate::render::sampler::Sampler::moment)): each sample then stands
//! for a column, with the pixel's full height, during a b-th of the time, and these boxes fill everything. Along the height, a first-order
//! approximation for one sample stays one for many.

use std::cell::Cell;
use std::ops::{Add, Mul};

use glam::{DVec2, DVec3};

use super::camera_rays::{CameraRays, TIME};
use super::emitted::{Emission, Emitted};
use super::run::Run;
use super::stats::{Counter, Meter};
use super::surface_point::EmissionClock;
use crate::light::time_texture::{Capture, CapturePoint, Located, Near, Sampled, TimeTexture};
use crate::scene::model::Reconstruction;
use crate::spacetime::{Direction, NullRay, World};

/// The maximum number of lookups along a side.
const MOST: f64 = 64.0;

/// The maximum number of parts of a box in time, if a longer box smooths over the parts.
const STEPS: f64 = 16.0;

/// Bounds the rounding error of a length that is a whole number of parts, up to MOST: it must not add a part.
const ROUNDING: f64 = 1e-9;

/// The cell that a sample stands for.
pub(super) struct Footprint {
    /// The sample's position in its cell, from 0 to 1.
    within: [f64; 3],
    /// Sides across, down, and in time; the last is zero if no exposure is integrated over.
    sides: [Side; 3],
    /// Whether an exposure is integrated over.
    is_exposed: bool,
}

/// The displacement from one side of a cell to the other.
#[derive(Debug, Clone, Copy, Default)]
struct Side {
    /// Position in the rest frame, metres.
    position: DVec3,
    /// Barycentric coordinates in the triangle.
    barycentric: DVec2,
    /// Emission time by the requested clock, metres.
    time: f64,
}

/// The intersection of a ray with a plane.
struct Meeting {
    position: DVec3,
    barycentric: DVec2,
    time: f64,
}

impl Run<'_> {
    /// Whether lookups in `texture` are means over footprints.
    pub(super) fn filters(&self, texture: &TimeTexture) -> bool {
        texture.reconstruction() == Reconstruction::Footprint
            && self.traced.rays.samples.cells.is_some()
    }

    /// The footprint of member `k`, with times by `clock`; `None` if a neighbouring ray does not intersect the member's plane.
    pub(super) fn footprint(&self, k: usize, clock: EmissionClock) -> Option<Footprint> {
        let cells = self.traced.rays.samples.cells.as_ref()?;
        let (hit, ray) = (self.hit(k)?, self.members[k] as usize);
        let corners = self.rest.bvh.corners(hit.slot);
        let own = self.meeting(cells.rays, ray, corners, clock)?;
        let mut footprint = Footprint {
            within: [0.0; 3],
            sides: [Side::default(); 3],
            is_exposed: cells.beside.len() > TIME,
        };
        for (axis, beside) in cells.beside.iter().enumerate() {
            let met = self.meeting(beside, ray, corners, clock)?;
            let (size, place) = (cells.size[axis], cells.rays.place(ray, axis));
            let per_side = size / (beside.place(ray, axis) - place);
            footprint.sides[axis] = Side {
                position: (met.position - own.position) * per_side,
                barycentric: (met.barycentric - own.barycentric) * per_side,
                time: (met.time - own.time) * per_side,
            };
            let cell = place / size;
            footprint.within[axis] = cell - cell.floor();
        }
        Some(footprint)
    }

    /// The intersection of ray `ray` of `rays` with the plane of the triangle with these corners.
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
        let surfaces = self.traced.surfaces;
        let local = NullRay {
            origin: surfaces.start(self.frame, origin.displacement),
            tangent: self.rest.frame.frame_from_world().tangent(index, d),
        };
        let (e1, e2) = (b - a, c - a);
        let normal = e1.cross(e2);
        // The ray parameter is the same in all frames.
        let s = normal.dot(a - local.origin.x) / normal.dot(local.tangent.x);
        if !(s > 0.0 && s.is_finite()) {
            return None;
        }
        let met = local.at(s);
        // Barycentrics by areas: those of (from_a, e2) and (e1, from_a) along the normal, over that of (e1, e2).
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

/// How the mean over a cell is split.
struct Split {
    /// The number of parts of each side.
    count: [usize; 3],
    /// The side whose parts are read as spans of time, if any; parts of the others are read at their middles.
    span: Option<usize>,
    /// Whether sides are split by time, because the times within a part span more than a bin.
    in_time: bool,
}

/// One part of a cell.
struct Part {
    /// The offset along each side from the sample's position.
    sides: [f64; 3],
    /// How much later than the sample's light the light of this part leaves.
    later: f64,
    /// The span of time around that, if it is read as a span.
    span: Option<[f64; 2]>,
}

impl Footprint {
    /// The mean of `look_up` over the cell, whose sides have these lengths in texels; `None` if a single lookup is enough.
    fn mean(
        &self,
        texture: &TimeTexture,
        texels: [f64; 3],
        mut look_up: impl FnMut(Part) -> Sampled,
    ) -> Option<Sampled> {
        let split = self.split(texture, texels);
        let [n, m, l] = split.count;
        if n * m * l == 1 && !split.in_time && !self.is_exposed {
            return None;
        }
        // Parts of equal size: their mean, at their middles, without weights.
        let mut sum = Sampled::default();
        for (e, j, i) in
            (0..l).flat_map(|e| (0..m).flat_map(move |j| (0..n).map(move |i| (e, j, i))))
        {
            let one = look_up(self.part(&split, [i, j, e]));
            for c in 0..3 {
                sum.radiance[c] += one.radiance[c];
                sum.unscaled[c] += one.unscaled[c];
            }
            sum.coverage += one.coverage;
        }
        let each = 1.0 / (n * m * l) as f64;
        Some(Sampled {
            radiance: sum.radiance.map(|c| c * each),
            unscaled: sum.unscaled.map(|c| c * each),
            coverage: sum.coverage * each,
        })
    }

    fn split(&self, texture: &TimeTexture, texels: [f64; 3]) -> Split {
        let parts = |length: f64, most: f64| (length - ROUNDING).ceil().clamp(1.0, most);
        let [across, down] = [parts(texels[0], MOST), parts(texels[1], MOST)];
        // With many positions, few parts of the slide are needed for each.
        let sliding = parts(texels[TIME], (MOST * MOST / (across * down)).min(MOST));
        let mut count = [across, down, sliding];
        let bins = self.sides.map(|side| texture.bins_in(side.time.abs()));
        let of_part: [f64; 3] = std::array::from_fn(|k| bins[k] / count[k]);
        let mut span = self.is_exposed.then_some(TIME);
        // |α| + |β| in bins.
        let in_time = of_part[0] + of_part[1] > 1.0;
        if in_time {
            let longest = (0..3).fold(
                0,
                |most, k| if of_part[k] > of_part[most] { k } else { most },
            );
            span = Some(longest);
            for k in (0..3).filter(|k| *k != longest) {
                count[k] = count[k].max(parts(bins[k], STEPS));
            }
        }
        Split {
            count: count.map(|count| count as usize),
            span,
            in_time,
        }
    }

    fn part(&self, split: &Split, number: [usize; 3]) -> Part {
        // A side in the film that is not split stays at the sample's position, unless times are averaged.
        let sides: [f64; 3] =
            std::array::from_fn(|k| match split.count[k] > 1 || split.in_time || k == TIME {
                true => (number[k] as f64 + 0.5) / split.count[k] as f64 - self.within[k],
                false => 0.0,
            });
        Part {
            sides,
            later: sides
                .iter()
                .zip(&self.sides)
                .fold(0.0, |sum, (part, side)| sum + part * side.time),
            span: split.span.map(|side| {
                let half = 0.5 * self.sides[side].time.abs() / split.count[side] as f64;
                [-half, half]
            }),
        }
    }
}

/// `from`, moved by these fractions of each side.
fn along<V: Copy + Mul<f64, Output = V> + Add<Output = V>>(
    from: V,
    sides: &[V; 3],
    parts: [f64; 3],
) -> V {
    sides
        .iter()
        .zip(parts)
        .fold(from, |at, (side, part)| at + *side * part)
}

/// Looks up `texture`, by texture coordinates, for the footprints of the points of `run`. Positions beyond the edges of the texture count
/// as those on its edges if the sample itself is inside.
pub(super) fn look_up(
    texture: &TimeTexture,
    set: usize,
    clock: EmissionClock,
    run: &Run,
    emitted: &mut Emitted,
    meter: &mut Meter,
) {
    let (is_on, mut read) = (meter.is_on(), 0);
    let near = std::mem::take(&mut emitted.near);
    let spans = run.spans(clock, &mut emitted.spans);
    emitted.times.resize(run.count(), 0.0);
    run.times(clock, 0, &mut emitted.times);
    let size = DVec2::from_array(texture.size_of_side().map(|n| n as f64));
    texture.look_up_each(&near, run.count(), |k| {
        let hit = run.hit(k);
        let front = hit.is_none_or(|hit| hit.front);
        // Extrapolated linearly beyond the triangle's edges: parts of a footprint lie in its plane.
        let at = |u: f64, v: f64| {
            let hit = hit.map(|hit| crate::accel::Hit { u, v, ..hit })?;
            run.rest.uv(run.patch, set, &hit)
        };
        let uv = hit.and_then(|hit| at(hit.u, hit.v)).unwrap_or(DVec2::NAN);
        let time = emitted.times[k];
        let span = spans.then(|| emitted.spans[k]);
        let mut one = |uv: DVec2, time: f64, span: Option<[f64; 2]>| {
            let uv = texture.on_side(uv, front);
            let span = span.map(|span| span.map(|after| time + after));
            if is_on && !near.is_asking() {
                read += texture.bytes_of_lookup(None, span);
            }
            match span {
                Some(span) => texture.mean_uv(uv, span, &near),
                None => texture.sample_uv_near(uv, time, &near),
            }
        };
        let mean = run
            .footprint(k, clock)
            .zip(hit)
            .and_then(|(footprint, hit)| {
                let beside =
                    |side: &Side| at(hit.u + side.barycentric.x, hit.v + side.barycentric.y);
                // Sides of the cell in texture coordinates, and in texels: n, m and l follow from these.
                let mut sides = [DVec2::ZERO; 3];
                for (to, side) in sides.iter_mut().zip(&footprint.sides) {
                    *to = beside(side)? - uv;
                }
                let is_on = |uv: DVec2| uv.cmpge(DVec2::ZERO).all() && uv.cmple(DVec2::ONE).all();
                let texels = sides.map(|side| (side * size).length());
                footprint.mean(texture, texels, |part| {
                    let place = along(uv, &sides, part.sides);
                    let place = match is_on(uv) {
                        true => place.clamp(DVec2::ZERO, DVec2::ONE),
                        false => place,
                    };
                    one(place, time + part.later, part.span)
                })
            });
        let sampled = mean.unwrap_or_else(|| one(uv, time, span));
        // While bricks are only being requested, there are no results to keep.
        if !near.is_asking() {
            emitted.push(Emission::stored(sampled));
        }
    });
    emitted.near = near;
    meter.count(Counter::TextureBytes, read);
}

/// One point of a run as a capture saw it, with the data that a lookup needs.
pub(super) struct Recorded<'a> {
    pub texture: &'a TimeTexture,
    pub capture: &'a Capture,
    pub clock: EmissionClock,
    pub point: CapturePoint,
    pub located: &'a Located,
    pub time: f64,
    /// The span of the exposure around that time.
    pub span: Option<[f64; 2]>,
    pub blocked: bool,
    /// Bricks in memory.
    pub near: &'a Near,
    /// The number of bytes that lookups have read, if counted.
    pub read: Option<&'a Cell<u64>>,
}

impl Recorded<'_> {
    /// The recorded radiance of the footprint of member `k` of `run`.
    pub fn look_up(&self, run: &Run, k: usize) -> Sampled {
        let is_seen = self.located.is_seen() && !self.blocked;
        let mean = match is_seen && run.filters(self.texture) {
            true => self.mean(run, k),
            false => None,
        };
        mean.unwrap_or_else(|| self.at(self.located, self.time, self.span))
    }

    fn at(&self, located: &Located, time: f64, span: Option<[f64; 2]>) -> Sampled {
        let (texture, capture) = (self.texture, self.capture);
        let span = span.map(|span| span.map(|after| time + after));
        if let Some(read) = self
            .read
            .filter(|_| !self.blocked && !self.near.is_asking())
        {
            read.set(read.get() + texture.bytes_of_lookup(Some(located), span));
        }
        match span {
            Some(span) => texture.mean_located(capture, located, span, self.blocked, self.near),
            None => texture.sample_located(capture, located, time, self.blocked, self.near),
        }
    }

    fn mean(&self, run: &Run, k: usize) -> Option<Sampled> {
        let footprint = run.footprint(k, self.clock)?;
        let place = |position: DVec3| self.capture.project(position).map(DVec2::from_array);
        let own = place(self.point.position)?;
        let sides = footprint.sides.map(|side| side.position);
        let mut texels = [0.0; 3];
        for (length, side) in texels.iter_mut().zip(sides) {
            *length = (place(self.point.position + side)? - own).length();
        }
        footprint.mean(self.texture, texels, |part| {
            let point = CapturePoint {
                position: self.point.position + along(DVec3::ZERO, &sides, part.sides),
                ..self.point
            };
            let located = self.texture.locate(self.capture, &point);
            // Beyond the end of the surface, or if another surface hides the position, use the sample's own.
            let located = if located.is_seen() {
                located
            } else {
                *self.located
            };
            self.at(&located, self.time + part.later, part.span)
        })
    }
}
