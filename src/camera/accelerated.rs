//! Cameras on any world line, with a sensor, a shutter, or both.
//!
//! At proper time t the pinhole is at X(t), with the comoving frame Λ(t). The sensor element of film
//! vector D is exposed at the event E = X(t) + q, with the pinhole's four-velocity u(t):
//!
//! ```text
//! rigid:         q = Λ (0, −f D)          world length:  the same with f′ (`inertial`)
//! Bell's ships:  q = (0, −f D)            in the world: shifted copies of one world line
//! ```
//!
//! A rigid camera is Born-rigid: the elements that are simultaneous with the pinhole in its comoving frame keep their distances and share
//! its velocity. Such a body does not rotate (Fermi–Walker transport); on a path that is not straight, the camera's axes, which are the
//! world's axes boosted without rotation, do rotate relative to it (Thomas precession). Each moment's picture is that of the rigid body
//! whose axes coincide with the camera's at that moment. The light passed the pinhole at the event P of X(·) on the past light cone of E;
//! its look direction is that of P − E. For a pinhole without acceleration, P = −f|D| u again.

use glam::DVec3;

use super::any_projection::AnyProjection;
use super::inertial::ExposureTime;
use super::projection::Projection;
use super::rays::{RayBlock, SimpleRays};
use super::{CameraRay, FilmPoints, RayOrigin, RaySlices, Shot, View};
use crate::accel::vectors::{BLOCK, Block};
use crate::scene::model::{Assembly, CameraModel, Sensor};
use crate::spacetime::worldline::{Anchor, State, Stretch, Vicinity, WorldLine};
use crate::spacetime::{Boost, CameraFrame, Direction, Displacement, Event, Frame, World};

/// A camera on a world line, with a sensor, a shutter, or both.
#[derive(Debug)]
pub struct Accelerated {
    line: WorldLine,
    film: AnyProjection,
    sensor: Option<Sensor>,
    /// Camera time and event of the shot.
    time: f64,
    event: Event<World>,
    /// The camera at that time, if there is no exposure.
    instant: Option<Placed>,
    /// The world line during the exposure of a camera without a sensor, if its acceleration is constant then.
    stretch: Option<Stretch>,
    exposure: ExposureTime,
    aberration: bool,
}

/// The camera at a proper time.
#[derive(Debug)]
struct Placed {
    state: State,
    world_from_camera: Boost<World, CameraFrame>,
    /// The neighbourhood of the state, if the acceleration is constant there.
    vicinity: Option<Vicinity>,
    /// The focal length in its own frame less that in the scene, metres.
    stretch: f64,
    /// From the event of the shot to the pinhole's event.
    moved: Displacement<World>,
}

/// The ray of a sensor element.
struct ElementRay {
    d: Direction<World>,
    seen: Direction<CameraFrame>,
    ratio: f64,
    /// From the pinhole's event at the time of exposure to the event at which the ray leaves.
    from: Displacement<World>,
}

impl Accelerated {
    /// The view of `model`, which moves along `line`; its shutter opens at `shot`.
    pub fn new(model: &CameraModel, line: WorldLine, shot: &Shot, aberration: bool) -> Self {
        let exposure = ExposureTime::of(model);
        let mut camera = Accelerated {
            line,
            film: shot.projection.clone(),
            sensor: model.sensor,
            time: model.time,
            event: shot.event,
            instant: None,
            stretch: None,
            exposure,
            aberration,
        };
        // An instant has one state for all rays; without a sensor, exposures under constant acceleration have a closed form.
        if exposure.duration == 0.0 {
            camera.instant = camera.placed(0.0);
        } else if camera.sensor.is_none() {
            let times = [camera.time, camera.time + exposure.duration];
            camera.stretch = camera.line.stretch(times, camera.event);
        }
        camera
    }

    /// The projection of the film in the camera's own frame at `shot`; `None` for Bell's ships in motion ([`super::Camera::film`]).
    pub(super) fn film_at_shot(&self, shot: &Shot) -> Option<AnyProjection> {
        let Some(sensor) = self.sensor else {
            return Some(self.film.clone());
        };
        let velocity = shot.frame.velocity();
        if sensor.assembly == Assembly::Bell {
            return velocity.is_rest().then(|| self.film.clone());
        }
        let own = sensor.own_focal_length(self.film.forward(), velocity);
        Some(self.film.stretched(own / sensor.focal_length))
    }

