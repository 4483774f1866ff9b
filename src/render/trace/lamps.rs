//! Illumination by lamps: the light of each [`Lamp`], minus shadows.
//!
//! All points of a run are lit together, in loops over arrays; only colours of spectra are looked up point by point, for points that are
//! lit. Shadows are tested beforehand, for all points together.

use glam::DVec3;

use super::emitted::Emitted;
use super::lamp_light::{Gathered, LampLight};
use super::occlusion::any_to_point;
use super::run::Run;
use super::stats::Meter;
use crate::accel::vectors::{
    BLOCK, Block, Columns, VectorLoop, Vectors, VectorsRef, block_of, dispatch, load, store,
};
use crate::light::lamp::{Incident, Kept, Lamp};
use crate::light::reflection::{Coefficients, Glosses, Reflection};

/// Adds the light of one lamp to the points of `run`, in a medium of index `index`.
pub(super) fn illuminate(
    run: &Run,
    lamp: &Lamp,
    index: f64,
    emitted: &mut Emitted,
    meter: &mut Meter,
) {
    let Emitted {
        points,
        views,
        lamp_light,
        queries,
        leaving,
        starts,
        blocked,
        incident,
        glosses,
        reflections,
        added,
        is_unlit,
        spectral,
        ..
    } = emitted;
    let surfaces = run.traced.surfaces;

    // The light that arrives at each point, and its angle of incidence.
    let LampLight {
        arrivals,
        incidence,
        colours,
        lit,
        values,
    } = lamp_light;
    let boost = surfaces.boost(run.frame);
    let (on_rays, normals) = (points.on_rays(), &points.normals);
    // Shadow rays need directions to the lamp, unless they all end at one point of the frame.
    let end = surfaces.at_rest().zip(lamp.place());
    let is_matte = glosses.is_empty() && reflections.is_empty();
    let needs_ways = lamp.shadows && end.is_none();
    let constant = lamp.constant_colour().map(DVec3::from_array);
    let kept = Kept {
        directions: !is_matte || points.is_smooth(),
        ratios: constant.is_none() || incident.weighs || !reflections.is_empty(),
    };
    // One loop for steady, isotropic lamps if no shadow ray needs directions of the world; otherwise arrivals are stored first.
    if needs_ways || !lamp.incidence_at((&on_rays, index), boost, normals, kept, incidence) {
        lamp.arrivals(&on_rays, index, arrivals);
        lamp.incidence(arrivals, boost, normals, incidence);
    }

    // Remove light from below a surface with vertex normals.
    if points.is_smooth() {
        for k in 0..points.count() {
            if points.is_below(k, incidence.l(arrivals).get(k)) {
                incidence.darken(k);
            }
        }
    }

    // Remove light that is blocked.
    if lamp.shadows {
        find_lit(incidence.factors(), lit);
        let blocked = match end {
            Some((rest, end)) => {
                leaving.fill(points, lit, end, starts);
                let (method, counts) = (run.traced.rays.method, meter.occlusion());
                any_to_point(&rest.bvh, method, leaving.towards(end), blocked, counts);
                &blocked[..]
            }
            None => {
                queries.fill(lit, &arrivals.d, &arrivals.distance);
                surfaces.occlude(queries, run, points, index, meter);
                queries.blocked()
            }
        };
        for (k, blocked) in lit.iter().zip(blocked) {
            if *blocked {
                incidence.darken(*k as usize);
            }
        }
    }

    // Lines are followed one by one.
    if lamp.is_of_lines() && spectral.is_sampled() {
        find_lit(incidence.factors(), lit);
        for k in lit.iter().map(|k| *k as usize) {
            for line in lamp.lines(incidence.ratios()[k]) {
                let line = line.scaled(incidence.factors()[k]);
                spectral.reflect(k, line, &glosses.colours, |of| {
                    of.value(incidence.l(arrivals).get(k))
                });
            }
        }
        return;
    }

    // The lamp's intensity as seen at the W of each lit point.
    if constant.is_none() {
        colours.resize(points.count());
        let seen = incidence.ratios().iter().zip(incidence.factors());
        for (k, (w, factor)) in seen.enumerate() {
            let is_lit = *factor != 0.0;
            let colour = match spectral.at(k) {
                _ if !is_lit => [0.0; 3],
                Some(wavelengths) => lamp.at(*w, *wavelengths),
                None => lamp.colour(*w),
            };
            colours.set(k, colour.into());
        }
    }
    let light = Light {
        constant,
        colours,
        ratios: lamp.shifts_wavelengths().then_some(incidence.ratios()),
        factors: incidence.factors(),
    };
    // A separate loop for each kind of surface: matte surfaces reflect the sum later, others each light by itself.
    if !glosses.is_empty() {
        return dispatch(Gloss {
            light,
            glosses,
            normals: &points.normals,
            views: match points.unit_tangents() {
                Some(tangents) => (tangents, -1.0),
                None => (views, 1.0),
            },
            l: incidence.l(arrivals),
            gathered: incident,
            is_first: std::mem::take(is_unlit),
            added,
        });
    }
    if reflections.is_empty() {
        return dispatch(Gather {
            light,
            is_first: std::mem::take(is_unlit),
            gathered: incident,
        });
    }
    find_lit(incidence.factors(), lit);
    Reflection::values(reflections, lit, incidence.l(arrivals), values);
    for (at, k) in lit.iter().enumerate() {
        let k = *k as usize;
        let (w, factor) = (incidence.ratios()[k], incidence.factors()[k]);
        let light = match spectral.is_sampled() {
            true => Incident::new((colours.get(k) * factor).to_array(), 1.0),
            false => lamp.incident_at(w, factor),
        };
        reflect(k, &light, values.get(at), incident, added);
    }
}

