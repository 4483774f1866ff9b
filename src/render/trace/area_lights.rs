//! The light of shining surfaces.
//!
//! An element dA of a surface that rests in its frame G and has the radiance L there, seen from the point X of a surface that rests in F,
//! emitted its light at the event on the past light cone of X: in G a fixed point, at the distance r_G. It subtends the solid angle dω_F =
//! W² dω_G = W² cos θ_y dA/r_G², and L_F = W⁻ᵖ L, so that
//!
//! ```text
//! E_F = ∫ W²⁻ᵖ L cos θ_y cos θ_F/r_G² dA.
//! ```
//!
//! If L changes with the proper time of the surface's object, it is evaluated at the event of emission: in G the time of X minus η r_G.
//!
//! Every hit samples one point on one of all elements, as described in [`shining_frames`](super::shining_frames). Obstacles are black:
//! light is traced for one step only.

use glam::DVec3;

use super::base_colours::{BaseColour, BaseColours};
use super::emitted::Emitted;
use super::lamps::reflect_unblocked;
use super::light_tree::{Density, Shining};
use super::rest_frame::RestFrame;
use super::run::Run;
use super::shining_frames::ShiningFrames;
use super::spherical_triangle::Triangle;
use super::stats::Meter;
use super::surface_point::SurfacePoint;
use super::surfaces::Surfaces;
use crate::accel::Hit;
use crate::accel::vectors::{Block, Columns};
use crate::colour::{ColourTable, Wavelengths};
use crate::light::Received;
use crate::light::lamp::{self, Incident};
use crate::light::reflection::Reflection;
use crate::spacetime::unit_and_length_or_nan;

/// Dimensions of a hit's random numbers, in addition to those of [`sky_light`](super::sky_light).
const AREA: u32 = 0;

/// The approximate number of triangles whose emission times are checked.
const MOST_TIMED: usize = 32;

/// Shining surfaces.
#[derive(Debug)]
pub struct AreaLights {
    /// By frame and triangle.
    elements: Vec<Element>,
    /// Their triangles, arranged for sampling.
    shining: ShiningFrames,
    /// How surfaces receive the elements' light.
    received: Received,
}

/// A shining triangle.
#[derive(Debug, Clone)]
pub struct Element {
    /// Its rest frame.
    pub frame: u32,
    /// Its index in the frame's BVH.
    pub triangle: u32,
    /// Its corners in the frame.
    pub corners: [DVec3; 3],
    /// Radiance, by channel.
    pub radiance: BaseColour,
    /// The spectrum that the mean of the channels multiplies, if it has one.
    pub spectrum: Option<std::sync::Arc<ColourTable>>,
    /// Whether its back shines, too.
    pub two_sided: bool,
    /// Whether other surfaces cast shadows in its light.
    pub shadows: bool,
}

impl Element {
    /// Its approximate brightness at rest, for sampling.
    fn brightness(&self) -> f64 {
        let factor = self.radiance.factor.iter().sum::<f64>();
        let Some(table) = &self.spectrum else {
            return factor;
        };
        // Light that is invisible at rest may be visible in motion.
        let at_rest: f64 = table.colour(1.0).iter().sum();
        factor * if at_rest > 0.0 { at_rest } else { 1.0 }
    }

    fn power(&self) -> f64 {
        Triangle::new(self.corners).area() * self.brightness()
    }
}

/// A sampled point of an area light, for a point in the same rest frame.
pub(super) struct AreaDraw<'a> {
    /// Brightness as a function of proper time.
    pub emission: &'a lamp::Emission,
    /// The frame's time at which the proper time is 0.
    pub clock_zero: f64,
    pub triangle: u32,
    pub distance: f64,
    /// Of the angle between the direction and the triangle's normal.
    pub cosine: f64,
    /// The irradiance for an emission of 1, over the density.
    pub light: [f64; 3],
    pub sent: Sent,
}

/// A sample of area lights, reduced to what its weight depends on.
pub(super) struct Sent {
    /// Direction to the sampled point, in the rest frame of the point that is lit.
    pub l: DVec3,
    /// Whether other surfaces block it.
    pub shadows: bool,
    /// Density per solid angle in the rest frame of the point that is lit.
    pub density: f64,
}

impl AreaLights {
    /// Keeps the elements that have an area and shine; `None` if there are none.
    pub fn new(elements: Vec<Element>, received: Received) -> Option<AreaLights> {
        let shines = |e: &Element| e.power() > 0.0 && e.power().is_finite();
        let mut elements: Vec<_> = elements.into_iter().filter(shines).collect();
        // The order must not depend on trees built for other purposes.
        elements.sort_by_key(|e| (e.frame, e.triangle));
        let sum: f64 = elements.iter().map(Element::power).sum();
        if !(sum > 0.0 && sum.is_finite()) {
            return None;
        }
        let shining = elements.iter().map(|e| {
            let shining = Shining {
                triangle: Triangle::new(e.corners),
                brightness: e.brightness() / sum,
                two_sided: e.two_sided,
            };
            (e.frame, e.triangle, shining)
        });
        Some(AreaLights {
            shining: ShiningFrames::new(&shining.collect::<Vec<_>>()),
            elements,
            received,
        })
    }