    /// Whether the light that reaches every element passed the pinhole on its world line, during the whole exposure.
    pub(super) fn sees_everywhere(&self) -> bool {
        // The light of the corners takes longest; check the first and the last moment of the exposure.
        let times = [0.0, self.exposure.duration];
        times.iter().all(|t| {
            let placed = self.placed(*t);
            let mut corners = self.film.corners().into_iter();
            placed.is_some_and(|p| corners.all(|at| self.element_ray(&p, &self.film, at).is_some()))
        })
    }

    /// The camera at time `t` after the shot, if its world line extends that far.
    #[inline]
    fn placed(&self, t: f64) -> Option<Placed> {
        let state = self.line.state(self.time + t)?;
        Some(Placed {
            world_from_camera: *state.frame().world_from_frame(),
            vicinity: self.line.vicinity(&state),
            stretch: self.sensor.map_or(0.0, |sensor| {
                let own = sensor.own_focal_length(self.film.forward(), state.velocity);
                own - sensor.focal_length
            }),
            moved: state.event - self.event,
            state,
        })
    }

    /// The ray of a camera without a sensor, which depends only on its velocity and position at the moment.
    fn ray_from_point<P: Projection>(
        &self,
        film: &P,
        at: [f64; 2],
        moment: f64,
    ) -> Option<CameraRay> {
        if let Some(stretch) = &self.stretch {
            return Some(self.stretch_ray(stretch, film, at, moment));
        }
        let (event, velocity) = self.line.place(self.moment(moment))?;
        let seen = film.direction(at[0], at[1]);
        let (d, ratio) = Boost::<World, CameraFrame>::new(velocity).direction(seen);
        Some(self.point_ray(film, at, (seen, d, ratio, event - self.event)))
    }

    /// The same, if the acceleration is constant during the exposure.
    #[inline(always)]
    fn stretch_ray<P: Projection>(
        &self,
        stretch: &Stretch,
        film: &P,
        at: [f64; 2],
        moment: f64,
    ) -> CameraRay {
        let seen = film.direction(at[0], at[1]);
        let time = self.moment(moment);
        let (moved, d, ratio) = stretch.nearest(time).look(time, seen);
        self.point_ray(film, at, (seen, d, ratio, moved))
    }

    /// Camera time at a moment of the exposure.
    #[inline(always)]
    fn moment(&self, moment: f64) -> f64 {
        self.time + moment * self.exposure.duration
    }

    /// The ray of a camera without a sensor that has `moved` since the shot, from its look direction in the camera and in the world.
    #[inline(always)]
    fn point_ray<P: Projection>(
        &self,
        film: &P,
        [x, y]: [f64; 2],
        (seen, d, ratio, moved): (
            Direction<CameraFrame>,
            Direction<World>,
            f64,
            Displacement<World>,
        ),
    ) -> CameraRay {
        CameraRay {
            d: match self.aberration {
                true => d,
                false => Direction::from_unit(seen.unit()),
            },
            ratio,
            origin: RayOrigin {
                displacement: moved,
                delay: 1.0,
                weight: self.exposure.weight_at(film, x, y),
            },
        }
    }

    /// The ray of an element of the sensor of `camera`.
    #[inline(always)]
    fn camera_ray(&self, camera: &Placed, ray: ElementRay) -> CameraRay {
        CameraRay {
            d: match self.aberration {
                true => ray.d,
                false => Direction::from_unit(ray.seen.unit()),
            },
            ratio: ray.ratio,
            origin: RayOrigin {
                displacement: camera.moved + ray.from,
                delay: 1.0,
                weight: self.exposure.weight,
            },
        }
    }

    /// The ray of the element at film point `(x, y)`.
    fn element_ray<P: Projection>(
        &self,
        camera: &Placed,
        film: &P,
        at: [f64; 2],
    ) -> Option<ElementRay> {
        let Some(sensor) = &self.sensor else {
            let seen = film.direction(at[0], at[1]);
            return Some(camera.element_ray(seen, Displacement::new(0.0, DVec3::ZERO)));
        };
        // Closed form while the acceleration is constant; if the crossing lies elsewhere, it is searched on the whole world line.
        let near = camera.vicinity.as_ref().and_then(|vicinity| {
            let (ray, is_seen) = match sensor.assembly {
                Assembly::Bell => camera.nearby_ship(vicinity, element(film, sensor, at)),
                Assembly::Rigid | Assembly::WorldLength => {
                    camera.nearby_on_body(vicinity, camera.on_body(film, sensor, at))
                }
            };
            is_seen.then_some(ray)
        });
        near.or_else(|| self.element_ray_anywhere(camera, film, sensor, at))
    }

