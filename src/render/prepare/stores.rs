//! Cubes with their capture cameras, each file loaded once, in the rest frames that they light.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use glam::DVec3;

use crate::accel::Ray;
use crate::error::{Error, Result};
use crate::io::cube::{
    self as cubes, Bricks, Channels, Cube, CubeChannel, CubeStore, Negative, Wanted,
};
use crate::light::time_texture::survey::{self, Order};
use crate::light::time_texture::{Capture, SeenPoint, TimeAxis, TimeTexture};
use crate::render::plan::Plan;
use crate::render::trace::{CapturedCube, EmissionClock, Emitter, RestFrame};
use crate::scene::model::{
    Binding, CaptureCamera, Clock, CubeData, CubeFile, CubeSource, Fill, Mapping, Reconstruction,
    Scene, SourceKind,
};

/// A file, the declarations of its channels and of samples below 0, the companions used from it, and whether the scene holds its first and
/// last bins.
type FileParts = (
    CubeFile,
    Option<Channels>,
    Option<Negative>,
    Vec<CubeChannel>,
    bool,
);

/// Cubes from files, for scenes that are [prepared](super::Prepared::sharing) one after the other: what each has in common with the one
/// before is neither loaded nor checked again.
#[derive(Debug, Default)]
pub struct LoadedCubes {
    files: HashMap<FileParts, Loaded>,
}

/// A cube, and what looks wrong about its samples, or was assumed of them.
#[derive(Debug, Clone)]
struct Loaded {
    colours: CubeStore,
    /// In the order of the channels that were requested.
    companions: Vec<CubeStore>,
    remarks: Vec<String>,
}

impl LoadedCubes {
    /// Drops what `scene` does not use, before more is loaded: a plan foresees the memory that its own scene takes.
    pub(super) fn keep_those_of(&mut self, scene: &Scene) {
        let keys = scene
            .sources
            .iter()
            .filter_map(|source| match &source.kind {
                SourceKind::Cube(cube) => key(scene, cube),
                SourceKind::Pulse(_) => None,
            });
        let keys: HashSet<FileParts> = keys.collect();
        // Of cubes that are read on demand, each scene holds as much as it has room for.
        self.files.retain(|key, loaded| {
            matches!(loaded.colours, CubeStore::Memory(_)) && keys.contains(key)
        });
    }
}

/// What is read of a cube's file; `None` without a file.
fn key(scene: &Scene, cube: &CubeSource) -> Option<FileParts> {
    match &cube.data {
        CubeData::File(file) => Some((
            file.clone(),
            cube.channels.clone(),
            cube.negative,
            scene.companions_of(cube),
            is_held(scene),
        )),
        CubeData::Memory(_) => None,
    }
}

/// Whether the first and the last bin of cubes go on for ever.
fn is_held(scene: &Scene) -> bool {
    [scene.outside.before, scene.outside.after] == [Fill::Hold; 2]
}

/// Cubes and capture cameras, each file loaded once.
pub(super) struct Stores<'a> {
    loaded: &'a mut LoadedCubes,
    /// Whether the parts of cubes that are read on demand are only counted.
    counts_only: bool,
    /// The memory limit, bytes.
    memory: u64,
    pub cubes: Vec<TimeTexture>,
    /// For each cube, its source.
    pub sources: Vec<usize>,
    pub captures: Vec<Capture>,
    /// Suspicious properties of the data.
    pub warnings: Vec<String>,
}

