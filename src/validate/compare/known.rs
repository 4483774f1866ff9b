//! Where the points of a known scene are seen.
//!
//! A point p of an object at rest in frame k is seen at the event where its world line crosses the past light cone of the shot P. In that
//! frame P is at (T, q); with r = p − q, and in vacuum, the light left |r| earlier, so the displacement from P is the null vector (−|r|,
//! r), boosted to the world (−s, x), and to the camera (−s′, k): the point is seen along k. In a medium of index η the same holds with the
//! velocity ηβ and c = r⊥ + n r∥ / (γ √(1 − η²β²)) in place of r (derived in `approximate::projection`); with η = 0, light takes no time
//! and c = r⊥ + n r∥/γ is the position of the contracted object at the time of the shot.
//!
//! With this map π from points to the film, the candidate's point Y at pixel p is misplaced by π(Y) − p: without a search or differences,
//! and correct beyond silhouettes, too. It is measured relative to π(X) of the reference's own point X, so that pictures sampled elsewhere
//! than at pixel centres are compared with what they show.

use std::collections::BTreeMap;
use std::path::Path;

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::picture::{Picture, Plane, is_identity};
use super::points::{FEWEST_OF_OBJECT, OBJECT_POINT, Points, around, place};
use crate::camera::{AnyProjection, Projection, Shot};
use crate::error::Result;
use crate::io::image::{Channel, Layers, Samples};
use crate::render::aov::Aov;
use crate::scene::model::{
    CameraModel, CubeData, Effects, Equations, Geometry, Motion, Object, Scene, Source, SourceKind,
};
use crate::scene::{self, CameraMotion, Overrides};
use crate::spacetime::{
    self, Boost, Direction, Displacement, Event, InertialFrame, Rest, Velocity, World,
};

/// The part of a scene that determines where points of objects are seen.
#[derive(Debug, Clone, PartialEq)]
pub struct KnownScene {
    model: CameraModel,
    film: AnyProjection,
    /// The event of the shot, from which all rays start.
    event: Event<World>,
    camera: InertialFrame<spacetime::CameraFrame>,
    /// How the world's directions are converted to the camera's frame.
    aberration: Aberration,
    /// Refractive index of the medium; 0 where light takes no time.
    index: f64,
    objects: Vec<InertialFrame<Rest>>,
    /// How the points of each object are seen in the world; `None` for those that outrun light.
    views: Vec<Option<ObjectView>>,
    /// Whether objects are contracted in the world.
    contracts: bool,
}

/// How the points of an object are seen in the world: along the boosted c, of the head of this module.
#[derive(Debug, Clone, Copy, PartialEq)]
struct ObjectView {
    /// The place q of the shot in the object's frame.
    shot: DVec3,
    /// n, and (1/(γ √(1 − η²β²)) − 1); `None` for those with c = r.
    stretch: Option<(DVec3, f64)>,
    boost: Boost<World, Rest>,
}

impl ObjectView {
    /// For an object at rest in `frame`, a shot at `event` and the refractive index η; `None` if the object outruns light.
    fn new(frame: &InertialFrame<Rest>, event: Event<World>, index: f64) -> Option<ObjectView> {
        let shot = frame.event_from_world(event).x;
        let (n, rapidity) = frame.velocity().split();
        let slowed = index * libm::tanh(rapidity);
        if slowed >= 1.0 {
            return None;
        }
        let (stretch, boost) = match index == 1.0 || rapidity == 0.0 {
            true => (None, *frame.world_from_frame()),
            false => {
                // 1/(γq) − 1, as in `approximate::projection`.
                let q = ((1.0 - slowed) * (1.0 + slowed)).sqrt();
                let stretch = 1.0 / (frame.velocity().gamma() * q) - 1.0;
                let velocity = Velocity::from_rapidity_along(libm::atanh(slowed), n).ok()?;
                (Some((n, stretch)), Boost::new(velocity))
            }
        };
        Some(ObjectView {
            shot,
            stretch,
            boost,
        })
    }

