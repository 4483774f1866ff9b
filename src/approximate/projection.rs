//! Apparent positions: the film point at which a point at rest in some frame is seen.
//!
//! The light by which the camera sees a point left the point's world line on the past light cone of the
//! event of the shot (Müller & Boblest, "Visual appearance of wireframe objects in special relativity",
//! European J. Phys. 35, 2014; Weiskopf, "Visualization of four-dimensional spacetimes", 2001).
//!
//! A point rests at X in a frame that moves with β along n. With r = X − O, O the place of the event of
//! the shot in that frame, and a medium of index η (0 without retardation), the emission event is at the
//! world displacement (−η s, x) from the shot, s = |x|. Its world line is x = a − ηs β with
//! a = r⊥ + n r∥/γ, where it is at the world time of the shot, so that
//!
//! ```text
//! (1 − η²β²) s² + 2ηs β·a − |a|² = 0.
//! ```
//!
//! With q² = 1 − η²β² and c = r⊥ + n r∥/(γq) the root s > 0 is
//!
//! ```text
//! (−s, x) = Λ(ηβ) (−|c|, c),
//! ```
//!
//! a boost by ηβ of a null vector: in vacuum c = r and Λ is that from the rest frame; without retardation
//! c = a and Λ is the identity. Boosted to the camera's frame its spatial part k is the *apparent
//! position*, in whose direction the point is seen. All this is linear but for |c|:
//!
//! ```text
//! h(c) = A c + m |c|,     h = (x z, y z, z): film coordinates times the part of k along the forward axis.
//! ```
//!
//! A rasterizer that joins the apparent positions of two points by a straight line has |c| linear between them, instead of the true
//! value, which is smaller by δ ≥ 0. The point at fraction λ is then drawn at h + m δ, displaced on the film by
//! ```text
//! Δ = δ (m_xy − m_z (x, y)) / (z + m_z δ),     δ ≈ ½ λ(1 − λ) |c″|,     |c|″ = |c × e|²/|c|³,
//! ```
//!
//! e = c_B − c_A. The component of Δ across the edge bends it; the component along it makes textures slide. For ηβ ≥ 1 there is no such
//! root: the light of an object that outruns it arrives twice, or never.

use glam::{DMat3, DVec3};

use crate::accel::vectors::{BLOCK, Block, Vectors};
use crate::camera::{AnyProjection, Camera, Linear, Point, Projection as _, Shot};
use crate::error::{Error, Result, Setting};
use crate::render::aov::Aov;
use crate::render::film::Film;
use crate::render::prepare::Prepared;
use crate::spacetime::{
    self, Boost, Direction, Displacement, InertialFrame, Rest, Velocity, World,
};

/// A camera whose rays all leave one event.
#[derive(Debug, Clone)]
pub(crate) struct Observer {
    film: AnyProjection,
    linear: Linear,
    shot: Shot,
    /// `None` if directions of the world are used as the camera's.
    camera_from_world: Option<Boost<spacetime::CameraFrame, World>>,
    world_from_camera: Boost<World, spacetime::CameraFrame>,
    index: f64,
}

/// The view of points at rest in one frame by an observer.
#[derive(Debug, Clone)]
pub struct ApparentProjection<'a> {
    observer: &'a Observer,
    apparent: Apparent,
    rest_from_world: Boost<Rest, World>,
}

/// From points of a rest frame to their apparent positions: the coefficients for loops over vertices.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Apparent {
    /// The position of the shot in the frame.
    origin: DVec3,
    /// Direction of motion, and 1/(γq) − 1.
    stretch: (DVec3, f64),
    world_from_optical: Boost<World, Rest>,
    /// The identity if directions of the world are used as the camera's.
    camera_from_world: Boost<spacetime::CameraFrame, World>,
    homogeneous_from_camera: DMat3,
    /// Columns and rows of the film, and its pixels per radian in the corner.
    size: [f64; 2],
    density: f64,
    /// Change of the apparent position per |c|, and that of its homogeneous film coordinates.
    m_camera: DVec3,
    m: DVec3,
}

