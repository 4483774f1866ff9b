//! A sensor that rotates about an axis, in a camera without acceleration whose pinhole rests in its frame.
//!
//! All in the camera frame, with the pinhole at the origin. The element that is at q = −f D before the rotation is, at camera time t, at
//!
//! ```text
//! r = c + R(Ωt)(q − c),     v = Ω × (r − c),     c: where the axis passes (pinhole or sensor's centre).
//! ```
//!
//! *Exact.* Light that reaches it at t passed the pinhole at t − |r| and came along l = −r/|r|. The element's own four-velocity
//! determines the frequency: W = W_camera(l) / (γ_v (1 + v·l)).
//!
//! *Comoving* (Jarabo et al. 2015, Figure 10). Each element is an inertial camera with its own comoving pinhole: in the element's frame
//! the look direction is c′ = R D/|D|, and the light passed that pinhole |q| earlier. With the boost Λ_v from the element's frame,
//!
//! ```text
//! (−ω, ω l) = Λ_v (−1, c′),     P = E + |q| ω (−1, l),     W = ω W_camera(l).
//! ```
//!
//! *Aberrated* (there, Figure 11). The element sees the pinhole, which does not rotate, in its aberrated direction: that is the exact
//! direction again, since aberration there and back cancels. But aberration also lifts the other elements i of the sensor out of their
//! plane. With n the normal towards the pinhole, s = n·l, and V the speed along n of element j relative to element i, what is at
//! elevation 0 (elements) and arcsin s (pinhole) appears at the arcsines of
//!
//! ```text
//! V   and   (s + v_j)/(1 + v_j s),     V = (v_j − v_i)/(1 − v_j v_i)
//! ```
//!
//! and where an element between j and the foot of the pinhole's perpendicular appears higher, the film point sees nothing. v_i is linear
//! along the sensor, so the highest is at one of the two ends: V = 0 next to j, V = v_j at the foot, which rests. The latter is never
//! higher than the pinhole. What remains is v_j ≤ −s: the element recedes from the pinhole so fast that it sees it from behind. Eq. 17
//! has V = (v_i + v_j)/(1 + v_i v_j) instead, which the paper's equations follow: the condition is then v_j ≥ s, on the other side of the
//! axis. As in the paper, the delay of light within the camera is ignored here.

use glam::{DMat3, DVec3};

use super::any_projection::AnyProjection;
use super::inertial::ExposureTime;
use super::projection::{Projection, rotation_matrix};
use super::rays::{RayBlock, SimpleRays};
use super::{CameraRay, FilmPoints, RayOrigin, RaySlices, Shot, View};
use crate::accel::vectors::{BLOCK, Block};
use crate::scene::model::{CameraModel, Elements, Equations, Pivot, Rotation};
use crate::spacetime::{Boost, CameraFrame, Direction, Displacement, World, paper2015};

/// A camera with a turning sensor.
#[derive(Debug)]
pub struct Turning {
    film: AnyProjection,
    world_from_camera: Boost<World, CameraFrame>,
    focal_length: f64,
    axis: DVec3,
    rate: f64,
    /// The point c.
    centre: DVec3,
    elements: Elements,
    equations: Equations,
    /// Camera time of the shot.
    time: f64,
    /// The rotation at that time, if there is no exposure.
    instant: Option<DMat3>,
    exposure: ExposureTime,
    aberration: bool,
}

/// A sensor element at a moment, and what it sees.
struct Element {
    /// Velocity in the camera frame.
    v: DVec3,
    /// The look direction in the camera frame.
    l: DVec3,
    /// ω_camera/ω_element of light from that direction.
    ratio: f64,
    /// From the pinhole's event to the event at which the ray leaves, in the camera frame.
    from: Displacement<CameraFrame>,
}