    /// The world's direction in which the object's point `p` is seen.
    fn direction(&self, p: DVec3) -> Option<Direction<World>> {
        let r = p - self.shot;
        let c = match self.stretch {
            Some((n, stretch)) => r + n * (n.dot(r) * stretch),
            None => r,
        };
        Some(self.boost.direction(Direction::new(c)?).0)
    }
}

/// How the world's directions are converted to the camera's frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Aberration {
    /// By the boost.
    Exact,
    /// Unchanged.
    Missing,
    /// By a boost that lacks γ: along d + β.
    WithoutGamma,
}

/// A mistake that a rasterizer may have made with a scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Change {
    /// Light takes no time.
    Instant,
    /// Light arrives from events as much later as it left earlier.
    Advanced,
    /// The camera moves in the opposite direction.
    CameraReversed,
    /// The camera's motion does not change directions.
    CameraAtRest,
    /// It changes them by a boost that lacks γ.
    CameraWithoutGamma,
    /// An object is at rest.
    AtRest(usize),
    /// An object is at rest where its origin is at the time of the shot.
    Standing(usize),
    /// An object moves in the opposite direction.
    Reversed(usize),
    /// Two objects have each other's velocity.
    Swapped(usize, usize),
    /// Objects are not contracted: their matrices lack γ.
    Uncontracted,
}

/// Where an origin is at the time `ct`. The null vectors (|r|, r) of the future light cone have in a frame that moves at β the directions that
/// (−|r|, r) have in one that moves at −β: where light would arrive from later, an object that moves at −β through its place at the time of
/// the shot is seen.
pub(super) fn at_time(velocity: Velocity, origin: Event<World>, ct: f64) -> Event<World> {
    Event::new(ct, origin.x + velocity.beta() * (ct - origin.ct))
}

/// The result of `read` for the scene in a picture's metadata.
fn described<T>(
    picture: &Picture,
    read: fn(&str, &str, &Path, &Overrides) -> Result<T>,
) -> Option<T> {
    let text = picture.metadata("scene_text")?;
    let name = picture.metadata("scene").unwrap_or("scene");
    let overrides = Overrides {
        size: Some([picture.layers.width, picture.layers.height]),
        ..Overrides::default()
    };
    read(text, name, scene::base(name.as_ref()), &overrides).ok()
}

/// The whole scene that the metadata of a picture describes; `None` if it needs files, which may have changed, or light that is reflected
/// more than once, which may take long.
pub(super) fn scene_of_picture(picture: &Picture) -> Option<Scene> {
    let mut scene = described(picture, scene::parse)?;
    if let Some(time) = picture.metadata("camera_time") {
        scene.camera = scene.camera.at(time.parse().ok()?);
    }
    (scene.bounces == 0 && is_all_in_its_text(&scene)).then_some(scene)
}

/// Whether a scene needs no files.
pub(super) fn is_all_in_its_text(scene: &Scene) -> bool {
    let is_shape = |object: &Object| {
        matches!(object.geometry, Geometry::Shape { .. }) && object.texture_coordinates.is_none()
    };
    let is_file = |source: &Source| match &source.kind {
        SourceKind::Cube(cube) => matches!(cube.data, CubeData::File(_)),
        SourceKind::Pulse(_) => false,
    };
    let sky = scene.sky.as_ref();
    scene.objects.iter().all(is_shape)
        && !scene.sources.iter().any(is_file)
        && sky.is_none_or(|sky| sky.files().next().is_none())
}

/// The camera of one eye of a stereo pair, with a picture of `size`; `None` for single cameras, and for those that accelerate or rotate.
pub(super) fn eye(pair: &CameraModel, side: f64, size: [u32; 2]) -> Option<CameraModel> {
    let distance = pair.stereo?.interpupillary_distance;
    (pair.motion == Motion::Inertial && pair.rotation.is_none()).then_some(())?;
    let frame = InertialFrame::<spacetime::CameraFrame>::new(pair.velocity, pair.origin);
    let [right, ..] = pair.axes;
    let offset = Displacement::new(0.0, right * (0.5 * side * distance));
    let offset = frame.world_from_frame().displacement(offset);
    let origin = Event::new(pair.origin.ct + offset.ct, pair.origin.x + offset.x);
    Some(CameraModel {
        stereo: None,
        origin,
        size,
        ..pair.clone()
    })
}