    /// The same if the acceleration is not constant, or changes while the light is on its way.
    #[inline(never)]
    fn element_ray_anywhere<P: Projection>(
        &self,
        camera: &Placed,
        film: &P,
        sensor: &Sensor,
        at: [f64; 2],
    ) -> Option<ElementRay> {
        // The light that the element receives now passed the pinhole where its line crosses the past light cone of the element.
        let passage = |offset| {
            let crossing = self.line.on_past_light_cone(&camera.state, offset)?;
            Some(crossing.displacement)
        };
        match sensor.assembly {
            Assembly::Bell => {
                // Bell: the offset from pinhole to element is fixed in the world.
                let element = element(film, sensor, at);
                let from = passage(Displacement::new(0.0, element))?;
                Some(camera.ray_of_ship(along(from.x - element)?, from))
            }
            Assembly::Rigid | Assembly::WorldLength => {
                // Rigid: it is fixed in the camera's momentary rest frame.
                let element = camera.on_body(film, sensor, at);
                let offset = Displacement::new(0.0, element);
                let from = passage(camera.world_from_camera.displacement(offset))?;
                let own = camera.state.frame().frame_from_world().displacement(from);
                Some(camera.element_ray(along(own.x - element)?, from))
            }
        }
    }
}

/// The element at film point `(x, y)` relative to the pinhole: in the camera's frame, or in the world for Bell's ships.
#[inline(always)]
fn element<P: Projection>(film: &P, sensor: &Sensor, [x, y]: [f64; 2]) -> DVec3 {
    film.vector(x, y) * -sensor.focal_length
}

impl Placed {
    /// The element at film point `(x, y)` of a rigid sensor relative to the pinhole, in the camera's frame.
    #[inline(always)]
    fn on_body<P: Projection>(&self, film: &P, sensor: &Sensor, at: [f64; 2]) -> DVec3 {
        // The focal length is stretched, but the sensor is not.
        element(film, sensor, at) - film.forward() * self.stretch
    }

    /// The ray of `element` of a rigid sensor for light that passed the pinhole in `vicinity`, and whether there is any.
    #[inline(always)]
    fn nearby_on_body(&self, vicinity: &Vicinity, element: DVec3) -> (ElementRay, bool) {
        let (seen, own, is_seen) = passage_on_body(vicinity, element);
        (self.element_ray(seen, vicinity.in_world(own)), is_seen)
    }

    /// The same for an element with its own world line (Bell).
    #[inline(always)]
    fn nearby_ship(&self, vicinity: &Vicinity, element: DVec3) -> (ElementRay, bool) {
        let (own, crosses) =
            passage_of_ship(self.state.frame().frame_from_world(), vicinity, element);
        let from = vicinity.in_world(own);
        let (d, is_usual) = along_usual(from.x - element);
        (self.ray_of_ship(d, from), crosses & is_usual)
    }

    /// The ray that leaves at `from` along the look direction `seen` of the comoving frame.
    #[inline(always)]
    fn element_ray(&self, seen: Direction<CameraFrame>, from: Displacement<World>) -> ElementRay {
        let (d, ratio) = self.world_from_camera.direction(seen);
        ElementRay {
            d,
            seen,
            ratio,
            from,
        }
    }

    /// The ray that leaves at `from` along the look direction `d` of the world.
    #[inline(always)]
    fn ray_of_ship(&self, d: Direction<World>, from: Displacement<World>) -> ElementRay {
        let (seen, ratio) = self.state.frame().frame_from_world().direction(d);
        ElementRay {
            d,
            seen,
            // The boost's ratio is that from the camera to the world.
            ratio: 1.0 / ratio,
            from,
        }
    }
}

