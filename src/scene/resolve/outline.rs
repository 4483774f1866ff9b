//! What a scene has of world lines and events, without its meshes and cubes.

use glam::DVec3;

use super::context::Context;
use super::{camera, object, velocity};
use crate::error::Result;
use crate::scene::at::At;
use crate::scene::file;
use crate::scene::model::CameraModel;
use crate::scene::names;
use crate::spacetime::worldline::WorldLine;
use crate::spacetime::{Event, Velocity, World};

/// World lines and events of a scene.
pub(crate) struct Outline {
    /// The camera.
    pub camera: Option<Filming>,
    /// The objects.
    pub objects: Vec<Body>,
    /// Emissions of pulses, by name.
    pub pulses: Vec<(String, Event<World>)>,
}

/// The camera, and the world line of its pinhole.
pub(crate) struct Filming {
    pub model: CameraModel,
    pub line: WorldLine,
}

/// An object's name and world line.
pub(crate) struct Body {
    pub name: String,
    pub velocity: Velocity,
    pub origin: Event<World>,
}

impl Outline {
    /// That of the scene which `file` means.
    pub(in crate::scene) fn new<D>(cx: &Context, file: &file::Scene<D>) -> Result<Outline> {
        Ok(Outline {
            camera: filming(cx, &file.camera)?,
            objects: bodies(cx, &file.object)?,
            pulses: pulses(cx, &file.source)?,
        })
    }

    /// The direction in which something of it moves: the camera, or else an object.
    pub fn direction(&self) -> Option<DVec3> {
        let camera = self.camera.as_ref().and_then(Filming::direction);
        let mut bodies = self.objects.iter().map(|body| body.velocity);
        camera.or_else(|| Some(bodies.find(|v| !v.is_rest())?.rapidity()))
    }

    /// All directions in which something of it moves: the camera, then objects.
    pub fn directions(&self) -> impl Iterator<Item = DVec3> + '_ {
        let camera = self.camera.iter().filter_map(Filming::direction);
        camera.chain(self.objects.iter().map(|body| body.velocity.rapidity()))
    }

    /// The names of its world lines.
    pub fn names(&self) -> Vec<&str> {
        let camera = self.camera.iter().flat_map(|filming| {
            let sensor = filming.model.sensor.map(|_| "sensor");
            ["camera", "pinhole"].into_iter().chain(sensor)
        });
        let bodies = self.objects.iter().map(|body| body.name.as_str());
        camera.chain(bodies).collect()
    }
}

impl Filming {
    /// The direction of its velocity, or of its acceleration.
    fn direction(&self) -> Option<DVec3> {
        let state = self.line.state(self.model.time)?;
        let vectors = [state.velocity.rapidity(), state.acceleration];
        vectors.into_iter().find(|v| *v != DVec3::ZERO)
    }
}

fn filming(cx: &Context, camera: &Option<At<file::Camera>>) -> Result<Option<Filming>> {
    let Some(at) = camera else {
        return Ok(None);
    };
    let model = camera::resolve(cx, at)?;
    let line = model.world_line();
    let line = line.map_err(|error| cx.refuse(at, error.to_string(), ""))?;
    Ok(Some(Filming { model, line }))
}

fn bodies(cx: &Context, objects: &[At<file::Object>]) -> Result<Vec<Body>> {
    let entries = objects.iter();
    let names = names::unique(entries.map(|at| object::entry_names(&at.value)).collect());
    let body = |(at, name): (&At<file::Object>, String)| {
        let origin = &at.value.origin;
        Ok(Body {
            name,
            velocity: velocity::resolve(cx, &at.value.velocity)?,
            origin: Event::new(cx.time(&origin.time)?, origin.position.value.vec()),
        })
    };
    objects.iter().zip(names).map(body).collect()
}

fn pulses(cx: &Context, sources: &[At<file::Source>]) -> Result<Vec<(String, Event<World>)>> {
    let pulses = sources.iter().filter_map(|at| {
        let pulse = at.value.pulse.as_ref()?;
        let name = at.value.name.as_ref().map(|name| name.value.clone());
        Some((name.unwrap_or_else(|| "pulse".into()), &pulse.value))
    });
    pulses
        .map(|(name, pulse)| {
            let event = Event::new(cx.time(&pulse.time)?, pulse.position.value.vec());
            Ok((name, event))
        })
        .collect()
}
