//! The surface points that the pixels of a picture show.

use glam::DVec3;

use super::picture::Plane;
use crate::io::image::Layers;
use crate::render::aov::Aov;

pub(super) const OBJECT_POINT: [Aov; 3] = [Aov::ObjectEventX, Aov::ObjectEventY, Aov::ObjectEventZ];
pub(super) const WORLD_POINT: [Aov; 3] = [Aov::EventX, Aov::EventY, Aov::EventZ];
pub(super) const DIRECTION: [Aov; 3] = [Aov::DirectionX, Aov::DirectionY, Aov::DirectionZ];
/// The third coordinate is redundant.
const BARYCENTRIC: [Aov; 3] = [Aov::BarycentricU, Aov::BarycentricV, Aov::BarycentricV];

/// The fewest pixels of an object that can be reported missing: with fewer, an allowed error may move all of them.
pub(super) const FEWEST_OF_OBJECT: u64 = 8;

/// Channels of surface points.
#[derive(Debug, Clone, Copy)]
pub(super) struct Points<'a> {
    pub width: usize,
    pub height: usize,
    pub object: Option<Plane<'a>>,
    pub primitive: Option<Plane<'a>>,
    /// Positions in the object's own frame.
    pub material: Option<[Plane<'a>; 3]>,
    /// Positions in the world.
    pub world: Option<[Plane<'a>; 3]>,
    /// Positions on the triangle.
    pub barycentric: Option<[Plane<'a>; 3]>,
    /// Look directions in the world.
    pub direction: Option<[Plane<'a>; 3]>,
    /// Emission times in the world, or, if that is all that both pictures have, in the object's frame.
    pub time: Option<Plane<'a>>,
}

impl<'a> Points<'a> {
    /// The channels that both pictures have, with times in the same frame.
    pub fn pair(pair: [&'a Layers; 2]) -> [Self; 2] {
        let times = [Aov::EventCt, Aov::ObjectEventCt].into_iter();
        let mut both = times.filter(|time| pair.iter().all(|p| Plane::aov(p, *time).is_some()));
        let time = both.next();
        pair.map(|layers| Points {
            time: time.and_then(|time| Plane::aov(layers, time)),
            ..Points::new(layers)
        })
    }

    fn new(layers: &'a Layers) -> Self {
        let plane = |aov| Plane::aov(layers, aov);
        Points {
            width: layers.width as usize,
            height: layers.height as usize,
            object: plane(Aov::Object),
            primitive: plane(Aov::Primitive),
            material: Plane::aovs(layers, OBJECT_POINT),
            world: Plane::aovs(layers, WORLD_POINT),
            barycentric: Plane::aovs(layers, BARYCENTRIC),
            direction: Plane::aovs(layers, DIRECTION),
            time: None,
        }
    }

    pub fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    /// The planes of both pictures in which the same surface point has the same position: in the object's frame, or else in the world's,
    /// which is right for objects at rest.
    pub fn places(pair: &[Points<'a>; 2]) -> Option<[[Plane<'a>; 3]; 2]> {
        let both =
            |of: fn(&Points<'a>) -> Option<[Plane<'a>; 3]>| Some([of(&pair[0])?, of(&pair[1])?]);
        both(|p| p.material).or_else(|| both(|p| p.world))
    }

    /// The object that a pixel shows, below 0 for none; `None` if there is no such channel.
    pub fn object_at(&self, index: usize) -> Option<f64> {
        // EXR files of other programs store −1 as the largest unsigned integer.
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

    /// The point that a pixel shows in its object's frame, if there are such channels.
    pub fn own_point(&self, index: usize) -> Option<DVec3> {
        Some(place(&self.material?, index))
    }

    /// The position in the world that a pixel shows, if there are such channels.
    pub fn world_point(&self, index: usize) -> Option<DVec3> {
        Some(place(&self.world?, index))
    }

    /// Whether both pictures show the same object at this pixel; always true if neither has the channel.
    pub fn same_object(&self, other: &Points, index: usize) -> bool {
        match (self.object_at(index), other.object_at(index)) {
            (Some(a), Some(b)) => a == b && a >= 0.0,
            _ => true,
        }
    }
}

/// A pixel with those beside and diagonally beside it.
pub(super) fn around([width, height]: [usize; 2], i: usize) -> impl Iterator<Item = usize> {
    let (x, y) = (i % width, i / width);
    let rows = y.saturating_sub(1)..=(y + 1).min(height - 1);
    rows.flat_map(move |y| {
        (x.saturating_sub(1)..=(x + 1).min(width - 1)).map(move |x| y * width + x)
    })
}

/// The three coordinates at a pixel.
pub(super) fn place(planes: &[Plane; 3], index: usize) -> DVec3 {
    let [x, y, z] = planes.map(|plane| plane.at(index));
    DVec3::new(x, y, z)
}