/// A point of a rest frame in the form that a rasterizer needs.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ApparentVertex {
    /// Homogeneous film coordinates.
    pub film: DVec3,
    /// |c| |Δ/δ|, pixels. A point outside the film by more than half its size, or behind the camera, is treated as in the film's corner.
    pub scale: f64,
}

/// Points of a rest frame by component.
#[derive(Debug, Clone, Copy)]
pub(crate) struct VertexBlock {
    /// Places in the frame, which become the places c.
    pub c: Vectors,
    /// |c|.
    pub length: Block,
    pub film: Vectors,
    /// The film point, pixels; without meaning unless it is in front of the camera.
    pub point: [Block; 2],
    pub scale: Block,
}

impl VertexBlock {
    /// An empty block, to be filled.
    pub const ZERO: VertexBlock = VertexBlock {
        c: Vectors::ZERO,
        length: [0.0; BLOCK],
        film: Vectors::ZERO,
        point: [[0.0; BLOCK]; 2],
        scale: [0.0; BLOCK],
    };

    /// Vertex `at`.
    #[inline(always)]
    pub fn get(&self, at: usize) -> ApparentVertex {
        ApparentVertex {
            film: self.film.get(at),
            scale: self.scale[at],
        }
    }
}

impl Apparent {
    /// The place c of the point `x`.
    #[inline(always)]
    fn optical(&self, x: DVec3) -> DVec3 {
        let r = x - self.origin;
        let (n, stretch) = self.stretch;
        r + n * (n.dot(r) * stretch)
    }

    /// The largest factor by which lengths in the frame grow in positions c.
    pub fn most_stretch(&self) -> f64 {
        (1.0 + self.stretch.1).max(1.0)
    }

    /// The look direction in the world to the point at `c`, whose length is `length`, and the world distance.
    #[inline(always)]
    pub fn look(&self, c: DVec3, length: f64) -> (Direction<World>, f64) {
        let unit = Direction::from_unit(c * (1.0 / length));
        let (d, ratio) = self.world_from_optical.direction(unit);
        (d, length * ratio)
    }

    /// [`Apparent::look`] for the points at `c`, and their lengths.
    #[inline(always)]
    pub fn look_at(&self, c: &Vectors, d: &mut Vectors, [lengths, distances]: [&mut Block; 2]) {
        for k in 0..BLOCK {
            let length = c.get(k).length();
            d.set(k, c.get(k) * (1.0 / length));
            (lengths[k], distances[k]) = (length, length);
        }
        // Test once: a branch at each direction would keep the loop from vectorizing.
        let boost = self.world_from_optical;
        if boost.is_identity() {
            return;
        }
        for (k, distance) in distances.iter_mut().enumerate() {
            let (direction, ratio) = boost.direction_of_moving(Direction::from_unit(d.get(k)));
            d.set(k, direction.unit());
            *distance *= ratio;
        }
    }

    /// The apparent position in the camera's frame of a point seen along `d` at the distance `s`.
    #[inline(always)]
    fn seen(&self, d: Direction<World>, s: f64) -> DVec3 {
        let (seen, ratio) = self.camera_from_world.direction(d);
        seen.unit() * (s * ratio)
    }