/// The world's unit direction d that a boost without γ turns into `own`, along d + β.
pub(super) fn unaberrated_without_gamma(own: DVec3, velocity: Velocity) -> DVec3 {
    // |s d′ − β| = 1 for s > 0.
    let beta = velocity.beta();
    let along = own.dot(beta);
    let s = along + (along * along + 1.0 - beta.length_squared()).sqrt();
    s * own - beta
}

/// The relative tolerance between time and distance for an event to be on the past light cone of the shot.
const ON_CONE: f64 = 1e-3;

impl KnownScene {
    /// Extracts it from `scene`; `None` for cameras whose rays start at different events (a sensor, a shutter, stereo, or `model =
    /// "paper2015"` in motion).
    pub fn of(scene: &Scene) -> Option<KnownScene> {
        let bodies = scene
            .objects
            .iter()
            .map(|object| (object.velocity, object.origin));
        let light = (scene.medium_index, scene.effects, scene.equations);
        KnownScene::new(&scene.camera, bodies.collect(), light)
    }

    /// From the scene's text in the metadata of a picture; `None` if there is no such text, or its camera is in a file that does not exist.
    pub(super) fn of_picture(picture: &Picture) -> Option<KnownScene> {
        KnownScene::of_metadata(picture, Some)
    }

    /// The same for one eye's half of a stereo pair, -1 for the left one and 1 for the right one.
    pub(super) fn of_eye(half: &Picture, side: f64) -> Option<KnownScene> {
        let size = [half.layers.width, half.layers.height];
        KnownScene::of_metadata(half, |camera| eye(&camera, side, size))
    }

    fn of_metadata(
        picture: &Picture,
        camera: impl Fn(CameraModel) -> Option<CameraModel>,
    ) -> Option<KnownScene> {
        let motions = described(picture, scene::kinematics)?;
        let CameraMotion { model, .. } = motions.camera?;
        let mut model = camera(model)?;
        // A frame of a sequence has its own time.
        if let Some(time) = picture.metadata("camera_time") {
            model = model.at(time.parse().ok()?);
        }
        let bodies = motions
            .objects
            .iter()
            .map(|body| (body.velocity, body.origin));
        let light = (motions.medium_index, motions.effects, motions.equations);
        KnownScene::new(&model, bodies.collect(), light)
    }

    fn new(
        camera: &CameraModel,
        bodies: Vec<(Velocity, Event<World>)>,
        (index, effects, equations): (f64, Effects, Equations),
    ) -> Option<KnownScene> {
        let shot = Shot::new(camera).ok()?;
        let is_instant = camera.sensor.is_none() && camera.shutter.is_none();
        let is_point = is_instant && camera.stereo.is_none();
        let is_exact = equations == Equations::Exact || shot.frame.velocity().is_rest();
        (is_point && is_exact).then_some(())?;
        let scene = KnownScene {
            model: camera.clone(),
            film: shot.projection,
            event: shot.event,
            camera: shot.frame,
            aberration: match effects.aberration {
                true => Aberration::Exact,
                false => Aberration::Missing,
            },
            index: if effects.retardation { index } else { 0.0 },
            objects: bodies
                .into_iter()
                .map(|(velocity, origin)| InertialFrame::new(velocity, origin))
                .collect(),
            views: Vec::new(),
            contracts: true,
        };
        Some(scene.with_views())
    }

    /// With the views of its objects, for its shot and medium.
    fn with_views(mut self) -> KnownScene {
        let view = |frame: &InertialFrame<Rest>| ObjectView::new(frame, self.event, self.index);
        self.views = self.objects.iter().map(view).collect();
        self
    }