/// The look direction of `element` of a rigid sensor, the event at which its light passed the pinhole in `vicinity`, and whether both
/// exist.
#[inline(always)]
fn passage_on_body(
    vicinity: &Vicinity,
    element: DVec3,
) -> (Direction<CameraFrame>, Displacement<CameraFrame>, bool) {
    let apex = Displacement::new(0.0, element);
    let (own, crosses) = vicinity.crossing_or_not(apex, element.length_squared());
    let (seen, is_usual) = along_usual(own.x - element);
    (seen, own, crosses & is_usual)
}

/// The event at which the light of `element`, which has its own world line (Bell), passed the pinhole, and whether it did.
#[inline(always)]
fn passage_of_ship(
    frame_from_world: &Boost<CameraFrame, World>,
    vicinity: &Vicinity,
    element: DVec3,
) -> (Displacement<CameraFrame>, bool) {
    let apex = frame_from_world.displacement(Displacement::new(0.0, element));
    vicinity.crossing_or_not(apex, element.length_squared())
}

/// The direction of `way`.
fn along<F: Frame>(way: DVec3) -> Option<Direction<F>> {
    match along_usual(way) {
        (direction, true) => Some(direction),
        _ => Direction::new(way),
    }
}

/// The direction of `way`, and whether its square is in the range where that is accurate, as it is unless the camera's dimensions are
/// extreme.
#[inline(always)]
#[allow(clippy::manual_range_contains, reason = "without a branch")]
fn along_usual<F: Frame>(way: DVec3) -> (Direction<F>, bool) {
    // Within 1e±200 neither the square nor the inverse of its root overflows or loses digits.
    let square = way.length_squared();
    let direction = Direction::from_unit(way * (1.0 / square.sqrt()));
    (direction, (square >= 1e-200) & (square < 1e200))
}

/// The ray of an element whose light never passed the pinhole.
fn nothing() -> CameraRay {
    CameraRay {
        d: Direction::from_unit(DVec3::NAN),
        ratio: f64::NAN,
        origin: RayOrigin {
            weight: 0.0,
            ..RayOrigin::AT_SHOT
        },
    }
}

impl View for Accelerated {
    const SHARED_ORIGIN: bool = false;

    #[inline]
    fn uses_time(&self) -> bool {
        self.exposure.duration > 0.0
    }

    #[inline]
    fn film(&self) -> &AnyProjection {
        &self.film
    }

    #[inline]
    fn ray_through<P: Projection>(&self, film: &P, x: f64, y: f64, moment: f64) -> CameraRay {
        if self.sensor.is_none() {
            return self
                .ray_from_point(film, [x, y], moment)
                .unwrap_or_else(nothing);
        }
        let later;
        let camera = match &self.instant {
            Some(placed) => placed,
            None => {
                let Some(placed) = self.placed(moment * self.exposure.duration) else {
                    return nothing();
                };
                later = placed;
                &later
            }
        };
        match self.element_ray(camera, film, [x, y]) {
            Some(ray) => self.camera_ray(camera, ray),
            None => nothing(),
        }
    }

    #[inline(always)]
    fn rays<P: Projection>(&self, film: &P, points: &FilmPoints, mut rays: RaySlices) {
        // Under constant acceleration the pinhole's event is a closed form in the camera's time: a vectorized loop.
        if let Some(anchor) = self.stretch.as_ref().and_then(Stretch::only) {
            let moments = Moments {
                camera: self,
                anchor,
            };
            return rays.fill_by(&moments, self, film, points);
        }
        // Where the acceleration changes while light is on its way, solve for the crossing ray by ray.
        let placed = self.instant.as_ref();
        let vicinity = placed.and_then(|placed| placed.vicinity.as_ref());
        let (Some(sensor), Some(placed), Some(vicinity)) = (&self.sensor, placed, vicinity) else {
            return rays.fill(self, film, points);
        };
        let (camera, sensor) = (self, *sensor);
        match sensor.assembly {
            Assembly::Bell => {
                let ships = Ships {
                    camera,
                    placed,
                    vicinity,
                    sensor,
                };
                rays.fill_by(&ships, self, film, points);
            }
            Assembly::Rigid | Assembly::WorldLength => {
                let body = Body {
                    camera,
                    placed,
                    vicinity,
                    sensor,
                };
                rays.fill_by(&body, self, film, points);
            }
        }
    }
}

/// Moments of an exposure near one of them.
struct Moments<'a> {
    camera: &'a Accelerated,
    anchor: &'a Anchor,
}