/// Fills `lit` with the indices of nonzero factors.
fn find_lit(factors: &[f64], lit: &mut Vec<u32>) {
    lit.resize(factors.len(), 0);
    let mut count = 0;
    // Each index is written, and stays only if it is lit: no branch, and count ≤ k keeps within bounds.
    for (k, factor) in factors.iter().enumerate() {
        lit[count] = k as u32;
        count += usize::from(*factor != 0.0);
    }
    lit.truncate(count);
}

/// Adds the arriving light that is not blocked, testing for obstacles if `shadows` is set; `value` is f.
pub(super) fn reflect_unblocked(
    value: impl Fn(&Reflection, DVec3) -> [f64; 3],
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
        glosses,
        spectral,
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
            // A matte surface multiplies by its colour once, later; all others need the direction of the light.
            None => incident.add(*k, light),
            Some(reflection) => {
                let value = DVec3::from_array(value(reflection, *l));
                reflect(*k, light, value, incident, added);
            }
        }
    }
    let mut lines = std::mem::take(&mut spectral.arriving);
    for (at, line) in lines.drain(..) {
        if !queries.is_blocked(at) {
            let (k, _, l) = &arriving[at];
            spectral.reflect(*k, line, &glosses.colours, |of| value(of, *l));
        }
    }
    spectral.arriving = lines;
}

/// Adds the reflection of `light` at point `k`, whose surface has this value of f.
#[inline(always)]
fn reflect(k: usize, light: &Incident, value: DVec3, gathered: &mut Gathered, added: &mut Columns) {
    let mut all = gathered.get(k);
    all.weigh(light);
    gathered.set(k, &all);
    added.set(
        k,
        added.get(k) + value * DVec3::from_array(light.irradiance),
    );
}

/// The light of one lamp at points of surfaces.
#[derive(Clone, Copy)]
struct Light<'a> {
    /// The lamp's intensity as seen: the same everywhere, or by point.
    constant: Option<DVec3>,
    colours: &'a Columns,
    /// Wavelengths relative to the lamp's; `None` if the colours already include the shift.
    ratios: Option<&'a [f64]>,
    /// Factors on the intensity; 0 where no light falls.
    factors: &'a [f64],
}

impl<'a> Light<'a> {
    /// The factors of a block, if any light arrives there: in place, or copied to `last`.
    #[inline(always)]
    fn factors<'b>(&self, begin: usize, last: &'b mut Block) -> Option<&'b Block>
    where
        'a: 'b,
    {
        let factors = block_of(self.factors, begin, last);
        // Bits are combined in fewer instructions than comparisons.
        let mut bits = 0;
        for factor in factors {
            bits |= factor.to_bits();
        }
        (bits != 0).then_some(factors)
    }

    /// Sets `irradiance` to the irradiance at a block of points with these factors.
    #[inline(always)]
    fn irradiate(&self, begin: usize, factors: &Block, irradiance: &mut Vectors) {
        match self.constant {
            Some(colour) => {
                for (k, factor) in factors.iter().enumerate() {
                    irradiance.set(k, colour * *factor);
                }
            }
            None => {
                let colours = self.colours.block(begin);
                for (k, factor) in factors.iter().enumerate() {
                    irradiance.set(k, colours.get(k) * *factor);
                }
            }
        }
    }

    /// The wavelength scales of a block.
    #[inline(always)]
    fn scales(&self, begin: usize, factors: &Block) -> Block {
        let ratios = match self.ratios {
            Some(ratios) => load(ratios, begin),
            None => [1.0; BLOCK],
        };
        let mut scales = [0.0; BLOCK];
        for k in 0..BLOCK {
            // W may be NaN for points without light.
            scales[k] = if factors[k] != 0.0 { ratios[k] } else { 0.0 };
        }
        scales
    }
}