impl Turning {
    /// The view of `model` with the rotation `rotation`; its shutter opens at `shot`.
    pub fn new(
        model: &CameraModel,
        rotation: Rotation,
        shot: &Shot,
        equations: Equations,
        aberration: bool,
    ) -> Self {
        let (velocity, forward) = (shot.frame.velocity(), model.axes[2]);
        // If the scene gives the focal length in the world, it is longer in the camera's own frame, and so is the film's.
        let (focal_length, stretch) = model.sensor.map_or((0.0, 1.0), |sensor| {
            let own = sensor.own_focal_length(forward, velocity);
            (own, own / sensor.focal_length)
        });
        let exposure = ExposureTime::of(model);
        let turn = rotation_matrix(rotation.axis, rotation.rate * model.time);
        Turning {
            film: AnyProjection::new(model).stretched(stretch),
            world_from_camera: *shot.frame.world_from_frame(),
            focal_length,
            axis: rotation.axis,
            rate: rotation.rate,
            centre: match rotation.through {
                Pivot::Pinhole => DVec3::ZERO,
                Pivot::Sensor => model.axes[2] * -focal_length,
            },
            elements: rotation.elements,
            equations,
            time: model.time,
            instant: (exposure.duration == 0.0).then_some(turn),
            exposure,
            aberration,
        }
    }

    /// The projection of the film in the camera's own frame at the shot.
    pub(super) fn film_at_shot(&self) -> AnyProjection {
        self.film
            .turned(rotation_matrix(self.axis, self.rate * self.time))
    }

    /// The position of the element of film vector `film` on the rotated sensor, and its velocity.
    #[inline(always)]
    fn place(&self, film: DVec3, turn: &DMat3) -> (DVec3, DVec3) {
        // r = c + R (q − c) and v = Ω × (r − c).
        let arm = *turn * (film * -self.focal_length - self.centre);
        (self.centre + arm, (self.axis * self.rate).cross(arm))
    }

    /// The element of film vector `film`, at camera time `t` after the shot.
    #[inline]
    fn element(&self, film: DVec3, turn: &DMat3, t: f64) -> Element {
        let (r, v) = self.place(film, turn);
        match self.elements {
            Elements::Comoving => comoving(r, v, (*turn * film).normalize(), film, self, t),
            Elements::Exact | Elements::Aberrated => {
                // A point camera has |r| = 0, and no direction can be computed from r.
                let towards = if self.focal_length > 0.0 {
                    -r
                } else {
                    *turn * film
                };
                exact(r, v, towards, t)
            }
        }
    }

    /// Whether the sensor hides the pinhole from `element`.
    fn covered(&self, element: &Element, turn: &DMat3) -> bool {
        let n = *turn * self.film.forward();
        let foot = self.centre + *turn * (self.film.forward() * -self.focal_length - self.centre);
        // V of an adjacent element, and of the one at the foot of the perpendicular: one of these is the highest.
        let speed = |r: DVec3| (self.axis * self.rate).cross(r - self.centre).dot(n);
        let own = element.v.dot(n);
        let highest = self.relative(own, own).max(self.relative(speed(foot), own));
        let s = n.dot(element.l);
        highest >= (s + own) / (1.0 + own * s)
    }

    /// The speed along the normal of an element that moves with `own` relative to one that moves with `other`.
    fn relative(&self, other: f64, own: f64) -> f64 {
        match self.equations {
            Equations::Exact => (own - other) / (1.0 - own * other),
            Equations::Paper2015 => paper2015::composed_speed(other, own),
        }
    }

    /// Where the ray of `element` leaves relative to the shot, and its weight.
    #[inline]
    fn origin(&self, element: &Element, turn: &DMat3, t: f64) -> RayOrigin {
        let covered = self.elements == Elements::Aberrated && self.covered(element, turn);
        let weight = if covered { 0.0 } else { self.exposure.weight };
        let displacement = self.world_from_camera.displacement(element.from);
        match self.equations {
            Equations::Exact => RayOrigin {
                displacement,
                delay: 1.0,
                weight,
            },
            // Eq. 11 with the element's own γ, from the camera's position: t′/γ in place of t.
            Equations::Paper2015 => {
                let camera_time = self.time + t;
                RayOrigin {
                    displacement: Displacement::new(
                        camera_time / gamma(element.v) - self.time,
                        DVec3::ZERO,
                    ),
                    delay: (1.0 - element.v.dot(element.l).powi(2)).sqrt(),
                    weight,
                }
            }
        }
    }
}

