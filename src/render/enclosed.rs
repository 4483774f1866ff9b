//! Lamps inside bodies, whose outside they do not light: one reason why a picture is dark. And cameras inside glass, which delays no light on
//! its last way to them.

use std::collections::{BTreeMap, HashMap};
use std::f64::consts::TAU;

use glam::DVec3;

use crate::accel::{Bvh, Facing, Ray};
use crate::mesh::solid_angle;
use crate::render::prepare::Prepared;
use crate::render::trace::{Emitter, HitBuffer, Meter, Patch, Rays, Surfaces};
use crate::scene::model::{Beam, LightKind, Scene, SourceKind};
use crate::spacetime::{Event, InertialFrame, World};

/// A lamp inside a body, whose outside it lights only through openings.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct EnclosedLamp {
    /// The name of the light, or of the pulse.
    pub lamp: String,
    /// Index of an object that encloses it.
    pub object: usize,
}

/// The lamps from which no ray escapes and most rays first hit the inside of a surface, at the event at which the camera sees them: 26
/// rays along their past light cone, towards the faces, edges and corners of a cube. Bodies with culled back faces have no inside to hit,
/// though shadow rays to the lamp hit their outside: they enclose the lamp if, along most of these rays, more of their faces are turned
/// away from it than towards it. A body that also encloses the camera is a room, and left out.
pub fn enclosed_lamps(scene: &Scene, prepared: &Prepared) -> Vec<EnclosedLamp> {
    let shot = prepared.camera.shot.event;
    let lights = scene.lights.iter().filter(|light| light.shadows);
    let lamps = lights.filter_map(|light| match &light.kind {
        LightKind::Lamp(lamp) if !matches!(lamp.beam, Beam::Parallel(_)) => {
            // Where and when the camera sees the lamp; if that is unknown, the position in the scene.
            let seen = lamp.world_line().ok().and_then(|line| {
                let near = line.state(0.0)?;
                let crossing = line.on_past_light_cone(&near, shot - near.event)?;
                Some(near.event + crossing.displacement)
            });
            Some((&light.name, seen.unwrap_or(lamp.origin)))
        }
        _ => None,
    });
    let pulses = scene
        .sources
        .iter()
        .filter_map(|source| match &source.kind {
            SourceKind::Pulse(pulse) if pulse.shadows => Some((&source.name, pulse.origin)),
            _ => None,
        });
    let mut room = None;
    let found = lamps.chain(pulses).filter_map(|(name, at)| {
        let object = enclosing(prepared, at)?;
        // A lamp in the same room as the camera is not enclosed.
        let room = *room.get_or_insert_with(|| enclosing(prepared, shot));
        (room != Some(object)).then(|| EnclosedLamp {
            lamp: name.clone(),
            object: object as usize,
        })
    });
    found.collect()
}

/// Index of an object whose body of glass is around the pinhole at the event of the shot: light reaches the camera from its surface as if it
/// came through the medium outside. The winding number of its faces is above ½ there: 1 inside a closed body, and 0 outside.
pub fn glass_around_camera(prepared: &Prepared) -> Option<usize> {
    let light = prepared.light.time_resolved()?;
    let is_glass = |patch: &Patch| match &light.emitters[patch.emitter as usize].0 {
        Emitter::Lit { finish, .. } => finish.glass.is_some_and(|glass| glass.solid),
        Emitter::Base(_) | Emitter::Uv { .. } | Emitter::Captured(_) => false,
    };
    let shot = &prepared.camera.shot;
    for rest in &prepared.frames {
        if !rest.patches.iter().any(is_glass) {
            continue;
        }
        let at = shot.event_in(&rest.frame).x;
        let mut angles: BTreeMap<u32, f64> = BTreeMap::new();
        for slot in 0..rest.bvh.len() as u32 {
            let patch = rest.patch(rest.bvh.triangle(slot).0);
            if is_glass(patch) {
                let angle = solid_angle(rest.bvh.corners(slot), at);
                *angles.entry(patch.object).or_default() += angle;
            }
        }
        if let Some((object, _)) = angles.into_iter().find(|(_, angle)| *angle > TAU) {
            return Some(object as usize);
        }
    }
    None
}