impl<'a> Stores<'a> {
    /// None yet, of the cubes of `plan`.
    pub fn new(plan: &Plan, loaded: &'a mut LoadedCubes) -> Stores<'a> {
        Stores {
            loaded,
            counts_only: plan.counts_only,
            memory: plan.memory_limit,
            cubes: Vec::new(),
            sources: Vec::new(),
            captures: Vec::new(),
            warnings: Vec::new(),
        }
    }

    /// The cube of `source` in `scene`, with `held` bytes in memory if it is read on demand.
    pub fn cube(
        &mut self,
        scene: &Scene,
        source: usize,
        (cube, held): (&CubeSource, Option<u64>),
        frames: &[RestFrame],
    ) -> Result<Emitter> {
        let companions = scene.companions_of(cube);
        let loaded = self.loaded(scene, cube, held)?;
        self.warn(scene, source, loaded.remarks);
        let texture = |store: CubeStore| {
            let texture = TimeTexture::new(store, TimeAxis::from(cube), scene.outside)
                .map_err(|e| refused(scene, source, e))?
                .with_reconstruction(cube.reconstruction);
            let texture = match cube.mapping {
                Mapping::Uv { backs, .. } => texture.with_backs(backs),
                Mapping::Capture(_) => texture,
            };
            // Prefix sums along time, for lookups that are means over time spans.
            Ok(match cube.is_read_over_spans(&scene.camera) {
                true => texture.with_sums(),
                false => texture,
            })
        };
        let others = loaded.companions.into_iter().map(texture);
        let others: Vec<TimeTexture> = others.collect::<Result<_>>()?;
        let texture = texture(loaded.colours)?;
        let size = texture.size();
        // Cameras and clocks of the file are those of the world or of the objects; lookups are in the rest frame.
        let place = Place::of(scene, source, frames);
        let clock = place.clock(cube.clock);
        // The colours, and their companions after them.
        let index = self.cubes.len();
        let companions = CubeChannel::COMPANIONS.map(|channel| {
            let place = companions.iter().position(|own| *own == channel);
            place.map(|place| index + 1 + place)
        });
        let emitter = match &cube.mapping {
            Mapping::Uv { set, .. } => Emitter::Uv {
                cube: index,
                companions,
                set: *set,
                clock,
            },
            Mapping::Capture(camera) => {
                let camera = CaptureCamera {
                    eye: place.eye(camera.eye),
                    ..camera.clone()
                };
                // Subtract the delay to the capture camera from times of arrival.
                let warped = cube.clock == Clock::Capture;
                let trace = |origin, direction| place.seen(origin, direction);
                let capture = Capture::new(&camera, size, warped, scene.medium_index, trace);
                let capture = match cube.reconstruction {
                    Reconstruction::Bilinear | Reconstruction::Footprint => capture,
                    Reconstruction::Sharp => capture.with_neighbours(),
                };
                self.warn(
                    scene,
                    source,
                    survey::of_capture(&texture, &capture, scene.medium_index),
                );
                self.captures.push(capture);
                Emitter::Captured(vec![CapturedCube {
                    cube: index,
                    companions,
                    capture: self.captures.len() - 1,
                    clock,
                }])
            }
        };
        for texture in [texture].into_iter().chain(others) {
            self.cubes.push(texture);
            self.sources.push(source);
        }
        Ok(emitter)
    }

    fn warn(&mut self, scene: &Scene, source: usize, remarks: Vec<String>) {
        let name = &scene.sources[source].name;
        let named = |remark| format!("source \"{name}\": {remark}");
        self.warnings.extend(remarks.into_iter().map(named));
    }

    /// The cube, with its companions; from a file, as it was loaded for another source or scene.
    fn loaded(&mut self, scene: &Scene, cube: &CubeSource, held: Option<u64>) -> Result<Loaded> {
        let key = key(scene, cube);
        if let Some(loaded) = key.as_ref().and_then(|key| self.loaded.files.get(key)) {
            return Ok(loaded.clone());
        }
        let channels = scene.companions_of(cube);
        let (colours, companions) = self.load(cube, &channels, held)?;
        // What looks wrong about the samples, or was assumed of them.
        let (mut assumed, negative) = (Order::Stated, cube.negative);
        let mut remarks = Vec::new();
        if let CubeData::File(file) = &cube.data {
            let wanted = cube.wanted(file);
            let info = cubes::inspect(&file.path, wanted.within(self.memory))?;
            let format = cubes::format_called(&file.path);
            assumed = match (info.assumed, format.is_some_and(|format| format.pictures)) {
                (false, _) => Order::Stated,
                (true, true) => Order::Pictures,
                (true, false) => Order::Array,
            };
            remarks = info.remarks;
        }
        let is_held = is_held(scene);
        remarks.extend(survey::of_samples_with(
            &colours, assumed, negative, is_held,
        ));
        for (channel, companion) in channels.iter().zip(&companions) {
            let own = survey::of_samples_with(companion, Order::Stated, negative, is_held);
            let named = |remark| format!("channel {}: {remark}", channel.name());
            remarks.extend(own.into_iter().map(named));
        }
        let loaded = Loaded {
            colours,
            companions,
            remarks,
        };
        if let Some(key) = key {
            self.loaded.files.insert(key, loaded.clone());
        }
        Ok(loaded)
    }

    /// The cube, whole; or on disk, with room for `held` bytes of it: its colours, and one cube for each of these companions.
    fn load(
        &self,
        cube: &CubeSource,
        companions: &[CubeChannel],
        held: Option<u64>,
    ) -> Result<(CubeStore, Vec<CubeStore>)> {
        let file = match &cube.data {
            CubeData::File(file) => file,
            CubeData::Memory(whole) => {
                return Ok(match &cube.channels {
                    Some(channels) => split(whole, channels, companions),
                    None => (whole.clone().into(), Vec::new()),
                });
            }
        };
        let wanted = cube.wanted(file).within(self.memory);
        Ok(match (held, &cube.channels) {
            (Some(room), None) => (self.bricks(file, wanted, room)?.into(), Vec::new()),
            (Some(room), Some(channels)) => {
                // Each has its share of the room.
                let parts = 1 + companions.len() as u64;
                let bricks = |places: &[usize]| {
                    let bricks = self.bricks(file, wanted, room / parts)?;
                    Ok(bricks.taking(places).into())
                };
                let others = companions.iter();
                let others = others.filter_map(|channel| channels.place(*channel));
                let others = others.map(|place| bricks(&[place]));
                (bricks(&channels.colours())?, others.collect::<Result<_>>()?)
            }
            (None, None) => (cubes::load(&file.path, wanted)?.into(), Vec::new()),
            (None, Some(channels)) => {
                let whole = Arc::new(cubes::load(&file.path, wanted)?);
                split(&whole, channels, companions)
            }
        })
    }

    fn bricks(&self, file: &CubeFile, wanted: Wanted, room: u64) -> Result<Bricks> {
        if self.counts_only
            && let Some(bricks) = Bricks::counting(&file.path, wanted, room)?
        {
            return Ok(bricks);
        }
        Bricks::open(&file.path, wanted, room)
    }
}

/// The colours of a cube with these channels, and each of these companions.
fn split(
    cube: &Arc<Cube>,
    channels: &Channels,
    companions: &[CubeChannel],
) -> (CubeStore, Vec<CubeStore>) {
    let places = companions.iter();
    let places = places.filter_map(|channel| channels.place(*channel));
    let others = places.map(|place| cube.taking(&[place]).into()).collect();
    // Cubes that are already red, green and blue are kept as they are.
    let colours = match channels.names().as_slice() {
        ["R", "G", "B"] => cube.clone().into(),
        _ => cube.taking(&channels.colours()).into(),
    };
    (colours, others)
}

fn refused(scene: &Scene, source: usize, error: impl std::fmt::Display) -> Error {
    let place = format!("source \"{}\"", scene.sources[source].name);
    Error::invalid(
        &scene.name,
        place,
        error.to_string(),
        "a cube (H, W, T) or (H, W, T, 1 or 3), or one whose `channels` are named, and a time axis that fits it",
    )
}

/// The rest frame of the objects that a source is bound to, and the first of these objects.
struct Place<'a> {
    rest: Option<&'a RestFrame>,
    /// Origin of the object in the frame.
    object: DVec3,
    /// World coordinates of the frame's origin if the frame rests in the world.
    world: Option<DVec3>,
}

