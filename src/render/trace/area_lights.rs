//! Where the light of shining surfaces falls.
//!
//! An element dA of a surface that rests in its frame G and has the radiance L there, seen from the point X of a
//! surface that rests in F, was at the event of emission on the past light cone of X: in G a point that does not move, at the
//! distance r_G. It fills the solid angle dω_F = W² dω_G = W² cos θ_y dA/r_G², and L_F = W⁻ᵖ L, so that
//!
//! ```text
//! E_F = ∫ W²⁻ᵖ L cos θ_y cos θ_F/r_G² dA.
//! ```
//!
//! Where L changes with the proper time of the surface's object, it is that of the event of emission: in G the time of X less η r_G.
//!
//! Every hit draws one point of all elements, with a density as their area times their radiance. What is in the way is black: light is followed
//! once.

use glam::DVec3;

use super::area_draws::AreaDraws;
use super::base_colours::{BaseColour, BaseColours};
use super::emitted::Emitted;
use super::lamps::reflect_unblocked;
use super::point::SurfacePoint;
use super::rest_frame::RestFrame;
use super::run::Run;
use super::stats::Meter;
use super::surfaces::Surfaces;
use crate::accel::Hit;
use crate::accel::vectors::{BLOCK, Columns, VectorLoop, Vectors, dispatch};
use crate::colour::{ColourTable, Wavelengths};
use crate::light::Received;
use crate::light::lamp::{self, Incident};
use crate::light::reflection::Reflection;
use crate::spacetime::{Boost, Direction, Rest, World, unit_and_length_or_nan};

/// What random numbers of a hit are for, beside those of [`sky_light`](super::sky_light).
const AREA: u32 = 0;

/// Shadow rays end this part of the way before the shining surface, which is no obstacle to itself.
pub(super) const SHORTER: f64 = 1.0 - 1e-6;

/// About how many triangles are looked at for when their light left.
const MOST_TIMED: usize = 32;

/// Surfaces that shine.
#[derive(Debug)]
pub struct AreaLights {
    elements: Vec<Element>,
    /// Power of all elements up to each, in parts of the whole.
    cumulative: Vec<f64>,
    /// What surfaces receive of them.
    received: Received,
    /// Frame, triangle and index of each element, ascending.
    places: Vec<(u32, u32, u32)>,
    /// By element, what points on it are drawn from.
    shapes: Vec<Shape>,
    /// The rest frames of elements, each once.
    frames: Vec<u32>,
}

/// A triangle that shines.
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
    /// The spectrum that the mean of the channels is a factor on, where it has one.
    pub spectrum: Option<std::sync::Arc<ColourTable>>,
    /// Whether its back shines too.
    pub two_sided: bool,
    /// Whether other surfaces shadow it.
    pub shadows: bool,
}

impl Element {
    fn area(&self) -> f64 {
        let [a, b, c] = self.corners;
        0.5 * (b - a).cross(c - a).length()
    }

    /// About how bright it is at rest: by this it is drawn.
    fn brightness(&self) -> f64 {
        let factor = self.radiance.factor.iter().sum::<f64>();
        let Some(table) = &self.spectrum else {
            return factor;
        };
        // What is not seen at rest may be seen in motion.
        let at_rest: f64 = table.colour(1.0).iter().sum();
        factor * if at_rest > 0.0 { at_rest } else { 1.0 }
    }
}

/// An element as points on it are drawn.
#[derive(Debug)]
struct Shape {
    /// A corner, and the edges from there.
    corner: DVec3,
    edges: [DVec3; 2],
    /// Along the normal, and as long as twice the area.
    normal: DVec3,
    twice: f64,
    /// Power of the elements before it, and its own, in parts of the whole.
    before: f64,
    share: f64,
}

impl Shape {
    fn new(element: &Element, before: f64, share: f64) -> Shape {
        let [a, b, c] = element.corners;
        let normal = (b - a).cross(c - a);
        Shape {
            corner: a,
            edges: [b - a, c - a],
            normal,
            twice: normal.length(),
            before,
            share,
        }
    }
}

/// A point of an area light that is drawn for one of the same rest frame.
pub(super) struct AreaDraw<'a> {
    /// How bright it is by its proper time.
    pub emission: &'a lamp::Emission,
    /// The frame's time at which that is 0.
    pub clock_zero: f64,
    pub triangle: u32,
    pub distance: f64,
    /// The irradiance with an emission of 1, over the density.
    pub light: [f64; 3],
    pub sent: Sent,
}