    /// The same scene with a change; `None` if the change makes no difference to the picture.
    pub(super) fn changed(&self, change: Change) -> Option<KnownScene> {
        let mut changed = self.clone();
        let velocity = |k: usize| Some(self.objects.get(k)?.velocity());
        let mut set = |k: usize, velocity: Velocity| {
            changed.objects[k] = InertialFrame::new(velocity, self.objects[k].origin());
        };
        match change {
            Change::Instant => changed.index = 0.0,
            Change::Advanced => {
                let advanced = |frame: &InertialFrame<Rest>| {
                    let (velocity, origin) = (frame.velocity(), frame.origin());
                    let origin = at_time(velocity, origin, self.event.ct);
                    InertialFrame::new(-velocity, origin)
                };
                changed.objects = self.objects.iter().map(advanced).collect();
            }
            Change::CameraAtRest => changed.aberration = Aberration::Missing,
            // For a camera at rest both are the same.
            Change::CameraWithoutGamma if self.camera.velocity().is_rest() => return None,
            Change::CameraWithoutGamma => changed.aberration = Aberration::WithoutGamma,
            Change::CameraReversed => {
                changed.camera = InertialFrame::new(-self.camera.velocity(), self.camera.origin());
            }
            Change::AtRest(k) => set(k, Velocity::REST),
            Change::Standing(k) => {
                let frame = self.objects.get(k)?;
                let origin = at_time(frame.velocity(), frame.origin(), self.event.ct);
                changed.objects[k] = InertialFrame::new(Velocity::REST, origin);
            }
            Change::Reversed(k) => set(k, -velocity(k)?),
            Change::Swapped(j, k) => {
                let (of_j, of_k) = (velocity(j)?, velocity(k)?);
                set(j, of_k);
                set(k, of_j);
            }
            Change::Uncontracted if self.velocities().all(Velocity::is_rest) => return None,
            Change::Uncontracted => changed.contracts = false,
        }
        let changed = changed.with_views();
        (changed != *self).then_some(changed)
    }

    /// The camera, at the time of its shot.
    pub(super) fn camera(&self) -> &CameraModel {
        &self.model
    }

    /// The same scene seen by another camera with the same kind of film.
    pub(super) fn seen_by(&self, camera: CameraModel) -> Option<KnownScene> {
        let shot = Shot::new(&camera).ok()?;
        let scene = KnownScene {
            model: camera,
            film: shot.projection,
            event: shot.event,
            camera: shot.frame,
            ..self.clone()
        };
        Some(scene.with_views())
    }

    /// The displacement from the shot to an event of the world: its spatial part in the world, and in the camera's frame.
    pub(super) fn since_shot(&self, ct: f64, x: DVec3) -> [DVec3; 2] {
        let way = Displacement::new(ct - self.event.ct, x - self.event.x);
        [way.x, self.camera.frame_from_world().displacement(way).x]
    }

    /// The path of light that arrives from the world's distance `s` along `d`, in the camera's frame.
    pub(super) fn own_way(&self, s: f64, d: DVec3) -> DVec3 {
        let way = Displacement::new(-self.index * s, s * d);
        self.camera.frame_from_world().displacement(way).x
    }

    /// Refractive index of the medium; 0 where light takes no time.
    pub(super) fn index(&self) -> f64 {
        self.index
    }

    /// The world's time of the shot.
    pub(super) fn shot_time(&self) -> f64 {
        self.event.ct
    }

    /// The look direction in the camera's frame for one in the world.
    pub(super) fn own_look(&self, d: DVec3) -> Option<DVec3> {
        let d = Direction::new(d)?;
        Some(self.camera.frame_from_world().direction(d).0.unit())
    }

    /// A vector of the camera's frame in components along its axes: right, up and backwards.
    pub(super) fn view(&self, v: DVec3) -> DVec3 {
        self.film.along_axes(v) * DVec3::new(1.0, 1.0, -1.0)
    }

    /// The camera's velocity in the world.
    pub(super) fn camera_velocity(&self) -> Velocity {
        self.camera.velocity()
    }

    /// The velocity that aberrates look directions.
    pub(super) fn velocity_of_looks(&self) -> Velocity {
        match self.aberration {
            Aberration::Missing => Velocity::REST,
            Aberration::Exact | Aberration::WithoutGamma => self.camera.velocity(),
        }
    }

