//! Cameras on any world line that have a sensor, a shutter, or both.
//!
//! At proper time t the pinhole is at X(t), with the comoving frame Λ(t). The sensor element of film
//! vector D is exposed at the event E = X(t) + q, with the pinhole's four-velocity u(t):
//!
//! ```text
//! rigid:         q = Λ (0, −f D)          world length:  the same with f′ (`inertial`)
//! Bell's ships:  q = (0, −f D)            in the world: shifted copies of one world line
//! ```
//!
//! A rigid camera is Born-rigid: the elements that are simultaneous with the pinhole in its comoving
//! frame keep their distances and share its velocity. Such a body does not turn (Fermi–Walker); on a
//! path that is not straight the axes of a camera, the world's boosted without rotation, do turn against
//! it (Thomas). Each moment's picture is that of the rigid body whose axes lie like that then. The light passed the pinhole at the event P of
//! X(·) on the past light cone of E; its look direction is that of P − E. For a pinhole without
//! acceleration that is P = −f|D| u again.

use glam::DVec3;

use super::any_projection::AnyProjection;
use super::inertial::ExposureTime;
use super::projection::Projection;
use super::{CameraRay, RayOrigin, Shot, View};
use crate::scene::model::{Assembly, CameraModel, Sensor};
use crate::spacetime::worldline::{State, Vicinity, WorldLine};
use crate::spacetime::{Boost, Camera, Direction, Displacement, Event, Frame, World};

/// A camera on a world line, with a sensor, a shutter, or both.
#[derive(Debug)]
pub struct Accelerated {
    line: WorldLine,
    film: AnyProjection,
    sensor: Option<Sensor>,
    /// Camera time and event of the shot.
    time: f64,
    event: Event<World>,
    /// The camera at that time, where there is no exposure.
    instant: Option<Placed>,
    exposure: ExposureTime,
    aberration: bool,
}

/// The camera at a proper time.
#[derive(Debug)]
struct Placed {
    state: State,
    world_from_camera: Boost<World, Camera>,
    /// What is around the state, where the acceleration is constant there.
    vicinity: Option<Vicinity>,
    /// By how much the focal length is longer in its own frame than the scene says, metres.
    stretch: f64,
    /// From the event of the shot to the pinhole's event.
    moved: Displacement<World>,
}

