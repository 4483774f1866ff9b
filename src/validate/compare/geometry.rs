//! Points of surfaces that pixels show, and how far each is from where it should be; `surface` says the definition.

use glam::{DVec2, DVec3};

use super::picture::Plane;
use crate::io::image::Layers;

const OBJECT_POINT: [&str; 3] = ["object_event.x", "object_event.y", "object_event.z"];
const BARYCENTRIC: [&str; 3] = ["barycentric.u", "barycentric.v", "barycentric.v"];
const WORLD_POINT: [&str; 3] = ["event.x", "event.y", "event.z"];

/// Channels of surface points.
#[derive(Debug, Clone, Copy)]
pub(super) struct Points<'a> {
    width: usize,
    height: usize,
    pub object: Option<Plane<'a>>,
    pub primitive: Option<Plane<'a>>,
    /// Places in the object's own frame.
    material: Option<[Plane<'a>; 3]>,
    /// Places in the world.
    world: Option<[Plane<'a>; 3]>,
    /// Places on the triangle; the third coordinate adds nothing.
    pub barycentric: Option<[Plane<'a>; 3]>,
    pub time: Option<Plane<'a>>,
}

impl<'a> Points<'a> {
    /// The channels that there are.
    pub fn new(layers: &'a Layers) -> Self {
        let plane = |name| Plane::find(layers, name);
        Points {
            width: layers.width as usize,
            height: layers.height as usize,
            object: plane("object"),
            primitive: plane("primitive"),
            material: Plane::group(layers, OBJECT_POINT),
            world: Plane::group(layers, WORLD_POINT),
            barycentric: Plane::group(layers, BARYCENTRIC),
            time: plane("event.ct").or_else(|| plane("object_event.ct")),
        }
    }

    pub fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    /// The planes of both pictures in which the same point of a surface has the same place: in the object's
    /// frame, or else in the world's, which is right for what rests there.
    pub fn places(pair: &[Points<'a>; 2]) -> Option<[[Plane<'a>; 3]; 2]> {
        let both =
            |of: fn(&Points<'a>) -> Option<[Plane<'a>; 3]>| Some([of(&pair[0])?, of(&pair[1])?]);
        both(|p| p.material).or_else(|| both(|p| p.world))
    }

    /// The object that a pixel shows, below 0 for none; none where there is no such channel.
    pub fn object_at(&self, index: usize) -> Option<f64> {
        // EXR files of other programs hold −1 as the largest count.
        let id = self.object?.at(index);
        Some(if id.is_nan() || id >= 4_294_967_295.0 {
            -1.0
        } else {
            id
        })
    }

    /// The triangle that a pixel shows.
    pub fn primitive_at(&self, index: usize) -> Option<f64> {
        Some(self.primitive?.at(index))
    }

    /// Whether both pictures show one object at this pixel; where neither has the channel, always.
    pub fn same_object(&self, other: &Points, index: usize) -> bool {
        match (self.object_at(index), other.object_at(index)) {
            (Some(a), Some(b)) => a == b && a >= 0.0,
            _ => true,
        }
    }
}

/// A place; NaN where nothing is met.
#[inline]
pub(super) fn place(planes: &[Plane; 3], index: usize) -> DVec3 {
    DVec3::new(
        planes[0].at(index),
        planes[1].at(index),
        planes[2].at(index),
    )
}

/// Newton's steps.
const MOST_STEPS: usize = 12;
/// One-sided differences agree when they differ by at most this part of the longer one.
const SMOOTH: f64 = 0.25;
/// A surface seen edge-on: the least sine of the angle between the columns of J.
const EDGE_ON: f64 = 1e-4;

/// The geometric error of every pixel, NaN where there is none; none where channels are missing.
pub(super) fn map(pair: &[Points; 2]) -> Option<Vec<f32>> {
    let field = Field::new(pair)?;
    let [width, height] = pair[0].size();
    let error = |i: usize| {
        field
            .displacement(i)
            .map_or(f32::NAN, |d| d.length() as f32)
    };
    Some((0..width * height).map(error).collect())
}

/// Where the candidate's surface points are seen and where they belong.
#[derive(Debug, Clone, Copy)]
pub(super) struct Field<'a> {
    reference: [Plane<'a>; 3],
    candidate: [Plane<'a>; 3],
    points: [Points<'a>; 2],
    /// Whether places are those on a triangle, and mean nothing on another one.
    on_triangles: bool,
    width: usize,
    height: usize,
}

impl<'a> Field<'a> {
    /// The field of a reference and a candidate of one size; none where channels of places are missing.
    pub fn new(pair: &[Points<'a>; 2]) -> Option<Self> {
        let [reference, candidate] = Points::places(pair)?;
        let [width, height] = pair[0].size();
        Some(Field {
            reference,
            candidate,
            points: *pair,
            on_triangles: false,
            width,
            height,
        })
    }

    /// The same by places on triangles, for pictures of one triangulation: points that slide along their surface
    /// are seen to do so even where the place is not what the candidate has from its triangles.
    pub fn on_triangles(pair: &[Points<'a>; 2]) -> Option<Self> {
        let [r, c] = pair;
        (r.primitive.is_some() && c.primitive.is_some()).then_some(())?;
        let [width, height] = r.size();
        Some(Field {
            reference: r.barycentric?,
            candidate: c.barycentric?,
            points: *pair,
            on_triangles: true,
            width,
            height,
        })
    }

    /// How far, in pixels to the right and down, the candidate's point at pixel `index` belongs from there.
    pub fn displacement(&self, index: usize) -> Option<DVec2> {
        let [r, c] = &self.points;
        let other_triangle = self.on_triangles && r.primitive_at(index) != c.primitive_at(index);
        if !r.same_object(c, index) || other_triangle {
            return None;
        }
        let wanted = place(&self.candidate, index);
        let found = place(&self.reference, index);
        if found == wanted {
            return Some(DVec2::ZERO);
        }
        if !wanted.is_finite() || !found.is_finite() {
            return None;
        }
        self.newton(index, wanted)
    }

    fn newton(&self, start: usize, wanted: DVec3) -> Option<DVec2> {
        let origin = self.pixel(start);
        let mut at = start;
        let mut found = None;
        for _ in 0..MOST_STEPS {
            let Some(step) = self.step(at, wanted) else {
                break;
            };
            let target = self.pixel(at) + step;
            found = Some(target - origin);
            let next = self.index(target).filter(|next| self.same(start, *next));
            match next {
                Some(next) if next != at => at = next,
                _ => break,
            }
        }
        found
    }

    /// From the pixel `at` to where the reference shows `wanted`, to first order.
    fn step(&self, at: usize, wanted: DVec3) -> Option<DVec2> {
        let (x, y) = (at % self.width, at / self.width);
        let u = self.difference(
            at,
            (x + 1 < self.width).then_some(at + 1),
            x.checked_sub(1).map(|_| at - 1),
        )?;
        let below = (y + 1 < self.height).then_some(at + self.width);
        let v = self.difference(at, below, y.checked_sub(1).map(|_| at - self.width))?;
        // δ = (JᵀJ)⁻¹ Jᵀ d by Cramer's rule; det JᵀJ = |u × v|².
        let d = wanted - place(&self.reference, at);
        let (uu, uv, vv) = (u.dot(u), u.dot(v), v.dot(v));
        let (ud, vd) = (u.dot(d), v.dot(d));
        let determinant = u.cross(v).length_squared();
        if determinant <= EDGE_ON * EDGE_ON * uu * vv {
            return None;
        }
        let step = DVec2::new(vv * ud - uv * vd, uu * vd - uv * ud) / determinant;
        step.is_finite().then_some(step)
    }

    /// Change of the surface point per pixel along one axis.
    fn difference(&self, at: usize, after: Option<usize>, before: Option<usize>) -> Option<DVec3> {
        let here = place(&self.reference, at);
        let towards = |other: Option<usize>| {
            let other = other.filter(|other| self.same(at, *other))?;
            let there = place(&self.reference, other);
            there
                .is_finite()
                .then_some((there - here, self.same_triangle(at, other)))
        };
        match (towards(after), towards(before)) {
            (Some((f, flat)), Some((b, flat_too))) => {
                let b = -b;
                let close = (f - b).length() <= SMOOTH * f.length().max(b.length());
                Some(match (flat, flat_too) {
                    (true, true) => 0.5 * (f + b),
                    (true, false) => f,
                    (false, true) => b,
                    _ if close => 0.5 * (f + b),
                    _ if f.length() <= b.length() => f,
                    _ => b,
                })
            }
            (Some((f, _)), None) => Some(f),
            (None, Some((b, _))) => Some(-b),
            (None, None) => None,
        }
    }

    /// Whether the reference shows the same object at both pixels.
    fn same(&self, a: usize, b: usize) -> bool {
        let objects = self.points[0].object_at(a) == self.points[0].object_at(b);
        objects && (!self.on_triangles || self.same_triangle(a, b))
    }

    /// Whether the reference is known to show the same triangle at both pixels.
    fn same_triangle(&self, a: usize, b: usize) -> bool {
        let [a, b] = [a, b].map(|i| self.points[0].primitive_at(i));
        a.is_some() && a == b
    }

    fn pixel(&self, index: usize) -> DVec2 {
        DVec2::new((index % self.width) as f64, (index / self.width) as f64)
    }

    fn index(&self, pixel: DVec2) -> Option<usize> {
        let rounded = pixel.round();
        let inside = |x: f64, size: usize| (0.0..size as f64).contains(&x);
        let is_inside = inside(rounded.x, self.width) && inside(rounded.y, self.height);
        is_inside.then(|| rounded.y as usize * self.width + rounded.x as usize)
    }
}