fn enclosing(prepared: &Prepared, at: Event<World>) -> Option<u32> {
    around(prepared, at).or_else(|| around_without_backs(prepared, at))
}

/// 26 directions, towards the faces, edges and corners of a cube, slightly rotated to avoid the edges of boxes.
fn directions() -> Vec<DVec3> {
    let steps = [-1.0, 0.0, 1.0];
    let all = steps.into_iter().flat_map(|x| {
        steps
            .into_iter()
            .flat_map(move |y| steps.map(|z| DVec3::new(x, y, z)))
    });
    let turn = glam::DMat3::from_rotation_y(0.11) * glam::DMat3::from_rotation_x(0.07);
    all.filter_map(|d| (turn * d).try_normalize()).collect()
}

/// The object with culled backs that encloses `at` along most of these directions. Seen from a point inside, a closed body has one more
/// face turned away than towards it, and equally many from outside.
fn around_without_backs(prepared: &Prepared, at: Event<World>) -> Option<u32> {
    let directions = directions();
    for rest in prepared.frames.iter() {
        let Some((low, high)) = rest.bvh.bounds() else {
            continue;
        };
        let at = rest.frame.event_from_world(at).x;
        // No face is farther away than this.
        let reach = (at - low).abs().max((high - at).abs()).length();
        let is_within = at.cmpge(low).all() && at.cmple(high).all();
        if !is_within || !reach.is_finite() {
            continue;
        }
        let mut found: Vec<u32> = Vec::new();
        for d in &directions {
            let mut turned: HashMap<u32, i32> = HashMap::new();
            let mut count = |origin: DVec3, direction: DVec3, step: i32| {
                each_front(&rest.bvh, origin, direction, reach, |triangle| {
                    *turned.entry(rest.patch(triangle).object).or_default() += step;
                });
            };
            count(at + *d * reach, -*d, 1);
            count(at, *d, -1);
            found.extend(
                turned
                    .into_iter()
                    .filter(|(_, n)| *n > 0)
                    .map(|(object, _)| object),
            );
        }
        found.sort_unstable();
        let most = found
            .chunk_by(|a, b| a == b)
            .max_by_key(|same| same.len())
            .filter(|same| 2 * same.len() > directions.len());
        if let Some(same) = most {
            return same.first().copied();
        }
    }
    None
}

/// The culled triangles whose fronts a ray hits, from the nearest on, up to a distance.
fn each_front(bvh: &Bvh, origin: DVec3, direction: DVec3, reach: f64, mut each: impl FnMut(u32)) {
    /// A limit for bodies too complex to decide.
    const MOST: usize = 256;
    let mut s_min = 0.0;
    for _ in 0..MOST {
        let ray = Ray {
            origin,
            direction,
            s_min,
        };
        let Some(hit) = bvh.closest(&ray, reach) else {
            return;
        };
        if bvh.triangle(hit.slot).1 == Facing::FrontOnly {
            each(hit.triangle);
        }
        s_min = hit.s;
    }
}

/// The object whose inside is hit first by most of the rays from `at`, if all of them hit something and most of them an inside: the floor
/// may close a body that stands on it.
fn around(prepared: &Prepared, at: Event<World>) -> Option<u32> {
    let directions = directions();
    let event_in = |frame: &InertialFrame<_>| frame.event_from_world(at);
    let surfaces = Surfaces::unbuffered(&prepared.frames, event_in, prepared.ray_index);
    let rays = Rays::from_shot(&directions, prepared.method);
    let mut hits = HitBuffer::default();
    surfaces.nearest(&rays, &mut hits, &mut Meter::off());
    let met = (0..directions.len()).map(|ray| hits.hit(ray));
    let met: Vec<_> = met.collect::<Option<_>>()?;
    let inside = met.iter().filter(|met| !met.hit.front);
    let mut objects: Vec<u32> = inside
        .map(|met| surfaces.rest(met.frame).patch(met.hit.triangle).object)
        .collect();
    if 2 * objects.len() <= met.len() {
        return None;
    }
    objects.sort_unstable();
    let most = objects
        .chunk_by(|a, b| a == b)
        .max_by_key(|same| same.len());
    most.and_then(|same| same.first().copied())
}