    /// The view of the points of `block`, whose positions are in its `c`. Short loops, one step after the other, with copies of shared
    /// values, and boosts tested once for being the identity: compilers do not vectorize a long loop, or one with branches, for AVX2.
    #[inline(always)]
    pub fn see(&self, block: &mut VertexBlock) {
        let VertexBlock {
            c,
            length: lengths,
            film,
            point: [point_x, point_y],
            scale,
        } = block;
        let apparent = *self;
        let mut k = Vectors::ZERO;
        let mut distances = [0.0; BLOCK];
        for at in 0..BLOCK {
            c.set(at, apparent.optical(c.get(at)));
        }
        apparent.look_at(c, &mut k, [lengths, &mut distances]);
        // The apparent position in the camera's frame.
        if !apparent.camera_from_world.is_identity() {
            let boost = apparent.camera_from_world;
            for (at, distance) in distances.iter_mut().enumerate() {
                let (d, ratio) = boost.direction_of_moving(Direction::from_unit(k.get(at)));
                k.set(at, d.unit());
                *distance *= ratio;
            }
        }
        let homogeneous = apparent.homogeneous_from_camera;
        for at in 0..BLOCK {
            let seen = k.get(at) * distances[at];
            k.set(at, seen);
            let h = homogeneous * seen;
            film.set(at, h);
            point_x[at] = h.x / h.z;
            point_y[at] = h.y / h.z;
        }
        // |Δ/δ|, by the film where the point is on it or near, otherwise by the angle and the corner's density.
        let [width, height] = apparent.size;
        for at in 0..BLOCK {
            let (h, seen, x, y) = (film.get(at), k.get(at), point_x[at], point_y[at]);
            let [u, v] = apparent.slide(h, [x, y]);
            let square = seen.length_squared();
            // The part of m along the line of sight causes no rotation; the rest rotates it by |m⊥|/|k|.
            let along = apparent.m_camera.dot(seen) / square;
            let turn = (apparent.m_camera - seen * along).length() / square.sqrt();
            // Beyond the film's edge by at most half of its size.
            let near_x = (x > -0.5 * width) & (x < 1.5 * width);
            let near_y = (y > -0.5 * height) & (y < 1.5 * height);
            let on_film = (u * u + v * v).sqrt();
            let by_angle = apparent.density * turn;
            let is_near = near_x & near_y & (h.z > 0.0);
            scale[at] = lengths[at] * if is_near { on_film } else { by_angle };
        }
    }

    /// The change of the film coordinates of a point seen at `film`, with film point `point`, per metre of |c|.
    #[inline(always)]
    fn slide(&self, film: DVec3, [x, y]: [f64; 2]) -> [f64; 2] {
        [
            (self.m.x - x * self.m.z) / film.z,
            (self.m.y - y * self.m.z) / film.z,
        ]
    }
}

/// The view of a point.
#[derive(Debug, Clone, Copy)]
pub struct Image {
    /// Homogeneous film coordinates (x z, y z, z), x and y in pixels from the top left corner, z in metres
    /// along the forward axis of the camera frame; z ≤ 0 is behind the camera.
    pub film: DVec3,
    /// The look direction in the world.
    pub d: Direction<World>,
    /// World distance from the event of the shot to that of emission, metres.
    pub s: f64,
}

impl Image {
    /// The film point in pixels; `None` if it is not in front of the camera.
    pub fn film_point(&self) -> Option<[f64; 2]> {
        film_point(self.film)
    }
}

fn film_point(film: DVec3) -> Option<[f64; 2]> {
    (film.z > 0.0).then(|| [film.x / film.z, film.y / film.z])
}

impl Observer {
    /// The observer of `prepared`.
    ///
    /// # Errors
    /// As [`Observer::of`].
    pub fn new(prepared: &Prepared) -> Result<Self> {
        Observer::of(&prepared.camera, prepared.ray_index)
    }

    /// The observer with `camera` in a medium of index `index`, 0 where light takes no time.
    ///
    /// # Errors
    /// A camera whose rays leave events of their own: a sensor, a shutter, or the equations of 2015; a
    /// projection that bends straight lines.
    pub fn of(camera: &Camera, index: f64) -> Result<Self> {
        let shot = &camera.shot;
        let frame = &shot.frame;
        let camera_from_world = match camera.view.point().ok_or_else(apart)? {
            Point::Still(_) | Point::Unaberrated(_) => None,
            Point::Moving(_) => Some(*frame.frame_from_world()),
        };
        Ok(Observer {
            film: shot.projection.clone(),
            linear: shot.projection.linear().ok_or_else(curved)?,
            shot: shot.clone(),
            camera_from_world,
            world_from_camera: *frame.world_from_frame(),
            index,
        })
    }