    /// Adds the light of all elements at the points of `run`, in a medium of index `index`.
    pub(super) fn illuminate(
        &self,
        base: &BaseColours,
        run: &Run,
        index: f64,
        emitted: &mut Emitted,
        meter: &mut Meter,
    ) {
        let [x, y] = &mut emitted.numbers;
        x.clear();
        y.clear();
        for k in 0..run.count() {
            let numbers = run.random(k, AREA);
            x.push(numbers[0]);
            y.push(numbers[1]);
        }
        self.illuminate_by(|_, _| 1.0, base, run, index, emitted, meter);
    }

    /// The same with the random numbers in `emitted.numbers`, and the light at each point weighted by `weight`.
    pub(super) fn illuminate_by(
        &self,
        weight: impl Fn(Option<&Reflection>, &Sent) -> f64,
        base: &BaseColours,
        run: &Run,
        index: f64,
        emitted: &mut Emitted,
        meter: &mut Meter,
    ) {
        self.shining.draw(run, emitted);
        // Elements with and without shadows are handled separately: the rays of a batch are either all traced or all unoccluded.
        for shadows in [true, false] {
            let Emitted {
                draws,
                arriving,
                queries,
                reflections,
                spectral,
                ..
            } = &mut *emitted;
            arriving.clear();
            queries.clear();
            for k in 0..run.count() {
                let element = &self.elements[draws.elements[k] as usize];
                if draws.factors[k] == 0.0 || element.shadows != shadows {
                    continue;
                }
                let shines = element
                    .radiance
                    .factor_at(|| proper_time(run, element, (draws.u[k], draws.v[k]), k, index));
                // Dark when its light left: no shadow ray is needed.
                if shines == 0.0 {
                    continue;
                }
                let l = draws.l.get(k);
                let density = draws.densities[k];
                let sent = Sent {
                    l,
                    shadows,
                    density,
                };
                let weight = weight(reflections.get(k), &sent);
                let rest = run.traced.surfaces.rest(element.frame);
                let place = (rest, element, (draws.u[k], draws.v[k]));
                let radiance = Self::radiance_of(base, place);
                let (w, factor) = (draws.ratios[k], draws.factors[k]);
                let incident = self.incident_of(element, radiance, w, factor, spectral.at(k));
                // Lines are added to the sampled light.
                if let Some(table) = element.spectrum.as_ref().filter(|_| spectral.is_sampled()) {
                    let factor = w * w * factor * mean(radiance) * weight * shines;
                    let lines = table.spectrum().lines();
                    let lines = lines.map(|line| line.received(w).scaled(factor));
                    let lines = lines.map(|line| (arriving.len(), line));
                    spectral.arriving.extend(lines);
                }
                arriving.push((k, incident.scaled(weight * shines), l));
                let end = (element.frame, element.triangle);
                queries.push_to(k, draws.d.get(k), draws.distances[k], end);
            }
            reflect_unblocked(Reflection::value, run, shadows, index, emitted, meter);
            // Usually nothing is left for the second pass.
            if self.elements.iter().all(|e| e.shadows) {
                break;
            }
        }
    }

    /// The radiance at a place of `element`, which rests in `rest`.
    fn radiance_of(
        base: &BaseColours,
        (rest, element, (u, v)): (&RestFrame, &Element, (f64, f64)),
    ) -> [f64; 3] {
        match element.radiance.constant() {
            // Holes do not shine.
            _ if !rest.bvh.is_opaque(element.triangle, [u, v]) => [0.0; 3],
            Some(radiance) => radiance,
            None => {
                let hit = Hit {
                    s: 0.0,
                    u,
                    v,
                    triangle: element.triangle,
                    slot: 0,
                    front: true,
                };
                base.colour_at(&element.radiance, rest, rest.patch(element.triangle), &hit)
            }
        }
    }

    /// The light that arrives at a point that sees `element` with this radiance at W; `factor` is cos θ_y cos θ_F/r² over the density. The result
    /// is by channel, or at `wavelengths`, without the spectrum's lines.
    fn incident_of(
        &self,
        element: &Element,
        radiance: [f64; 3],
        w: f64,
        factor: f64,
        wavelengths: Option<&Wavelengths>,
    ) -> Incident {
        let irradiance = match (&element.spectrum, wavelengths) {
            (None, None) => self.received.irradiance(w, radiance, factor),
            // W⁻⁵ is included in the colour, but W² of the solid angle is not.
            (Some(table), None) => {
                let factor = w * w * factor * radiance.iter().sum::<f64>() / 3.0;
                table.colour(w).map(|c| c * factor)
            }
            (None, Some(wavelengths)) => {
                let factor = w * w * factor;
                let seen = self.received.at(w, radiance, *wavelengths);
                seen.map(|l| l * factor)
            }
            (Some(table), Some(wavelengths)) => {
                let factor = w * w * factor * mean(radiance);
                table.spectrum().at(w, *wavelengths).map(|l| l * factor)
            }
        };
        Incident::new(irradiance, self.received.wavelength_scale(w))
    }

