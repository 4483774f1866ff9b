//! Where the light of pulses falls: what [`Arrival`] gives, less what stands in its way.
//!
//! Shadows are asked for last, for all points of a run together.

use super::emitted::Emitted;
use super::occlusion::OcclusionQuery;
use super::point::SurfacePoint;
use super::run::Run;
use super::stats::Meter;
use super::surfaces::Surfaces;
use crate::colour::RgbShift;
use crate::light::pulse::{Arrival, Incident};
use crate::scene::model::Pulse;
use crate::spacetime::Quantity;

/// Adds the light of one pulse to what falls on the points of `run`, in a medium of index `index`.
pub(super) fn illuminate(
    run: &Run,
    pulse: &Pulse,
    quantity: Quantity,
    shift: Option<&RgbShift>,
    index: f64,
    emitted: &mut Emitted,
    meter: &mut Meter,
) {
    let (surfaces, rays) = (run.traced.surfaces, &run.traced.rays);
    emitted.arriving.clear();
    emitted.queries.clear();
    for (k, point) in run.points().enumerate() {
        let Some(arrival) = Arrival::at(pulse, &point.ray, point.hit.s, index) else {
            continue;
        };
        let Some(incident) = incident(surfaces, &arrival, pulse, (quantity, shift), &point) else {
            continue;
        };
        emitted.arriving.push((k, incident));
        if pulse.shadows {
            let query = OcclusionQuery::new(&point, arrival.d, arrival.distance);
            emitted.queries.queries.push(query);
        }
    }
    if pulse.shadows {
        surfaces.occlude(&mut emitted.queries, index, rays.method, meter);
    }
    for (at, (k, incident)) in emitted.arriving.iter().enumerate() {
        if emitted.queries.blocked.get(at) != Some(&true) {
            emitted.incident[*k].add(incident);
        }
    }
}

/// The light of a pulse on the side of the surface that faces the camera, if nothing is in its way.
#[inline]
fn incident(
    surfaces: &Surfaces,
    arrival: &Arrival,
    pulse: &Pulse,
    (quantity, shift): (Quantity, Option<&RgbShift>),
    point: &SurfacePoint,
) -> Option<Incident> {
    let (d, rho) = surfaces.direction(point.frame, arrival.d);
    let cosine = point.facing_normal().dot(d.unit());
    if cosine <= 0.0 {
        return None;
    }
    Some(arrival.incident(pulse, quantity, shift, rho, cosine))
}