impl Gathered {
    /// Adds to the weights of a block with these factors, if they are needed, in the order of
    /// [`Irradiance::weigh`](crate::light::lamp::Irradiance::weigh).
    #[inline(always)]
    fn weigh(&mut self, begin: usize, light: &Light, factors: &Block, irradiance: &Vectors) {
        if !self.weighs {
            return;
        }
        let scales = light.scales(begin, factors);
        let mut weight = load(&self.weight, begin);
        let mut weighted = load(&self.weighted, begin);
        for k in 0..BLOCK {
            let (e, scale) = (irradiance.get(k), scales[k]);
            // From left to right: `+=` would add up the three first, and round differently.
            weight[k] = weight[k] + e.x + e.y + e.z;
            weighted[k] = weighted[k] + e.x * scale + e.y * scale + e.z * scale;
        }
        store(&weight, &mut self.weight, begin);
        store(&weighted, &mut self.weighted, begin);
    }
}

/// The loop that adds light at matte surfaces.
struct Gather<'a> {
    light: Light<'a>,
    /// Whether this is the first light, and previous contents are ignored.
    is_first: bool,
    gathered: &'a mut Gathered,
}

impl VectorLoop for Gather<'_> {
    #[inline(always)]
    fn run(self) {
        let Gather {
            light,
            is_first,
            gathered,
        } = self;
        let (mut irradiance, mut sum) = (Vectors::ZERO, Vectors::ZERO);
        // If wavelengths have no weights, light of one colour needs no block of irradiances.
        let plain = match gathered.weighs {
            true => None,
            false => light.constant,
        };
        let mut last = [0.0; BLOCK];
        let mut begin = 0;
        while begin < light.factors.len() {
            // A dark block leaves the sum as it is; the first light has to write its zeros.
            let Some(factors) = light.factors(begin, &mut last) else {
                if is_first {
                    gathered.sum.store(&Vectors::ZERO, begin);
                }
                begin += BLOCK;
                continue;
            };
            // Light of one colour is added to the sum in place, channel by channel.
            if let (Some(colour), Some(sum)) = (plain, gathered.sum.block_mut(begin)) {
                for (sum, intensity) in sum.into_iter().zip(colour.to_array()) {
                    if is_first {
                        for (sum, factor) in sum.iter_mut().zip(factors) {
                            *sum = intensity * *factor;
                        }
                    } else {
                        for (sum, factor) in sum.iter_mut().zip(factors) {
                            *sum += intensity * *factor;
                        }
                    }
                }
            } else {
                light.irradiate(begin, factors, &mut irradiance);
                let before = before(&gathered.sum, is_first, begin);
                for k in 0..BLOCK {
                    sum.set(k, before.get(k) + irradiance.get(k));
                }
                gathered.sum.store(&sum, begin);
                gathered.weigh(begin, &light, factors, &irradiance);
            }
            begin += BLOCK;
        }
    }
}

/// The contents of `sum` before light is added: zero for the first light.
#[inline(always)]
fn before(sum: &Columns, is_first: bool, begin: usize) -> VectorsRef<'_> {
    const NOTHING: &Vectors = &Vectors::ZERO;
    match is_first {
        true => NOTHING.as_ref(),
        false => sum.block(begin),
    }
}

/// The loop that adds light reflected by glossy surfaces.
struct Gloss<'a> {
    light: Light<'a>,
    glosses: &'a Glosses,
    normals: &'a Columns,
    /// Vectors which, multiplied by the factor, point to the observer.
    views: (&'a Columns, f64),
    l: &'a Columns,
    gathered: &'a mut Gathered,
    /// Whether this is the first light, and previous contents are ignored.
    is_first: bool,
    added: &'a mut Columns,
}

/// A block of points of glossy surfaces.
struct Glossy<'a> {
    n: VectorsRef<'a>,
    v: (VectorsRef<'a>, f64),
    l: VectorsRef<'a>,
}

/// Reflection parameters of a block.
struct Reflectances<'a> {
    colours: VectorsRef<'a>,
    metallic: &'a Block,
    roughness: &'a Block,
    /// f₀ of the dielectric part.
    dielectric: f64,
}