    /// Whether the brightness of any element changes with time.
    pub(super) fn changes(&self) -> bool {
        self.elements.iter().any(|e| e.radiance.profile.is_some())
    }

    /// Calls `each` with every object that has an emission profile, the profile, and the time at which the light from the corners of its
    /// elements to `point` was emitted.
    pub(crate) fn times_at(
        &self,
        surfaces: &Surfaces,
        point: &SurfacePoint,
        index: f64,
        mut each: impl FnMut(u32, &lamp::Emission, f64),
    ) {
        let changes = |e: &&Element| e.radiance.profile.is_some();
        let count = self.elements.iter().filter(changes).count();
        let step = count.div_ceil(MOST_TIMED).max(1);
        for element in self.elements.iter().filter(changes).step_by(step) {
            let Some(emission) = element.radiance.profile.as_deref() else {
                continue;
            };
            let event = surfaces.event(element.frame, point);
            let patch = surfaces.rest(element.frame).patch(element.triangle);
            for corner in element.corners {
                let left = event.ct - index * (corner - event.x).length();
                each(patch.object, emission, left - patch.object_origin.ct);
            }
        }
    }

    /// Samples a point of all elements with two numbers in [0, 1), for the lifted point `x` in the scene's only rest frame, with the normals of its surface
    /// and of its triangle. `None` if no light arrives from the sampled point, or if its emission does not change with time.
    pub(super) fn drawn_from(
        &self,
        (base, rest): (&BaseColours, &RestFrame),
        (x, normal, geometric): (DVec3, DVec3, DVec3),
        numbers: [f64; 2],
    ) -> Option<AreaDraw<'_>> {
        let drawn = self.shining.draw_one((x, geometric), numbers);
        let element = &self.elements[drawn.element as usize];
        let emission = element.radiance.profile.as_deref()?;
        let (u, v) = drawn.place;
        let (l, distance) = unit_and_length_or_nan(drawn.triangle.at((u, v)) - x);
        // cos θ_y, as the normal is as long as twice the area.
        let towards = -drawn.triangle.normal.dot(l) / drawn.triangle.twice;
        let cosine_there = if element.two_sided {
            towards.abs()
        } else {
            towards
        };
        let cosine = normal.dot(l);
        let density = drawn.density;
        let density = density.per_solid_angle(distance * distance, cosine_there);
        // True for NaN too, if the point is on the element.
        if !(cosine_there > 0.0 && cosine > 0.0 && density > 0.0) {
            return None;
        }
        let radiance = Self::radiance_of(base, (rest, element, (u, v)));
        let incident = self.incident_of(element, radiance, 1.0, cosine / density, None);
        Some(AreaDraw {
            emission,
            clock_zero: rest.patch(element.triangle).object_origin.ct,
            triangle: element.triangle,
            distance,
            cosine: cosine_there,
            light: incident.irradiance,
            sent: Sent {
                l,
                shadows: element.shadows,
                density,
            },
        })
    }

    /// The density with which `point`, which was hit by a ray from a triangle with rest frame and normal `from`, would have been sampled there, if it shines,
    /// and whether other surfaces block it.
    pub(super) fn density(
        &self,
        surfaces: &Surfaces,
        point: &SurfacePoint,
        from: (u32, DVec3),
    ) -> Option<(Density, bool)> {
        let (element, density) = self.shining.density(surfaces, point, from)?;
        Some((density, self.elements[element as usize].shadows))
    }

    /// The same for a place on a triangle of the only rest frame, for a ray that leaves a triangle with this normal.
    pub(super) fn density_at(
        &self,
        triangle: u32,
        from: (DVec3, DVec3),
    ) -> Option<(Density, bool)> {
        let (element, density) = self.shining.density_at(triangle, from)?;
        Some((density, self.elements[element as usize].shadows))
    }

    /// The same per area at `y`, for a block of points, given the normals of their triangles and the offsets by which they are lifted.
    pub(super) fn densities_at(
        &self,
        triangle: u32,
        y: DVec3,
        points: (&Columns, &Columns, &[f64]),
        densities: &mut Block,
    ) -> Option<bool> {
        let element = self.shining.densities_at(triangle, y, points, densities)?;
        Some(self.elements[element as usize].shadows)
    }
}

/// The proper time of `element`'s object at which the light was emitted that goes from its point (u, v) to point `k` of `run`.
fn proper_time(run: &Run, element: &Element, (u, v): (f64, f64), k: usize, index: f64) -> f64 {
    let surfaces = run.traced.surfaces;
    let Some(point) = run.point(k) else {
        return f64::NAN;
    };
    let event = surfaces.event(element.frame, &point);
    let [a, b, c] = element.corners;
    let place = a + (b - a) * u + (c - a) * v;
    let patch = surfaces.rest(element.frame).patch(element.triangle);
    event.ct - index * (place - event.x).length() - patch.object_origin.ct
}

fn mean([r, g, b]: [f64; 3]) -> f64 {
    (r + g + b) / 3.0
}
