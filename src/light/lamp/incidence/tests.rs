use glam::DVec3;

use super::super::{Cone, Emission, EventColumns, Path, PointsOnRays, Start};
use super::*;
use crate::scene::model::EmissionProfile;
use crate::spacetime::{Event, InertialFrame, NullRay, Quantity, Velocity};

fn velocity(x: f64, y: f64, z: f64) -> Velocity {
    Velocity::from_beta(DVec3::new(x, y, z)).unwrap()
}

fn boosts() -> [Option<Boost<Rest, World>>; 2] {
    [None, Some(Boost::new(velocity(0.5, -0.2, 0.3)))]
}

/// Lamps with all beam shapes at rest, slow and fast.
fn lamps(emission: &Emission) -> Vec<Lamp> {
    let origin = Event::new(-3.0, DVec3::new(0.4, 2.0, -1.0));
    let path = |v| match v {
        None => Path::Rest(origin),
        Some(v) => Path::Inertial(InertialFrame::new(v, origin)),
    };
    let paths = [
        path(None),
        path(Some(velocity(0.3, 0.0, 0.1))),
        path(Some(velocity(-0.6, 0.7, 0.0))),
    ];
    let axis = DVec3::new(0.0, -0.6, -0.8);
    let beams = [
        Cone::Everywhere,
        Cone::Parallel(axis),
        Cone::Spot {
            axis,
            outer: 0.1,
            inner: 0.9,
        },
    ];
    let all = paths.iter().flat_map(|path| beams.map(|beam| (path, beam)));
    let lamp = |(path, beam): (&Path, Cone)| Lamp {
        path: path.clone(),
        beam,
        emission: emission.clone(),
        intensity: [1.0, 0.5, 0.25],
        received: Received::Scaled(Quantity::Integrated),
        spectrum: None,
        shadows: false,
        pulse: None,
    };
    all.map(lamp).collect()
}

const COUNT: usize = 150;
const SHOT: Event<World> = Event::new(0.2, DVec3::new(0.1, 0.2, 5.0));

/// Points on rays from one event, more than a block of them; some normals face away from the light.
#[derive(Default)]
struct Points {
    directions: Columns,
    s: Vec<f64>,
    /// The same as if each ray had its own start event.
    events: EventColumns,
    offsets: EventColumns,
    normals: Columns,
    rays: Vec<NullRay<World>>,
}

impl Points {
    fn on_rays(&self) -> PointsOnRays<'_> {
        let start = Start::Shot {
            index: 1.0,
            directions: &self.directions,
            s: &self.s,
        };
        PointsOnRays { shot: SHOT, start }
    }

    fn on_own_rays(&self) -> PointsOnRays<'_> {
        let start = Start::Own {
            events: &self.events,
            offsets: &self.offsets,
        };
        PointsOnRays { shot: SHOT, start }
    }
}

fn points() -> Points {
    let part = |k: usize, n: usize| (k * n % 103) as f64 / 51.0 - 1.0;
    let mut points = Points::default();
    points.events.resize(COUNT);
    points.offsets.resize(COUNT);
    for k in 0..COUNT {
        let d = Direction::new(DVec3::new(part(k, 7), part(k, 11), -1.5)).unwrap();
        let ray = NullRay::new(SHOT, d, 1.0);
        let s = 4.0 + 2.0 * part(k, 13);
        points.directions.push(d.unit());
        points.s.push(s);
        let offset = ray.tangent * s;
        points.events.ct[k] = SHOT.ct;
        points.events.x.set(k, SHOT.x);
        points.offsets.ct[k] = offset.ct;
        points.offsets.x.set(k, offset.x);
        let normal = DVec3::new(part(k, 17), part(k, 19), part(k, 23));
        points.normals.push(normal.normalize());
        points.rays.push(ray);
    }
    points
}

#[test]
fn arrivals_that_nothing_else_needs_fall_with_the_same_bits() {
    let points = points();
    let (on_rays, normals) = (points.on_rays(), &points.normals);
    let mut in_one_loop = 0;
    for lamp in lamps(&Emission::Steady) {
        for (boost, all) in boosts().iter().flat_map(|b| [(b, false), (b, true)]) {
            let (mut arrivals, mut expected) = (Arrivals::default(), Incidence::default());
            lamp.arrivals(&on_rays, 1.0, &mut arrivals);
            lamp.incidence(&arrivals, boost.as_ref(), normals, &mut expected);
            let mut found = Incidence::default();
            let kept = Kept {
                directions: all,
                ratios: all,
            };
            let to = &mut found;
            let is_found = lamp.incidence_at((&on_rays, 1.0), boost.as_ref(), normals, kept, to);
            assert_eq!(is_found, !matches!(lamp.beam, Cone::Spot { .. }));
            if !is_found {
                continue;
            }
            in_one_loop += 1;
            assert_eq!(found.factors(), expected.factors());
            let lit = found.factors().iter().filter(|f| **f > 0.0).count();
            assert!((10..COUNT - 10).contains(&lit), "{lit}");
            if all {
                assert_eq!(found.ratios(), expected.ratios());
                let none = Arrivals::default();
                for k in 0..COUNT {
                    assert_eq!(found.l(&none).get(k), expected.l(&arrivals).get(k));
                }
            }
        }
    }
    assert_eq!(in_one_loop, 24);
}