impl Glossy<'_> {
    /// Sets `sum` to `before` plus what the points reflect of light of this colour times these factors, if all points have the same
    /// coefficients; `ROUGHEST` and `METAL` as in [`Coefficients::kind`].
    #[inline(always)]
    fn add_alike<const ROUGHEST: bool, const METAL: bool>(
        &self,
        of: Coefficients,
        (colour, factors): (DVec3, &Block),
        before: VectorsRef,
        sum: &mut Vectors,
    ) {
        for (k, factor) in factors.iter().enumerate() {
            let value = self.value::<ROUGHEST, METAL>(&of, k);
            let more = before.get(k) + value * (colour * *factor);
            // f may be NaN for points without light.
            let is_lit = *factor != 0.0;
            sum.set(k, if is_lit { more } else { before.get(k) });
        }
    }

    /// The same for any `irradiance` with these factors, where points have different coefficients; `ROUGHEST` says that all
    /// roughnesses are 1.
    #[inline(always)]
    fn add_each<const ROUGHEST: bool>(
        &self,
        reflectances: &Reflectances,
        (irradiance, factors): (&Vectors, &Block),
        before: VectorsRef,
        sum: &mut Vectors,
    ) {
        for (k, factor) in factors.iter().enumerate() {
            let look = [reflectances.metallic[k], reflectances.roughness[k]];
            let of = Coefficients::new(reflectances.colours.get(k), look, reflectances.dielectric);
            let value = self.value::<ROUGHEST, false>(&of, k);
            let more = before.get(k) + value * irradiance.get(k);
            let is_lit = *factor != 0.0;
            sum.set(k, if is_lit { more } else { before.get(k) });
        }
    }

    #[inline(always)]
    fn value<const ROUGHEST: bool, const METAL: bool>(&self, of: &Coefficients, k: usize) -> DVec3 {
        let (v, sign) = self.v;
        of.value_at::<ROUGHEST, METAL>(self.n.get(k), v.get(k) * sign, self.l.get(k))
    }
}

impl VectorLoop for Gloss<'_> {
    #[inline(always)]
    fn run(self) {
        let Gloss {
            light,
            glosses,
            normals,
            views,
            l,
            gathered,
            is_first,
            added,
        } = self;
        // If all points are alike, their coefficients are computed once, and their kind selects the loop.
        let shared = glosses.shared().map(|of| (of, of.kind()));
        let (mut irradiance, mut sum) = (Vectors::ZERO, Vectors::ZERO);
        let mut last = [[0.0; BLOCK]; 3];
        let mut begin = 0;
        while begin < light.factors.len() {
            let [last_factors, last_metallic, last_roughness] = &mut last;
            let Some(factors) = light.factors(begin, last_factors) else {
                if is_first {
                    added.store(&Vectors::ZERO, begin);
                }
                begin += BLOCK;
                continue;
            };
            // Light of one colour on points that are alike is used as colour times factor, without irradiances.
            if shared.is_none() || light.constant.is_none() || gathered.weighs {
                light.irradiate(begin, factors, &mut irradiance);
            }
            let points = Glossy {
                n: normals.block(begin),
                v: (views.0.block(begin), views.1),
                l: l.block(begin),
            };
            let before = before(added, is_first, begin);
            // The roughest surfaces, as is the default, need fewer square roots.
            match shared.zip(light.constant) {
                Some(((of, kind), colour)) => {
                    let light = (colour, factors);
                    match kind {
                        [true, true] => {
                            points.add_alike::<true, true>(of, light, before, &mut sum);
                        }
                        [true, false] => {
                            points.add_alike::<true, false>(of, light, before, &mut sum);
                        }
                        [false, _] => {
                            points.add_alike::<false, false>(of, light, before, &mut sum);
                        }
                    }
                }
                None => {
                    let look = glosses.begin(begin);
                    let reflectances = Reflectances {
                        colours: glosses.colours.block(look),
                        metallic: block_of(&glosses.metallic, look, last_metallic),
                        roughness: block_of(&glosses.roughness, look, last_roughness),
                        dielectric: glosses.dielectric,
                    };
                    // From the bits, without a branch: any roughness that is not exactly 1.
                    let mut others = 0;
                    for roughness in reflectances.roughness {
                        others |= roughness.to_bits() ^ 1.0f64.to_bits();
                    }
                    let light = (&irradiance, factors);
                    match others == 0 {
                        true => points.add_each::<true>(&reflectances, light, before, &mut sum),
                        false => points.add_each::<false>(&reflectances, light, before, &mut sum),
                    }
                }
            }
            added.store(&sum, begin);
            gathered.weigh(begin, &light, factors, &irradiance);
            begin += BLOCK;
        }
    }
}

#[cfg(test)]
mod tests;
