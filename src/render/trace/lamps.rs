//! Where the light of lamps falls: what [`Lamp`] gives, less what stands in its way.
//!
//! All points of a run are lit together, in loops over arrays; only colours are looked up point by point, where
//! light has been found to come. Shadows are asked for before that, for all points together.

use glam::DVec3;

use super::emitted::Emitted;
use super::run::Run;
use super::stats::Meter;
use crate::accel::vectors::{BLOCK, Columns, VectorLoop, dispatch, load, store};
use crate::light::lamp::{Incident, Irradiance, Lamp};
use crate::light::reflection::Reflection;
use crate::spacetime::{Boost, Direction, Rest, World};

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
    falling.resize(count);
    dispatch(Fall {
        boost: surfaces.boost(run.frame),
        d: &falling.arrivals.d,
        emitted: &falling.arrivals.ratio,
        normals: &points.normals,
        l: &mut falling.l,
        cosines: &mut falling.cosines,
        ratios: &mut falling.ratios,
    });
    lamp.incident_factors(
        &falling.arrivals,
        &falling.ratios,
        &falling.cosines,
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
    let mut open = 0;
    for at in 0..falling.lit.len() {
        if !queries.is_blocked(at) {
            falling.lit[open] = falling.lit[at];
            open += 1;
        }
    }
    falling.lit.truncate(open);

    // Diffuse surfaces reflect the sum; others each light by itself.
    let light = |k: usize| lamp.incident_at(falling.ratios[k], falling.factors[k]);
    let lit = falling.lit.iter().map(|k| *k as usize);
    if reflections.is_empty() {
        lit.for_each(|k| incident[k].add(&light(k)));
        return;
    }
    Reflection::values(reflections, &falling.lit, &falling.l, &mut falling.values);
    for (at, k) in lit.enumerate() {
        reflect(
            &light(k),
            falling.values.get(at),
            &mut incident[k],
            &mut added[k],
        );
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
        if queries.is_blocked(at) {
            continue;
        }
        match reflections.get(*k) {
            // A matte surface multiplies its colour once, later; any other needs the direction of the light.
            None => incident[*k].add(light),
            Some(reflection) => {
                let value = DVec3::from_array(reflection.value(*l));
                reflect(light, value, &mut incident[*k], &mut added[*k]);
            }
        }
    }
}

/// Adds what is reflected of `light` by a surface with this value of f.
#[inline(always)]
fn reflect(light: &Incident, value: DVec3, incident: &mut Irradiance, added: &mut [f64; 3]) {
    incident.weigh(light);
    let parts = value.to_array().into_iter().zip(light.irradiance);
    for (sum, (value, e)) in added.iter_mut().zip(parts) {
        *sum += value * e;
    }
}

/// From what comes of a lamp to how it falls on points of a rest frame.
struct Fall<'a> {
    /// To the rest frame; none where nothing changes.
    boost: Option<&'a Boost<Rest, World>>,
    d: &'a Columns,
    /// ω_G/ω_world.
    emitted: &'a [f64],
    normals: &'a Columns,
    l: &'a mut Columns,
    cosines: &'a mut [f64],
    ratios: &'a mut [f64],
}

impl VectorLoop for Fall<'_> {
    #[inline(always)]
    fn run(self) {
        let Fall {
            boost,
            d,
            emitted,
            normals,
            l,
            cosines,
            ratios,
        } = self;
        let mut begin = 0;
        while begin < cosines.len() {
            let (mut d, normals) = (d.load(begin), normals.load(begin));
            let mut ratio = load(emitted, begin);
            let mut cosine = [0.0; BLOCK];
            // W = (ω_G/ω_world)/(ω_F/ω_world).
            if let Some(boost) = boost {
                for (k, ratio) in ratio.iter_mut().enumerate() {
                    let (in_rest, rho) = boost.direction(Direction::from_unit(d.get(k)));
                    d.set(k, in_rest.unit());
                    *ratio /= rho;
                }
            }
            for (k, cosine) in cosine.iter_mut().enumerate() {
                *cosine = normals.get(k).dot(d.get(k));
            }
            l.store(&d, begin);
            store(&cosine, cosines, begin);
            store(&ratio, ratios, begin);
            begin += BLOCK;
        }
    }
}