    /// For each object of the scene, its view and the position of its origin in its rest frame: the sum of this and a point's coordinates
    /// in its object (the channel `object_event`) are the coordinates for [`ApparentProjection`]. `None` for objects without triangles.
    ///
    /// # Errors
    /// As [`Observer::projection`].
    pub fn places(&self, scene: &Prepared) -> Result<Vec<Place<'_>>> {
        let mut places = Vec::new();
        for rest in &scene.frames {
            for patch in &rest.patches {
                let object = patch.object as usize;
                if places.len() <= object {
                    places.resize(object + 1, None);
                }
                if places[object].is_none() {
                    places[object] = Some((self.projection(&rest.frame)?, patch.object_origin.x));
                }
            }
        }
        Ok(places)
    }

    /// The view of points at rest in `frame`.
    ///
    /// # Errors
    /// A frame that moves as fast as light in the medium, or faster.
    pub fn projection(&self, frame: &InertialFrame<Rest>) -> Result<ApparentProjection<'_>> {
        let (n, stretch, velocity) = optical(frame.velocity(), self.index)?;
        let world_from_optical = Boost::new(velocity);
        let rest = Boost::new(Velocity::REST);
        let mut projection = ApparentProjection {
            observer: self,
            apparent: Apparent {
                origin: self.shot.event_in(frame).x,
                stretch: (n, stretch),
                world_from_optical,
                camera_from_world: self.camera_from_world.unwrap_or(rest),
                homogeneous_from_camera: self.linear.homogeneous_from_camera,
                size: self.film.size(),
                density: self.film.density(),
                m_camera: DVec3::ZERO,
                m: DVec3::ZERO,
            },
            rest_from_world: *frame.frame_from_world(),
        };
        // h is linear in the four-vector (−|c|, c): m is what becomes of (−1, 0).
        let (_, seen) = projection.in_camera(Displacement::new(-1.0, DVec3::ZERO));
        projection.apparent.m_camera = seen;
        projection.apparent.m = self.linear.homogeneous_from_camera * seen;
        Ok(projection)
    }
}

/// The view of an object, and the position of its origin in its rest frame, metres.
pub type Place<'a> = Option<(ApparentProjection<'a>, DVec3)>;

/// Direction of motion, 1/(γq) − 1 and the velocity ηβ.
fn optical(velocity: Velocity, index: f64) -> Result<(DVec3, f64, Velocity)> {
    let (n, rapidity) = velocity.split();
    // In vacuum γq is 1, and ηβ is β.
    if index == 1.0 || velocity.is_rest() {
        return Ok((n, 0.0, velocity));
    }
    let slowed = index * libm::tanh(rapidity);
    let optical = Velocity::from_rapidity_along(libm::atanh(slowed), n);
    let optical = optical.ok().filter(|_| slowed < 1.0).ok_or_else(outrun)?;
    // √(1 − (ηβ)²) as a product, which loses no digits near 1.
    let q = ((1.0 - slowed) * (1.0 + slowed)).sqrt();
    Ok((n, 1.0 / (velocity.gamma() * q) - 1.0, optical))
}

pub(crate) fn apart() -> Error {
    Error::unsupported(
        "camera",
        "method",
        "rasterizers need a camera whose rays all leave one event, and whose film sees something everywhere",
        Setting::TraceIt + ", or with a perspective camera without sensor and shutter",
    )
}

fn curved() -> Error {
    Error::unsupported(
        "camera",
        "method",
        "rasterizers draw straight edges, and this camera's projection bends them",
        Setting::TraceIt + ", or with a perspective camera",
    )
}

fn outrun() -> Error {
    Error::unsupported(
        "object",
        "velocity",
        "an object moves as fast as light in the medium, or faster: its points are seen twice, or not at all",
        Setting::TraceIt + ", or give a slower object or a smaller index of the medium",
    )
}

