//! The kinematics of a scene: its world lines and events, without its meshes and cubes.

use glam::DVec3;

use super::context::Context;
use super::{camera, gltf_light, light, object, settings, source, velocity};
use crate::error::Result;
use crate::scene::at::At;
use crate::scene::file;
use crate::scene::model::{CameraModel, Effects, Equations};
use crate::scene::names;
use crate::spacetime::worldline::WorldLine;
use crate::spacetime::{Event, Velocity, World};

/// World lines and events of a scene.
pub(crate) struct Kinematics {
    /// The camera.
    pub camera: Option<CameraMotion>,
    /// The objects.
    pub objects: Vec<ObjectMotion>,
    /// Point and spot lights, by name; empty without [`Kinematics::with_lamps`].
    pub lamps: Vec<(String, WorldLine)>,
    /// Emissions of pulses, by name.
    pub pulses: Vec<(String, Event<World>)>,
    /// Refractive index of the medium.
    pub medium_index: f64,
    /// Which effects are on.
    pub effects: Effects,
    /// The equations that it follows.
    pub equations: Equations,
}

/// The camera, and the world line of its pinhole.
pub(crate) struct CameraMotion {
    pub model: CameraModel,
    pub line: WorldLine,
}

/// An object's name and world line.
pub(crate) struct ObjectMotion {
    pub name: String,
    pub velocity: Velocity,
    pub origin: Event<World>,
}

impl Kinematics {
    /// The kinematics of the scene in `file`.
    pub(in crate::scene) fn new<D>(cx: &Context, file: &file::Scene<D>) -> Result<Kinematics> {
        Ok(Kinematics {
            camera: camera_motion(cx, &file.camera)?,
            objects: object_motions(cx, &file.object)?,
            lamps: Vec::new(),
            pulses: pulses(cx, &file.source)?,
            medium_index: settings::medium_index(cx, &file.medium)?,
            effects: settings::effects(&file.effects),
            equations: file.model.value,
        })
    }

    /// With the world lines of lamps, which only diagrams need; `lights` get what they take from glTF files.
    pub(in crate::scene) fn with_lamps(
        self,
        cx: &Context,
        lights: &mut [At<file::Light>],
    ) -> Result<Self> {
        gltf_light::fill(cx, lights)?;
        let lamps = lights.iter().zip(light::names(lights));
        let lamps = lamps.filter(|(at, _)| light::has_place(at.value.kind.value));
        let line = |(at, name)| Ok((name, light::moving(cx, at)?.line));
        Ok(Kinematics {
            lamps: lamps.map(line).collect::<Result<_>>()?,
            ..self
        })
    }

    /// The direction of motion of the camera, or else of an object.
    pub fn direction(&self) -> Option<DVec3> {
        let camera = self.camera.as_ref().and_then(CameraMotion::direction);
        let mut objects = self.objects.iter().map(|object| object.velocity);
        camera.or_else(|| Some(objects.find(|v| !v.is_rest())?.rapidity()))
    }

    /// All directions of motion: the camera's, then those of objects.
    pub fn directions(&self) -> impl Iterator<Item = DVec3> + '_ {
        let camera = self.camera.iter().filter_map(CameraMotion::direction);
        camera.chain(self.objects.iter().map(|object| object.velocity.rapidity()))
    }

    /// The names of its world lines.
    pub fn names(&self) -> Vec<&str> {
        let camera = self.camera.iter().flat_map(|camera| {
            let sensor = camera.model.sensor.map(|_| "sensor");
            ["camera", "pinhole"].into_iter().chain(sensor)
        });
        let objects = self.objects.iter().map(|object| object.name.as_str());
        let lamps = self.lamps.iter().map(|(name, _)| name.as_str());
        let pulses = self.pulses.iter().map(|(name, _)| name.as_str());
        camera.chain(objects).chain(lamps).chain(pulses).collect()
    }
}

impl CameraMotion {
    /// The direction of its velocity, or of its acceleration.
    fn direction(&self) -> Option<DVec3> {
        let state = self.line.state(self.model.time)?;
        let vectors = [state.velocity.rapidity(), state.acceleration];
        vectors.into_iter().find(|v| *v != DVec3::ZERO)
    }
}

fn camera_motion(cx: &Context, camera: &Option<At<file::Camera>>) -> Result<Option<CameraMotion>> {
    let Some(at) = camera else {
        return Ok(None);
    };
    let model = camera::resolve(cx, at)?;
    let line = model.world_line();
    let line = line.map_err(|error| cx.refuse(at, error.to_string(), ""))?;
    Ok(Some(CameraMotion { model, line }))
}

fn object_motions(cx: &Context, objects: &[At<file::Object>]) -> Result<Vec<ObjectMotion>> {
    let entries = objects.iter();
    let names = names::unique(entries.map(|at| object::entry_names(&at.value)).collect());
    let body = |(at, name): (&At<file::Object>, String)| {
        let origin = &at.value.origin;
        Ok(ObjectMotion {
            name,
            velocity: velocity::resolve(cx, &at.value.velocity)?,
            origin: Event::new(cx.time(&origin.time)?, origin.position.value.vec()),
        })
    };
    objects.iter().zip(names).map(body).collect()
}

fn pulses(cx: &Context, sources: &[At<file::Source>]) -> Result<Vec<(String, Event<World>)>> {
    let named = sources.iter().zip(source::names(sources));
    let pulses = named.filter_map(|(at, name)| Some((name, &at.value.pulse.as_ref()?.value)));
    pulses
        .map(|(name, pulse)| {
            let event = Event::new(cx.time(&pulse.time)?, pulse.position.value.vec());
            Ok((name, event))
        })
        .collect()
}