#[test]
fn lamps_that_flicker_are_not_taken_in_one_loop() {
    let points = points();
    let table = EmissionProfile::Table(vec![[-100.0, 1.0], [100.0, 2.0]]);
    let flickering = Emission::from(&table);
    for lamp in lamps(&flickering) {
        let to = &mut Incidence::default();
        let (on_rays, normals) = (points.on_rays(), &points.normals);
        let kept = Kept {
            directions: false,
            ratios: false,
        };
        assert!(!lamp.incidence_at((&on_rays, 1.0), None, normals, kept, to));
    }
}

#[test]
fn light_in_loops_has_the_bits_of_light_at_single_points() {
    let points = points();
    let (on_rays, normals) = (points.on_rays(), &points.normals);
    let gaussian = Emission::Gaussian {
        centre: -2.0,
        sigma: 2.0,
        scale: 1.3,
    };
    let mut dark = 0;
    for lamp in lamps(&gaussian) {
        for boost in &boosts() {
            let (mut arrivals, mut incidence) = (Arrivals::default(), Incidence::default());
            lamp.arrivals(&on_rays, 1.0, &mut arrivals);
            lamp.incidence(&arrivals, boost.as_ref(), normals, &mut incidence);
            for (k, (ray, s)) in points.rays.iter().zip(&points.s).enumerate() {
                let (w, factor) = (incidence.ratios()[k], incidence.factors()[k]);
                let together = lamp.incident_at(w, factor);
                let arrival = lamp.arrival(ray, *s, 1.0);
                let alone = arrival.and_then(|arrival| {
                    let (l, rho) = match boost {
                        None => (arrival.d.unit(), 1.0),
                        Some(boost) => {
                            let (l, rho) = boost.direction(arrival.d);
                            (l.unit(), rho)
                        }
                    };
                    assert_eq!(l, incidence.l(&arrivals).get(k));
                    let cosine = normals.get(k).dot(l);
                    (cosine > 0.0).then(|| lamp.incident(&arrival, rho, cosine))
                });
                let Some(alone) = alone else {
                    assert_eq!(factor, 0.0);
                    dark += 1;
                    continue;
                };
                assert_eq!(alone.irradiance, together.irradiance);
                assert_eq!(alone.wavelength_scale, together.wavelength_scale);
            }
        }
    }
    assert!((200..COUNT * 18 - 200).contains(&dark), "{dark}");
}

#[test]
fn rays_of_one_event_and_rays_with_events_of_their_own_find_the_same_light() {
    let points = points();
    for lamp in lamps(&Emission::Steady) {
        let found = [points.on_rays(), points.on_own_rays()].map(|on_rays| {
            let mut arrivals = Arrivals::default();
            lamp.arrivals(&on_rays, 1.0, &mut arrivals);
            (arrivals.ratio, arrivals.distance, arrivals.fade)
        });
        assert_eq!(found[0], found[1]);
        assert_eq!(found[0].0.len(), COUNT);
    }
}

/// Compares with the formulas at the head of the module, with separate divisions, for slow and fast lamps.
#[test]
fn quotients_of_one_division_are_those_of_the_formulas() {
    let (points, mut tested) = (points(), 0);
    for lamp in lamps(&Emission::Steady) {
        let (Cone::Everywhere, Some(v)) = (lamp.beam, lamp.velocity()) else {
            continue;
        };
        let (beta, gamma) = (v.beta(), v.gamma());
        for (ray, s) in points.rays.iter().zip(&points.s) {
            // The lamp at the time of the point, and r by |w − βr| = r.
            let at = ray.origin + ray.tangent * *s;
            let w = DVec3::new(0.4, 2.0, -1.0) + beta * (at.ct + 3.0) - at.x;
            let (along, rest) = (w.dot(beta), 1.0 - beta.length_squared());
            let r = ((along * along + rest * w.length_squared()).sqrt() - along) / rest;
            let d = (w - beta * r) / r;
            let in_lamp = gamma * r * (1.0 + beta.dot(d));
            let found = lamp.arrival(ray, *s, 1.0).unwrap();
            let is_near = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-13;
            assert!((found.d.unit() - d).length() < 1e-13);
            assert!(is_near(found.distance, r));
            assert!(is_near(found.ratio, in_lamp / r));
            assert!(is_near(found.inverse, r / in_lamp));
            assert!(is_near(found.fade, 1.0 / (in_lamp * in_lamp)));
            tested += 1;
        }
    }
    assert_eq!(tested, 3 * COUNT);
}

#[test]
fn points_at_the_lamp_or_beyond_all_numbers_have_no_light_of_it() {
    for lamp in lamps(&Emission::Steady) {
        if matches!(lamp.beam, Cone::Parallel(_)) {
            continue;
        }
        let d = Direction::new(DVec3::X).unwrap();
        for at in [0.0, 1e200, f64::INFINITY, f64::NAN] {
            let origin = Event::new(-3.0, DVec3::new(0.4 + at, 2.0, -1.0));
            let ray = NullRay::new(origin, d, 1.0);
            assert!(lamp.arrival(&ray, 0.0, 1.0).is_none(), "{at}");
        }
    }
}
