//! Distances of the surface points that pixels show from where they should be; `surface` has the definition.

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::known::KnownScene;
use super::picture::Plane;
use super::points::{Points, around, place};

/// The geometric error of every pixel, NaN if it has none; from the search `otherwise` where `field` has none.
pub(super) fn map(field: &Field, otherwise: Option<&Search>) -> Vec<f32> {
    let error = |i: usize| {
        let length = field.error(i).or_else(|| otherwise?.distance(i));
        length.map_or(f32::NAN, |length| length as f32)
    };
    let pixels = (0..field.width() * field.height()).into_par_iter();
    pixels.map(error).collect()
}

/// Displacements of the candidate's points to where they belong.
#[derive(Debug)]
pub(super) enum Field<'a> {
    /// From the scene.
    Known(&'a KnownScene, [Points<'a>; 2]),
    /// By a search on the surface that the reference shows.
    Search(Search<'a>),
}

impl<'a> Field<'a> {
    /// The field of a reference and a candidate of one size; `None` if position channels are missing.
    pub fn new(pair: &[Points<'a>; 2], known: Option<&'a KnownScene>) -> Option<Self> {
        let [_, candidate] = pair;
        match known {
            Some(known) if candidate.material.is_some() || candidate.world.is_some() => {
                Some(Field::Known(known, *pair))
            }
            _ => Some(Field::Search(Search::new(pair)?)),
        }
    }

    /// The same by positions on triangles, for pictures of one triangulation: this shows points that slide along their surface even if the
    /// candidate's position channels are not computed from its triangles.
    pub fn on_triangles(pair: &[Points<'a>; 2]) -> Option<Self> {
        let [r, c] = pair;
        (r.primitive.is_some() && c.primitive.is_some()).then_some(())?;
        let planes = [r.barycentric?, c.barycentric?];
        Some(Field::Search(Search::on(pair, planes, Surface::Triangles)))
    }

    /// The same by look directions, which do not depend on what is hit.
    pub fn of_directions(pair: &[Points<'a>; 2]) -> Option<Self> {
        let planes = [pair[0].direction?, pair[1].direction?];
        Some(Field::Search(Search::on(pair, planes, Surface::Sky)))
    }

    fn width(&self) -> usize {
        self.points().width
    }

    fn height(&self) -> usize {
        self.points().height
    }

    fn points(&self) -> &Points<'a> {
        match self {
            Field::Known(_, points) => &points[0],
            Field::Search(search) => &search.points[0],
        }
    }

    /// The displacement, in pixels to the right and down, from pixel `index` to where the candidate's point there belongs.
    pub fn displacement(&self, index: usize) -> Option<DVec2> {
        match self {
            Field::Known(known, [r, c]) => {
                if !r.same_object(c, index) {
                    return None;
                }
                let shown = known.place(c, index)?;
                let pixel = DVec2::new((index % r.width) as f64, (index / r.width) as f64);
                let right = known.place(r, index).unwrap_or(pixel + 0.5);
                Some(shown - right)
            }
            Field::Search(search) => search.displacement(index),
        }
    }

    /// The length of the displacement; for a point of a known scene that is seen where it belongs, or near, but is off the surface there,
    /// its distance from the reference's point in steps of the surface.
    pub fn error(&self, index: usize) -> Option<f64> {
        let seen = self.displacement(index)?.length();
        Some(self.off_surface(index, seen).unwrap_or(seen))
    }

    /// Whether both pictures show the same point of the surface, for all that samples elsewhere in the pixel tell.
    pub fn is_at_place(&self, index: usize) -> bool {
        let seen = self.displacement(index).map(DVec2::length);
        seen.is_some_and(|seen| seen <= SAME_PLACE && self.off_surface(index, seen).is_none())
    }

    /// Whether a point is seen where it belongs, but is elsewhere along the ray.
    pub fn is_elsewhere_along_ray(&self, index: usize) -> bool {
        let seen = self.displacement(index).map(DVec2::length);
        seen.is_some_and(|seen| self.off_surface(index, seen).is_some())
    }

    /// The distance of both points at a pixel of a known scene, in the reference's largest step to a pixel around it, if that is more than
    /// their displacement `seen` explains.
    fn off_surface(&self, index: usize, seen: f64) -> Option<f64> {
        let Field::Known(known, [r, c]) = self else {
            return None;
        };
        (seen <= SAME_PLACE).then_some(())?;
        let (object, right) = known.point(r, index)?;
        let (_, is) = known.point(c, index)?;
        let off = (is - right).length();
        let beside = around(r.size(), index).filter_map(|j| known.point(r, j));
        let steps = beside
            .filter(|(k, _)| *k == object)
            .map(|(_, p)| (p - right).length());
        let step = steps.fold(0.0, f64::max);
        (step > 0.0 && off > (OFF_SURFACE + FOOTPRINT * seen) * step).then(|| off / step)
    }
}

/// An upper bound on the displacement, in pixels, by samples elsewhere in the pixel.
const SAME_PLACE: f64 = 1.5;

/// The distance of a surface's points per pixel of their displacement, at most, in its largest step to a pixel around: on a sphere a step
/// towards the silhouette is at most 2.4 times the last one, and pixels of other objects have no steps.
const FOOTPRINT: f64 = 4.0;

/// Where the candidate's surface points are seen and where they belong, from the reference alone.
#[derive(Debug)]
pub(super) struct Search<'a> {
    reference: [Plane<'a>; 3],
    candidate: [Plane<'a>; 3],
    points: [Points<'a>; 2],
    surface: Surface,
    /// For each pixel, the connected part of a surface that the reference shows.
    part: Vec<u32>,
}

/// What positions are relative to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Surface {
    /// Surfaces of objects.
    Objects,
    /// Single triangles: positions are meaningless on another triangle.
    Triangles,
    /// The sphere of look directions.
    Sky,
}

/// Maximum number of steps of Newton's method.
const MOST_STEPS: usize = 8;
/// sin of the angle between the two columns of J below which they do not distinguish two directions.
const EDGE_ON: f64 = 1e-6;
/// One-sided differences nearly agree if they differ by less than this fraction of the longer one.
const SMOOTH: f64 = 0.5;
/// A surface is connected from a pixel to the next if the step is at most this many times the longer of the two adjacent steps: on a
/// sphere, where steps grow fastest towards the silhouette, it is at most 1/(√2 − 1) = 2.4 times.
const CONNECTED: f64 = 3.0;
/// The largest residual, in pixels, between a point and where it is found, or seen: points with more are off the surface.
const OFF_SURFACE: f64 = 0.5;
/// The largest last step, in pixels along an axis, that may lead beyond the last pixel of a surface.
const BEYOND: f64 = 1.5;

impl<'a> Search<'a> {
    pub fn new(pair: &[Points<'a>; 2]) -> Option<Self> {
        Some(Search::on(pair, Points::places(pair)?, Surface::Objects))
    }

    fn on(
        pair: &[Points<'a>; 2],
        [reference, candidate]: [[Plane<'a>; 3]; 2],
        surface: Surface,
    ) -> Self {
        let mut search = Search {
            reference,
            candidate,
            points: *pair,
            surface,
            part: Vec::new(),
        };
        search.part = search.parts();
        search
    }

    /// The displacement from pixel `index` to where the candidate's point there belongs.
    fn displacement(&self, index: usize) -> Option<DVec2> {
        let [r, c] = &self.points;
        let other = match self.surface {
            Surface::Sky => false,
            Surface::Objects => !r.same_object(c, index),
            Surface::Triangles => {
                !r.same_object(c, index) || r.primitive_at(index) != c.primitive_at(index)
            }
        };
        if other {
            return None;
        }
        let wanted = place(&self.candidate, index);
        let found = place(&self.reference, index);
        if found == wanted {
            return Some(DVec2::ZERO);
        }
        if !wanted.is_finite() {
            return None;
        }
        if let Some(found) = self.newton(index, index, wanted) {
            return Some(found);
        }
        // At a silhouette the point may be on the part of the surface that adjacent pixels show. Positions on another object do not count,
        // whatever their coordinates.
        let around = self.around(index).filter(|j| {
            let same_object = r.object_at(*j) == r.object_at(index);
            self.part[*j] != self.part[index] && (same_object || self.surface == Surface::Sky)
        });
        let found = around.filter_map(|j| self.newton(index, j, wanted));
        found.min_by(|a, b| a.length_squared().total_cmp(&b.length_squared()))
    }

    /// The length of the displacement, or, for points off the surface, their distance in pixels there.
    fn distance(&self, index: usize) -> Option<f64> {
        if let Some(found) = self.displacement(index) {
            return Some(found.length());
        }
        let [r, c] = &self.points;
        let off = (place(&self.candidate, index) - place(&self.reference, index)).length();
        let is_there = r.same_object(c, index) && off.is_finite();
        is_there.then_some(())?;
        let here = place(&self.reference, index);
        let beside = self.around(index).filter(|j| self.same(index, *j));
        let steps = beside.map(|j| (place(&self.reference, j) - here).length());
        let pixel = steps.filter(|step| step.is_finite()).reduce(f64::max)?;
        (pixel > 0.0).then(|| off / pixel)
    }

    /// The displacement from pixel `origin` to where the part of the surface shown at pixel `start` has the position `wanted`.
    fn newton(&self, origin: usize, start: usize, wanted: DVec3) -> Option<DVec2> {
        let mut at = start;
        for _ in 0..MOST_STEPS {
            let step = self.step(at, wanted)?;
            let target = self.pixel(at) + step;
            let next = self
                .index(target)
                .filter(|j| self.part[*j] == self.part[start]);
            match next {
                Some(next) if next != at => at = next,
                // It is in this pixel, or just beyond the last pixel of this part.
                _ => {
                    let near = step.abs().max_element() <= BEYOND;
                    return near.then(|| target - self.pixel(origin));
                }
            }
        }
        None
    }

    /// The first-order displacement from the pixel `at` to where the reference shows `wanted`; `None` if that is off the surface.
    fn step(&self, at: usize, wanted: DVec3) -> Option<DVec2> {
        let (x, y) = (at % self.points[0].width, at / self.points[0].width);
        let [width, height] = self.points[0].size();
        let u = self.difference(
            at,
            (x + 1 < width).then_some(at + 1),
            x.checked_sub(1).map(|_| at - 1),
        )?;
        let below = (y + 1 < height).then_some(at + width);
        let v = self.difference(at, below, y.checked_sub(1).map(|_| at - width))?;
        // δ = (JᵀJ)⁻¹ Jᵀ d by Cramer's rule; det JᵀJ = |u × v|².
        let d = wanted - place(&self.reference, at);
        let (uu, uv, vv) = (u.dot(u), u.dot(v), v.dot(v));
        let (ud, vd) = (u.dot(d), v.dot(d));
        let determinant = u.cross(v).length_squared();
        if determinant <= EDGE_ON * EDGE_ON * uu * vv {
            return None;
        }
        let step = DVec2::new(vv * ud - uv * vd, uu * vd - uv * ud) / determinant;
        // A curved surface departs from its tangent plane with the square of the step.
        let rest = (d - u * step.x - v * step.y).length();
        let pixel = u.length().max(v.length());
        let off_surface = rest > OFF_SURFACE * pixel * step.length().max(1.0);
        (step.is_finite() && !off_surface).then_some(step)
    }

    /// Change of the surface point per pixel along one axis.
    fn difference(&self, at: usize, after: Option<usize>, before: Option<usize>) -> Option<DVec3> {
        let here = place(&self.reference, at);
        let towards = |other: Option<usize>| {
            let other = other.filter(|other| self.part[*other] == self.part[at])?;
            let there = place(&self.reference, other);
            let flat = self.same_triangle(at, other);
            there.is_finite().then_some((there - here, flat))
        };
        let has_triangles = self.points[0].primitive.is_some() && self.surface != Surface::Sky;
        match (towards(after), towards(before)) {
            (Some((f, flat)), Some((b, flat_too))) => {
                let b = -b;
                let close = (f - b).length() <= SMOOTH * f.length().max(b.length());
                // A neighbour on the same triangle is exact; others count only if both sides agree.
                match (flat, flat_too) {
                    (true, true) => Some(0.5 * (f + b)),
                    (true, false) => Some(f),
                    (false, true) => Some(b),
                    _ if close => Some(0.5 * (f + b)),
                    // Both neighbours lie on other triangles, across creases.
                    _ if has_triangles => None,
                    _ if f.length() <= b.length() => Some(f),
                    _ => Some(b),
                }
            }
            (Some((f, flat)), None) => (flat || !has_triangles).then_some(f),
            (None, Some((b, flat))) => (flat || !has_triangles).then_some(-b),
            (None, None) => None,
        }
    }

    /// The connected part of a surface that each pixel of the reference shows: by union of neighbours.
    fn parts(&self) -> Vec<u32> {
        let [width, height] = self.points[0].size();
        let mut parents: Vec<u32> = (0..(width * height) as u32).collect();
        for i in 0..width * height {
            let (x, y) = (i % width, i / width);
            if x + 1 < width && self.connected(i, i + 1, (x > 0, x + 2 < width), 1) {
                unite(&mut parents, i, i + 1);
            }
            if y + 1 < height && self.connected(i, i + width, (y > 0, y + 2 < height), width) {
                unite(&mut parents, i, i + width);
            }
        }
        (0..parents.len()).map(|i| root(&mut parents, i)).collect()
    }

    /// Whether the surface continues from pixel `a` to the next one `b`, `stride` further.
    fn connected(
        &self,
        a: usize,
        b: usize,
        (has_before, has_after): (bool, bool),
        stride: usize,
    ) -> bool {
        if self.surface == Surface::Sky {
            return true;
        }
        if !self.same(a, b) {
            return false;
        }
        if self.same_triangle(a, b) {
            return true;
        }
        let length = |a: usize, b: usize| {
            let step = place(&self.reference, b) - place(&self.reference, a);
            Some(step.length()).filter(|_| self.same(a, b))
        };
        let before = has_before.then(|| length(a - stride, a)).flatten();
        let after = has_after.then(|| length(b, b + stride)).flatten();
        let beside = match (before, after) {
            (Some(a), Some(b)) => a.max(b),
            (Some(a), None) | (None, Some(a)) => a,
            // An object of two pixels: undecidable.
            (None, None) => return true,
        };
        length(a, b).is_some_and(|length| length <= CONNECTED * beside)
    }

    /// Whether the reference shows the same object at both pixels.
    fn same(&self, a: usize, b: usize) -> bool {
        let objects = self.points[0].object_at(a) == self.points[0].object_at(b);
        objects && (self.surface != Surface::Triangles || self.same_triangle(a, b))
    }

    /// Whether the reference is known to show the same triangle of the same object at both pixels.
    fn same_triangle(&self, a: usize, b: usize) -> bool {
        let [p, q] = [a, b].map(|i| self.points[0].primitive_at(i));
        p.is_some() && p == q && self.points[0].object_at(a) == self.points[0].object_at(b)
    }

    /// The pixels beside and diagonally beside a pixel.
    fn around(&self, index: usize) -> impl Iterator<Item = usize> + '_ {
        let centre = self.pixel(index);
        let steps = (-1..=1).flat_map(|y| (-1..=1).map(move |x| [x, y]));
        let steps = steps.filter(|step| *step != [0, 0]);
        steps
            .filter_map(move |[x, y]: [i32; 2]| self.index(centre + DVec2::new(x.into(), y.into())))
    }

    fn pixel(&self, index: usize) -> DVec2 {
        let width = self.points[0].width;
        DVec2::new((index % width) as f64, (index / width) as f64)
    }

    fn index(&self, pixel: DVec2) -> Option<usize> {
        let [width, height] = self.points[0].size();
        let rounded = pixel.round();
        let inside = |x: f64, size: usize| (0.0..size as f64).contains(&x);
        let is_inside = inside(rounded.x, width) && inside(rounded.y, height);
        is_inside.then(|| rounded.y as usize * width + rounded.x as usize)
    }
}

/// The root of the part that pixel `i` belongs to, with path compression.
fn root(parents: &mut [u32], i: usize) -> u32 {
    let mut at = i;
    while parents[at] as usize != at {
        parents[at] = parents[parents[at] as usize];
        at = parents[at] as usize;
    }
    at as u32
}

/// Joins the parts of two pixels; the earlier root becomes the root of both.
fn unite(parents: &mut [u32], a: usize, b: usize) {
    let (a, b) = (root(parents, a), root(parents, b));
    parents[a.max(b) as usize] = a.min(b);
}