/// Light of an area light that is drawn, as its weight depends on it.
pub(super) struct Sent {
    /// Towards it in the point's rest frame.
    pub l: DVec3,
    /// Whether other surfaces shadow it.
    pub shadows: bool,
    /// Per solid angle of the point's rest frame.
    pub density: f64,
}

impl AreaLights {
    /// Those of `elements` that have an area and shine; none if none does.
    pub fn new(elements: Vec<Element>, received: Received) -> Option<AreaLights> {
        let power = |e: &Element| e.area() * e.brightness();
        let shines = |e: &Element| power(e) > 0.0 && power(e).is_finite();
        let elements: Vec<_> = elements.into_iter().filter(shines).collect();
        // The distribution by area times radiance, as running sums up to 1.
        let mut sum = 0.0;
        let sums: Vec<f64> = elements
            .iter()
            .map(|e| {
                sum += power(e);
                sum
            })
            .collect();
        // Sorted, so that a ray that meets a shining triangle finds its element.
        let places = (0..).zip(&elements);
        let mut places: Vec<_> = places.map(|(k, e)| (e.frame, e.triangle, k)).collect();
        places.sort_unstable();
        let cumulative: Vec<f64> = sums.into_iter().map(|part| part / sum).collect();
        let before = std::iter::once(0.0).chain(cumulative.iter().copied());
        let ends = before.zip(&cumulative).zip(&elements);
        let shapes = ends.map(|((before, end), e)| Shape::new(e, before, end - before));
        let shapes = shapes.collect();
        let mut frames: Vec<u32> = elements.iter().map(|e| e.frame).collect();
        frames.sort_unstable();
        frames.dedup();
        (sum > 0.0 && sum.is_finite()).then_some(AreaLights {
            places,
            cumulative,
            shapes,
            frames,
            elements,
            received,
        })
    }

    /// Adds what falls on the points of `run`, in a medium of index `index`.
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

