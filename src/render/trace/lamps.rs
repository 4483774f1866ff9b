//! Where the light of lamps falls: what [`Lamp`] gives, less what stands in its way.
//!
//! All points of a run are lit together, in loops over arrays; only colours are looked up point by point, where
//! light has been found to come. Shadows are asked for before that, for all points together.

use glam::DVec3;

use super::emitted::Emitted;
use super::run::Run;
use super::stats::Meter;
use crate::accel::vectors::{Columns, ColumnsRef, VectorLoop, dispatch};
use crate::light::lamp::{Arrivals, Incident, Irradiance, Lamp};
use crate::light::reflection::Reflection;

/// The light of one lamp at the points of a run, by point.
#[derive(Debug, Default)]
pub(super) struct Falling {
    arrivals: Arrivals,
    /// Towards the lamp in the points' rest frame, and ω_F/ω_world.
    l: Columns,
    rho: Vec<f64>,
    /// Of the angle of incidence.
    cosines: Vec<f64>,
    /// W, and factors on the lamp's intensity.
    ratios: Vec<f64>,
    factors: Vec<f64>,
    /// Points that it shines on.
    lit: Vec<u32>,
}

/// Adds the light of one lamp to what falls on the points of `run`, in a medium of index `index`.
pub(super) fn illuminate(
    run: &Run,
    lamp: &Lamp,
    index: f64,
    emitted: &mut Emitted,
    meter: &mut Meter,
) {
    let Emitted {
        points,
        falling,
        queries,
        incident,
        reflections,
        added,
        ..
    } = emitted;
    let surfaces = run.traced.surfaces;
    let count = points.count();

    // What comes to each point, and under which angle.
    lamp.arrivals(&points.on_rays(), index, &mut falling.arrivals);
    surfaces.directions(
        run.frame,
        &falling.arrivals.d,
        &mut falling.l,
        &mut falling.rho,
        count,
    );
    falling.cosines.resize(count, 0.0);
    dispatch(Cosines {
        normals: points.normals.first(count),
        directions: falling.l.first(count),
        cosines: &mut falling.cosines,
    });
    lamp.incident_factors(
        &falling.arrivals,
        &falling.rho,
        &falling.cosines,
        &mut falling.ratios,
        &mut falling.factors,
    );

    // Those that it shines on: on the side that the camera sees. Cosines are NaN where no light comes.
    falling.lit.clear();
    let strengths = falling.arrivals.strength.iter();
    for (k, (strength, cosine)) in strengths.zip(&falling.cosines).enumerate() {
        if *strength != 0.0 && *cosine > 0.0 {
            falling.lit.push(k as u32);
        }
    }
    queries.clear();
    if lamp.shadows {
        for k in falling.lit.iter().map(|k| *k as usize) {
            let (d, distance) = (falling.arrivals.d.get(k), falling.arrivals.distance[k]);
            queries.push(k, d, distance);
        }
        surfaces.occlude(queries, run, points, index, meter);
    }
    for (at, k) in falling.lit.iter().map(|k| *k as usize).enumerate() {
        if !queries.is_blocked(at) {
            let light = lamp.incident_at(falling.ratios[k], falling.factors[k]);
            let l = falling.l.get(k);
            reflect(k, &light, l, incident, reflections, added);
        }
    }
}

/// Adds the light that is arriving and that nothing stands in the way of, as far as `shadows` are asked for.
pub(super) fn reflect_unblocked(
    run: &Run,
    shadows: bool,
    index: f64,
    emitted: &mut Emitted,
    meter: &mut Meter,
) {
    let Emitted {
        points,
        queries,
        arriving,
        incident,
        reflections,
        added,
        ..
    } = emitted;
    if shadows {
        run.traced
            .surfaces
            .occlude(queries, run, points, index, meter);
    }
    for (at, (k, light, l)) in arriving.iter().enumerate() {
        if !queries.is_blocked(at) {
            reflect(*k, light, *l, incident, reflections, added);
        }
    }
}

/// Adds `light` from `l` to that at point `k`: diffuse surfaces reflect the sum, others each light by itself.
#[inline(always)]
fn reflect(
    k: usize,
    light: &Incident,
    l: DVec3,
    incident: &mut [Irradiance],
    reflections: &[Reflection],
    added: &mut [[f64; 3]],
) {
    match reflections.get(k) {
        None => incident[k].add(light),
        Some(reflection) => {
            incident[k].weigh(light);
            let value = reflection.value(l);
            let parts = value.iter().zip(light.irradiance);
            for (sum, (value, e)) in added[k].iter_mut().zip(parts) {
                *sum += value * e;
            }
        }
    }
}

/// Of the angles between normals and directions.
struct Cosines<'a> {
    normals: ColumnsRef<'a>,
    directions: ColumnsRef<'a>,
    cosines: &'a mut [f64],
}

impl VectorLoop for Cosines<'_> {
    #[inline(always)]
    fn run(self) {
        for (k, cosine) in self.cosines.iter_mut().enumerate() {
            *cosine = self.normals.get(k).dot(self.directions.get(k));
        }
    }
}
