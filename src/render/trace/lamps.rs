//! Where the light of lamps falls: what [`Lamp`] gives, less what stands in its way.
//!
//! Shadows are asked for last, for all points of a run together.

use glam::DVec3;

use super::emitted::Emitted;
use super::occlusion::OcclusionQuery;
use super::point::SurfacePoint;
use super::run::Run;
use super::stats::Meter;
use super::surfaces::Surfaces;
use crate::light::lamp::{Arrival, Incident, Lamp};

/// Adds the light of one lamp to what falls on the points of `run`, in a medium of index `index`.
pub(super) fn illuminate(
    run: &Run,
    lamp: &Lamp,
    index: f64,
    emitted: &mut Emitted,
    meter: &mut Meter,
) {
    let surfaces = run.traced.surfaces;
    emitted.arriving.clear();
    emitted.queries.clear();
    for (k, point) in run.points().enumerate() {
        let Some(arrival) = lamp.arrival(&point.ray, point.hit.s, index) else {
            continue;
        };
        let Some((incident, l)) = incident(surfaces, &arrival, lamp, &point) else {
            continue;
        };
        emitted.arriving.push((k, incident, l));
        if lamp.shadows {
            let query = OcclusionQuery::new(&point, arrival.d, arrival.distance);
            emitted.queries.queries.push(query);
        }
    }
    reflect_unblocked(run, lamp.shadows, index, emitted, meter);
}

/// Adds the light that is arriving and that nothing stands in the way of, as far as `shadows` are asked for.
pub(super) fn reflect_unblocked(
    run: &Run,
    shadows: bool,
    index: f64,
    emitted: &mut Emitted,
    meter: &mut Meter,
) {
    if shadows {
        let (surfaces, method) = (run.traced.surfaces, run.traced.rays.method);
        surfaces.occlude(&mut emitted.queries, index, method, meter);
    }
    for (at, (k, incident, l)) in emitted.arriving.iter().enumerate() {
        if emitted.queries.blocked.get(at) == Some(&true) {
            continue;
        }
        // Diffuse surfaces reflect the sum; others each light by itself.
        match emitted.reflections.get(*k) {
            None => emitted.incident[*k].add(incident),
            Some(reflection) => {
                emitted.incident[*k].weigh(incident);
                let value = reflection.value(*l);
                let parts = value.iter().zip(incident.irradiance);
                for (sum, (value, e)) in emitted.added[*k].iter_mut().zip(parts) {
                    *sum += value * e;
                }
            }
        }
    }
}

/// The light of a lamp on the side of the surface that faces the camera, if nothing is in its way, and its direction.
#[inline]
fn incident(
    surfaces: &Surfaces,
    arrival: &Arrival,
    lamp: &Lamp,
    point: &SurfacePoint,
) -> Option<(Incident, DVec3)> {
    let (d, rho) = surfaces.direction(point.frame, arrival.d);
    let cosine = point.facing_normal().dot(d.unit());
    if cosine <= 0.0 {
        return None;
    }
    Some((lamp.incident(arrival, rho, cosine), d.unit()))
}