    /// The same by `emitted.numbers`, each point's light weighted by `weight`.
    pub(super) fn illuminate_by(
        &self,
        weight: impl Fn(Option<&Reflection>, &Sent) -> f64,
        base: &BaseColours,
        run: &Run,
        index: f64,
        emitted: &mut Emitted,
        meter: &mut Meter,
    ) {
        self.draw(run, emitted);
        // Elements with shadows and those without in turn: the rays of a batch are either all traced or all taken as open.
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
                // Lines come beside what is sampled.
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
            // Usually nothing is left for a second turn.
            if self.elements.iter().all(|e| e.shadows) {
                break;
            }
        }
    }

    /// Draws a point of all elements for each of the points of `run`, by `emitted.numbers`.
    fn draw(&self, run: &Run, emitted: &mut Emitted) {
        let Emitted {
            points,
            numbers,
            draws,
            ..
        } = emitted;
        draws.resize(run.count());
        let last = self.cumulative.len() - 1;
        let at = |x: &f64| self.cumulative.partition_point(|sum| sum <= x).min(last) as u32;
        draws.elements.clear();
        draws.elements.extend(numbers[0].iter().map(at));
        let surfaces = run.traced.surfaces;
        for frame in self.frames.iter().copied() {
            draws.chosen.clear();
            for (k, element) in draws.elements.iter().enumerate() {
                if self.elements[*element as usize].frame == frame {
                    draws.chosen.push(k as u32);
                }
            }
            // Where the points are in the frame of the elements.
            let is_own = surfaces.shares_places(frame, run.frame);
            if !is_own {
                for k in &draws.chosen {
                    if let Some(point) = run.point(*k as usize) {
                        draws
                            .places
                            .set(*k as usize, surfaces.event(frame, &point).x);
                    }
                }
            }
            dispatch(Draws {
                shapes: &self.shapes,
                elements: &self.elements,
                to_world: surfaces.rest(frame).frame.world_from_frame(),
                from_world: surfaces.boost(run.frame),
                positions: is_own.then_some(&points.positions),
                normals: &points.normals,
                numbers,
                draws,
            });
        }
        if points.is_smooth() {
            for k in 0..run.count() {
                if points.is_below(k, draws.l.get(k)) {
                    draws.factors[k] = 0.0;
                }
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

    /// What falls on a point that sees `element` with this radiance at W and with the factor cos θ_y cos θ_F/r² over the density: by channel, or at
    /// `wavelengths`, at which no line is.
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
            // W⁻⁵ is in the colour, and W² of the solid angle is not.
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

    /// Whether any of them changes with time.
    pub(super) fn changes(&self) -> bool {
        self.elements.iter().any(|e| e.radiance.profile.is_some())
    }

    /// Calls `each` with the objects that shine by their own time, how they do, and when what comes from corners of them to `point` left.
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

    /// A point of all elements by two numbers in [0, 1), as it is seen from `x` of the same rest frame, where the normal is `normal`; none
    /// where it does not shine there, or always does.
    pub(super) fn drawn_from(
        &self,
        (base, rest): (&BaseColours, &RestFrame),
        (x, normal): (DVec3, DVec3),
        [first, second]: [f64; 2],
    ) -> Option<AreaDraw<'_>> {
        let last = self.cumulative.len() - 1;
        let chosen = (self.cumulative)
            .partition_point(|sum| *sum <= first)
            .min(last);
        let (element, shape) = (&self.elements[chosen], &self.shapes[chosen]);
        let emission = element.radiance.profile.as_deref()?;
        let root = unit_interval((first - shape.before) / shape.share).sqrt();
        let (u, v) = (root * (1.0 - second), root * second);
        let place = shape.corner + shape.edges[0] * u + shape.edges[1] * v;
        let (l, distance) = unit_and_length_or_nan(place - x);
        let towards = -shape.normal.dot(l) / shape.twice;
        let cosine_there = if element.two_sided {
            towards.abs()
        } else {
            towards
        };
        let cosine = normal.dot(l);
        // Also for NaN, where the point is on the element.
        if !(cosine_there > 0.0 && cosine > 0.0) {
            return None;
        }
        let density = shape.share / (0.5 * shape.twice);
        let factor = cosine_there * cosine / (distance * distance * density);
        let radiance = Self::radiance_of(base, (rest, element, (u, v)));
        let incident = self.incident_of(element, radiance, 1.0, factor, None);
        Some(AreaDraw {
            emission,
            clock_zero: rest.patch(element.triangle).object_origin.ct,
            triangle: element.triangle,
            distance,
            light: incident.irradiance,
            sent: Sent {
                l,
                shadows: element.shadows,
                density: density * distance * distance / cosine_there,
            },
        })
    }

    /// The density per area with which a point of this triangle is drawn, where it shines, and whether other surfaces
    /// shadow it.
    pub(super) fn density(&self, frame: u32, triangle: u32) -> Option<(f64, bool)> {
        let at = |place: &(u32, u32, u32)| (place.0, place.1).cmp(&(frame, triangle));
        let place = self.places.binary_search_by(at).ok()?;
        let k = self.places[place].2 as usize;
        let before = k.checked_sub(1).map_or(0.0, |k| self.cumulative[k]);
        let element = &self.elements[k];
        let share = self.cumulative[k] - before;
        Some((share / element.area(), element.shadows))
    }
}

/// The proper time of `element`'s object at which it sent what comes to point `k` of `run` from its place (u, v).
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

/// The loop over points whose elements are in one frame.
struct Draws<'a> {
    shapes: &'a [Shape],
    elements: &'a [Element],
    to_world: &'a Boost<World, Rest>,
    /// None where nothing changes.
    from_world: Option<&'a Boost<Rest, World>>,
    /// Where points are, if not as `draws` says.
    positions: Option<&'a Columns>,
    normals: &'a Columns,
    numbers: &'a [Vec<f64>; 2],
    draws: &'a mut AreaDraws,
}

