use super::*;
use crate::accel::{Bvh, Facing, Ray, numbers};
use crate::spacetime::{Direction, InertialFrame, Velocity};

fn vector(next: &mut impl FnMut() -> f64) -> DVec3 {
    DVec3::new(next(), next(), next())
}

/// A triangle that moves with a rapidity of up to `rapidity` per axis.
fn body(next: &mut impl FnMut() -> f64, rapidity: f64) -> RestFrame {
    let centre = vector(next) * 3.0;
    let corners = [(); 3].map(|()| centre + vector(next));
    let velocity = Velocity::from_rapidity(vector(next) * rapidity).unwrap();
    RestFrame {
        frame: InertialFrame::new(velocity, Event::new(next(), vector(next))),
        bvh: Bvh::build(vec![corners], |_| Facing::TwoSided),
        normals: Default::default(),
        patches: Vec::new(),
        meshes: Default::default(),
        vertices: Default::default(),
    }
}

/// The number of bodies that were hit, and the number of the others that were known to be missed.
fn count(rapidity: f64) -> [usize; 2] {
    let next = &mut numbers(7);
    let mut counts = [0; 2];
    for _ in 0..20_000 {
        let rest = body(next, rapidity);
        let camera = rest
            .frame
            .event_from_world(Event::new(next(), vector(next)));
        let towards = vector(next).normalize();
        let directions: Vec<_> = (0..16)
            .map(|_| (towards + vector(next) * 0.02).normalize())
            .collect();
        let is_hit = |ray: &usize| {
            let d = Direction::from_unit(directions[*ray]);
            let ray = Ray {
                origin: camera.x,
                direction: rest.frame.frame_from_world().tangent(1.0, d).x,
                s_min: 0.0,
            };
            rest.bvh.closest(&ray, f64::INFINITY).is_some()
        };
        let hit: Vec<usize> = (0..directions.len()).filter(is_hit).collect();
        let met = !hit.is_empty();
        let cone = VisibleCone::of(&rest, camera, 1.0);
        let missed = cone.is_some_and(|cone| cone.misses(&DirectionBounds::of(&directions)));
        if let Some(cone) = cone {
            let mut chosen = Vec::new();
            cone.choose(&directions, &mut chosen);
            let is_chosen = |ray: &usize| chosen.contains(&(*ray as u32));
            assert!(hit.iter().all(is_chosen), "{rest:?} is met by {hit:?}");
        }
        assert!(!(met && missed), "{rest:?} is met along {towards}");
        counts[usize::from(!met)] += usize::from(met || missed);
    }
    counts
}

#[test]
fn what_is_met_is_never_taken_for_missed() {
    for rapidity in [0.0, 1.0, 5.0, 20.0] {
        let [met, missed] = count(rapidity);
        assert!(met > 20, "{met} at {rapidity}");
        assert!(rapidity > 1.0 || missed > 10_000, "{missed} at {rapidity}");
    }
}

#[test]
fn a_medium_lets_everything_pass() {
    let rest = body(&mut numbers(1), 0.3);
    let camera = Event::new(0.0, DVec3::splat(100.0));
    assert!(VisibleCone::of(&rest, camera, 1.0).is_some());
    assert!(VisibleCone::of(&rest, camera, 1.3).is_none());
}