impl<'a> Place<'a> {
    fn of(scene: &Scene, source: usize, frames: &'a [RestFrame]) -> Self {
        let object = match &scene.sources[source].binding {
            Binding::All => 0,
            Binding::Only { objects, .. } => objects.first().copied().unwrap_or(0),
        };
        let has = |f: &&RestFrame| f.patches.iter().any(|p| p.object as usize == object);
        let rest = frames.iter().find(has);
        let origin = rest
            .and_then(|f| f.patches.iter().find(|p| p.object as usize == object))
            .map(|p| p.object_origin);
        let still = rest.filter(|f| f.frame.velocity().is_rest());
        Place {
            rest,
            object: origin.map_or(DVec3::ZERO, |o| o.x),
            world: still.map(|f| f.frame.origin().x),
        }
    }

    /// A cube's clock for its bound objects. A capture camera's clock runs in world time for objects at rest in the world, and in the
    /// object's own for others.
    fn clock(&self, clock: Clock) -> EmissionClock {
        match (clock, self.world) {
            (Clock::World, _) | (Clock::Capture, Some(_)) => EmissionClock::World,
            (Clock::Object, _) | (Clock::Capture, None) => EmissionClock::Object,
        }
    }

    /// The capture pinhole in frame coordinates.
    fn eye(&self, eye: DVec3) -> DVec3 {
        match self.world {
            // World coordinates if the objects rest there, and otherwise the object's own.
            Some(frame_origin) => eye - frame_origin,
            None => eye + self.object,
        }
    }

    fn seen(&self, origin: DVec3, direction: DVec3) -> Option<SeenPoint> {
        let bvh = &self.rest?.bvh;
        let hit = bvh.closest(
            &Ray {
                origin,
                direction,
                s_min: 0.0,
            },
            f64::INFINITY,
        )?;
        Some(SeenPoint {
            distance: hit.s,
            normal: bvh.normal(&hit),
        })
    }
}