impl ApparentProjection<'_> {
    /// The view of the point `x` of the frame, metres relative to the frame's origin; `None` for the position of the camera itself.
    #[inline]
    pub fn image(&self, x: DVec3) -> Option<Image> {
        self.image_of(self.optical(x))
    }

    /// The point's place c relative to the camera, metres (see the [module](self)).
    #[inline]
    pub fn optical(&self, x: DVec3) -> DVec3 {
        self.apparent.optical(x)
    }

    /// The image of the point at `c`.
    #[inline]
    pub(crate) fn image_of(&self, c: DVec3) -> Option<Image> {
        let length = c.length();
        let (d, s) = self.apparent.look(c, length);
        let film = self.apparent.homogeneous_from_camera * self.apparent.seen(d, s);
        (length > 0.0 && film.is_finite()).then_some(Image { film, d, s })
    }

    /// The film point of the point `x` of the frame, pixels from the top left corner; it may lie outside the picture. `None` if the point
    /// is seen behind the camera.
    pub fn film_point(&self, x: DVec3) -> Option<[f64; 2]> {
        self.image(x)?.film_point()
    }

    /// The observed wavelength over the emitted one of light that comes along `d`.
    pub fn wavelength_ratio(&self, d: Direction<World>) -> f64 {
        let (_, rest) = self.rest_from_world.direction(d);
        let camera = match &self.observer.camera_from_world {
            Some(boost) => 1.0 / boost.direction(d).1,
            None => {
                let seen = Direction::from_unit(d.unit());
                self.observer.world_from_camera.direction(seen).1
            }
        };
        camera * rest
    }

    /// The emission event relative to the shot, in the world and in the frame, of a point that is seen
    /// along `d` at the world distance `s`.
    pub fn emission(
        &self,
        d: Direction<World>,
        s: f64,
    ) -> (Displacement<World>, Displacement<Rest>) {
        let index = self.observer.index;
        (
            Displacement::new(-index, d.unit()) * s,
            self.rest_from_world.tangent(index, d) * s,
        )
    }

    /// The four-vector `v`, in coordinates (t, c), as (t, k) in those in which the film looks.
    pub(crate) fn in_camera(&self, v: Displacement<Rest>) -> (f64, DVec3) {
        let world = self.apparent.world_from_optical.displacement(v);
        let v = self.apparent.camera_from_world.displacement(world);
        (v.ct, v.x)
    }

    /// The place of the shot in the frame, metres.
    pub fn origin(&self) -> DVec3 {
        self.apparent.origin
    }

    /// The numbers that loops over points read.
    pub(crate) fn apparent(&self) -> &Apparent {
        &self.apparent
    }

    /// The projection of the observer.
    pub fn film(&self) -> &AnyProjection {
        &self.observer.film
    }

    /// What is linear in it.
    pub fn linear(&self) -> &Linear {
        &self.observer.linear
    }

    /// The change of the film coordinates (x, y, pixels) of a point seen at `film` per metre of excess in its |c|, in the limit of small
    /// errors; `None` behind the camera.
    pub(crate) fn slide(&self, film: DVec3) -> Option<[f64; 2]> {
        Some(self.apparent.slide(film, film_point(film)?))
    }
}

/// The channels that [`displacements`] reads.
pub const CHANNELS: [Aov; 4] = [
    Aov::Object,
    Aov::ObjectEventX,
    Aov::ObjectEventY,
    Aov::ObjectEventZ,
];

/// For each pixel of `film`, the displacement from where its surface point is drawn (the pixel's centre) to where it should be, in
/// pixels; NaN if nothing is hit, or the point is behind the camera.
///
/// The film has [`CHANNELS`] and one sample at the centre of each pixel.
///
/// # Errors
/// A film that does not meet this; a camera whose rays leave events of their own, or whose projection bends straight lines; objects as
/// fast as light in the medium, or faster.
pub fn displacements(scene: &Prepared, film: &Film) -> Result<Vec<[f64; 2]>> {
    let [Some(object), Some(x), Some(y), Some(z)] = CHANNELS.map(|aov| film.aov(aov)) else {
        return Err(unfit());
    };
    if !film.is_centred() {
        return Err(unfit());
    }
    let observer = Observer::new(scene)?;
    let places = observer.places(scene)?;
    let width = film.size()[0] as usize;
    let displaced = |pixel: usize| {
        let (projection, origin) = places.get(object[pixel] as usize)?.as_ref()?;
        let point = DVec3::new(x[pixel], y[pixel], z[pixel]);
        let [u, v] = projection.film_point(origin + point)?;
        let drawn = [(pixel % width) as f64 + 0.5, (pixel / width) as f64 + 0.5];
        Some([u - drawn[0], v - drawn[1]])
    };
    let met = |pixel: usize| object[pixel] >= 0.0;
    let all = 0..object.len();
    Ok(all
        .map(|pixel| met(pixel).then(|| displaced(pixel)).flatten())
        .map(|found| found.unwrap_or([f64::NAN; 2]))
        .collect())
}

fn unfit() -> Error {
    Error::invalid(
        "film",
        "channels",
        "film points are compared at pixel centres, by the channels object and object_event",
        "render with pixel centres and these channels",
    )
}