/// An element at r whose look direction is `towards`, of any length, at camera time `t` after the shot.
#[inline(always)]
fn exact(r: DVec3, v: DVec3, towards: DVec3, t: f64) -> Element {
    // Light from l has γ_v (1 + v·l) times the camera's frequency for the element.
    let l = towards.normalize();
    Element {
        v,
        l,
        ratio: 1.0 / (gamma(v) * (1.0 + v.dot(l))),
        from: Displacement::new(t - r.length(), DVec3::ZERO),
    }
}

/// An element with its own comoving pinhole.
#[inline]
fn comoving(r: DVec3, v: DVec3, seen: DVec3, film: DVec3, camera: &Turning, t: f64) -> Element {
    let gamma = gamma(v);
    // ω and l of Λ_v (−1, c′).
    let along = v.dot(seen);
    let ratio = gamma * (1.0 - along);
    let l = (seen + v * (gamma * gamma / (gamma + 1.0) * along - gamma)) / ratio;
    let delay = camera.focal_length * film.length() * ratio;
    Element {
        v,
        l,
        ratio,
        from: Displacement::new(t - delay, r + l * delay),
    }
}

#[inline(always)]
fn gamma(v: DVec3) -> f64 {
    let speed = v.length();
    // As a product, 1 − v² keeps its digits near the speed of light.
    1.0 / ((1.0 - speed) * (1.0 + speed)).sqrt()
}

impl Turning {
    /// [`View::ray_through`] for a known rotation.
    fn ray_of<P: Projection>(&self, film: &P, [x, y]: [f64; 2], turn: &DMat3, t: f64) -> CameraRay {
        let element = self.element(film.vector(x, y), turn, t);
        let mut origin = self.origin(&element, turn, t);
        if !film.sees(x, y) {
            origin.weight = 0.0;
        }
        self.camera_ray(&element, origin)
    }

    /// The ray of `element` in the world, leaving at `origin`.
    #[inline(always)]
    fn camera_ray(&self, element: &Element, origin: RayOrigin) -> CameraRay {
        let l = Direction::from_unit(element.l);
        let (d, ratio) = self.world_from_camera.direction(l);
        CameraRay {
            d: if self.aberration {
                d
            } else {
                Direction::from_unit(element.l)
            },
            ratio: ratio * element.ratio,
            origin,
        }
    }
}

/// Exact elements of a sensor with a focal length, at one moment.
struct Exact<'a> {
    camera: &'a Turning,
    turn: &'a DMat3,
}

impl SimpleRays for Exact<'_> {
    #[inline(always)]
    fn rays<P: Projection>(&self, film: &P, [x, y]: [&Block; 2], _: &Block, to: &mut RayBlock) {
        let Exact { camera, turn } = self;
        let mut ratios = [0.0; BLOCK];
        for k in 0..BLOCK {
            let (r, v) = camera.place(film.vector(x[k], y[k]), turn);
            let element = exact(r, v, -r, 0.0);
            to.d.set(k, element.l);
            to.set_place(k, element.from);
            ratios[k] = element.ratio;
        }
        to.look(&camera.world_from_camera, camera.aberration);
        let boost = camera.world_from_camera;
        for k in 0..BLOCK {
            to.set_place(k, boost.displacement(to.place(k)));
            to.ratio[k] *= ratios[k];
            // A film point that sees nothing is left to `ray_through`, which gives it no weight.
            to.set_simple(k, film.sees(x[k], y[k]));
        }
        to.weight = [camera.exposure.weight; BLOCK];
    }
}

impl View for Turning {
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
        let t = moment * self.exposure.duration;
        match &self.instant {
            Some(turn) => self.ray_of(film, [x, y], turn, t),
            None => {
                let turn = rotation_matrix(self.axis, self.rate * (self.time + t));
                self.ray_of(film, [x, y], &turn, t)
            }
        }
    }

    #[inline(always)]
    fn rays<P: Projection>(&self, film: &P, points: &FilmPoints, mut rays: RaySlices) {
        // Only exact elements at one moment share their rotation matrix, and have a loop over blocks.
        let kind = (&self.elements, &self.equations, &self.instant);
        match kind {
            (Elements::Exact, Equations::Exact, Some(turn)) if self.focal_length > 0.0 => {
                let exact = Exact { camera: self, turn };
                rays.fill_by(&exact, self, film, points);
            }
            _ => rays.fill(self, film, points),
        }
    }
}