/// The ray of a sensor element.
struct ElementRay {
    d: Direction<World>,
    seen: Direction<Camera>,
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
            exposure,
            aberration,
        };
        if exposure.duration == 0.0 {
            camera.instant = camera.placed(0.0);
        }
        camera
    }

    /// Whether light that every element gets passed the pinhole on its world line, during the whole
    /// exposure.
    pub(super) fn sees_everywhere(&self) -> bool {
        let times = [0.0, self.exposure.duration];
        times.iter().all(|t| {
            let placed = self.placed(*t);
            let mut corners = self.film.corners().into_iter();
            placed.is_some_and(|p| corners.all(|at| self.element_ray(&p, &self.film, at).is_some()))
        })
    }

    /// The camera `t` after the shot, where its world line goes that far.
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

    /// What a camera without a sensor sees: its velocity and place at the moment are all that counts.
    #[inline]
    fn ray_from_point<P: Projection>(
        &self,
        film: &P,
        [x, y]: [f64; 2],
        moment: f64,
    ) -> Option<CameraRay> {
        let time = self.time + moment * self.exposure.duration;
        let (event, velocity) = self.line.place(time)?;
        let seen = film.direction(x, y);
        let (d, ratio) = Boost::<World, Camera>::new(velocity).direction(seen);
        Some(CameraRay {
            d: match self.aberration {
                true => d,
                false => Direction::from_unit(seen.unit()),
            },
            ratio,
            origin: RayOrigin {
                displacement: event - self.event,
                delay: 1.0,
                weight: self.exposure.weight_at(film, x, y),
            },
        })
    }

    /// What the element at film point `(x, y)` sees.
    #[inline]
    fn element_ray<P: Projection>(
        &self,
        camera: &Placed,
        film: &P,
        [x, y]: [f64; 2],
    ) -> Option<ElementRay> {
        let Some(sensor) = self.sensor else {
            let seen = film.direction(x, y);
            return Some(camera.element_ray(seen, Displacement::new(0.0, DVec3::ZERO)));
        };
        let element = film.vector(x, y) * -sensor.focal_length;
        match sensor.assembly {
            Assembly::Bell => self.ships(camera, element),
            // The focal length is stretched, the sensor is not.
            Assembly::Rigid | Assembly::WorldLength => {
                self.rigid(camera, element - film.forward() * camera.stretch)
            }
        }
    }

    /// The element at `element` from the pinhole on a rigid body, in its frame.
    #[inline]
    fn rigid(&self, camera: &Placed, element: DVec3) -> Option<ElementRay> {
        let apex = Displacement::new(0.0, element);
        let crossing = |v: &Vicinity| {
            let own = v.crossing(apex, element.length_squared())?;
            Some((own, v.in_world(own)))
        };
        let near = camera.vicinity.as_ref().and_then(crossing);
        let (own, from) = near.or_else(|| self.rigid_anywhere(camera, apex))?;
        Some(camera.element_ray(along(own.x - element)?, from))
    }

    /// Where light left the pinhole for a place on its body, in its frame and the world, where the
    /// acceleration is not constant, or changes while the light is under way.
    #[inline(never)]
    fn rigid_anywhere(&self, camera: &Placed, apex: Displacement<Camera>) -> Option<Passage> {
        let at = camera.world_from_camera.displacement(apex);
        let from = self
            .line
            .on_past_light_cone(&camera.state, at)?
            .displacement;
        let camera_from_world = camera.state.frame().frame_from_world();
        Some((camera_from_world.displacement(from), from))
    }

    /// The element at `element` from the pinhole, as the world measures, on a ship of its own.
    #[inline]
    fn ships(&self, camera: &Placed, element: DVec3) -> Option<ElementRay> {
        let camera_from_world = camera.state.frame().frame_from_world();
        let at = Displacement::new(0.0, element);
        let crossing = |v: &Vicinity| {
            let apex = camera_from_world.displacement(at);
            Some(v.in_world(v.crossing(apex, element.length_squared())?))
        };
        let near = camera.vicinity.as_ref().and_then(crossing);
        let anywhere = || {
            Some(
                self.line
                    .on_past_light_cone(&camera.state, at)?
                    .displacement,
            )
        };
        let from = near.or_else(anywhere)?;
        let d = along(from.x - element)?;
        let (seen, ratio) = camera_from_world.direction(d);
        Some(ElementRay {
            d,
            seen,
            ratio: 1.0 / ratio,
            from,
        })
    }
}

/// From the pinhole's event at the time of exposure to that at which the light passed: in the comoving
/// frame and in the world.
type Passage = (Displacement<Camera>, Displacement<World>);

impl Placed {
    /// What is seen along `seen` of the comoving frame by a ray that leaves at `from`.
    #[inline]
    fn element_ray(&self, seen: Direction<Camera>, from: Displacement<World>) -> ElementRay {
        let (d, ratio) = self.world_from_camera.direction(seen);
        ElementRay {
            d,
            seen,
            ratio,
            from,
        }
    }
}

/// The direction of `way`, whose squares are in the usual range unless the camera's sizes are not.
#[inline]
fn along<F: Frame>(way: DVec3) -> Option<Direction<F>> {
    let square = way.length_squared();
    if (1e-200..1e200).contains(&square) {
        return Some(Direction::from_unit(way * (1.0 / square.sqrt())));
    }
    Direction::new(way)
}

/// What an element sees whose light never passed the pinhole.
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
    const USES_TIME: bool = true;

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
        let Some(ray) = self.element_ray(camera, film, [x, y]) else {
            return nothing();
        };
        CameraRay {
            d: if self.aberration {
                ray.d
            } else {
                Direction::from_unit(ray.seen.unit())
            },
            ratio: ray.ratio,
            origin: RayOrigin {
                displacement: camera.moved + ray.from,
                delay: 1.0,
                weight: self.exposure.weight,
            },
        }
    }
}