impl VectorLoop for Draws<'_> {
    #[inline(always)]
    fn run(self) {
        let Draws {
            shapes,
            elements,
            to_world,
            from_world,
            positions,
            normals,
            numbers,
            draws,
        } = self;
        let mut begin = 0;
        while begin < draws.chosen.len() {
            // Points, their numbers and their elements, side by side.
            let count = (draws.chosen.len() - begin).min(BLOCK);
            let (mut from, mut facing) = (Vectors::ZERO, Vectors::ZERO);
            let (mut corners, mut shape_normals) = (Vectors::ZERO, Vectors::ZERO);
            let (mut e1, mut e2) = (Vectors::ZERO, Vectors::ZERO);
            let (mut x, mut y) = ([0.0; BLOCK], [0.0; BLOCK]);
            let (mut before, mut share) = ([0.0; BLOCK], [1.0; BLOCK]);
            let (mut twice, mut back) = ([1.0; BLOCK], [0.0; BLOCK]);
            let mut lane = 0;
            while lane < count {
                let k = draws.chosen[begin + lane] as usize;
                let element = draws.elements[k] as usize;
                let shape = &shapes[element];
                let place = match positions {
                    Some(positions) => positions.get(k),
                    None => draws.places.get(k),
                };
                from.set(lane, place);
                facing.set(lane, normals.get(k));
                corners.set(lane, shape.corner);
                e1.set(lane, shape.edges[0]);
                e2.set(lane, shape.edges[1]);
                shape_normals.set(lane, shape.normal);
                (x[lane], y[lane]) = (numbers[0][k], numbers[1][k]);
                (before[lane], share[lane]) = (shape.before, shape.share);
                twice[lane] = shape.twice;
                back[lane] = if elements[element].two_sided {
                    -1.0
                } else {
                    0.0
                };
                lane += 1;
            }

            let (mut us, mut vs) = ([0.0; BLOCK], [0.0; BLOCK]);
            let (mut ls, mut ds) = (Vectors::ZERO, Vectors::ZERO);
            let (mut distances, mut ratios) = ([0.0; BLOCK], [0.0; BLOCK]);
            let (mut factors, mut densities) = ([0.0; BLOCK], [0.0; BLOCK]);
            for k in 0..BLOCK {
                // From what is left of the number that chose the element, where on it.
                let root = unit_interval((x[k] - before[k]) / share[k]).sqrt();
                let (u, v) = (root * (1.0 - y[k]), root * y[k]);
                // k in G, where the element does not move.
                let place = corners.get(k) + e1.get(k) * u + e2.get(k) * v;
                let (in_light, distance) = unit_and_length_or_nan(place - from.get(k));
                let cosine_there = -shape_normals.get(k).dot(in_light) / twice[k];
                let opposite = cosine_there * back[k];
                let cosine_there = if cosine_there > opposite {
                    cosine_there
                } else {
                    opposite
                };
                // Towards it in the world and in F, with ω_G/ω_world = 1/ratio.
                let (d, ratio) = to_world.direction(Direction::from_unit(in_light));
                let (l, rho) = match from_world {
                    Some(boost) => boost.direction(d),
                    None => (Direction::from_unit(d.unit()), 1.0),
                };
                let cosine = facing.get(k).dot(l.unit());
                let w = 1.0 / (ratio * rho);
                let density = share[k] / (0.5 * twice[k]);
                let factor = cosine_there * cosine / (distance * distance * density);
                (us[k], vs[k]) = (u, v);
                ls.set(k, l.unit());
                ds.set(k, d.unit());
                distances[k] = distance * ratio * SHORTER;
                ratios[k] = w;
                // Also for NaN, where the point is on the element.
                let falls = (cosine_there > 0.0) & (cosine > 0.0);
                factors[k] = if falls { factor } else { 0.0 };
                densities[k] = density * distance * distance / (w * w * cosine_there);
            }

            let mut lane = 0;
            while lane < count {
                let k = draws.chosen[begin + lane] as usize;
                (draws.u[k], draws.v[k]) = (us[lane], vs[lane]);
                draws.l.set(k, ls.get(lane));
                draws.d.set(k, ds.get(lane));
                draws.distances[k] = distances[lane];
                draws.ratios[k] = ratios[lane];
                draws.factors[k] = factors[lane];
                draws.densities[k] = densities[lane];
                lane += 1;
            }
            begin += BLOCK;
        }
    }
}

fn mean([r, g, b]: [f64; 3]) -> f64 {
    (r + g + b) / 3.0
}

/// As near to x as numbers from 0 to 1 are, without a branch.
#[inline(always)]
fn unit_interval(x: f64) -> f64 {
    let x = if x > 0.0 { x } else { 0.0 };
    if x < 1.0 { x } else { 1.0 }
}