impl SimpleRays for Moments<'_> {
    #[inline(always)]
    fn rays<P: Projection>(
        &self,
        film: &P,
        [x, y]: [&Block; 2],
        moments: &Block,
        to: &mut RayBlock,
    ) {
        let Accelerated { time, exposure, .. } = *self.camera;
        let anchor = self.anchor.clone();
        film.directions_and_lengths([x, y], to.d.axes_mut(), &mut [0.0; BLOCK]);
        // Without aberration, the camera's look directions are used as the world's.
        let seen = to.d;
        let mut ratios = [0.0; BLOCK];
        for k in 0..BLOCK {
            let time = time + moments[k] * exposure.duration;
            // To the anchor's frame, and from there to the world: the ratios of both steps multiply.
            let (d, ratio) = anchor.turned(time, Direction::from_unit(to.d.get(k)));
            to.d.set(k, d.unit());
            ratios[k] = ratio;
        }
        to.look(anchor.world_from_comoving(), true);
        if !self.camera.aberration {
            to.d = seen;
        }
        for k in 0..BLOCK {
            let time = time + moments[k] * exposure.duration;
            to.set_place(k, anchor.event(time));
            to.ratio[k] *= ratios[k];
            to.weight[k] = exposure.weight_at(film, x[k], y[k]);
        }
    }
}

/// Elements of a rigid sensor, if the acceleration is constant.
struct Body<'a> {
    camera: &'a Accelerated,
    placed: &'a Placed,
    vicinity: &'a Vicinity,
    sensor: Sensor,
}

impl SimpleRays for Body<'_> {
    #[inline(always)]
    fn rays<P: Projection>(&self, film: &P, [x, y]: [&Block; 2], _: &Block, to: &mut RayBlock) {
        let (vicinity, sensor) = (*self.vicinity, self.sensor);
        for k in 0..BLOCK {
            let element = self.placed.on_body(film, &sensor, [x[k], y[k]]);
            let (seen, own, is_seen) = passage_on_body(&vicinity, element);
            to.d.set(k, seen.unit());
            to.set_place(k, own);
            // Elements whose light crossed elsewhere are left to `ray_through`.
            to.set_simple(k, is_seen);
        }
        to.look(&self.placed.world_from_camera, self.camera.aberration);
        let moved = self.placed.moved;
        for k in 0..BLOCK {
            to.set_place(k, moved + vicinity.in_world(to.place(k)));
        }
        to.weight = [self.camera.exposure.weight; BLOCK];
    }
}

/// The elements of a Bell sensor, if the acceleration is constant.
struct Ships<'a> {
    camera: &'a Accelerated,
    placed: &'a Placed,
    vicinity: &'a Vicinity,
    sensor: Sensor,
}

impl SimpleRays for Ships<'_> {
    #[inline(always)]
    fn rays<P: Projection>(&self, film: &P, [x, y]: [&Block; 2], _: &Block, to: &mut RayBlock) {
        let (vicinity, sensor) = (*self.vicinity, self.sensor);
        let boost = *self.placed.state.frame().frame_from_world();
        for k in 0..BLOCK {
            let element = element(film, &sensor, [x[k], y[k]]);
            // Where the light of the element crossed the pinhole's world line, in the comoving frame.
            let (own, crosses) = passage_of_ship(&boost, &vicinity, element);
            to.set_place(k, own);
            to.set_simple(k, crosses);
        }
        for k in 0..BLOCK {
            // The element is fixed relative to the pinhole in the world, so the direction is computed there.
            let from = vicinity.in_world(to.place(k));
            let (d, is_usual) = along_usual::<World>(from.x - element(film, &sensor, [x[k], y[k]]));
            to.d.set(k, d.unit());
            to.set_place(k, from);
            to.set_simple(k, is_usual & (to.is_simple[k] != 0.0));
        }
        let (moved, aberration) = (self.placed.moved, self.camera.aberration);
        for k in 0..BLOCK {
            // ω_camera/ω_world, the inverse of W.
            let (seen, ratio) = boost.direction(Direction::from_unit(to.d.get(k)));
            to.ratio[k] = 1.0 / ratio;
            if !aberration {
                to.d.set(k, seen.unit());
            }
        }
        for k in 0..BLOCK {
            to.set_place(k, moved + to.place(k));
        }
        to.weight = [self.camera.exposure.weight; BLOCK];
    }
}