    /// The velocities of the objects in the world.
    pub(super) fn velocities(&self) -> impl Iterator<Item = Velocity> + '_ {
        self.objects.iter().map(InertialFrame::velocity)
    }

    /// The place of the shot in the rest frame of an object: q, of the head of this module.
    pub(super) fn shot_in(&self, k: usize) -> Option<DVec3> {
        Some(self.views.get(k)?.as_ref()?.shot)
    }

    /// The rest frame of an object.
    pub(super) fn frame(&self, k: usize) -> Option<&InertialFrame<Rest>> {
        self.objects.get(k)
    }

    /// The projection's field of view from the middle of the left edge to the middle of the right edge, radians.
    pub(super) fn horizontal_fov(&self) -> f64 {
        let [w, h] = self.film.size();
        let [left, right] = [0.0, w].map(|x| self.film.vector(x, 0.5 * h));
        left.angle_between(right)
    }

    /// The image of the point `p` of object `k`, pixels from the film's top left corner; `None` if it would not be seen on a film of any
    /// size, or is seen twice.
    pub(super) fn film_point(&self, k: usize, p: DVec3) -> Option<DVec2> {
        let view = self.views.get(k)?.as_ref()?;
        // A body that is not contracted is one that is γ times as long in its rest frame.
        let p = match self.contracts {
            true => p,
            false => {
                let velocity = self.objects[k].velocity();
                let (n, _) = velocity.split();
                p + n * (n.dot(p) * (velocity.gamma() - 1.0))
            }
        };
        self.film_point_along(view.direction(p)?)
    }

    /// The image of the world's direction `d`; `None` if no film point looks that way.
    pub(super) fn film_point_along(&self, d: Direction<World>) -> Option<DVec2> {
        let seen = match self.aberration {
            Aberration::Exact => self.camera.frame_from_world().direction(d).0.unit(),
            Aberration::Missing => d.unit(),
            Aberration::WithoutGamma => (d.unit() + self.camera.velocity().beta()).normalize(),
        };
        let point = self.film.film_point(self.film.along_axes(seen))?;
        Some(DVec2::from_array(point)).filter(|point| point.is_finite())
    }

    /// The world's direction along which the film point `p` looks; `None` if it sees nothing.
    pub(super) fn look_along(&self, p: DVec2) -> Option<Direction<World>> {
        let own = self.own_look_along(p)?;
        match self.aberration {
            Aberration::Exact => {
                let own = Direction::from_unit(own);
                Some(self.camera.world_from_frame().direction(own).0)
            }
            Aberration::Missing => Direction::new(own),
            Aberration::WithoutGamma => {
                Direction::new(unaberrated_without_gamma(own, self.camera.velocity()))
            }
        }
    }

    /// The unit look direction of the film point `p` in the camera's frame; `None` if it sees nothing.
    pub(super) fn own_look_along(&self, p: DVec2) -> Option<DVec3> {
        self.film.sees(p.x, p.y).then_some(())?;
        Some(Direction::<World>::new(self.film.vector(p.x, p.y))?.unit())
    }

    /// The world's direction from the shot to an event of its past light cone; `None` for other events.
    pub(super) fn look_to(&self, ct: f64, x: DVec3) -> Option<Direction<World>> {
        let [way, _] = self.since_shot(ct, x);
        let late = ct - self.event.ct + self.index * way.length();
        (late.abs() <= ON_CONE * way.length()).then_some(())?;
        Direction::new(way)
    }

    /// The object at pixel `i` of a picture, and the coordinates in it of the point shown there. If the picture has events of the world
    /// only, this works for objects at rest only: any event on the past light cone of the shot is seen where it is, whichever point of a
    /// moving object it may be.
    pub(super) fn point(&self, points: &Points, i: usize) -> Option<(usize, DVec3)> {
        let k = match points.object_at(i) {
            Some(id) if id >= 0.0 => id as usize,
            Some(_) => return None,
            None => (self.objects.len() == 1).then_some(0)?,
        };
        let frame = self.objects.get(k)?;
        let p = match points.own_point(i) {
            Some(p) => p,
            None => {
                let place = points
                    .world_point(i)
                    .filter(|_| frame.velocity().is_rest())?;
                place - frame.origin().x
            }
        };
        p.is_finite().then_some((k, p))
    }

    /// The objects of a picture and their own points, p = Λ(β)(E − O) for an event E of the world if the picture has no such channels;
    /// `None` without events and their times. Unlike where E is seen, p depends on the object's velocity.
    pub(super) fn own_points(&self, layers: &Layers) -> Option<Layers> {
        let [points, _] = Points::pair([layers, layers]);
        let count = points.width * points.height;
        let own: Vec<DVec3> = match points.material {
            Some(own) => (0..count).map(|i| place(&own, i)).collect(),
            None => {
                let (time, world) = (Plane::aov(layers, Aov::EventCt)?, points.world?);
                let frame = |i: usize| self.objects.get(points.object_at(i)? as usize);
                let own = |i: usize| {
                    let event = Event::new(time.at(i), place(&world, i));
                    frame(i).map_or(DVec3::NAN, |frame| frame.event_from_world(event).x)
                };
                points.object?;
                (0..count).map(own).collect()
            }
        };
        let axes = OBJECT_POINT
            .into_iter()
            .enumerate()
            .map(|(k, aov)| Channel {
                name: aov.name().into(),
                samples: Samples::F64(own.iter().map(|p| p[k]).collect()),
            });
        let is_index = |channel: &&Channel| is_identity(channel);
        let indices = layers.channels.iter().filter(is_index).cloned();
        let channels = indices.chain(axes).collect();
        Layers::new(layers.width, layers.height, channels, Vec::new()).ok()
    }

    /// Where the point that a picture shows at pixel `i` is seen.
    pub(super) fn place(&self, points: &Points, i: usize) -> Option<DVec2> {
        let (k, p) = self.point(points, i)?;
        self.film_point(k, p)
    }

    /// Whether the `points` of a reference are seen where this scene predicts: see [`KnownScene::contradiction`].
    pub(super) fn is_that_of(&self, points: &Points) -> bool {
        self.contradiction(points).is_none()
    }

    /// What of the `points` of a reference is not seen where this scene predicts, if anything. The median of their distances from pixel
    /// centres has to be below 3/4, the most that samples elsewhere in pixels can cause: of all of them, and of those of each object, but
    /// for its rims, where points may be means over several surfaces.
    pub(super) fn contradiction(&self, points: &Points) -> Option<Contradiction> {
        let size = points.size();
        let off = |i: usize| {
            let centre = DVec2::new((i % size[0]) as f64 + 0.5, (i / size[0]) as f64 + 0.5);
            let (k, p) = self.point(points, i)?;
            let id = points.object_at(i);
            let is_inside = around(size, i).all(|j| points.object_at(j) == id);
            Some((k, (self.film_point(k, p)? - centre).length(), is_inside))
        };
        let pixels = (0..size[0] * size[1]).into_par_iter();
        let all: Vec<(usize, f64, bool)> = pixels.filter_map(off).collect();
        // Half of a pixel's diagonal is 0.71: anything farther off is seen in another pixel.
        let is_off = |mut distances: Vec<f64>| {
            let middle = distances.len() / 2;
            let (_, median, _) = distances.select_nth_unstable_by(middle, f64::total_cmp);
            *median >= 0.75
        };
        if all.is_empty() || is_off(all.iter().map(|(_, off, _)| *off).collect()) {
            return Some(Contradiction::Points);
        }
        let mut objects = BTreeMap::<usize, Vec<f64>>::new();
        for (k, off, _) in all.iter().filter(|(.., is_inside)| *is_inside) {
            objects.entry(*k).or_default().push(*off);
        }
        objects.retain(|_, off| off.len() as u64 >= FEWEST_OF_OBJECT);
        let mut wrong = objects
            .into_iter()
            .filter_map(|(k, off)| is_off(off).then_some(k));
        wrong.next().map(Contradiction::Object)
    }
}

/// What of a reference is not where a scene says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Contradiction {
    /// Most of its points, or all.
    Points,
    /// The points of the object with this index.
    Object(usize),
}
