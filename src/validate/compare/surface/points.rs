//! What a picture says of the surface point that a pixel shows.

use glam::DVec3;

use crate::io::image::Layers;
use crate::validate::compare::plane::Plane;

const OBJECT_POINT: [&str; 3] = ["object_event.x", "object_event.y", "object_event.z"];
const BARYCENTRIC: [&str; 3] = ["barycentric.u", "barycentric.v", "barycentric.v"];
const WORLD_POINT: [&str; 3] = ["event.x", "event.y", "event.z"];

/// Channels of surface points.
#[derive(Debug, Clone, Copy)]
pub struct Points<'a> {
    width: usize,
    height: usize,
    pub(in crate::validate::compare) object: Option<Plane<'a>>,
    pub(in crate::validate::compare) primitive: Option<Plane<'a>>,
    /// Places in the object's own frame.
    material: Option<[Plane<'a>; 3]>,
    /// Places in the world.
    world: Option<[Plane<'a>; 3]>,
    /// Places on the triangle; the third coordinate adds nothing.
    pub(super) barycentric: Option<[Plane<'a>; 3]>,
    pub(in crate::validate::compare) time: Option<Plane<'a>>,
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

    pub(in crate::validate::compare) fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    /// The planes of both pictures in which the same point of a surface has the same place: in the object's
    /// frame, or else in the world's, which is right for what rests there.
    pub(super) fn places(pair: &[Points<'a>; 2]) -> Option<[[Plane<'a>; 3]; 2]> {
        let both =
            |of: fn(&Points<'a>) -> Option<[Plane<'a>; 3]>| Some([of(&pair[0])?, of(&pair[1])?]);
        both(|p| p.material).or_else(|| both(|p| p.world))
    }

    /// The object that a pixel shows, below 0 for none; none where there is no such channel.
    pub(in crate::validate::compare) fn object_at(&self, index: usize) -> Option<f64> {
        // EXR files of other programs hold −1 as the largest count.
        let id = self.object?.at(index);
        Some(if id.is_nan() || id >= 4_294_967_295.0 {
            -1.0
        } else {
            id
        })
    }

    /// The triangle that a pixel shows.
    pub(in crate::validate::compare) fn primitive_at(&self, index: usize) -> Option<f64> {
        Some(self.primitive?.at(index))
    }

    /// Whether both pictures show one object at this pixel; where neither has the channel, always.
    pub(in crate::validate::compare) fn same_object(&self, other: &Points, index: usize) -> bool {
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
